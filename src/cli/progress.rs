//! Progress of work that takes longer than a second, with the estimated remaining time: a bar on terminals, elsewhere a
//! line every ten seconds.

use crate::report::run::DisplayTime;
use crate::study::ProgressCallback;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::ThreadPool;
use std::io::{IsTerminal, Write};
use std::ops::ControlFlow;
use std::sync::{Mutex, Once, OnceLock};
use std::time::{Duration, Instant};

/// Time from the start of the work to the appearance of the progress bar.
const PROGRESS_BAR_DELAY: Duration = Duration::from_secs(1);
/// Interval between progress lines, printed where standard error is not a terminal.
pub(super) const PROGRESS_LINE_INTERVAL: Duration = Duration::from_secs(10);

/// Runs a study on the threads of a pool and shows its progress, labelled `name`.
pub fn run_with_progress<T: Send>(
    pool: &ThreadPool,
    name: &'static str,
    study: impl FnOnce(ProgressCallback) -> T + Send,
) -> T {
    let progress = OnceLock::new();
    let on_progress = |done: usize, all: usize| {
        let progress = progress.get_or_init(|| DelayedProgressBar::new(name, all as u64));
        progress.advance_to(done as u64, all as u64);
        ControlFlow::Continue(())
    };
    pool.install(|| study(&on_progress))
}

/// Thread-safe progress display on standard error; a bar is cleared on drop.
pub struct DelayedProgressBar {
    name: &'static str,
    /// Progress bar; `None` if standard error is not a terminal.
    bar: Option<ProgressBar>,
    /// Time of the last progress line, initially of the start; used if standard error is not a terminal.
    last_line: Mutex<Instant>,
    start_time: Instant,
    show_once: Once,
}

impl DelayedProgressBar {
    /// Creates the bar for `total` steps, labelled `name`.
    pub fn new(name: &'static str, total: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
            bar.with_style(style).with_message(name)
        });
        let now = Instant::now();
        Self { name, bar, last_line: Mutex::new(now), start_time: now, show_once: Once::new() }
    }

    /// Sets the message beside the bar.
    pub fn set_message(&self, text: String) {
        if let Some(bar) = &self.bar {
            bar.set_message(text);
        }
    }

    /// Advances the bar by `steps`; prints no line.
    pub fn advance_by(&self, steps: u64) {
        if let Some(bar) = &self.bar {
            self.show_after_delay(bar);
            bar.inc(steps);
        }
    }

    /// Sets the position to `done` of `all` steps. Threads may report in any order: the bar never goes back.
    fn advance_to(&self, done: u64, all: u64) {
        if let Some(bar) = &self.bar {
            self.show_after_delay(bar);
            bar.set_length(all);
            bar.set_position(done.max(bar.position()));
        } else {
            self.print_line(done, all);
        }
    }

    /// Prints a progress line if the last one, or at first the start, is at least [`PROGRESS_LINE_INTERVAL`] ago.
    fn print_line(&self, done: u64, all: u64) {
        // If another thread is printing, this one prints nothing.
        let Ok(mut last_line) = self.last_line.try_lock() else { return };
        if last_line.elapsed() < PROGRESS_LINE_INTERVAL || done == 0 {
            return;
        }
        *last_line = Instant::now();
        let (done, all) = (done as f64, all as f64);
        let remaining = DisplayTime(self.start_time.elapsed().as_secs_f64() * (all - done) / done);
        let percent = 100.0 * done / all;
        // A closed standard error is ignored.
        let _ =
            writeln!(std::io::stderr(), "{}: {percent:.1} %, about {remaining} left", self.name);
    }

    fn show_after_delay(&self, bar: &ProgressBar) {
        if self.start_time.elapsed() > PROGRESS_BAR_DELAY {
            self.show_once.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }
}

impl Drop for DelayedProgressBar {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
