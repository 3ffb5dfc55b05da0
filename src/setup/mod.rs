//! From a case to what the crates below take, and their errors with the place in the case file.

pub mod check;
pub mod flow;
pub(crate) mod flow_run;
pub mod solid;
pub(crate) mod solid_run;

use crate::Error;
use crate::case::{Case, Kind, Material};
use analysis::StateError;
use models::InputError;

/// The error of a state with its place in the case file.
pub fn locate(material: &Material, error: StateError) -> Error {
    material.locate(into_input(material, error)).into()
}

/// Position of an error in a state of the map of the case, whose swept numbers are in \[map\].
pub fn locate_in_map(case: &Case, error: StateError) -> Error {
    case.locate_in_map(into_input(&case.material, error)).into()
}

fn into_input(material: &Material, error: StateError) -> InputError {
    let state = if let Kind::Solid(_) = material.kind { "model" } else { "background" };
    let (key, allowed) = match error {
        StateError::Input(error) => return error,
        StateError::Analysis(error) => (state, error.to_string()),
        StateError::NoResponse(error) => ("yield", error.to_string()),
        StateError::Sphere(error) => ("model", error.to_string()),
    };
    InputError { input: key, found: "a state that cannot be analysed".into(), allowed }
}
