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

/// That so many threads can be started beside those of the pool, as the steps of a solid do again and again.
pub(super) fn check_threads(count: usize) -> Result<(), Error> {
    let (wait, end) = std::sync::mpsc::channel::<()>();
    let end = std::sync::Mutex::new(end);
    std::thread::scope(|scope| {
        let result = (0..count).try_for_each(|_| {
            // All of them at once: none ends before the last one has been started.
            let until_all = || drop(end.lock().map(|end| end.recv()));
            std::thread::Builder::new().spawn_scoped(scope, until_all).map(drop)
        });
        drop(wait);
        result.map_err(|error| Error::Threads(error.to_string()))
    })
}
