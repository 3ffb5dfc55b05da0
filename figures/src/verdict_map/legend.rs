//! Legend of a verdict map: categories with their percentage of the area, and curves.

use super::colour_map::{MISSING_LEVEL_COLOUR, draw_shades};
use super::curves::draw_curve;
use super::figure::{FillStyle, VerdictMap};
use super::hatching::{category_fill, draw_hatch};
use super::levels::LevelRange;
use super::shares::format_percent;
use crate::page::LegendEntry;
use crate::picture::INK;

impl VerdictMap {
    pub(super) fn legend_entries(&self, range: Option<&LevelRange>) -> Vec<LegendEntry> {
        let mut counts = vec![0_usize; self.categories.len()];
        self.category_indices.iter().for_each(|&category| counts[usize::from(category)] += 1);
        let cells = self.category_indices.len();
        let mut entries: Vec<LegendEntry> = Vec::new();
        let has_levels = range.is_some();
        for (index, category) in self.categories.iter().enumerate() {
            if counts[index] == 0 {
                continue;
            }
            let (ground, hatches) = category_fill(category.fill_style, self.variant_index(index));
            let graded = has_levels && category.fill_style == FillStyle::IllPosed;
            let label = format!("{} ({})", category.label, format_percent(counts[index], cells));
            entries.push((
                label,
                Box::new(move |picture, area| {
                    if graded {
                        draw_shades(picture, area, true, false);
                    } else {
                        picture.fill_rectangle(area, ground);
                    }
                    for hatch in &hatches {
                        draw_hatch(picture, area, *hatch, |_| true);
                    }
                    picture.draw_frame(area, 1.5, INK);
                }),
            ));
        }
        if has_levels && self.ill_posed_levels().any(|(_, level)| level.is_nan() || level <= 0.0) {
            entries.push((
                "ill-posed, no level known".to_owned(),
                Box::new(|picture, area| {
                    picture.fill_rectangle(area, MISSING_LEVEL_COLOUR);
                    picture.draw_frame(area, 1.5, INK);
                }),
            ));
        }
        for (index, curve) in self.curves.iter().enumerate() {
            let style_index = self.style_index(index);
            if self.curves[..index].iter().all(|other| other.label != curve.label) {
                entries.push((
                    curve.label.clone(),
                    Box::new(move |picture, area| {
                        let y = 0.5 * (area.top + area.bottom);
                        draw_curve(picture, &[[area.left, y], [area.right, y]], style_index);
                    }),
                ));
            }
        }
        entries
    }
}
