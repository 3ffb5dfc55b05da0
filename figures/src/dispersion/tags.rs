//! Branch numbers on discs, and rings for measured points.

use crate::picture::{Anchor, Colour, Picture, Point, Rectangle, Text, WHITE, text_width};

/// Outer radius of a ring, pixels.
pub(super) const RING: f64 = 9.0;

/// Radius of the disc that carries a number, pixels.
pub(crate) const TAG: f64 = 15.0;

/// Draws a number on a disc, for lines and points that are explained in the legend.
pub(crate) fn draw_tag(picture: &mut Picture, [x, y]: Point, number: usize, colour: Colour) {
    picture.disc([x, y], TAG + 1.5, WHITE);
    picture.disc([x, y], TAG, colour);
    picture.disc([x, y], TAG - 2.5, WHITE);
    let words = number.to_string();
    let size = (20.0_f64).min(20.0 * 1.3 * TAG / text_width(&words, 20.0, true).max(1.0));
    let text = Text::new([x, y + 0.36 * size], Anchor::Middle, size, words);
    picture.text(Text { bold: true, ..text });
}

/// Draws the ring of a measured point.
pub(crate) fn draw_ring(picture: &mut Picture, place: Point, colour: Colour) {
    picture.disc(place, RING + 1.5, WHITE);
    picture.disc(place, RING, colour);
    picture.disc(place, RING - 3.5, WHITE);
}

/// Returns the bounding box of a tag.
pub(crate) fn tag_area([x, y]: Point) -> Rectangle {
    let half = TAG + 2.0;
    Rectangle { left: x - half, top: y - half, right: x + half, bottom: y + half }
}
