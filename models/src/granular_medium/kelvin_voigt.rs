//! Particles in contact with a spring and a dashpot in parallel: σ = C:ε′ + η:ε̇′ for the strain ε′ of the particles, σ in the
//! cone of the contact, ε = ε′ + εᶜ.
//!
//! In a time step Δt the dashpot is a spring of the modulus 2η/Δt, without stress at the start of the step: if its strain
//! grows uniformly by Δε′, its mean stress is ½(2η/Δt)Δε′ = ηΔε′/Δt. Sweeps and the law of the contact thus act as in a
//! granular medium with the moduli
//!
//! ```text
//! k* = k + 2η_v/Δt,    μ* = μ + 2η_s/Δt,    C* = C + 2η/Δt.
//! ```
//!
//! Once per step the dashpot is released. With the stress b of the spring at the last release, Δε′ = C*⁻¹:(σ − b), so that
//!
//! ```text
//! b′ = b + C:C*⁻¹:(σ − b),    σ′ = π_K(b′ + x),    x′ = b′ + x − σ′
//! ```
//!
//! with the excess x = C*:εᶜ. Where the projection changes the stress, the dashpot is strained at the release itself, not
//! uniformly over the step, and one release gives half of the strain. Hence two releases per step: the stress of the spring
//! of an open particle decays by (1 + EΔt/(2η))⁻² per step, which is exp(−EΔt/η) to first order.
//!
//! The energy between two releases,
//!
//! ```text
//! Φ = ½σ:C*⁻¹:σ + ½b:(C⁻¹ − C*⁻¹):b,
//! ```
//!
//! is that of the spring, and what the dashpot will dissipate at the next release.

use super::contact_law::GranularContact;
use super::maxwell::scale_parts;
use super::parameters::GranularMedium;
use crate::common::input::{InputError, ensure};
use crate::common::number::Number;
use crate::common::range::AllowedRange::Positive;
use crate::rheology::relaxation::SymmetricTensor;

/// Viscosities of particles whose spring and dashpot are parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KelvinVoigtParticles {
    /// Viscosity η_s of shear, Pa·s; 0 without.
    shear_viscosity: f64,
    /// Viscosity η_v of volume, Pa·s; 0 without.
    bulk_viscosity: f64,
}

/// Law of a granular medium with such particles for one size of the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KelvinVoigtStep<N> {
    /// Law with the moduli k* and M* = 2μ*c².
    pub contact: GranularContact<N>,
    /// Share μ/μ* of the spring in the deviator of a stress increment.
    pub shear_share: N,
    /// Share k/k* of the spring in the mean of a stress increment.
    pub bulk_share: N,
}

/// State after a release of the dashpot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DampedState<N, const SHEAR_COUNT: usize> {
    /// Stress σ′, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Excess x′, Pa.
    pub excess: SymmetricTensor<N, SHEAR_COUNT>,
    /// Stress b′ of the spring, Pa.
    pub spring_stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Energy lost, J/m³: dissipation of dashpots and hinges.
    pub energy_loss: N,
}

impl KelvinVoigtParticles {
    /// Creates the particles with viscosities η_s and η_v, Pa·s; `None`: no viscosity.
    ///
    /// # Errors
    /// A viscosity is not positive and finite.
    pub fn new([shear_viscosity, bulk_viscosity]: [Option<f64>; 2]) -> Result<Self, InputError> {
        let check = |key, viscosity: Option<f64>| match viscosity {
            None => Ok(0.0),
            Some(value) => {
                ensure(Positive.contains(value), key, value, "a viscosity must be > 0, in Pa·s")?;
                Ok(value)
            }
        };
        Ok(Self {
            shear_viscosity: check("shear_viscosity", shear_viscosity)?,
            bulk_viscosity: check("bulk_viscosity", bulk_viscosity)?,
        })
    }

    /// Returns the moduli k* and μ*, Pa, for a time step, s.
    pub fn moduli(&self, medium: &GranularMedium, step: f64) -> [f64; 2] {
        let own = medium.parameters();
        [
            own.bulk_modulus + 2.0 * self.bulk_viscosity / step,
            own.shear_modulus + 2.0 * self.shear_viscosity / step,
        ]
    }

    /// Returns the law for a time step, s.
    pub fn step(&self, medium: &GranularMedium, step: f64) -> KelvinVoigtStep<f64> {
        let own = medium.parameters();
        let [bulk_modulus, shear_modulus] = self.moduli(medium, step);
        KelvinVoigtStep {
            contact: GranularContact::from_moduli(
                bulk_modulus,
                2.0 * shear_modulus * own.intensity_coefficient,
                own.intensity_coefficient.sqrt(),
                own.friction,
                own.yield_stress,
            ),
            shear_share: own.shear_modulus / shear_modulus,
            bulk_share: own.bulk_modulus / bulk_modulus,
        }
    }

    /// Returns the longest time step Δt, s, in which longitudinal waves with the moduli k*, μ* travel at most `distance`, m:
    /// the root of EΔt² + 2ηΔt = ρd² with E = k + 4μ/3 and η = η_v + 4η_s/3. For small d it is ρd²/(2η).
    pub fn longest_step(&self, medium: &GranularMedium, distance: f64) -> f64 {
        let own = medium.parameters();
        let modulus = own.bulk_modulus + 4.0 / 3.0 * own.shear_modulus;
        let viscosity = self.bulk_viscosity + 4.0 / 3.0 * self.shear_viscosity;
        let inertia = own.density * distance * distance;
        inertia / (viscosity + (viscosity * viscosity + inertia * modulus).sqrt())
    }
}

impl<N: Number> KelvinVoigtStep<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M + Copy) -> KelvinVoigtStep<M> {
        KelvinVoigtStep {
            contact: self.contact.map(f),
            shear_share: f(self.shear_share),
            bulk_share: f(self.bulk_share),
        }
    }

    /// Releases the dashpot of a state, Pa.
    #[inline(always)]
    pub fn release<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        excess: SymmetricTensor<N, SHEAR_COUNT>,
        spring_stress: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> DampedState<N, SHEAR_COUNT> {
        let shares = [self.shear_share, self.bulk_share];
        let mut state = DampedState { stress, excess, spring_stress, energy_loss: N::ZERO };
        for _ in 0..2 {
            let increment = state.stress.plus(state.spring_stress.scale(-N::ONE));
            state.spring_stress = state.spring_stress.plus(scale_parts(increment, shares));
            let step = self.contact.complete_step(state.spring_stress, state.excess);
            (state.stress, state.excess) = (step.stress, step.excess);
        }
        let differences = |before, after| self.contact.doubled_energy_differences(before, after);
        let of_stress = differences(stress, state.stress);
        let of_spring = differences(spring_stress, state.spring_stress);
        // C⁻¹ − C*⁻¹ is C*⁻¹ times the modulus ratios C*/C − 1.
        let [shear_ratio, bulk_ratio] = shares.map(|share| N::ONE / share - N::ONE);
        state.energy_loss = N::HALF
            * ((of_stress[0] + bulk_ratio * of_spring[0])
                + (of_stress[1] + shear_ratio * of_spring[1]));
        state
    }

    /// Returns the law of fields that are `factor` times the physical ones.
    #[must_use]
    pub fn with_field_factor(mut self, factor: N) -> Self {
        self.contact.yield_stress = factor * self.contact.yield_stress;
        self.contact.corner_pressure = factor * self.contact.corner_pressure;
        self
    }
}
