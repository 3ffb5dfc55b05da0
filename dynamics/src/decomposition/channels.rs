//! Halo exchange between subdomains: on threads of the same process, and on other ranks.

use super::communicator::Communicator;
use super::ranks::Owner;
use crate::simd::{LaneGroup, Real};
use crate::solid::domain::HaloExchange;
use std::ops::Range;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Error of the halo exchange: the thread of a neighbouring subdomain has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the thread of a neighbouring part has ended")]
pub(super) struct Disconnected;

/// Connections to the neighbours, by axis and end (0: lower, 1: upper); `None` at ends without neighbour.
#[derive(Debug)]
pub(super) struct Channels<T: Real, const D: usize> {
    neighbours: [[Option<Connection<T>>; 2]; D],
}

/// Connection to a neighbouring subdomain.
#[derive(Debug)]
enum Connection<T: Real> {
    /// The neighbour is on a thread of the same process.
    Thread(NeighbourChannels<T::Lanes>),
    /// The neighbour is on another rank.
    Rank(RankConnection),
}

/// Connection to a subdomain on another rank.
#[derive(Debug)]
struct RankConnection {
    communicator: Arc<dyn Communicator>,
    rank: usize,
    /// Tags of the messages to the neighbour and from it.
    tags: [u16; 2],
}

impl<T: Real, const D: usize> Default for Channels<T, D> {
    fn default() -> Self {
        Self { neighbours: std::array::from_fn(|_| [None, None]) }
    }
}

/// Channels to and from a neighbouring subdomain, and received buffers for reuse.
#[derive(Debug)]
struct NeighbourChannels<T> {
    sender: SyncSender<Vec<T>>,
    receiver: Receiver<Vec<T>>,
    spare_messages: Vec<Vec<T>>,
}

impl<T: Real, const D: usize> Channels<T, D> {
    /// Connects the upper end of `axis` in subdomain `lower` with its lower end in subdomain `upper` (indices in
    /// `channels`, the channels of all subdomains), by channels that hold `capacity` messages. The two subdomains of a
    /// periodic axis are connected at both ends, by two calls.
    pub(super) fn connect(
        channels: &mut [Self],
        axis: usize,
        [lower, upper]: [usize; 2],
        capacity: usize,
    ) {
        let ((forth, from_below), (back, from_above)) =
            (sync_channel(capacity), sync_channel(capacity));
        let neighbour = |sender, receiver| {
            let spare_messages = Vec::new();
            Some(Connection::Thread(NeighbourChannels { sender, receiver, spare_messages }))
        };
        channels[lower].neighbours[axis][1] = neighbour(forth, from_above);
        channels[upper].neighbours[axis][0] = neighbour(back, from_below);
    }

    /// Connects an end of `axis` of the subdomain `thread` of this rank with the neighbour that another rank owns. The
    /// tag of a message tells the subdomain of its receiver, and the axis and the end at which it arrives.
    pub(super) fn connect_rank(
        &mut self,
        communicator: &Arc<dyn Communicator>,
        (axis, end): (usize, usize),
        thread: usize,
        neighbour: Owner,
    ) {
        let tag = |thread: usize, end: usize| ((thread * D + axis) * 2 + end) as u16;
        self.neighbours[axis][end] = Some(Connection::Rank(RankConnection {
            communicator: Arc::clone(communicator),
            rank: neighbour.rank,
            tags: [tag(neighbour.thread, 1 - end), tag(thread, end)],
        }));
    }
}

impl RankConnection {
    fn send<T: Real>(&self, values: &[T::Lanes], ranges: impl Iterator<Item = Range<usize>>) {
        let ranges: Vec<_> = ranges.collect();
        let mut message = vec![0; message_length::<T>(&ranges)];
        let groups = ranges.into_iter().flat_map(|range| &values[range]);
        for (bytes, group) in message.chunks_exact_mut(size_of::<T::Lanes>()).zip(groups) {
            T::write_bytes(group.lanes(), bytes);
        }
        self.communicator.begin_send(self.rank, self.tags[0], message);
    }

    fn receive<T: Real>(
        &self,
        values: &mut [T::Lanes],
        ranges: impl Iterator<Item = Range<usize>>,
    ) {
        let ranges: Vec<_> = ranges.collect();
        let mut message = vec![0; message_length::<T>(&ranges)];
        self.communicator.receive(self.rank, self.tags[1], &mut message);
        let mut groups = message.chunks_exact(size_of::<T::Lanes>());
        for range in ranges {
            for (group, bytes) in values[range].iter_mut().zip(&mut groups) {
                T::read_bytes(bytes, group.lanes_mut());
            }
        }
    }
}

/// Returns the length of a message with ranges of groups, bytes.
fn message_length<T: Real>(ranges: &[Range<usize>]) -> usize {
    ranges.iter().map(ExactSizeIterator::len).sum::<usize>() * size_of::<T::Lanes>()
}

impl<T: Real, const D: usize> HaloExchange<T::Lanes> for Channels<T, D> {
    type Error = Disconnected;

    fn send(
        &mut self,
        axis: usize,
        end: usize,
        values: &[T::Lanes],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Disconnected> {
        let neighbour = match &mut self.neighbours[axis][end] {
            None => return Ok(()),
            Some(Connection::Rank(rank)) => {
                rank.send::<T>(values, ranges);
                return Ok(());
            }
            Some(Connection::Thread(neighbour)) => neighbour,
        };
        let mut message = neighbour.spare_messages.pop().unwrap_or_default();
        message.clear();
        ranges.for_each(|range| message.extend_from_slice(&values[range]));
        neighbour.sender.send(message).map_err(|_| Disconnected)
    }

    fn receive(
        &mut self,
        axis: usize,
        end: usize,
        values: &mut [T::Lanes],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Disconnected> {
        let neighbour = match &mut self.neighbours[axis][end] {
            None => return Ok(()),
            Some(Connection::Rank(rank)) => {
                rank.receive::<T>(values, ranges);
                return Ok(());
            }
            Some(Connection::Thread(neighbour)) => neighbour,
        };
        let received = neighbour.receiver.recv().map_err(|_| Disconnected)?;
        let mut unread = received.as_slice();
        for range in ranges {
            let (chunk, remaining) = unread.split_at(range.len());
            values[range].copy_from_slice(chunk);
            unread = remaining;
        }
        debug_assert!(unread.is_empty());
        neighbour.spare_messages.push(received);
        Ok(())
    }
}
