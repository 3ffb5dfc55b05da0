//! Raster of a field: several cells are merged if there are more cells than pixels, or than [`MAX_COARSE_CELLS`] in SVG
//! files and for contour lines.

use super::figure::FieldFigure;
use crate::picture::Rectangle;
use crate::scale::FINITE_LIMIT;

/// Maximum number of raster cells along an axis, in SVG files and in the grid on which contour lines are computed.
pub(super) const MAX_COARSE_CELLS: usize = 400;

/// Raster of a field: each raster cell is a block of cells.
pub(super) struct FieldRaster {
    /// Along each axis the index of the first cell of each raster cell, followed by the number of cells.
    pub(super) edges: [Vec<usize>; 2],
    pub(super) frame: Rectangle,
}

impl FieldRaster {
    pub(super) fn new(figure: &FieldFigure, frame: Rectangle, max_cells: [usize; 2]) -> Self {
        let all = [figure.columns, figure.rows];
        let edges = [0, 1].map(|axis| {
            let drawn = all[axis].min(max_cells[axis].max(1));
            (0..=drawn).map(|index| index * all[axis] / drawn).collect::<Vec<usize>>()
        });
        Self { edges, frame }
    }

    pub(super) fn cell_count(&self, axis: usize) -> usize {
        self.edges[axis].len() - 1
    }

    /// Returns the x position, in pixels, of a column edge; edges are counted in cells.
    pub(super) fn x_position(&self, edge: f64) -> f64 {
        let all = self.edges[0][self.cell_count(0)] as f64;
        self.frame.left + edge / all * self.frame.width()
    }

    pub(super) fn y_position(&self, edge: f64) -> f64 {
        let all = self.edges[1][self.cell_count(1)] as f64;
        self.frame.bottom - edge / all * self.frame.height()
    }

    /// Returns the area of the raster cells in half-open ranges of columns and rows. If there are more cells than
    /// pixels, areas are aligned to whole pixels, so that a single cell is drawn in its exact colour.
    pub(super) fn cells_area(&self, columns: (usize, usize), rows: (usize, usize)) -> Rectangle {
        let [x, y] = [(0, columns), (1, rows)].map(|(axis, range)| {
            let length = if axis == 0 { self.frame.width() } else { self.frame.height() };
            let edges = &self.edges[axis];
            let all = edges[self.cell_count(axis)] as f64;
            [range.0, range.1].map(|index| {
                let place = edges[index] as f64 / all * length;
                if all > length { (place - 1e-6).ceil() } else { place }
            })
        });
        Rectangle {
            left: self.frame.left + x[0],
            right: self.frame.left + x[1],
            top: self.frame.bottom - y[1],
            bottom: self.frame.bottom - y[0],
        }
    }

    /// Computes a value for each raster cell from the indices of its cells, row by row from below.
    fn map_blocks<T>(&self, value: impl Fn(&mut dyn Iterator<Item = usize>) -> T) -> Vec<T> {
        let [x, y] = &self.edges;
        let all = x[self.cell_count(0)];
        let mut values = Vec::with_capacity(self.cell_count(0) * self.cell_count(1));
        for rows in y.windows(2) {
            for columns in x.windows(2) {
                let (first, last) = (columns[0], columns[1]);
                let mut cells = (rows[0]..rows[1])
                    .flat_map(|row| (first..last).map(move |column| row * all + column));
                values.push(value(&mut cells));
            }
        }
        values
    }

    /// Returns the value of largest magnitude in each raster cell; NaN if a value is non-finite.
    pub(super) fn extreme_values(&self, values: &[f64]) -> Vec<f64> {
        self.map_blocks(|cells| {
            let mut extreme = 0.0_f64;
            for value in cells.map(|cell| values[cell]) {
                if value.is_nan() || value.abs() >= FINITE_LIMIT {
                    return f64::NAN;
                }
                if value.abs() > extreme.abs() {
                    extreme = value;
                }
            }
            extreme
        })
    }

    /// Returns for each raster cell whether a property holds in all its cells.
    pub(super) fn all_of(&self, holds: &[bool]) -> Vec<bool> {
        self.map_blocks(|mut cells| Iterator::all(&mut cells, |cell| holds[cell]))
    }

    /// Returns the mean value in each raster cell; NaN if a value is non-finite.
    pub(super) fn mean_values(&self, values: &[f64]) -> Vec<f64> {
        self.map_blocks(|cells| {
            let (mut sum, mut count) = (0.0, 0);
            for value in cells.map(|cell| values[cell]) {
                sum += if value.abs() < FINITE_LIMIT { value } else { f64::NAN };
                count += 1;
            }
            sum / f64::from(count)
        })
    }
}
