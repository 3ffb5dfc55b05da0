//! The list of shapes.

use super::geometry::{Point, Rectangle, circle, dashes};
use super::text::{Colour, Text};

pub(super) enum Shape {
    Rectangle(Rectangle, Colour),
    Patches(Vec<Rectangle>, Colour),
    Polygon(Vec<Point>, Colour),
    Line { points: Vec<Point>, width: f64, colour: Colour },
    Text(Text),
}

/// A white sheet with shapes on it, later ones above earlier ones.
pub(crate) struct Picture {
    pub width: u32,
    pub height: u32,
    pub(super) shapes: Vec<Shape>,
}

impl Picture {
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, shapes: Vec::new() }
    }

    pub fn fill(&mut self, area: Rectangle, colour: Colour) {
        self.shapes.push(Shape::Rectangle(area, colour));
    }

    /// Fills many areas at once, with edges on whole fine pixels and none shared: a fifth of the
    /// bytes of single areas in an SVG, and no hairlines between neighbours.
    pub fn patches(&mut self, areas: Vec<Rectangle>, colour: Colour) {
        self.shapes.push(Shape::Patches(areas, colour));
    }

    pub fn polygon(&mut self, points: Vec<Point>, colour: Colour) {
        self.shapes.push(Shape::Polygon(points, colour));
    }

    pub fn disc(&mut self, centre: Point, radius: f64, colour: Colour) {
        self.polygon(circle(centre, radius, 24), colour);
    }

    pub fn line(&mut self, points: impl Into<Vec<Point>>, width: f64, colour: Colour) {
        self.shapes.push(Shape::Line { points: points.into(), width, colour });
    }

    pub fn frame(&mut self, area: Rectangle, width: f64, colour: Colour) {
        let corners = area.corners();
        // The first edge is drawn twice so that all four corners are mitred.
        self.line([&corners[..], &corners[..2]].concat(), width, colour);
    }

    /// A line interrupted by gaps: `pattern` holds the lengths of dashes and gaps in turn, in
    /// pixels; without a pattern the line is solid.
    pub fn dashed(&mut self, points: &[Point], pattern: &[f64], width: f64, colour: Colour) {
        if pattern.is_empty() {
            return self.line(points, width, colour);
        }
        for dash in dashes(points, pattern) {
            self.line(dash, width, colour);
        }
    }

    pub fn text(&mut self, text: Text) {
        self.shapes.push(Shape::Text(text));
    }

    /// The texts of the picture.
    #[cfg(test)]
    pub fn texts(&self) -> impl Iterator<Item = &Text> {
        self.shapes.iter().filter_map(|shape| match shape {
            Shape::Text(text) => Some(text),
            _ => None,
        })
    }

    /// Fails when a text leaves the sheet or lies on another text.
    #[cfg(test)]
    pub fn assert_texts_are_apart(&self) {
        let texts: Vec<&Text> = self.texts().collect();
        for (index, text) in texts.iter().enumerate() {
            let bounds = text.bounds();
            assert!(bounds.left >= 0.0 && bounds.right <= f64::from(self.width), "{text:?}");
            assert!(bounds.top >= 0.0 && bounds.bottom <= f64::from(self.height), "{text:?}");
            for other in &texts[..index] {
                assert!(!bounds.overlaps(&other.bounds()), "{text:?} on {other:?}");
            }
        }
    }
}
