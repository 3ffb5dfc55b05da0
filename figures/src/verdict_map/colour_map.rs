//! Colour map of growth levels, and dimensions of its colour bar.

use plotters::style::RGBColor;

use crate::picture::{Colour, Picture, Rectangle, WHITE};

/// Number of colour steps: few enough that equal neighbouring cells merge, too many for steps to be visible.
pub(super) const SHADES: usize = 128;

/// Stops of the colour map; luminance decreases uniformly.
const STOPS: [[f64; 3]; 6] = [
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];

/// Colour of an infinite level; darker than the darkest shade.
pub(super) const INFINITE: Colour = RGBColor(14, 2, 22);
/// Colour of a cell without level in a map with levels.
pub(crate) const LEVEL_MISSING: Colour = RGBColor(196, 176, 180);
/// Colour of ill-posed cells in a map without levels.
pub(super) const NO_LEVELS: Colour = RGBColor(236, 130, 80);

/// Returns the colour at a share of the length of the colour map.
pub(crate) fn shade(share: f64) -> Colour {
    let step = (share.clamp(0.0, 1.0) * (SHADES - 1) as f64).round() / (SHADES - 1) as f64;
    let place = step * (STOPS.len() - 1) as f64;
    let below = (place as usize).min(STOPS.len() - 2);
    let mix = |channel: usize| {
        let (from, to) = (STOPS[below][channel], STOPS[below + 1][channel]);
        (from + (place - below as f64) * (to - from)).round() as u8
    };
    RGBColor(mix(0), mix(1), mix(2))
}

/// Computes the luma of a colour, from 0 to 255 (ITU-R Rec. 601).
pub(crate) fn luminance(RGBColor(red, green, blue): Colour) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

/// Distance of the colour bar from the map, width of the bar, and length of its arrows, pixels.
pub(crate) const BAR_GAP: f64 = 34.0;
pub(crate) const BAR: f64 = 36.0;
pub(crate) const ARROW: f64 = 30.0;

/// Returns the colour of lines on a shade, for contrast.
pub(crate) fn colour_on_shade(share: f64) -> Colour {
    let ground = shade(share);
    if luminance(ground) > 95.0 { RGBColor(70, 25, 20) } else { WHITE }
}

/// Draws the colour map, with its low end on the left (`lying`) or at the bottom.
pub(crate) fn draw_shades(picture: &mut Picture, area: Rectangle, lying: bool, dark_is_low: bool) {
    for step in 0..SHADES {
        let [from, to] = [step, step + 1].map(|step| step as f64 / SHADES as f64);
        let part = if lying {
            let left = area.left + from * area.width();
            let right = (area.left + to * area.width() + 2.0).min(area.right);
            Rectangle { left, right, ..area }
        } else {
            let top = (area.bottom - to * area.height() - 2.0).max(area.top);
            Rectangle { top, bottom: area.bottom - from * area.height(), ..area }
        };
        let share = step as f64 / (SHADES - 1) as f64;
        picture.fill(part, shade(if dark_is_low { 1.0 - share } else { share }));
    }
}
