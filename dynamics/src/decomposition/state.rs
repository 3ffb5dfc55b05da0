//! State of the whole grid: snapshots, their restoration, initial values.

use super::messages::{append_indices, append_list, take_indices, take_list};
use super::{DecomposedDomain, Subdomain};
use crate::solid::domain::SolverReal;
use crate::solid::ledger::{Sums as _, WorkSums};
use crate::solid::region::Region;
use crate::solid::snapshot::Snapshot;
use models::solid::waves::SolidField;
use std::ops::Range;

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Returns the state for a checkpoint.
    pub fn snapshot(&self) -> Snapshot<T> {
        let fields = self.fields().to_vec();
        Snapshot {
            steps: self.subdomains.first().map_or(0, |subdomain| subdomain.domain.steps()),
            fields: fields.into_iter().filter_map(|field| self.permuted_values(field)).collect(),
            work_sums: self.work_sums().to_partial_sums(),
            cell_sums: self.cell_sums(),
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
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
            subdomain.domain.restore_work(0, WorkSums::default());
            let mut sums = subdomain.domain.cell_sums();
            sums.iter_mut().for_each(|own| own.fill(0.0));
            subdomain.domain.set_cell_sums(&sums);
        }
    }

    /// Restores a snapshot, of the root if there are several ranks; `false` if it belongs to another problem.
    pub fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
        let cells: usize = self.cells.iter().product();
        let fields = self.fields().to_vec();
        // All ranks take part in both lists.
        let (sums, history) = (self.cell_sums(), self.interlayer_history());
        let fits = snapshot.fields.len() == fields.len()
            && snapshot.fields.iter().all(|values| values.len() == cells)
            && snapshot.cell_sums.iter().map(Vec::len).eq(sums.iter().map(Vec::len))
            && snapshot.interlayer_history.len() == history.len();
        let mut root_state = [usize::from(fits), snapshot.steps];
        if let Some(ranks) = &self.ranks {
            root_state = ranks.broadcast_indices(root_state);
        }
        let [fits, steps] = root_state;
        if fits == 0 {
            return false;
        }
        for subdomain in &mut self.subdomains {
            subdomain.domain.clear();
        }
        for (index, field) in fields.into_iter().enumerate() {
            self.restore_field(field, snapshot.fields.get(index).map_or(&[], Vec::as_slice));
        }
        // The first subdomain holds the work sums of all; those of the others are zero.
        let mut work = match self.ranks.as_ref().is_none_or(|own| own.communicator.is_root()) {
            true => WorkSums::from_partial_sums(&snapshot.work_sums),
            false => WorkSums::default(),
        };
        for subdomain in &mut self.subdomains {
            subdomain.domain.restore_work(steps, std::mem::take(&mut work));
        }
        self.set_cell_sums(&snapshot.cell_sums, sums.len());
        self.set_interlayer_history(&snapshot.interlayer_history);
        true
    }

    /// Sets the values of a field by cell of the whole grid with permuted axes, those of the root if there are several
    /// ranks.
    fn restore_field(&mut self, field: SolidField, values: &[T]) {
        let Some(ranks) = &self.ranks else { return self.set_permuted_values(field, values) };
        let by_subdomain = ranks.scatter_values(values, Region::global_cells);
        for (subdomain, values) in self.subdomains.iter_mut().zip(by_subdomain) {
            subdomain.domain.set_in_all_cells(field, |cell| values.get(cell).copied());
        }
    }

    /// Sets the sums stored per cell, of `kinds` kinds, from those by cell of the whole grid, of the root if there are
    /// several ranks.
    fn set_cell_sums(&mut self, sums: &[Vec<f64>], kinds: usize) {
        let mut by_subdomain = vec![Vec::new(); self.subdomains.len()];
        for kind in 0..kinds {
            let grid_values = sums.get(kind).map_or(&[][..], Vec::as_slice);
            let select_owned = |region: &Region<D>| -> Vec<f64> {
                let cells = region.owned_global_cells().into_iter();
                cells.filter_map(|cell| grid_values.get(cell).copied()).collect()
            };
            let values = match &self.ranks {
                None => self.subdomains.iter().map(|own| select_owned(&own.region)).collect(),
                Some(ranks) => ranks.scatter_values(grid_values, Region::owned_global_cells),
            };
            by_subdomain.iter_mut().zip(values).for_each(|(own, values)| own.push(values));
        }
        for (subdomain, sums) in self.subdomains.iter_mut().zip(by_subdomain) {
            subdomain.domain.set_cell_sums(&sums);
        }
    }

    /// Returns the interlayers of the subdomains of this rank: position of the face as
    /// [`Subdomain::interlayer_positions`] returns it, and number of history variables.
    fn own_interlayers(&self) -> Vec<([usize; 3], usize)> {
        let layer_cells: usize = self.cells[..D - 1].iter().product();
        let subdomains = self.subdomains.iter();
        subdomains.flat_map(|subdomain| subdomain.interlayer_positions(layer_cells)).collect()
    }

    /// Returns the history variables of all interlayers, in the order of [`Domain::interlayer_history`] of the whole
    /// grid; those of all ranks at the root, and none at other ranks.
    ///
    /// [`Domain::interlayer_history`]: crate::solid::domain::Domain::interlayer_history
    pub fn interlayer_history(&self) -> Vec<T> {
        let own = || self.subdomains.iter().flat_map(|own| own.domain.interlayer_history());
        let mut faces: Vec<([usize; 3], Vec<T>)> = Vec::new();
        let mut insert = |interlayers: Vec<([usize; 3], usize)>, history: Vec<T>| {
            let mut history = history.into_iter();
            let face =
                |(position, variables)| (position, history.by_ref().take(variables).collect());
            faces.extend(interlayers.into_iter().map(face));
        };
        match &self.ranks {
            None if self.subdomains.len() == 1 => return own().collect(),
            None => insert(self.own_interlayers(), own().collect()),
            Some(ranks) => {
                let mut message = Vec::new();
                append_interlayers(&mut message, &self.own_interlayers());
                append_list(&mut message, &own().collect::<Vec<T>>());
                ranks.communicator.gather(message, &mut |_, message| {
                    let mut message = message.as_slice();
                    let interlayers = take_interlayers(&mut message);
                    insert(interlayers, take_list(&mut message));
                });
            }
        }
        faces.sort_unstable_by_key(|face| face.0);
        faces.into_iter().flat_map(|face| face.1).collect()
    }

    /// Sets the history variables of all interlayers in the order of [`Self::interlayer_history`], from those of the
    /// root if there are several ranks.
    fn set_interlayer_history(&mut self, history: &[T]) {
        let by_rank = match &self.ranks {
            None => vec![self.own_interlayers()],
            Some(ranks) => {
                let (mut by_rank, mut message) = (Vec::new(), Vec::new());
                append_interlayers(&mut message, &self.own_interlayers());
                ranks.communicator.gather(message, &mut |_, message| {
                    by_rank.push(take_interlayers(&mut message.as_slice()));
                });
                by_rank
            }
        };
        let mut all: Vec<([usize; 3], usize)> = by_rank.iter().flatten().copied().collect();
        all.sort_unstable();
        let mut end = 0;
        let range = |(position, variables): ([usize; 3], usize)| {
            end += variables;
            (position, end - variables..end)
        };
        let ranges: Vec<([usize; 3], Range<usize>)> = all.into_iter().map(range).collect();
        let select = |interlayers: &[([usize; 3], usize)]| -> Vec<T> {
            let of_face = |(position, _): &([usize; 3], usize)| {
                let index = ranges.partition_point(|other| other.0.cmp(position).is_lt());
                history.get(ranges[index].1.clone()).unwrap_or_default()
            };
            interlayers.iter().flat_map(of_face).copied().collect()
        };
        let own = match &self.ranks {
            None => select(&by_rank[0]),
            Some(ranks) => {
                let received = ranks.communicator.scatter(&mut |rank| {
                    let mut message = Vec::new();
                    append_list(&mut message, &select(&by_rank[rank]));
                    message
                });
                take_list(&mut received.as_slice())
            }
        };
        let mut own = own.into_iter();
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

    /// Sets the values of a field by cell (first axis fastest).
    pub fn set_field(&mut self, field: SolidField, values: &[T]) {
        self.set_permuted_values(field, &self.permutation.permute(values));
    }

    /// Sets the values of a field by cell of the whole grid with permuted axes, in owned cells and halos, since output
    /// may read the halos; all ranks have them.
    fn set_permuted_values(&mut self, field: SolidField, values: &[T]) {
        if let (None, [subdomain]) = (&self.ranks, self.subdomains.as_mut_slice()) {
            return subdomain.domain.set_field(field, values);
        }
        for subdomain in &mut self.subdomains {
            let cells = subdomain.region.global_cells();
            subdomain.domain.set_in_all_cells(field, |cell| values.get(cells[cell]).copied());
        }
    }
}

/// Appends the positions of interlayers and their numbers of history variables to a message.
fn append_interlayers(message: &mut Vec<u8>, interlayers: &[([usize; 3], usize)]) {
    let numbers = interlayers.iter().flat_map(|(position, variables)| {
        position.iter().chain(std::iter::once(variables)).copied()
    });
    append_indices(message, &numbers.collect::<Vec<usize>>());
}

/// Removes what [`append_interlayers`] has appended from the front of a message.
fn take_interlayers(message: &mut &[u8]) -> Vec<([usize; 3], usize)> {
    let numbers = take_indices(message);
    let (faces, _) = numbers.as_chunks();
    faces
        .iter()
        .map(|[layer, axis, cell, variables]| ([*layer, *axis, *cell], *variables))
        .collect()
}
