//! Branch numbers on discs, and rings for measured points.

use crate::picture::{Anchor, Colour, Picture, Point, Rectangle, Text, WHITE, text_width};

/// Outer radius of a ring, pixels.
pub(super) const RING_RADIUS: f64 = 9.0;

/// Colour of points that disagree.
pub(crate) const DISAGREEMENT_COLOUR: Colour = plotters::style::RGBColor(205, 0, 30);

/// Radius of the disc that carries a number, pixels.
pub(crate) const NUMBER_DISC_RADIUS: f64 = 15.0;

/// Draws a number on a disc, for lines and points that are explained in the legend.
pub(crate) fn draw_number_disc(
    picture: &mut Picture,
    [x, y]: Point,
    number: usize,
    colour: Colour,
) {
    picture.fill_disc([x, y], NUMBER_DISC_RADIUS + 1.5, WHITE);
    picture.fill_disc([x, y], NUMBER_DISC_RADIUS, colour);
    picture.fill_disc([x, y], NUMBER_DISC_RADIUS - 2.5, WHITE);
    let label_text = number.to_string();
    let size = (20.0_f64)
        .min(20.0 * 1.3 * NUMBER_DISC_RADIUS / text_width(&label_text, 20.0, true).max(1.0));
    let text = Text::new([x, y + 0.36 * size], Anchor::Middle, size, label_text);
    picture.draw_text(Text { is_bold: true, ..text });
}

/// Draws the ring of a measured point.
pub(crate) fn draw_ring(picture: &mut Picture, place: Point, colour: Colour) {
    picture.mark_point(place, RING_RADIUS);
    picture.fill_disc(place, RING_RADIUS + 1.5, WHITE);
    picture.fill_disc(place, RING_RADIUS, colour);
    picture.fill_disc(place, RING_RADIUS - 3.5, WHITE);
}

/// Draws the mark of a measured point that disagrees: a red cross over its ring.
pub(crate) fn draw_disagreement(picture: &mut Picture, [x, y]: Point) {
    const HALF: f64 = RING_RADIUS + 4.0;
    picture.mark_point([x, y], HALF);
    for (width, colour) in [(6.5, WHITE), (3.5, DISAGREEMENT_COLOUR)] {
        for sign in [-1.0, 1.0] {
            picture.draw_line(
                [[x - HALF, y - sign * HALF], [x + HALF, y + sign * HALF]],
                width,
                colour,
            );
        }
    }
}

/// Returns the bounding box of a tag.
pub(crate) fn number_disc_area([x, y]: Point) -> Rectangle {
    let half = NUMBER_DISC_RADIUS + 2.0;
    Rectangle { left: x - half, top: y - half, right: x + half, bottom: y + half }
}
