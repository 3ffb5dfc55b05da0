//! One panel of a dispersion figure: lines of all branches, levels and bands.

use plotters::style::RGBColor;

use super::axes::{AxisScale, ScaleKind};
use super::figure::{FrequencyBand, ReferenceLevel};
use super::labels::{LABEL_SIZE, densify, place_branch_numbers, place_text};
use super::number_discs::{
    draw_disagreement, draw_numbers, draw_rings, number_disc_area, numbers_area,
};
use super::styles::{BAND_COLOUR, GROUP_SPEED_DASHES, LEVEL_LINE_WIDTH};
use crate::directions::spread_heights;
use crate::growth::{GRID_COLOUR, LINEAR_RANGE_COLOUR, LineStyle};
use crate::page::{self, FRAME_LINE_WIDTH};
use crate::picture::{
    Anchor, Colour, INK, PALE_INK, Picture, Point, Rectangle, Text, clip_polyline, text_width,
};
use crate::scale::Tick;

/// Content of one panel.
pub(super) struct DispersionPanel<'a> {
    pub(super) frame: Rectangle,
    pub(super) x_scale: AxisScale,
    pub(super) y_scale: AxisScale,
    /// Points of the solid line of each branch.
    pub(super) solid_lines: Vec<Vec<Point>>,
    /// Style of the solid line of each branch.
    pub(super) styles: Vec<LineStyle>,
    /// Points of the dashed line of each branch.
    pub(super) dashed_lines: Vec<Vec<Point>>,
    /// Measured points of each branch, drawn as rings.
    pub(super) measured_points: Vec<Vec<Point>>,
    /// Measured points that disagree with the prediction.
    pub(super) disagreeing_points: Vec<Point>,
    pub(super) levels: &'a [ReferenceLevel],
    pub(super) level_dashes: &'static [f64],
    pub(super) bands: &'a [FrequencyBand],
}

impl DispersionPanel<'_> {
    pub(super) fn to_point(&self, [x, y]: Point) -> Point {
        let Rectangle { left, bottom, .. } = self.frame;
        let (x, y) = (self.x_scale.fraction(x), self.y_scale.fraction(y));
        [left + x * self.frame.width(), bottom - y * self.frame.height()]
    }

    fn y_position(&self, value: f64) -> f64 {
        self.frame.bottom - self.y_scale.fraction(value) * self.frame.height()
    }

    pub(super) fn clip_lines(&self, lines: &[Vec<Point>]) -> Vec<Vec<Vec<Point>>> {
        let parts = |line: &Vec<Point>| {
            let points: Vec<Point> = line.iter().map(|&point| self.to_point(point)).collect();
            clip_polyline(&points, self.frame)
        };
        lines.iter().map(parts).collect()
    }

    /// Computes the area of a band, clamped to the frame; `None` if empty.
    pub(super) fn band_area(&self, band: &FrequencyBand) -> Option<Rectangle> {
        let frame = self.frame;
        let min_value = if matches!(self.y_scale.kind, ScaleKind::Logarithmic) {
            0.0
        } else {
            f64::NEG_INFINITY
        };
        let [bottom, top] = [band.low, band.high]
            .map(|value| self.y_position(value.max(min_value)).clamp(frame.top, frame.bottom));
        let known = !band.low.is_nan() && !band.high.is_nan() && top < bottom;
        known.then_some(Rectangle { top, bottom, ..frame })
    }

    pub(super) fn draw(&self, picture: &mut Picture, x_label: Option<&str>, y_label: &str) {
        let frame = self.frame;
        let bands: Vec<(Rectangle, &FrequencyBand)> =
            self.bands.iter().filter_map(|band| Some((self.band_area(band)?, band))).collect();
        let x_ticks: Vec<Tick> = self
            .x_scale
            .ticks(frame.width(), false)
            .into_iter()
            .map(|(share, label)| (frame.left + share * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = self
            .y_scale
            .ticks(frame.height(), true)
            .into_iter()
            .map(|(share, label)| (frame.bottom - share * frame.height(), label))
            .collect();
        let levels: Vec<(f64, &str)> = self
            .levels
            .iter()
            .map(|level| (self.y_position(level.value), level.label.as_str()))
            .filter(|(y, _)| *y >= frame.top && *y <= frame.bottom)
            .collect();
        let (solid, dashed) =
            (self.clip_lines(&self.solid_lines), self.clip_lines(&self.dashed_lines));
        self.draw_background(picture, &bands, &x_ticks, &y_ticks);
        self.draw_lines(picture, &solid, &dashed);
        // Above the lines, since a branch may run along the level of its cut-off or its limit.
        for (y, _) in &levels {
            let ends = [[frame.left, *y], [frame.right, *y]];
            picture.draw_dashed_line(&ends, self.level_dashes, LEVEL_LINE_WIDTH, INK);
        }
        picture.draw_frame(frame, FRAME_LINE_WIDTH, INK);
        draw_level_labels(picture, frame, levels);
        self.draw_labels(picture, &bands, &solid, &dashed);
        match x_label {
            Some(name) => page::draw_bottom_axis(picture, frame, &x_ticks, name),
            None => {
                let bare: Vec<Tick> = x_ticks.iter().map(|(x, _)| (*x, String::new())).collect();
                page::draw_bottom_axis(picture, frame, &bare, "");
            }
        }
        page::draw_left_axis(picture, frame, &y_ticks, y_label);
    }

    /// Draws the bands, the linear part of a symmetric logarithmic axis and the grid lines.
    fn draw_background(
        &self,
        picture: &mut Picture,
        bands: &[(Rectangle, &FrequencyBand)],
        x_ticks: &[Tick],
        y_ticks: &[Tick],
    ) {
        let frame = self.frame;
        if let ScaleKind::SymmetricLogarithmic(_) = self.y_scale.kind {
            let [bottom, top] = [-1.0, 1.0].map(|place: f64| {
                let share = (place - self.y_scale.low) / (self.y_scale.high - self.y_scale.low);
                (frame.bottom - share * frame.height()).clamp(frame.top, frame.bottom)
            });
            picture.fill_rectangle(Rectangle { top, bottom, ..frame }, LINEAR_RANGE_COLOUR);
        }
        for (area, _) in bands {
            picture.fill_rectangle(*area, BAND_COLOUR);
        }
        for (x, _) in x_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.draw_line([[*x, frame.top], [*x, frame.bottom]], 1.2, GRID_COLOUR);
        }
        for (y, _) in y_ticks.iter().filter(|(_, label)| !label.is_empty()) {
            picture.draw_line([[frame.left, *y], [frame.right, *y]], 1.2, GRID_COLOUR);
        }
        let zero = self.y_position(0.0);
        if zero > frame.top + 1.0 && zero < frame.bottom - 1.0 {
            picture.draw_line(
                [[frame.left, zero], [frame.right, zero]],
                2.0,
                RGBColor(110, 110, 110),
            );
        }
    }

    /// Draws the lines and the rings of all branches.
    fn draw_lines(
        &self,
        picture: &mut Picture,
        solid: &[Vec<Vec<Point>>],
        dashed: &[Vec<Vec<Point>>],
    ) {
        let frame = self.frame;
        for (lines, is_solid) in [(dashed, false), (solid, true)] {
            for (branch, parts) in lines.iter().enumerate() {
                for part in parts {
                    let style = self.styles[branch];
                    let pattern = if is_solid { style.dashes } else { GROUP_SPEED_DASHES };
                    picture.draw_curve(part, pattern, style.width, style.colour);
                }
            }
        }
        let branches = self.measured_points.iter().zip(&self.styles);
        let rings: Vec<(Point, Colour)> = branches
            .flat_map(|(points, style)| points.iter().map(|point| (*point, style.colour)))
            .map(|(point, colour)| (self.to_point(point), colour))
            .collect();
        draw_rings(picture, &rings, frame);
        for point in &self.disagreeing_points {
            let place = self.to_point(*point);
            if !clip_polyline(&[place, place], frame).is_empty() {
                draw_disagreement(picture, place);
            }
        }
    }

    /// Draws the labels of bands, then the branch numbers, clear of earlier labels. Without free space branch numbers
    /// cover lines, and labels of bands are omitted.
    fn draw_labels(
        &self,
        picture: &mut Picture,
        bands: &[(Rectangle, &FrequencyBand)],
        solid: &[Vec<Vec<Point>>],
        dashed: &[Vec<Vec<Point>>],
    ) {
        let frame = self.frame;
        let lines: Vec<Vec<Point>> =
            solid.iter().chain(dashed).flatten().map(|part| densify(part)).collect();
        let places = self.measured_points.iter().flatten().map(|&point| self.to_point(point));
        let mut occupied: Vec<Rectangle> = places.map(number_disc_area).collect();
        for (area, band) in bands {
            let middle = 0.5 * (area.top + area.bottom) + 0.26 * LABEL_SIZE;
            if area.height() < 1.2 * LABEL_SIZE {
                continue;
            }
            // The label of a band is omitted if it would cover lines, since the legend has it as well.
            let text = place_text(&band.label, &[middle], frame, &lines, &occupied);
            if let Some((_, text)) = text.filter(|(covered_length, _)| *covered_length == 0.0) {
                occupied.push(text.bounds());
                picture.draw_text(text);
            }
        }
        // The solid lines, then the dashed ones. A line that coincides with an earlier one has its number there; a dashed
        // line that coincides with the solid line of its own branch needs none.
        let all: Vec<(usize, &Vec<Vec<Point>>)> =
            solid.iter().enumerate().chain(dashed.iter().enumerate()).collect();
        let mut labelled: Vec<(&Vec<Vec<Point>>, Vec<usize>)> = Vec::new();
        for (branch, parts) in all.iter().filter(|(_, parts)| !parts.is_empty()) {
            match labelled.iter_mut().find(|(line, _)| is_coincident(line, parts)) {
                Some((_, numbers)) if !numbers.contains(&(branch + 1)) => numbers.push(branch + 1),
                Some(_) => {}
                None => labelled.push((parts, vec![branch + 1])),
            }
        }
        let mut discs: Vec<Point> = Vec::new();
        for (parts, numbers) in &labelled {
            // Points of all other lines, from which the numbers keep their distance.
            let others: Vec<Point> = labelled
                .iter()
                .filter(|(line, _)| !std::ptr::eq(*line, *parts))
                .flat_map(|(line, _)| line.iter())
                .flat_map(|part| densify(part))
                .collect();
            let place = place_branch_numbers(numbers, parts, [&others, &discs], frame, &occupied);
            if let Some(at) = place {
                occupied.push(numbers_area(at, numbers));
                discs.push(at);
                draw_numbers(picture, at, numbers, self.styles[numbers[0] - 1].colour);
            }
        }
    }
}

/// Returns whether two lines run along each other within a pixel.
fn is_coincident(one: &[Vec<Point>], other: &[Vec<Point>]) -> bool {
    const TOLERANCE: f64 = 1.0;
    let is_along = |a: &[Vec<Point>], b: &[Vec<Point>]| {
        a.iter().flatten().all(|point| b.iter().any(|line| distance_to(line, *point) <= TOLERANCE))
    };
    is_along(one, other) && is_along(other, one)
}

/// Returns the distance of a point from a polyline.
fn distance_to(line: &[Point], [x, y]: Point) -> f64 {
    let distances = line.windows(2).map(|piece| {
        let ([x0, y0], [x1, y1]) = (piece[0], piece[1]);
        let (dx, dy) = (x1 - x0, y1 - y0);
        let square = dx * dx + dy * dy;
        let share = if square > 0.0 { ((x - x0) * dx + (y - y0) * dy) / square } else { 0.0 };
        let share = share.clamp(0.0, 1.0);
        (x - x0 - share * dx).hypot(y - y0 - share * dy)
    });
    distances.fold(f64::INFINITY, f64::min)
}

/// Distance of the labels of levels from the frame, which their leader lines bridge, pixels.
const LEVEL_LABEL_GAP: f64 = 22.0;

/// Returns the width to the right of the frame that the labels of levels need, pixels.
pub(super) fn level_labels_width(levels: &[ReferenceLevel]) -> f64 {
    const MAX_WIDTH: f64 = 190.0;
    let drawn = levels.iter().filter(|level| level.value.is_finite());
    let width = drawn.map(|level| text_width(&level.label, LABEL_SIZE, false)).fold(0.0, f64::max);
    if width > 0.0 { width.min(MAX_WIDTH) + LEVEL_LABEL_GAP + 4.0 } else { 0.0 }
}

/// Writes the labels of levels to the right of the frame, clear of the curves and of each other.
fn draw_level_labels(picture: &mut Picture, frame: Rectangle, mut levels: Vec<(f64, &str)>) {
    levels.sort_by(|a, b| a.0.total_cmp(&b.0));
    levels.dedup();
    let gap = 1.15 * LABEL_SIZE;
    levels.truncate((frame.height() / gap) as usize);
    let preferred: Vec<f64> = levels.iter().map(|(y, _)| *y).collect();
    let bounds = [frame.top + 0.5 * gap, frame.bottom - 0.5 * gap];
    for ((y, label), height) in levels.iter().zip(spread_heights(&preferred, gap, bounds)) {
        let x = frame.right + LEVEL_LABEL_GAP;
        let leader = [[frame.right, *y], [frame.right + 7.0, *y], [x - 4.0, height]];
        picture.draw_line(leader, 1.4, PALE_INK);
        let (label, size) = page::fit_text(label, LABEL_SIZE, 190.0);
        let text = Text::new([x, height + 0.36 * LABEL_SIZE], Anchor::Start, size, label);
        picture.draw_text(Text { colour: PALE_INK, ..text });
    }
}
