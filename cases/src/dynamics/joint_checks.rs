//! Errors of the constants and options of a joint that depend on its kind, in the words of case files.

use super::joint_keys::{LAYER_END_NAMES, LAYER_ENDS};
use crate::error::CaseError;
use crate::section::{SectionReader, join_with_commas};
use models::InputError;
use models::common::decimal::ToPlainText;
use models::interface::kinds::{FRACTURE_OPTION, LayerKind, LayerModel};
use models::registry;

/// Returns whether joints of a kind have a constant or an option, besides those of all kinds.
fn has_key(kind: &LayerModel, key: &str) -> bool {
    match key {
        LAYER_ENDS => kind.name == "saturated",
        _ => {
            kind.parameters.iter().any(|own| own.name == key)
                || kind.options.iter().any(|own| own.name == key)
        }
    }
}

/// Checks that a joint has no constants and options of other kinds alone.
pub(super) fn check_foreign_keys(
    section: &SectionReader,
    kind: LayerKind,
) -> Result<(), CaseError> {
    let constants = registry::LAYERS.iter().flat_map(|layer| layer.parameters);
    let names = constants.map(|own| own.name).chain([FRACTURE_OPTION.name, LAYER_ENDS]);
    let Some(foreign) =
        names.into_iter().find(|name| section.has_key(name) && !has_key(&kind, name))
    else {
        return Ok(());
    };
    let owners: Vec<&str> = registry::LAYERS
        .iter()
        .filter(|layer| has_key(layer, foreign))
        .map(|layer| layer.name)
        .collect();
    let found = format!("found in a joint of kind '{}'", kind.name);
    let allowed = format!("leave it out; joints with {foreign}: {}", join_with_commas(&owners));
    Err(section.key_error(foreign, found, allowed))
}

/// Creates the error of a constant that its kind refuses; `constants` are all constants of the joint, in the order of the
/// kind. Bounds by other constants are stated with their keys.
pub(super) fn constant_error(
    section: &SectionReader,
    kind: LayerKind,
    constants: &[Option<f64>],
    error: InputError,
) -> CaseError {
    let value = |name: &str| {
        let index = kind.parameters.iter().position(|own| own.name == name)?;
        constants.get(index).copied().flatten()
    };
    let bound = |names: [&str; 2]| Some([value(names[0])?, value(names[1])?]);
    let allowed = match error.input {
        "coupling_stiffness" => {
            bound(["undrained_stiffness", "fluid_stiffness"]).map(|[undrained, fluid]| {
                format!(
                    "expected less than √(undrained_stiffness · fluid_stiffness) = {:.4e} Pa, since the energy must be \
                     positive",
                    (undrained * fluid).sqrt()
                )
            })
        }
        "tensile_strength" => {
            bound(["shear_strength", "shear_friction"]).map(|[strength, friction]| {
                format!(
                    "expected at most shear_strength/shear_friction = {} Pa, the apex of the yield set",
                    (strength / friction).to_plain_text()
                )
            })
        }
        _ => None,
    };
    let found = format!("found {}", error.rejected_value);
    section.key_error(error.input, found, allowed.unwrap_or(error.allowed_values))
}

/// Reads whether the ends of a layer at the boundaries of the domain are open.
pub(super) fn read_open_ends(section: &SectionReader) -> Result<bool, CaseError> {
    let is_open = section.read_optional_choice(LAYER_ENDS, &[false, true], layer_end_name)?;
    Ok(is_open.unwrap_or_default())
}

/// Returns the word of the key `ends`.
pub(super) const fn layer_end_name(is_open: bool) -> &'static str {
    LAYER_END_NAMES[is_open as usize]
}
