//! Colours of curves, sequential colour map of fields and verdict maps, interpolation of colour maps, and luminance.

use plotters::style::RGBColor;

use crate::picture::Colour;

/// Stops of the sequential colour map (red, green and blue, from 0 to 255), from zero to the largest value; luminance
/// decreases from stop to stop.
pub(crate) const SEQUENTIAL_STOPS: [[f64; 3]; 7] = [
    [253.0, 252.0, 248.0],
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];

/// Colours of curves, after Okabe and Ito (2008), darkened for lines: any two differ for readers with and without red-green
/// blindness. In greyscale, dash patterns or numbers distinguish the curves.
pub(crate) const CURVE_COLOURS: [Colour; 8] = [
    RGBColor(0, 0, 0),
    RGBColor(213, 94, 0),
    RGBColor(0, 114, 178),
    RGBColor(0, 138, 100),
    RGBColor(176, 80, 140),
    RGBColor(75, 45, 165),
    RGBColor(70, 150, 205),
    RGBColor(112, 112, 112),
];

/// Interpolates the colour at a fraction (0 to 1) of the length of a colour map with equidistant stops.
pub(crate) fn interpolate_stops(stops: &[[f64; 3]], fraction: f64) -> Colour {
    let position = fraction * (stops.len() - 1) as f64;
    let below = (position as usize).min(stops.len() - 2);
    let mix = |channel: usize| {
        let (from, to) = (stops[below][channel], stops[below + 1][channel]);
        (from + (position - below as f64) * (to - from)).round() as u8
    };
    RGBColor(mix(0), mix(1), mix(2))
}

/// Computes the luma of a colour, from 0 to 255 (ITU-R Rec. 601).
pub(crate) fn luminance(RGBColor(red, green, blue): Colour) -> f64 {
    0.299 * f64::from(red) + 0.587 * f64::from(green) + 0.114 * f64::from(blue)
}

#[cfg(test)]
mod tests;
