//! Times for which ranks wait for messages of others.

use dynamics::decomposition::communicator::Communicator;
use std::fmt::{Display, Formatter};
use std::time::Instant;

/// Clock of a rank from the beginning of a run on.
pub(in crate::cli) struct WaitingClock<'a> {
    communicator: &'a dyn Communicator,
    start: Instant,
    /// Waiting time before the run, s.
    waited_before: f64,
}

/// Times of all ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::cli) struct WaitingTimes(Vec<[f64; 2]>);

impl<'a> WaitingClock<'a> {
    pub(in crate::cli) fn start(communicator: &'a dyn Communicator) -> Self {
        let waited_before = communicator.waiting_time();
        Self { communicator, start: Instant::now(), waited_before }
    }

    /// Returns the times of all ranks, of `threads` threads each, at the root, and nothing at the others; called by all
    /// ranks.
    pub(in crate::cli) fn collect(self, threads: usize) -> WaitingTimes {
        let waited = self.communicator.waiting_time() - self.waited_before;
        let own = [self.start.elapsed().as_secs_f64(), waited / threads as f64];
        let mut all = Vec::new();
        let message = own.iter().flat_map(|time| time.to_le_bytes()).collect();
        self.communicator.gather(message, &mut |_, message| {
            if let ([elapsed, waited], _) = message.as_chunks() {
                all.push([elapsed, waited].map(|own| f64::from_le_bytes(*own)));
            }
        });
        WaitingTimes(all)
    }
}

/// Formats a table with a row per rank.
impl Display for WaitingTimes {
    fn fmt(&self, formatter: &mut Formatter) -> std::fmt::Result {
        writeln!(
            formatter,
            "waiting for messages of other ranks, mean of the threads\n  {:>6}  {:>10}  {:>10}  {:>6}",
            "rank", "elapsed, s", "waiting, s", "share"
        )?;
        for (rank, [elapsed, waited]) in self.0.iter().enumerate() {
            let share = 100.0 * waited / elapsed;
            writeln!(formatter, "  {rank:>6}  {elapsed:>10.3}  {waited:>10.3}  {share:>4.1} %")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dynamics::decomposition::communicator::ThreadRank;

    #[test]
    fn the_root_gets_the_times_of_all_ranks() {
        let times: Vec<WaitingTimes> = std::thread::scope(|scope| {
            let start = |rank: ThreadRank| {
                scope.spawn(move || {
                    let clock = WaitingClock::start(&rank);
                    if rank.rank() == 1 {
                        std::thread::sleep(std::time::Duration::from_millis(20));
                    }
                    rank.broadcast(vec![0]);
                    rank.gather(vec![0], &mut |_, _| {});
                    clock.collect(2)
                })
            };
            let ranks: Vec<_> = ThreadRank::create_all(2).into_iter().map(start).collect();
            ranks.into_iter().map(|own| own.join().expect("no panic")).collect()
        });
        assert_eq!((times[0].0.len(), times[1].0.len()), (2, 0));
        // The root waits for the other rank, whose sleep is no waiting; two threads would halve it.
        let [[elapsed, waited], [_, other]] = times[0].0[..] else { panic!("{times:?}") };
        assert!(elapsed >= 0.02 && waited >= 0.009 && other < waited, "{times:?}");
        let text = WaitingTimes(vec![[2.0, 0.5], [2.0, 0.0]]).to_string();
        assert!(text.ends_with("       1       2.000       0.000   0.0 %\n"), "{text}");
    }
}
