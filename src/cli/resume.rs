//! `wellposed resume`: resumes a run from its last checkpoint.

use super::run::{Checkpoint, Control, Run, carry_out};
use crate::case::InTime;
use crate::cli::folder::{Begun, ResultFolder};
use crate::cli::{Error, Format};
use crate::study::simulate::job;
use std::io::Write;
use std::path::Path;

/// Resumes an interrupted or killed run.
///
/// # Errors
/// The folder holds no run, a finished run, or a damaged checkpoint; otherwise the errors of [`run`](super::run()).
pub fn resume(
    path: &Path,
    threads: Option<usize>,
    control: Control,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let Begun { folder, case, lock } = ResultFolder::of_run(path)?;
    let job = job(&case)?;
    let plan = job.plan(false)?;
    let found = Checkpoint::read(&folder)?;
    let duration = match case.in_time()? {
        InTime::Solid(dynamics) => dynamics.time.duration,
        InTime::Flow(flow) => flow.time.duration,
    };
    let start = found.as_ref().map_or(0.0, |found| found.state.time);
    let _ = writeln!(std::io::stderr(), "{plan}\nfrom {:.1} %", 100.0 * start / duration);
    let run = Run { case: &case, folder: &folder, control, threads };
    carry_out(&run, &*job, found, Some(lock), format, stdout)
}
