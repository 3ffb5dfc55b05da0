//! Raster of a verdict map.

use super::figure::{STEP_PARTS, VerdictMap};
use crate::contour::GridEdge;
use crate::picture::{Point, Rectangle};

/// Raster of a verdict map: both axes ascending, at most one point per pixel.
pub(super) struct VerdictRaster {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) categories: Vec<u8>,
    pub(super) levels: Vec<f64>,
    /// Places of the boundaries between a point and the next along x and along y, as fractions of the spacing.
    pub(super) boundaries: [Vec<f64>; 2],
    /// Whether a point belongs to a set without area.
    pub(super) is_line: Vec<bool>,
}

impl VerdictRaster {
    pub(super) fn cell_index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
    }

    /// Returns the place of the boundary on an edge, as a fraction of its length.
    pub(super) fn boundary_share(&self, (i, j, along_y): GridEdge) -> f64 {
        self.boundaries[usize::from(along_y)][self.cell_index(i, j)]
    }

    /// Returns the distances between neighbouring points along x and y, pixels.
    pub(super) fn spacing(&self, frame: Rectangle) -> [f64; 2] {
        let steps = |count: usize| count.saturating_sub(1).max(1) as f64;
        [frame.width() / steps(self.columns), frame.height() / steps(self.rows)]
    }

    /// Converts a position in units of the spacing to a point of the picture; a single column or row is in the middle.
    pub(super) fn place(&self, frame: Rectangle, [x, y]: Point) -> Point {
        let share = |value: f64, count: usize| {
            if count > 1 { value / (count - 1) as f64 } else { value + 0.5 }
        };
        [
            frame.left + share(x, self.columns) * frame.width(),
            frame.bottom - share(y, self.rows) * frame.height(),
        ]
    }
}

impl VerdictMap {
    pub(super) fn build_raster(
        &self,
        frame: Rectangle,
        is_x_flipped: bool,
        is_y_flipped: bool,
    ) -> VerdictRaster {
        let (all_columns, all_rows) = (self.x.values.len(), self.y.values.len());
        let columns = all_columns.min(frame.width() as usize);
        let rows = all_rows.min(frame.height() as usize);
        // Index of the point next to a point of the raster.
        let nearest = |index: usize, drawn: usize, all: usize, flip: bool| {
            let steps = drawn.saturating_sub(1).max(1);
            let cell = (2 * index * (all - 1) + steps) / (2 * steps);
            if flip { all - 1 - cell } else { cell }
        };
        let cells: Vec<[usize; 2]> = (0..rows)
            .flat_map(|row| {
                let row = nearest(row, rows, all_rows, is_y_flipped);
                (0..columns)
                    .map(move |column| [nearest(column, columns, all_columns, is_x_flipped), row])
            })
            .collect();
        let index = |[column, row]: [usize; 2]| row * all_columns + column;
        let (categories, levels) = cells
            .iter()
            .map(|&cell| (self.category_indices[index(cell)], self.growth_level(index(cell))))
            .unzip();
        // A raster with fewer points than the map does not resolve the places of boundaries.
        let is_whole = columns == all_columns && rows == all_rows;
        let flips = [is_x_flipped, is_y_flipped];
        let boundaries = [0, 1].map(|axis| {
            let share = |cell: &[usize; 2]| {
                let mut cell = *cell;
                if flips[axis] {
                    cell[axis] = cell[axis].saturating_sub(1);
                }
                let parts = self.boundaries[axis].get(index(cell)).copied();
                let parts = parts.filter(|parts| is_whole && *parts <= STEP_PARTS);
                let share = parts.map_or(0.5, |parts| f64::from(parts) / f64::from(STEP_PARTS));
                if flips[axis] { 1.0 - share } else { share }
            };
            cells.iter().map(share).collect()
        });
        let line_cells = self.line_cells();
        let is_line = cells.iter().map(|&cell| is_whole && line_cells[index(cell)]).collect();
        VerdictRaster { columns, rows, categories, levels, boundaries, is_line }
    }
}

/// Returns the maximal runs of selected indices below `count`, as half-open ranges.
pub(crate) fn find_runs(count: usize, is_selected: impl Fn(usize) -> bool) -> Vec<(usize, usize)> {
    let mut runs = Vec::new();
    let mut start = None;
    for index in 0..=count {
        match start {
            None if index < count && is_selected(index) => start = Some(index),
            Some(first) if index == count || !is_selected(index) => {
                runs.push((first, index));
                start = None;
            }
            _ => {}
        }
    }
    runs
}
