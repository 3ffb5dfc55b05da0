//! Studies of a case that return values, without output to terminal or files.
//!
//! One module per study. Results implement `serde::Serialize`, as in the JSON reports; data that reports omit, such as
//! long curves, are fields marked `#[serde(skip)]`.

mod available;
pub mod check;
pub mod dispersion;
pub mod extremes;
pub mod map;
pub mod point;
pub mod simulate;
pub mod speeds;
pub mod words;

pub use check::{CheckResult, check};
pub use dispersion::{Dispersion, dispersion};
pub use map::{MapOptions, MapResult, check_map, map};
pub use point::{FlowPoint, PointResult, SolidPoint, point};
pub use simulate::{RunResult, simulate};
pub use speeds::{Speeds, speeds};

use crate::Error;
use std::ops::ControlFlow;

/// Callback with the number of steps done and the total, called from any thread; on `Break` the study ends with
/// [`Error::Cancelled`].
pub type OnProgress<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// Progress callback that does nothing.
pub fn unwatched(_done: usize, _all: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Reports progress to the callback.
///
/// # Errors
/// The callback returned `Break`: [`Error::Cancelled`].
fn report_progress(on_progress: OnProgress, done: usize, all: usize) -> Result<(), Error> {
    match on_progress(done, all) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}
