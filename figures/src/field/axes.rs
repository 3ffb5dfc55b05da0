//! Axes of the domain with their ticks and names.

use super::figure::{FieldAxis, FieldFigure};
use super::layout::FieldLayout;
use super::ticks::remove_overlapping_labels;
use crate::page::{self, AXIS_NAME_SIZE, MARGIN};
use crate::picture::{Anchor, Picture, Text};
use crate::scale::{Tick, format_number};

impl FieldFigure {
    pub(super) fn draw_axes(&self, picture: &mut Picture, layout: &FieldLayout) {
        let frame = layout.frame;
        let share = |axis: &FieldAxis, value: f64| (value - axis.start) / (axis.end - axis.start);
        let x_ticks: Vec<Tick> = Self::axis_ticks(&self.x, frame.width(), false)
            .into_iter()
            .map(|(x, label)| (frame.left + share(&self.x, x) * frame.width(), label))
            .collect();
        let y_ticks: Vec<Tick> = Self::axis_ticks(&self.y, frame.height(), true)
            .into_iter()
            .map(|(y, label)| (frame.bottom - share(&self.y, y) * frame.height(), label))
            .collect();
        page::draw_bottom_axis(picture, frame, &remove_overlapping_labels(x_ticks, false), "");
        // The name may be wider than a narrow frame.
        let middle = 0.5 * (frame.left + frame.right);
        let name_width = 2.0 * (middle - MARGIN).min(page::width() - MARGIN - middle);
        let (label_text, size) = page::fit_text(
            &format_stretched_name(&self.x.label, layout.stretch[0]),
            AXIS_NAME_SIZE,
            name_width,
        );
        if !label_text.is_empty() {
            let at = [middle, frame.bottom + page::BOTTOM_AXIS_HEIGHT - 0.3 * AXIS_NAME_SIZE];
            picture.draw_text(Text::new(at, Anchor::Middle, size, label_text));
        }
        let y_ticks = remove_overlapping_labels(y_ticks, true);
        match self.y_name_above(layout) {
            Some(name) => {
                page::draw_left_axis(picture, frame, &y_ticks, "");
                picture.draw_text(name);
            }
            None => {
                let name = format_stretched_name(&self.y.label, layout.stretch[1]);
                page::draw_left_axis(picture, frame, &y_ticks, &name);
            }
        }
    }

    /// Returns the name of the y axis if it is written above the frame.
    pub(super) fn y_name_above(&self, layout: &FieldLayout) -> Option<Text> {
        if !layout.is_y_name_above || self.y.label.is_empty() {
            return None;
        }
        let left = layout.frame.left - 60.0;
        let name = format_stretched_name(&self.y.label, layout.stretch[1]);
        let (label_text, size) =
            page::fit_text(&name, AXIS_NAME_SIZE, page::width() - MARGIN - left);
        Some(Text::new(
            [left, layout.frame.top - 0.7 * AXIS_NAME_SIZE],
            Anchor::Start,
            size,
            label_text,
        ))
    }
}

/// Formats the name of an axis with its stretch factor, if stretched.
pub(super) fn format_stretched_name(label: &str, factor: f64) -> String {
    let round = if factor < 9.95 { (10.0 * factor).round() / 10.0 } else { factor.round() };
    if factor < 1.05 {
        label.to_owned()
    } else if round < 1e6 {
        format!("{label}, stretched ×{}", format_number(round))
    } else {
        format!("{label}, not to scale")
    }
}
