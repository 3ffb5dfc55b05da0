//! One step of the contact by cone of a porous medium with elastic skeleton: the collapsed pores add the projection of the
//! stress q + q⁰ onto the cone τ ≤ æp.
//!
//! With the stiffness C_a of the skeleton and C_b of the spring that collapsed pores add, s = C_a:ε, q = C_b:ε and
//! q⁰ = k_bθ₀δ, the stress is
//!
//! ```text
//! σ = s + r,    r = π_K(q + q⁰).
//! ```
//!
//! The history variable is the excess x = q − r. An elastic step with the stiffness C_a + C_b ends at a stress σ̂, so that
//! s + q = σ̂ + x; its mean stress and its deviator divide by the moduli:
//!
//! ```text
//! qₘ = k_b (σ̂ + x)ₘ/(k_a + k_b),    dev q = μ_b dev(σ̂ + x)/(μ_a + μ_b),    x′ = q − π_K(q + q⁰),    σ = σ̂ + x − x′.
//! ```
//!
//! Without pores, θ₀ = 0, the medium is heteromodular: stiffer in compression than in tension (Sadovskii & Sadovskaya 2012).
//! The energy ½s:a:s + ½r:b:r never exceeds that of the elastic step.

use super::parameters::{PoreContact, PorousMedium};
use crate::common::number::Number;
use crate::granular_medium::GranularContact;
use crate::rheology::relaxation::SymmetricTensor;

/// Constants of the law of pores whose walls transmit stresses in a friction cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreConeLaw<N> {
    /// Spring of collapsed pores in series with the cone: an elastic granular medium.
    pub contact: GranularContact<N>,
    /// Share k_b/(k_a + k_b) of the spring in the mean stress of closed contacts.
    pub bulk_share: N,
    /// Share μ_b/(μ_a + μ_b) of the spring in their deviator.
    pub shear_share: N,
    /// Mean stress q⁰ = k_bθ₀, Pa.
    pub offset: N,
}

/// State of a porous medium after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreConeStep<N, const SHEAR_COUNT: usize> {
    /// Stress σ, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Excess x = q − r, Pa.
    pub excess: SymmetricTensor<N, SHEAR_COUNT>,
    /// Energy lost in the step, J/m³.
    pub energy_loss: N,
}

impl PoreConeLaw<f64> {
    /// Creates the constants of a medium; `None` unless its contact is a cone, and its skeleton elastic.
    pub fn new(medium: &PorousMedium) -> Option<Self> {
        Self::with_any_skeleton(medium).filter(|_| medium.parameters().yield_stress.is_none())
    }

    /// Creates the constants of a medium whose skeleton may yield; `None` unless its contact is a cone.
    pub(super) fn with_any_skeleton(medium: &PorousMedium) -> Option<Self> {
        let own = medium.parameters();
        let PoreContact::Frictional { shear_modulus, friction } = own.contact else { return None };
        let bulk_modulus = own.contact_bulk_modulus;
        let contact = GranularContact::from_moduli(
            bulk_modulus,
            2.0 * shear_modulus * own.intensity_coefficient,
            own.intensity_coefficient.sqrt(),
            friction,
            None,
        );
        Some(Self {
            contact,
            bulk_share: bulk_modulus / (own.bulk_modulus + bulk_modulus),
            shear_share: shear_modulus / (own.shear_modulus + shear_modulus),
            offset: bulk_modulus * own.porosity,
        })
    }
}

impl<N: Number> PoreConeLaw<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M + Copy) -> PoreConeLaw<M> {
        PoreConeLaw {
            contact: self.contact.map(f),
            bulk_share: f(self.bulk_share),
            shear_share: f(self.shear_share),
            offset: f(self.offset),
        }
    }

    /// Completes an elastic step: `stress` is the stress σ̂ after it, `excess` the excess before it, Pa.
    #[inline(always)]
    pub fn complete_step<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        excess: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> PoreConeStep<N, SHEAR_COUNT> {
        let closed = stress.plus(excess);
        let mut spring = closed.deviator().scale(self.shear_share);
        let mean = self.bulk_share * closed.mean();
        let mut shifted = spring;
        for i in 0..3 {
            spring.normal[i] = spring.normal[i] + mean;
            shifted.normal[i] = shifted.normal[i] + (mean + self.offset);
        }
        let step = self.contact.complete_step(shifted, SymmetricTensor::ZERO);
        // q − r = (q + q⁰ − r) − q⁰, where the bracket is exactly zero while the pores stay collapsed.
        let mut new_excess = step.excess;
        for i in 0..3 {
            new_excess.normal[i] = new_excess.normal[i] - self.offset;
        }
        let minus = -N::ONE;
        let elastic = spring.plus(excess.scale(minus));
        PoreConeStep {
            stress: closed.plus(new_excess.scale(minus)),
            excess: new_excess,
            energy_loss: self.contact.energy_difference(elastic, step.stress),
        }
    }
}
