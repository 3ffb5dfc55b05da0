//! Command line options of the verbs.

use super::CommandError;
use crate::report::PictureOptions;
use std::path::PathBuf;

/// Command line options of the verbs that run a case.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Path of the case file; for `check` also of a folder of case files.
    pub case_path: PathBuf,
    /// `key=value` settings that override the file; the last setting of a key takes precedence.
    pub settings: Vec<String>,
    /// Format in which the verb prints its report.
    pub format: OutputFormat,
    /// Results folder; default `out/<case name>`.
    pub output_folder: Option<PathBuf>,
    /// Whether `--force` is given: results of another case may be overwritten, a finished or interrupted run restarted,
    /// and the cost limits of a run exceeded.
    pub force: bool,
    /// Whether `--dry-run` is given: the case is validated and the work described, but nothing is written.
    pub is_dry_run: bool,
    /// Number of threads; default one per core. Results do not depend on it.
    pub thread_count: Option<usize>,
    /// Whether a flow is simulated although its equations are ill-posed.
    pub accept_ill_posed: bool,
    /// Whether `check` prints only what disagrees.
    pub only_disagreeing: bool,
    /// Which pictures are drawn, and how.
    pub pictures: PictureOptions,
}

/// Format in which a verb prints its report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OutputFormat {
    /// Report as text.
    #[default]
    Text,
    /// Report as one JSON value.
    Json,
}

/// Creates a pool of `threads` threads; `None` stands for one per core.
pub(super) fn create_thread_pool(
    threads: Option<usize>,
) -> Result<rayon::ThreadPool, CommandError> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0));
    builder.build().map_err(|error| CommandError::ThreadStart(error.to_string()))
}

/// Checks that `count` threads can be started besides those of the pool: each time step of a solid may start that many.
pub(super) fn check_thread_start(count: usize) -> Result<(), CommandError> {
    let (wait, end) = std::sync::mpsc::channel::<()>();
    let end = std::sync::Mutex::new(end);
    std::thread::scope(|scope| {
        let result = (0..count).try_for_each(|_| {
            // Each thread waits until all have started, so that all exist at the same time.
            let until_all = || drop(end.lock().map(|end| end.recv()));
            std::thread::Builder::new().spawn_scoped(scope, until_all).map(drop)
        });
        drop(wait);
        result.map_err(|error| CommandError::ThreadStart(error.to_string()))
    })
}
