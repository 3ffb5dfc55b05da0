//! Legend of a verdict map: categories with their percentage of the area, and curves.

use super::boundaries::draw_line_set_swatch;
use super::colour_map::{MISSING_LEVEL_COLOUR, draw_shades};
use super::curves::draw_curve;
use super::figure::VerdictMap;
use super::hatching::{category_fill, draw_hatch};
use super::levels::LevelRange;
use super::shares::format_percent;
use crate::page::LegendEntry;
use crate::picture::{INK, Picture, Rectangle};

impl VerdictMap {
    pub(super) fn legend_entries(&self, range: Option<&LevelRange>) -> Vec<LegendEntry> {
        // Numbers of points of each category in areas and on lines.
        let mut counts = vec![[0_usize; 2]; self.categories.len()];
        let line_cells = self.line_cells();
        for (&category, &is_line) in self.category_indices.iter().zip(&line_cells) {
            counts[usize::from(category)][usize::from(is_line)] += 1;
        }
        let cells = counts.iter().map(|[in_area, _]| in_area).sum();
        let mut entries: Vec<LegendEntry> = Vec::new();
        let has_levels = range.is_some();
        for (index, category) in self.categories.iter().enumerate() {
            let (ground, hatches) = category_fill(category.fill_style);
            match counts[index] {
                [0, 0] => continue,
                [0, _] => {
                    let is_point = !self.has_neighbours_on_line(index, &line_cells);
                    let swatch = move |picture: &mut Picture, area: Rectangle| {
                        draw_line_set_swatch(picture, area, ground, is_point);
                    };
                    let place = if is_point { "at single points" } else { "on lines" };
                    entries.push((format!("{} ({place}, 0 %)", category.label), Box::new(swatch)));
                    continue;
                }
                _ => {}
            }
            let graded = has_levels && category.fill_style.is_ill_posed();
            let share = format_percent(counts[index][0], cells);
            let label = format!("{} ({share})", category.label);
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

    /// Returns whether two neighbouring points, diagonal ones included, of a category are on lines.
    fn has_neighbours_on_line(&self, category: usize, line_cells: &[bool]) -> bool {
        let (columns, rows) = (self.x.values.len(), self.y.values.len());
        let is_own = |i: usize, j: usize| {
            let cell = j * columns + i;
            usize::from(self.category_indices[cell]) == category && line_cells[cell]
        };
        let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        cells.filter(|&(i, j)| is_own(i, j)).any(|(i, j)| {
            let next = [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i.wrapping_sub(1), j + 1)];
            next.into_iter().any(|(i, j)| i < columns && j < rows && is_own(i, j))
        })
    }
}
