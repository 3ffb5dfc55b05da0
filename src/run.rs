//! `wellposed run` and `wellposed resume`: a solid in time.
//!
//! Receivers and ledger grow line by line, snapshots come one after the other; all else is written at the
//! end. A checkpoint holds the state and what the growing files held: what resumes from it writes the
//! same bits as a run that was never interrupted.

mod checkpoint;
mod march;
mod setup;

use crate::case::Case;
use crate::case::dynamics::{Component, Dynamics, Ledger as LedgerKind, Precision};
use crate::output::{Growing, ResultFolder};
use crate::plot;
use crate::words::{case_title, short, unit_of};
use crate::{Error, Format, Options};
use checkpoint::Checkpoint;
use dynamics::domain::memory;
use dynamics::ledger::{Energy, Ledger};
use dynamics::medium::Medium;
use files::npz::Npz;
use models::cosserat::waves::Field;
use serde_json::json;
use setup::{Setup, Steps, cell_at, centre, media, steps};
pub(crate) use setup::{medium, unknown_name};
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write;
use std::path::Path;

/// Seconds between two checkpoints where nothing else is asked for.
pub const CHECKPOINT_EVERY: f64 = 300.0;

/// A run that ended by its own state.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{what} after {time} s; {remedy}; the state at {saved} s is saved")]
pub struct Stopped {
    /// What is wrong, and where.
    what: String,
    /// When it was found, s.
    time: String,
    /// What may help.
    remedy: &'static str,
    /// The time of the last state without fault, s.
    saved: String,
}

/// How a run is kept from being lost.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Wall time between two checkpoints, s.
    pub checkpoint_every: f64,
}

/// A line of the ledger.
#[derive(Clone, Copy)]
struct Line {
    time: f64,
    energy: Energy,
    ledger: Ledger,
}

impl Line {
    /// Energy that no term accounts for, J: rounding in a full ledger; in a light one it is what the scheme
    /// dissipates, with the sign turned.
    fn balance(&self, start: f64) -> f64 {
        self.energy.total() - start - self.ledger.change()
    }
}

/// What came out.
struct Found {
    /// By shown quantity and cell.
    values: Vec<Vec<f64>>,
    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    dissipated: Vec<f64>,
    /// Energy at the beginning, J.
    start: f64,
    last: Line,
    /// All steps of the case.
    steps: Steps,
    /// How many of them were done.
    done: usize,
    of_cell: Vec<u16>,
    stopped: Option<Stopped>,
    /// Held until all is written.
    lock: File,
}

impl Found {
    /// The time that the run came to, s.
    fn time(&self) -> f64 {
        self.steps.time(self.done)
    }
}

/// Names of what is shown of a cell, in the order in which it is: fields, then integrals in time.
fn shown(dynamics: &Dynamics, fields: &[Field]) -> Vec<String> {
    let fields = fields.iter().map(|field| Component(*field).to_string());
    let integrals = dynamics.output.integrals.iter().filter_map(|own| own.integral());
    fields.chain(integrals).collect()
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, memory is short, results cannot be written, or the run ended by its own state.
pub fn run(options: &Options, control: Control, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load_in_time(&options.case, &options.sets)?;
    let dynamics = case.required_dynamics()?;
    let media = media(&case, dynamics)?;
    let plan = plan(dynamics, &media)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    folder.check_runs(options.force)?;
    if options.dry_run {
        // Everything that can be wrong with the case is found by setting it up.
        match dynamics.grid.dimensions() {
            2 => drop(Setup::<2>::new(&case, dynamics, media)?),
            _ => drop(Setup::<3>::new(&case, dynamics, media)?),
        }
        writeln!(stdout, "would compute {plan}")?;
        writeln!(stdout, "would write {}", folder.path().join("run.png").display())?;
        return Ok(());
    }
    // Nothing is left to be said if standard error is closed.
    let _ = writeln!(std::io::stderr(), "{plan}");
    warn(dynamics, steps(dynamics, &media)?.step);
    let job = Job { case: &case, dynamics, folder: &folder, control, threads: options.threads };
    job.carry_out(media, None, options.format, stdout)
}

/// Goes on with a run that was interrupted or killed.
///
/// # Errors
/// The folder holds no run, a finished one, or a damaged checkpoint; then as [`run`].
pub fn resume(
    path: &Path,
    threads: Option<usize>,
    control: Control,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let (folder, case) = ResultFolder::of_run(path)?;
    let dynamics = case.required_dynamics()?;
    let media = media(&case, dynamics)?;
    let plan = plan(dynamics, &media)?;
    let found = Checkpoint::read(&folder)?;
    let start = found.as_ref().map_or(0.0, |found| found.steps as f64);
    let Steps { count, .. } = steps(dynamics, &media)?;
    let _ = writeln!(std::io::stderr(), "{plan}\nfrom {:.1} %", 100.0 * start / count as f64);
    let job = Job { case: &case, dynamics, folder: &folder, control, threads };
    job.carry_out(media, found, format, stdout)
}

/// What is likely not meant.
fn warn(dynamics: &Dynamics, step: f64) {
    const FEW: f64 = 4.0;
    let loads = dynamics.loads.iter().map(|load| ("load", &load.time)).enumerate();
    let sources = dynamics.sources.iter().map(|source| ("source", &source.time)).enumerate();
    for (index, (name, time)) in loads.chain(sources) {
        if let Some(shortest) = time.shortest().filter(|time| *time < FEW * step) {
            let steps = short(shortest / step);
            let text = format!("warning: {name}[{index}].time changes within {steps} steps");
            let _ = writeln!(std::io::stderr(), "{text}: smaller cells see more of it");
        }
    }
}

/// What will be computed, in words, if memory suffices.
fn plan(dynamics: &Dynamics, media: &[Medium]) -> Result<String, Error> {
    let Steps { count, step, by_rotation, .. } = steps(dynamics, media)?;
    let needed = needed(dynamics, media);
    let cells = dynamics.grid.cells.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
    let plan = format!(
        "{cells} cells of {} fields, {count} steps of {} s ({}), memory {}",
        media[0].fields.len(),
        short(step),
        if by_rotation { "for the natural rotation" } else { "for the fastest wave" },
        bytes(needed)
    );
    match available_memory().filter(|available| needed > *available) {
        Some(available) => {
            let found = format!("{plan}, of which {} are free", bytes(available));
            let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
            Err(dynamics.locate("grid.cells", found, allowed).into())
        }
        None => Ok(plan),
    }
}

/// Memory of a run, bytes: the fields, and copies of them for a checkpoint and for the results.
fn needed(dynamics: &Dynamics, media: &[Medium]) -> f64 {
    let fields = media[0].fields.len();
    let own = match dynamics.scheme.precision {
        Precision::F64 => memory::<f64>(&dynamics.grid.cells, fields),
        Precision::F32 => memory::<f32>(&dynamics.grid.cells, fields),
    };
    let copies = 2 * fields + dynamics.initial.len() + 2 * dynamics.output.integrals.len() + 1;
    own + dynamics.grid.count() as f64 * (copies * size_of::<f64>()) as f64
}

fn bytes(bytes: f64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let power = (bytes.max(1.0).log2() / 10.0).floor().clamp(1.0, 4.0);
    format!("{:.1} {}", bytes / 1024f64.powf(power), UNITS[power as usize - 1])
}

/// Memory that the system can give, bytes, where it says so.
fn available_memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok().map(|kibibytes| 1024.0 * kibibytes)
}

/// A run and where it goes.
struct Job<'a> {
    case: &'a Case,
    dynamics: &'a Dynamics,
    folder: &'a ResultFolder,
    control: Control,
    threads: Option<usize>,
}

impl Job<'_> {
    fn carry_out(
        &self,
        media: Vec<Medium>,
        from: Option<Checkpoint>,
        format: Format,
        stdout: &mut dyn Write,
    ) -> Result<(), Error> {
        let names = shown(self.dynamics, &media[0].fields);
        let found = match (self.dynamics.grid.dimensions(), self.dynamics.scheme.precision) {
            (2, Precision::F64) => self.march::<f64, 2>(media, from)?,
            (2, Precision::F32) => self.march::<f32, 2>(media, from)?,
            (_, Precision::F64) => self.march::<f64, 3>(media, from)?,
            (_, Precision::F32) => self.march::<f32, 3>(media, from)?,
        };
        let words = words(self.case, self.dynamics, &found);
        let json = format!("{:#}\n", self.report(&names, &found));
        self.folder.write("fields.npz", &fields(self.dynamics, &names, &found)?)?;
        self.folder.write("run.txt", words.as_bytes())?;
        if !self.dynamics.receivers.is_empty() {
            self.folder.write("receivers.npz", &receivers(self.folder)?)?;
        }
        plot::draw(self.case, self.dynamics, self.folder)?;
        // The last of all: the run is finished where it stands.
        self.folder.write("run.json", json.as_bytes())?;
        self.folder.remove(Growing::Checkpoint)?;
        self.folder.remove(Growing::Lock)?;
        drop(found.lock);
        match format {
            Format::Json => stdout.write_all(json.as_bytes())?,
            Format::Text => {
                stdout.write_all(words.as_bytes())?;
                writeln!(stdout, "picture: {}", self.folder.path().join("run.png").display())?;
            }
        }
        found.stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
    }

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
            ledger["numerical"] = json!(last.ledger.numerical());
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
            })).collect::<Vec<_>>(),
            "stopped": found.stopped.as_ref().map(ToString::to_string),
        })
    }
}

/// What the receivers saw, as arrays of the names of the table's columns.
fn receivers(folder: &ResultFolder) -> Result<Vec<u8>, Error> {
    let mut archive = Npz::new();
    let columns = plot::table(folder, Growing::Receivers)?;
    let names: Vec<&str> = columns.iter().map(|column| column.0.as_str()).collect();
    let of = |name: &&str| name.rsplit_once('.').map_or("s", |(_, name)| unit_of(name));
    let units: Vec<&str> = names.iter().map(of).collect();
    archive.add_text("names", &[names.len()], &names)?;
    archive.add_text("units", &[units.len()], &units)?;
    for (name, values) in &columns {
        archive.add_f64(name, &[values.len()], values)?;
    }
    Ok(archive.finish()?)
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
            line("dissipation of the scheme", last.ledger.numerical());
            line("left over (rounding)", last.balance(found.start));
        }
        LedgerKind::Light => line("balance (the scheme's, not counted)", last.balance(found.start)),
    }
    text
}
