//! Legend of a polar diagram.

use super::circles::NEUTRAL_COLOUR;
use super::figure::{PolarFigure, SpokeStyle};
use crate::growth::{LINEAR_RANGE_COLOUR, build_line_entries};
use crate::page::LegendEntry;
use crate::picture::{PALE_INK, Picture, Rectangle};

impl PolarFigure {
    pub(super) fn legend_entries(&self) -> Vec<LegendEntry> {
        let labels: Vec<&str> = self.curves.iter().map(|line| line.label.as_str()).collect();
        let mut entries = build_line_entries(&labels);
        for style in SpokeStyle::ALL {
            if self.finite_spokes().any(|spoke| spoke.style == style) {
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = 0.5 * (area.top + area.bottom);
                    style.draw(picture, &[[area.left, middle], [area.right, middle]]);
                };
                entries.push((style.description().to_owned(), Box::new(swatch)));
            }
        }
        let neutral = |picture: &mut Picture, area: Rectangle| {
            let middle = 0.5 * (area.top + area.bottom);
            picture.draw_line([[area.left, middle], [area.right, middle]], 3.4, NEUTRAL_COLOUR);
        };
        let label_text = format!("{} = 0: growth outside, decay inside", self.symbol);
        entries.push((label_text, Box::new(neutral)));
        let linear = |picture: &mut Picture, area: Rectangle| {
            picture.fill_rectangle(area, LINEAR_RANGE_COLOUR);
            picture.draw_frame(area, 1.5, PALE_INK);
        };
        entries.push(("linear scale about 0".to_owned(), Box::new(linear)));
        entries
    }
}
