//! Legend of a verdict map: categories with their shares, and curves.

use super::colour_map::{LEVEL_MISSING, draw_shades};
use super::curves::draw_curve;
use super::figure::{Look, VerdictMap};
use super::hatching::{draw_hatch, fill};
use super::levels::Range;
use super::shares::percent;
use crate::page::Entry;
use crate::picture::INK;

impl VerdictMap {
    pub(super) fn legend(&self, range: Option<&Range>) -> Vec<Entry> {
        let mut counts = vec![0_usize; self.categories.len()];
        self.category.iter().for_each(|&category| counts[usize::from(category)] += 1);
        let cells = self.category.len();
        let mut entries: Vec<Entry> = Vec::new();
        let has_levels = range.is_some();
        for (index, category) in self.categories.iter().enumerate() {
            if counts[index] == 0 {
                continue;
            }
            let (ground, hatches) = fill(category.look, self.variant(index));
            let graded = has_levels && category.look == Look::IllPosed;
            let label = format!("{} ({})", category.label, percent(counts[index], cells));
            entries.push((
                label,
                Box::new(move |picture, area| {
                    if graded {
                        draw_shades(picture, area, true, false);
                    } else {
                        picture.fill(area, ground);
                    }
                    for hatch in &hatches {
                        draw_hatch(picture, area, *hatch, |_| true);
                    }
                    picture.frame(area, 1.5, INK);
                }),
            ));
        }
        if has_levels && self.levels().any(|(_, level)| level.is_nan() || level <= 0.0) {
            entries.push((
                "ill-posed, no level known".to_owned(),
                Box::new(|picture, area| {
                    picture.fill(area, LEVEL_MISSING);
                    picture.frame(area, 1.5, INK);
                }),
            ));
        }
        for (index, curve) in self.curves.iter().enumerate() {
            let look = self.first_of_label(index);
            if self.curves[..index].iter().all(|other| other.label != curve.label) {
                entries.push((
                    curve.label.clone(),
                    Box::new(move |picture, area| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_curve(picture, &[[area.left, y], [area.right, y]], look);
                    }),
                ));
            }
        }
        entries
    }
}
