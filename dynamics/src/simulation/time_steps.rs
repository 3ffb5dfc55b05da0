//! Equal time steps within the CFL condition that end with the run, and the position of times among them.

use crate::solid::medium::Medium;

/// Maximum number of steps of a run.
const MAX_STEPS: f64 = 1e12;

/// Fraction of a step that counts as rounding.
const STEP_ROUNDING: f64 = 1e-9;

/// Criterion that limits the time step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepLimit {
    /// Courant number of the fastest wave.
    Wave,
    /// Phase angle per step of the spin oscillation driven by antisymmetric stress.
    Rotation,
}

/// Equal time steps that end with the run.
#[derive(Clone, Copy, Debug)]
pub struct TimeSteps {
    /// Number of time steps of the run.
    pub count: usize,
    /// Time step Δt, s.
    pub step: f64,
    /// Criterion that limits the time step Δt.
    pub limit: StepLimit,
    /// Duration of the run, s.
    duration: f64,
}

/// Error: a run would need more than 10¹² time steps.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{count:.3e} steps of {longest_step:.3e} s")]
pub struct TooManySteps {
    /// Number of time steps required.
    count: f64,
    /// Longest admissible time step, s.
    longest_step: f64,
}

impl TimeSteps {
    /// Chooses the longest steps for which each sweep (half a step along an axis) has at most the Courant number
    /// `courant` and the spin oscillation of a medium advances by a phase angle of at most `rotation`, rad, per step,
    /// shortened to divide the `duration`, s. `spacing`: cell edges, m.
    ///
    /// # Errors
    /// More than 10¹² steps.
    pub fn new(
        media: &[Medium],
        spacing: &[f64],
        courant: f64,
        rotation: f64,
        duration: f64,
    ) -> Result<Self, TooManySteps> {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
        let rates = spacing.iter().enumerate().map(|(axis, spacing)| {
            let pairs = media.iter().flat_map(|m| &m.pairs[axis]);
            largest(&mut pairs.map(|pair| pair.speed())) / spacing
        });
        // A step has two sweeps along each axis.
        let by_waves = 2.0 * courant / largest(&mut { rates });
        let frequencies = media.iter().filter_map(|m| Some(m.rotation?.frequency));
        let by_rotation = rotation / largest(&mut { frequencies });
        let longest_step = by_waves.min(by_rotation);
        let count = (duration / longest_step * (1.0 - 1e-12)).ceil().max(1.0);
        if count > MAX_STEPS {
            return Err(TooManySteps { count, longest_step });
        }
        let limit = if by_rotation < by_waves { StepLimit::Rotation } else { StepLimit::Wave };
        Ok(Self { count: count as usize, step: duration / count, limit, duration })
    }

    /// Returns the time after `done` steps, s; after the last step exactly the duration, which a sum of steps would
    /// miss.
    pub fn time(&self, done: usize) -> f64 {
        done as f64 / self.count as f64 * self.duration
    }

    /// Returns the number of steps that end at or before `time`, s, and the fraction of the next step up to it, in \[0,
    /// 1), which is 0 if a step ends at that time up to rounding.
    pub fn locate(&self, time: f64) -> (usize, f64) {
        let position = time / self.duration * self.count as f64;
        let nearest = position.round();
        let rounding = STEP_ROUNDING + 4.0 * f64::EPSILON * position;
        if (position - nearest).abs() <= rounding {
            return (nearest as usize, 0.0);
        }
        (position.floor() as usize, position - position.floor())
    }
}

#[cfg(test)]
mod tests {
    use super::super::RegularTimes;
    use super::*;

    /// Verifies the position of all multiples of an interval among the steps, and that the last one is the end of the
    /// run.
    #[test]
    fn times_are_located_among_the_steps() {
        for (interval, duration, count) in
            [(0.02, 0.1, 37), (0.02, 0.1, 50), (0.03, 0.1, 7), (1.0, 0.1, 3), (1e-3, 0.1, 11)]
        {
            let step = duration / count as f64;
            let steps = TimeSteps { count, step, limit: StepLimit::Wave, duration };
            let times = RegularTimes::new(interval, duration);
            let output_times: Vec<f64> = (0..).map_while(|index| times.time(index)).collect();
            assert_eq!(
                output_times.len(),
                ((duration / interval) * (1.0 - 1e-9)).ceil() as usize + 1
            );
            for own in &output_times {
                let (done, fraction) = steps.locate(*own);
                assert!((0.0..1.0).contains(&fraction) && done <= count);
                let time = (done as f64 + fraction) / count as f64 * duration;
                assert!((time - own).abs() < 1e-12 * duration);
            }
            assert_eq!(steps.locate(*output_times.last().unwrap()), (count, 0.0));
            for done in 0..=count {
                assert_eq!(steps.locate(steps.time(done)), (done, 0.0));
            }
        }
    }
}
