//! Boxes of cells, and copies of the values of the cells that two boxes have in common.

use std::io::{self, Read};
use std::ops::Range;

/// Returns the number of cells of a box.
pub(in crate::cli) fn count_cells(cells: &[Range<usize>]) -> usize {
    cells.iter().map(ExactSizeIterator::len).product()
}

/// Copy from the values of one box to those of another, first axis fastest, row by row.
pub(in crate::cli) struct BoxCopy {
    /// Number of cells of a common row.
    row_cells: usize,
    /// First cell of each common row: number in the source, ascending, and number in the target.
    rows: Vec<[usize; 2]>,
}

impl BoxCopy {
    /// Finds the common cells of two boxes with as many axes.
    pub(in crate::cli) fn new(source: &[Range<usize>], target: &[Range<usize>]) -> Self {
        let common: Vec<Range<usize>> = source
            .iter()
            .zip(target)
            .map(|(one, other)| one.start.max(other.start)..one.end.min(other.end))
            .collect();
        let row_cells = common.first().map_or(0, ExactSizeIterator::len);
        if count_cells(&common) == 0 {
            return Self { row_cells: 0, rows: Vec::new() };
        }
        let number = |place: &[usize], cells: &[Range<usize>]| {
            let along = place.iter().zip(cells).rev();
            along.fold(0, |number, (place, own)| number * own.len() + place - own.start)
        };
        let mut rows = Vec::new();
        for mut row in 0..count_cells(&common[1..]) {
            let mut place = vec![common[0].start];
            for own in &common[1..] {
                place.push(own.start + row % own.len());
                row /= own.len();
            }
            rows.push([number(&place, source), number(&place, target)]);
        }
        Self { row_cells, rows }
    }

    /// Whether the boxes have no common cell.
    pub(in crate::cli) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Reads the values of the source, of `size` bytes per cell, and copies those of common cells to `target`.
    pub(in crate::cli) fn read(
        &self,
        size: usize,
        source: &mut dyn Read,
        target: &mut [u8],
    ) -> io::Result<()> {
        let mut position = 0;
        for [from, to] in &self.rows {
            let skipped = ((from - position) * size) as u64;
            io::copy(&mut Read::take(&mut *source, skipped), &mut io::sink())?;
            let row = to * size..(to + self.row_cells) * size;
            let row = target.get_mut(row).ok_or(io::ErrorKind::InvalidData)?;
            source.read_exact(row)?;
            position = from + self.row_cells;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of a box: the index of each cell in a grid of 5 × 4 × 3 cells, in two bytes.
    fn values(cells: &[Range<usize>]) -> Vec<u8> {
        let mut bytes = Vec::new();
        for k in cells[2].clone() {
            for j in cells[1].clone() {
                cells[0]
                    .clone()
                    .for_each(|i| bytes.extend(((k * 4 + j) * 5 + i + 1).to_le_bytes()));
            }
        }
        bytes
    }

    #[test]
    fn boxes_are_assembled_from_others() {
        let sources =
            [[0..2, 0..4, 0..1], [2..5, 0..4, 0..1], [0..5, 0..3, 1..3], [0..5, 3..4, 1..3]];
        for target in [[0..5, 0..4, 0..3], [1..4, 1..4, 0..2], [4..5, 3..4, 2..3]] {
            let mut found = vec![0; 8 * count_cells(&target)];
            for source in &sources {
                let copy = BoxCopy::new(source, &target);
                copy.read(8, &mut values(source).as_slice(), &mut found).expect("values");
            }
            assert_eq!(found, values(&target));
        }
        assert!(BoxCopy::new(&[0..2, 0..4], &[2..5, 0..4]).is_empty());
        let short =
            BoxCopy::new(&sources[0], &sources[0]).read(8, &mut [0; 9].as_slice(), &mut [0; 64]);
        assert!(short.is_err());
    }
}
