//! Plan of a simulation: size, time steps and warnings before it begins.

use crate::Error;
use crate::case::CaseError;
use dynamics::simulation::StepLimit;

/// Plan of a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Steps or wave numbers.
    pub work: Work,
    /// Memory that it needs.
    pub memory: Bytes,
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
        match available_memory().filter(|available| self.memory > *available) {
            Some(available) => {
                Err(refused(format!("{self}, of which {available} are free")).into())
            }
            None => Ok(self),
        }
    }
}

/// Snapshots at an interval of a duration, both in s; none where the interval is 0.
pub(super) fn number_of_snapshots(interval: f64, duration: f64) -> f64 {
    if interval > 0.0 { (duration / interval).ceil() + 1.0 } else { 0.0 }
}

/// Memory that the system can give, where it says so.
fn available_memory() -> Option<Bytes> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(Bytes(1024.0 * kibibytes))
}
