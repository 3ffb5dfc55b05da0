//! Layout of a field figure: frame, colour bar and legend.

use super::colour_map::ColourScale;
use super::figure::FieldFigure;
use crate::page::{self, AXIS_NAME_SIZE, MARGIN};
use crate::picture::{Rectangle, text_width};
use crate::verdict_map::{BAR_GAP, BAR_WIDTH};

/// Minimum length of either side of the frame, pixels; shorter sides are stretched.
const MIN_FRAME_LENGTH: f64 = 84.0;
/// Minimum side length, pixels, of frames with the names of marks inside; smaller frames have margins for the names.
const MIN_LENGTH_FOR_NAMES: f64 = 260.0;
/// Margin for the names of marks to the right of a narrow frame, pixels.
const NAME_MARGIN_RIGHT: f64 = 200.0;
/// Margin for the names of marks above a low frame, pixels.
const NAME_MARGIN_ABOVE: f64 = 64.0;
/// Margin for tick labels that extend beyond the right end of the frame, pixels.
const TICK_LABEL_MARGIN: f64 = 20.0;
/// Margin for the names of marks on the upper boundary, which stand above the frame, pixels.
const UPPER_NAME_MARGIN: f64 = 46.0;
/// Gap between the axis of the frame and a colour bar below it, pixels.
const LOWER_BAR_GAP: f64 = 20.0;

/// Layout of the figure, in pixels.
pub(super) struct FieldLayout {
    pub(super) height: f64,
    pub(super) frame: Rectangle,
    /// Stretch factor of each axis; 1 except for elongated domains.
    pub(super) stretch: [f64; 2],
    /// Area of the colour bar; `None` if no finite value differs from zero and the scale is not fixed.
    pub(super) bar_area: Option<Rectangle>,
    pub(super) is_bar_vertical: bool,
    /// Whether the name of the y axis is written above the frame, since it is too long for the space beside it.
    pub(super) is_y_name_above: bool,
    /// Area for the names of marks.
    pub(super) name_area: Rectangle,
    pub(super) legend_top: f64,
}

impl FieldFigure {
    /// Determines the layout with the largest domain, with the colour bar either beside or below the frame. `top` is
    /// the height of the heading, `legend_height` the height of the legend, in pixels.
    pub(super) fn compute_layout(
        &self,
        scale: &ColourScale,
        top: f64,
        legend_height: f64,
    ) -> FieldLayout {
        let below = (page::BOTTOM_AXIS_HEIGHT + 22.0 + legend_height + MARGIN - 12.0).ceil();
        let max_height = page::height().max(top + page::scale_height(480.0) + below) - top - below;
        let [x, y] = [&self.x, &self.y].map(|axis| (axis.end - axis.start).abs());
        let ratio = x / y;
        let content_width = page::width() - 2.0 * MARGIN;
        let about = (content_width / ratio).min(max_height).max(MIN_FRAME_LENGTH);
        let axis = page::left_axis_width(&Self::axis_ticks(&self.y, about, true));
        let wide = content_width - axis - TICK_LABEL_MARGIN;
        let has_bar = scale.limit > 0.0;
        let bar_width = if has_bar {
            let (ticks, _) = self.bar_ticks(scale, max_height, true);
            BAR_GAP + BAR_WIDTH + 14.0 + page::max_label_width(&ticks) + 12.0 + AXIS_NAME_SIZE
        } else {
            0.0
        };
        let under =
            if has_bar { LOWER_BAR_GAP + BAR_WIDTH + page::BOTTOM_AXIS_HEIGHT } else { 0.0 };
        let fitted =
            |width: f64, height: f64| [width.min(height * ratio), height.min(width / ratio)];
        let (upright, lying) =
            (fitted(wide - bar_width, max_height), fitted(wide, max_height - under));
        let is_bar_vertical = !has_bar || upright[0] >= lying[0];
        let [true_width, true_height] = if is_bar_vertical { upright } else { lying };
        let width = true_width.max(MIN_FRAME_LENGTH).floor();
        let height = true_height.max(MIN_FRAME_LENGTH).floor();

        let has_names = self.marks.iter().any(|mark| !mark.name.is_empty());
        let margin_above = match () {
            () if has_names && height < MIN_LENGTH_FOR_NAMES => NAME_MARGIN_ABOVE,
            () if self.has_names_above() => UPPER_NAME_MARGIN,
            () => 0.0,
        };
        let margin_beside =
            if has_names && width < MIN_LENGTH_FOR_NAMES { NAME_MARGIN_RIGHT } else { 0.0 };
        let is_y_name_above =
            height < 400.0 && text_width(&self.y.label, AXIS_NAME_SIZE, false) + 180.0 > height;
        let over =
            if is_y_name_above { margin_above.max(1.5 * AXIS_NAME_SIZE) } else { margin_above };
        let group = axis
            + width
            + margin_beside
            + if is_bar_vertical { bar_width } else { TICK_LABEL_MARGIN };
        let left = MARGIN + 0.5 * (content_width - group).max(0.0) + axis;
        let (left, top) = (left.round(), top + over.ceil());
        let frame = Rectangle { left, top, right: left + width, bottom: top + height };
        let bar = if is_bar_vertical {
            let left = frame.right + margin_beside + BAR_GAP;
            Rectangle { left, right: left + BAR_WIDTH, ..frame }
        } else {
            let top = frame.bottom + page::BOTTOM_AXIS_HEIGHT + LOWER_BAR_GAP;
            Rectangle { top, bottom: top + BAR_WIDTH, ..frame }
        };
        let end = frame.bottom + if is_bar_vertical { 0.0 } else { under };
        FieldLayout {
            height: (end + below).ceil(),
            frame,
            stretch: [width / true_width, height / true_height],
            bar_area: has_bar.then_some(bar),
            is_bar_vertical,
            is_y_name_above,
            name_area: Rectangle {
                top: frame.top - margin_above,
                right: frame.right + margin_beside,
                ..frame
            },
            legend_top: end + page::BOTTOM_AXIS_HEIGHT + 22.0,
        }
    }
}
