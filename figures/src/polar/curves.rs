//! Curves over the full circle.

use super::circles::polar_to_point;
use crate::growth::LineStyle;
use crate::picture::{Picture, Point};

/// Computes the points of a curve over the full circle from its half circle, each with its angle in degrees; NaN where
/// the curve is interrupted. `radius` maps a value to a radius in pixels.
pub(crate) fn full_circle_points(
    line: &[[f64; 2]],
    centre: Point,
    radius: impl Fn(f64) -> f64,
) -> Vec<(f64, Point)> {
    let place = |&[angle, value]: &[f64; 2], turn: f64| {
        let is_drawn = angle.is_finite() && !value.is_nan();
        let angle = angle + turn;
        (angle, if is_drawn { polar_to_point(centre, angle, radius(value)) } else { GAP_POINT })
    };
    let half = |turn: f64| line.iter().map(move |point| (*point, turn));
    // The two half circles are connected if the curve covers all directions.
    let ends = line.first().zip(line.last());
    let meets = ends.is_some_and(|(first, last)| last[0] - first[0] >= 180.0 - 1e-9);
    let gap = (!meets).then_some(([f64::NAN; 2], 0.0));
    half(0.0).chain(gap).chain(half(180.0)).map(|(point, turn)| place(&point, turn)).collect()
}

/// Placeholder position where a curve is interrupted.
const GAP_POINT: Point = [f64::NAN; 2];

pub(super) fn draw_curve(picture: &mut Picture, index: usize, points: &[(f64, Point)]) {
    for part in split_at_gaps(points) {
        LineStyle::from_index(index).draw(picture, &part);
    }
}

/// Splits a curve at its gaps; parts of a single point are omitted.
pub(crate) fn split_at_gaps(points: &[(f64, Point)]) -> Vec<Vec<Point>> {
    let parts = points.split(|(_, point)| point[0].is_nan()).filter(|part| part.len() > 1);
    parts.map(|part| part.iter().map(|(_, point)| *point).collect()).collect()
}
