//! Numbers on the rings, placed clear of curves and spokes.

use super::circles::{RING_LABEL_SIZE, polar_to_point};
use crate::page::{self};
use crate::picture::{Anchor, Point, Rectangle, Text, circle_points, clip_polyline};
use crate::scale::Tick;

/// Places the numbers of the rings, given by their radii, where a ray at the angle `ray_angle` (degrees) crosses them;
/// the unit follows the outermost number.
pub(super) fn place_ring_numbers(
    rings: &[Tick],
    unit: &str,
    centre: Point,
    rim_radius: f64,
    ray_angle: f64,
) -> Vec<Text> {
    let labelled = || rings.iter().filter(|(_, label)| !label.is_empty());
    let outermost = labelled().map(|(radius, _)| *radius).fold(f64::NEG_INFINITY, f64::max);
    let number = |(radius, label): &Tick| {
        let unit = if *radius == outermost { unit } else { "" };
        let label_text = format!("{label} {unit}");
        let (label_text, size) =
            page::fit_text(label_text.trim_end(), RING_LABEL_SIZE, 0.5 * rim_radius);
        let [x, y] = polar_to_point(centre, ray_angle, *radius);
        Text::new([x, y + 0.36 * size], Anchor::Middle, size, label_text)
    };
    labelled().map(number).collect()
}

/// Places the numbers of the rings on the steep ray in the lower half with the least cost: each number crossed by a
/// line costs 1, and a spoke near the ray (`spoke_angles` in degrees) costs up to 1 for each number.
pub(crate) fn choose_ring_numbers(
    rings: &[Tick],
    unit: &str,
    spoke_angles: &[f64],
    centre: Point,
    rim_radius: f64,
    lines: &[Vec<(f64, Point)>],
) -> Vec<Text> {
    let mut lines: Vec<Vec<Point>> =
        lines.iter().map(|line| line.iter().map(|(_, point)| *point).collect()).collect();
    // The rim counts as a line, since the angles are written outside it.
    lines.push(circle_points(centre, rim_radius, 360));
    let spoke_distance = |ray: f64| {
        spoke_angles
            .iter()
            .map(|spoke| (ray - spoke).rem_euclid(180.0))
            .map(|gap| gap.min(180.0 - gap))
            .fold(SPOKE_CLEARANCE, f64::min)
    };
    let best = (0..=28).map(|step| RAY_ANGLE_RANGE[0] + 2.0 * f64::from(step)).map(|ray| {
        let numbers = place_ring_numbers(rings, unit, centre, rim_radius, ray);
        let covered = numbers
            .iter()
            .map(text_background)
            .filter(|area| lines.iter().any(|line| !clip_polyline(line, *area).is_empty()));
        // A spoke covered by the numbers costs as much as covered curves.
        let cost = covered.count() as f64
            + numbers.len() as f64 * (1.0 - spoke_distance(ray) / SPOKE_CLEARANCE);
        (cost, numbers)
    });
    best.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Vec::new, |(_, numbers)| numbers)
}

/// Returns how many ring numbers fit on a steep ray of `length` pixels.
pub(crate) fn max_ring_numbers(length: f64) -> usize {
    (length * RAY_ANGLE_RANGE[0].to_radians().sin().abs() / (1.3 * RING_LABEL_SIZE)) as usize
}

/// Range of the angle of the ray on which the ring numbers are placed, degrees: steep, so that numbers do not overlap.
const RAY_ANGLE_RANGE: [f64; 2] = [242.0, 298.0];
/// Angle between ray and spoke, degrees, above which a spoke has no cost.
const SPOKE_CLEARANCE: f64 = 12.0;

/// Returns the background area of a number on a ring.
pub(crate) fn text_background(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle { left: bounds.left - 4.0, right: bounds.right + 4.0, ..bounds }
}
