//! JSON Schema of case files (draft 2020-12), for completion and validation in editors.
//!
//! The schema accepts every case that the program accepts, except a number out of range that is replaced only by a map
//! sweep. It rejects wrong types, ranges and words as well as missing and unknown keys, for each kind of model.
//! Relations between numbers are checked by the program only.

use crate::dynamics::stress;
use crate::forms::forms_in_time;
use crate::keys::{Key, Presence, keys};
use crate::kind::{Kind, Medium, NO_YIELD};
use crate::schema::{Condition, Form, Item, Layout, Length, Need, Order, Range, Scope, Type};
use crate::types::MAX_NAME;
use crate::value::text;
use models::registry;
use serde_json::{Map, Value, json};
use toml::de::DeValue;

/// Builds the JSON Schema of case files.
pub fn json_schema() -> Value {
    let mut properties = Map::new();
    let mut branches = Branches::default();
    for key in keys() {
        add_key(key, &mut properties, &mut branches);
    }
    for section in ["model", "background", "yield", "stress", "wave", "map", "compare"] {
        properties.entry(section).or_insert_with(|| object(Map::new(), Vec::new()));
    }
    properties.insert("check".into(), of_form(&crate::check::FORM, &Scope::default()));
    for kind in Kind::all() {
        let sets: Vec<&str> = kind.yield_sets().iter().map(|set| set.name).collect();
        let schema = match sets.is_empty() {
            true => json!(false),
            false => json!({ "properties": { "kind": { "enum": sets } } }),
        };
        let then = branches.under(is_one("model", "kind", &[kind.name()]));
        inside(then, "properties").insert("yield".into(), schema);
    }
    add_dimensions(&mut branches);
    let mut definitions = Map::new();
    for (name, kinds) in [("solid", Kind::solids()), ("flow", Kind::flows())] {
        add_forms(name, &kinds, &mut properties, &mut branches, &mut definitions);
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "wellposed case",
        "description": "A case file of wellposed. SI units; angles in degrees.",
        "type": "object",
        "properties": properties,
        "required": ["model"],
        "dependentRequired": { "stress": ["yield"] },
        "additionalProperties": false,
        "allOf": branches.into_list(),
        "$defs": definitions,
    })
}

/// Adds the conditions that a solid, its yield set and its grid have the same number of dimensions.
fn add_dimensions(branches: &mut Branches) {
    let in_model = |dimensions: usize| {
        json!({
            "properties": { "model": { "properties": { "dimensions": { "const": dimensions } }, "required": ["dimensions"] } },
            "required": ["model"],
        })
    };
    let mut ask = |condition: Value, section: &str, key: &str, schema: Value| {
        let then = branches.under(condition);
        let table = inside(inside(then, "properties"), section);
        inside(table, "properties").insert(key.to_owned(), schema);
    };
    ask(in_model(2), "grid", "cells", json!({ "maxItems": 2 }));
    ask(in_model(3), "grid", "cells", json!({ "minItems": 3 }));
    let sets = registry::yield_sets();
    let sets: Vec<&str> = sets.iter().filter(|set| set.is_plane).map(|set| set.name).collect();
    let of_plane = is_one("yield", "kind", &sets);
    ask(of_plane.clone(), "model", "dimensions", json!({ "const": 2 }));
    ask(of_plane, "grid", "cells", json!({ "maxItems": 2 }));
    let solids = registry::solids();
    let solids: Vec<&str> = solids.iter().filter(|own| own.is_plane).map(|own| own.name).collect();
    ask(is_one("model", "kind", &solids), "grid", "cells", json!({ "maxItems": 2 }));
}

/// Conditional parts of the schema (`if`/`then`): each condition occurs once, with all its requirements.
#[derive(Default)]
struct Branches(Vec<(Value, Map<String, Value>)>);

impl Branches {
    /// Returns the requirements under a condition, created if absent.
    fn under(&mut self, condition: Value) -> &mut Map<String, Value> {
        let place = self.0.iter().position(|(own, _)| *own == condition).unwrap_or_else(|| {
            self.0.push((condition, Map::new()));
            self.0.len() - 1
        });
        &mut self.0[place].1
    }

    fn into_list(self) -> Vec<Value> {
        self.0.into_iter().map(|(own, then)| json!({ "if": own, "then": then })).collect()
    }
}

/// Returns the object `name` in `map`, created if absent.
fn inside<'a>(map: &'a mut Map<String, Value>, name: &str) -> &'a mut Map<String, Value> {
    let slot = map.entry(name).or_insert_with(|| json!({}));
    if !slot.is_object() {
        *slot = json!({});
    }
    slot.as_object_mut().expect("an object was put there")
}

/// Appends `name` to the list `list` in `map`, unless it is already in the list.
fn append(map: &mut Map<String, Value>, list: &str, name: &str) {
    let slot = map.entry(list).or_insert_with(|| json!([]));
    if let Some(names) = slot.as_array_mut().filter(|names| !names.contains(&json!(name))) {
        names.push(json!(name));
    }
}

fn object(properties: Map<String, Value>, required: Vec<&str>) -> Value {
    let mut schema = json!({ "type": "object", "properties": properties });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema["additionalProperties"] = json!(false);
    schema
}

/// Builds the condition that a key of a section has one of the values `words`.
fn is_one(section: &str, key: &str, words: &[&str]) -> Value {
    json!({
        "properties": { section: { "properties": { key: { "enum": words } }, "required": [key] } },
        "required": [section],
    })
}

/// Builds the condition that the model, or a flow of `[compare]`, is one of `kinds` and, if `sets` is not empty, that
/// the yield set is one of `sets`.
fn has_one(kinds: &[&str], sets: &[&str]) -> Value {
    let own = is_one("model", "kind", kinds);
    let compared = json!({ "properties": { "compare": { "properties": { "kinds": { "contains": { "enum": kinds } } }, "required": ["kinds"] } }, "required": ["compare"] });
    let is_of_flows = kinds.iter().all(|name| matches!(Kind::from_name(name), Some(Kind::Flow(_))));
    let condition = if is_of_flows { json!({ "anyOf": [own, compared] }) } else { own };
    match sets {
        [] => condition,
        sets => json!({ "allOf": [condition, is_one("yield", "kind", sets)] }),
    }
}

/// Returns the kinds of model and the yield sets that require the key.
fn requiring<'a>(key: &Key, kinds: Vec<&'a str>, sets: Vec<&'a str>) -> [Vec<&'a str>; 2] {
    let is_required = |medium: Medium| matches!(key.presence_for(medium), Presence::Required(_));
    let by_kind = |name: &&str| {
        Kind::from_name(name).is_some_and(|kind| match sets.is_empty() {
            true => is_required(kind.into()),
            false => true,
        })
    };
    let kinds: Vec<&str> = kinds.into_iter().filter(by_kind).collect();
    let by_set = |name: &&str| {
        registry::yield_set(name).is_some_and(|set| {
            let media = kinds.iter().filter_map(|kind| Kind::from_name(kind));
            let media = media.filter_map(|kind| Medium::new(kind, Some(set)).ok());
            media.filter(|medium| key.is_used_by(*medium)).all(is_required)
        })
    };
    let sets = sets.iter().copied().filter(by_set).collect();
    [kinds, sets]
}

/// Adds a row of the key table, with the conditions under which the key is allowed or required.
fn add_key(key: &'static Key, properties: &mut Map<String, Value>, branches: &mut Branches) {
    let path: Vec<&str> = key.name.split('.').collect();
    let (last, sections) = path.split_last().expect("a name has a part");
    let mut table = &mut *properties;
    for section in sections {
        let slot = table.entry(*section).or_insert_with(|| object(Map::new(), Vec::new()));
        table = inside(slot.as_object_mut().expect("a table"), "properties");
    }
    table.insert((*last).to_owned(), of_key(key));
    let kinds: Vec<&str> =
        Kind::all().into_iter().filter(|kind| key.is_for(*kind)).map(Kind::name).collect();
    let is_required = matches!(key.presence, Presence::Required(_));
    let (Some(section), true) = (sections.first(), !sections.is_empty()) else { return };
    if kinds.len() == Kind::all().len() || *section == "compare" || key.name == "yield.kind" {
        // Required in its section, whatever the kind of model.
        if is_required {
            let mut slot = &mut *properties;
            for (depth, section) in sections.iter().enumerate() {
                let own = inside(slot, section);
                let name = path[depth + 1];
                append(own, "required", name);
                slot = inside(own, "properties");
            }
        }
        return;
    }
    let sets = key.set_names();
    let forbidden = branches.under(json!({ "not": has_one(&kinds, &sets) }));
    let table = inside(inside(forbidden, "properties"), section);
    inside(table, "properties").insert((*last).to_owned(), json!(false));
    let [kinds, sets] = requiring(key, kinds, sets);
    if !kinds.is_empty() && (sets.is_empty() == key.set_names().is_empty()) {
        let mut condition = has_one(&kinds, &sets);
        // With a section `[grid]` the number of dimensions follows from the grid.
        if key.name == "model.dimensions" {
            condition = json!({ "allOf": [condition, { "not": { "required": ["grid"] } }] });
        }
        let then = branches.under(condition);
        append(then, "required", section);
        append(inside(inside(then, "properties"), section), "required", last);
    }
}

fn of_key(key: &Key) -> Value {
    let mut schema = match key.value_type() {
        Type::Number(_) => of_range(key.range),
        other => of_type(&other, &Scope::default()),
    };
    match key.name {
        "name" => {
            // Dots alone are names of existing folders.
            schema = of_type(&Type::Name, &Scope::default());
            schema["not"] = json!({ "pattern": r"^\.*$" });
        }
        "model.dimensions" => schema = json!({ "enum": [2, 3] }),
        // Lists without repetition, of at least one item.
        "yield.active" | "compare.kinds" => {
            (schema["minItems"], schema["uniqueItems"]) = (json!(1), json!(true));
        }
        _ => {}
    }
    if let Some(words) = key.words() {
        match schema.get_mut("items") {
            Some(items) => *items = json!({ "enum": words }),
            None => schema = json!({ "enum": words }),
        }
    }
    schema["title"] = json!(key.label);
    schema["description"] = json!(description(key.unit, key.meaning));
    if let (Presence::Default(_), Some(text)) = (key.presence, key.example()) {
        schema["default"] = json_of(&text);
    }
    schema
}

fn description(unit: &str, meaning: &str) -> String {
    match unit {
        "" => meaning.to_owned(),
        unit => format!("{unit}: {meaning}"),
    }
}

/// Adds the time-domain sections of solids or flows, with one definition per number of dimensions.
fn add_forms(
    name: &str,
    kinds: &[Kind],
    properties: &mut Map<String, Value>,
    branches: &mut Branches,
    definitions: &mut Map<String, Value>,
) {
    for kind in kinds {
        let forms = forms_in_time(*kind);
        let own = is_one("model", "kind", &[kind.name()]);
        for dimensions in if let Kind::Solid(_) = kind { 2..=3 } else { 2..=2 } {
            let then = branches.under(match kind {
                Kind::Solid(_) => json!({ "allOf": [own, has_grid_of(dimensions)] }),
                Kind::Flow(_) => own.clone(),
            });
            let scope = Scope { dimensions: Some(dimensions), ..Scope::default() };
            for form in &forms {
                let own = format!("{name}.{}d.{}", dimensions, form.name);
                let reference = json!({ "$ref": format!("#/$defs/{own}") });
                inside(then, "properties").insert(form.name.to_owned(), reference);
                definitions.entry(own).or_insert_with(|| of_form(form, &scope));
            }
        }
        let then = branches.under(own);
        for form in &forms {
            properties.entry(form.name).or_insert_with(|| json!({}));
            let needed: Vec<&str> = forms
                .iter()
                .filter(|other| other.is_required && other.name != form.name)
                .map(|other| other.name)
                .collect();
            inside(then, "dependentRequired").insert(form.name.to_owned(), json!(needed));
        }
    }
    // Refuse the sections that only other kinds of model have.
    let all = Kind::all();
    for form in all.iter().flat_map(|kind| forms_in_time(*kind)) {
        for kind in kinds {
            if forms_in_time(*kind).iter().all(|own| own.name != form.name) {
                let then = branches.under(is_one("model", "kind", &[kind.name()]));
                inside(then, "properties").insert(form.name.to_owned(), json!(false));
            }
        }
    }
}

/// Builds the condition that the grid has 2 or 3 dimensions; grids with fewer or more entries fail both schemas.
fn has_grid_of(dimensions: usize) -> Value {
    let cells = match dimensions {
        2 => json!({ "maxItems": 2 }),
        _ => json!({ "minItems": 3 }),
    };
    json!({ "properties": { "grid": { "properties": { "cells": cells } } } })
}

/// Builds the schema of a table or of a list of tables.
fn of_form(form: &'static Form, scope: &Scope) -> Value {
    let mut schema = match form.groups {
        [] => of_stresses(),
        _ => of_items(form, scope),
    };
    schema["description"] = json!(form.meaning);
    match form.layout {
        Layout::List => {
            json!({ "type": "array", "items": schema, "minItems": usize::from(form.is_required) })
        }
        Layout::Section | Layout::Braces => schema,
    }
}

/// Builds the schema of the table whose keys are stress components.
fn of_stresses() -> Value {
    let stresses = stress::all().map(|component| {
        let schema = json!({ "type": "number", "description": stress::unit(component) });
        (component.to_string(), schema)
    });
    object(stresses.collect(), Vec::new())
}

fn of_items(form: &'static Form, scope: &Scope) -> Value {
    let mut properties = Map::new();
    let mut required = Vec::new();
    let mut branches = Branches::default();
    // Conditions under which each key is allowed.
    let mut allowed: Vec<(&str, Vec<Value>)> = Vec::new();
    for (when, item) in form.items() {
        let is_elsewhere = |own: &&Condition| holds(own, scope) == Some(false);
        if when.iter().chain(item.when).any(|own| is_elsewhere(&own)) {
            continue;
        }
        let is_open = |own: &&Condition| holds(own, scope).is_none();
        let conditions: Vec<&Condition> = when.iter().chain(item.when).filter(is_open).collect();
        let known: Vec<Value> = conditions.iter().filter_map(|own| of_condition(own)).collect();
        // Conditions on the dimensions cannot be evaluated inside the table if the dimensions are unknown.
        let is_everywhere = known.len() == conditions.len();
        let is_required = matches!(item.need, Need::Required(_)) && is_everywhere;
        if known.is_empty() {
            merge(&mut properties, item, scope);
            if is_required {
                required.push(item.name);
            }
            continue;
        }
        properties.entry(item.name).or_insert_with(|| json!({}));
        let condition = match &known[..] {
            [one] => one.clone(),
            all => json!({ "allOf": all }),
        };
        match allowed.iter_mut().find(|(name, _)| *name == item.name) {
            Some((_, all)) if all.contains(&condition) => {}
            Some((_, all)) => all.push(condition.clone()),
            None => allowed.push((item.name, vec![condition.clone()])),
        }
        let then = branches.under(condition);
        merge(inside(then, "properties"), item, scope);
        if is_required {
            append(then, "required", item.name);
        }
    }
    for (name, conditions) in allowed {
        let then = branches.under(json!({ "not": { "anyOf": conditions } }));
        inside(then, "properties").insert(name.to_owned(), json!(false));
    }
    let mut schema = object(properties, required);
    let branches = branches.into_list();
    if !branches.is_empty() {
        schema["allOf"] = json!(branches);
    }
    schema
}

/// Adds a key; a key whose type depends on the dimensions accepts each of its types.
fn merge(properties: &mut Map<String, Value>, item: &Item, scope: &Scope) {
    let schema = of_item(item, scope);
    let merged = match properties.remove(item.name) {
        Some(other) if other != json!({}) => json!({ "anyOf": [other, schema] }),
        _ => schema,
    };
    properties.insert(item.name.to_owned(), merged);
}

/// Returns whether a condition on the dimensions holds; `None` if the dimensions are unknown, and for other conditions.
fn holds(condition: &Condition, scope: &Scope) -> Option<bool> {
    match condition {
        Condition::Plane => Some(scope.dimensions? == 2),
        Condition::Space => Some(scope.dimensions? == 3),
        _ => None,
    }
}

fn of_condition(condition: &Condition) -> Option<Value> {
    match condition {
        Condition::Is(key, words) => Some(json!({
            "properties": { *key: { "enum": words } },
            "required": [key],
        })),
        Condition::Present(key) => Some(json!({ "required": [key] })),
        Condition::Absent(key) => Some(json!({ "not": { "required": [key] } })),
        Condition::Plane | Condition::Space => None,
    }
}

fn of_item(item: &Item, scope: &Scope) -> Value {
    let mut schema = of_type(&item.value, scope);
    schema["description"] = json!(description(item.unit, item.meaning));
    match item.need {
        Need::Default(text) => schema["default"] = json_of(text),
        Need::Required(text) | Need::Optional(text) => schema["examples"] = json!([json_of(text)]),
    }
    schema
}

/// Converts a TOML value, given as text, to JSON.
fn json_of(toml: &str) -> Value {
    fn convert(value: &DeValue) -> Value {
        match value {
            DeValue::Boolean(truth) => json!(truth),
            DeValue::Array(array) => array.iter().map(|item| convert(item.get_ref())).collect(),
            DeValue::Table(table) => table
                .iter()
                .map(|(key, value)| (key.get_ref().to_string(), convert(value.get_ref())))
                .collect::<Map<String, Value>>()
                .into(),
            DeValue::Integer(_) => json!(crate::value::integer(value)),
            _ => match (text(value), crate::value::number(value)) {
                (Some(text), _) => json!(text),
                (None, number) => json!(number),
            },
        }
    }
    DeValue::parse(toml).map_or(Value::Null, |value| convert(value.get_ref()))
}

fn of_range(range: Range) -> Value {
    match range {
        Range::Finite => json!({ "type": "number" }),
        Range::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        Range::NotNegative => json!({ "type": "number", "minimum": 0 }),
        Range::UpTo(most) => json!({ "type": "number", "exclusiveMinimum": 0, "maximum": most }),
        Range::Below(limit) => {
            json!({ "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": limit })
        }
        Range::NotNegativeBelow(limit) => {
            json!({ "type": "number", "minimum": 0, "exclusiveMaximum": limit })
        }
    }
}

/// Builds the schema of a list with `least` to `most` items.
fn list_of(items: Value, least: usize, most: usize) -> Value {
    json!({ "type": "array", "items": items, "minItems": least, "maxItems": most })
}

/// Returns the minimum and maximum length of a list in the dimensions of `scope`; in 2 or 3 dimensions if unknown.
fn lengths(length: Length, scope: &Scope) -> [usize; 2] {
    match (length, scope.dimensions) {
        (Length::Two, _) => [2, 2],
        (Length::Axes, Some(d)) => [d, d],
        (Length::Axes, None) => [2, 3],
        (Length::SideAxes, Some(d)) => [d - 1, d - 1],
        (Length::SideAxes, None) => [1, 2],
        (Length::Spins, Some(2)) => [1, 1],
        (Length::Spins, Some(_)) => [3, 3],
        (Length::Spins, None) => [1, 3],
    }
}

fn of_type(value: &Type, scope: &Scope) -> Value {
    let [axes, most] = lengths(Length::Axes, scope);
    let number = || json!({ "type": "number" });
    let axis = |most: usize| json!({ "type": "integer", "minimum": 1, "maximum": most });
    match *value {
        // One line: no control characters.
        Type::Text => json!({ "type": "string", "pattern": r"^[^\x00-\x1f\x7f-\x9f]*$" }),
        Type::Texts => json!({ "type": "array", "items": { "type": "string" } }),
        Type::Name => {
            // Name of ASCII letters, digits, '-', '_' and '.'; other letters are not checked, since regular-expression
            // engines differ in their character classes.
            json!({
                "type": "string",
                "pattern": r"^[^\x00-,/:-@\[-^`{-\x7f]+$",
                "maxLength": MAX_NAME,
            })
        }
        Type::Hexadecimal => json!({ "type": "string", "pattern": "^[+0-9A-Fa-f][0-9A-Fa-f]{7}$" }),
        Type::Truth => json!({ "type": "boolean" }),
        Type::Number(range) => of_range(range),
        Type::Whole(least) => json!({ "type": "integer", "minimum": least }),
        Type::Axis => axis(most),
        Type::AxisOfSpace => axis(3),
        Type::Pair => list_of(number(), 2, 2),
        Type::Matrix => list_of(list_of(number(), 2, 2), 2, 2),
        Type::Numbers(length) => {
            let [least, most] = lengths(length, scope);
            let list = list_of(number(), least, most);
            // Brackets are optional around a single number.
            if least == 1 { json!({ "anyOf": [number(), list] }) } else { list }
        }
        Type::PerAxis(length) => {
            let [least, most] = lengths(length, scope);
            let one = of_range(Range::Positive);
            json!({ "anyOf": [one.clone(), list_of(one, least, most)] })
        }
        Type::Direction => {
            let mut list = list_of(number(), axes, most);
            list["contains"] = json!({ "not": { "const": 0 } });
            list
        }
        Type::List(least, range) => {
            json!({ "type": "array", "items": of_range(range), "minItems": least })
        }
        Type::Counts { length: [few, many], least, order } => {
            let mut items = json!({ "type": "integer", "minimum": least });
            if order == Order::Even {
                items["multipleOf"] = json!(2);
            }
            let mut list = list_of(items, few, many);
            if order == Order::Ascending {
                list["uniqueItems"] = json!(true);
            }
            list
        }
        Type::Mode => {
            let mut list = list_of(json!({ "type": "integer" }), 2, 2);
            list["contains"] = json!({ "not": { "const": 0 } });
            list
        }
        Type::Tensor => list_of(list_of(number(), axes, most), axes, most),
        Type::Samples(_) => {
            json!({ "type": "array", "items": list_of(number(), 2, 2), "minItems": 2 })
        }
        Type::Points => {
            let point = list_of(number(), axes, most);
            json!({ "anyOf": [point.clone(), list_of(point, 1, most)] })
        }
        Type::Divisions => {
            let count = json!({ "type": "integer", "minimum": 2 });
            json!({ "anyOf": [count.clone(), list_of(count, 1, most)] })
        }
        Type::OneOf(words) => json!({ "enum": words(scope) }),
        Type::AnyOf(words) => {
            let items = json!({ "enum": words(scope) });
            json!({ "type": "array", "items": items, "uniqueItems": true })
        }
        Type::Table(form) => of_form(form, scope),
        Type::Part(section) => of_part(section),
    }
}

/// Builds the schema of a table with the keys of a section that at least one solid uses.
fn of_part(section: &str) -> Value {
    let is_of_solid = |key: &&Key| Kind::solids().iter().any(|own| key.is_for(*own));
    let own = keys().iter().filter(|key| key.split().0 == section).filter(is_of_solid);
    let mut properties = Map::new();
    for key in own {
        let mut schema = of_key(key);
        if key.name == "yield.kind"
            && let Some(words) = schema.get_mut("enum").and_then(Value::as_array_mut)
        {
            words.push(json!(NO_YIELD));
        }
        properties.insert(key.split().1.to_owned(), schema);
    }
    object(properties, Vec::new())
}
