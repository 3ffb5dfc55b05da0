//! Well-posedness of continuum models of granular media: from a case file to a verdict.
//!
//! A case file describes a medium and a state. `wellposed` linearises the equations there and says whether they are
//! well-posed, and if not how fast short waves grow and in which direction; solves the equations in time; and holds
//! both against each other. The program `wellposed` does this on the command line; this library answers the same
//! questions by values, without files.
//!
//! # Questions
//!
//! | question | answer |
//! |---|---|
//! | [`load`] | a [`Case`], read from a file and checked |
//! | [`point()`] | [`PointResult`](study::PointResult): all about one state: background, characteristics, roots, growth, verdict with evidence |
//! | [`map()`] | [`MapResult`](study::MapResult): the verdict over two numbers of the case |
//! | [`dispersion()`] | [`Dispersion`](study::Dispersion): frequencies and speeds of the waves of a solid against the wave number |
//! | [`speeds()`] | [`Speeds`](study::Speeds): characteristic speeds of a solid against the direction, elastic and yielding |
//! | [`simulate()`] | [`RunResult`](study::RunResult): fields, records of receivers and the energy ledger of a solid or a flow in time |
//! | [`check()`] | [`CheckResult`](study::CheckResult): frequencies and growth of waves as the analysis predicts them and as a solver has them |
//!
//! Harris–Grekova (2005) at constant volume is well-posed while stress and deformation rate are less than 45° apart:
//!
//! ```
//! let path = "cases/granular-flow/noncoaxiality-bound.toml";
//! let inside = wellposed::point(&wellposed::load(path, &["background.noncoaxiality_deg=40"])?)?;
//! let outside = wellposed::point(&wellposed::load(path, &["background.noncoaxiality_deg=50"])?)?;
//! assert_eq!(inside.verdict().map(|verdict| verdict.name()), Some("well-posed"));
//! assert_eq!(outside.verdict().map(|verdict| verdict.name()), Some("ill-posed"));
//!
//! // The report that `wellposed point --format json` prints.
//! println!("{:#}", wellposed::report::json(&outside)?);
//! # Ok::<(), wellposed::Error>(())
//! ```
//!
//! # Layout
//!
//! An arrow points from a part to one that it uses, and to all that this one uses; no arrow points up.
//!
#![doc = include_str!("../docs/crates.svg")]
//!
//! In this package are [`study`], which answers each question by a value; [`setup`], which makes problems of the
//! crates below from a case; [`report`], which makes text, JSON, tables and pictures from a value; and [`cli`], the
//! verbs of the command line. No physics and no numerics stand here. [`mod@case`] is the crate that reads case files
//! and writes them.
//!
//! | crate | holds |
//! |---|---|
//! | [`models`] | physics without discretisation, files or threads: flows, solids, yield sets, and the registry that lists them |
//! | [`analysis`] | from linearised equations to the dispersion polynomial, roots, growth of short waves, and a verdict |
//! | [`dynamics`] | solvers in time for solids and for flows, with energy ledgers |
//! | [`agreement`] | rates of waves as the analysis predicts them and as the solvers show them |
//! | [`cases`](mod@case) | case files: one schema for reader, writer, templates, reference page and JSON Schema |
//! | [`figures`] | pictures from plain structs |
//! | [`files`] | atomic writing, tables, archives, snapshots |
//!
//! `analysis` and `dynamics` never use each other, so that `agreement` compares independent statements; `figures`
//! and `files` know no physics.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod cases;
pub mod cli;
pub mod new;
pub mod output;
pub mod report;
pub mod setup;
pub mod study;

pub use ::cases as case;
pub use study::{
    check::check, dispersion::dispersion, map::map, point::point, simulate::simulate,
    speeds::speeds,
};

use case::Case;
use std::path::{Path, PathBuf};

/// Version, and commit where the program was built from a repository: `0.1.0 (abcdef123)`.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (", env!("WELLPOSED_COMMIT"), ")");

/// Reads a case file, with `key=value` settings over it, of which the last one of a key holds.
///
/// # Errors
/// The file cannot be read, or what is wrong in it or in a setting, where, and what is allowed.
///
/// # Examples
/// ```
/// let case = wellposed::load("cases/cosserat/forbidden-band.toml", &["wave.number=3"])?;
/// assert_eq!(case.numbers.wave.number, 3.0);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn load(path: impl AsRef<Path>, settings: &[&str]) -> Result<Case, Error> {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    Ok(Case::load(path.as_ref(), &settings)?)
}

/// What the verbs that run a case are asked for.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The case file.
    pub case: PathBuf,
    /// `key=value` settings over the file; the last one of a key holds.
    pub sets: Vec<String>,
    /// Form of what is printed.
    pub format: Format,
    /// Folder of results; absent: `out/<case name>`.
    pub out: Option<PathBuf>,
    /// Whether results of another case may be overwritten.
    pub force: bool,
    /// Check everything, say what would be done, write nothing.
    pub dry_run: bool,
    /// Number of threads; absent: one per core. Results do not depend on it.
    pub threads: Option<usize>,
    /// Whether a flow is run in time although its equations are ill-posed.
    pub accept_ill_posed: bool,
}

/// Form of what a verb prints.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// Words and numbers for a reader.
    #[default]
    Text,
    /// One JSON value.
    Json,
}

/// The program's exit code where it was interrupted.
const INTERRUPTED_CODE: u8 = 130;

/// So many threads, or one per core.
fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Error> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| Error::Threads(error.to_string()))
}

/// Why a request was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case is wrong.
    #[error(transparent)]
    Case(#[from] case::CaseError),
    /// A model that cannot have a yield set.
    #[error(transparent)]
    Medium(#[from] case::NoSuchMedium),
    /// Results cannot be written.
    #[error(transparent)]
    Output(#[from] output::OutputError),
    /// A run ended by its own state.
    #[error(transparent)]
    Stopped(#[from] study::simulate::Stopped),
    /// A flow that is not to be run in time unasked.
    #[error("{0}; --accept-ill-posed runs it all the same")]
    IllPosed(study::simulate::IllPosed),
    /// What was measured is not what was predicted.
    #[error(transparent)]
    Disagrees(#[from] cli::Disagreement),
    /// Somebody ended a run, which may go on.
    #[error("interrupted at {time} s; wellposed resume {folder} goes on")]
    Interrupted {
        /// The time that it had come to, s.
        time: String,
        /// The folder of its results.
        folder: String,
    },
    /// A snapshot could not be made.
    #[error(transparent)]
    Snapshot(#[from] files::vti::VtiError),
    /// No memory for the map.
    #[error("no memory for a map of {points} points: ask for fewer")]
    Memory {
        /// Number of points.
        points: usize,
    },
    /// A study was cancelled by whoever watched its progress.
    #[error("cancelled")]
    Cancelled,
    /// A result cannot be serialised.
    #[error("a result that cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
    /// A picture could not be drawn.
    #[error(transparent)]
    Figure(#[from] figures::FigureError),
    /// A table could not be made.
    #[error(transparent)]
    Table(#[from] files::csv::RowLength),
    /// An archive of arrays could not be made.
    #[error(transparent)]
    Archive(#[from] files::npz::NpzError),
    /// Standard output does not take what is printed.
    #[error("standard output: {0}")]
    Stdout(#[from] std::io::Error),
}

impl Error {
    /// The program's exit code: 2, but 0 where the reader of a pipe had enough, 1 where a check disagreed, 3 where a run was stopped
    /// by its own state, 130 where it was interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stdout(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Disagrees(_) => 1,
            Self::Stopped(_) => 3,
            Self::Interrupted { .. } => INTERRUPTED_CODE,
            _ => 2,
        }
    }
}
