//! Axes of the map, from the first to the last of the uniformly spaced points.

use super::figure::VerdictMapAxis;
use crate::error::FigureError;
use crate::page::{self};
use crate::scale::{self, Tick};

/// Extent of an axis: from the first to the last point; cells are centred at their points. Positions on a logarithmic
/// axis are log₁₀ of the values.
pub(super) struct AxisExtent {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) is_descending: bool,
    is_log: bool,
}

impl AxisExtent {
    pub(super) fn from_axis(axis: &VerdictMapAxis) -> Result<Self, FigureError> {
        let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
        let is_log = axis.is_log;
        if axis.values.iter().any(|value| !value.is_finite()) {
            return Err(refuse("has a point that is not a finite number"));
        }
        if is_log && axis.values.iter().any(|value| *value <= 0.0) {
            return Err(refuse("is logarithmic and has a point that is not positive"));
        }
        let positions: Vec<f64> =
            axis.values.iter().map(|&value| to_position(value, is_log)).collect();
        let (Some(&first), Some(&last)) = (positions.first(), positions.last()) else {
            return Err(refuse("has no points"));
        };
        if positions.len() == 1 {
            // The width of a single cell is arbitrary.
            let half = if is_log { 0.5 } else { 0.5 * first.abs().max(1.0) };
            return Ok(Self {
                low: first - half,
                high: first + half,
                is_descending: false,
                is_log,
            });
        }
        let step = (last - first) / (positions.len() - 1) as f64;
        if !(step.is_finite() && step != 0.0) {
            return Err(refuse("does not extend from a first to a different last value"));
        }
        let uniform = |(index, position): (usize, &f64)| {
            (position - (first + step * index as f64)).abs() <= 1e-3 * step.abs()
        };
        if !positions.iter().enumerate().all(uniform) {
            return Err(refuse("is not uniformly spaced"));
        }
        let (low, high) = (first.min(last), first.max(last));
        Ok(Self { low, high, is_descending: step < 0.0, is_log })
    }

    /// Returns the position of a value as a fraction of the axis length.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        self.position_fraction(to_position(value, self.is_log))
    }

    fn position_fraction(&self, position: f64) -> f64 {
        (position - self.low) / (self.high - self.low)
    }

    /// Computes the ticks, located by their fraction of the axis length; `length` in pixels. A logarithmic axis has
    /// unlabelled ticks between decades.
    pub(super) fn ticks(&self, axis: &VerdictMapAxis, length: f64, is_vertical: bool) -> Vec<Tick> {
        if let [only] = axis.values[..] {
            return vec![(self.fraction(only), scale::format_number(only))];
        }
        let degrees = axis.label.contains('°');
        let mut ticks = page::choose_ticks(length, is_vertical, |max_count| match self.is_log {
            true => scale::log_ticks(self.low, self.high, max_count),
            false => scale::linear_ticks(self.low, self.high, max_count, degrees),
        });
        if self.is_log {
            ticks.extend(self.minor_ticks(&ticks));
        }
        ticks
            .into_iter()
            .map(|(position, label)| (self.position_fraction(position), label))
            .collect()
    }

    /// Computes the ticks at the multiples of powers of ten if there is a tick at every power of ten.
    fn minor_ticks(&self, decades: &[Tick]) -> Vec<Tick> {
        let is_each_decade = decades.len() > 2
            && decades.windows(2).all(|pair| (pair[1].0 - pair[0].0 - 1.0).abs() < 1e-9);
        let exponents = match is_each_decade {
            true => self.low.floor() as i32..self.high.ceil() as i32,
            false => 0..0,
        };
        let ticks = exponents.flat_map(|exponent| {
            (2..10).map(move |multiple| f64::from(exponent) + f64::from(multiple).log10())
        });
        let inside = ticks.filter(|position| (self.low..=self.high).contains(position));
        inside.map(|position| (position, String::new())).collect()
    }
}

fn to_position(value: f64, is_log: bool) -> f64 {
    if is_log { value.log10() } else { value }
}
