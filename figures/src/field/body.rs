//! Field of a body that fills only part of the domain, such as an annulus.

use super::figure::FieldFigure;
use super::layout::FieldLayout;
use crate::picture::{INK, Picture, Point};

/// Width of the outline of the body, pixels.
const OUTLINE_WIDTH: f64 = 1.4;

/// Part of the domain that the body fills.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FieldBody {
    /// Whether each cell is outside the body, in the order of the values. These cells are not drawn; their values, which
    /// must not exceed those of the body in magnitude, continue the field, so that contour lines reach the outline.
    pub is_outside: Vec<bool>,
    /// Closed or open lines around the body, in the units of the axes.
    pub outline: Vec<Vec<[f64; 2]>>,
}

impl FieldFigure {
    /// Returns the parts inside the body of a line in pixels.
    pub(super) fn clip_to_body(&self, layout: &FieldLayout, points: Vec<Point>) -> Vec<Vec<Point>> {
        let Some(body) = &self.body else { return vec![points] };
        let frame = layout.frame;
        let index = |share: f64, count: usize| {
            ((share * count as f64).floor().max(0.0) as usize).min(count - 1)
        };
        let is_outside = |[x, y]: &Point| {
            let column = index((x - frame.left) / frame.width(), self.columns);
            let row = index((frame.bottom - y) / frame.height(), self.rows);
            body.is_outside[row * self.columns + column]
        };
        let parts = points.split(is_outside).filter(|part| part.len() > 1);
        parts.map(<[Point]>::to_vec).collect()
    }

    /// Draws the outline of the body.
    pub(super) fn draw_body_outline(&self, picture: &mut Picture, layout: &FieldLayout) {
        let frame = layout.frame;
        let share =
            |axis: &super::FieldAxis, value: f64| (value - axis.start) / (axis.end - axis.start);
        let to_point = |[x, y]: &[f64; 2]| {
            [
                frame.left + share(&self.x, *x) * frame.width(),
                frame.bottom - share(&self.y, *y) * frame.height(),
            ]
        };
        for line in self.body.iter().flat_map(|body| &body.outline) {
            let points: Vec<Point> = line.iter().map(to_point).collect();
            picture.draw_line(points, OUTLINE_WIDTH, INK);
        }
    }
}
