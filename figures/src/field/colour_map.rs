//! Colour map of a field: colour steps, limits and ticks.

use plotters::style::RGBColor;

use super::figure::FieldFigure;
use crate::colour::{SEQUENTIAL_STOPS, interpolate_stops};
use crate::page::{self, TICK_LABEL_SIZE};
use crate::picture::{Colour, text_width};
use crate::scale::{self, FINITE_LIMIT, Tick, format_number};

/// Number of colour steps on either side of zero.
pub(super) const SHADE_COUNT: i16 = 96;
/// Colour step of a value that is not a finite number.
pub(super) const NON_FINITE_STEP: i16 = i16::MIN;
pub(super) const NON_FINITE_COLOUR: Colour = RGBColor(150, 205, 120);
pub(super) const NON_FINITE_HATCH_COLOUR: Colour = RGBColor(0, 75, 40);

/// Colour stops of positive values, from zero to the largest magnitude; luminances nearly equal those of
/// [`NEGATIVE_STOPS`].
pub(super) const POSITIVE_STOPS: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [253.0, 206.0, 183.0],
    [242.0, 152.0, 116.0],
    [212.0, 92.0, 74.0],
    [170.0, 28.0, 44.0],
    [92.0, 2.0, 26.0],
];
/// Colour stops of negative values, from zero to the largest magnitude.
pub(super) const NEGATIVE_STOPS: [[f64; 3]; 6] = [
    [252.0, 252.0, 252.0],
    [188.0, 227.0, 246.0],
    [129.0, 190.0, 222.0],
    [66.0, 142.0, 196.0],
    [30.0, 78.0, 150.0],
    [7.0, 33.0, 88.0],
];

/// Relative magnitude, with respect to the largest value, below which negative values are regarded as round-off.
const ROUND_OFF_TOLERANCE: f64 = 1e-9;

/// Colour scale of a field.
#[derive(Clone)]
pub(crate) struct ColourScale {
    pub(super) is_signed: bool,
    /// Whether colours follow the square root of the magnitude.
    pub(super) is_root: bool,
    /// Whether the scale is shared with other figures, i.e. does not follow from the values of this figure.
    pub(super) is_fixed: bool,
    /// Magnitude of the darkest colour; 0 if the scale is not fixed and no finite value differs from 0.
    pub(super) limit: f64,
    /// Finite value of largest magnitude; 0 if there is none.
    pub(super) extreme_value: f64,
    /// Number of cells with values outside the limits of the scale.
    pub(super) clipped_count: usize,
    /// Whether values are clipped at the lower and at the upper limit, so that their colours also stand for these
    /// values.
    pub(super) has_clipped_values: [bool; 2],
    /// Number of cells without a finite value.
    pub(super) non_finite_count: usize,
}

impl ColourScale {
    pub(super) fn from_figure(figure: &FieldFigure) -> Self {
        let finite = || figure.values.iter().copied().filter(|value| value.abs() < FINITE_LIMIT);
        let coloured = figure.coloured_values().filter(|value| value.abs() < FINITE_LIMIT);
        let mut extreme_value = 0.0_f64;
        let mut lowest = 0.0_f64;
        for value in finite().chain(coloured) {
            if value.abs() > extreme_value.abs() {
                extreme_value = value;
            }
            lowest = lowest.min(value);
        }
        let is_negative = lowest < -ROUND_OFF_TOLERANCE * extreme_value.abs();
        let (is_fixed, is_signed, limit) = match figure.fixed_limit {
            Some(limit) => (true, figure.is_signed, limit),
            None => {
                let limit = figure
                    .limit
                    .map_or(extreme_value.abs(), |limit| limit.min(extreme_value.abs()));
                (false, figure.is_signed || is_negative, limit)
            }
        };
        let is_below = is_negative && !is_signed;
        let low = match () {
            () if is_signed => -limit,
            () if is_below => 0.0,
            () => f64::NEG_INFINITY,
        };
        let clipped_count = finite().filter(|value| *value > limit || *value < low).count();
        let is_open = clipped_count > 0 || is_fixed;
        Self {
            is_signed,
            is_root: figure.is_root_scaled,
            is_fixed,
            limit,
            extreme_value,
            clipped_count,
            has_clipped_values: [is_below || (is_signed && is_open), is_open],
            non_finite_count: figure.values.len() - finite().count(),
        }
    }

    /// Returns the scale for figures whose values are all within its limits.
    pub(super) fn without_values_beyond(self) -> Self {
        Self { is_fixed: false, has_clipped_values: [false; 2], ..self }
    }

    /// Returns all colours that cells of figures with this scale may have.
    pub fn all_colours(&self) -> Vec<Colour> {
        let first = if self.is_signed { -SHADE_COUNT } else { 0 };
        let steps = (first..=SHADE_COUNT).map(|step| self.step_colour(step));
        steps.chain([NON_FINITE_COLOUR, NON_FINITE_HATCH_COLOUR]).collect()
    }

    /// Returns the colour step of a value.
    pub(super) fn colour_step(&self, value: f64) -> i16 {
        if value.is_nan() {
            return NON_FINITE_STEP;
        }
        if self.limit == 0.0 {
            return 0;
        }
        let low = if self.is_signed { -1.0 } else { 0.0 };
        (self.scaled_share(value).clamp(low, 1.0) * f64::from(SHADE_COUNT)).round() as i16
    }

    pub(super) fn step_colour(&self, step: i16) -> Colour {
        if step == NON_FINITE_STEP {
            return NON_FINITE_COLOUR;
        }
        let stops: &[[f64; 3]] = match (self.is_signed, step < 0) {
            (false, _) => &SEQUENTIAL_STOPS,
            (true, false) => &POSITIVE_STOPS,
            (true, true) => &NEGATIVE_STOPS,
        };
        interpolate_stops(stops, f64::from(step.abs()) / f64::from(SHADE_COUNT))
    }

    pub(super) fn lower_limit(&self) -> f64 {
        if self.is_signed { -self.limit } else { 0.0 }
    }

    /// Returns the position of a value on the colour bar, as a fraction of its length.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        let share = self.scaled_share(value);
        if self.is_signed { 0.5 + 0.5 * share } else { share }
    }

    /// Returns the ratio of a value to the limit, with the square root of the magnitude on a root scale.
    fn scaled_share(&self, value: f64) -> f64 {
        let share = value / self.limit;
        if self.is_root { share.abs().sqrt().copysign(share) } else { share }
    }

    /// Computes the ticks of a colour bar of `length` pixels. The label of an upper limit with values beyond it begins
    /// with ≥, of a lower limit with ≤. Returns the ticks and the text of their common factor, which is empty if there is
    /// none.
    pub(super) fn ticks(
        &self,
        length: f64,
        is_vertical: bool,
        is_angle: bool,
    ) -> (Vec<Tick>, String) {
        if self.limit == 0.0 {
            return (Vec::new(), String::new());
        }
        let low = self.lower_limit();
        let (mut ticks, multiplier) =
            page::choose_ticks_with_multiplier(length, is_vertical, |max_count| {
                // On a root scale ticks are closer at the ends, by half at most.
                let max_count = if self.is_root { max_count.div_ceil(2) } else { max_count };
                match is_angle {
                    true => (scale::linear_ticks(low, self.limit, max_count, true), String::new()),
                    false => scale::linear_ticks_with_multiplier(low, self.limit, max_count),
                }
            });
        let unit = match multiplier.is_empty() {
            true => 1.0,
            false => 10_f64.powi(scale::common_exponent(ticks.iter().map(|(value, _)| *value))),
        };
        let end_label = |value: f64| format_number(value / unit);
        let mut ends = Vec::new();
        if self.has_clipped_values[1] {
            ends.push((self.limit, format!("≥ {}", end_label(self.limit))));
            if self.has_clipped_values[0] {
                ends.push((low, format!("≤ {}", end_label(low))));
            }
        } else if ticks.len() < 2 {
            ends.push((self.limit, end_label(self.limit)));
        }
        let apart = |(value, label): &Tick| {
            ends.iter().all(|(end, label_text)| {
                let min_distance = if is_vertical {
                    1.4 * TICK_LABEL_SIZE
                } else {
                    let widths =
                        [label, label_text].map(|text| text_width(text, TICK_LABEL_SIZE, false));
                    0.5 * (widths[0] + widths[1]) + 0.6 * TICK_LABEL_SIZE
                };
                (self.fraction(*value) - self.fraction(*end)).abs() * length >= min_distance
            })
        };
        ticks.retain(apart);
        ticks.extend(ends);
        (ticks, multiplier)
    }
}
