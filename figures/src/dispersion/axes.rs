//! The axes of wave numbers, frequencies, speeds and growth rates.

use super::figure::DispersionFigure;
use crate::page::{self};
use crate::scale::{self, SymmetricLog, Tick};

/// Magnitude above which numbers are treated as infinite, since differences would overflow.
const FINITE: f64 = 1e300;

/// Mapping from values to axis positions.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Linear,
    Log,
    Symmetric(SymmetricLog),
}

/// An axis with its range, in axis positions.
#[derive(Clone, Copy)]
pub(super) struct Scale {
    pub(super) kind: Kind,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl Scale {
    fn forward(kind: Kind, value: f64) -> f64 {
        match kind {
            Kind::Linear => value,
            Kind::Log => value.log10(),
            Kind::Symmetric(scale) => scale.forward(value),
        }
    }

    /// Computes the range of the finite positions of `values`, extended at the lower and upper end by the shares `room`
    /// of its length.
    pub(super) fn of(kind: Kind, values: impl Iterator<Item = f64>, room: [f64; 2]) -> Self {
        let places =
            values.map(|value| Self::forward(kind, value)).filter(|place| place.abs() < FINITE);
        let (mut low, mut high) = places
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), place| {
                (low.min(place), high.max(place))
            });
        if low > high {
            (low, high) = (0.0, 1.0);
        } else if high - low <= 1e-9 * low.abs().max(high.abs()) || low == high {
            let half = if matches!(kind, Kind::Log) { 0.5 } else { 0.5 * low.abs().max(1.0) };
            (low, high) = (low - half, high + half);
        }
        let extent = high - low;
        Self { kind, low: low - room[0] * extent, high: high + room[1] * extent }
    }

    pub(super) fn share(&self, value: f64) -> f64 {
        (Self::forward(self.kind, value) - self.low) / (self.high - self.low)
    }

    /// Computes the ticks, located by their share of the axis; `length` in pixels.
    pub(super) fn ticks(&self, length: f64, upright: bool) -> Vec<Tick> {
        let (low, high) = (self.low, self.high);
        let mut ticks = match self.kind {
            Kind::Linear => {
                page::spaced(length, upright, |most| scale::ticks(low, high, most, false))
            }
            Kind::Log => page::spaced(length, upright, |most| scale::log_ticks(low, high, most)),
            Kind::Symmetric(scale) => scale.ticks(low, high, (length / 48.0) as usize),
        };
        ticks.retain(|(place, _)| (low - 1e-9..=high + 1e-9).contains(place));
        let share = |place: f64| (place - self.low) / (self.high - self.low);
        ticks.into_iter().map(|(place, label)| (share(place), label)).collect()
    }
}

impl DispersionFigure {
    /// Computes the axes of wave numbers, frequencies, speeds and growth rates.
    pub(super) fn scales(&self) -> [Scale; 4] {
        let branches = || self.branches.iter();
        let kind = |log: bool| if log { Kind::Log } else { Kind::Linear };
        let numbers = || {
            branches()
                .flat_map(|b| {
                    b.frequency.iter().chain(&b.group_speed).chain(&b.growth).chain(&b.measured)
                })
                .map(|point| point[0])
        };
        let mut k = Scale::of(kind(self.k_log), numbers(), [0.0; 2]);
        if !self.k_log && k.low > 0.0 && k.low < 0.2 * k.high {
            k.low = 0.0;
        }

        let edges = self.bands.iter().flat_map(|band| [band.from, band.to]);
        let cutoffs = self.cutoffs.iter().map(|level| level.value);
        let frequencies =
            branches().flat_map(|b| b.frequency.iter().chain(&b.measured)).map(|point| point[1]);
        let values = frequencies.chain(cutoffs).chain(edges);
        let frequency = if self.frequency_log {
            Scale::of(Kind::Log, values, [0.04, 0.04])
        } else {
            from_zero(Scale::of(Kind::Linear, values.chain([0.0]), [0.0, 0.05]))
        };

        let group = branches().flat_map(|b| &b.group_speed).map(|point| point[1]);
        let limits = self.speed_limits.iter().map(|level| level.value);
        let shortest = branches().filter_map(|branch| {
            let known = Self::phase(branch).into_iter().filter(|[k, c]| (k + c).abs() < FINITE);
            known.max_by(|a, b| a[0].total_cmp(&b[0])).map(|[_, c]| c)
        });
        let values = group.chain(limits).chain(shortest).chain([0.0]);
        let speed = from_zero(Scale::of(Kind::Linear, values, [0.0, 0.25]));

        let growth = || branches().flat_map(|b| &b.growth).map(|point| point[1]).chain([0.0]);
        let kind = if self.k_log {
            Kind::Symmetric(SymmetricLog::for_values(growth().filter(|v| v.abs() < FINITE)))
        } else {
            Kind::Linear
        };
        [k, frequency, speed, Scale::of(kind, growth(), [0.06, 0.06])]
    }
}

/// Extends the range below by 5 % if a value is negative; otherwise returns it unchanged, starting at zero.
fn from_zero(scale: Scale) -> Scale {
    let low = if scale.low < 0.0 { scale.low - 0.05 * (scale.high - scale.low) } else { scale.low };
    Scale { low, ..scale }
}
