//! Steps in which shear waves are swept, if they have longer steps than longitudinal waves.
//!
//! Sweeps are exact for waves of Courant number 1. If longitudinal waves are n = 2 or 3 times as fast as shear waves,
//! both families have that Courant number if shear waves are swept in one of n steps only, by n steps at once. Both
//! families are independent within a sweep. With L and S for the step of the longitudinal and of all waves, the order
//! of the steps is
//!
//! ```text
//! n = 2: L S S L, L S S L, …        n = 3: L S L, L S L, …
//! ```
//!
//! Each period is symmetric in time, so that the product is of second order as each of its factors is (Strang 1968).

use crate::solid::problem::Problem;
use models::solid::waves::VelocityStressPair;

/// Numbers of steps per step of the shear waves that are possible.
pub const SHEAR_INTERVALS: [usize; 3] = [1, 2, 3];

/// Steps in which shear waves are swept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShearSteps {
    /// Number n of steps per step of the shear waves; 1 if both families have the same step.
    interval: usize,
}

impl ShearSteps {
    pub(crate) fn new<const D: usize>(problem: &Problem<D>) -> Self {
        Self { interval: problem.shear_interval }
    }

    /// Whether the step with an index counted from the start of the simulation sweeps shear waves.
    pub(crate) fn sweeps_shear_waves(self, step: usize) -> bool {
        match self.interval {
            2 => matches!(step % 4, 1 | 2),
            interval => step % interval == interval / 2,
        }
    }

    /// Returns the duration of the sweeps of shear waves by that of longitudinal waves: 0 in steps without them.
    pub(crate) fn relative_duration(self, step: usize) -> f64 {
        if self.sweeps_shear_waves(step) { self.interval as f64 } else { 0.0 }
    }

    /// Returns the middle of a sweep of shear waves, s; `half`: 0 in the first and 1 in the second half of the step with
    /// index `step`, in which steps of the duration `duration`, s.
    pub(crate) fn sweep_middle(self, (step, half): (usize, usize), duration: f64) -> f64 {
        let start = (step - step % self.interval) as f64 * duration;
        start + [0.25, 0.75][half] * (self.interval as f64 * duration)
    }

    /// Returns the fraction of a step by which a wave pair is swept, in steps that sweep shear waves, then in the
    /// others.
    pub(crate) fn sweep_fractions(self, pair: &VelocityStressPair) -> [f64; 2] {
        match pair.is_longitudinal() {
            true => [0.5; 2],
            false => [0.5 * self.interval as f64, 0.0],
        }
    }

    /// Whether the steps differ.
    pub(crate) fn differ(self) -> bool {
        self.interval > 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies that sweeps of shear waves cover all time once, their middles included, in symmetric order.
    #[test]
    fn sweeps_of_shear_waves_cover_the_time_once() {
        for interval in SHEAR_INTERVALS {
            let steps = ShearSteps { interval };
            let period = if interval == 2 { 4 } else { interval };
            let swept: Vec<usize> =
                (0..3 * period).filter(|step| steps.sweeps_shear_waves(*step)).collect();
            assert_eq!(swept.len() * interval, 3 * period);
            for (index, step) in swept.iter().enumerate() {
                let middles = [0, 1].map(|half| steps.sweep_middle((*step, half), 1.0));
                let expected = [0.25, 0.75].map(|place| interval as f64 * (index as f64 + place));
                assert_eq!(middles, expected);
                assert_eq!(steps.relative_duration(*step), interval as f64);
            }
            for step in 0..period {
                assert_eq!(
                    steps.sweeps_shear_waves(step),
                    steps.sweeps_shear_waves(period - 1 - step)
                );
            }
        }
    }
}
