//! Legend of a polar diagram.

use super::circles::NEUTRAL;
use super::figure::{PolarFigure, SpokeStyle};
use crate::growth::{LINEAR, legend_of};
use crate::page::Entry;
use crate::picture::{PALE_INK, Picture, Rectangle};

impl PolarFigure {
    pub(super) fn legend(&self) -> Vec<Entry> {
        let labels: Vec<&str> = self.curves.iter().map(|line| line.label.as_str()).collect();
        let mut entries = legend_of(&labels);
        for style in SpokeStyle::ALL {
            if self.drawn().any(|spoke| spoke.style == style) {
                let swatch = move |picture: &mut Picture, area: Rectangle| {
                    let middle = 0.5 * (area.top + area.bottom);
                    style.draw(picture, &[[area.left, middle], [area.right, middle]]);
                };
                entries.push((style.words().to_owned(), Box::new(swatch)));
            }
        }
        let neutral = |picture: &mut Picture, area: Rectangle| {
            let middle = 0.5 * (area.top + area.bottom);
            picture.line([[area.left, middle], [area.right, middle]], 3.4, NEUTRAL);
        };
        let words = format!("{} = 0: growth outside, decay inside", self.symbol);
        entries.push((words, Box::new(neutral)));
        let linear = |picture: &mut Picture, area: Rectangle| {
            picture.fill(area, LINEAR);
            picture.frame(area, 1.5, PALE_INK);
        };
        entries.push(("linear scale about 0".to_owned(), Box::new(linear)));
        entries
    }
}
