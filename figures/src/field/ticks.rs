//! Ticks of the axes and of the colour bar.

use super::colour_map::ColourScale;
use super::figure::{FieldAxis, FieldFigure};
use crate::page::{self, TICK_LABEL_SIZE};
use crate::picture::text_width;
use crate::scale::{self, Tick, format_number};

impl FieldFigure {
    /// Computes the ticks of an axis of `length` pixels, in the unit of the axis; both ends if there would be fewer
    /// than two ticks.
    pub(super) fn axis_ticks(axis: &FieldAxis, length: f64, is_vertical: bool) -> Vec<Tick> {
        let (low, high) = (axis.start.min(axis.end), axis.start.max(axis.end));
        let degrees = axis.label.contains('°');
        let ticks = page::choose_ticks(length, is_vertical, |max_count| {
            scale::linear_ticks(low, high, max_count, degrees)
        });
        let ends = [low, high].map(|end| (end, format_number(end)));
        // Ends with equal labels are too close to be distinguished and are not labelled.
        if ticks.len() < 2 && ends[0].1 != ends[1].1 { ends.to_vec() } else { ticks }
    }

    /// Computes the ticks of the colour bar and the text of their common factor.
    pub(super) fn bar_ticks(
        &self,
        scale: &ColourScale,
        length: f64,
        is_vertical: bool,
    ) -> (Vec<Tick>, String) {
        scale.ticks(length, is_vertical, self.label.contains('°'))
    }
}

/// Removes the labels that would overlap the previous label; positions are in pixels.
pub(super) fn remove_overlapping_labels(mut ticks: Vec<Tick>, is_vertical: bool) -> Vec<Tick> {
    ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut end = f64::NEG_INFINITY;
    for (place, label) in &mut ticks {
        let half = if is_vertical {
            0.55 * TICK_LABEL_SIZE
        } else {
            0.5 * text_width(label, TICK_LABEL_SIZE, false) + 4.0
        };
        if *place - half < end {
            label.clear();
        } else {
            end = *place + half;
        }
    }
    ticks
}
