//! Drawing of the cells in their colours, and hatching by horizontal lines.

use std::collections::BTreeMap;

use super::colour_map::{ColourScale, NON_FINITE_HATCH_COLOUR, NON_FINITE_STEP};
use super::figure::FieldFigure;
use super::raster::FieldRaster;
use crate::picture::{Picture, Rectangle};
use crate::verdict_map::find_runs;

impl FieldFigure {
    /// Fills the cells; runs of one colour in a row are filled as one rectangle.
    pub(super) fn draw_cells(
        &self,
        picture: &mut Picture,
        scale: &ColourScale,
        raster: &FieldRaster,
    ) {
        let columns = raster.cell_count(0);
        let steps: Vec<i16> = raster
            .extreme_values(&self.values)
            .into_iter()
            .map(|value| scale.colour_step(value))
            .collect();
        let outside = match &self.body {
            Some(body) => raster.all_of(&body.is_outside),
            None => vec![false; steps.len()],
        };
        let cells: Vec<(i16, bool)> = steps.iter().copied().zip(outside).collect();
        let mut areas: BTreeMap<i16, Vec<Rectangle>> = BTreeMap::new();
        for (row, cells) in cells.chunks_exact(columns).enumerate() {
            let mut start = 0;
            for run in cells.chunk_by(|a, b| a == b) {
                let end = start + run.len();
                let (step, is_outside) = run[0];
                if !is_outside {
                    let area = raster.cells_area((start, end), (row, row + 1));
                    areas.entry(step).or_default().push(area);
                }
                start = end;
            }
        }
        for (step, areas) in areas {
            picture.fill_patches(areas, scale.step_colour(step));
        }
        let unknown = |column: usize, row: usize| steps[row * columns + column] == NON_FINITE_STEP;
        if scale.non_finite_count > 0 {
            picture.fill_patches(
                horizontal_hatching(raster, 6.0, 1.4, unknown),
                NON_FINITE_HATCH_COLOUR,
            );
        }
    }
}

/// Computes horizontal lines `spacing` pixels apart over the selected raster cells, as rectangles of height `width`.
pub(super) fn horizontal_hatching(
    raster: &FieldRaster,
    spacing: f64,
    width: f64,
    is_selected: impl Fn(usize, usize) -> bool,
) -> Vec<Rectangle> {
    let frame = raster.frame;
    let edges = &raster.edges[1];
    let mut lines = Vec::new();
    let mut row = 0;
    for count in 0..(frame.height() / spacing) as usize {
        let y = frame.bottom - (count as f64 + 0.5) * spacing;
        while row + 1 < raster.cell_count(1) && raster.y_position(edges[row + 1] as f64) > y {
            row += 1;
        }
        for run in find_runs(raster.cell_count(0), |column| is_selected(column, row)) {
            let area = raster.cells_area(run, (row, row + 1));
            lines.push(Rectangle { top: y - 0.5 * width, bottom: y + 0.5 * width, ..area });
        }
    }
    lines
}
