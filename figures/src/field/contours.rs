//! Contour lines.

use super::colour_map::ColourScale;
use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::raster::{FieldRaster, MAX_COARSE_CELLS};
use crate::contour;
use crate::picture::{INK, Picture, Point, WHITE, polyline_length, split_into_dashes};

/// Upper limit of the higher default level, as a fraction of the length of the colour bar from zero to its end.
const MAX_DEFAULT_SHARE: f64 = 0.6;
const CONTOUR_WIDTH: f64 = 1.4;
const NEGATIVE_DASHES: [f64; 2] = [7.0, 5.0];
/// Magnitude of a contour level, as a fraction of the limit of the colour scale, above which its lines are white.
const WHITE_LINE_THRESHOLD: f64 = 0.6;

/// Maximum number of contour points, counting 10 extra points per line; above it no contour lines are drawn.
const MAX_CONTOUR_POINTS: usize = 60_000;

/// Contour lines of a field.
pub(super) enum Contours {
    /// Contour lines, each with its level as a fraction of the limit of the colour scale.
    Lines(Vec<(f64, Vec<Point>)>),
    /// No lines: there would be too many of the requested ones.
    TooMany,
    None,
}

/// Computes the magnitudes of the default levels, as fractions of the limit of the colour scale: round values a half
/// and a quarter of the way from white to the strongest colour, or somewhat less.
fn default_levels(scale: &ColourScale) -> [f64; 2] {
    // Colours that follow the root of the magnitude reach a share of the bar at its square.
    let (share, ratio) =
        if scale.is_root { (MAX_DEFAULT_SHARE.powi(2), 0.2) } else { (MAX_DEFAULT_SHARE, 0.5) };
    let power = 10_f64.powf((share * scale.limit).log10().floor()) / scale.limit;
    let fits = |factor: &f64| factor * power <= share;
    let factor = [5.0, 4.0, 2.0, 1.0].into_iter().find(fits).unwrap_or(1.0);
    let high = factor * power;
    let high = if (0.1 * share..=share).contains(&high) { high } else { share };
    [ratio * high, high]
}

impl FieldFigure {
    /// Returns whether contour lines are drawn if their number permits.
    pub(super) fn has_contours(&self, scale: &ColourScale) -> bool {
        self.contour_levels.is_some() || scale.is_signed
    }

    /// Returns the contour levels as fractions of the limit of the colour scale, ascending and distinct.
    pub(super) fn relative_levels(&self, scale: &ColourScale) -> Vec<f64> {
        let Some(curves) = &self.contour_levels else {
            let [low, high] = default_levels(scale);
            return vec![-high, -low, low, high];
        };
        let mut shares: Vec<f64> = curves.iter().map(|level| level / scale.limit).collect();
        shares.retain(|share| share.is_finite());
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    pub(super) fn compute_contours(&self, scale: &ColourScale, layout: &FieldLayout) -> Contours {
        if !self.has_contours(scale) || scale.limit == 0.0 || self.arrows.is_some() {
            return Contours::None;
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
                    let is_requested = self.contour_levels.is_some();
                    return if is_requested { Contours::TooMany } else { Contours::None };
                }
                for part in self.clip_to_body(layout, points) {
                    if polyline_length(&part) > 12.0 {
                        lines.push((share, part));
                    }
                }
            }
        }
        match lines.is_empty() && self.contour_levels.is_none() && !scale.is_fixed {
            true => Contours::None,
            false => Contours::Lines(lines),
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
