//! Momentum balance of a thin layer with mass between two cells, by the midpoint rule, for one traction component.
//!
//! The mean velocity V = ½(v⁺ + v⁻) of a layer of mass m per area follows from the traction difference,
//!
//! ```text
//! m V̇ = σ⁺ − σ⁻,
//! ```
//!
//! and the material of the layer relates its traction S to the opening rate d = v⁺ − v⁻. The mass may be distributed in
//! two ways, which differ in the opening mass n:
//!
//! ```text
//! ½(σ⁺ + σ⁻) = S + n ḋ.
//! ```
//!
//! - **box**, n = 0: averages over both faces (box scheme, Preissmann 1961), dispersive but without numerical
//!   dissipation. It is valid for ωδ/c′ ≲ 1 at the angular frequency ω in a layer of thickness δ and wave speed c′;
//!   higher frequencies are transmitted with reversed sign, and an incident velocity step v₀ is first transmitted as
//!   −v₀ for a time of about m/2z with the impedance z of the cells;
//! - **lumped**, n = ¼m: half of the mass moves with each face, the material is between them. High frequencies are
//!   reflected; the limit for long waves is the same.
//!
//! With V and d at the midpoint of the step, z̄ = ½(z⁺ + z⁻) and ζ = (z⁺ − z⁻)/(z⁺ + z⁻), the Riemann invariants R± of
//! both sides and the momentum balance give, with T = ½(σ⁺ + σ⁻),
//!
//! ```text
//! d = d₀ − g T,          V = (b + 2ζT)/a,
//! a = 2m/Δt + 2z⁺z⁻/z̄,   b = 2mV_old/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻),
//! g = 2/z̄ + 4ζ²/a,       d₀ = (R⁺ − R⁻)/z̄ − 2ζb/a,
//! ```
//!
//! and with ν = 2n/Δt and T = S + ν(d − d_old)
//!
//! ```text
//! d = d₀′ − g′ S,        d₀′ = (d₀ + gν d_old)/(1 + gν),   g′ = g/(1 + gν).
//! ```
//!
//! The material law of the layer, a second relation between d and S, closes the system.

use super::{FaceState, RiemannData};
use crate::common::number::Number;

/// Number of history variables of the momentum balance of a component: velocity V and opening rate d, m/s, at the end
/// of the step; d is used only if the opening mass is not zero.
pub const INERTIA_VARIABLES: usize = 2;

/// Mass of a layer, for one traction component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerMass<N> {
    /// Mass per area m ≥ 0, kg/m².
    pub mass: N,
    /// Opening mass n per area, kg/m²: 0 for the box scheme, ¼m for lumped masses.
    pub opening_mass: N,
}

impl<N: Number> LayerMass<N> {
    /// Mass per area m, kg/m², distributed as in the box scheme.
    pub fn new_box(mass: N) -> Self {
        Self { mass, opening_mass: N::ZERO }
    }

    /// Mass per area m, kg/m², half of it at each face.
    pub fn new_lumped(mass: N) -> Self {
        Self { mass, opening_mass: N::QUARTER * mass }
    }

    /// Kinetic energy ½mV² + ½nd², J/m².
    #[inline(always)]
    pub fn kinetic_energy(&self, [velocity, opening_rate]: [N; INERTIA_VARIABLES]) -> N {
        N::HALF * self.mass * velocity * velocity
            + N::HALF * self.opening_mass * opening_rate * opening_rate
    }
}

impl<N> LayerMass<N> {
    /// Converts the masses by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> LayerMass<M> {
        LayerMass { mass: f(self.mass), opening_mass: f(self.opening_mass) }
    }
}

impl LayerMass<f64> {
    /// Converts the masses to the number type `N` (f32, f64 or SIMD lanes).
    pub fn to_number<N: Number>(self) -> LayerMass<N> {
        self.map(N::from_f64)
    }
}

/// Sets the history variables of the momentum balance to those of the adjacent cells at rest relative to the layer:
/// V = ½(v⁺ + v⁻), d = v⁺ − v⁻.
#[inline(always)]
pub fn initial_inertia<N: Number>([before, after]: [N; 2]) -> [N; INERTIA_VARIABLES] {
    [N::HALF * (before + after), after - before]
}

/// Admissible states of the layer in a step: the line d = d₀′ − g′S of opening rate d against traction S, as derived in
/// the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningLine<N> {
    incoming: RiemannData<N>,
    /// Reciprocal 1/a of the coefficient a = 2m/Δt + 2z⁺z⁻/z̄, m²s/kg.
    inverse_inertia: N,
    /// Coefficient b = 2mV/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻), Pa, with V at the beginning of the step.
    impulse: N,
    /// Impedance contrast ζ = (z⁺ − z⁻)/(z⁺ + z⁻).
    contrast: N,
    /// Rate ν = 2n/Δt, kg/(m²s).
    opening_inertia: N,
    /// V and d at the beginning of the step, m/s.
    old: [N; INERTIA_VARIABLES],
    /// Opening rate d₀′ at zero traction, m/s.
    pub free_rate: N,
    /// Admittance g′ > 0, m/(s Pa).
    pub admittance: N,
}

/// Result of the momentum balance of a step, for one traction component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerStep<N> {
    /// V and d at the end of the step, m/s.
    pub inertia: [N; INERTIA_VARIABLES],
    /// Opening rate d at the midpoint, m/s.
    pub opening_rate: N,
    /// States of both sides.
    pub states: [FaceState<N>; 2],
}

impl<N: Number> OpeningLine<N> {
    /// Computes the line of a step of duration `step`, s, from V and d at its beginning. Divisors depend on impedances,
    /// mass and step only, and quotients are products with their reciprocals: over faces with the same constants the
    /// compiler moves all divisions out of the loop.
    #[inline(always)]
    pub fn new(
        incoming: RiemannData<N>,
        mass: LayerMass<N>,
        old: [N; INERTIA_VARIABLES],
        step: N,
    ) -> Self {
        let [before, after] = incoming.impedance;
        let [from_before, from_after] = incoming.invariant;
        let inverse_sum = N::ONE / (after + before);
        let inverse_mean = inverse_sum + inverse_sum;
        let contrast = (after - before) * inverse_sum;
        let twice_contrast = contrast + contrast;
        let rate = (mass.mass + mass.mass) / step;
        let product = after * before * inverse_mean;
        let inverse_inertia = N::ONE / (rate + (product + product));
        let difference = from_after - from_before;
        let impulse = rate * old[0] + (from_after + from_before - contrast * difference);
        let free_rate = difference * inverse_mean - twice_contrast * inverse_inertia * impulse;
        let admittance =
            inverse_mean + inverse_mean + twice_contrast * twice_contrast * inverse_inertia;
        let opening_inertia = (mass.opening_mass + mass.opening_mass) / step;
        let product = admittance * opening_inertia;
        let share = N::ONE / (N::ONE + product);
        Self {
            incoming,
            inverse_inertia,
            impulse,
            contrast,
            opening_inertia,
            old,
            free_rate: (free_rate + product * old[1]) * share,
            admittance: admittance * share,
        }
    }

    /// Computes the end of the step for the traction `stress` S of the layer at the midpoint, Pa.
    #[inline(always)]
    pub fn finish(&self, stress: N) -> LayerStep<N> {
        let opening_rate = self.free_rate - self.admittance * stress;
        let mean = stress + self.opening_inertia * (opening_rate - self.old[1]);
        let velocity =
            (self.impulse + (self.contrast + self.contrast) * mean) * self.inverse_inertia;
        let half_opening = N::HALF * opening_rate;
        let [before, after] = [velocity - half_opening, velocity + half_opening];
        let RiemannData { impedance, invariant } = self.incoming;
        let states = [
            FaceState { velocity: before, stress: impedance[0] * before - invariant[0] },
            FaceState { velocity: after, stress: invariant[1] - impedance[1] * after },
        ];
        let inertia =
            [velocity + velocity - self.old[0], opening_rate + opening_rate - self.old[1]];
        LayerStep { inertia, opening_rate, states }
    }
}
