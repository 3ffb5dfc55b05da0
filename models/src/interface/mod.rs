//! Face laws: the generalised Riemann problem at a face between two cells.
//!
//! Per traction component each side supplies the impedance z of its cell and the incoming Riemann invariant,
//!
//! ```text
//! R⁻ = z⁻v⁻ − σ⁻,    R⁺ = z⁺v⁺ + σ⁺,
//! ```
//!
//! where − is the lower side (smaller coordinate) and + the upper side, and v, σ and R are averages of velocity,
//! traction and Riemann invariant at the face over the step. A [`FaceLaw`] closes these equations for v± and σ± of all
//! traction components of the face, possibly with history variables. The cells on both sides are updated by the fluxes
//! v± and σ± (Godunov 1959).
//!
//! - [`opening_line`]: momentum balance of a thin layer with mass, for any material law;
//! - [`elastic`], [`plastic`], [`viscous`], [`porous`], [`saturated`], [`cracked`], [`breaking`]: laws of layers;
//! - [`fluid`]: flow along saturated layers and through their junctions;
//! - [`layer`]: all laws of layers in one type; [`history`]: layout of their history variables;
//! - [`parameters`]: constants of layers of all materials; [`kinds`]: kinds of layers by name;
//! - [`homogenised`]: equivalent Cosserat continuum of blocks with elastic layers; [`continuum`]: its yield set.
//!
//! Generic over [`Number`]: the same code runs on single faces and on SIMD lanes of faces.

pub mod breaking;
pub mod continuum;
pub mod cracked;
pub mod elastic;
pub mod fluid;
pub mod history;
pub mod homogenised;
pub mod kinds;
pub mod layer;
pub mod opening_line;
pub mod parameters;
pub mod plastic;
pub mod porous;
pub mod saturated;
pub mod viscous;

use crate::common::number::Number;

/// Incoming Riemann invariants and impedances at a face, for one traction component; index 0 is the side of smaller
/// coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiemannData<N> {
    /// Impedances z⁻ and z⁺ > 0, kg/(m²s) for translations.
    pub impedance: [N; 2],
    /// Riemann invariants R⁻ = z⁻v⁻ − σ⁻ and R⁺ = z⁺v⁺ + σ⁺, Pa for translations: time averages over the step.
    pub invariant: [N; 2],
}

/// Velocity and traction on one side of a face, averaged over the step; they are the fluxes at the face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceState<N> {
    /// Velocity v, m/s for translations.
    pub velocity: N,
    /// Traction σ, Pa for translations.
    pub stress: N,
}

/// Time interval of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<N> {
    /// Time at the end of the step, s; positive.
    pub end: N,
    /// Duration Δt, s.
    pub step: N,
    /// Duration of the step of tangential components, s: Δt, or a multiple if the solver sweeps shear waves in longer
    /// steps. Laws that couple the components need equal durations and use Δt for both.
    pub tangential_step: N,
}

impl<N: Copy> Interval<N> {
    /// Returns the interval of a step of duration `step`, s, of all components, that ends at the time `end`, s.
    pub fn new(end: N, step: N) -> Self {
        Self { end, step, tangential_step: step }
    }
}

/// Energy of a face and energy that it has dissipated since the start, J/m².
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FaceEnergy<N> {
    /// Kinetic energy of the layer without the fluid, J/m².
    pub kinetic: N,
    /// Energy stored in the layer without the fluid, J/m².
    pub stored: N,
    /// Kinetic energy of the fluid in the layer, J/m².
    pub fluid_kinetic: N,
    /// Energy stored by the pressure of the fluid, J/m².
    pub fluid_stored: N,
    /// Numerical dissipation of the flow of the fluid along the layer since the start, J/m².
    pub fluid_dissipation: N,
    /// Plastic dissipation since the start by slip, and by the opening of an elastic-plastic layer, J/m².
    pub plastic_dissipation: N,
    /// Viscous dissipation since the start, J/m².
    pub viscous_dissipation: N,
    /// Stored shear energy that cracks have released by opening since the start, J/m².
    pub released_energy: N,
    /// Stored energy lost at fracture, J/m².
    pub fracture_energy: N,
}

impl<N: Number> FaceEnergy<N> {
    /// Zero energy and dissipation.
    pub const ZERO: Self = Self {
        kinetic: N::ZERO,
        stored: N::ZERO,
        fluid_kinetic: N::ZERO,
        fluid_stored: N::ZERO,
        fluid_dissipation: N::ZERO,
        plastic_dissipation: N::ZERO,
        viscous_dissipation: N::ZERO,
        released_energy: N::ZERO,
        fracture_energy: N::ZERO,
    };

    /// Returns energy plus dissipated energy, J/m². Its change in a step is the work done on the face.
    pub fn total(&self) -> N {
        let Self { kinetic, stored, fluid_kinetic, fluid_stored, .. } = *self;
        (kinetic + stored)
            + (fluid_kinetic + fluid_stored + self.fluid_dissipation)
            + ((self.plastic_dissipation + self.viscous_dissipation)
                + (self.released_energy + self.fracture_energy))
    }
}

/// Law of a face with `P` traction components: the normal one first, then the others.
///
/// Energy balance of every step Δt, to rounding errors: ΔE = Δt Σ (σ⁺v⁺ − σ⁻v⁻) with E of [`FaceEnergy::total`], summed
/// over the components; no dissipated energy decreases. So a face never adds energy to the adjacent cells.
pub trait FaceLaw<N: Number, const P: usize>: Copy {
    /// Number of history variables of a face.
    const HISTORY_VARIABLE_COUNT: usize;

    /// Sets the history variables to those of a stress-free face at the start of a simulation. `velocities` are those
    /// of the adjacent cells by component, lower side first, m/s.
    fn initialise(&self, velocities: &[[N; 2]; P], history: &mut [N]);

    /// Advances the face by a step: updates the history variables and returns the states on both sides by component,
    /// which give the fluxes.
    fn advance(
        &self,
        incoming: &[RiemannData<N>; P],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; P];

    /// Returns the energy of the face.
    fn energy(&self, history: &[N]) -> FaceEnergy<N>;
}

/// Power σ⁺v⁺ − σ⁻v⁻, W/m², supplied to a face by both adjacent cells, for one traction component.
#[inline(always)]
pub fn power<N: Number>([lower, upper]: &[FaceState<N>; 2]) -> N {
    upper.stress * upper.velocity - lower.stress * lower.velocity
}
