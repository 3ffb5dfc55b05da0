//! Colour bar of a field.

use super::colour_map::{ColourScale, SHADE_COUNT};
use super::contours::{Contours, draw_contour_line};
use super::figure::FieldFigure;
use super::signs::draw_sign_lines_in;
use super::ticks::remove_overlapping_labels;
use crate::page::{self, AXIS_NAME_SIZE, FRAME_LINE_WIDTH, TICK_LABEL_SIZE};
use crate::picture::{Anchor, INK, Picture, Point, Rectangle, Text, WHITE};
use crate::scale::{Tick, label_with_multiplier};
use crate::verdict_map::ARROW_LENGTH;

/// Colour bar and its orientation.
struct ColourBar {
    area: Rectangle,
    is_vertical: bool,
}

impl ColourBar {
    fn length(&self) -> f64 {
        if self.is_vertical { self.area.height() } else { self.area.width() }
    }

    /// Returns the coordinate, in pixels, at a fraction of the bar's length.
    fn position(&self, fraction: f64) -> f64 {
        let length = self.length();
        if self.is_vertical {
            self.area.bottom - fraction * length
        } else {
            self.area.left + fraction * length
        }
    }

    /// Returns the transverse line at a fraction of the bar's length.
    fn transverse_line(&self, fraction: f64) -> [Point; 2] {
        let (bar, place) = (self.area, self.position(fraction));
        if self.is_vertical {
            [[bar.left, place], [bar.right, place]]
        } else {
            [[place, bar.top], [place, bar.bottom]]
        }
    }

    fn draw_colours(&self, picture: &mut Picture, scale: &ColourScale) {
        let first = if scale.is_signed { -SHADE_COUNT } else { 0 };
        let count = f64::from(SHADE_COUNT - first) + 1.0;
        for (index, step) in (first..=SHADE_COUNT).enumerate() {
            let [from, to] =
                [index as f64, index as f64 + 1.0].map(|edge| self.position(edge / count));
            let part = if self.is_vertical {
                Rectangle { top: to, bottom: from, ..self.area }
            } else {
                Rectangle { left: from, right: to, ..self.area }
            };
            picture.fill_patches(vec![part], scale.step_colour(step));
            draw_sign_lines_in(picture, scale, (step, part), self.area);
        }
    }

    /// Draws the outline, with arrows at ends whose colours also represent values outside the scale.
    fn draw_outline(&self, picture: &mut Picture, scale: &ColourScale) {
        let ends: &[f64] = match scale.has_clipped_values {
            [false, false] => &[],
            [true, false] => &[0.0],
            [false, true] => &[1.0],
            [true, true] => &[0.0, 1.0],
        };
        for &end in ends {
            let base = self.transverse_line(end + (0.5 - end) * 2.0 * ARROW_LENGTH / self.length());
            let middle = self.transverse_line(end);
            let tip = [0, 1].map(|part| 0.5 * (middle[0][part] + middle[1][part]));
            for (corner, inner) in middle.into_iter().zip(base) {
                picture.fill_polygon(vec![tip, corner, inner], WHITE);
            }
            picture.draw_line([base[0], tip, base[1]], FRAME_LINE_WIDTH, INK);
        }
        picture.draw_line(
            outline_points(self.area, self.is_vertical, ends, ARROW_LENGTH),
            FRAME_LINE_WIDTH,
            INK,
        );
    }
}

impl FieldFigure {
    pub(super) fn draw_colour_bar(
        &self,
        picture: &mut Picture,
        scale: &ColourScale,
        levels: &Contours,
        area: Rectangle,
        is_upright: bool,
    ) {
        let bar = ColourBar { area, is_vertical: is_upright };
        bar.draw_colours(picture, scale);
        self.draw_contours_on_bar(picture, scale, levels, &bar);
        bar.draw_outline(picture, scale);
        self.draw_bar_axis(picture, scale, &bar);
    }

    fn draw_contours_on_bar(
        &self,
        picture: &mut Picture,
        scale: &ColourScale,
        levels: &Contours,
        bar: &ColourBar,
    ) {
        let Contours::Lines(lines) = levels else { return };
        // Other figures with the same fixed scale may have lines at all levels.
        let is_drawn = |level: &f64| scale.is_fixed || lines.iter().any(|(own, _)| own == level);
        for level in self.relative_levels(scale).into_iter().filter(is_drawn) {
            let share = scale.fraction(level * scale.limit);
            if (0.0..=1.0).contains(&share) {
                draw_contour_line(picture, level, &bar.transverse_line(share));
            }
        }
    }

    fn draw_bar_axis(&self, picture: &mut Picture, scale: &ColourScale, bar: &ColourBar) {
        let (ticks, multiplier) = self.bar_ticks(scale, bar.length(), bar.is_vertical);
        let label = label_with_multiplier(&self.label, &multiplier);
        let ticks: Vec<Tick> = ticks
            .into_iter()
            .map(|(value, label)| (bar.position(scale.fraction(value)), label))
            .collect();
        let area = bar.area;
        let root_note = if page::is_narrow() { "root scale" } else { "square-root scale" };
        let name = match scale.is_root && !self.label.is_empty() {
            true => format!("{label}, {root_note}"),
            false => label,
        };
        if !bar.is_vertical {
            return page::draw_bottom_axis(
                picture,
                area,
                &remove_overlapping_labels(ticks, false),
                &name,
            );
        }
        let ticks = remove_overlapping_labels(ticks, true);
        for (y, label) in &ticks {
            picture.draw_line([[area.right, *y], [area.right + 8.0, *y]], FRAME_LINE_WIDTH, INK);
            if !label.is_empty() {
                let at = [area.right + 14.0, y + 0.36 * TICK_LABEL_SIZE];
                picture.draw_text(Text::new(at, Anchor::Start, TICK_LABEL_SIZE, label));
            }
        }
        if !name.is_empty() {
            let x =
                area.right + 14.0 + page::max_label_width(&ticks) + 12.0 + 0.76 * AXIS_NAME_SIZE;
            page::draw_vertical_name(picture, x, [area.top, area.bottom], &name);
        }
    }
}

/// Computes the closed outline of a bar, with arrows of length `arrow` at the `ends` (0: lower or left, 1: upper or
/// right).
fn outline_points(bar: Rectangle, is_vertical: bool, ends: &[f64], arrow: f64) -> Vec<Point> {
    let Rectangle { left, top, right, bottom } = bar;
    let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
    let [low, high] = [0.0, 1.0].map(|end| ends.contains(&end));
    let cut = |is_cut: bool| if is_cut { arrow } else { 0.0 };
    let corners: [(Point, bool); 6] = if is_vertical {
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
