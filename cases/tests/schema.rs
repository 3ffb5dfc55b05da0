//! Verifies the schema: templates, reference page and JSON Schema have the same keys; an independent validator accepts
//! all bundled and generated cases; program and validator refuse the same invalid cases.

mod support;

use jsonschema::Validator;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::Path;
use support::{bundled_case_files, toml_to_json};
use testkit::ranges::{closed_ends, values_just_inside, values_outside};
use wellposed_cases::schema::{TableSchema, ValueType};
use wellposed_cases::template::{TemplateKind, generate_template};
use wellposed_cases::{
    Case, Key, MediumKind, ModelKind, all_schemas, generate_json_schema, generate_reference, keys,
};

type KeyNames = BTreeSet<String>;

const ALL_TEMPLATES: [TemplateKind; 5] = [
    TemplateKind::SingleState,
    TemplateKind::Simulation,
    TemplateKind::BlockySimulation,
    TemplateKind::GranularPlaneWave,
    TemplateKind::PorousPlaneWave,
];

/// Returns all keys by section and name, e.g. `model.mu`, `load.time.kind`. A key of both solids and flows occurs once.
fn collect_all_keys() -> KeyNames {
    let mut names: KeyNames = keys().iter().map(|key| key.name.to_owned()).collect();
    for (_, forms) in all_schemas() {
        for table_schema in forms {
            collect_schema_keys(&mut names, table_schema.name, table_schema);
        }
    }
    names
}

fn collect_schema_keys(names: &mut KeyNames, path: &str, table_schema: &'static TableSchema) {
    for (_, item) in table_schema.keys() {
        let name = format!("{path}.{}", item.name);
        if let ValueType::Table(inner) | ValueType::TableList(inner) = item.value_type {
            collect_schema_keys(names, &name, inner);
        }
        names.insert(name);
    }
}

/// Returns the former names of sections and of keys by section.
fn former_names() -> KeyNames {
    let schemas = all_schemas().into_iter().flat_map(|(_, forms)| forms);
    let in_schema = |table_schema: &'static TableSchema| {
        let keys = table_schema.keys().filter_map(|(_, item)| item.former_name);
        let keys = keys.map(|name| format!("{}.{name}", table_schema.name));
        table_schema.former_name.map(str::to_owned).into_iter().chain(keys)
    };
    schemas.flat_map(in_schema).collect()
}

/// Collects the keys of an object of the JSON Schema and of nested objects, including conditional ones, without former
/// names.
fn collect_properties(schema: &Value, root: &Value, path: &str, names: &mut KeyNames) {
    if let Some(reference) = schema["$ref"].as_str() {
        let inner = root.pointer(reference.trim_start_matches('#')).expect("a definition");
        return collect_properties(inner, root, path, names);
    }
    for (name, inner) in schema["properties"].as_object().into_iter().flatten() {
        let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
        if *inner != json!(false) && !former_names().contains(&path) {
            collect_properties(inner, root, &path, names);
            names.insert(path);
        }
    }
    collect_nested_properties(schema, root, path, names);
}

fn collect_nested_properties(schema: &Value, root: &Value, path: &str, names: &mut KeyNames) {
    if schema["items"].is_object() {
        collect_properties(&schema["items"], root, path, names);
    }
    for part in ["allOf", "anyOf"].iter().flat_map(|list| schema[list].as_array()).flatten() {
        collect_properties(&part["then"], root, path, names);
        collect_properties(part, root, path, names);
    }
}

/// Removes the names of sections, and keys of tables whose keys are defined by other sections.
fn remove_sections(names: KeyNames) -> KeyNames {
    let all = collect_all_keys();
    let is_inside = |name: &String| {
        let of_material =
            ["region.model.", "region.yield.", "block.model.", "block.yield.", "block.materials."];
        name.starts_with("initial_stress.")
            || of_material.iter().any(|start| name.starts_with(start)) && !all.contains(name)
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
fn assert_same_names(one: &KeyNames, other: &KeyNames) {
    let missing: Vec<_> = other.difference(one).collect();
    let surplus: Vec<_> = one.difference(other).collect();
    assert!(one == other, "missing: {missing:?}, surplus: {surplus:?}");
}

#[test]
fn json_schema_has_exactly_all_keys() {
    let schema = generate_json_schema();
    let mut names = KeyNames::new();
    // Cases whose model is given as equations have a branch of their own.
    collect_properties(&schema["then"], &schema, "", &mut names);
    collect_properties(&schema["else"], &schema, "", &mut names);
    names.remove("background.value");
    assert_same_names(&remove_sections(names), &collect_all_keys());
}

/// Verifies that the root of the schema, from which editors complete and explain keys, has all keys as well.
#[test]
fn root_of_json_schema_has_exactly_all_keys() {
    let schema = generate_json_schema();
    let mut names = KeyNames::new();
    collect_properties(&schema, &schema, "", &mut names);
    names.remove("background.value");
    assert_same_names(&remove_sections(names), &collect_all_keys());
}

#[test]
fn reference_page_has_exactly_all_keys() {
    let (mut names, mut section) = (KeyNames::new(), String::new());
    let tables = ["time", "profile", "materials", "inside", "element"];
    for line in generate_reference().lines() {
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
    // Both axes of a map of a model given as equations.
    names.retain(|name| !name.starts_with("{axis}."));
    let in_page = |name: &String| {
        let path: Vec<&str> = name.split('.').collect();
        match path[..] {
            [_, table, key] if tables.contains(&table) => format!("{{{table}}}.{key}"),
            _ => name.clone(),
        }
    };
    assert_same_names(&names, &collect_all_keys().iter().map(in_page).collect());
}

/// Collects the keys in a template, including keys that are commented out.
fn collect_template_keys(text: &str, names: &mut KeyNames) {
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
        // Keys of an inline table, and keys for three dimensions listed in its comment.
        for (inner, _) in value.split(['{', ',']).filter_map(|part| part.split_once(" = ")) {
            let inner = inner.trim().trim_start_matches("in 3D also ");
            if value.starts_with('{') && is_key(inner) {
                names.insert(format!("{name}.{inner}"));
            }
        }
        if let Some((_, rest)) = value.split_once("in 3D also ") {
            names.insert(format!("{name}.{}", rest.split(' ').next().unwrap_or_default()));
        }
        names.insert(name);
    }
}

#[test]
fn templates_have_exactly_all_keys() {
    let mut names = KeyNames::new();
    for medium in MediumKind::all_media() {
        for purpose in ALL_TEMPLATES {
            collect_template_keys(&generate_template(medium, purpose), &mut names);
        }
    }
    let rheology = generate_template(ModelKind::Rheology.into(), TemplateKind::SingleState);
    collect_template_keys(&rheology, &mut names);
    // Names that the template of a model given as equations chooses are inside these tables.
    let mut own = KeyNames::new();
    let equations = generate_template(ModelKind::Equations.into(), TemplateKind::SingleState);
    collect_template_keys(&equations, &mut own);
    for name in own.into_iter().filter(|name| !name.starts_with("background.")) {
        let tables = ["model.unknowns", "model.parameters", "model.define", "model.equations"];
        let table = tables.into_iter().find(|table| name.starts_with(&format!("{table}.")));
        names.insert(table.map_or(name.clone(), str::to_owned));
    }
    let mut expected = collect_all_keys();
    // `map.x` and `map.y` are inline tables, whose keys are rows of the key table.
    names.retain(|name| name != "map.x" && name != "map.y");
    expected.retain(|name| name != "map.x" && name != "map.y");
    // Inline tables and the parameters of shapes are written in full once; their keys are equal in all sections.
    let fold = |name: &str| match name.split('.').collect::<Vec<_>>()[..] {
        [_, table @ ("time" | "profile"), key] => format!("{table}.{key}"),
        ["initial", key @ ("center" | "point" | "normal")] => format!("region.{key}"),
        ["block", "materials", key] => format!("block.{key}"),
        // The elements are a list of inline tables.
        ["rheology", "element", _] => "rheology.element".to_owned(),
        _ => name.to_owned(),
    };
    expected = expected.iter().map(|name| fold(name)).collect();
    assert_same_names(&remove_sections(names.iter().map(|name| fold(name)).collect()), &expected);
}

#[test]
fn reference_page_is_up_to_date() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reference.md");
    let page = std::fs::read_to_string(file).expect("the page");
    assert!(
        page == generate_reference(),
        "write it anew: wellposed schema --markdown > docs/reference.md"
    );
}

fn build_validator() -> Validator {
    jsonschema::draft202012::new(&generate_json_schema()).expect("a schema")
}

/// Parses a case and converts it to JSON.
fn parse_to_json(text: &str) -> Value {
    toml_to_json(&toml::Value::Table(text.parse().expect("TOML")))
}

#[test]
fn former_names_are_read_with_hints() {
    let former = SOLID_CASE.replace("[[boundary]]", "[[side]]").replace("fixed_components", "held");
    let current = Case::parse(SOLID_CASE, "x.toml", &[]).expect("a case");
    let read = Case::parse(&former, "x.toml", &[]).expect("a case");
    assert!(read == current && read.to_toml() == current.to_toml());
    assert!(read.to_toml().contains("[[boundary]]") && current.hints().is_empty());
    let hints: Vec<String> = read.hints().iter().map(ToString::to_string).collect();
    let line = |text: &str| 1 + former.lines().position(|own| own.starts_with(text)).expect("it");
    let end = "the old name is read for one more version";
    let expected = [
        format!("x.toml:{}: [[side]] is now [[boundary]]; {end}", line("[[side]]")),
        format!("x.toml:{}: held is now fixed_components; {end}", line("held")),
    ];
    assert_eq!(hints, expected);
    assert!(build_validator().is_valid(&parse_to_json(&former)));

    // Options: keys with former names, and former names inside a value.
    for set in [
        "side[0].held=['v2']",
        "boundary[0].held=['v2']",
        "boundary[0].fixed_components=['v2']",
        "side[0]={ side = 'x1-', kind = 'mixed', held = ['v2'] }",
    ] {
        for text in [SOLID_CASE, &former] {
            let case = Case::parse(text, "x.toml", &[set.to_owned()]).expect("a case");
            let resolved = case.to_toml();
            assert!(resolved.contains("fixed_components = [\"v2\"]"), "{set}: {resolved}");
            let uses_former = text == former || set.contains("side[") || set.contains("held");
            assert_eq!(!case.hints().is_empty(), uses_former, "{set}");
        }
    }
    let sets = ["side[0].kind=free".to_owned(), "boundary[0].held=['v1']".to_owned()];
    let error = Case::parse(SOLID_CASE, "x.toml", &sets).expect_err("an unused key").to_string();
    assert!(error.starts_with("--set boundary[0].held=['v1']: boundary[0]."), "{error}");
}

#[test]
fn former_and_current_name_together_are_refused() {
    let validator = build_validator();
    for (found, replacement, message) in [
        (
            "[[load]]",
            "[[side]]\nside = 'x1+'\nkind = 'free'\n[[load]]",
            "side: found [[side]] and [[boundary]]; write [[boundary]] alone; [[side]] is its former name",
        ),
        (
            "fixed_components = ['v1']",
            "fixed_components = ['v1']\nheld = ['v2']",
            "boundary[0].held: found held and fixed_components; write fixed_components alone; held is \
             its former name",
        ),
    ] {
        let text = SOLID_CASE.replace(found, replacement);
        let error = Case::parse(&text, "x.toml", &[]).expect_err("both names").to_string();
        assert!(error.starts_with("x.toml:") && error.ends_with(message), "{error}");
        assert!(!validator.is_valid(&parse_to_json(&text)), "{replacement}");
    }
}

#[test]
fn bundled_resolved_and_template_cases_are_valid() {
    let validator = build_validator();
    let check = |what: &str, text: &str| {
        let case = parse_to_json(text);
        let errors: Vec<String> =
            validator.iter_errors(&case).map(|error| error.to_string()).collect();
        assert!(errors.is_empty(), "{what}: {errors:#?}");
    };
    for file in bundled_case_files() {
        let text = std::fs::read_to_string(&file).expect("a case");
        let name = file.display().to_string();
        check(&name, &text);
        check(&name, &Case::load(&file, &[]).expect("a case").to_toml());
    }
    for medium in MediumKind::all_media().chain(ModelKind::WITHOUT_ENTRY.map(MediumKind::from)) {
        for purpose in ALL_TEMPLATES {
            let text = generate_template(medium, purpose);
            check(&medium.title(), &text);
            let case = Case::parse(&text, "new.toml", &[]).expect("a case");
            check(&medium.title(), &case.to_toml());
        }
    }
}

const EQUATIONS_CASE: &str = include_str!("../src/template/equations.toml");

const SOLID_CASE: &str = include_str!("data/solid.toml");

const FLOW_CASE: &str = include_str!("data/flow.toml");

/// Modifications that make a case invalid: case, text replaced, and its replacement.
#[rustfmt::skip]
const INVALID_MODIFICATIONS: &[(&str, &str, &str)] = &[
    // Unknown keys, and known keys that are not used.
    (SOLID_CASE, "mu = 1e9", "mu = 1e9\nmv = 1"),
    (SOLID_CASE, "mu = 1e9", "mu = 1e9\nalpha = 1"),
    (SOLID_CASE, "[gravity]", "[gravty]"),
    (SOLID_CASE, "spacing = 1", "spacing = 1\nlength = 1"),
    (SOLID_CASE, "fixed_components = ['v1']", "fixed_components = ['v1']\nshape = 'box'"),
    (SOLID_CASE, "axis = 2\n", "axis = 2\nradius = 1\n"),
    (SOLID_CASE, "frequency = 5 }", "frequency = 5, duration = 1 }"),
    (SOLID_CASE, "model = { mu = 2e9 }", "model = { mv = 2e9 }"),
    (SOLID_CASE, "[check]", "[limits]\nshear_rate = 0.1\n[check]"),
    (SOLID_CASE, "strength = 1e6", "strength = 1e6\nshear_strength = 1"),
    (FLOW_CASE, "density = 1600", "density = 1600\nstress_angle_rate_deg = 1"),
    (FLOW_CASE, "[[receiver]]", "[gravity]\nacceleration = [0, 1]\n[[receiver]]"),
    (FLOW_CASE, "seed = 1", "seed = 1\nradius = 1"),
    (FLOW_CASE, "at = [0.05, 0.05]", "at = [0.05, 0.05]\ninterpolation = 'cubic'"),
    // Wrong types.
    (SOLID_CASE, "mu = 1e9", "mu = '1e9'"),
    (SOLID_CASE, "cells = [20, 10]", "cells = [20.5, 10]"),
    (SOLID_CASE, "fixed_components = ['v1']", "fixed_components = 'v1'"),
    (SOLID_CASE, "time = { kind = 'ricker', frequency = 5 }", "time = 'ricker'"),
    (SOLID_CASE, "count = 3", "count = true"),
    (FLOW_CASE, "amplitude = 1e-4", "amplitude = [1e-4]"),
    (FLOW_CASE, "at = [0.05, 0.05]", "at = 0.05"),
    // Missing keys and sections.
    (SOLID_CASE, "lambda = 1e9\n", ""),
    (SOLID_CASE, "kind = 'drucker-prager'\n", ""),
    (SOLID_CASE, "friction = 0.5\n", ""),
    (SOLID_CASE, "[time]\nduration = 1\n", ""),
    (SOLID_CASE, "duration = 1\n", ""),
    (SOLID_CASE, "fixed_components = ['v1']\n", ""),
    (SOLID_CASE, "to = 10\n", ""),
    (SOLID_CASE, ", frequency = 5", ""),
    (SOLID_CASE, "count = 3\n", ""),
    (FLOW_CASE, "moment_of_inertia = 1e-7\n", ""),
    (FLOW_CASE, "pressure = 1000\n", ""),
    (FLOW_CASE, "length = 0.1\n", ""),
    (FLOW_CASE, "seed = 1\n", ""),
    // Numbers out of range and unknown names.
    (SOLID_CASE, "duration = 1\n", "duration = 0\n"),
    (SOLID_CASE, "duration = 1\n", "duration = 1\ncourant = 1.5\n"),
    (SOLID_CASE, "cells = [20, 10]", "cells = [20, 0]"),
    (SOLID_CASE, "spacing = 1", "spacing = [1, -1]"),
    (SOLID_CASE, "shape = 'layer'", "shape = 'layr'"),
    (SOLID_CASE, "kind = 'mixed'", "kind = 'mixd'"),
    (SOLID_CASE, "field = 'sigma22'", "field = 'sigma44'"),
    (SOLID_CASE, "kind = 'drucker-prager'", "kind = 'cosserat-mises'\nantisymmetric_weight = 1"),
    (SOLID_CASE, "numbers = [1]", "numbers = [-1]"),
    (SOLID_CASE, "count = 3", "count = 1"),
    (FLOW_CASE, "kind = 'harris-grekova'", "kind = 'harris-grekov'"),
    (FLOW_CASE, "cells = [32, 32]", "cells = [32, 31]"),
    (FLOW_CASE, "duration = 1e-3", "duration = 1e-3\ntolerance = 1"),
    (FLOW_CASE, "from = 1\n", "from = 0\n"),
    // Invalid names and dimensions, and lists of other length than the number of axes.
    (SOLID_CASE, "[model]", "name = 'a/b'\n[model]"),
    (SOLID_CASE, "[model]", "name = '..'\n[model]"),
    (SOLID_CASE, "[model]", "name = ''\n[model]"),
    (SOLID_CASE, "mu = 1e9", "mu = 1e9\ndimensions = 4"),
    (SOLID_CASE, "mu = 1e9", "mu = 1e9\ndimensions = 3"),
    (SOLID_CASE, "acceleration = [0, -9.81]", "acceleration = [0, 0, -9.81]"),
    (SOLID_CASE, "at = [5, 5]", "at = [5, 5, 5]"),
    (SOLID_CASE, "axis = 2\n", "axis = 3\n"),
    (FLOW_CASE, "at = [0.05, 0.05]", "at = [0.05, 0.05, 0.05]"),
    (FLOW_CASE, "[background]", "[compare]\nkinds = []\n[background]"),
    // Models given as equations.
    (EQUATIONS_CASE, "a = { value = 2.0, unit", "a = { valu = 2.0, unit"),
    (EQUATIONS_CASE, "c = 1.0", "c = '1.0'"),
    (EQUATIONS_CASE, "c = 1.0", "c = { value = 1.0, dx = 2 }"),
    (EQUATIONS_CASE, "number = 1000.0", "number = -1"),
    (EQUATIONS_CASE, "dimensions = 2", "dimension = 2"),
    (EQUATIONS_CASE, "[wave]", "[yield]\nkind = 'von-mises'\n[wave]"),
    // Mutually exclusive keys.
    (SOLID_CASE, "at = 5\n", "at = 5\nfrom = 1\nto = 2\n"),
    (SOLID_CASE, "count = 3", "count = 3\nat = [1, 1]"),
    (SOLID_CASE, "frequency = 5 }", "frequency = 5 }\nprofile = { kind = 'bell', at = 0, radius = 1 }"),
];

/// Verifies that program and validator both refuse each modified case.
#[test]
fn invalid_cases_are_rejected_by_schema_and_program() {
    let validator = build_validator();
    for text in [SOLID_CASE, FLOW_CASE, EQUATIONS_CASE] {
        Case::parse(text, "x.toml", &[]).expect("a sound case");
        assert!(validator.is_valid(&parse_to_json(text)));
    }
    for (text, old, new) in INVALID_MODIFICATIONS {
        assert!(text.contains(old), "{old}");
        let text = text.replacen(old, new, 1);
        assert!(Case::parse(&text, "x.toml", &[]).is_err(), "the program takes {new}");
        assert!(!validator.is_valid(&parse_to_json(&text)), "the validator takes {new}");
    }
}

/// Returns the case in JSON with another value of a key.
fn with_key_value(case: &Value, key: &Key, value: f64) -> Value {
    let (section, name) = key.split_section();
    let mut case = case.clone();
    case[section][name] = value.into();
    case
}

/// Verifies that the schema refuses numbers outside the range of each key and accepts numbers inside.
#[test]
fn schema_rejects_numbers_out_of_range() {
    let validator = build_validator();
    for medium in MediumKind::all_media() {
        let case = parse_to_json(&generate_template(medium, TemplateKind::SingleState));
        let is_number = |key: &&Key| matches!(key.value_type(), ValueType::Number(_));
        let numbers = keys().iter().filter(is_number).filter(|key| key.is_used_by(medium));
        for key in numbers.filter(|key| !key.name.starts_with("map.")) {
            let what = format!("{} of {}", key.name, medium.title());
            for value in values_outside(key.range) {
                assert!(
                    !validator.is_valid(&with_key_value(&case, key, value)),
                    "{what} = {value:?}"
                );
            }
            for value in closed_ends(key.range).into_iter().chain(values_just_inside(key.range)) {
                assert!(
                    validator.is_valid(&with_key_value(&case, key, value)),
                    "{what} = {value:?}"
                );
            }
        }
    }
    // The range also applies in a region.
    let text = SOLID_CASE.replace("model = { mu = 2e9 }", "model = { mu = -2e9 }");
    assert!(!validator.is_valid(&parse_to_json(&text)));
}
