//! Tests of error messages: location, key and remedy of refused input.

use super::full_case::{FULL_CASE, derive_background, parse_full_case_with};
use crate::support::parse_case;
use models::registry;
use wellposed::case::{Case, ModelKind, SweepParameter};

/// Passage of [`FULL_CASE`], its replacement, location and key of the error, and words of its message.
#[rustfmt::skip]
const INVALID_INPUTS: &[(&str, &str, &str, &str)] = &[
    // unknown and misspelt keys
    ("pressure = 1000.25", "presure = 1", "11: background.presure: ", "did you mean 'pressure'?"),
    ("shear_rate = 2", "shear_rat = 2", "13: background.shear_rat: ", "'shear_rate'"),
    ("[background]", "[backgroud]", "9: backgroud: ", "did you mean 'background'?"),
    ("title =", "titel =", "1: titel: ", "'title'"),
    ("rotational_strength = 5", "density = 5", "7: model.density: ", "'background.density'"),
    ("title =", "'model.kind' = 'x'\ntitle =", "1: \"model.kind\": ", "unknown key"),
    ("points = 3", "pionts = 3", "24: map.y.pionts: ", "'points'? allowed here: parameter, from, to, points"),
    ("kinds = [", "kind = [", "27: compare.kind: ", "'model.kind'"),
    ("title =", "\"a\\u0007b\" = 1\ntitle =", "1: a\\u{7}b: ", "unknown key"),
    // wrong types
    ("density = 1600", "density = '1600'", "10: background.density: ", "found the text '1600'; expected a finite number in kg/m³"),
    ("density = 1600", "density = true", "10: background.density: ", "truth value"),
    ("density = 1600", "density = [1]", "10: background.density: ", "list of 1"),
    ("density = 1600", "density = 2026-11-21", "10: background.density: ", "date"),
    ("density = 1600", "density = { a = 1 }", "10: background.density: ", "section"),
    ("[0.5, 0.25]", "[0.5]", "14: background.velocity: ", "a pair of finite numbers [x1, x2]"),
    ("[0.5, 0.25]", "[0.5, 1, 2]", "14: background.velocity: ", "list of 3"),
    ("[0.5, 0.25]", "[0.5, 'a']", "14: background.velocity: ", "the text 'a'"),
    ("[0.5, 0.25]", "0.5", "14: background.velocity: ", "found 0.5"),
    ("spin = -0.125", "velocity_gradient = [1, 2]", "15: background.velocity_gradient: ", "[[a11, a12], [a21, a22]]"),
    ("'All sections'", "7", "1: title: ", "text in quotes"),
    ("'All sections'", "\"two\\nlines\"", "1: title: ", "text in quotes"),
    ("title =", "name = 3\ntitle =", "1: name: ", "found 3; expected text in quotes"),
    ("title =", "name = ''\ntitle =", "1: name: ", "found ''; expected 1 to 255 letters"),
    ("title =", "name = '..'\ntitle =", "1: name: ", "not only dots"),
    ("title =", "name = 'a/b'\ntitle =", "1: name: ", "found 'a/b'"),
    ("kind = 'harris-grekova'", "kind = 3", "3: model.kind: ", "harris-grekova, double-shearing"),
    ("kind = 'harris-grekova'", "kind = 'harris-grekov'", "3: model.kind: ", "did you mean 'harris-grekova'?"),
    ("[wave]\nnumber = 500\ndirection_deg = 30\n", "wave.x = 1", "18: background.wave: ", "unknown key"),
    ("[wave]", "[[wave]]", "18: wave: ", "expected a section [wave]"),
    ("['harris-grekova', 'double-shearing']", "'double-shearing'", "27: compare.kinds: ", "a list"),
    ("['harris-grekova', 'double-shearing']", "['double-shearing', 3]", "27: compare.kinds: ", "a list that contains 3"),
    ("['harris-grekova', 'double-shearing']", "[]", "27: compare.kinds: ", "at least one"),
    ("['harris-grekova', 'double-shearing']", "['double-shearing', 'double-shearing']", "27: compare.kinds: ", "twice"),
    ("['harris-grekova', 'double-shearing']", "['duble-shearing']", "27: compare.kinds: ", "'double-shearing'"),
    // non-finite and inexact numbers
    ("density = 1600", "density = nan", "10: background.density: ", "not finite"),
    ("density = 1600", "density = -inf", "10: background.density: ", "not finite"),
    ("density = 1600", "density = 1e999", "10: background.density: ", "not finite"),
    ("density = 1600", "density = 9007199254740993", "10: background.density: ", "too large to be exact"),
    ("density = 1600", "density = 99999999999999999999", "10: background.density: ", "too large to be exact"),
    ("[0.5, 0.25]", "[0.5, inf]", "14: background.velocity: ", "inf, which is not finite"),
    ("number = 500", "number = 0", "19: wave.number: ", "positive"),
    ("number = 500", "number = -5", "19: wave.number: ", "positive"),
    // invalid TOML
    ("density = 1600", "density = 1600 kg", "10: ", "'density = 1600 kg'"),
    ("density = 1600", "density 1600", "10: ", "'density 1600'"),
    ("density = 1600", "density = 1600\ndensity = 1600", "11: ", "duplicate key"),
    ("[wave]", "[model]", "18: ", "duplicate key"),
    ("'All sections'", "'All", "1: ", ""),
    // missing keys
    ("density = 1600\n", "", "9: background.density: ", "missing; add density to [background]"),
    ("kind = 'harris-grekova'\n", "", "2: model.kind: ", "missing"),
    ("moment_of_inertia = 1.25e-7\n", "", "2: model.moment_of_inertia: ", "missing"),
    (", points = 3", "", "24: map.y.points: ", "missing"),
    ("y = {", "# {", "22: map.y.parameter: ", "missing"),
    ("kinds = [", "# [", "26: compare.kinds: ", "missing"),
    // maps
    ("points = 5", "points = 0", "23: map.x.points: ", "at least 1"),
    ("points = 5", "points = -5", "23: map.x.points: ", "at least 1"),
    ("points = 5", "points = 5.5", "23: map.x.points: ", "whole number"),
    ("points = 5", "points = 99999999999999999999", "23: map.x.points: ", "whole number"),
    ("points = 5", "points = 33333334", "23: map.x.points: ", "at most 100000000 points"),
    ("points = 5", "points = 9223372036854775807", "23: map.x.points: ", "at most 100000000 points"),
    ("from = 1,", "from = nan,", "23: map.x.from: ", "not finite"),
    ("to = 9,", "to = inf,", "23: map.x.to: ", "not finite"),
    ("to = 9,", "to = 1,", "23: map.x.to: ", "expected from < to, or points = 1"),
    ("from = 1, to = 9,", "from = -1e308, to = 1e308,", "23: map.x.to: ", "whose difference overflows"),
    ("from = 1, to = 9,", "from = 1.7e308, to = -1e308,", "23: map.x.to: ", "expected from < to: exchange them"),
    ("to = 9,", "to = 1.0000000000000004,", "23: map.x.points: ", "too close to differ"),
    ("from = 1, to = 9,", "from = 0, to = 1e-323,", "23: map.x.points: ", "too close to differ"),
    ("from = 1, to = 9,", "from = -9, to = -8.999999999999998,", "23: map.x.points: ", "too close to differ"),
    ("'background.pressure'", "'background.presure'", "23: map.x.parameter: ", "did you mean 'background.pressure'?"),
    ("'background.pressure'", "'background.velocity'", "23: map.x.parameter: ", "not a single number"),
    ("'background.pressure'", "'background.velocity[2]'", "23: map.x.parameter: ", "background.velocity[0]"),
    ("'background.pressure'", "'background.velocity_gradient'", "23: map.x.parameter: ", "not a single number"),
    ("'background.pressure'", "'title'", "23: map.x.parameter: ", "not a single number"),
    ("'background.pressure'", "'background.stress_angle_rate_deg'", "23: map.x.parameter: ", "not used by the model harris-grekova"),
    ("'background.pressure'", "'wave.number', from = 0", "23: ", "duplicate key"),
    ("'background.velocity[1]'", "'background.pressure'", "24: map.y.parameter: ", "two different parameters"),
    ("'background.velocity[1]'", "'wave.number'", "24: map.y.from: ", "positive"),
];

/// Verifies that replacing a passage of [`FULL_CASE`] gives a message of one line that begins with location and key.
#[test]
fn invalid_input_is_refused_with_line_key_and_remedy() {
    for (old, new, place, expected) in INVALID_INPUTS {
        assert!(FULL_CASE.contains(old), "{old}");
        let error = parse_case(&FULL_CASE.replacen(old, new, 1)).expect_err(new);
        let start = format!("folder/x.toml:{place}");
        assert!(error.starts_with(&start), "{new}: expected '{start}…', got '{error}'");
        assert!(error.contains(expected), "{new}: '{expected}' is not in '{error}'");
        assert!(!error.contains('\n') && error.contains("; "), "{error}");
    }
}

#[test]
fn keys_unused_by_the_kind_are_refused() {
    let alone = FULL_CASE.split("[compare]").next().unwrap();
    for (kind, place, expected) in [
        ("double-shearing", "6: model.moment_of_inertia: ", "it belongs to harris-grekova)"),
        ("free-rotating", "6: model.moment_of_inertia: ", "not used by the model free-rotating"),
        ("harris-grekova", "14: background.stress_angle_rate_deg: ", "to double-shearing)"),
    ] {
        let rate = if kind == "harris-grekova" { "stress_angle_rate_deg = 1" } else { "" };
        let text = alone
            .replace("velocity = [0.5, 0.25]", rate)
            .replace("'harris-grekova'", &format!("'{kind}'"));
        let error = parse_case(&text).unwrap_err();
        assert!(error.starts_with(&format!("folder/x.toml:{place}")), "{error}");
        assert!(error.contains(expected), "{error}");
    }
    let free = alone.replace("'harris-grekova'", "'free-rotating'");
    let free = free.replace("moment_of_inertia = 1.25e-7\nrotational_strength = 5\n", "");
    assert_eq!(parse_case(&free).unwrap().number("background.spin"), Some(-0.125));
    // Keys not used by the kind are not suggested.
    let error = parse_case(&free.replace("spin =", "spin_gradien =")).unwrap_err();
    assert!(error.contains("unknown key") && !error.contains("spin_gradient"), "{error}");
}

#[test]
fn error_of_swept_parameter_names_the_sweep() {
    let located = |sets: &[&str]| {
        let case = parse_full_case_with(sets).unwrap();
        let mut corner = case.clone();
        corner.set_number(SweepParameter::find_by_name("background.pressure").unwrap(), -3.0);
        corner.material.numbers.background.spin = None;
        let background = corner.build_located_model().unwrap().background(&corner.to_flow_state());
        case.locate_error_in_map(background.unwrap_err()).to_string()
    };
    let expected =
        "background.pressure: found -3, a value of the sweep map.x; expected a pressure above";
    let error = located(&["map.x.points=5"]);
    assert!(error.starts_with(&format!("--set map.x.points=5: {expected}")), "{error}");
    let error = located(&["map.x.points=5", "map.x.from=-3"]);
    assert!(error.starts_with(&format!("--set map.x.from=-3: {expected}")), "{error}");
    let error = located(&["background.pressure=5"]);
    assert!(error.starts_with(&format!("folder/x.toml:23: {expected}")), "{error}");
    // The error of a key that is not swept names the line of that key.
    let error = located(&["map.x.parameter=wave.number"]);
    assert!(error.starts_with("folder/x.toml:11: background.pressure: found -3; "), "{error}");
}

#[test]
fn errors_in_settings_name_the_option() {
    for (set, expected) in [
        ("background.presure=1", "background.presure: unknown key; did you mean 'pressure'?"),
        ("background.pressure=abc", "background.pressure: found the text 'abc'; expected a finite"),
        ("background.pressure=nan", "background.pressure: found nan, which is not finite"),
        ("background.pressure=", "background.pressure: found the text ''"),
        ("background.pressure=1\n[wave]", "background.pressure: found the text"),
        ("background.pressure", "found no '='; expected --set section.key=value"),
        ("background=1", "background: found a section; expected a key inside it: density, "),
        ("map.x.points=0", "map.x.points: found 0"),
        ("map.x.points=99999999", "map.x.points: found a map of 99999999 × 3 points"),
        ("map.y.parameter=background.pressure", "map.y.parameter: found background.pressure on"),
        ("model.kind=tensor", "model.kind: found 'tensor'; allowed: harris-grekova"),
        ("=1", "found no key before '='; expected --set section.key=value"),
        ("background.density=0x", "background.density: found '0x', which is not a number"),
        ("name=.", "name: found '.'"),
    ] {
        let error = parse_full_case_with(&[set]).expect_err(set);
        let start = format!("--set {}: ", set.replace('\n', "\\n"));
        assert!(error.starts_with(&start), "{error}");
        assert!(error.contains(expected), "{expected}: {error}");
    }
    let case = parse_full_case_with(&[
        "background.pressure=7",
        " background.pressure = 2e3",
        "title=no quotes",
        "background.velocity=[3, 4]",
        "map.y.points=2",
        "compare.kinds=['free-rotating']",
    ])
    .unwrap();
    assert_eq!((case.number("background.pressure"), case.title.as_str()), (Some(2e3), "no quotes"));
    assert_eq!(case.number("background.velocity[1]"), Some(4.0));
    assert_eq!(case.map.unwrap().y.point_count, 2);
    assert_eq!(case.compared_kinds, Some(vec![ModelKind::Flow(registry::FREE_ROTATING)]));
}

#[test]
fn inputs_out_of_range_are_refused_with_location() {
    let base = FULL_CASE
        .replace("spin = -0.125", "noncoaxiality_deg = 0")
        .replace("kinds = ['harris-grekova', 'double-shearing']", "kinds = ['plastic-potential']");
    #[rustfmt::skip]
    let table = [
        ("friction_angle_deg = 30", "friction_angle_deg = 0", "4: model.friction_angle_deg: "),
        ("friction_angle_deg = 30", "friction_angle_deg = 90", "4: model.friction_angle_deg: "),
        ("friction_angle_deg = 30", "friction_angle_deg = -1e308", "4: model.friction_angle_deg: "),
        ("dilatancy_angle_deg = 10.5", "dilatancy_angle_deg = 30", "5: model.dilatancy_angle_deg: "),
        ("dilatancy_angle_deg = 10.5", "dilatancy_angle_deg = -1", "5: model.dilatancy_angle_deg: "),
        ("dilatancy_angle_deg = 10.5", "cohesion = -1", "5: model.cohesion: "),
        ("moment_of_inertia = 1.25e-7", "moment_of_inertia = 0", "6: model.moment_of_inertia: "),
        ("rotational_strength = 5", "rotational_strength = -5", "7: model.rotational_strength: "),
        ("density = 1600", "density = 0", "10: background.density: "),
        ("pressure = 1000.25", "pressure = -1", "11: background.pressure: "),
        ("shear_rate = 2", "shear_rate = 0", "13: background.shear_rate: "),
        ("shear_rate = 2", "shear_rate = -2", "13: background.shear_rate: "),
        ("velocity = [0.5, 0.25]", "velocity_gradient = [[1, 0], [0, 1]]", "14: background.velocity_gradient: "),
        ("velocity = [0.5, 0.25]", "acceleration = [1, 1]", "14: background.acceleration: "),
        ("velocity = [0.5, 0.25]", "spin = 100", "14: background.spin: "),
    ];
    derive_background(&parse_case(&base).unwrap()).unwrap();
    for (old, new, place) in table {
        let case = parse_case(&base.replacen(old, new, 1)).unwrap();
        let error = derive_background(&case).expect_err(new);
        let start = format!("folder/x.toml:{place}found ");
        assert!(error.starts_with(&start), "{new}: expected '{start}…', got '{error}'");
    }

    let not_dilatant = base
        .replace("dilatancy_angle_deg = 10.5\n", "")
        .replace("velocity = [0.5, 0.25]", "density_gradient = [1, 0]");
    let error = derive_background(&parse_case(&not_dilatant).unwrap()).unwrap_err();
    assert!(error.starts_with("folder/x.toml:13: background.density_gradient: "), "{error}");

    let oblique = base.replace("noncoaxiality_deg = 0", "noncoaxiality_deg = 5");
    let coaxial =
        parse_case(&oblique).unwrap().convert_to_kind(ModelKind::Flow(registry::PLASTIC_POTENTIAL));
    let error = derive_background(&coaxial).unwrap_err();
    assert!(error.starts_with("folder/x.toml:15: background.noncoaxiality_deg: "), "{error}");

    let sets = ["model.friction_angle_deg=95".to_owned()];
    let error = derive_background(&Case::parse(&base, "x.toml", &sets).unwrap()).unwrap_err();
    assert!(
        error.starts_with("--set model.friction_angle_deg=95: model.friction_angle"),
        "{error}"
    );
}

#[test]
fn unreadable_files_are_refused_with_reason() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("unreadable");
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    for (path, expected) in [
        (folder.join("absent.toml"), "no such file"),
        (folder.clone(), "a folder, not a file"),
        (
            write("empty.toml", b""),
            "empty.toml: model.kind: missing; add a section [model] with kind: ",
        ),
        (write("comment.toml", b"# nothing\n"), "comment.toml: model.kind: missing"),
        (write("latin.toml", b"a = 1\ntitle = '\xe9'"), "latin.toml:2: a byte that is not UTF-8"),
        (write("zero.toml", &[0; 100]), "zero.toml:1: "),
        (write("large.toml", &vec![b'#'; (1 << 24) + 1]), "larger than 16 MiB"),
        (write("deep.toml", format!("a = {}", "[".repeat(100_000)).as_bytes()), "deep.toml:1: "),
    ] {
        let error = Case::load(&path, &[]).unwrap_err().to_string();
        assert!(error.starts_with(folder.to_str().unwrap()) && error.contains(expected), "{error}");
    }
    let error = parse_case(&FULL_CASE[..FULL_CASE.find("[map]").unwrap()])
        .unwrap()
        .require_map()
        .unwrap_err();
    assert!(error.to_string().starts_with("folder/x.toml: map: missing; add a section [map]"));
    let error = parse_case(&FULL_CASE[..FULL_CASE.find("[background]").unwrap()]).unwrap_err();
    let start =
        "folder/x.toml: background.density: missing; add a section [background] with density";
    assert!(error.starts_with(start), "{error}");
}
