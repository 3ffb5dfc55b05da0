//! Axes of the map, from the first to the last of the uniformly spaced points.

use super::figure::VerdictMapAxis;
use crate::error::FigureError;
use crate::page::{self};
use crate::scale::{self, Tick};

/// Extent of an axis: from the first to the last point; cells are centred at their points.
pub(super) struct AxisExtent {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) is_descending: bool,
}

impl AxisExtent {
    pub(super) fn from_axis(axis: &VerdictMapAxis) -> Result<Self, FigureError> {
        let refuse = |problem| FigureError::Axis { label: axis.label.clone(), problem };
        let values = &axis.values;
        let (Some(&first), Some(&last)) = (values.first(), values.last()) else {
            return Err(refuse("has no points"));
        };
        if values.iter().any(|value| !value.is_finite()) {
            return Err(refuse("has a point that is not a finite number"));
        }
        if values.len() == 1 {
            // The width of a single cell is arbitrary.
            let half = 0.5 * first.abs().max(1.0);
            return Ok(Self { low: first - half, high: first + half, is_descending: false });
        }
        let step = (last - first) / (values.len() - 1) as f64;
        if !(step.is_finite() && step != 0.0) {
            return Err(refuse("does not extend from a first to a different last value"));
        }
        let uniform = |(index, value): (usize, &f64)| {
            (value - (first + step * index as f64)).abs() <= 1e-3 * step.abs()
        };
        if !values.iter().enumerate().all(uniform) {
            return Err(refuse("is not uniformly spaced"));
        }
        let (low, high) = (first.min(last), first.max(last));
        Ok(Self { low, high, is_descending: step < 0.0 })
    }

    /// Returns the position of a value as a fraction of the axis length.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        (value - self.low) / (self.high - self.low)
    }

    pub(super) fn ticks(&self, axis: &VerdictMapAxis, length: f64, is_vertical: bool) -> Vec<Tick> {
        if let [only] = axis.values[..] {
            return vec![(only, scale::format_number(only))];
        }
        let degrees = axis.label.contains('°');
        page::choose_ticks(length, is_vertical, |max_count| {
            scale::linear_ticks(self.low, self.high, max_count, degrees)
        })
    }
}
