//! Rheological schemes in case files: reading, writing, and messages of wrong input.

use wellposed_cases::template::{TemplateKind, generate_template};
use wellposed_cases::{Case, LoadHistory, ModelKind};

const NAMED: &str = "\
title = 'pores'
[rheology]
kind = 'porous-elastic'
skeleton_modulus = 1e9
contact_modulus = 3e9
porosity = 0.02
[load_path]
points = [[0, 0], [1, -0.05]]
steps = 10
";

const TREE: &str = "\
[rheology]
kind = 'tree'
tree = 'a | (b - c)'

[[rheology.element]]
name = 'a'
kind = 'spring'
modulus = 1e9

[[rheology.element]]
name = 'b'
kind = 'spring'
modulus = 3e9

[[rheology.element]]
name = 'c'
kind = 'contact'
gap = 0.02

[load_path]
turning_values = [-0.05, 0.01]
rate = 0.1
";

fn parse(text: &str, options: &[&str]) -> Result<Case, String> {
    let options: Vec<String> = options.iter().map(|own| (*own).to_owned()).collect();
    Case::parse(text, "x.toml", &options).map_err(|error| error.to_string())
}

#[test]
fn named_schemes_and_trees_are_read() {
    let named = parse(NAMED, &[]).expect("a case");
    let tree = parse(TREE, &[]).expect("a case");
    let [named, tree] = [&named, &tree].map(|case| case.require_rheology().expect("a scheme"));
    let elements = |own: &wellposed_cases::RheologyCase| {
        own.scheme.elements().iter().map(|own| own.element).collect::<Vec<_>>()
    };
    assert_eq!(elements(named), elements(tree));
    assert_eq!(named.scheme.notation(), "skeleton | (particles - contact)");
    assert_eq!(tree.scheme.notation(), "a | (b - c)");
    assert_eq!(named.path.points(), [[0.0, 0.0], [1.0, -0.05]]);
    let cycles = LoadHistory::Cycles { turning_values: vec![-0.05, 0.01], cycles: 1, rate: 0.1 };
    assert_eq!(tree.history, cycles);
    let end = tree.path.points()[2];
    assert!((end[0] - 1.1).abs() < 1e-15 && end[1] == 0.01);
}

#[test]
fn resolved_schemes_parse_to_equal_cases() {
    let template = generate_template(ModelKind::Rheology.into(), TemplateKind::SingleState);
    for text in [NAMED, TREE, &template] {
        let case = parse(text, &[]).expect("a case");
        let resolved = case.to_toml();
        let reparsed = parse(&resolved, &[]).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(reparsed, case);
        assert_eq!(reparsed.to_toml(), resolved);
    }
}

#[test]
fn options_override_keys_of_schemes() {
    let options = ["rheology.element[2].gap=0.03", "load_path.steps=7", "name=other"];
    let case = parse(TREE, &options).expect("a case");
    let rheology = case.require_rheology().expect("a scheme");
    assert_eq!(rheology.scheme.elements()[2].element.constants(), [("gap", 0.03)]);
    assert_eq!((rheology.path.steps_per_segment(), case.name.as_str()), (7, "other"));
}

#[test]
fn wrong_sections_are_refused_with_file_line_and_key() {
    for (text, found, replacement, message) in [
        (NAMED, "porous-elastic", "porous", "x.toml:3: rheology.kind: found 'porous'; "),
        (
            NAMED,
            "porosity = 0.02",
            "gap = 0.02",
            "x.toml:2: rheology.porosity: missing; add porosity to [rheology]: expected",
        ),
        (
            NAMED,
            "porosity = 0.02",
            "porosity = 0.02\ngap = 1",
            "x.toml:7: rheology.gap: unknown key; allowed here: kind, skeleton_modulus, contact_modulus, porosity",
        ),
        (
            NAMED,
            "porosity = 0.02",
            "porosity = -0.02",
            "x.toml:6: rheology.porosity: found -0.02; expected",
        ),
        (
            NAMED,
            "contact_modulus = 3e9",
            "contact_modulus = 0",
            "x.toml:5: rheology.contact_modulus: found 0; expected",
        ),
        (
            NAMED,
            "points = [[0, 0], [1, -0.05]]",
            "points = [[0, 0], [0, -0.05]]",
            "x.toml:8: load_path.points: the time 0 s is not above that of the point before; give increasing times",
        ),
        (
            NAMED,
            "points = [[0, 0], [1, -0.05]]",
            "points = [[0, 0]]",
            "x.toml:8: load_path.points: a path needs at least two points; give increasing times",
        ),
        (
            NAMED,
            "steps = 10",
            "steps = 1000000",
            "x.toml:9: load_path.steps: 1000000 steps in total; expected at most 100000 steps in total",
        ),
        (NAMED, "steps = 10", "steps = 0", "x.toml:9: load_path.steps: found 0; expected"),
        (
            NAMED,
            "steps = 10",
            "rate = 1",
            "x.toml:9: load_path.rate: found, but not used here; leave it out: it is used beside turning_values only",
        ),
        (
            NAMED,
            "[load_path]\npoints = [[0, 0], [1, -0.05]]\nsteps = 10",
            "",
            "x.toml: load_path: missing; add",
        ),
        (
            NAMED,
            "steps = 10",
            "[model]\nkind = 'classical'",
            "x.toml:9: model: not used by a rheological scheme; leave it out",
        ),
        (
            NAMED,
            "steps = 10",
            "[grid]\ncells = [3, 3]",
            "x.toml:9: grid: not used by a rheological scheme; leave it out",
        ),
        (
            NAMED,
            "steps = 10",
            "[wave]\nnumber = 1",
            "x.toml:9: wave: not used by a rheological scheme; leave it out",
        ),
        (
            TREE,
            "'a | (b - c)'",
            "'a | b - c'",
            "x.toml:3: rheology.tree: found the text 'a | b - c'; - and | without parentheses at '- c'",
        ),
        (
            TREE,
            "'a | (b - c)'",
            "'a | (b - x)'",
            "x.toml:3: rheology.tree: found the text 'a | (b - x)'; no element is called 'x'",
        ),
        (
            TREE,
            "'a | (b - c)'",
            "'a | (b - b)'",
            "x.toml:3: rheology.tree: found the text 'a | (b - b)'; the element 'b' occurs twice",
        ),
        (
            TREE,
            "'a | (b - c)'",
            "'a | b'",
            "x.toml:16: rheology.element[2].name: found 'c'; the element 'c' is not in the tree",
        ),
        (TREE, "'a | (b - c)'", "'b - (a | c)'", ""),
        (
            TREE,
            "'a | (b - c)'",
            "'a | b | c'",
            "x.toml:3: rheology.tree: found a | b | c; the branch c admits no compression beyond its gap",
        ),
        (
            TREE,
            "name = 'b'",
            "name = 'a'",
            "x.toml:11: rheology.element[1].name: found 'a'; two elements are called 'a'",
        ),
        (
            TREE,
            "name = 'b'",
            "name = 'b-1'",
            "x.toml:11: rheology.element[1].name: found 'b-1'; 'b-1' is no name",
        ),
        (
            TREE,
            "modulus = 3e9",
            "modulus = -3e9",
            "x.toml:13: rheology.element[1].modulus: found -3e9; expected",
        ),
        (
            TREE,
            "modulus = 3e9",
            "viscosity = 3e9",
            "x.toml:10: rheology.element[1].modulus: missing; add modulus to rheology.element[1]",
        ),
        (
            TREE,
            "gap = 0.02",
            "gap = -0.02",
            "x.toml:18: rheology.element[2].gap: found -0.02; expected",
        ),
        (
            TREE,
            "gap = 0.02",
            "gip = 0.02",
            "x.toml:18: rheology.element[2].gip: unknown key; did you mean 'gap'?",
        ),
        (
            TREE,
            "kind = 'contact'",
            "kind = 'kontact'",
            "x.toml:17: rheology.element[2].kind: found 'kontact'; did you mean 'contact'?",
        ),
        (TREE, "rate = 0.1", "rate = 0", "x.toml:22: load_path.rate: found 0; expected"),
        (
            TREE,
            "[-0.05, 0.01]",
            "[0.0]",
            "x.toml:21: load_path.turning_values: found no turning value; give at least one",
        ),
        (
            TREE,
            "rate = 0.1",
            "rate = 0.1\npoints = [[0, 0], [1, 1]]",
            "x.toml:23: load_path.points: found beside turning_values; give one of them",
        ),
    ] {
        let changed = text.replacen(found, replacement, 1);
        assert_ne!(changed, text);
        match parse(&changed, &[]) {
            Ok(_) => assert_eq!(message, "", "{changed}"),
            Err(error) => {
                assert!(!message.is_empty() && error.starts_with(message), "{error}\n{message}");
            }
        }
    }
}

#[test]
fn chains_without_spring_are_refused() {
    let text = TREE.replace(
        "kind = 'spring'\nmodulus = 3e9",
        "kind = 'hinge'\ncompressive_yield_stress = 1\ntensile_yield_stress = 1",
    );
    let error = parse(&text, &[]).expect_err("a chain of contact and hinge");
    assert_eq!(
        error,
        "x.toml:3: rheology.tree: found the text 'a | (b - c)'; the chain b - c has neither spring nor damper, so that the \
         strains of its elements are not unique; put a spring or a damper in series"
    );
}

#[test]
fn an_option_with_a_wrong_value_is_named() {
    let error = parse(NAMED, &["rheology.porosity=-1"]).expect_err("a negative gap");
    assert!(
        error.starts_with("--set rheology.porosity=-1: rheology.porosity: found -1;"),
        "{error}"
    );
}
