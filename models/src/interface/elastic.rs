//! Elastic interlayer: C Ṡ = d, with compliance C, mean traction S and opening rate d.

use super::interlayer::OpeningLine;
use super::{FaceLaw, FaceStep, RiemannData};
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
            ensure(value > 0.0 && value.is_finite(), name, value, "a positive number")?;
        }
        Ok(())
    }

    /// The interlayer law for the normal traction, with stiffness K = ρ′c₁′²/δ.
    pub fn normal_interlayer(&self) -> ElasticInterlayer<f64> {
        self.interlayer_for_speed(self.longitudinal_speed)
    }

    /// The interlayer law for a tangential traction, with stiffness K = ρ′c₂′²/δ.
    pub fn tangential_interlayer(&self) -> ElasticInterlayer<f64> {
        self.interlayer_for_speed(self.shear_speed)
    }

    fn interlayer_for_speed(&self, speed: f64) -> ElasticInterlayer<f64> {
        ElasticInterlayer {
            mass: self.density * self.thickness,
            compliance: self.thickness / (self.density * speed * speed),
        }
    }
}

/// Face law of an elastic interlayer for one traction component. With zero mass and compliance the interface is welded:
/// velocity and traction are continuous.
///
/// History variables: mean velocity V, m/s, and mean traction S, Pa, at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticInterlayer<N> {
    /// Mass per area m = ρ′δ ≥ 0, kg/m².
    pub mass: N,
    /// Compliance C = 1/K = δ/(ρ′c′²) ≥ 0, m/Pa.
    pub compliance: N,
}

impl ElasticInterlayer<f64> {
    /// Converts the constants to the number type `N` (f32, f64 or SIMD lanes).
    pub fn to_number<N: Number>(&self) -> ElasticInterlayer<N> {
        ElasticInterlayer { mass: N::from_f64(self.mass), compliance: N::from_f64(self.compliance) }
    }
}

impl<N: Number> FaceLaw<N> for ElasticInterlayer<N> {
    type History = [N; 2];
    const REST_HISTORY: [N; 2] = [N::ZERO; 2];

    /// Midpoint rule: S_mid = (2CS/Δt + d₀)/(2C/Δt + g) with d₀ and g of [`OpeningLine`], then V ← 2V_mid − V and
    /// S ← 2S_mid − S.
    #[inline(always)]
    fn advance(&self, incoming: &RiemannData<N>, step: N, memory: &mut [N; 2]) -> FaceStep<N> {
        let [velocity, stress] = *memory;
        let line = OpeningLine::new(*incoming, self.mass, velocity, step);
        let rate = (self.compliance + self.compliance) / step;
        let middle = (rate * stress + line.free_rate) / (rate + line.admittance);
        let (velocity_middle, states) = line.states(middle);
        *memory = [velocity_middle + velocity_middle - velocity, middle + middle - stress];
        FaceStep { states, dissipated_energy: N::ZERO }
    }

    /// Kinetic energy ½mV², J/m².
    #[inline(always)]
    fn kinetic_energy(&self, [velocity, _]: &[N; 2]) -> N {
        N::HALF * self.mass * *velocity * *velocity
    }

    /// Elastic energy ½CS², J/m².
    #[inline(always)]
    fn stored_energy(&self, [_, stress]: &[N; 2]) -> N {
        N::HALF * self.compliance * *stress * *stress
    }
}
