//! Plan of the distribution of the cells of a problem over ranks. All ranks make the same plan; a single process can make
//! it to show it.
//!
//! The grid is cut into a Cartesian array of boxes, one per rank: the numbers of boxes along the axes have the least
//! surface of all cuts together, and cuts across an axis are where they balance the work of the layers of cells, counted
//! by medium ([`Medium::relative_work`](crate::solid::medium::Medium::relative_work)). Each rank cuts its box along the
//! last axis into one subdomain per thread by the same rule. Results do not depend on the cuts.

use super::communicator::Communicator;
use super::messages::{append_indices, take_indices};
use super::plan::{
    Decomposition, cut_by_work, fits, min_part_cells, plan_rank_counts, uniform_cuts,
};
use super::ranks::enclose_regions;
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::domain::{SolverReal, message_volumes};
use crate::solid::problem::{DomainError, Grid, PassLimits, Problem};
use crate::solid::region::Region;
use std::ops::Range;

/// Numbers of ranks, threads and parts for a [`RankPlan`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RankCounts {
    /// Number of ranks.
    pub ranks: usize,
    /// Maximum number of threads of each rank.
    pub threads: usize,
    /// Numbers of parts along the axes of the problem; `None` for those with the least surface.
    pub parts: Option<Vec<usize>>,
}

/// Distribution of the cells of a problem over ranks.
#[derive(Clone, Debug)]
pub struct RankPlan<const D: usize> {
    pub(super) permutation: AxisPermutation<D>,
    grid: Grid<D>,
    is_periodic: [bool; D],
    limits: PassLimits,
    /// Cuts between subdomains across the permuted axes.
    pub(super) cuts: [Vec<usize>; D],
    /// Number of subdomains of each rank, side by side along the last axis.
    pub(super) threads: usize,
}

/// Part of a rank, and what it exchanges with other ranks.
#[derive(Clone, Debug, PartialEq)]
pub struct RankPart<const D: usize> {
    /// Cells along the axes of the problem.
    pub cells: [Range<usize>; D],
    /// Number of cells in memory: those of all subdomains with their halos.
    pub stored_cells: usize,
    /// Number of faces of cells at cuts between this rank and others.
    pub surface: usize,
    /// Number of ranks beyond these faces, counted once for each end of an axis.
    pub neighbours: usize,
    /// Mean number of messages sent to other ranks in a step.
    pub messages_per_step: f64,
    /// Mean number of bytes sent to other ranks in a step.
    pub bytes_per_step: f64,
    /// Of these, mean numbers of bytes that are copied cell by cell: sent along the axis that is swept first, and along
    /// those between it and the last one.
    pub copied_bytes_per_step: [f64; 2],
}

impl<const D: usize> RankPlan<D> {
    /// Plans the distribution for [`DecomposedDomain::with_rank_plan`](super::DecomposedDomain::with_rank_plan), with
    /// `first_axis` swept first. The ranks of `communicator` count the work together: all of them must call it.
    ///
    /// # Errors
    /// [`DomainError::RankCount`] if the grid cannot be cut into so many parts, [`DomainError::PartCounts`] if the given
    /// numbers of parts do not multiply to that of ranks.
    pub fn new(
        first_axis: usize,
        problem: &Problem<D>,
        counts: &RankCounts,
        communicator: &dyn Communicator,
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        let grid = permutation.permute_grid(&problem.grid);
        let wraps_around = std::array::from_fn(|axis| problem.wraps_around(axis));
        let is_periodic = permutation.permute_axis_values(wraps_around);
        let (limits, ranks) = (problem.pass_limits(), counts.ranks);
        let mut part_counts = match &counts.parts {
            None => plan_rank_counts(&grid, is_periodic, limits, ranks)?,
            Some(parts) => {
                let refused = || DomainError::PartCounts { parts: parts.clone(), ranks };
                let own: [usize; D] = parts.as_slice().try_into().map_err(|_| refused())?;
                if own.iter().product::<usize>() != ranks {
                    return Err(refused());
                }
                let own = permutation.permute_axis_values(own);
                match fits(&grid, limits, &own) {
                    true => own,
                    false => return Err(DomainError::RankCount { ranks, cells: grid.count() }),
                }
            }
        };
        let layers_per_rank = grid.cells[D - 1] / part_counts[D - 1];
        let threads = counts.threads.clamp(1, (layers_per_rank / limits.halo).max(1));
        part_counts[D - 1] *= threads;
        let cuts = match count_layer_work(problem, communicator) {
            None => uniform_cuts(&grid, part_counts),
            Some(work) => {
                let axes = permutation.permute_axis_values(std::array::from_fn(|axis| axis));
                std::array::from_fn(|axis| match part_counts[axis] {
                    1 => vec![0, grid.cells[axis]],
                    count => cut_by_work(&work[axes[axis]], count, min_part_cells(axis, limits)),
                })
            }
        };
        Ok(Self { permutation, grid, is_periodic, limits, cuts, threads })
    }

    /// Returns the numbers of parts along the axes of the problem.
    pub fn part_counts(&self) -> [usize; D] {
        let mut counts = self.cuts.each_ref().map(|own| own.len() - 1);
        counts[D - 1] /= self.threads;
        self.permutation.unpermute_axis_values(counts)
    }

    /// Returns the number of threads of each rank.
    pub const fn threads(&self) -> usize {
        self.threads
    }

    /// Returns the cells of a rank along the axes of the problem.
    ///
    /// # Errors
    /// See [`Decomposition::with_cuts`].
    pub fn own_cells(&self, rank: usize) -> Result<[Range<usize>; D], DomainError> {
        let plan = self.decompose()?;
        let regions = plan.regions().iter().enumerate();
        let own = regions.filter(|(index, _)| plan.owner(*index, self.threads).rank == rank);
        let cells = enclose_regions(own.map(|(_, region)| region));
        Ok(self.permutation.unpermute_axis_values(cells))
    }

    /// Returns the parts of all ranks; `problem`: that of the plan, in numbers of type `T`.
    ///
    /// # Errors
    /// See [`Decomposition::with_cuts`].
    pub fn parts<T: SolverReal>(
        &self,
        problem: &Problem<D>,
    ) -> Result<Vec<RankPart<D>>, DomainError> {
        let problem = &self.permutation.check_and_permute(problem)?;
        let plan = self.decompose()?;
        let mut regions: Vec<Vec<(usize, &Region<D>)>> = Vec::new();
        for (index, region) in plan.regions().iter().enumerate() {
            let rank = plan.owner(index, self.threads).rank;
            regions.resize_with(regions.len().max(rank + 1), Vec::new);
            regions[rank].push((index, region));
        }
        let part = |(rank, own): (usize, &Vec<(usize, &Region<D>)>)| {
            let cells = enclose_regions(own.iter().map(|(_, region)| *region));
            let mut part = RankPart {
                stored_cells: own.iter().map(|(_, region)| region.count()).sum(),
                surface: 0,
                neighbours: 0,
                messages_per_step: 0.0,
                bytes_per_step: 0.0,
                copied_bytes_per_step: [0.0; 2],
                cells: self.permutation.unpermute_axis_values(cells),
            };
            let steps = plan.max_pass_steps() as f64;
            for (index, region) in own {
                let volumes = message_volumes::<T, D>(problem, region);
                for (axis, end) in (0..D).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                    let neighbour = plan.neighbour(*index, axis, end);
                    let is_other = |own: &usize| plan.owner(*own, self.threads).rank != rank;
                    if neighbour.filter(is_other).is_none() {
                        continue;
                    }
                    let owned = region.owned_counts();
                    part.surface += owned.iter().product::<usize>() / owned[axis];
                    part.neighbours += 1;
                    part.messages_per_step += volumes[axis][end].messages as f64 / steps;
                    let bytes = volumes[axis][end].bytes as f64 / steps;
                    part.bytes_per_step += bytes;
                    if axis + 1 < D {
                        part.copied_bytes_per_step[usize::from(axis > 0)] += bytes;
                    }
                }
            }
            part
        };
        Ok(regions.iter().enumerate().map(part).collect())
    }

    /// Returns the work of a step in the cells of a part, in units of
    /// [`Medium::relative_work`](crate::solid::medium::Medium::relative_work).
    pub fn work(&self, problem: &Problem<D>, part: &RankPart<D>) -> u64 {
        let work: Vec<u64> = problem.media.iter().map(|own| own.relative_work()).collect();
        let region = Region::from_box(problem.grid.cells, part.cells.clone());
        match work.iter().all(|own| *own == work[0]) {
            true => region.count() as u64 * work[0],
            false => {
                region.owned_global_cell_iter().map(|cell| work[problem.medium_index(cell)]).sum()
            }
        }
    }

    fn decompose(&self) -> Result<Decomposition<D>, DomainError> {
        Decomposition::with_cuts(&self.grid, self.is_periodic, self.limits, &self.cuts)
    }
}

/// Counts the work of the layers of cells across each axis of a problem, of which each rank counts a part; `None` if all
/// media have the same. All ranks call it.
fn count_layer_work<const D: usize>(
    problem: &Problem<D>,
    communicator: &dyn Communicator,
) -> Option<[Vec<u64>; D]> {
    let work: Vec<u64> = problem.media.iter().map(|own| own.relative_work()).collect();
    if work.iter().all(|own| *own == work[0]) {
        return None;
    }
    let (cells, count) = (problem.grid.cells, problem.grid.count());
    let mut sums: [Vec<usize>; D] = cells.map(|own| vec![0; own]);
    let (rank, size) = (communicator.rank() as u128, communicator.size() as u128);
    let start = |rank: u128| (rank * count as u128 / size) as usize;
    for cell in start(rank)..start(rank + 1) {
        let own = work[problem.medium_index(cell)] as usize;
        let mut rest = cell;
        for (sums, count) in sums.iter_mut().zip(cells) {
            sums[rest % count] += own;
            rest /= count;
        }
    }
    let encode = |sums: &[Vec<usize>; D]| {
        let mut message = Vec::new();
        sums.iter().for_each(|own| append_indices(&mut message, own));
        message
    };
    let mut totals: [Vec<usize>; D] = cells.map(|own| vec![0; own]);
    communicator.gather(encode(&sums), &mut |_, message| {
        let mut message = message.as_slice();
        for totals in &mut totals {
            let own = take_indices(&mut message);
            totals.iter_mut().zip(own).for_each(|(total, own)| *total += own);
        }
    });
    let message = communicator.broadcast(encode(&totals));
    let mut message = message.as_slice();
    Some(std::array::from_fn(|_| {
        take_indices(&mut message).into_iter().map(|own| own as u64).collect()
    }))
}
