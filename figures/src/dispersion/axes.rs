//! The axes of wave numbers, frequencies, speeds and growth rates.

use super::figure::DispersionFigure;
use crate::page::{self};
use crate::picture::Point;
use crate::scale::{self, FINITE_LIMIT, SymmetricLog, Tick};

/// Mapping from values to axis positions.
#[derive(Clone, Copy)]
pub(super) enum ScaleKind {
    Linear,
    Logarithmic,
    SymmetricLogarithmic(SymmetricLog),
}

/// An axis with its range, in axis positions.
#[derive(Clone, Copy)]
pub(super) struct AxisScale {
    pub(super) kind: ScaleKind,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl AxisScale {
    fn to_position(kind: ScaleKind, value: f64) -> f64 {
        match kind {
            ScaleKind::Linear => value,
            ScaleKind::Logarithmic => value.log10(),
            ScaleKind::SymmetricLogarithmic(scale) => scale.to_position(value),
        }
    }

    /// Computes the range of the finite positions of `values`, extended at the lower and upper end by the fractions
    /// `margins` of its length; a default range if there are none.
    pub(super) fn from_values(
        kind: ScaleKind,
        values: impl Iterator<Item = f64>,
        margins: [f64; 2],
    ) -> Self {
        let places = values
            .map(|value| Self::to_position(kind, value))
            .filter(|place| place.abs() < FINITE_LIMIT);
        let (mut low, mut high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            });
        if low > high {
            (low, high) = (0.0, 1.0);
        } else if high - low <= 1e-9 * low.abs().max(high.abs()) || low == high {
            let half =
                if matches!(kind, ScaleKind::Logarithmic) { 0.5 } else { 0.5 * low.abs().max(1.0) };
            (low, high) = (low - half, high + half);
        }
        let extent = high - low;
        Self { kind, low: low - margins[0] * extent, high: high + margins[1] * extent }
    }

    pub(super) fn fraction(&self, value: f64) -> f64 {
        (Self::to_position(self.kind, value) - self.low) / (self.high - self.low)
    }

    /// Computes the ticks, located by their fraction of the axis length; `length` in pixels.
    pub(super) fn ticks(&self, length: f64, is_vertical: bool) -> Vec<Tick> {
        let (low, high) = (self.low, self.high);
        let mut ticks = match self.kind {
            ScaleKind::Linear => page::choose_ticks(length, is_vertical, |max_count| {
                scale::linear_ticks(low, high, max_count, false)
            }),
            ScaleKind::Logarithmic => page::choose_ticks(length, is_vertical, |max_count| {
                scale::log_ticks(low, high, max_count)
            }),
            ScaleKind::SymmetricLogarithmic(scale) => {
                scale.ticks(low, high, (length / 48.0) as usize)
            }
        };
        ticks.retain(|(place, _)| (low - 1e-9..=high + 1e-9).contains(place));
        let share = |place: f64| (place - self.low) / (self.high - self.low);
        ticks.into_iter().map(|(place, label)| (share(place), label)).collect()
    }
}

impl DispersionFigure {
    /// Computes the axes of wave numbers, frequencies, speeds and growth rates.
    pub(super) fn axis_scales(&self) -> [AxisScale; 4] {
        let branches = || self.branches.iter();
        let kind = |log: bool| if log { ScaleKind::Logarithmic } else { ScaleKind::Linear };
        let numbers = || {
            branches()
                .flat_map(|b| {
                    b.frequency
                        .iter()
                        .chain(&b.group_speed)
                        .chain(&b.growth_rate)
                        .chain(&b.measured_frequency)
                })
                .map(|point| point[0])
        };
        let mut k = AxisScale::from_values(kind(self.is_wave_number_log), numbers(), [0.0; 2]);
        if !self.is_wave_number_log && k.low > 0.0 && k.low < 0.2 * k.high {
            k.low = 0.0;
        }

        let edges = self.bands.iter().flat_map(|band| [band.low, band.high]);
        let cutoffs = self.cutoffs.iter().map(|level| level.value);
        let frequencies = branches()
            .flat_map(|b| b.frequency.iter().chain(&b.measured_frequency))
            .map(|point| point[1]);
        let values = frequencies.chain(cutoffs).chain(edges);
        let frequency = if self.is_frequency_log {
            AxisScale::from_values(ScaleKind::Logarithmic, values, [0.04, 0.04])
        } else {
            let scale = AxisScale::from_values(ScaleKind::Linear, values.chain([0.0]), [0.0, 0.05]);
            extend_below_zero_lines(
                extend_negative_range(scale),
                branches().map(|branch| branch.frequency.clone()),
            )
        };

        let group = branches().flat_map(|b| &b.group_speed).map(|point| point[1]);
        let limits = self.speed_limits.iter().map(|level| level.value);
        let shortest = branches().filter_map(|branch| {
            let known = Self::branch_phase_speeds(branch)
                .into_iter()
                .filter(|[k, c]| (k + c).abs() < FINITE_LIMIT);
            known.max_by(|a, b| a[0].total_cmp(&b[0])).map(|[_, c]| c)
        });
        let values = group.chain(limits).chain(shortest).chain([0.0]);
        let speed =
            extend_negative_range(AxisScale::from_values(ScaleKind::Linear, values, [0.0, 0.25]));
        let lines = branches()
            .flat_map(|branch| [Self::branch_phase_speeds(branch), branch.group_speed.clone()]);
        let speed = extend_below_zero_lines(speed, lines);

        let growth = || branches().flat_map(|b| &b.growth_rate).map(|point| point[1]).chain([0.0]);
        let kind = if self.is_wave_number_log {
            ScaleKind::SymmetricLogarithmic(SymmetricLog::from_values(
                growth().filter(|v| v.abs() < FINITE_LIMIT),
            ))
        } else {
            ScaleKind::Linear
        };
        [k, frequency, speed, AxisScale::from_values(kind, growth(), [0.06, 0.06])]
    }
}

/// Lowers the lower end 0 of a range by 5 % of its length if one of the lines is at zero, where the frame would cover it and
/// its rings.
fn extend_below_zero_lines(scale: AxisScale, lines: impl Iterator<Item = Vec<Point>>) -> AxisScale {
    const TOLERANCE: f64 = 1e-6;
    let is_at_zero = |line: Vec<Point>| {
        !line.is_empty() && line.iter().all(|[_, value]| value.abs() <= TOLERANCE * scale.high)
    };
    match scale.low == 0.0 && { lines }.any(is_at_zero) {
        true => AxisScale { low: -0.05 * scale.high, ..scale },
        false => scale,
    }
}

/// Lowers a negative lower end of a range by 5 % of the length of the range; returns other ranges unchanged.
fn extend_negative_range(scale: AxisScale) -> AxisScale {
    let low = if scale.low < 0.0 { scale.low - 0.05 * (scale.high - scale.low) } else { scale.low };
    AxisScale { low, ..scale }
}
