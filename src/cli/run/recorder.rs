//! Recorder that writes the output of a simulation to files, and interrupts it on signals.

use super::RunContext;
use super::checkpoint::{Checkpoint, OpenedState};
use super::checkpoint_timer::CheckpointTimer;
use super::run_files::{RunFiles, read_records};
use crate::Error;
use crate::cli::CommandError;
use crate::cli::folder::{PartFile, RunFolder, has_joint_files, snapshot_file_names};
use crate::cli::parts::{create_field_store, write_fields};
use crate::cli::progress::{DelayedProgressBar, PROGRESS_LINE_INTERVAL};
use crate::cli::signals::{self, ProgramStage};
use crate::report::format::format_short;
use crate::report::run::{DisplayTime, create_joint_lines, whole_image, write_image};
use crate::study::simulate::{
    FieldSource, FieldStore, OutputFields, OutputPart, Recorder, RestoreState, RunProgress,
    RunRecords, StepStatistics, TableHeader, TableKind,
};
use dynamics::simulation::RegularTimes;
use files::SeekableWriter;
use files::lock::Lock;
use std::io::{self, IsTerminal as _, Write as _};
use std::time::Instant;

/// Number of increments of the progress bar over the duration of a run.
const PROGRESS_BAR_INCREMENTS: f64 = 1000.0;

/// Point of the run at which this process started to compute.
struct RunStart {
    /// Wall-clock time at which this process started to compute.
    wall_time: Instant,
    /// Number of steps that earlier processes of the run have done; 0 unless resumed.
    step_count: usize,
    /// Simulated time at which this process starts, s.
    simulated_time: f64,
}

/// Recorder of the files of a run; holds the run lock of the folder until dropped.
pub(in crate::cli) struct FileRecorder<'a> {
    run_context: &'a RunContext<'a>,
    /// Checkpoint to resume from, until the run starts.
    checkpoint: Option<Checkpoint>,
    is_resumed: bool,
    run_files: RunFiles<'a>,
    checkpoint_timer: CheckpointTimer<'a>,
    /// Part of the cells that this process holds.
    part: Option<OutputPart>,
    progress_bar: DelayedProgressBar,
    /// Number of increments that the progress bar has advanced.
    shown_increments: u64,
    run_start: RunStart,
    /// Wall-clock time of the last progress line.
    last_progress_line_time: Instant,
}

impl<'a> FileRecorder<'a> {
    /// Creates the recorder of a run, which resumes from `checkpoint` if there is one. `lock` is the run lock of a
    /// resumed run.
    pub(super) fn new(
        context: &'a RunContext<'a>,
        checkpoint: Option<Checkpoint>,
        lock: Option<Lock>,
    ) -> Self {
        Self {
            run_context: context,
            is_resumed: checkpoint.is_some(),
            checkpoint,
            run_files: RunFiles::new(context.folder, lock),
            checkpoint_timer: CheckpointTimer::new(context),
            part: None,
            progress_bar: DelayedProgressBar::new("run", PROGRESS_BAR_INCREMENTS as u64),
            shown_increments: 0,
            run_start: RunStart { wall_time: Instant::now(), step_count: 0, simulated_time: 0.0 },
            last_progress_line_time: Instant::now(),
        }
    }

    /// Returns the run folder, to which the final results are written; `None` if the run has not begun.
    ///
    /// # Errors
    /// The tables cannot be written.
    pub(super) fn into_folder(self) -> Result<Option<RunFolder<'a>>, crate::cli::CommandError> {
        self.run_files.into_folder()
    }

    /// Returns the files of the run, to which those of other ranks are added.
    pub(in crate::cli) fn run_files_mut(&mut self) -> &mut RunFiles<'a> {
        &mut self.run_files
    }

    /// Advances the progress bar to `time` of `duration`, both in s.
    fn advance_progress(&mut self, time: f64, duration: f64) {
        let steps = (PROGRESS_BAR_INCREMENTS * time / duration) as u64;
        self.progress_bar.advance_by(steps - self.shown_increments);
        self.shown_increments = steps;
    }

    /// Prints progress every [`PROGRESS_LINE_INTERVAL`] if standard error is not a terminal.
    fn print_progress(&mut self, progress: &RunProgress) {
        if std::io::stderr().is_terminal()
            || self.last_progress_line_time.elapsed() < PROGRESS_LINE_INTERVAL
        {
            return;
        }
        self.last_progress_line_time = Instant::now();
        let RunStart { wall_time: clock, simulated_time: time, .. } = self.run_start;
        let rest = (progress.duration - progress.time) / (progress.time - time);
        let part = 100.0 * progress.time / progress.duration;
        let remaining = DisplayTime(clock.elapsed().as_secs_f64() * rest);
        let _ = writeln!(
            std::io::stderr(),
            "{part:.1} %, {} steps, about {remaining} left",
            progress.step_count
        );
    }

    /// Opens the state of a checkpoint for the part that this process holds.
    fn open_state(&self, checkpoint: &Checkpoint) -> Result<OpenedState, CommandError> {
        Ok(checkpoint.open_state(self.part.as_ref().map(|part| &part.state))?)
    }

    /// Returns the number of steps done by this process and their wall time, s.
    fn steps_and_wall_time(&self, progress: &RunProgress) -> (usize, f64) {
        let RunStart { wall_time: clock, step_count: steps, .. } = self.run_start;
        (progress.step_count - steps, clock.elapsed().as_secs_f64())
    }
}

impl Recorder for FileRecorder<'_> {
    fn is_resumed(&self) -> bool {
        self.is_resumed
    }

    fn set_part(&mut self, part: OutputPart) {
        self.part = Some(part);
    }

    fn start(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        restore: &mut RestoreState,
    ) -> Result<(), Error> {
        match self.checkpoint.take() {
            None => {
                let has_joints = has_joint_files(self.run_context.case);
                self.run_files.begin_run(tables, snapshots, has_joints)?;
            }
            Some(checkpoint) => {
                // Each of several ranks loads its own part.
                let mut state = match self.part.as_ref().is_none_or(|part| part.is_whole()) {
                    true => self.open_state(&checkpoint)?,
                    false => OpenedState::default(),
                };
                let from = (&checkpoint, &mut state);
                self.run_files.resume_run(tables, from, restore, snapshots)?;
                if self.part.as_ref().is_none_or(OutputPart::is_whole) {
                    self.run_files.join_snapshots(self.run_context.case)?;
                }
                (self.run_start.step_count, self.run_start.simulated_time) =
                    (checkpoint.solver_state.steps, checkpoint.solver_state.time);
            }
        }
        self.checkpoint_timer = CheckpointTimer::new(self.run_context);
        self.run_start.wall_time = Instant::now();
        Ok(())
    }

    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        Ok(self.run_files.append_row(table.into(), row)?)
    }

    fn create_field_store(&self) -> Box<dyn FieldStore> {
        create_field_store(self.run_context.folder.path())
    }

    fn record_snapshot(&mut self, index: usize, fields: &dyn FieldSource) -> Result<(), Error> {
        let RunContext { case, folder, .. } = self.run_context;
        let joints = has_joint_files(case).then(|| {
            let OutputFields { joint_faces, time, .. } = fields.describe();
            create_joint_lines(&joint_faces, time)
        });
        let joints = joints.transpose()?;
        let names = snapshot_file_names(case, index);
        let (cells, storage) = whole_image(case)?;
        let write_fields = &mut |file: &mut dyn SeekableWriter| {
            write_image(case, fields, (&cells, storage), file, folder.path())
                .map_err(io::Error::other)
        };
        Ok(self.run_files.write_snapshot(write_fields, joints.as_ref(), names)?)
    }

    /// Writes the final fields of a solid by layers of cells, until they are archived when the solver has been dropped.
    fn record_final_fields(
        &mut self,
        fields: &dyn FieldSource,
    ) -> Result<Option<OutputFields>, Error> {
        let Some(part) = &self.part else { return Ok(Some(fields.read_all()?)) };
        let RunContext { case, folder, .. } = self.run_context;
        let path = folder.path().join(PartFile::Fields.name(case, 0));
        write_fields(&path, fields, &part.cells).map_err(CommandError::from)?;
        Ok(None)
    }

    fn restore_saved(&mut self, restore: &mut RestoreState) -> Result<bool, Error> {
        let mut restore_last = || -> Result<bool, CommandError> {
            let Some(checkpoint) = Checkpoint::read(self.run_context.folder)? else {
                return Ok(false);
            };
            Ok(self.open_state(&checkpoint)?.restore(restore)?.is_some())
        };
        // Without the checkpoint the run still ends with its fault: all steps are repeated.
        Ok(restore_last().unwrap_or_else(|error| {
            self.run_files.append_log(&format!("all steps are repeated: {error}"));
            false
        }))
    }

    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error> {
        self.advance_progress(progress.time, progress.duration);
        self.print_progress(progress);
        self.progress_bar
            .set_message(format_progress(progress, self.steps_and_wall_time(progress)));
        Ok(self.checkpoint_timer.write_checkpoint_if_due(&mut self.run_files, progress)?)
    }

    fn begin_replay(&mut self) -> Result<(), Error> {
        signals::set_stage(ProgramStage::Replay);
        match signals::is_interrupted() {
            true => Err(crate::cli::CommandError::InterruptedReplay {
                folder: self.run_context.folder.path().display().to_string(),
            }
            .into()),
            false => Ok(()),
        }
    }

    fn finish(&mut self, progress: &RunProgress) -> Result<RunRecords, Error> {
        signals::set_stage(ProgramStage::WritingResults);
        self.run_files.sync_tables()?;
        self.run_files.append_log(&format_log_line(progress, self.steps_and_wall_time(progress)));
        Ok(read_records(self.run_context.case, self.run_context.folder)?)
    }
}

/// Formats the progress of a run; `timing` contains the number of steps done by this process and their wall time, s.
fn format_progress(progress: &RunProgress, timing: (usize, f64)) -> String {
    let time = format_short(progress.time);
    match progress.statistics {
        StepStatistics::Solid { energy, cell_count: cells, .. } => format!(
            "t = {time} s, energy {}, {:.0} million cell-updates/s",
            format_short(energy),
            cell_update_rate(cells, timing)
        ),
        StepStatistics::Flow {
            energy,
            stage_count: stages,
            evaluation_count: evaluations,
            iteration_count: iterations,
            ..
        } => format!(
            "t = {time} s, energy {}, step {} of {stages} stages, {:.1} iterations of the pressure",
            format_short(energy),
            progress.step_count,
            iterations as f64 / evaluations.max(1) as f64
        ),
    }
}

/// Formats the number of steps, their wall time and the speed of a run.
fn format_log_line(progress: &RunProgress, (steps, seconds): (usize, f64)) -> String {
    match progress.statistics {
        StepStatistics::Solid { cell_count: cells, thread_count: threads, .. } => format!(
            "{steps} steps in {seconds:.2} s with {threads} threads: {:.1} million cell-updates/s",
            cell_update_rate(cells, (steps, seconds))
        ),
        StepStatistics::Flow { thread_count: threads, .. } => {
            format!("{steps} steps in {seconds:.2} s with {threads} threads")
        }
    }
}

/// Returns millions of cell updates per second, counting two updates per cell and step.
fn cell_update_rate(cells: usize, (steps, seconds): (usize, f64)) -> f64 {
    2.0 * steps as f64 * cells as f64 / seconds / 1e6
}
