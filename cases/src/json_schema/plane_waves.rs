//! JSON Schema of the sections of plane waves in granular and porous media.

use super::{ConditionalSchemas, build_table_schema, object_entry};
use crate::plane_wave::{ELASTIC_KIND, PLANE_WAVE_SCHEMAS};
use crate::schema::SchemaScope;
use serde_json::{Map, Value, json};

/// Adds the sections of granular and porous media and of plane waves: one medium, on a classical solid without yield set,
/// with a load or in a grid.
pub(super) fn add_plane_wave_sections(
    properties: &mut Map<String, Value>,
    branches: &mut ConditionalSchemas,
) {
    for table_schema in PLANE_WAVE_SCHEMAS {
        let schema = build_table_schema(table_schema, &SchemaScope::default());
        properties.insert(table_schema.name.into(), schema);
        let then = branches.requirements_under(json!({ "required": [table_schema.name] }));
        let own = object_entry(then, "properties");
        own.insert("model".into(), json!({ "properties": { "kind": { "const": ELASTIC_KIND } } }));
        for other in ["yield", "joint"] {
            own.insert(other.into(), json!(false));
        }
        own.insert("initial_stress".into(), json!({ "additionalProperties": { "const": 0 } }));
    }
    let require_any = |sections: &[&str]| {
        let each: Vec<Value> = sections.iter().map(|name| json!({ "required": [name] })).collect();
        json!(each)
    };
    for (section, excluded, needed) in [
        ("granular", ["porous"].as_slice(), ["piston", "spall", "grid", "block"].as_slice()),
        ("porous", &["granular", "spall"], &["piston", "grid", "block"]),
        ("piston", &[], &["granular", "porous"]),
        ("spall", &[], &["granular"]),
    ] {
        let then = branches.requirements_under(json!({ "required": [section] }));
        for other in excluded {
            object_entry(then, "properties").insert((*other).into(), json!(false));
        }
        then.insert("anyOf".into(), require_any(needed));
    }
    let then = branches.requirements_under(json!({ "required": ["porous"] }));
    let loosening = json!({ "properties": { "loosening": { "const": 0 } } });
    object_entry(then, "properties").insert("piston".into(), loosening);
}
