//! Legend of a dispersion figure.

use super::figure::DispersionFigure;
use super::looks::{BAND, COLOURS, CUTOFF, GROUP, LEVEL_WIDTH, LIMIT};
use super::tags::{draw_ring, draw_tag};
use crate::growth::{LINE_WIDTH, LINEAR};
use crate::page::Entry;
use crate::picture::{Colour, INK, PALE_INK, Picture, Rectangle};

impl DispersionFigure {
    pub(super) fn legend(&self) -> Vec<Entry> {
        let mut entries: Vec<Entry> = Vec::new();
        let middle = |area: Rectangle| 0.5 * (area.top + area.bottom);
        for (index, branch) in self.branches.iter().enumerate() {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let (y, colour) = (middle(area), COLOURS[index % COLOURS.len()]);
                picture.line([[area.left, y], [area.right, y]], LINE_WIDTH, colour);
                draw_tag(picture, [0.5 * (area.left + area.right), y], index + 1, colour);
            };
            entries.push((branch.label.clone(), Box::new(swatch)));
        }
        let mut line = |words: &str, pattern: &'static [f64], width: f64, colour: Colour| {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let ends = [[area.left, middle(area)], [area.right, middle(area)]];
                picture.dashed(&ends, pattern, width, colour);
            };
            entries.push((words.to_owned(), Box::new(swatch)));
        };
        if self.branches.iter().any(|branch| !branch.group_speed.is_empty()) {
            line("phase speed ω/k", &[], LINE_WIDTH, INK);
            line("group speed dω/dk", GROUP, LINE_WIDTH, INK);
        }
        let has_measured = self.branches.iter().any(|branch| !branch.measured.is_empty());
        if !self.cutoffs.is_empty() {
            line("cut-off frequency", CUTOFF, LEVEL_WIDTH, PALE_INK);
        }
        if !self.speed_limits.is_empty() {
            line("limit of the speed", LIMIT, LEVEL_WIDTH, PALE_INK);
        }
        if has_measured {
            let swatch = move |picture: &mut Picture, area: Rectangle| {
                let place = [0.5 * (area.left + area.right), middle(area)];
                draw_ring(picture, place, INK);
            };
            entries.push(("measured in time".to_owned(), Box::new(swatch)));
        }
        for (index, band) in self.bands.iter().enumerate() {
            if self.bands[..index].iter().all(|other| other.label != band.label) {
                entries.push((
                    band.label.clone(),
                    Box::new(|picture, area| {
                        picture.fill(area, BAND);
                        picture.frame(area, 1.5, PALE_INK);
                    }),
                ));
            }
        }
        if self.has_growth() && self.k_log {
            entries.push((
                "linear scale about 0".to_owned(),
                Box::new(|picture, area| {
                    picture.fill(area, LINEAR);
                    picture.frame(area, 1.5, PALE_INK);
                }),
            ));
        }
        entries
    }
}
