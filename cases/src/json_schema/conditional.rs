//! Conditional parts of the JSON Schema.

use serde_json::{Map, Value, json};

/// Conditional parts of the schema (`if`/`then`): each condition occurs once, with all its requirements.
#[derive(Default)]
pub(super) struct ConditionalSchemas(Vec<(Value, Map<String, Value>)>);

impl ConditionalSchemas {
    /// Returns the requirements under a condition, created if absent.
    pub(super) fn requirements_under(&mut self, condition: Value) -> &mut Map<String, Value> {
        let index = self.0.iter().position(|(own, _)| *own == condition).unwrap_or_else(|| {
            self.0.push((condition, Map::new()));
            self.0.len() - 1
        });
        &mut self.0[index].1
    }

    /// Returns the conditions and requirements as `allOf` takes them.
    pub(super) fn into_if_then_list(self) -> Vec<Value> {
        self.0.into_iter().map(|(own, then)| json!({ "if": own, "then": then })).collect()
    }
}

/// States `additionalProperties: true`, the default, in the conditional parts of the schema: the linter Tombi otherwise
/// warns about each key that a part does not name.
pub(super) fn state_additional_properties(schema: &mut Value) {
    match schema {
        Value::Object(map) => {
            map.values_mut().for_each(state_additional_properties);
            if map.get("properties").is_some_and(Value::is_object) {
                map.entry("additionalProperties").or_insert(json!(true));
            }
        }
        Value::Array(items) => items.iter_mut().for_each(state_additional_properties),
        _ => {}
    }
}
