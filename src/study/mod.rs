//! Questions about a case, each answered by a value: nothing is printed, no file is touched.
//!
//! One file per question. A value can be serialised (`serde`), as it stands in the reports; what reports do not hold,
//! such as long curves, is in it as well.

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

/// Called with the number of steps done and of all, from any thread; a study that is told to break ends with
/// [`Error::Cancelled`].
pub type OnProgress<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// For a study that nobody watches.
pub fn unwatched(_done: usize, _all: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Reports to whoever watches.
///
/// # Errors
/// The study was told to break.
fn report_progress(on_progress: OnProgress, done: usize, all: usize) -> Result<(), Error> {
    match on_progress(done, all) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}
