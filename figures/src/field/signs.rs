//! Fine horizontal lines on negative values: colour maps of both signs have equal luminances, so that in greyscale only
//! the lines distinguish the signs, down to the weakest values with a colour.

use std::collections::BTreeMap;

use plotters::style::RGBColor;

use super::colour_map::{ColourScale, NON_FINITE_STEP, SHADE_COUNT};
use super::figure::FieldFigure;
use super::raster::FieldRaster;
use crate::picture::{Colour, INK, Picture, Rectangle};
use crate::verdict_map::find_runs;

/// Distance of the lines, pixels.
const LINE_SPACING: f64 = 9.0;
const LINE_WIDTH: f64 = 1.6;
/// Weakest colour step with lines: paler values are nearly white.
const FIRST_LINED_STEP: i16 = -3;

/// Returns the colour of a line on the negative colour step `step`: a darker one of the scale, beyond its end darker than
/// all of it, so that the contrast changes nowhere abruptly.
fn line_colour(scale: &ColourScale, step: i16) -> Colour {
    let darker = step - (8 - step).min(24);
    let RGBColor(red, green, blue) = scale.step_colour(darker.max(-SHADE_COUNT));
    let share = 1.0 - 0.025 * f64::from((-SHADE_COUNT - darker).max(0));
    let [red, green, blue] = [red, green, blue].map(|own| (share * f64::from(own)).round() as u8);
    RGBColor(red, green, blue)
}

const fn is_lined(step: i16) -> bool {
    step <= FIRST_LINED_STEP && step != NON_FINITE_STEP
}

impl FieldFigure {
    /// Returns whether a value of the field has lines.
    pub(super) fn has_sign_lines(&self, scale: &ColourScale) -> bool {
        scale.is_signed && self.values.iter().any(|value| is_lined(scale.colour_step(*value)))
    }

    /// Draws the lines on the raster cells with negative values.
    pub(super) fn draw_sign_lines(
        &self,
        picture: &mut Picture,
        scale: &ColourScale,
        raster: &FieldRaster,
    ) {
        if !self.has_sign_lines(scale) {
            return;
        }
        let [columns, rows] = [0, 1].map(|axis| raster.cell_count(axis));
        let values = raster.extreme_values(&self.values);
        let outside = self.body.as_ref().map(|body| raster.all_of(&body.is_outside));
        let step = |column: usize, row: usize| {
            let cell = row * columns + column;
            let is_outside = outside.as_ref().is_some_and(|outside| outside[cell]);
            if is_outside { 0 } else { scale.colour_step(values[cell]) }
        };
        let mut lines: BTreeMap<i16, Vec<Rectangle>> = BTreeMap::new();
        let mut row = 0;
        for y in line_heights(raster.frame) {
            while row + 1 < rows && raster.y_position(raster.edges[1][row + 1] as f64) > y {
                row += 1;
            }
            for (from, to) in find_runs(columns, |column| is_lined(step(column, row))) {
                let mut start = from;
                for end in from + 1..=to {
                    if end == to || step(end, row) != step(start, row) {
                        let area = raster.cells_area((start, end), (row, row + 1));
                        lines.entry(step(start, row)).or_default().push(line_area(area, y));
                        start = end;
                    }
                }
            }
        }
        for (step, lines) in lines {
            picture.fill_patches(lines, line_colour(scale, step));
        }
    }
}

/// Draws the lines on the part of a colour bar or swatch with a colour step.
pub(super) fn draw_sign_lines_in(
    picture: &mut Picture,
    scale: &ColourScale,
    (step, part): (i16, Rectangle),
    whole: Rectangle,
) {
    if !(scale.is_signed && is_lined(step)) {
        return;
    }
    let inside = line_heights(whole).filter(|y| (part.top..part.bottom).contains(y));
    let lines = inside.map(|y| line_area(part, y)).collect();
    picture.fill_patches(lines, line_colour(scale, step));
}

/// Draws the swatch of negative values.
pub(super) fn draw_sign_swatch(picture: &mut Picture, scale: &ColourScale, area: Rectangle) {
    const STEP: i16 = -SHADE_COUNT / 3;
    picture.fill_rectangle(area, scale.step_colour(STEP));
    draw_sign_lines_in(picture, scale, (STEP, area), area);
    picture.draw_frame(area, 1.5, INK);
}

/// Iterates over the heights of the lines in an area, from below.
fn line_heights(area: Rectangle) -> impl Iterator<Item = f64> {
    let count = (area.height() / LINE_SPACING) as usize;
    (0..count).map(move |index| area.bottom - (index as f64 + 0.5) * LINE_SPACING)
}

fn line_area(area: Rectangle, y: f64) -> Rectangle {
    Rectangle { top: y - 0.5 * LINE_WIDTH, bottom: y + 0.5 * LINE_WIDTH, ..area }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::luminance;

    /// On every shade the lines are darker, and weak values of both signs have no lines.
    #[test]
    fn lines_are_darker_than_their_ground() {
        let figure = FieldFigure {
            columns: 2,
            rows: 1,
            values: vec![1.0, -1.0],
            is_signed: true,
            ..FieldFigure::default()
        };
        let scale = ColourScale::from_figure(&figure);
        for step in -SHADE_COUNT..=FIRST_LINED_STEP {
            let contrast =
                luminance(scale.step_colour(step)) - luminance(line_colour(&scale, step));
            assert!(is_lined(step) && contrast > 8.0, "{step} {contrast}");
        }
        assert!(!is_lined(0) && !is_lined(NON_FINITE_STEP) && !is_lined(5));
    }
}
