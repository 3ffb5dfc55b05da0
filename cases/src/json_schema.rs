//! JSON Schema of case files (draft 2020-12), for completion and validation in editors.
//!
//! The schema accepts every case that the program accepts, except a number out of range that is replaced only by a map
//! sweep. It rejects wrong types, numbers out of range and unknown names as well as missing and unknown keys, for each
//! kind of model. Relations between numbers are checked by the program only.

mod conditional;
mod equations;
mod overview;
mod plane_waves;
mod value_types;

use crate::dynamics::stress;
use crate::equations::EQUATIONS_KIND;
use crate::keys::{Key, Presence, keys};
use crate::kind::{MediumKind, ModelKind, NO_YIELD_NAME};
use crate::schema::{
    KeyCondition, KeyPresence, KeySchema, SchemaScope, TableLayout, TableSchema, ValueType,
};
use crate::section_schemas::{CASE_SCHEMAS, simulation_schemas};
use crate::value::parse_text;
use conditional::{ConditionalSchemas, state_additional_properties};
use equations::build_equations_schema;
use models::registry;
use overview::build_root_properties;
use plane_waves::add_plane_wave_sections;
use serde_json::{Map, Value, json};
use toml::de::DeValue;
use value_types::{build_range_schema, build_type_schema};

/// Builds the JSON Schema of case files.
pub fn generate_json_schema() -> Value {
    let mut properties = Map::new();
    let mut branches = ConditionalSchemas::default();
    for key in keys() {
        add_scalar_key(key, &mut properties, &mut branches);
    }
    for section in ["model", "background", "yield", "stress", "wave", "map", "compare"] {
        properties.entry(section).or_insert_with(|| build_object_schema(Map::new(), Vec::new()));
    }
    properties
        .insert("check".into(), build_table_schema(&crate::check::SCHEMA, &SchemaScope::default()));
    let rheology_sections = add_rheology_sections(&mut properties, &mut branches);
    for kind in ModelKind::all_kinds() {
        let sets: Vec<&str> = kind.admissible_yield_sets().iter().map(|set| set.name).collect();
        let schema = match sets.is_empty() {
            true => json!(false),
            false => json!({ "properties": { "kind": { "enum": sets } } }),
        };
        let then =
            branches.requirements_under(build_value_condition("model", "kind", &[kind.name()]));
        object_entry(then, "properties").insert("yield".into(), schema);
    }
    add_plane_wave_sections(&mut properties, &mut branches);
    add_dimension_conditions(&mut branches);
    let mut definitions = Map::new();
    for (name, kinds) in [("solid", ModelKind::solid_kinds()), ("flow", ModelKind::flow_kinds())] {
        add_simulation_sections(name, &kinds, &mut properties, &mut branches, &mut definitions);
    }
    let equations = build_equations_schema(&properties);
    let root = build_root_properties(&properties, &equations, &definitions);
    let mut schema = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "wellposed case",
        "description": "A case file of wellposed. SI units; angles in degrees.",
        "type": "object",
        "properties": root,
        "additionalProperties": false,
        "if": build_value_condition("model", "kind", &[EQUATIONS_KIND]),
        "then": equations,
        "else": {
            "properties": properties,
            "anyOf": [{ "required": ["model"] }, { "required": rheology_sections }],
            "dependentRequired": { "stress": ["yield"] },
            "additionalProperties": false,
            "allOf": branches.into_if_then_list(),
        },
        "$defs": definitions,
    });
    state_additional_properties(&mut schema);
    schema
}

/// Adds the sections of rheological schemes, which exclude all other sections; returns their names.
fn add_rheology_sections(
    properties: &mut Map<String, Value>,
    branches: &mut ConditionalSchemas,
) -> Vec<&'static str> {
    let names: Vec<&str> = CASE_SCHEMAS.rheology.iter().map(|own| own.name).collect();
    for table_schema in CASE_SCHEMAS.rheology {
        let schema = build_table_schema(table_schema, &SchemaScope::default());
        properties.insert(table_schema.name.to_owned(), schema);
        let then = branches.requirements_under(json!({ "required": [table_schema.name] }));
        then.insert("required".into(), json!(names));
        let allowed: Vec<&str> = ["title", "name"].into_iter().chain(names.clone()).collect();
        then.insert("propertyNames".into(), json!({ "enum": allowed }));
    }
    names
}

/// Adds the conditions that a solid, its yield set and its grid have the same number of dimensions.
fn add_dimension_conditions(branches: &mut ConditionalSchemas) {
    let in_model = |dimensions: usize| {
        json!({
            "properties": { "model": { "properties": { "dimensions": { "const": dimensions } }, "required": ["dimensions"] } },
            "required": ["model"],
        })
    };
    let mut ask = |condition: Value, section: &str, key: &str, schema: Value| {
        let then = branches.requirements_under(condition);
        let table = object_entry(object_entry(then, "properties"), section);
        object_entry(table, "properties").insert(key.to_owned(), schema);
    };
    ask(in_model(2), "grid", "cells", json!({ "maxItems": 2 }));
    ask(in_model(3), "grid", "cells", json!({ "minItems": 3 }));
    let sets = registry::yield_sets();
    let sets: Vec<&str> = sets.iter().filter(|set| set.is_plane).map(|set| set.name).collect();
    let of_plane = build_value_condition("yield", "kind", &sets);
    ask(of_plane.clone(), "model", "dimensions", json!({ "const": 2 }));
    ask(of_plane, "grid", "cells", json!({ "maxItems": 2 }));
    let solids = registry::solids();
    let solids: Vec<&str> = solids.iter().filter(|own| own.is_plane).map(|own| own.name).collect();
    ask(build_value_condition("model", "kind", &solids), "grid", "cells", json!({ "maxItems": 2 }));
    // Blocks are in plane strain.
    let then = branches.requirements_under(in_model(3));
    object_entry(then, "properties").insert("block".into(), json!(false));
}

/// Returns the object `name` in `map`, created if absent.
fn object_entry<'a>(map: &'a mut Map<String, Value>, name: &str) -> &'a mut Map<String, Value> {
    let slot = map.entry(name).or_insert_with(|| json!({}));
    if !slot.is_object() {
        *slot = json!({});
    }
    slot.as_object_mut().expect("an object was put there")
}

/// Appends `name` to the list `list` in `map`, unless it is already in the list.
fn append_unique(map: &mut Map<String, Value>, list: &str, name: &str) {
    let slot = map.entry(list).or_insert_with(|| json!([]));
    if let Some(names) = slot.as_array_mut().filter(|names| !names.contains(&json!(name))) {
        names.push(json!(name));
    }
}

fn build_object_schema(properties: Map<String, Value>, required: Vec<&str>) -> Value {
    let mut schema = json!({ "type": "object", "properties": properties });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema["additionalProperties"] = json!(false);
    schema
}

/// Builds the condition that a key of a section has one of the values `names`.
fn build_value_condition(section: &str, key: &str, names: &[&str]) -> Value {
    json!({
        "properties": { section: { "properties": { key: { "enum": names } }, "required": [key] } },
        "required": [section],
    })
}

/// Builds the condition that the model, or for kinds of flow a model of `[compare]`, is one of `kinds` and, if `sets`
/// is not empty, that the yield set is one of `sets`.
fn build_model_condition(kinds: &[&str], sets: &[&str]) -> Value {
    let own = build_value_condition("model", "kind", kinds);
    let compared = json!({ "properties": { "compare": { "properties": { "kinds": { "contains": { "enum": kinds } } }, "required": ["kinds"] } }, "required": ["compare"] });
    let is_of_flows =
        kinds.iter().all(|name| matches!(ModelKind::from_name(name), Some(ModelKind::Flow(_))));
    let condition = if is_of_flows { json!({ "anyOf": [own, compared] }) } else { own };
    match sets {
        [] => condition,
        sets => json!({ "allOf": [condition, build_value_condition("yield", "kind", sets)] }),
    }
}

/// Returns the kinds of model and the yield sets that require the key, among `kinds` and `sets`, which use it. If
/// `sets` is not empty, all of `kinds` are returned.
fn find_requiring_models<'a>(
    key: &Key,
    kinds: Vec<&'a str>,
    sets: Vec<&'a str>,
) -> [Vec<&'a str>; 2] {
    let is_required =
        |medium: MediumKind| matches!(key.presence_for(medium), Presence::Required(_));
    let by_kind = |name: &&str| {
        ModelKind::from_name(name).is_some_and(|kind| match sets.is_empty() {
            true => is_required(kind.into()),
            false => true,
        })
    };
    let kinds: Vec<&str> = kinds.into_iter().filter(by_kind).collect();
    let by_set = |name: &&str| {
        registry::find_yield_set(name).is_some_and(|set| {
            let media = kinds.iter().filter_map(|kind| ModelKind::from_name(kind));
            let media = media.filter_map(|kind| MediumKind::new(kind, Some(set)).ok());
            media.filter(|medium| key.is_used_by(*medium)).all(is_required)
        })
    };
    let sets = sets.iter().copied().filter(by_set).collect();
    [kinds, sets]
}

/// Adds a row of the key table, with the conditions under which the key is allowed or required.
fn add_scalar_key(
    key: &'static Key,
    properties: &mut Map<String, Value>,
    branches: &mut ConditionalSchemas,
) {
    let path: Vec<&str> = key.name.split('.').collect();
    let (last, sections) = path.split_last().expect("a name has a part");
    let mut table = &mut *properties;
    for section in sections {
        let slot =
            table.entry(*section).or_insert_with(|| build_object_schema(Map::new(), Vec::new()));
        table = object_entry(slot.as_object_mut().expect("a table"), "properties");
    }
    table.insert((*last).to_owned(), build_key_schema(key));
    let kinds: Vec<&str> = ModelKind::all_kinds()
        .into_iter()
        .filter(|kind| key.is_used_by_kind(*kind))
        .map(ModelKind::name)
        .collect();
    let is_required = matches!(key.presence, Presence::Required(_));
    let (Some(section), true) = (sections.first(), !sections.is_empty()) else { return };
    if kinds.len() == ModelKind::all_kinds().len()
        || *section == "compare"
        || key.name == "yield.kind"
    {
        // A key required in its section is required for every kind of model that has the section.
        if is_required {
            let mut slot = &mut *properties;
            for (depth, section) in sections.iter().enumerate() {
                let own = object_entry(slot, section);
                let name = path[depth + 1];
                append_unique(own, "required", name);
                slot = object_entry(own, "properties");
            }
        }
        return;
    }
    let sets = key.yield_set_names();
    let forbidden =
        branches.requirements_under(json!({ "not": build_model_condition(&kinds, &sets) }));
    let table = object_entry(object_entry(forbidden, "properties"), section);
    object_entry(table, "properties").insert((*last).to_owned(), json!(false));
    let [kinds, sets] = find_requiring_models(key, kinds, sets);
    if !kinds.is_empty() && (sets.is_empty() == key.yield_set_names().is_empty()) {
        let mut condition = build_model_condition(&kinds, &sets);
        // With a section `[grid]` the number of dimensions follows from the grid.
        if key.name == "model.dimensions" {
            let grids = json!([{ "required": ["grid"] }, { "required": ["block"] }]);
            condition = json!({ "allOf": [condition, { "not": { "anyOf": grids } }] });
        }
        let then = branches.requirements_under(condition);
        append_unique(then, "required", section);
        append_unique(object_entry(object_entry(then, "properties"), section), "required", last);
    }
}

fn build_key_schema(key: &Key) -> Value {
    let mut schema = match key.value_type() {
        ValueType::Number(_) => build_range_schema(key.range),
        other => build_type_schema(&other, &SchemaScope::default()),
    };
    match key.name {
        "name" => {
            // Names of dots only are refused: `.` and `..` are existing folders.
            schema = build_type_schema(&ValueType::Name, &SchemaScope::default());
            schema["not"] = json!({ "pattern": r"^\.*$" });
        }
        "model.dimensions" => schema = json!({ "enum": [2, 3] }),
        // Lists without repetition, of at least one item.
        "yield.active" | "compare.kinds" => {
            (schema["minItems"], schema["uniqueItems"]) = (json!(1), json!(true));
        }
        _ => {}
    }
    if let Some(names) = key.allowed_names() {
        match schema.get_mut("items") {
            Some(items) => *items = json!({ "enum": names }),
            None => schema = json!({ "enum": names }),
        }
    }
    schema["title"] = json!(key.label);
    schema["description"] = json!(format_description(key.unit, key.meaning));
    if let (Presence::Default(_), Some(text)) = (key.presence, key.example_value()) {
        schema["default"] = toml_to_json(&text);
    }
    schema
}

fn format_description(unit: &str, meaning: &str) -> String {
    match unit {
        "" => meaning.to_owned(),
        unit => format!("{unit}: {meaning}"),
    }
}

/// Adds the time-domain sections of solids or flows, with one definition per number of dimensions.
fn add_simulation_sections(
    name: &str,
    kinds: &[ModelKind],
    properties: &mut Map<String, Value>,
    branches: &mut ConditionalSchemas,
    definitions: &mut Map<String, Value>,
) {
    for kind in kinds {
        let table_schemas = simulation_schemas(*kind);
        let own = build_value_condition("model", "kind", &[kind.name()]);
        for dimensions in if let ModelKind::Solid(_) = kind { 2..=3 } else { 2..=2 } {
            let then = branches.requirements_under(match kind {
                ModelKind::Solid(_) => {
                    json!({ "allOf": [own, build_dimension_condition(dimensions)] })
                }
                ModelKind::Flow(_) | ModelKind::Rheology | ModelKind::Equations => own.clone(),
            });
            let scope = SchemaScope { dimensions: Some(dimensions), ..SchemaScope::default() };
            for table_schema in &table_schemas {
                let own = format!("{name}.{}d.{}", dimensions, table_schema.name);
                let reference = json!({ "$ref": format!("#/$defs/{own}") });
                let sections = object_entry(then, "properties");
                if let Some(name) = table_schema.former_name {
                    let mut deprecated = reference.clone();
                    deprecated["deprecated"] = json!(true);
                    sections.insert(name.to_owned(), deprecated);
                }
                sections.insert(table_schema.name.to_owned(), reference);
                definitions.entry(own).or_insert_with(|| build_table_schema(table_schema, &scope));
            }
        }
        let then = branches.requirements_under(own);
        for table_schema in &table_schemas {
            let others = || {
                table_schemas
                    .iter()
                    .filter(|other| other.is_required && other.name != table_schema.name)
            };
            let needed: Vec<&str> = others()
                .filter(|other| other.alternative.is_none())
                .map(|other| other.name)
                .collect();
            for name in [table_schema.name].into_iter().chain(table_schema.former_name) {
                properties.entry(name).or_insert_with(|| json!(true));
                object_entry(then, "dependentRequired").insert(name.to_owned(), json!(needed));
                let dependent = object_entry(object_entry(then, "dependentSchemas"), name);
                for (other, section) in
                    others().filter_map(|other| Some((other, other.alternative?)))
                {
                    let either = json!([{ "required": [other.name] }, { "required": [section] }]);
                    dependent.insert("oneOf".into(), either);
                }
            }
            if let Some(name) = table_schema.former_name {
                // The section has one of both names.
                let own = object_entry(object_entry(then, "dependentSchemas"), table_schema.name);
                object_entry(own, "properties").insert(name.to_owned(), json!(false));
            }
            if table_schema.name == "joint" || table_schema.name == "region" {
                let own = object_entry(object_entry(then, "dependentSchemas"), table_schema.name);
                match table_schema.name {
                    "joint" => own.insert("required".into(), json!(["block"])),
                    _ => object_entry(own, "properties").insert("block".to_owned(), json!(false)),
                };
            }
        }
    }
    // Refuse the sections that only other kinds of model have.
    let all = ModelKind::all_kinds();
    for table_schema in all.iter().flat_map(|kind| simulation_schemas(*kind)) {
        for kind in kinds {
            if simulation_schemas(*kind).iter().all(|own| own.name != table_schema.name) {
                let then = branches.requirements_under(build_value_condition(
                    "model",
                    "kind",
                    &[kind.name()],
                ));
                let sections = object_entry(then, "properties");
                for name in [table_schema.name].into_iter().chain(table_schema.former_name) {
                    sections.insert(name.to_owned(), json!(false));
                }
            }
        }
    }
}

/// Builds the condition that the grid has 2 or 3 dimensions; grids with fewer or more entries fail both schemas.
fn build_dimension_condition(dimensions: usize) -> Value {
    let cells = match dimensions {
        2 => json!({ "maxItems": 2 }),
        // Without a section `[grid]` there are two dimensions.
        _ => {
            let grid = json!({ "properties": { "cells": { "minItems": 3 } } });
            return json!({ "properties": { "grid": grid }, "required": ["grid"] });
        }
    };
    json!({ "properties": { "grid": { "properties": { "cells": cells } } } })
}

/// Builds the schema of a table or of a list of tables.
fn build_table_schema(table_schema: &'static TableSchema, scope: &SchemaScope) -> Value {
    let mut schema = match (table_schema.groups, table_schema.named_values) {
        (_, Some(values)) => value_types::build_named_values_schema(values),
        ([], None) => build_stress_schema(),
        _ => build_keys_schema(table_schema, scope),
    };
    schema["description"] = json!(table_schema.meaning);
    match table_schema.layout {
        TableLayout::List => {
            json!({ "type": "array", "items": schema, "minItems": usize::from(table_schema.is_required) })
        }
        TableLayout::Section | TableLayout::InlineTable => schema,
    }
}

/// Builds the schema of the table `initial_stress`, whose keys are stress components.
fn build_stress_schema() -> Value {
    let stresses = stress::stress_components().map(|component| {
        let schema = json!({ "type": "number", "description": stress::stress_unit(component) });
        (component.to_string(), schema)
    });
    build_object_schema(stresses.collect(), Vec::new())
}

fn build_keys_schema(table_schema: &'static TableSchema, scope: &SchemaScope) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    let mut branches = ConditionalSchemas::default();
    // Conditions under which each key is allowed.
    let mut allowed: Vec<(&str, Vec<Value>)> = Vec::new();
    for (when, item) in table_schema.keys() {
        let is_elsewhere =
            |own: &&KeyCondition| evaluate_dimension_condition(own, scope) == Some(false);
        if when.iter().chain(item.conditions).any(|own| is_elsewhere(&own)) {
            continue;
        }
        let is_open = |own: &&KeyCondition| evaluate_dimension_condition(own, scope).is_none();
        let conditions: Vec<&KeyCondition> =
            when.iter().chain(item.conditions).filter(is_open).collect();
        let known: Vec<Value> =
            conditions.iter().filter_map(|own| build_key_condition(own)).collect();
        // Conditions on the dimensions cannot be evaluated inside the table if the dimensions are unknown.
        let is_everywhere = known.len() == conditions.len();
        let is_required = matches!(item.presence, KeyPresence::Required(_)) && is_everywhere;
        if known.is_empty() && item.former_name.is_none() {
            merge_key_schema(&mut properties, item, scope);
            if is_required {
                required.push(item.name);
            }
            continue;
        }
        for name in [item.name].into_iter().chain(item.former_name) {
            properties.entry(name).or_insert_with(|| json!({}));
        }
        let condition = match &known[..] {
            [] => json!(true),
            [one] => one.clone(),
            all => json!({ "allOf": all }),
        };
        match allowed.iter_mut().find(|(name, _)| *name == item.name) {
            Some((_, all)) if all.contains(&condition) => {}
            Some((_, all)) => all.push(condition.clone()),
            None => allowed.push((item.name, vec![condition.clone()])),
        }
        let then = branches.requirements_under(condition);
        merge_key_schema(object_entry(then, "properties"), item, scope);
        match item.former_name {
            Some(name) => add_former_name(then, item, name, is_required),
            None if is_required => append_unique(then, "required", item.name),
            None => {}
        }
    }
    for (name, conditions) in allowed {
        let then = branches.requirements_under(json!({ "not": { "anyOf": conditions } }));
        let renamed = table_schema.renamed_keys().filter(|(_, current_name)| *current_name == name);
        for name in renamed.map(|(former_name, _)| former_name).chain([name]) {
            object_entry(then, "properties").insert(name.to_owned(), json!(false));
        }
    }
    let mut schema = build_object_schema(properties, required);
    let branches = branches.into_if_then_list();
    if !branches.is_empty() {
        schema["allOf"] = json!(branches);
    }
    schema
}

/// Adds the former name of a key to the requirements `then`, which have the key with its current name. A table has one
/// of both names.
fn add_former_name(
    then: &mut Map<String, Value>,
    item: &KeySchema,
    former_name: &str,
    is_required: bool,
) {
    let properties = object_entry(then, "properties");
    let mut deprecated = properties[item.name].clone();
    deprecated["deprecated"] = json!(true);
    properties.insert(former_name.to_owned(), deprecated);
    let (former, current) =
        (json!({ "required": [former_name] }), json!({ "required": [item.name] }));
    match is_required {
        true => then.insert("oneOf".into(), json!([current, former])),
        false => then.insert("not".into(), json!({ "required": [former_name, item.name] })),
    };
}

/// Adds a key; a key whose type depends on the dimensions accepts each of its types.
fn merge_key_schema(properties: &mut Map<String, Value>, item: &KeySchema, scope: &SchemaScope) {
    let schema = build_section_key_schema(item, scope);
    let merged = match properties.remove(item.name) {
        Some(other) if other != json!({}) => json!({ "anyOf": [other, schema] }),
        _ => schema,
    };
    properties.insert(item.name.to_owned(), merged);
}

/// Returns whether a condition on the dimensions holds; `None` if the dimensions are unknown, and for other conditions.
fn evaluate_dimension_condition(condition: &KeyCondition, scope: &SchemaScope) -> Option<bool> {
    match condition {
        KeyCondition::PlaneStrain => Some(scope.dimensions? == 2),
        KeyCondition::Space => Some(scope.dimensions? == 3),
        _ => None,
    }
}

fn build_key_condition(condition: &KeyCondition) -> Option<Value> {
    match condition {
        KeyCondition::HasValue(key, names) => Some(json!({
            "properties": { *key: { "enum": names } },
            "required": [key],
        })),
        KeyCondition::Present(key) => Some(json!({ "required": [key] })),
        KeyCondition::Absent(key) => Some(json!({ "not": { "required": [key] } })),
        KeyCondition::PlaneStrain | KeyCondition::Space => None,
    }
}

fn build_section_key_schema(item: &KeySchema, scope: &SchemaScope) -> Value {
    let mut schema = build_type_schema(&item.value_type, scope);
    schema["description"] = json!(format_description(item.unit, item.meaning));
    match item.presence {
        KeyPresence::Default(text) => schema["default"] = toml_to_json(text),
        KeyPresence::Required(text) | KeyPresence::Optional(text) => {
            schema["examples"] = json!([toml_to_json(text)])
        }
    }
    schema
}

/// Converts a TOML value, given as text, to JSON.
fn toml_to_json(toml: &str) -> Value {
    fn convert(value: &DeValue) -> Value {
        match value {
            DeValue::Boolean(truth) => json!(truth),
            DeValue::Array(array) => array.iter().map(|item| convert(item.get_ref())).collect(),
            DeValue::Table(table) => table
                .iter()
                .map(|(key, value)| (key.get_ref().to_string(), convert(value.get_ref())))
                .collect::<Map<String, Value>>()
                .into(),
            DeValue::Integer(_) => json!(crate::value::parse_integer(value)),
            _ => match (parse_text(value), crate::value::parse_number(value)) {
                (Some(text), _) => json!(text),
                (None, number) => json!(number),
            },
        }
    }
    DeValue::parse(toml).map_or(Value::Null, |value| convert(value.get_ref()))
}

/// Builds the schema of a table with the keys of a section that at least one solid uses.
fn build_section_schema(section: &str) -> Value {
    let is_of_solid =
        |key: &&Key| ModelKind::solid_kinds().iter().any(|own| key.is_used_by_kind(*own));
    let own = keys().iter().filter(|key| key.split_section().0 == section).filter(is_of_solid);
    let mut properties = Map::new();
    for key in own {
        let mut schema = build_key_schema(key);
        if key.name == "yield.kind"
            && let Some(names) = schema.get_mut("enum").and_then(Value::as_array_mut)
        {
            names.push(json!(NO_YIELD_NAME));
        }
        properties.insert(key.split_section().1.to_owned(), schema);
    }
    build_object_schema(properties, Vec::new())
}
