//! Studies in a thread of their own, while the calling thread handles signals, progress and snapshots.

use crate::error::to_exception;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, SyncSender, sync_channel};
use std::time::Duration;
use wellposed::Error;
use wellposed::study::ProgressCallback;
use wellposed::study::simulate::OutputFields;

/// Longest time after which signals are handled and progress is reported.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Python callables of a study, and the number of its threads; `None` stands for one thread per core.
#[derive(Clone, Copy)]
pub struct Supervision<'a, 'py> {
    /// Called with the numbers of finished and of all steps.
    pub progress: Option<&'a Bound<'py, PyAny>>,
    /// Number of threads.
    pub threads: Option<usize>,
    /// Whether errors of the case state lines.
    pub has_lines: bool,
}

/// Sender of snapshots to the calling thread.
pub type SnapshotSender = SyncSender<OutputFields>;

impl Supervision<'_, '_> {
    /// Runs a study without the lock of the interpreter. A signal such as Ctrl-C, and an exception of a callable, cancel the
    /// study and are raised when it has ended.
    ///
    /// # Errors
    /// The exception of a signal or of a callable, or the error of the study as exception.
    pub fn run<T: Send>(
        self,
        py: Python<'_>,
        study: impl FnOnce(ProgressCallback) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        self.run_with_snapshots(py, &|_, _| Ok(()), |progress, _| study(progress))
    }

    /// Runs a study like [`run`](Self::run), and passes the snapshots that it sends to `on_snapshot`; the study waits while
    /// a snapshot is handled.
    ///
    /// # Errors
    /// As [`run`](Self::run).
    pub fn run_with_snapshots<T: Send>(
        self,
        py: Python<'_>,
        on_snapshot: &(dyn Fn(Python<'_>, OutputFields) -> PyResult<()> + Sync),
        study: impl FnOnce(ProgressCallback, SnapshotSender) -> Result<T, Error> + Send,
    ) -> PyResult<T> {
        let threads = self.threads.unwrap_or(0);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| {
            pyo3::exceptions::PyRuntimeError::new_err(format!("threads cannot be started: {error}"))
        })?;
        let progress = self.progress.map(|own| own.clone().unbind());
        let (done, all) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let is_cancelled = AtomicBool::new(false);
        let note_progress = |finished: usize, total: usize| {
            // Threads report out of order.
            done.fetch_max(finished, Ordering::Relaxed);
            all.store(total, Ordering::Relaxed);
            match is_cancelled.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        };
        let report_progress = |py: Python<'_>| {
            let total = all.load(Ordering::Relaxed);
            match &progress {
                Some(progress) if total > 0 => {
                    progress.call1(py, (done.load(Ordering::Relaxed), total)).map(drop)
                }
                _ => Ok(()),
            }
        };
        let (raised, result) = py.detach(|| {
            let (sender, receiver) = sync_channel(0);
            std::thread::scope(|scope| {
                let note_progress = &note_progress;
                let worker = scope.spawn(move || pool.install(|| study(note_progress, sender)));
                let mut raised = None;
                loop {
                    let snapshot = match receiver.recv_timeout(POLL_INTERVAL) {
                        Ok(snapshot) => Some(snapshot),
                        Err(RecvTimeoutError::Timeout) => None,
                        // The study has ended.
                        Err(RecvTimeoutError::Disconnected) => break,
                    };
                    if raised.is_some() {
                        continue;
                    }
                    raised = Python::attach(|py| {
                        py.check_signals()?;
                        report_progress(py)?;
                        snapshot.map_or(Ok(()), |snapshot| on_snapshot(py, snapshot))
                    })
                    .err();
                    is_cancelled.store(raised.is_some(), Ordering::Relaxed);
                }
                (raised, worker.join())
            })
        });
        if let Some(exception) = raised {
            return Err(exception);
        }
        let result = result.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        let value = result.map_err(|error| to_exception(py, &error, self.has_lines))?;
        report_progress(py)?;
        Ok(value)
    }
}
