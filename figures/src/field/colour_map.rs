//! Colour map of a field: colour steps, limits and ticks.

use plotters::style::RGBColor;

use super::figure::{FINITE, FieldFigure};
use crate::page::{self, NUMBER};
use crate::picture::{Colour, text_width};
use crate::scale::{self, Tick, plain};

/// Number of colour steps on either side of zero.
pub(super) const SHADES: i16 = 96;
/// Colour step of a value that is not a finite number.
pub(super) const UNKNOWN: i16 = i16::MIN;
pub(super) const UNKNOWN_GROUND: Colour = RGBColor(150, 205, 120);
pub(super) const UNKNOWN_HATCH: Colour = RGBColor(0, 75, 40);

/// Sequential colour map for unsigned quantities, from zero to the maximum; luminance decreases uniformly.
const SEQUENTIAL: [[f64; 3]; 7] = [
    [253.0, 252.0, 248.0],
    [253.0, 211.0, 150.0],
    [250.0, 164.0, 91.0],
    [233.0, 104.0, 63.0],
    [192.0, 46.0, 62.0],
    [122.0, 18.0, 66.0],
    [58.0, 6.0, 52.0],
];
/// Diverging colour maps from zero to the largest positive and negative magnitude, with equal luminance at
/// corresponding stops.
pub(super) const POSITIVE: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [253.0, 206.0, 183.0],
    [242.0, 152.0, 116.0],
    [212.0, 92.0, 74.0],
    [170.0, 28.0, 44.0],
    [92.0, 2.0, 26.0],
];
pub(super) const NEGATIVE: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [188.0, 227.0, 246.0],
    [129.0, 190.0, 222.0],
    [66.0, 142.0, 196.0],
    [30.0, 78.0, 150.0],
    [7.0, 33.0, 88.0],
];

/// Relative magnitude, with respect to the largest value, below which negative values are regarded as round-off.
const ROUND_OFF: f64 = 1e-9;

/// Colour scale of a field.
#[derive(Clone)]
pub(crate) struct Scale {
    pub(super) is_signed: bool,
    /// Whether the scale is shared with other figures, i.e. does not follow from the values of this figure.
    pub(super) is_fixed: bool,
    /// Magnitude of the darkest colour; 0 if all values are 0.
    pub(super) end: f64,
    /// Value of largest magnitude.
    pub(super) extreme: f64,
    /// Number of cells beyond the limits of the scale.
    pub(super) clipped: usize,
    /// Whether the colours at the lower and upper limit also stand for values beyond.
    pub(super) open: [bool; 2],
    /// Number of cells without a finite value.
    pub(super) unknown: usize,
}

impl Scale {
    pub(super) fn of(figure: &FieldFigure) -> Self {
        let finite = || figure.values.iter().copied().filter(|value| value.abs() < FINITE);
        let mut extreme = 0.0_f64;
        let mut lowest = 0.0_f64;
        for value in finite() {
            if value.abs() > extreme.abs() {
                extreme = value;
            }
            lowest = lowest.min(value);
        }
        let is_negative = lowest < -ROUND_OFF * extreme.abs();
        let (is_fixed, is_signed, end) = match figure.scale {
            Some(end) => (true, figure.is_signed, end),
            None => {
                let end = figure.limit.map_or(extreme.abs(), |limit| limit.min(extreme.abs()));
                (false, figure.is_signed || is_negative, end)
            }
        };
        let is_below = is_negative && !is_signed;
        let low = match () {
            () if is_signed => -end,
            () if is_below => 0.0,
            () => f64::NEG_INFINITY,
        };
        let clipped = finite().filter(|value| *value > end || *value < low).count();
        let is_open = clipped > 0 || is_fixed;
        Self {
            is_signed,
            is_fixed,
            end,
            extreme,
            clipped,
            open: [is_below || (is_signed && is_open), is_open],
            unknown: figure.values.len() - finite().count(),
        }
    }

    /// Returns all colours that cells of figures with this scale may have.
    pub fn colours(&self) -> Vec<Colour> {
        let first = if self.is_signed { -SHADES } else { 0 };
        let steps = (first..=SHADES).map(|step| self.colour(step));
        steps.chain([UNKNOWN_GROUND, UNKNOWN_HATCH]).collect()
    }

    /// Returns the colour step of a value.
    pub(super) fn step(&self, value: f64) -> i16 {
        if value.is_nan() {
            return UNKNOWN;
        }
        if self.end == 0.0 {
            return 0;
        }
        let low = if self.is_signed { -1.0 } else { 0.0 };
        ((value / self.end).clamp(low, 1.0) * f64::from(SHADES)).round() as i16
    }

    pub(super) fn colour(&self, step: i16) -> Colour {
        if step == UNKNOWN {
            return UNKNOWN_GROUND;
        }
        let stops: &[[f64; 3]] = match (self.is_signed, step < 0) {
            (false, _) => &SEQUENTIAL,
            (true, false) => &POSITIVE,
            (true, true) => &NEGATIVE,
        };
        let place = f64::from(step.abs()) / f64::from(SHADES) * (stops.len() - 1) as f64;
        let below = (place as usize).min(stops.len() - 2);
        let mix = |channel: usize| {
            let (from, to) = (stops[below][channel], stops[below + 1][channel]);
            (from + (place - below as f64) * (to - from)).round() as u8
        };
        RGBColor(mix(0), mix(1), mix(2))
    }

    pub(super) fn low(&self) -> f64 {
        if self.is_signed { -self.end } else { 0.0 }
    }

    /// Returns the position of a value on the colour bar, as a share of its length.
    pub(super) fn share(&self, value: f64) -> f64 {
        if self.is_signed { 0.5 + 0.5 * (value / self.end) } else { value / self.end }
    }

    /// Computes the ticks of a colour bar of `length` pixels. At limits with values beyond the labels are ≥ and ≤.
    pub(super) fn ticks(&self, length: f64, upright: bool, degrees: bool) -> Vec<Tick> {
        if self.end == 0.0 {
            return Vec::new();
        }
        let low = self.low();
        let mut ticks =
            page::spaced(length, upright, |most| scale::ticks(low, self.end, most, degrees));
        let mut ends = Vec::new();
        if self.open[1] {
            ends.push((self.end, format!("≥ {}", plain(self.end))));
            if self.open[0] {
                ends.push((low, format!("≤ {}", plain(low))));
            }
        } else if ticks.len() < 2 {
            ends.push((self.end, plain(self.end)));
        }
        let apart = |(value, label): &Tick| {
            ends.iter().all(|(end, words)| {
                let room = if upright {
                    1.4 * NUMBER
                } else {
                    let widths = [label, words].map(|text| text_width(text, NUMBER, false));
                    0.5 * (widths[0] + widths[1]) + 0.6 * NUMBER
                };
                (self.share(*value) - self.share(*end)).abs() * length >= room
            })
        };
        ticks.retain(apart);
        ticks.extend(ends);
        ticks
    }
}
