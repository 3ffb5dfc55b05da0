//! Step by step, and what is written on the way.

use super::checkpoint::Checkpoint;
use super::control::{Keeper, computed, listen};
use super::files::{Files, Table, check_snapshots, columns};
use super::interpolation::{Stencil, interpolated, stencil};
use super::setup::{Setup, Steps, cell_at, centre};
use super::snapshots::{Schedule, Snapshot, between};
use super::solid::{Found, Job, Line, shown};
use super::{Run, Stopped};
use crate::Error;
use crate::case::CaseError;
use crate::case::dynamics::{Component, Ledger as LedgerKind};
use crate::output::Growing;
use crate::progress::Progress;
use crate::words::{short, unit_of};
use dynamics::ledger::{Energy, Ledger};
use dynamics::medium::Medium;
use dynamics::problem::Problem;
use dynamics::real::Real;
use dynamics::split::Split;
use files::vti::{Grid, ImageData, Storage};
use models::cosserat::waves::Field;
use std::fs::File;
use std::time::Instant;

/// Lines of the ledger where the case does not say how many.
const LINES: usize = 1000;
/// Steps between two looks whether all values are finite, at most.
const LOOK: usize = 64;

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
        run: &Run,
        media: Vec<Medium>,
        from: Option<Checkpoint>,
    ) -> Result<Found, Error> {
        listen(run.folder);
        let start = Start::new(self, media, run.threads)?;
        let mut march = March::<T, D>::new(start, run, from.as_ref())?;
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
            march.keep_state_before_snapshot();
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
    /// The cells that receivers need, ascending.
    watched: Vec<usize>,
    /// By receiver: places among these and weights, and the cell that holds it.
    stencils: Vec<(Stencil, usize)>,
}

impl<'a, const D: usize> Start<'a, D> {
    fn new(job: &'a Job<'a>, media: Vec<Medium>, threads: Option<usize>) -> Result<Self, Error> {
        let dynamics = job.dynamics;
        let names = shown(dynamics, &media[0].fields);
        let Setup { problem, steps, initial } = Setup::<D>::new(job.case, dynamics, media)?;
        let threads = threads.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        let most = Split::<f64, D>::max_parts(problem.first_axis(), &problem);
        let parts = threads.clamp(1, most);
        let mut stencils: Vec<(Stencil, usize)> = dynamics
            .receivers
            .iter()
            .map(|own| (stencil(dynamics, &problem.of_cell, own), cell_at(dynamics, &own.at)))
            .collect();
        let cells = stencils.iter().flat_map(|(stencil, _)| stencil);
        let mut watched: Vec<usize> = cells.map(|(cell, _)| *cell).collect();
        watched.sort_unstable();
        watched.dedup();
        for (cell, _) in stencils.iter_mut().flat_map(|(stencil, _)| stencil) {
            *cell = watched.partition_point(|own| own < cell);
        }
        Ok(Self { job, problem, steps, initial, parts, names, watched, stencils })
    }

    /// The state at the beginning.
    fn split<T: Real>(&self) -> Result<Split<T, D>, Error> {
        let first = self.problem.first_axis();
        let split = Split::with_first_axis(first, &self.problem, self.parts);
        let mut split = split.map_err(|error| {
            self.job.dynamics.locate("grid", error.to_string(), "see the README")
        })?;
        for (field, values) in &self.initial {
            split.set(*field, &values.iter().map(|value| T::of(*value)).collect::<Vec<_>>());
        }
        Ok(split)
    }
}

/// All that is shown of a state, by quantity and cell; the plastic dissipation last, where anything yields.
type Shown = Vec<Vec<f64>>;

/// A run on its way.
struct March<'a, T: Real, const D: usize> {
    start: Start<'a, D>,
    split: Split<T, D>,
    files: Files<'a>,
    keeper: Keeper<'a>,
    /// Places of what the receivers record, in all that is recorded of a step.
    columns: Vec<usize>,
    /// Steps between two lines of the ledger.
    lines: usize,
    /// When there are snapshots, if there are to be any.
    snapshots: Option<Schedule>,
    /// What is shown before a step within which a snapshot is due.
    before: Option<Shown>,
    /// Steps done.
    done: usize,
    /// The ledger after these.
    last: Line,
    energy_at_start: f64,
    /// When this part of the run began, and after how many steps.
    began: (Instant, usize),
    lock: File,
}

impl<'a, T: Real, const D: usize> March<'a, T, D> {
    /// A run at its beginning, or at a checkpoint.
    fn new(
        start: Start<'a, D>,
        run: &'a Run<'a>,
        from: Option<&Checkpoint>,
    ) -> Result<Self, Error> {
        let (job, dynamics, steps) = (start.job, start.job.dynamics, start.steps);
        let mut split = start.split::<T>()?;
        split.watch(&start.watched);
        if from.is_none() {
            check_yield(job, &split)?;
        }
        let (header, columns) = columns(&dynamics.receivers, &start.names);
        let receivers = (!dynamics.receivers.is_empty()).then_some((Growing::Receivers, header));
        let ledger = ledger_header(job).into_iter().map(str::to_owned).collect();
        let tables: Vec<Table> = receivers.into_iter().chain([(Growing::Ledger, ledger)]).collect();
        let has_snapshots = dynamics.output.snapshot_interval > 0.0;
        let (files, lock) = Files::open(run.folder, &tables, has_snapshots, from, |from| {
            from.solid().is_some_and(|snapshot| split.restore(&snapshot))
        })?;
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(LINES),
            seconds => interval(seconds, steps.step),
        };
        let snapshots = match dynamics.output.snapshot_interval {
            0.0 => None,
            seconds => Some(Schedule::new(seconds, dynamics.time.duration, steps.count)),
        };
        let done = from.map_or(0, |from| from.steps);
        if let (Some(_), Some(snapshots)) = (from, snapshots) {
            check_snapshots(run.folder, snapshots.until(done).map(|own| own.name("vti")))?;
        }
        let last = line(&split, steps.time(done));
        let energy_at_start = from.map_or(last.energy.total(), |from| from.start);
        let began = (Instant::now(), done);
        Ok(Self {
            start,
            split,
            files,
            keeper: Keeper::new(run),
            columns,
            lines,
            snapshots,
            before: None,
            done,
            last,
            energy_at_start,
            began,
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
        self.write_receivers(0)?;
        self.write_line(&self.last.clone())?;
        self.write_snapshots()
    }

    /// Steps to the next line, or state that a snapshot needs, or to the next look whether all values are
    /// finite.
    fn to_next_look(&self) -> usize {
        let to_next = |every: usize| every - self.done % every;
        let snapshot = self.snapshots.and_then(|own| own.to_next(self.done)).unwrap_or(LOOK);
        let next = to_next(self.lines).min(snapshot).min(LOOK);
        next.min(self.start.steps.count - self.done)
    }

    /// Keeps what is shown now if a snapshot is due before the next step ends.
    fn keep_state_before_snapshot(&mut self) {
        let is_needed = self.snapshots.is_some_and(|own| own.is_between(self.done));
        self.before = is_needed.then(|| self.shown());
    }

    fn shown(&self) -> Shown {
        let mut shown = self.split.shown();
        shown.extend(Some(self.split.dissipated()).filter(|own| !own.is_empty()));
        shown
    }

    /// Records the steps just made, which ended in `now`.
    fn record(&mut self, steps: usize, now: Line) -> Result<(), Error> {
        self.write_receivers(self.done + 1)?;
        self.done += steps;
        self.last = now;
        let is_last = self.done == self.start.steps.count;
        if is_last || self.done.is_multiple_of(self.lines) {
            self.write_line(&now)?;
        }
        self.write_snapshots()
    }

    /// Writes the snapshots that are due.
    fn write_snapshots(&mut self) -> Result<(), Error> {
        let Some(schedule) = self.snapshots else { return Ok(()) };
        let due: Vec<Snapshot> = schedule.due_at(self.done).collect();
        if due.is_empty() {
            return Ok(());
        }
        let now = self.shown();
        for own in &due {
            let image = match self.before.as_ref().filter(|_| own.part > 0.0) {
                Some(before) => self.image(&between(before, &now, own.part), own.time)?,
                None => self.image(&now, own.time)?,
            };
            let so_far = schedule.until(self.done).take(own.index + 1);
            let list: Vec<(f64, String)> = so_far.map(|own| (own.time, own.name("vti"))).collect();
            self.files.snapshot(&image, &list)?;
        }
        Ok(())
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
                    self.write_line(&self.last.clone())?;
                }
                return Ok(stopped);
            }
            self.write_receivers(self.done + 1)?;
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

    fn keep(&mut self) -> Result<(), Error> {
        let is_last = self.done == self.start.steps.count;
        let (split, time, start) = (&self.split, self.last.time, self.energy_at_start);
        self.keeper.keep(&mut self.files, is_last, |tables| {
            Checkpoint::of_solid(&split.snapshot(), time, tables, start)
        })
    }

    /// Adds what was recorded of steps, of which the first is `step`.
    fn write_receivers(&mut self, step: usize) -> Result<(), Error> {
        let names = self.start.names.len();
        let width = self.start.watched.len() * names;
        if width == 0 {
            return Ok(());
        }
        let mut row = Vec::with_capacity(self.columns.len() + 1);
        let mut state = Vec::with_capacity(self.start.stencils.len() * names);
        let Problem { media, of_cell, .. } = &self.start.problem;
        for (index, cells) in self.split.records().chunks_exact(width).enumerate() {
            state.clear();
            for (stencil, home) in &self.start.stencils {
                let first = state.len();
                let value = |name| interpolated(stencil, |place| cells[place * names + name]);
                state.extend((0..names).map(value));
                if stencil.len() > 1 {
                    media[usize::from(of_cell[*home])].make_admissible(&mut state[first..]);
                }
            }
            row.clear();
            row.push(self.start.steps.time(step + index));
            row.extend(self.columns.iter().map(|column| state[*column]));
            self.files.write(Growing::Receivers, &row)?;
        }
        Ok(())
    }

    fn write_line(&mut self, line: &Line) -> Result<(), Error> {
        let Ledger { inflow, sources, released, plastic, .. } = line.ledger;
        let Energy { kinetic, stored } = line.energy;
        let mut row = vec![line.time, kinetic, stored, inflow, sources, released, plastic];
        if self.start.job.dynamics.scheme.ledger == LedgerKind::Full {
            row.push(line.ledger.numerical);
        }
        row.push(line.balance(self.energy_at_start));
        self.files.write(Growing::Ledger, &row)
    }

    /// What is shown at a time (s), for ParaView.
    fn image(&self, shown: &Shown, time: f64) -> Result<ImageData, Error> {
        let dynamics = self.start.job.dynamics;
        let own = &dynamics.grid;
        let grid = Grid {
            cells: own.cells.clone(),
            origin: own.origin.clone(),
            spacing: own.spacing.clone(),
        };
        let mut image = ImageData::new(grid, Storage::Plain)?;
        image.set_time(time)?;
        let (values, dissipated) = shown.split_at(self.start.names.len());
        let names = &self.start.names;
        let is_velocity = |name: &str| name.starts_with('v');
        let of_velocity = names.iter().zip(values).filter(|(name, _)| is_velocity(name));
        let axes: Vec<&[f64]> = of_velocity.map(|(_, values)| values.as_slice()).collect();
        image.add_vector("velocity [m/s]", &axes)?;
        for (name, values) in names.iter().zip(values).filter(|(name, _)| !is_velocity(name)) {
            image.add(&format!("{name} [{}]", unit_of(name)), 1, values)?;
        }
        if let [dissipated] = dissipated {
            image.add("dissipation [J/m3]", 1, dissipated)?;
        }
        if !dynamics.regions.is_empty() {
            let of_cell = &self.start.problem.of_cell;
            let regions: Vec<i32> = of_cell.iter().map(|&region| i32::from(region)).collect();
            image.add("region", 1, &regions)?;
        }
        Ok(image)
    }

    /// What came out.
    fn finish(mut self, stopped: Option<Stopped>) -> Result<Found, Error> {
        computed();
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

fn ledger_header(job: &Job) -> Vec<&'static str> {
    let mut header =
        vec!["time", "kinetic", "stored", "sides", "sources", "initial_stress", "plastic"];
    header.extend(match job.dynamics.scheme.ledger {
        LedgerKind::Full => ["numerical", "residual"].as_slice(),
        LedgerKind::Light => &["balance"],
    });
    header
}
