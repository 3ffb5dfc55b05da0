//! Placement of labels and branch numbers clear of lines.

use super::tags::{TAG, tag_area};
use crate::page::{self};
use crate::picture::{Anchor, Point, Rectangle, Text, clip, polyline_length, text_width};

/// Font size of the labels of levels and bands, pixels.
pub(super) const LABEL: f64 = 22.0;

/// Subdivides a line so that neighbouring points are at most 6 pixels apart.
pub(super) fn densified(line: &[Point]) -> Vec<Point> {
    const STEP: f64 = 6.0;
    let mut dense: Vec<Point> = line.first().copied().into_iter().collect();
    for piece in line.windows(2) {
        let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
        let count = ((x1 - x0).hypot(y1 - y0) / STEP).ceil().max(1.0);
        let points = (1..=count as usize).map(|step| step as f64 / count);
        dense.extend(points.map(|share| [x0 + share * (x1 - x0), y0 + share * (y1 - y0)]));
    }
    dense
}

/// Places a text in a frame at one of the `baselines`, clear of the areas `taken` and with the least length of lines
/// behind it. Returns that length (pixels) and the text; `None` if there is not enough space.
pub(super) fn free_text(
    words: &str,
    baselines: &[f64],
    frame: Rectangle,
    lines: &[Vec<Point>],
    taken: &[Rectangle],
) -> Option<(f64, Text)> {
    const STEPS: usize = 60;
    let (words, size) = page::fit(words, LABEL, frame.width() - 24.0);
    if words.is_empty() {
        return None;
    }
    let room = frame.width() - 24.0 - text_width(&words, size, false);
    let mut best: Option<(f64, Text)> = None;
    for step in (0..=STEPS).rev() {
        for baseline in baselines {
            let x = frame.left + 12.0 + room.max(0.0) * step as f64 / STEPS as f64;
            let text = Text::new([x, *baseline], Anchor::Start, size, words.clone());
            let bounds = text.bounds();
            let area = Rectangle {
                left: bounds.left - 6.0,
                top: bounds.top - 2.0,
                right: bounds.right + 6.0,
                bottom: bounds.bottom + 2.0,
            };
            let fits = bounds.top > frame.top + 2.0 && bounds.bottom < frame.bottom - 2.0;
            if !fits || taken.iter().any(|other| other.overlaps(&area)) {
                continue;
            }
            let hits: f64 =
                lines.iter().flat_map(|line| clip(line, area)).map(|l| polyline_length(&l)).sum();
            if best.as_ref().is_none_or(|(least, _)| hits < *least) {
                best = Some((hits, text));
            }
        }
    }
    best
}

/// Finds the position of a branch number on a line: inside the frame, clear of the areas `taken` and, if possible, far
/// from the points of other lines. `None` if there is no such position.
pub(super) fn tag_place(
    parts: &[Vec<Point>],
    others: &[Point],
    frame: Rectangle,
    taken: &[Rectangle],
) -> Option<Point> {
    const FAR: f64 = 40.0;
    let inside = |[x, y]: Point| {
        let edge = TAG + 4.0;
        x > frame.left + edge
            && x < frame.right - edge
            && y > frame.top + edge
            && y < frame.bottom - edge
    };
    let points = parts.iter().flat_map(|part| densified(part)).filter(|&point| inside(point));
    let free: Vec<Point> =
        points.filter(|&point| !taken.iter().any(|area| area.overlaps(&tag_area(point)))).collect();
    // Preferred position: two thirds of the width, where branches are usually separated.
    let wanted = frame.left + 0.66 * frame.width();
    let cost = |&[x, y]: &Point| {
        let near = |[a, b]: &Point| (a - x).hypot(b - y);
        let nearest = others.iter().map(near).fold(FAR, f64::min);
        (FAR - nearest) / FAR + 0.25 * (x - wanted).abs() / frame.width().max(1.0)
    };
    free.into_iter().min_by(|a, b| cost(a).total_cmp(&cost(b)))
}
