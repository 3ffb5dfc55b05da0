//! Records delivered by a running simulation, and their receiver.

use super::{Fields, Records, unit_of};
use crate::Error;
use crate::case::Case;
use dynamics::simulation::{RegularTimes, State};

/// A table that grows row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Records of the receivers.
    Receivers,
    /// The ledger of energy.
    Ledger,
    /// Energies of the shells of modes of a flow.
    Spectrum,
}

/// A table and the names of its columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Which.
    pub kind: TableKind,
    /// The first one is `time`.
    pub columns: Vec<String>,
    /// Units of the columns.
    pub units: Vec<&'static str>,
}

impl Head {
    pub(super) fn new(case: &Case, kind: TableKind, columns: Vec<String>) -> Self {
        let units = columns.iter().map(|name| column_unit(case, kind, name)).collect();
        Self { kind, columns, units }
    }
}

/// The unit of a column of a case's table.
pub fn column_unit(case: &Case, kind: TableKind, name: &str) -> &'static str {
    match (kind, name) {
        (_, "time") => "s",
        (TableKind::Receivers, _) => name.rsplit_once('.').map_or("s", |(_, name)| unit_of(name)),
        (_, "power") => "W/m3",
        _ => energy_unit(case),
    }
}

/// The unit of energies: in a plane per length out of it, of flows per volume.
pub(super) fn energy_unit(case: &Case) -> &'static str {
    match &case.dynamics {
        None => "J/m3",
        Some(dynamics) if dynamics.grid.dimensions() == 2 => "J/m",
        Some(_) => "J",
    }
}

/// A simulation between two batches of steps.
pub struct Moment<'a> {
    /// Steps done.
    pub steps: usize,
    /// Time of the state, s.
    pub time: f64,
    /// Duration of the whole simulation, s.
    pub duration: f64,
    /// Whether the duration is over.
    pub is_finished: bool,
    /// Account of the time steps.
    pub effort: Effort,
    /// All that the steps to come depend on.
    pub state: &'a dyn Fn() -> State,
}

/// Account of the time steps, by kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Effort {
    /// Time steps of a solid.
    Solid {
        /// Energy of the state, J, in a plane J/m.
        energy: f64,
        /// Cells.
        cells: usize,
        /// Parts of the grid, each in a thread of its own.
        threads: usize,
    },
    /// Time steps of a flow.
    Flow {
        /// Kinetic energy of the last account, J/m³.
        energy: f64,
        /// Stages of the last step.
        stages: usize,
        /// Evaluations of the right-hand side so far.
        evaluations: usize,
        /// Iterations of the pressure in all of them.
        iterations: usize,
        /// Threads.
        threads: usize,
    },
}

/// Takes what a simulation delivers. An error of any method ends the run.
pub trait Recorder: Send {
    /// Whether the run goes on from a saved state.
    fn is_resumed(&self) -> bool {
        false
    }

    /// The beginning: tables and snapshots to come. Where the run is resumed, `restore` is to be called with the saved
    /// state: it hands back the number of snapshots delivered up to it, or `None` where the state is of another case.
    ///
    /// # Errors
    /// The recorder is not ready, or the state is refused.
    fn start(
        &mut self,
        tables: &[Head],
        snapshots: Option<RegularTimes>,
        restore: &mut dyn FnMut(&State) -> Option<usize>,
    ) -> Result<(), Error>;

    /// A row of one of the tables.
    ///
    /// # Errors
    /// It cannot be kept.
    fn row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error>;

    /// A snapshot: its number from 0 on, and the fields.
    ///
    /// # Errors
    /// It cannot be kept.
    fn snapshot(&mut self, index: usize, fields: Fields) -> Result<(), Error>;

    /// Steps are about to be made again, to find the last sound state before a fault.
    ///
    /// # Errors
    /// The run is to end here.
    fn replay(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// A look at the simulation when all output that is due has been taken.
    ///
    /// # Errors
    /// The run is to end here.
    fn after_steps(&mut self, moment: &Moment) -> Result<(), Error>;

    /// All steps are done: hands over what was recorded.
    ///
    /// # Errors
    /// It cannot be had.
    fn finish(&mut self, moment: &Moment) -> Result<Records, Error>;
}
