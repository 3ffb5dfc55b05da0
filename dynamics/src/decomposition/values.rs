//! Values of the cells of a process from those of its subdomains: fields, output, sums, and places of invalid states.

use super::threads::{SystemThreads, evaluate_each};
use super::{DecomposedDomain, Subdomain};
use crate::simd::Real;
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::domain::{Domain, SolverReal};
use crate::solid::ledger::{Energy, EnergySums, Ledger, LedgerSums, Sums};
use crate::solid::region::Region;
use models::solid::waves::SolidField;
use std::ops::Range;

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Returns the plastic dissipation by cell of this process, J/m³; empty if no medium yields.
    pub fn plastic_dissipation(&self) -> Vec<f64> {
        self.plastic_dissipation_in(self.own_layers())
    }

    /// Returns the plastic dissipation as [`plastic_dissipation`](Self::plastic_dissipation) does, in some layers of cells as
    /// [`output_values_in`](Self::output_values_in).
    pub fn plastic_dissipation_in(&self, layers: Range<usize>) -> Vec<f64> {
        let is_stored = |own: &Subdomain<T, D>| own.domain.has_plastic_dissipation();
        if !self.subdomains.iter().all(is_stored) {
            return Vec::new();
        }
        let found = self.evaluate_layers(layers, 1, |domain| {
            move |cell, values: &mut Vec<f64>| values.push(domain.plastic_dissipation(cell))
        });
        found.into_iter().next().unwrap_or_default()
    }

    /// Returns the range of all layers of the cells of this process across the last axis of the problem.
    fn own_layers(&self) -> Range<usize> {
        0..self.own_cells()[D - 1].len()
    }

    /// Returns the permutation of the axes of the cells of this process.
    pub(super) fn own_permutation(&self) -> AxisPermutation<D> {
        self.permutation.restrict_to_box(&self.own_cells)
    }

    /// Returns the number of cells of this process.
    pub(super) fn own_cell_count(&self) -> usize {
        self.own_cells.iter().map(ExactSizeIterator::len).product()
    }

    /// Returns the lengths of the lists by cell of a state: of the fields, and of the sums.
    pub(crate) fn list_lengths(&self) -> [Vec<usize>; 2] {
        let cells = self.own_cell_count();
        let sums = self.subdomains.first().map_or(Vec::new(), |Subdomain { domain, .. }| {
            let length = |index| if domain.has_cell_sums(index) { cells } else { 0 };
            (0..domain.cell_sum_count()).map(length).collect()
        });
        [vec![cells; self.fields().len()], sums]
    }

    /// Returns the sums stored by cell of this process at an index, see [`Domain::cell_sums`].
    pub(crate) fn sum_list(&self, index: usize) -> Vec<f64> {
        self.join_values(self.subdomains.iter().map(|own| own.domain.cell_sums(index)))
    }

    /// Returns the values of a field by cell of this process, in the order of [`Snapshot::fields`].
    ///
    /// [`Snapshot::fields`]: crate::solid::snapshot::Snapshot::fields
    pub(crate) fn field_list(&self, index: usize) -> Vec<T> {
        self.permuted_values(self.fields()[index]).unwrap_or_default()
    }

    /// Joins values by owned cell of the subdomains to those by cell of this process; empty if no subdomain has values.
    pub(super) fn join_values<V: Real>(
        &self,
        mut by_subdomain: impl Iterator<Item = Vec<V>>,
    ) -> Vec<V> {
        let is_layer = |own: &Subdomain<T, D>| {
            (0..D - 1).all(|axis| own.region.owned_range(axis) == self.own_cells[axis])
        };
        let mut joined = by_subdomain.next().unwrap_or_default();
        if self.subdomains.iter().all(is_layer) {
            if !joined.is_empty() {
                joined.reserve_exact(self.own_cell_count() - joined.len());
            }
            by_subdomain.for_each(|values| joined.extend(values));
            return joined;
        }
        // Subdomains of a single process along several axes. Any value for initialisation: all cells are overwritten.
        let Some(&any) = joined.first() else { return joined };
        let mut placed = vec![any; self.cells.iter().product()];
        let lists = std::iter::once(joined).chain(by_subdomain);
        for (Subdomain { region, .. }, values) in self.subdomains.iter().zip(lists) {
            for (cell, value) in region.owned_global_cell_iter().zip(values) {
                placed[cell] = value;
            }
        }
        placed
    }

    /// Returns work and dissipation of the steps so far, J.
    pub fn ledger(&self) -> Ledger {
        let mut sums = LedgerSums::default();
        let by_subdomain = self.map_subdomains(|domain| domain.ledger_sums());
        by_subdomain.iter().for_each(|own| sums.merge(own));
        self.add_ranks(sums).to_ledger(self.cell_volume())
    }

    /// Returns the energy of the deviation from the initial stress, J.
    pub fn energy(&self) -> Energy {
        let mut sums = EnergySums::default();
        let by_subdomain = self.map_subdomains(|domain| domain.energy_sums());
        by_subdomain.iter().for_each(|own| sums.merge(own));
        self.add_ranks(sums).to_energy(self.cell_volume())
    }

    /// Adds the sums of all ranks.
    pub(super) fn add_ranks<S: Sums>(&self, own: S) -> S {
        match &self.ranks {
            None => own,
            Some(ranks) => ranks.add_up(&own),
        }
    }

    /// Returns the volume of a cell, m³.
    fn cell_volume(&self) -> f64 {
        self.subdomains.first().map_or(0.0, |subdomain| subdomain.domain.grid().volume())
    }

    /// Calls `evaluate` for each subdomain, those of a single thread on the calling thread, others on several if they
    /// start.
    fn map_subdomains<V: Send>(&self, evaluate: impl Fn(&Domain<T, D>) -> V + Sync) -> Vec<V> {
        let domains: Vec<&Domain<T, D>> = self.subdomains.iter().map(|own| &own.domain).collect();
        let evaluate_all = |domains: &[&Domain<T, D>]| -> Vec<V> {
            domains.iter().map(|domain| evaluate(domain)).collect()
        };
        if domains.len() <= self.subdomains_per_thread {
            return evaluate_all(&domains);
        }
        let of_threads = domains.chunks(self.subdomains_per_thread);
        evaluate_each(&mut SystemThreads, of_threads, evaluate_all).into_iter().flatten().collect()
    }

    /// Returns field and cell of a non-finite value (for interlayers, the cell above the face); `None` if all are
    /// finite. Each subdomain reports its first one; that with the lowest cell in the order of permuted axes is
    /// returned.
    pub fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        let locate = |subdomain: &Subdomain<T, D>| {
            let (field, cell) = subdomain.domain.first_non_finite()?;
            let field = self.fields().iter().position(|own| *own == field)?;
            Some([subdomain.region.owned_global_cell(cell), field])
        };
        let [cell, field] = self.find_least(locate)?;
        Some((self.fields()[field], self.permutation.original_cell(cell)))
    }

    /// Returns the smallest of the pairs that `locate` returns for the subdomains of all ranks.
    fn find_least(
        &self,
        locate: impl Fn(&Subdomain<T, D>) -> Option<[usize; 2]>,
    ) -> Option<[usize; 2]> {
        let own = self.subdomains.iter().filter_map(locate).min();
        match &self.ranks {
            None => own,
            Some(ranks) => ranks.find_least(own),
        }
    }

    /// Returns the first cell, in the order of permuted axes, whose stress is outside its yield set; `None` if there is
    /// none.
    pub fn first_cell_outside_yield_set(&self) -> Option<usize> {
        let locate = |subdomain: &Subdomain<T, D>| {
            let cell = subdomain.domain.first_cell_outside_yield_set()?;
            Some([subdomain.region.owned_global_cell(cell), 0])
        };
        self.find_least(locate).map(|[cell, _]| self.permutation.original_cell(cell))
    }

    /// Returns the output quantities by cell of this process (first axis fastest), see [`Domain::output_cell`].
    pub fn output_values(&self) -> Vec<Vec<f64>> {
        self.output_values_in(self.own_layers())
    }

    /// Returns the output quantities as [`output_values`](Self::output_values) does, of the cells of some layers across the
    /// last axis of the problem, counted from the first layer of this process: all values together take as much memory as
    /// the fields.
    pub fn output_values_in(&self, layers: Range<usize>) -> Vec<Vec<f64>> {
        self.evaluate_layers(layers, self.quantity_count(), |domain| {
            let boundaries = domain.closing_boundaries();
            move |cell, values: &mut _| domain.output_cell_with(cell, boundaries.as_ref(), values)
        })
    }

    /// Evaluates `count` quantities in the cells of some layers of this process, as
    /// [`output_values_in`](Self::output_values_in); `evaluator`: function that appends those of an owned cell of a domain.
    fn evaluate_layers<'a, E: FnMut(usize, &mut Vec<f64>)>(
        &'a self,
        layers: Range<usize>,
        count: usize,
        evaluator: impl Fn(&'a Domain<T, D>) -> E,
    ) -> Vec<Vec<f64>> {
        let mut cells = self.own_cells();
        let first = cells[D - 1].start;
        cells[D - 1] = first + layers.start..first + layers.end;
        let cells = self.permutation.permute_axis_ranges(&cells);
        let cell_count = cells.iter().map(ExactSizeIterator::len).product();
        let mut quantities = vec![vec![0.0; cell_count]; count];
        let mut state = Vec::with_capacity(count);
        for Subdomain { domain, region, .. } in &self.subdomains {
            let owned = std::array::from_fn(|axis| region.owned_range(axis));
            let mut evaluate = evaluator(domain);
            for [own, place] in Region::from_box(self.cells, owned).cells_in_box(&cells) {
                state.clear();
                evaluate(own, &mut state);
                for (values, value) in quantities.iter_mut().zip(&state) {
                    values[place] = *value;
                }
            }
        }
        let permutation = self.permutation.restrict_to_box(&cells);
        quantities.into_iter().map(|values| permutation.unpermute(values)).collect()
    }

    /// Returns the stored values of a field by cell of this process (first axis fastest), without the completion of the step that output
    /// applies for alternating sweeps; `None` if there is no such field.
    pub fn values(&self, field: SolidField) -> Option<Vec<T>> {
        self.permuted_values(field).map(|values| self.own_permutation().unpermute(values))
    }

    /// Returns the stored values of a field by cell of this process, with permuted axes.
    pub(super) fn permuted_values(&self, field: SolidField) -> Option<Vec<T>> {
        let is_present = self.fields().contains(&field);
        // Values of one subdomain at a time are in memory besides the joined ones.
        is_present.then(|| {
            let values = |own: &Subdomain<T, D>| own.domain.values(field).unwrap_or_default();
            self.join_values(self.subdomains.iter().map(values))
        })
    }
}
