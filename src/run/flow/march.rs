//! Step by step, and what is written on the way.

use super::super::checkpoint::Checkpoint;
use super::super::control::{Keeper, computed, listen};
use super::super::files::{Files, Table, check_snapshots, columns};
use super::super::{Run, Stopped, snapshots};
use super::times::Times;
use super::{Job, Values, initial, quantity};
use crate::Error;
use crate::case::flow::Quantity;
use crate::output::{Growing, ResultFolder};
use crate::progress::Progress;
use crate::words::{short, unit_of};
use dynamics::flow::{Energy, Flow, Left, Snapshot};
use files::vti::{Grid, ImageData, Storage};
use std::fs::File;
use std::time::Instant;

/// Parts of the duration at whose ends steps end; lines of the ledger where the case does not say how many.
const LINES: f64 = 200.0;
/// Parts of the duration that a bar of progress tells apart.
const PARTS: f64 = 1000.0;

/// What came out.
pub(super) struct Found {
    pub(super) values: Values,
    pub(super) deformation: [[f64; 2]; 2],
    /// Kinetic energy at the beginning, J/m³.
    pub(super) start: f64,
    pub(super) last: Line,
    pub(super) steps: usize,
    /// The time that the run came to, s.
    pub(super) time: f64,
    pub(super) stopped: Option<Stopped>,
    /// Held until all is written.
    pub(super) lock: File,
}

/// A line of the ledger.
#[derive(Clone, Copy)]
pub(super) struct Line {
    time: f64,
    pub(super) energy: Energy,
}

impl Line {
    /// Energy that no term accounts for, J/m³: the error of the steps.
    pub(super) fn balance(&self, start: f64) -> f64 {
        self.energy.kinetic - start - self.energy.background - self.energy.stress
    }
}

/// The time of the last line of the ledger, s.
fn last_time(folder: &ResultFolder) -> f64 {
    let text = std::fs::read_to_string(folder.growing(Growing::Ledger)).unwrap_or_default();
    let time = text.lines().next_back().and_then(|line| line.split(',').next()?.parse().ok());
    time.unwrap_or(f64::NEG_INFINITY)
}

/// What happened, and at which point if it is one that has left the fully deforming region.
fn told(left: &Left) -> String {
    match left.at.map(|at| at.map(short)) {
        Some([first, second]) => {
            format!("{} at [{first}, {second}] m in the box at the beginning", left.what)
        }
        None => left.what.clone(),
    }
}

impl Job<'_> {
    /// Computes the run, from its beginning or from a checkpoint.
    pub(super) fn march(&self, run: &Run, from: Option<&Checkpoint>) -> Result<Found, Error> {
        listen(run.folder);
        let mut march = March::new(self, run, from)?;
        let duration = self.run.time.duration;
        let done = |march: &March| (PARTS * march.flow.time() / duration) as u64;
        let mut shown = done(&march);
        let progress = Progress::new("run", PARTS as u64);
        progress.tick(shown);
        let mut stopped = None;
        while march.flow.time() < duration {
            if let Err(left) = march.step()? {
                stopped = Some(march.stop(&left)?);
                break;
            }
            progress.tick(done(&march) - shown);
            shown = done(&march);
            progress.note(march.note());
            march.keep()?;
        }
        march.finish(stopped)
    }
}

/// A run on its way.
struct March<'a> {
    job: &'a Job<'a>,
    flow: Flow,
    files: Files<'a>,
    keeper: Keeper<'a>,
    /// Points of the receivers.
    watched: Vec<usize>,
    /// Places of what the receivers record, in all quantities of their points.
    columns: Vec<usize>,
    /// Times of the lines of the ledger.
    lines: Times,
    /// Times of snapshots, if there are to be any.
    snapshots: Option<Times>,
    /// Number of snapshots written.
    written: usize,
    last: Line,
    energy_at_start: f64,
    /// When this part of the run began, and after how many steps.
    began: (Instant, usize),
    lock: File,
}

impl<'a> March<'a> {
    /// A run at its beginning, or at a checkpoint.
    fn new(job: &'a Job<'a>, run: &'a Run<'a>, from: Option<&Checkpoint>) -> Result<Self, Error> {
        let (case, duration) = (job.run, job.run.time.duration);
        let mut flow = Flow::new(&job.problem)
            .map_err(|error| case.locate("grid", error.to_string(), "see the README"))?;
        // Left before it began: the perturbation asks for too much.
        let too_much = |left: Left| {
            case.locate(
                "initial",
                told(&left),
                "a smaller perturbation, which leaves the flow deforming",
            )
        };
        if from.is_none() {
            let fields = initial::fields(case, &job.problem)?;
            let [v1, v2] = &fields.velocity;
            flow.perturb([v1, v2], &fields.inner).map_err(too_much)?;
        }
        let names: Vec<&str> = flow.fields().into_iter().map(|own| quantity(own).name()).collect();
        let (header, columns) = columns(&case.receivers, &names);
        let mut tables: Vec<Table> = Vec::new();
        if !case.receivers.is_empty() {
            tables.push((Growing::Receivers, header));
        }
        let ledger = ["time", "kinetic", "background", "stress", "balance", "power"];
        tables.push((Growing::Ledger, ledger.map(str::to_owned).to_vec()));
        let shells = (1..=flow.spectrum().len()).map(|shell| shell.to_string());
        let header = ["time".to_owned()].into_iter().chain(shells).collect();
        tables.push((Growing::Spectrum, header));
        let output = &case.output;
        let (files, lock) =
            Files::open(run.folder, &tables, output.snapshot_interval > 0.0, from, |from| {
                from.flow().is_some_and(|snapshot| flow.restore(&snapshot))
            })?;
        let lines = match output.ledger_interval {
            0.0 => duration / LINES,
            seconds => seconds,
        };
        let energy = flow.energy();
        // What resumes may have written no line of this state.
        let time = if from.is_some() { last_time(run.folder) } else { flow.time() };
        let last = Line { time, energy };
        let snapshots = Some(output.snapshot_interval).filter(|seconds| *seconds > 0.0);
        let snapshots = snapshots.map(|seconds| Times::new(seconds, duration));
        let mut march = Self {
            job,
            files,
            keeper: Keeper::new(run),
            watched: case.receivers.iter().map(|own| case.grid.nearest(&own.at)).collect(),
            columns,
            lines: Times::new(lines, duration),
            snapshots,
            written: 0,
            last,
            energy_at_start: from.map_or(energy.kinetic, |from| from.start),
            began: (Instant::now(), flow.steps()),
            flow,
            lock,
        };
        match from {
            None => {
                march.write_receivers()?;
                march.write_line(None)?;
                march.write_snapshot(None)?;
            }
            Some(_) => {
                march.written = snapshots.map_or(0, |times| times.until(march.flow.time()));
                let due = (0..march.written).map(|index| snapshots::name(index, "vts"));
                check_snapshots(run.folder, due)?;
            }
        }
        Ok(march)
    }

    /// One step, and what is to be recorded of it; no step depends on what that is.
    fn step(&mut self) -> Result<Result<(), Left>, Error> {
        let (time, duration) = (self.flow.time(), self.job.run.time.duration);
        let ends = Times::new(duration / LINES, duration);
        let before = self.flow.snapshot();
        if let Err(left) = self.flow.advance(ends.time(ends.until(time))) {
            return Ok(Err(left));
        }
        let now = self.flow.time();
        self.write_receivers()?;
        for index in self.lines.until(time)..self.lines.until(now) {
            match self.on_the_way(&before, self.lines.time(index))? {
                Ok(aside) => self.write_line(aside.as_ref())?,
                Err(left) => return Ok(Err(left)),
            }
        }
        let Some(times) = self.snapshots else { return Ok(Ok(())) };
        for index in self.written..times.until(now) {
            match self.on_the_way(&before, times.time(index))? {
                Ok(aside) => self.write_snapshot(aside.as_ref())?,
                Err(left) => return Ok(Err(left)),
            }
        }
        Ok(Ok(()))
    }

    /// The flow at a time during the last step, on its own way there from the state before; `None` where the step
    /// ended then.
    fn on_the_way(
        &self,
        before: &Snapshot,
        time: f64,
    ) -> Result<Result<Option<Flow>, Left>, Error> {
        if self.lines.is_one(time, self.flow.time()) {
            return Ok(Ok(None));
        }
        let mut aside = Flow::new(&self.job.problem)
            .map_err(|error| self.job.run.locate("grid", error.to_string(), "see the README"))?;
        aside.restore(before);
        while aside.time() < time {
            if let Err(left) = aside.advance(time) {
                return Ok(Err(left));
            }
        }
        Ok(Ok(Some(aside)))
    }

    /// The next snapshot: of the state, or of one on the way to it.
    fn write_snapshot(&mut self, aside: Option<&Flow>) -> Result<(), Error> {
        let Some(times) = self.snapshots else { return Ok(()) };
        let time = times.time(self.written);
        let image = self.image(aside.unwrap_or(&self.flow), time)?;
        self.written += 1;
        let name = |index| (times.time(index), snapshots::name(index, "vts"));
        let list: Vec<_> = (0..self.written).map(name).collect();
        self.files.snapshot(&image, &list)
    }

    fn write_receivers(&mut self) -> Result<(), Error> {
        if self.watched.is_empty() {
            return Ok(());
        }
        let values = self.flow.values();
        let fields: Vec<Quantity> = self.flow.fields().into_iter().map(quantity).collect();
        let state: Vec<f64> = self
            .watched
            .iter()
            .flat_map(|&point| {
                fields.iter().zip(&values).map(move |(own, values)| own.shown(values[point]))
            })
            .collect();
        let own = self.columns.iter().map(|column| state[*column]);
        let row: Vec<f64> = [self.flow.time()].into_iter().chain(own).collect();
        self.files.write(Growing::Receivers, &row)
    }

    /// A line of the ledger and one of the spectrum.
    fn write_line(&mut self, aside: Option<&Flow>) -> Result<(), Error> {
        let flow = aside.unwrap_or(&self.flow);
        let line = Line { time: flow.time(), energy: flow.energy() };
        self.last = line;
        let Energy { kinetic, background, stress, power } = line.energy;
        let balance = line.balance(self.energy_at_start);
        let row = [line.time, kinetic, background, stress, balance, power];
        self.files.write(Growing::Ledger, &row)?;
        let row: Vec<f64> = [line.time].into_iter().chain(flow.spectrum()).collect();
        self.files.write(Growing::Spectrum, &row)
    }

    /// The state for ParaView, where the box is.
    fn image(&self, flow: &Flow, time: f64) -> Result<ImageData, Error> {
        let own = &self.job.run.grid;
        let grid = Grid {
            cells: own.cells.to_vec(),
            origin: vec![0.0; 2],
            spacing: [0, 1].map(|axis| own.lengths[axis] / own.cells[axis] as f64).to_vec(),
        };
        let mut image = ImageData::deformed(grid, flow.deformation(), Storage::Plain)?;
        image.set_time(time)?;
        let values = flow.values();
        let [v1, v2, others @ ..] = values.as_slice() else { return Ok(image) };
        image.add_vector("velocity [m/s]", &[v1, v2])?;
        for (field, values) in flow.fields().into_iter().skip(2).zip(others) {
            let name = quantity(field).array();
            image.add(&format!("{name} [{}]", unit_of(name)), 1, values)?;
        }
        Ok(image)
    }

    /// The run ends here: the last line is that of the last state that had a stress everywhere.
    fn stop(&mut self, left: &Left) -> Result<Stopped, Error> {
        if self.last.time < self.flow.time() {
            self.write_line(None)?;
        }
        Ok(Stopped {
            what: told(left),
            time: short(left.time),
            remedy: match left.at {
                Some(_) => "a smaller perturbation goes on for longer if the state is well-posed",
                None => {
                    "a smaller perturbation or greater tolerances go on for longer if the state is well-posed"
                }
            },
            saved: short(self.flow.time()),
        })
    }

    fn note(&self) -> String {
        let [time, energy] = [self.flow.time(), self.last.energy.kinetic].map(short);
        let [evaluations, iterations] = self.flow.effort();
        let iterations = iterations as f64 / evaluations.max(1) as f64;
        let (steps, stages) = (self.flow.steps(), self.flow.stages());
        format!(
            "t = {time} s, energy {energy}, step {steps} of {stages} stages, {iterations:.1} iterations \
             of the pressure"
        )
    }

    fn keep(&mut self) -> Result<(), Error> {
        let (flow, start) = (&self.flow, self.energy_at_start);
        let is_last = flow.time() >= self.job.run.time.duration;
        self.keeper.keep(&mut self.files, is_last, |tables| {
            Checkpoint::of_flow(&flow.snapshot(), flow.time(), tables, start)
        })
    }

    /// What came out.
    fn finish(mut self, stopped: Option<Stopped>) -> Result<Found, Error> {
        computed();
        self.files.sync()?;
        let (clock, first) = self.began;
        self.files.log(&format!(
            "{} steps in {:.2} s with {} threads",
            self.flow.steps() - first,
            clock.elapsed().as_secs_f64(),
            rayon::current_num_threads(),
        ));
        let quantities = self.flow.fields().into_iter().map(quantity);
        Ok(Found {
            values: quantities.zip(self.flow.values()).collect(),
            deformation: self.flow.deformation(),
            start: self.energy_at_start,
            last: self.last,
            steps: self.flow.steps(),
            time: self.flow.time(),
            stopped,
            lock: self.lock,
        })
    }
}
