//! Well-posedness of continuum models of granular media.
//!
//! Describe a medium and a state in a case file; `wellposed` says whether its equations are
//! well-posed. [`load`] reads a case; each question about it is answered by a value: [`point()`], [`map()`],
//! [`dispersion()`], [`speeds()`], [`simulate()`], [`check()`] ([`study`]). Their reports are in [`report`], the verbs of the
//! command line in [`cli`], [`cases`] and [`new`];
//! [`mod@case`] reads case files; [`setup`] makes of them what the crates below take; [`output`] keeps folders of
//! results. No physics and no numerics here.
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
/// assert_eq!(case.get("wave.number"), Some(3.0));
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
