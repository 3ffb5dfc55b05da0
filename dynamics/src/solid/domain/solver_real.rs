//! Expensive functions of the solvers, compiled in this crate once for each number type and dimension, and not again in
//! every crate that uses a solver.

use super::Domain;
use super::plastic::ProjectionKernel;
use super::step::StepStages;
use crate::simd::{InstructionSet, Real};
use crate::simulation::solver::{SolidSolver, SolverChoice};
use crate::solid::ledger::EnergySums;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::reference::Reference;
use std::any::Any;
use std::ops::Range;

/// Number type of the solvers: `f32` or `f64`.
#[allow(private_interfaces, reason = "nobody else implements or calls it")]
pub trait SolverReal: Real {
    /// Advances layers of a `Domain<Self, 2>` or a `Domain<Self, 3>` by a step.
    #[doc(hidden)]
    fn advance_layers(domain: &mut dyn Any, stages: &StepStages<'_>);

    /// Applies the first x and y sweeps to a layer of a `Domain<Self, 2>` or a `Domain<Self, 3>`: `rows` that enter the x
    /// sweep, and rows that the y sweep completes.
    #[doc(hidden)]
    fn sweep_layer(domain: &mut dyn Any, layer: usize, rows: [Range<usize>; 2]);

    /// Returns the sums of the energy in owned cells of a `Domain<Self, 2>` or a `Domain<Self, 3>`.
    #[doc(hidden)]
    fn energy_sums(domain: &dyn Any) -> EnergySums;

    /// Runs the kernel of the return mapping by projection.
    #[doc(hidden)]
    fn map_stresses(work: ProjectionKernel<'_, Self>, instructions: InstructionSet);

    /// Advances a `Reference<Self, 2>` or a `Reference<Self, 3>` by a step.
    #[doc(hidden)]
    fn advance_reference(reference: &mut dyn Any);

    /// Creates the solver of a `Problem<2>` or a `Problem<3>`, at rest.
    #[doc(hidden)]
    fn build_solver(
        choice: SolverChoice,
        problem: &dyn Any,
    ) -> Result<Box<dyn SolidSolver<Self>>, DomainError>;
}

macro_rules! compiled {
    ($kind:ident $(, $parameter:ident)?) => {
        #[allow(private_interfaces, reason = "nobody else implements or calls it")]
        impl$(<$parameter: Real>)? SolverReal for $kind {
            // Without `inline(never)`, the functions would be inlined into other crates, and all functions that they
            // call compiled there.
            #[inline(never)]
            fn advance_layers(domain: &mut dyn Any, stages: &StepStages<'_>) {
                if let Some(domain) = domain.downcast_mut::<Domain<Self, 2>>() {
                    domain.advance_layers(stages);
                } else if let Some(domain) = domain.downcast_mut::<Domain<Self, 3>>() {
                    domain.advance_layers(stages);
                }
            }

            #[inline(never)]
            fn sweep_layer(domain: &mut dyn Any, layer: usize, rows: [Range<usize>; 2]) {
                let [entered, middle] = rows;
                let rows = [entered, middle, 0..0];
                if let Some(domain) = domain.downcast_mut::<Domain<Self, 2>>() {
                    domain.sweep_layer(layer, &rows, 0);
                } else if let Some(domain) = domain.downcast_mut::<Domain<Self, 3>>() {
                    domain.sweep_layer(layer, &rows, 0);
                }
            }

            #[inline(never)]
            fn energy_sums(domain: &dyn Any) -> EnergySums {
                let plane = domain.downcast_ref::<Domain<Self, 2>>().map(Domain::sum_energies);
                let space = || domain.downcast_ref::<Domain<Self, 3>>().map(Domain::sum_energies);
                plane.or_else(space).unwrap_or_default()
            }

            #[inline(never)]
            fn map_stresses(work: ProjectionKernel<'_, Self>, instructions: InstructionSet) {
                instructions.run_kernel::<Self>(work);
            }

            #[inline(never)]
            fn advance_reference(reference: &mut dyn Any) {
                if let Some(reference) = reference.downcast_mut::<Reference<Self, 2>>() {
                    reference.advance_step();
                } else if let Some(reference) = reference.downcast_mut::<Reference<Self, 3>>() {
                    reference.advance_step();
                }
            }

            #[inline(never)]
            fn build_solver(
                choice: SolverChoice,
                problem: &dyn Any,
            ) -> Result<Box<dyn SolidSolver<Self>>, DomainError> {
                if let Some(problem) = problem.downcast_ref::<Problem<2>>() {
                    choice.build_solver(problem)
                } else if let Some(problem) = problem.downcast_ref::<Problem<3>>() {
                    choice.build_solver(problem)
                } else {
                    Err(DomainError::Media)
                }
            }
        }
    };
}

#[cfg(not(test))]
compiled!(f32);
#[cfg(not(test))]
compiled!(f64);
// Tests of this crate use few of these functions: a generic implementation compiles only those.
#[cfg(test)]
compiled!(T, T);
