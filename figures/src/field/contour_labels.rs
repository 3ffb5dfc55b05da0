//! Placement of the numbers on contour lines.

use std::collections::BTreeMap;

use super::arrows::arrow_areas;
use super::figure::FieldFigure;
use super::layout::FieldLayout;
use super::marks::{mark_area, padded_bounds};
use crate::picture::{Anchor, Point, Rectangle, Text, polyline_length, text_width};
use crate::scale::format_number;

/// Font size of the numbers on contour lines, pixels.
const NUMBER_SIZE: f64 = 20.0;
/// Length of a contour line per number, pixels.
const NUMBER_SPACING: f64 = 900.0;

impl FieldFigure {
    /// Places the numbers on contour lines, given with their levels. Each number is placed where its line is nearly
    /// horizontal, clear of marks, arrows and other numbers and, if possible, of other lines.
    pub(super) fn place_contour_numbers(
        &self,
        layout: &FieldLayout,
        lines: &[(f64, Vec<Point>)],
        arrows: &[(Point, Point)],
    ) -> Vec<Text> {
        let frame = layout.frame;
        let mut occupied: Vec<Rectangle> =
            self.mark_positions(frame).iter().map(|(at, _)| mark_area(*at)).collect();
        occupied.extend(self.place_mark_names(layout).iter().flatten().map(padded_bounds));
        occupied.extend(arrows.iter().copied().flat_map(arrow_areas));
        let lines_by_square = index_lines_by_square(lines);
        // Longest lines first, since they most need numbers.
        let mut order: Vec<(f64, usize)> = lines
            .iter()
            .enumerate()
            .map(|(index, (_, line))| (polyline_length(line), index))
            .collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut numbers = Vec::new();
        for (whole, index) in order {
            let (level, line) = &lines[index];
            let label_text = format_number(*level);
            let width = text_width(&label_text, NUMBER_SIZE, false);
            // A number would cover most of a short closed line.
            let min_length_ratio = if line.first() == line.last() { 4.5 } else { 1.6 };
            if whole < min_length_ratio * width {
                continue;
            }
            let mut placed: Vec<Point> = Vec::new();
            let crossings = |area: Rectangle| {
                let (from, to) =
                    (hash_square([area.left, area.top]), hash_square([area.right, area.bottom]));
                let squares = (from.0..=to.0).flat_map(|x| (from.1..=to.1).map(move |y| (x, y)));
                squares
                    .filter_map(|place| lines_by_square.get(&place))
                    .filter(|indices| indices.iter().any(|other| *other != index))
                    .count()
            };
            let count = 1 + (whole / NUMBER_SPACING) as usize;
            // The line is divided into one interval per number.
            let step = (line.len() / (60 * count)).max(1);
            for part in 0..count {
                let [first, last] = [part, part + 1].map(|edge| edge * (line.len() - 1) / count);
                let mut best: Option<(f64, Text)> = None;
                for middle in (first..=last).step_by(step) {
                    let [x, y] = line[middle];
                    let at = [x, y + 0.36 * NUMBER_SIZE];
                    let text = Text::new(at, Anchor::Middle, NUMBER_SIZE, &label_text);
                    let is_near = |&[a, b]: &Point| (a - x).hypot(b - y) < 0.25 * NUMBER_SPACING;
                    if !is_free(&text, frame, &occupied) || placed.iter().any(is_near) {
                        continue;
                    }
                    let area = padded_bounds(&text);
                    let reach = vertical_deviation(line, middle, width);
                    let place = (middle - first) as f64 / (last - first).max(1) as f64;
                    let cost = crossings(area) as f64 + 0.1 * reach + 2.0 * (place - 0.5).abs();
                    if best.as_ref().is_none_or(|(min_cost, _)| cost < *min_cost) {
                        best = Some((cost, text));
                    }
                }
                if let Some((_, text)) = best {
                    placed.push(text.anchor_point);
                    // Adjacent numbers could be read as one number.
                    let pad = padded_bounds(&text);
                    occupied.push(Rectangle {
                        left: pad.left - 8.0,
                        right: pad.right + 8.0,
                        ..pad
                    });
                    numbers.push(text);
                }
            }
        }
        numbers
    }
}

/// Edge of the squares of the hash grid used to find line crossings, pixels.
const HASH_SQUARE_SIZE: f64 = 6.0;

fn hash_square([x, y]: Point) -> (usize, usize) {
    ((x / HASH_SQUARE_SIZE) as usize, (y / HASH_SQUARE_SIZE) as usize)
}

/// Maps each square of the hash grid to the indices of the lines that pass it (two of them if there are several).
fn index_lines_by_square(lines: &[(f64, Vec<Point>)]) -> BTreeMap<(usize, usize), [usize; 2]> {
    let mut passed: BTreeMap<(usize, usize), [usize; 2]> = BTreeMap::new();
    for (index, (_, line)) in lines.iter().enumerate() {
        for &point in line {
            let indices = passed.entry(hash_square(point)).or_insert([index; 2]);
            indices[1] = if indices[0] == index { indices[1] } else { index };
        }
    }
    passed
}

/// Returns whether a number is inside the frame and clear of the areas `occupied`.
fn is_free(text: &Text, frame: Rectangle, occupied: &[Rectangle]) -> bool {
    let pad = padded_bounds(text);
    pad.left > frame.left + 4.0
        && pad.right < frame.right - 4.0
        && pad.top > frame.top + 4.0
        && pad.bottom < frame.bottom - 4.0
        && !occupied.iter().any(|other| other.is_overlapping(&pad))
}

/// Computes the largest vertical deviation of a line from the point `middle` within `width`, limited to the height of a
/// number, in pixels.
fn vertical_deviation(line: &[Point], middle: usize, width: f64) -> f64 {
    let [x, y] = line[middle];
    (middle.saturating_sub(200)..(middle + 200).min(line.len()))
        .map(|other| line[other])
        .filter(|point| (point[0] - x).abs() < 0.5 * width && (point[1] - y).abs() < 60.0)
        .map(|point| (point[1] - y).abs())
        .fold(0.0, f64::max)
        .min(NUMBER_SIZE)
}
