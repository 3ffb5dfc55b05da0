//! Output of a domain: fields of cells at the time of the domain, records of watched cells, sums over time by cell.

use super::completion::ClosingBoundaries;
use super::{Domain, SolverReal};

use crate::solid::cell_laws::{add_scaled, is_outside_yield_set};
use crate::solid::medium::{Medium, stress_component};
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the time integrals of the problem in an owned cell, m or rad.
    pub(crate) fn time_integrals(&self, cell: usize) -> impl Iterator<Item = f64> {
        // Trapezoidal rule: subtracts half of the last value times Δt; the midpoint rule is used if the cell laws act on
        // both sides of the middle.
        let last = if self.scheme.is_alternating() { 0.0 } else { 0.5 * self.step };
        let has_steps = self.schedule.steps > 0;
        let cell = self.layout.local_cell(cell);
        self.diagnostics.time_integrals.iter().map(move |(place, sums)| match has_steps {
            true => sums[cell] - last * self.value_at(cell, *place).to_f64(),
            false => 0.0,
        })
    }

    /// Returns the number of time integrals per cell.
    pub(crate) fn integral_count(&self) -> usize {
        self.diagnostics.time_integrals.len()
    }

    /// Returns the number of lists of sums over time by cell.
    pub(crate) fn cell_sum_count(&self) -> usize {
        self.diagnostics.dissipation.lists().len() + self.diagnostics.time_integrals.len()
    }

    /// Whether the problem needs the sums at an index of [`Self::cell_sums`].
    pub(crate) fn has_cell_sums(&self, index: usize) -> bool {
        self.diagnostics.dissipation.lists().get(index).is_none_or(|sums| !sums.is_empty())
    }

    /// Returns the sums over time by owned cell at an index: in the lists of [`CellDissipation::lists`], then the time
    /// integrals; empty if the problem does not need them.
    ///
    /// [`CellDissipation::lists`]: crate::solid::ledger::CellDissipation::lists
    pub(crate) fn cell_sums(&self, index: usize) -> Vec<f64> {
        let dissipation = self.diagnostics.dissipation.lists();
        match dissipation.get(index) {
            Some(sums) => self.owned_lane_values(sums).collect(),
            None => {
                let (_, sums) = &self.diagnostics.time_integrals[index - dissipation.len()];
                self.layout.owned_cells().map(|cell| sums[cell]).collect()
            }
        }
    }

    /// Whether the plastic dissipation is stored by cell.
    pub(crate) fn has_plastic_dissipation(&self) -> bool {
        !self.diagnostics.dissipation.plastic_dissipation.is_empty()
    }

    /// Returns the plastic dissipation in an owned cell, J/m³; it must be stored.
    pub(crate) fn plastic_dissipation(&self, cell: usize) -> f64 {
        let cell = self.layout.flat_lane_index::<T>(self.layout.local_cell(cell));
        self.diagnostics.dissipation.plastic_dissipation[cell]
    }

    /// Returns the values of owned cells, in the order of the cells, from a list by group and lane; none if the list is
    /// empty.
    fn owned_lane_values(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        let cells = self.layout.owned_cells().take(if values.is_empty() { 0 } else { usize::MAX });
        cells.map(|cell| values[self.layout.flat_lane_index::<T>(cell)])
    }

    /// Sets the sums that [`Self::cell_sums`] returns; no values if the problem does not need them.
    pub(crate) fn set_cell_sums(&mut self, index: usize, values: impl Iterator<Item = f64>) {
        let cells = self.layout.owned_cells();
        let mut dissipation = self.diagnostics.dissipation.lists_mut();
        let integral = index.wrapping_sub(dissipation.len());
        match dissipation.get_mut(index) {
            Some(own) => cells
                .zip(values)
                .for_each(|(cell, value)| own[self.layout.flat_lane_index::<T>(cell)] = value),
            None => {
                let (_, own) = &mut self.diagnostics.time_integrals[integral];
                cells.zip(values).for_each(|(cell, value)| own[cell] = value);
            }
        }
    }

    /// Returns a copy of the domain with the stresses mapped into their yield sets, for output.
    #[must_use]
    pub fn to_admissible(&self) -> Self {
        let mut mapped = self.clone();
        for row in 0..self.layout.rows {
            let tile = self.layout.row_segment(row);
            mapped.apply_return_mapping(&(0..self.layout.layers()), &tile, false);
        }
        mapped.diagnostics.work.clone_from(&self.diagnostics.work);
        mapped.diagnostics.dissipation.clone_from(&self.diagnostics.dissipation);
        mapped
    }

    /// Returns the first owned cell whose total stress its projection onto the yield set changes; `None` if there is
    /// none.
    pub(crate) fn first_cell_outside_yield_set(&self) -> Option<usize> {
        (0..self.grid.count()).find(|&cell| {
            let layer = self.layout.local_cell(cell) / self.layout.layer_cells();
            let factor = self.lane_laws.field_factor(layer);
            is_outside_yield_set(self.medium(cell), factor, &self.total_stress(cell))
        })
    }

    /// Sets the owned cells, in ascending order, that are recorded after each step from now on.
    pub(crate) fn watch_cells(&mut self, cells: impl Iterator<Item = usize>) {
        self.diagnostics.watched_cells = cells.collect();
    }

    /// Records the watched cells in layers that have completed a step of the pass.
    pub(super) fn record_watched_layers(&mut self, layers: Range<usize>, step: usize) {
        let mut records = std::mem::take(&mut self.diagnostics.records[step]);
        let [from, to] = [layers.start, layers.end].map(|layer| {
            let is_before =
                |cell: &usize| self.layout.local_cell(*cell) < layer * self.layout.layer_cells();
            self.diagnostics.watched_cells.partition_point(is_before)
        });
        let boundaries = self.boundaries.closing_boundaries.get(step);
        for &cell in &self.diagnostics.watched_cells[from..to] {
            self.output_cell_with(cell, boundaries, &mut records);
        }
        self.diagnostics.records[step] = records;
    }

    /// Moves the records of the pass to the end of `records`, by step and then by cell.
    pub(crate) fn drain_records(&mut self, records: &mut Vec<f64>) {
        self.diagnostics.records.iter_mut().for_each(|step| records.append(step));
    }

    /// Appends the output of an owned cell: all fields, with the total stress (initial stress included) mapped into its
    /// yield set, then the time integrals of the problem.
    pub fn output_cell(&self, cell: usize, values: &mut Vec<f64>) {
        self.output_cell_with(cell, self.closing_boundaries().as_ref(), values);
    }

    /// Appends the output of an owned cell as [`Self::output_cell`] does, with the boundaries that
    /// [`Self::closing_boundaries`] has returned once for many cells.
    pub(crate) fn output_cell_with(
        &self,
        cell: usize,
        boundaries: Option<&ClosingBoundaries<T>>,
        values: &mut Vec<f64>,
    ) {
        let local_cell = self.layout.local_cell(cell);
        let cell_values = self.complete_cell(local_cell, boundaries);
        let stress = self.stress_from_fields(&cell_values);
        let trial = add_scaled(&stress, &self.initial_stress(local_cell), 1.0);
        let stress = self.medium(cell).project(&trial).stress;
        for (&field, value) in self.fields().iter().zip(cell_values) {
            values.push(stress_component(field, &stress).unwrap_or_else(|| value.to_f64()));
        }
        values.extend(self.time_integrals(cell));
    }

    /// Returns the medium of an owned cell.
    fn medium(&self, cell: usize) -> &Medium {
        self.materials.medium(self.layout.local_cell(cell))
    }
}
