//! JSON Schema of the value types.

use super::{build_section_schema, build_table_schema};
use crate::schema::{
    AllowedRange, CountConstraint, ListLength, NamedValues, SchemaScope, ValueType,
};
use crate::types::MAX_NAME_LENGTH;
use serde_json::{Value, json};

/// Builds the schema of a number in a range.
pub(super) fn build_range_schema(range: AllowedRange) -> Value {
    match range {
        AllowedRange::Finite => json!({ "type": "number" }),
        AllowedRange::Positive => json!({ "type": "number", "exclusiveMinimum": 0 }),
        AllowedRange::NotNegative => json!({ "type": "number", "minimum": 0 }),
        AllowedRange::PositiveUpTo(most) => {
            json!({ "type": "number", "exclusiveMinimum": 0, "maximum": most })
        }
        AllowedRange::PositiveBelow(limit) => {
            json!({ "type": "number", "exclusiveMinimum": 0, "exclusiveMaximum": limit })
        }
        AllowedRange::NotNegativeBelow(limit) => {
            json!({ "type": "number", "minimum": 0, "exclusiveMaximum": limit })
        }
    }
}

/// Builds the schema of a list with `least` to `most` items.
fn build_list_schema(items: Value, least: usize, most: usize) -> Value {
    json!({ "type": "array", "items": items, "minItems": least, "maxItems": most })
}

/// Requires at least one item of a list to differ from 0.
fn require_nonzero_item(mut list: Value) -> Value {
    list["contains"] = json!({ "not": { "const": 0 } });
    list
}

/// Builds the schema of a list of whole numbers with minimum and maximum length.
fn build_count_list_schema(
    [shortest, longest]: [usize; 2],
    minimum: usize,
    constraint: CountConstraint,
) -> Value {
    let mut items = json!({ "type": "integer", "minimum": minimum });
    if constraint == CountConstraint::Even {
        items["multipleOf"] = json!(2);
    }
    let mut list = build_list_schema(items, shortest, longest);
    if constraint == CountConstraint::Ascending {
        list["uniqueItems"] = json!(true);
    }
    list
}

/// Returns the minimum and maximum length of a list in the dimensions of `scope`; in 2 or 3 dimensions if unknown.
fn length_bounds(length: ListLength, scope: &SchemaScope) -> [usize; 2] {
    match (length, scope.dimensions) {
        (ListLength::Two, _) => [2, 2],
        (ListLength::GridAxes, Some(d)) => [d, d],
        (ListLength::GridAxes, None) => [2, 3],
        (ListLength::FaceAxes, Some(d)) => [d - 1, d - 1],
        (ListLength::FaceAxes, None) => [1, 2],
        (ListLength::SpinComponents, Some(2)) => [1, 1],
        (ListLength::SpinComponents, Some(_)) => [3, 3],
        (ListLength::SpinComponents, None) => [1, 3],
    }
}

/// Builds the schema of a table whose names the case chooses.
pub(super) fn build_named_values_schema(values: NamedValues) -> Value {
    let text = || json!({ "type": "string" });
    let table = |items: Value| json!({ "type": "object", "additionalProperties": items });
    match values {
        NamedValues::Units => {
            json!({ "anyOf": [table(text()), { "type": "array", "items": text() }] })
        }
        NamedValues::Expressions => table(text()),
        NamedValues::Parameters => {
            let with_unit = json!({
                "type": "object",
                "properties": { "value": { "type": "number" }, "unit": text() },
                "required": ["value"],
                "additionalProperties": false,
            });
            table(json!({ "anyOf": [{ "type": "number" }, with_unit] }))
        }
        NamedValues::Background => {
            let number = json!({ "anyOf": [{ "type": "number" }, { "const": "solve" }] });
            let derivatives = json!({
                "type": "object",
                "properties": { "value": { "type": "number" } },
                "patternProperties": { "^d[t123]{1,4}$": number },
                "additionalProperties": false,
            });
            table(json!({ "anyOf": [{ "type": "number" }, derivatives] }))
        }
    }
}

/// Builds the schema of the values of a type.
pub(super) fn build_type_schema(value: &ValueType, scope: &SchemaScope) -> Value {
    let [axes, most] = length_bounds(ListLength::GridAxes, scope);
    let number = || json!({ "type": "number" });
    let axis = |most: usize| json!({ "type": "integer", "minimum": 1, "maximum": most });
    match *value {
        // One line: no control characters.
        ValueType::Text => json!({ "type": "string", "pattern": r"^[^\x00-\x1f\x7f-\x9f]*$" }),
        ValueType::TextList => json!({ "type": "array", "items": { "type": "string" } }),
        ValueType::Name => {
            // Name of ASCII letters, digits, '-', '_' and '.'; other letters are not checked, since regular-expression
            // engines differ in their character classes.
            json!({
                "type": "string",
                "pattern": r"^[^\x00-,/:-@\[-^`{-\x7f]+$",
                "maxLength": MAX_NAME_LENGTH,
            })
        }
        ValueType::Hexadecimal => {
            json!({ "type": "string", "pattern": "^[+0-9A-Fa-f][0-9A-Fa-f]{7}$" })
        }
        ValueType::Boolean => json!({ "type": "boolean" }),
        ValueType::Number(range) => build_range_schema(range),
        ValueType::WholeNumber(least) => json!({ "type": "integer", "minimum": least }),
        ValueType::Axis => axis(most),
        ValueType::SpaceAxis => axis(3),
        ValueType::Pair => build_list_schema(number(), 2, 2),
        ValueType::Matrix => build_list_schema(build_list_schema(number(), 2, 2), 2, 2),
        ValueType::Numbers(length) => {
            let [least, most] = length_bounds(length, scope);
            let list = build_list_schema(number(), least, most);
            // Brackets are optional around a single number.
            if least == 1 { json!({ "anyOf": [number(), list] }) } else { list }
        }
        ValueType::PerAxis(length) => {
            let [least, most] = length_bounds(length, scope);
            let one = build_range_schema(AllowedRange::Positive);
            json!({ "anyOf": [one.clone(), build_list_schema(one, least, most)] })
        }
        ValueType::Direction => require_nonzero_item(build_list_schema(number(), axes, most)),
        ValueType::NumberList(least, range) => {
            json!({ "type": "array", "items": build_range_schema(range), "minItems": least })
        }
        ValueType::CountList { length, minimum, order } => {
            build_count_list_schema(length, minimum, order)
        }
        ValueType::ModeNumbers => {
            require_nonzero_item(build_list_schema(json!({ "type": "integer" }), 2, 2))
        }
        ValueType::Tensor => build_list_schema(build_list_schema(number(), axes, most), axes, most),
        ValueType::Samples(_) => {
            json!({ "type": "array", "items": build_list_schema(number(), 2, 2), "minItems": 2 })
        }
        ValueType::PointList => {
            let point = build_list_schema(number(), axes, most);
            json!({ "anyOf": [point.clone(), build_list_schema(point, 1, most)] })
        }
        ValueType::PointCounts => {
            let count = json!({ "type": "integer", "minimum": 2 });
            json!({ "anyOf": [count.clone(), build_list_schema(count, 1, most)] })
        }
        ValueType::OneOf(allowed_names) => json!({ "enum": allowed_names(scope) }),
        ValueType::AnyOf(allowed_names) => {
            let items = json!({ "enum": allowed_names(scope) });
            json!({ "type": "array", "items": items, "uniqueItems": true })
        }
        ValueType::Table(table_schema) => build_table_schema(table_schema, scope),
        ValueType::TableList(table_schema) => {
            json!({ "type": "array", "items": build_table_schema(table_schema, scope), "minItems": 1 })
        }
        ValueType::IndexList => {
            json!({ "type": "array", "items": { "type": "integer", "minimum": 0 } })
        }
        ValueType::SectionKeys(section) => build_section_schema(section),
        ValueType::Named(values) => build_named_values_schema(values),
    }
}
