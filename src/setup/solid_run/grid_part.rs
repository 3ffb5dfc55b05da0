//! Cells of the grid whose values this process computes: those of its rank, or all.

use dynamics::decomposition::communicator::{Communicator, SingleProcess};
use std::ops::Range;
use std::sync::Arc;

/// Box of cells of the grid, and the ranks that compute the others.
pub(crate) struct GridPart {
    /// Number of cells of the whole grid along each axis.
    grid_cells: Vec<usize>,
    /// Cells of this process along each axis.
    own_cells: Vec<Range<usize>>,
    communicator: Arc<dyn Communicator>,
}

impl GridPart {
    /// Creates the part of a rank with the cells `own_cells` of a grid; without a communicator, that of a single process.
    pub(super) fn new(
        grid_cells: &[usize],
        own_cells: &[Range<usize>],
        communicator: Option<Arc<dyn Communicator>>,
    ) -> Self {
        Self {
            grid_cells: grid_cells.to_vec(),
            own_cells: own_cells.to_vec(),
            communicator: communicator.unwrap_or_else(|| Arc::new(SingleProcess)),
        }
    }

    /// Returns the number of cells of this process.
    pub(super) fn cell_count(&self) -> usize {
        self.own_cells.iter().map(ExactSizeIterator::len).product()
    }

    /// Iterates over the indices in the whole grid of the cells of this process, first axis fastest.
    pub(super) fn cells(&self) -> impl Iterator<Item = usize> {
        (0..self.cell_count()).map(|mut number| {
            let (mut cell, mut stride) = (0, 1);
            for (own, count) in self.own_cells.iter().zip(&self.grid_cells) {
                cell += (own.start + number % own.len()) * stride;
                number /= own.len();
                stride *= count;
            }
            cell
        })
    }

    /// Replaces values by the greatest ones of all ranks, by NaN if one is NaN. All ranks call it.
    pub(super) fn take_greatest(&self, values: &mut [f64]) {
        let encode = |values: &[f64]| values.iter().flat_map(|own| own.to_le_bytes()).collect();
        let decode = |values: &mut [f64], message: &[u8]| {
            for (own, bytes) in values.iter_mut().zip(message.as_chunks().0) {
                let other = f64::from_le_bytes(*bytes);
                *own = if own.is_nan() || *own >= other { *own } else { other };
            }
        };
        let own = encode(values);
        self.communicator.gather(own, &mut |_, message| decode(values, &message));
        let greatest = self.communicator.broadcast(encode(values));
        decode(values, &greatest);
    }

    /// Returns the first cell of the whole grid with a property; `None` if no cell has it. All ranks call it.
    pub(super) fn find_first_cell(&self, has_property: impl Fn(usize) -> bool) -> Option<usize> {
        // Indices of cells are exact as `f64`.
        let own = self.cells().find(|cell| has_property(*cell));
        let mut negative = [own.map_or(f64::NEG_INFINITY, |cell| -(cell as f64))];
        self.take_greatest(&mut negative);
        negative[0].is_finite().then_some(-negative[0] as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::decomposition::communicator::ThreadRank;

    #[test]
    fn ranks_agree_on_cells_and_maxima() {
        let found: Vec<_> = std::thread::scope(|scope| {
            let start = |rank: ThreadRank| {
                scope.spawn(move || {
                    let first = rank.rank() * 2;
                    let own = [1..3, first..first + 2];
                    let part = GridPart::new(&[3, 4], &own, Some(Arc::new(rank)));
                    let cells: Vec<usize> = part.cells().collect();
                    let mut greatest = [first as f64, -1.0, if first > 0 { f64::NAN } else { 7.0 }];
                    part.take_greatest(&mut greatest);
                    let cell = part.find_first_cell(|cell| cell > 4);
                    (cells, greatest, cell, part.find_first_cell(|_| false))
                })
            };
            let ranks: Vec<_> = ThreadRank::create_all(2).into_iter().map(start).collect();
            ranks.into_iter().map(|own| own.join().expect("no panic")).collect()
        });
        assert_eq!((&found[0].0, &found[1].0), (&vec![1, 2, 4, 5], &vec![7, 8, 10, 11]));
        for (_, greatest, cell, absent) in found {
            assert_eq!((greatest[0], greatest[1], cell, absent), (2.0, -1.0, Some(5), None));
            assert!(greatest[2].is_nan());
        }
    }
}
