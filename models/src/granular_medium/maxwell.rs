//! Viscous particles in contact, the scheme spring, dashpot and contact in series: the acting stress σ relaxes the
//! conditional stress s.
//!
//! At constant strain
//!
//! ```text
//! dev ṡ = −dev σ/τ_s,    ṗ_s = −p/τ_v,    σ = π_K(s),    τ_s = η_s/μ,  τ_v = η_v/k
//! ```
//!
//! with the viscosities η_s of shear and η_v of volume. An open contact has no stress and keeps its opening. Over a time t
//! with the factors f = exp(t/τ) the implicit step
//!
//! ```text
//! s′ = s − (f − 1)σ′,    σ′ = π_K(s′),    so that σ′ = π′(s/f)
//! ```
//!
//! with the projection π′ in the norm of the moduli divided by f. It is exact where the state stays within the cone, since
//! σ′ = σ/f there, and the energy decreases for any t.

use super::contact_law::GranularContact;
use crate::common::elementary::Elementary;
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;
use crate::common::range::AllowedRange::Positive;
use crate::rheology::relaxation::SymmetricTensor;

/// Relaxation times of the particles of a granular medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellParticles {
    /// Relaxation time τ_s = η_s/μ of the deviator, s; infinite without viscosity of shear.
    shear_time: f64,
    /// Relaxation time τ_v = η_v/k of the mean stress, s; infinite without viscosity of volume.
    bulk_time: f64,
}

/// Law of a granular medium in a step of relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MaxwellStep<N> {
    /// Law with the moduli k/f_v and M/f_s.
    pub contact: GranularContact<N>,
    /// Factor f_s of the deviator.
    pub shear_factor: N,
    /// Factor f_v of the mean stress.
    pub bulk_factor: N,
}

impl MaxwellParticles {
    /// Largest t/τ of a step, by which stresses decay to 0.2 %. The rounding of an excess grows with f.
    pub const MAX_DECREMENT: f64 = 6.0;

    /// Creates the relaxation times of viscosities η_s and η_v, Pa·s, in a medium; `None`: no relaxation.
    ///
    /// # Errors
    /// A viscosity is not positive and finite.
    pub fn new(
        contact: &GranularContact<f64>,
        shear_modulus: f64,
        [shear_viscosity, bulk_viscosity]: [Option<f64>; 2],
    ) -> Result<Self, InputError> {
        let time = |key, viscosity: Option<f64>, modulus: f64| match viscosity {
            None => Ok(f64::INFINITY),
            Some(value) => {
                ensure(Positive.contains(value), key, value, "a viscosity must be > 0, in Pa·s")?;
                Ok(value / modulus)
            }
        };
        Ok(Self {
            shear_time: time("shear_viscosity", shear_viscosity, shear_modulus)?,
            bulk_time: time("bulk_viscosity", bulk_viscosity, contact.bulk_modulus)?,
        })
    }

    /// Returns the law of a step of a duration, s.
    pub fn step(&self, contact: &GranularContact<f64>, duration: f64) -> MaxwellStep<f64> {
        let factor = |time: f64| (duration / time).min(Self::MAX_DECREMENT).cr_exp();
        let [shear_factor, bulk_factor] = [self.shear_time, self.bulk_time].map(factor);
        let contact = GranularContact::from_moduli(
            contact.bulk_modulus / bulk_factor,
            contact.energy_modulus / shear_factor,
            contact.intensity_factor,
            contact.friction,
            Some(contact.yield_stress),
        );
        MaxwellStep { contact, shear_factor, bulk_factor }
    }
}

/// Result of a step of relaxation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelaxedState<N, const SHEAR_COUNT: usize> {
    /// Stress σ′, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Excess s′ − σ′, Pa.
    pub excess: SymmetricTensor<N, SHEAR_COUNT>,
    /// Energy lost, J/m³: dissipation of dashpots and hinges.
    pub energy_loss: N,
}

impl<N: Number> MaxwellStep<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M + Copy) -> MaxwellStep<M> {
        MaxwellStep {
            contact: self.contact.map(f),
            shear_factor: f(self.shear_factor),
            bulk_factor: f(self.bulk_factor),
        }
    }

    /// Returns the law of fields that are `factor` times the physical ones.
    #[must_use]
    pub fn with_field_factor(mut self, factor: N) -> Self {
        self.contact.yield_stress = factor * self.contact.yield_stress;
        self.contact.corner_pressure = factor * self.contact.corner_pressure;
        self
    }

    /// Relaxes the stress and the excess of a state, Pa, at constant strain.
    #[inline(always)]
    pub fn relax<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        excess: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> RelaxedState<N, SHEAR_COUNT> {
        let Self { shear_factor, bulk_factor, .. } = *self;
        let (shear_share, bulk_share) = (N::ONE / shear_factor, N::ONE / bulk_factor);
        let trial = scale_parts(stress.plus(excess), [shear_share, bulk_share]);
        let step = self.contact.complete_step(trial, SymmetricTensor::ZERO);
        // With the moduli divided by f the energy is f times that of a stress.
        let [of_mean, of_deviator] = self.contact.doubled_energy_differences(stress, step.stress);
        let energy_loss = N::HALF * (bulk_share * of_mean + shear_share * of_deviator);
        RelaxedState {
            stress: step.stress,
            excess: scale_parts(step.excess, [shear_factor, bulk_factor]),
            energy_loss,
        }
    }
}

/// Multiplies the deviator and the mean of a tensor by factors.
#[inline(always)]
pub(super) fn scale_parts<N: Number, const SHEAR_COUNT: usize>(
    tensor: SymmetricTensor<N, SHEAR_COUNT>,
    [of_deviator, of_mean]: [N; 2],
) -> SymmetricTensor<N, SHEAR_COUNT> {
    let mean = of_mean * tensor.mean();
    let mut scaled = tensor.deviator().scale(of_deviator);
    for i in 0..3 {
        scaled.normal[i] = scaled.normal[i] + mean;
    }
    scaled
}
