//! A thin layer with mass between the two sides of a face, by the midpoint rule.
//!
//! The mean velocity V = ½(v⁺ + v⁻) of a layer of mass m per area is driven by the difference of tractions,
//!
//! ```text
//! m V̇ = σ⁺ − σ⁻,
//! ```
//!
//! and the material of the layer relates S = ½(σ⁺ + σ⁻) to the rate of its opening d = v⁺ − v⁻. This is the box closure:
//! mean values of both faces, no dissipation of its own, dispersive (Preissmann 1961). It holds for ωδ/c′ ≲ 1 in a
//! layer of thickness δ and wave speed c′: higher frequencies pass with their sign reversed, and a step of velocity v₀ that
//! arrives begins behind the layer with −v₀ for a time of m/2z.
//!
//! With V and S at the middle of the step, z̄ = ½(z⁺ + z⁻) and ζ = (z⁺ − z⁻)/(z⁺ + z⁻), the equations of both sides and
//! the balance of momentum leave the layer
//!
//! ```text
//! d = d₀ − g S,          V = (b + 2ζS)/a,
//! a = 2m/Δt + 2z⁺z⁻/z̄,   b = 2mV_old/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻),
//! g = 2/z̄ + 4ζ²/a,       d₀ = (R⁺ − R⁻)/z̄ − 2ζb/a:
//! ```
//!
//! all that it knows of them.

use super::{FaceState, Incoming};
use crate::common::number::Number;

/// The line d = d₀ − gS that both sides and the mass leave the material of the layer in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningLine<N> {
    incoming: Incoming<N>,
    /// a, kg/(m²s).
    inertia: N,
    /// b, Pa.
    impulse: N,
    /// ζ.
    contrast: N,
    /// d₀: rate of opening of a layer without stress, m/s.
    pub free_rate: N,
    /// g > 0, m/(s Pa).
    pub admittance: N,
}

impl<N: Number> OpeningLine<N> {
    /// Of a layer of mass m ≥ 0 (kg/m²) that moved with V (m/s) at the beginning of a step of Δt (s).
    #[inline(always)]
    pub fn new(incoming: Incoming<N>, mass: N, velocity: N, step: N) -> Self {
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

    /// V in the middle of the step, and both faces, where the mean traction is S.
    #[inline(always)]
    pub fn states(&self, stress: N) -> (N, [FaceState<N>; 2]) {
        let velocity = (self.impulse + (self.contrast + self.contrast) * stress) / self.inertia;
        let half_opening = N::HALF * (self.free_rate - self.admittance * stress);
        let [before, after] = [velocity - half_opening, velocity + half_opening];
        let Incoming { impedance, invariant } = self.incoming;
        let states = [
            FaceState { velocity: before, stress: impedance[0] * before - invariant[0] },
            FaceState { velocity: after, stress: invariant[1] - impedance[1] * after },
        ];
        (velocity, states)
    }
}
