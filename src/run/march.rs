//! Step by step, and what is written on the way.

use super::checkpoint::Checkpoint;
use super::setup::{Setup, Steps, cell_at, centre};
use super::{Found, Job, Line, Stopped, shown};
use crate::case::CaseError;
use crate::case::dynamics::{Component, Ledger as LedgerKind};
use crate::output::{Growing, OutputError, ResultFolder, SNAPSHOTS};
use crate::progress::Progress;
use crate::words::{short, unit_of};
use crate::{Error, INTERRUPTED_CODE};
use dynamics::ledger::{Energy, Ledger};
use dynamics::line::HALO;
use dynamics::medium::Medium;
use dynamics::problem::Problem;
use dynamics::real::Real;
use dynamics::split::Split;
use files::append::{Appender, Written};
use files::vti::{Grid, ImageData, Storage, collection};
use models::cosserat::waves::Field;
use std::fs::File;
use std::io::{IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Lines of the ledger where the case does not say how many.
const LINES: usize = 1000;
/// Steps between two looks whether all values are finite, at most.
const LOOK: usize = 64;

/// Whether somebody has asked the program to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);
/// Whether all steps are done, so that only results are left to be written.
static COMPUTED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C end the run after a checkpoint; a second one ends it at once, and takes away what is half-written.
fn listen(folder: &ResultFolder) {
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

/// Whether a state has numbers for its energy.
fn is_sound(line: &Line) -> bool {
    line.energy.total().is_finite() && line.ledger.change().is_finite()
}

/// How many steps lie between two lines or snapshots.
fn interval(seconds: f64, step: f64) -> usize {
    ((seconds / step).round() as usize).max(1)
}

impl Job<'_> {
    /// Computes the run, from its beginning or from a checkpoint.
    pub(super) fn march<T: Real, const D: usize>(
        &self,
        media: Vec<Medium>,
        from: Option<Checkpoint>,
    ) -> Result<Found, Error> {
        listen(self.folder);
        let mut march = March::<T, D>::new(Start::new(self, media)?, from.as_ref())?;
        let count = march.start.steps.count;
        let mut stopped = match march.last.energy.total().is_finite() {
            true => None,
            false => Some(march.broken(0.0)),
        };
        if from.is_none() && stopped.is_none() {
            march.record_start()?;
        }
        let progress = Progress::new("run", count as u64);
        progress.tick(march.done as u64);
        while march.done < count && stopped.is_none() {
            let next = march.to_next_look();
            march.split.advance(next);
            let now = march.line(march.done + next);
            if !is_sound(&now) {
                stopped = Some(march.up_to_fault()?);
                break;
            }
            march.record(next, now)?;
            progress.tick(next as u64);
            progress.note(march.note());
            march.keep()?;
        }
        march.finish(stopped)
    }
}

/// What a run begins with.
struct Start<'a, const D: usize> {
    job: &'a Job<'a>,
    problem: Problem<D>,
    steps: Steps,
    /// Values of the fields that are not zero, by cell.
    initial: Vec<(Field, Vec<f64>)>,
    /// Parts of the domain, one for each thread.
    parts: usize,
    /// Names of what is shown of a cell.
    names: Vec<String>,
    /// The cells of the receivers.
    watched: Vec<usize>,
}

impl<'a, const D: usize> Start<'a, D> {
    fn new(job: &'a Job<'a>, media: Vec<Medium>) -> Result<Self, Error> {
        let dynamics = job.dynamics;
        let names = shown(dynamics, &media[0].fields);
        let Setup { problem, steps, initial } = Setup::<D>::new(job.case, dynamics, media)?;
        let threads = job.threads.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        let parts = threads.clamp(1, (problem.grid.cells[D - 1] / HALO).max(1));
        let receivers = dynamics.receivers.iter();
        let watched = receivers.map(|receiver| cell_at(dynamics, &receiver.at)).collect();
        Ok(Self { job, problem, steps, initial, parts, names, watched })
    }

    /// The state at the beginning.
    fn split<T: Real>(&self) -> Result<Split<T, D>, Error> {
        let mut split = Split::new(&self.problem, self.parts).map_err(|error| {
            self.job.dynamics.locate("grid", error.to_string(), "see the README")
        })?;
        for (field, values) in &self.initial {
            split.set(*field, &values.iter().map(|value| T::of(*value)).collect::<Vec<_>>());
        }
        Ok(split)
    }
}

/// A run on its way.
struct March<'a, T: Real, const D: usize> {
    start: Start<'a, D>,
    split: Split<T, D>,
    files: Files<'a>,
    /// Steps between two lines of the ledger.
    lines: usize,
    /// Steps between two snapshots, if there are to be any.
    snapshots: Option<usize>,
    /// Steps done.
    done: usize,
    /// The ledger after these.
    last: Line,
    energy_at_start: f64,
    /// When this part of the run began, and after how many steps.
    began: (Instant, usize),
    /// When the last checkpoint was written.
    kept: Instant,
    lock: File,
}

impl<'a, T: Real, const D: usize> March<'a, T, D> {
    /// A run at its beginning, or at a checkpoint.
    fn new(start: Start<'a, D>, from: Option<&Checkpoint>) -> Result<Self, Error> {
        let (job, dynamics, steps) = (start.job, start.job.dynamics, start.steps);
        let mut split = start.split::<T>()?;
        split.watch(&start.watched);
        if from.is_none() {
            check_yield(job, &split)?;
        }
        let lock = job.folder.lock()?;
        let files = match from {
            None => {
                job.folder.open_run()?;
                Files::create(job, &start.names, steps)?
            }
            Some(from) => {
                job.folder.sweep()?;
                let snapshot = from.snapshot().filter(|snapshot| split.restore(snapshot));
                snapshot.ok_or_else(|| Checkpoint::refused(job.folder))?;
                Files::resume(job, &start.names, steps, from.tables)?
            }
        };
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(LINES),
            seconds => interval(seconds, steps.step),
        };
        let snapshots = match dynamics.output.snapshot_interval {
            0.0 => None,
            seconds => Some(interval(seconds, steps.step)),
        };
        let done = from.map_or(0, |from| from.steps);
        if let (Some(_), Some(every)) = (from, snapshots) {
            check_snapshots(job.folder, done, every)?;
        }
        let last = line(&split, steps.time(done));
        let energy_at_start = from.map_or(last.energy.total(), |from| from.start);
        let (began, kept) = ((Instant::now(), done), Instant::now());
        Ok(Self {
            start,
            split,
            files,
            lines,
            snapshots,
            done,
            last,
            energy_at_start,
            began,
            kept,
            lock,
        })
    }

    /// The ledger of the state, which so many steps have led to.
    fn line(&self, done: usize) -> Line {
        line(&self.split, self.start.steps.time(done))
    }

    /// Records the state before the first step.
    fn record_start(&mut self) -> Result<(), Error> {
        self.split.record();
        self.files.receivers(&self.split.records(), 0)?;
        self.files.line(&self.last, self.energy_at_start)?;
        self.snapshot_if(self.snapshots.is_some())
    }

    /// Steps to the next line or snapshot, or to the next look whether all values are finite.
    fn to_next_look(&self) -> usize {
        let to_next = |every: usize| every - self.done % every;
        let next = to_next(self.lines).min(to_next(self.snapshots.unwrap_or(LOOK))).min(LOOK);
        next.min(self.start.steps.count - self.done)
    }

    /// Records the steps just made, which ended in `now`.
    fn record(&mut self, steps: usize, now: Line) -> Result<(), Error> {
        self.files.receivers(&self.split.records(), self.done + 1)?;
        self.done += steps;
        self.last = now;
        let is_last = self.done == self.start.steps.count;
        if is_last || self.done.is_multiple_of(self.lines) {
            self.files.line(&now, self.energy_at_start)?;
        }
        let is_due = |every: usize| is_last || self.done.is_multiple_of(every);
        self.snapshot_if(self.snapshots.is_some_and(is_due))
    }

    fn snapshot_if(&self, is_due: bool) -> Result<(), Error> {
        if !is_due {
            return Ok(());
        }
        let (names, of_cell) = (&self.start.names, &self.start.problem.of_cell);
        self.files.snapshot(&self.split, names, self.done, self.snapshots, of_cell)
    }

    /// The same bits again as far as they were sound, then step by step up to the last sound state.
    fn up_to_fault(&mut self) -> Result<Stopped, Error> {
        self.split = self.start.split()?;
        self.split.advance(self.done);
        self.split.watch(&self.start.watched);
        loop {
            let sound = self.split.snapshot();
            self.split.advance(1);
            let now = self.line(self.done + 1);
            if !is_sound(&now) || self.done == self.start.steps.count {
                let stopped = self.broken(self.start.steps.time(self.done));
                self.split.restore(&sound);
                if self.done > 0 && !self.done.is_multiple_of(self.lines) {
                    self.files.line(&self.last, self.energy_at_start)?;
                }
                return Ok(stopped);
            }
            self.files.receivers(&self.split.records(), self.done + 1)?;
            (self.done, self.last) = (self.done + 1, now);
        }
    }

    /// What is wrong with the state; the last one without fault is that at the time `saved`, s.
    fn broken(&self, saved: f64) -> Stopped {
        let what = match self.split.first_non_finite() {
            Some((field, cell)) => {
                let place = centre(self.start.job.dynamics, cell);
                format!("{} is not finite in the cell at {place:?} m", Component(field))
            }
            None => "the energy is not finite".to_owned(),
        };
        let remedy = "loads or initial values may be too large for the numbers";
        Stopped { what, time: short(self.split.time()), remedy, saved: short(saved) }
    }

    /// Millions of cell-updates per second: two of each cell in a step.
    fn rate(&self) -> f64 {
        let (clock, first) = self.began;
        let updates = 2.0 * (self.done - first) as f64 * self.start.problem.grid.count() as f64;
        updates / clock.elapsed().as_secs_f64() / 1e6
    }

    fn note(&self) -> String {
        let [time, energy] = [self.last.time, self.last.energy.total()].map(short);
        format!("t = {time} s, energy {energy}, {:.0} million cell-updates/s", self.rate())
    }

    /// Writes a checkpoint if it is time, or if somebody has asked the program to end, which it then does.
    fn keep(&mut self) -> Result<(), Error> {
        let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
        if is_interrupted
            || self.kept.elapsed().as_secs_f64() > self.start.job.control.checkpoint_every
        {
            let tables = self.files.sync()?;
            let checkpoint = Checkpoint::new(&self.split.snapshot(), tables, self.energy_at_start);
            checkpoint.write(self.start.job.folder)?;
            self.files.log(&format!("checkpoint at step {}", self.done));
            self.kept = Instant::now();
        }
        if is_interrupted && self.done < self.start.steps.count {
            return Err(Error::Interrupted {
                time: short(self.last.time),
                folder: self.start.job.folder.path().display().to_string(),
            });
        }
        Ok(())
    }

    /// What came out.
    fn finish(mut self, stopped: Option<Stopped>) -> Result<Found, Error> {
        COMPUTED.store(true, Ordering::Relaxed);
        self.files.sync()?;
        let (clock, first) = self.began;
        self.files.log(&format!(
            "{} steps in {:.2} s with {} threads: {:.1} million cell-updates/s",
            self.done - first,
            clock.elapsed().as_secs_f64(),
            self.start.parts,
            self.rate()
        ));
        Ok(Found {
            values: self.split.shown(),
            dissipated: self.split.dissipated(),
            start: self.energy_at_start,
            last: self.last,
            steps: self.start.steps,
            done: self.done,
            of_cell: self.start.problem.of_cell,
            stopped,
            lock: self.lock,
        })
    }
}

fn line<T: Real, const D: usize>(split: &Split<T, D>, time: f64) -> Line {
    Line { time, energy: split.energy(), ledger: split.ledger() }
}

/// That no stress is beyond yield at the beginning.
fn check_yield<T: Real, const D: usize>(job: &Job, split: &Split<T, D>) -> Result<(), CaseError> {
    let Some(cell) = split.first_beyond_yield() else { return Ok(()) };
    let found = format!("a stress beyond yield in the cell at {:?}", centre(job.dynamics, cell));
    let allowed = "initial stresses, and those of [initial_stress] with them, within the yield set";
    Err(job.dynamics.locate("initial", found, allowed))
}

/// That no snapshot of the steps done is missing.
fn check_snapshots(folder: &ResultFolder, done: usize, every: usize) -> Result<(), OutputError> {
    let mut due = (0..=done).step_by(every).map(|step| folder.path().join(snapshot_name(step)));
    match due.find(|path| !path.exists()) {
        Some(path) => Err(OutputError::unusable(&path, "is missing")),
        None => Ok(()),
    }
}

/// The files that grow during a run.
struct Files<'a> {
    job: &'a Job<'a>,
    steps: Steps,
    /// Absent without receivers.
    receivers: Option<Appender>,
    ledger: Appender,
    /// Places of what the receivers record, in all that is recorded of a step.
    columns: Vec<usize>,
    /// Numbers recorded of a step.
    width: usize,
}

impl<'a> Files<'a> {
    fn create(job: &'a Job<'a>, names: &[String], steps: Steps) -> Result<Self, Error> {
        let (header, columns) = columns(job, names);
        let create = |file: Growing, header: &[&str]| {
            Appender::create(&job.folder.growing(file), header).map_err(OutputError::of_table)
        };
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        let receivers = (!job.dynamics.receivers.is_empty())
            .then(|| create(Growing::Receivers, &header))
            .transpose()?;
        let ledger = create(Growing::Ledger, &ledger_header(job))?;
        if job.dynamics.output.snapshot_interval > 0.0 {
            job.folder.write(SNAPSHOTS, &collection(&[] as &[(f64, &str)])?)?;
        }
        let width = job.dynamics.receivers.len() * names.len();
        Ok(Self { job, steps, receivers, ledger, columns, width })
    }

    fn resume(
        job: &'a Job<'a>,
        names: &[String],
        steps: Steps,
        tables: [Written; 2],
    ) -> Result<Self, Error> {
        let (_, columns) = columns(job, names);
        let resume = |file: Growing, written: Written| {
            Appender::resume(&job.folder.growing(file), written).map_err(OutputError::of_table)
        };
        let receivers = (!job.dynamics.receivers.is_empty())
            .then(|| resume(Growing::Receivers, tables[0]))
            .transpose()?;
        let ledger = resume(Growing::Ledger, tables[1])?;
        let width = job.dynamics.receivers.len() * names.len();
        Ok(Self { job, steps, receivers, ledger, columns, width })
    }

    /// Adds what was recorded of steps, of which the first is `step`.
    fn receivers(&mut self, records: &[f64], step: usize) -> Result<(), Error> {
        let Some(file) = &mut self.receivers else { return Ok(()) };
        let mut row = Vec::with_capacity(self.columns.len() + 1);
        for (index, state) in records.chunks_exact(self.width).enumerate() {
            row.clear();
            row.push(self.steps.time(step + index));
            row.extend(self.columns.iter().map(|column| state[*column]));
            file.write_row(&row).map_err(OutputError::of_table)?;
        }
        Ok(())
    }

    fn line(&mut self, line: &Line, start: f64) -> Result<(), Error> {
        let Ledger { inflow, sources, released, plastic, .. } = line.ledger;
        let Energy { kinetic, stored } = line.energy;
        let mut row = vec![line.time, kinetic, stored, inflow, sources, released, plastic];
        if self.job.dynamics.scheme.ledger == LedgerKind::Full {
            row.push(line.ledger.numerical());
        }
        row.push(line.balance(start));
        Ok(self.ledger.write_row(&row).map_err(OutputError::of_table)?)
    }

    /// Writes the state of a step for ParaView, and the list of all so far.
    fn snapshot<T: Real, const D: usize>(
        &self,
        split: &Split<T, D>,
        names: &[String],
        step: usize,
        every: Option<usize>,
        of_cell: &[u16],
    ) -> Result<(), Error> {
        let own = &self.job.dynamics.grid;
        let grid = Grid {
            cells: own.cells.clone(),
            origin: own.origin.clone(),
            spacing: own.spacing.clone(),
        };
        let mut image = ImageData::new(grid, Storage::Plain)?;
        image.set_time(self.steps.time(step))?;
        let values = split.shown();
        let is_velocity = |name: &str| name.starts_with('v');
        let of_velocity = names.iter().zip(&values).filter(|(name, _)| is_velocity(name));
        let axes: Vec<&[f64]> = of_velocity.map(|(_, values)| values.as_slice()).collect();
        image.add_vector("velocity [m/s]", &axes)?;
        for (name, values) in names.iter().zip(&values).filter(|(name, _)| !is_velocity(name)) {
            image.add(&format!("{name} [{}]", unit_of(name)), 1, values)?;
        }
        let dissipated = split.dissipated();
        if !dissipated.is_empty() {
            image.add("dissipation [J/m3]", 1, &dissipated)?;
        }
        if !self.job.dynamics.regions.is_empty() {
            let regions: Vec<i32> = of_cell.iter().map(|&region| i32::from(region)).collect();
            image.add("region", 1, &regions)?;
        }
        let folder = self.job.folder;
        folder.write(&snapshot_name(step), &image.bytes())?;
        // All that an uninterrupted run would have written by now.
        let every = every.unwrap_or(1);
        let mut list: Vec<usize> = (0..=step / every).map(|index| index * every).collect();
        if !step.is_multiple_of(every) {
            list.push(step);
        }
        let list: Vec<(f64, String)> =
            list.into_iter().map(|step| (self.steps.time(step), snapshot_name(step))).collect();
        Ok(folder.write(SNAPSHOTS, &collection(&list)?)?)
    }

    /// Brings the tables to the disk, and says what they hold.
    fn sync(&mut self) -> Result<[Written; 2], Error> {
        let receivers = match &mut self.receivers {
            Some(file) => file.sync().map_err(OutputError::of_table)?,
            None => Written::default(),
        };
        Ok([receivers, self.ledger.sync().map_err(OutputError::of_table)?])
    }

    /// Wall times and speeds, which no result holds. A log that cannot be written stops nothing.
    fn log(&self, text: &str) {
        let path = self.job.folder.growing(Growing::Log);
        if let Ok(mut file) = std::fs::OpenOptions::new().create(true).append(true).open(path) {
            let _ = writeln!(file, "{text}");
        }
    }
}

/// The name of a snapshot.
fn snapshot_name(step: usize) -> String {
    format!("snapshot-{step:08}.vti")
}

/// The header of the receivers' table, and where its columns stand in what is recorded of a step.
fn columns(job: &Job, names: &[String]) -> (Vec<String>, Vec<usize>) {
    let mut header = vec!["time".to_owned()];
    let mut columns = Vec::new();
    for (index, receiver) in job.dynamics.receivers.iter().enumerate() {
        for name in receiver.fields.iter().map(ToString::to_string) {
            if let Some(place) = names.iter().position(|own| *own == name) {
                header.push(format!("{}.{name}", receiver.name));
                columns.push(index * names.len() + place);
            }
        }
    }
    (header, columns)
}

fn ledger_header(job: &Job) -> Vec<&'static str> {
    let mut header =
        vec!["time", "kinetic", "stored", "sides", "sources", "initial_stress", "plastic"];
    header.extend(match job.dynamics.scheme.ledger {
        LedgerKind::Full => ["numerical", "residual"].as_slice(),
        LedgerKind::Light => &["balance"],
    });
    header
}
