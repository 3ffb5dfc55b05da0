//! Recorder that writes the output of a simulation to files, and interrupts it on signals.

use super::Run;
use super::appended::{Files, records};
use super::checkpoint::Checkpoint;
use super::control::CheckpointTimer;
use crate::Error;
use crate::cli::folder::{RunFolder, snapshot_name};
use crate::cli::progress::Progress;
use crate::cli::signals::{self, Stage};
use crate::report::format::short;
use crate::report::run::{Time, image};
use crate::study::simulate::{Effort, Fields, Head, Moment, Recorder, Records, TableKind};
use dynamics::simulation::{RegularTimes, State};
use files::lock::Lock;
use std::io::{IsTerminal as _, Write as _};
use std::time::Instant;

/// Wall time between two progress lines if standard error is not a terminal, s.
const LINE_EVERY: f64 = 10.0;

/// Number of increments of the progress bar.
const PARTS: f64 = 1000.0;

/// Recorder of the files of a run; holds the run lock of the folder until dropped.
pub(super) struct FileRecorder<'a> {
    run: &'a Run<'a>,
    /// Checkpoint to resume from, until the run starts.
    from: Option<Checkpoint>,
    is_resumed: bool,
    files: Files<'a>,
    timer: CheckpointTimer<'a>,
    snapshots: Option<RegularTimes>,
    progress: Progress,
    /// Increments shown by the bar.
    parts: u64,
    /// Wall-clock start of this part of the run, steps done before it, and simulated time at its start, s.
    start: (Instant, usize, f64),
    /// Time of the last progress line.
    last_line: Instant,
}

impl<'a> FileRecorder<'a> {
    /// `lock` is the folder lock of a resumed run.
    pub(super) fn new(run: &'a Run<'a>, from: Option<Checkpoint>, lock: Option<Lock>) -> Self {
        Self {
            run,
            is_resumed: from.is_some(),
            from,
            files: Files::new(run.folder, lock),
            timer: CheckpointTimer::new(run),
            snapshots: None,
            progress: Progress::new("run", PARTS as u64),
            parts: 0,
            start: (Instant::now(), 0, 0.0),
            last_line: Instant::now(),
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
    fn tick(&mut self, time: f64, duration: f64) {
        let parts = (PARTS * time / duration) as u64;
        self.progress.tick(parts - self.parts);
        self.parts = parts;
    }

    /// Prints progress every [`LINE_EVERY`] seconds if standard error is not a terminal.
    fn say_progress(&mut self, moment: &Moment) {
        if std::io::stderr().is_terminal() || self.last_line.elapsed().as_secs_f64() < LINE_EVERY {
            return;
        }
        self.last_line = Instant::now();
        let (clock, _, from) = self.start;
        let rest = (moment.duration - moment.time) / (moment.time - from);
        let part = 100.0 * moment.time / moment.duration;
        let left = Time(clock.elapsed().as_secs_f64() * rest);
        let _ =
            writeln!(std::io::stderr(), "{part:.1} %, {} steps, about {left} left", moment.steps);
    }

    /// Returns the steps of this part of the run and their wall time, s.
    fn rate(&self, moment: &Moment) -> (usize, f64) {
        let (clock, first, _) = self.start;
        (moment.steps - first, clock.elapsed().as_secs_f64())
    }

    /// Returns the file name of a snapshot by its index.
    fn snapshot_name(&self, index: usize) -> String {
        snapshot_name(self.run.case, index)
    }
}

impl Recorder for FileRecorder<'_> {
    fn is_resumed(&self) -> bool {
        self.is_resumed
    }

    fn start(
        &mut self,
        tables: &[Head],
        snapshots: Option<RegularTimes>,
        restore: &mut dyn FnMut(&State) -> Option<usize>,
    ) -> Result<(), Error> {
        match self.from.take() {
            None => self.files.create(tables, snapshots.is_some())?,
            Some(from) => {
                let case = self.run.case;
                let snapshot =
                    |index| Some((snapshots.as_ref()?.time(index)?, snapshot_name(case, index)));
                self.files.resume(tables, &from, restore, snapshot)?;
                (self.start.1, self.start.2) = (from.state.steps, from.state.time);
            }
        }
        self.snapshots = snapshots;
        self.timer = CheckpointTimer::new(self.run);
        self.start.0 = Instant::now();
        Ok(())
    }

    fn row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        Ok(self.files.write(table.into(), row)?)
    }

    fn snapshot(&mut self, index: usize, fields: Fields) -> Result<(), Error> {
        let Some(times) = self.snapshots else { return Ok(()) };
        let image = image(self.run.case, &fields)?;
        drop(fields);
        let name = |index| Some((times.time(index)?, self.snapshot_name(index)));
        let list: Vec<(f64, String)> = (0..=index).map_while(name).collect();
        Ok(self.files.snapshot(&image, &list)?)
    }

    fn after_steps(&mut self, moment: &Moment) -> Result<(), Error> {
        self.tick(moment.time, moment.duration);
        self.say_progress(moment);
        self.progress.note(note(moment, self.rate(moment)));
        Ok(self.timer.write_if_due(&mut self.files, moment)?)
    }

    fn replay(&mut self) -> Result<(), Error> {
        signals::enter(Stage::Replay);
        match signals::is_interrupted() {
            true => Err(crate::cli::Error::InterruptedReplay {
                folder: self.run.folder.path().display().to_string(),
            }
            .into()),
            false => Ok(()),
        }
    }

    fn finish(&mut self, moment: &Moment) -> Result<Records, Error> {
        signals::enter(Stage::Results);
        self.files.sync()?;
        self.files.log(&log(moment, self.rate(moment)));
        Ok(records(self.run.case, self.run.folder)?)
    }
}

/// Describes the progress of a run; `rate` holds its steps so far and their wall time, s.
fn note(moment: &Moment, rate: (usize, f64)) -> String {
    let time = short(moment.time);
    match moment.effort {
        Effort::Solid { energy, cells, .. } => format!(
            "t = {time} s, energy {}, {:.0} million cell-updates/s",
            short(energy),
            cell_updates(cells, rate)
        ),
        Effort::Flow { energy, stages, evaluations, iterations, .. } => format!(
            "t = {time} s, energy {}, step {} of {stages} stages, {:.1} iterations of the pressure",
            short(energy),
            moment.steps,
            iterations as f64 / evaluations.max(1) as f64
        ),
    }
}

/// Describes steps, wall time and speed of a run.
fn log(moment: &Moment, (steps, seconds): (usize, f64)) -> String {
    match moment.effort {
        Effort::Solid { cells, threads, .. } => format!(
            "{steps} steps in {seconds:.2} s with {threads} threads: {:.1} million cell-updates/s",
            cell_updates(cells, (steps, seconds))
        ),
        Effort::Flow { threads, .. } => {
            format!("{steps} steps in {seconds:.2} s with {threads} threads")
        }
    }
}

/// Returns millions of cell updates per second, counting two updates per cell and step.
fn cell_updates(cells: usize, (steps, seconds): (usize, f64)) -> f64 {
    2.0 * steps as f64 * cells as f64 / seconds / 1e6
}
