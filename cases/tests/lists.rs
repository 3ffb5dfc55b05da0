//! Verifies the JSON Schema against the program for lists of wrong length or with items of wrong type: it refuses no
//! case that the program accepts, and accepts no case that the program refuses except those in `PROGRAM_ONLY_ERRORS`.

mod support;

use std::collections::BTreeSet;
use support::{bundled_case_files, toml_to_json};
use wellposed_cases::template::{TemplateKind, generate_template};
use wellposed_cases::{Case, MediumKind, generate_json_schema};

/// Collects the paths of all lists, including lists inside lists.
fn collect_list_paths(value: &toml::Value, path: &mut Vec<String>, found: &mut Vec<Vec<String>>) {
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
        collect_list_paths(own, path, found);
        path.pop();
    }
}

fn find_list<'a>(value: &'a mut toml::Value, path: &[String]) -> &'a mut toml::Value {
    path.iter().fold(value, |value, name| match value {
        toml::Value::Array(items) => &mut items[name.parse::<usize>().expect("an index")],
        toml::Value::Table(table) => table.get_mut(name).expect("a key"),
        _ => panic!("no table"),
    })
}

/// Modifications of a list.
#[derive(Clone, Copy, Debug)]
enum ListChange {
    Empty,
    Shorter,
    /// Repeats the last item.
    Longer,
    TextItem,
    BooleanItem,
    NotAList,
}

impl ListChange {
    const ALL: [Self; 6] = [
        Self::Empty,
        Self::Shorter,
        Self::Longer,
        Self::TextItem,
        Self::BooleanItem,
        Self::NotAList,
    ];

    fn apply(self, value: &mut toml::Value) {
        let toml::Value::Array(list) = value else { return };
        let mut first = |own: toml::Value| list.first_mut().map_or((), |item| *item = own);
        match self {
            Self::Empty => list.clear(),
            Self::Shorter => _ = list.pop(),
            Self::Longer => list.extend(list.last().cloned()),
            Self::TextItem => first(toml::Value::String("x".to_owned())),
            Self::BooleanItem => first(toml::Value::Boolean(true)),
            Self::NotAList => *value = toml::Value::Boolean(true),
        }
    }
}

/// Cases refused by the program only, since the error depends on several items or tables: no perturbation left,
/// duplicate receiver names, an empty list of fields, a periodic face without its opposite face, a recorded integral
/// that is not computed, a second region `rest`, no blocks, two blocks in the same cells, two points of a load path at one
/// time, elements that are not those of the tree, unknowns and velocities that are not those of the equations.
const PROGRAM_ONLY_ERRORS: [&str; 22] = [
    "block Empty",
    "block Shorter",
    "block Longer",
    "initial Empty",
    "initial Shorter",
    "output.integrals Empty",
    "output.integrals Shorter",
    "receiver Longer",
    "receiver.#.fields Empty",
    "region Longer",
    "boundary Shorter",
    "load_path.points Longer",
    "rheology.element Shorter",
    "rheology.element Longer",
    "model.unknowns Empty",
    "model.unknowns Shorter",
    "model.unknowns Longer",
    "model.unknowns TextItem",
    "model.velocity Empty",
    "model.velocity Shorter",
    "model.velocity Longer",
    "model.velocity TextItem",
];

/// Returns the texts of all templates and resolved bundled cases, with their file names.
fn generate_case_texts() -> Vec<(String, String)> {
    let of = |medium: MediumKind| {
        let purposes = [TemplateKind::SingleState, TemplateKind::Simulation];
        purposes.map(|purpose| ("new.toml".to_owned(), generate_template(medium, purpose)))
    };
    let mut texts: Vec<(String, String)> = MediumKind::all_media().flat_map(of).collect();
    for path in bundled_case_files() {
        let case = Case::load(&path, &[]).expect("a case");
        texts.push((path.display().to_string(), case.to_toml()));
    }
    texts
}

#[test]
fn modified_lists_are_rejected_by_schema_and_program() {
    /// Longer lists are skipped: sample tables are long, and their items are alike.
    const MAX_LIST_LENGTH: usize = 20;
    let validator = jsonschema::draft202012::new(&generate_json_schema()).expect("a schema");
    let (mut by_program_alone, mut count) = (BTreeSet::new(), 0);
    for (file, text) in generate_case_texts() {
        let value = toml::Value::Table(text.parse().expect("TOML"));
        let mut found = Vec::new();
        collect_list_paths(&value, &mut Vec::new(), &mut found);
        for path in found {
            for change in ListChange::ALL {
                let mut own = value.clone();
                let list = find_list(&mut own, &path);
                if list.as_array().is_some_and(|items| items.len() > MAX_LIST_LENGTH) {
                    continue;
                }
                change.apply(list);
                if own == value {
                    continue;
                }
                let text = toml::to_string(&own).expect("TOML");
                let is_taken = Case::parse(&text, &file, &[]).is_ok();
                let is_valid = validator.is_valid(&toml_to_json(&own));
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
    let unexpected: Vec<&String> = by_program_alone
        .iter()
        .filter(|own| !PROGRAM_ONLY_ERRORS.contains(&own.as_str()))
        .collect();
    assert!(unexpected.is_empty(), "{unexpected:?}");
}
