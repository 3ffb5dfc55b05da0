//! Studies of a case. They return values and write neither to the terminal nor to files.
//!
//! Each study has one module. Results implement `serde::Serialize`, as in the JSON reports; values that reports omit,
//! such as long curves, are fields marked `#[serde(skip)]`.

mod available_memory;
pub mod bloch;
pub mod certified;
pub mod check;
pub mod compare;
pub mod diagram;
pub mod dispersion;
pub mod extremes;
pub mod format;
pub mod homogenise;
pub mod map;
pub mod point;
pub mod shocks;
pub mod simulate;
pub mod speeds;
pub mod timing;
pub mod verdict;

pub use bloch::{BandStructureResult, compute_bloch_waves};
pub use certified::{BoxRange, BoxRangeError, CertifiedState, certify_state, is_certificate_of};
pub use check::{CheckResult, check_agreement};
pub use compare::{ComparisonResult, compare_runs};
pub use diagram::{DiagramResult, compute_diagram};
pub use dispersion::{DispersionResult, compute_dispersion};
pub use homogenise::{HomogeniseResult, homogenise};
pub use map::{
    MapOptions, MapResult, check_map, check_map_memory, compute_map, compute_map_on_ranks,
    estimate_map_memory, sample_map,
};
pub use point::{EquationsAnalysis, FlowAnalysis, PointResult, SolidAnalysis, analyse_point};
pub use shocks::{ShocksResult, compute_shocks};
pub use simulate::{RunResult, simulate};
pub use speeds::{SpeedsResult, compute_speeds};
pub use verdict::{SolidVerdict, decide_solid_verdict};

use crate::Error;
use std::ops::ControlFlow;

/// Progress callback of a study; if it returns `Break`, the study ends with [`Error::Cancelled`].
#[doc(inline)]
pub use agreement::ProgressCallback;

/// Progress callback that ignores the progress and lets the study continue.
pub fn ignore_progress(_done: usize, _all: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Passes progress to the callback: `done` of `all` steps are complete.
///
/// # Errors
/// The callback returned `Break`: [`Error::Cancelled`].
fn report_progress(on_progress: ProgressCallback, done: usize, all: usize) -> Result<(), Error> {
    match on_progress(done, all) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(Error::Cancelled),
    }
}
