//! The list of models: granular flows by name.
//!
//! [`STANDARD_FLOWS`] are those of this crate. A program adds its own with [`register_flow`]; from
//! then on they can be named in case files and are treated like the others.

use crate::granular_flow::{FlowModel, Kind};
use std::sync::{PoisonError, RwLock};

/// The granular flows of this crate, in the order in which they are listed.
pub const STANDARD_FLOWS: [Kind; 4] =
    [Kind::HARRIS_GREKOVA, Kind::DOUBLE_SHEARING, Kind::PLASTIC_POTENTIAL, Kind::FREE_ROTATING];

/// Models that a program has added.
static ADDED_FLOWS: RwLock<Vec<Kind>> = RwLock::new(Vec::new());

/// A model that cannot be added.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegistryError {
    /// Its name is taken.
    #[error("a model is called {0} already")]
    NameTaken(&'static str),
    /// Another model has a parameter of the same name in another unit.
    #[error("{model}: the parameter {parameter} has the unit {unit} in other models")]
    OtherUnit {
        /// The model.
        model: &'static str,
        /// The parameter.
        parameter: &'static str,
        /// Its unit in the models that are listed already.
        unit: &'static str,
    },
}

/// All granular flows, those of this crate first.
pub fn flows() -> Vec<Kind> {
    let added = ADDED_FLOWS.read().unwrap_or_else(PoisonError::into_inner);
    STANDARD_FLOWS.iter().chain(added.iter()).copied().collect()
}

/// Adds a granular-flow model.
///
/// # Errors
/// Its name is taken, or a parameter has another unit in another model.
pub fn register_flow(model: &'static FlowModel) -> Result<(), RegistryError> {
    let mut added = ADDED_FLOWS.write().unwrap_or_else(PoisonError::into_inner);
    for other in STANDARD_FLOWS.iter().chain(added.iter()) {
        if other.name() == model.name {
            return Err(RegistryError::NameTaken(model.name));
        }
        for parameter in model.parameters {
            let same = other.parameters().iter().find(|own| own.name == parameter.name);
            if let Some(same) = same.filter(|own| own.unit != parameter.unit) {
                return Err(RegistryError::OtherUnit {
                    model: model.name,
                    parameter: parameter.name,
                    unit: same.unit,
                });
            }
        }
    }
    added.push(Kind::new(model));
    Ok(())
}
