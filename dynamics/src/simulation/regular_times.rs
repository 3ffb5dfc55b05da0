//! Equidistant output times.

use super::Simulation;
use std::cmp::Ordering;

/// Times at the multiples of an interval, from 0 on; the last time is the duration, which replaces a multiple less than
/// 10⁻⁶ intervals before it.
#[derive(Clone, Copy, Debug)]
pub struct RegularTimes {
    /// Interval between successive times, s.
    interval: f64,
    /// Duration, which is the last time, s.
    duration: f64,
    /// Number of times, 0 and the duration included.
    count: usize,
}

/// Maximum number of times between the first and the last one: 2⁵³, the largest index that `f64` resolves.
const MAX_INTERIOR_TIMES: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

impl RegularTimes {
    /// Creates the multiples of `interval`, s, up to `duration`, s, both positive. If the duration exceeds 2⁵³
    /// intervals, the multiples after the 2⁵³-th are omitted.
    pub fn new(interval: f64, duration: f64) -> Self {
        let interior_count = (duration / interval - 1e-6).floor().clamp(0.0, MAX_INTERIOR_TIMES);
        Self { interval, duration, count: interior_count as usize + 2 }
    }

    /// Returns time `index` (from 0), s; `None` beyond the last one.
    pub fn time(&self, index: usize) -> Option<f64> {
        match self.count.checked_sub(index)? {
            0 => None,
            1 => Some(self.duration),
            _ => Some(index as f64 * self.interval),
        }
    }

    /// Whether two times, s, are equal up to 10⁻¹² of the duration.
    pub fn is_same_time(&self, time: f64, other: f64) -> bool {
        (time - other).abs() <= 1e-12 * self.duration
    }

    /// Counts the times up to `time`, s, inclusive up to rounding.
    pub fn count_until(&self, time: f64) -> usize {
        let is_past = |own: f64| own <= time || self.is_same_time(own, time);
        // Start one index lower, since the quotient may be rounded up.
        let before = (time.min(self.duration) / self.interval).floor().max(1.0) as usize - 1;
        let mut count = before.min(self.count - 1);
        while self.time(count).is_some_and(is_past) {
            count += 1;
        }
        count
    }

    /// Counts the times that a simulation has reached.
    pub fn count_reached(&self, simulation: &impl Simulation) -> usize {
        let is_reached = |time: f64| simulation.compare_time(time) != Ordering::Greater;
        (0..).take_while(|index| self.time(*index).is_some_and(is_reached)).count()
    }
}

#[cfg(test)]
mod tests {
    use super::RegularTimes;

    /// Verifies the number of times, that they increase from 0 to the duration, and the numbers of times up to a time.
    #[test]
    fn each_time_occurs_once_and_the_last_is_the_duration() {
        for (interval, duration, count) in [
            (0.1, 1.0, 11),
            (1e-3 / 200.0, 1e-3, 201),
            (0.3, 1.0, 5),
            (7.0, 1.0, 2),
            (1e-5, 0.7, 70_001),
        ] {
            let times = RegularTimes::new(interval, duration);
            let listed_times: Vec<f64> = (0..).map_while(|k| times.time(k)).collect();
            assert_eq!(
                (listed_times.len(), listed_times[0], *listed_times.last().unwrap()),
                (count, 0.0, duration)
            );
            assert!(listed_times.windows(2).all(|pair| pair[0] < pair[1]));
            for (index, time) in listed_times.iter().enumerate().step_by(7) {
                assert_eq!(times.count_until(*time), index + 1, "{time}");
                assert_eq!(times.count_until(time - 1e-3 * interval), index, "{time}");
            }
            assert_eq!(times.count_until(duration), count);
        }
    }

    /// Verifies the limit of 2⁵³ + 2 times for intervals far shorter than `f64` resolves.
    #[test]
    fn number_of_times_is_limited_for_tiny_intervals() {
        for interval in [1e-300, f64::MIN_POSITIVE, 5e-324, 1e-17] {
            let times = RegularTimes::new(interval, 1.0);
            let count = times.count_until(1.0);
            assert_eq!(count, (1 << 53) + 2, "{interval}");
            assert_eq!(times.time(0), Some(0.0));
            assert_eq!(times.time(count - 1), Some(1.0));
            assert_eq!(times.time(count), None);
            assert_eq!(times.time(usize::MAX), None);
        }
        // An interval longer than the duration: first and last time only.
        assert_eq!(RegularTimes::new(f64::MAX, 1.0).count_until(1.0), 2);
    }
}
