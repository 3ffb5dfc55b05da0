//! Distribution of the subdomains of a domain over ranks.
//!
//! All ranks plan the same decomposition. A rank owns a box of subdomains, one per thread, side by side along the last
//! axis, and the values of their cells. What concerns the whole domain is computed by all ranks together: sums are exact,
//! and all ranks get the same ones.

use super::communicator::Communicator;
use super::messages::{append_indices, append_list, append_numbers, take_indices, take_list};
use super::plan::Decomposition;
use crate::simd::Real;
use crate::solid::ledger::Sums;
use crate::solid::region::Region;
use std::ops::Range;
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

    /// Passes to the other ranks those values of the box `cells` of this rank that their halos hold, and those of the
    /// other ranks to `take`, by cell of each of the regions of this rank: number of the region, cell of it, value.
    pub(super) fn exchange_halos<T: Real>(
        &self,
        cells: &[Range<usize>; D],
        values: &[T],
        mut take: impl FnMut(usize, &mut dyn Iterator<Item = (usize, T)>),
    ) {
        let own = self.communicator.rank();
        let others = || (0..self.regions.len()).filter(|rank| *rank != own);
        for rank in others() {
            let regions = self.regions[rank].iter();
            let needed = regions.flat_map(|region| region.cells_in_box(cells));
            let needed = needed.filter_map(|[_, cell]| values.get(cell)).copied();
            let mut message = Vec::new();
            append_numbers(&mut message, &needed.collect::<Vec<T>>());
            if !message.is_empty() {
                self.communicator.send_any_length(rank, message);
            }
        }
        for rank in others() {
            let cells = enclose_regions(self.regions[rank].iter());
            let needed = || self.regions[own].iter().map(|region| region.cells_in_box(&cells));
            if needed().flatten().next().is_none() {
                continue;
            }
            let message = self.communicator.receive_any_length(rank);
            let mut received = T::from_bytes(&message).unwrap_or_default().into_iter();
            for (index, needed) in needed().enumerate() {
                take(index, &mut needed.map(|[cell, _]| cell).zip(&mut received));
            }
        }
    }
}

/// Returns the box of the owned cells of regions side by side.
pub(super) fn enclose_regions<'a, const D: usize>(
    regions: impl Iterator<Item = &'a Region<D>>,
) -> [Range<usize>; D] {
    let own = |region: &Region<D>| std::array::from_fn(|axis| region.owned_range(axis));
    let enclose = |one: [Range<usize>; D], other: [Range<usize>; D]| {
        std::array::from_fn(|axis| {
            one[axis].start.min(other[axis].start)..one[axis].end.max(other[axis].end)
        })
    };
    regions.map(own).reduce(enclose).unwrap_or_else(|| std::array::from_fn(|_| 0..0))
}
