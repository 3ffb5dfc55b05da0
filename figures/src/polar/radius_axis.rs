//! Axis of the radius, below the disc, so that no number covers a curve.

use super::circles::{NEUTRAL_COLOUR, RING_LABEL_SIZE};
use crate::page;
use crate::picture::{Anchor, Picture, Point, Rectangle, Text, text_width};
use crate::scale::Tick;

/// Height of the axis with its numbers, pixels.
pub(super) const RADIUS_AXIS_HEIGHT: f64 = 54.0;
/// Length of the ticks, pixels.
const TICK_LENGTH: f64 = 9.0;

/// Draws the axis to the right of the centre of the disc at the height `top`, between the radii `ends`, with ticks at the
/// rings, given by their radii in ascending order, and the name of the radius to the left. Negative numbers end at their
/// ticks, since zero is near.
pub(super) fn draw_radius_axis(
    picture: &mut Picture,
    rings: &[Tick],
    name: &str,
    [centre, top]: Point,
    ends: [f64; 2],
    left_end: f64,
) {
    picture.draw_line(ends.map(|end| [centre + end, top]), 1.8, NEUTRAL_COLOUR);
    let baseline = top + TICK_LENGTH + 1.1 * RING_LABEL_SIZE;
    let mut free_from = f64::NEG_INFINITY;
    let mut name_end = centre - 0.5 * text_width("0", RING_LABEL_SIZE, false);
    for (size, label) in rings.iter().filter(|(size, _)| *size <= ends[1] + 1e-9) {
        let x = centre + size;
        let width = text_width(label, RING_LABEL_SIZE, false);
        let is_negative = label.starts_with('−');
        let left = if is_negative { x + 8.0 - width } else { x - 0.5 * width };
        let is_labelled = !label.is_empty() && left >= free_from;
        let length = if is_labelled { TICK_LENGTH } else { 0.6 * TICK_LENGTH };
        picture.draw_line([[x, top], [x, top + length]], 1.8, NEUTRAL_COLOUR);
        if is_labelled {
            let text = Text::new([left, baseline], Anchor::Start, RING_LABEL_SIZE, label);
            name_end = name_end.min(left);
            free_from = text.bounds().right + 10.0;
            picture.draw_text(text);
        }
    }
    let right = name_end - 16.0;
    let (name, size) = page::fit_text(name, RING_LABEL_SIZE, right - left_end);
    picture.draw_text(Text::new([right, baseline], Anchor::End, size, name));
}

/// Returns how many numbers fit on an axis of `length` pixels.
pub(crate) fn max_ring_numbers(length: f64) -> usize {
    (length / (2.6 * RING_LABEL_SIZE)) as usize
}

/// Returns the background area of a text.
pub(crate) fn text_background(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle { left: bounds.left - 4.0, right: bounds.right + 4.0, ..bounds }
}
