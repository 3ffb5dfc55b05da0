//! Drawing of the cells in their colours, and hatching by horizontal lines.

use std::collections::BTreeMap;

use super::colour_map::{Scale, UNKNOWN, UNKNOWN_HATCH};
use super::figure::FieldFigure;
use super::raster::Raster;
use crate::picture::{Picture, Rectangle};
use crate::verdict_map::runs;

impl FieldFigure {
    /// Fills the cells; runs of one colour in a row are filled as one rectangle.
    pub(super) fn draw_cells(&self, picture: &mut Picture, scale: &Scale, raster: &Raster) {
        let columns = raster.count(0);
        let steps: Vec<i16> =
            raster.extremes(&self.values).into_iter().map(|value| scale.step(value)).collect();
        let mut areas: BTreeMap<i16, Vec<Rectangle>> = BTreeMap::new();
        for (row, steps) in steps.chunks_exact(columns).enumerate() {
            let mut start = 0;
            for run in steps.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                areas.entry(run[0]).or_default().push(raster.area((start, end), (row, row + 1)));
                start = end;
            }
        }
        for (step, areas) in areas {
            picture.patches(areas, scale.colour(step));
        }
        let unknown = |column: usize, row: usize| steps[row * columns + column] == UNKNOWN;
        if scale.unknown > 0 {
            picture.patches(rules(raster, 6.0, 1.4, unknown), UNKNOWN_HATCH);
        }
    }
}

/// Computes horizontal lines `spacing` pixels apart over the selected raster cells, as rectangles of height `width`.
pub(super) fn rules(
    raster: &Raster,
    spacing: f64,
    width: f64,
    selected: impl Fn(usize, usize) -> bool,
) -> Vec<Rectangle> {
    let frame = raster.frame;
    let edges = &raster.edges[1];
    let mut lines = Vec::new();
    let mut row = 0;
    for count in 0..(frame.height() / spacing) as usize {
        let y = frame.bottom - (count as f64 + 0.5) * spacing;
        while row + 1 < raster.count(1) && raster.y(edges[row + 1] as f64) > y {
            row += 1;
        }
        for run in runs(raster.count(0), |column| selected(column, row)) {
            let area = raster.area(run, (row, row + 1));
            lines.push(Rectangle { top: y - 0.5 * width, bottom: y + 0.5 * width, ..area });
        }
    }
    lines
}
