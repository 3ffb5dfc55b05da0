//! Halo exchange between neighbouring subdomains.
//!
//! Along the last axis a pass exchanges layers while it runs, see [`crate::solid::domain`]. Along the other axes halos
//! are exchanged before the pass, axis by axis from the first one on: the halo along an axis includes the cells in the
//! halos along lower axes, so that edges and corners are filled by two or three successive exchanges.

use super::interlayer_faces::LaneInterlayers;
use super::kernel::prefetch;
use super::layout::Layout;
use super::{Domain, SolverReal};
use crate::simd::{LaneGroup, Number};
use std::convert::Infallible;
use std::ops::Range;

/// Exchange of the halo with the neighbouring subdomains at the lower (0) and the upper end (1) of the axes of a
/// domain.
///
/// At each end a domain sends as many messages as it receives, and they arrive in the order in which the neighbour
/// sends them at its opposite end. A neighbour may be up to [`Domain::message_capacity`] messages ahead: `send` may
/// block beyond that number, and `receive` blocks until the message arrives. With channels of that capacity there is no
/// deadlock: a pass sends all that its neighbours need for a block of rows before it receives their layers of the same
/// block.
pub trait HaloExchange<T> {
    /// Error of an exchange that failed.
    type Error;

    /// Sends ranges of `values` to the neighbour at an end of an axis (0: lower, 1: upper).
    ///
    /// # Errors
    /// The neighbour cannot be reached.
    fn send(
        &mut self,
        axis: usize,
        end: usize,
        values: &[T],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Self::Error>;

    /// Receives the next message of the neighbour at an end of an axis into ranges of `values`.
    ///
    /// # Errors
    /// The neighbour cannot be reached, or does not send any more.
    fn receive(
        &mut self,
        axis: usize,
        end: usize,
        values: &mut [T],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Self::Error>;
}

/// No exchange: a domain without neighbours.
impl<T> HaloExchange<T> for () {
    type Error = Infallible;

    fn send(
        &mut self,
        _: usize,
        _: usize,
        _: &[T],
        _: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Infallible> {
        Ok(())
    }

    fn receive(
        &mut self,
        _: usize,
        _: usize,
        _: &mut [T],
        _: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Returns the number of groups that the field values of the cells in a box fill.
pub(super) fn packed_groups<T: SolverReal, const D: usize>(
    layout: &Layout<D>,
    cells: &[Range<usize>; D],
) -> usize {
    let count: usize = cells.iter().map(ExactSizeIterator::len).product();
    (count * layout.field_count).div_ceil(T::Lanes::COUNT)
}

/// Returns the number of messages of a piece of a halo: one with fields, and one with the history variables of interlayers
/// if the problem has any.
pub(super) fn messages_per_piece<T: SolverReal, const D: usize>(
    interfaces: &LaneInterlayers<T, D>,
) -> usize {
    if interfaces.has_interlayers() { 2 } else { 1 }
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Returns the number of messages that a neighbour at an end of an axis may send before this domain receives the
    /// first of them.
    pub fn message_capacity(&self, axis: usize) -> usize {
        let messages = |end: usize| match axis + 1 == D {
            true => self.layout.halo(axis)[end],
            false => self.layout.halo_pieces(axis, end, true).count(),
        };
        // A neighbour may be one block of rows ahead, or one pass.
        messages_per_piece(&self.interfaces) * 2 * messages(0).max(messages(1))
    }

    /// Applies the first x and y sweeps to a block of rows in those owned layers that the neighbours along the last
    /// axis need, then sends the rows whose sweeps are complete. The first step of the pass skips these sweeps. A
    /// domain that is periodic in place sends nothing: its halo holds copies of its owned layers.
    pub(super) fn sweep_and_send<H: HaloExchange<T::Lanes>>(
        &mut self,
        block: &Range<usize>,
        ready: &Range<usize>,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let owned = self.layout.owned_layers();
        for layer in owned.clone() {
            if !self.layout.is_in_any_halo(layer) {
                continue;
            }
            let mut loaded = block.start;
            while loaded < block.end {
                let rows = self.schedule.next_rows(loaded, block, (1, self.layout.rows));
                loaded = rows.end;
                let progress = [rows.start, rows.end].map(|row| self.row_progress(row)[1]);
                T::sweep_layer(self, layer, [rows, progress[0]..progress[1]]);
            }
            let depths = [layer - owned.start, owned.end - 1 - layer];
            let halo = self.layout.halo(D - 1);
            for end in (0..2).filter(|end| depths[*end] < halo[*end]) {
                neighbours.send(
                    D - 1,
                    end,
                    &self.field_data,
                    self.layout.exchanged_ranges(layer, ready),
                )?;
                if self.interfaces.has_interlayers() {
                    let ranges = self.interfaces.exchanged_ranges(&self.layout, layer, ready);
                    neighbours.send(D - 1, end, &self.interfaces.history, ranges)?;
                }
            }
        }
        Ok(())
    }

    /// Receives rows of the halo at an end of the last axis.
    pub(super) fn receive_layers<H: HaloExchange<T::Lanes>>(
        &mut self,
        end: usize,
        rows: &Range<usize>,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let first = [0, self.layout.owned_layers().end][end];
        for layer in first..first + self.layout.halo(D - 1)[end] {
            let ranges = self.layout.exchanged_ranges(layer, rows);
            neighbours.receive(D - 1, end, &mut self.field_data, ranges)?;
            if self.interfaces.has_interlayers() {
                let ranges = self.interfaces.exchanged_ranges(&self.layout, layer, rows);
                neighbours.receive(D - 1, end, &mut self.interfaces.history, ranges)?;
            }
        }
        Ok(())
    }

    /// Fills rows of the halo along the last axis with the periodic images of the owned layers.
    pub(super) fn fill_periodic_halo(&mut self, rows: &Range<usize>) {
        let (owned, layers) = (self.layout.owned_layers(), self.layout.layers());
        for index in (0..owned.start).chain(owned.end..layers) {
            let source =
                owned.start + (index + owned.len() * owned.start - owned.start) % owned.len();
            let [from, to] = [source, index].map(|layer| self.layout.data_range(layer, rows));
            self.field_data.copy_within(from, to.start);
            let [from, to] = [source, index]
                .map(|layer| self.interfaces.exchanged_ranges(&self.layout, layer, rows));
            for (from, to) in from.zip(to) {
                self.interfaces.history.copy_within(from, to.start);
            }
        }
    }

    /// Sends what the neighbours along the first axis need in the next pass. It depends on no message: subdomains of the
    /// same thread that have neighbours along that axis only can begin a pass one after the other, then complete it.
    ///
    /// # Errors
    /// The neighbours cannot be reached.
    pub(crate) fn begin_pass<H: HaloExchange<T::Lanes>>(
        &mut self,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        self.send_halo(0, neighbours)
    }

    /// Sends the halos of the neighbours along an axis other than the last one.
    fn send_halo<H: HaloExchange<T::Lanes>>(
        &mut self,
        axis: usize,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let halo = self.layout.halo(axis);
        for end in (0..2).filter(|end| halo[*end] > 0) {
            for piece in self.layout.halo_pieces(axis, end, true) {
                if axis == 0 {
                    let packed = self.pack_fields(&piece);
                    neighbours.send(axis, end, &packed, std::iter::once(0..packed.len()))?;
                } else {
                    let rows = self.layout.row_ranges(&piece);
                    neighbours.send(axis, end, &self.field_data, rows)?;
                }
                if self.interfaces.has_interlayers() {
                    let history = self.interfaces.pack_history(&self.layout, &piece);
                    neighbours.send(axis, end, &history, std::iter::once(0..history.len()))?;
                }
            }
        }
        Ok(())
    }

    /// Receives the halo at both ends of an axis other than the last one.
    fn receive_halo<H: HaloExchange<T::Lanes>>(
        &mut self,
        axis: usize,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        let halo = self.layout.halo(axis);
        let mut buffer = Vec::new();
        for end in (0..2).filter(|end| halo[*end] > 0) {
            for piece in self.layout.halo_pieces(axis, end, false) {
                if axis == 0 {
                    let groups = packed_groups::<T, D>(&self.layout, &piece);
                    buffer.resize(groups, T::Lanes::ZERO);
                    neighbours.receive(axis, end, &mut buffer, std::iter::once(0..groups))?;
                    self.unpack_fields(&piece, &buffer);
                } else {
                    let rows = self.layout.row_ranges(&piece);
                    neighbours.receive(axis, end, &mut self.field_data, rows)?;
                }
                if self.interfaces.has_interlayers() {
                    let groups = self.interfaces.packed_history_groups(&self.layout, &piece);
                    buffer.resize(groups, T::Lanes::ZERO);
                    neighbours.receive(axis, end, &mut buffer, std::iter::once(0..groups))?;
                    self.interfaces.unpack_history(&self.layout, &piece, &buffer);
                }
            }
        }
        Ok(())
    }

    /// Exchanges the halo along all axes but the last one; along the first one it has been sent.
    pub(super) fn exchange_halo<H: HaloExchange<T::Lanes>>(
        &mut self,
        neighbours: &mut H,
    ) -> Result<(), H::Error> {
        for axis in 0..D - 1 {
            if axis > 0 {
                self.send_halo(axis, neighbours)?;
            }
            self.receive_halo(axis, neighbours)?;
        }
        if self.interfaces.has_interlayers()
            && (0..D - 1).any(|axis| self.layout.halo(axis) != [0, 0])
        {
            self.interfaces.synchronise_copies(&self.layout);
        }
        Ok(())
    }

    /// Packs the fields of the cells in a box: along the first axis the cells of a halo are in some lanes of their rows
    /// only.
    fn pack_fields(&self, cells: &[Range<usize>; D]) -> Vec<T::Lanes> {
        let mut packed = vec![T::Lanes::ZERO; packed_groups::<T, D>(&self.layout, cells)];
        let (mut number, row_size) = (0, self.layout.row_size());
        self.layout.visit_values(cells, |group, lane| {
            prefetch(&self.field_data[group..], row_size, true);
            let value = self.field_data[group].lanes()[lane];
            packed[number / T::Lanes::COUNT].lanes_mut()[number % T::Lanes::COUNT] = value;
            number += 1;
        });
        packed
    }

    /// Unpacks the fields of the cells in a box.
    fn unpack_fields(&mut self, cells: &[Range<usize>; D], packed: &[T::Lanes]) {
        let (mut number, row_size) = (0, self.layout.row_size());
        self.layout.visit_values(cells, |group, lane| {
            prefetch(&self.field_data[group..], row_size, true);
            let value = packed[number / T::Lanes::COUNT].lanes()[number % T::Lanes::COUNT];
            self.field_data[group].lanes_mut()[lane] = value;
            number += 1;
        });
    }
}
