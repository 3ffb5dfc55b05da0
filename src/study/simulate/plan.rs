//! Plan of a simulation: size, time steps, memory, cost and warnings.

use super::{Bytes, Cost};
use crate::Error;
use crate::case::CaseError;
use crate::study::available_memory::AvailableMemory;
use dynamics::simulation::StepLimit;

/// Plan of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationPlan {
    /// Size of the problem, by kind.
    pub size: ProblemSize,
    /// Memory required.
    pub memory: Bytes,
    /// Time, steps, files and bytes required.
    pub cost: Cost,
}

/// Size of a simulation, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum ProblemSize {
    /// Simulation of a solid.
    Solid {
        /// Number of cells along each axis.
        cells: Vec<usize>,
        /// Number of fields per cell.
        fields: usize,
        /// Number of time steps.
        steps: usize,
        /// Time step Δt, s.
        time_step: f64,
        /// Condition that limits the time step.
        limit: StepLimit,
    },
    /// Simulation of a flow.
    Flow {
        /// Number of grid points along each axis.
        points: [usize; 2],
        /// Title of the model.
        model: &'static str,
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
        entry: String,
        /// Number of time steps in the shortest time scale of the time function.
        steps: f64,
    },
    /// The residual of an energy ledger with numerical dissipation exceeds rounding, see
    /// [`RunResult::residual_warning`](super::RunResult::residual_warning).
    LedgerResidual {
        /// Residual relative to the largest term of the ledger.
        relative_residual: f64,
    },
    /// A load or source acts on one cell at a Courant number of 1, which leaves sawtooth waves undamped.
    Sawtooth {
        /// Load or source in the case, such as `source[0]`.
        entry: String,
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
        match AvailableMemory::find_shortage(self.memory) {
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
