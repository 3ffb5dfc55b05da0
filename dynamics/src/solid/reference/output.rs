//! Output: fields at the time of the solver, records, energies, snapshots.

use super::sweep::{LineOfCells, Strip, WavePair};
use super::{Reference, slot};
use crate::simd::Real;
use crate::solid::cell_laws::{combined, stress_of};
use crate::solid::domain::{BOUNDARY_LAYER, SolverReal};
use crate::solid::ghosts::{BoundaryFaces, set_time};
use crate::solid::ledger::{EnergySums, WorkSums};
use crate::solid::line;
use crate::solid::medium::{component, energy_terms_by_medium};
use crate::solid::reconstruction::GHOSTS;
use crate::solid::snapshot::Snapshot;
use models::solid::stress::Stress;
use models::solid::waves::Field;

/// Boundaries of the first axis for the sweeps that complete a step: by a quarter and by half a step.
struct ClosingSides<T: Real> {
    quarter: [BoundaryFaces<T>; 2],
    half: [BoundaryFaces<T>; 2],
}

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn width(&self) -> usize {
        self.fields.len() + self.integrals.len()
    }

    /// Returns the total stress in a cell of the problem.
    pub fn total_stress(&self, cell: usize) -> Stress {
        self.whole_stress_of(self.permutation.permuted_cell(cell))
    }

    /// Returns a copy with all stresses projected onto their yield sets.
    #[must_use]
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        shown.map_stresses();
        shown.work.clone_from(&self.work);
        shown.dissipation.clone_from(&self.dissipation);
        shown
    }

    /// Returns field and cell of the first non-finite value; for interlayers, the cell above the face.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let is_broken = |cell: &usize| {
            let broken = self.fields.iter().position(|own| !own[*cell].to_f64().is_finite());
            broken.map(|place| self.fields()[place])
        };
        let first = (0..self.problem.grid.count()).find(|cell| is_broken(cell).is_some());
        let (field, cell) = match first {
            Some(cell) => (is_broken(&cell)?, cell),
            None => self.faces.first_non_finite(&self.problem)?,
        };
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Returns the first cell whose stress is outside its yield set.
    pub fn first_beyond_yield(&self) -> Option<usize> {
        let cell = (0..self.problem.grid.count()).find(|&cell| {
            let stress = self.whole_stress_of(cell);
            self.medium(cell).project(&stress).stress != stress
        });
        cell.map(|cell| self.permutation.original_cell(cell))
    }

    /// Records all fields of these cells after each step, and discards earlier records.
    pub fn watch(&mut self, cells: &[usize]) {
        self.records.clear();
        self.watched = cells.iter().map(|cell| self.permutation.permuted_cell(*cell)).collect();
    }

    /// Records all fields of the watched cells in the present state.
    pub fn record(&mut self) {
        let mut records = std::mem::take(&mut self.records);
        let sides = self.closing_sides();
        for &cell in &self.watched {
            let length = self.problem.grid.cells[0];
            let row = self.completed_row(cell / length, sides.as_ref());
            self.output_cell(cell, &row, &mut records);
        }
        self.records = records;
    }

    /// Returns the records since the last call, by step, watched cell and field.
    pub fn records(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.records)
    }

    /// Returns the output quantities by cell (first axis fastest) at the time of the solver: all fields, with total
    /// stresses projected onto their yield sets, then the time integrals.
    pub fn output_fields(&self) -> Vec<Vec<f64>> {
        let mut fields = vec![Vec::new(); self.width()];
        let (mut state, sides) = (Vec::new(), self.closing_sides());
        let length = self.problem.grid.cells[0];
        for row in 0..self.problem.grid.faces(0) {
            let completed = self.completed_row(row, sides.as_ref());
            for cell in row * length..(row + 1) * length {
                state.clear();
                self.output_cell(cell, &completed, &mut state);
                for (values, value) in fields.iter_mut().zip(&state) {
                    values.push(*value);
                }
            }
        }
        fields.into_iter().map(|values| self.permutation.unpermute(values)).collect()
    }

    /// Appends the output quantities of a cell; `row`: completed fields of its row.
    fn output_cell(&self, cell: usize, row: &[Vec<T>], values: &mut Vec<f64>) {
        let x = cell % self.problem.grid.cells[0];
        let state: Vec<T> = row.iter().map(|field| field[x]).collect();
        let initial = self.initial_stress(cell).unwrap_or_default();
        let whole = combined(&stress_of(self.fields(), &state), &initial, 1.0);
        let stress = self.medium(cell).project(&whole).stress;
        for (&field, value) in self.fields().iter().zip(&state) {
            values.push(component(field, &stress).unwrap_or_else(|| value.to_f64()));
        }
        // End correction of the trapezoidal rule; alternating sweeps use the midpoint rule.
        let last = if self.problem.scheme.alternates() { 0.0 } else { 0.5 * self.problem.step };
        for (place, sums) in &self.integrals {
            let sum = sums[cell] - last * self.fields[*place][cell].to_f64();
            values.push(if self.steps > 0 { sum } else { 0.0 });
        }
    }

    /// Returns the boundaries of the sweeps that complete the last step; `None` if it needs no completion.
    fn closing_sides(&self) -> Option<ClosingSides<T>> {
        (self.problem.scheme.alternates() && self.steps > 0).then(|| {
            let [mut quarter, mut half] = [0, 1].map(|_| self.sides[0].clone());
            set_time(&mut quarter, self.time() - 0.125 * self.problem.step);
            set_time(&mut half, self.time());
            ClosingSides { quarter, half }
        })
    }

    /// Returns the fields of a row at the time of the solver. With alternating sweeps the state lacks a sweep by a
    /// quarter of a step along the first axis, which is applied to a copy; near reflecting boundaries the mean of the
    /// states before and after a sweep by half a step is used.
    fn completed_row(&self, row: usize, sides: Option<&ClosingSides<T>>) -> Vec<Vec<T>> {
        let length = self.problem.grid.cells[0];
        let first = row * length;
        let mut values: Vec<Vec<T>> =
            self.fields.iter().map(|own| own[first..first + length].to_vec()).collect();
        let Some(sides) = sides else { return values };
        let line = LineOfCells { axis: 0, first, stride: 1, count: length, face: row };
        let mut strips = [Strip::new(), Strip::new()];
        for (pair, wave) in self.quarter_waves.iter().enumerate() {
            let both = [(wave, &sides.quarter), (&self.waves[0][pair], &sides.half)];
            for (strip, (wave, sides)) in strips.iter_mut().zip(both) {
                self.fill(strip, line, (pair, wave), sides);
                let Strip { velocity, stress, cells, .. } = strip;
                line::sweep(velocity, stress, cells, self.slopes, None);
            }
            let reflects = self.sides[0].each_ref().map(|side| reflects(side, pair, row));
            for x in 0..length {
                let is_near = (reflects[0] && x < BOUNDARY_LAYER)
                    || (reflects[1] && length - 1 - x < BOUNDARY_LAYER);
                let (strip, part) = match is_near {
                    true => (&strips[1], T::HALF),
                    false => (&strips[0], T::ONE),
                };
                self.complete(&mut values, (first + x, x), wave, (strip, part));
            }
        }
        values
    }

    /// Adds the fraction `part` of the change of a cell by a sweep to the fields of its row; `x`: position in the row.
    fn complete(
        &self,
        values: &mut [Vec<T>],
        (cell, x): (usize, usize),
        wave: &WavePair<T>,
        (strip, part): (&Strip<T>, T),
    ) {
        let before = self.fields[wave.velocity][cell];
        values[wave.velocity][x] = before + part * (strip.velocity[GHOSTS + x] - before);
        let before = self.fields[wave.stress][cell];
        let change = part * (strip.stress[GHOSTS + x] - before);
        values[wave.stress][x] = before + change;
        let medium = usize::from(self.problem.of_cell[cell]);
        for (place, ratios) in &wave.passive_stresses {
            let value = &mut values[*place][x];
            *value = *value + ratios[medium] * change;
        }
    }

    /// Returns the plastic dissipation by cell, J/m³; empty if no medium yields.
    pub fn dissipated(&self) -> Vec<f64> {
        self.permutation.unpermute(self.dissipation.plastic.clone())
    }

    /// Computes the energy sums.
    pub(super) fn energy_sums(&self) -> EnergySums {
        let (terms, kinetic) = energy_terms_by_medium(&self.problem.media, &self.names);
        let mut sums = EnergySums::default();
        for (cell, medium) in self.problem.of_cell.iter().enumerate() {
            let mut of_cell = [0.0; 2];
            for (term, ([one, other], factors)) in terms.iter().enumerate() {
                let factor = T::from_f64(factors[usize::from(*medium)]);
                let [one, other] = [one, other].map(|place| self.fields[*place][cell].to_f64());
                of_cell[usize::from(term >= kinetic)] += factor.to_f64() * one * other;
            }
            sums.kinetic.add(of_cell[0]);
            sums.stored.add(of_cell[1]);
        }
        self.faces.add_energy(&self.problem, &mut sums);
        sums
    }

    fn sums(&self) -> Vec<Vec<f64>> {
        let integrals = self.integrals.iter().map(|(_, sums)| sums);
        self.dissipation.all().into_iter().chain(integrals).cloned().collect()
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        Snapshot {
            steps: self.steps,
            fields: self.fields.clone(),
            work: self.work.parts(),
            sums: self.sums(),
            interlayers: self.faces.memory(),
        }
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        self.steps = 0;
        self.fields.iter_mut().for_each(|own| own.fill(T::ZERO));
        self.work = WorkSums::default();
        self.dissipation.all_mut().into_iter().for_each(|sums| sums.fill(0.0));
        self.integrals.iter_mut().for_each(|(_, sums)| sums.fill(0.0));
        self.faces.set_memory(&vec![[T::ZERO; 2]; self.faces.memory().len()]);
    }

    /// Restores a snapshot; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        let Snapshot { steps, fields, work, sums, interlayers } = snapshot;
        let is_same = fields.iter().map(Vec::len).eq(self.fields.iter().map(Vec::len))
            && interlayers.len() == self.faces.memory().len()
            && sums.iter().map(Vec::len).eq(self.sums().iter().map(Vec::len));
        let (Some((dissipation, integrals)), true) = (sums.split_at_checked(3), is_same) else {
            return false;
        };
        self.steps = *steps;
        self.fields.clone_from(fields);
        self.faces.set_memory(interlayers);
        self.work = WorkSums::from_parts(work);
        for (own, sums) in self.dissipation.all_mut().into_iter().zip(dissipation) {
            own.clone_from(sums);
        }
        for ((_, own), sums) in self.integrals.iter_mut().zip(integrals) {
            own.clone_from(sums);
        }
        true
    }
}

/// Returns whether a boundary reflects a wave pair at a row.
fn reflects<T: Real>(side: &BoundaryFaces<T>, pair: usize, row: usize) -> bool {
    side.mirror().is_some_and(|rule| {
        let [sign, .., one_sided] = rule.face_at(pair, slot::<T>(row));
        sign != T::ZERO && one_sided != T::ZERO
    })
}
