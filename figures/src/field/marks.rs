//! Marks of sources and receivers, and placement of their names.

use super::arrows::arrow_areas;
use super::figure::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use super::layout::FieldLayout;
use crate::page::{self};
use crate::picture::{
    Anchor, INK, Picture, Point, Rectangle, Text, WHITE, circle_points, text_width,
};

const MARK_NAME_SIZE: f64 = 22.0;
/// Half the edge length of the square about a mark that is kept free of names, pixels.
const MARK_RADIUS: f64 = 15.0;
/// Width of the line along a loaded part of the boundary, pixels.
pub(crate) const LOADED_LINE_WIDTH: f64 = 9.0;
/// Legend text of loaded parts of the boundary.
pub(crate) const LOADED_LINE_TEXT: &str = "loaded part of the boundary";

impl FieldFigure {
    /// Returns the loaded parts of the boundary, in pixels; those on the frame lie outside it and cover no values.
    pub(super) fn loaded_curves(&self, frame: Rectangle) -> Vec<Vec<Point>> {
        let offset = 0.5 * LOADED_LINE_WIDTH;
        let curve = |line: &Vec<[f64; 2]>| -> Vec<Point> {
            let place = |[x, y]: &[f64; 2]| [self.pixel(frame, 0, *x), self.pixel(frame, 1, *y)];
            let mut curve: Vec<Point> = line.iter().map(place).collect();
            for (axis, edges) in
                [[frame.left, frame.right], [frame.top, frame.bottom]].into_iter().enumerate()
            {
                for (edge, outwards) in edges.into_iter().zip([-offset, offset]) {
                    if curve.iter().all(|point| (point[axis] - edge).abs() < 0.5) {
                        curve.iter_mut().for_each(|point| point[axis] += outwards);
                    }
                }
            }
            curve
        };
        self.loaded_lines.iter().map(curve).collect()
    }

    /// Returns the marks inside the domain, with their positions in pixels.
    pub(super) fn mark_positions(&self, frame: Rectangle) -> Vec<(Point, &FieldMark)> {
        let share = |axis: &FieldAxis, value: f64| (value - axis.start) / (axis.end - axis.start);
        let inside = |share: f64| (-1e-9..=1.0 + 1e-9).contains(&share);
        let shares = self.marks.iter().map(|mark| {
            ([share(&self.x, mark.position[0]), share(&self.y, mark.position[1])], mark)
        });
        shares
            .filter(|([x, y], _)| inside(*x) && inside(*y))
            .map(|([x, y], mark)| {
                let x = frame.left + x * frame.width();
                ([x, frame.bottom - y * frame.height()], mark)
            })
            .collect()
    }

    /// Returns whether a mark lies at the upper boundary, where its name stands above the frame.
    fn is_at_upper_boundary(&self, mark: &FieldMark) -> bool {
        /// Distance from the boundary, as a fraction of the height: a mark covers as much.
        const MAX_SHARE: f64 = 0.02;
        let depth = (self.y.end - mark.position[1]) / (self.y.end - self.y.start);
        (-1e-9..=MAX_SHARE).contains(&depth)
    }

    /// Returns whether names of marks stand above the frame.
    pub(super) fn has_names_above(&self) -> bool {
        self.marks.iter().any(|mark| !mark.name.is_empty() && self.is_at_upper_boundary(mark))
    }

    /// Returns a function for the strength of the field in an area: its largest magnitude there as a fraction of that of
    /// the whole field; 0 outside the frame. Names of figures with a fixed scale, whose values vary between frames, do
    /// not depend on it.
    fn field_strength(&self, frame: Rectangle) -> impl Fn(Rectangle) -> f64 {
        let finite = self.values.iter().map(|value| value.abs()).filter(|own| own.is_finite());
        let largest = finite.fold(0.0, f64::max);
        let is_known = self.fixed_limit.is_none() && largest > 0.0;
        move |area| {
            const SAMPLES: [f64; 7] = [0.0, 0.17, 0.33, 0.5, 0.67, 0.83, 1.0];
            let index = |share: f64, count: usize| (share * count as f64) as usize;
            let strength = |x: f64, y: f64| {
                let across = (area.left + x * area.width() - frame.left) / frame.width();
                let up = (frame.bottom - area.top - y * area.height()) / frame.height();
                if !((0.0..1.0).contains(&across) && (0.0..1.0).contains(&up)) {
                    return 0.0;
                }
                let cell = index(up, self.rows) * self.columns + index(across, self.columns);
                let share = self.values[cell].abs() / largest;
                match share.is_finite() {
                    true if self.is_root_scaled => share.sqrt(),
                    true => share,
                    false => 1.0,
                }
            };
            let all = SAMPLES.into_iter().flat_map(|x| SAMPLES.map(|y| strength(x, y)));
            if is_known { all.fold(0.0, f64::max) } else { 0.0 }
        }
    }

    /// Places the name of each mark in the domain, above the frame for marks on the upper boundary, else near the mark
    /// where the field is weak; `None` if there is not enough space.
    pub(super) fn place_mark_names(&self, layout: &FieldLayout) -> Vec<Option<Text>> {
        let places = self.mark_positions(layout.frame);
        let mut occupied: Vec<Rectangle> = places.iter().map(|(at, _)| mark_area(*at)).collect();
        // Names must not lie on the lines of the frame.
        let (area, frame) = (layout.name_area, layout.frame);
        occupied.extend([
            Rectangle { bottom: frame.top + 2.0, top: frame.top - 2.0, ..frame },
            Rectangle { left: frame.right - 2.0, right: frame.right + 2.0, ..frame },
        ]);
        occupied.extend(self.y_name_above(layout).as_ref().map(padded_bounds));
        let arrows = self.place_arrows(frame, self.arrow_scale(frame));
        occupied.extend(arrows.into_iter().flat_map(arrow_areas));
        for curve in self.loaded_curves(frame) {
            let segments = curve.windows(2).map(|ends| Rectangle {
                left: ends[0][0].min(ends[1][0]) - LOADED_LINE_WIDTH,
                right: ends[0][0].max(ends[1][0]) + LOADED_LINE_WIDTH,
                top: ends[0][1].min(ends[1][1]) - LOADED_LINE_WIDTH,
                bottom: ends[0][1].max(ends[1][1]) + LOADED_LINE_WIDTH,
            });
            occupied.extend(segments);
        }
        let strength = self.field_strength(frame);
        let mut names = Vec::new();
        for &([x, y], mark) in &places {
            // Candidate directions in degrees: right and left first, then the other directions; above the frame first.
            let is_above = self.is_at_upper_boundary(mark);
            let start = if is_above { frame.top } else { y };
            let directions = match is_above {
                true => [90.0_f64, 45.0, 135.0, 0.0, 180.0, -45.0, -135.0, -90.0],
                false => [0.0, 180.0, 45.0, 135.0, -45.0, -135.0, 90.0, -90.0],
            };
            let widest = (0.4 * area.width()).max(150.0);
            let (name, size) = page::fit_text(&mark.name, MARK_NAME_SIZE, widest);
            let half = 0.5 * text_width(&name, size, false);
            let near = (0..14).flat_map(|step| {
                let distance = MARK_RADIUS + 7.0 + 14.0 * f64::from(step);
                directions.map(|turn| {
                    let (sin, cos) = turn.to_radians().sin_cos();
                    let middle = x + cos * (distance + half);
                    let baseline = start - sin * (distance + 0.4 * size) + 0.3 * size;
                    (step, Text::new([middle, baseline], Anchor::Middle, size, &name))
                })
            });
            let is_free = |text: &Text| {
                let pad = padded_bounds(text);
                pad.left >= area.left + 2.0
                    && pad.right <= area.right - 2.0
                    && pad.top >= area.top + 2.0
                    && pad.bottom <= area.bottom - 2.0
                    && !occupied.iter().any(|other| other.is_overlapping(&pad))
            };
            // A mark without a name has an empty text.
            let place = if name.is_empty() {
                Some(Text::new([x, y], Anchor::Middle, size, ""))
            } else {
                // A name with a leader line is worse than one on a field of an eighth of its maximum.
                let cost = |(step, text): &(i32, Text)| {
                    let leader = if *step > 0 { 0.125 } else { 0.0 };
                    strength(padded_bounds(text)) + leader + 0.06 * f64::from(*step)
                };
                let free = near.into_iter().filter(|(_, text)| is_free(text));
                let best = free.map(|place| (cost(&place), place.1));
                best.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, text)| text)
            };
            if let Some(text) = place.as_ref().filter(|text| !text.content.is_empty()) {
                occupied.push(padded_bounds(text));
            }
            names.push(place);
        }
        names
    }

    pub(super) fn draw_marks(&self, picture: &mut Picture, layout: &FieldLayout) {
        for curve in self.loaded_curves(layout.frame) {
            draw_loaded_line(picture, &curve);
        }
        let places = self.mark_positions(layout.frame);
        let names = self.place_mark_names(layout);
        let label_text =
            || names.iter().map(|name| name.as_ref().filter(|t| !t.content.is_empty()));
        for (&([x, y], _), text) in places.iter().zip(label_text()) {
            let Some(pad) = text.map(padded_bounds) else { continue };
            let end = [x.clamp(pad.left, pad.right), y.clamp(pad.top, pad.bottom)];
            if (end[0] - x).hypot(end[1] - y) > MARK_RADIUS + 12.0 {
                picture.draw_line([[x, y], end], 4.4, WHITE);
                picture.draw_line([[x, y], end], 1.6, INK);
            }
        }
        for &(at, mark) in &places {
            picture.mark_point(at, 0.7 * MARK_RADIUS);
            draw_mark(picture, at, mark.kind);
        }
        for text in label_text().flatten() {
            picture.fill_rectangle(padded_bounds(text), WHITE);
            picture.draw_text(text.clone());
        }
    }
}

/// Draws the line along a loaded part of the boundary.
pub(crate) fn draw_loaded_line(picture: &mut Picture, points: &[Point]) {
    picture.draw_line(points.to_vec(), LOADED_LINE_WIDTH, INK);
}

pub(crate) fn draw_mark(picture: &mut Picture, [x, y]: Point, kind: FieldMarkKind) {
    for (more, colour) in [(3.0, WHITE), (0.0, INK)] {
        match kind {
            FieldMarkKind::Source => {
                let (outer, inner) = (13.0 + 1.4 * more, 5.4 + more);
                let tip = |corner: usize| {
                    let radius = if corner.is_multiple_of(2) { outer } else { inner };
                    let angle = std::f64::consts::PI * (0.2 * corner as f64 - 0.5);
                    [x + radius * angle.cos(), y + radius * angle.sin()]
                };
                picture.fill_polygon((0..10).map(tip).collect(), colour);
            }
            FieldMarkKind::Receiver => {
                let radius = 12.0 + 1.6 * more;
                let corners = circle_points([x, y - 1.5], radius, 12);
                // Corners at 30°, 150° and 270°, anticlockwise from the x axis: the tip points downwards.
                picture
                    .fill_polygon([3, 7, 11].map(|corner: usize| corners[corner]).to_vec(), colour);
            }
        }
    }
}

/// Returns the square about a mark that is kept free of names.
pub(super) fn mark_area([x, y]: Point) -> Rectangle {
    Rectangle {
        left: x - MARK_RADIUS,
        top: y - MARK_RADIUS,
        right: x + MARK_RADIUS,
        bottom: y + MARK_RADIUS,
    }
}

/// Returns the background area of a name.
pub(super) fn padded_bounds(text: &Text) -> Rectangle {
    let bounds = text.bounds();
    Rectangle {
        left: bounds.left - 4.0,
        right: bounds.right + 4.0,
        top: bounds.top - 1.0,
        bottom: bounds.bottom + 1.0,
    }
}
