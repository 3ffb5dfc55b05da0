//! Face law of a thin layer with mass between two cells, by the midpoint rule.
//!
//! The mean velocity V = ½(v⁺ + v⁻) of a layer of mass m per area follows from the traction difference,
//!
//! ```text
//! m V̇ = σ⁺ − σ⁻,
//! ```
//!
//! and the material of the layer relates the mean traction S = ½(σ⁺ + σ⁻) to the opening rate d = v⁺ − v⁻. This is the
//! box scheme (Preissmann 1961): averages over both faces, dispersive but without numerical dissipation. It is valid
//! for ωδ/c′ ≲ 1 at the angular frequency ω in a layer of thickness δ and wave speed c′; higher frequencies are
//! transmitted with reversed sign, and an incident velocity step v₀ is first transmitted as −v₀ for a time of about
//! m/2z with the impedance z of the cells.
//!
//! With V and S at the midpoint of the step, z̄ = ½(z⁺ + z⁻) and ζ = (z⁺ − z⁻)/(z⁺ + z⁻), the Riemann invariants R± of
//! both sides and the momentum balance give
//!
//! ```text
//! d = d₀ − g S,          V = (b + 2ζS)/a,
//! a = 2m/Δt + 2z⁺z⁻/z̄,   b = 2mV_old/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻),
//! g = 2/z̄ + 4ζ²/a,       d₀ = (R⁺ − R⁻)/z̄ − 2ζb/a.
//! ```
//!
//! The material law of the layer, a second relation between d and S, closes the system.

use super::{FaceState, RiemannData};
use crate::common::number::Number;

/// Admissible states of the layer in a step: the line d = d₀ − gS of opening rate d against mean traction S, as derived
/// in the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningLine<N> {
    incoming: RiemannData<N>,
    /// Coefficient a = 2m/Δt + 2z⁺z⁻/z̄, kg/(m²s).
    inertia: N,
    /// Coefficient b = 2mV/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻), Pa, with V at the beginning of the step.
    impulse: N,
    /// Impedance contrast ζ = (z⁺ − z⁻)/(z⁺ + z⁻).
    contrast: N,
    /// Opening rate d₀ at zero traction, m/s.
    pub free_rate: N,
    /// Admittance g = 2/z̄ + 4ζ²/a > 0, m/(s Pa).
    pub admittance: N,
}

impl<N: Number> OpeningLine<N> {
    /// Computes the line of a step: `mass` m ≥ 0 in kg/m², `velocity` V at the beginning of the step in m/s, `step` Δt
    /// in s.
    #[inline(always)]
    pub fn new(incoming: RiemannData<N>, mass: N, velocity: N, step: N) -> Self {
        let [before, after] = incoming.impedance;
        let [from_before, from_after] = incoming.invariant;
        let mean = N::HALF * (after + before);
        let contrast = (after - before) / (after + before);
        let twice_contrast = contrast + contrast;
        let rate = (mass + mass) / step;
        let product = after * before / mean;
        let inertia = rate + (product + product);
        let difference = from_after - from_before;
        let impulse = rate * velocity + (from_after + from_before - contrast * difference);
        Self {
            incoming,
            inertia,
            impulse,
            contrast,
            free_rate: difference / mean - twice_contrast * impulse / inertia,
            admittance: (N::ONE + N::ONE) / mean + twice_contrast * twice_contrast / inertia,
        }
    }

    /// Computes the velocity V at the midpoint, m/s, and the states of both sides for the mean traction `stress` S, Pa.
    #[inline(always)]
    pub fn states(&self, stress: N) -> (N, [FaceState<N>; 2]) {
        let velocity = (self.impulse + (self.contrast + self.contrast) * stress) / self.inertia;
        let half_opening = N::HALF * (self.free_rate - self.admittance * stress);
        let [before, after] = [velocity - half_opening, velocity + half_opening];
        let RiemannData { impedance, invariant } = self.incoming;
        let states = [
            FaceState { velocity: before, stress: impedance[0] * before - invariant[0] },
            FaceState { velocity: after, stress: invariant[1] - impedance[1] * after },
        ];
        (velocity, states)
    }
}
