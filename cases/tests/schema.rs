//! Verifies the schema: templates, reference page and JSON Schema have the same keys; an independent validator accepts
//! all bundled and generated cases; program and validator refuse the same invalid cases.

use jsonschema::Validator;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use testkit::ranges::{closed_ends, just_inside, outside};
use wellposed_cases::schema::{Form, Type};
use wellposed_cases::template::{Purpose, text_for};
use wellposed_cases::{Case, Key, Medium, all_forms, json_schema, keys, reference};

type Names = BTreeSet<String>;

/// Returns all keys by section and name, e.g. `model.mu`, `load.time.kind`. A key of both solids and flows occurs once.
fn all_keys() -> Names {
    let mut names: Names = keys().iter().map(|key| key.name.to_owned()).collect();
    for (_, forms) in all_forms() {
        for form in forms {
            add_items(&mut names, form.name, form);
        }
    }
    names
}

fn add_items(names: &mut Names, path: &str, form: &'static Form) {
    for (_, item) in form.items() {
        let name = format!("{path}.{}", item.name);
        if let Type::Table(inner) = item.value {
            add_items(names, &name, inner);
        }
        names.insert(name);
    }
}

/// Collects the keys of an object of the JSON Schema and of nested objects, including conditional ones.
fn properties(schema: &Value, root: &Value, path: &str, names: &mut Names) {
    if let Some(reference) = schema["$ref"].as_str() {
        let inner = root.pointer(reference.trim_start_matches('#')).expect("a definition");
        return properties(inner, root, path, names);
    }
    for (name, inner) in schema["properties"].as_object().into_iter().flatten() {
        if *inner != json!(false) {
            let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
            properties(inner, root, &path, names);
            names.insert(path);
        }
    }
    properties_of_parts(schema, root, path, names);
}

fn properties_of_parts(schema: &Value, root: &Value, path: &str, names: &mut Names) {
    if schema["items"].is_object() {
        properties(&schema["items"], root, path, names);
    }
    for part in ["allOf", "anyOf"].iter().flat_map(|list| schema[list].as_array()).flatten() {
        properties(&part["then"], root, path, names);
        properties(part, root, path, names);
    }
}

/// Removes the names of sections, and keys of tables whose keys are defined by other sections.
fn leaves(names: Names) -> Names {
    let all = all_keys();
    let is_inside = |name: &String| {
        name.starts_with("region.model.")
            || name.starts_with("region.yield.")
            || name.starts_with("initial_stress.")
    };
    let is_section = |name: &String| {
        !all.contains(name) && all.iter().any(|own| own.starts_with(&format!("{name}.")))
    };
    names
        .into_iter()
        .filter(|name| !is_inside(name) && !is_section(name) && name != "initial_stress")
        .collect()
}

/// Asserts that two sets of names are equal; otherwise lists the names that only one set has.
fn assert_same(one: &Names, other: &Names) {
    let missing: Vec<_> = other.difference(one).collect();
    let surplus: Vec<_> = one.difference(other).collect();
    assert!(one == other, "missing: {missing:?}, surplus: {surplus:?}");
}

#[test]
fn the_json_schema_has_all_keys_and_no_others() {
    let schema = json_schema();
    let mut names = Names::new();
    properties(&schema, &schema, "", &mut names);
    assert_same(&leaves(names), &all_keys());
}

#[test]
fn the_reference_page_has_all_keys_and_no_others() {
    let (mut names, mut section) = (Names::new(), String::new());
    let tables = ["time", "profile"];
    for line in reference().lines() {
        if let Some(title) = line.strip_prefix("## ").or(line.strip_prefix("### ")) {
            let name = title.split('`').nth(1).unwrap_or_default();
            section = name.trim_matches(['[', ']']).trim_end_matches(" = { … }").to_owned();
            // Inline tables may occur in several sections.
            if name.contains('{') {
                section = format!("{{{section}}}");
            }
        }
        let key = line.strip_prefix("| `").and_then(|rest| rest.split_once('`')).map(|own| own.0);
        if let Some(key) = key.filter(|_| section != "initial_stress") {
            names.insert(if section.is_empty() { key.into() } else { format!("{section}.{key}") });
        }
    }
    let in_page = |name: &String| {
        let path: Vec<&str> = name.split('.').collect();
        match path[..] {
            [_, table, key] if tables.contains(&table) => format!("{{{table}}}.{key}"),
            _ => name.clone(),
        }
    };
    assert_same(&names, &all_keys().iter().map(in_page).collect());
}

/// Collects the keys in a template, including keys that are commented out.
fn shown(text: &str, names: &mut Names) {
    let mut section = String::new();
    for line in text.lines() {
        let line = line.strip_prefix("# ").unwrap_or(line);
        if line.starts_with('[') {
            section = line.trim_matches(['[', ']']).to_owned();
        }
        let is_key = |key: &str| key.chars().all(|c| c.is_ascii_alphanumeric() || "_.".contains(c));
        let Some((key, value)) = line.split_once(" = ").filter(|(key, _)| is_key(key)) else {
            continue;
        };
        let name = if section.is_empty() { key.into() } else { format!("{section}.{key}") };
        // Keys of an inline table, and keys in space that its comment lists.
        for (inner, _) in value.split(['{', ',']).filter_map(|part| part.split_once(" = ")) {
            let inner = inner.trim().trim_start_matches("in space also ");
            if value.starts_with('{') && is_key(inner) {
                names.insert(format!("{name}.{inner}"));
            }
        }
        if let Some((_, rest)) = value.split_once("in space also ") {
            names.insert(format!("{name}.{}", rest.split(' ').next().unwrap_or_default()));
        }
        names.insert(name);
    }
}

#[test]
fn the_templates_have_all_keys_and_no_others() {
    let mut names = Names::new();
    for medium in Medium::all() {
        for purpose in [Purpose::State, Purpose::Run] {
            shown(&text_for(medium, purpose), &mut names);
        }
    }
    let mut expected = all_keys();
    // Written as inline tables; their keys are listed in the key table.
    names.retain(|name| name != "map.x" && name != "map.y");
    // Inline tables and the parameters of shapes are written in full once; their keys are equal in all sections.
    let fold = |name: &str| match name.split('.').collect::<Vec<_>>()[..] {
        [_, table @ ("time" | "profile"), key] => format!("{table}.{key}"),
        ["initial", key @ ("center" | "point" | "normal")] => format!("region.{key}"),
        _ => name.to_owned(),
    };
    expected = expected.iter().map(|name| fold(name)).collect();
    assert_same(&leaves(names.iter().map(|name| fold(name)).collect()), &expected);
}

#[test]
fn the_reference_page_is_up_to_date() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference.md");
    let page = std::fs::read_to_string(file).expect("the page");
    assert!(page == reference(), "write it anew: wellposed schema --markdown > docs/reference.md");
}

fn validator() -> Validator {
    jsonschema::draft202012::new(&json_schema()).expect("a schema")
}

fn as_json(text: &str) -> Value {
    fn convert(value: &toml::Value) -> Value {
        match value {
            toml::Value::String(text) => json!(text),
            toml::Value::Integer(number) => json!(number),
            toml::Value::Float(number) => json!(number),
            toml::Value::Boolean(truth) => json!(truth),
            toml::Value::Datetime(date) => json!(date.to_string()),
            toml::Value::Array(items) => items.iter().map(convert).collect(),
            toml::Value::Table(table) => {
                let pairs = table.iter().map(|(key, value)| (key.clone(), convert(value)));
                Value::Object(pairs.collect())
            }
        }
    }
    convert(&toml::Value::Table(text.parse().expect("TOML")))
}

/// Returns the paths of the bundled case files.
fn shipped() -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = ["check", "cosserat", "dynamics", "flow", "granular-flow"];
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(root.join(folder)).expect("it"));
    let mut files: Vec<PathBuf> = files.map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|own| own == "toml"));
    files.sort();
    assert!(files.len() >= 29);
    files
}

#[test]
fn shipped_resolved_and_new_cases_are_valid() {
    let validator = validator();
    let check = |what: &str, text: &str| {
        let case = as_json(text);
        let errors: Vec<String> =
            validator.iter_errors(&case).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{what}: {errors:#?}");
    };
    for file in shipped() {
        let text = std::fs::read_to_string(&file).expect("a case");
        let name = file.display().to_string();
        check(&name, &text);
        check(&name, &Case::load(&file, &[]).expect("a case").to_toml());
    }
    for medium in Medium::all() {
        for purpose in [Purpose::State, Purpose::Run] {
            let text = text_for(medium, purpose);
            check(&medium.title(), &text);
            let case = Case::parse(&text, "new.toml", &[]).expect("a case");
            check(&medium.title(), &case.to_toml());
        }
    }
}

const SOLID: &str = "\
[model]
kind = 'classical'
lambda = 1e9
mu = 1e9
density = 2000
[yield]
kind = 'drucker-prager'
strength = 1e6
friction = 0.5
dilatancy = 0.5
[grid]
cells = [20, 10]
spacing = 1
[time]
duration = 1
[[region]]
shape = 'layer'
axis = 2
from = 0
to = 10
model = { mu = 2e9 }
[[side]]
side = 'x1-'
kind = 'mixed'
held = ['v1']
[[load]]
side = 'x2+'
field = 'sigma22'
amplitude = 1
at = 5
kernel = 'bell'
radius = 1
time = { kind = 'ricker', frequency = 5 }
[[initial]]
kind = 'pulse'
field = 'v1'
amplitude = 1
at = [5, 5]
radius = 1
[gravity]
acceleration = [0, -9.81]
[[receiver]]
from = [1, 1]
to = [5, 5]
count = 3
[check]
numbers = [1]
";

const FLOW: &str = "\
[model]
kind = 'harris-grekova'
friction_angle_deg = 30
moment_of_inertia = 1e-7
rotational_strength = 0
[background]
density = 1600
pressure = 1000
stress_angle_deg = 45
shear_rate = 50
[grid]
cells = [32, 32]
length = 0.1
[time]
duration = 1e-3
[[initial]]
kind = 'noise'
field = 'v'
from = 1
to = 6
amplitude = 1e-4
seed = 1
[[receiver]]
at = [0.05, 0.05]
";

/// Verifies that program and validator both refuse each modified case.
#[test]
fn spoiled_cases_are_refused_by_both() {
    let validator = validator();
    #[rustfmt::skip]
    let spoiled: &[(&str, &str, &str)] = &[
        // Unknown keys, and known keys that are not used.
        (SOLID, "mu = 1e9", "mu = 1e9\nmv = 1"),
        (SOLID, "mu = 1e9", "mu = 1e9\nalpha = 1"),
        (SOLID, "[gravity]", "[gravty]"),
        (SOLID, "spacing = 1", "spacing = 1\nlength = 1"),
        (SOLID, "held = ['v1']", "held = ['v1']\nshape = 'box'"),
        (SOLID, "axis = 2\n", "axis = 2\nradius = 1\n"),
        (SOLID, "frequency = 5 }", "frequency = 5, duration = 1 }"),
        (SOLID, "model = { mu = 2e9 }", "model = { mv = 2e9 }"),
        (SOLID, "[check]", "[limits]\nshear_rate = 0.1\n[check]"),
        (SOLID, "strength = 1e6", "strength = 1e6\nshear_strength = 1"),
        (FLOW, "density = 1600", "density = 1600\nstress_angle_rate_deg = 1"),
        (FLOW, "[[receiver]]", "[gravity]\nacceleration = [0, 1]\n[[receiver]]"),
        (FLOW, "seed = 1", "seed = 1\nradius = 1"),
        (FLOW, "at = [0.05, 0.05]", "at = [0.05, 0.05]\ninterpolation = 'cubic'"),
        // Wrong types.
        (SOLID, "mu = 1e9", "mu = '1e9'"),
        (SOLID, "cells = [20, 10]", "cells = [20.5, 10]"),
        (SOLID, "held = ['v1']", "held = 'v1'"),
        (SOLID, "time = { kind = 'ricker', frequency = 5 }", "time = 'ricker'"),
        (SOLID, "count = 3", "count = true"),
        (FLOW, "amplitude = 1e-4", "amplitude = [1e-4]"),
        (FLOW, "at = [0.05, 0.05]", "at = 0.05"),
        // Missing keys and sections.
        (SOLID, "lambda = 1e9\n", ""),
        (SOLID, "kind = 'drucker-prager'\n", ""),
        (SOLID, "friction = 0.5\n", ""),
        (SOLID, "[time]\nduration = 1\n", ""),
        (SOLID, "duration = 1\n", ""),
        (SOLID, "held = ['v1']\n", ""),
        (SOLID, "to = 10\n", ""),
        (SOLID, ", frequency = 5", ""),
        (SOLID, "count = 3\n", ""),
        (FLOW, "moment_of_inertia = 1e-7\n", ""),
        (FLOW, "pressure = 1000\n", ""),
        (FLOW, "length = 0.1\n", ""),
        (FLOW, "seed = 1\n", ""),
        // Numbers out of range and unknown words.
        (SOLID, "duration = 1\n", "duration = 0\n"),
        (SOLID, "duration = 1\n", "duration = 1\ncourant = 1.5\n"),
        (SOLID, "cells = [20, 10]", "cells = [20, 0]"),
        (SOLID, "spacing = 1", "spacing = [1, -1]"),
        (SOLID, "shape = 'layer'", "shape = 'layr'"),
        (SOLID, "kind = 'mixed'", "kind = 'mixd'"),
        (SOLID, "field = 'sigma22'", "field = 'sigma44'"),
        (SOLID, "kind = 'drucker-prager'", "kind = 'cosserat-mises'\nantisymmetric_weight = 1"),
        (SOLID, "numbers = [1]", "numbers = [-1]"),
        (SOLID, "count = 3", "count = 1"),
        (FLOW, "kind = 'harris-grekova'", "kind = 'harris-grekov'"),
        (FLOW, "cells = [32, 32]", "cells = [32, 31]"),
        (FLOW, "duration = 1e-3", "duration = 1e-3\ntolerance = 1"),
        (FLOW, "from = 1\n", "from = 0\n"),
        // Invalid names and dimensions, and lists of other length than the number of axes.
        (SOLID, "[model]", "name = 'a/b'\n[model]"),
        (SOLID, "[model]", "name = '..'\n[model]"),
        (SOLID, "[model]", "name = ''\n[model]"),
        (SOLID, "mu = 1e9", "mu = 1e9\ndimensions = 4"),
        (SOLID, "mu = 1e9", "mu = 1e9\ndimensions = 3"),
        (SOLID, "acceleration = [0, -9.81]", "acceleration = [0, 0, -9.81]"),
        (SOLID, "at = [5, 5]", "at = [5, 5, 5]"),
        (SOLID, "axis = 2\n", "axis = 3\n"),
        (FLOW, "at = [0.05, 0.05]", "at = [0.05, 0.05, 0.05]"),
        (FLOW, "[background]", "[compare]\nkinds = []\n[background]"),
        // Mutually exclusive keys.
        (SOLID, "at = 5\n", "at = 5\nfrom = 1\nto = 2\n"),
        (SOLID, "count = 3", "count = 3\nat = [1, 1]"),
        (SOLID, "frequency = 5 }", "frequency = 5 }\nprofile = { kind = 'bell', at = 0, radius = 1 }"),
    ];
    for text in [SOLID, FLOW] {
        Case::parse(text, "x.toml", &[]).expect("a sound case");
        assert!(validator.is_valid(&as_json(text)));
    }
    for (text, old, new) in spoiled {
        assert!(text.contains(old), "{old}");
        let text = text.replacen(old, new, 1);
        assert!(Case::parse(&text, "x.toml", &[]).is_err(), "the program takes {new}");
        assert!(!validator.is_valid(&as_json(&text)), "the validator takes {new}");
    }
}

/// Returns the case in JSON with another value of a key.
fn with_value(case: &Value, key: &Key, value: f64) -> Value {
    let (section, name) = key.split();
    let mut case = case.clone();
    case[section][name] = value.into();
    case
}

/// Verifies that the schema refuses numbers outside the range of each key and accepts numbers inside.
#[test]
fn numbers_out_of_range_are_refused_by_the_schema() {
    let validator = validator();
    for medium in Medium::all() {
        let case = as_json(&text_for(medium, Purpose::State));
        let is_number = |key: &&Key| matches!(key.value_type(), Type::Number(_));
        let numbers = keys().iter().filter(is_number).filter(|key| key.is_used_by(medium));
        for key in numbers.filter(|key| !key.name.starts_with("map.")) {
            let what = format!("{} of {}", key.name, medium.title());
            for value in outside(key.range) {
                assert!(!validator.is_valid(&with_value(&case, key, value)), "{what} = {value:?}");
            }
            for value in closed_ends(key.range).into_iter().chain(just_inside(key.range)) {
                assert!(validator.is_valid(&with_value(&case, key, value)), "{what} = {value:?}");
            }
        }
    }
    // The range also applies in a region.
    let text = SOLID.replace("model = { mu = 2e9 }", "model = { mu = -2e9 }");
    assert!(!validator.is_valid(&as_json(&text)));
}
