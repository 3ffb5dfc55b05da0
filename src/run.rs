//! `wellposed run` and `wellposed resume`: a solid or a flow in time.
//!
//! The loop in time is that of [`dynamics::simulation`]. Here a case becomes a simulation (`setup`, `solid`, `flow`),
//! `recorder` writes what the loop delivers, and the rest is written at the end. Tables are appended to line by line,
//! snapshots come one after the other. A checkpoint holds the state and what the tables held: what resumes from
//! it writes the same bits as a run that was never interrupted.

mod checkpoint;
mod control;
mod files;
mod flow;
mod recorder;
mod setup;
mod solid;

use crate::case::{Case, CaseError, InTime};
use crate::output::{AppendedFile, ResultFolder};
use crate::plot;
use crate::report::format::{short, superscript, unit_of};
use crate::{Error, Format, Options};
use ::files::npz::Npz;
use analysis::growth::Growth;
use checkpoint::Checkpoint;
pub(crate) use flow::{flow_problem, perturbation};
use models::elementary::Elementary;
pub(crate) use setup::medium;
use std::fmt;
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

/// Short waves of a flow grow without bound: what is solved in time depends on the grid.
#[derive(Clone, Debug, PartialEq)]
pub struct IllPosed {
    /// Growth rate as k → ∞, and where; `None` where it is unbounded at finite k.
    growth: Option<Growth>,
    /// The worst direction of the wave vector, degrees.
    direction_deg: f64,
    /// The greatest wave number of the grid, 1/m.
    number: f64,
}

impl fmt::Display for IllPosed {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let direction = short(self.direction_deg);
        formatter.write_str("ill-posed: ")?;
        let Some(Growth { order, coefficient }) = self.growth else {
            return write!(formatter, "waves at {direction}° grow at unbounded rates");
        };
        let order = order.value();
        let tenfold = 10f64.cr_ln() / (coefficient * self.number.cr_powf(order));
        write!(
            formatter,
            "short waves grow at the rate {} k{} 1/s, fastest at {direction}°; those of the grid, \
             k = {} 1/m, tenfold in {} s, and finer grids faster",
            short(coefficient),
            superscript(order),
            short(self.number),
            short(tenfold)
        )
    }
}

/// How a run is kept from being lost.
#[derive(Clone, Copy, Debug)]
pub struct Control {
    /// Wall time between two checkpoints, s.
    pub checkpoint_every: f64,
}

/// A case that is run in time: a solid or a flow.
trait Job {
    /// What will be computed, in words, if memory suffices.
    fn plan(&self) -> Result<String, Error>;

    /// Finds everything that can be wrong with the case.
    fn check(&self) -> Result<(), Error>;

    /// What is likely not meant.
    fn warnings(&self) -> Result<Vec<String>, Error>;

    /// What the analysis says of its equations, where that is against running them.
    fn ill_posed(&self) -> Result<Option<IllPosed>, Error>;

    /// Computes it, from its beginning or from a checkpoint, and writes the files that are appended to.
    fn compute(&self, run: &Run, from: Option<Checkpoint>) -> Result<Outcome, Error>;
}

/// Where a run goes, and how.
struct Run<'a> {
    folder: &'a ResultFolder,
    control: Control,
    threads: Option<usize>,
}

/// What came out.
struct Outcome {
    words: String,
    report: serde_json::Value,
    /// The archive of the fields at the end.
    fields: Vec<u8>,
    has_receivers: bool,
    stopped: Option<Stopped>,
    /// Held until all is written.
    lock: File,
}

fn job(case: &Case) -> Result<Box<dyn Job + '_>, Error> {
    Ok(match case.in_time()? {
        InTime::Solid(dynamics) => Box::new(solid::SolidJob::new(case, dynamics)?),
        InTime::Flow(flow) => Box::new(flow::FlowJob::new(case, flow)?),
    })
}

/// Runs the verb.
///
/// # Errors
/// The case is wrong, memory is short, results cannot be written, or the run ended by its own state.
pub fn run(options: &Options, control: Control, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load_in_time(&options.case, &options.sets)?;
    let job = job(&case)?;
    let plan = job.plan()?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    folder.check_runs(options.force)?;
    if options.dry_run {
        job.check()?;
        writeln!(stdout, "would compute {plan}")?;
        writeln!(stdout, "would write {}", folder.path().join("run.png").display())?;
        return Ok(());
    }
    // Nothing is left to be said if standard error is closed.
    let _ = writeln!(std::io::stderr(), "{plan}");
    for warning in job.warnings()? {
        let _ = writeln!(std::io::stderr(), "warning: {warning}");
    }
    match job.ill_posed()? {
        Some(found) if !options.accept_ill_posed => return Err(Error::IllPosed(found)),
        Some(found) => drop(writeln!(std::io::stderr(), "warning: {found}")),
        None => {}
    }
    let run = Run { folder: &folder, control, threads: options.threads };
    carry_out(&case, &*job, &run, None, options.format, stdout)
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
    let job = job(&case)?;
    let plan = job.plan()?;
    let found = Checkpoint::read(&folder)?;
    let duration = match case.in_time()? {
        InTime::Solid(dynamics) => dynamics.time.duration,
        InTime::Flow(flow) => flow.time.duration,
    };
    let start = found.as_ref().map_or(0.0, |found| found.state.time);
    let _ = writeln!(std::io::stderr(), "{plan}\nfrom {:.1} %", 100.0 * start / duration);
    let run = Run { folder: &folder, control, threads };
    carry_out(&case, &*job, &run, found, format, stdout)
}

fn carry_out(
    case: &Case,
    job: &dyn Job,
    run: &Run,
    from: Option<Checkpoint>,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let Outcome { words, report, fields, has_receivers, stopped, lock } = job.compute(run, from)?;
    let folder = run.folder;
    let json = format!("{report:#}\n");
    folder.write("fields.npz", &fields)?;
    folder.write("run.txt", words.as_bytes())?;
    if has_receivers {
        folder.write("receivers.npz", &receivers(folder)?)?;
    }
    plot::draw(case, folder)?;
    // The last of all: the run is finished where it stands.
    folder.write("run.json", json.as_bytes())?;
    folder.remove(AppendedFile::Checkpoint)?;
    folder.remove(AppendedFile::Lock)?;
    drop(lock);
    match format {
        Format::Json => stdout.write_all(json.as_bytes())?,
        Format::Text => {
            stdout.write_all(words.as_bytes())?;
            writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
        }
    }
    stopped.map_or(Ok(()), |stopped| Err(stopped.into()))
}

/// That so many bytes are free; hands back what will be computed, with them.
///
/// # Errors
/// They are not: what `refused` makes of the words.
fn if_memory_suffices(
    plan: &str,
    needed: f64,
    refused: impl FnOnce(String) -> CaseError,
) -> Result<String, Error> {
    let plan = format!("{plan}, memory {}", bytes(needed));
    match available_memory().filter(|available| needed > *available) {
        Some(available) => {
            Err(refused(format!("{plan}, of which {} are free", bytes(available))).into())
        }
        None => Ok(plan),
    }
}

fn bytes(bytes: f64) -> String {
    const UNITS: [&str; 4] = ["KiB", "MiB", "GiB", "TiB"];
    let power = (bytes.max(1.0).cr_log2() / 10.0).floor().clamp(1.0, 4.0);
    format!("{:.1} {}", bytes / 1024f64.cr_powf(power), UNITS[power as usize - 1])
}

/// Memory that the system can give, bytes, where it says so.
fn available_memory() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok().map(|kibibytes| 1024.0 * kibibytes)
}

/// What the receivers saw, as arrays of the names of the table's columns.
fn receivers(folder: &ResultFolder) -> Result<Vec<u8>, Error> {
    let mut archive = Npz::new();
    let columns = plot::table(folder, AppendedFile::Receivers)?;
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
