//! Properties at the root of the JSON Schema: the keys of all kinds of model together. Editors complete and explain keys by
//! them, since they do not look into `then` and `else` of the root. They accept whatever one of the kinds accepts.

use serde_json::{Map, Value, json};

/// Builds the properties of the root from those of cases with and without equations. A section of simulations is one of
/// its definitions, which are named by medium, dimensions and section.
pub(super) fn build_root_properties(
    without_equations: &Map<String, Value>,
    with_equations: &Value,
    definitions: &Map<String, Value>,
) -> Map<String, Value> {
    let mut properties = without_equations.clone();
    for (name, schema) in with_equations["properties"].as_object().into_iter().flatten() {
        let merged = match properties.get(name) {
            Some(other) => merge_schemas(other, schema),
            None => schema.clone(),
        };
        properties.insert(name.clone(), merged);
    }
    for (name, schema) in &mut properties {
        let own = definitions.keys().filter(|own| own.rsplit('.').next() == Some(name));
        let own: Vec<Value> = own.map(|own| json!({ "$ref": format!("#/$defs/{own}") })).collect();
        if !own.is_empty() {
            *schema = json!({ "anyOf": own });
        }
    }
    properties
}

/// Merges two schemas into one that accepts whatever one of them accepts; tables are merged key by key.
fn merge_schemas(one: &Value, other: &Value) -> Value {
    let tables = (one["properties"].as_object(), other["properties"].as_object());
    match (one, other, tables) {
        (one, other, _) if one == other => one.clone(),
        (Value::Bool(false), schema, _) | (schema, Value::Bool(false), _) => schema.clone(),
        (Value::Bool(true), ..) | (_, Value::Bool(true), _) => json!(true),
        (_, _, (Some(keys), Some(other_keys))) => {
            let mut properties = keys.clone();
            for (name, schema) in other_keys {
                let merged =
                    keys.get(name).map_or(schema.clone(), |own| merge_schemas(own, schema));
                properties.insert(name.clone(), merged);
            }
            let is_closed = [one, other].iter().all(|own| own["additionalProperties"] == false);
            json!({ "type": "object", "properties": properties, "additionalProperties": !is_closed })
        }
        _ => json!({ "anyOf": [one, other] }),
    }
}
