//! Regular grids of image data.

use super::error::VtiError;
use crate::csv::format_shortest;
use std::ops::Range;

/// Regular grid with axes along x, y and, in three dimensions, z.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageGrid {
    /// Number of cells along each of the two or three axes.
    pub cells: Vec<usize>,
    /// Lower corner of the grid, in any unit of length.
    pub origin: Vec<f64>,
    /// Edge length of a cell along each axis, in the same unit.
    pub spacing: Vec<f64>,
}

impl ImageGrid {
    /// Checks the grid and returns its number of cells.
    pub(super) fn checked_cell_count(&self) -> Result<usize, VtiError> {
        let axes = self.cells.len();
        if !(2..=3).contains(&axes) || self.origin.len() != axes || self.spacing.len() != axes {
            let (origin, spacing) = (self.origin.len(), self.spacing.len());
            return Err(VtiError::Axes { cells: axes, origin, spacing });
        }
        if let Some(&origin) = self.origin.iter().find(|origin| !origin.is_finite()) {
            return Err(VtiError::Origin(origin));
        }
        let fits = |spacing: &f64| spacing.is_finite() && *spacing > 0.0;
        if let Some(&spacing) = self.spacing.iter().find(|&spacing| !fits(spacing)) {
            return Err(VtiError::Spacing(spacing));
        }
        // VTK extents are signed 32-bit integers.
        let counts = |&cells: &usize| cells > 0 && i32::try_from(cells).is_ok();
        let product = |product: usize, &cells: &usize| product.checked_mul(cells);
        let count = self.cells.iter().try_fold(1, product);
        count
            .filter(|_| self.cells.iter().all(counts))
            .ok_or_else(|| VtiError::Size { cells: self.cells.clone() })
    }

    /// VTK extent of all cells, see [`format_cell_extent`].
    pub(super) fn format_extent(&self) -> String {
        let cells: Vec<Range<usize>> = self.cells.iter().map(|count| 0..*count).collect();
        format_cell_extent(&cells)
    }
}

/// Formats the VTK extent of a box of cells: indices of the first and the last node along three axes. A plane grid has a
/// single node along z.
pub(super) fn format_cell_extent(cells: &[Range<usize>]) -> String {
    let ends = (0..3).map(|axis| cells.get(axis).map_or([0, 0], |own| [own.start, own.end]));
    ends.map(|[first, last]| format!("{first} {last}")).collect::<Vec<_>>().join(" ")
}

/// Parses an extent that [`format_cell_extent`] has formatted for a grid of `axes` axes; `None` if it is another text.
pub(super) fn parse_cell_extent(text: &str, axes: usize) -> Option<Vec<Range<usize>>> {
    let numbers = text.split(' ').map(str::parse).collect::<Result<Vec<usize>, _>>().ok()?;
    let (ends, []) = numbers.as_chunks::<2>() else { return None };
    Some(ends.get(..axes)?.iter().map(|[first, last]| *first..*last).collect())
}

/// Formats three numbers; missing numbers are replaced by `missing`.
pub(super) fn format_triple(numbers: &[f64], missing: f64) -> String {
    let texts = (0..3).map(|axis| format_shortest(numbers.get(axis).copied().unwrap_or(missing)));
    texts.collect::<Vec<_>>().join(" ")
}
