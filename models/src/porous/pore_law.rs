//! One step of the spherical contact of a porous medium: the collapsed pores add k_bκ to the mean stress, with the
//! closure κ = min(θ₀ + tr ε, 0).
//!
//! An elastic step treats the pores as collapsed, with the bulk modulus k_a + k_b. The law takes the change of the volume
//! from the change of the mean stress, computes the new closure and corrects the mean stress:
//!
//! ```text
//! Δe = (σ̂ₘ − k_a e − k_b κ)/(k_a + k_b),    κ′ = min(θ₀ + e + Δe, 0),    δ = Δe − (κ′ − κ),    σₘ = σ̂ₘ − k_b δ.
//! ```
//!
//! The energy ½k_a e² + ½k_b κ² decreases by k_b δ(κ′ + ½δ) ≥ 0 relative to that of the elastic step.

use super::parameters::PorousMedium;
use crate::common::number::Number;

/// Constants of the law of pores with spherical contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreLaw<N> {
    /// Bulk modulus k_a of the skeleton, Pa.
    pub skeleton_modulus: N,
    /// Bulk modulus k_b that collapsed pores add, Pa.
    pub contact_modulus: N,
    /// Compliance 1/(k_a + k_b), 1/Pa.
    pub closed_compliance: N,
    /// Porosity θ₀ of the natural state.
    pub porosity: N,
}

/// Volumetric strain and closure of the pores.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreState<N> {
    /// Volumetric strain e = tr ε.
    pub volumetric_strain: N,
    /// Closure κ = min(θ₀ + e, 0).
    pub closure: N,
}

/// Result of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoreStep<N> {
    /// State after the step.
    pub state: PoreState<N>,
    /// Change −k_b δ of the mean stress, Pa.
    pub mean_stress_change: N,
    /// Energy lost in the step, J/m³; ≥ 0.
    pub energy_loss: N,
}

impl PoreLaw<f64> {
    /// Creates the constants of a medium.
    pub fn new(medium: &PorousMedium) -> Self {
        let own = medium.parameters();
        Self {
            skeleton_modulus: own.bulk_modulus,
            contact_modulus: own.contact_bulk_modulus,
            closed_compliance: 1.0 / (own.bulk_modulus + own.contact_bulk_modulus),
            porosity: own.porosity,
        }
    }

    /// Returns the state of a mean stress, Pa.
    pub fn state_of_mean_stress(&self, mean_stress: f64) -> PoreState<f64> {
        let open = mean_stress / self.skeleton_modulus;
        let closed = (mean_stress - self.contact_modulus * self.porosity) * self.closed_compliance;
        let volumetric_strain = if self.porosity + open >= 0.0 { open } else { closed };
        PoreState { volumetric_strain, closure: (self.porosity + volumetric_strain).min(0.0) }
    }
}

impl<N: Number> PoreLaw<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> PoreLaw<M> {
        PoreLaw {
            skeleton_modulus: f(self.skeleton_modulus),
            contact_modulus: f(self.contact_modulus),
            closed_compliance: f(self.closed_compliance),
            porosity: f(self.porosity),
        }
    }

    /// Completes an elastic step that ends at `mean_stress` σ̂ₘ, Pa, from the state before it.
    #[inline(always)]
    pub fn complete_step(&self, mean_stress: N, before: PoreState<N>) -> PoreStep<N> {
        let PoreState { volumetric_strain, closure } = before;
        let old_stress = self.skeleton_modulus * volumetric_strain + self.contact_modulus * closure;
        let strain_change = (mean_stress - old_stress) * self.closed_compliance;
        let volumetric_strain = volumetric_strain + strain_change;
        let new_closure = (self.porosity + volumetric_strain).min(N::ZERO);
        let closure_change = new_closure - closure;
        // Exactly zero while the pores stay collapsed.
        let not_closed = strain_change - closure_change;
        let not_closed = N::ZERO.select_gt(closure.max(new_closure), N::ZERO, not_closed);
        let excess = self.contact_modulus * not_closed;
        PoreStep {
            state: PoreState { volumetric_strain, closure: new_closure },
            mean_stress_change: -excess,
            // Rounding may change the sign of δ where the pores begin to collapse.
            energy_loss: (excess * (new_closure + N::HALF * not_closed)).max(N::ZERO),
        }
    }
}
