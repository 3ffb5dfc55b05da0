//! Keys of the section `[rheology]`, from the parameters of the named schemes and of the elements.

use crate::schema::{
    KeyCondition, KeyGroup, KeyPresence, KeySchema, SchemaScope, TableSchema, ValueType,
};
use models::common::parameter::{Parameter, Presence};
use models::rheology::{element, named};

/// Key of the kind of a scheme or of an element.
pub(super) const KIND_KEY: &str = "kind";
/// Key of the tree.
pub(super) const TREE_KEY: &str = "tree";
/// Key of the list of elements.
pub(super) const ELEMENT_KEY: &str = "element";
/// Key of the name of an element.
pub(super) const NAME_KEY: &str = "name";

/// Returns the allowed names of the kind of a scheme.
pub(super) fn kind_names() -> Vec<String> {
    let named = named::NAMED_SCHEMES.iter().map(|scheme| scheme.name);
    named.chain([super::TREE_KIND]).map(str::to_owned).collect()
}

/// Returns the allowed names of the kind of an element.
pub(super) fn element_kind_names() -> Vec<String> {
    [element::SPRING, element::DAMPER, element::HINGE, element::CONTACT].map(str::to_owned).to_vec()
}

/// Builds the key of a parameter; `example` is its example or default, as TOML.
const fn new_key(parameter: &Parameter, example: &'static str) -> KeySchema {
    let key = KeySchema::new_required(
        parameter.name,
        ValueType::Number(parameter.range),
        parameter.unit,
        example,
        parameter.meaning,
    );
    match parameter.presence {
        Presence::Default(_) => KeySchema { presence: KeyPresence::Default(example), ..key },
        Presence::Required(_) | Presence::Optional => key,
    }
}

/// Builds a group of keys of schemes of these kinds.
const fn new_group(conditions: &'static [KeyCondition], keys: &'static [KeySchema]) -> KeyGroup {
    KeyGroup::with_conditions(conditions, keys)
}

/// Schema of the table `element` of the section `[rheology]`.
pub(super) const ELEMENT_SCHEMA: TableSchema = TableSchema::new_inline_table(
    ELEMENT_KEY,
    "element of a rheological tree",
    &[
        KeyGroup::new(&[
            KeySchema::new_required(
                NAME_KEY,
                ValueType::Text,
                "",
                "\"skeleton\"",
                "name in the tree: a letter, then letters, digits and _",
            ),
            KeySchema::new_required(
                KIND_KEY,
                ValueType::OneOf(|_: &SchemaScope| element_kind_names()),
                "",
                "\"spring\"",
                "spring, σ = Eε; damper, σ = η dε/dt; hinge, −σ⁻ ≤ σ ≤ σ⁺; contact, σ ≤ 0 and ε + θ ≥ 0",
            ),
        ]),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &[element::SPRING])],
            &[new_key(&element::MODULUS, "1e6")],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &[element::DAMPER])],
            &[new_key(&element::VISCOSITY, "1e5")],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &[element::HINGE])],
            &[
                new_key(&element::COMPRESSIVE_YIELD_STRESS, "1e4"),
                new_key(&element::TENSILE_YIELD_STRESS, "1e4"),
            ],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &[element::CONTACT])],
            &[new_key(&element::GAP, "0.0")],
        ),
    ],
);

/// Schema of the section `[rheology]`.
pub(super) const RHEOLOGY_SCHEMA: TableSchema = TableSchema {
    // Not in a simulation.
    is_required: false,
    ..TableSchema::new_section(
    "rheology",
    "rheological scheme of wellposed diagram, in place of a model: a named scheme with its constants, or a tree of elements",
    &[
        KeyGroup::new(&[KeySchema::new_required(
            KIND_KEY,
            ValueType::OneOf(|_: &SchemaScope| kind_names()),
            "",
            "\"porous-plastic\"",
            "name of the scheme, or tree",
        )]),
        new_group(
            &[KeyCondition::HasValue(
                KIND_KEY,
                &[
                    "granular-elastic",
                    "granular-plastic",
                    "granular-maxwell",
                    "granular-kelvin-voigt",
                    "poynting-thomson",
                ],
            )],
            &[new_key(&element::MODULUS, "1e6")],
        ),
        new_group(
            &[KeyCondition::HasValue(
                KIND_KEY,
                &["heteromodular", "porous-elastic", "porous-plastic", "porous-viscoplastic"],
            )],
            &[new_key(&named::SKELETON_MODULUS, "1e6"), new_key(&named::CONTACT_MODULUS, "3e6")],
        ),
        new_group(
            &[KeyCondition::HasValue(
                KIND_KEY,
                &["porous-elastic", "porous-plastic", "porous-viscoplastic"],
            )],
            &[new_key(&named::POROSITY, "0.02")],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &["porous-plastic", "porous-viscoplastic"])],
            &[
                new_key(&element::COMPRESSIVE_YIELD_STRESS, "1e4"),
                new_key(&element::TENSILE_YIELD_STRESS, "1e4"),
            ],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &["granular-plastic"])],
            &[new_key(&named::YIELD_STRESS, "1e4")],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &["poynting-thomson"])],
            &[new_key(&named::DELAYED_MODULUS, "1e6")],
        ),
        new_group(
            &[KeyCondition::HasValue(
                KIND_KEY,
                &[
                    "granular-maxwell",
                    "granular-kelvin-voigt",
                    "porous-viscoplastic",
                    "poynting-thomson",
                ],
            )],
            &[new_key(&element::VISCOSITY, "1e5")],
        ),
        new_group(
            &[KeyCondition::HasValue(KIND_KEY, &[super::TREE_KIND])],
            &[
                KeySchema::new_required(
                    TREE_KEY,
                    ValueType::Text,
                    "",
                    "\"skeleton | (particles - pores)\"",
                    "names of the elements, joined by - in series and by | in parallel; each branch that is joined the other way is in parentheses",
                ),
                KeySchema::new_required(
                    ELEMENT_KEY,
                    ValueType::TableList(&ELEMENT_SCHEMA),
                    "",
                    "[{ name = \"skeleton\", kind = \"spring\", modulus = 1e6 }, { name = \"particles\", kind = \"spring\", modulus = 3e6 }, { name = \"pores\", kind = \"contact\", gap = 0.02 }]",
                    "elements of the tree, also as sections [[rheology.element]]",
                ),
            ],
        ),
    ],
)
.with_remedy("[rheology] with the kind of a scheme, and [load_path]")
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Every named scheme has the keys of its parameters, with their examples, and no others.
    #[test]
    fn keys_of_named_schemes_are_their_parameters() {
        for scheme in named::NAMED_SCHEMES {
            let holds = |condition: &KeyCondition| match condition {
                KeyCondition::HasValue(_, names) => names.contains(&scheme.name),
                _ => false,
            };
            let mut keys: Vec<(&str, &str, f64)> = RHEOLOGY_SCHEMA
                .applicable_keys(holds)
                .filter(|key| key.name != KIND_KEY)
                .map(|key| (key.name, key.meaning, key.example_value().parse().expect("a number")))
                .collect();
            let mut parameters: Vec<(&str, &str, f64)> = scheme
                .parameters
                .iter()
                .map(|own| (own.name, own.meaning, own.example_value()))
                .collect();
            keys.sort_by_key(|own| own.0);
            parameters.sort_by_key(|own| own.0);
            assert_eq!(keys, parameters, "{}", scheme.name);
        }
    }
}
