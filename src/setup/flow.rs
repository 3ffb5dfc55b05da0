//! Frozen-coefficient state of a flow from a case.

use crate::case::Case;
use analysis::StateError;
use analysis::flows::{FrozenState, Workspace};
use models::flow::Model;

/// Returns the model of a case and the assessment of its state by the linearised equations.
///
/// # Errors
/// See [`StateError`].
pub fn assess(case: &Case, workspace: &mut Workspace) -> Result<(Model, FrozenState), StateError> {
    let model = case.flow_model()?;
    let frozen = workspace.assess_state(&model, &case.state())?;
    Ok((model, frozen))
}
