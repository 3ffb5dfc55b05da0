//! Output: fields at the time of the solver, records, energies, snapshots.

use super::sweep::{GridLine, LineFields, ReferenceWavePair};
use super::{Reference, lane_index};
use crate::simd::Real;
use crate::solid::cell_laws::{add_scaled, is_outside_yield_set, stress_from_fields};
use crate::solid::domain::{BOUNDARY_LAYER_CELLS, ClosingBoundaries, SolverReal};
use crate::solid::ghosts::BoundaryFaces;
use crate::solid::ledger::{EnergySums, WorkSums};
use crate::solid::line;
use crate::solid::medium::{energy_terms_by_medium, stress_component};
use crate::solid::region::Region;
use crate::solid::snapshot::{Snapshot, StateLists, StatePart};
use models::solid::stress::Stress;
use models::solid::waves::SolidField;
use std::ops::Range;

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn quantity_count(&self) -> usize {
        self.fields.len() + self.time_integrals.len()
    }

    /// Returns the part of the state that this process holds: the whole one.
    pub(crate) fn state_part(&self) -> StatePart {
        let cells = self.problem.grid.cells;
        let faces = self.problem.interlayer_faces().into_iter();
        let layer = self.problem.grid.faces(D - 1);
        let interlayers =
            faces.map(|face| ([face.cell / layer, face.axis, face.cell], face.history.len()));
        StatePart {
            grid_cells: cells.to_vec(),
            cells: cells.iter().map(|count| 0..*count).collect(),
            interlayers: interlayers.collect(),
        }
    }

    /// Returns the total stress in a cell of the problem.
    pub fn total_stress(&self, cell: usize) -> Stress {
        self.permuted_total_stress(self.permutation.permuted_cell(cell))
    }

    /// Returns a copy with all stresses projected onto their yield sets.
    #[must_use]
    pub fn to_admissible(&self) -> Self {
        let mut mapped = self.clone();
        mapped.map_stresses();
        mapped.work.clone_from(&self.work);
        mapped.dissipation.clone_from(&self.dissipation);
        mapped
    }

    /// Returns field and cell of the first non-finite value; for interlayers, the cell above the face. `None` if all
    /// values are finite.
    pub fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        let non_finite_field = |cell: &usize| {
            let non_finite = self.fields.iter().position(|own| !own[*cell].to_f64().is_finite());
            non_finite.map(|index| self.fields()[index])
        };
        let first = (0..self.problem.grid.count()).find(|cell| non_finite_field(cell).is_some());
        let (field, cell) = match first {
            Some(cell) => (non_finite_field(&cell)?, cell),
            None => self.interlayers.first_non_finite()?,
        };
        Some((field, self.permutation.original_cell(cell)))
    }

    /// Returns the first cell, in the order of the sweeps, whose stress its projection onto the yield set changes;
    /// `None` if there is none.
    pub fn first_cell_outside_yield_set(&self) -> Option<usize> {
        let cell = (0..self.problem.grid.count()).find(|&cell| {
            let (medium, factor) = (self.medium(cell), self.field_factor(cell));
            is_outside_yield_set(medium, factor, &self.permuted_total_stress(cell))
        });
        cell.map(|cell| self.permutation.original_cell(cell))
    }

    /// Records all output quantities of these cells after each step, and discards earlier records.
    pub fn watch_cells(&mut self, cells: &[usize]) {
        self.records.clear();
        self.watched_cells =
            cells.iter().map(|cell| self.permutation.permuted_cell(*cell)).collect();
    }

    /// Records all output quantities of the watched cells in the present state.
    pub fn record_watched_cells(&mut self) {
        let mut records = std::mem::take(&mut self.records);
        let boundaries = self.closing_boundaries();
        for &cell in &self.watched_cells {
            let length = self.problem.grid.cells[0];
            let row = self.complete_row(cell / length, boundaries.as_ref());
            self.output_cell(cell, &row, &mut records);
        }
        self.records = records;
    }

    /// Returns the records since the last call, by step, watched cell and output quantity.
    pub fn take_records(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.records)
    }

    /// Returns the output quantities by cell (first axis fastest) at the time of the solver: all fields, with total
    /// stresses projected onto their yield sets, then the time integrals.
    pub fn output_values(&self) -> Vec<Vec<f64>> {
        self.output_values_in(0..self.layer_count())
    }

    /// Returns the output quantities as [`output_values`](Self::output_values) does, of the cells of some layers across the
    /// last axis of the problem.
    pub fn output_values_in(&self, layers: Range<usize>) -> Vec<Vec<f64>> {
        let mut fields = vec![Vec::new(); self.quantity_count()];
        let (mut state, boundaries) = (Vec::new(), self.closing_boundaries());
        let length = self.problem.grid.cells[0];
        let mut completed = (usize::MAX, Vec::new());
        let cells = self.layer_box(layers);
        for cell in
            Region::from_box(self.problem.grid.cells, cells.clone()).owned_global_cell_iter()
        {
            let row = cell / length;
            if completed.0 != row {
                completed = (row, self.complete_row(row, boundaries.as_ref()));
            }
            state.clear();
            self.output_cell(cell, &completed.1, &mut state);
            for (values, value) in fields.iter_mut().zip(&state) {
                values.push(*value);
            }
        }
        let permutation = self.permutation.restrict_to_box(&cells);
        fields.into_iter().map(|values| permutation.unpermute(values)).collect()
    }

    /// Returns the number of layers across the last axis of the problem.
    fn layer_count(&self) -> usize {
        self.permutation.unpermute_axis_values(self.problem.grid.cells)[D - 1]
    }

    /// Returns the cells of some layers across the last axis of the problem, along the permuted axes.
    fn layer_box(&self, layers: Range<usize>) -> [Range<usize>; D] {
        let counts = self.permutation.unpermute_axis_values(self.problem.grid.cells);
        let mut cells = counts.map(|count| 0..count);
        cells[D - 1] = layers;
        self.permutation.permute_axis_ranges(&cells)
    }

    /// Appends the output quantities of a cell; `row`: fields of its row at the time of the solver, from
    /// [`Self::complete_row`].
    fn output_cell(&self, cell: usize, row: &[Vec<T>], values: &mut Vec<f64>) {
        let x = cell % self.problem.grid.cells[0];
        let state: Vec<T> = row.iter().map(|field| field[x]).collect();
        let initial = self.initial_stress(cell).unwrap_or_default();
        let trial = add_scaled(&stress_from_fields(self.fields(), &state), &initial, 1.0);
        let stress = self.medium(cell).project(&trial).stress;
        for (&field, value) in self.fields().iter().zip(&state) {
            values.push(stress_component(field, &stress).unwrap_or_else(|| value.to_f64()));
        }
        // End correction of the trapezoidal rule: subtracts half of the last value; alternating sweeps use the midpoint
        // rule.
        let last = if self.problem.scheme.is_alternating() { 0.0 } else { 0.5 * self.problem.step };
        for (index, sums) in &self.time_integrals {
            let sum = sums[cell] - last * self.fields[*index][cell].to_f64();
            values.push(if self.steps > 0 { sum } else { 0.0 });
        }
    }

    /// Returns the boundaries of the sweeps that complete the last step; `None` if it needs no completion.
    fn closing_boundaries(&self) -> Option<ClosingBoundaries<T>> {
        (self.problem.scheme.is_alternating() && self.steps > 0).then(|| {
            let mut boundaries = ClosingBoundaries::new(&self.boundaries[0]);
            boundaries.set_time(self.time(), self.problem.step);
            boundaries
        })
    }

    /// Returns the fields of a row at the time of the solver. With alternating sweeps the state lacks a sweep by a
    /// quarter of a step along the first axis, which is applied to a copy; near reflecting boundaries the mean of the
    /// states before and after a sweep by half a step is used.
    fn complete_row(&self, row: usize, boundaries: Option<&ClosingBoundaries<T>>) -> Vec<Vec<T>> {
        let length = self.problem.grid.cells[0];
        let first = row * length;
        let mut values: Vec<Vec<T>> =
            self.fields.iter().map(|own| own[first..first + length].to_vec()).collect();
        let Some(boundaries) = boundaries else { return values };
        let line = GridLine { axis: 0, first, stride: 1, count: length, face: row };
        let mut line_fields_by_step = [LineFields::new(), LineFields::new()];
        for (pair, wave) in self.quarter_step_waves.iter().enumerate() {
            let both =
                [(wave, &boundaries.quarter_step), (&self.waves[0][pair], &boundaries.half_step)];
            for (line_fields, (wave, boundaries)) in line_fields_by_step.iter_mut().zip(both) {
                self.fill_line(line_fields, line, (pair, wave), boundaries);
                let LineFields { velocity, stress, cells, .. } = line_fields;
                line::sweep(velocity, stress, cells, self.slopes, None);
            }
            let is_reflecting =
                self.boundaries[0].each_ref().map(|boundary| is_reflecting(boundary, pair, row));
            for x in 0..length {
                let is_near = (is_reflecting[0] && x < BOUNDARY_LAYER_CELLS)
                    || (is_reflecting[1] && length - 1 - x < BOUNDARY_LAYER_CELLS);
                let (line_fields, fraction) = match is_near {
                    true => (&line_fields_by_step[1], T::HALF),
                    false => (&line_fields_by_step[0], T::ONE),
                };
                self.add_completion(&mut values, (first + x, x), wave, (line_fields, fraction));
            }
        }
        values
    }

    /// Adds `fraction` times the change of a cell by the sweep of a wave pair to the fields `values` of its row; `x`:
    /// position in the row.
    fn add_completion(
        &self,
        values: &mut [Vec<T>],
        (cell, x): (usize, usize),
        wave: &ReferenceWavePair<T>,
        (line_fields, fraction): (&LineFields<T>, T),
    ) {
        let (before, place) = (self.fields[wave.velocity][cell], self.slopes.ghosts() + x);
        values[wave.velocity][x] = before + fraction * (line_fields.velocity[place] - before);
        let before = self.fields[wave.stress][cell];
        let change = fraction * (line_fields.stress[place] - before);
        values[wave.stress][x] = before + change;
        let medium = usize::from(self.problem.cell_media[cell]);
        for (index, ratios) in &wave.passive_stresses {
            let value = &mut values[*index][x];
            *value = *value + ratios[medium] * change;
        }
    }

    /// Returns the plastic dissipation by cell, J/m³; empty if no medium yields.
    pub fn plastic_dissipation(&self) -> Vec<f64> {
        self.plastic_dissipation_in(0..self.layer_count())
    }

    /// Returns the plastic dissipation as [`plastic_dissipation`](Self::plastic_dissipation) does, of the cells of some layers
    /// across the last axis of the problem.
    pub fn plastic_dissipation_in(&self, layers: Range<usize>) -> Vec<f64> {
        let values = &self.dissipation.plastic_dissipation;
        let cells = self.layer_box(layers);
        let region = Region::from_box(self.problem.grid.cells, cells.clone());
        let own = region.owned_global_cell_iter().filter_map(|cell| values.get(cell).copied());
        self.permutation.restrict_to_box(&cells).unpermute(own.collect())
    }

    /// Computes the exact sums of the energies over cells and interlayers.
    pub(super) fn energy_sums(&self) -> EnergySums {
        let (terms, kinetic) = energy_terms_by_medium(&self.problem.media, &self.state_fields);
        let mut sums = EnergySums::default();
        for (cell, medium) in self.problem.cell_media.iter().enumerate() {
            let mut cell_energies = [0.0; 2];
            for (term, ([one, other], factors)) in terms.iter().enumerate() {
                let factor = T::from_f64(factors[usize::from(*medium)]);
                let [one, other] = [one, other].map(|index| self.fields[*index][cell].to_f64());
                cell_energies[usize::from(term >= kinetic)] += factor.to_f64() * one * other;
            }
            sums.kinetic.add(cell_energies[0]);
            sums.stored.add(cell_energies[1]);
        }
        sums.interlayers = self.interlayers.sum_energies(&self.problem);
        sums
    }

    fn cell_sum_lists(&self) -> impl Iterator<Item = &Vec<f64>> {
        let integrals = self.time_integrals.iter().map(|(_, sums)| sums);
        self.dissipation.lists().into_iter().chain(integrals)
    }

    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        Snapshot {
            fields: self.fields.clone(),
            cell_sums: self.cell_sum_lists().cloned().collect(),
            ..self.snapshot_without_lists()
        }
    }

    /// Returns the state without values by cell.
    pub(crate) fn snapshot_without_lists(&self) -> Snapshot<T> {
        Snapshot {
            steps: self.steps,
            fields: Vec::new(),
            work_sums: self.work.to_partial_sums(),
            cell_sums: Vec::new(),
            interlayer_history: self.interlayers.history().to_vec(),
        }
    }

    /// Returns the lengths of the lists by cell of a state.
    pub(crate) fn list_lengths(&self) -> [Vec<usize>; 2] {
        let sums = self.cell_sum_lists().map(Vec::len).collect();
        [self.fields.iter().map(Vec::len).collect(), sums]
    }

    /// Returns the values of a field of a state.
    pub(crate) fn field_list(&self, index: usize) -> Vec<T> {
        self.fields[index].clone()
    }

    /// Returns the sums by cell at an index of a state.
    pub(crate) fn sum_list(&self, index: usize) -> Vec<f64> {
        self.cell_sum_lists().nth(index).cloned().unwrap_or_default()
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        self.steps = 0;
        self.fields.iter_mut().for_each(|own| own.fill(T::ZERO));
        self.work = WorkSums::default();
        self.dissipation.lists_mut().into_iter().for_each(|sums| sums.fill(0.0));
        self.time_integrals.iter_mut().for_each(|(_, sums)| sums.fill(0.0));
        self.interlayers.clear();
    }

    /// Restores a snapshot; returns `false`, without any change, if the sizes of its lists are not those of this
    /// problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        self.restore_lists(snapshot, &mut &*snapshot)
    }

    /// Restores a state, whose lists by cell are `lists`, as [`restore`](Self::restore) does. If a list cannot be read,
    /// other lists may have been restored.
    pub(crate) fn restore_lists(
        &mut self,
        state: &Snapshot<T>,
        lists: &mut dyn StateLists<T>,
    ) -> bool {
        if lists.lengths() != self.list_lengths()
            || state.interlayer_history.len() != self.interlayers.history().len()
        {
            return false;
        }
        self.steps = state.steps;
        self.interlayers.set_history(&state.interlayer_history);
        self.work = WorkSums::from_partial_sums(&state.work_sums);
        for (index, own) in self.fields.iter_mut().enumerate() {
            let Some(values) = lists.read_field(index) else { return false };
            own.copy_from_slice(&values);
        }
        let integrals = self.time_integrals.iter_mut().map(|(_, sums)| sums);
        let sums = self.dissipation.lists_mut().into_iter().chain(integrals);
        for (index, own) in sums.enumerate() {
            let Some(values) = lists.read_sums(index) else { return false };
            own.copy_from_slice(&values);
        }
        true
    }
}

/// Returns whether a wave pair has a one-sided reconstruction at a reflecting face of a row: prescribed velocity or
/// traction, not a symmetry plane, and not the first-order scheme.
fn is_reflecting<T: Real>(boundary: &BoundaryFaces<T>, pair: usize, row: usize) -> bool {
    boundary.ghost_rule().is_some_and(|rule| {
        let [sign, .., one_sided] = rule.face_coefficients(pair, lane_index::<T>(row));
        sign != T::ZERO && one_sided != T::ZERO
    })
}
