//! Palette of an animated GIF.

use crate::picture::{Colour, INK, WHITE};
use plotters::style::RGBColor;
use std::collections::HashMap;

/// Maximum number of colours of a GIF palette.
const MAX_COLOURS: usize = 256;
/// Number of shades between ink and paper, used for the antialiased edges of letters and lines.
const GREY_COUNT: u8 = 24;
/// Shares of ink in the mixtures of ink and colours of the frames, used for antialiased edges on the field.
const INK_SHARES: [f64; 2] = [0.35, 0.7];

/// Palette of an animation, with a cache of the nearest palette colour of each other colour.
pub(super) struct Palette {
    colours: Vec<[u8; 3]>,
    nearest_index: HashMap<[u8; 3], u8>,
}

impl Palette {
    /// Builds the palette: shades of ink on paper, the colours of a field or of curves and, within the remaining
    /// capacity, mixtures of these colours with ink.
    pub(super) fn new(field: &[Colour]) -> Self {
        let channels = |RGBColor(red, green, blue): Colour| [red, green, blue];
        let mixed = |from: Colour, to: Colour, share: f64| {
            let (from, to) = (channels(from), channels(to));
            [0, 1, 2].map(|part| {
                let (from, to) = (f64::from(from[part]), f64::from(to[part]));
                (from + share * (to - from)).round() as u8
            })
        };
        let mut colours: Vec<[u8; 3]> = Vec::new();
        let mut add = |colour: [u8; 3]| {
            if colours.len() < MAX_COLOURS && !colours.contains(&colour) {
                colours.push(colour);
            }
        };
        for step in 0..GREY_COUNT {
            add(mixed(INK, WHITE, f64::from(step) / f64::from(GREY_COUNT - 1)));
        }
        field.iter().for_each(|colour| add(channels(*colour)));
        let mixture_capacity =
            MAX_COLOURS.saturating_sub(GREY_COUNT.into()).saturating_sub(field.len());
        let every = (INK_SHARES.len() * field.len()).div_ceil(mixture_capacity.max(1)).max(1);
        for colour in field.iter().skip(every / 2).step_by(every) {
            for share in INK_SHARES {
                add(mixed(*colour, INK, share));
            }
        }
        Self { colours, nearest_index: HashMap::new() }
    }

    pub(super) fn to_bytes(&self) -> Vec<u8> {
        self.colours.concat()
    }

    /// Returns the palette index of the nearest colour for each pixel.
    pub(super) fn index_pixels(&mut self, pixels: &[u8]) -> Vec<u8> {
        let Self { colours, nearest_index } = self;
        let pixels = pixels.chunks_exact(3).map(|pixel| [pixel[0], pixel[1], pixel[2]]);
        let index = |pixel: [u8; 3]| {
            let distance = |colour: &[u8; 3]| -> i32 {
                let parts = colour.iter().zip(pixel).zip([3, 5, 2]);
                parts.map(|((a, b), weight)| weight * (i32::from(*a) - i32::from(b)).pow(2)).sum()
            };
            let nearest = colours.iter().enumerate().min_by_key(|(_, colour)| distance(colour));
            nearest.map_or(0, |(index, _)| index as u8)
        };
        pixels.map(|pixel| *nearest_index.entry(pixel).or_insert_with(|| index(pixel))).collect()
    }
}
