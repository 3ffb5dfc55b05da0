//! Plan of a simulation: size, time steps, cost and warnings.

use super::{Bytes, Cost};
use crate::Error;
use crate::case::CaseError;
use crate::study::available::Available;
use dynamics::simulation::StepLimit;

/// Plan of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Size of the problem, by kind.
    pub work: Work,
    /// Memory required.
    pub memory: Bytes,
    /// Time, files and bytes required.
    pub cost: Cost,
}

/// Size of a simulation, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Work {
    /// Simulation of a solid.
    Solid {
        /// Cells along each axis.
        cells: Vec<usize>,
        /// Number of fields per cell.
        fields: usize,
        /// Number of steps.
        steps: usize,
        /// Time step Δt, s.
        step: f64,
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
        /// Least and greatest initial wave number of the box along an axis, 1/m.
        wave_numbers: [f64; 2],
    },
}

/// Warning: a setting that is probably unintended.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A time function of a load or source changes within few steps.
    FewSteps {
        /// Entry in the case: `load[0]`.
        entry: String,
        /// Number of steps.
        steps: f64,
    },
    /// The residual of the full ledger exceeds rounding.
    Remainder {
        /// Residual relative to the greatest term of the ledger.
        part: f64,
    },
    /// A load or source on one cell at a Courant number of 1.
    Sawtooth {
        /// Entry in the case.
        entry: String,
    },
}

impl Plan {
    /// Checks that enough memory is available.
    ///
    /// # Errors
    /// Memory is short: the result of `refused` for the message.
    pub(super) fn if_memory_suffices(
        self,
        refused: impl FnOnce(String) -> CaseError,
    ) -> Result<Self, Error> {
        match Available::too_little_for(self.memory) {
            Some(available) => Err(refused(format!("{self}, more than {available}")).into()),
            None => Ok(self),
        }
    }
}

/// Returns the number of snapshots at `interval` within `duration`, both in s; 0 if the interval is 0.
pub(super) fn number_of_snapshots(interval: f64, duration: f64) -> f64 {
    if interval > 0.0 { (duration / interval).ceil() + 1.0 } else { 0.0 }
}
