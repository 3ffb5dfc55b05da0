//! A flow in time.

mod initial;

use super::checkpoint::Checkpoint;
use super::control::install_signal_handlers;
use super::files::{Table, columns};
use super::recorder::{Effort, Found, View, output_times, simulate};
use super::{IllPosed, Outcome, Run, Stopped, if_memory_suffices};
use crate::case::Case;
use crate::case::flow::{FlowRun, Grid, Quantity};
use crate::output::AppendedFile;
use crate::report::format::{case_title, short, unit_of};
use crate::{Error, pool, setup};
use analysis::StateError;
use analysis::flows::Workspace;
use analysis::growth::Verdict;
use dynamics::flow::{Closure, Energy, Left, Problem};
use dynamics::simulation::{FlowAccount, FlowFields, FlowSimulation};
use files::npz::Npz;
use files::vti::{Grid as ImageGrid, ImageData, Storage};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Numbers that a run keeps of a point, at most: 24 were found in 1024² points, to which a checkpoint and a
/// snapshot add theirs.
const NUMBERS: f64 = 40.0;

/// Lines of the ledger where the case does not say how many.
const LINES: f64 = 200.0;

/// A flow and the problem that it comes to.
pub(super) struct FlowJob<'a> {
    case: &'a Case,
    run: &'a FlowRun,
    problem: Problem,
    /// The fields of this flow.
    quantities: Vec<Quantity>,
}

/// The problem of a case in a box, with the tolerances that are the default.
///
/// # Errors
/// The case is none of a uniform flow that a solver takes.
pub(crate) fn flow_problem(
    case: &Case,
    points: [usize; 2],
    lengths: [f64; 2],
) -> Result<Problem, Error> {
    let mean = case.mean_flow()?;
    let model = case.model()?;
    let coulomb = *model.coulomb();
    let closure = Closure::from_rotation(case.rotation_in_time()?).expect("a determined rotation");
    Ok(Problem {
        closure,
        density: mean.density,
        friction_angle: coulomb.friction_angle,
        rotation_ratio: model.flow_rule().rotation_ratio(),
        cohesion: coulomb.cohesion,
        pressure: mean.stress.pressure,
        velocity_gradient: mean.velocity_gradient.map(|row| row.map(|entry| entry.value)),
        stress_angle: mean.stress.angle,
        spin: mean.spin.map_or(0.0, |spin| spin.value),
        spin_acceleration: case.numbers.background.spin_acceleration,
        points,
        lengths,
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        least_shear_rate: 1e-3,
    })
}

/// Velocities and ω or ψ of a case's perturbation at the points of a problem.
///
/// # Errors
/// The archive that a part names is not what it should be.
pub(crate) fn perturbation(
    run: &FlowRun,
    problem: &Problem,
) -> Result<([Vec<f64>; 2], Vec<f64>), Error> {
    let grid = Grid { cells: problem.points, lengths: problem.lengths };
    let fields = initial::fields(&run.on(grid), problem)?;
    Ok((fields.velocity, fields.inner))
}

impl<'a> FlowJob<'a> {
    pub(super) fn new(case: &'a Case, run: &'a FlowRun) -> Result<Self, Error> {
        let problem = Problem {
            tolerance: run.time.tolerance,
            pressure_tolerance: run.time.pressure_tolerance,
            least_shear_rate: run.least_shear_rate,
            ..flow_problem(case, run.grid.cells, run.grid.lengths)?
        };
        let quantities = Quantity::all(run.rotation);
        Ok(Self { case, run, problem, quantities })
    }
}

impl super::Job for FlowJob<'_> {
    fn plan(&self) -> Result<String, Error> {
        let grid = &self.run.grid;
        let [least, greatest] = self.wave_numbers();
        let plan = format!(
            "{} × {} points, {}, {} s, wave numbers from {} to {} 1/m",
            grid.cells[0],
            grid.cells[1],
            self.case.kind.title(),
            short(self.run.time.duration),
            short(least),
            short(greatest),
        );
        let needed = NUMBERS * size_of::<f64>() as f64 * grid.count() as f64;
        if_memory_suffices(&plan, needed, |found| {
            self.run.locate("grid.cells", found, "ask for fewer points")
        })
    }

    fn check(&self) -> Result<(), Error> {
        initial::fields(self.run, &self.problem)?;
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<String>, Error> {
        Ok(Vec::new())
    }

    fn ill_posed(&self) -> Result<Option<IllPosed>, Error> {
        let flow = self.case.mean_flow()?;
        let located = |error: StateError| setup::locate(self.case, error);
        let model = self.case.flow_model().map_err(|error| located(error.into()))?;
        let judged = Workspace::default().decide(&model, &flow);
        let (verdict, _) = judged.map_err(|error| located(error.into()))?;
        let Verdict::IllPosed { growth, direction } = verdict else { return Ok(None) };
        let [_, number] = self.wave_numbers();
        Ok(Some(IllPosed { growth, direction_deg: direction.to_degrees(), number }))
    }

    fn compute(&self, run: &Run, from: Option<Checkpoint>) -> Result<Outcome, Error> {
        install_signal_handlers(run.folder);
        let found = pool(run.threads)?.install(|| self.simulate(run, from))?;
        Ok(Outcome {
            words: self.words(&found),
            report: self.report(&found),
            fields: self.fields(&found)?,
            has_receivers: !self.run.receivers.is_empty(),
            stopped: found.stopped,
            lock: found.lock,
        })
    }
}

impl FlowJob<'_> {
    fn simulate(
        &self,
        run: &Run,
        from: Option<Checkpoint>,
    ) -> Result<Found<FlowSimulation>, Error> {
        let (case, duration) = (self.run, self.run.time.duration);
        let probes = case.receivers.iter().map(|own| case.grid.nearest(&own.at)).collect();
        let mut simulation = FlowSimulation::new(&self.problem, duration, probes)
            .map_err(|error| case.locate("grid", error.to_string(), "see the README"))?;
        // Left before it began: the perturbation asks for too much.
        let too_much = |left: Left| {
            let allowed = "a smaller perturbation, which leaves the flow deforming";
            case.locate("initial", told(&left), allowed)
        };
        if from.is_none() {
            let fields = initial::fields(case, &self.problem)?;
            let [v1, v2] = &fields.velocity;
            simulation.perturb([v1, v2], &fields.inner).map_err(too_much)?;
        }
        let lines = match case.output.ledger_interval {
            0.0 => duration / LINES,
            seconds => seconds,
        };
        let output = output_times(lines, case.output.snapshot_interval, duration);
        simulate(self, run, simulation, &output, duration, from)
    }

    /// Least and greatest wave number of the box along an axis at the beginning, 1/m.
    fn wave_numbers(&self) -> [f64; 2] {
        let grid = &self.run.grid;
        let least = grid.lengths.map(|length| 2.0 * std::f64::consts::PI / length);
        let modes = grid.greatest_modes();
        let greatest = [0, 1].map(|axis| modes[axis] as f64 * least[axis]);
        [least[0].min(least[1]), greatest[0].max(greatest[1])]
    }

    fn report(&self, found: &Found<FlowSimulation>) -> Value {
        let grid = &self.run.grid;
        let energy = found.last.energy;
        json!({
            "title": self.case.title,
            "model": self.case.kind.name(),
            "cells": grid.cells,
            "length": grid.lengths,
            "steps": found.steps,
            "time": found.time,
            "velocity_gradient": self.problem.velocity_gradient,
            "deformation": found.fields.deformation,
            "fields": self.quantities.iter().map(|own| own.array()).collect::<Vec<_>>(),
            "ledger": {
                "unit": "J/m3",
                "kinetic": energy.kinetic,
                "at_start": found.last.initial_energy,
                "background": energy.background,
                "stress": energy.stress,
                "balance": found.last.balance(),
                "power": energy.power,
            },
            "receivers": self.run.receivers.iter().map(|receiver| {
                let point = grid.nearest(&receiver.at);
                let index = [point % grid.cells[0], point / grid.cells[0]];
                let point = [grid.position(0, index[0]), grid.position(1, index[1])];
                json!({ "name": receiver.name, "at": receiver.at, "point": point })
            }).collect::<Vec<_>>(),
            "stopped": found.stopped.as_ref().map(ToString::to_string),
        })
    }

    fn fields(&self, found: &Found<FlowSimulation>) -> Result<Vec<u8>, Error> {
        let mut archive = Npz::new();
        let grid = &self.run.grid;
        for axis in 0..2 {
            let points: Vec<f64> = (0..grid.cells[axis]).map(|i| grid.position(axis, i)).collect();
            archive.add_f64(&format!("x{}", axis + 1), &[points.len()], &points)?;
        }
        archive.add_f64("time", &[], &[found.time])?;
        archive.add_f64("deformation", &[2, 2], found.fields.deformation.as_flattened())?;
        let names: Vec<&str> = self.quantities.iter().map(|own| own.array()).collect();
        let units: Vec<&str> = names.iter().map(|name| unit_of(name)).collect();
        archive.add_text("names", &[names.len()], &names)?;
        archive.add_text("units", &[units.len()], &units)?;
        // The first axis runs fastest.
        for (name, values) in names.iter().zip(&found.fields.values) {
            archive.add_f64(name, &[grid.cells[1], grid.cells[0]], values)?;
        }
        Ok(archive.finish()?)
    }

    fn words(&self, found: &Found<FlowSimulation>) -> String {
        let mut text = String::new();
        let energy = found.last.energy;
        let _ = writeln!(text, "{}", case_title(self.case));
        let _ = writeln!(text, "{} steps: t = {} s", found.steps, short(found.time));
        let mut line = |name: &str, value: f64, unit: &str| {
            let _ = writeln!(text, "  {name:<34} {:>11} {unit}", short(value));
        };
        line("kinetic energy at the start", found.last.initial_energy, "J/m³");
        line("kinetic energy", energy.kinetic, "J/m³");
        line("given by the mean flow", energy.background, "J/m³");
        line("work of the stress", energy.stress, "J/m³");
        line("left over (error of the steps)", found.last.balance(), "J/m³");
        line("internal power", energy.power, "W/m³");
        for (own, values) in self.quantities.iter().zip(&found.fields.values) {
            let [least, greatest] = range(values);
            let unit = unit_of(own.name());
            line(&format!("least {own}"), own.shown(least), unit);
            line(&format!("greatest {own}"), own.shown(greatest), unit);
        }
        text
    }
}

impl View<FlowSimulation> for FlowJob<'_> {
    const EXTENSION: &'static str = "vts";

    fn receivers(&self) -> Option<(Vec<String>, Vec<usize>)> {
        let names: Vec<&str> = self.quantities.iter().map(|own| own.name()).collect();
        let receivers = &self.run.receivers;
        (!receivers.is_empty()).then(|| columns(receivers, &names))
    }

    fn to_display_unit(&self, place: usize, value: f64) -> f64 {
        self.quantities[place % self.quantities.len()].shown(value)
    }

    fn tables(&self) -> Vec<Table> {
        let header = ["time", "kinetic", "background", "stress", "balance", "power"];
        let ledger = (AppendedFile::Ledger, header.map(str::to_owned).to_vec());
        let [most, across] = self.run.grid.greatest_modes();
        let shells = (1..=most.max(across)).map(|shell| shell.to_string());
        let header = ["time".to_owned()].into_iter().chain(shells).collect();
        vec![ledger, (AppendedFile::Spectrum, header)]
    }

    fn rows(&self, account: &FlowAccount) -> Vec<Vec<f64>> {
        let Energy { kinetic, background, stress, power } = account.energy;
        let ledger = vec![account.time, kinetic, background, stress, account.balance(), power];
        let spectrum = [account.time].iter().chain(&account.spectrum).copied().collect();
        vec![ledger, spectrum]
    }

    /// Where the box is.
    fn image(
        &self,
        _simulation: &FlowSimulation,
        fields: &FlowFields,
        time: f64,
    ) -> Result<ImageData, Error> {
        let own = &self.run.grid;
        let grid = ImageGrid {
            cells: own.cells.to_vec(),
            origin: vec![0.0; 2],
            spacing: [0, 1].map(|axis| own.lengths[axis] / own.cells[axis] as f64).to_vec(),
        };
        let mut image = ImageData::deformed(grid, fields.deformation, Storage::Plain)?;
        image.set_time(time)?;
        let [v1, v2, others @ ..] = fields.values.as_slice() else { return Ok(image) };
        image.add_vector("velocity [m/s]", &[v1, v2])?;
        for (quantity, values) in self.quantities.iter().skip(2).zip(others) {
            let name = quantity.array();
            image.add(&format!("{name} [{}]", unit_of(name)), 1, values)?;
        }
        Ok(image)
    }

    fn note(&self, simulation: &FlowSimulation, last: &FlowAccount, _effort: Effort) -> String {
        let flow = simulation.flow();
        let [time, energy] = [flow.time(), last.energy.kinetic].map(short);
        let [evaluations, iterations] = flow.effort();
        let iterations = iterations as f64 / evaluations.max(1) as f64;
        let (steps, stages) = (flow.steps(), flow.stages());
        format!(
            "t = {time} s, energy {energy}, step {steps} of {stages} stages, {iterations:.1} iterations \
             of the pressure"
        )
    }

    fn log(&self, _simulation: &FlowSimulation, effort: Effort) -> String {
        format!(
            "{} steps in {:.2} s with {} threads",
            effort.steps,
            effort.seconds,
            rayon::current_num_threads(),
        )
    }

    fn stopped(&self, left: &Left, saved: f64) -> Stopped {
        Stopped {
            what: told(left),
            time: short(left.time),
            remedy: match left.at {
                Some(_) => "a smaller perturbation goes on for longer if the state is well-posed",
                None => {
                    "a smaller perturbation or greater tolerances go on for longer if the state is well-posed"
                }
            },
            saved: short(saved),
        }
    }
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

/// Least and greatest.
fn range(values: &[f64]) -> [f64; 2] {
    values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(*value), high.max(*value)]
    })
}
