//! Contour lines, or ruling of negative values where these would be too many.

use super::cells::rules;
use super::colour_map::Scale;
use super::figure::FieldFigure;
use super::layout::Layout;
use super::raster::{COARSE, Raster};
use crate::contour;
use crate::picture::{INK, Picture, Point, Rectangle, WHITE, dashes, polyline_length};

/// Contour lines, as shares of the end of the colours.
const LEVELS: [f64; 4] = [-0.5, -0.25, 0.25, 0.5];
const LEVEL_WIDTH: f64 = 1.4;
const LEVEL_DASHES: [f64; 2] = [7.0, 5.0];
/// Lines on colours darker than this share of the scale are white.
const DARK: f64 = 0.6;

/// Points of contour lines above which they are no help; each line counts for some more.
const MOST_LEVEL_POINTS: usize = 60_000;
/// Distance of the lines over negative values where contour lines would be too many.
const RULED: f64 = 8.0;

/// Contours that distinguish positive and negative values in greyscale.
pub(super) enum Levels {
    /// Contour lines with the share of the end of the colours that they belong to.
    Lines(Vec<(f64, Vec<Point>)>),
    /// No contour lines, as they would be too many: large negative values are hatched instead.
    Ruled,
    /// Too many requested contour lines of a quantity without a sign: none are drawn.
    TooMany,
    None,
}

impl FieldFigure {
    /// Whether contour lines are drawn if the values permit.
    pub(super) fn has_curves(&self, scale: &Scale) -> bool {
        self.curves.is_some() || scale.is_signed
    }

    /// The values with lines, as shares of the end of the colours.
    pub(super) fn level_shares(&self, scale: &Scale) -> Vec<f64> {
        let Some(curves) = &self.curves else { return LEVELS.to_vec() };
        let mut shares: Vec<f64> = curves.iter().map(|level| level / scale.end).collect();
        shares.retain(|share| share.is_finite());
        shares.sort_by(f64::total_cmp);
        shares.dedup();
        shares
    }

    /// Rules the negative values that are darker than a quarter of the scale.
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
        // One cell more all around repeats the outermost values, so that lines reach the frame.
        let inner = |index: usize, count: usize| index.clamp(1, count) - 1;
        let value = |i: usize, j: usize| means[inner(j, rows) * columns + inner(i, columns)];
        // From places on the grid to cells: to the middle of each, or to an edge of the domain.
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
                // Specks tell nothing, but many of them that there is no line to follow.
                effort += 10 + points.len();
                if effort > MOST_LEVEL_POINTS {
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

/// The ruling of negative values over an area.
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
