//! Flow of the fluid along a saturated layer, a separate stage between the sweeps across the layers: Godunov's method
//! for the acoustic equations (Godunov 1959), and junctions of layers (Sadovskii & Sadovskaya, kind 5).
//!
//! With the velocity w of the fluid and its traction s = s₁₁ = −pθ along the layer (pore pressure p, porosity θ), at
//! fixed strain ε across the layer and with a skeleton free to move along it,
//!
//! ```text
//! ρ̂ ẇ = s,₁,   ṡ = b_f w,₁,   V̇₁ = ẇ ρ_a/(ρ_s + ρ_a),   Ṡ₂₂ = (b_s/b_f) ṡ,   ρ̂ = ρ_f + ρ_sρ_a/(ρ_s + ρ_a).
//! ```
//!
//! The impedance is z = √(ρ̂b_f), the wave speed c = √(b_f/ρ̂). Along the layer, zw − s propagates to larger and zw + s
//! to smaller coordinates. The history variable is the fluid strain D, with s = b_sε + b_fD, so the traction S₂₂ =
//! ∂W/∂ε follows.

use super::history::{self, accumulate};
use crate::common::number::Number;

/// Velocity and traction of the fluid at a point of a layer, or averaged over a step at a face between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidState<N> {
    /// Velocity w along the layer, m/s.
    pub velocity: N,
    /// Traction s₁₁ = −pθ, Pa.
    pub stress: N,
}

/// Constants of the flow of the fluid along a saturated layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidConstants<N> {
    /// Thickness δ, m.
    pub thickness: N,
    /// Effective density ρ̂ = ρ_f + ρ_sρ_a/(ρ_s + ρ_a), kg/m³.
    pub density: N,
    /// Stiffness b_f of the fluid, Pa.
    pub stiffness: N,
    /// Stiffness b_s that couples the strain across the layer and the fluid, Pa.
    pub coupling_stiffness: N,
    /// Impedance z = √(ρ̂b_f), kg/(m²s).
    pub impedance: N,
    /// Wave speed c = √(b_f/ρ̂), m/s.
    pub speed: N,
    /// Ratio ρ_a/(ρ_s + ρ_a) of the velocity change of the skeleton along the layer to that of the fluid.
    pub skeleton_share: N,
}

/// Side of a junction, or of an end of a layer, on which the layer lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmSide {
    /// The layer extends to smaller coordinates: the invariant zw − s arrives from it.
    Lower,
    /// The layer extends to larger coordinates: the invariant zw + s arrives from it.
    Upper,
}

/// A layer that ends at a junction: an arm of the junction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JunctionArm<N> {
    /// Side on which the layer lies.
    pub side: ArmSide,
    /// Porosity θ ≥ 0; 0 if the layer is closed or absent.
    pub porosity: N,
    /// Thickness D of the layer, m.
    pub thickness: N,
    /// Impedance z > 0 of the fluid in the layer, kg/(m²s).
    pub impedance: N,
    /// State of the fluid in the cell next to the junction.
    pub state: FluidState<N>,
}

impl<N: Number> FluidState<N> {
    /// Riemann invariant zw − s or zw + s, Pa, that arrives from a layer on `side` with the impedance z.
    #[inline(always)]
    pub fn invariant(&self, side: ArmSide, impedance: N) -> N {
        match side {
            ArmSide::Lower => impedance * self.velocity - self.stress,
            ArmSide::Upper => impedance * self.velocity + self.stress,
        }
    }

    /// Power s·w that the fluid transports to smaller coordinates, W/m².
    #[inline(always)]
    pub fn power(&self) -> N {
        self.stress * self.velocity
    }
}

/// Solves the Riemann problem between two cells of a layer, of equal or unequal impedances.
#[inline(always)]
pub fn solve_riemann<N: Number>(
    [lower, upper]: [FluidState<N>; 2],
    [lower_impedance, upper_impedance]: [N; 2],
) -> FluidState<N> {
    let from_lower = lower.invariant(ArmSide::Lower, lower_impedance);
    let from_upper = upper.invariant(ArmSide::Upper, upper_impedance);
    let sum = lower_impedance + upper_impedance;
    FluidState {
        velocity: (from_lower + from_upper) / sum,
        stress: (lower_impedance * from_upper - upper_impedance * from_lower) / sum,
    }
}

/// Solves for the state at an open end of a layer on `side`, where s = 0.
#[inline(always)]
pub fn solve_open_end<N: Number>(
    state: FluidState<N>,
    side: ArmSide,
    impedance: N,
) -> FluidState<N> {
    FluidState { velocity: state.invariant(side, impedance) / impedance, stress: N::ZERO }
}

/// Solves for the state at a closed end of a layer on `side`, where w = 0.
#[inline(always)]
pub fn solve_closed_end<N: Number>(
    state: FluidState<N>,
    side: ArmSide,
    impedance: N,
) -> FluidState<N> {
    let invariant = state.invariant(side, impedance);
    let stress = match side {
        ArmSide::Lower => -invariant,
        ArmSide::Upper => invariant,
    };
    FluidState { velocity: N::ZERO, stress }
}

/// Solves for the states at the ends of the arms of a junction and the pressure p, Pa, of the fluid there. With the
/// invariants R∓ of the arms on the lower and the upper side, thickness D, porosity θ and impedance z,
///
/// ```text
/// p = [Σ₋ DθR⁻/z − Σ₊ DθR⁺/z]/Σ Dθ²/z,   s = −pθ,   w = (R⁻ − pθ)/z or (R⁺ + pθ)/z.
/// ```
///
/// Volume flow Σ± Dθw and power Σ± Dsw balance. Arms with θ = 0 are closed; p = 0 if all arms are closed.
#[inline(always)]
pub fn solve_junction<N: Number, const A: usize>(
    arms: &[JunctionArm<N>; A],
) -> ([FluidState<N>; A], N) {
    let (mut supply, mut admittance) = (N::ZERO, N::ZERO);
    for arm in arms {
        let weight = arm.thickness * arm.porosity / arm.impedance;
        let invariant = arm.state.invariant(arm.side, arm.impedance);
        supply = match arm.side {
            ArmSide::Lower => supply + weight * invariant,
            ArmSide::Upper => supply - weight * invariant,
        };
        admittance = admittance + weight * arm.porosity;
    }
    let divisor = admittance.select_gt(N::ZERO, admittance, N::ONE);
    let pressure = admittance.select_gt(N::ZERO, supply / divisor, N::ZERO);
    let states = std::array::from_fn(|index| {
        let arm = &arms[index];
        let stress = -(pressure * arm.porosity);
        let invariant = arm.state.invariant(arm.side, arm.impedance);
        let outgoing = match arm.side {
            ArmSide::Lower => invariant + stress,
            ArmSide::Upper => invariant - stress,
        };
        FluidState { velocity: outgoing / arm.impedance, stress }
    });
    (states, pressure)
}

impl FluidConstants<f64> {
    /// Smallest number of equal sub-steps of a step Δt, s, for which the Courant number in cells of length Δx, m, is at
    /// most 1.
    pub fn count_substeps(&self, step: f64, cell_length: f64) -> usize {
        ((self.speed * step / cell_length) * (1.0 - 4.0 * f64::EPSILON)).ceil().max(1.0) as usize
    }
}

impl<N: Number> FluidConstants<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> FluidConstants<M> {
        FluidConstants {
            thickness: f(self.thickness),
            density: f(self.density),
            stiffness: f(self.stiffness),
            coupling_stiffness: f(self.coupling_stiffness),
            impedance: f(self.impedance),
            speed: f(self.speed),
            skeleton_share: f(self.skeleton_share),
        }
    }

    /// Traction s₁₁ = b_sε + b_fD of the history variables, Pa.
    #[inline(always)]
    pub fn stress(&self, history: &[N]) -> N {
        self.coupling_stiffness * history[history::NORMAL_STATE]
            + self.stiffness * history[history::FLUID_STRAIN]
    }

    /// State of the fluid in a cell of the layer.
    #[inline(always)]
    pub fn state(&self, history: &[N]) -> FluidState<N> {
        FluidState { velocity: history[history::FLUID_VELOCITY], stress: self.stress(history) }
    }

    /// Advances a cell of the layer, of length Δx, by Δt ≤ Δx/c, with `ratio` = Δt/Δx, s/m, and the states at its lower
    /// and its upper end. The numerical dissipation per face area is δC(1 − C)Σj²/(4zc) ≥ 0 with the Courant number
    /// C = cΔt/Δx and the differences j between the invariants zw ∓ s at the ends and in the cell, so that
    /// Δ(energy) + dissipation = δ(Δt/Δx)(s_upper w_upper − s_lower w_lower).
    #[inline(always)]
    pub fn advance_cell(&self, [lower, upper]: [FluidState<N>; 2], ratio: N, history: &mut [N]) {
        let z = self.impedance;
        let cell = self.state(history);
        let courant = self.speed * ratio;
        let from_lower = lower.invariant(ArmSide::Lower, z) - cell.invariant(ArmSide::Lower, z);
        let from_upper = upper.invariant(ArmSide::Upper, z) - cell.invariant(ArmSide::Upper, z);
        let square = from_lower * from_lower + from_upper * from_upper;
        let dissipation =
            self.thickness * courant * (N::ONE - courant) * N::QUARTER * square / self.stiffness;
        let change = ratio * (upper.stress - lower.stress) / self.density;
        let strain = ratio * (upper.velocity - lower.velocity);
        let skeleton = history::SHEAR_MOTION;
        history[skeleton] = history[skeleton] + self.skeleton_share * change;
        history[history::FLUID_VELOCITY] = history[history::FLUID_VELOCITY] + change;
        history[history::FLUID_STRAIN] = history[history::FLUID_STRAIN] + strain;
        accumulate(history, history::FLUID_DISSIPATION, dissipation);
    }
}
