//! Recorder that writes the output of a simulation to files, and interrupts it on signals.

use super::RunContext;
use super::checkpoint::Checkpoint;
use super::checkpoint_timer::CheckpointTimer;
use super::run_files::{RunFiles, read_records};
use crate::Error;
use crate::cli::folder::{RunFolder, has_joint_files, snapshot_files};
use crate::cli::progress::{DelayedProgressBar, PROGRESS_LINE_INTERVAL};
use crate::cli::signals::{self, ProgramStage};
use crate::report::format::format_short;
use crate::report::run::{DisplayTime, create_image, create_joint_lines};
use crate::study::simulate::{
    OutputFields, Recorder, RunProgress, RunRecords, StepStatistics, TableHeader, TableKind,
};
use dynamics::simulation::{RegularTimes, SimulationState};
use files::lock::Lock;
use std::io::{IsTerminal as _, Write as _};
use std::time::Instant;

/// Number of increments of the progress bar.
const PROGRESS_STEPS: f64 = 1000.0;

/// Starting point of the computation by this process.
struct RunStart {
    /// Wall-clock time of the start.
    clock: Instant,
    /// Number of steps done before by the interrupted run; 0 unless resumed.
    steps: usize,
    /// Simulated time at which this process starts, s.
    time: f64,
}

/// Recorder of the files of a run; holds the run lock of the folder until dropped.
pub(super) struct FileRecorder<'a> {
    context: &'a RunContext<'a>,
    /// Checkpoint to resume from, until the run starts.
    checkpoint: Option<Checkpoint>,
    is_resumed: bool,
    files: RunFiles<'a>,
    timer: CheckpointTimer<'a>,
    snapshot_times: Option<RegularTimes>,
    progress_bar: DelayedProgressBar,
    /// Number of increments that the bar shows.
    progress_steps: u64,
    start: RunStart,
    /// Wall-clock time of the last progress line.
    last_progress_line: Instant,
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
            context,
            is_resumed: checkpoint.is_some(),
            checkpoint,
            files: RunFiles::new(context.folder, lock),
            timer: CheckpointTimer::new(context),
            snapshot_times: None,
            progress_bar: DelayedProgressBar::new("run", PROGRESS_STEPS as u64),
            progress_steps: 0,
            start: RunStart { clock: Instant::now(), steps: 0, time: 0.0 },
            last_progress_line: Instant::now(),
        }
    }

    /// Returns the run folder, to which the final results are written; `None` if the run has not begun.
    ///
    /// # Errors
    /// The tables cannot be written.
    pub(super) fn into_folder(self) -> Result<Option<RunFolder<'a>>, crate::cli::Error> {
        self.files.into_folder()
    }

    /// Advances the progress bar to `time` of `duration`, both in s.
    fn advance_progress(&mut self, time: f64, duration: f64) {
        let steps = (PROGRESS_STEPS * time / duration) as u64;
        self.progress_bar.advance_by(steps - self.progress_steps);
        self.progress_steps = steps;
    }

    /// Prints progress every [`PROGRESS_LINE_INTERVAL`] if standard error is not a terminal.
    fn print_progress(&mut self, progress: &RunProgress) {
        if std::io::stderr().is_terminal()
            || self.last_progress_line.elapsed() < PROGRESS_LINE_INTERVAL
        {
            return;
        }
        self.last_progress_line = Instant::now();
        let RunStart { clock, time, .. } = self.start;
        let rest = (progress.duration - progress.time) / (progress.time - time);
        let part = 100.0 * progress.time / progress.duration;
        let remaining = DisplayTime(clock.elapsed().as_secs_f64() * rest);
        let _ = writeln!(
            std::io::stderr(),
            "{part:.1} %, {} steps, about {remaining} left",
            progress.steps
        );
    }

    /// Returns the number of steps done by this process and their wall time, s.
    fn step_timing(&self, progress: &RunProgress) -> (usize, f64) {
        let RunStart { clock, steps, .. } = self.start;
        (progress.steps - steps, clock.elapsed().as_secs_f64())
    }
}

impl Recorder for FileRecorder<'_> {
    fn is_resumed(&self) -> bool {
        self.is_resumed
    }

    fn start(
        &mut self,
        tables: &[TableHeader],
        snapshots: Option<RegularTimes>,
        restore: &mut dyn FnMut(&SimulationState) -> Option<usize>,
    ) -> Result<(), Error> {
        match self.checkpoint.take() {
            None => {
                let has_joints = has_joint_files(self.context.case);
                self.files.create(tables, snapshots.is_some(), has_joints)?;
            }
            Some(checkpoint) => {
                let case = self.context.case;
                let snapshot =
                    |index| Some((snapshots.as_ref()?.time(index)?, snapshot_files(case, index)));
                self.files.resume(tables, &checkpoint, restore, snapshot)?;
                (self.start.steps, self.start.time) =
                    (checkpoint.state.steps, checkpoint.state.time);
            }
        }
        self.snapshot_times = snapshots;
        self.timer = CheckpointTimer::new(self.context);
        self.start.clock = Instant::now();
        Ok(())
    }

    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        Ok(self.files.append_row(table.into(), row)?)
    }

    fn record_snapshot(&mut self, index: usize, fields: OutputFields) -> Result<(), Error> {
        let Some(times) = self.snapshot_times else { return Ok(()) };
        let case = self.context.case;
        let image = create_image(case, &fields)?;
        let joints = has_joint_files(case)
            .then(|| create_joint_lines(&fields.joints, fields.time))
            .transpose()?;
        drop(fields);
        let names = |index| Some((times.time(index)?, snapshot_files(case, index)));
        let list: Vec<(f64, Vec<String>)> = (0..=index).map_while(names).collect();
        Ok(self.files.write_snapshot(&image, joints.as_ref(), &list)?)
    }

    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error> {
        self.advance_progress(progress.time, progress.duration);
        self.print_progress(progress);
        self.progress_bar.set_message(format_progress(progress, self.step_timing(progress)));
        Ok(self.timer.write_if_due(&mut self.files, progress)?)
    }

    fn begin_replay(&mut self) -> Result<(), Error> {
        signals::set_stage(ProgramStage::Replay);
        match signals::is_interrupted() {
            true => Err(crate::cli::Error::InterruptedReplay {
                folder: self.context.folder.path().display().to_string(),
            }
            .into()),
            false => Ok(()),
        }
    }

    fn finish(&mut self, progress: &RunProgress) -> Result<RunRecords, Error> {
        signals::set_stage(ProgramStage::WritingResults);
        self.files.sync_tables()?;
        self.files.append_log(&format_log_line(progress, self.step_timing(progress)));
        Ok(read_records(self.context.case, self.context.folder)?)
    }
}

/// Describes the progress of a run; `timing` holds the number of steps done by this process and their wall time, s.
fn format_progress(progress: &RunProgress, timing: (usize, f64)) -> String {
    let time = format_short(progress.time);
    match progress.statistics {
        StepStatistics::Solid { energy, cells, .. } => format!(
            "t = {time} s, energy {}, {:.0} million cell-updates/s",
            format_short(energy),
            cell_update_rate(cells, timing)
        ),
        StepStatistics::Flow { energy, stages, evaluations, iterations, .. } => format!(
            "t = {time} s, energy {}, step {} of {stages} stages, {:.1} iterations of the pressure",
            format_short(energy),
            progress.steps,
            iterations as f64 / evaluations.max(1) as f64
        ),
    }
}

/// Describes the number of steps, their wall time and the speed of a run.
fn format_log_line(progress: &RunProgress, (steps, seconds): (usize, f64)) -> String {
    match progress.statistics {
        StepStatistics::Solid { cells, threads, .. } => format!(
            "{steps} steps in {seconds:.2} s with {threads} threads: {:.1} million cell-updates/s",
            cell_update_rate(cells, (steps, seconds))
        ),
        StepStatistics::Flow { threads, .. } => {
            format!("{steps} steps in {seconds:.2} s with {threads} threads")
        }
    }
}

/// Returns millions of cell updates per second, counting two updates per cell and step.
fn cell_update_rate(cells: usize, (steps, seconds): (usize, f64)) -> f64 {
    2.0 * steps as f64 * cells as f64 / seconds / 1e6
}
