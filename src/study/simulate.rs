//! A solid or a flow in time.
//!
//! A case becomes a [`Job`], which the one loop of [`dynamics::simulation`] carries out. What comes out on the way goes
//! to a [`Recorder`]: [`simulate`] has one that keeps all of it in memory, the program one that writes files and
//! checkpoints. Results do not depend on the recorder, nor on threads: those of the surrounding `rayon` pool.

mod cost;
mod flow;
mod memory;
mod plan;
mod record;
mod solid;
mod stop;
mod value;
mod watch;

pub use cost::{Amount, Cost, Excess};
pub use plan::{Bytes, Plan, Warning, Work};
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
    /// Whether a flow is run in time although its equations are ill-posed.
    pub accept_ill_posed: bool,
}

/// Runs a solid or a flow in time, in memory. Progress counts thousandths of the duration.
///
/// A run that its own state ends before is a result as well: it says so in [`RunResult::stopped`].
///
/// # Errors
/// The case is wrong or does not say how it is run in time, memory is short, its equations are ill-posed, which the
/// settings do not accept, or the simulation was cancelled.
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

/// A case that is run in time: a solid or a flow.
pub trait Job: Sync {
    /// Plan of the computation, if memory suffices; including all snapshots if they are kept.
    ///
    /// # Errors
    /// Memory is short, or there would be too many steps.
    fn plan(&self, keeps_snapshots: bool) -> Result<Plan, Error>;

    /// That a plan takes what nobody means to spend.
    ///
    /// # Errors
    /// It does, and by which key.
    fn refuse_excess(&self, plan: &Plan) -> Result<(), Error>;

    /// Finds everything that can be wrong with the case.
    ///
    /// # Errors
    /// Checks the simulation for errors.
    fn check(&self) -> Result<(), Error>;

    /// Warnings: settings that are probably unintended.
    ///
    /// # Errors
    /// There would be too many steps.
    fn warnings(&self) -> Result<Vec<Warning>, Error>;

    /// Verdict of the analysis that argues against the simulation.
    ///
    /// # Errors
    /// Its state cannot be analysed.
    fn ill_posed(&self) -> Result<Option<IllPosed>, Error>;

    /// Computes it, from its beginning or from where the recorder says.
    ///
    /// # Errors
    /// The case is wrong, or the first error of the recorder.
    fn carry_out(&self, recorder: &mut dyn Recorder) -> Result<RunResult, Error>;
}

/// Time-domain simulation of a case.
///
/// # Errors
/// The case is wrong, or does not say how it is run in time.
pub fn job(case: &Case) -> Result<Box<dyn Job + '_>, Error> {
    Ok(match case.in_time()? {
        InTime::Solid(dynamics) => Box::new(solid::SolidJob::new(case, dynamics)?),
        InTime::Flow(run) => Box::new(flow::FlowJob::new(case, run)?),
    })
}
