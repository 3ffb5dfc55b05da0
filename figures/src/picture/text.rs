//! Lines of text, and the colours of text and background.

use plotters::style::RGBColor;

use super::fonts::text_width;
use super::geometry::{Point, Rectangle};

pub(crate) type Colour = RGBColor;

pub(crate) const INK: Colour = RGBColor(25, 25, 25);
pub(crate) const PALE_INK: Colour = RGBColor(95, 95, 95);
pub(crate) const WHITE: Colour = RGBColor(255, 255, 255);

/// Anchor of a text: its start, middle or end is at the given position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Text {
    /// Anchor point on the baseline, pixels.
    pub anchor_point: Point,
    pub content: String,
    /// Size of the em square of the font, pixels.
    pub font_size: f64,
    pub is_bold: bool,
    pub colour: Colour,
    pub anchor: Anchor,
    /// Whether the text is vertical, reading upwards.
    pub is_vertical: bool,
}

/// Replaces each character that XML 1.0 does not allow (production 2, `Char`) by U+FFFD; an SVG with such characters
/// cannot be read.
fn replace_invalid_characters(text: String) -> String {
    let is_allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..);
    match text.chars().all(is_allowed) {
        true => text,
        false => text
            .chars()
            .map(|c| if is_allowed(c) { c } else { char::REPLACEMENT_CHARACTER })
            .collect(),
    }
}

impl Text {
    pub fn new(
        anchor_point: Point,
        anchor: Anchor,
        font_size: f64,
        content: impl Into<String>,
    ) -> Self {
        let content = replace_invalid_characters(content.into());
        Self {
            anchor_point,
            content,
            font_size,
            is_bold: false,
            colour: INK,
            anchor,
            is_vertical: false,
        }
    }

    /// Returns the bounding box of the text, with capitals, ascenders and descenders.
    pub fn bounds(&self) -> Rectangle {
        let width = text_width(&self.content, self.font_size, self.is_bold);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let [x, y] = self.anchor_point;
        let (above, below) = (0.76 * self.font_size, 0.24 * self.font_size);
        if self.is_vertical {
            let bottom = y + before;
            Rectangle { left: x - above, right: x + below, top: bottom - width, bottom }
        } else {
            let left = x - before;
            Rectangle { left, right: left + width, top: y - above, bottom: y + below }
        }
    }
}
