//! One step of the contact by cone of a porous medium whose skeleton yields at τ = τ_s.
//!
//! The history variables are the excess x = q − r of the [elastic skeleton](super::cone_law) and the plastic strain εᵖ of
//! the skeleton, a deviator:
//!
//! ```text
//! s = C_a:(ε − εᵖ),    q = C_b:ε,    r = π_K(q + q⁰),    σ = s + r.
//! ```
//!
//! With z = C_a:εᵖ = 2μ_aεᵖ the sum σ + z is the stress of the elastic skeleton at the same strain, so that an elastic step
//! to σ̂ is completed as there, from σ̂ + z. It ends at the trial s̄ of the skeleton, which returns radially to τ = τ_s:
//!
//! ```text
//! dev s′ = dev s̄ τ_s/t̄,    εᵖ′ = εᵖ + (dev s̄ − dev s′)/(2μ_a),    t̄ = c |dev s̄| > τ_s.
//! ```
//!
//! The contact does not feel the flow, since it depends on the total strain. The plastic dissipation is τ_s(t̄ − τ_s)/M_a
//! with M_a = 2μ_a c²; the step itself loses (t̄ − τ_s)²/(2M_a).

use super::cone_law::PoreConeLaw;
use super::parameters::PorousMedium;
use crate::common::number::Number;
use crate::rheology::relaxation::SymmetricTensor;

/// Constants of the law of pores with contact by cone in a plastic skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticPoreConeLaw<N> {
    /// Law of the same medium with elastic skeleton.
    pub elastic: PoreConeLaw<N>,
    /// Yield stress τ_s, Pa.
    pub yield_stress: N,
    /// Modulus 2μ_a, Pa, and compliance 1/(2μ_a), 1/Pa, of the deviator of the skeleton.
    pub shear_modulus_and_compliance: [N; 2],
    /// 1/M_a = 1/(2μ_a c²), 1/Pa.
    pub energy_compliance: N,
}

/// State of a porous medium with plastic skeleton after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticPoreConeStep<N, const SHEAR_COUNT: usize> {
    /// Stress σ, Pa.
    pub stress: SymmetricTensor<N, SHEAR_COUNT>,
    /// Excess x = q − r, Pa.
    pub excess: SymmetricTensor<N, SHEAR_COUNT>,
    /// Plastic strain εᵖ of the skeleton.
    pub plastic_strain: SymmetricTensor<N, SHEAR_COUNT>,
    /// Plastic dissipation of the step, J/m³.
    pub plastic_dissipation: N,
    /// Other energy lost in the step, J/m³.
    pub other_loss: N,
}

impl PlasticPoreConeLaw<f64> {
    /// Creates the constants of a medium; `None` unless its contact is a cone, and its skeleton yields.
    pub fn new(medium: &PorousMedium) -> Option<Self> {
        let own = medium.parameters();
        let modulus = 2.0 * own.shear_modulus;
        Some(Self {
            elastic: PoreConeLaw::with_any_skeleton(medium)?,
            yield_stress: own.yield_stress?,
            shear_modulus_and_compliance: [modulus, 1.0 / modulus],
            energy_compliance: 1.0 / (modulus * own.intensity_coefficient),
        })
    }
}

impl<N: Number> PlasticPoreConeLaw<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M + Copy) -> PlasticPoreConeLaw<M> {
        let [modulus, compliance] = self.shear_modulus_and_compliance;
        PlasticPoreConeLaw {
            elastic: self.elastic.map(f),
            yield_stress: f(self.yield_stress),
            shear_modulus_and_compliance: [f(modulus), f(compliance)],
            energy_compliance: f(self.energy_compliance),
        }
    }

    /// Returns the law of fields that are `factor` times the physical ones.
    #[inline(always)]
    #[must_use]
    pub fn with_field_factor(mut self, factor: N) -> Self {
        self.elastic.offset = factor * self.elastic.offset;
        self.yield_stress = factor * self.yield_stress;
        self
    }

    /// Completes an elastic step: `stress` is the stress σ̂ after it; `excess` (Pa) and `plastic_strain` are those before it.
    #[inline(always)]
    pub fn complete_step<const SHEAR_COUNT: usize>(
        &self,
        stress: SymmetricTensor<N, SHEAR_COUNT>,
        excess: SymmetricTensor<N, SHEAR_COUNT>,
        plastic_strain: SymmetricTensor<N, SHEAR_COUNT>,
    ) -> PlasticPoreConeStep<N, SHEAR_COUNT> {
        let minus = -N::ONE;
        let [modulus, compliance] = self.shear_modulus_and_compliance;
        let flow_stress = plastic_strain.scale(modulus);
        let closed = self.elastic.complete_step(stress.plus(flow_stress), excess);

        // dev s̄ is the share of the skeleton in dev(σ + z + x), less z.
        let skeleton_share = N::ONE - self.elastic.shear_share;
        let total = closed.stress.plus(closed.excess).deviator().scale(skeleton_share);
        let trial = total.plus(flow_stress.scale(minus));
        let intensity = self.elastic.contact.intensity_factor * trial.squared_norm().sqrt();
        let beyond = (intensity - self.yield_stress).max(N::ZERO);
        let removed = trial.scale(beyond.select_gt(N::ZERO, beyond / intensity, N::ZERO));

        let flow = beyond * self.energy_compliance;
        PlasticPoreConeStep {
            stress: closed.stress.plus(flow_stress.plus(removed).scale(minus)),
            excess: closed.excess,
            plastic_strain: plastic_strain.plus(removed.scale(compliance)),
            plastic_dissipation: self.yield_stress * flow,
            other_loss: closed.energy_loss + N::HALF * beyond * flow,
        }
    }
}
