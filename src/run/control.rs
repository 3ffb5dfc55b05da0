//! What ends a run early, and when checkpoints are due.

use super::Run;
use super::checkpoint::Checkpoint;
use super::files::Files;
use crate::output::ResultFolder;
use crate::words::short;
use crate::{Error, INTERRUPTED_CODE};
use files::append::Written;
use std::io::{IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whether somebody has asked the program to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether all steps are done, so that only results are left to be written.
static COMPUTED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C end the run after a checkpoint; a second one ends it at once, and takes away what is half-written.
pub(super) fn listen(folder: &ResultFolder) {
    let folder = folder.clone();
    // Where another listener stands already it will do.
    let _ = ctrlc::set_handler(move || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            let _ = folder.sweep();
            std::process::exit(INTERRUPTED_CODE.into());
        }
        let stage = match COMPUTED.load(Ordering::Relaxed) {
            false => "finishing the step and writing a checkpoint",
            true => "all steps are done, writing results",
        };
        // On a terminal the bar stands in the line. Nothing is left to be said if nobody listens.
        let mut stderr = std::io::stderr();
        let start = if stderr.is_terminal() { "\n" } else { "" };
        let _ = writeln!(stderr, "{start}{stage}; press again to stop at once");
    });
}

/// Says that all steps are done.
pub(super) fn computed() {
    COMPUTED.store(true, Ordering::Relaxed);
}

/// Writes checkpoints when they are due.
pub(super) struct Keeper<'a> {
    run: &'a Run<'a>,
    /// When the last one was written.
    kept: Instant,
}

impl<'a> Keeper<'a> {
    pub(super) fn new(run: &'a Run<'a>) -> Self {
        Self { run, kept: Instant::now() }
    }

    /// Writes a checkpoint if it is time, or if somebody has asked the program to end, which it then does
    /// unless the run is at its end.
    pub(super) fn keep(
        &mut self,
        files: &mut Files,
        is_last: bool,
        checkpoint: impl FnOnce(Vec<Written>) -> Checkpoint,
    ) -> Result<(), Error> {
        let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
        if !is_interrupted && self.kept.elapsed().as_secs_f64() <= self.run.control.checkpoint_every
        {
            return Ok(());
        }
        let checkpoint = checkpoint(files.sync()?);
        checkpoint.write(self.run.folder)?;
        files.log(&format!("checkpoint at step {}", checkpoint.steps));
        self.kept = Instant::now();
        if is_interrupted && !is_last {
            return Err(Error::Interrupted {
                time: short(checkpoint.time),
                folder: self.run.folder.path().display().to_string(),
            });
        }
        Ok(())
    }
}
