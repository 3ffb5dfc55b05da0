//! `wellposed run`, and the code shared with `wellposed resume`.
//!
//! [`study::simulate`](mod@crate::study::simulate) computes; this module writes its output to files: rows are appended
//! to tables, snapshots are written one by one. A checkpoint holds the state and the lengths and checksums of tables
//! and snapshots; a resumed run writes the same bits as an uninterrupted run. The remaining results are written at the
//! end.

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

/// Default wall time between two checkpoints, s.
pub const CHECKPOINT_EVERY: f64 = 300.0;

/// Checkpoint settings of a run.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Wall time between two checkpoints, s.
    pub checkpoint_every: f64,
}

/// Runs `run`.
///
/// # Errors
/// The case is invalid, memory is short, its cost exceeds the limits, the equations are ill-posed, results cannot be
/// written, or the run was stopped by its own state.
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
    // A closed standard error is ignored.
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

/// Case, results folder and settings of a run.
pub(super) struct Run<'a> {
    pub(super) case: &'a Case,
    pub(super) folder: &'a ResultFolder,
    pub(super) control: Control,
    pub(super) threads: Option<usize>,
}

/// Computes a run from its beginning or from a checkpoint and writes all results. `lock` is the folder lock of a
/// resumed run.
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
