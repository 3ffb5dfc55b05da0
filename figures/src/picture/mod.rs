//! Picture as a list of shapes, and its rendering.
//!
//! Coordinates are fractional pixels.

mod dialect;
mod fonts;
mod geometry;
mod render;
mod shapes;
#[cfg(test)]
mod tests;
mod text;

pub(crate) use fonts::text_width;
pub(crate) use geometry::{Point, Rectangle, circle, clip, dashes, polyline_length};
pub(crate) use shapes::Picture;
pub(crate) use text::{Anchor, Colour, INK, PALE_INK, Text, WHITE};
