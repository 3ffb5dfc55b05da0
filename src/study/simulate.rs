//! Time-domain simulation of a solid or a flow.
//!
//! A case is converted to a [`Job`], which the common driver of [`dynamics::simulation`] runs. Its output goes to a
//! [`Recorder`]: [`simulate`] keeps it in memory, the program writes files and checkpoints. Results depend neither on
//! the recorder nor on the number of threads of the surrounding `rayon` pool.

mod cost;
mod flow;
mod memory;
mod plan;
mod record;
mod solid;
mod stop;
mod value;
mod watch;

pub use super::available::Bytes;
pub use cost::{Amount, Cost, Excess};
pub use plan::{Plan, Warning, Work};
pub use record::{Effort, Head, Moment, Recorder, TableKind, column_unit};
pub use stop::{IllPosed, StopCause, Stopped};
pub use value::{
    Column, Fields, FinalLedger, Quantity, Receiver, Records, RunResult, Table, unit_of,
};

use super::OnProgress;
use crate::Error;
use crate::case::{Case, InTime};
use memory::InMemory;
use serde::Serialize;

/// Options of a simulation besides its case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Settings {
    /// Whether a flow is simulated although its equations are ill-posed.
    pub accept_ill_posed: bool,
}

/// Simulates a solid or a flow and keeps the output in memory. Progress counts thousandths of the duration.
///
/// A simulation stopped early by its own state returns a result as well, see [`RunResult::stopped`].
///
/// # Errors
/// The case is invalid or has no simulation, memory is short, the equations are ill-posed without acceptance in the
/// settings, or the simulation was cancelled.
///
/// # Examples
/// ```
/// use wellposed::study::{simulate::Settings, unwatched};
///
/// let settings = ["grid.cells=[36, 36]", "initial[0].to=8", "time.duration=1e-4"];
/// let case = wellposed::load("cases/flow/decay.toml", &settings)?;
/// let found = wellposed::simulate(&case, Settings::default(), &unwatched)?;
/// assert!(found.stopped.is_none());
/// let kinetic = found.records.ledger.get("kinetic").expect("a column");
/// assert!(kinetic.last() < kinetic.first());
/// assert_eq!(found.fields.get("v1").map(<[f64]>::len), Some(36 * 36));
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn simulate(case: &Case, settings: Settings, progress: OnProgress) -> Result<RunResult, Error> {
    let job = job(case)?;
    job.plan(true)?;
    match job.ill_posed()? {
        Some(found) if !settings.accept_ill_posed => return Err(Error::IllPosed(found)),
        _ => {}
    }
    job.carry_out(&mut InMemory::new(progress))
}

/// Time-domain simulation of a solid or a flow.
pub trait Job: Sync {
    /// Plans the computation and checks that memory suffices, including all snapshots if `keeps_snapshots` is set.
    ///
    /// # Errors
    /// Memory is short, or there are too many steps.
    fn plan(&self, keeps_snapshots: bool) -> Result<Plan, Error>;

    /// Refuses a plan whose cost exceeds the limits of [`Cost::excess`].
    ///
    /// # Errors
    /// The cost exceeds a limit; the error names the responsible key.
    fn refuse_excess(&self, plan: &Plan) -> Result<(), Error>;

    /// Checks the case completely, without a time step.
    ///
    /// # Errors
    /// The case is invalid.
    fn check(&self) -> Result<(), Error>;

    /// Returns warnings on settings that are probably unintended.
    ///
    /// # Errors
    /// There are too many steps.
    fn warnings(&self) -> Result<Vec<Warning>, Error>;

    /// Returns the ill-posedness found by the analysis, `None` if well-posed.
    ///
    /// # Errors
    /// The state cannot be analysed.
    fn ill_posed(&self) -> Result<Option<IllPosed>, Error>;

    /// Runs the simulation from its beginning or from the state of the recorder.
    ///
    /// # Errors
    /// The case is invalid, or the recorder failed.
    fn carry_out(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error>;
}

/// Creates the simulation of a case.
///
/// # Errors
/// The case is invalid or has no simulation.
pub fn job(case: &Case) -> Result<Box<dyn Job + '_>, Error> {
    Ok(match case.in_time()? {
        InTime::Solid(dynamics) => Box::new(solid::SolidJob::new(case, dynamics)?),
        InTime::Flow(run) => Box::new(flow::FlowJob::new(case, run)?),
    })
}
