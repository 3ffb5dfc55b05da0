//! Halo exchange between subdomains on threads of the same process.

use crate::solid::domain::HaloExchange;
use std::ops::Range;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

/// Error of the halo exchange: the thread of a neighbouring subdomain has ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the thread of a neighbouring part has ended")]
pub(super) struct Disconnected;

/// Channels to the neighbours, by axis and end (0: lower, 1: upper); `None` at ends without neighbour.
#[derive(Debug)]
pub(super) struct Channels<T, const D: usize> {
    neighbours: [[Option<NeighbourChannels<T>>; 2]; D],
}

impl<T, const D: usize> Default for Channels<T, D> {
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

impl<T, const D: usize> Channels<T, D> {
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
            Some(NeighbourChannels { sender, receiver, spare_messages: Vec::new() })
        };
        channels[lower].neighbours[axis][1] = neighbour(forth, from_above);
        channels[upper].neighbours[axis][0] = neighbour(back, from_below);
    }
}

impl<T: Copy, const D: usize> HaloExchange<T> for Channels<T, D> {
    type Error = Disconnected;

    fn send(
        &mut self,
        axis: usize,
        end: usize,
        values: &[T],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Disconnected> {
        let Some(neighbour) = &mut self.neighbours[axis][end] else { return Ok(()) };
        let mut message = neighbour.spare_messages.pop().unwrap_or_default();
        message.clear();
        ranges.for_each(|range| message.extend_from_slice(&values[range]));
        neighbour.sender.send(message).map_err(|_| Disconnected)
    }

    fn receive(
        &mut self,
        axis: usize,
        end: usize,
        values: &mut [T],
        ranges: impl Iterator<Item = Range<usize>>,
    ) -> Result<(), Disconnected> {
        let Some(neighbour) = &mut self.neighbours[axis][end] else { return Ok(()) };
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
