//! Assessment of the state of a flow that a case describes, with frozen coefficients.

use crate::case::Case;
use analysis::StateError;
use analysis::flows::{FlowWorkspace, FrozenState};
use models::flow::Model;

/// Returns the model of a case and the assessment of its state by the linearised equations.
///
/// # Errors
/// A constant is out of range, or the state cannot be analysed.
pub fn assess_flow_state(
    case: &Case,
    workspace: &mut FlowWorkspace,
) -> Result<(Model, FrozenState), StateError> {
    let model = case.build_model()?;
    let frozen = workspace.assess_state(&model, &case.to_flow_state())?;
    Ok((model, frozen))
}
