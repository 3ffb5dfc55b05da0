//! Bundled case files, and conversion of TOML to JSON, for tests of the JSON Schema.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Converts a TOML value to JSON; dates become texts.
pub fn toml_to_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => json!(text),
        toml::Value::Integer(number) => json!(number),
        toml::Value::Float(number) => json!(number),
        toml::Value::Boolean(boolean) => json!(boolean),
        toml::Value::Datetime(date) => json!(date.to_string()),
        toml::Value::Array(items) => items.iter().map(toml_to_json).collect(),
        toml::Value::Table(table) => {
            let pairs = table.iter().map(|(key, value)| (key.clone(), toml_to_json(value)));
            Value::Object(pairs.collect())
        }
    }
}

/// Returns the paths of the bundled case files, sorted.
pub fn bundled_case_files() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    wellposed_cases::CASES.iter().map(|(path, _)| root.join(path)).collect()
}
