//! Ticks of the axes and of the colour bar.

use super::colour_map::Scale;
use super::figure::{FieldAxis, FieldFigure};
use crate::page::{self, NUMBER};
use crate::picture::text_width;
use crate::scale::{self, Tick, plain};

impl FieldFigure {
    /// Ticks of an axis in the axis's unit, for a length in pixels; both ends where there would be
    /// less than two.
    pub(super) fn axis_ticks(axis: &FieldAxis, length: f64, upright: bool) -> Vec<Tick> {
        let (low, high) = (axis.from.min(axis.to), axis.from.max(axis.to));
        let degrees = axis.label.contains('°');
        let ticks = page::spaced(length, upright, |most| scale::ticks(low, high, most, degrees));
        let ends = [low, high].map(|end| (end, plain(end)));
        // Too close to each other to differ in few figures, they would say nothing.
        if ticks.len() < 2 && ends[0].1 != ends[1].1 { ends.to_vec() } else { ticks }
    }

    pub(super) fn bar_ticks(&self, scale: &Scale, length: f64, upright: bool) -> Vec<Tick> {
        scale.ticks(length, upright, self.label.contains('°'))
    }
}

/// The ticks with the labels left out that would touch the one before; places are in pixels.
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
