//! Output of a running simulation, and the interface of its recorder.

use super::{OutputFields, RunRecords, quantity_unit};
use crate::Error;
use crate::case::Case;
use dynamics::decomposition::communicator::Communicator;
use dynamics::simulation::{CellSections, RegularTimes, SimulationState, StatePart, StateSource};
use std::io;
use std::ops::Range;
use std::sync::Arc;

/// Kind of a table to which a simulation appends rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableKind {
    /// Table of the receiver records.
    Receivers,
    /// Table of the energy ledger.
    Ledger,
    /// Table of the energy spectrum of a flow, by shells of mode numbers.
    Spectrum,
}

/// Header of a table: kind, and names and units of its columns.
#[derive(Clone, Debug, PartialEq)]
pub struct TableHeader {
    /// Kind of the table, which determines its file.
    pub kind: TableKind,
    /// Names of the columns; the first is `time`.
    pub columns: Vec<String>,
    /// Units of the columns, in the order of `columns`.
    pub units: Vec<&'static str>,
}

impl TableHeader {
    pub(super) fn new(case: &Case, kind: TableKind, columns: Vec<String>) -> Self {
        let units = columns.iter().map(|name| column_unit(case, kind, name)).collect();
        Self { kind, columns, units }
    }
}

/// Returns the unit of the table column `name` of a case.
pub fn column_unit(case: &Case, kind: TableKind, name: &str) -> &'static str {
    match (kind, name) {
        (_, "time") => "s",
        (TableKind::Receivers, _) => {
            name.rsplit_once('.').map_or("s", |(_, name)| quantity_unit(name))
        }
        (_, "power") => "W/m3",
        _ => energy_unit(case),
    }
}

/// Returns the unit of energies: J; in plane problems J/m, per out-of-plane length; for flows J/m³.
pub(super) fn energy_unit(case: &Case) -> &'static str {
    match &case.solid_run {
        None => "J/m3",
        Some(solid_run) if solid_run.grid.dimensions() == 2 => "J/m",
        Some(_) => "J",
    }
}

/// Progress of a simulation between two batches of time steps.
pub struct RunProgress<'a> {
    /// Number of time steps done.
    pub step_count: usize,
    /// Simulated time reached, s.
    pub time: f64,
    /// Duration of the simulation, s.
    pub duration: f64,
    /// Whether the duration has been reached.
    pub is_finished: bool,
    /// Statistics of the time steps.
    pub statistics: StepStatistics,
    /// Function that returns the state for a checkpoint; it fails if ranks cannot save their parts.
    pub save_state: &'a dyn Fn() -> Result<SavedState<'a>, Error>,
}

/// State for a checkpoint, of which the values by cell are not in memory.
pub struct SavedState<'a> {
    /// State without the sections with values by cell.
    pub without_cells: SimulationState,
    /// Source of the sections with values by cell; `None` if the ranks have written them to files of their own.
    pub cells: Option<&'a dyn StateSource>,
}

/// Function that restores a saved state: its sections without values by cell, and those with values by cell. Returns the
/// number of snapshots recorded before, or `None` if the state does not match the case.
pub type RestoreState<'a> =
    dyn FnMut(&SimulationState, &mut dyn CellSections) -> Option<usize> + 'a;

/// Statistics of the time steps of a solid or a flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepStatistics {
    /// Statistics of the time steps of a solid.
    Solid {
        /// Energy of the state, J; in plane problems J/m.
        energy: f64,
        /// Number of cells of the grid.
        cell_count: usize,
        /// Number of threads of the solver.
        thread_count: usize,
    },
    /// Statistics of the time steps of a flow.
    Flow {
        /// Kinetic energy in the last ledger row, J/m³.
        energy: f64,
        /// Number of stages of the last time step.
        stage_count: usize,
        /// Number of evaluations of the right-hand side so far.
        evaluation_count: usize,
        /// Number of pressure iterations so far.
        iteration_count: usize,
        /// Number of threads of the thread pool.
        thread_count: usize,
    },
}

/// Part of the cells of a solid that a process holds: those of its rank, or all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputPart {
    /// Part of the state for checkpoints.
    pub state: StatePart,
    /// Cells along each axis of the grid, whose fields are the output.
    pub cells: Vec<Range<usize>>,
}

impl OutputPart {
    /// Whether the process holds all cells.
    pub fn is_whole(&self) -> bool {
        let StatePart { grid_cells, cells, .. } = &self.state;
        cells.iter().zip(grid_cells).all(|(own, count)| *own == (0..*count))
    }
}

/// Output fields of a state, which are computed when they are asked for.
pub trait FieldSource {
    /// Returns all but the values by cell: time, coordinates, names of the quantities, and joints.
    fn describe(&self) -> OutputFields;

    /// Returns the number of layers of the cells of this process across the last axis; 1 if they cannot be read one by one.
    fn layer_count(&self) -> usize;

    /// Returns the number of cells of a layer.
    fn layer_size(&self) -> usize;

    /// Returns the values of the cells of some layers; without joints.
    ///
    /// # Errors
    /// Values that have been stored in a file cannot be read.
    fn read_layers(&self, layers: Range<usize>) -> io::Result<OutputFields>;

    /// Returns all fields.
    ///
    /// # Errors
    /// As [`read_layers`](Self::read_layers).
    fn read_all(&self) -> io::Result<OutputFields> {
        let joint_faces = self.describe().joint_faces;
        Ok(OutputFields { joint_faces, ..self.read_layers(0..self.layer_count())? })
    }
}

impl dyn FieldSource + '_ {
    /// Iterates over all fields by a few layers of cells at a time.
    pub fn slabs(&self) -> impl Iterator<Item = io::Result<OutputFields>> {
        let layer_count = self.layer_count();
        let quantity_count = self.describe().quantities.len();
        let layer_bytes = self.layer_size() * quantity_count.max(1) * size_of::<f64>();
        let slab_layers = (SLAB_BYTES / layer_bytes.max(1)).clamp(1, layer_count.max(1));
        (0..layer_count)
            .step_by(slab_layers)
            .map(move |first| self.read_layers(first..(first + slab_layers).min(layer_count)))
    }
}

/// Bytes of values that are in memory while fields are written, unless a layer of cells has more.
const SLAB_BYTES: usize = 4 << 20;

/// Store of bytes that are written, then read again.
pub trait FieldStore: io::Read + io::Write + io::Seek {}

impl<S: io::Read + io::Write + io::Seek> FieldStore for S {}

/// Recorder of the output of a simulation. An error returned by any method ends the run.
pub trait Recorder: Send {
    /// Returns the communication between the ranks that make the simulation together; `None` if this process makes it
    /// alone. Each rank has a recorder, which receives the fields of the cells of the rank; only that of the root receives
    /// records.
    fn communicator(&self) -> Option<Arc<dyn Communicator>> {
        None
    }

    /// Returns whether the run resumes from a saved state.
    fn is_resumed(&self) -> bool {
        false
    }

    /// Receives the part of the cells that this process holds, before the recording starts.
    fn set_part(&mut self, _part: OutputPart) {}

    /// Starts recording the given tables, and snapshots at the given times. The recorder of a resumed run calls
    /// `restore` with the saved state.
    ///
    /// # Errors
    /// The recorder cannot start, or the saved state does not match.
    fn start(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        restore: &mut RestoreState,
    ) -> Result<(), Error>;

    /// Records a row of a table.
    ///
    /// # Errors
    /// The output cannot be recorded.
    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error>;

    /// Creates the store in which fields are kept until they are recorded; in memory by default.
    fn create_field_store(&self) -> Box<dyn FieldStore> {
        Box::new(io::Cursor::new(Vec::new()))
    }

    /// Records a snapshot with its index, from 0, and fields.
    ///
    /// # Errors
    /// The output cannot be recorded.
    fn record_snapshot(&mut self, index: usize, fields: &dyn FieldSource) -> Result<(), Error>;

    /// Prepares the repetition of steps, by which the last valid state before a fault is found.
    ///
    /// # Errors
    /// The run is interrupted.
    fn begin_replay(&mut self) -> Result<(), Error> {
        Ok(())
    }

    /// Restores the last state that has been saved, or from which the run was resumed, by `restore`; `false` if there is none
    /// or it does not match the case.
    ///
    /// # Errors
    /// The state cannot be read.
    fn restore_saved(&mut self, restore: &mut RestoreState) -> Result<bool, Error> {
        let _ = restore;
        Ok(false)
    }

    /// Handles the progress after a batch of steps, when all output due has been recorded.
    ///
    /// # Errors
    /// The run is interrupted.
    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error>;

    /// Takes the fields of the final state, after [`finish`](Self::finish), and returns those with all values that the
    /// result keeps; `None` if it keeps a [description](FieldSource::describe) of them. All fields together take as much
    /// memory as the state.
    ///
    /// # Errors
    /// The fields cannot be recorded.
    fn record_final_fields(
        &mut self,
        fields: &dyn FieldSource,
    ) -> Result<Option<OutputFields>, Error> {
        Ok(Some(fields.read_all()?))
    }

    /// Ends recording after the last step and returns the records.
    ///
    /// # Errors
    /// The records cannot be completed or read.
    fn finish(&mut self, progress: &RunProgress) -> Result<RunRecords, Error>;
}
