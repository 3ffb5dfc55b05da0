//! Plan of a simulation: size, time steps, cost and warnings.

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
    /// Time, files and bytes required.
    pub cost: Cost,
}

/// Size of a simulation, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum ProblemSize {
    /// Simulation of a solid.
    Solid {
        /// Cells along each axis.
        cells: Vec<usize>,
        /// Number of fields per cell.
        fields: usize,
        /// Number of steps.
        steps: usize,
        /// Time step Δt, s.
        time_step: f64,
        /// Condition that limits the time step.
        limit: StepLimit,
    },
    /// Simulation of a flow.
    Flow {
        /// Points along each axis.
        points: [usize; 2],
        /// Title of the model.
        model: &'static str,
        /// Duration, s.
        duration: f64,
        /// Smallest and largest initial wave number of the box along an axis, 1/m.
        wave_numbers: [f64; 2],
    },
}

/// Warning: a setting that is probably unintended.
#[derive(Clone, Debug, PartialEq)]
pub enum SimulationWarning {
    /// A time function of a load or source changes within few steps.
    FewSteps {
        /// Entry in the case: `load[0]`.
        entry: String,
        /// Number of steps.
        steps: f64,
    },
    /// The residual of the full ledger exceeds rounding.
    LedgerResidual {
        /// Residual relative to the largest term of the ledger.
        relative_residual: f64,
    },
    /// A load or source on one cell at a Courant number of 1.
    Sawtooth {
        /// Entry in the case.
        entry: String,
    },
}

impl SimulationPlan {
    /// Checks that enough memory is available.
    ///
    /// # Errors
    /// Memory is short: the result of `refused` for the message.
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

/// Returns the number of snapshots at `interval` within `duration`, both in s; 0 if the interval is 0.
pub(super) fn snapshot_count(interval: f64, duration: f64) -> f64 {
    if interval > 0.0 { (duration / interval).ceil() + 1.0 } else { 0.0 }
}
