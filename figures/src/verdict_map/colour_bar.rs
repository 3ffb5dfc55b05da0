//! Colour bar of growth levels.

use super::colour_map::{
    ARROW_LENGTH, BAR_GAP, BAR_WIDTH, INFINITE_LEVEL_COLOUR, contrast_colour, draw_shades,
    shade_colour,
};
use super::figure::VerdictMap;
use super::levels::{LevelRange, contour_colour};
use crate::page::{self, AXIS_NAME_SIZE, FRAME_LINE_WIDTH, MARGIN, MIN_TEXT_SIZE, TICK_LABEL_SIZE};
use crate::picture::{Anchor, INK, Picture, Rectangle, Text};
use crate::scale::Tick;

/// Word that says what the lines across the bar stand for.
pub(super) const CONTOUR_WORD: &str = "contour";

impl VerdictMap {
    /// Draws the bar beside the frame. Levels with a contour line in the map are marked across the bar; `has_line` says
    /// which of the ticks have one.
    pub(super) fn draw_colour_bar(
        &self,
        picture: &mut Picture,
        frame: Rectangle,
        range: &LevelRange,
        (ticks, has_line): (&[Tick], &[bool]),
    ) {
        let left = frame.right + BAR_GAP;
        let mut bar = Rectangle { left, right: left + BAR_WIDTH, ..frame };
        if range.has_infinite_levels {
            let cap = Rectangle { bottom: bar.top + 34.0, ..bar };
            picture.fill_rectangle(cap, INFINITE_LEVEL_COLOUR);
            picture.draw_frame(cap, FRAME_LINE_WIDTH, INK);
            let at = [cap.right + 14.0, 0.5 * (cap.top + cap.bottom) + 0.36 * TICK_LABEL_SIZE];
            picture.draw_text(Text::new(at, Anchor::Start, TICK_LABEL_SIZE, "∞"));
            bar.top = cap.bottom + 0.6 * TICK_LABEL_SIZE;
        }
        // Arrows indicate that the colours at the ends also represent levels beyond.
        let middle = 0.5 * (bar.left + bar.right);
        for (end, beyond) in range.has_clipped_levels.into_iter().enumerate() {
            if beyond {
                let (share, tip, base) = if end == 0 {
                    (0.0, bar.bottom, bar.bottom - ARROW_LENGTH)
                } else {
                    (1.0, bar.top, bar.top + ARROW_LENGTH)
                };
                let corners = vec![[bar.left, base], [bar.right, base], [middle, tip]];
                picture.fill_polygon(corners.clone(), shade_colour(share));
                picture.draw_line([&corners[..], &corners[..2]].concat(), FRAME_LINE_WIDTH, INK);
                if end == 0 {
                    bar.bottom = base;
                } else {
                    bar.top = base;
                }
            }
        }
        draw_shades(picture, bar, false, false);
        for ((tick, label), has_line) in ticks.iter().zip(has_line) {
            let share = (tick - range.low) / (range.high - range.low);
            let y = bar.bottom - share.clamp(0.0, 1.0) * bar.height();
            if *has_line {
                let mark = [[bar.left, y], [bar.right, y]];
                picture.draw_line(mark, 1.6, contour_colour(range, *tick));
            }
            picture.draw_line([[bar.right, y], [bar.right + 8.0, y]], FRAME_LINE_WIDTH, INK);
            let at = [bar.right + 14.0, y + 0.36 * TICK_LABEL_SIZE];
            picture.draw_text(Text::new(at, Anchor::Start, TICK_LABEL_SIZE, label));
        }
        picture.draw_frame(bar, FRAME_LINE_WIDTH, INK);
        if has_line.contains(&true) {
            // Below the bar, lower than the tick labels of the map: what the lines across it stand for.
            let y = frame.bottom + 2.5 * TICK_LABEL_SIZE;
            draw_contour_key(picture, Rectangle { top: y - 9.0, bottom: y + 9.0, ..bar });
            let at = [bar.right + 8.0, y + 0.36 * MIN_TEXT_SIZE];
            picture.draw_text(Text::new(at, Anchor::Start, MIN_TEXT_SIZE, CONTOUR_WORD));
        }
        let x = page::width() - MARGIN - 0.3 * AXIS_NAME_SIZE;
        page::draw_vertical_name(picture, x, [frame.top, frame.bottom], &self.level_label);
    }
}

/// Draws contour lines on a light and on a dark colour.
fn draw_contour_key(picture: &mut Picture, area: Rectangle) {
    const SHARES: [f64; 2] = [0.2, 0.8];
    let [middle, y] = [0.5 * (area.left + area.right), 0.5 * (area.top + area.bottom)];
    let halves =
        [Rectangle { right: middle, ..area }, Rectangle { left: middle, ..area }].into_iter();
    for (half, share) in halves.zip(SHARES) {
        picture.fill_rectangle(half, shade_colour(share));
        picture.draw_line([[half.left, y], [half.right, y]], 1.6, contrast_colour(share));
    }
}
