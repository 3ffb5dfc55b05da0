//! The times of snapshots among the steps of a run.
//!
//! Snapshots are asked for at multiples of an interval and at the end; steps are as long as waves let
//! them be, whatever is asked for. Between two steps a snapshot is on the straight line between the states, so that
//! stresses stay in their convex yield sets.

/// A part of a step that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// A snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Snapshot {
    /// Its number, from 0.
    pub(super) index: usize,
    /// Its time, s.
    pub(super) time: f64,
    /// Steps done before it.
    pub(super) step: usize,
    /// Part of the next step that it takes, in [0, 1): 0 where a step ends at its time.
    pub(super) part: f64,
}

impl Snapshot {
    /// Steps done when it can be written.
    pub(super) fn due(&self) -> usize {
        self.step + usize::from(self.part > 0.0)
    }

    /// The name of its file with that extension.
    pub(super) fn name(&self, extension: &str) -> String {
        name(self.index, extension)
    }
}

/// The name of the file of a snapshot.
pub(super) fn name(index: usize, extension: &str) -> String {
    format!("snapshot-{index:08}.{extension}")
}

/// All snapshots of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    interval: f64,
    duration: f64,
    /// Steps of the run.
    steps: usize,
    /// Snapshots, those at the beginning and at the end among them.
    count: usize,
}

impl Schedule {
    /// Snapshots at multiples of an interval until the duration, both in s, and there.
    pub(super) fn new(interval: f64, duration: f64, steps: usize) -> Self {
        // A multiple next to the end is the end.
        let before = (duration / interval - 1e-6).floor().max(0.0);
        Self { interval, duration, steps, count: before as usize + 2 }
    }

    fn get(&self, index: usize) -> Snapshot {
        let is_last = index + 1 == self.count;
        if is_last {
            return Snapshot { index, time: self.duration, step: self.steps, part: 0.0 };
        }
        let time = index as f64 * self.interval;
        let place = time / self.duration * self.steps as f64;
        let nearest = place.round();
        let rounding = ROUNDING + 4.0 * f64::EPSILON * place;
        let (step, part) = match (place - nearest).abs() <= rounding {
            true => (nearest, 0.0),
            false => (place.floor(), place - place.floor()),
        };
        Snapshot { index, time, step: step as usize, part }
    }

    /// Those that are due when so many steps have been done, in their order.
    pub(super) fn until(&self, done: usize) -> impl Iterator<Item = Snapshot> {
        let own = *self;
        (0..own.count).map(move |index| own.get(index)).take_while(move |own| own.due() <= done)
    }

    /// The first that is due only after so many steps.
    fn first_after(&self, done: usize) -> Option<Snapshot> {
        let passed = done as f64 / self.steps as f64 * self.duration / self.interval;
        let start = (passed.floor() as usize).saturating_sub(2).min(self.count - 1);
        (start..self.count).map(|index| self.get(index)).find(|own| own.due() > done)
    }

    /// Those that are due at just so many steps.
    pub(super) fn due_at(&self, done: usize) -> impl Iterator<Item = Snapshot> {
        let own = *self;
        let before = done.checked_sub(1).map(|done| self.first_after(done).map(|own| own.index));
        let first = before.unwrap_or(Some(0)).unwrap_or(own.count);
        (first..own.count).map(move |index| own.get(index)).take_while(move |own| own.due() == done)
    }

    /// Steps after `done` to the next at which a state is needed, if any is.
    pub(super) fn to_next(self, done: usize) -> Option<usize> {
        let next = self.first_after(done)?;
        Some(if next.step > done { next.step - done } else { next.due() - done })
    }

    /// Whether the state after so many steps is needed together with the next one.
    pub(super) fn is_between(&self, done: usize) -> bool {
        self.first_after(done).is_some_and(|next| next.step == done && next.part > 0.0)
    }
}

/// What is shown after a step and before it, on the straight line between.
pub(super) fn between(before: &[Vec<f64>], after: &[Vec<f64>], part: f64) -> Vec<Vec<f64>> {
    let line = |(a, b): (&f64, &f64)| (1.0 - part) * a + part * b;
    let field = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(line).collect();
    before.iter().zip(after).map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every multiple comes once, and the end; each between the steps around it.
    #[test]
    fn times_are_those_asked_for() {
        for (interval, duration, steps) in
            [(0.02, 0.1, 37), (0.02, 0.1, 50), (0.03, 0.1, 7), (1.0, 0.1, 3), (1e-3, 0.1, 11)]
        {
            let schedule = Schedule::new(interval, duration, steps);
            let all: Vec<Snapshot> = schedule.until(steps).collect();
            assert_eq!(all.last().unwrap().time, duration);
            for (index, own) in all.iter().enumerate() {
                assert_eq!(own.index, index);
                if index + 1 < all.len() {
                    assert_eq!(own.time, index as f64 * interval);
                }
                let time = (own.step as f64 + own.part) / steps as f64 * duration;
                assert!((time - own.time).abs() < 1e-12 * duration && own.part < 1.0);
            }
            assert_eq!(all.len(), ((duration / interval) * (1.0 - 1e-9)).ceil() as usize + 1);
            // Step by step, each snapshot comes when it is due.
            let mut found = Vec::new();
            for done in 0..=steps {
                found.extend(schedule.due_at(done));
                let next = found.len();
                assert_eq!(schedule.until(done).count(), next);
                if done < steps {
                    let step = schedule.to_next(done).unwrap();
                    assert!(step >= 1 && done + step <= steps);
                    let is_between = |own: &Snapshot| own.step == done && own.part > 0.0;
                    assert_eq!(schedule.is_between(done), all[next..].iter().any(is_between));
                }
            }
            assert_eq!(found, all);
        }
    }
}
