//! Agreement of waves measured by the solvers in the time domain with those predicted by the analysis.
//!
//! [`agreement`] compares prediction and measurement; this module collects its results for the problems of a case.

pub mod blocks;
pub mod equations;
pub mod flow;
pub mod refinement;
pub mod shocks;
pub mod solid;

pub use crate::setup::check::CheckExtent;

use super::{ProgressCallback, SolidVerdict, decide_solid_verdict};
use crate::Error;
use crate::case::Case;
use crate::setup::check::{CheckPlan, format_reason};
use equations::EquationsCheck;
use flow::FlowCheck;
use serde::Serialize;
use shocks::ShockCheck;
use solid::SolidCheck;

/// Result of comparing the measured waves of a case with the predicted ones.
#[derive(Clone, Debug, Serialize)]
pub struct CheckResult {
    /// Title of the checked medium.
    #[serde(rename = "model")]
    pub medium_title: String,
    /// Whether all measurements agree with the predictions, including grid refinements and band gaps; `None` without
    /// measurements.
    #[serde(rename = "agrees")]
    pub is_in_agreement: Option<bool>,
    /// Verdict of the analysis on a solid; `None` for other media.
    #[serde(flatten)]
    pub solid_verdict: Option<SolidVerdict>,
    /// Detailed results, by kind of medium.
    #[serde(flatten)]
    pub outcome: CheckOutcome,
}

/// Detailed results of the check of a case, by kind of medium.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum CheckOutcome {
    /// Check results of a solid.
    Solid(SolidCheck),
    /// Check results of a flow.
    Flow(FlowCheck),
    /// Check results of a model given as equations.
    Equations(EquationsCheck),
    /// Check results of plane waves in a granular or porous medium.
    Shocks(ShockCheck),
    /// Nothing is measured, since no solver supports the case.
    NotMeasurable {
        /// Reason why no solver supports the case.
        #[serde(rename = "not_measurable")]
        reason: String,
    },
}

/// Measures waves of a case with the solver and compares them with the analysis, on the threads of the surrounding
/// rayon pool.
///
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::check::{CheckExtent, CheckOutcome};
/// use wellposed::study::ignore_progress;
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
/// let found = wellposed::check_agreement(&case, CheckExtent::Short, &ignore_progress)?;
/// assert_eq!(found.is_in_agreement, Some(true));
/// let CheckOutcome::Solid(solid) = found.outcome else { panic!("a solid") };
/// // Pressure and shear waves in two directions.
/// assert_eq!(solid.medium_checks[0].branch_checks.len(), 4);
/// # Ok::<(), wellposed::Error>(())
/// ```
///
/// # Errors
/// The case is invalid, its state cannot be analysed, or the study was cancelled.
pub fn check_agreement(
    case: &Case,
    extent: CheckExtent,
    on_progress: ProgressCallback,
) -> Result<CheckResult, Error> {
    let (is_in_agreement, outcome) = match CheckPlan::new(case, extent)? {
        CheckPlan::Solid { medium_plans: media, blocky_medium_plans: blocks } => {
            let found = solid::check_solid((media, blocks), &case.material, on_progress)?;
            (found.is_in_agreement(), CheckOutcome::Solid(found))
        }
        CheckPlan::Flow(plan) => {
            let found = flow::check_flow(case, &plan, on_progress)?;
            (found.is_in_agreement(), CheckOutcome::Flow(found))
        }
        CheckPlan::Equations(wave_count) => {
            let found = equations::check_equations(case, wave_count, on_progress)?;
            (Some(found.is_in_agreement()), CheckOutcome::Equations(found))
        }
        CheckPlan::Shocks(plan) => match shocks::check_shocks(case, &plan, on_progress)? {
            Ok(found) => (found.is_in_agreement(), CheckOutcome::Shocks(found)),
            Err(error) => (None, CheckOutcome::NotMeasurable { reason: format_reason(error) }),
        },
        CheckPlan::NotMeasurable(reason) => (None, CheckOutcome::NotMeasurable { reason }),
    };
    Ok(CheckResult {
        medium_title: case.medium().title(),
        is_in_agreement,
        solid_verdict: decide_solid_verdict(case),
        outcome,
    })
}

impl CheckResult {
    /// Returns the number of checked items and the number of those that disagree. Items are branches and band gaps of a
    /// solid and its blocks, modes and grid refinements of a flow, or quantities of plane waves.
    pub fn item_and_failure_counts(&self) -> [usize; 2] {
        match &self.outcome {
            CheckOutcome::NotMeasurable { .. } => [0, 0],
            CheckOutcome::Equations(own) => own.item_and_failure_counts(),
            CheckOutcome::Flow(own) => own.item_and_failure_counts(),
            CheckOutcome::Shocks(own) => own.item_and_failure_counts(),
            CheckOutcome::Solid(own) => own.item_and_failure_counts(),
        }
    }

    /// Returns the number of branches of a solid, modes of a flow, or quantities of plane waves without measurement.
    pub fn unmeasured_count(&self) -> usize {
        match &self.outcome {
            CheckOutcome::NotMeasurable { .. } | CheckOutcome::Equations(_) => 0,
            CheckOutcome::Flow(own) => own.unmeasured_count(),
            CheckOutcome::Shocks(own) => own.unmeasured_count(),
            CheckOutcome::Solid(own) => {
                let media: usize = own.medium_checks.iter().map(|own| own.unmeasured_count()).sum();
                media
                    + own
                        .blocky_medium_checks
                        .iter()
                        .map(|own| own.unmeasured_count())
                        .sum::<usize>()
            }
        }
    }

    /// Returns the largest relative difference between measured and predicted rates of branches or modes, or quantities
    /// of plane waves; `None` without measurement.
    pub fn max_relative_difference(&self) -> Option<f64> {
        match &self.outcome {
            CheckOutcome::NotMeasurable { .. } => None,
            CheckOutcome::Equations(own) => own.max_relative_difference(),
            CheckOutcome::Flow(own) => own.max_relative_difference(),
            CheckOutcome::Shocks(own) => own.max_relative_difference(),
            CheckOutcome::Solid(own) => {
                let media = own.medium_checks.iter().flat_map(|own| own.relative_differences());
                max_with_nan_largest(media.chain(
                    own.blocky_medium_checks.iter().flat_map(|own| own.relative_differences()),
                ))
            }
        }
    }
}

/// Returns the maximum of `sizes`, where NaN counts as the largest value; `None` without values.
fn max_with_nan_largest(sizes: impl Iterator<Item = f64>) -> Option<f64> {
    sizes.reduce(|sum, own| if own <= sum || sum.is_nan() { sum } else { own })
}
