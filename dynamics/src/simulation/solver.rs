//! Choice of the solver of a solid, and the interface through which its simulation calls it.

use crate::decomposition::communicator::Communicator;
use crate::decomposition::{DecomposedDomain, RankCounts, RankPlan, ThreadStartError};
use crate::simd::Real;
use crate::solid::domain::SolverReal;
use crate::solid::ledger::{Energy, Ledger};
use crate::solid::problem::{DomainError, Problem};
use crate::solid::reference::Reference;
use crate::solid::snapshot::{Snapshot, StateLists, StatePart};
use models::solid::waves::SolidField;
use std::ops::Range;
use std::sync::Arc;

/// Choice of the solver of a solid.
#[derive(Clone, Debug)]
pub enum SolverChoice {
    /// Fused solver; the number of threads is limited by the length of the grid. Its ledger lacks the numerical
    /// dissipation.
    Fused {
        /// Maximum number of threads.
        threads: usize,
    },
    /// Fused solver whose domain is distributed over ranks. All of them make the same simulation; fields and states for
    /// checkpoints are those of the cells of the rank, and records are complete at the root and empty at the others.
    Ranks {
        /// Communication between the ranks.
        communicator: Arc<dyn Communicator>,
        /// Maximum number of threads of each rank; the same for all.
        threads: usize,
        /// Numbers of parts along the axes of the problem; `None` for those with the least surface.
        parts: Option<Vec<usize>>,
    },
    /// Reference solver: single-threaded, many times slower, with a full ledger.
    Reference,
}

impl SolverChoice {
    /// Returns the number of threads used for a problem, those of all ranks.
    pub(super) fn thread_count<T: SolverReal, const D: usize>(
        &self,
        problem: &Problem<D>,
    ) -> usize {
        match self {
            Self::Fused { threads } => {
                DecomposedDomain::<T, D>::usable_threads(problem.first_axis(), problem, *threads)
            }
            Self::Ranks { communicator, threads, .. } => communicator.size() * threads,
            Self::Reference => 1,
        }
    }

    /// Returns the communication between the ranks; `None` in a single process.
    pub fn communicator(&self) -> Option<&Arc<dyn Communicator>> {
        match self {
            Self::Ranks { communicator, .. } => Some(communicator),
            _ => None,
        }
    }

    /// Returns the cells along each axis whose values this process will hold: those of the rank, or the whole grid.
    ///
    /// # Errors
    /// [`DomainError::RankCount`] if the grid cannot be cut into as many parts as there are ranks.
    pub fn own_cells<const D: usize>(
        &self,
        problem: &Problem<D>,
    ) -> Result<[Range<usize>; D], DomainError> {
        match self {
            Self::Ranks { communicator, threads, parts } => {
                plan_ranks(problem, &**communicator, (*threads, parts.as_ref()))?
                    .own_cells(communicator.rank())
            }
            _ => Ok(problem.grid.cells.map(|count| 0..count)),
        }
    }

    /// Creates the solver of a problem, at rest.
    pub(crate) fn build_solver<T: SolverReal, const D: usize>(
        self,
        problem: &Problem<D>,
    ) -> Result<Box<dyn SolidSolver<T>>, DomainError> {
        let (first, thread_count) = (problem.first_axis(), self.thread_count::<T, D>(problem));
        Ok(match self {
            Self::Fused { .. } => {
                Box::new(DecomposedDomain::<T, D>::with_first_axis(first, problem, thread_count)?)
            }
            Self::Ranks { communicator, threads, parts } => {
                let plan = plan_ranks(problem, &*communicator, (threads, parts.as_ref()))?;
                Box::new(DecomposedDomain::<T, D>::with_rank_plan(problem, plan, communicator)?)
            }
            Self::Reference => Box::new(Reference::<T, D>::with_first_axis(first, problem)?),
        })
    }
}

/// Plans the distribution over all ranks of a communicator.
fn plan_ranks<const D: usize>(
    problem: &Problem<D>,
    communicator: &dyn Communicator,
    (threads, parts): (usize, Option<&Vec<usize>>),
) -> Result<RankPlan<D>, DomainError> {
    let counts = RankCounts { ranks: communicator.size(), threads, parts: parts.cloned() };
    RankPlan::new(problem.first_axis(), problem, &counts, communicator)
}

/// Interface of both solvers, which have methods of the same names.
pub(crate) trait SolidSolver<T: Real>: Send {
    /// Advances all fields by `steps` time steps.
    fn advance(&mut self, steps: usize) -> Result<(), ThreadStartError>;
    /// Time of the present state, s.
    fn time(&self) -> f64;
    /// Energy of the deviation from the initial stress, J.
    fn energy(&self) -> Energy;
    /// Work and dissipation of the steps so far, J.
    fn ledger(&self) -> Ledger;
    /// Part of the state that this process holds: cells and interlayers.
    fn state_part(&self) -> StatePart;
    /// Sets the values of a field, by cell of this process.
    fn set_field(&mut self, field: SolidField, values: &[T]);
    /// Sets interlayer velocities to the mean of the two adjacent cells, and their stresses to zero.
    fn initialise_interlayers(&mut self);
    /// Returns to the state of rest before the first step.
    fn reset(&mut self);
    /// Returns the whole state.
    fn snapshot(&self) -> Snapshot<T>;
    /// Returns the state without values by cell. All ranks call it.
    fn snapshot_without_lists(&self) -> Snapshot<T>;
    /// Lengths of the lists by cell of a state: of the fields, and of the sums.
    fn list_lengths(&self) -> [Vec<usize>; 2];
    /// Returns the values of the field at an index of a state.
    fn field_list(&self, index: usize) -> Vec<T>;
    /// Returns the sums at an index of a state.
    fn sum_list(&self, index: usize) -> Vec<f64>;
    /// Restores a snapshot; `false` if it belongs to another problem.
    fn restore(&mut self, snapshot: &Snapshot<T>) -> bool;
    /// Restores a state whose lists by cell are `lists`; `false` if it belongs to another problem, or a list cannot be read.
    fn restore_lists(&mut self, state: &Snapshot<T>, lists: &mut dyn StateLists<T>) -> bool;
    /// Number of output quantities per cell.
    fn quantity_count(&self) -> usize;
    /// Output values by quantity and cell of some layers of this process across the last axis.
    fn output_values_in(&self, layers: Range<usize>) -> Vec<Vec<f64>>;
    /// Plastic dissipation by cell of some layers of this process, J/m³; empty if no medium yields.
    fn plastic_dissipation_in(&self, layers: Range<usize>) -> Vec<f64>;
    /// History variables of the interlayers of this process, in the order of
    /// [`Problem::interlayer_faces_in`](crate::solid::problem::Problem::interlayer_faces_in).
    fn interlayer_history(&self) -> Vec<T>;
    /// Selects the cells to be recorded after each step.
    fn watch_cells(&mut self, cells: &[usize]);
    /// Records the watched cells in the present state.
    fn record_watched_cells(&mut self);
    /// Returns the records since the last call, by step, watched cell and output quantity.
    fn take_records(&mut self) -> Vec<f64>;
    /// Returns field and cell of the first non-finite value; `None` if all values are finite.
    fn first_non_finite(&self) -> Option<(SolidField, usize)>;
    /// Returns the first cell whose stress is outside its yield set; `None` if there is none.
    fn first_cell_outside_yield_set(&self) -> Option<usize>;
}

macro_rules! impl_solid_solver {
    ($kind:ident, $advance:expr) => {
        impl<T: SolverReal, const D: usize> SolidSolver<T> for $kind<T, D> {
            fn advance(&mut self, steps: usize) -> Result<(), ThreadStartError> {
                let advance: fn(&mut Self, usize) -> Result<(), ThreadStartError> = $advance;
                advance(self, steps)
            }

            fn time(&self) -> f64 {
                self.time()
            }

            fn energy(&self) -> Energy {
                self.energy()
            }

            fn ledger(&self) -> Ledger {
                self.ledger()
            }

            fn state_part(&self) -> StatePart {
                self.state_part()
            }

            fn set_field(&mut self, field: SolidField, values: &[T]) {
                self.set_field(field, values);
            }

            fn initialise_interlayers(&mut self) {
                self.initialise_interlayers();
            }

            fn reset(&mut self) {
                self.reset();
            }

            fn snapshot(&self) -> Snapshot<T> {
                self.snapshot()
            }

            fn snapshot_without_lists(&self) -> Snapshot<T> {
                self.snapshot_without_lists()
            }

            fn list_lengths(&self) -> [Vec<usize>; 2] {
                self.list_lengths()
            }

            fn field_list(&self, index: usize) -> Vec<T> {
                self.field_list(index)
            }

            fn sum_list(&self, index: usize) -> Vec<f64> {
                self.sum_list(index)
            }

            fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
                self.restore(snapshot)
            }

            fn restore_lists(
                &mut self,
                state: &Snapshot<T>,
                lists: &mut dyn StateLists<T>,
            ) -> bool {
                self.restore_lists(state, lists)
            }

            fn quantity_count(&self) -> usize {
                self.quantity_count()
            }

            fn output_values_in(&self, layers: Range<usize>) -> Vec<Vec<f64>> {
                self.output_values_in(layers)
            }

            fn plastic_dissipation_in(&self, layers: Range<usize>) -> Vec<f64> {
                self.plastic_dissipation_in(layers)
            }

            fn interlayer_history(&self) -> Vec<T> {
                self.interlayer_history()
            }

            fn watch_cells(&mut self, cells: &[usize]) {
                self.watch_cells(cells);
            }

            fn record_watched_cells(&mut self) {
                self.record_watched_cells();
            }

            fn take_records(&mut self) -> Vec<f64> {
                self.take_records()
            }

            fn first_non_finite(&self) -> Option<(SolidField, usize)> {
                self.first_non_finite()
            }

            fn first_cell_outside_yield_set(&self) -> Option<usize> {
                self.first_cell_outside_yield_set()
            }
        }
    };
}

impl_solid_solver!(DecomposedDomain, |own, steps| own.advance(steps));
impl_solid_solver!(Reference, |own, steps| {
    own.advance(steps);
    Ok(())
});
