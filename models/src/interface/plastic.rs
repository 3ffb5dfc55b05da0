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

use super::history::{self, accumulate, read_motion, record_time, sum_value, write_motion};
use super::opening_line::{LayerMass, OpeningLine};
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Absolute value of `x`.
#[inline(always)]
pub(super) fn abs<N: Number>(x: N) -> N {
    x.max(-x)
}

/// Returns `magnitude` with the sign of `x`; the sign of zero is positive.
#[inline(always)]
pub(super) fn with_sign<N: Number>(magnitude: N, x: N) -> N {
    N::ZERO.select_gt(x, -magnitude, magnitude)
}

/// Yield cone |S_t| + k_s S_n ≤ τ_s + Hχ of the tractions of a layer, with the slip χ.
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
    /// Returned tractions S_n and S_t, Pa.
    pub stress: [N; 2],
    /// Plastic multiplier λ ≥ 0: slip rate, m/s, or slip, m.
    pub multiplier: N,
    /// Strength τ + hλ ≥ 0, Pa.
    pub strength: N,
}

impl<N: Number> YieldCone<N> {
    /// Converts every constant by the function `f`.
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
    pub fn hardened_strength(&self, slip: N) -> N {
        self.strength + self.hardening * slip
    }

    /// Returns the tractions `trial` (normal, tangential) to the cone of strength `strength` τ + hλ in the norm
    /// with the `weights` G > 0 (admittances 2C/Δt + g or compliances C), where `hardening` is h.
    #[inline(always)]
    pub fn return_traction(
        &self,
        trial: [N; 2],
        weights: [N; 2],
        strength: N,
        hardening: N,
    ) -> ReturnedTraction<N> {
        let [normal, shear] = trial;
        let magnitude = abs(shear);
        let [normal_stiffness, shear_stiffness] = [N::ONE / weights[0], N::ONE / weights[1]];
        let k = self.friction;
        let excess = (magnitude + k * normal - strength).max(N::ZERO);
        let multiplier =
            excess * (N::ONE / (shear_stiffness + k * k * normal_stiffness + hardening));
        let reduced_magnitude = magnitude - multiplier * shear_stiffness;
        // The apex exists for k > 0 only; else its formulas are evaluated with k = 1 and not used.
        let apex_friction = k.select_gt(N::ZERO, k, N::ONE);
        let inverse_apex_friction = N::ONE / apex_friction;
        let apex_excess = (normal - strength * inverse_apex_friction).max(N::ZERO);
        let apex_multiplier = apex_excess
            * (N::ONE / (apex_friction * normal_stiffness + hardening * inverse_apex_friction));
        let apex_strength = strength + hardening * apex_multiplier;
        let is_beyond_apex = k.select_gt(N::ZERO, -reduced_magnitude, N::ZERO);
        let new_strength = strength + hardening * multiplier;
        let regular_normal = normal - multiplier * k * normal_stiffness;
        // Without rounding errors the limit is reached if λ > 0.
        let max_magnitude = new_strength - k * regular_normal;
        let regular_magnitude = reduced_magnitude.min(max_magnitude).max(N::ZERO);
        let returned_magnitude = is_beyond_apex.select_gt(N::ZERO, N::ZERO, regular_magnitude);
        ReturnedTraction {
            stress: [
                is_beyond_apex.select_gt(
                    N::ZERO,
                    apex_strength * inverse_apex_friction,
                    regular_normal,
                ),
                with_sign(returned_magnitude, shear),
            ],
            multiplier: is_beyond_apex.select_gt(N::ZERO, apex_multiplier, multiplier),
            strength: is_beyond_apex.select_gt(N::ZERO, apex_strength, new_strength),
        }
    }
}

/// Elastic trial of a traction component in a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct ElasticTrial<N> {
    /// Admittance G = 2C/Δt + g of the layer and the adjacent cells, m/(s Pa).
    pub(super) admittance: N,
    /// Trial traction S̄ at the midpoint, Pa.
    pub(super) stress: N,
}

impl<N: Number> ElasticTrial<N> {
    /// Computes the trial S̄ = (2CS/Δt + d₀)/G from the traction S = `old_stress`, Pa, at the beginning of the step.
    #[inline(always)]
    pub(super) fn new(line: &OpeningLine<N>, compliance: N, old_stress: N, step: N) -> Self {
        let rate = (compliance + compliance) / step;
        let admittance = rate + line.admittance;
        let stress = (rate * old_stress + line.free_opening_rate) * (N::ONE / admittance);
        Self { admittance, stress }
    }
}

/// Result of a step by the plastic midpoint rule.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlasticStep<N> {
    /// Tractions S_n and S_t at the midpoint of the step, Pa.
    pub(super) midpoint_stress: [N; 2],
    /// Tractions S_n and S_t at the end of the step, Pa.
    pub(super) end_stress: [N; 2],
    /// Slip in the step, m.
    pub(super) slip: N,
    /// Dissipation in the step, J/m².
    pub(super) dissipation: N,
}

impl<N: Number> PlasticStep<N> {
    /// Computes the step from the elastic trials, the tractions `old_stress` and the slip at its beginning.
    #[inline(always)]
    pub(super) fn new(
        cone: &YieldCone<N>,
        trials: [ElasticTrial<N>; 2],
        compliance: [N; 2],
        old_stress: [N; 2],
        slip: N,
        step: N,
    ) -> Self {
        let half_hardening = N::HALF * step * cone.hardening;
        let midpoint = cone.return_traction(
            [trials[0].stress, trials[1].stress],
            [trials[0].admittance, trials[1].admittance],
            cone.hardened_strength(slip),
            half_hardening,
        );
        let midpoint_slip = step * midpoint.multiplier;
        let mut reflected_stress = midpoint.stress;
        for i in 0..2 {
            reflected_stress[i] = midpoint.stress[i] + midpoint.stress[i] - old_stress[i];
        }
        let end = cone.return_traction(
            reflected_stress,
            compliance,
            cone.hardened_strength(slip + midpoint_slip),
            cone.hardening,
        );
        let mut losses = [N::ZERO; 2];
        for i in 0..2 {
            let change = reflected_stress[i] - end.stress[i];
            losses[i] = N::HALF * compliance[i] * change * change;
        }
        Self {
            midpoint_stress: midpoint.stress,
            end_stress: end.stress,
            slip: midpoint_slip + end.multiplier,
            dissipation: midpoint_slip * midpoint.strength
                + (end.multiplier * end.strength + (losses[0] + losses[1])),
        }
    }

    /// Adds the slip and the dissipation of the step to the history variables; `end` is the time at its end, s.
    #[inline(always)]
    pub(super) fn add_to_history(&self, history: &mut [N], end: N) {
        history[history::SLIP] = history[history::SLIP] + self.slip;
        record_time(history, history::SLIP_TIME, self.slip, end);
        accumulate(history, history::PLASTIC_DISSIPATION, self.dissipation);
    }
}

/// Law of an elastic-plastic layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlasticLayer<N> {
    /// Mass per area of the layer.
    pub mass: LayerMass<N>,
    /// Compliances C_n and C_t > 0, m/Pa.
    pub compliance: [N; 2],
    /// Yield condition of both tractions.
    pub cone: YieldCone<N>,
}

impl<N: Number> PlasticLayer<N> {
    /// Converts every constant by the function `f`.
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
    const HISTORY_VARIABLE_COUNT: usize = history::RELEASED_ENERGY;

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
        let motion_starts = [history::NORMAL_MOTION, history::SHEAR_MOTION];
        let old = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let start_motions =
            [read_motion(history, motion_starts[0]), read_motion(history, motion_starts[1])];
        let opening_lines = [
            OpeningLine::new(incoming[0], self.mass, start_motions[0], step),
            OpeningLine::new(incoming[1], self.mass, start_motions[1], step),
        ];
        let trials = [
            ElasticTrial::new(&opening_lines[0], self.compliance[0], old[0], step),
            ElasticTrial::new(&opening_lines[1], self.compliance[1], old[1], step),
        ];
        let slip = history[history::SLIP];
        let result = PlasticStep::new(&self.cone, trials, self.compliance, old, slip, step);
        result.add_to_history(history, interval.end);
        history[history::NORMAL_STATE] = result.end_stress[0];
        history[history::SHEAR_STRESS] = result.end_stress[1];
        let layer_steps = [
            opening_lines[0].complete_step(result.midpoint_stress[0]),
            opening_lines[1].complete_step(result.midpoint_stress[1]),
        ];
        for i in 0..2 {
            write_motion(history, motion_starts[i], layer_steps[i].motion);
        }
        [layer_steps[0].states, layer_steps[1].states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let stress = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let [normal, shear] =
            std::array::from_fn(|i| N::HALF * self.compliance[i] * stress[i] * stress[i]);
        FaceEnergy {
            kinetic: self.mass.kinetic_energy(read_motion(history, history::NORMAL_MOTION))
                + self.mass.kinetic_energy(read_motion(history, history::SHEAR_MOTION)),
            stored: normal + shear,
            plastic_dissipation: sum_value(history, history::PLASTIC_DISSIPATION),
            ..FaceEnergy::ZERO
        }
    }
}
