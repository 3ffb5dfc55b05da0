//! From a case to a frozen state of a flow.

use crate::case::Case;
use analysis::StateError;
use analysis::flows::{FrozenState, Workspace};
use models::flow::Model;

/// The model of a case, and the assessment of the case's state from its linearised equations.
///
/// # Errors
/// See [`StateError`].
pub fn assess(case: &Case, workspace: &mut Workspace) -> Result<(Model, FrozenState), StateError> {
    let model = case.flow_model()?;
    let frozen = workspace.assess_state(&model, &case.state())?;
    Ok((model, frozen))
}
