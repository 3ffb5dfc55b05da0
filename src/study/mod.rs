//! Questions about a case, each answered by a value: nothing is printed, no file is touched.
//!
//! One file per question. A value can be serialised (`serde`), as it stands in the reports; what reports do not hold,
//! such as long curves, is in it as well.

pub mod dispersion;
pub mod simulate;

pub use dispersion::{Dispersion, dispersion};
pub use simulate::{RunResult, simulate};

use std::ops::ControlFlow;

/// Called with the number of steps done and of all, from any thread; a study that is told to break ends with
/// [`Error::Cancelled`](crate::Error::Cancelled).
pub type OnProgress<'a> = &'a (dyn Fn(usize, usize) -> ControlFlow<()> + Sync);

/// For a study that nobody watches.
pub fn unwatched(_done: usize, _all: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}
