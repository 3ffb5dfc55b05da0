//! Distribution of the subdomains of a domain over ranks.
//!
//! All ranks plan the same decomposition. A rank owns a box of subdomains, one per thread, side by side along the last
//! axis. What concerns the whole domain is computed by all ranks together: values by cell are collected by the root, in
//! the order of the ranks; sums are exact, and all ranks get the same ones.

use super::communicator::Communicator;
use super::messages::{append_indices, append_list, take_indices, take_list};
use super::plan::Decomposition;
use crate::simd::Real;
use crate::solid::ledger::Sums;
use crate::solid::region::Region;
use std::sync::Arc;

/// Ranks among which the subdomains of a domain are distributed.
pub(super) struct Ranks<const D: usize> {
    pub(super) communicator: Arc<dyn Communicator>,
    /// Regions of the subdomains by rank and thread.
    pub(super) regions: Vec<Vec<Region<D>>>,
}

/// Rank that owns a subdomain, and the index of the subdomain among those of the rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Owner {
    pub(super) rank: usize,
    pub(super) thread: usize,
}

impl<const D: usize> Ranks<D> {
    /// Distributes the subdomains of a plan, of which each rank owns `threads` along the last axis.
    pub(super) fn new(
        communicator: Arc<dyn Communicator>,
        plan: &Decomposition<D>,
        threads: usize,
    ) -> Self {
        let mut regions = vec![Vec::new(); communicator.size()];
        for (index, region) in plan.regions().iter().enumerate() {
            // Subdomains of a rank follow each other in the order of the plan.
            if let Some(own) = regions.get_mut(plan.owner(index, threads).rank) {
                own.push(region.clone());
            }
        }
        Self { communicator, regions }
    }

    /// Returns the exact sums over all ranks.
    pub(super) fn add_up<S: Sums>(&self, own: &S) -> S {
        let encode = |sums: &S| {
            let mut message = Vec::new();
            sums.to_terms().iter().for_each(|terms| append_list(&mut message, terms));
            message
        };
        let decode = |mut message: &[u8]| {
            let mut terms = Vec::new();
            while !message.is_empty() {
                terms.push(take_list(&mut message));
            }
            S::from_terms(&terms)
        };
        let mut sums = S::default();
        self.communicator.gather(encode(own), &mut |_, message| sums.merge(&decode(&message)));
        decode(&self.communicator.broadcast(encode(&sums)))
    }

    /// Returns the smallest of the lists `own` of all ranks in lexicographic order; `None` if no rank has one.
    pub(super) fn find_least(&self, own: Option<[usize; 2]>) -> Option<[usize; 2]> {
        let encode = |list: Option<[usize; 2]>| {
            let mut message = Vec::new();
            append_indices(&mut message, list.as_ref().map_or(&[], |list| list));
            message
        };
        let decode = |message: Vec<u8>| take_indices(&mut message.as_slice()).try_into().ok();
        let mut least: Option<[usize; 2]> = None;
        self.communicator.gather(encode(own), &mut |_, message| {
            least = least.into_iter().chain(decode(message)).min();
        });
        decode(self.communicator.broadcast(encode(least)))
    }

    /// Returns the indices `own` of the root.
    pub(super) fn broadcast_indices<const N: usize>(&self, own: [usize; N]) -> [usize; N] {
        let mut message = Vec::new();
        append_indices(&mut message, &own);
        let received = self.communicator.broadcast(message);
        take_indices(&mut received.as_slice()).try_into().unwrap_or(own)
    }

    /// Returns, by subdomain of this rank, the values of the root in those cells of the whole grid that `cells` selects
    /// for the region of the subdomain.
    pub(super) fn scatter_values<T: Real>(
        &self,
        values: &[T],
        cells: impl Fn(&Region<D>) -> Vec<usize>,
    ) -> Vec<Vec<T>> {
        let received = self.communicator.scatter(&mut |rank| {
            let mut message = Vec::new();
            for region in &self.regions[rank] {
                let needed = cells(region).into_iter().filter_map(|cell| values.get(cell)).copied();
                append_list(&mut message, &needed.collect::<Vec<T>>());
            }
            message
        });
        let mut message = received.as_slice();
        let own = self.regions[self.communicator.rank()].iter();
        own.map(|_| take_list(&mut message)).collect()
    }
}
