//! Numbers on the rings, placed clear of curves and spokes.

use super::circles::{RING_LABEL, at};
use crate::page::{self};
use crate::picture::{Anchor, Point, Rectangle, Text, circle, clip};
use crate::scale::Tick;

/// Places the numbers of the rings, given by their radii, where a ray at the angle `ray` (degrees) crosses them; the
/// unit follows the outermost number.
pub(super) fn numbers(rings: &[Tick], unit: &str, centre: Point, rim: f64, ray: f64) -> Vec<Text> {
    let labelled = || rings.iter().filter(|(_, label)| !label.is_empty());
    let outermost = labelled().map(|(radius, _)| *radius).fold(f64::NEG_INFINITY, f64::max);
    let number = |(radius, label): &Tick| {
        let unit = if *radius == outermost { unit } else { "" };
        let words = format!("{label} {unit}");
        let (words, size) = page::fit(words.trim_end(), RING_LABEL, 0.5 * rim);
        let [x, y] = at(centre, ray, *radius);
        Text::new([x, y + 0.36 * size], Anchor::Middle, size, words)
    };
    labelled().map(number).collect()
}

/// Places the numbers of the rings on the steep ray in the lower half with the least cost: covered numbers count 1, and
/// spokes (angles in degrees) near the ray count as well.
pub(crate) fn best_numbers(
    rings: &[Tick],
    unit: &str,
    spokes: &[f64],
    centre: Point,
    rim: f64,
    lines: &[Vec<(f64, Point)>],
) -> Vec<Text> {
    let mut lines: Vec<Vec<Point>> =
        lines.iter().map(|line| line.iter().map(|(_, point)| *point).collect()).collect();
    // The rim counts as a line, since the angles are written outside it.
    lines.push(circle(centre, rim, 360));
    let room = |ray: f64| {
        spokes
            .iter()
            .map(|spoke| (ray - spoke).rem_euclid(180.0))
            .map(|gap| gap.min(180.0 - gap))
            .fold(MAX_ROOM, f64::min)
    };
    let best = (0..=28).map(|step| STEEP[0] + 2.0 * f64::from(step)).map(|ray| {
        let numbers = numbers(rings, unit, centre, rim, ray);
        let covered = numbers
            .iter()
            .map(backing)
            .filter(|area| lines.iter().any(|line| !clip(line, *area).is_empty()));
        // A spoke behind the numbers costs as much as covered curves.
        let cost = covered.count() as f64 + numbers.len() as f64 * (1.0 - room(ray) / MAX_ROOM);
        (cost, numbers)
    });
    best.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Vec::new, |(_, numbers)| numbers)
}

/// Returns the maximum number of numbers on a steep ray of `length` pixels.
pub(crate) fn most_numbers(length: f64) -> usize {
    (length * STEEP[0].to_radians().sin().abs() / (1.3 * RING_LABEL)) as usize
}

/// Range of the angles of the ray of numbers, degrees: steep, so that numbers do not overlap. Angular distance to
/// spokes, degrees, above which spokes cost nothing.
const STEEP: [f64; 2] = [242.0, 298.0];
const MAX_ROOM: f64 = 12.0;

/// Returns the background area of a number on a ring.
pub(crate) fn backing(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle { left: bounds.left - 4.0, right: bounds.right + 4.0, ..bounds }
}
