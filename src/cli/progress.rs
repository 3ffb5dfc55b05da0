//! Progress display of work that takes longer than a second, with the estimated remaining time: a bar on terminals,
//! otherwise a line every ten seconds, also during a long increment.

use crate::Error;
use crate::report::run::DisplayTime;
use crate::study::ProgressCallback;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::ThreadPool;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, Once, PoisonError, mpsc};
use std::time::{Duration, Instant};

/// Time from the start of the work to the appearance of the progress bar.
const PROGRESS_BAR_DELAY: Duration = Duration::from_secs(1);
/// Interval between progress lines, printed where standard error is not a terminal.
pub(super) const PROGRESS_LINE_INTERVAL: Duration = Duration::from_secs(10);
/// Interval at which a thread checks whether a progress line is due.
const LINE_CHECK_INTERVAL: Duration = Duration::from_secs(1);

/// Number of steps of one of several studies in a common progress display.
const STEPS_PER_STUDY: u64 = 1000;

/// Runs a study on the threads of a pool and shows its progress with the label `name`, see
/// [`run_in_series_with_progress`].
pub fn run_with_progress<T: Send>(
    pool: &ThreadPool,
    name: &'static str,
    study: impl FnOnce(ProgressCallback) -> T + Send,
) -> T {
    run_in_series_with_progress(pool, &DelayedProgressBar::new(name, 1), [0, 1], study)
}

/// Runs the study `index` of `count` studies on the threads of a pool and shows their common progress. Where standard
/// error is not a terminal, another thread prints the lines that become due while the study reports no progress; if that
/// thread cannot be started, only reports of the study print lines.
pub fn run_in_series_with_progress<T: Send>(
    pool: &ThreadPool,
    progress: &DelayedProgressBar,
    [index, count]: [u64; 2],
    study: impl FnOnce(ProgressCallback) -> T + Send,
) -> T {
    let on_progress = |done: usize, all: usize| {
        match count {
            1 => progress.advance_to(done as u64, all as u64),
            _ => {
                let own = STEPS_PER_STUDY * done as u64 / (all as u64).max(1);
                progress.advance_to(STEPS_PER_STUDY * index + own, STEPS_PER_STUDY * count);
            }
        }
        ControlFlow::Continue(())
    };
    if progress.progress_bar.is_some() {
        return pool.install(|| study(&on_progress));
    }
    std::thread::scope(|scope| {
        let (end, ended) = mpsc::channel::<()>();
        let print_due_lines = move || {
            while ended.recv_timeout(LINE_CHECK_INTERVAL) == Err(mpsc::RecvTimeoutError::Timeout) {
                progress.print_line_if_due();
            }
        };
        let _ = std::thread::Builder::new().spawn_scoped(scope, print_due_lines);
        let result = pool.install(|| study(&on_progress));
        // Without a sender the thread ends.
        drop(end);
        result
    })
}

/// Time after which [`estimate_time`] stops a study.
pub const ESTIMATE_TIME: Duration = Duration::from_millis(300);

/// Estimates the wall time of a study, s: runs it on the threads of a pool and, at its first report of progress after
/// [`ESTIMATE_TIME`], cancels it and extrapolates.
///
/// # Errors
/// The study fails.
pub fn estimate_time<T: Send>(
    pool: &ThreadPool,
    study: impl FnOnce(ProgressCallback) -> Result<T, Error> + Send,
) -> Result<f64, Error> {
    estimate_time_within(pool, ESTIMATE_TIME, study)
}

/// Estimates the wall time of a study like [`estimate_time`]; the study is cancelled after `limit`.
///
/// # Errors
/// The study fails.
pub fn estimate_time_within<T: Send>(
    pool: &ThreadPool,
    limit: Duration,
    study: impl FnOnce(ProgressCallback) -> Result<T, Error> + Send,
) -> Result<f64, Error> {
    let start = Instant::now();
    let estimate = Mutex::new(None);
    let on_progress = |done: usize, all: usize| {
        let elapsed = start.elapsed();
        if done == 0 || elapsed < limit {
            return ControlFlow::Continue(());
        }
        let mut estimate = estimate.lock().unwrap_or_else(PoisonError::into_inner);
        estimate.get_or_insert(elapsed.as_secs_f64() * all as f64 / done as f64);
        ControlFlow::Break(())
    };
    let result = pool.install(|| study(&on_progress));
    match (result, estimate.into_inner().unwrap_or_else(PoisonError::into_inner)) {
        (Err(Error::Cancelled), Some(seconds)) => Ok(seconds),
        (result, _) => result.map(|_| start.elapsed().as_secs_f64()),
    }
}

/// Thread-safe progress display on standard error; a bar is cleared on drop.
pub struct DelayedProgressBar {
    label: &'static str,
    /// Progress bar; `None` if standard error is not a terminal.
    progress_bar: Option<ProgressBar>,
    /// Time of the last progress line, or of the start before the first line; used if standard error is not a terminal.
    last_line_time: Mutex<Instant>,
    /// Numbers of done and of all steps for progress lines.
    step_counts: [AtomicU64; 2],
    start_time: Instant,
    first_display: Once,
}

impl DelayedProgressBar {
    /// Creates the bar for `total` steps with the label `name`.
    pub fn new(name: &'static str, total: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
            bar.with_style(style).with_message(name)
        });
        let now = Instant::now();
        Self {
            label: name,
            progress_bar: bar,
            last_line_time: Mutex::new(now),
            step_counts: [AtomicU64::new(0), AtomicU64::new(total)],
            start_time: now,
            first_display: Once::new(),
        }
    }

    /// Sets the message to the right of the bar.
    pub fn set_message(&self, text: String) {
        if let Some(bar) = &self.progress_bar {
            bar.set_message(text);
        }
    }

    /// Calls `print`, which prints to the terminal, with the bar hidden.
    pub fn hide_during<T>(&self, print: impl FnOnce() -> T) -> T {
        match &self.progress_bar {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }

    /// Advances the bar by `steps`; prints no line.
    pub fn advance_by(&self, steps: u64) {
        if let Some(bar) = &self.progress_bar {
            self.show_after_delay(bar);
            bar.inc(steps);
        }
    }

    /// Sets the position to `done` of `all` steps. Threads may report in any order: the bar never goes back.
    pub fn advance_to(&self, done: u64, all: u64) {
        if let Some(bar) = &self.progress_bar {
            self.show_after_delay(bar);
            bar.set_length(all);
            bar.set_position(done.max(bar.position()));
        } else {
            self.step_counts[1].store(all, Ordering::Relaxed);
            self.step_counts[0].fetch_max(done, Ordering::Relaxed);
            self.print_line_if_due();
        }
    }

    /// Prints a progress line if the last one, or at first the start, is at least [`PROGRESS_LINE_INTERVAL`] ago.
    fn print_line_if_due(&self) {
        // If another thread is printing, this one prints nothing.
        let Ok(mut last_line) = self.last_line_time.try_lock() else { return };
        if last_line.elapsed() < PROGRESS_LINE_INTERVAL {
            return;
        }
        *last_line = Instant::now();
        let [done, all] =
            [0, 1].map(|index| self.step_counts[index].load(Ordering::Relaxed) as f64);
        let elapsed = self.start_time.elapsed().as_secs_f64();
        let state = match done > 0.0 {
            true => format!(
                "{:.1} %, about {} left",
                100.0 * (done / all).min(1.0),
                DisplayTime(elapsed * (all - done).max(0.0) / done)
            ),
            false => format!("{} so far", DisplayTime(elapsed)),
        };
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr(), "{}: {state}", self.label);
    }

    fn show_after_delay(&self, bar: &ProgressBar) {
        if self.start_time.elapsed() > PROGRESS_BAR_DELAY {
            self.first_display.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }
}

impl Drop for DelayedProgressBar {
    fn drop(&mut self) {
        if let Some(bar) = &self.progress_bar {
            bar.finish_and_clear();
        }
    }
}
