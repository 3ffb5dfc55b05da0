//! Generator of the reference page of case files from the schema.

use super::keys::{Key, Presence, keys};
use super::kind::ModelKind;
use crate::dynamics::stress;
use crate::schema::{
    AllowedRange, CountConstraint, KeyCondition, KeyPresence, ListLength, SchemaScope, TableLayout,
    TableSchema, ValueType,
};
use crate::section_schemas::all_schemas;
use crate::types::MAX_NAME_LENGTH;
use std::fmt::Write;

const PAGE_HEADER: &str = "\
# Reference of case files

Made by `wellposed schema --markdown` from the schema that also reads the files; `wellposed schema` prints it as
JSON Schema for editors. `wellposed new KIND` writes a case with every key.

A case is TOML: SI units, angles in degrees anticlockwise from x₁. Where a default stands a key may be left out;
*required* ones must be there as soon as their section is. `--set section.key=value` sets a key over the file, `--set
load[0].amplitude=2` one in a list, counted from 0.
";

/// Introductory text for each section of scalar keys.
const SECTION_INTRODUCTIONS: [(&str, &str); 8] = [
    ("", "Before the first section"),
    ("model", "The kind of model and its constants"),
    ("background", "The state of a flow"),
    ("yield", "The set within which the stress of a solid stays; without it the solid is elastic"),
    ("stress", "The stress of a solid that yields, scaled until it does; or else `yield.active`"),
    ("wave", "The wave at which roots are listed"),
    ("map.x", "What `wellposed map` sweeps, in a table `x` and one `y`"),
    ("compare", "For `wellposed point`: models side by side on this state"),
];

/// Generates the reference page in Markdown.
pub fn generate_reference() -> String {
    let mut page = PAGE_HEADER.to_owned();
    for (section, meaning) in SECTION_INTRODUCTIONS {
        let title = match section {
            "" => "Title and name".to_owned(),
            "map.x" => "`[map]`".to_owned(),
            _ => format!("`[{section}]`"),
        };
        let _ = write!(page, "\n## {title}\n\n{meaning}.\n");
        page.push_str(
            "\n| key | value | unit | default | meaning | of |\n|---|---|---|---|---|---|\n",
        );
        for key in keys().iter().filter(|key| is_in_section(key, section)) {
            page.push_str(&format_key_row(key));
        }
    }
    for (title, forms) in all_schemas() {
        match title {
            "check" => page.push_str("\n## Check\n"),
            _ => {
                let _ = write!(page, "\n## {}{}\n", title[..1].to_uppercase(), &title[1..]);
            }
        }
        let mut tables: Vec<&'static TableSchema> = Vec::new();
        for form in forms {
            append_table(&mut page, form);
            for (_, item) in form.keys() {
                if let ValueType::Table(inner) = item.value_type
                    && !tables.iter().any(|own| std::ptr::eq(*own, inner) || own.name == inner.name)
                {
                    tables.push(inner);
                }
            }
        }
        for form in tables {
            append_table(&mut page, form);
        }
    }
    page
}

fn is_in_section(key: &Key, section: &str) -> bool {
    // Both axes of a map have the same keys; they are listed once.
    key.split_section().0 == section || (section == "map.x" && key.split_section().0 == "map.y")
}

fn format_row(cells: &[&str]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

fn format_code(text: &str) -> String {
    format!("`{text}`")
}

fn format_key_row(key: &Key) -> String {
    let (section, name) = key.split_section();
    let name = match section.strip_prefix("map.") {
        Some(axis) => format!("{axis}.{name}"),
        None => name.to_owned(),
    };
    let words = key.allowed_names().filter(|words| words.len() <= MAX_LISTED_NAMES);
    let value = match words {
        Some(words) if matches!(key.value_type(), ValueType::TextList) => {
            format!("list of {}", format_name_list(&words))
        }
        Some(words) => format_name_list(&words),
        None => match key.value_type() {
            ValueType::Number(_) => describe_range(key.range),
            other => describe_type(&other),
        },
    };
    let default = match (key.presence, key.example_value()) {
        (Presence::Required(_), _) => "*required*".to_owned(),
        (Presence::Default(_), Some(value)) => format_code(&value),
        _ => String::new(),
    };
    format_row(&[&format_code(&name), &value, key.unit, &default, key.meaning, &format_users(key)])
}

/// Lists the kinds of model and the yield sets that use a key, as text.
fn format_users(key: &Key) -> String {
    let all = ModelKind::all_kinds();
    let own: Vec<&str> =
        all.iter().filter(|kind| key.is_used_by_kind(**kind)).map(|own| own.name()).collect();
    let names = |kinds: Vec<ModelKind>| kinds.into_iter().map(ModelKind::name).collect::<Vec<_>>();
    let kinds = match &own {
        own if own.len() == all.len() => "all".to_owned(),
        own if *own == names(ModelKind::flow_kinds()) => "flows".to_owned(),
        own if *own == names(ModelKind::solid_kinds()) => "solids".to_owned(),
        own => own.join(", "),
    };
    let sets = key.yield_set_names();
    match sets.len() {
        0 => kinds,
        count if count == models::registry::yield_sets().len() => format!("{kinds} that yield"),
        _ => format!("{kinds} that yield by {}", sets.join(", ")),
    }
}

fn append_table(page: &mut String, form: &'static TableSchema) {
    let mut letters = form.meaning.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_uppercase().collect());
    let _ = write!(page, "\n### `{}`\n\n{first}{}.\n", form.header(), letters.as_str());
    if form.is_required && form.layout != TableLayout::InlineTable {
        page.push_str("A run in time must have it.\n");
    }
    if let Some(name) = form.former_name {
        let header = form.layout.format_header(name);
        let _ = writeln!(page, "The former name `{header}` is read for one more version.");
    }
    if form.groups.is_empty() {
        append_stress_table(page);
        return;
    }
    page.push_str(
        "\n| key | value | unit | default | meaning | where |\n|---|---|---|---|---|---|\n",
    );
    for (when, item) in form.keys() {
        let default = match item.presence {
            KeyPresence::Required(_) => "*required*".to_owned(),
            KeyPresence::Default(value) => format_code(value),
            KeyPresence::Optional(_) => String::new(),
        };
        let conditions: Vec<String> =
            when.iter().chain(item.conditions).map(format_condition).collect();
        let meaning = match item.former_name {
            Some(name) => {
                format!("{}; former name, read for one more version: `{name}`", item.meaning)
            }
            None => item.meaning.to_owned(),
        };
        let (name, value) = (format_code(item.name), describe_type(&item.value_type));
        page.push_str(&format_row(&[
            &name,
            &value,
            item.unit,
            &default,
            &meaning,
            &conditions.join(", "),
        ]));
    }
}

/// Adds the table of the section whose keys are stress components.
fn append_stress_table(page: &mut String) {
    page.push_str("\n| key | value | unit |\n|---|---|---|\n");
    for component in stress::stress_components() {
        let unit = stress::stress_unit(component);
        page.push_str(&format_row(&[&format_code(&component.to_string()), "number", unit]));
    }
}

fn format_condition(condition: &KeyCondition) -> String {
    match condition {
        KeyCondition::HasValue(key, words) => format!("`{key}` is {}", words.join(", ")),
        KeyCondition::Present(key) => format!("with `{key}`"),
        KeyCondition::Absent(key) => format!("without `{key}`"),
        KeyCondition::PlaneStrain => "plane strain".into(),
        KeyCondition::Space => "space".into(),
    }
}

/// Maximum number of names listed in a table cell.
const MAX_LISTED_NAMES: usize = 12;

fn format_name_list(words: &[String]) -> String {
    words.iter().map(|word| format_code(word)).collect::<Vec<_>>().join(", ")
}

fn describe_range(range: AllowedRange) -> String {
    match range {
        AllowedRange::Finite => "number".into(),
        AllowedRange::Positive => "number > 0".into(),
        AllowedRange::NotNegative => "number ≥ 0".into(),
        AllowedRange::PositiveUpTo(most) => format!("0 < number ≤ {most}"),
        AllowedRange::PositiveBelow(limit) => format!("0 < number < {limit}"),
        AllowedRange::NotNegativeBelow(limit) => format!("0 ≤ number < {limit}"),
    }
}

fn describe_length(length: ListLength) -> &'static str {
    match length {
        ListLength::Two => "two numbers",
        ListLength::GridAxes => "a number for each axis",
        ListLength::FaceAxes => "a number for each axis of the side",
        ListLength::SpinComponents => "a number, in space three",
    }
}

/// Describes a type for a table cell.
fn describe_type(value: &ValueType) -> String {
    match *value {
        ValueType::Text => "text".into(),
        ValueType::TextList => "list of texts".into(),
        ValueType::Name => {
            format!("text of at most {MAX_NAME_LENGTH} letters, digits, `-`, `_`, `.`")
        }
        ValueType::Hexadecimal => "eight hexadecimal digits".into(),
        ValueType::Boolean => "`true`, `false`".into(),
        ValueType::Number(range) => describe_range(range),
        ValueType::WholeNumber(least) => format!("whole number ≥ {least}"),
        ValueType::Axis => "axis: 1, 2 or in space 3".into(),
        ValueType::SpaceAxis => "axis: 1, 2 or 3".into(),
        ValueType::Pair => "`[x1, x2]`".into(),
        ValueType::Matrix => "`[[a11, a12], [a21, a22]]`".into(),
        ValueType::Numbers(length) => describe_length(length).into(),
        ValueType::PerAxis(_) => "number > 0, or one for each axis".into(),
        ValueType::Direction => "a number for each axis, not all 0".into(),
        ValueType::NumberList(0, range) => format!("list of any length: {}", describe_range(range)),
        ValueType::NumberList(_, range) => format!("list: {}", describe_range(range)),
        ValueType::CountList { length: [few, many], minimum: least, order } => {
            let length = if few == many { few.to_string() } else { format!("{few} to {many}") };
            let order = match order {
                CountConstraint::Unconstrained => "",
                CountConstraint::Even => " even",
                CountConstraint::Ascending => " ascending",
            };
            format!("{length}{order} whole numbers ≥ {least}")
        }
        ValueType::ModeNumbers => "two whole numbers, not both 0".into(),
        ValueType::Tensor => "a row of numbers for each axis".into(),
        ValueType::Samples([pair, _]) => format!("list of pairs `{pair}`"),
        ValueType::PointList => "point, or list of points".into(),
        ValueType::PointCounts => "whole number ≥ 2, or list of such".into(),
        ValueType::OneOf(words) | ValueType::AnyOf(words) => {
            let all = words(&SchemaScope::default());
            let is_list = matches!(value, ValueType::AnyOf(_));
            match (all.len() <= MAX_LISTED_NAMES, is_list) {
                (true, false) => format_name_list(&all),
                (true, true) => format!("list of {}", format_name_list(&all)),
                (false, false) => format!("a name, as {}", format_code(&all[0])),
                (false, true) => format!("list of names, as {}", format_code(&all[0])),
            }
        }
        ValueType::Table(form) => format!("table, see `{}`", form.header()),
        ValueType::SectionKeys(section) => format!("table with keys of `[{section}]`"),
    }
}
