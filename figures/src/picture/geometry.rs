//! Geometry in pixels: points, rectangles, circles, dashes and clipping.

/// A point: pixels to the right of and below the upper left corner of the picture.
pub(crate) type Point = [f64; 2];

/// An axis-aligned rectangle in pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rectangle {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Rectangle {
    pub fn width(&self) -> f64 {
        self.right - self.left
    }

    pub fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub fn is_overlapping(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    pub(super) fn corners(&self) -> [Point; 4] {
        let Self { left, top, right, bottom } = *self;
        [[left, top], [right, top], [right, bottom], [left, bottom]]
    }
}

pub(crate) fn circle_points([x, y]: Point, radius: f64, corners: usize) -> Vec<Point> {
    let turn = std::f64::consts::TAU / corners as f64;
    (0..corners)
        .map(|corner| {
            let (sin, cos) = (corner as f64 * turn).sin_cos();
            [x + radius * cos, y + radius * sin]
        })
        .collect()
}

/// Computes the dashes of a line; `pattern` has the lengths of dashes and gaps alternately, pixels.
pub(crate) fn split_into_dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    let mut dashes = Vec::new();
    let (mut turn, mut remaining) = (0, pattern[0]);
    let mut dash: Vec<Point> = points.first().copied().into_iter().collect();
    for piece in points.windows(2) {
        let (from, to) = (piece[0], piece[1]);
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        let mut done = 0.0;
        while length - done > remaining {
            done += remaining;
            let share = done / length;
            let at = [from[0] + share * (to[0] - from[0]), from[1] + share * (to[1] - from[1])];
            if turn % 2 == 0 {
                dash.push(at);
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![at];
            }
            turn += 1;
            remaining = pattern[turn % pattern.len()];
        }
        remaining -= length - done;
        if turn % 2 == 0 {
            dash.push(to);
        }
    }
    if dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

/// Computes the length of a polyline.
pub(crate) fn polyline_length(line: &[Point]) -> f64 {
    line.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum()
}

/// Clips a polyline to an area; returns the parts inside. Non-finite coordinates interrupt the line.
pub(crate) fn clip_polyline(points: &[Point], area: Rectangle) -> Vec<Vec<Point>> {
    let mut parts: Vec<Vec<Point>> = Vec::new();
    let mut open = false;
    for piece in points.windows(2) {
        let Some((from, to)) = clip_segment(piece[0], piece[1], area) else {
            open = false;
            continue;
        };
        match parts.last_mut() {
            Some(part) if open && from == piece[0] => part.push(to),
            _ => parts.push(vec![from, to]),
        }
        open = to == piece[1];
    }
    parts
}

/// Clips a line segment to an area (Liang and Barsky 1984).
fn clip_segment(from: Point, to: Point, area: Rectangle) -> Option<(Point, Point)> {
    if !from.iter().chain(&to).all(|coordinate| coordinate.is_finite()) {
        return None;
    }
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (speed, distance) in [
        (-dx, from[0] - area.left),
        (dx, area.right - from[0]),
        (-dy, from[1] - area.top),
        (dy, area.bottom - from[1]),
    ] {
        if speed == 0.0 {
            if distance < 0.0 {
                return None;
            }
        } else if speed < 0.0 {
            enter = enter.max(distance / speed);
        } else {
            leave = leave.min(distance / speed);
        }
    }
    let at = |share: f64| [from[0] + share * dx, from[1] + share * dy];
    let start = if enter > 0.0 { at(enter) } else { from };
    let end = if leave < 1.0 { at(leave) } else { to };
    (enter <= leave).then_some((start, end))
}
