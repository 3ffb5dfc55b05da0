//! Elastic layer: CṠ = d in every traction component, with compliance C, m/Pa, traction S, Pa, and opening rate d, m/s.

use super::opening_line::{LayerMass, MOTION_VARIABLE_COUNT, OpeningLine, initial_motion};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;

/// Thickness and material constants of an isotropic elastic interlayer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticMaterial {
    /// Thickness δ, m.
    pub thickness: f64,
    /// Density ρ′, kg/m³.
    pub density: f64,
    /// Longitudinal wave speed c₁′, m/s.
    pub longitudinal_speed: f64,
    /// Shear wave speed c₂′, m/s.
    pub shear_speed: f64,
}

impl ElasticMaterial {
    /// Checks that all constants are positive and finite.
    ///
    /// # Errors
    /// A constant is not positive and finite.
    pub fn check(&self) -> Result<(), InputError> {
        for (name, value) in [
            ("thickness", self.thickness),
            ("density", self.density),
            ("longitudinal_speed", self.longitudinal_speed),
            ("shear_speed", self.shear_speed),
        ] {
            ensure(value > 0.0 && value.is_finite(), name, value, "expected a positive number")?;
        }
        Ok(())
    }

    /// Mass per area ρ′δ, kg/m².
    pub fn mass(&self) -> f64 {
        self.density * self.thickness
    }

    /// Compliance 1/K = δ/(ρ′c₁′²) for the normal traction, m/Pa.
    pub fn normal_compliance(&self) -> f64 {
        self.thickness / (self.density * self.longitudinal_speed * self.longitudinal_speed)
    }

    /// Compliance 1/K = δ/(ρ′c₂′²) for a tangential traction, m/Pa.
    pub fn tangential_compliance(&self) -> f64 {
        self.thickness / (self.density * self.shear_speed * self.shear_speed)
    }
}

/// Elastic law of a layer for one traction component. With zero mass and compliance the interface is welded: velocity
/// and traction are continuous.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticComponent<N> {
    /// Mass per area of the layer.
    pub mass: LayerMass<N>,
    /// Compliance C = 1/K = δ/(ρ′c′²) ≥ 0, m/Pa.
    pub compliance: N,
}

/// Number of history variables of an elastic component: velocity V and opening rate d, m/s, and traction S, Pa.
pub const COMPONENT_VARIABLE_COUNT: usize = MOTION_VARIABLE_COUNT + 1;

impl ElasticComponent<f64> {
    /// A welded interface: zero mass and compliance.
    pub const WELDED: Self =
        Self { mass: LayerMass { mass: 0.0, opening_mass: 0.0 }, compliance: 0.0 };

    /// Converts the constants to the number type `N` (f32, f64 or SIMD lanes).
    pub fn to_number<N: Number>(self) -> ElasticComponent<N> {
        self.map(N::from_f64)
    }
}

impl<N> ElasticComponent<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ElasticComponent<M> {
        ElasticComponent { mass: self.mass.map(&f), compliance: f(self.compliance) }
    }
}

impl<N: Number> ElasticComponent<N> {
    /// Advances the history variables by `step`, s, and returns the states on both sides. Midpoint rule:
    /// S_mid = (2CS/Δt + d₀)/(2C/Δt + g) with d₀ and g of [`OpeningLine`], then S ← 2S_mid − S.
    #[inline(always)]
    pub fn advance(
        &self,
        incoming: RiemannData<N>,
        step: N,
        history: &mut [N; COMPONENT_VARIABLE_COUNT],
    ) -> [FaceState<N>; 2] {
        let [velocity, opening_rate, stress] = *history;
        let line = OpeningLine::new(incoming, self.mass, [velocity, opening_rate], step);
        let rate = (self.compliance + self.compliance) / step;
        let middle = (rate * stress + line.free_opening_rate) * (N::ONE / (rate + line.admittance));
        let layer_step = line.complete_step(middle);
        *history = [layer_step.motion[0], layer_step.motion[1], middle + middle - stress];
        layer_step.states
    }

    /// Elastic energy ½CS², J/m².
    #[inline(always)]
    pub fn stored_energy(&self, stress: N) -> N {
        N::HALF * self.compliance * stress * stress
    }
}

/// Law of an elastic layer: independent elastic components. The history variables are those of each component in turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticLayer<N, const P: usize> {
    /// Laws of the traction components, the normal one first.
    pub components: [ElasticComponent<N>; P],
}

impl<N, const P: usize> ElasticLayer<N, P> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> ElasticLayer<M, P> {
        ElasticLayer { components: self.components.map(|component| component.map(&f)) }
    }
}

impl<N: Number, const P: usize> FaceLaw<N, P> for ElasticLayer<N, P> {
    const HISTORY_VARIABLE_COUNT: usize = COMPONENT_VARIABLE_COUNT * P;

    fn initialise(&self, velocities: &[[N; 2]; P], history: &mut [N]) {
        let (components, _) = history.as_chunks_mut::<COMPONENT_VARIABLE_COUNT>();
        for (component, velocities) in components.iter_mut().zip(velocities) {
            let [velocity, opening_rate] = initial_motion(*velocities);
            *component = [velocity, opening_rate, N::ZERO];
        }
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; P],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; P] {
        let zero = FaceState { velocity: N::ZERO, stress: N::ZERO };
        let mut states = [[zero; 2]; P];
        let (components, _) = history.as_chunks_mut::<COMPONENT_VARIABLE_COUNT>();
        for index in 0..P {
            states[index] = self.components[index].advance(
                incoming[index],
                if index == 0 { interval.step } else { interval.tangential_step },
                &mut components[index],
            );
        }
        states
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let mut energy = FaceEnergy::ZERO;
        let (components, _) = history.as_chunks::<COMPONENT_VARIABLE_COUNT>();
        for (law, [velocity, opening_rate, stress]) in self.components.iter().zip(components) {
            energy.kinetic = energy.kinetic + law.mass.kinetic_energy([*velocity, *opening_rate]);
            energy.stored = energy.stored + law.stored_energy(*stress);
        }
        energy
    }
}
