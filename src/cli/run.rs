//! `wellposed run`, and what it has in common with `wellposed resume`.
//!
//! [`study::simulate`] computes; here what it delivers on its way goes to files: tables are appended to line by line,
//! snapshots come one after the other. A checkpoint holds the state and what the tables held: what resumes from it
//! writes the same bits as a run that was never interrupted. The rest is written at the end.

mod animation;
mod appended;
mod checkpoint;
mod control;
mod planned;
mod recorder;

pub(super) use animation::animation;
pub(super) use appended::records;
pub(super) use checkpoint::Checkpoint;

use super::write::{files_into, print, would_write};
use crate::case::Case;
use crate::cli::folder::{AppendedFile, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Format, Options};
use crate::report::Rendered;
use crate::study::simulate::{Job, job};
use control::install_signal_handlers;
use recorder::FileRecorder;
use std::io::Write;

/// Seconds between two checkpoints where nothing else is asked for.
pub const CHECKPOINT_EVERY: f64 = 300.0;

/// How a run is kept from being lost.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Wall time between two checkpoints, s.
    pub checkpoint_every: f64,
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, memory is short, results cannot be written, or the run ended by its own state.
pub fn run(options: &Options, control: Control, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load_in_time(&options.case, &options.sets)?;
    let job = job(&case)?;
    let plan = job.plan(false)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    folder.check_runs(options.force)?;
    if options.dry_run {
        job.check()?;
        if let Some(found) = job.ill_posed()?.filter(|_| !options.accept_ill_posed) {
            return Err(Error::IllPosed(found));
        }
        writeln!(stdout, "would compute {plan}")?;
        return would_write(&folder, &planned::planned(&case)?, stdout);
    }
    // Nothing is left to be said if standard error is closed.
    let _ = writeln!(std::io::stderr(), "{plan}");
    for warning in job.warnings()? {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    match job.ill_posed()? {
        Some(found) if !options.accept_ill_posed => return Err(Error::IllPosed(found)),
        Some(found) => drop(writeln!(std::io::stderr(), "warning: {found}")),
        None => {}
    }
    let run = Run { case: &case, folder: &folder, control, threads: options.threads };
    carry_out(&run, &*job, None, options.format, stdout)
}

/// Where a run goes, and how.
pub(super) struct Run<'a> {
    pub(super) case: &'a Case,
    pub(super) folder: &'a ResultFolder,
    pub(super) control: Control,
    pub(super) threads: Option<usize>,
}

/// Computes a run, from its beginning or from a checkpoint, and writes all of its results.
pub(super) fn carry_out(
    run: &Run,
    job: &dyn Job,
    from: Option<Checkpoint>,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    install_signal_handlers(run.folder);
    let mut recorder = FileRecorder::new(run, from);
    let result = pool(run.threads)?.install(|| job.carry_out(&mut recorder))?;
    let Run { case, folder, .. } = run;
    let rendered = Rendered::new(&result, case)?;
    animation(case, folder)?;
    // The report comes last: the run is finished where it stands.
    rendered.write(files_into(folder))?;
    folder.remove(AppendedFile::Checkpoint)?;
    folder.remove(AppendedFile::Lock)?;
    drop(recorder);
    print(&rendered, folder, format, stdout)?;
    result.stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
}
