//! Raster of a verdict map, and the boundaries between categories.

use super::figure::VerdictMap;
use crate::picture::{INK, Picture, Rectangle};

/// Raster of a verdict map: both axes ascending, at most one raster cell per pixel.
pub(super) struct VerdictRaster {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) categories: Vec<u8>,
    pub(super) levels: Vec<f64>,
}

impl VerdictRaster {
    pub(super) fn cell_index(&self, column: usize, row: usize) -> usize {
        row * self.columns + column
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
        // Index of the cell at the centre of a raster cell.
        let nearest = |index: usize, drawn: usize, all: usize, flip: bool| {
            let cell = (2 * index + 1) * all / (2 * drawn);
            if flip { all - 1 - cell } else { cell }
        };
        let cells = (0..rows).flat_map(|row| {
            let row = nearest(row, rows, all_rows, is_y_flipped) * all_columns;
            (0..columns)
                .map(move |column| row + nearest(column, columns, all_columns, is_x_flipped))
        });
        let (categories, levels) =
            cells.map(|cell| (self.category_indices[cell], self.growth_levels[cell])).unzip();
        VerdictRaster { columns, rows, categories, levels }
    }
}

pub(super) fn cell_size(frame: Rectangle, raster: &VerdictRaster) -> (f64, f64) {
    (frame.width() / raster.columns as f64, frame.height() / raster.rows as f64)
}

/// Draws lines between cells of different categories.
pub(super) fn draw_borders(picture: &mut Picture, frame: Rectangle, raster: &VerdictRaster) {
    let (width, height) = cell_size(frame, raster);
    let category = |column: usize, row: usize| raster.categories[raster.cell_index(column, row)];
    let place = |column: usize, row: usize| {
        [frame.left + column as f64 * width, frame.bottom - row as f64 * height]
    };
    // The line width is limited, so that cells a few pixels wide remain visible.
    let thickness = |size: f64| (0.3 * size).clamp(0.7, 2.4);
    for column in 1..raster.columns {
        let differs = |row| category(column - 1, row) != category(column, row);
        for (from, to) in find_runs(raster.rows, differs) {
            picture.draw_line([place(column, from), place(column, to)], thickness(width), INK);
        }
    }
    for row in 1..raster.rows {
        let differs = |column| category(column, row - 1) != category(column, row);
        for (from, to) in find_runs(raster.columns, differs) {
            picture.draw_line([place(from, row), place(to, row)], thickness(height), INK);
        }
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
