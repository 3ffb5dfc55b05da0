//! Axes of the domain with their ticks and names.

use super::figure::{FieldAxis, FieldFigure};
use super::layout::Layout;
use super::ticks::thinned;
use crate::page::{self, MARGIN, NAME};
use crate::picture::{Anchor, Picture, Text};
use crate::scale::{Tick, plain};

impl FieldFigure {
    pub(super) fn draw_axes(&self, picture: &mut Picture, layout: &Layout) {
        let frame = layout.frame;
        let share = |axis: &FieldAxis, value: f64| (value - axis.from) / (axis.to - axis.from);
        let x_ticks: Vec<Tick> = Self::axis_ticks(&self.x, frame.width(), false)
            .into_iter()
            .map(|(x, label)| (frame.left + share(&self.x, x) * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = Self::axis_ticks(&self.y, frame.height(), true)
            .into_iter()
            .map(|(y, label)| (frame.bottom - share(&self.y, y) * frame.height(), label))
            .collect();
        page::bottom_axis(picture, frame, &thinned(x_ticks, false), "");
        // The name may be wider than a narrow frame.
        let middle = 0.5 * (frame.left + frame.right);
        let room = 2.0 * (middle - MARGIN).min(page::WIDTH - MARGIN - middle);
        let (words, size) = page::fit(&stretched(&self.x.label, layout.stretch[0]), NAME, room);
        if !words.is_empty() {
            let at = [middle, frame.bottom + page::BOTTOM_AXIS - 0.3 * NAME];
            picture.text(Text::new(at, Anchor::Middle, size, words));
        }
        let y_ticks = thinned(y_ticks, true);
        match self.name_above(layout) {
            Some(name) => {
                page::left_axis(picture, frame, &y_ticks, "");
                picture.text(name);
            }
            None => {
                let name = stretched(&self.y.label, layout.stretch[1]);
                page::left_axis(picture, frame, &y_ticks, &name);
            }
        }
    }

    /// Returns the name of the y axis if it is written above the frame.
    pub(super) fn name_above(&self, layout: &Layout) -> Option<Text> {
        if !layout.name_above || self.y.label.is_empty() {
            return None;
        }
        let left = layout.frame.left - 60.0;
        let name = stretched(&self.y.label, layout.stretch[1]);
        let (words, size) = page::fit(&name, NAME, page::WIDTH - MARGIN - left);
        Some(Text::new([left, layout.frame.top - 0.7 * NAME], Anchor::Start, size, words))
    }
}

/// Formats the name of an axis with its stretch factor, if stretched.
pub(super) fn stretched(label: &str, factor: f64) -> String {
    let round = if factor < 9.95 { (10.0 * factor).round() / 10.0 } else { factor.round() };
    if factor < 1.05 {
        label.to_owned()
    } else if round < 1e6 {
        format!("{label}, stretched ×{}", plain(round))
    } else {
        format!("{label}, not to scale")
    }
}
