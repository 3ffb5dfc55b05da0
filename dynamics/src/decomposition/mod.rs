//! Domain decomposition: subdomains of a grid, each on its own thread, of one process or of several ranks.
//!
//! In each pass over memory a subdomain receives a halo of
//! [`PassLimits::halo`](crate::solid::problem::PassLimits::halo) cells per step of the pass (more along the first
//! axis for alternating sweeps, see [`Decomposition`]) and advances the halo cells redundantly. Every cell undergoes
//! the same operations as without decomposition, and sums over cells are exact: results are identical bit for bit.
//! Along the last axis, layers are exchanged during the pass. The upper halo is received last: a subdomain can
//! therefore be almost one block of rows ahead of its upper neighbour, and short delays do not propagate. Along the
//! other axes the exchange precedes the pass, see [`HaloExchange`](crate::solid::domain::HaloExchange).
//!
//! A grid of few long rows is cut along them, into several subdomains for each thread: a few steps of each fit in the
//! cache. Such a thread sends the halos of all its subdomains before it advances the first of them.

mod channels;
pub mod communicator;
mod messages;
#[cfg(unix)]
pub mod mpi;
mod plan;
mod rank_plan;
mod ranks;
mod records;
mod state;
mod threads;
mod values;

use crate::simd::InstructionSet;
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::domain::{Domain, SolverReal};
use crate::solid::problem::{DomainError, Problem};
use crate::solid::region::Region;
use crate::solid::snapshot::StatePart;
use channels::{Channels, Disconnected};
use communicator::Communicator;
use models::solid::waves::SolidField;
use plan::{min_part_cells, uniform_cuts};
use ranks::{Owner, Ranks};
use std::ops::Range;
use std::sync::Arc;
use threads::{SystemThreads, run_concurrently};

pub use crate::solid::snapshot::Snapshot;
pub use plan::Decomposition;
pub use rank_plan::{RankCounts, RankPart, RankPlan};
pub use threads::ThreadStartError;
#[doc(hidden)]
pub use threads::ThreadStarter;

/// Smallest number of rows that pass the stages of a step in tiles, a few rows at a time in the cache.
const MIN_TILED_ROWS: usize = 8;

/// Size of the fields of a subdomain that passes a step in the private cache of a core, bytes.
const CACHED_PART_BYTES: usize = 1 << 19;

/// Smallest number of cells that a thread advances where the grid is cut along rows: two steps take some ten microseconds.
const MIN_THREAD_CELLS: usize = 2048;

/// A subdomain with its halo, channels and records.
struct Subdomain<T: SolverReal, const D: usize> {
    domain: Domain<T, D>,
    region: Region<D>,
    channels: Channels<T, D>,
    /// Cells recorded after each step: index in the list of all watched cells, and index among the owned cells.
    watched_cells: Vec<(usize, usize)>,
    /// Records of the watched cells: all output quantities, by step and cell.
    records: Vec<f64>,
}

/// Subdomains that a thread advances. If it ends early, by a panic or since a neighbour has, the channels are dropped, so
/// that receiving fails in the neighbouring threads instead of blocking.
struct ConnectedSubdomains<'a, T: SolverReal, const D: usize> {
    subdomains: &'a mut [Subdomain<T, D>],
    is_finished: bool,
}

impl<T: SolverReal, const D: usize> Drop for ConnectedSubdomains<'_, T, D> {
    fn drop(&mut self) {
        if !self.is_finished {
            self.subdomains.iter_mut().for_each(|own| own.channels = Channels::default());
        }
    }
}

impl<T: SolverReal, const D: usize> Subdomain<T, D> {
    /// Advances the subdomains of a thread.
    fn advance_all(subdomains: &mut [Self], steps: usize) -> Result<(), Disconnected> {
        let mut own = ConnectedSubdomains { subdomains, is_finished: false };
        let max_pass_steps = own.subdomains.first().map_or(1, |own| own.domain.max_pass_steps());
        let mut remaining = steps;
        while remaining > 0 {
            let steps = remaining.min(max_pass_steps);
            for Self { domain, channels, .. } in own.subdomains.iter_mut() {
                domain.begin_pass(channels)?;
            }
            for Self { domain, channels, records, .. } in own.subdomains.iter_mut() {
                domain.complete_pass(steps, channels)?;
                domain.drain_records(records);
            }
            remaining -= steps;
        }
        own.is_finished = true;
        Ok(())
    }

    /// Returns positions and numbers of history variables of the interlayers at the lower faces of owned cells.
    /// Position: layer of the whole grid across the last axis, axis normal to the face, and global cell above the face.
    /// `layer_cells`: number of cells of a layer of the whole grid.
    fn interlayer_positions(&self, layer_cells: usize) -> Vec<([usize; 3], usize)> {
        let cells = self.region.owned_global_cells();
        let faces = self.domain.interlayer_faces().into_iter();
        faces
            .map(|[axis, cell, variables]| {
                ([cells[cell] / layer_cells, axis, cells[cell]], variables)
            })
            .collect()
    }
}

/// A domain decomposed into subdomains, all of this process or some of each rank.
///
/// With several ranks, all of them call the same methods in the same order. Values by cell are then those of the cells of
/// the rank, a box of the grid; sums and places are the same at all ranks, and records of cells are complete at the root.
pub struct DecomposedDomain<T: SolverReal, const D: usize> {
    subdomains: Vec<Subdomain<T, D>>,
    /// Number of consecutive subdomains that a thread advances; several only if all cuts are across the first axis.
    subdomains_per_thread: usize,
    /// Permutation from the axes of the problem to those of the subdomains.
    permutation: AxisPermutation<D>,
    /// Number of cells of the whole grid along each permuted axis.
    cells: [usize; D],
    /// Cells of the subdomains of this process along each permuted axis.
    own_cells: [Range<usize>; D],
    /// Number of watched cells, those outside the grid included.
    watched_cell_count: usize,
    /// Ranks among which the subdomains are distributed; `None` if this process owns all of them.
    ranks: Option<Ranks<D>>,
}

impl<T: SolverReal, const D: usize> DecomposedDomain<T, D> {
    /// Creates a domain at rest, decomposed into `count` subdomains along its last axis.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>, count: usize) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem, count)
    }

    /// Returns how many of at most `count` threads [`with_first_axis`](Self::with_first_axis) can use, fewer where they
    /// would spend more time on messages than on cells.
    pub fn usable_threads(first_axis: usize, problem: &Problem<D>, count: usize) -> usize {
        let (axis, room) = Self::choose_cut_axis(first_axis, problem, count);
        let useful = if axis == 0 { problem.grid.count() / MIN_THREAD_CELLS } else { room };
        useful.clamp(1, room)
    }

    /// Returns the axis of the domain across which it is cut for at most `count` threads, and their maximum number: the
    /// last axis, unless it is too short for so many, and another one has room for more; the first axis if there are so
    /// few rows that they are not tiled.
    fn choose_cut_axis(first_axis: usize, problem: &Problem<D>, count: usize) -> (usize, usize) {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        let cells = permutation.permute_grid(&problem.grid).cells;
        let room = |axis: usize| cells[axis] / min_part_cells(axis, problem.pass_limits());
        let has_few_rows = cells[1..].iter().product::<usize>() < MIN_TILED_ROWS;
        let axes = if has_few_rows { 0..1 } else { 0..D };
        let by_axis = axes.map(|axis| (axis, room(axis).clamp(1, count.max(1))));
        by_axis.max_by_key(|own| own.1).unwrap_or((D - 1, 1))
    }

    /// Creates a domain at rest for `count` threads, with `axis` swept first. The other axes keep their order; the domain
    /// is decomposed along the last of them or, if that is too short, along that with the most room. Few long rows are cut
    /// into more subdomains than threads, so that each passes a step in the cache.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_first_axis(
        axis: usize,
        problem: &Problem<D>,
        count: usize,
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(axis, &problem.grid);
        let grid = permutation.permute_grid(&problem.grid);
        let mut counts = [1; D];
        let (cut_axis, _) = Self::choose_cut_axis(axis, problem, count);
        let mut per_thread = 1;
        if cut_axis == 0 && count > 0 {
            let bytes = grid.count() * problem.fields().len() * size_of::<T>();
            let room = grid.cells[0] / min_part_cells(0, problem.pass_limits());
            per_thread = bytes.div_ceil(count * CACHED_PART_BYTES).min(room / count).max(1);
        }
        counts[cut_axis] = count * per_thread;
        let cuts = uniform_cuts(&grid, counts);
        let own = Self::with_permuted_cuts(problem, permutation, &cuts, None)?;
        Ok(Self { subdomains_per_thread: per_thread, ..own })
    }

    /// Creates a domain at rest, with `subdomain_counts` subdomains along each axis of the problem and with
    /// `first_axis` swept first.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_subdomains(
        first_axis: usize,
        problem: &Problem<D>,
        subdomain_counts: [usize; D],
    ) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(first_axis, &problem.grid);
        let counts = permutation.permute_axis_values(subdomain_counts);
        let cuts = uniform_cuts(&permutation.permute_grid(&problem.grid), counts);
        Self::with_permuted_cuts(problem, permutation, &cuts, None)
    }

    /// Creates a domain at rest that is distributed over ranks, with `first_axis` swept first, as [`RankPlan`] plans it
    /// for at most `threads` threads of each rank.
    ///
    /// # Errors
    /// See [`with_rank_plan`](Self::with_rank_plan) and [`RankPlan::new`].
    pub fn with_ranks(
        first_axis: usize,
        problem: &Problem<D>,
        communicator: Arc<dyn Communicator>,
        threads: usize,
    ) -> Result<Self, DomainError> {
        let counts = RankCounts { ranks: communicator.size(), threads, parts: None };
        let plan = RankPlan::new(first_axis, problem, &counts, &*communicator)?;
        Self::with_rank_plan(problem, plan, communicator)
    }

    /// Creates a domain at rest that is distributed over ranks by a plan. Each rank cuts its box along the last axis into
    /// subdomains for its threads. All ranks must give the same arguments, and each builds only its own subdomains.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_rank_plan(
        problem: &Problem<D>,
        plan: RankPlan<D>,
        communicator: Arc<dyn Communicator>,
    ) -> Result<Self, DomainError> {
        let RankPlan { permutation, cuts, threads, .. } = plan;
        Self::with_permuted_cuts(problem, permutation, &cuts, Some((communicator, threads)))
    }

    /// Creates a domain at rest, with subdomains between `cuts` across each permuted axis; `ranks`: ranks that own them,
    /// and number of those of each rank along the last axis.
    fn with_permuted_cuts(
        problem: &Problem<D>,
        permutation: AxisPermutation<D>,
        cuts: &[Vec<usize>; D],
        ranks: Option<(Arc<dyn Communicator>, usize)>,
    ) -> Result<Self, DomainError> {
        let problem = &permutation.check_and_permute(problem)?;
        let wraps_around = std::array::from_fn(|axis| problem.wraps_around(axis));
        let plan =
            Decomposition::with_cuts(&problem.grid, wraps_around, problem.pass_limits(), cuts)?;
        let (rank, threads) = match &ranks {
            Some((communicator, threads)) => (communicator.rank(), *threads),
            None => (0, plan.regions().len()),
        };
        let owner = |subdomain: usize| match &ranks {
            Some(_) => plan.owner(subdomain, threads),
            None => Owner { rank: 0, thread: subdomain },
        };
        let own: Vec<usize> =
            (0..plan.regions().len()).filter(|index| owner(*index).rank == rank).collect();
        let create_subdomain = |index: &usize| {
            let region = &plan.regions()[*index];
            let restricted = problem.restrict_to(region);
            Ok(Subdomain {
                domain: Domain::new_unchecked(&restricted, region, plan.max_pass_steps())?,
                region: region.clone(),
                channels: Channels::default(),
                watched_cells: Vec::new(),
                records: Vec::new(),
            })
        };
        let subdomains: Result<Vec<_>, DomainError> = own.iter().map(create_subdomain).collect();
        let group = ranks
            .as_ref()
            .map(|(communicator, threads)| Ranks::new(Arc::clone(communicator), &plan, *threads));
        let failed = subdomains.is_err().then_some([rank, 0]);
        let failed = group.as_ref().and_then(|ranks| ranks.find_least(failed));
        let mut subdomains = subdomains?;
        if let Some([rank, _]) = failed {
            return Err(DomainError::OtherRank { rank });
        }
        let mut channels: Vec<_> = subdomains.iter().map(|_| Channels::default()).collect();
        for (thread, (index, subdomain)) in own.iter().zip(&subdomains).enumerate() {
            for (axis, end) in (0..D).flat_map(|axis| [(axis, 0), (axis, 1)]) {
                let Some(next) = plan.neighbour(*index, axis, end) else { continue };
                match (&ranks, owner(next)) {
                    (Some((communicator, _)), neighbour) if neighbour.rank != rank => {
                        let channels: &mut Channels<T, D> = &mut channels[thread];
                        channels.connect_rank(communicator, (axis, end), thread, neighbour);
                    }
                    // The neighbour below connects both.
                    (_, neighbour) if end == 1 => {
                        let capacity = subdomain.domain.message_capacity(axis);
                        let pair = [thread, neighbour.thread];
                        Channels::connect(&mut channels, axis, pair, capacity);
                    }
                    _ => {}
                }
            }
        }
        for (subdomain, channels) in subdomains.iter_mut().zip(channels) {
            subdomain.channels = channels;
        }
        let regions = || subdomains.iter().map(|own| &own.region);
        Ok(Self {
            own_cells: ranks::enclose_regions(regions()),
            subdomains,
            subdomains_per_thread: 1,
            permutation,
            cells: problem.grid.cells,
            watched_cell_count: 0,
            ranks: group,
        })
    }

    /// Selects the instruction set; results do not depend on it.
    pub fn set_instructions(&mut self, instructions: InstructionSet) {
        for subdomain in &mut self.subdomains {
            subdomain.domain.set_instructions(instructions);
        }
    }

    /// Selects the scalar return mapping in all subdomains, see [`Domain::use_scalar_mapping`].
    #[doc(hidden)]
    pub fn use_scalar_mapping(&mut self) {
        for subdomain in &mut self.subdomains {
            subdomain.domain.use_scalar_mapping();
        }
    }

    /// Advances all fields by `steps` time steps: subdomains of a single thread on the calling thread, others on several.
    ///
    /// # Errors
    /// A thread cannot be started; the state is unchanged.
    pub fn advance(&mut self, steps: usize) -> Result<(), ThreadStartError> {
        self.advance_with(&mut SystemThreads, steps)
    }

    /// Advances as [`advance`](Self::advance) does, on threads that `starter` starts.
    #[doc(hidden)]
    pub fn advance_with(
        &mut self,
        starter: &mut impl ThreadStarter,
        steps: usize,
    ) -> Result<(), ThreadStartError> {
        // A neighbour's thread ends early only by a panic, which the scope propagates.
        let task = |subdomains| {
            move || {
                let _ = Subdomain::advance_all(subdomains, steps);
            }
        };
        if self.subdomains.len() <= self.subdomains_per_thread {
            task(&mut self.subdomains)();
            return Ok(());
        }
        let of_threads = self.subdomains.chunks_mut(self.subdomains_per_thread);
        let started = run_concurrently(starter, of_threads.map(task));
        if let (Err(error), Some(ranks)) = (&started, &self.ranks) {
            // The other ranks have begun, and wait for messages of this one.
            ranks.communicator.abort(&error.to_string());
        }
        started
    }

    /// Returns the cells of this process along each axis of the problem: those of the rank, or the whole grid.
    pub fn own_cells(&self) -> [Range<usize>; D] {
        self.permutation.unpermute_axis_values(self.own_cells.clone())
    }

    /// Returns the part of the state that this process holds.
    pub fn state_part(&self) -> StatePart {
        StatePart {
            grid_cells: self.cells.to_vec(),
            cells: self.own_cells.to_vec(),
            interlayers: self.own_interlayers(),
        }
    }

    /// Returns the maximum number of steps per pass over memory; a pass reads and writes each field once.
    pub fn max_pass_steps(&self) -> usize {
        self.subdomains.first().map_or(1, |subdomain| subdomain.domain.max_pass_steps())
    }

    /// Returns the time of the present state, s.
    pub fn time(&self) -> f64 {
        self.subdomains.first().map_or(0.0, |subdomain| subdomain.domain.time())
    }

    /// Returns the fields of the state, in their order.
    pub fn fields(&self) -> &[SolidField] {
        self.subdomains.first().map_or(&[], |subdomain| subdomain.domain.fields())
    }

    /// Returns the number of output quantities per cell: fields and time integrals.
    pub fn quantity_count(&self) -> usize {
        let integrals =
            self.subdomains.first().map_or(0, |subdomain| subdomain.domain.integral_count());
        self.fields().len() + integrals
    }
}
