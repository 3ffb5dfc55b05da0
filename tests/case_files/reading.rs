//! Tests of parsing and writing case files: values, units, defaults, sweeps and names.

use crate::mutation::without_marks;
use crate::support::{CASE, parse, parse_with};
use models::registry;
use wellposed::CASES;
use wellposed::case::{Case, Kind, Medium, Parameter, Presence, keys, radians};
use wellposed::setup;

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

/// Constants passed to the flow model of a case.
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
    // A changed key must change the input of the model, which detects entries that refer to the field of another
    // entry.
    for parameter in Parameter::all().filter(|p| !p.name().starts_with("wave.")) {
        let medium = Medium::all().find(|&m| parameter.key().is_used_by(m)).unwrap();
        let kind = medium.kind;
        // The stress of layers is used only if no active conditions are named.
        let text = wellposed::cli::new::text(medium).replace("active =", "# active =");
        let mut case = parse(&text).unwrap();
        // In general position, since a parameter multiplied by zero has no effect.
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
            // Named active conditions replace the stress.
            let is_replaced = section == "stress" && case.material.active.is_some();
            let is_used = key.is_used_by(case.medium()) && !is_replaced;
            assert!(stands || !is_used, "[{section}] {name} is missing in\n{resolved}");
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
        // The resolved case has the same name, whatever the name of its file.
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
