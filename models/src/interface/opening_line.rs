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
pub const MOTION_VARIABLE_COUNT: usize = 2;

/// Mass per area of a layer, for one traction component.
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
    pub fn kinetic_energy(&self, [velocity, opening_rate]: [N; MOTION_VARIABLE_COUNT]) -> N {
        N::HALF * self.mass * velocity * velocity
            + N::HALF * self.opening_mass * opening_rate * opening_rate
    }
}

impl<N> LayerMass<N> {
    /// Converts both masses by the function `f`.
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

/// Returns the initial velocity and opening rate of a layer from the velocities v⁻ and v⁺ of the adjacent cells, m/s:
/// V = ½(v⁺ + v⁻), d = v⁺ − v⁻.
#[inline(always)]
pub fn initial_motion<N: Number>([lower, upper]: [N; 2]) -> [N; MOTION_VARIABLE_COUNT] {
    [N::HALF * (lower + upper), upper - lower]
}

/// Admissible states of the layer in a step: the line d = d₀′ − g′S of opening rate d against traction S, as derived in
/// the [module](self).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpeningLine<N> {
    incoming: RiemannData<N>,
    /// Reciprocal 1/a of the coefficient a = 2m/Δt + 2z⁺z⁻/z̄, m²s/kg.
    inverse_momentum_coefficient: N,
    /// Coefficient b = 2mV/Δt + R⁺ + R⁻ − ζ(R⁺ − R⁻), Pa, with V at the beginning of the step.
    impulse: N,
    /// Impedance contrast ζ = (z⁺ − z⁻)/(z⁺ + z⁻).
    impedance_contrast: N,
    /// Impedance ν = 2n/Δt of the opening mass n, kg/(m²s).
    opening_impedance: N,
    /// Velocity V and opening rate d at the beginning of the step, m/s.
    start_motion: [N; MOTION_VARIABLE_COUNT],
    /// Opening rate d₀′ at zero traction, m/s.
    pub free_opening_rate: N,
    /// Admittance g′ > 0 of the adjacent cells, m/(s Pa).
    pub admittance: N,
}

/// Result of the momentum balance of a step, for one traction component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerStep<N> {
    /// Velocity V and opening rate d at the end of the step, m/s.
    pub motion: [N; MOTION_VARIABLE_COUNT],
    /// Opening rate d at the midpoint of the step, m/s.
    pub opening_rate: N,
    /// States on both sides of the face.
    pub states: [FaceState<N>; 2],
}

impl<N: Number> OpeningLine<N> {
    /// Computes the opening line of a step of duration `step`, s, from V and d at its beginning. Divisors depend on
    /// impedances, mass and step only, and quotients are products with their reciprocals: over faces with the same
    /// constants the compiler moves all divisions out of the loop.
    #[inline(always)]
    pub fn new(
        incoming: RiemannData<N>,
        mass: LayerMass<N>,
        start_motion: [N; MOTION_VARIABLE_COUNT],
        step: N,
    ) -> Self {
        let [lower, upper] = incoming.impedance;
        let [from_lower, from_upper] = incoming.invariant;
        let inverse_sum = N::ONE / (upper + lower);
        let inverse_mean = inverse_sum + inverse_sum;
        let impedance_contrast = (upper - lower) * inverse_sum;
        let twice_impedance_contrast = impedance_contrast + impedance_contrast;
        let rate = (mass.mass + mass.mass) / step;
        let product = upper * lower * inverse_mean;
        let inverse_momentum_coefficient = N::ONE / (rate + (product + product));
        let difference = from_upper - from_lower;
        let impulse =
            rate * start_motion[0] + (from_upper + from_lower - impedance_contrast * difference);
        let free_opening_rate = difference * inverse_mean
            - twice_impedance_contrast * inverse_momentum_coefficient * impulse;
        let admittance = inverse_mean
            + inverse_mean
            + twice_impedance_contrast * twice_impedance_contrast * inverse_momentum_coefficient;
        let opening_impedance = (mass.opening_mass + mass.opening_mass) / step;
        let product = admittance * opening_impedance;
        let attenuation = N::ONE / (N::ONE + product);
        Self {
            incoming,
            inverse_momentum_coefficient,
            impulse,
            impedance_contrast,
            opening_impedance,
            start_motion,
            free_opening_rate: (free_opening_rate + product * start_motion[1]) * attenuation,
            admittance: admittance * attenuation,
        }
    }

    /// Computes the motion at the end of the step and the states on both sides from the traction S = `stress` of the
    /// layer at the midpoint, Pa.
    #[inline(always)]
    pub fn complete_step(&self, stress: N) -> LayerStep<N> {
        let opening_rate = self.free_opening_rate - self.admittance * stress;
        let mean = stress + self.opening_impedance * (opening_rate - self.start_motion[1]);
        let velocity = (self.impulse + (self.impedance_contrast + self.impedance_contrast) * mean)
            * self.inverse_momentum_coefficient;
        let half_opening = N::HALF * opening_rate;
        let [lower, upper] = [velocity - half_opening, velocity + half_opening];
        let RiemannData { impedance, invariant } = self.incoming;
        let states = [
            FaceState { velocity: lower, stress: impedance[0] * lower - invariant[0] },
            FaceState { velocity: upper, stress: invariant[1] - impedance[1] * upper },
        ];
        let motion = [
            velocity + velocity - self.start_motion[0],
            opening_rate + opening_rate - self.start_motion[1],
        ];
        LayerStep { motion, opening_rate, states }
    }
}
