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

pub(super) use animation::{ANIMATION, Animation, animation};
pub(super) use appended::records;
pub(super) use checkpoint::Checkpoint;

use super::signals::{self, Stage};
use super::write::{print, would_write};
use crate::case::Case;
use crate::cli::folder::ResultFolder;
use crate::cli::options::{check_threads, pool};
use crate::cli::{Error, Format, Options};
use crate::report::Rendered;
use crate::study::simulate::{Job, job};
use files::lock::Lock;
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
    if !options.force {
        job.refuse_excess(&plan)?;
    }
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    folder.check_runs()?;
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
    carry_out(&run, &*job, None, None, options.format, stdout)
}

/// Where a run goes, and how.
pub(super) struct Run<'a> {
    pub(super) case: &'a Case,
    pub(super) folder: &'a ResultFolder,
    pub(super) control: Control,
    pub(super) threads: Option<usize>,
}

/// Computes a run, from its beginning or from a checkpoint, and writes all of its results. A run that is resumed holds
/// the lock of its folder.
pub(super) fn carry_out(
    run: &Run,
    job: &dyn Job,
    from: Option<Checkpoint>,
    lock: Option<Lock>,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    signals::install();
    let _stage = signals::enter_until_dropped(Stage::Steps);
    let mut recorder = FileRecorder::new(run, from, lock);
    let pool = pool(run.threads)?;
    check_threads(pool.current_num_threads())?;
    let result = pool.install(|| job.carry_out(&mut recorder))?;
    if let Some(warning) = result.warning() {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    let Run { case, folder, .. } = run;
    let rendered = Rendered::new(&result, case)?;
    if let Some(mut files) = recorder.into_folder()? {
        match animation(case, folder)? {
            Animation::None => {}
            Animation::Empty => files.remove(ANIMATION)?,
            Animation::Drawn(bytes) => drop(files.write(ANIMATION, &bytes)?),
        }
        rendered.write(|name, bytes| files.write(name, bytes).map(drop).map_err(Error::from))?;
        files.finish()?;
    }
    print(&rendered, folder, format, stdout)?;
    result.stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
}
