//! Verifies the stated ranges of parameters against the states that the program accepts.

use models::common::range::AllowedRange;
use testkit::ranges::{closed_ends, values_outside};
use wellposed::case::template::{TemplateKind, generate_template};
use wellposed::case::{Case, Key, MediumKind, keys};
use wellposed::study::map::PointStatus;
use wellposed::study::{MapOptions, ignore_progress};

/// Returns the message with which the program refuses the state with another value of a key; `None` if the state is
/// accepted.
fn refusal_message(text: &str, key: &Key, value: f64) -> Option<String> {
    let set = format!("{}={value:?}", key.name);
    let state = Case::parse(text, "x.toml", &[set]).map_err(wellposed::Error::from);
    state
        .and_then(|case| wellposed::analyse_point(&case, &ignore_progress))
        .err()
        .map(|error| error.to_string())
}

#[test]
fn states_are_refused_outside_ranges_and_accepted_at_closed_ends() {
    let mut checked: Vec<&str> = Vec::new();
    for medium in MediumKind::all_media() {
        let text = generate_template(medium, TemplateKind::SingleState);
        for key in keys().iter().filter(|key| key.is_used_by(medium)) {
            let what = format!("{} of {}", key.name, medium.title());
            for value in values_outside(key.range) {
                let refusal = refusal_message(&text, key, value);
                let names_it = refusal.as_ref().is_some_and(|error| error.contains(key.name));
                assert!(names_it, "{what} = {value:?}: {refusal:?}");
                checked.push(key.name);
            }
            for value in closed_ends(key.range) {
                assert_eq!(refusal_message(&text, key, value), None, "{what} = {value:?}");
            }
        }
    }
    for key in keys().iter().filter(|key| key.range != AllowedRange::Finite) {
        assert!(checked.contains(&key.name), "{} has not been checked", key.name);
    }
    for name in ["model.mu", "model.friction_angle_deg", "yield.friction", "wave.number"] {
        assert!(checked.contains(&name), "{name} has no range");
    }
}

/// Verifies that a map continues through states out of range and marks each of them.
#[test]
fn map_marks_points_outside_ranges() {
    let text = "
[model]
kind = 'classical'
dimensions = 2
lambda = 2e9
mu = -1
density = 2000
[map]
x = { parameter = 'model.mu', from = -1e9, to = 1e9, points = 3 }
y = { parameter = 'wave.number', from = 1, to = 2, points = 2 }
";
    let case = Case::parse(text, "x.toml", &[]).expect("a case");
    let map =
        wellposed::compute_map(&case, MapOptions::default(), &ignore_progress).expect("a map");
    let count = |status| map.points.iter().filter(|point| point.status == status).count();
    assert_eq!([count(PointStatus::OutsideModel), count(PointStatus::WellPosed)], [4, 2]);
}
