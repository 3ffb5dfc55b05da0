//! Memory layout of cells and fields.
//!
//! A row along the first axis is folded into the lanes of a cache line: with G groups, cell x is in group x mod G and
//! lane x div G, so that consecutive cells lie in the same lane of consecutive groups. A row stores its fields one
//! after the other, each with all groups. The ghosts follow the last cell within the row itself, and there are at least
//! as many groups as ghosts: the neighbours of the first and the last groups of a row are in the adjacent lanes, not
//! farther away.
//!
//! If a domain has neighbouring subdomains along an axis, or is periodic along the last one, it has a halo of
//! [`Slopes::halo`](crate::solid::line::Slopes::halo) cells for each step of a pass, and
//! as many as ghosts more along the first axis for alternating sweeps. Cell indices count all cells, halo included, except
//! indices of owned cells, which count owned cells.

use super::kernel::CarriedState;
use super::schedule::{CHUNK_SIZE, max_pass_steps};
use crate::simd::{LaneGroup, Real};
use crate::solid::interlayers::Interlayers;
use crate::solid::problem::Problem;
use crate::solid::reconstruction::Slopes;
use std::cmp::Ordering;
use std::ops::Range;

/// Largest number of field values of a message with several layers of a halo: while one is packed or unpacked, it is twice in
/// memory, and a rank unpacks one while it waits for the next.
const MAX_MESSAGE_VALUES: usize = 1 << 17;

/// Largest number of groups of a row that pass the middle of a step together, so that their layers stay in the cache.
const MAX_SEGMENT_GROUPS: usize = 32;

/// Adjacent groups of a row, the same in all layers.
pub(super) struct RowSegment {
    pub(super) row: usize,
    pub(super) groups: Range<usize>,
}

impl RowSegment {
    /// Splits a row of `groups` groups into segments of nearly equal length.
    pub(super) fn split_row(row: usize, groups: usize) -> impl Iterator<Item = Self> {
        let length = groups.div_ceil(groups.div_ceil(MAX_SEGMENT_GROUPS));
        let starts = (0..groups).step_by(length);
        starts.map(move |start| Self { row, groups: start..groups.min(start + length) })
    }
}

/// Position of a group: its index in lists by group, and that of its first field among all field values.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroupIndex {
    /// Index of the group among all groups.
    pub(crate) group: usize,
    /// Index of its first field among all field values; the other fields follow at multiples of the pitch.
    pub(crate) start: usize,
}

impl GroupIndex {
    /// Returns the same group of line `line`, for lines at distances `line_stride`.
    #[inline(always)]
    pub(crate) fn shift_to_line(self, line: usize, line_stride: Self) -> Self {
        Self {
            group: self.group + line * line_stride.group,
            start: self.start + line * line_stride.start,
        }
    }
}

/// Shape of a domain and memory layout of its field values: by row, field and group.
#[derive(Clone, Debug)]
pub(super) struct Layout<const D: usize> {
    /// Number of cells along each axis, halo included.
    pub(super) cells: [usize; D],
    /// Owned cells along each axis, as ranges of the cells with the halo.
    pub(super) owned: [Range<usize>; D],
    /// By group of a row, mask of the lanes that hold owned cells along the first axis.
    pub(super) owned_lanes: Vec<u16>,
    /// Whether the halo along the last axis is filled from the owned layers (periodic, without neighbouring subdomain).
    pub(super) is_periodic_in_place: bool,
    /// Number of fields of a cell.
    pub(super) field_count: usize,
    /// Number of groups of a row.
    pub(super) groups: usize,
    /// Number of ghosts beyond each end of a line.
    pub(super) ghosts: usize,
    /// Distance between two fields of a row, in groups: the offset of a field is its index times this pitch.
    pub(super) pitch: usize,
    /// Number of rows of a layer across the last axis.
    pub(super) rows: usize,
    /// Fields sent into the halo of a neighbour along the last axis, as ranges of a row.
    pub(super) exchanged_fields: Vec<Range<usize>>,
}

impl<const D: usize> Layout<D> {
    /// Returns the number of cells of a layer across the last axis.
    pub(super) fn layer_cells(&self) -> usize {
        self.cells[..D - 1].iter().product()
    }

    /// Returns the number of groups of a layer across the last axis.
    pub(super) fn layer_groups(&self) -> usize {
        self.rows * self.groups
    }

    /// Returns the number of layers, halo included.
    pub(super) fn layers(&self) -> usize {
        self.cells[D - 1]
    }

    /// Returns the number of rows that are swept together along the first axis, each with a row of its own for the ghosts
    /// at each end and depth, which follow the cells.
    pub(super) fn ghost_rows(&self) -> usize {
        CHUNK_SIZE.min(self.layers() * self.rows)
    }

    /// Returns the owned layers as a range of all layers.
    pub(super) fn owned_layers(&self) -> Range<usize> {
        self.owned[D - 1].clone()
    }

    /// Returns the widths of the lower and the upper halo along an axis, in cells.
    pub(super) fn halo(&self, axis: usize) -> [usize; 2] {
        [self.owned[axis].start, self.cells[axis] - self.owned[axis].end]
    }

    /// Returns the indices of the owned cells among all cells, first axis fastest.
    pub(super) fn owned_cells(&self) -> impl Iterator<Item = usize> {
        let counts = self.owned.each_ref().map(ExactSizeIterator::len);
        let (first, cells) = (self.owned.each_ref().map(|range| range.start), self.cells);
        (0..counts.iter().product()).map(move |index| cell_in_box(index, &counts, &first, &cells))
    }

    /// Returns the box of cells that are sent at an end of an axis (`is_sent`), or of those that are received: all
    /// cells along lower axes, owned cells along higher axes, so that edges and corners are filled by successive
    /// exchanges.
    pub(super) fn halo_box(&self, axis: usize, end: usize, is_sent: bool) -> [Range<usize>; D] {
        let (owned, width) = (self.owned[axis].clone(), self.halo(axis)[end]);
        let along = match (end, is_sent) {
            (0, true) => owned.start..owned.start + width,
            (0, false) => owned.start - width..owned.start,
            (_, true) => owned.end - width..owned.end,
            (_, false) => owned.end..owned.end + width,
        };
        std::array::from_fn(|other| match other.cmp(&axis) {
            Ordering::Less => 0..self.cells[other],
            Ordering::Equal => along.clone(),
            Ordering::Greater => self.owned[other].clone(),
        })
    }

    /// Returns the pieces of a halo box whose cells are sent in one message each: layers across the last axis with at most
    /// [`MAX_MESSAGE_VALUES`] field values, or one layer. See [`halo_box`](Self::halo_box).
    pub(super) fn halo_pieces(
        &self,
        axis: usize,
        end: usize,
        is_sent: bool,
    ) -> impl Iterator<Item = [Range<usize>; D]> + use<D> {
        let cells = self.halo_box(axis, end, is_sent);
        let layers = cells[D - 1].clone();
        let layer_cells: usize = cells[..D - 1].iter().map(ExactSizeIterator::len).product();
        let count = (MAX_MESSAGE_VALUES / (layer_cells * self.field_count).max(1)).max(1);
        layers.clone().step_by(count).map(move |start| {
            let mut piece = cells.clone();
            piece[D - 1] = start..layers.end.min(start + count);
            piece
        })
    }

    /// Returns the ranges of the field values of the rows of a box of whole rows.
    pub(super) fn row_ranges(
        &self,
        cells: &[Range<usize>; D],
    ) -> impl Iterator<Item = Range<usize>> {
        let rows = cells[1].clone();
        cells[D - 1].clone().map(move |layer| self.data_range(layer, &rows))
    }

    /// Calls `visit` with the position of each field value of the cells in a box, by row, field and cell: the index of its
    /// group among all field values, and its lane.
    pub(super) fn visit_values(
        &self,
        cells: &[Range<usize>; D],
        mut visit: impl FnMut(usize, usize),
    ) {
        let lanes: Vec<_> = cells[0].clone().map(|x| (x % self.groups, x / self.groups)).collect();
        let rows = if D == 2 { 0..1 } else { cells[1].clone() };
        for layer in cells[D - 1].clone() {
            for row in rows.clone() {
                let row_start = self.data_range(layer, &(row..row + 1)).start;
                for field in 0..self.field_count {
                    for (group, lane) in &lanes {
                        visit(row_start + field * self.pitch + group, *lane);
                    }
                }
            }
        }
    }

    /// Converts the index of an owned cell to its index among all cells.
    pub(super) fn local_cell(&self, owned_index: usize) -> usize {
        let counts = self.owned.each_ref().map(ExactSizeIterator::len);
        cell_in_box(
            owned_index,
            &counts,
            &self.owned.each_ref().map(|range| range.start),
            &self.cells,
        )
    }

    /// Converts the index of a cell among all cells to that among owned cells; `None` for a cell of the halo.
    pub(super) fn owned_index(&self, cell: usize) -> Option<usize> {
        let (mut remaining_index, mut owned_index, mut stride) = (cell, 0, 1);
        for (owned, count) in self.owned.iter().zip(self.cells) {
            let position = remaining_index % count;
            if !owned.contains(&position) {
                return None;
            }
            owned_index += (position - owned.start) * stride;
            (remaining_index, stride) = (remaining_index / count, stride * owned.len());
        }
        Some(owned_index)
    }

    /// Returns the rows that have owned cells, numbered over all layers.
    pub(super) fn owned_rows(&self) -> impl Iterator<Item = usize> {
        let rows = if D == 2 { 0..1 } else { self.owned[1].clone() };
        let layer_rows = move |layer: usize| rows.clone().map(move |row| layer * self.rows + row);
        self.owned_layers().flat_map(layer_rows)
    }

    /// Whether a row of a layer has owned cells.
    pub(super) fn is_owned_row(&self, layer: usize, row: usize) -> bool {
        self.owned_layers().contains(&layer) && (D == 2 || self.owned[1].contains(&row))
    }

    /// Returns the distance between two rows among the field values, in groups.
    #[inline(always)]
    pub(super) fn row_size(&self) -> usize {
        self.field_count * self.pitch
    }

    /// Returns the position of a group of a row, with rows numbered over all layers.
    #[inline(always)]
    pub(super) fn group_index(&self, row: usize, group: usize) -> GroupIndex {
        GroupIndex { group: row * self.groups + group, start: row * self.row_size() + group }
    }

    /// Returns group and lane of a cell, given by its index with halo.
    #[inline(always)]
    pub(super) fn lane_index(&self, cell: usize) -> (GroupIndex, usize) {
        let length = self.cells[0];
        let (row, x) = (cell / length, cell % length);
        (self.group_index(row, x % self.groups), x / self.groups)
    }

    /// Returns the index of a cell among the lanes of all groups.
    pub(super) fn flat_lane_index<T: Real>(&self, cell: usize) -> usize {
        let (index, lane) = self.lane_index(cell);
        index.group * T::Lanes::COUNT + lane
    }

    /// Returns the cell in a lane of a group; `None` for a ghost or padding lane.
    #[inline(always)]
    pub(super) fn cell_in_lane(&self, group: usize, lane: usize) -> Option<usize> {
        let (row, position) = (group / self.groups, group % self.groups);
        let x = lane * self.groups + position;
        (x < self.cells[0]).then(|| row * self.cells[0] + x)
    }

    /// Returns the index of the first field value of a segment in a layer, and the range of its groups.
    pub(super) fn segment_groups(&self, layer: usize, tile: &RowSegment) -> (usize, Range<usize>) {
        let first = self.group_index(layer * self.rows + tile.row, tile.groups.start);
        (first.start, first.group..first.group + tile.groups.len())
    }

    /// Returns the segment that is a whole row.
    pub(super) fn row_segment(&self, row: usize) -> RowSegment {
        RowSegment { row, groups: 0..self.groups }
    }

    /// Returns the range of the field values of some rows of a layer.
    pub(super) fn data_range(&self, layer: usize, rows: &Range<usize>) -> Range<usize> {
        let first = layer * self.rows;
        (first + rows.start) * self.row_size()..(first + rows.end) * self.row_size()
    }

    /// Whether a layer is in the halo of this domain, or may be in the halo of a neighbour along the last axis.
    pub(super) fn is_in_any_halo(&self, layer: usize) -> bool {
        let [lower, upper] = self.halo(D - 1);
        layer < 2 * lower || layer + 2 * upper >= self.layers()
    }

    /// Returns the ranges of the exchanged field values of some rows of a layer.
    pub(super) fn exchanged_ranges(
        &self,
        layer: usize,
        rows: &Range<usize>,
    ) -> impl Iterator<Item = Range<usize>> {
        let rows = layer * self.rows + rows.start..layer * self.rows + rows.end;
        let firsts = rows.map(|row| row * self.row_size());
        let pieces = |first| {
            self.exchanged_fields.iter().map(move |range| first + range.start..first + range.end)
        };
        firsts.flat_map(pieces)
    }
}

/// Converts an index in a box, given by its first cell and its numbers of cells, to the index among all cells.
fn cell_in_box<const D: usize>(
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

/// Returns the number of groups of a row of `cells` cells and the ghosts after them: at least as many as ghosts, so that
/// a stencil reaches the adjacent lanes only.
fn min_groups<T: Real>(cells: usize, ghosts: usize) -> usize {
    (cells + ghosts).div_ceil(T::Lanes::COUNT).max(ghosts)
}

/// Returns the number of groups of a row of `cells` cells. With interlayers at regular distances along rows it is a
/// multiple of that distance, so that all lanes of a group have an interlayer or none, unless rows became longer by
/// more than a quarter.
pub(super) fn groups_per_row<T: Real, const D: usize>(problem: &Problem<D>, cells: usize) -> usize {
    let block = problem.interlayers_across(0).map_or(1, Interlayers::common_distance);
    let groups = min_groups::<T>(cells, problem.scheme.slopes.ghosts());
    let multiple = groups.next_multiple_of(block);
    if multiple <= groups + groups / 4 { multiple } else { groups }
}

/// Returns the distance between two fields of a row, in groups, for rows of `groups` groups. It is not a multiple of
/// four cache lines, so that fewer values of a cell in different fields and rows map to the same cache set.
pub(super) fn pitch(groups: usize) -> usize {
    if groups.is_multiple_of(4) { groups + 1 } else { groups }
}

/// Returns the memory of a domain of `cells` cells along each axis, bytes: of the `fields` fields, with the ghosts of the
/// reconstruction `slopes`, and the material indices; and of the states that sweeps across rows carry from tile to tile for
/// `pairs` pairs of waves. Padding of rows for interlayers is left out.
pub fn memory_bytes<T: Real>(
    cells: &[usize],
    fields: usize,
    pairs: usize,
    slopes: Slopes,
) -> [f64; 2] {
    let length = cells.first().copied().unwrap_or(0).max(1);
    let count: f64 = cells.iter().map(|&count| count as f64).product();
    let ghosts = slopes.ghosts();
    let groups = min_groups::<T>(length, ghosts);
    let per_row = pitch(groups) * fields * size_of::<T::Lanes>() + groups * size_of::<u32>();
    let rows = count / length as f64;
    let rows = rows + 2.0 * ghosts as f64 * rows.min(CHUNK_SIZE as f64);
    // Lines of groups across rows, and half steps of a pass.
    let (lines, halves) = match cells {
        [_, layers] => (groups, 2 * max_pass_steps::<2>(*layers, slopes.halo())),
        [_, rows, layers] => (groups * (rows + layers), 2),
        _ => (0, 0),
    };
    let slots = CarriedState::<T::Lanes>::slots(ghosts);
    let carried = lines * halves * pairs * slots * size_of::<CarriedState<T::Lanes>>();
    [rows * per_row as f64 + count * size_of::<u16>() as f64, carried as f64]
}
