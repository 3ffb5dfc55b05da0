//! Ticks of the axes and of the colour bar.

use super::colour_map::Scale;
use super::figure::{FieldAxis, FieldFigure};
use crate::page::{self, NUMBER};
use crate::picture::text_width;
use crate::scale::{self, Tick, plain};

impl FieldFigure {
    /// Computes the ticks of an axis of `length` pixels, in the unit of the axis; both ends if there would be fewer
    /// than two ticks.
    pub(super) fn axis_ticks(axis: &FieldAxis, length: f64, upright: bool) -> Vec<Tick> {
        let (low, high) = (axis.from.min(axis.to), axis.from.max(axis.to));
        let degrees = axis.label.contains('°');
        let ticks = page::spaced(length, upright, |most| scale::ticks(low, high, most, degrees));
        let ends = [low, high].map(|end| (end, plain(end)));
        // Ends with equal labels are too close to be distinguished and are not labelled.
        if ticks.len() < 2 && ends[0].1 != ends[1].1 { ends.to_vec() } else { ticks }
    }

    pub(super) fn bar_ticks(&self, scale: &Scale, length: f64, upright: bool) -> Vec<Tick> {
        scale.ticks(length, upright, self.label.contains('°'))
    }
}

/// Removes the labels that would overlap the previous label; positions are in pixels.
pub(super) fn thinned(mut ticks: Vec<Tick>, upright: bool) -> Vec<Tick> {
    ticks.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut end = f64::NEG_INFINITY;
    for (place, label) in &mut ticks {
        let half =
            if upright { 0.55 * NUMBER } else { 0.5 * text_width(label, NUMBER, false) + 4.0 };
        if *place - half < end {
            label.clear();
        } else {
            end = *place + half;
        }
    }
    ticks
}
