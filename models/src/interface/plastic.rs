//! Elastic-plastic layer: slip and opening with associated flow (Sadovskii & Sadovskaya, kind 2).
//!
//! The tractions S = (S_n, S_t) stay in the cone, or for k_s = 0 the strip,
//!
//! ```text
//! F = { |S_t| + k_s S_n ≤ τ },    τ = τ_s + Hχ,
//! ```
//!
//! with the slip χ, and the opening rate is elastic plus plastic, d = C Ṡ + λ ∂f/∂S with χ̇ = λ ≥ 0. A step is the
//! midpoint rule: the elastic trial S̄ of each component, with G = 2C/Δt + g, is returned to F in the norm of G:
//!
//! ```text
//! λ = (|S̄_t| + k_s S̄_n − τ)/(1/G_t + k_s²/G_n + h),   S_n = S̄_n − λk_s/G_n,   |S_t| = |S̄_t| − λ/G_t,
//! apex:  S_t = 0,   λ = (S̄_n − τ/k_s)/(k_s/G_n + h/k_s),   S_n = (τ + hλ)/k_s,
//! ```
//!
//! with h = ½HΔt. It dissipates Δtλ(τ + hλ) ≥ 0. The traction at the end of the step, 2S_mid − S, may leave F: it is
//! returned likewise with C in the place of G, h = H and the slip μ in the place of λ, which dissipates
//! μ(τ + Hμ) + ½Σ C (ΔS)² ≥ 0.

use super::history::{self, accumulate, inertia, record_time, set_inertia, sum_value};
use super::opening_line::{LayerMass, OpeningLine};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Absolute value.
#[inline(always)]
pub(super) fn abs<N: Number>(x: N) -> N {
    x.max(-x)
}

/// `size` with the sign of `x`; the sign of zero is positive.
#[inline(always)]
pub(super) fn with_sign<N: Number>(size: N, x: N) -> N {
    N::ZERO.select_gt(x, -size, size)
}

/// Yield condition |S_t| + k_s S_n ≤ τ_s + Hχ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct YieldCone<N> {
    /// Shear strength τ_s ≥ 0, Pa.
    pub strength: N,
    /// Friction k_s ≥ 0.
    pub friction: N,
    /// Slip hardening H ≥ 0, Pa/m.
    pub hardening: N,
}

/// Traction returned to a yield cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReturnedTraction<N> {
    /// Returned tractions S_n and S_t.
    pub stress: [N; 2],
    /// Multiplier λ ≥ 0.
    pub multiplier: N,
    /// Strength τ + hλ ≥ 0, Pa.
    pub strength: N,
}

impl<N: Number> YieldCone<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> YieldCone<M> {
        YieldCone {
            strength: f(self.strength),
            friction: f(self.friction),
            hardening: f(self.hardening),
        }
    }

    /// Strength τ_s + Hχ at the slip χ, Pa.
    #[inline(always)]
    pub fn strength_at(&self, slip: N) -> N {
        self.strength + self.hardening * slip
    }

    /// Returns the tractions `trial` (normal, tangential) to the cone of strength `strength` τ + hλ in the norm of
    /// `stiffness` G > 0, where `hardening` is h.
    #[inline(always)]
    pub fn return_traction(
        &self,
        trial: [N; 2],
        stiffness: [N; 2],
        strength: N,
        hardening: N,
    ) -> ReturnedTraction<N> {
        let [normal, shear] = trial;
        let size = abs(shear);
        let [soft_normal, soft_shear] = [N::ONE / stiffness[0], N::ONE / stiffness[1]];
        let k = self.friction;
        let excess = (size + k * normal - strength).max(N::ZERO);
        let multiplier = excess * (N::ONE / (soft_shear + k * k * soft_normal + hardening));
        let reduced = size - multiplier * soft_shear;
        // The apex exists for k > 0 only; else its formulas are evaluated with k = 1 and not used.
        let slope = k.select_gt(N::ZERO, k, N::ONE);
        let inverse_slope = N::ONE / slope;
        let apex_excess = (normal - strength * inverse_slope).max(N::ZERO);
        let apex_multiplier =
            apex_excess * (N::ONE / (slope * soft_normal + hardening * inverse_slope));
        let apex_strength = strength + hardening * apex_multiplier;
        let beyond = k.select_gt(N::ZERO, -reduced, N::ZERO);
        let new_strength = strength + hardening * multiplier;
        let regular_normal = normal - multiplier * k * soft_normal;
        // Without rounding errors the limit is reached if λ > 0.
        let limit = new_strength - k * regular_normal;
        let regular_size = reduced.min(limit).max(N::ZERO);
        let size = beyond.select_gt(N::ZERO, N::ZERO, regular_size);
        ReturnedTraction {
            stress: [
                beyond.select_gt(N::ZERO, apex_strength * inverse_slope, regular_normal),
                with_sign(size, shear),
            ],
            multiplier: beyond.select_gt(N::ZERO, apex_multiplier, multiplier),
            strength: beyond.select_gt(N::ZERO, apex_strength, new_strength),
        }
    }
}

/// Elastic trial of a component in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElasticTrial<N> {
    /// Stiffness G = 2C/Δt + g, m/(s Pa).
    pub(super) stiffness: N,
    /// Trial traction S̄ at the midpoint, Pa.
    pub(super) stress: N,
}

impl<N: Number> ElasticTrial<N> {
    /// S̄ = (2CS/Δt + d₀)/G.
    #[inline(always)]
    pub(super) fn new(line: &OpeningLine<N>, compliance: N, old: N, step: N) -> Self {
        let rate = (compliance + compliance) / step;
        let stiffness = rate + line.admittance;
        Self { stiffness, stress: (rate * old + line.free_rate) * (N::ONE / stiffness) }
    }
}

/// Result of the plastic midpoint rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlasticStep<N> {
    /// Tractions at the midpoint, Pa.
    pub(super) middle: [N; 2],
    /// Tractions at the end of the step, Pa.
    pub(super) stress: [N; 2],
    /// Slip in the step, m.
    pub(super) slip: N,
    /// Dissipation in the step, J/m².
    pub(super) dissipation: N,
}

impl<N: Number> PlasticStep<N> {
    /// Computes the step from the elastic trials, the tractions `old` and the slip at its beginning.
    #[inline(always)]
    pub(super) fn new(
        cone: &YieldCone<N>,
        trials: [ElasticTrial<N>; 2],
        compliance: [N; 2],
        old: [N; 2],
        slip: N,
        step: N,
    ) -> Self {
        let half_hardening = N::HALF * step * cone.hardening;
        let middle = cone.return_traction(
            [trials[0].stress, trials[1].stress],
            [trials[0].stiffness, trials[1].stiffness],
            cone.strength_at(slip),
            half_hardening,
        );
        let middle_slip = step * middle.multiplier;
        let mut reflected = middle.stress;
        for i in 0..2 {
            reflected[i] = middle.stress[i] + middle.stress[i] - old[i];
        }
        let end = cone.return_traction(
            reflected,
            compliance,
            cone.strength_at(slip + middle_slip),
            cone.hardening,
        );
        let mut losses = [N::ZERO; 2];
        for i in 0..2 {
            let change = reflected[i] - end.stress[i];
            losses[i] = N::HALF * compliance[i] * change * change;
        }
        Self {
            middle: middle.stress,
            stress: end.stress,
            slip: middle_slip + end.multiplier,
            dissipation: middle_slip * middle.strength
                + (end.multiplier * end.strength + (losses[0] + losses[1])),
        }
    }

    /// Adds slip and dissipation to the history variables.
    #[inline(always)]
    pub(super) fn record(&self, history: &mut [N], end: N) {
        history[history::SLIP] = history[history::SLIP] + self.slip;
        record_time(history, history::SLIP_TIME, self.slip, end);
        accumulate(history, history::PLASTIC, self.dissipation);
    }
}

/// Elastic-plastic layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticLayer<N> {
    /// Mass of the layer.
    pub mass: LayerMass<N>,
    /// Compliances C_n and C_t > 0, m/Pa.
    pub compliance: [N; 2],
    /// Yield condition.
    pub cone: YieldCone<N>,
}

impl<N: Number> PlasticLayer<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> PlasticLayer<M> {
        PlasticLayer {
            mass: self.mass.map(&f),
            compliance: self.compliance.map(&f),
            cone: self.cone.map(&f),
        }
    }
}

impl<N: Number> FaceLaw<N, 2> for PlasticLayer<N> {
    const HISTORY_VARIABLES: usize = history::RELEASED;

    fn initialise(&self, velocities: &[[N; 2]; 2], history: &mut [N]) {
        history::initialise(velocities, history);
    }

    #[inline(always)]
    fn advance(
        &self,
        incoming: &[RiemannData<N>; 2],
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [[FaceState<N>; 2]; 2] {
        let step = interval.step;
        let starts = [history::NORMAL_INERTIA, history::SHEAR_INERTIA];
        let old = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let lines = [
            OpeningLine::new(incoming[0], self.mass, inertia(history, starts[0]), step),
            OpeningLine::new(incoming[1], self.mass, inertia(history, starts[1]), step),
        ];
        let trials = [
            ElasticTrial::new(&lines[0], self.compliance[0], old[0], step),
            ElasticTrial::new(&lines[1], self.compliance[1], old[1], step),
        ];
        let slip = history[history::SLIP];
        let result = PlasticStep::new(&self.cone, trials, self.compliance, old, slip, step);
        result.record(history, interval.end);
        history[history::NORMAL_STATE] = result.stress[0];
        history[history::SHEAR_STRESS] = result.stress[1];
        let moved = [lines[0].finish(result.middle[0]), lines[1].finish(result.middle[1])];
        for i in 0..2 {
            set_inertia(history, starts[i], moved[i].inertia);
        }
        [moved[0].states, moved[1].states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let stress = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let [normal, shear] =
            std::array::from_fn(|i| N::HALF * self.compliance[i] * stress[i] * stress[i]);
        FaceEnergy {
            kinetic: self.mass.kinetic_energy(inertia(history, history::NORMAL_INERTIA))
                + self.mass.kinetic_energy(inertia(history, history::SHEAR_INERTIA)),
            stored: normal + shear,
            plastic: sum_value(history, history::PLASTIC),
            ..FaceEnergy::ZERO
        }
    }
}
