//! The colour map of growth levels, and the sizes of its bar.

use plotters::style::RGBColor;

use crate::picture::{Colour, Picture, Rectangle, WHITE};

/// Steps of the colour map. Few enough that equal neighbours merge, too many to be seen.
pub(super) const SHADES: usize = 128;

/// Lightness falls evenly from one stop to the next.
const STOPS: [[f64; 3]; 6] = [
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];

/// For a level without bound; below the darkest shade.
pub(super) const INFINITE: Colour = RGBColor(14, 2, 22);
/// For a cell without level among others that have one.
pub(crate) const LEVEL_MISSING: Colour = RGBColor(196, 176, 180);
/// For all ill-posed cells of a map without levels.
pub(super) const NO_LEVELS: Colour = RGBColor(236, 130, 80);

/// A colour of the colour map at a share of its length.
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

/// Luma of a colour, from 0 to 255 (Rec. 601).
pub(crate) fn luminance(RGBColor(red, green, blue): Colour) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

/// Distance of the colour bar from the map, its width, and the length of its arrows.
pub(crate) const BAR_GAP: f64 = 34.0;
pub(crate) const BAR: f64 = 36.0;
pub(crate) const ARROW: f64 = 30.0;

/// The colour of lines on a shade.
pub(crate) fn colour_on_shade(share: f64) -> Colour {
    let ground = shade(share);
    if luminance(ground) > 95.0 { RGBColor(70, 25, 20) } else { WHITE }
}

/// Draws the colour map, from its low end on the left or below.
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
