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
///
/// If shear waves have longer steps ([`Problem::shear_interval`]), states count after whole steps of the shear waves
/// only: the number of steps is a multiple, and times are located among such steps.
///
/// [`Problem::shear_interval`]: crate::solid::problem::Problem::shear_interval
#[derive(Clone, Copy, Debug)]
pub struct TimeSteps {
    /// Number of time steps of the run.
    pub count: usize,
    /// Time step Δt, s.
    pub step: f64,
    /// Criterion that limits the time step Δt.
    pub limit: StepLimit,
    /// Number of steps per step of the shear waves.
    pub shear_interval: usize,
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
    /// shortened to divide the `duration`, s, by a multiple of `shear_interval`. `spacing`: cell edges, m.
    ///
    /// # Errors
    /// More than 10¹² steps.
    pub fn new(
        media: &[Medium],
        spacing: &[f64],
        (courant, shear_interval): (f64, usize),
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
        let period = longest_step * shear_interval as f64;
        let periods = (duration / period * (1.0 - 1e-12)).ceil().max(1.0);
        let count = periods * shear_interval as f64;
        if count > MAX_STEPS {
            return Err(TooManySteps { count, longest_step });
        }
        let limit = if by_rotation < by_waves { StepLimit::Rotation } else { StepLimit::Wave };
        Ok(Self { count: count as usize, step: duration / count, limit, shear_interval, duration })
    }

    /// Returns the time after `done` steps, s; after the last step exactly the duration, which a sum of steps would
    /// miss.
    pub fn time(&self, done: usize) -> f64 {
        done as f64 / self.count as f64 * self.duration
    }

    /// Returns the number of steps that end at or before `time`, s, a multiple of `shear_interval`, and the fraction of
    /// the next `shear_interval` steps up to it, in \[0, 1), which is 0 if a step ends at that time up to rounding.
    pub fn locate(&self, time: f64) -> (usize, f64) {
        let position = time / self.duration * (self.count / self.shear_interval) as f64;
        let nearest = position.round();
        let rounding = STEP_ROUNDING + 4.0 * f64::EPSILON * position;
        if (position - nearest).abs() <= rounding {
            return (nearest as usize * self.shear_interval, 0.0);
        }
        (position.floor() as usize * self.shear_interval, position - position.floor())
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
            let limit = StepLimit::Wave;
            let steps = TimeSteps { count, step, limit, shear_interval: 1, duration };
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
