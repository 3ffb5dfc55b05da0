//! Plan of a simulation: size, time steps and warnings before it begins.

use super::Cost;
use crate::Error;
use crate::case::CaseError;
use crate::study::available::Available;
use dynamics::simulation::StepLimit;

/// Plan of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Steps or wave numbers.
    pub work: Work,
    /// Memory that it needs.
    pub memory: Bytes,
    /// Time, files and bytes that it takes.
    pub cost: Cost,
}

/// Plan of a simulation, by kind.
#[derive(Clone, Debug, PartialEq)]
pub enum Work {
    /// A solid.
    Solid {
        /// Cells along each axis.
        cells: Vec<usize>,
        /// Fields of a cell.
        fields: usize,
        /// Number of steps.
        steps: usize,
        /// Δt, s.
        step: f64,
        /// Condition that limits the time step.
        limit: StepLimit,
    },
    /// A flow.
    Flow {
        /// Points along each axis.
        points: [usize; 2],
        /// The model, as in titles.
        model: &'static str,
        /// s.
        duration: f64,
        /// Least and greatest wave number of the box along an axis at the beginning, 1/m.
        wave_numbers: [f64; 2],
    },
}

/// A number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Bytes(pub f64);

/// Warning: a setting that is probably unintended.
#[derive(Clone, Debug, PartialEq)]
pub enum Warning {
    /// A function of time that changes within few steps.
    FewSteps {
        /// Its entry in the case: `load[0]`.
        entry: String,
        /// The steps.
        steps: f64,
    },
    /// The full ledger leaves over more than rounding.
    Remainder {
        /// Relative to its greatest term.
        part: f64,
    },
    /// A load or source on one cell at a Courant number of 1.
    Sawtooth {
        /// Its entry in the case.
        entry: String,
    },
}

impl Plan {
    /// Checks that enough memory is free.
    ///
    /// # Errors
    /// It is not: what `refused` makes of the words.
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

/// Snapshots at an interval of a duration, both in s; none where the interval is 0.
pub(super) fn number_of_snapshots(interval: f64, duration: f64) -> f64 {
    if interval > 0.0 { (duration / interval).ceil() + 1.0 } else { 0.0 }
}
