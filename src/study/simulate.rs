//! Time-domain simulation of a solid or a flow.
//!
//! A case is converted to a [`SimulationJob`], which the common driver of [`dynamics::simulation`] runs. The output
//! goes to a [`Recorder`]: that of [`simulate`] keeps it in memory, that of the command line writes files and
//! checkpoints. Results depend neither on the recorder nor on the number of threads of the surrounding `rayon` pool.

mod cost;
mod derived_fields;
mod flow;
mod joint;
mod memory_recorder;
mod observer;
mod plan;
mod recorder;
mod run_result;
mod solid;
mod split;
mod stop;
mod stored_fields;

pub use super::available_memory::Bytes;
pub use cost::{Cost, CostAmount, CostExcess};
pub use joint::{FaceRecord, JOINT_QUANTITIES, JointFace, JointQuantity, JointSummary};
pub use plan::{ProblemSize, SimulationPlan, SimulationWarning};
pub use recorder::{
    FieldSource, FieldStore, OutputPart, Recorder, RestoreState, RunProgress, SavedState,
    StepStatistics, TableHeader, TableKind, column_unit,
};
pub use run_result::{
    FieldQuantity, FinalLedger, OutputFields, RecordColumn, RecordTable, RunReceiver, RunRecords,
    RunResult, quantity_unit,
};
pub use split::{RankRow, SplitResult, plan_split};
pub use stop::{IllPosedness, StopCause, StopReport};

use super::ProgressCallback;
use crate::Error;
use crate::case::{Case, TimeDomainRun};
use memory_recorder::MemoryRecorder;
use serde::Serialize;
use std::ops::ControlFlow;

/// Options of a simulation that are not part of its case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct SimulationSettings {
    /// Whether a flow is simulated although its equations are ill-posed.
    pub accept_ill_posed: bool,
}

/// Simulates a solid or a flow and keeps the output in memory. Progress counts thousandths of the simulated duration.
///
/// A simulation that stops early because of its state returns a result as well, see [`RunResult::stop_report`].
///
/// # Errors
/// The case is invalid or has no simulation, its state cannot be analysed, memory is insufficient, there are too many
/// steps, the equations are ill-posed and the settings do not accept that, or the simulation was cancelled.
///
/// # Examples
/// ```
/// use wellposed::study::{simulate::SimulationSettings, ignore_progress};
///
/// let settings = ["grid.cells=[36, 36]", "initial[0].to=8", "time.duration=1e-4"];
/// let case = wellposed::load("cases/flow/decay.toml", &settings)?;
/// let found = wellposed::simulate(&case, SimulationSettings::default(), &ignore_progress)?;
/// assert!(found.stop_report.is_none());
/// let kinetic = found.records.ledger.get("kinetic").expect("a column");
/// assert!(kinetic.last() < kinetic.first());
/// assert_eq!(found.fields.get("v1").map(<[f64]>::len), Some(36 * 36));
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn simulate(
    case: &Case,
    settings: SimulationSettings,
    progress: ProgressCallback,
) -> Result<RunResult, Error> {
    run_in_memory(case, settings, progress, None)
}

/// Callback that takes each snapshot of a simulation; if it returns `Break`, the simulation ends with
/// [`Error::Cancelled`].
pub type SnapshotCallback<'a> = &'a mut (dyn FnMut(OutputFields) -> ControlFlow<()> + Send);

/// Simulates like [`simulate`], and passes each snapshot of the case to `on_snapshot` instead of keeping it.
///
/// # Errors
/// As [`simulate`]; [`Error::Cancelled`] also if `on_snapshot` returned `Break`.
///
/// # Examples
/// ```
/// use std::ops::ControlFlow;
/// use wellposed::study::simulate::{SimulationSettings, simulate_with_snapshots};
/// use wellposed::study::ignore_progress;
///
/// let settings = [
///     "grid.cells=[36, 36]",
///     "initial[0].to=8",
///     "time.duration=1e-4",
///     "output.snapshot_interval=5e-5",
/// ];
/// let case = wellposed::load("cases/flow/decay.toml", &settings)?;
/// let mut times = Vec::new();
/// let mut note_time = |fields: wellposed::study::simulate::OutputFields| {
///     times.push(fields.time);
///     ControlFlow::Continue(())
/// };
/// let options = SimulationSettings::default();
/// let found = simulate_with_snapshots(&case, options, &ignore_progress, &mut note_time)?;
/// assert_eq!(times.len(), 3);
/// assert!(found.records.snapshots.is_empty());
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn simulate_with_snapshots(
    case: &Case,
    settings: SimulationSettings,
    progress: ProgressCallback,
    on_snapshot: SnapshotCallback,
) -> Result<RunResult, Error> {
    run_in_memory(case, settings, progress, Some(on_snapshot))
}

fn run_in_memory(
    case: &Case,
    settings: SimulationSettings,
    progress: ProgressCallback,
    on_snapshot: Option<SnapshotCallback>,
) -> Result<RunResult, Error> {
    let job = create_job(case)?;
    job.plan(on_snapshot.is_none(), 1)?;
    match job.find_ill_posedness()? {
        Some(found) if !settings.accept_ill_posed => return Err(Error::IllPosed(found)),
        _ => {}
    }
    job.execute(&mut MemoryRecorder::new(progress, on_snapshot))
}

/// Time-domain simulation of a solid or a flow.
pub trait SimulationJob: Sync {
    /// Plans the computation in `rank_count` processes and checks that memory suffices for one of them, including that of
    /// all snapshots if `keeps_snapshots` is set.
    ///
    /// # Errors
    /// Memory is short, or there are too many steps.
    fn plan(&self, keeps_snapshots: bool, rank_count: usize) -> Result<SimulationPlan, Error>;

    /// Refuses a plan whose cost exceeds the limits of [`Cost::find_excess`].
    ///
    /// # Errors
    /// The cost exceeds a limit; the error names the responsible key.
    fn refuse_excess(&self, plan: &SimulationPlan) -> Result<(), Error>;

    /// Checks the complete case, including the initial state, without a time step.
    ///
    /// # Errors
    /// The case is invalid.
    fn check_case(&self) -> Result<(), Error>;

    /// Returns warnings on settings that are probably unintended.
    ///
    /// # Errors
    /// The number of time steps exceeds its limit.
    fn find_warnings(&self) -> Result<Vec<SimulationWarning>, Error>;

    /// Returns the ill-posedness found by the analysis; `None` if well-posed.
    ///
    /// # Errors
    /// The state cannot be analysed.
    fn find_ill_posedness(&self) -> Result<Option<IllPosedness>, Error>;

    /// Runs the simulation from its beginning or from the state of the recorder.
    ///
    /// # Errors
    /// The case is invalid, or the recorder failed.
    fn execute(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error>;
}

/// Creates the simulation of a case.
///
/// # Errors
/// The case is invalid or has no simulation.
pub fn create_job(case: &Case) -> Result<Box<dyn SimulationJob + '_>, Error> {
    Ok(match case.time_domain_run()? {
        TimeDomainRun::Solid(solid_run) => Box::new(solid::SolidJob::new(case, solid_run)?),
        TimeDomainRun::Flow(run) => Box::new(flow::FlowJob::new(case, run)?),
    })
}
