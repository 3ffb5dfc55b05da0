//! Where cells and fields stand in memory.
//!
//! A row along the first axis is folded into as many lanes as fill a cache line: of G groups, cell x is in group
//! x mod G and lane x div G, so that cells follow each other lane by lane. A row holds its fields one after the other,
//! each with all groups. Two ghosts stand behind the last cell in the row itself, and there are at least two groups:
//! the neighbours of a row's first and last groups are in the adjacent lanes, not farther.
//!
//! Where a domain is cut along an axis, or periodic along the last one, it has a halo of
//! [`HALO`](crate::solid::line::HALO) cells for each step of a pass, and [`GHOSTS`] more along the first axis where sweeps
//! alternate. Cells are counted with those of the halo.

use crate::simd::{Group, Real};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use std::cmp::Ordering;
use std::ops::Range;

/// Groups of a row, at most, that go through the middle of a step together, so that their layers stay in the cache.
const SEGMENT: usize = 32;

/// Some adjacent groups of a row, the same in all layers.
pub(super) struct RowSegment {
    pub(super) row: usize,
    pub(super) groups: Range<usize>,
}

impl RowSegment {
    /// The segments of a row of `groups` groups, of nearly equal length.
    pub(super) fn of_row(row: usize, groups: usize) -> impl Iterator<Item = Self> {
        let length = groups.div_ceil(groups.div_ceil(SEGMENT));
        let starts = (0..groups).step_by(length);
        starts.map(move |start| Self { row, groups: start..groups.min(start + length) })
    }
}

/// A group on the path of a sweep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupIndex {
    /// Its number.
    pub(crate) group: usize,
    /// Where its first field stands in the data: the others follow at their places.
    pub(crate) data: usize,
}

impl GroupIndex {
    /// The same group of another line.
    #[inline(always)]
    pub(crate) fn of_line(self, line: usize, across: Self) -> Self {
        Self { group: self.group + line * across.group, data: self.data + line * across.data }
    }
}

/// Shape of a domain and the order of its data: by row, field and group.
#[derive(Clone, Debug)]
pub(super) struct Layout<const D: usize> {
    /// Cells along each axis, those of the halo included.
    pub(super) cells: [usize; D],
    /// The own cells among these.
    pub(super) own: [Range<usize>; D],
    /// By group of a row, the lanes of own cells.
    pub(super) own_lanes: Vec<u16>,
    /// Whether the own layers are each other's halo.
    pub(super) periodic_in_place: bool,
    /// Number of fields.
    pub(super) fields: usize,
    /// Groups of a row.
    pub(super) groups: usize,
    /// Groups from the beginning of a field in a row to that of the next one: the place of a field is this times its
    /// index.
    pub(super) pitch: usize,
    /// Rows of a layer across the last axis.
    pub(super) rows: usize,
    /// Fields that go into the halo of a neighbour along the last axis, as ranges of a row.
    pub(super) exchanged_fields: Vec<Range<usize>>,
}

impl<const D: usize> Layout<D> {
    /// Cells of a layer across the last axis.
    pub(super) fn layer_cells(&self) -> usize {
        self.cells[..D - 1].iter().product()
    }

    /// Groups of a layer across the last axis.
    pub(super) fn layer_groups(&self) -> usize {
        self.rows * self.groups
    }

    /// All layers, the halo included.
    pub(super) fn layers(&self) -> usize {
        self.cells[D - 1]
    }

    /// The own layers among all.
    pub(super) fn own_layers(&self) -> Range<usize> {
        self.own[D - 1].clone()
    }

    /// Cells of the halo in front of the own ones along an axis and behind.
    pub(super) fn halo(&self, axis: usize) -> [usize; 2] {
        [self.own[axis].start, self.cells[axis] - self.own[axis].end]
    }

    /// The cells in a box among all, the first axis running fastest.
    pub(super) fn cells_in(&self, ranges: &[Range<usize>; D]) -> impl Iterator<Item = usize> {
        let counts = ranges.each_ref().map(ExactSizeIterator::len);
        let (first, cells) = (ranges.each_ref().map(|range| range.start), self.cells);
        (0..counts.iter().product()).map(move |index| box_cell(index, &counts, &first, &cells))
    }

    /// The own cells among all, in their order.
    pub(super) fn own_cells(&self) -> impl Iterator<Item = usize> {
        self.cells_in(&self.own)
    }

    /// The cells at an end of an axis that are sent there, or those that are received: all cells along lower axes, own cells
    /// along higher ones, so that edges and corners arrive by successive exchanges.
    pub(super) fn strip(&self, axis: usize, end: usize, is_sent: bool) -> [Range<usize>; D] {
        let (own, width) = (self.own[axis].clone(), self.halo(axis)[end]);
        let along = match (end, is_sent) {
            (0, true) => own.start..own.start + width,
            (0, false) => own.start - width..own.start,
            (_, true) => own.end - width..own.end,
            (_, false) => own.end..own.end + width,
        };
        std::array::from_fn(|other| match other.cmp(&axis) {
            Ordering::Less => 0..self.cells[other],
            Ordering::Equal => along.clone(),
            Ordering::Greater => self.own[other].clone(),
        })
    }

    /// An own cell, by its number among these, among all.
    pub(super) fn own_cell(&self, number: usize) -> usize {
        let counts = self.own.each_ref().map(ExactSizeIterator::len);
        box_cell(number, &counts, &self.own.each_ref().map(|range| range.start), &self.cells)
    }

    /// The number of a cell among the own ones, if it is one.
    pub(super) fn own_number(&self, cell: usize) -> Option<usize> {
        let (mut rest, mut number, mut stride) = (cell, 0, 1);
        for (own, count) in self.own.iter().zip(self.cells) {
            let place = rest % count;
            if !own.contains(&place) {
                return None;
            }
            number += (place - own.start) * stride;
            (rest, stride) = (rest / count, stride * own.len());
        }
        Some(number)
    }

    /// The rows of all layers that have own cells.
    pub(super) fn own_rows(&self) -> impl Iterator<Item = usize> {
        let rows = if D == 2 { 0..1 } else { self.own[1].clone() };
        let of_layer = move |layer: usize| rows.clone().map(move |row| layer * self.rows + row);
        self.own_layers().flat_map(of_layer)
    }

    /// Whether a row of a layer has own cells.
    pub(super) fn is_own_row(&self, layer: usize, row: usize) -> bool {
        self.own_layers().contains(&layer) && (D == 2 || self.own[1].contains(&row))
    }

    /// From the beginning of a row in the data to that of the next one.
    #[inline(always)]
    pub(super) fn row_size(&self) -> usize {
        self.fields * self.pitch
    }

    /// A group of a row.
    #[inline(always)]
    pub(super) fn index(&self, row: usize, group: usize) -> GroupIndex {
        GroupIndex { group: row * self.groups + group, data: row * self.row_size() + group }
    }

    /// Group and lane of a cell.
    #[inline(always)]
    pub(super) fn slot(&self, cell: usize) -> (GroupIndex, usize) {
        let length = self.cells[0];
        let (row, x) = (cell / length, cell % length);
        (self.index(row, x % self.groups), x / self.groups)
    }

    /// The place of a cell among the lanes of all groups.
    pub(super) fn lane_of<T: Real>(&self, cell: usize) -> usize {
        let (index, lane) = self.slot(cell);
        index.group * T::Lanes::COUNT + lane
    }

    /// The cell in a lane of a group, if there is one.
    #[inline(always)]
    pub(super) fn cell_of(&self, group: usize, lane: usize) -> Option<usize> {
        let (row, place) = (group / self.groups, group % self.groups);
        let x = lane * self.groups + place;
        (x < self.cells[0]).then(|| row * self.cells[0] + x)
    }

    /// Where the fields of a segment begin in a layer, and its groups there.
    pub(super) fn groups_of(&self, layer: usize, tile: &RowSegment) -> (usize, Range<usize>) {
        let first = self.index(layer * self.rows + tile.row, tile.groups.start);
        (first.data, first.group..first.group + tile.groups.len())
    }

    /// A row in one segment.
    pub(super) fn whole_row(&self, row: usize) -> RowSegment {
        RowSegment { row, groups: 0..self.groups }
    }

    /// Where the fields of rows of a layer stand.
    pub(super) fn stored(&self, layer: usize, rows: &Range<usize>) -> Range<usize> {
        let first = layer * self.rows;
        (first + rows.start) * self.row_size()..(first + rows.end) * self.row_size()
    }

    /// Whether a layer is in the halo of this domain, or may be in a neighbour's.
    pub(super) fn is_in_a_halo(&self, layer: usize) -> bool {
        let [front, behind] = self.halo(D - 1);
        layer < 2 * front || layer + 2 * behind >= self.layers()
    }

    /// Where the exchanged fields of rows of a layer stand.
    pub(super) fn pieces(
        &self,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> {
        let rows = layer * self.rows + rows.start..layer * self.rows + rows.end;
        let firsts = rows.map(|row| row * self.row_size());
        let pieces =
            |first| self.exchanged_fields.iter().map(move |own| first + own.start..first + own.end);
        firsts.flat_map(pieces)
    }
}

/// A cell of a box, whose first cell and counts are given, among all.
fn box_cell<const D: usize>(
    mut index: usize,
    counts: &[usize; D],
    first: &[usize; D],
    cells: &[usize; D],
) -> usize {
    let (mut cell, mut stride) = (0, 1);
    for axis in 0..D {
        cell += (first[axis] + index % counts[axis]) * stride;
        index /= counts[axis];
        stride *= cells[axis];
    }
    cell
}

/// Groups of a row: its cells, and the ghosts behind them; neighbours in other lanes are next to each other.
fn groups<T: Real>(cells: usize) -> usize {
    (cells + GHOSTS).div_ceil(T::Lanes::COUNT).max(GHOSTS)
}

/// Groups of a row of `cells` cells. Where interlayers stand at regular distances along rows the number is a multiple of
/// that distance, so that interlayers stand in all lanes of a group or in none, unless rows became longer by more than a quarter.
pub(super) fn groups_of_rows<T: Real, const D: usize>(problem: &Problem<D>, cells: usize) -> usize {
    let block = problem.interlayers_across(0).map_or(1, |own| own.every);
    let groups = groups::<T>(cells);
    let multiple = groups.next_multiple_of(block);
    if multiple <= groups + groups / 4 { multiple } else { groups }
}

/// Distance of two fields of a row, in groups, for rows of `groups` groups. No multiple of four cache lines, so that fewer cells at one place of
/// different fields and rows map to the same cache set.
pub(super) fn pitch(groups: usize) -> usize {
    if groups.is_multiple_of(4) { groups + 1 } else { groups }
}

/// Memory of the fields of a domain and of its materials, bytes.
pub fn memory<T: Real>(cells: &[usize], fields: usize) -> f64 {
    let length = cells.first().copied().unwrap_or(0).max(1);
    let count: f64 = cells.iter().map(|&count| count as f64).product();
    let groups = groups::<T>(length);
    let per_row = pitch(groups) * fields * size_of::<T::Lanes>() + groups * size_of::<u32>();
    count / length as f64 * per_row as f64 + count * size_of::<u16>() as f64
}
