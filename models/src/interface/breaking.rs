//! Breaking layer: elastic-plastic until the normal traction reaches the tensile strength σ_t ≤ τ_s/k_s, then cracked
//! for good (Sadovskii & Sadovskaya, kinds 2 and 6).
//!
//! A step is computed as [elastic-plastic](super::plastic). If S_n,mid ≥ σ_t there, the layer breaks before the step:
//! the energy ½C_n max(S_n, 0)² is lost, the elastic opening C_nS_n becomes that of the [crack](super::cracked), and the
//! step is that of a crack with the friction k_s. The history variable of the normal component is b₁ε with
//! b₁ = ρ′c₁′²: the traction S_n while the layer is intact, b₁u/δ in an open crack of opening u.

use super::cracked::ContactStep;
use super::history::{self, accumulate, inertia, record_time, set_inertia, sum_value};
use super::opening_line::OpeningLine;
use super::plastic::{ElasticTrial, PlasticStep, YieldCone};
use super::porous::PorousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Breaking layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BreakingLayer<N> {
    /// Normal component of the crack, with b₀ = 0 and θ₀ = 0.
    pub crack: PorousComponent<N>,
    /// Compliances C_n = δ/b₁ and C_t > 0, m/Pa.
    pub compliance: [N; 2],
    /// Yield condition of the intact layer; its friction remains after fracture.
    pub cone: YieldCone<N>,
    /// Tensile strength σ_t ≥ 0, Pa.
    pub tensile_strength: N,
}

impl<N: Number> BreakingLayer<N> {
    /// Converts the constants by `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> BreakingLayer<M> {
        BreakingLayer {
            crack: self.crack.map(&f),
            compliance: self.compliance.map(&f),
            cone: self.cone.map(&f),
            tensile_strength: f(self.tensile_strength),
        }
    }

    /// Normal traction from the history variable b₁ε: all of it while the layer is intact, else min(b₁ε, 0), Pa.
    #[inline(always)]
    pub fn normal_stress(&self, history: &[N]) -> N {
        let stress = history[history::NORMAL_STATE];
        history[history::FRACTURE_TIME].select_gt(N::ZERO, stress.min(N::ZERO), stress)
    }
}

impl<N: Number> FaceLaw<N, 2> for BreakingLayer<N> {
    const HISTORY_VARIABLES: usize = history::MAX_HISTORY_VARIABLES;

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
        let (zero, step) = (N::ZERO, interval.step);
        let starts = [history::NORMAL_INERTIA, history::SHEAR_INERTIA];
        let old = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let lines = [
            OpeningLine::new(incoming[0], self.crack.mass, inertia(history, starts[0]), step),
            OpeningLine::new(incoming[1], self.crack.mass, inertia(history, starts[1]), step),
        ];

        // The step of an intact layer.
        let trials = [
            ElasticTrial::new(&lines[0], self.compliance[0], old[0], step),
            ElasticTrial::new(&lines[1], self.compliance[1], old[1], step),
        ];
        let slip = history[history::SLIP];
        let intact = PlasticStep::new(&self.cone, trials, self.compliance, old, slip, step);
        // The strength counts as reached within rounding errors, since S_n may stay at the apex.
        let rounding = N::from_f64(8.0) * N::EPSILON;
        let limit = self.tensile_strength * (N::ONE - rounding);
        let reached = intact.middle[0].select_gt(limit, N::ONE, zero);
        let was_broken = history[history::FRACTURE_TIME];
        let broken = was_broken.select_gt(zero, N::ONE, reached);
        let tension = was_broken.select_gt(zero, zero, reached) * old[0].max(zero);
        let fracture = N::HALF * self.compliance[0] * tension * tension;
        record_time(history, history::FRACTURE_TIME, reached, interval.end);
        accumulate(history, history::FRACTURE, fracture);

        // The step of a crack.
        let stiffness = self.crack.elasticity.collapse_stiffness;
        let strain = old[0] * (N::ONE / stiffness);
        let opening = self.crack.elasticity.solve(&lines[0], strain, zero, step);
        let normal_end = old[0] + stiffness * opening.change;
        let contact = ContactStep::new(
            &lines[1],
            self.compliance[1],
            Some(self.cone.friction),
            old[1],
            [opening.middle, normal_end.min(zero)],
            step,
        );

        let select = |crack: N, intact: N| broken.select_gt(zero, crack, intact);
        let slip = select(contact.slip, intact.slip);
        history[history::SLIP] = history[history::SLIP] + slip;
        record_time(history, history::SLIP_TIME, slip, interval.end);
        accumulate(history, history::PLASTIC, select(contact.dissipation, intact.dissipation));
        accumulate(history, history::RELEASED, select(contact.released, zero));
        history[history::NORMAL_STATE] = select(normal_end, intact.stress[0]);
        history[history::SHEAR_STRESS] = select(contact.stress, intact.stress[1]);
        let middle =
            [select(opening.middle, intact.middle[0]), select(contact.middle, intact.middle[1])];
        let moved = [lines[0].finish(middle[0]), lines[1].finish(middle[1])];
        for i in 0..2 {
            set_inertia(history, starts[i], moved[i].inertia);
        }
        [moved[0].states, moved[1].states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let mass = self.crack.mass;
        let stress = [self.normal_stress(history), history[history::SHEAR_STRESS]];
        let [normal, shear] =
            std::array::from_fn(|i| N::HALF * self.compliance[i] * stress[i] * stress[i]);
        FaceEnergy {
            kinetic: mass.kinetic_energy(inertia(history, history::NORMAL_INERTIA))
                + mass.kinetic_energy(inertia(history, history::SHEAR_INERTIA)),
            stored: normal + shear,
            plastic: sum_value(history, history::PLASTIC),
            released: sum_value(history, history::RELEASED),
            fracture: sum_value(history, history::FRACTURE),
            ..FaceEnergy::ZERO
        }
    }
}
