//! Colour bar of a field.

use super::colour_map::{SHADES, Scale};
use super::contours::{Levels, draw_level, draw_ruled};
use super::figure::FieldFigure;
use super::ticks::thinned;
use crate::page::{self, NAME, NUMBER, RULE};
use crate::picture::{Anchor, INK, Picture, Point, Rectangle, Text, WHITE};
use crate::scale::Tick;
use crate::verdict_map::ARROW;

/// Colour bar and its orientation.
struct Bar {
    area: Rectangle,
    is_upright: bool,
}

impl Bar {
    fn length(&self) -> f64 {
        if self.is_upright { self.area.height() } else { self.area.width() }
    }

    /// Returns the coordinate, in pixels, at a share of the bar's length.
    fn place(&self, share: f64) -> f64 {
        let length = self.length();
        if self.is_upright {
            self.area.bottom - share * length
        } else {
            self.area.left + share * length
        }
    }

    /// Returns the transverse line at a share of the bar's length.
    fn across(&self, share: f64) -> [Point; 2] {
        let (bar, place) = (self.area, self.place(share));
        if self.is_upright {
            [[bar.left, place], [bar.right, place]]
        } else {
            [[place, bar.top], [place, bar.bottom]]
        }
    }

    fn draw_colours(&self, picture: &mut Picture, scale: &Scale) {
        let first = if scale.is_signed { -SHADES } else { 0 };
        let count = f64::from(SHADES - first) + 1.0;
        for (index, step) in (first..=SHADES).enumerate() {
            let [from, to] =
                [index as f64, index as f64 + 1.0].map(|edge| self.place(edge / count));
            let part = if self.is_upright {
                Rectangle { top: to, bottom: from, ..self.area }
            } else {
                Rectangle { left: from, right: to, ..self.area }
            };
            picture.patches(vec![part], scale.colour(step));
        }
    }

    /// Draws the outline, with arrows at ends whose colours also stand for values beyond the scale.
    fn draw_outline(&self, picture: &mut Picture, scale: &Scale) {
        let ends: &[f64] = match scale.open {
            [false, false] => &[],
            [true, false] => &[0.0],
            [false, true] => &[1.0],
            [true, true] => &[0.0, 1.0],
        };
        for &end in ends {
            let base = self.across(end + (0.5 - end) * 2.0 * ARROW / self.length());
            let middle = self.across(end);
            let tip = [0, 1].map(|part| 0.5 * (middle[0][part] + middle[1][part]));
            for (corner, inner) in middle.into_iter().zip(base) {
                picture.polygon(vec![tip, corner, inner], WHITE);
            }
            picture.line([base[0], tip, base[1]], RULE, INK);
        }
        picture.line(outline(self.area, self.is_upright, ends, ARROW), RULE, INK);
    }
}

impl FieldFigure {
    pub(super) fn draw_bar(
        &self,
        picture: &mut Picture,
        scale: &Scale,
        levels: &Levels,
        area: Rectangle,
        is_upright: bool,
    ) {
        let bar = Bar { area, is_upright };
        bar.draw_colours(picture, scale);
        self.draw_levels_on_bar(picture, scale, levels, &bar);
        bar.draw_outline(picture, scale);
        self.draw_bar_axis(picture, scale, &bar);
    }

    fn draw_levels_on_bar(&self, picture: &mut Picture, scale: &Scale, levels: &Levels, bar: &Bar) {
        match levels {
            Levels::Lines(_) => {
                for level in self.level_shares(scale) {
                    let share = scale.share(level * scale.end);
                    if (0.0..=1.0).contains(&share) {
                        draw_level(picture, level, &bar.across(share));
                    }
                }
            }
            Levels::Ruled => {
                let end = bar.place(scale.share(-0.25 * scale.end));
                let ruled = if bar.is_upright {
                    Rectangle { top: end, ..bar.area }
                } else {
                    Rectangle { right: end, ..bar.area }
                };
                draw_ruled(picture, ruled);
            }
            Levels::TooMany | Levels::None => {}
        }
    }

    fn draw_bar_axis(&self, picture: &mut Picture, scale: &Scale, bar: &Bar) {
        let ticks: Vec<Tick> = self
            .bar_ticks(scale, bar.length(), bar.is_upright)
            .into_iter()
            .map(|(value, label)| (bar.place(scale.share(value)), label))
            .collect();
        let area = bar.area;
        if !bar.is_upright {
            return page::bottom_axis(picture, area, &thinned(ticks, false), &self.label);
        }
        let ticks = thinned(ticks, true);
        for (y, label) in &ticks {
            picture.line([[area.right, *y], [area.right + 8.0, *y]], RULE, INK);
            if !label.is_empty() {
                let at = [area.right + 14.0, y + 0.36 * NUMBER];
                picture.text(Text::new(at, Anchor::Start, NUMBER, label));
            }
        }
        let (name, size) = page::fit(&self.label, NAME, area.height());
        if !name.is_empty() {
            let x = area.right + 14.0 + page::widest(&ticks) + 12.0 + 0.76 * NAME;
            let at = [x, 0.5 * (area.top + area.bottom)];
            picture.text(Text { upwards: true, ..Text::new(at, Anchor::Middle, size, name) });
        }
    }
}

/// Computes the closed outline of a bar, with arrows of length `arrow` at the `ends` (0: lower or left, 1: upper or
/// right).
fn outline(bar: Rectangle, upright: bool, ends: &[f64], arrow: f64) -> Vec<Point> {
    let Rectangle { left, top, right, bottom } = bar;
    let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
    let [low, high] = [0.0, 1.0].map(|end| ends.contains(&end));
    let cut = |is_cut: bool| if is_cut { arrow } else { 0.0 };
    let corners: [(Point, bool); 6] = if upright {
        [
            ([left, bottom - cut(low)], true),
            ([x, bottom], low),
            ([right, bottom - cut(low)], true),
            ([right, top + cut(high)], true),
            ([x, top], high),
            ([left, top + cut(high)], true),
        ]
    } else {
        [
            ([left + cut(low), top], true),
            ([left, y], low),
            ([left + cut(low), bottom], true),
            ([right - cut(high), bottom], true),
            ([right, y], high),
            ([right - cut(high), top], true),
        ]
    };
    let mut points: Vec<Point> =
        corners.into_iter().filter(|(_, is_there)| *is_there).map(|(point, _)| point).collect();
    points.extend_from_within(..2);
    points
}
