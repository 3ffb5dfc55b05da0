//! Progress with the time left, on a terminal, for work that lasts over a second.

use crate::study::OnProgress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rayon::ThreadPool;
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::{Once, OnceLock};
use std::time::{Duration, Instant};

/// Work shorter than this is not worth a bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Carries out a study on the threads of a pool, with a bar called `name` while it lasts.
pub fn watched<T: Send>(
    pool: &ThreadPool,
    name: &'static str,
    study: impl FnOnce(OnProgress) -> T + Send,
) -> T {
    let progress = OnceLock::new();
    let on_progress = |done: usize, all: usize| {
        let progress = progress.get_or_init(|| Progress::new(name, all as u64));
        progress.advance_to(done as u64, all as u64);
        ControlFlow::Continue(())
    };
    pool.install(|| study(&on_progress))
}

/// A bar on standard error that several threads may push. Gone when dropped.
pub struct Progress {
    /// Absent where standard error is no terminal.
    bar: Option<ProgressBar>,
    start: Instant,
    show: Once,
}

impl Progress {
    /// Work of `total` steps, called `name`.
    pub fn new(name: &'static str, total: u64) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{msg} {wide_bar} {percent} %, {eta} left")
                .unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
            bar.with_style(style).with_message(name)
        });
        Self { bar, start: Instant::now(), show: Once::new() }
    }

    /// What is to be said beside the bar.
    pub fn note(&self, text: String) {
        if let Some(bar) = &self.bar {
            bar.set_message(text);
        }
    }

    /// `steps` more are done.
    pub fn tick(&self, steps: u64) {
        if let Some(bar) = &self.bar {
            self.show_after_a_while(bar);
            bar.inc(steps);
        }
    }

    /// So many steps of so many are done. Steps of several threads may be told in any order.
    fn advance_to(&self, done: u64, all: u64) {
        if let Some(bar) = &self.bar {
            self.show_after_a_while(bar);
            bar.set_length(all);
            bar.set_position(done.max(bar.position()));
        }
    }

    fn show_after_a_while(&self, bar: &ProgressBar) {
        if self.start.elapsed() > PATIENCE {
            self.show.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
