//! What verbs are asked for.

use super::Error;
use std::path::PathBuf;

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

/// So many threads, or one per core.
pub(super) fn pool(threads: Option<usize>) -> Result<rayon::ThreadPool, Error> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| Error::Threads(error.to_string()))
}
