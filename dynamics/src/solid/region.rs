//! Region: a box of cells of a grid, with its halo.

use std::ops::Range;
use std::sync::Arc;

/// A box of cells of a grid with its halo, which holds copies of neighbouring cells.
///
/// Along each axis the cells are those of the lower halo, the owned cells, and those of the upper halo, in the order of
/// the coordinate, which wraps around on periodic axes. Cells are numbered with the first axis fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region<const D: usize> {
    grid_cells: [usize; D],
    owned: [Range<usize>; D],
    halo: [[usize; 2]; D],
}

impl<const D: usize> Region<D> {
    /// Creates a region with owned cells `owned` in a grid of `grid_cells` cells; `halo`: width at each end of each
    /// axis, in cells. The width is zero at ends without neighbouring subdomain, except on a periodic last axis.
    pub(crate) fn new(
        grid_cells: [usize; D],
        owned: [Range<usize>; D],
        halo: [[usize; 2]; D],
    ) -> Self {
        debug_assert!((0..D).all(|axis| owned[axis].end <= grid_cells[axis]));
        Self { grid_cells, owned, halo }
    }

    /// Creates the region of a whole grid, without halo.
    pub fn from_grid(cells: [usize; D]) -> Self {
        Self::new(cells, cells.map(|count| 0..count), [[0; 2]; D])
    }

    /// Creates the region of a box of cells, without halo.
    pub(crate) fn from_box(grid_cells: [usize; D], owned: [Range<usize>; D]) -> Self {
        Self::new(grid_cells, owned, [[0; 2]; D])
    }

    /// Returns the coordinates of the owned cells along an axis of the whole grid.
    pub fn owned_range(&self, axis: usize) -> Range<usize> {
        self.owned[axis].clone()
    }

    /// Returns the number of owned cells along each axis.
    pub fn owned_counts(&self) -> [usize; D] {
        self.owned.each_ref().map(ExactSizeIterator::len)
    }

    /// Returns the width of the halo at both ends of an axis, in cells.
    pub fn halo(&self, axis: usize) -> [usize; 2] {
        self.halo[axis]
    }

    /// Returns whether the region has neighbouring subdomains beyond the lower and the upper end of an axis.
    pub fn has_neighbours(&self, axis: usize) -> [bool; 2] {
        let is_divided = self.owned[axis].len() < self.grid_cells[axis];
        self.halo[axis].map(|width| width > 0 && is_divided)
    }

    /// Returns the number of cells along each axis, halo included.
    pub fn cells(&self) -> [usize; D] {
        std::array::from_fn(|axis| self.owned[axis].len() + self.halo[axis][0] + self.halo[axis][1])
    }

    /// Returns the total number of cells, halo included.
    pub fn count(&self) -> usize {
        self.cells().iter().product()
    }

    /// Returns the number of faces of a boundary normal to an axis, halo included.
    pub fn faces(&self, axis: usize) -> usize {
        self.count() / self.cells()[axis].max(1)
    }

    /// Returns the coordinates in the whole grid of the cells along an axis, halo included.
    pub fn coordinates(&self, axis: usize) -> Vec<usize> {
        let (whole, halo) = (self.grid_cells[axis], self.halo[axis][0]);
        // The halo may be wider than the grid.
        let first = self.owned[axis].start + halo * whole - halo;
        (first..first + self.cells()[axis]).map(|place| place % whole).collect()
    }

    /// Returns the index in the whole grid of each cell of the region, halo included.
    pub fn global_cells(&self) -> Vec<usize> {
        linear_indices(
            &std::array::from_fn::<_, D, _>(|axis| self.coordinates(axis)),
            &self.grid_cells,
        )
    }

    /// Iterates over the same indices without a list of them.
    pub(crate) fn global_cell_iter(&self) -> impl Iterator<Item = usize> + use<D> {
        let along = std::array::from_fn::<_, D, _>(|axis| self.coordinates(axis));
        iterate_linear_indices(along.to_vec(), self.grid_cells.to_vec())
    }

    /// Iterates over the owned cells as [`owned_global_cells`](Self::owned_global_cells) lists them.
    pub(crate) fn owned_global_cell_iter(&self) -> impl Iterator<Item = usize> + use<D> {
        let along = std::array::from_fn::<_, D, _>(|axis| self.owned_range(axis).collect());
        iterate_linear_indices(along.to_vec(), self.grid_cells.to_vec())
    }

    /// Returns the cells of the region, halo included, whose cells of the whole grid are in a box: by axis their
    /// positions in the region, and in the box. Both lists are in the order of the positions.
    fn positions_in_box(&self, cells: &[Range<usize>; D]) -> [Vec<(usize, usize)>; D] {
        std::array::from_fn(|axis| {
            let places = self.coordinates(axis).into_iter().enumerate();
            let inside = places.filter(|(_, place)| cells[axis].contains(place));
            inside.map(|(position, place)| (position, place - cells[axis].start)).collect()
        })
    }

    /// Iterates over the cells of the region, halo included, whose cells of the whole grid are in a box, first axis
    /// fastest: numbers in the region and in the box.
    pub(crate) fn cells_in_box(
        &self,
        cells: &[Range<usize>; D],
    ) -> impl Iterator<Item = [usize; 2]> + use<D> {
        let positions = self.positions_in_box(cells);
        let counts = [self.cells(), cells.each_ref().map(ExactSizeIterator::len)];
        let [own, other] = [0, 1].map(|side| {
            let along = positions.iter().map(|own| {
                own.iter().map(|pair| if side == 0 { pair.0 } else { pair.1 }).collect()
            });
            iterate_linear_indices(along.collect(), counts[side].to_vec())
        });
        own.zip(other).map(|(own, other)| [own, other])
    }

    /// Returns the index in the whole grid of each owned cell.
    pub fn owned_global_cells(&self) -> Vec<usize> {
        let owned_coordinates =
            std::array::from_fn::<_, D, _>(|axis| self.owned_range(axis).collect());
        linear_indices(&owned_coordinates, &self.grid_cells)
    }

    /// Returns the positions along an axis of the region with a given coordinate in the whole grid: several if a
    /// periodic halo wraps around.
    fn region_positions(&self, axis: usize, coordinate: usize) -> Vec<usize> {
        let (whole, halo) = (self.grid_cells[axis], self.halo[axis][0]);
        let first = (self.owned[axis].start + halo * whole - halo) % whole;
        let first_position = (coordinate + whole - first) % whole;
        (first_position..self.cells()[axis]).step_by(whole).collect()
    }

    /// Returns the cells of the region that represent a cell of the whole grid: several if a periodic halo wraps
    /// around.
    pub(crate) fn region_cells(&self, mut cell: usize) -> Vec<usize> {
        let along: Vec<_> = (0..D)
            .map(|axis| {
                let coordinate = cell % self.grid_cells[axis];
                cell /= self.grid_cells[axis];
                self.region_positions(axis, coordinate)
            })
            .collect();
        linear_indices(&along, &self.cells())
    }

    /// Returns the first cell of the region that represents a cell of the whole grid; `None` if there is none.
    pub(crate) fn first_region_cell(&self, cell: usize) -> Option<usize> {
        let (mut remaining_index, mut index, mut stride) = (cell, 0, 1);
        for (axis, count) in self.cells().into_iter().enumerate() {
            let (whole, halo) = (self.grid_cells[axis], self.halo[axis][0]);
            let first = (self.owned[axis].start + halo * whole - halo) % whole;
            let position = (remaining_index % whole + whole - first) % whole;
            if position >= count {
                return None;
            }
            index += position * stride;
            (remaining_index, stride) = (remaining_index / whole, stride * count);
        }
        Some(index)
    }

    /// Returns the faces of a boundary of the region normal to `axis` that represent a face of the whole grid: several
    /// if a periodic halo wraps around.
    pub(crate) fn region_faces(&self, axis: usize, mut face: usize) -> Vec<usize> {
        let tangential_axes: Vec<usize> = (0..D).filter(|other| *other != axis).collect();
        let along = tangential_axes.iter().map(|&other| {
            let coordinate = face % self.grid_cells[other];
            face /= self.grid_cells[other];
            self.region_positions(other, coordinate)
        });
        let along: Vec<_> = along.collect();
        let cells: Vec<usize> = tangential_axes.iter().map(|&other| self.cells()[other]).collect();
        linear_indices(&along, &cells)
    }

    /// Returns the index in the whole grid of an owned cell, given its number among the owned cells.
    pub fn owned_global_cell(&self, mut number: usize) -> usize {
        let (mut cell, mut stride) = (0, 1);
        for (own, whole) in self.owned.iter().zip(self.grid_cells) {
            cell += (own.start + number % own.len()) * stride;
            number /= own.len();
            stride *= whole;
        }
        cell
    }

    /// Returns the number of a cell among the owned cells, given its index in the whole grid; `None` if it is not
    /// owned.
    pub fn owned_index(&self, cell: usize) -> Option<usize> {
        let (mut remaining_index, mut number, mut stride) = (cell, 0, 1);
        for (own, whole) in self.owned.iter().zip(self.grid_cells) {
            let coordinate = remaining_index % whole;
            if !own.contains(&coordinate) {
                return None;
            }
            number += (coordinate - own.start) * stride;
            (remaining_index, stride) = (remaining_index / whole, stride * own.len());
        }
        (remaining_index == 0).then_some(number)
    }

    /// Returns the index in the whole grid of each face of a boundary of the region normal to `axis`.
    pub fn global_faces(&self, axis: usize) -> Vec<usize> {
        let tangential_axes = (0..D).filter(|other| *other != axis);
        let (along, cells): (Vec<_>, Vec<_>) =
            tangential_axes.map(|other| (self.coordinates(other), self.grid_cells[other])).unzip();
        linear_indices(&along, &cells)
    }
}

/// Computes the linear indices (first axis fastest) in a grid of `cells` cells of all combinations of the coordinates
/// `along` the axes.
fn linear_indices(along: &[Vec<usize>], cells: &[usize]) -> Vec<usize> {
    let last_first = along.iter().zip(cells).rev();
    last_first.fold(vec![0], |before, (along, cells)| {
        let finer = |index: usize| along.iter().map(move |place| index * cells + place);
        before.into_iter().flat_map(finer).collect()
    })
}

/// Iterates over the linear indices that [`linear_indices`] lists.
fn iterate_linear_indices(
    along: Vec<Vec<usize>>,
    cells: Vec<usize>,
) -> impl Iterator<Item = usize> {
    let mut along = along.into_iter();
    let first = along.next().unwrap_or_default();
    let outer: Vec<Vec<usize>> = along.collect();
    let row_count: usize = outer.iter().map(Vec::len).product();
    let length = cells.first().copied().unwrap_or(1);
    let row_start = move |mut row: usize| {
        let (mut start, mut stride) = (0, length);
        for (places, count) in outer.iter().zip(&cells[1..]) {
            start += places[row % places.len()] * stride;
            row /= places.len();
            stride *= count;
        }
        start
    };
    let first = Arc::new(first);
    (0..row_count).map(row_start).flat_map(move |start| {
        let first = Arc::clone(&first);
        (0..first.len()).map(move |index| start + first[index])
    })
}

#[cfg(test)]
mod tests {
    use super::Region;

    #[test]
    fn periodic_halo_cells_wrap_around() {
        let region = Region::new([5, 3], [3..5, 1..2], [[1, 2], [1, 1]]);
        assert_eq!(region.coordinates(0), [2, 3, 4, 0, 1]);
        assert_eq!(region.coordinates(1), [0, 1, 2]);
        assert_eq!(region.global_cells()[..6], [2, 3, 4, 0, 1, 7]);
        assert_eq!(region.owned_global_cells(), [8, 9]);
        assert_eq!(region.global_faces(1), [2, 3, 4, 0, 1]);
        assert_eq!(region.global_faces(0), [0, 1, 2]);
        assert_eq!((region.region_cells(7), region.region_cells(1)), (vec![5], vec![4]));
        for cell in 0..15 {
            assert_eq!(region.first_region_cell(cell), region.region_cells(cell).first().copied());
        }
        assert_eq!((region.region_faces(1, 0), region.region_faces(0, 2)), (vec![3], vec![2]));
        // Halo wider than the grid.
        let narrow = Region::new([2], std::array::from_fn(|_| 0..2), [[3, 4]]);
        assert_eq!(narrow.coordinates(0), [1, 0, 1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(narrow.region_cells(1), [0, 2, 4, 6, 8]);
    }

    #[test]
    fn global_faces_in_three_dimensions() {
        let region = Region::new([2, 3, 4], [0..2, 1..3, 2..4], [[0, 0], [1, 0], [0, 1]]);
        // Across the second axis: first axis fastest, then the third, with coordinates 2, 3, 0.
        assert_eq!(region.global_faces(1), [4, 5, 6, 7, 0, 1]);
        assert_eq!(region.cells(), [2, 3, 3]);
    }
}
