//! Keys of the constants of joints, from the registered kinds of layers.

use crate::schema::{KeyCondition, KeyGroup, KeyPresence, KeySchema, ValueType};
use models::common::parameter::Presence;
use models::interface::kinds::{self, LayerModel};

/// Kinds of layers with the constants of an elastic layer.
const KINDS_WITH_ELASTICITY: &[&str] = &[
    "elastic",
    "elastic-plastic",
    "viscous",
    "porous",
    "cracked",
    "breaking",
    "porous-viscous",
    "porous-plastic",
];
/// Kinds of layers with shear strength and hardening.
const KINDS_WITH_PLASTICITY: &[&str] = &["elastic-plastic", "breaking", "porous-plastic"];
/// Kinds of layers with shear strength and friction.
const KINDS_WITH_COHESIVE_FRICTION: &[&str] = &["elastic-plastic", "breaking"];
/// Kinds of layers with delayed shear.
const KINDS_WITH_VISCOSITY: &[&str] = &["viscous", "saturated", "porous-viscous"];
/// Kinds of layers with collapsing pores.
const KINDS_WITH_PORES: &[&str] = &["porous", "saturated", "porous-viscous", "porous-plastic"];

const DENSITY_KEY: KeySchema = new_constant_key(&kinds::ELASTIC, "density", "1500.0");
const LONGITUDINAL_SPEED_KEY: KeySchema =
    new_constant_key(&kinds::ELASTIC, "longitudinal_speed", "1000.0");
const SHEAR_SPEED_KEY: KeySchema = new_constant_key(&kinds::ELASTIC, "shear_speed", "500.0");
const SHEAR_STRENGTH_KEY: KeySchema = new_constant_key(&kinds::BREAKING, "shear_strength", "1e6");
const SHEAR_FRICTION_KEY: KeySchema = new_constant_key(&kinds::BREAKING, "shear_friction", "0.5");
const SLIP_HARDENING_KEY: KeySchema = new_constant_key(&kinds::BREAKING, "slip_hardening", "0.0");
const DELAYED_COMPLIANCE_KEY: KeySchema =
    new_constant_key(&kinds::VISCOUS, "delayed_compliance", "5.333333333333333e-9");
const VISCOSITY_KEY: KeySchema = new_constant_key(&kinds::VISCOUS, "viscosity", "7500.0");
const COLLAPSE_STIFFNESS_KEY: KeySchema =
    new_constant_key(&kinds::POROUS, "collapse_stiffness", "1.35e10");
const POROSITY_KEY: KeySchema = new_constant_key(&kinds::POROUS, "porosity", "0.1");
const CONTACT_FRICTION_KEY: KeySchema = new_constant_key(&kinds::CRACKED, "shear_friction", "0.5");
const SKELETON_DENSITY_KEY: KeySchema =
    new_constant_key(&kinds::SATURATED, "skeleton_density", "1300.0");
const FLUID_DENSITY_KEY: KeySchema = new_constant_key(&kinds::SATURATED, "fluid_density", "250.0");
const ADDED_DENSITY_KEY: KeySchema = new_constant_key(&kinds::SATURATED, "added_density", "100.0");
const UNDRAINED_STIFFNESS_KEY: KeySchema =
    new_constant_key(&kinds::SATURATED, "undrained_stiffness", "1.5e9");
const COUPLING_STIFFNESS_KEY: KeySchema =
    new_constant_key(&kinds::SATURATED, "coupling_stiffness", "0.45e9");
const FLUID_STIFFNESS_KEY: KeySchema =
    new_constant_key(&kinds::SATURATED, "fluid_stiffness", "0.7e9");
const INSTANTANEOUS_COMPLIANCE_KEY: KeySchema =
    new_constant_key(&kinds::SATURATED, "instantaneous_compliance", "2.6666666666666666e-9");
const TENSILE_STRENGTH_KEY: KeySchema =
    new_constant_key(&kinds::BREAKING, "tensile_strength", "0.5e6");
const FRACTURE_KEY: KeySchema = KeySchema::new_with_default(
    kinds::FRACTURE_OPTION.name,
    ValueType::Boolean,
    "",
    "true",
    kinds::FRACTURE_OPTION.meaning,
);

/// Name of the key of the ends of saturated layers at the boundaries of the domain.
pub(super) const LAYER_ENDS: &str = "ends";

/// Allowed values of the key `ends`; the first one is the default.
pub(super) const LAYER_END_NAMES: [&str; 2] = ["closed", "open"];

const LAYER_ENDS_KEY: KeySchema = KeySchema::new_with_default(
    LAYER_ENDS,
    ValueType::OneOf(|_| LAYER_END_NAMES.map(str::to_owned).to_vec()),
    "",
    "\"closed\"",
    "ends of the layer at the boundaries of the domain: closed, no flow of the fluid; open, its pressure is zero",
);

/// Condition that the joint is given by its kind, not by a law for each component.
const WITHOUT_COMPONENTS: KeyCondition = KeyCondition::Absent("normal");
/// Condition that the joint is given by the laws of its normal and tangential components.
const WITH_COMPONENTS: KeyCondition = KeyCondition::Present("normal");

/// Builds a group of keys that are allowed under conditions.
const fn new_conditional_group(
    conditions: &'static [KeyCondition],
    keys: &'static [KeySchema],
) -> KeyGroup {
    KeyGroup::with_conditions(conditions, keys)
}

/// Key `thickness`, of all kinds of layers.
pub(super) const THICKNESS_KEY: KeySchema = new_constant_key(&kinds::ELASTIC, "thickness", "1e-3");

/// Elastic constants of a joint given by its kind.
pub(super) const ELASTIC_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", KINDS_WITH_ELASTICITY)],
    &[DENSITY_KEY, LONGITUDINAL_SPEED_KEY, SHEAR_SPEED_KEY],
);
/// Shear strength and hardening of a joint given by its kind.
pub(super) const PLASTIC_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", KINDS_WITH_PLASTICITY)],
    &[SHEAR_STRENGTH_KEY, SLIP_HARDENING_KEY],
);
/// Friction of a joint with cohesion given by its kind.
pub(super) const FRICTION_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", KINDS_WITH_COHESIVE_FRICTION)],
    &[SHEAR_FRICTION_KEY],
);
/// Friction of closed cracks.
pub(super) const CONTACT_FRICTION_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", &["cracked"])],
    &[CONTACT_FRICTION_KEY],
);
/// Constants of the delayed shear of a joint given by its kind.
pub(super) const VISCOUS_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", KINDS_WITH_VISCOSITY)],
    &[DELAYED_COMPLIANCE_KEY, VISCOSITY_KEY],
);
/// Constants of the pores of a joint given by its kind.
pub(super) const PORES_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", KINDS_WITH_PORES)],
    &[COLLAPSE_STIFFNESS_KEY, POROSITY_KEY],
);
/// Constants of fluid-saturated joints.
pub(super) const SATURATED_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", &["saturated"])],
    &[
        SKELETON_DENSITY_KEY,
        FLUID_DENSITY_KEY,
        ADDED_DENSITY_KEY,
        UNDRAINED_STIFFNESS_KEY,
        COUPLING_STIFFNESS_KEY,
        FLUID_STIFFNESS_KEY,
        INSTANTANEOUS_COMPLIANCE_KEY,
        LAYER_ENDS_KEY,
    ],
);
/// Tensile strength and fracture of breaking joints.
pub(super) const BREAKING_GROUP: KeyGroup = new_conditional_group(
    &[WITHOUT_COMPONENTS, KeyCondition::HasValue("kind", &["breaking"])],
    &[TENSILE_STRENGTH_KEY, FRACTURE_KEY],
);

/// Elastic constants of a joint given by components.
pub(super) const COMPONENTS_GROUP: KeyGroup = new_conditional_group(
    &[WITH_COMPONENTS],
    &[DENSITY_KEY, LONGITUDINAL_SPEED_KEY, SHEAR_SPEED_KEY],
);
/// Constants of a porous normal component.
pub(super) const POROUS_COMPONENT_GROUP: KeyGroup = new_conditional_group(
    &[WITH_COMPONENTS, KeyCondition::HasValue("normal", &["porous"])],
    &[COLLAPSE_STIFFNESS_KEY, POROSITY_KEY],
);
/// Constants of a viscous tangential component.
pub(super) const VISCOUS_COMPONENT_GROUP: KeyGroup = new_conditional_group(
    &[WITH_COMPONENTS, KeyCondition::HasValue("tangential", &["viscous"])],
    &[DELAYED_COMPLIANCE_KEY, VISCOSITY_KEY],
);
/// Constants of an elastic-plastic tangential component.
pub(super) const PLASTIC_COMPONENT_GROUP: KeyGroup = new_conditional_group(
    &[WITH_COMPONENTS, KeyCondition::HasValue("tangential", &["plastic"])],
    &[SHEAR_STRENGTH_KEY, SLIP_HARDENING_KEY],
);
/// Friction of an elastic-plastic tangential component with an elastic normal component.
pub(super) const FRICTION_COMPONENT_GROUP: KeyGroup = new_conditional_group(
    &[
        WITH_COMPONENTS,
        KeyCondition::HasValue("normal", &["elastic"]),
        KeyCondition::HasValue("tangential", &["plastic"]),
    ],
    &[SHEAR_FRICTION_KEY],
);

/// Builds the key of a constant of a kind of layer; `example` is its example or default, as TOML.
const fn new_constant_key(
    model: &'static LayerModel,
    name: &str,
    example: &'static str,
) -> KeySchema {
    let mut index = 0;
    // An unknown name is an error at compile time, since the index is out of bounds.
    while !is_equal(model.parameters[index].name, name) {
        index += 1;
    }
    let own = &model.parameters[index];
    let presence = match own.presence {
        Presence::Required(_) => KeyPresence::Required(example),
        Presence::Default(_) => KeyPresence::Default(example),
        Presence::Optional => KeyPresence::Optional(example),
    };
    let key = KeySchema::new_required(
        own.name,
        ValueType::Number(own.range),
        own.unit,
        example,
        own.meaning,
    );
    KeySchema { presence, ..key }
}

/// Compares two texts in a constant expression.
const fn is_equal(one: &str, other: &str) -> bool {
    let (one, other) = (one.as_bytes(), other.as_bytes());
    let mut index = 0;
    while index < one.len() && index < other.len() && one[index] == other[index] {
        index += 1;
    }
    index == one.len() && index == other.len()
}

#[cfg(test)]
mod tests {
    use crate::dynamics::joint::SCHEMA;
    use crate::schema::{KeyCondition, KeyPresence, ValueType};
    use models::common::parameter::Presence;
    use models::registry::LAYERS;

    /// Verifies that each kind, and each pair of components, has the keys of its constants and no others.
    #[test]
    fn keys_of_each_kind_are_its_constants() {
        for layer in LAYERS {
            for by_components in [false, true] {
                let components = match (by_components, layer.components) {
                    (true, None) => continue,
                    (_, components) => components.unwrap_or_default(),
                };
                let holds = |condition: &KeyCondition| match condition {
                    KeyCondition::HasValue("kind", names) => names.contains(&layer.name),
                    KeyCondition::HasValue("normal", names) => {
                        by_components && names.contains(&components[0])
                    }
                    KeyCondition::HasValue("tangential", names) => {
                        by_components && names.contains(&components[1])
                    }
                    KeyCondition::Present("normal") => by_components,
                    KeyCondition::Absent("normal") => !by_components,
                    _ => true,
                };
                let numbers: Vec<_> = SCHEMA
                    .applicable_keys(holds)
                    .filter(|key| matches!(key.value_type, ValueType::Number(_)))
                    .collect();
                let mut names: Vec<&str> = numbers.iter().map(|key| key.name).collect();
                names.sort_unstable();
                let mut expected: Vec<&str> = layer.parameters.iter().map(|own| own.name).collect();
                expected.sort_unstable();
                assert_eq!(names, expected, "{}", layer.name);
                for key in numbers {
                    let own = layer.parameters.iter().find(|own| own.name == key.name).expect("it");
                    assert_eq!((key.unit, key.meaning), (own.unit, own.meaning));
                    let ValueType::Number(range) = key.value_type else { continue };
                    assert_eq!(range, own.range);
                    let example = key.example_value().parse::<f64>();
                    match (own.presence, key.presence) {
                        (Presence::Required(value), KeyPresence::Required(_))
                        | (Presence::Default(value), KeyPresence::Default(_)) => {
                            assert_eq!(example, Ok(value), "{}", key.name);
                        }
                        (Presence::Optional, KeyPresence::Optional(_)) => {}
                        other => panic!("{}: {other:?}", key.name),
                    }
                }
            }
        }
    }
}
