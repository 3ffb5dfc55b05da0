//! Plan of a simulation: size, time steps, memory, cost and warnings.

use super::{Bytes, Cost};
use crate::Error;
use crate::case::CaseError;
use crate::study::available_memory::AvailableMemory;
use dynamics::simulation::StepLimit;

/// Plan of a simulation: its size, and the memory, time and storage that it requires.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationPlan {
    /// Size of the solver problem.
    pub problem_size: ProblemSize,
    /// Number of processes among which the cells are distributed.
    pub rank_count: usize,
    /// Estimated peak memory of each process.
    pub required_memory: Bytes,
    /// Estimated time, steps, files and bytes.
    pub cost: Cost,
}

/// Size of a simulation: cells or grid points, and time steps.
#[derive(Clone, Debug, PartialEq)]
pub enum ProblemSize {
    /// Size of the simulation of a solid.
    Solid {
        /// Number of cells along each axis.
        cell_counts: Vec<usize>,
        /// Number of evolving fields per cell.
        field_count: usize,
        /// Number of time steps.
        step_count: usize,
        /// Time step Δt, s.
        time_step: f64,
        /// Condition that limits the time step.
        step_limit: StepLimit,
        /// Number of time steps per step of the shear waves.
        shear_interval: usize,
    },
    /// Size of the simulation of a flow.
    Flow {
        /// Number of grid points along each axis.
        point_counts: [usize; 2],
        /// Title of the model.
        model_title: &'static str,
        /// Duration of the simulation, s.
        duration: f64,
        /// Smallest and largest initial wave number of the grid's modes along an axis, 1/m.
        wave_numbers: [f64; 2],
    },
}

/// Warning about a setting that is probably unintended, or about the result.
#[derive(Clone, Debug, PartialEq)]
pub enum SimulationWarning {
    /// A time function of a load or source changes within fewer than four steps.
    FewSteps {
        /// Load or source in the case, such as `load[0]`.
        entry_key: String,
        /// Number of time steps in the shortest time scale of the time function.
        steps_per_time_scale: f64,
    },
    /// The residual of an energy ledger with numerical dissipation exceeds rounding, see
    /// [`RunResult::residual_warning`](super::RunResult::residual_warning).
    LedgerResidual {
        /// Residual relative to the largest term of the ledger.
        relative_residual: f64,
    },
    /// Strains are so large that equations of small strains do not hold.
    LargeStrain {
        /// Estimate of the largest strain.
        strain: f64,
    },
    /// Shear waves have steps of their own, in a grid in which waves can be oblique to the axes.
    ObliqueWaves,
    /// A load or source acts on one cell at a Courant number of 1, which leaves sawtooth waves undamped.
    Sawtooth {
        /// Load or source in the case, such as `source[0]`.
        entry_key: String,
    },
}

impl SimulationPlan {
    /// Checks that enough memory is available.
    ///
    /// # Errors
    /// Memory is short: the result of `refused` for the message of the shortage.
    pub(super) fn check_memory(
        self,
        refused: impl FnOnce(String) -> CaseError,
    ) -> Result<Self, Error> {
        match AvailableMemory::find_shortage(self.required_memory) {
            Some(available) => Err(refused(format!("{self}, more than {available}")).into()),
            None => Ok(self),
        }
    }
}

/// Returns the number of snapshots at `interval` within `duration`, both in s, including the initial and the final one;
/// 0 if the interval is 0.
pub(super) fn snapshot_count(interval: f64, duration: f64) -> f64 {
    if interval > 0.0 { (duration / interval).ceil() + 1.0 } else { 0.0 }
}
