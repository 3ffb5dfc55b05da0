//! Agreement of time-domain measurements with the predictions of the analysis.
//!
//! [`agreement`] compares prediction and measurement; this module collects its results for the problems of a case.

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

/// Comparison of measured with predicted waves.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    /// Description of the medium.
    pub model: String,
    /// Whether all measurements agree; `None` without any.
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
    /// No solver supports the case.
    NotMeasurable {
        /// Reason.
        not_measurable: String,
    },
}

/// Measures waves of a case with the solver and compares them with the analysis, on the threads of the surrounding
/// rayon pool.
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
/// The case is invalid, its state cannot be analysed, or the study was cancelled.
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
    /// Returns the number of rows and the number that disagree.
    pub fn counts(&self) -> [usize; 2] {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => [0, 0],
            Outcome::Flow(own) => own.counts(),
            Outcome::Solid(own) => own.counts(),
        }
    }

    /// Returns the number of waves without measurement.
    pub fn unmeasured(&self) -> usize {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => 0,
            Outcome::Flow(own) => own.unmeasured(),
            Outcome::Solid(own) => own.media.iter().map(|own| own.unmeasured()).sum(),
        }
    }

    /// Returns the greatest difference of a measured wave relative to its rate; `None` without measurement.
    pub fn greatest_difference(&self) -> Option<f64> {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => None,
            Outcome::Flow(own) => own.greatest_difference(),
            Outcome::Solid(own) => greatest(own.media.iter().flat_map(|own| own.differences())),
        }
    }
}

/// Returns the maximum; NaN counts as the greatest, `None` without values.
fn greatest(sizes: impl Iterator<Item = f64>) -> Option<f64> {
    sizes.reduce(|sum, own| if own <= sum || sum.is_nan() { sum } else { own })
}
