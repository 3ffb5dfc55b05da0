//! Decomposition plan: subdomains of a grid and their neighbours.
//!
//! The positions of the cuts along the axes are given. A process decomposes its cells along one axis alone, as a rule the
//! last one, with one subdomain per thread, or several where few long rows are cut:
//! [`DecomposedDomain::with_first_axis`](super::DecomposedDomain::with_first_axis). Several ranks decompose the grid along
//! all axes: [`RankPlan`](super::RankPlan).

use super::ranks::Owner;
use crate::solid::domain::max_pass_steps;
use crate::solid::problem::{DomainError, Grid, PassLimits};
use crate::solid::region::Region;

/// Decomposition of a grid into subdomains: a Cartesian array of boxes between cuts across each axis.
///
/// Subdomains are numbered with the first axis fastest. The halo is [`PassLimits::halo`] cells wide per step of a pass, plus
/// [`PassLimits::first_axis_halo`] along the first axis. Edges and corners of the halo hold cells of diagonal
/// neighbours, which the exchange along one axis after the other passes on.
#[derive(Clone, Debug)]
pub struct Decomposition<const D: usize> {
    subdomain_counts: [usize; D],
    is_periodic: [bool; D],
    regions: Vec<Region<D>>,
    max_pass_steps: usize,
}

impl<const D: usize> Decomposition<D> {
    /// Plans `subdomain_counts` subdomains along each axis of a grid, whose numbers of cells along an axis differ by at
    /// most one; other arguments and errors as for [`with_cuts`](Self::with_cuts).
    ///
    /// # Errors
    /// See [`with_cuts`](Self::with_cuts).
    pub fn new(
        grid: &Grid<D>,
        is_periodic: [bool; D],
        limits: PassLimits,
        subdomain_counts: [usize; D],
    ) -> Result<Self, DomainError> {
        Self::with_cuts(grid, is_periodic, limits, &uniform_cuts(grid, subdomain_counts))
    }

    /// Plans the subdomains between `cuts` across each axis of a grid, both ends of the grid included; `is_periodic`:
    /// whether each axis is periodic; `limits` of passes
    /// ([`Problem::pass_limits`](crate::solid::problem::Problem::pass_limits)).
    ///
    /// # Errors
    /// [`DomainError::SubdomainCount`] if the number of subdomains along an axis is zero, or if one of several
    /// subdomains has fewer cells than the halo of its neighbour for one step.
    pub fn with_cuts(
        grid: &Grid<D>,
        is_periodic: [bool; D],
        limits: PassLimits,
        cuts: &[Vec<usize>; D],
    ) -> Result<Self, DomainError> {
        let subdomain_counts = cuts.each_ref().map(|own| own.len().saturating_sub(1));
        let narrowest = |axis: usize| {
            let widths = cuts[axis].windows(2).map(|own| own[1] - own[0]);
            widths.min().unwrap_or(grid.cells[axis])
        };
        let mut steps = max_pass_steps::<D>(narrowest(D - 1), limits.halo).min(limits.max_steps);
        for (axis, &found) in subdomain_counts.iter().enumerate() {
            let min_cells = min_part_cells(axis, limits);
            if found == 0 || (found > 1 && narrowest(axis) < min_cells) {
                let cells = grid.cells[axis];
                return Err(DomainError::SubdomainCount { axis, actual: found, cells, min_cells });
            }
            if found > 1 {
                let extra_halo = min_cells - limits.halo;
                steps = steps.min(max_pass_steps::<D>(narrowest(axis) - extra_halo, limits.halo));
            }
        }
        let region = |subdomain: usize| {
            let position = subdomain_position(subdomain, &subdomain_counts);
            let halo = std::array::from_fn(|axis| {
                // On a periodic last axis with a single subdomain, the halo holds copies of the layers at the opposite
                // end.
                let has_periodic_halo =
                    is_periodic[axis] && (subdomain_counts[axis] > 1 || axis + 1 == D);
                let has_neighbours =
                    [position[axis] > 0, position[axis] + 1 < subdomain_counts[axis]];
                has_neighbours.map(|has_neighbour| {
                    if has_neighbour || has_periodic_halo {
                        (steps - 1) * limits.halo + min_part_cells(axis, limits)
                    } else {
                        0
                    }
                })
            });
            Region::new(
                grid.cells,
                std::array::from_fn(|axis| {
                    cuts[axis][position[axis]]..cuts[axis][position[axis] + 1]
                }),
                halo,
            )
        };
        let count: usize = subdomain_counts.iter().product();
        Ok(Self {
            subdomain_counts,
            is_periodic,
            regions: (0..count).map(region).collect(),
            max_pass_steps: steps,
        })
    }

    /// Returns the regions of all subdomains.
    pub fn regions(&self) -> &[Region<D>] {
        &self.regions
    }

    /// Returns the neighbour of a subdomain at an end (0: lower, 1: upper) of an axis, as index; `None` at an end
    /// of the grid along an axis that is not periodic, and along an axis with a single subdomain.
    pub fn neighbour(&self, subdomain: usize, axis: usize, end: usize) -> Option<usize> {
        let count = self.subdomain_counts[axis];
        let stride: usize = self.subdomain_counts[..axis].iter().product();
        let position = subdomain / stride % count;
        let is_last = position == [0, count - 1][end];
        if count == 1 || (is_last && !self.is_periodic[axis]) {
            return None;
        }
        let neighbour_position = (position + [count - 1, 1][end]) % count;
        Some(subdomain - position * stride + neighbour_position * stride)
    }

    /// Returns the rank that owns a subdomain if each rank owns a box of `threads` subdomains along the last axis. Ranks
    /// are numbered with the first axis fastest.
    pub(super) fn owner(&self, subdomain: usize, threads: usize) -> Owner {
        let in_layer: usize = self.subdomain_counts[..D - 1].iter().product();
        let layer = subdomain / in_layer;
        Owner { rank: layer / threads * in_layer + subdomain % in_layer, thread: layer % threads }
    }

    /// Returns the maximum number of steps of a pass, for which one halo exchange suffices.
    pub fn max_pass_steps(&self) -> usize {
        self.max_pass_steps
    }
}

/// Returns the smallest number of cells along an axis of one of several parts: that of the halo of its neighbour for one
/// step.
pub(super) const fn min_part_cells(axis: usize, limits: PassLimits) -> usize {
    limits.halo + if axis == 0 { limits.first_axis_halo } else { 0 }
}

/// Returns cuts between `counts` parts along each axis of a grid, whose numbers of cells along an axis differ by at most
/// one.
pub(super) fn uniform_cuts<const D: usize>(grid: &Grid<D>, counts: [usize; D]) -> [Vec<usize>; D] {
    std::array::from_fn(|axis| {
        let (count, cells) = (counts[axis], grid.cells[axis]);
        (0..=count).map(|index| index * cells / count.max(1)).collect()
    })
}

/// Returns cuts between `count` parts of nearly the same work across an axis; `work`: that of each layer of cells.
/// A part has at least `min_cells` layers, of which there must be enough.
pub(super) fn cut_by_work(work: &[u64], count: usize, min_cells: usize) -> Vec<usize> {
    let mut sums: Vec<u128> = vec![0];
    for own in work {
        sums.push(sums[sums.len() - 1] + u128::from(*own));
    }
    let (count_of_all, total) = (count as u128, sums[work.len()]);
    let nearest = |index: usize| {
        // Both multiplied by the number of parts, so that the comparison is exact.
        let wanted = index as u128 * total;
        let above = sums.partition_point(|sum| sum * count_of_all < wanted);
        let distance = |place: usize| (sums[place] * count_of_all).abs_diff(wanted);
        match above.checked_sub(1) {
            Some(below) if distance(below) < distance(above) => below,
            _ => above,
        }
    };
    let mut cuts: Vec<usize> = (0..=count).map(nearest).collect();
    cuts[0] = 0;
    for index in 1..=count {
        cuts[index] = cuts[index].max(cuts[index - 1] + min_cells);
    }
    cuts[count] = work.len();
    for index in (1..count).rev() {
        cuts[index] = cuts[index].min(cuts[index + 1].saturating_sub(min_cells));
    }
    cuts
}

/// Returns the numbers of parts along the axes of a grid for `rank_count` ranks, with the least surface of all cuts
/// together; of several such ones, that with fewest cuts along the first axes. Arguments as in [`Decomposition::new`].
///
/// # Errors
/// [`DomainError::RankCount`] if some part would have fewer cells than the halo of its neighbour for one step.
pub(super) fn plan_rank_counts<const D: usize>(
    grid: &Grid<D>,
    is_periodic: [bool; D],
    limits: PassLimits,
    rank_count: usize,
) -> Result<[usize; D], DomainError> {
    let cut_faces = |counts: &[usize; D]| -> usize {
        let cuts = |axis: usize| match counts[axis] {
            1 => 0,
            count => count - usize::from(!is_periodic[axis]),
        };
        (0..D).map(|axis| cuts(axis) * grid.faces(axis)).sum()
    };
    // All products of D factors.
    let divisors = |number: usize| (1..=number).filter(move |own| number.is_multiple_of(*own));
    let mut factorisations = vec![([1; D], rank_count)];
    for axis in 0..D - 1 {
        let split = |(counts, rest): ([usize; D], usize)| {
            divisors(rest).map(move |own| {
                let mut counts = counts;
                counts[axis] = own;
                (counts, rest / own)
            })
        };
        factorisations = factorisations.into_iter().flat_map(split).collect();
    }
    let with_last = factorisations.into_iter().map(|(mut counts, rest)| {
        counts[D - 1] = rest;
        counts
    });
    with_last
        .filter(|counts| fits(grid, limits, counts))
        .min_by_key(|counts| (cut_faces(counts), *counts))
        .ok_or(DomainError::RankCount { ranks: rank_count, cells: grid.count() })
}

/// Returns whether all of `counts` parts along the axes can have as many cells as the halos of their neighbours.
pub(super) fn fits<const D: usize>(
    grid: &Grid<D>,
    limits: PassLimits,
    counts: &[usize; D],
) -> bool {
    (0..D).all(|axis| {
        let min_cells = min_part_cells(axis, limits);
        counts[axis] == 1 || grid.cells[axis] / counts[axis] >= min_cells
    })
}

/// Returns the position of a subdomain along each axis; `subdomain_counts`: numbers of subdomains along the
/// axes.
fn subdomain_position<const D: usize>(
    mut subdomain: usize,
    subdomain_counts: &[usize; D],
) -> [usize; D] {
    subdomain_counts.map(|count| {
        let position = subdomain % count;
        subdomain /= count;
        position
    })
}

#[cfg(test)]
mod tests {
    use super::{Decomposition, cut_by_work, plan_rank_counts};
    use crate::decomposition::ranks::Owner;
    use crate::solid::problem::{DomainError, Grid, PassLimits};

    #[test]
    fn regions_tile_the_grid() {
        let grid = Grid { cells: [23, 9, 17], spacing: [1.0; 3] };
        let limits = PassLimits { halo: 4, first_axis_halo: 0, max_steps: 2 };
        let plan =
            Decomposition::new(&grid, [true, false, false], limits, [3, 2, 4]).expect("sound");
        let mut owners = vec![0; grid.count()];
        for region in plan.regions() {
            region.owned_global_cells().into_iter().for_each(|cell| owners[cell] += 1);
        }
        assert!(owners.iter().all(|count| *count == 1));
        // The neighbour relation is symmetric.
        for subdomain in 0..24 {
            for (axis, end) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                let neighbour = plan.neighbour(subdomain, axis, end);
                assert_eq!(
                    neighbour.is_some(),
                    plan.regions()[subdomain].has_neighbours(axis)[end]
                );
                if let Some(neighbour) = neighbour {
                    assert_eq!(plan.neighbour(neighbour, axis, 1 - end), Some(subdomain));
                }
            }
        }
        assert_eq!(plan.neighbour(0, 0, 0), Some(2));
        assert_eq!(plan.neighbour(0, 1, 1), Some(3));
        let refused = Decomposition::new(&grid, [false; 3], limits, [1, 3, 1]);
        assert!(matches!(
            refused,
            Err(DomainError::SubdomainCount { axis: 1, actual: 3, cells: 9, min_cells: 4 })
        ));
    }

    #[test]
    fn cuts_balance_the_work() {
        assert_eq!(cut_by_work(&[1; 10], 4, 1), [0, 3, 5, 8, 10]);
        // Half of the work is in the last third.
        let work: Vec<u64> = (0..30).map(|layer| if layer < 20 { 1 } else { 2 }).collect();
        assert_eq!(cut_by_work(&work, 2, 4), [0, 20, 30]);
        assert_eq!(cut_by_work(&work, 4, 4), [0, 10, 20, 25, 30]);
        // Parts have as many cells as halos need, although the work is in one layer.
        let mut single = vec![1; 16];
        for place in [0, 7, 15] {
            single[place] = 1000;
            assert_eq!(cut_by_work(&single, 4, 4), [0, 4, 8, 12, 16]);
            let cuts = cut_by_work(&single, 3, 4);
            assert!(cuts.windows(2).all(|own| own[1] >= own[0] + 4) && cuts[3] == 16, "{cuts:?}");
            single[place] = 1;
        }
        assert_eq!(cut_by_work(&[0; 8], 2, 4), [0, 4, 8]);
    }

    #[test]
    fn ranks_own_neighbouring_subdomains() {
        let grid = Grid { cells: [40, 80], spacing: [1.0; 2] };
        let limits = PassLimits { halo: 4, first_axis_halo: 0, max_steps: 1 };
        // 2 × 3 ranks with two threads each.
        let plan = Decomposition::new(&grid, [false; 2], limits, [2, 6]).expect("sound");
        let owners: Vec<Owner> = (0..12).map(|index| plan.owner(index, 2)).collect();
        let ranks: Vec<usize> = owners.iter().map(|owner| owner.rank).collect();
        assert_eq!(ranks, [0, 1, 0, 1, 2, 3, 2, 3, 4, 5, 4, 5]);
        let threads: Vec<usize> = owners.iter().map(|owner| owner.thread).collect();
        assert_eq!(threads, [0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1]);
    }

    #[test]
    fn rank_counts_have_the_least_surface() {
        let limits = PassLimits { halo: 4, first_axis_halo: 2, max_steps: 1 };
        let plane = |cells: [usize; 2], periodic, ranks| {
            plan_rank_counts(&Grid { cells, spacing: [1.0; 2] }, periodic, limits, ranks).ok()
        };
        // Of equal surfaces, cuts along the last axis come first.
        assert_eq!(plane([100, 100], [false; 2], 2), Some([1, 2]));
        assert_eq!(plane([100, 100], [false; 2], 4), Some([2, 2]));
        assert_eq!(plane([300, 100], [false; 2], 4), Some([4, 1]));
        // 2·100 + 1·300 of [3, 2] equal 5·100 of [6, 1].
        assert_eq!(plane([300, 100], [false; 2], 6), Some([3, 2]));
        assert_eq!(plane([100, 100], [false; 2], 7), Some([1, 7]));
        // A periodic axis has one cut more: 2·100 + 1·120 of [2, 2] exceed 3·100 of [1, 4].
        assert_eq!(plane([100, 120], [true, false], 4), Some([1, 4]));
        // Parts need 6 cells along the first axis and 4 along the last.
        assert_eq!(plane([17, 12], [false; 2], 6), Some([2, 3]));
        assert_eq!(plane([17, 12], [false; 2], 7), None);
        let space = Grid { cells: [64, 32, 32], spacing: [1.0; 3] };
        let counts = |ranks| plan_rank_counts(&space, [false; 3], limits, ranks).ok();
        // 1·32² + 1·32·64 + 1·32·64 = 5120 of [2, 2, 2] against 3·32² + 1·32·64 = 5120 of [4, 1, 2].
        assert_eq!((counts(2), counts(8)), (Some([2, 1, 1]), Some([2, 2, 2])));
    }
}
