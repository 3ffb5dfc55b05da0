//! A solid in time.

use super::checkpoint::Checkpoint;
use super::control::install_signal_handlers;
use super::files::{Table, columns};
use super::recorder::{Effort, Found, View, output_times, simulate};
use super::setup::{Setup, cell_at, centre, media, probe, time_steps};
use super::{IllPosed, Outcome, Run, Stopped, if_memory_suffices};
use crate::Error;
use crate::case::dynamics::{
    Action, Component, Dynamics, Kernel, Ledger as LedgerKind, Load, Precision, TimeFunction,
};
use crate::case::{Case, CaseError};
use crate::output::AppendedFile;
use crate::report::format::{case_title, short, unit_of};
use dynamics::domain::memory;
use dynamics::ledger::{Energy, Ledger};
use dynamics::medium::Medium;
use dynamics::real::Real;
use dynamics::simulation::{
    Simulation, SolidAccount, SolidFault, SolidFields, SolidSimulation, StepLimit, TimeSteps,
};
use files::npz::Npz;
use files::vti::{Grid, ImageData, Storage};
use models::cosserat::waves::Field;
use serde_json::json;
use std::fmt::Write as _;

/// Lines of the ledger where the case does not say how many.
const LINES: usize = 1000;

/// Names of what is shown of a cell, in the order in which it is: fields, then integrals in time.
fn quantities(dynamics: &Dynamics, fields: &[Field]) -> Vec<String> {
    let fields = fields.iter().map(|field| Component(*field).to_string());
    let integrals = dynamics.output.integrals.iter().filter_map(|own| own.integral());
    fields.chain(integrals).collect()
}

/// Memory of a run, bytes: the fields, and copies of them for a checkpoint and for the results.
fn needed(dynamics: &Dynamics, media: &[Medium]) -> f64 {
    let fields = media[0].fields.len();
    let own = match dynamics.scheme.precision {
        Precision::F64 => memory::<f64>(&dynamics.grid.cells, fields),
        Precision::F32 => memory::<f32>(&dynamics.grid.cells, fields),
    };
    // A snapshot between two steps needs both.
    let has_snapshots = dynamics.output.snapshot_interval > 0.0;
    let snapshot = if has_snapshots { fields + dynamics.output.integrals.len() + 1 } else { 0 };
    let copies =
        snapshot + 2 * fields + dynamics.initial.len() + 2 * dynamics.output.integrals.len() + 1;
    own + dynamics.grid.count() as f64 * (copies * size_of::<f64>()) as f64
}

/// A solid and its media.
pub(super) struct SolidJob<'a> {
    case: &'a Case,
    dynamics: &'a Dynamics,
    media: Vec<Medium>,
}

impl<'a> SolidJob<'a> {
    pub(super) fn new(case: &'a Case, dynamics: &'a Dynamics) -> Result<Self, Error> {
        Ok(Self { case, dynamics, media: media(case, dynamics)? })
    }
}

impl super::Job for SolidJob<'_> {
    fn plan(&self) -> Result<String, Error> {
        let (dynamics, media) = (self.dynamics, &self.media);
        let TimeSteps { count, step, limit, .. } = time_steps(dynamics, media)?;
        let cells = dynamics.grid.cells.iter().map(usize::to_string).collect::<Vec<_>>();
        let plan = format!(
            "{} cells of {} fields, {count} steps of {} s ({})",
            cells.join(" × "),
            media[0].fields.len(),
            short(step),
            match limit {
                StepLimit::Rotation => "for the natural rotation",
                StepLimit::Wave => "for the fastest wave",
            },
        );
        if_memory_suffices(&plan, needed(dynamics, media), |found| {
            let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
            dynamics.locate("grid.cells", found, allowed)
        })
    }

    fn check(&self) -> Result<(), Error> {
        let media = self.media.clone();
        match self.dynamics.grid.dimensions() {
            2 => drop(Setup::<2>::new(self.case, self.dynamics, media)?),
            _ => drop(Setup::<3>::new(self.case, self.dynamics, media)?),
        }
        Ok(())
    }

    fn warnings(&self) -> Result<Vec<String>, Error> {
        const FEW: f64 = 4.0;
        let step = time_steps(self.dynamics, &self.media)?.step;
        let loads = self.dynamics.loads.iter().map(|load| ("load", &load.time)).enumerate();
        let sources = self.dynamics.sources.iter().map(|own| ("source", &own.time)).enumerate();
        let warning = |(index, (name, time)): (usize, (&str, &TimeFunction))| {
            let shortest = time.shortest().filter(|time| *time < FEW * step)?;
            let steps = short(shortest / step);
            let text = format!("{name}[{index}].time changes within {steps} steps");
            Some(format!("{text}: smaller cells see more of it"))
        };
        let mut warnings: Vec<String> = loads.chain(sources).filter_map(warning).collect();
        if self.dynamics.time.courant == 1.0 {
            let loads = self.dynamics.loads.iter().enumerate();
            let of_load = |own: &Load| match &own.action {
                Action::Point { kernel, .. } => *kernel == Kernel::Cell,
                Action::Whole | Action::Part(_) => false,
            };
            let loads = loads.filter(|own| of_load(own.1)).map(|own| ("load", own.0));
            let sources = self.dynamics.sources.iter().enumerate();
            let sources =
                sources.filter(|own| own.1.kernel == Kernel::Cell).map(|own| ("source", own.0));
            warnings.extend(loads.chain(sources).map(|(name, index)| {
                format!(
                    "{name}[{index}] acts on one cell: at Courant number 1 nothing damps the \
                     sawtooth that it makes; the kernel \"spline\" makes none"
                )
            }));
        }
        Ok(warnings)
    }

    fn ill_posed(&self) -> Result<Option<IllPosed>, Error> {
        // Elastic, or with associated flow without softening: all others are refused.
        Ok(None)
    }

    fn compute(&self, run: &Run, from: Option<Checkpoint>) -> Result<Outcome, Error> {
        match (self.dynamics.grid.dimensions(), self.dynamics.scheme.precision) {
            (2, Precision::F64) => self.simulate::<f64, 2>(run, from),
            (2, Precision::F32) => self.simulate::<f32, 2>(run, from),
            (_, Precision::F64) => self.simulate::<f64, 3>(run, from),
            (_, Precision::F32) => self.simulate::<f32, 3>(run, from),
        }
    }
}

/// How many steps lie between two lines.
fn interval(seconds: f64, step: f64) -> usize {
    ((seconds / step).round() as usize).max(1)
}

impl SolidJob<'_> {
    /// Names of what is shown of a cell.
    fn names(&self) -> Vec<String> {
        quantities(self.dynamics, &self.media[0].fields)
    }

    fn simulate<T: Real, const D: usize>(
        &self,
        run: &Run,
        from: Option<Checkpoint>,
    ) -> Result<Outcome, Error> {
        install_signal_handlers(run.folder);
        let dynamics = self.dynamics;
        let simulation = self.simulation::<T, D>(run.threads)?;
        if let (None, Some(cell)) = (&from, simulation.first_beyond_yield()) {
            return Err(self.beyond_yield(cell).into());
        }
        let steps = simulation.time_steps();
        let lines = match dynamics.output.ledger_interval {
            0.0 => steps.count.div_ceil(LINES),
            seconds => interval(seconds, steps.step),
        };
        let duration = dynamics.time.duration;
        let accounts = lines as f64 * steps.step;
        let output = output_times(accounts, dynamics.output.snapshot_interval, duration);
        let found = simulate(self, run, simulation, &output, duration, from)?;
        Ok(Outcome {
            words: words(self.case, dynamics, steps, &found),
            report: self.report(steps, &found),
            fields: self.fields(&found)?,
            has_receivers: !dynamics.receivers.is_empty(),
            stopped: found.stopped,
            lock: found.lock,
        })
    }

    /// The solid at its beginning.
    fn simulation<T: Real, const D: usize>(
        &self,
        threads: Option<usize>,
    ) -> Result<SolidSimulation<T, D>, Error> {
        let dynamics = self.dynamics;
        let Setup { problem, steps, initial } =
            Setup::<D>::new(self.case, dynamics, self.media.clone())?;
        let threads = threads.unwrap_or_else(|| {
            std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
        });
        let of_cell = &problem.of_cell;
        let probes = dynamics.receivers.iter().map(|own| probe(dynamics, of_cell, own)).collect();
        let simulation = SolidSimulation::new(problem, steps, initial, probes, threads);
        Ok(simulation
            .map_err(|error| dynamics.locate("grid", error.to_string(), "see the README"))?)
    }

    /// That a stress is beyond yield at the beginning.
    fn beyond_yield(&self, cell: usize) -> CaseError {
        let place = centre(self.dynamics, cell);
        let found = format!("a stress beyond yield in the cell at {place:?}");
        let allowed =
            "initial stresses, and those of [initial_stress] with them, within the yield set";
        self.dynamics.locate("initial", found, allowed)
    }

    fn report<T: Real, const D: usize>(
        &self,
        steps: TimeSteps,
        found: &Found<SolidSimulation<T, D>>,
    ) -> serde_json::Value {
        let dynamics = self.dynamics;
        let last = found.last;
        let is_full = dynamics.scheme.ledger == LedgerKind::Full;
        let mut ledger = json!({
            "unit": if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" },
            "kinetic": last.energy.kinetic,
            "stored": last.energy.stored,
            "at_start": last.initial_energy,
            "sides": last.ledger.inflow,
            "sources": last.ledger.sources,
            "initial_stress": last.ledger.released,
            "plastic": last.ledger.plastic,
        });
        if is_full {
            ledger["numerical"] = json!(last.ledger.numerical);
        }
        ledger[if is_full { "residual" } else { "balance" }] = json!(last.balance());
        json!({
            "title": self.case.title,
            "cells": dynamics.grid.cells,
            "steps": found.steps,
            "step": steps.step,
            "time": found.time,
            "precision": dynamics.scheme.precision.name(),
            "order": dynamics.scheme.order.name(),
            "fields": self.names(),
            "ledger": ledger,
            "receivers": dynamics.receivers.iter().map(|receiver| json!({
                "name": receiver.name,
                "at": receiver.at,
                "cell": centre(dynamics, cell_at(dynamics, &receiver.at)),
                "interpolation": receiver.interpolation.name(),
            })).collect::<Vec<_>>(),
            "stopped": found.stopped.as_ref().map(ToString::to_string),
        })
    }

    fn fields<T: Real, const D: usize>(
        &self,
        found: &Found<SolidSimulation<T, D>>,
    ) -> Result<Vec<u8>, Error> {
        let dynamics = self.dynamics;
        let names = &self.names();
        let SolidFields { values, dissipated } = &found.fields;
        let mut archive = Npz::new();
        let grid = &dynamics.grid;
        for axis in 0..grid.dimensions() {
            let middles: Vec<f64> = (0..grid.cells[axis]).map(|i| grid.centre(axis, i)).collect();
            archive.add_f64(&format!("x{}", axis + 1), &[middles.len()], &middles)?;
        }
        archive.add_f64("time", &[], &[found.time])?;
        let units: Vec<&str> = names.iter().map(|name| unit_of(name)).collect();
        archive.add_text("names", &[names.len()], names)?;
        archive.add_text("units", &[units.len()], &units)?;
        // The first axis runs fastest.
        let shape: Vec<usize> = grid.cells.iter().rev().copied().collect();
        for (name, values) in names.iter().zip(values) {
            archive.add_f64(name, &shape, values)?;
        }
        if !dissipated.is_empty() {
            archive.add_f64("dissipation", &shape, dissipated)?;
        }
        if !dynamics.regions.is_empty() {
            let regions: Vec<i32> =
                dynamics.media_of_cells()?.iter().map(|&region| i32::from(region)).collect();
            archive.add_i32("region", &shape, &regions)?;
        }
        Ok(archive.finish()?)
    }
}

impl<T: Real, const D: usize> View<SolidSimulation<T, D>> for SolidJob<'_> {
    const EXTENSION: &'static str = "vti";

    fn receivers(&self) -> Option<(Vec<String>, Vec<usize>)> {
        let receivers = &self.dynamics.receivers;
        (!receivers.is_empty()).then(|| columns(receivers, &self.names()))
    }

    fn tables(&self) -> Vec<Table> {
        let mut header =
            vec!["time", "kinetic", "stored", "sides", "sources", "initial_stress", "plastic"];
        header.extend(match self.dynamics.scheme.ledger {
            LedgerKind::Full => ["numerical", "residual"].as_slice(),
            LedgerKind::Light => &["balance"],
        });
        vec![(AppendedFile::Ledger, header.into_iter().map(str::to_owned).collect())]
    }

    fn rows(&self, account: &SolidAccount) -> Vec<Vec<f64>> {
        let Ledger { inflow, sources, released, plastic, numerical, .. } = account.ledger;
        let Energy { kinetic, stored } = account.energy;
        let mut row = vec![account.time, kinetic, stored, inflow, sources, released, plastic];
        if self.dynamics.scheme.ledger == LedgerKind::Full {
            row.push(numerical);
        }
        row.push(account.balance());
        vec![row]
    }

    fn image(
        &self,
        simulation: &SolidSimulation<T, D>,
        fields: &SolidFields,
        time: f64,
    ) -> Result<ImageData, Error> {
        let dynamics = self.dynamics;
        let own = &dynamics.grid;
        let grid = Grid {
            cells: own.cells.clone(),
            origin: own.origin.clone(),
            spacing: own.spacing.clone(),
        };
        let mut image = ImageData::new(grid, Storage::Plain)?;
        image.set_time(time)?;
        let names = &self.names();
        let SolidFields { values, dissipated } = fields;
        let is_velocity = |name: &str| name.starts_with('v');
        let of_velocity = names.iter().zip(values).filter(|(name, _)| is_velocity(name));
        let axes: Vec<&[f64]> = of_velocity.map(|(_, values)| values.as_slice()).collect();
        image.add_vector("velocity [m/s]", &axes)?;
        for (name, values) in names.iter().zip(values).filter(|(name, _)| !is_velocity(name)) {
            image.add(&format!("{name} [{}]", unit_of(name)), 1, values)?;
        }
        if !dissipated.is_empty() {
            image.add("dissipation [J/m3]", 1, dissipated)?;
        }
        if !dynamics.regions.is_empty() {
            let of_cell = &simulation.problem().of_cell;
            let regions: Vec<i32> = of_cell.iter().map(|&region| i32::from(region)).collect();
            image.add("region", 1, &regions)?;
        }
        Ok(image)
    }

    fn note(
        &self,
        simulation: &SolidSimulation<T, D>,
        _last: &SolidAccount,
        effort: Effort,
    ) -> String {
        let now = simulation.account();
        let [time, energy] = [now.time, now.energy.total()].map(short);
        let rate = rate(simulation, effort);
        format!("t = {time} s, energy {energy}, {rate:.0} million cell-updates/s")
    }

    fn log(&self, simulation: &SolidSimulation<T, D>, effort: Effort) -> String {
        format!(
            "{} steps in {:.2} s with {} threads: {:.1} million cell-updates/s",
            effort.steps,
            effort.seconds,
            simulation.parts(),
            rate(simulation, effort)
        )
    }

    fn stopped(&self, fault: &SolidFault, saved: f64) -> Stopped {
        let what = match fault.place {
            Some((field, cell)) => {
                let place = centre(self.dynamics, cell);
                format!("{} is not finite in the cell at {place:?} m", Component(field))
            }
            None => "the energy is not finite".to_owned(),
        };
        let remedy = "loads or initial values may be too large for the numbers";
        Stopped { what, time: short(fault.time), remedy, saved: short(saved) }
    }
}

/// Millions of cell-updates per second: two of each cell in a step.
fn rate<T: Real, const D: usize>(simulation: &SolidSimulation<T, D>, effort: Effort) -> f64 {
    let updates = 2.0 * effort.steps as f64 * simulation.problem().grid.count() as f64;
    updates / effort.seconds / 1e6
}

fn words<T: Real, const D: usize>(
    case: &Case,
    dynamics: &Dynamics,
    steps: TimeSteps,
    found: &Found<SolidSimulation<T, D>>,
) -> String {
    let mut text = String::new();
    let last = found.last;
    let unit = if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" };
    let _ = writeln!(text, "{}", case_title(case));
    let _ = writeln!(
        text,
        "{} steps of {} s: t = {} s",
        found.steps,
        short(steps.step),
        short(found.time)
    );
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<34} {:>11} {unit}", short(value));
    };
    line("energy at the start", last.initial_energy);
    line("kinetic energy", last.energy.kinetic);
    line("stored energy", last.energy.stored);
    line("work at the sides", last.ledger.inflow);
    line("work of sources and weight", last.ledger.sources);
    if last.ledger.released != 0.0 {
        line("released by the initial stress", last.ledger.released);
    }
    line("plastic dissipation", last.ledger.plastic);
    match dynamics.scheme.ledger {
        LedgerKind::Full => {
            line("dissipation of the scheme", last.ledger.numerical);
            line("left over (rounding)", last.balance());
        }
        LedgerKind::Light => line("balance (the scheme's, not counted)", last.balance()),
    }
    text
}
