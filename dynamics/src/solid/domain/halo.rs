//! What crosses the cuts of a domain.

use super::{Domain, SolverReal};
use std::ops::Range;

/// What crosses the cuts of a domain, at the ends towards smaller (0) and towards greater coordinates (1), in the
/// order of these.
pub(crate) trait Halo<T> {
    /// Hands over pieces of an outermost layer at an end.
    fn begin(&mut self, end: usize, data: &[T], pieces: impl Iterator<Item = Range<usize>>);

    /// Brings those of the neighbour at an end; where there is none they are left as they are.
    fn finish(&mut self, end: usize, data: &mut [T], pieces: impl Iterator<Item = Range<usize>>);
}

/// No neighbours.
impl<T> Halo<T> for () {
    fn begin(&mut self, _: usize, _: &[T], _: impl Iterator<Item = Range<usize>>) {}

    fn finish(&mut self, _: usize, _: &mut [T], _: impl Iterator<Item = Range<usize>>) {}
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Does the first x and y sweeps of a block of rows in the layers that are exchanged, then sends their
    /// finished rows. Layers that are their own halo are sent to nobody.
    pub(super) fn send(
        &mut self,
        block: &Range<usize>,
        ready: &Range<usize>,
        neighbours: &mut impl Halo<T::Lanes>,
    ) {
        let own = self.layout.own_layers();
        for layer in own.clone() {
            if !self.layout.is_exchanged(layer) {
                continue;
            }
            let mut loaded = block.start;
            while loaded < block.end {
                let rows = self.schedule.next_rows(loaded, block, (1, self.layout.rows));
                loaded = rows.end;
                self.sweep_layer(layer, &[rows, 0..0, 0..0], 0);
            }
            let depths = [layer - own.start, own.end - 1 - layer];
            for end in (0..2).filter(|end| depths[*end] < self.layout.halo[*end]) {
                neighbours.begin(end, &self.data, self.layout.pieces(layer, ready));
                if self.interfaces.is_any() {
                    let pieces = self.interfaces.pieces(&self.layout, layer, ready);
                    neighbours.begin(end, &self.interfaces.memory, pieces);
                }
            }
        }
    }

    /// Fills rows of the halo at an end.
    pub(super) fn receive(
        &mut self,
        end: usize,
        rows: &Range<usize>,
        neighbours: &mut impl Halo<T::Lanes>,
    ) {
        let first = [0, self.layout.own_layers().end][end];
        for layer in first..first + self.layout.halo[end] {
            neighbours.finish(end, &mut self.data, self.layout.pieces(layer, rows));
            if self.interfaces.is_any() {
                let pieces = self.interfaces.pieces(&self.layout, layer, rows);
                neighbours.finish(end, &mut self.interfaces.memory, pieces);
            }
        }
    }

    /// Fills rows of the halo from the own layers.
    pub(super) fn fill_own_halo(&mut self, rows: &Range<usize>) {
        let (own, layers) = (self.layout.own_layers(), self.layout.layers());
        for index in (0..own.start).chain(own.end..layers) {
            let source = own.start + (index + own.len() * own.start - own.start) % own.len();
            let [from, to] = [source, index].map(|layer| self.layout.stored(layer, rows));
            self.data.copy_within(from, to.start);
            let [from, to] =
                [source, index].map(|layer| self.interfaces.pieces(&self.layout, layer, rows));
            for (from, to) in from.zip(to) {
                self.interfaces.memory.copy_within(from, to.start);
            }
        }
    }
}
