//! Shapes of a picture.

use super::geometry::{Point, Rectangle, circle_points, clip_polyline, split_into_dashes};
use super::scaling::Heading;
use super::text::{Colour, Text};
use std::ops::Range;

pub(super) enum PictureShape {
    Rectangle(Rectangle, Colour),
    Patches(Vec<Rectangle>, Colour),
    Polygon(Vec<Point>, Colour),
    Line { points: Vec<Point>, width: f64, colour: Colour, is_curve: bool },
    Text(Text),
}

/// Picture: a white sheet with shapes; later shapes cover earlier shapes.
pub(crate) struct Picture {
    pub width: u32,
    pub height: u32,
    pub(super) shapes: Vec<PictureShape>,
    pub(super) headings: Vec<Heading>,
    /// Areas of marked points, which no text may cover.
    marked_areas: Vec<Rectangle>,
}

impl Picture {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, shapes: Vec::new(), headings: Vec::new(), marked_areas: Vec::new() }
    }

    pub fn fill_rectangle(&mut self, area: Rectangle, colour: Colour) {
        self.shapes.push(PictureShape::Rectangle(area, colour));
    }

    /// Fills many areas with one shape. Edges are rounded to whole fine pixels and have no outline: an SVG has a fifth
    /// of the bytes of single areas, and no hairlines between adjacent areas.
    pub fn fill_patches(&mut self, areas: Vec<Rectangle>, colour: Colour) {
        self.shapes.push(PictureShape::Patches(areas, colour));
    }

    pub fn fill_polygon(&mut self, points: Vec<Point>, colour: Colour) {
        self.shapes.push(PictureShape::Polygon(points, colour));
    }

    pub fn fill_disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.fill_polygon(circle_points(centre, radius, 24), colour);
    }

    /// Declares the disc of a marked point, such as a measurement, which no text may cover.
    pub fn mark_point(&mut self, [x, y]: Point, radius: f64) {
        let [left, top, right, bottom] = [x - radius, y - radius, x + radius, y + radius];
        self.marked_areas.push(Rectangle { left, top, right, bottom });
    }

    pub fn draw_line(&mut self, points: impl Into<Vec<Point>>, width: f64, colour: Colour) {
        let points = points.into();
        self.shapes.push(PictureShape::Line { points, width, colour, is_curve: false });
    }

    /// Draws a curve of data, dashed as by [`draw_dashed_line`](Self::draw_dashed_line). No text may cover a curve.
    pub fn draw_curve(&mut self, points: &[Point], pattern: &[f64], width: f64, colour: Colour) {
        let dashes = match pattern {
            [] => vec![points.to_vec()],
            pattern => split_into_dashes(points, pattern),
        };
        let curves = dashes.into_iter().map(|points| PictureShape::Line {
            points,
            width,
            colour,
            is_curve: true,
        });
        self.shapes.extend(curves);
    }

    pub fn draw_frame(&mut self, area: Rectangle, width: f64, colour: Colour) {
        let corners = area.corners();
        // The first edge is repeated, so that all four corners are joined.
        self.draw_line([&corners[..], &corners[..2]].concat(), width, colour);
    }

    /// Draws a dashed line: `pattern` has the lengths of dashes and gaps alternately, in pixels; an empty pattern gives
    /// a solid line.
    pub fn draw_dashed_line(
        &mut self,
        points: &[Point],
        pattern: &[f64],
        width: f64,
        colour: Colour,
    ) {
        if pattern.is_empty() {
            return self.draw_line(points, width, colour);
        }
        for dash in split_into_dashes(points, pattern) {
            self.draw_line(dash, width, colour);
        }
    }

    pub fn draw_text(&mut self, text: Text) {
        self.shapes.push(PictureShape::Text(text));
    }

    /// Marks the shapes so far as the heading, whose removal makes the picture lower by `height` pixels.
    pub fn end_heading(&mut self, height: f64) {
        self.headings.push(Heading { shapes: 0..self.shapes.len(), height });
    }

    /// Enlarges the picture by another one below it.
    pub fn append_below(&mut self, other: Self) {
        let offset = f64::from(self.height);
        let count = self.shapes.len();
        let shift = |heading: Heading| {
            let Range { start, end } = heading.shapes;
            Heading { shapes: start + count..end + count, ..heading }
        };
        let shift_down = |area: Rectangle| Rectangle {
            top: area.top + offset,
            bottom: area.bottom + offset,
            ..area
        };
        self.marked_areas.extend(other.marked_areas.into_iter().map(shift_down));
        self.headings.extend(other.headings.into_iter().map(shift));
        self.width = self.width.max(other.width);
        self.height += other.height;
        self.shapes.extend(other.shapes.iter().map(|shape| shape.shift_down(offset)));
    }

    /// Returns the texts of the picture.
    #[cfg(test)]
    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.shapes.iter().filter_map(|shape| match shape {
            PictureShape::Text(text) => Some(text),
            _ => None,
        })
    }

    /// Panics if [`find_covering_texts`](Self::find_covering_texts) finds a text.
    #[cfg(test)]
    pub fn assert_texts_do_not_overlap(&self) {
        let found = self.find_covering_texts();
        assert!(found.is_empty(), "{found:?}");
    }

    /// Describes each text that extends beyond the picture, overlaps another text, or covers a curve or a marked point.
    /// Numbers on discs, in bold, mark their curves and may cover them.
    pub(super) fn find_covering_texts(&self) -> Vec<String> {
        let texts: Vec<&Text> = self
            .shapes
            .iter()
            .filter_map(|shape| match shape {
                PictureShape::Text(text) => Some(text),
                _ => None,
            })
            .collect();
        let page = [f64::from(self.width), f64::from(self.height)];
        let mut found = Vec::new();
        for (index, text) in texts.iter().enumerate() {
            let bounds = text.bounds();
            let mut report = |place: &str| found.push(format!("'{}' {place}", text.content));
            if bounds.left < 0.0
                || bounds.right > page[0]
                || bounds.top < 0.0
                || bounds.bottom > page[1]
            {
                report("beyond the picture");
            }
            for other in texts[..index].iter().filter(|own| bounds.is_overlapping(&own.bounds())) {
                report(&format!("on '{}'", other.content));
            }
            let inner = Rectangle {
                left: bounds.left + 1.0,
                right: bounds.right - 1.0,
                top: bounds.top + 1.0,
                bottom: bounds.bottom - 1.0,
            };
            let is_crossing = |shape: &PictureShape| match shape {
                PictureShape::Line { points, is_curve: true, .. } => {
                    !clip_polyline(points, inner).is_empty()
                }
                _ => false,
            };
            let is_number_on_disc = text.is_bold && text.font_size <= MAX_DISC_NUMBER_SIZE;
            if !is_number_on_disc && self.shapes.iter().any(is_crossing) {
                report("on a curve");
            }
            if self.marked_areas.iter().any(|area| area.is_overlapping(&inner)) {
                report("on a marked point");
            }
        }
        found
    }
}

/// Largest font size of numbers on discs, pixels; other texts in bold are titles.
const MAX_DISC_NUMBER_SIZE: f64 = 20.0;
