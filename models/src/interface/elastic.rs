//! An elastic interlayer: C Ṡ = d.

use super::interlayer::OpeningLine;
use super::{FaceLaw, FaceStep, Incoming};
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;

/// Thickness and material of an isotropic elastic interlayer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticMaterial {
    /// δ, m.
    pub thickness: f64,
    /// ρ′, kg/m³.
    pub density: f64,
    /// c₁′, speed of longitudinal waves, m/s.
    pub longitudinal_speed: f64,
    /// c₂′, speed of shear waves, m/s.
    pub shear_speed: f64,
}

impl ElasticMaterial {
    /// Checks the constants.
    ///
    /// # Errors
    /// One that is not positive and finite.
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

    /// The layer for the normal component of the traction, with K = ρ′c₁′²/δ.
    pub fn normal(&self) -> ElasticInterlayer<f64> {
        self.with_speed(self.longitudinal_speed)
    }

    /// The layer for a tangential component of the traction, with K = ρ′c₂′²/δ.
    pub fn tangential(&self) -> ElasticInterlayer<f64> {
        self.with_speed(self.shear_speed)
    }

    fn with_speed(&self, speed: f64) -> ElasticInterlayer<f64> {
        ElasticInterlayer {
            mass: self.density * self.thickness,
            compliance: self.thickness / (self.density * speed * speed),
        }
    }
}

/// An elastic interlayer as one component of the traction sees it. Without mass and compliance the sides are welded.
///
/// Memory: V, m/s, and S, Pa, at the end of the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticInterlayer<N> {
    /// m = ρ′δ ≥ 0, kg/m².
    pub mass: N,
    /// C = 1/K = δ/(ρ′c′²) ≥ 0, m/Pa.
    pub compliance: N,
}

impl ElasticInterlayer<f64> {
    /// The same in numbers of another kind.
    pub fn to_number<N: Number>(&self) -> ElasticInterlayer<N> {
        ElasticInterlayer { mass: N::constant(self.mass), compliance: N::constant(self.compliance) }
    }
}

impl<N: Number> FaceLaw<N> for ElasticInterlayer<N> {
    type Memory = [N; 2];
    const REST: [N; 2] = [N::ZERO; 2];

    /// S_mid = (2CS/Δt + d₀)/(2C/Δt + g), then V and S go on by twice their way to the middle.
    #[inline(always)]
    fn advance(&self, incoming: &Incoming<N>, step: N, memory: &mut [N; 2]) -> FaceStep<N> {
        let [velocity, stress] = *memory;
        let line = OpeningLine::new(*incoming, self.mass, velocity, step);
        let rate = (self.compliance + self.compliance) / step;
        let middle = (rate * stress + line.free_rate) / (rate + line.admittance);
        let (velocity_middle, states) = line.states(middle);
        *memory = [velocity_middle + velocity_middle - velocity, middle + middle - stress];
        FaceStep { states, dissipated: N::ZERO }
    }

    /// ½mV².
    #[inline(always)]
    fn kinetic_energy(&self, [velocity, _]: &[N; 2]) -> N {
        N::HALF * self.mass * *velocity * *velocity
    }

    /// ½CS².
    #[inline(always)]
    fn stored_energy(&self, [_, stress]: &[N; 2]) -> N {
        N::HALF * self.compliance * *stress * *stress
    }
}
