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
    pub at: Point,
    pub content: String,
    /// Size of the em square of the font, pixels.
    pub size: f64,
    pub bold: bool,
    pub colour: Colour,
    pub anchor: Anchor,
    /// Whether the text is vertical, reading upwards.
    pub upwards: bool,
}

/// Replaces each character that XML 1.0 does not allow (production 2, `Char`) by U+FFFD; an SVG with such characters
/// cannot be read.
fn writable(text: String) -> String {
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
    pub fn new(at: Point, anchor: Anchor, size: f64, content: impl Into<String>) -> Self {
        let content = writable(content.into());
        Self { at, content, size, bold: false, colour: INK, anchor, upwards: false }
    }

    /// Returns the bounding box of the text, with capitals, ascenders and descenders.
    pub fn bounds(&self) -> Rectangle {
        let width = text_width(&self.content, self.size, self.bold);
        let before = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * width,
            Anchor::End => width,
        };
        let [x, y] = self.at;
        let (above, below) = (0.76 * self.size, 0.24 * self.size);
        if self.upwards {
            let bottom = y + before;
            Rectangle { left: x - above, right: x + below, top: bottom - width, bottom }
        } else {
            let left = x - before;
            Rectangle { left, right: left + width, top: y - above, bottom: y + below }
        }
    }
}
