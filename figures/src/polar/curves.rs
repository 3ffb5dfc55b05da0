//! Curves over the full circle, and their markers.

use super::circles::at;
use crate::growth::{LINE_WIDTH, LOOKS, MARKER_SPACING, draw_marker};
use crate::picture::{Picture, Point};

/// Computes the points of a curve over the full circle from its half circle, each with its angle in degrees; NaN where
/// the curve is interrupted. `radius` maps a value to a radius in pixels.
pub(crate) fn places(
    line: &[[f64; 2]],
    centre: Point,
    radius: impl Fn(f64) -> f64,
) -> Vec<(f64, Point)> {
    let place = |&[angle, value]: &[f64; 2], turn: f64| {
        let is_drawn = angle.is_finite() && !value.is_nan();
        let angle = angle + turn;
        (angle, if is_drawn { at(centre, angle, radius(value)) } else { GAP })
    };
    let half = |turn: f64| line.iter().map(move |point| (*point, turn));
    // The two half circles are connected if the curve covers all directions.
    let ends = line.first().zip(line.last());
    let meets = ends.is_some_and(|(first, last)| last[0] - first[0] >= 180.0 - 1e-9);
    let gap = (!meets).then_some(([f64::NAN; 2], 0.0));
    half(0.0).chain(gap).chain(half(180.0)).map(|(point, turn)| place(&point, turn)).collect()
}

/// Placeholder position where a curve is interrupted.
const GAP: Point = [f64::NAN; 2];

pub(super) fn draw_curve(
    picture: &mut Picture,
    centre: Point,
    index: usize,
    places: &[(f64, Point)],
) {
    let look = &LOOKS[index % LOOKS.len()];
    for part in parts(places) {
        picture.dashed(&part, look.dashes, LINE_WIDTH, look.colour);
    }
    draw_markers(picture, centre, index, places);
}

/// Splits a curve at its gaps.
pub(crate) fn parts(places: &[(f64, Point)]) -> Vec<Vec<Point>> {
    let parts = places.split(|(_, point)| point[0].is_nan()).filter(|part| part.len() > 1);
    parts.map(|part| part.iter().map(|(_, point)| *point).collect()).collect()
}

/// Draws the markers along a curve.
pub(crate) fn draw_markers(
    picture: &mut Picture,
    centre: Point,
    index: usize,
    places: &[(f64, Point)],
) {
    let look = &LOOKS[index % LOOKS.len()];
    // Markers are spaced by polar angle, so that radial spikes do not have dense markers.
    let step = |[x, y]: Point| {
        let radius = (x - centre[0]).hypot(y - centre[1]).max(1.0);
        (1.4 * MARKER_SPACING / radius).to_degrees()
    };
    let mut next = f64::NEG_INFINITY;
    for &(angle, point) in places.iter().filter(|(_, point)| !point[0].is_nan()) {
        if next == f64::NEG_INFINITY {
            // The first marker of each curve is shifted, so that markers of coincident curves are all visible.
            next = angle + step(point) * (0.25 + 0.28 * index as f64);
        }
        if angle >= next {
            draw_marker(picture, point, look);
            next = angle + step(point);
        }
    }
}
