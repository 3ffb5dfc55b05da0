//! Where cells and fields stand in memory.
//!
//! A row along the first axis is folded into as many lanes as fill a cache line: of G groups, cell x is in group
//! x mod G and lane x div G, so that cells follow each other lane by lane. A row holds its fields one after the other,
//! each with all groups. Two ghosts stand behind the last cell in the row itself, and there are at least two groups:
//! the neighbours of a row's first and last groups are in the adjacent lanes, not farther.
//!
//! Where a domain is cut, or periodic, along the last axis, it has [`HALO`](crate::solid::line::HALO) halo layers for
//! each step of a pass.

use crate::simd::{Group, Real};
use crate::solid::reconstruction::GHOSTS;
use std::ops::Range;

/// Groups of a row, at most, that go through the middle of a step together, so that their layers stay in the cache.
const TILE: usize = 32;

/// Some groups of a row, the same in all layers; never beyond its end, so that sums do not depend on the tiling.
pub(super) struct Tile {
    pub(super) row: usize,
    pub(super) groups: Range<usize>,
}

impl Tile {
    /// A row of so many groups, in tiles that are as long as each other.
    pub(super) fn of_row(row: usize, groups: usize) -> impl Iterator<Item = Self> {
        let length = groups.div_ceil(groups.div_ceil(TILE));
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
    /// Own cells along each axis.
    pub(super) cells: [usize; D],
    /// Halo layers in front of the own ones and behind.
    pub(super) halo: [usize; 2],
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
    /// Parts of a row that go into the halo of a neighbour.
    pub(super) exchanged: Vec<Range<usize>>,
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
        self.cells[D - 1] + self.halo[0] + self.halo[1]
    }

    /// The own layers among all.
    pub(super) fn own_layers(&self) -> Range<usize> {
        self.halo[0]..self.layers() - self.halo[1]
    }

    /// The own cells among all.
    pub(super) fn own_cells(&self) -> Range<usize> {
        let first = self.halo[0] * self.layer_cells();
        first..first + self.cells.iter().product::<usize>()
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

    /// Where the fields of a tile begin in a layer, and its groups there.
    pub(super) fn groups_of(&self, layer: usize, tile: &Tile) -> (usize, Range<usize>) {
        let first = self.index(layer * self.rows + tile.row, tile.groups.start);
        (first.data, first.group..first.group + tile.groups.len())
    }

    /// A row in one tile.
    pub(super) fn whole_row(&self, row: usize) -> Tile {
        Tile { row, groups: 0..self.groups }
    }

    /// Where the fields of rows of a layer stand.
    pub(super) fn stored(&self, layer: usize, rows: &Range<usize>) -> Range<usize> {
        let first = layer * self.rows;
        (first + rows.start) * self.row_size()..(first + rows.end) * self.row_size()
    }

    /// Whether a layer is in the halo of this domain, or may be in a neighbour's.
    pub(super) fn is_exchanged(&self, layer: usize) -> bool {
        layer < 2 * self.halo[0] || layer + 2 * self.halo[1] >= self.layers()
    }

    /// Where the exchanged parts of rows of a layer stand.
    pub(super) fn pieces(
        &self,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> {
        let rows = layer * self.rows + rows.start..layer * self.rows + rows.end;
        let firsts = rows.map(|row| row * self.row_size());
        let pieces =
            |first| self.exchanged.iter().map(move |own| first + own.start..first + own.end);
        firsts.flat_map(pieces)
    }
}

/// Groups of a row: its cells, and the ghosts behind them; neighbours in other lanes are next to each other.
pub(super) fn groups<T: Real>(cells: usize) -> usize {
    (cells + GHOSTS).div_ceil(T::Lanes::COUNT).max(GHOSTS)
}

/// The same where an interlayer stands in front of every so many cells: a multiple of their number, so that they stand in
/// all lanes of a group or in none, unless rows became longer by more than a quarter.
pub(super) fn groups_of_blocks<T: Real>(cells: usize, block: usize) -> usize {
    let groups = groups::<T>(cells);
    let multiple = groups.next_multiple_of(block);
    if multiple <= groups + groups / 4 { multiple } else { groups }
}

/// Room of a field in a row of so many groups. No multiple of four cache lines, so that fewer cells at one place of
/// different fields and rows map to the same cache set.
pub(super) fn pitch(groups: usize) -> usize {
    if groups.is_multiple_of(4) { groups + 1 } else { groups }
}

/// Memory that a domain takes, bytes, in numbers of kind `T`: so many fields, and what goes with them.
pub fn memory<T: Real>(cells: &[usize], fields: usize) -> f64 {
    let length = cells.first().copied().unwrap_or(0).max(1);
    let count: f64 = cells.iter().map(|&count| count as f64).product();
    let groups = groups::<T>(length);
    let per_row = pitch(groups) * fields * size_of::<T::Lanes>() + groups * size_of::<u32>();
    count / length as f64 * per_row as f64 + count * size_of::<u16>() as f64
}
