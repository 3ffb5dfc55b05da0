//! Curves over the full circle and their markers.

use super::circles::at;
use crate::growth::{LINE_WIDTH, LOOKS, MARKER_SPACING, draw_marker};
use crate::picture::{Picture, Point};

/// The points of a line over the full circle, with their angles; NaN where it is
/// interrupted. `radius` gives the radius of a value.
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
    // The two halves meet where the line covers all directions.
    let ends = line.first().zip(line.last());
    let meets = ends.is_some_and(|(first, last)| last[0] - first[0] >= 180.0 - 1e-9);
    let gap = (!meets).then_some(([f64::NAN; 2], 0.0));
    half(0.0).chain(gap).chain(half(180.0)).map(|(point, turn)| place(&point, turn)).collect()
}

/// Positions at which a line is interrupted.
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

/// The uninterrupted parts of a line.
pub(crate) fn parts(places: &[(f64, Point)]) -> Vec<Vec<Point>> {
    let parts = places.split(|(_, point)| point[0].is_nan()).filter(|part| part.len() > 1);
    parts.map(|part| part.iter().map(|(_, point)| *point).collect()).collect()
}

/// Draws the markers along a line.
pub(crate) fn draw_markers(
    picture: &mut Picture,
    centre: Point,
    index: usize,
    places: &[(f64, Point)],
) {
    let look = &LOOKS[index % LOOKS.len()];
    // By the angle that the line has turned, so that spikes carry no crowd of markers.
    let step = |[x, y]: Point| {
        let radius = (x - centre[0]).hypot(y - centre[1]).max(1.0);
        (1.4 * MARKER_SPACING / radius).to_degrees()
    };
    let mut next = f64::NEG_INFINITY;
    for &(angle, point) in places.iter().filter(|(_, point)| !point[0].is_nan()) {
        if next == f64::NEG_INFINITY {
            // Each line's markers start elsewhere, so that lines on top of each other show all.
            next = angle + step(point) * (0.25 + 0.28 * index as f64);
        }
        if angle >= next {
            draw_marker(picture, point, look);
            next = angle + step(point);
        }
    }
}
