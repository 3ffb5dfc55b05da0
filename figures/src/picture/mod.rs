//! Picture as a list of shapes, and its rendering.
//!
//! Coordinates are fractional pixels.

mod backend;
mod fonts;
mod geometry;
mod pdf;
mod render;
mod scaling;
mod shapes;
#[cfg(test)]
mod tests;
mod text;

pub(crate) use fonts::text_width;
pub(crate) use geometry::{
    Point, Rectangle, circle_points, clip_polyline, polyline_length, split_into_dashes,
};
pub(crate) use shapes::Picture;
pub(crate) use text::{Anchor, Colour, INK, PALE_INK, Text, WHITE};
