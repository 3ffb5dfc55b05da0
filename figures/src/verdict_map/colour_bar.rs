//! Colour bar of growth levels.

use super::colour_map::{ARROW, BAR, BAR_GAP, INFINITE, draw_shades, shade};
use super::figure::VerdictMap;
use super::levels::{Range, contour_colour};
use crate::page::{self, MARGIN, NAME, NUMBER, RULE};
use crate::picture::{Anchor, INK, Picture, Rectangle, Text};
use crate::scale::Tick;

impl VerdictMap {
    pub(super) fn draw_bar(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        range: &Range,
        ticks: &[Tick],
    ) {
        let left = frame.right + BAR_GAP;
        let mut bar = Rectangle { left, right: left + BAR, ..frame };
        if range.infinite {
            let cap = Rectangle { bottom: bar.top + 34.0, ..bar };
            picture.fill(cap, INFINITE);
            picture.frame(cap, RULE, INK);
            let at = [cap.right + 14.0, 0.5 * (cap.top + cap.bottom) + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::Start, NUMBER, "∞"));
            bar.top = cap.bottom + 0.6 * NUMBER;
        }
        // Arrows indicate that the colours at the ends also represent levels beyond.
        let middle = 0.5 * (bar.left + bar.right);
        for (end, beyond) in range.beyond.into_iter().enumerate() {
            if beyond {
                let (share, tip, base) = if end == 0 {
                    (0.0, bar.bottom, bar.bottom - ARROW)
                } else {
                    (1.0, bar.top, bar.top + ARROW)
                };
                let corners = vec![[bar.left, base], [bar.right, base], [middle, tip]];
                picture.polygon(corners.clone(), shade(share));
                picture.line([&corners[..], &corners[..2]].concat(), RULE, INK);
                if end == 0 {
                    bar.bottom = base;
                } else {
                    bar.top = base;
                }
            }
        }
        draw_shades(picture, bar, false, false);
        for (tick, label) in ticks {
            let share = (tick - range.low) / (range.high - range.low);
            let y = bar.bottom - share.clamp(0.0, 1.0) * bar.height();
            picture.line([[bar.left, y], [bar.right, y]], 1.6, contour_colour(range, *tick));
            picture.line([[bar.right, y], [bar.right + 8.0, y]], RULE, INK);
            let at = [bar.right + 14.0, y + 0.36 * NUMBER];
            picture.text(Text::new(at, Anchor::Start, NUMBER, label));
        }
        picture.frame(bar, RULE, INK);
        let (name, size) = page::fit(&self.level_label, NAME, frame.height());
        let at = [page::WIDTH - MARGIN - 0.3 * NAME, 0.5 * (frame.top + frame.bottom)];
        picture.text(Text { upwards: true, ..Text::new(at, Anchor::Middle, size, name) });
    }
}
