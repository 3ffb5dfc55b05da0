//! Evolution of the uniform mean flow. In v = Γx with constant Γ the angle ψ of the major principal stress is constant,
//! except for the models below. ψ_D is the angle of the major principal deformation rate, Q_D the shear rate, s₂₁ half
//! the vorticity (1/s), Ω the spin (rad/s), φ the friction angle and ν the dilatancy angle.
//!
//! - double shearing: ψ̇ = s₂₁ + Q_D sin 2(ψ − ψ_D)/sin φ (Spencer 1964; ν = 0). With θ = ψ − ψ_D and tan θ = y/x the
//!   equation is linear, ẋ = −bx − sy, ẏ = sx + by, where b = Q_D/sin φ and s = s₂₁;
//! - Harris & Grekova with DΩ/Dt ≠ 0: sin 2(ψ − ψ_D) = sin φ (Ω(t) − s₂₁)/Q_D (2005, eq. 42).

use models::LinearisedSystem;
use models::common::elementary::Elementary;
use models::flow::state::{Background, DeformingFlow, MaterialState};
use models::flow::{Model, RotationKind};
use nalgebra::{Matrix2, Vector2};

/// A time-dependent uniform mean flow.
pub(super) struct MeanFlow {
    model: Model,
    /// Initial state.
    state: MaterialState,
    /// Initial flow.
    flow: DeformingFlow,
    system: LinearisedSystem<2>,
    rotation_ratio: f64,
    angle_law: AngleLaw,
}

/// Evolution law of ψ − ψ_D.
enum AngleLaw {
    ConstantAngle,
    /// Double shearing: the linear equation for (x, y) in the module comment.
    DoubleShearing,
    /// Harris–Grekova: ψ − ψ_D follows from the spin, which has this constant rate, rad/s².
    ConstantSpinRate(f64),
}

impl MeanFlow {
    pub(super) fn new(model: Model, state: MaterialState, flow: DeformingFlow) -> Self {
        let law = match model.kind().rotation() {
            RotationKind::StressAxes => AngleLaw::DoubleShearing,
            RotationKind::IntrinsicSpin if state.spin_acceleration != 0.0 => {
                AngleLaw::ConstantSpinRate(state.spin_acceleration)
            }
            _ => AngleLaw::ConstantAngle,
        };
        let mut system = LinearisedSystem::default();
        model.write_symbol(&flow, &mut system);
        let rotation_ratio = model.flow_rule().rotation_ratio();
        Self { model, state, flow, system, rotation_ratio, angle_law: law }
    }

    /// Linearised equations at the initial time.
    pub(super) fn system(&self) -> &LinearisedSystem<2> {
        &self.system
    }

    /// Angle ψ − ψ_D at a time (s), modulo π; `None` if the flow is no longer fully deforming.
    pub(super) fn angle(&self, time: f64) -> Option<f64> {
        let (rate, vorticity) = (self.flow.shear_rate, self.flow.half_vorticity);
        let start = -self.flow.noncoaxiality;
        match self.angle_law {
            AngleLaw::ConstantAngle => Some(start),
            AngleLaw::DoubleShearing => {
                let b = rate / self.rotation_ratio;
                let matrix = Matrix2::new(-b, -vorticity, vorticity, b) * time;
                let [x, y]: [f64; 2] =
                    (matrix.exp() * Vector2::new(start.cr_cos(), start.cr_sin())).into();
                Some(y.cr_atan2(x))
            }
            AngleLaw::ConstantSpinRate(acceleration) => {
                let spin = self.flow.spin?.value + acceleration * time;
                let sine = self.rotation_ratio * (spin - vorticity) / rate;
                let half = 0.5 * sine.cr_asin();
                let is_coaxial = (2.0 * start).cr_cos() > 0.0;
                let angle = if is_coaxial { half } else { std::f64::consts::FRAC_PI_2 - half };
                (sine.abs() < 1.0).then_some(angle)
            }
        }
    }

    /// Linearised equations at a time (s); `None` if the mean flow is no longer fully deforming.
    pub(super) fn system_at(&self, time: f64) -> Option<LinearisedSystem<2>> {
        if matches!(self.angle_law, AngleLaw::ConstantAngle) {
            return Some(self.system.clone());
        }
        let angle = self.angle(time)?;
        let along = self.flow.stress.angle + self.flow.noncoaxiality;
        let state = MaterialState {
            stress_angle: along + angle,
            noncoaxiality: Some(-angle),
            spin: None,
            stress_angle_rate: None,
            rotational_stress: self.flow.spin.map(|_| self.flow.stress.rotational_stress),
            acceleration: None,
            body_moment: None,
            velocity_gradient: None,
            ..self.state
        };
        let Background::FullyDeforming(flow) = self.model.background(&state).ok()? else {
            return None;
        };
        let mut system = LinearisedSystem::default();
        self.model.write_symbol(&flow, &mut system);
        Some(system)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use models::registry;

    fn double_shearing_flow(state: MaterialState) -> MeanFlow {
        let constants = [30f64.to_radians(), 0.0, 0.0];
        let model = Model::new(registry::DOUBLE_SHEARING, &constants).expect("a model");
        let Background::FullyDeforming(flow) = model.background(&state).expect("a flow") else {
            panic!("a flow that deforms");
        };
        MeanFlow::new(model, state, flow)
    }

    /// Verifies the angle ψ − ψ_D against the classical Runge–Kutta method applied to the evolution equation of ψ.
    #[test]
    fn stress_angle_follows_evolution_equation() {
        let own = double_shearing_flow(MaterialState {
            density: 1600.0,
            pressure: 1000.0,
            shear_rate: 50.0,
            half_vorticity: -9.0,
            noncoaxiality: Some(16f64.to_radians()),
            ..MaterialState::default()
        });
        let (rate, vorticity) = (own.flow.shear_rate, own.flow.half_vorticity);
        let slope = |angle: f64| vorticity + rate * (2.0 * angle).sin() / own.rotation_ratio;
        let (mut angle, step) = (-own.flow.noncoaxiality, 1e-3 / rate);
        for index in 1..=400 {
            let one = slope(angle);
            let two = slope(angle + 0.5 * step * one);
            let three = slope(angle + 0.5 * step * two);
            let four = slope(angle + step * three);
            angle += step / 6.0 * (one + 2.0 * (two + three) + four);
            let found = own.angle(f64::from(index) * step).expect("an angle");
            assert!((found - angle).sin().abs() < 1e-9, "{index}: {found} for {angle}");
        }
        let first = own.system_at(0.0).expect("equations");
        assert_eq!(first.unknowns, own.system().unknowns);
    }
}
