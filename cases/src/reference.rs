//! Generator of the reference page of case files from the schema.

use super::keys::{Key, Presence, keys};
use super::kind::Kind;
use crate::dynamics::stress;
use crate::forms::all_forms;
use crate::schema::{Condition, Form, Item, Layout, Length, Need, Order, Range, Scope, Type};
use crate::types::MAX_NAME;
use std::fmt::Write;

const HEAD: &str = "\
# Reference of case files

Made by `wellposed schema --markdown` from the schema that also reads the files; `wellposed schema` prints it as
JSON Schema for editors. `wellposed new KIND` writes a case with every key.

A case is TOML: SI units, angles in degrees anticlockwise from x₁. Where a default stands a key may be left out;
*required* ones must be there as soon as their section is. `--set section.key=value` sets a key over the file, `--set
load[0].amplitude=2` one in a list, counted from 0.
";

/// Introductory text for each section of scalar keys.
const SECTIONS: [(&str, &str); 8] = [
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
pub fn reference() -> String {
    let mut page = HEAD.to_owned();
    for (section, meaning) in SECTIONS {
        let title = match section {
            "" => "Title and name".to_owned(),
            "map.x" => "`[map]`".to_owned(),
            _ => format!("`[{section}]`"),
        };
        let _ = write!(page, "\n## {title}\n\n{meaning}.\n");
        page.push_str(
            "\n| key | value | unit | default | meaning | of |\n|---|---|---|---|---|---|\n",
        );
        for key in keys().iter().filter(|key| is_in(key, section)) {
            page.push_str(&row_of_key(key));
        }
    }
    for (title, forms) in all_forms() {
        match title {
            "check" => page.push_str("\n## Check\n"),
            _ => {
                let _ = write!(page, "\n## {}{}\n", title[..1].to_uppercase(), &title[1..]);
            }
        }
        let mut tables: Vec<&'static Form> = Vec::new();
        for form in forms {
            add_form(&mut page, form);
            for (_, item) in form.items() {
                if let Type::Table(inner) = item.value
                    && !tables.iter().any(|own| std::ptr::eq(*own, inner) || own.name == inner.name)
                {
                    tables.push(inner);
                }
            }
        }
        for form in tables {
            add_form(&mut page, form);
        }
    }
    page
}

fn is_in(key: &Key, section: &str) -> bool {
    // Both axes of a map have the same keys; they are listed once.
    key.split().0 == section || (section == "map.x" && key.split().0 == "map.y")
}

fn row(cells: &[&str]) -> String {
    let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|")).collect();
    format!("| {} |\n", cells.join(" | "))
}

fn code(text: &str) -> String {
    format!("`{text}`")
}

fn row_of_key(key: &Key) -> String {
    let (section, name) = key.split();
    let name = match section.strip_prefix("map.") {
        Some(axis) => format!("{axis}.{name}"),
        None => name.to_owned(),
    };
    let words = key.words().filter(|words| words.len() <= MAX_WORDS);
    let value = match words {
        Some(words) if matches!(key.value_type(), Type::Texts) => {
            format!("list of {}", listed(&words))
        }
        Some(words) => listed(&words),
        None => match key.value_type() {
            Type::Number(_) => described_range(key.range),
            other => described(&other),
        },
    };
    let default = match (key.presence, key.example()) {
        (Presence::Required(_), _) => "*required*".to_owned(),
        (Presence::Default(_), Some(value)) => code(&value),
        _ => String::new(),
    };
    row(&[&code(&name), &value, key.unit, &default, key.meaning, &owners(key)])
}

/// Lists the kinds of model and the yield sets that use a key, as text.
fn owners(key: &Key) -> String {
    let all = Kind::all();
    let own: Vec<&str> =
        all.iter().filter(|kind| key.is_for(**kind)).map(|own| own.name()).collect();
    let names = |kinds: Vec<Kind>| kinds.into_iter().map(Kind::name).collect::<Vec<_>>();
    let kinds = match &own {
        own if own.len() == all.len() => "all".to_owned(),
        own if *own == names(Kind::flows()) => "flows".to_owned(),
        own if *own == names(Kind::solids()) => "solids".to_owned(),
        own => own.join(", "),
    };
    let sets = key.set_names();
    match sets.len() {
        0 => kinds,
        count if count == models::registry::yield_sets().len() => format!("{kinds} that yield"),
        _ => format!("{kinds} that yield by {}", sets.join(", ")),
    }
}

fn add_form(page: &mut String, form: &'static Form) {
    let mut letters = form.meaning.chars();
    let first = letters.next().map_or(String::new(), |letter| letter.to_uppercase().collect());
    let _ = write!(page, "\n### `{}`\n\n{first}{}.\n", form.header(), letters.as_str());
    if form.is_required && form.layout != Layout::Braces {
        page.push_str("A run in time must have it.\n");
    }
    if form.groups.is_empty() {
        add_stresses(page);
        return;
    }
    page.push_str(
        "\n| key | value | unit | default | meaning | where |\n|---|---|---|---|---|---|\n",
    );
    for (when, item) in form.items() {
        let default = match item.need {
            Need::Required(_) => "*required*".to_owned(),
            Need::Default(value) => code(value),
            Need::Optional(_) => String::new(),
        };
        let conditions: Vec<String> = when.iter().chain(item.when).map(condition).collect();
        let (name, value) = (code(item.name), value_of(item));
        page.push_str(&row(&[
            &name,
            &value,
            item.unit,
            &default,
            item.meaning,
            &conditions.join(", "),
        ]));
    }
}

/// Adds the table of the section whose keys are stress components.
fn add_stresses(page: &mut String) {
    page.push_str("\n| key | value | unit |\n|---|---|---|\n");
    for component in stress::all() {
        let unit = stress::unit(component);
        page.push_str(&row(&[&code(&component.to_string()), "number", unit]));
    }
}

fn condition(condition: &Condition) -> String {
    match condition {
        Condition::Is(key, words) => format!("`{key}` is {}", words.join(", ")),
        Condition::Present(key) => format!("with `{key}`"),
        Condition::Absent(key) => format!("without `{key}`"),
        Condition::Plane => "plane strain".into(),
        Condition::Space => "space".into(),
    }
}

/// Maximum number of words listed in a table cell.
const MAX_WORDS: usize = 12;

fn listed(words: &[String]) -> String {
    words.iter().map(|word| code(word)).collect::<Vec<_>>().join(", ")
}

fn value_of(item: &Item) -> String {
    described(&item.value)
}

fn described_range(range: Range) -> String {
    match range {
        Range::Finite => "number".into(),
        Range::Positive => "number > 0".into(),
        Range::NotNegative => "number ≥ 0".into(),
        Range::UpTo(most) => format!("0 < number ≤ {most}"),
        Range::Below(limit) => format!("0 < number < {limit}"),
        Range::NotNegativeBelow(limit) => format!("0 ≤ number < {limit}"),
    }
}

fn described_length(length: Length) -> &'static str {
    match length {
        Length::Two => "two numbers",
        Length::Axes => "a number for each axis",
        Length::SideAxes => "a number for each axis of the side",
        Length::Spins => "a number, in space three",
    }
}

/// Describes a type for a table cell.
fn described(value: &Type) -> String {
    match *value {
        Type::Text => "text".into(),
        Type::Texts => "list of texts".into(),
        Type::Name => {
            format!("text of at most {MAX_NAME} letters, digits, `-`, `_`, `.`")
        }
        Type::Hexadecimal => "eight hexadecimal digits".into(),
        Type::Truth => "`true`, `false`".into(),
        Type::Number(range) => described_range(range),
        Type::Whole(least) => format!("whole number ≥ {least}"),
        Type::Axis => "axis: 1, 2 or in space 3".into(),
        Type::AxisOfSpace => "axis: 1, 2 or 3".into(),
        Type::Pair => "`[x1, x2]`".into(),
        Type::Matrix => "`[[a11, a12], [a21, a22]]`".into(),
        Type::Numbers(length) => described_length(length).into(),
        Type::PerAxis(_) => "number > 0, or one for each axis".into(),
        Type::Direction => "a number for each axis, not all 0".into(),
        Type::List(0, range) => format!("list of any length: {}", described_range(range)),
        Type::List(_, range) => format!("list: {}", described_range(range)),
        Type::Counts { length: [few, many], least, order } => {
            let length = if few == many { few.to_string() } else { format!("{few} to {many}") };
            let order = match order {
                Order::Any => "",
                Order::Even => " even",
                Order::Ascending => " ascending",
            };
            format!("{length}{order} whole numbers ≥ {least}")
        }
        Type::Mode => "two whole numbers, not both 0".into(),
        Type::Tensor => "a row of numbers for each axis".into(),
        Type::Samples([pair, _]) => format!("list of pairs `{pair}`"),
        Type::Points => "point, or list of points".into(),
        Type::Divisions => "whole number ≥ 2, or list of such".into(),
        Type::OneOf(words) | Type::AnyOf(words) => {
            let all = words(&Scope::default());
            let is_list = matches!(value, Type::AnyOf(_));
            match (all.len() <= MAX_WORDS, is_list) {
                (true, false) => listed(&all),
                (true, true) => format!("list of {}", listed(&all)),
                (false, false) => format!("a name, as {}", code(&all[0])),
                (false, true) => format!("list of names, as {}", code(&all[0])),
            }
        }
        Type::Table(form) => format!("table, see `{}`", form.header()),
        Type::Part(section) => format!("table with keys of `[{section}]`"),
    }
}
