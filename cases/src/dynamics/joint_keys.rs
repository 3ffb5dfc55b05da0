//! Keys of the constants of joints, from the registered kinds of layers.

use crate::schema::{KeyCondition, KeyGroup, KeyPresence, KeySchema, ValueType};
use models::common::parameter::Presence;
use models::interface::kinds::{self, LayerModel};

/// Kinds with the constants of an elastic layer.
const WITH_ELASTICITY: &[&str] = &[
    "elastic",
    "elastic-plastic",
    "viscous",
    "porous",
    "cracked",
    "breaking",
    "porous-viscous",
    "porous-plastic",
];
const WITH_PLASTICITY: &[&str] = &["elastic-plastic", "breaking", "porous-plastic"];
const WITH_COHESIVE_FRICTION: &[&str] = &["elastic-plastic", "breaking"];
const WITH_VISCOSITY: &[&str] = &["viscous", "saturated", "porous-viscous"];
const WITH_PORES: &[&str] = &["porous", "saturated", "porous-viscous", "porous-plastic"];

const DENSITY: KeySchema = constant(&kinds::ELASTIC, "density", "1500.0");
const LONGITUDINAL_SPEED: KeySchema = constant(&kinds::ELASTIC, "longitudinal_speed", "1000.0");
const SHEAR_SPEED: KeySchema = constant(&kinds::ELASTIC, "shear_speed", "500.0");
const SHEAR_STRENGTH: KeySchema = constant(&kinds::BREAKING, "shear_strength", "1e6");
const SHEAR_FRICTION: KeySchema = constant(&kinds::BREAKING, "shear_friction", "0.5");
const SLIP_HARDENING: KeySchema = constant(&kinds::BREAKING, "slip_hardening", "0.0");
const DELAYED_COMPLIANCE: KeySchema =
    constant(&kinds::VISCOUS, "delayed_compliance", "5.333333333333333e-9");
const VISCOSITY: KeySchema = constant(&kinds::VISCOUS, "viscosity", "7500.0");
const COLLAPSE_STIFFNESS: KeySchema = constant(&kinds::POROUS, "collapse_stiffness", "1.35e10");
const POROSITY: KeySchema = constant(&kinds::POROUS, "porosity", "0.1");
const CONTACT_FRICTION: KeySchema = constant(&kinds::CRACKED, "shear_friction", "0.5");
const SKELETON_DENSITY: KeySchema = constant(&kinds::SATURATED, "skeleton_density", "1300.0");
const FLUID_DENSITY: KeySchema = constant(&kinds::SATURATED, "fluid_density", "250.0");
const ADDED_DENSITY: KeySchema = constant(&kinds::SATURATED, "added_density", "100.0");
const UNDRAINED_STIFFNESS: KeySchema = constant(&kinds::SATURATED, "undrained_stiffness", "1.5e9");
const COUPLING_STIFFNESS: KeySchema = constant(&kinds::SATURATED, "coupling_stiffness", "0.45e9");
const FLUID_STIFFNESS: KeySchema = constant(&kinds::SATURATED, "fluid_stiffness", "0.7e9");
const INSTANTANEOUS_COMPLIANCE: KeySchema =
    constant(&kinds::SATURATED, "instantaneous_compliance", "2.6666666666666666e-9");
const TENSILE_STRENGTH: KeySchema = constant(&kinds::BREAKING, "tensile_strength", "0.5e6");
const FRACTURE: KeySchema = KeySchema::new_with_default(
    kinds::FRACTURE_OPTION.name,
    ValueType::Boolean,
    "",
    "true",
    kinds::FRACTURE_OPTION.meaning,
);

/// Condition that the components of the joint are not given.
const BY_KIND: KeyCondition = KeyCondition::Absent("normal");
const BY_COMPONENTS: KeyCondition = KeyCondition::Present("normal");

const fn by_kind(conditions: &'static [KeyCondition], keys: &'static [KeySchema]) -> KeyGroup {
    KeyGroup::with_conditions(conditions, keys)
}

/// Key of the thickness, of all kinds.
pub(super) const THICKNESS: KeySchema = constant(&kinds::ELASTIC, "thickness", "1e-3");

/// Constants by kind.
pub(super) const ELASTIC_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", WITH_ELASTICITY)],
    &[DENSITY, LONGITUDINAL_SPEED, SHEAR_SPEED],
);
pub(super) const PLASTIC_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", WITH_PLASTICITY)],
    &[SHEAR_STRENGTH, SLIP_HARDENING],
);
pub(super) const FRICTION_GROUP: KeyGroup =
    by_kind(&[BY_KIND, KeyCondition::HasValue("kind", WITH_COHESIVE_FRICTION)], &[SHEAR_FRICTION]);
pub(super) const CONTACT_FRICTION_GROUP: KeyGroup =
    by_kind(&[BY_KIND, KeyCondition::HasValue("kind", &["cracked"])], &[CONTACT_FRICTION]);
pub(super) const VISCOUS_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", WITH_VISCOSITY)],
    &[DELAYED_COMPLIANCE, VISCOSITY],
);
pub(super) const PORES_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", WITH_PORES)],
    &[COLLAPSE_STIFFNESS, POROSITY],
);
pub(super) const SATURATED_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", &["saturated"])],
    &[
        SKELETON_DENSITY,
        FLUID_DENSITY,
        ADDED_DENSITY,
        UNDRAINED_STIFFNESS,
        COUPLING_STIFFNESS,
        FLUID_STIFFNESS,
        INSTANTANEOUS_COMPLIANCE,
    ],
);
pub(super) const BREAKING_GROUP: KeyGroup = by_kind(
    &[BY_KIND, KeyCondition::HasValue("kind", &["breaking"])],
    &[TENSILE_STRENGTH, FRACTURE],
);

/// Constants by components.
pub(super) const COMPONENTS_GROUP: KeyGroup =
    by_kind(&[BY_COMPONENTS], &[DENSITY, LONGITUDINAL_SPEED, SHEAR_SPEED]);
pub(super) const POROUS_COMPONENT_GROUP: KeyGroup = by_kind(
    &[BY_COMPONENTS, KeyCondition::HasValue("normal", &["porous"])],
    &[COLLAPSE_STIFFNESS, POROSITY],
);
pub(super) const VISCOUS_COMPONENT_GROUP: KeyGroup = by_kind(
    &[BY_COMPONENTS, KeyCondition::HasValue("tangential", &["viscous"])],
    &[DELAYED_COMPLIANCE, VISCOSITY],
);
pub(super) const PLASTIC_COMPONENT_GROUP: KeyGroup = by_kind(
    &[BY_COMPONENTS, KeyCondition::HasValue("tangential", &["plastic"])],
    &[SHEAR_STRENGTH, SLIP_HARDENING],
);
pub(super) const FRICTION_COMPONENT_GROUP: KeyGroup = by_kind(
    &[
        BY_COMPONENTS,
        KeyCondition::HasValue("normal", &["elastic"]),
        KeyCondition::HasValue("tangential", &["plastic"]),
    ],
    &[SHEAR_FRICTION],
);

/// Builds the key of a constant of a kind of layer; `example` is its example or default, as TOML.
const fn constant(model: &'static LayerModel, name: &str, example: &'static str) -> KeySchema {
    let mut index = 0;
    // An unknown name ends the compilation: the index is out of bounds.
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
                    KeyCondition::HasValue("kind", words) => words.contains(&layer.name),
                    KeyCondition::HasValue("normal", words) => {
                        by_components && words.contains(&components[0])
                    }
                    KeyCondition::HasValue("tangential", words) => {
                        by_components && words.contains(&components[1])
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
