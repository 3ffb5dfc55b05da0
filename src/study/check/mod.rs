//! Agreement of time-domain measurements with the predictions of the analysis.
//!
//! [`agreement`] holds prediction and measurement against each other; here stand its results on the problems that a case
//! states.

pub mod flow;
pub mod refinement;
pub mod solid;

pub use crate::setup::check::Extent;

use super::OnProgress;
use crate::Error;
use crate::case::Case;
use crate::setup::check::CheckPlan;
use flow::FlowCheck;
use serde::Serialize;
use solid::SolidCheck;

/// Whether measured waves are those that are predicted.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    /// The medium in words.
    pub model: String,
    /// Whether everything that was measured agrees; `None` where nothing was.
    pub agrees: Option<bool>,
    /// Result of the check.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// Result of the check of a case.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// Check of a solid.
    Solid(SolidCheck),
    /// Check of a flow.
    Flow(FlowCheck),
    /// No solver takes the case.
    NotMeasurable {
        /// Why not.
        not_measurable: String,
    },
}

/// Follows waves of a case in time and by the analysis, on the threads of the surrounding rayon pool.
///
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::check::{Extent, Outcome};
/// use wellposed::study::unwatched;
///
/// let text = "
/// [model]
/// kind = 'classical'
/// dimensions = 2
/// lambda = 1.5
/// mu = 1
/// density = 2
/// [check]
/// cells = [12, 16]
/// ";
/// let case = Case::parse(text, "elastic.toml", &[])?;
/// let found = wellposed::check(&case, Extent::Short, &unwatched)?;
/// assert_eq!(found.agrees, Some(true));
/// let Outcome::Solid(solid) = found.outcome else { panic!("a solid") };
/// // Pressure and shear waves in two directions.
/// assert_eq!(solid.media[0].rows.len(), 4);
/// # Ok::<(), wellposed::Error>(())
/// ```
///
/// # Errors
/// The case is wrong, its state cannot be analysed, or the study was cancelled.
pub fn check(case: &Case, extent: Extent, on_progress: OnProgress) -> Result<CheckResult, Error> {
    let (agrees, outcome) = match CheckPlan::new(case, extent)? {
        CheckPlan::Solid(media) => {
            let found = solid::check(media, on_progress)?;
            (found.agrees(), Outcome::Solid(found))
        }
        CheckPlan::Flow(plan) => {
            let found = flow::check(case, &plan, on_progress)?;
            (found.agrees(), Outcome::Flow(found))
        }
        CheckPlan::NotMeasurable(not_measurable) => {
            (None, Outcome::NotMeasurable { not_measurable })
        }
    };
    Ok(CheckResult { model: case.medium().title(), agrees, outcome })
}

impl CheckResult {
    /// Number of rows and of those that disagree.
    pub fn counts(&self) -> [usize; 2] {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => [0, 0],
            Outcome::Flow(own) => own.counts(),
            Outcome::Solid(own) => own.counts(),
        }
    }

    /// Number of waves without a measurement.
    pub fn unmeasured(&self) -> usize {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => 0,
            Outcome::Flow(own) => own.unmeasured(),
            Outcome::Solid(own) => own.media.iter().map(|own| own.unmeasured()).sum(),
        }
    }

    /// The greatest difference of a measured wave, relative to its rate; `None` where nothing was measured.
    pub fn greatest_difference(&self) -> Option<f64> {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => None,
            Outcome::Flow(own) => own.greatest_difference(),
            Outcome::Solid(own) => greatest(own.media.iter().flat_map(|own| own.differences())),
        }
    }
}

/// The greatest of some sizes; what is not a number is the greatest.
fn greatest(sizes: impl Iterator<Item = f64>) -> Option<f64> {
    sizes.reduce(|sum, own| if own <= sum || sum.is_nan() { sum } else { own })
}
