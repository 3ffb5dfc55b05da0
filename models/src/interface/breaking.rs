//! Breaking layer: elastic-plastic until the normal traction reaches the tensile strength σ_t ≤ τ_s/k_s, then cracked
//! for good (Sadovskii & Sadovskaya, kinds 2 and 6).
//!
//! A step is computed as [elastic-plastic](super::plastic). If S_n,mid ≥ σ_t there, the layer breaks before the step:
//! the energy ½C_n max(S_n, 0)² is lost, the elastic opening C_nS_n becomes that of the [crack](super::cracked), and
//! the step is that of a crack with the friction k_s. The history variable of the normal component is b₁ε with b₁ =
//! ρ′c₁′²: the traction S_n while the layer is intact, b₁u/δ in an open crack of opening u.

use super::cracked::ContactStep;
use super::history::{self, accumulate, read_motion, record_time, sum_value, write_motion};
use super::opening_line::OpeningLine;
use super::plastic::{ElasticTrial, PlasticStep, YieldCone};
use super::porous::PorousComponent;
use super::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
use crate::common::number::Number;

/// Law of a breaking layer: elastic-plastic while intact, a crack with friction after fracture.
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
    /// Converts every constant by the function `f`.
    #[inline(always)]
    pub fn map<M>(self, f: impl Fn(N) -> M) -> BreakingLayer<M> {
        BreakingLayer {
            crack: self.crack.map(&f),
            compliance: self.compliance.map(&f),
            cone: self.cone.map(&f),
            tensile_strength: f(self.tensile_strength),
        }
    }

    /// Normal traction S_n, Pa, from the history variable b₁ε: equal to it while the layer is intact, min(b₁ε, 0) after
    /// fracture.
    #[inline(always)]
    pub fn normal_stress(&self, history: &[N]) -> N {
        let stress = history[history::NORMAL_STATE];
        history[history::FRACTURE_TIME].select_gt(N::ZERO, stress.min(N::ZERO), stress)
    }
}

impl<N: Number> FaceLaw<N, 2> for BreakingLayer<N> {
    const HISTORY_VARIABLE_COUNT: usize = history::MAX_HISTORY_VARIABLES;

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
        let motion_starts = [history::NORMAL_MOTION, history::SHEAR_MOTION];
        let old_stress = [history[history::NORMAL_STATE], history[history::SHEAR_STRESS]];
        let start_motions =
            [read_motion(history, motion_starts[0]), read_motion(history, motion_starts[1])];
        let opening_lines = [
            OpeningLine::new(incoming[0], self.crack.mass, start_motions[0], step),
            OpeningLine::new(incoming[1], self.crack.mass, start_motions[1], step),
        ];

        // Step of the layer if it is intact.
        let trials = [
            ElasticTrial::new(&opening_lines[0], self.compliance[0], old_stress[0], step),
            ElasticTrial::new(&opening_lines[1], self.compliance[1], old_stress[1], step),
        ];
        let slip = history[history::SLIP];
        let intact = PlasticStep::new(&self.cone, trials, self.compliance, old_stress, slip, step);
        // The tensile strength counts as reached up to rounding errors: at the apex S_n equals it.
        let relative_tolerance = N::from_f64(8.0) * N::EPSILON;
        let limit = self.tensile_strength * (N::ONE - relative_tolerance);
        let reached = intact.midpoint_stress[0].select_gt(limit, N::ONE, zero);
        let old_fracture_time = history[history::FRACTURE_TIME];
        let is_broken = old_fracture_time.select_gt(zero, N::ONE, reached);
        let tension = old_fracture_time.select_gt(zero, zero, reached) * old_stress[0].max(zero);
        let fracture_energy = N::HALF * self.compliance[0] * tension * tension;
        record_time(history, history::FRACTURE_TIME, reached, interval.end);
        accumulate(history, history::FRACTURE_ENERGY, fracture_energy);

        // Step of the layer if it is broken: a crack.
        let stiffness = self.crack.elasticity.collapse_stiffness;
        let strain = old_stress[0] * (N::ONE / stiffness);
        let opening = self.crack.elasticity.solve(&opening_lines[0], strain, zero, step);
        let normal_end_stress = old_stress[0] + stiffness * opening.strain_change;
        let contact = ContactStep::new(
            &opening_lines[1],
            self.compliance[1],
            Some(self.cone.friction),
            old_stress[1],
            [opening.midpoint_stress, normal_end_stress.min(zero)],
            step,
        );

        let select_by_state = |crack: N, intact: N| is_broken.select_gt(zero, crack, intact);
        let slip = select_by_state(contact.slip, intact.slip);
        history[history::SLIP] = history[history::SLIP] + slip;
        record_time(history, history::SLIP_TIME, slip, interval.end);
        accumulate(
            history,
            history::PLASTIC_DISSIPATION,
            select_by_state(contact.dissipation, intact.dissipation),
        );
        accumulate(
            history,
            history::RELEASED_ENERGY,
            select_by_state(contact.released_energy, zero),
        );
        history[history::NORMAL_STATE] = select_by_state(normal_end_stress, intact.end_stress[0]);
        history[history::SHEAR_STRESS] = select_by_state(contact.end_stress, intact.end_stress[1]);
        let midpoint_stress = [
            select_by_state(opening.midpoint_stress, intact.midpoint_stress[0]),
            select_by_state(contact.midpoint_stress, intact.midpoint_stress[1]),
        ];
        let layer_steps = [
            opening_lines[0].complete_step(midpoint_stress[0]),
            opening_lines[1].complete_step(midpoint_stress[1]),
        ];
        for i in 0..2 {
            write_motion(history, motion_starts[i], layer_steps[i].motion);
        }
        [layer_steps[0].states, layer_steps[1].states]
    }

    fn energy(&self, history: &[N]) -> FaceEnergy<N> {
        let mass = self.crack.mass;
        let stress = [self.normal_stress(history), history[history::SHEAR_STRESS]];
        let [normal, shear] =
            std::array::from_fn(|i| N::HALF * self.compliance[i] * stress[i] * stress[i]);
        FaceEnergy {
            kinetic: mass.kinetic_energy(read_motion(history, history::NORMAL_MOTION))
                + mass.kinetic_energy(read_motion(history, history::SHEAR_MOTION)),
            stored: normal + shear,
            plastic_dissipation: sum_value(history, history::PLASTIC_DISSIPATION),
            released_energy: sum_value(history, history::RELEASED_ENERGY),
            fracture_energy: sum_value(history, history::FRACTURE_ENERGY),
            ..FaceEnergy::ZERO
        }
    }
}
