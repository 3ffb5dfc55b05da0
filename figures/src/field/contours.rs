//! Contour lines, or hatching of negative values if there would be too many contour lines.

use super::cells::rules;
use super::colour_map::Scale;
use super::figure::FieldFigure;
use super::layout::Layout;
use super::raster::{COARSE, Raster};
use crate::contour;
use crate::picture::{INK, Picture, Point, Rectangle, WHITE, dashes, polyline_length};

/// Default contour levels, as shares of the limit of the colour scale.
const LEVELS: [f64; 4] = [-0.5, -0.25, 0.25, 0.5];
const LEVEL_WIDTH: f64 = 1.4;
const LEVEL_DASHES: [f64; 2] = [7.0, 5.0];
/// Share of the colour scale above which contour lines are drawn in white.
const DARK: f64 = 0.6;

/// Maximum number of contour points, counting 10 extra points per line; above it no contour lines are drawn.
const MAX_LEVEL_POINTS: usize = 60_000;
/// Spacing of the hatching of negative values, pixels.
const RULED: f64 = 8.0;

/// Contour lines or hatching, which distinguish positive and negative values in greyscale.
pub(super) enum Levels {
    /// Contour lines, each with its level as a share of the limit of the colour scale.
    Lines(Vec<(f64, Vec<Point>)>),
    /// Hatching of large negative values, since there would be too many contour lines.
    Ruled,
    /// Neither: there would be too many of the requested contour lines of an unsigned quantity.
    TooMany,
    None,
}

impl FieldFigure {
    /// Returns whether contour lines are drawn if their number permits.
    pub(super) fn has_curves(&self, scale: &Scale) -> bool {
        self.curves.is_some() || scale.is_signed
    }

    /// Returns the contour levels as shares of the limit of the colour scale, ascending and distinct.
    pub(super) fn level_shares(&self, scale: &Scale) -> Vec<f64> {
        let Some(curves) = &self.curves else { return LEVELS.to_vec() };
        let mut shares: Vec<f64> = curves.iter().map(|level| level / scale.end).collect();
        shares.retain(|share| share.is_finite());
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    /// Hatches the cells with values below −¼ of the limit of the colour scale.
    pub(super) fn rule_negative(&self, picture: &mut Picture, scale: &Scale, raster: &Raster) {
        let values = raster.extremes(&self.values);
        let is_low =
            |column: usize, row: usize| values[row * raster.count(0) + column] < -0.25 * scale.end;
        picture.patches(rules(raster, RULED, 1.6, is_low), INK);
    }

    pub(super) fn levels(&self, scale: &Scale, layout: &Layout) -> Levels {
        if !self.has_curves(scale) || scale.end == 0.0 {
            return Levels::None;
        }
        let frame = layout.frame;
        let raster = Raster::new(self, frame, [COARSE; 2]);
        let means = raster.means(&self.values);
        let [columns, rows] = [0, 1].map(|axis| raster.count(axis));
        // The outermost values are repeated in one additional row or column on each side, so that lines reach the
        // frame.
        let inner = |index: usize, count: usize| index.clamp(1, count) - 1;
        let value = |i: usize, j: usize| means[inner(j, rows) * columns + inner(i, columns)];
        // Maps a position in the extended grid to a cell coordinate: cell centres inside, domain edges at the ends.
        let cell = |place: f64, axis: usize| {
            let (edges, count) = (&raster.edges[axis], raster.count(axis));
            let centre = |index: usize| match index {
                0 => 0.0,
                index if index > count => edges[count] as f64,
                index => 0.5 * (edges[index - 1] + edges[index]) as f64,
            };
            let below = (place.max(0.0) as usize).min(count);
            let (from, to) = (centre(below), centre(below + 1));
            from + (place - below as f64) * (to - from)
        };
        let mut lines = Vec::new();
        let mut effort = 0;
        for share in self.level_shares(scale) {
            for line in contour::lines(columns + 2, rows + 2, value, share * scale.end) {
                let points: Vec<Point> = line
                    .iter()
                    .map(|&[i, j]| [raster.x(cell(i, 0)), raster.y(cell(j, 1))])
                    .collect();
                // Lines too short to be drawn count as well: a field with many of them has no meaningful contours.
                effort += 10 + points.len();
                if effort > MAX_LEVEL_POINTS {
                    return if scale.is_signed { Levels::Ruled } else { Levels::TooMany };
                }
                if polyline_length(&points) > 12.0 {
                    lines.push((share, points));
                }
            }
        }
        if !lines.is_empty() || self.curves.is_some() {
            Levels::Lines(lines)
        } else if self.values.iter().any(|value| *value < -0.25 * scale.end) {
            Levels::Ruled
        } else if scale.is_fixed {
            Levels::Lines(lines)
        } else {
            Levels::None
        }
    }
}

/// Hatches an area like negative values of the field.
pub(super) fn draw_ruled(picture: &mut Picture, area: Rectangle) {
    let count = ((area.height() / RULED) as usize).max(1);
    let spacing = area.height() / count as f64;
    let line = |index: usize| {
        let y = area.top + (index as f64 + 0.5) * spacing;
        Rectangle { top: y - 0.8, bottom: y + 0.8, ..area }
    };
    picture.patches((0..count).map(line).collect(), INK);
}

pub(super) fn draw_level(picture: &mut Picture, share: f64, points: &[Point]) {
    let colour = if share.abs() > DARK { WHITE } else { INK };
    let pattern: &[f64] = if share < 0.0 { &LEVEL_DASHES } else { &[] };
    if pattern.is_empty() {
        return picture.line(points, LEVEL_WIDTH, colour);
    }
    for dash in dashes(points, pattern) {
        picture.line(dash, LEVEL_WIDTH, colour);
    }
}
