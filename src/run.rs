//! `wellposed run`: a solid in time.

mod setup;

use crate::case::Case;
use crate::case::dynamics::{Component, Dynamics, Ledger as LedgerKind, Picture, Precision};
use crate::output::{self, ResultFolder};
use crate::progress::Progress;
use crate::words::{case_title, short};
use crate::{Error, Format, Options};
use dynamics::domain::memory;
use dynamics::ledger::{Energy, Ledger};
use dynamics::line::GHOSTS;
use dynamics::medium::Medium;
use dynamics::real::Real;
use dynamics::split::Split;
use figures::{FieldAxis, FieldFigure, FieldMark, FieldMarkKind};
use files::npz::Npz;
use models::cosserat::waves::Field;
use serde_json::json;
use setup::{Setup, Steps, cell_at, centre, media, steps};
use std::fmt::Write as _;
use std::io::Write;

/// Lines of the ledger where the case does not say how many.
const LINES: usize = 1000;
/// Steps between two looks whether all values are finite, at most.
const LOOK: usize = 64;

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
    fields: Vec<Field>,
    /// By field and cell.
    values: Vec<Vec<f64>>,
    /// By step, receiver and field; the state at the beginning first.
    records: Vec<f64>,
    lines: Vec<Line>,
    /// Time step, s.
    step: f64,
    steps: usize,
    /// Region of each cell.
    of_cell: Vec<u16>,
    stopped: Option<Stopped>,
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, memory is short, results cannot be written, or the run ended by its own state.
pub fn run(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let dynamics = case.required_dynamics()?;
    let media = media(&case, dynamics)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let Steps { count, step, by_rotation } = steps(dynamics, &media)?;
    let needed = needed(dynamics, &media, count);
    let cells = dynamics.grid.cells.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
    let plan = format!(
        "{cells} cells of {} fields, {count} steps of {} s ({}), memory {}",
        media[0].fields.len(),
        short(step),
        if by_rotation { "for the natural rotation" } else { "for the fastest wave" },
        bytes(needed)
    );
    if let Some(available) = available_memory().filter(|available| needed > *available) {
        let (needed, available) = (bytes(needed), bytes(available));
        let found = format!("{plan}, of which {available} are free");
        let allowed = "ask for fewer cells, or for scheme.precision = \"f32\"";
        return Err(dynamics
            .locate("grid.cells", found, format!("{allowed} ({needed} needed)"))
            .into());
    }
    let files = || {
        let has_receivers = !dynamics.receivers.is_empty();
        output::RUN.iter().filter(move |name| has_receivers || **name != "receivers.csv")
    };
    if options.dry_run {
        // Everything that can be wrong with the case is found by setting it up.
        match dynamics.grid.dimensions() {
            2 => drop(Setup::<2>::new(&case, dynamics, media)?),
            _ => drop(Setup::<3>::new(&case, dynamics, media)?),
        }
        writeln!(stdout, "would compute {plan}")?;
        for name in files() {
            writeln!(stdout, "would write {}", folder.path().join(name).display())?;
        }
        return Ok(());
    }
    // Nothing is left to be said if standard error is closed.
    let _ = writeln!(std::io::stderr(), "{plan}");
    let threads = options
        .threads
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, std::num::NonZero::get));
    let found = match (dynamics.grid.dimensions(), dynamics.scheme.precision) {
        (2, Precision::F64) => solve::<f64, 2>(&case, dynamics, media, threads)?,
        (2, Precision::F32) => solve::<f32, 2>(&case, dynamics, media, threads)?,
        (_, Precision::F64) => solve::<f64, 3>(&case, dynamics, media, threads)?,
        (_, Precision::F32) => solve::<f32, 3>(&case, dynamics, media, threads)?,
    };

    let words = words(&case, dynamics, &found);
    let json = format!("{:#}\n", report(&case, dynamics, &found));
    let figure = figure(&case, dynamics, &found);
    folder.open()?;
    folder.write("run.png", &figure.draw(figures::Format::Png)?)?;
    folder.write("run.svg", &figure.draw(figures::Format::Svg)?)?;
    if !dynamics.receivers.is_empty() {
        folder.write("receivers.csv", &receivers(dynamics, &found)?)?;
    }
    folder.write("ledger.csv", &ledger(dynamics, &found)?)?;
    folder.write("fields.npz", &fields(dynamics, &found)?)?;
    folder.write("run.json", json.as_bytes())?;
    folder.write("run.txt", words.as_bytes())?;
    match options.format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
        }
    }
    found.stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
}

/// Memory of a run, bytes: the fields, a copy of them for the results, and what is recorded.
fn needed(dynamics: &Dynamics, media: &[Medium], steps: usize) -> f64 {
    let fields = media[0].fields.len();
    let own = match dynamics.scheme.precision {
        Precision::F64 => memory::<f64>(&dynamics.grid.cells, fields),
        Precision::F32 => memory::<f32>(&dynamics.grid.cells, fields),
    };
    let copies = 2 * dynamics.grid.count() * (fields + dynamics.initial.len());
    let records = (steps + 1) * fields * dynamics.receivers.len();
    own + ((copies + records) * size_of::<f64>()) as f64
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

fn solve<T: Real, const D: usize>(
    case: &Case,
    dynamics: &Dynamics,
    media: Vec<Medium>,
    threads: usize,
) -> Result<Found, Error> {
    let Setup { problem, steps, initial } = Setup::<D>::new(case, dynamics, media)?;
    let most = problem.grid.cells[D - 1] / GHOSTS;
    let start = || -> Result<Split<T, D>, Error> {
        let mut split = Split::new(&problem, threads.clamp(1, most.max(1)))
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
    split.record();
    let line = |split: &Split<T, D>| Line {
        time: split.time(),
        energy: split.energy(),
        ledger: split.ledger(),
    };
    let interval = match dynamics.output.ledger_interval {
        0.0 => steps.div_ceil(LINES),
        interval => ((interval / problem.step).round() as usize).max(1),
    };
    let progress = Progress::new("run", steps as u64);
    let (mut records, mut lines) = (split.records(), vec![line(&split)]);
    let (mut done, mut stopped) = (0, None);
    let mut end = steps;
    if !lines[0].energy.total().is_finite() {
        end = 0;
        stopped = Some(broken(dynamics, &split, 0.0));
    }
    while done < end {
        let next = (interval - done % interval).min(end - done).min(LOOK);
        split.advance(next);
        let now = line(&split);
        if !now.energy.total().is_finite() || !now.ledger.change().is_finite() {
            stopped = Some(broken(dynamics, &split, done as f64 * problem.step));
            // The same bits again, as far as they were sound.
            split = start()?;
            split.advance(done);
            break;
        }
        records.extend(split.records());
        done += next;
        if done % interval == 0 || done == end {
            lines.push(now);
        }
        progress.tick(next as u64);
    }
    Ok(Found {
        fields: split.fields().to_vec(),
        values: split.shown(),
        records,
        lines,
        step: problem.step,
        steps: done,
        of_cell: problem.of_cell,
        stopped,
    })
}

fn broken<T: Real, const D: usize>(
    dynamics: &Dynamics,
    split: &Split<T, D>,
    saved: f64,
) -> Stopped {
    let what = match split.first_non_finite() {
        Some((field, cell)) => {
            format!(
                "{} is not finite in the cell at {:?} m",
                Component(field),
                centre(dynamics, cell)
            )
        }
        None => "the energy is not finite".to_owned(),
    };
    let remedy = "loads or initial values may be too large for the numbers";
    Stopped { what, time: short(split.time()), remedy, saved: short(saved) }
}

/// A component with its symbol and unit.
fn label(field: Field) -> String {
    let (symbol, unit) = match field {
        Field::Velocity(i) => (format!("velocity v{}", i + 1), "m/s"),
        Field::Spin(k) => (format!("spin ω{}", k + 1), "rad/s"),
        Field::Stress(i, j) => (format!("stress σ{}{}", i + 1, j + 1), "Pa"),
        Field::Couple(k, j) => (format!("couple stress m{}{}", k + 1, j + 1), "N/m"),
    };
    let subscripts = |c: char| match c {
        '1'..='3' => char::from_u32('₀' as u32 + (c as u32 - '0' as u32)).unwrap_or(c),
        c => c,
    };
    format!("{}, {unit}", symbol.chars().map(subscripts).collect::<String>())
}

fn receivers(dynamics: &Dynamics, found: &Found) -> Result<Vec<u8>, Error> {
    let width = found.fields.len();
    let place = |component: &Component| found.fields.iter().position(|own| *own == component.0);
    let columns: Vec<(usize, String)> = dynamics
        .receivers
        .iter()
        .enumerate()
        .flat_map(|(index, receiver)| {
            let column = move |component: &Component| {
                let name = format!("{}.{component}", receiver.name);
                Some((index * width + place(component)?, name))
            };
            receiver.fields.iter().filter_map(column)
        })
        .collect();
    let header: Vec<&str> =
        ["time"].into_iter().chain(columns.iter().map(|column| column.1.as_str())).collect();
    let all = dynamics.receivers.len() * width;
    let rows = found.records.chunks_exact(all).enumerate().map(|(step, state)| {
        let time = step as f64 * found.step;
        let values = columns.iter().map(|(place, _)| state[*place]);
        [time].into_iter().chain(values).map(Into::into).collect()
    });
    Ok(files::csv::table(&header, rows)?)
}

fn ledger(dynamics: &Dynamics, found: &Found) -> Result<Vec<u8>, Error> {
    let is_full = dynamics.scheme.ledger == LedgerKind::Full;
    let mut header =
        vec!["time", "kinetic", "stored", "sides", "sources", "initial_stress", "plastic"];
    header.extend(match is_full {
        true => ["numerical", "residual"].as_slice(),
        false => &["balance"],
    });
    let start = found.lines[0].energy.total();
    let rows = found.lines.iter().map(|line| {
        let Ledger { inflow, sources, released, plastic, .. } = line.ledger;
        let Energy { kinetic, stored } = line.energy;
        let mut row = vec![line.time, kinetic, stored, inflow, sources, released, plastic];
        if is_full {
            row.push(line.ledger.numerical());
        }
        row.push(line.balance(start));
        row.into_iter().map(Into::into).collect()
    });
    Ok(files::csv::table(&header, rows)?)
}

fn fields(dynamics: &Dynamics, found: &Found) -> Result<Vec<u8>, Error> {
    let mut archive = Npz::new();
    let grid = &dynamics.grid;
    for axis in 0..grid.dimensions() {
        let middles: Vec<f64> = (0..grid.cells[axis]).map(|i| grid.centre(axis, i)).collect();
        archive.add_f64(&format!("x{}", axis + 1), &[middles.len()], &middles)?;
    }
    archive.add_f64("time", &[], &[found.steps as f64 * found.step])?;
    // The first axis runs fastest.
    let shape: Vec<usize> = grid.cells.iter().rev().copied().collect();
    for (field, values) in found.fields.iter().zip(&found.values) {
        archive.add_f64(&Component(*field).to_string(), &shape, values)?;
    }
    if !dynamics.regions.is_empty() {
        let regions: Vec<i32> = found.of_cell.iter().map(|&region| i32::from(region)).collect();
        archive.add_i32("region", &shape, &regions)?;
    }
    Ok(archive.finish()?)
}

/// The final state: of a space a section across x₂ through its first source, or its middle.
fn figure(case: &Case, dynamics: &Dynamics, found: &Found) -> FieldFigure {
    let grid = &dynamics.grid;
    let [across, up] = if grid.dimensions() == 2 { [0, 1] } else { [0, 2] };
    let section = (grid.dimensions() == 3).then(|| {
        let [first, last] = grid.extent(1);
        let at = dynamics.sources.first().map_or(0.5 * (first + last), |source| source.at[1]);
        let index = ((at - grid.origin[1]) / grid.spacing[1]).floor().max(0.0) as usize;
        index.min(grid.cells[1] - 1)
    });
    let (columns, rows) = (grid.cells[across], grid.cells[up]);
    let cell = |i: usize, j: usize| match section {
        None => j * columns + i,
        Some(index) => (j * grid.cells[1] + index) * columns + i,
    };
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| cell(i, j));
    let place = |field: Field| found.fields.iter().position(|own| *own == field);
    let (values, label, is_signed): (Vec<f64>, String, bool) = match dynamics.output.picture {
        Picture::Component(Component(field)) => {
            let all = place(field).map(|place| &found.values[place]);
            let at = |cell: usize| all.map_or(0.0, |values| values[cell]);
            (cells.clone().map(at).collect(), label(field), true)
        }
        Picture::Speed => {
            let axes = (0..grid.dimensions()).filter_map(|i| place(Field::Velocity(i)));
            let axes: Vec<&Vec<f64>> = axes.map(|place| &found.values[place]).collect();
            let speed = |cell: usize| axes.iter().fold(0.0, |sum, v| f64::hypot(sum, v[cell]));
            (cells.clone().map(speed).collect(), "speed |v|, m/s".to_owned(), false)
        }
    };
    let mut subtitle = format!("t = {} s", short(found.steps as f64 * found.step));
    if let Some(index) = section {
        let _ = write!(subtitle, ", section x₂ = {} m", short(grid.centre(1, index)));
    }
    let axis = |axis: usize, name: &str| {
        let [from, to] = grid.extent(axis);
        FieldAxis { label: format!("{name}, m"), from, to }
    };
    let mark = |at: &[f64], name: &str, kind: FieldMarkKind| {
        let is_near = section
            .is_none_or(|index| (at[1] - grid.centre(1, index)).abs() <= 0.5 * grid.spacing[1]);
        is_near.then(|| FieldMark { at: [at[across], at[up]], name: name.to_owned(), kind })
    };
    let receivers = dynamics.receivers.iter();
    let sources = dynamics.sources.iter();
    FieldFigure {
        title: case_title(case),
        subtitle,
        x: axis(across, "x₁"),
        y: axis(up, if up == 1 { "x₂" } else { "x₃" }),
        columns,
        rows,
        values,
        label,
        is_signed,
        limit: None,
        scale: None,
        curves: None,
        outlines: match dynamics.regions.len() {
            0 | 1 => Vec::new(),
            _ => cells.map(|cell| found.of_cell[cell]).collect(),
        },
        plastic: Vec::new(),
        marks: receivers
            .filter_map(|receiver| mark(&receiver.at, &receiver.name, FieldMarkKind::Receiver))
            .chain(
                sources.filter_map(|source| {
                    mark(&source.at, source.action.name(), FieldMarkKind::Source)
                }),
            )
            .collect(),
    }
}

fn report(case: &Case, dynamics: &Dynamics, found: &Found) -> serde_json::Value {
    let (start, last) = (found.lines[0].energy.total(), found.lines[found.lines.len() - 1]);
    let is_full = dynamics.scheme.ledger == LedgerKind::Full;
    let mut ledger = json!({
        "unit": if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" },
        "kinetic": last.energy.kinetic,
        "stored": last.energy.stored,
        "at_start": start,
        "sides": last.ledger.inflow,
        "sources": last.ledger.sources,
        "initial_stress": last.ledger.released,
        "plastic": last.ledger.plastic,
    });
    if is_full {
        ledger["numerical"] = json!(last.ledger.numerical());
    }
    ledger[if is_full { "residual" } else { "balance" }] = json!(last.balance(start));
    json!({
        "title": case.title,
        "cells": dynamics.grid.cells,
        "steps": found.steps,
        "step": found.step,
        "time": found.steps as f64 * found.step,
        "precision": dynamics.scheme.precision.name(),
        "order": dynamics.scheme.order.name(),
        "fields": found.fields.iter().map(|f| Component(*f).to_string()).collect::<Vec<_>>(),
        "ledger": ledger,
        "receivers": dynamics.receivers.iter().map(|receiver| json!({
            "name": receiver.name,
            "at": receiver.at,
            "cell": centre(dynamics, cell_at(dynamics, &receiver.at)),
        })).collect::<Vec<_>>(),
        "stopped": found.stopped.as_ref().map(ToString::to_string),
    })
}

fn words(case: &Case, dynamics: &Dynamics, found: &Found) -> String {
    let mut text = String::new();
    let (start, last) = (found.lines[0].energy.total(), found.lines[found.lines.len() - 1]);
    let unit = if dynamics.grid.dimensions() == 2 { "J/m" } else { "J" };
    let _ = writeln!(text, "{}", case_title(case));
    let _ = writeln!(
        text,
        "{} steps of {} s: t = {} s",
        found.steps,
        short(found.step),
        short(found.steps as f64 * found.step)
    );
    let mut line = |name: &str, value: f64| {
        let _ = writeln!(text, "  {name:<34} {:>11} {unit}", short(value));
    };
    line("energy at the start", start);
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
            line("left over (rounding)", last.balance(start));
        }
        LedgerKind::Light => line("balance (the scheme's, not counted)", last.balance(start)),
    }
    text
}
