//! Legend of a dispersion figure.

use super::figure::{DispersionFigure, ReferenceLevel};
use super::number_discs::{draw_disagreement, draw_number_disc, draw_ring};
use super::styles::{
    BAND_COLOUR, CUTOFF_DASHES, GROUP_SPEED_DASHES, LEVEL_LINE_WIDTH, SPEED_LIMIT_DASHES,
};
use crate::growth::{LINE_WIDTH, LINEAR_RANGE_COLOUR};
use crate::page::LegendEntry;
use crate::picture::{Colour, INK, PALE_INK, Picture, Rectangle};

impl DispersionFigure {
    pub(super) fn legend_entries(&self) -> Vec<LegendEntry> {
        let mut entries: Vec<LegendEntry> = Vec::new();
        let middle = |area: Rectangle| 0.5 * (area.top + area.bottom);
        for (index, branch) in self.branches.iter().enumerate() {
            let style = self.branch_style(index);
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                style.draw_swatch(picture, area);
                let centre = [0.5 * (area.left + area.right), middle(area)];
                draw_number_disc(picture, centre, index + 1, style.colour);
            };
            entries.push((branch.label.clone(), Box::new(swatch)));
        }
        let mut line = |label_text: &str, pattern: &'static [f64], width: f64, colour: Colour| {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let ends = [[area.left, middle(area)], [area.right, middle(area)]];
                picture.draw_dashed_line(&ends, pattern, width, colour);
            };
            entries.push((label_text.to_owned(), Box::new(swatch)));
        };
        if self.has_group_speeds() {
            line("phase speed ω/k", &[], LINE_WIDTH, INK);
            line("group speed dω/dk", GROUP_SPEED_DASHES, LINE_WIDTH, INK);
        }
        let has_measured = self.branches.iter().any(|branch| !branch.measured_frequency.is_empty());
        if has_drawn_level(&self.cutoffs, self.is_frequency_log) {
            line("cut-off frequency", CUTOFF_DASHES, LEVEL_LINE_WIDTH, INK);
        }
        if has_drawn_level(&self.speed_limits, false) {
            line("limit of the speed as k → ∞", SPEED_LIMIT_DASHES, LEVEL_LINE_WIDTH, INK);
        }
        if has_measured {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let place = [0.5 * (area.left + area.right), middle(area)];
                draw_ring(picture, place, INK);
            };
            entries.push(("measured in time".to_owned(), Box::new(swatch)));
        }
        if self.branches.iter().any(|branch| !branch.disagreeing_frequency.is_empty()) {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                draw_disagreement(picture, [0.5 * (area.left + area.right), middle(area)]);
            };
            entries.push(("disagrees with the prediction".to_owned(), Box::new(swatch)));
        }
        for (index, band) in self.bands.iter().enumerate() {
            if self.bands[..index].iter().all(|other| other.label != band.label) {
                entries.push((
                    band.label.clone(),
                    Box::new(|picture, area| {
                        picture.fill_rectangle(area, BAND_COLOUR);
                        picture.draw_frame(area, 1.5, PALE_INK);
                    }),
                ));
            }
        }
        let highest = self.axis_scales()[2].high;
        let mut speeds = self.branches.iter().flat_map(Self::branch_phase_speeds);
        if speeds.any(|[_, speed]| speed.is_finite() && speed > highest) {
            let text = "(higher speeds not drawn)".to_owned();
            entries.push((text, Box::new(|_, _| {})));
        }
        if self.has_growth() && self.is_wave_number_log {
            entries.push((
                "linear scale about 0".to_owned(),
                Box::new(|picture, area| {
                    picture.fill_rectangle(area, LINEAR_RANGE_COLOUR);
                    picture.draw_frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        entries
    }
}

/// Returns whether a level is on its axis, which covers all finite levels, on a logarithmic axis the positive ones.
fn has_drawn_level(levels: &[ReferenceLevel], is_log: bool) -> bool {
    levels.iter().any(|level| level.value.is_finite() && (!is_log || level.value > 0.0))
}
