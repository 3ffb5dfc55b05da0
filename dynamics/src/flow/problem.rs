//! Problem of the flow solver: background flow, box, tolerances, and checks of its parameters.

use super::closure::{Closure, Deformation};
use models::common::elementary::Elementary;

/// A homogeneous flow and the box in which it is perturbed; SI units, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowProblem {
    /// Equation for the stress angle ψ.
    pub closure: Closure,
    /// Density ρ, kg/m³; > 0.
    pub density: f64,
    /// Friction angle φ, rad; in (0, π/2).
    pub friction_angle: f64,
    /// Coefficient ratio e_r/c_r of the flow rule (sin φ in double shearing at constant volume): sin 2(ψ − ψ_D) is this
    /// ratio times the relative rotation (ω − s₂₁)/Q_D. Unused by coaxial models.
    pub rotation_ratio: f64,
    /// Cohesion c, Pa; ≥ 0.
    pub cohesion: f64,
    /// Mean pressure P₀, Pa; > −c cot φ.
    pub pressure: f64,
    /// Velocity gradient Γ, entry \[i\]\[j\] = ∂ⱼVᵢ, 1/s; traceless, with non-zero deformation rate.
    pub velocity_gradient: [[f64; 2]; 2],
    /// Initial stress angle Ψ of the background flow, rad.
    pub stress_angle: f64,
    /// Initial spin Ω of the background flow, rad/s (Harris–Grekova only).
    pub spin: f64,
    /// Rate of change DΩ/Dt of the spin of the background flow, rad/s² (Harris–Grekova only).
    pub spin_acceleration: f64,
    /// Number of points along each axis of the box; even, at least 4.
    pub points: [usize; 2],
    /// Initial edge lengths of the box along x₁ and x₂, m.
    pub lengths: [f64; 2],
    /// Maximum error of a step relative to the norm of the perturbation.
    pub tolerance: f64,
    /// Maximum residual of the pressure equation relative to its right-hand side.
    pub pressure_tolerance: f64,
    /// Shear rate Q_D, relative to that of the background flow, below which a run ends (plastic potential only).
    pub min_shear_rate: f64,
}

/// Error: an invalid parameter of a flow problem.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FlowError {
    /// Too few points, or an odd number of them.
    #[error("{0:?} points: an even number of at least 4 is needed along each axis")]
    PointCount([usize; 2]),
    /// A parameter outside its admissible range.
    #[error("{name} cannot be {value}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Value of the parameter.
        value: f64,
    },
    /// A background flow that changes volume or does not deform.
    #[error("the velocity gradient {0:?} must have trace 0 and deform")]
    VelocityGradient([[f64; 2]; 2]),
}

impl FlowProblem {
    /// Checks all parameters.
    ///
    /// # Errors
    /// The first invalid parameter.
    pub(super) fn check_parameters(&self) -> Result<(), FlowError> {
        if self.points.iter().any(|points| *points < 4 || points % 2 == 1) {
            return Err(FlowError::PointCount(self.points));
        }
        let positive = [
            ("the density", self.density),
            ("the friction angle", self.friction_angle),
            ("the length of the box", self.lengths[0]),
            ("the length of the box", self.lengths[1]),
            ("the tolerance", self.tolerance),
            ("the tolerance of the pressure", self.pressure_tolerance),
            ("the deviatoric stress", self.deviatoric_stress()),
            ("the cosine of the friction angle", self.friction_angle.cr_cos()),
        ];
        let finite = [
            ("the ratio of the flow rule", self.rotation_ratio),
            ("the cohesion", self.cohesion),
            ("the stress angle", self.stress_angle),
            ("the spin", self.spin),
            ("the spin's acceleration", self.spin_acceleration),
            ("the least shear rate", self.min_shear_rate),
        ];
        let odd = positive.iter().find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        if let Some(&(name, value)) = odd.or(finite.iter().find(|own| !own.1.is_finite())) {
            return Err(FlowError::Parameter { name, value });
        }
        let gradient = self.velocity_gradient;
        let rate = gradient_shear_rate(gradient);
        let trace = gradient[0][0] + gradient[1][1];
        if !(rate > 0.0 && rate.is_finite() && trace.abs() <= 1e-12 * rate) {
            return Err(FlowError::VelocityGradient(gradient));
        }
        Ok(())
    }

    /// Computes the deviatoric stress q = P₀ sin φ + c cos φ of the background flow, Pa.
    fn deviatoric_stress(&self) -> f64 {
        self.pressure * self.friction_angle.cr_sin() + self.cohesion * self.friction_angle.cr_cos()
    }
}

/// Computes the shear rate Q_D of a velocity gradient, 1/s.
pub(super) fn gradient_shear_rate(gradient: [[f64; 2]; 2]) -> f64 {
    Deformation::new(gradient).shear_rate()
}
