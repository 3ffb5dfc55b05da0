//! Communication between the ranks of a run: processes with one part of the domain each.
//!
//! A message is a list of bytes with a tag. Messages of one sender to one receiver with the same tag arrive in the
//! order in which they were sent. All other operations are built from messages, in an order that depends only on the
//! number of ranks, so that results do too.

use std::collections::{HashMap, VecDeque};
use std::fmt::Debug;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Tag of the messages of operations that all ranks take part in; halos have lower ones.
const COLLECTIVE_TAG: u16 = 32_767;

/// Communication between the ranks of a run, numbered from 0 to [`size`](Self::size) − 1.
///
/// Rank 0, the root, collects and writes results. Operations in which all ranks take part must be called by all of them
/// in the same order. A failed transfer ends the run on all ranks, see [`abort`](Self::abort): there is no state to
/// which the ranks could return together.
pub trait Communicator: Debug + Send + Sync {
    /// Returns the number of this rank.
    fn rank(&self) -> usize;

    /// Returns the number of ranks.
    fn size(&self) -> usize;

    /// Begins to send a message to another rank, without waiting for its arrival. `tag`: below 32,768.
    fn begin_send(&self, receiver: usize, tag: u16, message: Vec<u8>);

    /// Waits for the next message of another rank with this tag, and writes it to `message`, which has its length.
    fn receive(&self, sender: usize, tag: u16, message: &mut [u8]);

    /// Ends the run on all ranks for the reason `cause`.
    fn abort(&self, cause: &str) -> !;

    /// Waits until all messages have been sent; the last call before the program ends.
    fn finish(&self) {}

    /// Returns the time for which threads of this rank have waited for messages so far, s.
    fn waiting_time(&self) -> f64 {
        0.0
    }

    /// Returns whether this rank is the root.
    fn is_root(&self) -> bool {
        self.rank() == 0
    }

    /// Sends a message that [`receive_any_length`](Self::receive_any_length) receives.
    fn send_any_length(&self, receiver: usize, message: Vec<u8>) {
        let length = (message.len() as u64).to_le_bytes();
        self.begin_send(receiver, COLLECTIVE_TAG, length.to_vec());
        self.begin_send(receiver, COLLECTIVE_TAG, message);
    }

    /// Waits for a message whose length only the sender knows.
    fn receive_any_length(&self, sender: usize) -> Vec<u8> {
        let mut length = [0; 8];
        self.receive(sender, COLLECTIVE_TAG, &mut length);
        let mut message = vec![0; u64::from_le_bytes(length) as usize];
        self.receive(sender, COLLECTIVE_TAG, &mut message);
        message
    }

    /// Passes the messages `own` of all ranks to `take` of the root, in the order of the ranks; called by all ranks.
    fn gather(&self, own: Vec<u8>, take: &mut dyn FnMut(usize, Vec<u8>)) {
        if !self.is_root() {
            return self.send_any_length(0, own);
        }
        take(0, own);
        (1..self.size()).for_each(|rank| take(rank, self.receive_any_length(rank)));
    }

    /// Returns to each rank the message `message(rank)` of the root; called by all ranks.
    fn scatter(&self, message: &mut dyn FnMut(usize) -> Vec<u8>) -> Vec<u8> {
        if !self.is_root() {
            return self.receive_any_length(0);
        }
        (1..self.size()).for_each(|rank| self.send_any_length(rank, message(rank)));
        message(0)
    }

    /// Returns the message `own` of the root to all ranks; called by all ranks.
    fn broadcast(&self, own: Vec<u8>) -> Vec<u8> {
        self.scatter(&mut |_| own.clone())
    }

    /// Returns the messages `own` of all ranks to all ranks, in their order; called by all ranks.
    fn gather_to_all(&self, own: Vec<u8>) -> Vec<Vec<u8>> {
        let mut messages = Vec::with_capacity(self.size());
        self.gather(own, &mut |_, message| messages.push(message));
        messages.resize(self.size(), Vec::new());
        messages.into_iter().map(|message| self.broadcast(message)).collect()
    }
}

/// A single process: the root, without other ranks.
#[derive(Clone, Copy, Debug, Default)]
pub struct SingleProcess;

impl Communicator for SingleProcess {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    /// There is no other rank to send to.
    fn begin_send(&self, _: usize, _: u16, _: Vec<u8>) {}

    /// There is no other rank to receive from.
    fn receive(&self, _: usize, _: u16, _: &mut [u8]) {}

    fn abort(&self, cause: &str) -> ! {
        panic!("{cause}")
    }
}

/// Rank among several on threads of this process: the smallest setting in which ranks communicate.
#[derive(Debug)]
pub struct ThreadRank {
    rank: usize,
    size: usize,
    mailboxes: Arc<Mailboxes>,
    waiting_time: WaitingTime,
}

/// Time for which threads have waited for messages, ns.
#[derive(Debug, Default)]
pub(super) struct WaitingTime(AtomicU64);

impl WaitingTime {
    /// Adds the time since `start`.
    pub(super) fn add_since(&self, start: Instant) {
        self.0.fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// Returns the time in s.
    pub(super) fn as_seconds(&self) -> f64 {
        Duration::from_nanos(self.0.load(Ordering::Relaxed)).as_secs_f64()
    }
}

/// Messages that have been sent but not received.
#[derive(Debug, Default)]
struct Mailboxes {
    state: Mutex<MailboxState>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct MailboxState {
    /// Messages by sender, receiver and tag.
    messages: HashMap<(usize, usize, u16), VecDeque<Vec<u8>>>,
    /// Whether a rank has ended the run or panicked.
    has_ended: bool,
}

impl Mailboxes {
    fn lock(&self) -> MutexGuard<'_, MailboxState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self) {
        self.lock().has_ended = true;
        self.changed.notify_all();
    }
}

impl ThreadRank {
    /// Creates the ranks of a run.
    pub fn create_all(size: usize) -> Vec<Self> {
        let mailboxes = Arc::new(Mailboxes::default());
        let rank = |rank| {
            let mailboxes = Arc::clone(&mailboxes);
            Self { rank, size, mailboxes, waiting_time: WaitingTime::default() }
        };
        (0..size).map(rank).collect()
    }
}

impl Drop for ThreadRank {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.mailboxes.end();
        }
    }
}

impl Communicator for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn begin_send(&self, receiver: usize, tag: u16, message: Vec<u8>) {
        let key = (self.rank, receiver, tag);
        self.mailboxes.lock().messages.entry(key).or_default().push_back(message);
        self.mailboxes.changed.notify_all();
    }

    fn receive(&self, sender: usize, tag: u16, message: &mut [u8]) {
        let (key, start) = ((sender, self.rank, tag), Instant::now());
        let mut state = self.mailboxes.lock();
        let received = loop {
            if let Some(received) = state.messages.get_mut(&key).and_then(VecDeque::pop_front) {
                break received;
            }
            if state.has_ended {
                drop(state);
                self.abort("another rank has ended");
            }
            state = self.mailboxes.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        };
        drop(state);
        self.waiting_time.add_since(start);
        if received.len() != message.len() {
            self.abort("a message has another length than its receiver expects");
        }
        message.copy_from_slice(&received);
    }

    fn waiting_time(&self) -> f64 {
        self.waiting_time.as_seconds()
    }

    /// Ends the ranks by a panic in each.
    fn abort(&self, cause: &str) -> ! {
        self.mailboxes.end();
        panic!("rank {}: {cause}", self.rank)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Calls `task` for each rank on a thread of its own.
    fn run_ranks<V: Send>(size: usize, task: impl Fn(&ThreadRank) -> V + Sync) -> Vec<V> {
        std::thread::scope(|scope| {
            let task = &task;
            let threads: Vec<_> = ThreadRank::create_all(size)
                .into_iter()
                .map(|rank| scope.spawn(move || task(&rank)))
                .collect();
            threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
        })
    }

    #[test]
    fn messages_arrive_in_order_and_by_tag() {
        let received = run_ranks(3, |rank| {
            let next = (rank.rank() + 1) % 3;
            let own = rank.rank() as u8;
            for (tag, value) in [(1, 10), (2, 20), (1, 30)] {
                rank.begin_send(next, tag, vec![value + own]);
            }
            let mut values = [0; 3];
            for (tag, value) in [2, 1, 1].into_iter().zip(values.chunks_mut(1)) {
                rank.receive((rank.rank() + 2) % 3, tag, value);
            }
            values
        });
        assert_eq!(received, [[22, 12, 32], [20, 10, 30], [21, 11, 31]]);
    }

    #[test]
    fn operations_of_all_ranks_follow_the_order_of_ranks() {
        for size in 1..5 {
            let results = run_ranks(size, |rank| {
                let mut gathered = Vec::new();
                rank.gather(vec![rank.rank() as u8; rank.rank()], &mut |from, message| {
                    gathered.push((from, message.len()));
                });
                let own = rank.scatter(&mut |to| vec![7; 2 * to]);
                let sent = rank.broadcast(vec![rank.rank() as u8 + 5]);
                (gathered, own.len(), sent, rank.gather_to_all(vec![3; rank.rank()]))
            });
            for (rank, (gathered, own, sent, all)) in results.into_iter().enumerate() {
                assert!(all.iter().map(Vec::len).eq(0..size));
                let expected =
                    if rank == 0 { (0..size).map(|own| (own, own)).collect() } else { vec![] };
                assert_eq!((gathered, own, sent), (expected, 2 * rank, vec![5]));
            }
        }
        let mut taken = Vec::new();
        SingleProcess.gather(vec![3], &mut |rank, message| taken.push((rank, message)));
        assert_eq!(taken, [(0, vec![3])]);
        assert_eq!(SingleProcess.broadcast(vec![4]), [4]);
    }

    #[test]
    fn a_rank_that_ends_ends_the_others() {
        let ended = std::thread::scope(|scope| {
            let threads: Vec<_> = ThreadRank::create_all(3)
                .into_iter()
                .map(|rank| {
                    scope.spawn(move || match rank.rank() {
                        1 => rank.abort("disk full"),
                        _ => rank.receive(1, 0, &mut [0]),
                    })
                })
                .collect();
            threads.into_iter().map(|thread| thread.join().is_err()).collect::<Vec<_>>()
        });
        assert_eq!(ended, [true; 3]);
    }
}
