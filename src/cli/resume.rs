//! `wellposed resume`: resumes a run from its last checkpoint.

use super::load::print_hints;
use super::run::{Checkpoint, CheckpointSettings, RunContext, execute_run};
use crate::case::TimeDomainRun;
use crate::cli::folder::{ResultFolder, UnfinishedRun};
use crate::cli::{CommandError, OutputFormat};
use crate::report::PictureOptions;
use crate::study::simulate::create_job;
use std::io::Write;
use std::path::Path;

/// Runs the verb `resume`: resumes an interrupted or killed run from its last checkpoint.
///
/// # Errors
/// The folder holds no run, a finished run, a run in progress, a run of another program version or of a changed case,
/// or a damaged checkpoint; memory is insufficient; the threads cannot be started; results cannot be written; or the
/// run was interrupted or stopped because of its state.
pub fn resume(
    path: &Path,
    threads: Option<usize>,
    checkpoint_settings: CheckpointSettings,
    format: OutputFormat,
    pictures: &PictureOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let (UnfinishedRun { folder, case, run_lock: lock }, found) = prepare_resumed_run(path, 1)?;
    let job = create_job(&case)?;
    let run = RunContext {
        case: &case,
        folder: &folder,
        checkpoint_settings,
        thread_count: threads,
        pictures,
        communicator: None,
    };
    execute_run(&run, &*job, found, Some(lock), format, stdout)
}

/// Opens the folder of an unfinished run, checks the memory, and prints the plan; returns the last checkpoint as well,
/// if there is one.
pub(super) fn prepare_resumed_run(
    path: &Path,
    rank_count: usize,
) -> Result<(UnfinishedRun, Option<Checkpoint>), CommandError> {
    let unfinished = ResultFolder::open_unfinished_run(path)?;
    let UnfinishedRun { folder, case, .. } = &unfinished;
    print_hints(case);
    let plan = create_job(case)?.plan(false, rank_count)?;
    let found = Checkpoint::read(folder)?;
    let duration = match case.time_domain_run()? {
        TimeDomainRun::Solid(solid_run) => solid_run.time.duration,
        TimeDomainRun::Flow(flow) => flow.time.duration,
    };
    let start = found.as_ref().map_or(0.0, |found| found.solver_state.time);
    let _ = writeln!(std::io::stderr(), "{plan}\nfrom {:.1} %", 100.0 * start / duration);
    Ok((unfinished, found))
}
