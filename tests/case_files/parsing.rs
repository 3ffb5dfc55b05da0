//! Tests of parsing and writing case files: values, units, defaults, sweeps and names.

use super::full_case::{FULL_CASE, parse_full_case_with};
use crate::mutation::uncomment_optional_keys;
use crate::support::parse_case;
use models::registry;
use wellposed::CASES;
use wellposed::case::{
    Case, MediumKind, ModelKind, Presence, SweepParameter, degrees_to_radians, keys,
};
use wellposed::setup;

#[test]
fn case_is_parsed_as_written() {
    let case = parse_case(FULL_CASE).unwrap();
    assert_eq!((case.name.as_str(), case.title.as_str()), ("x", "All sections"));
    assert_eq!(case.material.kind, ModelKind::Flow(registry::HARRIS_GREKOVA));
    assert_eq!(
        case.compared_kinds,
        Some(vec![
            ModelKind::Flow(registry::HARRIS_GREKOVA),
            ModelKind::Flow(registry::DOUBLE_SHEARING)
        ])
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
        assert_eq!(case.number(name), expected, "{name}");
    }
    let map = case.map.unwrap();
    assert_eq!(map.x.parameter.name(), "background.pressure");
    assert_eq!((map.x.first_value, map.x.last_value, map.x.point_count), (1.0, 9.0, 5));
    assert_eq!(map.y.parameter.name(), "background.velocity[1]");

    let minimal_text = FULL_CASE.split("velocity").next().unwrap();
    let case = parse_case(minimal_text).unwrap();
    assert_eq!(
        (case.material.numbers.wave.wave_number, case.material.numbers.wave.direction_deg),
        (1000.0, 0.0)
    );
    assert_eq!((case.map, case.compared_kinds), (None, None));
}

/// Returns the constants that are passed to the flow model of a case.
fn model_constants(case: &Case) -> Vec<f64> {
    let ModelKind::Flow(flow) = case.material.kind else { return Vec::new() };
    let mut constants = Vec::new();
    case.material.numbers.model_constants.collect_si_values(flow.parameters(), &mut constants);
    constants
}

#[test]
fn only_angles_are_converted_to_other_units() {
    let case = parse_case(FULL_CASE).unwrap();
    let (constants, state) = (model_constants(&case), case.to_flow_state());
    let cohesion = case.number("model.cohesion").unwrap();
    let strength = case.number("model.rotational_strength").unwrap();
    let expected = [30f64.to_radians(), 10.5f64.to_radians(), cohesion, 1.25e-7, strength];
    assert_eq!(constants, expected);
    assert_eq!(state.stress_angle, 45f64.to_radians());
    assert_eq!(state.pressure, 1000.25);
    assert_eq!(state.velocity, [0.5, 0.25]);
    assert_eq!((state.spin, state.noncoaxiality), (Some(-0.125), None));
}

#[test]
fn every_parameter_reaches_the_model() {
    // A changed key must change the input of the model, which detects entries that refer to the field of another
    // entry.
    for parameter in SweepParameter::all_parameters().filter(|p| !p.name().starts_with("wave.")) {
        let medium = MediumKind::all_media().find(|&m| parameter.key().is_used_by(m)).unwrap();
        let kind = medium.kind;
        // The stress of layers is used only if no active conditions are named.
        let text =
            wellposed::cli::new::generate_state_template(medium).replace("active =", "# active =");
        let mut case = parse_case(&text).unwrap();
        // Values in general position, since a parameter multiplied by zero has no effect.
        for (name, value) in [
            ("stress.deviatoric_stress", 0.3),
            ("stress.stress_angle_deg", 20.0),
            ("stress.rotational_stress", 0.9),
            ("yield.symmetric_length", 0.5),
            ("yield.antisymmetric_length", 0.4),
        ] {
            let other = SweepParameter::find_by_name(name).unwrap();
            if other.key().is_used_by(medium) {
                case.set_number(other, value);
            }
        }
        for (component, value) in [("[0]", 0.2), ("[1]", 0.1)] {
            let other =
                SweepParameter::find_by_name(&format!("stress.couple_stress{component}")).unwrap();
            if other.key().is_used_by(medium) {
                case.set_number(other, value);
            }
        }
        let mut changed = case.clone();
        changed.set_number(parameter, 0.77);
        let name = parameter.name();
        assert_eq!(changed.number(&name), Some(0.77));
        for other in
            SweepParameter::all_parameters().filter(|p| p.key().name != parameter.key().name)
        {
            assert_eq!(
                other.value(&changed.material.numbers),
                other.value(&case.material.numbers),
                "{name}"
            );
        }
        let reaches = match kind {
            ModelKind::Flow(_) => {
                model_constants(&changed) != model_constants(&case)
                    || changed.to_flow_state() != case.to_flow_state()
            }
            ModelKind::Rheology | ModelKind::Equations => unreachable!("not among all kinds"),
            ModelKind::Solid(_) => {
                setup::solid::create_solid(&changed.material)
                    != setup::solid::create_solid(&case.material)
            }
        };
        assert!(reaches, "{name}");
    }
}

#[test]
fn resolved_case_parses_to_equal_case() {
    let new = MediumKind::all_media().map(|medium| {
        uncomment_optional_keys(&wellposed::cli::new::generate_state_template(medium))
    });
    let bundled = CASES.iter().map(|(_, text)| (*text).to_owned());
    let odd = FULL_CASE
        .replace("'All sections'", r#""quotes \" ' and \\ Ψ""#)
        .replace("1000.25", "0.1")
        .replace("0.5, 0.25", "-0.0, 5e-324")
        .replace("500", "1.7976931348623157e308");
    for text in bundled.chain(new).chain([FULL_CASE.to_owned(), odd]) {
        let case = parse_case(&text).unwrap();
        let resolved = case.to_toml();
        let reparsed = parse_case(&resolved).unwrap_or_else(|error| panic!("{error}\n{resolved}"));
        assert_eq!(reparsed, case, "{resolved}");
        assert_eq!(reparsed.to_toml(), resolved);
        for key in keys().iter().filter(|key| matches!(key.presence, Presence::Default(_))) {
            let (section, name) = key.split_section();
            let is_written = resolved.contains(&format!("\n{name} = "));
            // Named active conditions replace the stress.
            let is_replaced = section == "stress" && case.material.active_conditions.is_some();
            let is_used = key.is_used_by(case.medium()) && !is_replaced;
            assert!(is_written || !is_used, "[{section}] {name} is missing in\n{resolved}");
        }
    }
}

#[test]
fn sweep_contains_ends_and_whole_numbers() {
    let bound = CASES.iter().find(|(path, _)| path.contains("noncoaxiality-bound")).unwrap();
    let x = parse_case(bound.1).unwrap().map.unwrap().x;
    assert_eq!((x.sweep_value(0), x.sweep_value(240)), (-90.0, 90.0));
    for exact in [-45.0, 0.0, 45.0] {
        assert!(
            (0..x.point_count).any(|i| x.sweep_value(i) == exact),
            "{exact} is not on the grid"
        );
    }
    for (from, to) in
        [("-5e307", "1e308"), ("1e308", "1.5e308"), ("1", "1.0000000000000058"), ("0", "1e-322")]
    {
        let sets = [format!("map.x.from={from}"), format!("map.x.to={to}")];
        let sweep = parse_full_case_with(&[&sets[0], &sets[1]]).unwrap().map.unwrap().x;
        let ends = (from.parse().unwrap(), to.parse().unwrap());
        assert_eq!((sweep.sweep_value(0), sweep.sweep_value(4)), ends);
        assert!((0..4).all(|i| sweep.sweep_value(i) < sweep.sweep_value(i + 1)), "{from} … {to}");
    }
}

#[test]
fn case_names_are_valid_folder_names_and_persist() {
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
        let case = Case::parse(FULL_CASE, file, &[]).unwrap();
        assert_eq!(case.name, name, "{file}");
        // The resolved case has the same name, whatever the name of its file.
        assert_eq!(Case::parse(&case.to_toml(), "case.toml", &[]).unwrap(), case, "{file}");
    }
    assert_eq!(parse_case(&format!("name = 'mine'\n{FULL_CASE}")).unwrap().name, "mine");
    assert_eq!(parse_full_case_with(&["name=v1.2_a"]).unwrap().name, "v1.2_a");
}

#[test]
fn angles_are_reduced_modulo_360_degrees() {
    let state = |stress: f64, delta: f64| {
        let mut case = parse_case(FULL_CASE).unwrap();
        case.set_number(
            SweepParameter::find_by_name("background.stress_angle_deg").unwrap(),
            stress,
        );
        case.set_number(
            SweepParameter::find_by_name("background.noncoaxiality_deg").unwrap(),
            delta,
        );
        case.to_flow_state()
    };
    assert_eq!(state(405.0, -725.0), state(45.0, -5.0));
    assert_eq!(state(359.5, 123.456).stress_angle, 359.5f64.to_radians());
    assert_eq!(state(1e308, -1e308), state(1e308 % 360.0, -(1e308 % 360.0)));
    assert!(degrees_to_radians(f64::MAX).abs() < 6.3);
    assert_eq!(degrees_to_radians(90.0 + 360.0), 90f64.to_radians());
}

/// Verifies that an option sets several keys of a section, keeps the others, and refuses unknown ones.
#[test]
fn options_set_sections() {
    let load = |options: &[&str]| {
        let options: Vec<String> = options.iter().map(|&option| option.to_owned()).collect();
        Case::load("noncoaxiality-bound".as_ref(), &options)
    };
    let section = "map={ y = { parameter = 'background.pressure', from = 500, to = 1e3 }, x = { points = 3 } }";
    let keys =
        ["map.y.parameter=background.pressure", "map.y.from=500", "map.y.to=1e3", "map.x.points=3"];
    assert_eq!(load(&[section]).unwrap().to_toml(), load(&keys).unwrap().to_toml());
    let error = load(&["map.x={ form = 1 }"]).unwrap_err().to_string();
    assert!(error.contains("map.x.form: unknown key; did you mean 'from'?"), "{error}");
    let error = load(&["map.x={ from = 'a' }"]).unwrap_err().to_string();
    assert!(
        error.contains("--set map.x={ from = 'a' }: map.x.from: found the text 'a'"),
        "{error}"
    );
}
