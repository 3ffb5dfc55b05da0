//! Kinds of layers in the registry: constants, examples, errors.

use crate::interface::support::{ELASTIC, SATURATED, plastic_constants};
use wellposed_models::common::parameter::{Parameter, Presence};
use wellposed_models::interface::kinds::{NORMAL_COMPONENT_NAMES, TANGENTIAL_COMPONENT_NAMES};
use wellposed_models::interface::layer::LayerLaw;
use wellposed_models::interface::parameters::{LayerMaterial, SaturatedMaterial};
use wellposed_models::registry::{LAYERS, find_layer, find_layer_by_components};

#[test]
fn examples_of_all_kinds_build_a_law() {
    for kind in LAYERS {
        let examples: Vec<f64> = kind.parameters.iter().map(Parameter::example_value).collect();
        let material = kind.build(&examples).expect("valid examples");
        material.to_law(Default::default());
        assert_eq!(find_layer(kind.name), Some(kind));
        assert!(material.thickness() > 0.0);
        assert!(kind.build(&examples[1..]).is_err());
    }
    let names: Vec<_> = LAYERS.iter().map(|kind| kind.name).collect();
    assert_eq!(
        names[..7],
        ["elastic", "elastic-plastic", "viscous", "porous", "saturated", "cracked", "breaking"]
    );
}

/// The error for a constant out of range names the constant.
#[test]
fn constants_out_of_range_are_refused_by_name() {
    for kind in LAYERS {
        for (index, parameter) in kind.parameters.iter().enumerate() {
            let mut constants: Vec<f64> =
                kind.parameters.iter().map(Parameter::example_value).collect();
            for wrong in [-1.0, f64::INFINITY, f64::NAN] {
                let is_absent = wrong.is_nan() && parameter.presence == Presence::Optional;
                let is_allowed = wrong == -1.0 && parameter.name == "coupling_stiffness";
                if is_absent || is_allowed {
                    continue;
                }
                constants[index] = wrong;
                let error = kind.build(&constants).expect_err("refused");
                assert_eq!(error.input, parameter.name, "{}: {error}", kind.name);
            }
        }
    }
}

#[test]
fn constants_of_one_name_have_one_unit_and_components_are_found() {
    for kind in LAYERS {
        for other in LAYERS {
            for parameter in kind.parameters {
                for counterpart in other.parameters.iter().filter(|p| p.name == parameter.name) {
                    assert_eq!(parameter.unit, counterpart.unit);
                }
            }
        }
    }
    for normal in NORMAL_COMPONENT_NAMES {
        for tangential in TANGENTIAL_COMPONENT_NAMES {
            let kind = find_layer_by_components(normal, tangential).expect("allowed");
            assert_eq!(kind.components, Some([normal, tangential]));
        }
    }
    assert_eq!(
        find_layer_by_components("porous", "plastic").map(|kind| kind.name),
        Some("porous-plastic")
    );
}

#[test]
fn dependent_constants_are_checked() {
    let unstable = SaturatedMaterial { coupling_stiffness: 1.03, ..SATURATED };
    let error = LayerMaterial::Saturated(unstable).check().expect_err("b0 bf < bs^2");
    println!("{error}");
    assert_eq!(error.input, "coupling_stiffness");
    let breaking =
        |strength| LayerMaterial::Breaking(ELASTIC, plastic_constants(1.0, 0.5, 0.0), strength);
    let error = breaking(2.01).check().expect_err("beyond the apex");
    println!("{error}");
    assert_eq!(error.input, "tensile_strength");
    assert!(breaking(2.0).check().is_ok());
    assert!(matches!(
        breaking(2.0).without_fracture().to_law(Default::default()),
        LayerLaw::Plastic(_)
    ));
}
