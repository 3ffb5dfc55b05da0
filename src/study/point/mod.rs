//! Analysis of one state of a flow or solid: background, characteristics, dispersion roots, growth, verdict.

pub mod background;
pub mod equations;
pub mod flow;
pub mod flow_state;
pub mod solid;

pub use equations::EquationsAnalysis;
pub use flow::{FlowAnalysis, FlowModelAnalysis, FlowState};
pub use flow_state::YieldingState;
pub use solid::SolidAnalysis;

use super::ProgressCallback;
use crate::Error;
use crate::case::{Case, ModelKind};
use analysis::growth::Verdict;
use serde::Serialize;

/// Analysis of the state given by a case.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub enum PointResult {
    /// Analysis of the state of a flow.
    Flow(FlowAnalysis),
    /// Analysis of the state of a solid.
    Solid(Box<SolidAnalysis>),
    /// Analysis of the state of a model given as equations.
    Equations(Box<EquationsAnalysis>),
}

impl PointResult {
    /// Returns the verdict on the model of the case; `None` if the state is not fully deforming.
    pub fn verdict(&self) -> Option<&Verdict> {
        match self {
            Self::Flow(flow) => {
                flow.analysis.yielding_state().map(|state| &state.assessment.verdict)
            }
            Self::Solid(solid) => Some(&solid.assessment.verdict),
            Self::Equations(found) => Some(&found.assessment.verdict),
        }
    }
}

/// Analyses the state of a case. Progress counts the steps of the analysis.
///
/// # Errors
/// The case is out of range of its model, or cannot be analysed; [`Error::Cancelled`].
///
/// # Examples
/// Perturbations in double shearing grow in proportion to the wave number:
/// ```
/// use wellposed::case::Case;
/// use wellposed::study::{PointResult, ignore_progress};
///
/// let case = Case::parse(
///     "
/// [model]
/// kind = 'double-shearing'
/// friction_angle_deg = 30
/// [background]
/// density = 1600
/// pressure = 1000
/// shear_rate = 2
/// stress_angle_deg = 0
/// noncoaxiality_deg = 20
/// [wave]
/// number = 500
/// ",
///     "state.toml",
///     &[],
/// )?;
/// let found = wellposed::analyse_point(&case, &ignore_progress)?;
/// assert_eq!(found.verdict().map(|verdict| verdict.name()), Some("ill-posed"));
///
/// let PointResult::Flow(flow) = &found else { unreachable!("double shearing is a flow") };
/// let state = flow.analysis.yielding_state().expect("a fully deforming state");
/// assert_eq!(state.growth_order, Some(1.0));
/// println!("Re ς ≈ {:?} k at {:?}°", state.growth_coefficient, state.direction_deg);
/// # Ok::<(), wellposed::Error>(())
/// ```
pub fn analyse_point(case: &Case, on_progress: ProgressCallback) -> Result<PointResult, Error> {
    case.check_without_contacts()?;
    match case.material.kind {
        ModelKind::Flow(_) => Ok(PointResult::Flow(flow::analyse_flow(case, on_progress)?)),
        ModelKind::Solid(_) => {
            Ok(PointResult::Solid(Box::new(solid::analyse_solid(case, on_progress)?)))
        }
        ModelKind::Equations => {
            Ok(PointResult::Equations(Box::new(equations::analyse_equations(case, on_progress)?)))
        }
        ModelKind::Rheology => Err(case.locate_error(case.material.unsuitable_kind_error()).into()),
    }
}

/// Returns the order of growth in k and the growth coefficient, m^order/s, of an ill-posed state; `None` if growth is
/// unbounded at finite wave numbers, or if the state is not ill-posed.
fn order_and_coefficient(verdict: &Verdict) -> [Option<f64>; 2] {
    match verdict {
        Verdict::IllPosed { growth: Some(growth), .. } => {
            [Some(growth.order.to_f64()), Some(growth.coefficient)]
        }
        _ => [None; 2],
    }
}
