//! Maps with logarithmically spaced axes.

use wellposed::case::Case;
use wellposed::compute_map;
use wellposed::study::{MapOptions, MapResult, ignore_progress};

/// Harris–Grekova without rotational strength and dilatancy, well-posed up to a non-coaxiality of 45°.
const CASE: &str = "
[model]
kind = 'harris-grekova'
friction_angle_deg = 30
moment_of_inertia = 1.25e-7
rotational_strength = 0
[background]
density = 1600
pressure = 1000
shear_rate = 2
stress_angle_deg = 0
[wave]
number = 500
[map]
x = { parameter = 'background.noncoaxiality_deg', from = 5, to = 80, points = 8, spacing = 'log' }
y = { parameter = 'background.pressure', from = 1e-2, to = 1e3, points = 6, spacing = 'log' }
";

fn parse(settings: &[&str]) -> Result<Case, String> {
    let settings: Vec<String> = settings.iter().map(|own| (*own).to_owned()).collect();
    Case::parse(CASE, "folder/x.toml", &settings).map_err(|error| error.to_string())
}

fn compute(settings: &[&str]) -> MapResult {
    compute_map(&parse(settings).unwrap(), MapOptions::default(), &ignore_progress).unwrap()
}

/// Verifies that the values form a geometric sequence with exact ends, and that powers of ten are exact.
#[test]
fn values_of_log_axes_are_geometric() {
    let found = compute(&[]);
    assert_eq!(found.y.values, [1e-2, 1e-1, 1.0, 10.0, 100.0, 1000.0]);
    let values = &found.x.values;
    assert_eq!([values[0], values[7]], [5.0, 80.0]);
    // The ratio of neighbours is 16^(1/7); 16 = 2⁴ makes every seventh power of it exact.
    for pair in values.windows(2) {
        let power = (pair[1] / pair[0]).powi(7);
        assert!((power - 16.0).abs() < 1e-12, "{pair:?} {power}");
    }
    assert!(found.status_counts.iter().map(|own| own.1).sum::<usize>() == 48);
}

/// Verifies that boundaries are bisected in the logarithm of the value: between the values 5°, 20° and 80° the verdict
/// changes at 45°, at the position 2 log 9 / log 16, and four bisections leave an error of 1/32 of a step.
#[test]
fn boundaries_of_log_axes_are_exact() {
    let found = compute(&["map.x.points=3"]);
    let exact = 2.0 * 9_f64.ln() / 16_f64.ln();
    let column = exact.floor() as usize;
    for row in 0..6 {
        for i in 0..2 {
            let place = found.boundaries.step_fraction(0, 3 * row + i);
            assert_eq!(place.is_nan(), i != column, "{i} {place}");
        }
        let place = column as f64 + found.boundaries.step_fraction(0, 3 * row + column);
        assert!((place - exact).abs() <= 1.0 / 32.0 + 1e-12, "{place} {exact}");
    }
    // With a linear axis the boundary is elsewhere between the same two values.
    let linear = 45.0 - found.x.values[column];
    let linear = linear / (found.x.values[column + 1] - found.x.values[column]);
    assert!((linear - exact.fract()).abs() > 1.0 / 16.0, "{linear}");
}

/// Verifies that resolved cases, reports and tables have the spacing, and that those of linear axes are without it.
#[test]
fn spacing_is_kept_in_cases_and_reports() {
    let case = parse(&["map.y.spacing=linear"]).unwrap();
    let text = case.to_toml();
    assert!(text.contains("points = 8, spacing = \"log\" }"), "{text}");
    assert!(text.contains("points = 6 }"), "{text}");
    let again = Case::parse(&text, "folder/x.toml", &[]).unwrap();
    assert_eq!(again.map, case.map);
    let found = compute(&["map.y.spacing=linear"]);
    let json = serde_json::to_value(&found).unwrap();
    assert_eq!((json["x"]["spacing"].as_str(), json["y"].get("spacing")), (Some("log"), None));
}

#[test]
fn unsuitable_log_axes_are_refused() {
    for (settings, expected) in [
        (
            ["map.x.from=0", "map.x.to=80"],
            "--set map.x.from=0: map.x.from: found 0; expected a number > 0, since the spacing of the axis is log",
        ),
        (
            ["map.x.from=-3", "map.x.to=80"],
            "--set map.x.from=-3: map.x.from: found -3; expected a number > 0, since the spacing of the axis is log",
        ),
        (
            ["map.x.spacing=logarithmic", "map.x.to=80"],
            "--set map.x.spacing=logarithmic: map.x.spacing: found 'logarithmic'; ",
        ),
        (["map.x.from=79.99999999999999", "map.x.points=9"], "too close to differ"),
        (
            ["map.x.from=5e-324", "map.x.points=9000"],
            "map.x.from: found 5e-324; expected a number > 0",
        ),
    ] {
        let error = parse(&settings).unwrap_err();
        assert!(error.contains(expected), "{error}");
    }
}
