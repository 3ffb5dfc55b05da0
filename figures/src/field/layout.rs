//! Layout of a field figure: frame, colour bar and legend.

use super::colour_map::Scale;
use super::figure::FieldFigure;
use crate::page::{self, MARGIN, NAME};
use crate::picture::{Rectangle, text_width};
use crate::verdict_map::{BAR, BAR_GAP};

/// Minimum length of either side of the frame, pixels; shorter sides are stretched.
const SHORTEST_SIDE: f64 = 84.0;
/// Minimum side length, pixels, of frames with the names of marks inside; smaller frames have margins for the names.
const ROOMY: f64 = 260.0;
/// Margin for names beside a narrow frame, and above a low frame, pixels.
const BESIDE: f64 = 200.0;
const ABOVE: f64 = 64.0;
/// Margin for tick labels that extend beyond the right end of the frame, pixels.
const OVERHANG: f64 = 20.0;
/// Gap between the axis of the frame and a colour bar below it, pixels.
const BAR_BELOW: f64 = 20.0;

/// Layout of the figure, in pixels.
pub(super) struct Layout {
    pub(super) height: f64,
    pub(super) frame: Rectangle,
    /// Stretch factor of each axis; 1 except for elongated domains.
    pub(super) stretch: [f64; 2],
    /// Area of the colour bar; `None` if the field is zero everywhere.
    pub(super) bar: Option<Rectangle>,
    pub(super) bar_is_upright: bool,
    /// Whether the name of the y axis is written above the frame, since it is too long for the space beside it.
    pub(super) name_above: bool,
    /// Area for the names of marks.
    pub(super) names: Rectangle,
    pub(super) legend_top: f64,
}

impl FieldFigure {
    /// Determines the layout with the largest domain, with the colour bar either beside or below the frame. `top` is
    /// the height of the heading, `legend` the height of the legend, in pixels.
    pub(super) fn layout(&self, scale: &Scale, top: f64, legend: f64) -> Layout {
        let below = (page::BOTTOM_AXIS + 22.0 + legend + MARGIN - 12.0).ceil();
        let most = page::HEIGHT.max(top + 480.0 + below) - top - below;
        let [x, y] = [&self.x, &self.y].map(|axis| (axis.to - axis.from).abs());
        let ratio = x / y;
        let sheet = page::WIDTH - 2.0 * MARGIN;
        let about = (sheet / ratio).min(most).max(SHORTEST_SIDE);
        let axis = page::left_axis_width(&Self::axis_ticks(&self.y, about, true));
        let wide = sheet - axis - OVERHANG;
        let has_bar = scale.end > 0.0;
        let beside = if has_bar {
            let ticks = self.bar_ticks(scale, most, true);
            BAR_GAP + BAR + 14.0 + page::widest(&ticks) + 12.0 + NAME
        } else {
            0.0
        };
        let under = if has_bar { BAR_BELOW + BAR + page::BOTTOM_AXIS } else { 0.0 };
        let fitted =
            |width: f64, height: f64| [width.min(height * ratio), height.min(width / ratio)];
        let (upright, lying) = (fitted(wide - beside, most), fitted(wide, most - under));
        let bar_is_upright = !has_bar || upright[0] >= lying[0];
        let [true_width, true_height] = if bar_is_upright { upright } else { lying };
        let width = true_width.max(SHORTEST_SIDE).floor();
        let height = true_height.max(SHORTEST_SIDE).floor();

        let has_names = self.marks.iter().any(|mark| !mark.name.is_empty());
        let room_above = if has_names && height < ROOMY { ABOVE } else { 0.0 };
        let room_beside = if has_names && width < ROOMY { BESIDE } else { 0.0 };
        let name_above = height < 400.0 && text_width(&self.y.label, NAME, false) + 180.0 > height;
        let over = if name_above { room_above.max(1.5 * NAME) } else { room_above };
        let group = axis + width + room_beside + if bar_is_upright { beside } else { OVERHANG };
        let left = MARGIN + 0.5 * (sheet - group).max(0.0) + axis;
        let (left, top) = (left.round(), top + over.ceil());
        let frame = Rectangle { left, top, right: left + width, bottom: top + height };
        let bar = if bar_is_upright {
            let left = frame.right + room_beside + BAR_GAP;
            Rectangle { left, right: left + BAR, ..frame }
        } else {
            let top = frame.bottom + page::BOTTOM_AXIS + BAR_BELOW;
            Rectangle { top, bottom: top + BAR, ..frame }
        };
        let end = frame.bottom + if bar_is_upright { 0.0 } else { under };
        Layout {
            height: (end + below).ceil(),
            frame,
            stretch: [width / true_width, height / true_height],
            bar: has_bar.then_some(bar),
            bar_is_upright,
            name_above,
            names: Rectangle {
                top: frame.top - room_above,
                right: frame.right + room_beside,
                ..frame
            },
            legend_top: end + page::BOTTOM_AXIS + 22.0,
        }
    }
}
