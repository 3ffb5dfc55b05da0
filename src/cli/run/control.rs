//! What ends a run early, and when checkpoints are due.

use super::Run;
use super::appended::Files;
use super::checkpoint::Checkpoint;
use crate::cli::Error;
use crate::cli::error::INTERRUPTED_CODE;
use crate::cli::folder::ResultFolder;
use crate::report::format::short;
use crate::study::simulate::Moment;
use std::io::{IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Whether somebody has asked the program to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether all steps are done, so that only results are left to be written.
static COMPUTED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C end the run after a checkpoint; a second one ends it at once, and takes away what is half-written.
pub(super) fn install_signal_handlers(folder: &ResultFolder) {
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
pub(super) struct CheckpointTimer<'a> {
    run: &'a Run<'a>,
    /// When the last one was written.
    last: Instant,
}

impl<'a> CheckpointTimer<'a> {
    pub(super) fn new(run: &'a Run<'a>) -> Self {
        Self { run, last: Instant::now() }
    }

    /// Writes a checkpoint if it is time, or if somebody has asked the program to end, which it then does
    /// unless the run is at its end.
    ///
    /// # Errors
    /// The run is interrupted, or the checkpoint cannot be written.
    pub(super) fn write_if_due(&mut self, files: &mut Files, moment: &Moment) -> Result<(), Error> {
        let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
        if !is_interrupted && self.last.elapsed().as_secs_f64() <= self.run.control.checkpoint_every
        {
            return Ok(());
        }
        let checkpoint = Checkpoint { tables: files.sync()?, state: (moment.state)() };
        checkpoint.write(self.run.folder)?;
        files.log(&format!("checkpoint at step {}", checkpoint.state.steps));
        self.last = Instant::now();
        if is_interrupted && !moment.is_finished {
            return Err(Error::Interrupted {
                time: short(checkpoint.state.time),
                folder: self.run.folder.path().display().to_string(),
            });
        }
        Ok(())
    }
}
