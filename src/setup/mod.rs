//! Conversion of cases to problems of the other crates, and of the errors of these crates to errors with a position in
//! the case file.

pub mod blocky;
pub mod check;
pub mod flow;
pub(crate) mod flow_run;
pub mod plane_wave;
pub mod solid;
pub(crate) mod solid_run;

use crate::Error;
use crate::case::{Case, Material, ModelKind};
use analysis::StateError;
use models::InputError;

/// Converts an error in the state of a case to an error with its position in the case file.
pub fn locate_state_error(material: &Material, error: StateError) -> Error {
    material.locate_error(into_input_error(material, error)).into()
}

/// Converts an error in the state at a map point to an error with its position in the case file; errors in swept
/// parameters are located in the section \[map\].
pub fn locate_map_point_error(case: &Case, error: StateError) -> Error {
    if let (StateError::Evaluation(error), Some(equations)) = (&error, &case.equations) {
        return equations.locate_evaluation_error(error).into();
    }
    case.locate_error_in_map(into_input_error(&case.material, error)).into()
}

fn into_input_error(material: &Material, error: StateError) -> InputError {
    let state = if let ModelKind::Solid(_) = material.kind { "model" } else { "background" };
    let (key, allowed) = match error {
        StateError::Input(error) => return error,
        StateError::Analysis(error) => (state, error.to_string()),
        StateError::Evaluation(error) => (state, error.to_string()),
        StateError::NoResponse(error) => ("yield", error.to_string()),
        StateError::NormalSearch(error) => ("model", error.to_string()),
    };
    InputError {
        input: key,
        rejected_value: "a state that cannot be analysed".into(),
        allowed_values: allowed,
    }
}
