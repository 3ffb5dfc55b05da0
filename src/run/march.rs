//! Step by step, and what is written on the way.

use super::checkpoint::Checkpoint;
use super::setup::{Setup, Steps, cell_at, centre};
use super::{Found, Job, Line, Stopped, shown};
use crate::Error;
use crate::case::dynamics::{Component, Ledger as LedgerKind};
use crate::output::{Growing, OutputError, SNAPSHOTS};
use crate::progress::Progress;
use crate::words::{short, unit_of};
use dynamics::ledger::{Energy, Ledger};
use dynamics::line::GHOSTS;
use dynamics::medium::Medium;
use dynamics::real::Real;
use dynamics::split::Split;
use files::append::{Appender, Written};
use files::vti::{Grid, ImageData, Storage, collection};
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Lines of the ledger where the case does not say how many.
const LINES: usize = 1000;
/// Steps between two looks whether all values are finite, at most.
const LOOK: usize = 64;

/// Whether somebody has asked the program to end.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C end the run after a checkpoint; a second one ends it at once.
fn listen() {
    // Where another listener stands already it will do.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
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
        listen();
        let dynamics = self.dynamics;
        let fields = media[0].fields.clone();
        let Setup { problem, steps, initial } = Setup::<D>::new(self.case, dynamics, media)?;
        let threads = self.threads.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        let parts = threads.clamp(1, (problem.grid.cells[D - 1] / GHOSTS).max(1));
        let start = || -> Result<Split<T, D>, Error> {
            let mut split = Split::new(&problem, parts)
                .map_err(|error| dynamics.locate("grid", error.to_string(), "see the README"))?;
            for (field, values) in &initial {
                split.set(*field, &values.iter().map(|value| T::of(*value)).collect::<Vec<_>>());
            }
            Ok(split)
        };
        let mut split = start()?;
        let watched: Vec<usize> =
            dynamics.receivers.iter().map(|receiver| cell_at(dynamics, &receiver.at)).collect();
        split.watch(&watched);
        if let Some(cell) = split.first_beyond_yield().filter(|_| from.is_none()) {
            let place = centre(dynamics, cell);
            let found = format!("a stress beyond yield in the cell at {place:?}");
            let allowed = "initial stresses, and those of [initial_stress] with them, within the \
                           yield set";
            return Err(dynamics.locate("initial", found, allowed).into());
        }
        let names = shown(dynamics, &fields);
        let lock = self.folder.lock()?;
        let mut files = match &from {
            None => {
                self.folder.open_run()?;
                Files::create(self, &names, steps)?
            }
            Some(from) => {
                self.folder.sweep()?;
                let snapshot = from.snapshot().filter(|snapshot| split.restore(snapshot));
                snapshot.ok_or_else(|| Checkpoint::refused(self.folder))?;
                Files::resume(self, &names, steps, from.tables)?
            }
        };
        let line = |split: &Split<T, D>, done: usize| Line {
            time: steps.time(done),
            energy: split.energy(),
            ledger: split.ledger(),
        };
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(LINES),
            seconds => interval(seconds, problem.step),
        };
        let snapshots = match dynamics.output.snapshot_interval {
            0.0 => None,
            seconds => Some(interval(seconds, problem.step)),
        };
        let mut done = from.as_ref().map_or(0, |from| from.steps);
        let mut last = line(&split, done);
        let energy_at_start = from.as_ref().map_or(last.energy.total(), |from| from.start);
        let mut stopped = None;
        if let (Some(from), Some(every)) = (&from, snapshots) {
            let mut due = (0..=from.steps).step_by(every).map(snapshot_name);
            if let Some(name) = due.find(|own| !self.folder.path().join(own).exists()) {
                return Err(
                    OutputError::unusable(&self.folder.path().join(name), "is missing").into()
                );
            }
        }
        if from.is_none() && last.energy.total().is_finite() {
            split.record();
            files.receivers(&split.records(), 0)?;
            files.line(&last, energy_at_start)?;
            if snapshots.is_some() {
                files.snapshot(&split, &names, 0, snapshots, &problem.of_cell)?;
            }
        }
        if !last.energy.total().is_finite() {
            stopped = Some(self.broken(&split, 0.0));
        }
        let progress = Progress::new("run", steps.count as u64);
        progress.tick(done as u64);
        let (clock, mut kept, first) = (Instant::now(), Instant::now(), done);
        while done < steps.count && stopped.is_none() {
            let to_next = |every: usize| every - done % every;
            let next = to_next(lines).min(to_next(snapshots.unwrap_or(LOOK))).min(LOOK);
            let next = next.min(steps.count - done);
            split.advance(next);
            let now = line(&split, done + next);
            if !is_sound(&now) {
                // The same bits again as far as they were sound, then step by step.
                split = start()?;
                split.advance(done);
                split.watch(&watched);
                loop {
                    let sound = split.snapshot();
                    split.advance(1);
                    let now = line(&split, done + 1);
                    if !is_sound(&now) || done == steps.count {
                        stopped = Some(self.broken(&split, steps.time(done)));
                        split.restore(&sound);
                        break;
                    }
                    files.receivers(&split.records(), done + 1)?;
                    (done, last) = (done + 1, now);
                }
                if done > 0 && !done.is_multiple_of(lines) {
                    files.line(&last, energy_at_start)?;
                }
                break;
            }
            files.receivers(&split.records(), done + 1)?;
            done += next;
            last = now;
            if done.is_multiple_of(lines) || done == steps.count {
                files.line(&now, energy_at_start)?;
            }
            if snapshots.is_some_and(|every| done.is_multiple_of(every) || done == steps.count) {
                files.snapshot(&split, &names, done, snapshots, &problem.of_cell)?;
            }
            let updates = 2.0 * (done - first) as f64 * problem.grid.count() as f64;
            let rate = updates / clock.elapsed().as_secs_f64() / 1e6;
            progress.tick(next as u64);
            progress.note(format!(
                "t = {} s, energy {}, {rate:.0} million cell-updates/s",
                short(now.time),
                short(now.energy.total())
            ));
            let is_interrupted = INTERRUPTED.load(Ordering::Relaxed);
            if is_interrupted || kept.elapsed().as_secs_f64() > self.control.checkpoint_every {
                let tables = files.sync()?;
                Checkpoint::new(&split.snapshot(), tables, energy_at_start).write(self.folder)?;
                files.log(&format!("checkpoint at step {done}"));
                kept = Instant::now();
            }
            if is_interrupted && done < steps.count {
                return Err(Error::Interrupted {
                    time: short(now.time),
                    folder: self.folder.path().display().to_string(),
                });
            }
        }
        files.sync()?;
        let seconds = clock.elapsed().as_secs_f64();
        let updates = 2.0 * (done - first) as f64 * problem.grid.count() as f64;
        files.log(&format!(
            "{} steps in {seconds:.2} s with {parts} threads: {:.1} million cell-updates/s",
            done - first,
            updates / seconds / 1e6
        ));
        Ok(Found {
            values: split.shown(),
            dissipated: split.dissipated(),
            start: energy_at_start,
            last,
            steps,
            done,
            of_cell: problem.of_cell,
            stopped,
            lock,
        })
    }

    fn broken<T: Real, const D: usize>(&self, split: &Split<T, D>, saved: f64) -> Stopped {
        let what = match split.first_non_finite() {
            Some((field, cell)) => {
                let place = centre(self.dynamics, cell);
                format!("{} is not finite in the cell at {place:?} m", Component(field))
            }
            None => "the energy is not finite".to_owned(),
        };
        let remedy = "loads or initial values may be too large for the numbers";
        Stopped { what, time: short(split.time()), remedy, saved: short(saved) }
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
