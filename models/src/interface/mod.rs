//! Laws of faces: what a face between two cells does with the waves that both send to it.
//!
//! A face sees one traction component of each side: the impedance z of its cells, and the wave that arrives from it,
//!
//! ```text
//! R⁻ = z⁻v⁻ − σ⁻,    R⁺ = z⁺v⁺ + σ⁺,
//! ```
//!
//! where − is the side at smaller coordinates and + that at greater ones, v and σ are means over the step of velocity and
//! traction at the face, and R is that of the Riemann invariant. A [`FaceLaw`] closes these two equations for v± and σ±,
//! by its own memory if it has one. The cells on both sides change by the fluxes v± and σ± (Godunov 1959).
//!
//! - [`interlayer`]: a thin layer with mass between both sides;
//! - [`elastic`]: its elastic law.
//!
//! Written over [`Number`], once for a face and for many side by side.

pub mod elastic;
pub mod interlayer;

use crate::common::number::Number;

/// What both sides of a face send to it: index 0 at smaller coordinates, 1 at greater ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Incoming<N> {
    /// z⁻ and z⁺, positive, kg/(m²s) for translations.
    pub impedance: [N; 2],
    /// R⁻ = z⁻v⁻ − σ⁻ and R⁺ = z⁺v⁺ + σ⁺, Pa for translations: means over the step.
    pub invariant: [N; 2],
}

/// One side of a face: means over the step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceState<N> {
    /// v, m/s for translations.
    pub velocity: N,
    /// σ, Pa for translations.
    pub stress: N,
}

/// A face in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceStep<N> {
    /// Both sides: index 0 at smaller coordinates.
    pub states: [FaceState<N>; 2],
    /// Energy that the law dissipated in the step, J/m².
    pub dissipated: N,
}

impl<N: Number> FaceStep<N> {
    /// Power that both sides put into the face, σ⁺v⁺ − σ⁻v⁻, W/m².
    #[inline(always)]
    pub fn power(&self) -> N {
        let [before, after] = self.states;
        after.stress * after.velocity - before.stress * before.velocity
    }
}

/// The law of a face for one traction component.
///
/// In every step of Δt, to rounding: change of kinetic and stored energy + dissipated = Δt (σ⁺v⁺ − σ⁻v⁻), and dissipated
/// is not negative. So the face adds no energy to that of its neighbours, whatever they send.
pub trait FaceLaw<N: Number>: Copy {
    /// What the face remembers from step to step; zeros in a face at rest without stress.
    type Memory: AsRef<[N]> + AsMut<[N]> + Copy;

    /// The memory of a face at rest without stress.
    const REST: Self::Memory;

    /// A step of Δt (s) under what arrives.
    fn advance(&self, incoming: &Incoming<N>, step: N, memory: &mut Self::Memory) -> FaceStep<N>;

    /// Kinetic energy, J/m².
    fn kinetic_energy(&self, memory: &Self::Memory) -> N;

    /// Stored energy, J/m².
    fn stored_energy(&self, memory: &Self::Memory) -> N;
}
