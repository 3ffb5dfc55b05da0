//! Verifies the JSON Schema against the program for lists of wrong length or with items of wrong type: it refuses no
//! case that the program accepts, and accepts no case that the program refuses except those in `RELATIONS`.

use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use wellposed_cases::template::{Purpose, text_for};
use wellposed_cases::{Case, Medium, json_schema};

fn as_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::String(text) => json!(text),
        toml::Value::Integer(number) => json!(number),
        toml::Value::Float(number) => json!(number),
        toml::Value::Boolean(truth) => json!(truth),
        toml::Value::Datetime(date) => json!(date.to_string()),
        toml::Value::Array(items) => items.iter().map(as_json).collect(),
        toml::Value::Table(table) => {
            let pairs = table.iter().map(|(key, value)| (key.clone(), as_json(value)));
            Value::Object(pairs.collect())
        }
    }
}

/// Collects the paths of all lists, including lists inside lists.
fn lists(value: &toml::Value, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
    let children: Vec<(String, &toml::Value)> = match value {
        toml::Value::Table(table) => table.iter().map(|(key, own)| (key.clone(), own)).collect(),
        toml::Value::Array(items) => {
            found.push(path.clone());
            items.iter().enumerate().map(|(index, own)| (index.to_string(), own)).collect()
        }
        _ => Vec::new(),
    };
    for (name, own) in children {
        path.push(name);
        lists(own, path, found);
        path.pop();
    }
}

fn at<'a>(value: &'a mut toml::Value, path: &[String]) -> &'a mut toml::Value {
    path.iter().fold(value, |value, name| match value {
        toml::Value::Array(items) => &mut items[name.parse::<usize>().expect("an index")],
        toml::Value::Table(table) => table.get_mut(name).expect("a key"),
        _ => panic!("no table"),
    })
}

/// Modifications of a list.
#[derive(Clone, Copy, Debug)]
enum Change {
    Empty,
    Shorter,
    /// Repeats the last item.
    Longer,
    Text,
    Truth,
    NoList,
}

impl Change {
    const ALL: [Self; 6] =
        [Self::Empty, Self::Shorter, Self::Longer, Self::Text, Self::Truth, Self::NoList];

    fn apply(self, value: &mut toml::Value) {
        let toml::Value::Array(list) = value else { return };
        let mut first = |own: toml::Value| list.first_mut().map_or((), |item| *item = own);
        match self {
            Self::Empty => list.clear(),
            Self::Shorter => _ = list.pop(),
            Self::Longer => list.extend(list.last().cloned()),
            Self::Text => first(toml::Value::String("x".to_owned())),
            Self::Truth => first(toml::Value::Boolean(true)),
            Self::NoList => *value = toml::Value::Boolean(true),
        }
    }
}

/// Cases refused by the program only, since the error depends on several items or tables: no perturbation left,
/// duplicate receiver names, an empty list of fields, a periodic face without its opposite face, a recorded integral
/// that is not computed, a second region `rest`.
const RELATIONS: [&str; 8] = [
    "initial Empty",
    "initial Shorter",
    "output.integrals Empty",
    "output.integrals Shorter",
    "receiver Longer",
    "receiver.#.fields Empty",
    "region Longer",
    "side Shorter",
];

/// Returns the texts of all templates and resolved bundled cases, with their file names.
fn texts() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of = |medium: Medium| {
        let purposes = [Purpose::State, Purpose::Run];
        purposes.map(|purpose| ("new.toml".to_owned(), text_for(medium, purpose)))
    };
    let mut texts: Vec<(String, String)> = Medium::all().flat_map(of).collect();
    for folder in ["check", "cosserat", "dynamics", "flow", "granular-flow"] {
        for entry in std::fs::read_dir(root.join(folder)).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.extension().is_some_and(|own| own == "toml") {
                let case = Case::load(&path, &[]).expect("a case");
                texts.push((path.display().to_string(), case.to_toml()));
            }
        }
    }
    texts
}

#[test]
fn lists_are_refused_by_both() {
    /// Longer lists are skipped: sample tables are long, and their items are alike.
    const LONG: usize = 20;
    let validator = jsonschema::draft202012::new(&json_schema()).expect("a schema");
    let (mut by_program_alone, mut count) = (BTreeSet::new(), 0);
    for (file, text) in texts() {
        let value = toml::Value::Table(text.parse().expect("TOML"));
        let mut found = Vec::new();
        lists(&value, &mut Vec::new(), &mut found);
        for path in found {
            for change in Change::ALL {
                let mut own = value.clone();
                let list = at(&mut own, &path);
                if list.as_array().is_some_and(|items| items.len() > LONG) {
                    continue;
                }
                change.apply(list);
                if own == value {
                    continue;
                }
                let text = toml::to_string(&own).expect("TOML");
                let is_taken = Case::parse(&text, &file, &[]).is_ok();
                let is_valid = validator.is_valid(&as_json(&own));
                assert!(is_valid || !is_taken, "{file}: {path:?} {change:?}");
                if is_valid && !is_taken {
                    let is_index = |name: &String| name.parse::<usize>().is_ok();
                    let names: Vec<&str> =
                        path.iter().map(|own| if is_index(own) { "#" } else { own }).collect();
                    by_program_alone.insert(format!("{} {change:?}", names.join(".")));
                }
                count += 1;
            }
        }
    }
    assert!(count > 1000, "{count}");
    let unexpected: Vec<&String> =
        by_program_alone.iter().filter(|own| !RELATIONS.contains(&own.as_str())).collect();
    assert!(unexpected.is_empty(), "{unexpected:?}");
}
