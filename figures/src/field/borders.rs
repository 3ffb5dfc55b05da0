//! Borders between materials.

use super::figure::FieldFigure;
use super::raster::FieldRaster;
use crate::picture::{INK, Picture, Rectangle, WHITE};
use crate::verdict_map::find_runs;

impl FieldFigure {
    /// Computes the boundaries between materials as rectangles of zero width or height; `None` for a single material,
    /// or if the boundaries would cover too much of the field.
    pub(super) fn material_borders(&self, raster: &FieldRaster) -> Option<Vec<Rectangle>> {
        if self.material_indices.iter().all(|material| *material == self.material_indices[0]) {
            return None;
        }
        let [columns, rows] = [0, 1].map(|axis| raster.cell_count(axis));
        let middle = |axis: usize, index: usize| {
            let edges = &raster.edges[axis];
            (edges[index] + edges[index + 1] - 1) / 2
        };
        let material = |column: usize, row: usize| {
            self.material_indices[middle(1, row) * self.columns + middle(0, column)]
        };
        let mut lines = Vec::new();
        let mut covered = 0.0;
        for column in 1..columns {
            for run in find_runs(rows, |row| material(column - 1, row) != material(column, row)) {
                lines.push(raster.cells_area((column, column), run));
            }
        }
        for row in 1..rows {
            for run in
                find_runs(columns, |column| material(column, row - 1) != material(column, row))
            {
                lines.push(raster.cells_area(run, (row, row)));
            }
        }
        for line in &lines {
            covered += 6.0 * (line.width() + line.height());
        }
        let frame = raster.frame;
        (covered < 0.4 * frame.width() * frame.height()).then_some(lines)
    }
}

/// Draws vertical and horizontal lines, given as rectangles of zero width or height, in ink with a white rim.
pub(super) fn draw_borders(picture: &mut Picture, lines: Vec<Rectangle>) {
    for (half, colour) in [(3.0, WHITE), (1.8, INK)] {
        let widened = |line: &Rectangle| {
            let (x, y) = if line.height() > line.width() { (half, 0.0) } else { (0.0, half) };
            // Lengthen the lines so that corners are closed.
            let (x, y) =
                (x + if x == 0.0 { 1.0 } else { 0.0 }, y + if y == 0.0 { 1.0 } else { 0.0 });
            Rectangle {
                left: line.left - x,
                top: line.top - y,
                right: line.right + x,
                bottom: line.bottom + y,
            }
        };
        picture.fill_patches(lines.iter().map(widened).collect(), colour);
    }
}
