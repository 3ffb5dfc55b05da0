//! Output of a domain: fields of cells at the time of the domain, records of watched cells, sums by cell.

use super::complete::ClosingBoundaries;
use super::{Domain, SolverReal};

use crate::solid::cell_laws::combined;
use crate::solid::medium::{Medium, component};
use std::ops::Range;

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the time integrals of the problem in an own cell, m or rad.
    pub(crate) fn integrals(&self, cell: usize) -> impl Iterator<Item = f64> {
        // Trapezoidal rule: removes half of the last value; alternating sweeps use the midpoint rule.
        let last = if self.scheme.alternates() { 0.0 } else { 0.5 * self.step };
        let is_under_way = self.schedule.steps > 0;
        let cell = self.layout.own_cell(cell);
        self.diagnostics.integrals.iter().map(move |(place, sums)| match is_under_way {
            true => sums[cell] - last * self.at(cell, *place).to_f64(),
            false => 0.0,
        })
    }

    /// Returns the number of time integrals by cell.
    pub(crate) fn integral_count(&self) -> usize {
        self.diagnostics.integrals.len()
    }

    /// Returns the sums over time by own cell: the lists of [`CellDissipation`], then the time integrals.
    ///
    /// [`CellDissipation`]: crate::solid::ledger::CellDissipation
    pub(crate) fn sums(&self) -> Vec<Vec<f64>> {
        let dissipation = self.diagnostics.dissipation.all();
        let dissipation = dissipation.map(|sums| self.of_own_lanes(sums).collect());
        let integrals = self.diagnostics.integrals.iter();
        let integrals =
            integrals.map(|(_, sums)| self.layout.own_cells().map(|cell| sums[cell]).collect());
        dissipation.into_iter().chain(integrals).collect()
    }

    /// Returns the values of own cells, in their order, from a list by group and lane; none if the list is empty.
    fn of_own_lanes(&self, values: &[f64]) -> impl Iterator<Item = f64> {
        let cells = self.layout.own_cells().take(if values.is_empty() { 0 } else { usize::MAX });
        cells.map(|cell| values[self.layout.lane_of::<T>(cell)])
    }

    /// Restores the sums that [`Self::sums`] returns.
    pub(crate) fn set_sums(&mut self, sums: &[Vec<f64>]) {
        let Some((dissipation, integrals)) = sums.split_at_checked(3) else { return };
        for (own, values) in self.diagnostics.dissipation.all_mut().into_iter().zip(dissipation) {
            for (cell, &value) in self.layout.own_cells().zip(values) {
                own[self.layout.lane_of::<T>(cell)] = value;
            }
        }
        for ((_, own), values) in self.diagnostics.integrals.iter_mut().zip(integrals) {
            for (cell, &value) in self.layout.own_cells().zip(values) {
                own[cell] = value;
            }
        }
    }

    /// Returns a copy of the domain with its stresses mapped into their yield sets, for output.
    #[must_use]
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        for row in 0..self.layout.rows {
            let tile = self.layout.whole_row(row);
            shown.correct(&(0..self.layout.layers()), &tile, false);
        }
        shown.diagnostics.work.clone_from(&self.diagnostics.work);
        shown.diagnostics.dissipation.clone_from(&self.diagnostics.dissipation);
        shown
    }

    /// Returns the first own cell whose total stress is not in its yield set.
    pub(crate) fn first_beyond_yield(&self) -> Option<usize> {
        (0..self.grid.count()).find(|&cell| {
            let stress = self.total_stress(cell);
            self.medium(cell).project(&stress).stress != stress
        })
    }

    /// Sets the own cells, in ascending order, that are recorded after each step from now on.
    pub(crate) fn watch(&mut self, cells: impl Iterator<Item = usize>) {
        self.diagnostics.watched = cells.collect();
    }

    /// Records the watched cells in layers that have completed a step of the pass.
    pub(super) fn record(&mut self, layers: Range<usize>, step: usize) {
        let mut records = std::mem::take(&mut self.diagnostics.records[step]);
        let [from, to] = [layers.start, layers.end].map(|layer| {
            let is_before =
                |cell: &usize| self.layout.own_cell(*cell) < layer * self.layout.layer_cells();
            self.diagnostics.watched.partition_point(is_before)
        });
        let sides = self.boundary.closing.get(step);
        for &cell in &self.diagnostics.watched[from..to] {
            self.output_cell_between(cell, sides, &mut records);
        }
        self.diagnostics.records[step] = records;
    }

    /// Moves the records of the pass to the end of `records`, by step and then by cell.
    pub(crate) fn drain_records(&mut self, records: &mut Vec<f64>) {
        self.diagnostics.records.iter_mut().for_each(|step| records.append(step));
    }

    /// Appends the output of an own cell: all fields, with the total stress (initial stress included) mapped into its
    /// yield set, then the time integrals of the problem.
    pub fn output_cell(&self, cell: usize, values: &mut Vec<f64>) {
        self.output_cell_between(cell, self.closing_boundaries().as_ref(), values);
    }

    /// Appends the output of an own cell as [`Self::output_cell`] does, with boundaries that
    /// [`Self::closing_boundaries`] has returned, to save time for many cells.
    pub(crate) fn output_cell_between(
        &self,
        cell: usize,
        sides: Option<&ClosingBoundaries<T>>,
        values: &mut Vec<f64>,
    ) {
        let of_all = self.layout.own_cell(cell);
        let own = self.completed(of_all, sides);
        let stress = self.stress_of(&own);
        let whole = combined(&stress, &self.initial_stress(of_all), 1.0);
        let stress = self.medium(cell).project(&whole).stress;
        for (&field, value) in self.fields().iter().zip(own) {
            values.push(component(field, &stress).unwrap_or_else(|| value.to_f64()));
        }
        values.extend(self.integrals(cell));
    }

    /// Returns the medium of an own cell.
    fn medium(&self, cell: usize) -> &Medium {
        self.materials.of(self.layout.own_cell(cell))
    }
}
