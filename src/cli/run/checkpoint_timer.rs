//! Checkpoint timing and interruption of a run.

use super::RunContext;
use super::run_files::RunFiles;
use crate::cli::CommandError;
use crate::cli::signals::{self, ProgramStage};
use crate::report::format::format_short;
use crate::study::simulate::{RunProgress, SavedState};
use std::time::Instant;

/// Timer that writes checkpoints when they are due.
pub(super) struct CheckpointTimer<'a> {
    run_context: &'a RunContext<'a>,
    /// Wall-clock time of the last checkpoint.
    last_checkpoint_time: Instant,
}

impl<'a> CheckpointTimer<'a> {
    pub(super) fn new(context: &'a RunContext<'a>) -> Self {
        Self { run_context: context, last_checkpoint_time: Instant::now() }
    }

    /// Writes a checkpoint if the checkpoint interval has passed or a signal was received. A signal then ends the run,
    /// unless all its steps are done.
    ///
    /// # Errors
    /// The run is interrupted, or the checkpoint cannot be written.
    pub(super) fn write_checkpoint_if_due(
        &mut self,
        files: &mut RunFiles,
        progress: &RunProgress,
    ) -> Result<(), CommandError> {
        let is_interrupted = signals::is_interrupted();
        if !is_interrupted
            && self.last_checkpoint_time.elapsed().as_secs_f64()
                <= self.run_context.checkpoint_settings.interval
        {
            return Ok(());
        }
        if is_interrupted && !progress.is_finished {
            signals::set_stage(ProgramStage::WritingCheckpoint);
        }
        let SavedState { without_cells, cells } =
            (progress.save_state)().map_err(CommandError::from)?;
        let checkpoint = files.create_checkpoint(without_cells)?;
        checkpoint.write(self.run_context.folder, cells)?;
        self.run_context.folder.remove_checkpoint_parts(Some(checkpoint.solver_state.steps))?;
        files.append_log(&format!("checkpoint at step {}", checkpoint.solver_state.steps));
        self.last_checkpoint_time = Instant::now();
        if is_interrupted && !progress.is_finished {
            return Err(CommandError::Interrupted {
                simulated_time: format_short(checkpoint.solver_state.time),
                folder: self.run_context.folder.path().display().to_string(),
            });
        }
        Ok(())
    }
}
