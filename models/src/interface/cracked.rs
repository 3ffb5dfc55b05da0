//! Cracked layer: a contact without tensile strength (Sadovskii & Sadovskaya, kind 6).
//!
//! The normal component is the porous law with b₀ = 0, θ₀ = 0 and b₁ = ρ′c₁′²: S_n = b₁ min(ε, 0), and the opening is
//! u = δ max(ε, 0). It conserves energy to rounding when the crack opens or closes. In a step in which the faces touch,
//! S_n,mid < 0, the shear is elastic, without slip or, with the friction k_s, limited by Coulomb's law:
//!
//! ```text
//! |S_t,mid| = min(|S̄_t|, −k_s S_n,mid),    slip rate λ = G_t(|S̄_t| − |S_t,mid|),    dissipated Δtλ|S_t,mid| ≥ 0,
//! ```
//!
//! and at the end of the step |S_t| ≤ −k_s S_n likewise. Slip does not open the crack: the friction of a contact is not
//! associated. In a step in which the crack is open throughout, S_t is set to zero before the step, which releases the
//! energy ½C_tS_t², and S_t,mid = 0. Faces that touch without normal traction count as open.

use super::history::{self, accumulate, read_motion, record_time, sum_value, write_motion};
use super::opening_line::OpeningLine;
use super::plastic::{ElasticTrial, abs, with_sign};
use super::porous::PorousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Result of a step of the tangential component of a crack: contact with Coulomb friction.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactStep<N> {
    /// Traction S_t at the midpoint, Pa.
    pub(super) midpoint_stress: N,
    /// Traction S_t at the end of the step, Pa.
    pub(super) end_stress: N,
    /// Slip in the step, m.
    pub(super) slip: N,
    /// Dissipation by friction, J/m².
    pub(super) dissipation: N,
    /// Elastic shear energy released by the opening of the crack, J/m².
    pub(super) released_energy: N,
}

impl<N: Number> ContactStep<N> {
    /// Computes the step from the shear traction `old_stress` at its beginning and the normal tractions at the
    /// midpoint and at the end; `friction` is `None` for faces that do not slip.
    #[inline(always)]
    pub(super) fn new(
        line: &OpeningLine<N>,
        compliance: N,
        friction: Option<N>,
        old_stress: N,
        [normal_midpoint_stress, normal_end_stress]: [N; 2],
        step: N,
    ) -> Self {
        let zero = N::ZERO;
        let pressure = -normal_midpoint_stress;
        let start_stress = pressure.select_gt(zero, old_stress, zero);
        let lost_stress = pressure.select_gt(zero, zero, old_stress);
        let released_energy = N::HALF * compliance * lost_stress * lost_stress;
        let trial = ElasticTrial::new(line, compliance, start_stress, step);
        let Some(friction) = friction else {
            let midpoint_stress = pressure.select_gt(zero, trial.stress, zero);
            let end_stress = midpoint_stress + midpoint_stress - start_stress;
            return Self {
                midpoint_stress,
                end_stress,
                slip: zero,
                dissipation: zero,
                released_energy,
            };
        };
        let trial_magnitude = abs(trial.stress);
        let midpoint_magnitude = trial_magnitude.min(friction * pressure.max(zero));
        let midpoint_stress = with_sign(midpoint_magnitude, trial.stress);
        let excess = pressure.select_gt(zero, trial_magnitude - midpoint_magnitude, zero);
        let midpoint_slip = step * trial.admittance * excess;
        let reflected_stress = midpoint_stress + midpoint_stress - start_stress;
        let reflected_magnitude = abs(reflected_stress);
        let end_magnitude = reflected_magnitude.min(friction * (-normal_end_stress).max(zero));
        let end_slip = compliance * (reflected_magnitude - end_magnitude);
        Self {
            midpoint_stress,
            end_stress: with_sign(end_magnitude, reflected_stress),
            slip: midpoint_slip + end_slip,
            dissipation: midpoint_slip * midpoint_magnitude
                + N::HALF * end_slip * (reflected_magnitude + end_magnitude),
            released_energy,
        }
    }
}

/// Law of a cracked layer: without tensile strength, with or without slip of closed faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackedLayer<N> {
    /// Law of the normal component, with the stiffness b₀ = 0 and the porosity θ₀ = 0.
    pub normal: PorousComponent<N>,
    /// Compliance C_t = δ/(ρ′c₂′²) > 0, m/Pa.
    pub shear_compliance: N,
    /// Friction k_s ≥ 0 of closed faces; `None` if they do not slip.
    pub friction: Option<N>,
}

impl<N: Number> CrackedLayer<N> {
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> CrackedLayer<M> {
        CrackedLayer {
            normal: self.normal.map(&f),
            shear_compliance: f(self.shear_compliance),
            friction: self.friction.map(&f),
        }
    }
}

impl<N: Number> FaceLaw<N, 2> for CrackedLayer<N> {
    const HISTORY_VARIABLE_COUNT: usize = history::FRACTURE_TIME;

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
        let (normal_midpoint_stress, normal_states) =
            self.normal.advance(incoming[0], N::ZERO, step, history);
        let normal_end_stress = self.normal.elasticity.stress(history[history::NORMAL_STATE]);
        let start_motion = read_motion(history, history::SHEAR_MOTION);
        let line = OpeningLine::new(incoming[1], self.normal.mass, start_motion, step);
        let shear = ContactStep::new(
            &line,
            self.shear_compliance,
            self.friction,
            history[history::SHEAR_STRESS],
            [normal_midpoint_stress, normal_end_stress],
            step,
        );
        history[history::SHEAR_STRESS] = shear.end_stress;
        accumulate(history, history::RELEASED_ENERGY, shear.released_energy);
        if self.friction.is_some() {
            history[history::SLIP] = history[history::SLIP] + shear.slip;
            record_time(history, history::SLIP_TIME, shear.slip, interval.end);
            accumulate(history, history::PLASTIC_DISSIPATION, shear.dissipation);
        }
        let layer_step = line.complete_step(shear.midpoint_stress);
        write_motion(history, history::SHEAR_MOTION, layer_step.motion);
        [normal_states, layer_step.states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let mass = self.normal.mass;
        let stress = history[history::SHEAR_STRESS];
        FaceEnergy {
            kinetic: mass.kinetic_energy(read_motion(history, history::NORMAL_MOTION))
                + mass.kinetic_energy(read_motion(history, history::SHEAR_MOTION)),
            stored: self.normal.elasticity.stored_energy(history[history::NORMAL_STATE])
                + N::HALF * self.shear_compliance * stress * stress,
            plastic_dissipation: sum_value(history, history::PLASTIC_DISSIPATION),
            released_energy: sum_value(history, history::RELEASED_ENERGY),
            ..FaceEnergy::ZERO
        }
    }
}
