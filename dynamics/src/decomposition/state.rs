//! State of the cells of a process: snapshots, their restoration, initial values.

use super::{DecomposedDomain, Subdomain};
use crate::solid::domain::SolverReal;
use crate::solid::ledger::{Sums as _, WorkSums};
use crate::solid::region::Region;
use crate::solid::snapshot::{Snapshot, StateLists};
use models::solid::waves::SolidField;
use std::ops::Range;

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        let [fields, sums] = self.list_lengths();
        Snapshot {
            fields: (0..fields.len()).map(|index| self.field_list(index)).collect(),
            cell_sums: (0..sums.len()).map(|index| self.sum_list(index)).collect(),
            ..self.snapshot_without_lists()
        }
    }

    /// Returns the state without values by cell. All ranks call it.
    pub(crate) fn snapshot_without_lists(&self) -> Snapshot<T> {
        Snapshot {
            steps: self.subdomains.first().map_or(0, |subdomain| subdomain.domain.steps()),
            fields: Vec::new(),
            work_sums: self.work_sums().to_partial_sums(),
            cell_sums: Vec::new(),
            interlayer_history: self.interlayer_history(),
        }
    }

    /// Returns the work sums of all subdomains of all ranks.
    fn work_sums(&self) -> WorkSums {
        let mut sums = WorkSums::default();
        self.subdomains.iter().for_each(|subdomain| sums.merge(subdomain.domain.work()));
        self.add_ranks(sums)
    }

    /// Returns to the state of rest before the first step.
    pub(crate) fn reset(&mut self) {
        let [_, sums] = self.list_lengths();
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
            subdomain.domain.restore_work(0, WorkSums::default());
            for (index, length) in sums.iter().enumerate() {
                subdomain.domain.set_cell_sums(index, std::iter::repeat_n(0.0, *length));
            }
        }
    }

    /// Restores a snapshot of the cells of this process; `false` if it, or that of any rank, belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        self.restore_lists(snapshot, &mut &*snapshot)
    }

    /// Restores a state of the cells of this process, whose lists by cell are `lists`, as [`restore`](Self::restore) does. If a
    /// rank cannot read a list, other lists may have been restored.
    pub(crate) fn restore_lists(
        &mut self,
        state: &Snapshot<T>,
        lists: &mut dyn StateLists<T>,
    ) -> bool {
        let history_length: usize = self.own_interlayers().iter().map(|own| own.1).sum();
        let [fields, sums] = self.list_lengths();
        let fits = lists.lengths() == [fields, sums.clone()]
            && state.interlayer_history.len() == history_length;
        if !self.is_true_on_all_ranks(fits) || !self.is_same_on_all_ranks(state.steps) {
            return false;
        }
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
        }
        for (index, field) in self.fields().to_vec().into_iter().enumerate() {
            let values = lists.read_field(index);
            if !self.is_true_on_all_ranks(values.is_some()) {
                return false;
            }
            self.set_permuted_values(field, &values.unwrap_or_default());
        }
        for index in 0..sums.len() {
            let values = lists.read_sums(index);
            if !self.is_true_on_all_ranks(values.is_some()) {
                return false;
            }
            self.set_sum_list(index, &values.unwrap_or_default());
        }
        // The first subdomain holds the work sums of all; those of the others are zero.
        let mut work = match self.ranks.as_ref().is_none_or(|own| own.communicator.is_root()) {
            true => WorkSums::from_partial_sums(&state.work_sums),
            false => WorkSums::default(),
        };
        for subdomain in &mut self.subdomains {
            subdomain.domain.restore_work(state.steps, std::mem::take(&mut work));
        }
        self.set_interlayer_history(&state.interlayer_history);
        true
    }

    /// Returns whether all ranks call it with the same number.
    fn is_same_on_all_ranks(&self, own: usize) -> bool {
        self.ranks.as_ref().is_none_or(|ranks| {
            let message = (own as u64).to_le_bytes().to_vec();
            let all = ranks.communicator.gather_to_all(message.clone());
            all.iter().all(|other| *other == message)
        })
    }

    /// Returns whether `own` is true on all ranks, which all call it.
    fn is_true_on_all_ranks(&self, own: bool) -> bool {
        let odd = (!own).then_some([0, 0]);
        self.ranks.as_ref().map_or(odd, |ranks| ranks.find_least(odd)).is_none()
    }

    /// Sets the sums stored per cell at an index from those by cell of this process.
    fn set_sum_list(&mut self, index: usize, values: &[f64]) {
        for Subdomain { domain, region, .. } in &mut self.subdomains {
            let owned = std::array::from_fn(|axis| region.owned_range(axis));
            let own = Region::from_box(self.cells, self.own_cells.clone());
            let cells = own.cells_in_box(&owned);
            let values = cells.filter_map(|[cell, _]| values.get(cell).copied());
            domain.set_cell_sums(index, values);
        }
    }

    /// Returns the interlayers of the subdomains of this process, in the order of [`Self::interlayer_history`]: position
    /// of the face as [`Subdomain::interlayer_positions`] returns it, and number of history variables.
    pub(super) fn own_interlayers(&self) -> Vec<([usize; 3], usize)> {
        let mut faces = self.list_interlayers();
        faces.sort_unstable();
        faces
    }

    /// Lists the interlayers in the order of the subdomains.
    fn list_interlayers(&self) -> Vec<([usize; 3], usize)> {
        let layer_cells: usize = self.cells[..D - 1].iter().product();
        let subdomains = self.subdomains.iter();
        subdomains.flat_map(|subdomain| subdomain.interlayer_positions(layer_cells)).collect()
    }

    /// Returns the history variables of the interlayers of this process, in the order of [`Domain::interlayer_history`] of
    /// the whole grid.
    ///
    /// [`Domain::interlayer_history`]: crate::solid::domain::Domain::interlayer_history
    pub fn interlayer_history(&self) -> Vec<T> {
        let mut history = self.subdomains.iter().flat_map(|own| own.domain.interlayer_history());
        if self.subdomains.len() == 1 {
            return history.collect();
        }
        let face = |(position, variables)| (position, history.by_ref().take(variables).collect());
        let mut faces: Vec<([usize; 3], Vec<T>)> =
            self.list_interlayers().into_iter().map(face).collect();
        faces.sort_unstable_by_key(|face| face.0);
        faces.into_iter().flat_map(|face| face.1).collect()
    }

    /// Sets the history variables of the interlayers of this process in the order of [`Self::interlayer_history`].
    fn set_interlayer_history(&mut self, history: &[T]) {
        let mut end = 0;
        let range = |(position, variables): ([usize; 3], usize)| {
            end += variables;
            (position, end - variables..end)
        };
        let ranges: Vec<([usize; 3], Range<usize>)> =
            self.own_interlayers().into_iter().map(range).collect();
        let of_face = |(position, _): ([usize; 3], usize)| {
            let index = ranges.partition_point(|other| other.0.cmp(&position).is_lt());
            history.get(ranges[index].1.clone()).unwrap_or_default()
        };
        let mut own = self.list_interlayers().into_iter().flat_map(of_face).copied();
        for subdomain in &mut self.subdomains {
            subdomain.domain.set_interlayer_history(&mut own);
        }
    }

    /// Initialises interlayers with the mean velocity of the adjacent cells and without stress, see
    /// [`Domain::initialise_interlayers`](crate::solid::domain::Domain::initialise_interlayers). Adjacent cells of
    /// other subdomains are in the halo.
    pub fn initialise_interlayers(&mut self) {
        for Subdomain { domain, region, .. } in &mut self.subdomains {
            let cells = region.owned_global_cells();
            let value = |field: SolidField, cell: usize| {
                // A halo of copies of owned cells is filled by the first pass only.
                let value = match region.owned_index(cell) {
                    Some(cell) => domain.value(field, cell),
                    None => region
                        .first_region_cell(cell)
                        .and_then(|cell| domain.value_with_halo(field, cell)),
                };
                value.unwrap_or(T::ZERO)
            };
            let history = domain.initial_interlayer_history(&self.cells, |cell| cells[cell], value);
            domain.set_interlayer_history(&mut history.into_iter());
        }
    }

    /// Sets the values of a field by cell of this process (first axis fastest).
    pub fn set_field(&mut self, field: SolidField, values: &[T]) {
        self.set_permuted_values(field, &self.own_permutation().permute(values));
    }

    /// Sets the values of a field by cell of this process with permuted axes, in owned cells and halos, since output may
    /// read the halos.
    fn set_permuted_values(&mut self, field: SolidField, values: &[T]) {
        if let (None, [subdomain]) = (&self.ranks, self.subdomains.as_mut_slice()) {
            return subdomain.domain.set_field(field, values);
        }
        let Self { subdomains, own_cells, ranks, .. } = self;
        for Subdomain { domain, region, .. } in subdomains.iter_mut() {
            let cells = region.cells_in_box(own_cells);
            let values = cells.filter_map(|[cell, own]| Some((cell, *values.get(own)?)));
            domain.set_cells(field, values);
        }
        if let Some(ranks) = ranks {
            ranks.exchange_halos(own_cells, values, |subdomain, values| {
                subdomains[subdomain].domain.set_cells(field, values);
            });
        }
    }
}
