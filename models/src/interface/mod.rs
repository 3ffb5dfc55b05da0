//! Face laws: the generalised Riemann problem at a face between two cells.
//!
//! Per traction component each side supplies the impedance z of its cell and the incoming Riemann invariant,
//!
//! ```text
//! R⁻ = z⁻v⁻ − σ⁻,    R⁺ = z⁺v⁺ + σ⁺,
//! ```
//!
//! where − is the lower side (smaller coordinate) and + the upper side, and v, σ and R are averages of velocity,
//! traction and Riemann invariant at the face over the step. A [`FaceLaw`] closes these two equations for v± and σ±,
//! possibly with history variables. The cells on both sides are updated by the fluxes v± and σ± (Godunov 1959).
//!
//! - [`interlayer`]: momentum balance of a thin layer with mass, for any material law;
//! - [`elastic`]: face law of a layer with an elastic material.
//!
//! Generic over [`Number`]: the same code runs on single faces and on SIMD lanes of faces.

pub mod elastic;
pub mod interlayer;

use crate::common::number::Number;

/// Incoming Riemann invariants and impedances at a face; index 0 is the lower side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiemannData<N> {
    /// Impedances z⁻ and z⁺ > 0, kg/(m²s) for translations.
    pub impedance: [N; 2],
    /// Riemann invariants R⁻ = z⁻v⁻ − σ⁻ and R⁺ = z⁺v⁺ + σ⁺, Pa for translations: time averages over the step.
    pub invariant: [N; 2],
}

/// State on one side of a face, averaged over the step; it gives the fluxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceState<N> {
    /// Velocity v, m/s for translations.
    pub velocity: N,
    /// Traction σ, Pa for translations.
    pub stress: N,
}

/// Result of a face law for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceStep<N> {
    /// States of both sides; index 0 is the lower side.
    pub states: [FaceState<N>; 2],
    /// Energy dissipated by the law in the step, J/m².
    pub dissipated_energy: N,
}

impl<N: Number> FaceStep<N> {
    /// Power supplied to the face by both sides, σ⁺v⁺ − σ⁻v⁻, W/m².
    #[inline(always)]
    pub fn power(&self) -> N {
        let [before, after] = self.states;
        after.stress * after.velocity - before.stress * before.velocity
    }
}

/// Face law for one traction component.
///
/// Energy balance of every step Δt, to rounding: ΔE_kinetic + ΔE_stored + dissipated = Δt (σ⁺v⁺ − σ⁻v⁻) with
/// dissipated ≥ 0. So a face never adds energy to the adjacent cells.
pub trait FaceLaw<N: Number>: Copy {
    /// History variables of a face; all zero in a face at rest without stress.
    type History: AsRef<[N]> + AsMut<[N]> + Copy;

    /// History variables of a face at rest without stress.
    const REST_HISTORY: Self::History;

    /// Advances the face by a step Δt = `step` (s): updates the history variables `memory` and returns the states on
    /// both sides, which give the fluxes, and the dissipated energy.
    fn advance(
        &self,
        incoming: &RiemannData<N>,
        step: N,
        memory: &mut Self::History,
    ) -> FaceStep<N>;

    /// Kinetic energy of the face, J/m².
    fn kinetic_energy(&self, memory: &Self::History) -> N;

    /// Elastic energy stored in the face, J/m².
    fn stored_energy(&self, memory: &Self::History) -> N;
}
