//! The list of models: granular flows by name.
//!
//! [`STANDARD_FLOWS`] are those of this crate. A program adds its own with [`register_flow`]; from
//! then on they can be named in case files and are treated like the others.

use crate::granular_flow::{FlowModel, Kind};
use crate::{double_shearing, free_rotating, harris_grekova, plastic_potential};
use std::sync::{PoisonError, RwLock};

/// Harris & Grekova (2005).
pub const HARRIS_GREKOVA: Kind = Kind::new(&harris_grekova::MODEL);
/// Spencer (1964); Mehrabadi & Cowin (1978) for ν > 0.
pub const DOUBLE_SHEARING: Kind = Kind::new(&double_shearing::MODEL);
/// Coaxial plastic potential with its own dilatancy angle.
pub const PLASTIC_POTENTIAL: Kind = Kind::new(&plastic_potential::MODEL);
/// Double-sliding free-rotating (de Josselin de Jong 1977).
pub const FREE_ROTATING: Kind = Kind::new(&free_rotating::MODEL);

/// The granular flows of this crate, in the order in which they are listed.
pub const STANDARD_FLOWS: [Kind; 4] =
    [HARRIS_GREKOVA, DOUBLE_SHEARING, PLASTIC_POTENTIAL, FREE_ROTATING];

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

/// The granular flow of that name.
pub fn flow(name: &str) -> Option<Kind> {
    flows().into_iter().find(|kind| kind.name() == name)
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
