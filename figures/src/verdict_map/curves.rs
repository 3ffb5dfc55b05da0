//! Curves over the map, dashed and with a white rim.

use plotters::style::RGBColor;

use crate::picture::{Colour, Picture, Point, WHITE, split_into_dashes};

/// Dash patterns and colours of the curves, by the index of their labels.
const CURVE_STYLES: [(&[f64], Colour); 4] = [
    (&[20.0, 18.0], RGBColor(10, 10, 10)),
    (&[5.0, 8.0], RGBColor(0, 60, 150)),
    (&[34.0, 9.0, 5.0, 9.0], RGBColor(90, 0, 100)),
    (&[12.0, 6.0], RGBColor(0, 85, 65)),
];

pub(super) fn draw_curve(picture: &mut Picture, points: &[Point], index: usize) {
    let (pattern, colour) = CURVE_STYLES[index % CURVE_STYLES.len()];
    // The white rim keeps dashes visible on dark shades; gaps show the cells below.
    for dash in split_into_dashes(points, pattern) {
        picture.draw_line(extend_ends(&dash, 1.5), 6.0, WHITE);
        picture.draw_curve(&dash, &[], 3.0, colour);
    }
}

/// Extends a polyline at both ends by `length` pixels.
fn extend_ends(line: &[Point], length: f64) -> Vec<Point> {
    let mut line = line.to_vec();
    let beyond = |end: Point, inner: Point| {
        let (dx, dy) = (end[0] - inner[0], end[1] - inner[1]);
        let scale = length / dx.hypot(dy).max(1e-9);
        [end[0] + scale * dx, end[1] + scale * dy]
    };
    if let [first, second, ..] = line[..] {
        line[0] = beyond(first, second);
    }
    if let [.., before, last] = line[..] {
        let end = line.len() - 1;
        line[end] = beyond(last, before);
    }
    line
}
