//! Distances of the colours of figures for readers with full colour vision, with red-green blindness, and in greyscale.

use super::{CURVE_COLOURS, SEQUENTIAL_STOPS, interpolate_stops};
use crate::growth::LINE_STYLES;
use crate::picture::Colour;
use crate::verdict_map::{FillStyle, Hatching, category_fill};
use plotters::style::RGBColor;

/// Maps of linear red, green and blue to those of another vision (Machado, Oliveira and Fernandes 2009, severity 1).
type Vision = [[f64; 3]; 3];
const FULL_VISION: Vision = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
const PROTANOPIA: Vision = [
    [0.152286, 1.052583, -0.204868],
    [0.114503, 0.786281, 0.099216],
    [-0.003882, -0.048116, 1.051998],
];
const DEUTERANOPIA: Vision = [
    [0.367322, 0.860646, -0.227968],
    [0.280085, 0.672501, 0.047413],
    [-0.011820, 0.042940, 0.968881],
];
/// Luminance (ITU-R Rec. 709), as greyscale prints show it.
const GREYSCALE: Vision = [[0.2126, 0.7152, 0.0722]; 3];

/// Just noticeable distance of two adjacent colours in CIE 1976 L*a*b* (Mahy, Van Eycken and Oosterlinck 1994).
const NOTICEABLE_DISTANCE: f64 = 2.3;

/// Converts a colour of sRGB (IEC 61966-2-1) to CIE 1976 L*a*b* with the white of D65, as seen with a vision.
fn to_lab(RGBColor(red, green, blue): Colour, vision: &Vision) -> [f64; 3] {
    let linear = [red, green, blue].map(|value| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    });
    let product =
        |row: &[f64; 3], of: &[f64; 3]| -> f64 { row.iter().zip(of).map(|(a, b)| a * b).sum() };
    let seen = vision.map(|row| product(&row, &linear).clamp(0.0, 1.0));
    let to_xyz = [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ];
    let white = to_xyz.map(|row| row.iter().sum::<f64>());
    let [x, y, z] = [0, 1, 2].map(|axis| {
        let share = product(&to_xyz[axis], &seen) / white[axis];
        let edge = 6.0_f64 / 29.0;
        if share > edge.powi(3) { share.cbrt() } else { share / (3.0 * edge * edge) + 4.0 / 29.0 }
    });
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn distance(first: Colour, second: Colour, vision: &Vision) -> f64 {
    let [a, b] = [first, second].map(|colour| to_lab(colour, vision));
    a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Compares with the published coordinates of the primary colours of sRGB.
#[test]
fn lab_coordinates_are_those_of_the_primary_colours() {
    let published = [
        (RGBColor(255, 255, 255), [100.0, 0.0, 0.0]),
        (RGBColor(255, 0, 0), [53.24, 80.09, 67.20]),
        (RGBColor(0, 255, 0), [87.74, -86.18, 83.18]),
        (RGBColor(0, 0, 255), [32.30, 79.19, -107.86]),
    ];
    for (colour, expected) in published {
        let found = to_lab(colour, &FULL_VISION);
        let error = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 0.02, "{colour:?} {found:?}");
    }
    // Grey is the same for all.
    for vision in [PROTANOPIA, DEUTERANOPIA, GREYSCALE] {
        let seen = to_lab(RGBColor(120, 120, 120), &vision);
        let own = to_lab(RGBColor(120, 120, 120), &FULL_VISION);
        assert!(seen.iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-3));
    }
    // Red and a dark green are confused without green receptors, not otherwise.
    let confused = [RGBColor(170, 60, 0), RGBColor(90, 100, 0)];
    let [full, deuteranopia] =
        [FULL_VISION, DEUTERANOPIA].map(|vision| distance(confused[0], confused[1], &vision));
    assert!(deuteranopia < 0.3 * full, "{deuteranopia} {full}");
}

#[test]
fn curves_differ_with_and_without_colour_vision() {
    for (index, first) in CURVE_COLOURS.iter().enumerate() {
        for second in &CURVE_COLOURS[..index] {
            for vision in [FULL_VISION, PROTANOPIA, DEUTERANOPIA] {
                let found = distance(*first, *second, &vision);
                assert!(found > 3.0 * NOTICEABLE_DISTANCE, "{first:?} {second:?} {found}");
            }
        }
    }
    for (index, first) in LINE_STYLES.iter().enumerate() {
        for second in &LINE_STYLES[..index] {
            let is_other_line = first.dashes != second.dashes
                || (first.width - second.width).abs() >= 0.3 * first.width.max(second.width);
            assert!(is_other_line, "{:?} {:?}", first.colour, second.colour);
        }
    }
}

#[test]
fn adjacent_fills_of_maps_differ_in_hatching_or_lightness() {
    let ill_posed = [
        Hatching::Plain,
        Hatching::Rising,
        Hatching::Falling,
        Hatching::Horizontal,
        Hatching::Vertical,
        Hatching::Grid,
    ];
    let mut styles = vec![
        FillStyle::WellPosed,
        FillStyle::UnboundedAtFiniteWaveNumber,
        FillStyle::Marginal,
        FillStyle::Indeterminate,
        FillStyle::OutsideModel,
    ];
    styles.extend(ill_posed.map(FillStyle::IllPosed));
    for (index, first) in styles.iter().enumerate() {
        for second in &styles[..index] {
            let [(ground, lines), (other_ground, other_lines)] =
                [*first, *second].map(category_fill);
            let directions = |lines: &[crate::verdict_map::HatchLines]| -> Vec<[f64; 2]> {
                lines.iter().map(|own| own.direction).collect()
            };
            if directions(&lines) != directions(&other_lines) {
                continue;
            }
            for vision in [FULL_VISION, PROTANOPIA, DEUTERANOPIA, GREYSCALE] {
                let found = distance(ground, other_ground, &vision);
                assert!(found > 3.0 * NOTICEABLE_DISTANCE, "{first:?} {second:?} {found}");
            }
        }
    }
}

/// Verifies that larger values are darker for all readers, so that the order of shades needs no colours.
#[test]
fn shades_are_ordered_by_lightness() {
    for vision in [FULL_VISION, PROTANOPIA, DEUTERANOPIA, GREYSCALE] {
        let lightness: Vec<f64> = (0..=24)
            .map(|step| {
                to_lab(interpolate_stops(&SEQUENTIAL_STOPS, f64::from(step) / 24.0), &vision)[0]
            })
            .collect();
        assert!(lightness.windows(2).all(|pair| pair[0] > pair[1] + 1.0), "{lightness:?}");
    }
}
