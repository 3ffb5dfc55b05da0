//! Sequence of operations of a time step; notation, theory and references: `step` of the fused solver.

use super::Reference;
use crate::solid::cell_laws::LawInterval;
use crate::solid::domain::SolverReal;
use crate::solid::problem::PlasticStep;

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Advances all fields by `steps` time steps.
    pub fn advance(&mut self, steps: usize) {
        for _ in 0..steps {
            T::advance_reference(self);
        }
    }

    /// Advances all fields by a time step.
    pub(in crate::solid) fn advance_step(&mut self) {
        let start = self.steps as f64 * self.problem.step;
        let end = (self.steps + 1) as f64 * self.problem.step;
        match self.problem.scheme.is_alternating() {
            true => self.advance_alternating(start, end),
            false => self.advance_two_cyclic(start, end),
        }
        self.steps += 1;
        self.flush_subnormals();
        if !self.problem.scheme.is_alternating() {
            self.accumulate_integrals(1.0);
        }
        self.record_watched_cells();
    }

    /// Advances by a two-cyclic step: U ← x y z, K Q K, z y x, then P; or 2P − I in the middle of Q, which includes
    /// relaxation. The laws of contacts complete each sweep and each rotation by the curvature.
    fn advance_two_cyclic(&mut self, start: f64, end: f64) {
        let step = self.problem.step;
        let middle = start + 0.5 * step;
        if self.steps == 0 {
            // First term of the trapezoidal rule.
            self.accumulate_integrals(0.5);
        }

        let middles = [0, 1].map(|half| {
            let shear_middle = self.shear_steps.sweep_middle((self.steps, half), step);
            [start + [0.25, 0.75][half] * step, shear_middle]
        });
        for axis in 0..D {
            self.sweep(axis, (middles[0], middle));
            self.apply_contact_laws();
        }

        self.interlayers.advance_fluid(step);
        let sources =
            [self.integrate_signals([start, middle]), self.integrate_signals([middle, end])];
        self.apply_cell_operators(&sources);

        for axis in (0..D).rev() {
            self.sweep(axis, (middles[1], end));
            self.apply_contact_laws();
        }
        if self.problem.scheme.plastic_step == PlasticStep::ReturnMapping {
            self.map_stresses();
        }
    }

    /// Applies K Q K with relaxation, and with the reflection 2P − I in the middle if the scheme requires it.
    fn apply_cell_operators(&mut self, sources: &[Vec<[f64; 2]>; 2]) {
        self.apply_sources(&sources[0]);
        match self.problem.scheme.plastic_step {
            PlasticStep::MidpointReflection if !self.dissipation.plastic_dissipation.is_empty() => {
                self.rotate_by_curvature(LawInterval::HalfStep);
                self.rotate_spins(LawInterval::HalfStep);
                self.relax(LawInterval::HalfStep);
                self.map_cells_scalar(true);
                self.relax(LawInterval::HalfStep);
                self.rotate_spins(LawInterval::HalfStep);
                self.rotate_by_curvature(LawInterval::HalfStep);
            }
            _ => {
                // The rotation by the curvature does not commute with the other laws: half of the rotation before, half
                // after them.
                let has_other_laws = self.cell_laws.has_rotation_or_relaxation();
                let interval =
                    if has_other_laws { LawInterval::HalfStep } else { LawInterval::Step };
                self.rotate_by_curvature(interval);
                self.rotate_spins(LawInterval::Step);
                self.relax(LawInterval::Step);
                self.relax_contacts();
                if has_other_laws {
                    self.rotate_by_curvature(interval);
                }
            }
        }
        self.apply_sources(&sources[1]);
    }

    /// Advances by a step with alternating sweeps: U ← x y z, K √Q x √Q K, z y, then P; the very first x is by a
    /// quarter of a step.
    fn advance_alternating(&mut self, start: f64, end: f64) {
        let step = self.problem.step;
        let middle = start + 0.5 * step;

        match self.steps {
            0 => self.sweep_quarter_step(([start + 0.125 * step; 2], middle)),
            _ => self.sweep(0, ([start; 2], middle)),
        }
        for axis in 1..D {
            self.sweep(axis, ([start + 0.25 * step; 2], middle));
        }

        let sources =
            [self.integrate_signals([start, middle]), self.integrate_signals([middle, end])];
        self.apply_sources(&sources[0]);
        self.rotate_spins(LawInterval::HalfStep);
        self.relax(LawInterval::HalfStep);
        // Time integrals use the mean of the states before and after the sweep, which is second order at mid-step.
        self.accumulate_integrals(0.5);
        self.sweep(0, ([middle; 2], end));
        self.accumulate_integrals(0.5);
        self.relax(LawInterval::HalfStep);
        self.rotate_spins(LawInterval::HalfStep);
        self.apply_sources(&sources[1]);

        for axis in (1..D).rev() {
            self.sweep(axis, ([start + 0.75 * step; 2], end));
        }
        self.map_stresses();
    }
}
