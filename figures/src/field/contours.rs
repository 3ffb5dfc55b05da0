//! Contour lines, or hatching of negative values if there would be too many contour lines.

use super::cells::horizontal_hatching;
use super::colour_map::ColourScale;
use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::raster::{FieldRaster, MAX_COARSE_CELLS};
use crate::contour;
use crate::picture::{INK, Picture, Point, Rectangle, WHITE, polyline_length, split_into_dashes};

/// Default contour levels, as fractions of the limit of the colour scale.
const DEFAULT_LEVELS: [f64; 4] = [-0.5, -0.25, 0.25, 0.5];
const CONTOUR_WIDTH: f64 = 1.4;
const NEGATIVE_DASHES: [f64; 2] = [7.0, 5.0];
/// Magnitude of a contour level, as a fraction of the limit of the colour scale, above which its lines are white.
const WHITE_LINE_THRESHOLD: f64 = 0.6;

/// Maximum number of contour points, counting 10 extra points per line; above it no contour lines are drawn.
const MAX_CONTOUR_POINTS: usize = 60_000;
/// Spacing of the hatching of negative values, pixels.
const HATCH_SPACING: f64 = 8.0;

/// Contour lines or hatching, which distinguish positive and negative values in greyscale.
pub(super) enum Contours {
    /// Contour lines, each with its level as a fraction of the limit of the colour scale.
    Lines(Vec<(f64, Vec<Point>)>),
    /// Hatching of values below −¼ of the limit of the colour scale, since there would be too many contour lines, or
    /// none.
    Hatching,
    /// Neither lines nor hatching: there would be too many of the requested contour lines of an unsigned quantity.
    TooMany,
    None,
}

impl FieldFigure {
    /// Returns whether contour lines are drawn if their number permits.
    pub(super) fn has_contours(&self, scale: &ColourScale) -> bool {
        self.contour_levels.is_some() || scale.is_signed
    }

    /// Returns the contour levels as fractions of the limit of the colour scale, ascending and distinct.
    pub(super) fn relative_levels(&self, scale: &ColourScale) -> Vec<f64> {
        let Some(curves) = &self.contour_levels else { return DEFAULT_LEVELS.to_vec() };
        let mut shares: Vec<f64> = curves.iter().map(|level| level / scale.limit).collect();
        shares.retain(|share| share.is_finite());
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    /// Hatches the cells with values below −¼ of the limit of the colour scale.
    pub(super) fn hatch_negative_cells(
        &self,
        picture: &mut Picture,
        scale: &ColourScale,
        raster: &FieldRaster,
    ) {
        let values = raster.extreme_values(&self.values);
        let is_low = |column: usize, row: usize| {
            values[row * raster.cell_count(0) + column] < -0.25 * scale.limit
        };
        picture.fill_patches(horizontal_hatching(raster, HATCH_SPACING, 1.6, is_low), INK);
    }

    pub(super) fn compute_contours(&self, scale: &ColourScale, layout: &FieldLayout) -> Contours {
        if !self.has_contours(scale) || scale.limit == 0.0 {
            return Contours::None;
        }
        if self.arrows.is_some() {
            let is_low = |value: &f64| *value < -0.25 * scale.limit;
            let has_low = scale.is_signed && self.values.iter().any(is_low);
            return if has_low { Contours::Hatching } else { Contours::None };
        }
        let raster = FieldRaster::new(self, layout.frame, [MAX_COARSE_CELLS; 2]);
        let means = raster.mean_values(&self.values);
        let mut lines = Vec::new();
        let mut point_count = 0;
        for share in self.relative_levels(scale) {
            for points in raster.trace_contours(&means, share * scale.limit) {
                // Lines too short to be drawn count as well: a field with many of them has no meaningful contours.
                point_count += 10 + points.len();
                if point_count > MAX_CONTOUR_POINTS {
                    return if scale.is_signed { Contours::Hatching } else { Contours::TooMany };
                }
                for part in self.clip_to_body(layout, points) {
                    if polyline_length(&part) > 12.0 {
                        lines.push((share, part));
                    }
                }
            }
        }
        if !lines.is_empty() || self.contour_levels.is_some() {
            Contours::Lines(lines)
        } else if self.values.iter().any(|value| *value < -0.25 * scale.limit) {
            Contours::Hatching
        } else if scale.is_fixed {
            Contours::Lines(lines)
        } else {
            Contours::None
        }
    }
}

impl FieldRaster {
    /// Traces the contour lines of one level, in pixels; `values` are those of the raster cells.
    pub(super) fn trace_contours(&self, values: &[f64], level: f64) -> Vec<Vec<Point>> {
        let [columns, rows] = [0, 1].map(|axis| self.cell_count(axis));
        // The outermost values are repeated in one additional row or column on each side, so that lines reach the
        // frame.
        let inner = |index: usize, count: usize| index.clamp(1, count) - 1;
        let value = |i: usize, j: usize| values[inner(j, rows) * columns + inner(i, columns)];
        // Maps a position in the extended grid to a cell coordinate: cell centres inside, domain edges at the ends.
        let cell = |place: f64, axis: usize| {
            let (edges, count) = (&self.edges[axis], self.cell_count(axis));
            let centre = |index: usize| match index {
                0 => 0.0,
                index if index > count => edges[count] as f64,
                index => 0.5 * (edges[index - 1] + edges[index]) as f64,
            };
            let below = (place.max(0.0) as usize).min(count);
            let (from, to) = (centre(below), centre(below + 1));
            from + (place - below as f64) * (to - from)
        };
        let to_points = |line: Vec<Point>| {
            let point = |[i, j]: Point| [self.x_position(cell(i, 0)), self.y_position(cell(j, 1))];
            line.into_iter().map(point).collect()
        };
        let lines = contour::trace_contours(columns + 2, rows + 2, value, level);
        lines.into_iter().map(to_points).collect()
    }
}

/// Hatches an area like negative values of the field.
pub(super) fn draw_hatching(picture: &mut Picture, area: Rectangle) {
    let count = ((area.height() / HATCH_SPACING) as usize).max(1);
    let spacing = area.height() / count as f64;
    let line = |index: usize| {
        let y = area.top + (index as f64 + 0.5) * spacing;
        Rectangle { top: y - 0.8, bottom: y + 0.8, ..area }
    };
    picture.fill_patches((0..count).map(line).collect(), INK);
}

pub(super) fn draw_contour_line(picture: &mut Picture, relative_level: f64, points: &[Point]) {
    let colour = if relative_level.abs() > WHITE_LINE_THRESHOLD { WHITE } else { INK };
    let pattern: &[f64] = if relative_level < 0.0 { &NEGATIVE_DASHES } else { &[] };
    if pattern.is_empty() {
        return picture.draw_line(points, CONTOUR_WIDTH, colour);
    }
    for dash in split_into_dashes(points, pattern) {
        picture.draw_line(dash, CONTOUR_WIDTH, colour);
    }
}
