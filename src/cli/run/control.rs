//! Checkpoint timing and interruption of a run.

use super::Run;
use super::appended::Files;
use crate::cli::Error;
use crate::cli::signals::{self, Stage};
use crate::report::format::short;
use crate::study::simulate::Moment;
use std::time::Instant;

/// Timer that writes checkpoints when they are due.
pub(super) struct CheckpointTimer<'a> {
    run: &'a Run<'a>,
    /// Time of the last checkpoint.
    last: Instant,
}

impl<'a> CheckpointTimer<'a> {
    pub(super) fn new(run: &'a Run<'a>) -> Self {
        Self { run, last: Instant::now() }
    }

    /// Writes a checkpoint if the interval has passed or a signal was received; the signal then ends the run, unless it
    /// has finished.
    ///
    /// # Errors
    /// The run is interrupted, or the checkpoint cannot be written.
    pub(super) fn write_if_due(&mut self, files: &mut Files, moment: &Moment) -> Result<(), Error> {
        let is_interrupted = signals::is_interrupted();
        if !is_interrupted && self.last.elapsed().as_secs_f64() <= self.run.control.checkpoint_every
        {
            return Ok(());
        }
        if is_interrupted && !moment.is_finished {
            signals::enter(Stage::Checkpoint);
        }
        let checkpoint = files.checkpoint((moment.state)())?;
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
