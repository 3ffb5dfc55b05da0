//! Placement of labels and branch numbers clear of lines.

use super::number_discs::numbers_area;
use crate::page::{self};
use crate::picture::{Anchor, Point, Rectangle, Text, clip_polyline, polyline_length, text_width};

/// Font size of the labels of reference levels and frequency bands, pixels.
pub(super) const LABEL_SIZE: f64 = 22.0;

/// Subdivides a line so that neighbouring points are at most 6 pixels apart.
pub(super) fn densify(line: &[Point]) -> Vec<Point> {
    const MAX_STEP: f64 = 6.0;
    let mut dense: Vec<Point> = line.first().copied().into_iter().collect();
    for piece in line.windows(2) {
        let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / MAX_STEP).ceil().max(1.0);
        let points = (1..=count as usize).map(|step| step as f64 / count);
        dense.extend(points.map(|share| [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]));
    }
    dense
}

/// Places a text in a frame at one of the `baselines`, clear of the areas `occupied`, where it covers the least length
/// of lines. Returns this length (pixels) and the text; `None` if there is not enough space.
pub(super) fn place_text(
    text: &str,
    baselines: &[f64],
    frame: Rectangle,
    lines: &[Vec<Point>],
    occupied: &[Rectangle],
) -> Option<(f64, Text)> {
    const POSITION_COUNT: usize = 60;
    let (label_text, size) = page::fit_text(text, LABEL_SIZE, frame.width() - 24.0);
    if label_text.is_empty() {
        return None;
    }
    let free_width = frame.width() - 24.0 - text_width(&label_text, size, false);
    let mut best: Option<(f64, Text)> = None;
    for step in (0..=POSITION_COUNT).rev() {
        for baseline in baselines {
            let x = frame.left + 12.0 + free_width.max(0.0) * step as f64 / POSITION_COUNT as f64;
            let text = Text::new([x, *baseline], Anchor::Start, size, label_text.clone());
            let bounds = text.bounds();
            let area = Rectangle {
                left: bounds.left - 6.0,
                top: bounds.top - 2.0,
                right: bounds.right + 6.0,
                bottom: bounds.bottom + 2.0,
            };
            let fits = bounds.top > frame.top + 2.0 && bounds.bottom < frame.bottom - 2.0;
            if !fits || occupied.iter().any(|other| other.is_overlapping(&area)) {
                continue;
            }
            let covered_length: f64 = lines
                .iter()
                .flat_map(|line| clip_polyline(line, area))
                .map(|l| polyline_length(&l))
                .sum();
            if best.as_ref().is_none_or(|(min_length, _)| covered_length < *min_length) {
                best = Some((covered_length, text));
            }
        }
    }
    best
}

/// Finds the position of the numbers of branches on their line: inside the frame, clear of the areas `occupied` and, if
/// possible, far from the points of other lines and from the `discs` of other numbers. `None` if there is no such position.
pub(super) fn place_branch_numbers(
    numbers: &[usize],
    parts: &[Vec<Point>],
    [others, discs]: [&[Point]; 2],
    frame: Rectangle,
    occupied: &[Rectangle],
) -> Option<Point> {
    const CLEAR_DISTANCE: f64 = 40.0;
    const DISC_DISTANCE: f64 = 110.0;
    let inside = |place: Point| {
        let area = numbers_area(place, numbers);
        area.left > frame.left + 2.0
            && area.right < frame.right - 2.0
            && area.top > frame.top + 2.0
            && area.bottom < frame.bottom - 2.0
    };
    let points = parts.iter().flat_map(|part| densify(part)).filter(|&point| inside(point));
    let free: Vec<Point> = points
        .filter(|&point| {
            let own = numbers_area(point, numbers);
            !occupied.iter().any(|area| area.is_overlapping(&own))
        })
        .collect();
    // Preferred position: two thirds of the width, where branches are usually separated.
    let preferred_x = frame.left + 0.66 * frame.width();
    let cost = |&[x, y]: &Point| {
        let near = |[a, b]: &Point| (a - x).hypot(b - y);
        let nearest = others.iter().map(near).fold(CLEAR_DISTANCE, f64::min);
        let nearest_disc = discs.iter().map(near).fold(DISC_DISTANCE, f64::min);
        (CLEAR_DISTANCE - nearest) / CLEAR_DISTANCE
            + 0.5 * (DISC_DISTANCE - nearest_disc) / DISC_DISTANCE
            + 0.25 * (x - preferred_x).abs() / frame.width().max(1.0)
    };
    free.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
}
