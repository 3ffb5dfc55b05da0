//! Region: a box of cells of a grid with a halo around it.

use std::ops::Range;

/// A box of cells of a grid and the halo around it, which holds copies of neighbouring cells.
///
/// Along each axis the cells are those of the lower halo, the owned cells, and those of the upper halo, in the order of
/// the coordinate, which wraps around on periodic axes. Cells are numbered with the first axis fastest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Region<const D: usize> {
    whole: [usize; D],
    own: [Range<usize>; D],
    halo: [[usize; 2]; D],
}

impl<const D: usize> Region<D> {
    /// A region with owned cells `own` in a grid of `whole` cells; `halo`: width at each end of each axis, in cells. It
    /// is zero at ends that are neither cut nor, along the last axis, periodic.
    pub(crate) fn new(whole: [usize; D], own: [Range<usize>; D], halo: [[usize; 2]; D]) -> Self {
        debug_assert!((0..D).all(|axis| own[axis].end <= whole[axis]));
        Self { whole, own, halo }
    }

    /// Region of a whole grid, without halo.
    pub fn whole(cells: [usize; D]) -> Self {
        Self::new(cells, cells.map(|count| 0..count), [[0; 2]; D])
    }

    /// Returns the coordinates of the owned cells along an axis of the whole grid.
    pub fn own(&self, axis: usize) -> Range<usize> {
        self.own[axis].clone()
    }

    /// Returns the number of owned cells along each axis.
    pub fn own_cells(&self) -> [usize; D] {
        self.own.each_ref().map(ExactSizeIterator::len)
    }

    /// Returns the width of the halo at both ends of an axis, in cells.
    pub fn halo(&self, axis: usize) -> [usize; 2] {
        self.halo[axis]
    }

    /// Returns whether the region has neighbours beyond the lower and the upper end of an axis.
    pub fn is_cut(&self, axis: usize) -> [bool; 2] {
        let is_part = self.own[axis].len() < self.whole[axis];
        self.halo[axis].map(|width| width > 0 && is_part)
    }

    /// Returns the number of cells along each axis, halo included.
    pub fn cells(&self) -> [usize; D] {
        std::array::from_fn(|axis| self.own[axis].len() + self.halo[axis][0] + self.halo[axis][1])
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
        let (whole, halo) = (self.whole[axis], self.halo[axis][0]);
        // The halo may be wider than the grid.
        let first = self.own[axis].start + halo * whole - halo;
        (first..first + self.cells()[axis]).map(|place| place % whole).collect()
    }

    /// Returns the global cell of each cell of the region.
    pub fn global_cells(&self) -> Vec<usize> {
        products(&std::array::from_fn::<_, D, _>(|axis| self.coordinates(axis)), &self.whole)
    }

    /// Returns the global cell of each owned cell.
    pub fn own_global_cells(&self) -> Vec<usize> {
        let own = std::array::from_fn::<_, D, _>(|axis| self.own(axis).collect());
        products(&own, &self.whole)
    }

    /// Returns the positions along an axis with a given global coordinate: several if a periodic halo wraps around.
    fn places(&self, axis: usize, coordinate: usize) -> Vec<usize> {
        let (whole, halo) = (self.whole[axis], self.halo[axis][0]);
        let first = (self.own[axis].start + halo * whole - halo) % whole;
        let place = (coordinate + whole - first) % whole;
        (place..self.cells()[axis]).step_by(whole).collect()
    }

    /// Returns the cells of the region that are copies of a global cell.
    pub(crate) fn cells_of(&self, mut cell: usize) -> Vec<usize> {
        let along: Vec<_> = (0..D)
            .map(|axis| {
                let coordinate = cell % self.whole[axis];
                cell /= self.whole[axis];
                self.places(axis, coordinate)
            })
            .collect();
        products(&along, &self.cells())
    }

    /// Returns the faces of a boundary of the region normal to `axis` that are copies of a global face.
    pub(crate) fn faces_of(&self, axis: usize, mut face: usize) -> Vec<usize> {
        let others: Vec<usize> = (0..D).filter(|other| *other != axis).collect();
        let along = others.iter().map(|&other| {
            let coordinate = face % self.whole[other];
            face /= self.whole[other];
            self.places(other, coordinate)
        });
        let along: Vec<_> = along.collect();
        let cells: Vec<usize> = others.iter().map(|&other| self.cells()[other]).collect();
        products(&along, &cells)
    }

    /// Returns the global cell of an owned cell, given its number among the owned cells.
    pub fn own_global_cell(&self, mut number: usize) -> usize {
        let (mut cell, mut stride) = (0, 1);
        for (own, whole) in self.own.iter().zip(self.whole) {
            cell += (own.start + number % own.len()) * stride;
            number /= own.len();
            stride *= whole;
        }
        cell
    }

    /// Returns the number among the owned cells of a global cell; `None` if it is not owned.
    pub fn own_number(&self, cell: usize) -> Option<usize> {
        let (mut rest, mut number, mut stride) = (cell, 0, 1);
        for (own, whole) in self.own.iter().zip(self.whole) {
            let place = rest % whole;
            if !own.contains(&place) {
                return None;
            }
            number += (place - own.start) * stride;
            (rest, stride) = (rest / whole, stride * own.len());
        }
        (rest == 0).then_some(number)
    }

    /// Returns the global face of each face of a boundary of the region normal to `axis`.
    pub fn global_faces(&self, axis: usize) -> Vec<usize> {
        let others = (0..D).filter(|other| *other != axis);
        let (along, cells): (Vec<_>, Vec<_>) =
            others.map(|other| (self.coordinates(other), self.whole[other])).unzip();
        products(&along, &cells)
    }
}

/// Computes linear indices (first axis fastest) from coordinates along each axis, for a grid of `cells`.
fn products(along: &[Vec<usize>], cells: &[usize]) -> Vec<usize> {
    let last_first = along.iter().zip(cells).rev();
    last_first.fold(vec![0], |before, (along, cells)| {
        let finer = |index: usize| along.iter().map(move |place| index * cells + place);
        before.into_iter().flat_map(finer).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::Region;

    #[test]
    fn cells_come_round() {
        let region = Region::new([5, 3], [3..5, 1..2], [[1, 2], [1, 1]]);
        assert_eq!(region.coordinates(0), [2, 3, 4, 0, 1]);
        assert_eq!(region.coordinates(1), [0, 1, 2]);
        assert_eq!(region.global_cells()[..6], [2, 3, 4, 0, 1, 7]);
        assert_eq!(region.own_global_cells(), [8, 9]);
        assert_eq!(region.global_faces(1), [2, 3, 4, 0, 1]);
        assert_eq!(region.global_faces(0), [0, 1, 2]);
        assert_eq!((region.cells_of(7), region.cells_of(1)), (vec![5], vec![4]));
        assert_eq!((region.faces_of(1, 0), region.faces_of(0, 2)), (vec![3], vec![2]));
        // Halo wider than the grid.
        let narrow = Region::new([2], std::array::from_fn(|_| 0..2), [[3, 4]]);
        assert_eq!(narrow.coordinates(0), [1, 0, 1, 0, 1, 0, 1, 0, 1]);
        assert_eq!(narrow.cells_of(1), [0, 2, 4, 6, 8]);
    }

    #[test]
    fn faces_in_space() {
        let region = Region::new([2, 3, 4], [0..2, 1..3, 2..4], [[0, 0], [1, 0], [0, 1]]);
        // Across the second axis: first axis fastest, then the third, with coordinates 2, 3, 0.
        assert_eq!(region.global_faces(1), [4, 5, 6, 7, 0, 1]);
        assert_eq!(region.cells(), [2, 3, 3]);
    }
}
