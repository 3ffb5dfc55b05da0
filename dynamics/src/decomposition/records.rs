//! Records of watched cells after each step.

use super::messages::{append_indices, append_list, take_indices, take_list};
use super::{DecomposedDomain, Subdomain};
use crate::solid::domain::SolverReal;

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Records all output quantities of these cells after each step and discards earlier records; cells outside the
    /// grid give zeros.
    pub fn watch_cells(&mut self, cells: &[usize]) {
        self.watched_cell_count = cells.len();
        for subdomain in &mut self.subdomains {
            subdomain.records.clear();
            let numbered_cells = cells.iter().enumerate();
            subdomain.watched_cells = numbered_cells
                .filter_map(|(watched_index, cell)| {
                    let cell = self.permutation.permuted_cell(*cell);
                    Some((watched_index, subdomain.region.owned_index(cell)?))
                })
                .collect();
            subdomain.watched_cells.sort_by_key(|(_, cell)| *cell);
            subdomain.domain.watch_cells(subdomain.watched_cells.iter().map(|(_, cell)| *cell));
        }
    }

    /// Records all output quantities of the watched cells in the present state.
    pub fn record_watched_cells(&mut self) {
        for subdomain in &mut self.subdomains {
            let boundaries = subdomain.domain.closing_boundaries();
            for &(_, cell) in &subdomain.watched_cells {
                subdomain.domain.output_cell_with(
                    cell,
                    boundaries.as_ref(),
                    &mut subdomain.records,
                );
            }
        }
    }

    /// Returns the records since the last call, by step, watched cell and output quantity; values as in
    /// [`Domain::output_cell`](crate::solid::domain::Domain::output_cell). With several ranks all call it, and only the
    /// root gets the records.
    pub fn take_records(&mut self) -> Vec<f64> {
        let (width, count) = (self.quantity_count(), self.watched_cell_count);
        let mut gathered = Vec::new();
        let mut place = |watched: &[usize], records: &[f64]| {
            if watched.is_empty() {
                return;
            }
            let steps = records.len() / (watched.len() * width);
            gathered.resize(steps * count * width, 0.0);
            let indices =
                (0..steps).flat_map(|step| watched.iter().map(move |own| step * count + own));
            for (index, values) in indices.zip(records.chunks_exact(width)) {
                gathered[index * width..(index + 1) * width].copy_from_slice(values);
            }
        };
        let watched = |subdomain: &Subdomain<T, D>| -> Vec<usize> {
            subdomain.watched_cells.iter().map(|own| own.0).collect()
        };
        match &self.ranks {
            None => self.subdomains.iter().for_each(|own| place(&watched(own), &own.records)),
            Some(ranks) => {
                let mut message = Vec::new();
                for subdomain in &self.subdomains {
                    append_indices(&mut message, &watched(subdomain));
                    append_list(&mut message, &subdomain.records);
                }
                ranks.communicator.gather(message, &mut |_, message| {
                    let mut message = message.as_slice();
                    while !message.is_empty() {
                        let watched = take_indices(&mut message);
                        place(&watched, &take_list(&mut message));
                    }
                });
            }
        }
        self.subdomains.iter_mut().for_each(|own| own.records.clear());
        gathered
    }
}
