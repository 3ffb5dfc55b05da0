//! Case files: what is read, what is refused and in which words, and that nothing panics.

mod mutation;

use analysis::flows::Workspace;
use models::registry;
use mutation::{mutants, shrunk, without_marks};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use wellposed::case::{Case, Kind, Medium, Parameter, Presence, keys, radians};
use wellposed::cli::Options;
use wellposed::cli::cases::CASES;
use wellposed::setup;

/// A case with every section; tests refer to its lines.
const CASE: &str = "\
title = 'All sections'
[model]
kind = 'harris-grekova'
friction_angle_deg = 30
dilatancy_angle_deg = 10.5
moment_of_inertia = 1.25e-7
rotational_strength = 5

[background]
density = 1600
pressure = 1000.25
stress_angle_deg = 45
shear_rate = 2
velocity = [0.5, 0.25]
spin = -0.125
pressure_gradient = [1, -2]

[wave]
number = 500
direction_deg = 30

[map]
x = { parameter = 'background.pressure', from = 1, to = 9, points = 5 }
y = { parameter = 'background.velocity[1]', from = -1, to = 1, points = 3 }

[compare]
kinds = ['harris-grekova', 'double-shearing']
";

fn parse(text: &str) -> Result<Case, String> {
    Case::parse(text, "folder/x.toml", &[]).map_err(|error| error.to_string())
}

fn parse_with(sets: &[&str]) -> Result<Case, String> {
    let sets: Vec<String> = sets.iter().map(|set| (*set).to_owned()).collect();
    Case::parse(CASE, "folder/x.toml", &sets).map_err(|error| error.to_string())
}

/// Reads a case and derives its background: everything before the analysis.
fn check(case: &Case) -> Result<(), String> {
    let background = case.model().map_err(|error| error.to_string())?.background(&case.state());
    background.map(|_| ()).map_err(|error| case.locate(error).to_string())
}

#[test]
fn a_case_is_read_as_written() {
    let case = parse(CASE).unwrap();
    assert_eq!((case.name.as_str(), case.title.as_str()), ("x", "All sections"));
    assert_eq!(case.material.kind, Kind::Flow(registry::HARRIS_GREKOVA));
    assert_eq!(
        case.compare,
        Some(vec![Kind::Flow(registry::HARRIS_GREKOVA), Kind::Flow(registry::DOUBLE_SHEARING)])
    );
    for (name, expected) in [
        ("model.friction_angle_deg", Some(30.0)),
        ("model.dilatancy_angle_deg", Some(10.5)),
        ("model.cohesion", Some(0.0)),
        ("model.rotational_strength", Some(5.0)),
        ("background.pressure", Some(1000.25)),
        ("background.velocity[0]", Some(0.5)),
        ("background.velocity[1]", Some(0.25)),
        ("background.spin", Some(-0.125)),
        ("background.noncoaxiality_deg", None),
        ("background.acceleration[0]", None),
        ("wave.number", Some(500.0)),
        ("background.nothing", None),
    ] {
        assert_eq!(case.get(name), expected, "{name}");
    }
    let map = case.map.unwrap();
    assert_eq!(map.x.parameter.name(), "background.pressure");
    assert_eq!((map.x.from, map.x.to, map.x.points), (1.0, 9.0, 5));
    assert_eq!(map.y.parameter.name(), "background.velocity[1]");

    let least = CASE.split("velocity").next().unwrap();
    let case = parse(least).unwrap();
    assert_eq!(
        (case.material.numbers.wave.number, case.material.numbers.wave.direction_deg),
        (1000.0, 0.0)
    );
    assert_eq!((case.map, case.compare), (None, None));
}

/// The constants that a flow's model is given.
fn constants(case: &Case) -> Vec<f64> {
    let Kind::Flow(flow) = case.material.kind else { return Vec::new() };
    let mut constants = Vec::new();
    case.material.numbers.model.in_order(flow.parameters(), &mut constants);
    constants
}

#[test]
fn angles_become_radians_and_nothing_else_changes() {
    let case = parse(CASE).unwrap();
    let (constants, state) = (constants(&case), case.state());
    let cohesion = case.get("model.cohesion").unwrap();
    let strength = case.get("model.rotational_strength").unwrap();
    let expected = [30f64.to_radians(), 10.5f64.to_radians(), cohesion, 1.25e-7, strength];
    assert_eq!(constants, expected);
    assert_eq!(state.stress_angle, 45f64.to_radians());
    assert_eq!(state.pressure, 1000.25);
    assert_eq!(state.velocity, [0.5, 0.25]);
    assert_eq!((state.spin, state.noncoaxiality), (Some(-0.125), None));
}

#[test]
fn every_number_of_the_table_reaches_the_models() {
    // A changed key must change what the model gets: no row may point at another row's field.
    for parameter in Parameter::all().filter(|p| !p.name().starts_with("wave.")) {
        let medium = Medium::all().find(|&m| parameter.key().is_used_by(m)).unwrap();
        let kind = medium.kind;
        // A layer's stress counts where no conditions are named.
        let text = wellposed::cli::new::text(medium).replace("active =", "# active =");
        let mut case = parse(&text).unwrap();
        // In general position: what multiplies a zero reaches nothing.
        for (name, value) in [
            ("stress.deviatoric_stress", 0.3),
            ("stress.stress_angle_deg", 20.0),
            ("stress.rotational_stress", 0.9),
            ("yield.symmetric_length", 0.5),
            ("yield.antisymmetric_length", 0.4),
        ] {
            let other = Parameter::find(name).unwrap();
            if other.key().is_used_by(medium) {
                case.set(other, value);
            }
        }
        for (component, value) in [("[0]", 0.2), ("[1]", 0.1)] {
            let other = Parameter::find(&format!("stress.couple_stress{component}")).unwrap();
            if other.key().is_used_by(medium) {
                case.set(other, value);
            }
        }
        let mut changed = case.clone();
        changed.set(parameter, 0.77);
        let name = parameter.name();
        assert_eq!(changed.get(&name), Some(0.77));
        for other in Parameter::all().filter(|p| p.key().name != parameter.key().name) {
            assert_eq!(
                other.get(&changed.material.numbers),
                other.get(&case.material.numbers),
                "{name}"
            );
        }
        let reaches = match kind {
            Kind::Flow(_) => {
                constants(&changed) != constants(&case) || changed.state() != case.state()
            }
            Kind::Solid(_) => {
                setup::solid::solid(&changed.material) != setup::solid::solid(&case.material)
            }
        };
        assert!(reaches, "{name}");
    }
}

#[test]
fn another_kind_takes_what_it_uses() {
    let case = parse(CASE).unwrap();
    let other = case.for_kind(Kind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.material.kind, Kind::Flow(registry::DOUBLE_SHEARING));
    assert_eq!(other.get("background.pressure"), Some(1000.25));
    assert_eq!((other.get("background.spin"), other.get("model.moment_of_inertia")), (None, None));
    check(&other).unwrap();
    // A compared kind's keys are allowed though the case's own kind does not use them.
    let sets = ["model.kind=double-shearing", "map.x.parameter=wave.number"];
    check(&parse_with(&sets).unwrap().for_kind(Kind::Flow(registry::HARRIS_GREKOVA))).unwrap();
}

#[test]
fn the_resolved_case_reads_back_to_itself() {
    let new = Medium::all().map(|medium| without_marks(&wellposed::cli::new::text(medium)));
    let bundled = CASES.iter().map(|(_, text)| (*text).to_owned());
    let odd = CASE
        .replace("'All sections'", r#""quotes \" ' and \\ Ψ""#)
        .replace("1000.25", "0.1")
        .replace("0.5, 0.25", "-0.0, 5e-324")
        .replace("500", "1.7976931348623157e308");
    for text in bundled.chain(new).chain([CASE.to_owned(), odd]) {
        let case = parse(&text).unwrap();
        let resolved = case.to_toml();
        let again = parse(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(again, case, "{resolved}");
        assert_eq!(again.to_toml(), resolved);
        for key in keys().iter().filter(|key| matches!(key.presence, Presence::Default(_))) {
            let (section, name) = key.split();
            let stands = resolved.contains(&format!("\n{name} = "));
            // Named conditions stand in place of a stress.
            let is_replaced = section == "stress" && case.material.active.is_some();
            let is_used = key.is_used_by(case.medium()) && !is_replaced;
            assert!(stands || !is_used, "[{section}] {name} is missing in\n{resolved}");
        }
    }
}

#[test]
fn new_cases_are_complete_and_valid() {
    for medium in Medium::all() {
        let text = wellposed::cli::new::text(medium);
        let case = parse(&text).unwrap();
        assert_eq!(case.medium(), medium);
        if let Kind::Solid(_) = medium.kind {
            setup::solid::solid(&case.material).unwrap();
        } else {
            check(&case).unwrap();
            let map = case.required_map().unwrap();
            for (x, y) in [(0, 0), (25, 0), (0, 30), (25, 30)] {
                let mut corner = case.clone();
                corner.set(map.x.parameter, map.x.value(x));
                corner.set(map.y.parameter, map.y.value(y));
                check(&corner).unwrap();
            }
        }
        // Every optional key can be taken in as it stands, and none of them is unknown.
        let full = without_marks(&text);
        parse(&full).unwrap();
        let is_layered = medium.yields == Some(registry::INTERLAYER);
        for key in keys()
            .iter()
            .filter(|key| key.is_used_by(medium) && key.example().is_some())
            .filter(|key| !(is_layered && key.name.starts_with("stress.")))
        {
            let line = format!("\n{} = ", key.split().1);
            assert_eq!(full.matches(&line).count(), 1, "{}", key.name);
        }
    }
}

#[test]
fn bundled_cases_are_valid_and_have_headers() {
    assert!(CASES.len() >= 5);
    for (path, text) in CASES {
        let case = Case::parse(text, path, &[]).unwrap_or_else(|error| panic!("{error}"));
        assert!(!case.title.is_empty(), "{path}");
        let verb = if case.in_time().is_ok() {
            if path.starts_with("cases/check/") { "check" } else { "run" }
        } else if let Kind::Solid(_) = case.material.kind {
            setup::solid::solid(&case.material).unwrap_or_else(|error| panic!("{error}"));
            match case.map.is_some() {
                true => "map",
                false if path.starts_with("cases/check/") => "check",
                false => "dispersion",
            }
        } else {
            check(&case).unwrap_or_else(|error| panic!("{error}"));
            if case.map.is_some() { "map" } else { "point" }
        };
        let command = format!("# Run     wellposed {verb} {path}");
        let lines = || text.lines();
        assert!(
            lines().any(|line| line.trim_end_matches(" --accept-ill-posed") == command),
            "{path} does not say '{command}'"
        );
        for part in ["# Shows ", "# Expect ", "# Takes "] {
            assert!(text.contains(part), "{path} does not say '{part}'");
        }
    }
}

#[test]
fn a_sweep_hits_its_ends_and_whole_numbers() {
    let bound = CASES.iter().find(|(path, _)| path.contains("noncoaxiality-bound")).unwrap();
    let x = parse(bound.1).unwrap().map.unwrap().x;
    assert_eq!((x.value(0), x.value(240)), (-90.0, 90.0));
    for exact in [-45.0, 0.0, 45.0] {
        assert!((0..x.points).any(|i| x.value(i) == exact), "{exact} is not on the grid");
    }
    for (from, to) in
        [("-5e307", "1e308"), ("1e308", "1.5e308"), ("1", "1.0000000000000058"), ("0", "1e-322")]
    {
        let sets = [format!("map.x.from={from}"), format!("map.x.to={to}")];
        let sweep = parse_with(&[&sets[0], &sets[1]]).unwrap().map.unwrap().x;
        let ends = (from.parse().unwrap(), to.parse().unwrap());
        assert_eq!((sweep.value(0), sweep.value(4)), ends);
        assert!((0..4).all(|i| sweep.value(i) < sweep.value(i + 1)), "{from} … {to}");
    }
}

/// Replaces a part of [`CASE`] and expects one line that starts with place and key.
#[test]
fn bad_input_is_answered_with_line_key_and_remedy() {
    #[rustfmt::skip]
    let table: &[(&str, &str, &str, &str)] = &[
        // unknown and misspelt keys
        ("pressure = 1000.25", "presure = 1", "11: background.presure: ", "did you mean 'pressure'? allowed here: density, "),
        ("shear_rate = 2", "shear_rat = 2", "13: background.shear_rat: ", "'shear_rate'"),
        ("[background]", "[backgroud]", "9: backgroud: ", "'background'? allowed here: title, name, [model], "),
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
        ("[0.5, 0.25]", "0.5", "14: background.velocity: ", "the number 0.5"),
        ("spin = -0.125", "velocity_gradient = [1, 2]", "15: background.velocity_gradient: ", "[[a11, a12], [a21, a22]]"),
        ("'All sections'", "7", "1: title: ", "text in quotes"),
        ("'All sections'", "\"two\\nlines\"", "1: title: ", "text in quotes"),
        ("title =", "name = 3\ntitle =", "1: name: ", "the integer 3; expected text in quotes"),
        ("title =", "name = ''\ntitle =", "1: name: ", "found ''; expected text"),
        ("title =", "name = '..'\ntitle =", "1: name: ", "not dots alone"),
        ("title =", "name = 'a/b'\ntitle =", "1: name: ", "found 'a/b'"),
        ("kind = 'harris-grekova'", "kind = 3", "3: model.kind: ", "harris-grekova, double-shearing"),
        ("kind = 'harris-grekova'", "kind = 'harris-grekov'", "3: model.kind: ", "did you mean 'harris-grekova'?"),
        ("[wave]\nnumber = 500\ndirection_deg = 30\n", "wave.x = 1", "18: background.wave: ", "unknown key"),
        ("[wave]", "[[wave]]", "18: wave: ", "expected a section [wave]"),
        ("['harris-grekova', 'double-shearing']", "'double-shearing'", "27: compare.kinds: ", "a list"),
        ("['harris-grekova', 'double-shearing']", "['double-shearing', 3]", "27: compare.kinds: ", "a list that holds the integer 3"),
        ("['harris-grekova', 'double-shearing']", "[]", "27: compare.kinds: ", "at least one"),
        ("['harris-grekova', 'double-shearing']", "['double-shearing', 'double-shearing']", "27: compare.kinds: ", "twice"),
        ("['harris-grekova', 'double-shearing']", "['duble-shearing']", "27: compare.kinds: ", "'double-shearing'"),
        // numbers that are none
        ("density = 1600", "density = nan", "10: background.density: ", "not finite"),
        ("density = 1600", "density = -inf", "10: background.density: ", "not finite"),
        ("density = 1600", "density = 1e999", "10: background.density: ", "not finite"),
        ("density = 1600", "density = 9007199254740993", "10: background.density: ", "too large to be exact"),
        ("density = 1600", "density = 99999999999999999999", "10: background.density: ", "too large to be exact"),
        ("[0.5, 0.25]", "[0.5, inf]", "14: background.velocity: ", "inf, which is not finite"),
        ("number = 500", "number = 0", "19: wave.number: ", "positive"),
        ("number = 500", "number = -5", "19: wave.number: ", "positive"),
        // what is not TOML
        ("density = 1600", "density = 1600 kg", "10: ", "'density = 1600 kg'"),
        ("density = 1600", "density 1600", "10: ", "'density 1600'"),
        ("density = 1600", "density = 1600\ndensity = 1600", "11: ", "duplicate key"),
        ("[wave]", "[model]", "18: ", "duplicate key"),
        ("'All sections'", "'All", "1: ", ""),
        // what is missing
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
        ("to = 9,", "to = 1,", "23: map.x.to: ", "two different ends"),
        ("from = 1, to = 9,", "from = -1e308, to = 1e308,", "23: map.x.to: ", "whose difference overflows"),
        ("from = 1, to = 9,", "from = 1.7e308, to = -1e308,", "23: map.x.from: ", "whose difference overflows"),
        ("to = 9,", "to = 1.0000000000000004,", "23: map.x.points: ", "too close to differ"),
        ("from = 1, to = 9,", "from = 0, to = 1e-323,", "23: map.x.points: ", "too close to differ"),
        ("from = 1, to = 9,", "from = -9, to = -8.999999999999998,", "23: map.x.points: ", "too close to differ"),
        ("'background.pressure'", "'background.presure'", "23: map.x.parameter: ", "did you mean 'background.pressure'?"),
        ("'background.pressure'", "'background.velocity'", "23: map.x.parameter: ", "no single number"),
        ("'background.pressure'", "'background.velocity[2]'", "23: map.x.parameter: ", "background.velocity[0]"),
        ("'background.pressure'", "'background.velocity_gradient'", "23: map.x.parameter: ", "no single number"),
        ("'background.pressure'", "'title'", "23: map.x.parameter: ", "no single number"),
        ("'background.pressure'", "'background.stress_angle_rate_deg'", "23: map.x.parameter: ", "not used by the model harris-grekova"),
        ("'background.pressure'", "'wave.number', from = 0", "23: ", "duplicate key"),
        ("'background.velocity[1]'", "'background.pressure'", "24: map.y.parameter: ", "two different parameters"),
        ("'background.velocity[1]'", "'wave.number'", "24: map.y.from: ", "positive"),
    ];
    for (old, new, place, words) in table {
        assert!(CASE.contains(old), "{old}");
        let error = parse(&CASE.replacen(old, new, 1)).expect_err(new);
        let start = format!("folder/x.toml:{place}");
        assert!(error.starts_with(&start), "{new}: expected '{start}…', got '{error}'");
        assert!(error.contains(words), "{new}: '{words}' is not in '{error}'");
        assert!(!error.contains('\n') && error.contains("; "), "{error}");
    }
}

#[test]
fn keys_that_no_kind_uses_are_refused() {
    let alone = CASE.split("[compare]").next().unwrap();
    for (kind, place, words) in [
        ("double-shearing", "6: model.moment_of_inertia: ", "it belongs to harris-grekova)"),
        ("free-rotating", "6: model.moment_of_inertia: ", "not used by the model free-rotating"),
        ("harris-grekova", "14: background.stress_angle_rate_deg: ", "to double-shearing)"),
    ] {
        let rate = if kind == "harris-grekova" { "stress_angle_rate_deg = 1" } else { "" };
        let text = alone
            .replace("velocity = [0.5, 0.25]", rate)
            .replace("'harris-grekova'", &format!("'{kind}'"));
        let error = parse(&text).unwrap_err();
        assert!(error.starts_with(&format!("folder/x.toml:{place}")), "{error}");
        assert!(error.contains(words), "{error}");
    }
    let free = alone.replace("'harris-grekova'", "'free-rotating'");
    let free = free.replace("moment_of_inertia = 1.25e-7\nrotational_strength = 5\n", "");
    assert_eq!(parse(&free).unwrap().get("background.spin"), Some(-0.125));
    // What the kind does not use is not offered either.
    let error = parse(&free.replace("spin =", "spin_gradien =")).unwrap_err();
    assert!(error.contains("unknown key") && !error.contains("spin_gradient"), "{error}");
}

#[test]
fn a_name_can_be_a_folder_and_stays() {
    for (file, name) in [
        ("folder/x.toml", "x"),
        ("a.b.toml", "a.b"),
        ("plain", "plain"),
        ("Größe_1.toml", "Größe_1"),
        ("two words(1).toml", "two-words-1-"),
        (".toml", "case"),
        ("..toml", "case"),
        ("...toml", "case"),
        ("folder/....toml", "case"),
        ("..", "case"),
        ("", "case"),
    ] {
        let case = Case::parse(CASE, file, &[]).unwrap();
        assert_eq!(case.name, name, "{file}");
        // The resolved case goes by the same name, whatever its file is called.
        assert_eq!(Case::parse(&case.to_toml(), "case.toml", &[]).unwrap(), case, "{file}");
    }
    assert_eq!(parse(&format!("name = 'mine'\n{CASE}")).unwrap().name, "mine");
    assert_eq!(parse_with(&["name=v1.2_a"]).unwrap().name, "v1.2_a");
}

#[test]
fn angles_are_reduced_in_degrees() {
    let state = |stress: f64, delta: f64| {
        let mut case = parse(CASE).unwrap();
        case.set(Parameter::find("background.stress_angle_deg").unwrap(), stress);
        case.set(Parameter::find("background.noncoaxiality_deg").unwrap(), delta);
        case.state()
    };
    assert_eq!(state(405.0, -725.0), state(45.0, -5.0));
    assert_eq!(state(359.5, 123.456).stress_angle, 359.5f64.to_radians());
    assert_eq!(state(1e308, -1e308), state(1e308 % 360.0, -(1e308 % 360.0)));
    assert!(radians(f64::MAX).abs() < 6.3);
    assert_eq!(radians(90.0 + 360.0), 90f64.to_radians());
}

#[test]
fn an_error_of_a_swept_number_points_at_the_sweep() {
    let located = |sets: &[&str]| {
        let case = parse_with(sets).unwrap();
        let mut corner = case.clone();
        corner.set(Parameter::find("background.pressure").unwrap(), -3.0);
        corner.material.numbers.background.spin = None;
        let background = corner.model().unwrap().background(&corner.state());
        case.locate_in_map(background.unwrap_err()).to_string()
    };
    let words = "background.pressure: found -3, a value of the sweep map.x; the pressure must";
    let error = located(&["map.x.points=5"]);
    assert!(error.starts_with(&format!("--set map.x.points=5: {words}")), "{error}");
    let error = located(&["map.x.points=5", "map.x.from=-3"]);
    assert!(error.starts_with(&format!("--set map.x.from=-3: {words}")), "{error}");
    let error = located(&["background.pressure=5"]);
    assert!(error.starts_with(&format!("folder/x.toml:23: {words}")), "{error}");
    // What is not swept stands where it stands.
    let error = located(&["map.x.parameter=wave.number"]);
    assert!(error.starts_with("folder/x.toml:11: background.pressure: found -3; "), "{error}");
}

#[test]
fn another_kind_keeps_the_noncoaxiality_that_a_spin_stands_for() {
    let case = parse(CASE).unwrap();
    let delta = |case: &Case| case.material.numbers.background.noncoaxiality_deg;
    // Kinds with a spin take it as it is, to the last bit; others what it stands for.
    for (kind, expected, lost) in [
        (Kind::Flow(registry::HARRIS_GREKOVA), None, None),
        (Kind::Flow(registry::FREE_ROTATING), None, None),
        (Kind::Flow(registry::DOUBLE_SHEARING), Some(7.5), None),
        (Kind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0), Some(7.5)),
    ] {
        let converted = case.for_kind_with(kind, Some(7.5));
        assert_eq!(delta(&converted.case), expected, "{kind:?}");
        assert_eq!(converted.lost_noncoaxiality_deg, lost, "{kind:?}");
        assert_eq!(converted.case.get("background.spin").is_some(), expected.is_none());
        check(&converted.case).unwrap();
    }
    // A given non-coaxiality goes before.
    let given = parse(&CASE.replace("spin = -0.125", "noncoaxiality_deg = 5")).unwrap();
    let converted = given.for_kind_with(Kind::Flow(registry::DOUBLE_SHEARING), Some(7.5));
    assert_eq!(converted.case, given.for_kind(Kind::Flow(registry::DOUBLE_SHEARING)));
    let converted = given.for_kind_with(Kind::Flow(registry::PLASTIC_POTENTIAL), None);
    assert_eq!((delta(&converted.case), converted.lost_noncoaxiality_deg), (Some(0.0), Some(5.0)));
    // What is coaxial loses nothing.
    let coaxial = parse(&CASE.replace("spin = -0.125\n", "")).unwrap();
    let converted = coaxial.for_kind_with(Kind::Flow(registry::PLASTIC_POTENTIAL), Some(0.0));
    assert_eq!(converted.lost_noncoaxiality_deg, None);
    let converted = coaxial.for_kind_with(Kind::Flow(registry::DOUBLE_SHEARING), Some(0.0));
    assert_eq!(converted.case, coaxial.for_kind(Kind::Flow(registry::DOUBLE_SHEARING)));
}

#[test]
fn errors_in_set_name_the_option() {
    for (set, words) in [
        ("background.presure=1", "background.presure: unknown key; did you mean 'pressure'? "),
        ("background.pressure=abc", "background.pressure: found the text 'abc'; expected a finite"),
        ("background.pressure=nan", "background.pressure: found nan, which is not finite"),
        ("background.pressure=", "background.pressure: found the text ''"),
        ("background.pressure=1\n[wave]", "background.pressure: found the text"),
        ("background.pressure", "no '='"),
        ("background=1", "background: a section; name a key inside it: density, "),
        ("map.x.points=0", "map.x.points: found the integer 0"),
        ("map.x.points=99999999", "map.x.points: a grid of 99999999 × 3 points"),
        ("map.y.parameter=background.pressure", "map.y.parameter: found background.pressure on"),
        ("model.kind=tensor", "model.kind: found 'tensor'; allowed: harris-grekova"),
        ("=1", "no key before '='; write --set section.key=value"),
        ("background.density=0x", "background.density: found '0x', which is not a number"),
        ("name=.", "name: found '.'"),
    ] {
        let error = parse_with(&[set]).expect_err(set);
        let start = format!("--set {}: ", set.replace('\n', "\\n"));
        assert!(error.starts_with(&start), "{error}");
        assert!(error.contains(words), "{words}: {error}");
    }
    let case = parse_with(&[
        "background.pressure=7",
        " background.pressure = 2e3",
        "title=no quotes",
        "background.velocity=[3, 4]",
        "map.y.points=2",
        "compare.kinds=['free-rotating']",
    ])
    .unwrap();
    assert_eq!((case.get("background.pressure"), case.title.as_str()), (Some(2e3), "no quotes"));
    assert_eq!(case.get("background.velocity[1]"), Some(4.0));
    assert_eq!(case.map.unwrap().y.points, 2);
    assert_eq!(case.compare, Some(vec![Kind::Flow(registry::FREE_ROTATING)]));
}

#[test]
fn inputs_out_of_range_are_located() {
    let base = CASE
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
    check(&parse(&base).unwrap()).unwrap();
    for (old, new, place) in table {
        let case = parse(&base.replacen(old, new, 1)).unwrap();
        let error = check(&case).expect_err(new);
        let start = format!("folder/x.toml:{place}found ");
        assert!(error.starts_with(&start), "{new}: expected '{start}…', got '{error}'");
    }

    let not_dilatant = base
        .replace("dilatancy_angle_deg = 10.5\n", "")
        .replace("velocity = [0.5, 0.25]", "density_gradient = [1, 0]");
    let error = check(&parse(&not_dilatant).unwrap()).unwrap_err();
    assert!(error.starts_with("folder/x.toml:13: background.density_gradient: "), "{error}");

    let oblique = base.replace("noncoaxiality_deg = 0", "noncoaxiality_deg = 5");
    let coaxial = parse(&oblique).unwrap().for_kind(Kind::Flow(registry::PLASTIC_POTENTIAL));
    let error = check(&coaxial).unwrap_err();
    assert!(error.starts_with("folder/x.toml:15: background.noncoaxiality_deg: "), "{error}");

    let sets = ["model.friction_angle_deg=95".to_owned()];
    let error = check(&Case::parse(&base, "x.toml", &sets).unwrap()).unwrap_err();
    assert!(
        error.starts_with("--set model.friction_angle_deg=95: model.friction_angle"),
        "{error}"
    );
}

#[test]
fn files_that_cannot_be_read_say_why() {
    let folder = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("unreadable");
    std::fs::create_dir_all(&folder).unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    for (path, words) in [
        (folder.join("absent.toml"), "No such file"),
        (folder.clone(), "directory"),
        (
            write("empty.toml", b""),
            "empty.toml: model.kind: missing; add a section [model] with kind: ",
        ),
        (write("comment.toml", b"# nothing\n"), "comment.toml: model.kind: missing"),
        (write("latin.toml", b"a = 1\ntitle = '\xe9'"), "latin.toml:2: a byte that is not UTF-8"),
        (write("zero.toml", &[0; 100]), "zero.toml:1: "),
        (write("large.toml", &vec![b'#'; (1 << 28) + 1]), "larger than 256 MiB"),
        (write("deep.toml", format!("a = {}", "[".repeat(100_000)).as_bytes()), "deep.toml:1: "),
    ] {
        let error = Case::load(&path, &[]).unwrap_err().to_string();
        assert!(error.starts_with(folder.to_str().unwrap()) && error.contains(words), "{error}");
    }
    let error = parse(&CASE[..CASE.find("[map]").unwrap()]).unwrap().required_map().unwrap_err();
    assert!(error.to_string().starts_with("folder/x.toml: map: missing; add a section [map]"));
    let error = parse(&CASE[..CASE.find("[background]").unwrap()]).unwrap_err();
    let start =
        "folder/x.toml: background.density: missing; add a section [background] with density";
    assert!(error.starts_with(start), "{error}");
}

/// Hands `count` mutants to `run`, which says whether it took them; none may panic or be slow.
fn survive(count: usize, mut run: impl FnMut(&str) -> bool) {
    const LIMIT: Duration = Duration::from_secs(20);
    let (mut taken, mut slowest, mut failures) = (0, Duration::ZERO, Vec::new());
    for (index, mutant) in mutants(1).take(count).enumerate() {
        // Bytes that are no text are for the program to refuse; see tests/command_line.rs.
        let text = String::from_utf8_lossy(&mutant);
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| run(&text))) {
            Ok(was_taken) => taken += usize::from(was_taken),
            Err(_) => failures.push(format!("mutant {index} panicked:\n{text}")),
        }
        let time = start.elapsed();
        slowest = slowest.max(time);
        if time > LIMIT {
            failures.push(format!("mutant {index} took {time:?}:\n{text}"));
        }
    }
    println!("{taken} of {count} mutants were taken; the slowest took {slowest:?}");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures[0]);
    // Were nearly all refused, or nearly none, the mutants would test little.
    assert!(taken > count / 20 && taken < count * 3 / 4, "{taken} of {count} were taken");
}

#[test]
fn ten_thousand_mutants_are_taken_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mutant.toml");
    let mut workspace = Workspace::default();
    let mut index = 0;
    survive(10_000, |text| {
        index += 1;
        let Ok(case) = parse(text) else { return false };
        let again = parse(&case.to_toml()).expect("a resolved case is a case");
        assert!(again == case, "the resolved case differs from the case");
        for kind in case.compare.iter().flatten() {
            let _ = setup::flow::assess(&case.for_kind(*kind), &mut workspace);
        }
        // All corners of the map.
        for map in case.map.iter().filter(|map| map.x.points.max(map.y.points) <= 1000) {
            for corner in 0..4 {
                let mut case = case.clone();
                case.set(map.x.parameter, map.x.value((corner % 2) * (map.x.points - 1)));
                case.set(map.y.parameter, map.y.value((corner / 2) * (map.y.points - 1)));
                let _ = setup::flow::assess(&case, &mut workspace);
            }
        }
        // Everything that a point is asked for costs more than its verdict: every tenth.
        if index % 10 == 0 {
            std::fs::write(&file, text).unwrap();
            let options = Options { case: file.clone(), dry_run: true, ..Options::default() };
            let _ = wellposed::cli::point(&options, &mut std::io::sink());
        }
        setup::flow::assess(&case, &mut workspace).is_ok()
    });
}

#[test]
fn shrinking_keeps_all_but_the_grid() {
    for (path, text) in CASES {
        let (case, small) = (parse(text).unwrap(), parse(&shrunk(text)).unwrap());
        assert_eq!(case.material.numbers, small.material.numbers, "{path}");
        assert_eq!(case.map.is_some(), small.map.is_some(), "{path}");
        assert!(small.map.is_none_or(|map| map.x.points * map.y.points == 12), "{path}");
    }
}
