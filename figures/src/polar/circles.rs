//! Circles about a centre, and points in polar coordinates.

use plotters::style::RGBColor;

use crate::picture::{Colour, Picture, Point, circle_points};

pub(crate) const RING_COLOUR: Colour = RGBColor(205, 205, 205);
pub(crate) const NEUTRAL_COLOUR: Colour = RGBColor(110, 110, 110);

/// Font size of the numbers on rings and of the angles around the rim, pixels.
pub(crate) const RING_LABEL_SIZE: f64 = 22.0;

/// Converts polar coordinates about a centre to a point; angle in degrees anticlockwise.
pub(crate) fn polar_to_point(centre: Point, angle_deg: f64, radius: f64) -> Point {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    [centre[0] + radius * cos, centre[1] - radius * sin]
}

/// Draws a circle.
pub(crate) fn draw_circle(
    picture: &mut Picture,
    centre: Point,
    radius: f64,
    width: f64,
    colour: Colour,
) {
    let mut rim = circle_points(centre, radius, 360);
    rim.extend_from_within(..2);
    picture.draw_line(rim, width, colour);
}
