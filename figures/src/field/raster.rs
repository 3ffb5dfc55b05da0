//! The cells of a field as they are drawn: many cells in one where there are more than pixels.

use super::figure::{FINITE, FieldFigure};
use crate::picture::Rectangle;

/// The most cells along an axis of an SVG, and of the grid for contour lines.
pub(super) const COARSE: usize = 400;

/// The cells along both axes as they are drawn, a number of true cells each.
pub(super) struct Raster {
    /// For each axis the first true cell of each drawn one, and the number of all.
    pub(super) edges: [Vec<usize>; 2],
    pub(super) frame: Rectangle,
}

impl Raster {
    pub(super) fn new(figure: &FieldFigure, frame: Rectangle, most: [usize; 2]) -> Self {
        let all = [figure.columns, figure.rows];
        let edges = [0, 1].map(|axis| {
            let drawn = all[axis].min(most[axis].max(1));
            (0..=drawn).map(|index| index * all[axis] / drawn).collect::<Vec<usize>>()
        });
        Self { edges, frame }
    }

    pub(super) fn count(&self, axis: usize) -> usize {
        self.edges[axis].len() - 1
    }

    /// Place of the left edge of a drawn column, counted in true columns.
    pub(super) fn x(&self, edge: f64) -> f64 {
        let all = self.edges[0][self.count(0)] as f64;
        self.frame.left + edge / all * self.frame.width()
    }

    pub(super) fn y(&self, edge: f64) -> f64 {
        let all = self.edges[1][self.count(1)] as f64;
        self.frame.bottom - edge / all * self.frame.height()
    }

    /// The area of the drawn columns and rows from the first to behind the last. Where there are
    /// more cells than pixels, cells fill whole pixels, so that a single one keeps its colour.
    pub(super) fn area(&self, columns: (usize, usize), rows: (usize, usize)) -> Rectangle {
        let [x, y] = [(0, columns), (1, rows)].map(|(axis, range)| {
            let length = if axis == 0 { self.frame.width() } else { self.frame.height() };
            let edges = &self.edges[axis];
            let all = edges[self.count(axis)] as f64;
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

    /// A value for each drawn cell, from the indices of its true ones, row by row from below.
    fn gather<T>(&self, value: impl Fn(&mut dyn Iterator<Item = usize>) -> T) -> Vec<T> {
        let [x, y] = &self.edges;
        let all = x[self.count(0)];
        let mut values = Vec::with_capacity(self.count(0) * self.count(1));
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

    /// For each drawn cell the value of greatest magnitude; NaN where one is not finite.
    pub(super) fn extremes(&self, values: &[f64]) -> Vec<f64> {
        self.gather(|cells| {
            let mut extreme = 0.0_f64;
            for value in cells.map(|cell| values[cell]) {
                if value.is_nan() || value.abs() >= FINITE {
                    return f64::NAN;
                }
                if value.abs() > extreme.abs() {
                    extreme = value;
                }
            }
            extreme
        })
    }

    /// The mean of each drawn cell; NaN where one is not finite.
    pub(super) fn means(&self, values: &[f64]) -> Vec<f64> {
        self.gather(|cells| {
            let (mut sum, mut count) = (0.0, 0);
            for value in cells.map(|cell| values[cell]) {
                sum += if value.abs() < FINITE { value } else { f64::NAN };
                count += 1;
            }
            sum / f64::from(count)
        })
    }
}
