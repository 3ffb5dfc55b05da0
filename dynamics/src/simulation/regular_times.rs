//! Times at equal intervals.

use super::Simulation;
use std::cmp::Ordering;

/// The multiples of an interval from 0 on. The last one is the duration, which stands for a multiple next to it.
#[derive(Clone, Copy, Debug)]
pub struct RegularTimes {
    /// s.
    interval: f64,
    /// s.
    duration: f64,
    count: usize,
}

/// Most times between the first and the last one: numbers of more are not told apart as floating-point numbers.
const MOST_INSIDE: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

impl RegularTimes {
    /// Both in s, and positive. An interval that is too short for the duration, more than 2⁵³ times, ends early but for
    /// the last time.
    pub fn new(interval: f64, duration: f64) -> Self {
        let inside = (duration / interval - 1e-6).floor().clamp(0.0, MOST_INSIDE);
        Self { interval, duration, count: inside as usize + 2 }
    }

    /// A time by its number from 0 on, s; `None` beyond the last one.
    pub fn time(&self, index: usize) -> Option<f64> {
        match self.count.checked_sub(index)? {
            0 => None,
            1 => Some(self.duration),
            _ => Some(index as f64 * self.interval),
        }
    }

    /// Whether two times, s, are one but for rounding.
    pub fn is_one(&self, time: f64, other: f64) -> bool {
        (time - other).abs() <= 1e-12 * self.duration
    }

    /// How many come before a time, s, that one included where it is one of them but for rounding.
    pub fn until(&self, time: f64) -> usize {
        let is_past = |own: f64| own <= time || self.is_one(own, time);
        // Counted from just below, for what rounding does to the quotient.
        let before = (time.min(self.duration) / self.interval).floor().max(1.0) as usize - 1;
        let mut count = before.min(self.count - 1);
        while self.time(count).is_some_and(is_past) {
            count += 1;
        }
        count
    }

    /// How many a simulation has come to.
    pub fn reached(&self, simulation: &impl Simulation) -> usize {
        let is_reached = |time: f64| simulation.compare(time) != Ordering::Greater;
        (0..).take_while(|index| self.time(*index).is_some_and(is_reached)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::RegularTimes;

    /// Multiples that a sum would miss come once each, the last one when the run ends.
    #[test]
    fn every_time_once() {
        for (interval, duration, count) in [
            (0.1, 1.0, 11),
            (1e-3 / 200.0, 1e-3, 201),
            (0.3, 1.0, 5),
            (7.0, 1.0, 2),
            (1e-5, 0.7, 70_001),
        ] {
            let times = RegularTimes::new(interval, duration);
            let all: Vec<f64> = (0..).map_while(|k| times.time(k)).collect();
            assert_eq!((all.len(), all[0], *all.last().unwrap()), (count, 0.0, duration));
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
            for (index, time) in all.iter().enumerate().step_by(7) {
                assert_eq!(times.until(*time), index + 1, "{time}");
                assert_eq!(times.until(time - 1e-3 * interval), index, "{time}");
            }
            assert_eq!(times.until(duration), count);
        }
    }

    /// Far more times than there are numbers for.
    #[test]
    fn absurd_intervals_have_an_end() {
        for interval in [1e-300, f64::MIN_POSITIVE, 5e-324, 1e-17] {
            let times = RegularTimes::new(interval, 1.0);
            let count = times.until(1.0);
            assert_eq!(count, (1 << 53) + 2, "{interval}");
            assert_eq!(times.time(0), Some(0.0));
            assert_eq!(times.time(count - 1), Some(1.0));
            assert_eq!(times.time(count), None);
            assert_eq!(times.time(usize::MAX), None);
        }
        // Shorter than any: one step of the last bit is left.
        assert_eq!(RegularTimes::new(f64::MAX, 1.0).until(1.0), 2);
    }
}
