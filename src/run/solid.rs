//! A solid in time.

use super::checkpoint::Checkpoint;
use super::setup::{Setup, Steps, cell_at, centre, media, steps};
use super::{IllPosed, Outcome, Run, Stopped, if_memory_suffices};
use crate::Error;
use crate::case::Case;
use crate::case::dynamics::{
    Action, Component, Dynamics, Kernel, Ledger as LedgerKind, Load, Precision, TimeFunction,
};
use crate::words::{case_title, short, unit_of};
use dynamics::domain::memory;
use dynamics::ledger::{Energy, Ledger};
use dynamics::medium::Medium;
use files::npz::Npz;
use models::cosserat::waves::Field;
use serde_json::json;
use std::fmt::Write as _;
use std::fs::File;

/// A line of the ledger.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub(super) time: f64,
    pub(super) energy: Energy,
    pub(super) ledger: Ledger,
}

impl Line {
    /// Energy that no term accounts for, J: rounding in a full ledger; in a light one it is what the scheme
    /// dissipates, with the sign turned.
    pub(super) fn balance(&self, start: f64) -> f64 {
        self.energy.total() - start - self.ledger.change()
    }
}

/// What came out.
pub(super) struct Found {
    /// By shown quantity and cell.
    pub(super) values: Vec<Vec<f64>>,
    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    pub(super) dissipated: Vec<f64>,
    /// Energy at the beginning, J.
    pub(super) start: f64,
    pub(super) last: Line,
    /// All steps of the case.
    pub(super) steps: Steps,
    /// How many of them were done.
    pub(super) done: usize,
    pub(super) of_cell: Vec<u16>,
    pub(super) stopped: Option<Stopped>,
    /// Held until all is written.
    pub(super) lock: File,
}

impl Found {
    /// The time that the run came to, s.
    fn time(&self) -> f64 {
        self.steps.time(self.done)
    }
}

/// Names of what is shown of a cell, in the order in which it is: fields, then integrals in time.
pub(super) fn shown(dynamics: &Dynamics, fields: &[Field]) -> Vec<String> {
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
pub(super) struct Job<'a> {
    pub(super) case: &'a Case,
    pub(super) dynamics: &'a Dynamics,
    media: Vec<Medium>,
}

impl<'a> Job<'a> {
    pub(super) fn new(case: &'a Case, dynamics: &'a Dynamics) -> Result<Self, Error> {
        Ok(Self { case, dynamics, media: media(case, dynamics)? })
    }
}

impl super::Job for Job<'_> {
    fn plan(&self) -> Result<String, Error> {
        let (dynamics, media) = (self.dynamics, &self.media);
        let Steps { count, step, by_rotation, .. } = steps(dynamics, media)?;
        let cells = dynamics.grid.cells.iter().map(usize::to_string).collect::<Vec<_>>();
        let plan = format!(
            "{} cells of {} fields, {count} steps of {} s ({})",
            cells.join(" × "),
            media[0].fields.len(),
            short(step),
            if by_rotation { "for the natural rotation" } else { "for the fastest wave" },
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
        let step = steps(self.dynamics, &self.media)?.step;
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
        let names = shown(self.dynamics, &self.media[0].fields);
        let media = self.media.clone();
        let found = match (self.dynamics.grid.dimensions(), self.dynamics.scheme.precision) {
            (2, Precision::F64) => self.march::<f64, 2>(run, media, from)?,
            (2, Precision::F32) => self.march::<f32, 2>(run, media, from)?,
            (_, Precision::F64) => self.march::<f64, 3>(run, media, from)?,
            (_, Precision::F32) => self.march::<f32, 3>(run, media, from)?,
        };
        Ok(Outcome {
            words: words(self.case, self.dynamics, &found),
            report: self.report(&names, &found),
            fields: fields(self.dynamics, &names, &found)?,
            has_receivers: !self.dynamics.receivers.is_empty(),
            stopped: found.stopped,
            lock: found.lock,
        })
    }
}

impl Job<'_> {
    fn report(&self, names: &[String], found: &Found) -> serde_json::Value {
        let dynamics = self.dynamics;
        let last = found.last;
        let is_full = dynamics.scheme.ledger == LedgerKind::Full;
        let mut ledger = json!({
            "unit": if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" },
            "kinetic": last.energy.kinetic,
            "stored": last.energy.stored,
            "at_start": found.start,
            "sides": last.ledger.inflow,
            "sources": last.ledger.sources,
            "initial_stress": last.ledger.released,
            "plastic": last.ledger.plastic,
        });
        if is_full {
            ledger["numerical"] = json!(last.ledger.numerical);
        }
        ledger[if is_full { "residual" } else { "balance" }] = json!(last.balance(found.start));
        json!({
            "title": self.case.title,
            "cells": dynamics.grid.cells,
            "steps": found.done,
            "step": found.steps.step,
            "time": found.time(),
            "precision": dynamics.scheme.precision.name(),
            "order": dynamics.scheme.order.name(),
            "fields": names,
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
}

fn fields(dynamics: &Dynamics, names: &[String], found: &Found) -> Result<Vec<u8>, Error> {
    let mut archive = Npz::new();
    let grid = &dynamics.grid;
    for axis in 0..grid.dimensions() {
        let middles: Vec<f64> = (0..grid.cells[axis]).map(|i| grid.centre(axis, i)).collect();
        archive.add_f64(&format!("x{}", axis + 1), &[middles.len()], &middles)?;
    }
    archive.add_f64("time", &[], &[found.time()])?;
    let units: Vec<&str> = names.iter().map(|name| unit_of(name)).collect();
    archive.add_text("names", &[names.len()], names)?;
    archive.add_text("units", &[units.len()], &units)?;
    // The first axis runs fastest.
    let shape: Vec<usize> = grid.cells.iter().rev().copied().collect();
    for (name, values) in names.iter().zip(&found.values) {
        archive.add_f64(name, &shape, values)?;
    }
    if !found.dissipated.is_empty() {
        archive.add_f64("dissipation", &shape, &found.dissipated)?;
    }
    if !dynamics.regions.is_empty() {
        let regions: Vec<i32> = found.of_cell.iter().map(|&region| i32::from(region)).collect();
        archive.add_i32("region", &shape, &regions)?;
    }
    Ok(archive.finish()?)
}

fn words(case: &Case, dynamics: &Dynamics, found: &Found) -> String {
    let mut text = String::new();
    let last = found.last;
    let unit = if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" };
    let _ = writeln!(text, "{}", case_title(case));
    let _ = writeln!(
        text,
        "{} steps of {} s: t = {} s",
        found.done,
        short(found.steps.step),
        short(found.time())
    );
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<34} {:>11} {unit}", short(value));
    };
    line("energy at the start", found.start);
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
            line("left over (rounding)", last.balance(found.start));
        }
        LedgerKind::Light => line("balance (the scheme's, not counted)", last.balance(found.start)),
    }
    text
}
