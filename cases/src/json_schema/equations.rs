//! JSON Schema of cases whose model is given as equations.

use super::{build_object_schema, build_table_schema};
use crate::schema::SchemaScope;
use crate::section_schemas::EQUATION_CASE_SCHEMAS;
use serde_json::{Map, Value, json};

/// Builds the schema of cases whose model is given as equations, with the keys before the first section from
/// `properties`.
pub(super) fn build_equations_schema(properties: &Map<String, Value>) -> Value {
    let mut own = Map::new();
    for name in ["title", "name", "check"] {
        own.insert(name.to_owned(), properties.get(name).cloned().unwrap_or(json!(true)));
    }
    for table_schema in EQUATION_CASE_SCHEMAS.equations {
        let schema = build_table_schema(table_schema, &SchemaScope::default());
        own.insert(table_schema.name.to_owned(), schema);
    }
    build_object_schema(own, vec!["model"])
}
