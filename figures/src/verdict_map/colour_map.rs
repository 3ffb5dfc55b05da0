//! Colour map of growth levels, and dimensions of its colour bar.

use plotters::style::RGBColor;

use crate::colour::{SEQUENTIAL_STOPS, interpolate_stops, luminance};
use crate::picture::{Colour, Picture, Rectangle, WHITE};

/// Number of colour steps: few enough that equal neighbouring cells merge, too many for steps to be visible.
pub(super) const SHADE_COUNT: usize = 128;

/// Colour of an infinite level; darker than the darkest shade.
pub(super) const INFINITE_LEVEL_COLOUR: Colour = RGBColor(14, 2, 22);
/// Colour of a cell without level in a map with levels.
pub(crate) const MISSING_LEVEL_COLOUR: Colour = RGBColor(196, 176, 180);
/// Width of the dark rim of lines that stand for sets without area, pixels.
pub(super) const LINE_SET_RIM: f64 = 1.8;
/// Colour of ill-posed cells in a map without levels.
pub(super) const ILL_POSED_COLOUR: Colour = RGBColor(236, 130, 80);

/// Returns the colour at a fraction of the length of the colour map.
pub(crate) fn shade_colour(fraction: f64) -> Colour {
    let step =
        (fraction.clamp(0.0, 1.0) * (SHADE_COUNT - 1) as f64).round() / (SHADE_COUNT - 1) as f64;
    // The first stop is almost white, as well-posed cells are.
    interpolate_stops(&SEQUENTIAL_STOPS[1..], step)
}

/// Distance of the colour bar from the map, pixels.
pub(crate) const BAR_GAP: f64 = 34.0;
/// Width of the colour bar, pixels.
pub(crate) const BAR_WIDTH: f64 = 36.0;
/// Length of the arrows at the ends of the colour bar, pixels.
pub(crate) const ARROW_LENGTH: f64 = 30.0;

/// Returns the colour of lines on a shade, for contrast.
pub(crate) fn contrast_colour(fraction: f64) -> Colour {
    let ground = shade_colour(fraction);
    if luminance(ground) > 95.0 { RGBColor(70, 25, 20) } else { WHITE }
}

/// Draws the colour map, with its low end on the left (`is_horizontal`) or at the bottom.
pub(crate) fn draw_shades(
    picture: &mut Picture,
    area: Rectangle,
    is_horizontal: bool,
    is_dark_low: bool,
) {
    for step in 0..SHADE_COUNT {
        let [from, to] = [step, step + 1].map(|step| step as f64 / SHADE_COUNT as f64);
        let part = if is_horizontal {
            let left = area.left + from * area.width();
            let right = (area.left + to * area.width() + 2.0).min(area.right);
            Rectangle { left, right, ..area }
        } else {
            let top = (area.bottom - to * area.height() - 2.0).max(area.top);
            Rectangle { top, bottom: area.bottom - from * area.height(), ..area }
        };
        let share = step as f64 / (SHADE_COUNT - 1) as f64;
        picture.fill_rectangle(part, shade_colour(if is_dark_low { 1.0 - share } else { share }));
    }
}
