//! Arrows of a vector field, and level curves of its magnitude.

use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::legend::{FieldLegendEntry, build_entry, build_note};
use super::raster::{FieldRaster, MAX_COARSE_CELLS};
use crate::picture::{INK, Picture, Point, Rectangle, WHITE};
use crate::scale::format_number;

/// Arrow that represents a vector at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FieldArrow {
    /// Coordinates of the middle of the arrow, in the units of the axes.
    pub position: [f64; 2],
    /// Components along x and y, in the unit of [`FieldArrows::unit`].
    pub vector: [f64; 2],
}

/// Vector field over the domain: arrows whose length grows as the square root of the magnitude, and level curves of the
/// magnitude at 1, 2 and 5 times powers of ten, from one hundredth of its maximum on. With arrows, the values have no
/// contour lines.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldArrows {
    /// Name and symbol of the vector.
    pub label: String,
    /// Symbol of the magnitude.
    pub magnitude_label: String,
    /// Unit of the vector.
    pub unit: String,
    /// Arrows. If they are too close to be distinguished, every second, third, … along each axis is drawn.
    pub arrows: Vec<FieldArrow>,
    /// Magnitude in each cell, for level curves, in the order of the values of the figure; empty for none.
    pub magnitudes: Vec<f64>,
}

/// Minimum distance of arrows along an axis, pixels.
const MIN_ARROW_DISTANCE: f64 = 30.0;
/// Length of the longest arrow relative to the distance of arrows.
const ARROW_LENGTH_RATIO: f64 = 1.7;
/// Arrows shorter than this are not drawn, pixels.
const MIN_ARROW_LENGTH: f64 = 3.0;
/// Upper limit of the length of the longest arrow, pixels.
const MAX_ARROW_LENGTH: f64 = 90.0;
/// Longest arrow in the legend, pixels.
const MAX_LEGEND_ARROW_LENGTH: f64 = 64.0;
const LEVEL_CURVE_WIDTH: f64 = 1.2;
const LEVEL_CURVE_DASHES: [f64; 2] = [9.0, 4.0];

/// Scale of the arrows, and selection of those that are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ArrowScale {
    /// Largest magnitude of an arrow.
    max_magnitude: f64,
    /// Length of the arrow of the largest magnitude, pixels.
    max_length: f64,
    /// Arrows are drawn at every `stride`-th coordinate along each axis.
    stride: usize,
}

/// Distinct coordinates along an axis, ascending.
fn distinct_coordinates(mut all: Vec<f64>, tolerance: f64) -> Vec<f64> {
    all.sort_by(f64::total_cmp);
    all.dedup_by(|one, other| (*one - *other).abs() <= tolerance);
    all
}

fn magnitude([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Returns the largest of 1, 2 and 5 times a power of ten that does not exceed `value`, which is positive.
fn round_down(value: f64) -> f64 {
    let power = 10f64.powi(value.log10().floor() as i32);
    let factor = [5.0, 2.0, 1.0].into_iter().find(|factor| factor * power <= value);
    factor.map_or(0.5 * power, |factor| factor * power)
}

/// Returns the levels of the curves, descending: 1, 2 and 5 times powers of ten from a hundredth of `max_magnitude` on.
fn curve_levels(max_magnitude: f64) -> Vec<f64> {
    let mut levels = Vec::new();
    let mut level = round_down(0.999 * max_magnitude);
    while level >= 0.01 * max_magnitude && level.is_normal() && levels.len() < 7 {
        levels.push(level);
        level = round_down(0.999 * level);
    }
    levels
}

impl ArrowScale {
    /// Returns the length of an arrow, pixels: it grows as the square root, so that a decaying field is visible.
    fn length(&self, magnitude: f64) -> f64 {
        self.max_length * (magnitude / self.max_magnitude).sqrt()
    }
}

impl FieldArrows {
    /// Returns the largest magnitude of an arrow; 0 without finite arrows.
    fn max_magnitude(&self) -> f64 {
        let sizes = self.arrows.iter().map(|arrow| magnitude(arrow.vector));
        sizes.filter(|size| size.is_finite()).fold(0.0, f64::max)
    }

    /// Distinct coordinates of the arrows along an axis, ascending.
    fn arrow_coordinates(&self, axis: usize) -> Vec<f64> {
        let all: Vec<f64> = self.arrows.iter().map(|arrow| arrow.position[axis]).collect();
        let extent = all.iter().fold(0.0, |extent: f64, own| extent.max(own.abs()));
        distinct_coordinates(all, 1e-9 * extent)
    }

    /// Returns the arrows at every `stride`-th coordinate along each axis, among them the middle ones.
    fn select_arrows(&self, stride: usize) -> impl Iterator<Item = &FieldArrow> {
        let coordinates = [0, 1].map(|axis| self.arrow_coordinates(axis));
        let is_selected = move |arrow: &&FieldArrow| {
            (0..2).all(|axis| {
                let own = &coordinates[axis];
                // Coordinates that differ by rounding have one index.
                let at = arrow.position[axis];
                let above = own.partition_point(|other| *other < at);
                let nearest = [above.saturating_sub(1), above.min(own.len() - 1)]
                    .into_iter()
                    .min_by(|a, b| (own[*a] - at).abs().total_cmp(&(own[*b] - at).abs()));
                nearest.is_some_and(|index| index % stride == (own.len() - 1) / 2 % stride)
            })
        };
        self.arrows.iter().filter(is_selected)
    }
}

impl FieldFigure {
    /// Determines the scale of the arrows in a frame; `None` without arrows of finite, positive length.
    pub(super) fn arrow_scale(&self, frame: Rectangle) -> Option<ArrowScale> {
        let own = self.arrows.as_ref()?;
        let max_magnitude = own.max_magnitude();
        if max_magnitude <= 0.0 {
            return None;
        }
        let mut distance = f64::INFINITY;
        for axis in 0..2 {
            let places = own.arrow_coordinates(axis);
            if let [first, .., last] = places[..] {
                let ends = [first, last].map(|end| self.pixel(frame, axis, end));
                distance = distance.min((ends[1] - ends[0]).abs() / (places.len() - 1) as f64);
            }
        }
        let stride = match distance.is_finite() && distance > 0.0 {
            true => (MIN_ARROW_DISTANCE / distance).ceil().max(1.0),
            false => 1.0,
        };
        let max_length = (ARROW_LENGTH_RATIO * stride * distance).min(MAX_ARROW_LENGTH);
        Some(ArrowScale { max_magnitude, max_length, stride: stride as usize })
    }

    /// Traces the level curves of the magnitude, each with its level.
    pub(super) fn magnitude_curves(&self, layout: &FieldLayout) -> Vec<(f64, Vec<Point>)> {
        let Some(own) = self.arrows.as_ref().filter(|own| !own.magnitudes.is_empty()) else {
            return Vec::new();
        };
        let raster = FieldRaster::new(self, layout.frame, [MAX_COARSE_CELLS; 2]);
        let means = raster.mean_values(&own.magnitudes);
        let mut curves = Vec::new();
        for level in curve_levels(own.max_magnitude()) {
            let lines = raster.trace_contours(&means, level).into_iter();
            curves.extend(lines.filter(|line| line.len() > 2).map(|line| (level, line)));
        }
        curves
    }

    pub(super) fn draw_magnitude_curves(
        &self,
        picture: &mut Picture,
        curves: &[(f64, Vec<Point>)],
    ) {
        for (_, line) in curves {
            draw_level_curve(picture, line);
        }
    }

    /// Places the arrows: the middle of each, and its vector in pixels, downwards positive.
    pub(super) fn place_arrows(
        &self,
        frame: Rectangle,
        scale: Option<ArrowScale>,
    ) -> Vec<(Point, Point)> {
        let (Some(own), Some(scale)) = (&self.arrows, scale) else { return Vec::new() };
        let is_inside = |[x, y]: Point| {
            (frame.left..=frame.right).contains(&x) && (frame.top..=frame.bottom).contains(&y)
        };
        // The vertical axis points upwards, pixels count downwards; either axis may be reversed.
        let sign = [&self.x, &self.y].map(|axis| (axis.end - axis.start).signum());
        let place = |arrow: &FieldArrow| {
            let at = [0, 1].map(|axis| self.pixel(frame, axis, arrow.position[axis]));
            let size = magnitude(arrow.vector);
            let length = scale.length(size);
            let [x, y] = arrow.vector.map(|part| length * part / size);
            let vector = [sign[0] * x, -sign[1] * y];
            // An arrow across the frame could cover the ticks.
            let ends = [-0.5, 0.5].map(|share| [0, 1].map(|axis| at[axis] + share * vector[axis]));
            let is_drawn = ends.into_iter().all(is_inside)
                && length >= MIN_ARROW_LENGTH
                && size <= scale.max_magnitude;
            is_drawn.then_some((at, vector))
        };
        own.select_arrows(scale.stride).filter_map(place).collect()
    }

    /// Builds the legend entries of arrows and level curves.
    pub(super) fn arrow_entries(&self, scale: Option<ArrowScale>) -> Vec<FieldLegendEntry> {
        let Some(own) = &self.arrows else { return Vec::new() };
        let FieldArrows { label, magnitude_label, unit, .. } = own;
        let Some(scale) = scale else {
            return vec![build_note(format!("{label}: zero everywhere"))];
        };
        let ArrowScale { max_magnitude, max_length, .. } = scale;
        let value =
            round_down(max_magnitude * (MAX_LEGEND_ARROW_LENGTH / max_length).min(1.0).powi(2));
        let length = scale.length(value);
        let place = match scale.stride {
            1 => String::new(),
            2 => ", at every 2nd junction".to_owned(),
            3 => ", at every 3rd junction".to_owned(),
            stride => format!(", at every {stride}th junction"),
        };
        let text = format!(
            "{label}: {} {unit} (length ∝ √{magnitude_label}), largest {}{place}",
            format_number(value),
            format_number(max_magnitude)
        );
        let swatch = move |picture: &mut Picture, area: Rectangle| {
            let middle = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
            draw_arrow(picture, middle, [length, 0.0]);
        };
        let mut entries = vec![build_entry(text, swatch)];
        if !own.magnitudes.is_empty() {
            let swatch = |picture: &mut Picture, area: Rectangle| {
                let y = 0.5 * (area.top + area.bottom);
                draw_level_curve(picture, &[[area.left, y], [area.right, y]]);
            };
            let text = format!("level curves of {magnitude_label}, {unit}, as numbered");
            entries.push(build_entry(text, swatch));
        }
        entries
    }
}

/// Draws a level curve: dashed, which distinguishes it from lines of joints and borders.
fn draw_level_curve(picture: &mut Picture, line: &[Point]) {
    picture.draw_line(line, LEVEL_CURVE_WIDTH + 1.6, WHITE);
    picture.draw_dashed_line(line, &LEVEL_CURVE_DASHES, LEVEL_CURVE_WIDTH, INK);
}

/// Draws an arrow with a white rim about its middle; `vector` is in pixels, downwards positive.
pub(super) fn draw_arrow(picture: &mut Picture, [x, y]: Point, [dx, dy]: [f64; 2]) {
    let length = dx.hypot(dy);
    let unit = [dx / length, dy / length];
    let head = (0.45 * length).min(11.0);
    let along = |distance: f64, aside: f64| {
        [x + distance * unit[0] - aside * unit[1], y + distance * unit[1] + aside * unit[0]]
    };
    let (start, tip) = (-0.5 * length, 0.5 * length);
    for (more, colour) in [(1.1, WHITE), (0.0, INK)] {
        let (half, end) = (0.42 * head + 1.4 * more, tip + 2.0 * more);
        picture.draw_line(
            [along(start - more, 0.0), along(tip - 0.8 * head, 0.0)],
            1.8 + 2.0 * more,
            colour,
        );
        let corners = [(end, 0.0), (tip - head - more, half), (tip - head - more, -half)];
        picture.fill_polygon(corners.map(|(d, a)| along(d, a)).to_vec(), colour);
    }
}

/// Returns squares that cover an arrow.
pub(super) fn arrow_areas(([x, y], [dx, dy]): (Point, Point)) -> impl Iterator<Item = Rectangle> {
    const HALF: f64 = 5.0;
    let count = (dx.hypot(dy) / HALF).ceil().max(1.0);
    (0..=count as usize).map(move |index| {
        let share = index as f64 / count - 0.5;
        let [x, y] = [x + share * dx, y + share * dy];
        Rectangle { left: x - HALF, right: x + HALF, top: y - HALF, bottom: y + HALF }
    })
}
