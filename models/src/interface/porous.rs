//! Porous layer: normal component whose pores collapse (Sadovskii & Sadovskaya, kind 4).
//!
//! Energy per volume of the layer and traction, with the strain ε across the layer and the porosity x = θ₀ + ε of open
//! pores,
//!
//! ```text
//! W = ½b₀ε² + ½b₁ min(x, 0)²,    S = ∂W/∂ε + S_ext,    d = δ ε̇,
//! ```
//!
//! where S_ext is the constant traction of a fluid, if any. A step uses the discrete gradient
//! S_mid = ΔW/Δε + S_ext (Gonzalez 1996), so that energy is conserved to rounding when pores collapse or open in a
//! step. With P = δ/Δt + ½gb₀, Q = g(b₀ε + S_ext) − d₀ and κ = gb₁ the change Δ of ε obeys PΔ + Q + κG = 0, where
//!
//! ```text
//! open:     G = 0,               Δ = −Q/P
//! closing:  G = (x + Δ)²/(2Δ),   Δ = −[Q + κx + √((Q + κx)² − 2(P + ½κ)κx²)]/(2P + κ)
//! closed:   G = x + ½Δ,          Δ = −(Q + κx)/(P + ½κ)
//! opening:  G = −x²/(2Δ),        Δ = κx²/(Q + h) if Q > 0, else (h − Q)/(2P),   h = √(Q² + 2Pκx²).
//! ```

use super::elastic::ElasticComponent;
use super::history::{self, read_motion, sum_value, write_motion};
use super::opening_line::{LayerMass, OpeningLine};
use super::plastic::{ElasticTrial, PlasticStep, YieldCone};
use super::viscous::ViscousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Elastic constants across a porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousElasticity<N> {
    /// Thickness δ > 0, m.
    pub thickness: N,
    /// Stiffness b₀ ≥ 0 with open pores, Pa.
    pub open_stiffness: N,
    /// Stiffness b₁ ≥ 0 added by collapsed pores, Pa.
    pub collapse_stiffness: N,
    /// Initial porosity θ₀ ≥ 0.
    pub porosity: N,
}

/// Change of the strain across a porous layer in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousStep<N> {
    /// Change Δ of the strain ε in the step.
    pub strain_change: N,
    /// Traction S_mid at the midpoint of the step, Pa: discrete gradient.
    pub midpoint_stress: N,
}

impl<N: Number> PorousElasticity<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> PorousElasticity<M> {
        PorousElasticity {
            thickness: f(self.thickness),
            open_stiffness: f(self.open_stiffness),
            collapse_stiffness: f(self.collapse_stiffness),
            porosity: f(self.porosity),
        }
    }

    /// Solves a step of duration `step`, s, on the opening line of the face, from the strain ε at its beginning and
    /// with the traction S_ext, Pa.
    #[inline(always)]
    pub fn solve(
        &self,
        line: &OpeningLine<N>,
        strain: N,
        external_stress: N,
        step: N,
    ) -> PorousStep<N> {
        let zero = N::ZERO;
        let g = line.admittance;
        let half_stiffness = N::HALF * self.open_stiffness;
        let p = self.thickness / step + g * half_stiffness;
        let q = g * (self.open_stiffness * strain + external_stress) - line.free_opening_rate;
        let kappa = g * self.collapse_stiffness;
        let x = self.porosity + strain;
        let kappa_x = kappa * x;
        let kappa_x_squared = kappa_x * x;
        let q_plus_kappa_x = q + kappa_x;
        // Coefficient of the quadratic equation of a step in which the pores close: 2P + κ.
        let two_p_plus_kappa = p + p + kappa;
        let inverse_coefficient = N::ONE / two_p_plus_kappa;

        let change_if_open = -q * (N::ONE / p);
        let root =
            (q_plus_kappa_x * q_plus_kappa_x - two_p_plus_kappa * kappa_x_squared).max(zero).sqrt();
        let change_if_closing = -(q_plus_kappa_x + root) * inverse_coefficient;
        let change_if_closed = -(q_plus_kappa_x + q_plus_kappa_x) * inverse_coefficient;
        let h = (q * q + (p + p) * kappa_x_squared).max(zero).sqrt();
        let sum = q.select_gt(zero, q + h, N::ONE);
        let change_if_opening =
            q.select_gt(zero, kappa_x_squared / sum, (h - q) * (N::ONE / (p + p)));

        // Positive if the pores are open at the beginning: x > 0, or x = 0 and Q ≤ 0.
        let sign_at_zero = q.select_gt(zero, -N::ONE, N::ONE);
        let start_sign = x.select_gt(zero, N::ONE, zero.select_gt(x, -N::ONE, sign_at_zero));
        let open_change = zero.select_gt(x + change_if_open, change_if_closing, change_if_open);
        let closed_change =
            (x + change_if_closed).select_gt(zero, change_if_opening, change_if_closed);
        let strain_change = start_sign.select_gt(zero, open_change, closed_change);

        let end = x + strain_change;
        let twice_change = strain_change + strain_change;
        let divisor = N::ONE / safe_divisor(twice_change);
        let gradient_from_open = zero.select_gt(x + change_if_open, end * end * divisor, zero);
        let gradient_from_closed =
            (x + change_if_closed).select_gt(zero, -(x * x * divisor), x + N::HALF * strain_change);
        let gradient = start_sign.select_gt(zero, gradient_from_open, gradient_from_closed);
        let midpoint_stress = self.open_stiffness * strain
            + half_stiffness * strain_change
            + self.collapse_stiffness * gradient
            + external_stress;
        PorousStep { strain_change, midpoint_stress }
    }

    /// Traction ∂W/∂ε = b₀ε + b₁ min(x, 0), Pa, without that of a fluid.
    #[inline(always)]
    pub fn stress(&self, strain: N) -> N {
        self.open_stiffness * strain
            + self.collapse_stiffness * (self.porosity + strain).min(N::ZERO)
    }

    /// Porosity θ = max(θ₀ + ε, 0).
    #[inline(always)]
    pub fn current_porosity(&self, strain: N) -> N {
        (self.porosity + strain).max(N::ZERO)
    }

    /// Stored energy δ(½b₀ε² + ½b₁ min(x, 0)²), J/m².
    #[inline(always)]
    pub fn stored_energy(&self, strain: N) -> N {
        let collapsed = (self.porosity + strain).min(N::ZERO);
        N::HALF
            * self.thickness
            * (self.open_stiffness * strain * strain
                + self.collapse_stiffness * collapsed * collapsed)
    }
}

/// Returns `x`, or 1 if `x` is zero or subnormal, so that its reciprocal is finite.
#[inline(always)]
fn safe_divisor<N: Number>(x: N) -> N {
    x.select_gt(N::MIN_POSITIVE, x, (-N::MIN_POSITIVE).select_gt(x, x, N::ONE))
}

/// Law of the normal component of a porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousComponent<N> {
    /// Mass per area of the layer.
    pub mass: LayerMass<N>,
    /// Elastic constants across the layer.
    pub elasticity: PorousElasticity<N>,
}

impl<N: Number> PorousComponent<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> PorousComponent<M> {
        PorousComponent { mass: self.mass.map(&f), elasticity: self.elasticity.map(&f) }
    }

    /// Advances the normal history variables by `step`, s, with the traction S_ext of a fluid, Pa; returns the traction
    /// S_mid, Pa, and the states on both sides.
    #[inline(always)]
    pub fn advance(
        &self,
        incoming: RiemannData<N>,
        external_stress: N,
        step: N,
        history: &mut [N],
    ) -> (N, [FaceState<N>; 2]) {
        let old = read_motion(history, history::NORMAL_MOTION);
        let line = OpeningLine::new(incoming, self.mass, old, step);
        let strain = history[history::NORMAL_STATE];
        let solution = self.elasticity.solve(&line, strain, external_stress, step);
        let layer_step = line.complete_step(solution.midpoint_stress);
        write_motion(history, history::NORMAL_MOTION, layer_step.motion);
        history[history::NORMAL_STATE] = strain + solution.strain_change;
        (solution.midpoint_stress, layer_step.states)
    }
}

/// Law of the tangential component of a porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialComponent<N> {
    /// Elastic shear.
    Elastic(ElasticComponent<N>),
    /// Viscous shear.
    Viscous(ViscousComponent<N>),
    /// Elastic-plastic shear without friction.
    Plastic(ElasticComponent<N>, YieldCone<N>),
}

impl<N: Number> TangentialComponent<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> TangentialComponent<M> {
        match self {
            Self::Elastic(elastic) => TangentialComponent::Elastic(elastic.map(f)),
            Self::Viscous(viscous) => TangentialComponent::Viscous(viscous.map(f)),
            Self::Plastic(elastic, cone) => {
                TangentialComponent::Plastic(elastic.map(&f), cone.map(&f))
            }
        }
    }

    /// Advances the tangential history variables by a step and returns the states on both sides.
    #[inline(always)]
    fn advance(
        &self,
        incoming: RiemannData<N>,
        interval: &Interval<N>,
        history: &mut [N],
    ) -> [FaceState<N>; 2] {
        match self {
            Self::Elastic(elastic) => {
                let start = history::SHEAR_MOTION;
                let mut shear = [history[start], history[start + 1], history[start + 2]];
                let states = elastic.advance(incoming, interval.tangential_step, &mut shear);
                history[start..start + shear.len()].copy_from_slice(&shear);
                states
            }
            Self::Viscous(viscous) => viscous.advance(incoming, interval.tangential_step, history),
            Self::Plastic(elastic, cone) => {
                advance_cohesive(elastic, cone, incoming, interval, history)
            }
        }
    }
}

/// Advances an elastic-plastic tangential component without friction, k_s = 0, and returns the states on both sides.
#[inline(always)]
fn advance_cohesive<N: Number>(
    elastic: &ElasticComponent<N>,
    cone: &YieldCone<N>,
    incoming: RiemannData<N>,
    interval: &Interval<N>,
    history: &mut [N],
) -> [FaceState<N>; 2] {
    let step = interval.tangential_step;
    let stress = history[history::SHEAR_STRESS];
    let old = read_motion(history, history::SHEAR_MOTION);
    let line = OpeningLine::new(incoming, elastic.mass, old, step);
    let trial = ElasticTrial::new(&line, elastic.compliance, stress, step);
    let normal = ElasticTrial { admittance: N::ONE, stress: N::ZERO };
    let result = PlasticStep::new(
        cone,
        [normal, trial],
        [N::ONE, elastic.compliance],
        [N::ZERO, stress],
        history[history::SLIP],
        step,
    );
    result.add_to_history(history, interval.end);
    let layer_step = line.complete_step(result.midpoint_stress[1]);
    write_motion(history, history::SHEAR_MOTION, layer_step.motion);
    history[history::SHEAR_STRESS] = result.end_stress[1];
    layer_step.states
}

/// Law of a porous layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PorousLayer<N> {
    /// Law of the normal component.
    pub normal: PorousComponent<N>,
    /// Law of the tangential component.
    pub shear: TangentialComponent<N>,
}

impl<N: Number> PorousLayer<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> PorousLayer<M> {
        PorousLayer { normal: self.normal.map(&f), shear: self.shear.map(&f) }
    }
}

impl<N: Number> FaceLaw<N, 2> for PorousLayer<N> {
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
        let (_, states) = self.normal.advance(incoming[0], N::ZERO, interval.step, history);
        [states, self.shear.advance(incoming[1], interval, history)]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let normal = read_motion(history, history::NORMAL_MOTION);
        let mass = self.normal.mass;
        let mut energy = FaceEnergy {
            kinetic: mass.kinetic_energy(normal)
                + mass.kinetic_energy(read_motion(history, history::SHEAR_MOTION)),
            ..FaceEnergy::ZERO
        };
        let stress = history[history::SHEAR_STRESS];
        let shear = match &self.shear {
            TangentialComponent::Elastic(elastic) => elastic.stored_energy(stress),
            TangentialComponent::Plastic(elastic, _) => {
                energy.plastic_dissipation = sum_value(history, history::PLASTIC_DISSIPATION);
                elastic.stored_energy(stress)
            }
            TangentialComponent::Viscous(viscous) => {
                energy.viscous_dissipation = sum_value(history, history::VISCOUS_DISSIPATION);
                viscous.stored_energy(history)
            }
        };
        energy.stored =
            self.normal.elasticity.stored_energy(history[history::NORMAL_STATE]) + shear;
        energy
    }
}
