//! Progress with the time left, on a terminal, for work that lasts over a second.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::ops::ControlFlow;
use std::sync::Once;
use std::time::{Duration, Instant};

/// Work shorter than this is not worth a bar.
const PATIENCE: Duration = Duration::from_secs(1);

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
        if let Some(bar) = self.shown() {
            bar.inc(steps);
        }
    }

    /// So many steps are done, as a study says; it goes on.
    pub fn reach(&self, done: usize) -> ControlFlow<()> {
        if let Some(bar) = self.shown() {
            bar.set_position(done as u64);
        }
        ControlFlow::Continue(())
    }

    /// The bar, on the terminal once the work lasts.
    fn shown(&self) -> Option<&ProgressBar> {
        let bar = self.bar.as_ref()?;
        if self.start.elapsed() > PATIENCE {
            self.show.call_once(|| bar.set_draw_target(ProgressDrawTarget::stderr()));
        }
        Some(bar)
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
