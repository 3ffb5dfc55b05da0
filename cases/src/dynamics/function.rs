//! Functions of time by which loads are multiplied.

use models::elementary::Elementary;
use std::f64::consts::PI;
use std::sync::Arc;

/// A function of time without unit; times in s, frequencies in Hz.
#[derive(Clone, Debug, PartialEq)]
pub enum TimeFunction {
    /// 1 from `start` until `start + duration`, or for ever; else 0.
    Step {
        /// When it begins, s.
        start: f64,
        /// How long it lasts, s; `None`: for ever.
        duration: Option<f64>,
    },
    /// From 0 to 1 and back in straight lines.
    Triangle {
        /// When it begins, s.
        start: f64,
        /// How long it lasts, s; positive.
        duration: f64,
    },
    /// From 0 to 1 and back as sin²(π(t − start)/duration).
    Pulse {
        /// When it begins, s.
        start: f64,
        /// How long it lasts, s; positive.
        duration: f64,
    },
    /// (1 − 2a) exp(−a) with a = (π·frequency·(t − delay))².
    Ricker {
        /// Frequency of the greatest amplitude, Hz; positive.
        frequency: f64,
        /// When it is greatest, s.
        delay: f64,
    },
    /// sin(2π·frequency·(t − start)) from `start` on; 0 before.
    Sine {
        /// Frequency, Hz; positive.
        frequency: f64,
        /// When it begins, s.
        start: f64,
    },
    /// Straight lines between samples; 0 outside.
    Table(Samples),
}

/// Samples of a function of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// Times (s), increasing, and values; kept once for all copies of a case.
    samples: Arc<[[f64; 2]]>,
}

impl Samples {
    /// Samples of a function of time; `None` unless there are two at least, all numbers are finite
    /// and times increase.
    pub fn new(samples: Vec<[f64; 2]>) -> Option<Self> {
        let is_finite = samples.iter().flatten().all(|x| x.is_finite());
        let increases = samples.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        (samples.len() >= 2 && is_finite && increases).then(|| Self { samples: samples.into() })
    }

    /// Times, s, and values.
    pub fn samples(&self) -> &[[f64; 2]] {
        &self.samples
    }

    /// On the straight line between its neighbours; at a sample exactly that.
    pub(super) fn value(&self, t: f64) -> f64 {
        let next = self.samples.partition_point(|[time, _]| *time <= t);
        let Some(&[before, value]) = next.checked_sub(1).and_then(|last| self.samples.get(last))
        else {
            return 0.0;
        };
        match self.samples.get(next) {
            Some(&[after, next]) => {
                let part = (t - before) / (after - before);
                value * (1.0 - part) + next * part
            }
            None if t == before => value,
            None => 0.0,
        }
    }
}

impl TimeFunction {
    /// All names in case files.
    pub const NAMES: [&str; 6] = ["step", "triangle", "pulse", "ricker", "sine", "table"];

    /// A function by its samples; see [`Samples::new`].
    pub fn from_samples(samples: Vec<[f64; 2]>) -> Option<Self> {
        Samples::new(samples).map(Self::Table)
    }

    /// Its value at the time `t`, s.
    pub fn value(&self, t: f64) -> f64 {
        // Where in the duration; only inside is there anything.
        let inside = |start: f64, duration: f64| {
            let part = (t - start) / duration;
            (0.0..1.0).contains(&part).then_some(part)
        };
        match *self {
            Self::Step { start, duration: None } => f64::from(t >= start),
            Self::Step { start, duration: Some(duration) } => {
                f64::from(inside(start, duration).is_some())
            }
            Self::Triangle { start, duration } => {
                inside(start, duration).map_or(0.0, |part| 1.0 - (2.0 * part - 1.0).abs())
            }
            Self::Pulse { start, duration } => {
                inside(start, duration).map_or(0.0, |part| (PI * part).cr_sin().powi(2))
            }
            Self::Ricker { frequency, delay } => {
                let a = (PI * frequency * (t - delay)).powi(2);
                // Far away the product of what overflows and 0 would be no number.
                if a < 700.0 { (1.0 - 2.0 * a) * (-a).cr_exp() } else { 0.0 }
            }
            Self::Sine { frequency, start } if t >= start => {
                (2.0 * PI * frequency * (t - start)).cr_sin()
            }
            Self::Sine { .. } => 0.0,
            Self::Table(ref samples) => samples.value(t),
        }
    }

    /// The shortest time in which much happens, s; `None` where that is a jump alone.
    pub fn shortest(&self) -> Option<f64> {
        match *self {
            Self::Step { duration, .. } => duration,
            Self::Triangle { duration, .. } | Self::Pulse { duration, .. } => Some(duration),
            Self::Ricker { frequency, .. } | Self::Sine { frequency, .. } => Some(1.0 / frequency),
            Self::Table(ref samples) => {
                let times = samples.samples().windows(2).map(|pair| pair[1][0] - pair[0][0]);
                times.reduce(f64::min)
            }
        }
    }

    /// Name in case files.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Step { .. } => "step",
            Self::Triangle { .. } => "triangle",
            Self::Pulse { .. } => "pulse",
            Self::Ricker { .. } => "ricker",
            Self::Sine { .. } => "sine",
            Self::Table(_) => "table",
        }
    }
}
