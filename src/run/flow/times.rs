//! Times at which a flow's output is asked for.

/// The multiples of an interval from 0 on. The last one is the duration, which stands for what is next to it.
#[derive(Clone, Copy)]
pub(super) struct Times {
    /// s; positive.
    interval: f64,
    /// s; positive.
    duration: f64,
}

impl Times {
    /// Both in s, and positive.
    pub(super) fn new(interval: f64, duration: f64) -> Self {
        Self { interval, duration }
    }

    /// A time by its number from 0 on, s.
    pub(super) fn time(self, index: usize) -> f64 {
        let time = index as f64 * self.interval;
        if time > self.duration - 1e-6 * self.interval { self.duration } else { time }
    }

    /// Whether there is a time of that number.
    fn has(self, index: usize) -> bool {
        index == 0 || self.time(index - 1) < self.duration
    }

    /// Whether two times are one but for rounding.
    pub(super) fn is_one(self, time: f64, other: f64) -> bool {
        (time - other).abs() <= 1e-12 * self.duration
    }

    /// How many come before a time, s, that one included where it is one of them but for rounding.
    pub(super) fn until(self, time: f64) -> usize {
        let is_past = |own: f64| own <= time || self.is_one(own, time);
        // Counted from just below, for what rounding does to the quotient.
        let mut count = (time.min(self.duration) / self.interval).floor().max(1.0) as usize - 1;
        while self.has(count) && is_past(self.time(count)) {
            count += 1;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::Times;

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
            let times = Times::new(interval, duration);
            let all: Vec<f64> =
                (0..).take_while(|k| times.has(*k)).map(|k| times.time(k)).collect();
            assert_eq!((all.len(), all[0], *all.last().unwrap()), (count, 0.0, duration));
            assert!(all.windows(2).all(|pair| pair[0] < pair[1]));
            for (index, time) in all.iter().enumerate().step_by(7) {
                assert_eq!(times.until(*time), index + 1, "{time}");
                assert_eq!(times.until(time - 1e-3 * interval), index, "{time}");
            }
            assert_eq!(times.until(duration), count);
        }
    }
}
