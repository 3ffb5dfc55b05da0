//! The solvers of a solid, as its simulation calls them.

use crate::decomposition::DecomposedDomain;
use crate::simd::Real;
use crate::solid::domain::SolverReal;
use crate::solid::ledger::{Energy, Ledger};
use crate::solid::problem::{DomainError, Problem};
use crate::solid::reference::Reference;
use crate::solid::snapshot::Snapshot;
use models::solid::waves::Field;

/// Which solver carries a solid through time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolverChoice {
    /// The fused solver, on as many of these threads as the layers allow. Its ledger lacks the dissipation of the scheme.
    Fused {
        /// At most.
        threads: usize,
    },
    /// The reference solver, on one thread and many times slower: its ledger is full.
    Reference,
}

impl SolverChoice {
    /// Threads that a problem takes.
    pub(super) fn threads<T: SolverReal, const D: usize>(self, problem: &Problem<D>) -> usize {
        match self {
            Self::Fused { threads } => {
                threads.clamp(1, DecomposedDomain::<T, D>::max_parts(problem.first_axis(), problem))
            }
            Self::Reference => 1,
        }
    }

    /// The solver of a problem, at rest.
    pub(super) fn start<T: SolverReal, const D: usize>(
        self,
        problem: &Problem<D>,
    ) -> Result<Box<dyn Solver<T>>, DomainError> {
        let (first, parts) = (problem.first_axis(), self.threads::<T, D>(problem));
        Ok(match self {
            Self::Fused { .. } => {
                Box::new(DecomposedDomain::<T, D>::with_first_axis(first, problem, parts)?)
            }
            Self::Reference => Box::new(Reference::<T, D>::with_first_axis(first, problem)?),
        })
    }
}

/// What a simulation asks of a solver; both have methods of these names.
pub(super) trait Solver<T: Real>: Send {
    /// Advances all fields by so many time steps.
    fn advance(&mut self, steps: usize);
    /// Time, s.
    fn time(&self) -> f64;
    /// Energy of the deviation from the initial stress.
    fn energy(&self) -> Energy;
    /// What steps did to the energy so far.
    fn ledger(&self) -> Ledger;
    /// Sets the values of a field, by cell of the problem.
    fn set(&mut self, field: Field, values: &[T]);
    /// Lets interlayers move with the cells beside them.
    fn initialise_interlayers(&mut self);
    /// Goes back to rest, before the first step.
    fn reset(&mut self);
    /// All that the steps to come depend on.
    fn snapshot(&self) -> Snapshot<T>;
    /// Goes to a snapshot of the same problem; `false` where it is one of another.
    fn restore(&mut self, snapshot: &Snapshot<T>) -> bool;
    /// Numbers that are shown of a cell.
    fn width(&self) -> usize;
    /// All that is shown, by quantity and cell.
    fn shown(&self) -> Vec<Vec<f64>>;
    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    fn dissipated(&self) -> Vec<f64>;
    /// Records these cells after each step.
    fn watch(&mut self, cells: &[usize]);
    /// Records the watched cells as they are.
    fn record(&mut self);
    /// What was recorded since the last call.
    fn records(&mut self) -> Vec<f64>;
    /// The first value that is not finite.
    fn first_non_finite(&self) -> Option<(Field, usize)>;
    /// The first cell whose stress is not in its yield set.
    fn first_beyond_yield(&self) -> Option<usize>;
}

macro_rules! solver {
    ($kind:ident) => {
        impl<T: SolverReal, const D: usize> Solver<T> for $kind<T, D> {
            fn advance(&mut self, steps: usize) {
                self.advance(steps);
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

            fn set(&mut self, field: Field, values: &[T]) {
                self.set(field, values);
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

            fn restore(&mut self, snapshot: &Snapshot<T>) -> bool {
                self.restore(snapshot)
            }

            fn width(&self) -> usize {
                self.width()
            }

            fn shown(&self) -> Vec<Vec<f64>> {
                self.shown()
            }

            fn dissipated(&self) -> Vec<f64> {
                self.dissipated()
            }

            fn watch(&mut self, cells: &[usize]) {
                self.watch(cells);
            }

            fn record(&mut self) {
                self.record();
            }

            fn records(&mut self) -> Vec<f64> {
                self.records()
            }

            fn first_non_finite(&self) -> Option<(Field, usize)> {
                self.first_non_finite()
            }

            fn first_beyond_yield(&self) -> Option<usize> {
                self.first_beyond_yield()
            }
        }
    };
}

solver!(DecomposedDomain);
solver!(Reference);
