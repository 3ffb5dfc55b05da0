//! Placement of the numbers on contour lines.

use std::collections::BTreeMap;

use super::colour_map::Scale;
use super::figure::FieldFigure;
use super::layout::Layout;
use super::marks::{around, padded};
use crate::picture::{Anchor, Point, Rectangle, Text, polyline_length, text_width};
use crate::scale::plain;

/// Font size of the numbers on contour lines, and line length per number, in pixels.
const LEVEL_NUMBER: f64 = 20.0;
const LEVEL_REPEAT: f64 = 900.0;

impl FieldFigure {
    /// Places the numbers on requested contour lines. Each number is placed where its line is nearly horizontal, clear
    /// of marks and other numbers and, if possible, of other lines.
    pub(super) fn place_numbers(
        &self,
        scale: &Scale,
        layout: &Layout,
        lines: &[(f64, Vec<Point>)],
    ) -> Vec<Text> {
        if self.curves.is_none() {
            return Vec::new();
        }
        let frame = layout.frame;
        let mut taken: Vec<Rectangle> =
            self.places(frame).iter().map(|(at, _)| around(*at)).collect();
        taken.extend(self.place_names(layout).iter().flatten().map(padded));
        let passed = passed_squares(lines);
        // Longest lines first, since they most need numbers.
        let mut order: Vec<(f64, usize)> = lines
            .iter()
            .enumerate()
            .map(|(index, (_, line))| (polyline_length(line), index))
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut numbers = Vec::new();
        for (whole, index) in order {
            let (share, line) = &lines[index];
            let words = plain(share * scale.end);
            let width = text_width(&words, LEVEL_NUMBER, false);
            // A number would cover most of a short closed line.
            let least = if line.first() == line.last() { 4.5 } else { 1.6 };
            if whole < least * width {
                continue;
            }
            let mut own: Vec<Point> = Vec::new();
            let crossings = |area: Rectangle| {
                let (from, to) = (square([area.left, area.top]), square([area.right, area.bottom]));
                let squares = (from.0..=to.0).flat_map(|x| (from.1..=to.1).map(move |y| (x, y)));
                squares
                    .filter_map(|place| passed.get(&place))
                    .filter(|own| own.iter().any(|other| *other != index))
                    .count()
            };
            let count = 1 + (whole / LEVEL_REPEAT) as usize;
            // The line is divided into one interval per number.
            let step = (line.len() / (60 * count)).max(1);
            for part in 0..count {
                let [first, last] = [part, part + 1].map(|edge| edge * (line.len() - 1) / count);
                let mut best: Option<(f64, Text)> = None;
                for middle in (first..=last).step_by(step) {
                    let [x, y] = line[middle];
                    let at = [x, y + 0.36 * LEVEL_NUMBER];
                    let text = Text::new(at, Anchor::Middle, LEVEL_NUMBER, &words);
                    let is_near = |&[a, b]: &Point| (a - x).hypot(b - y) < 0.25 * LEVEL_REPEAT;
                    if !is_free(&text, frame, &taken) || own.iter().any(is_near) {
                        continue;
                    }
                    let area = padded(&text);
                    let reach = reach(line, middle, width);
                    let place = (middle - first) as f64 / (last - first).max(1) as f64;
                    let cost = crossings(area) as f64 + 0.1 * reach + 2.0 * (place - 0.5).abs();
                    if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                        best = Some((cost, text));
                    }
                }
                if let Some((_, text)) = best {
                    own.push(text.at);
                    // Adjacent numbers could be read as one number.
                    let pad = padded(&text);
                    taken.push(Rectangle { left: pad.left - 8.0, right: pad.right + 8.0, ..pad });
                    numbers.push(text);
                }
            }
        }
        numbers
    }
}

/// Edge of the squares of the hash grid used to find line crossings, pixels.
const SQUARE: f64 = 6.0;

fn square([x, y]: Point) -> (usize, usize) {
    ((x / SQUARE) as usize, (y / SQUARE) as usize)
}

/// Maps each square of the hash grid to the indices of the lines that pass it (two of them if there are several).
fn passed_squares(lines: &[(f64, Vec<Point>)]) -> BTreeMap<(usize, usize), [usize; 2]> {
    let mut passed: BTreeMap<(usize, usize), [usize; 2]> = BTreeMap::new();
    for (index, (_, line)) in lines.iter().enumerate() {
        for &point in line {
            let own = passed.entry(square(point)).or_insert([index; 2]);
            own[1] = if own[0] == index { own[1] } else { index };
        }
    }
    passed
}

/// Returns whether a number is inside the frame and clear of the areas `taken`.
fn is_free(text: &Text, frame: Rectangle, taken: &[Rectangle]) -> bool {
    let pad = padded(text);
    pad.left > frame.left + 4.0
        && pad.right < frame.right - 4.0
        && pad.top > frame.top + 4.0
        && pad.bottom < frame.bottom - 4.0
        && !taken.iter().any(|other| other.overlaps(&pad))
}

/// Computes the largest vertical deviation of a line from the point `middle` within `width`, limited to the height of a
/// number, in pixels.
fn reach(line: &[Point], middle: usize, width: f64) -> f64 {
    let [x, y] = line[middle];
    (middle.saturating_sub(200)..(middle + 200).min(line.len()))
        .map(|other| line[other])
        .filter(|point| (point[0] - x).abs() < 0.5 * width && (point[1] - y).abs() < 60.0)
        .map(|point| (point[1] - y).abs())
        .fold(0.0, f64::max)
        .min(LEVEL_NUMBER)
}
