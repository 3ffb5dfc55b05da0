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

use super::history::{self, accumulate, inertia, record_time, set_inertia, sum_value};
use super::opening_line::OpeningLine;
use super::plastic::{ElasticTrial, abs, with_sign};
use super::porous::PorousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Result of a step of the shear of a contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactStep<N> {
    /// Traction S_t at the midpoint, Pa.
    pub(super) middle: N,
    /// Traction S_t at the end of the step, Pa.
    pub(super) stress: N,
    /// Slip in the step, m.
    pub(super) slip: N,
    /// Dissipation by friction, J/m².
    pub(super) dissipation: N,
    /// Released energy, J/m².
    pub(super) released: N,
}

impl<N: Number> ContactStep<N> {
    /// Computes the step from the traction `old` at its beginning and the normal tractions at the midpoint and at the
    /// end; `friction` is `None` for faces that do not slip.
    #[inline(always)]
    pub(super) fn new(
        line: &OpeningLine<N>,
        compliance: N,
        friction: Option<N>,
        old: N,
        [normal_middle, normal_end]: [N; 2],
        step: N,
    ) -> Self {
        let zero = N::ZERO;
        let pressure = -normal_middle;
        let start = pressure.select_gt(zero, old, zero);
        let lost = pressure.select_gt(zero, zero, old);
        let released = N::HALF * compliance * lost * lost;
        let trial = ElasticTrial::new(line, compliance, start, step);
        let Some(friction) = friction else {
            let middle = pressure.select_gt(zero, trial.stress, zero);
            let stress = middle + middle - start;
            return Self { middle, stress, slip: zero, dissipation: zero, released };
        };
        let size = abs(trial.stress);
        let middle_size = size.min(friction * pressure.max(zero));
        let middle = with_sign(middle_size, trial.stress);
        let excess = pressure.select_gt(zero, size - middle_size, zero);
        let middle_slip = step * trial.stiffness * excess;
        let reflected = middle + middle - start;
        let reflected_size = abs(reflected);
        let end_size = reflected_size.min(friction * (-normal_end).max(zero));
        let end_slip = compliance * (reflected_size - end_size);
        Self {
            middle,
            stress: with_sign(end_size, reflected),
            slip: middle_slip + end_slip,
            dissipation: middle_slip * middle_size
                + N::HALF * end_slip * (reflected_size + end_size),
            released,
        }
    }
}

/// Cracked layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackedLayer<N> {
    /// Normal component, with b₀ = 0 and θ₀ = 0.
    pub normal: PorousComponent<N>,
    /// Compliance C_t = δ/(ρ′c₂′²) > 0, m/Pa.
    pub shear_compliance: N,
    /// Friction k_s ≥ 0 of closed faces; `None` if they do not slip.
    pub friction: Option<N>,
}

impl<N: Number> CrackedLayer<N> {
    /// Converts the constants by `f`.
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
    const HISTORY_VARIABLES: usize = history::FRACTURE_TIME;

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
        let (normal_middle, normal_states) =
            self.normal.advance(incoming[0], N::ZERO, step, history);
        let normal_end = self.normal.elasticity.stress(history[history::NORMAL_STATE]);
        let old = inertia(history, history::SHEAR_INERTIA);
        let line = OpeningLine::new(incoming[1], self.normal.mass, old, step);
        let shear = ContactStep::new(
            &line,
            self.shear_compliance,
            self.friction,
            history[history::SHEAR_STRESS],
            [normal_middle, normal_end],
            step,
        );
        history[history::SHEAR_STRESS] = shear.stress;
        accumulate(history, history::RELEASED, shear.released);
        if self.friction.is_some() {
            history[history::SLIP] = history[history::SLIP] + shear.slip;
            record_time(history, history::SLIP_TIME, shear.slip, interval.end);
            accumulate(history, history::PLASTIC, shear.dissipation);
        }
        let moved = line.finish(shear.middle);
        set_inertia(history, history::SHEAR_INERTIA, moved.inertia);
        [normal_states, moved.states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let mass = self.normal.mass;
        let stress = history[history::SHEAR_STRESS];
        FaceEnergy {
            kinetic: mass.kinetic_energy(inertia(history, history::NORMAL_INERTIA))
                + mass.kinetic_energy(inertia(history, history::SHEAR_INERTIA)),
            stored: self.normal.elasticity.stored_energy(history[history::NORMAL_STATE])
                + N::HALF * self.shear_compliance * stress * stress,
            plastic: sum_value(history, history::PLASTIC),
            released: sum_value(history, history::RELEASED),
            ..FaceEnergy::ZERO
        }
    }
}
