//! Branch numbers on discs, and rings for measured points.

use crate::picture::{Anchor, Colour, Picture, Point, Rectangle, Text, WHITE, text_width};

/// Outer radius of a ring, pixels.
pub(super) const RING_RADIUS: f64 = 9.0;

/// Colour of points that disagree.
pub(crate) const DISAGREEMENT_COLOUR: Colour = plotters::style::RGBColor(205, 0, 30);

/// Radius of the disc that carries a number, pixels.
pub(crate) const NUMBER_DISC_RADIUS: f64 = 15.0;

/// Draws a number on a disc, for lines and points that are explained in the legend.
pub(crate) fn draw_number_disc(picture: &mut Picture, place: Point, number: usize, colour: Colour) {
    draw_numbers(picture, place, &[number], colour);
}

/// Draws the numbers of coincident lines, `2, 8`, on a disc lengthened to a pill.
pub(crate) fn draw_numbers(
    picture: &mut Picture,
    [x, y]: Point,
    numbers: &[usize],
    colour: Colour,
) {
    let half = numbers_half_length(numbers);
    for (radius, colour) in [
        (NUMBER_DISC_RADIUS + 1.5, WHITE),
        (NUMBER_DISC_RADIUS, colour),
        (NUMBER_DISC_RADIUS - 2.5, WHITE),
    ] {
        for sign in [-1.0, 1.0] {
            picture.fill_disc([x + sign * half, y], radius, colour);
        }
        let [left, right] = [x - half, x + half];
        picture
            .fill_rectangle(Rectangle { left, right, top: y - radius, bottom: y + radius }, colour);
    }
    let label_text = join_numbers(numbers);
    let room = 1.3 * NUMBER_DISC_RADIUS + 2.0 * half;
    let size = (20.0_f64).min(20.0 * room / text_width(&label_text, 20.0, true).max(1.0));
    let text = Text::new([x, y + 0.36 * size], Anchor::Middle, size, label_text);
    picture.draw_text(Text { is_bold: true, ..text });
}

/// Draws the ring of a measured point.
pub(crate) fn draw_ring(picture: &mut Picture, place: Point, colour: Colour) {
    draw_ring_of_radius(picture, place, RING_RADIUS, colour);
}

/// Draws rings, each with its colour, inside a frame, which omits those that it would clip. Of rings at about one place
/// those of earlier colours enclose those of later ones, which would hide them.
pub(crate) fn draw_rings(picture: &mut Picture, rings: &[(Point, Colour)], frame: Rectangle) {
    for (index, (place, colour)) in rings.iter().enumerate() {
        let [x, y] = *place;
        let is_near = |other: &Point| (other[0] - x).hypot(other[1] - y) < RING_RADIUS;
        let mut inner: Vec<Colour> = Vec::new();
        for (other, own) in &rings[index + 1..] {
            if own != colour && is_near(other) && !inner.contains(own) {
                inner.push(*own);
            }
        }
        let radius = RING_RADIUS * (1.0 + 0.55 * inner.len() as f64);
        if x > frame.left + radius
            && x < frame.right - radius
            && y > frame.top + radius
            && y < frame.bottom - radius
        {
            draw_ring_of_radius(picture, *place, radius, *colour);
        }
    }
}

fn draw_ring_of_radius(picture: &mut Picture, place: Point, radius: f64, colour: Colour) {
    picture.mark_point(place, radius);
    picture.fill_disc(place, radius + 1.5, WHITE);
    picture.fill_disc(place, radius, colour);
    picture.fill_disc(place, radius - 3.5, WHITE);
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

fn join_numbers(numbers: &[usize]) -> String {
    numbers.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
}

/// Returns half the distance between the centres of the round ends of a pill of numbers, pixels; 0 for one number.
fn numbers_half_length(numbers: &[usize]) -> f64 {
    match numbers {
        [_] => 0.0,
        _ => 0.5 * (text_width(&join_numbers(numbers), 20.0, true) - NUMBER_DISC_RADIUS).max(0.0),
    }
}

/// Returns the bounding box of a disc with a number, also of one measured point.
pub(crate) fn number_disc_area(place: Point) -> Rectangle {
    numbers_area(place, &[1])
}

/// Returns the bounding box of the numbers of coincident lines.
pub(super) fn numbers_area([x, y]: Point, numbers: &[usize]) -> Rectangle {
    let height = NUMBER_DISC_RADIUS + 2.0;
    let width = height + numbers_half_length(numbers);
    Rectangle { left: x - width, top: y - height, right: x + width, bottom: y + height }
}
