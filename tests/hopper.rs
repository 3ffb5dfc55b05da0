//! Radial flow in a hopper by `point`: zero spin, the weight carried by the stress, and the bundled case; slip lines in reports.

use std::f64::consts::PI;
use testkit::random::RandomNumbers;
use wellposed::Error;
use wellposed::models::flow::hopper::{RadialFlow, RadialScales};
use wellposed::models::flow::state::MaterialState;
use wellposed::report::Report;
use wellposed::study::ignore_progress;

const CASE: &str = "cases/granular-flow/hopper.toml";

fn solve([friction, wall, wall_friction]: [f64; 3]) -> RadialFlow {
    RadialFlow::new(friction.to_radians(), wall.to_radians(), wall_friction.to_radians())
        .expect("a hopper with radial flow")
}

fn report(settings: &[&str]) -> Result<(serde_json::Value, String), Error> {
    let case = wellposed::load(CASE, settings)?;
    let found = wellposed::analyse_point(&case, &ignore_progress)?;
    let json = serde_json::to_value(&found).expect("a report");
    Ok((json, found.to_text(&case)))
}

/// Values of a state by key of a case, in the units of the case.
fn case_values(state: &MaterialState) -> Vec<(&'static str, Vec<f64>)> {
    vec![
        ("density", vec![state.density]),
        ("pressure", vec![state.pressure]),
        ("stress_angle_deg", vec![state.stress_angle.to_degrees()]),
        ("shear_rate", vec![state.shear_rate]),
        ("half_vorticity", vec![state.half_vorticity]),
        ("velocity", state.velocity.to_vec()),
        ("pressure_gradient", state.pressure_gradient.to_vec()),
        ("stress_angle_gradient_deg", state.stress_angle_gradient.map(f64::to_degrees).to_vec()),
    ]
}

/// `point` on points of four hoppers (`models/tests/hopper.rs` has 600 points without its search for growth): from the
/// non-coaxiality it derives spin 0, and from the gradients the acceleration less body force (g, 0). All are well-posed, and no slip is reversed.
#[test]
fn radial_flow_has_zero_spin_carries_its_weight_and_is_well_posed() {
    let mut random = RandomNumbers::new(60);
    for hopper in [[30.0, 20.0, 15.0], [40.0, 30.0, 20.0], [45.0, 45.0, 20.0], [15.0, 10.0, 12.0]] {
        let flow = solve(hopper);
        for _ in 0..4 {
            let angle = random.uniform(-1.0, 1.0) * flow.wall_angle();
            let scales = RadialScales {
                density: random.uniform(500.0, 3000.0),
                gravity: random.uniform(1.0, 20.0),
                radius: random.uniform(0.05, 5.0),
                axis_flow: random.uniform(0.01, 2.0),
            };
            let state = flow.fields_at(angle).expect("regular").to_state(&scales);
            let delta = state.noncoaxiality.expect("given");
            let values = case_values(&state).into_iter().map(|(key, values)| match values[..] {
                [value] => format!("background.{key}={value:?}"),
                _ => format!("background.{key}={values:?}"),
            });
            let mut text = std::fs::read_to_string(CASE).expect("a case");
            // The redundant keys of the case, which would contradict other states.
            for key in ["spin = ", "acceleration = ", "[compare]", "kinds = "] {
                let lines = text.lines().filter(|line| !line.starts_with(key));
                text = lines.map(|line| format!("{line}\n")).collect();
            }
            let settings: Vec<String> = values
                .chain([
                    format!("model.friction_angle_deg={:?}", hopper[0]),
                    format!("background.noncoaxiality_deg={:?}", delta.to_degrees()),
                ])
                .collect();
            let case = wellposed::case::Case::parse(&text, CASE, &settings).expect("a case");
            let found = wellposed::analyse_point(&case, &ignore_progress).expect("an analysis");
            let found = serde_json::to_value(&found).expect("a report");
            let number =
                |pointer: &str| found.pointer(pointer).and_then(|x| x.as_f64()).expect(pointer);
            let spin = number("/background/spin");
            assert!(spin.abs() <= 1e-12 * state.shear_rate, "{hopper:?} at {angle}: {spin:e}");
            let first = number("/background/acceleration/0") / scales.gravity - 1.0;
            let second = number("/background/acceleration/1") / scales.gravity;
            assert!(first.abs().max(second.abs()) <= 1e-12, "{hopper:?}: {first:e} {second:e}");
            assert_eq!(found["verdict"], "well-posed", "{hopper:?} at {angle}");
            assert!(number("/slip/0/rate") >= 0.0 && number("/slip/1/rate") >= 0.0);
        }
    }
}

/// The numbers of the bundled case are those of the solution, and its results those that it announces.
#[test]
fn bundled_hopper_is_a_point_of_the_solution() {
    let flow = solve([30.0, 20.0, 15.0]);
    let fields = flow.fields_at(15f64.to_radians()).expect("regular");
    let scales = RadialScales { density: 1600.0, gravity: 9.81, radius: 1.0, axis_flow: 0.2 };
    let text = std::fs::read_to_string(CASE).expect("a case");
    for (key, expected) in case_values(&fields.to_state(&scales)) {
        let line = text.lines().find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "));
        let (values, _) = line.expect(key).split_once('#').expect("a unit");
        let found: Vec<f64> = values
            .split(['[', ']', ',', ' '])
            .filter(|part| !part.is_empty())
            .map(|part| part.parse().expect("a number"))
            .collect();
        assert_eq!(found.len(), expected.len(), "{key}");
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-11, "{key}: {found} for {expected}");
        }
    }
    let (found, text) = report(&[]).expect("a report");
    assert_eq!(found["verdict"], "well-posed");
    assert_eq!(found["compare"][1]["verdict"], "ill-posed");
    assert_eq!(found["compare"][1]["order"], 1.0);
    let delta = found["background"]["noncoaxiality_deg"].as_f64().expect("Δ");
    assert!((delta - fields.noncoaxiality().to_degrees()).abs() < 1e-9, "{delta}");
    assert!((delta + 5.993).abs() < 5e-4, "{delta}");
    assert!(text.contains("acceleration minus body force       (9.81, "), "{text}");
}

/// The report gives slip rates and directions of jumps of velocity, which are those of the steady characteristics of stress
/// and velocity; simple shear with zero spin slips on the shear plane only, and beyond Δ = (φ − ν)/2 slip is reversed.
#[test]
fn point_prints_slip_rates_and_directions_of_jumps() {
    let shear = |more: &[&str]| {
        let uniform = [
            "background.pressure_gradient=[0, 0]",
            "background.stress_angle_gradient_deg=[0, 0]",
            "background.acceleration=[0, 0]",
            "background.shear_rate=1",
            "background.half_vorticity=-1",
            "background.stress_angle_deg=60",
        ];
        report(&[&uniform[..], more].concat()).expect("a report")
    };
    let (found, text) = shear(&[]);
    let slip = |index: usize, key: &str| found["slip"][index][key].as_f64().expect("a number");
    assert!((slip(0, "rate") - 2.0).abs() < 1e-12 && slip(1, "rate").abs() < 1e-7, "{found}");
    let angle = slip(0, "angle_deg");
    assert!(angle.min(180.0 - angle) < 1e-12 && (slip(1, "angle_deg") - 120.0).abs() < 1e-12);
    for index in 0..2 {
        let own = slip(index, "angle_deg");
        let is_characteristic = |c: &serde_json::Value| {
            let distance = (c["angle_deg"].as_f64().expect("an angle") - own) * PI / 180.0;
            c["family"] == "stress and velocity" && distance.sin().abs() < 1e-12
        };
        assert!(found["characteristics"].as_array().expect("a list").iter().any(is_characteristic));
    }
    assert!(text.contains("the velocity may jump along "), "{text}");
    assert!(text.contains("slip along 120°"), "{text}");
    // Another spin: k₁ + k₂ = 2 cos 2Δ/cos φ and k₁ − k₂ = 2(ω − s₂₁), the second slip reversed.
    let (found, text) = shear(&["background.spin=0.5"]);
    let (sum, difference) = ((1.0f64 - 0.75 * 0.75).sqrt() * 2.0 / 0.75f64.sqrt(), 3.0);
    for (index, expected) in [0.5 * (sum + difference), 0.5 * (sum - difference)].iter().enumerate()
    {
        let rate = found["slip"][index]["rate"].as_f64().expect("a rate");
        assert!((rate - expected).abs() < 1e-12, "{rate} {expected}");
    }
    assert!(text.contains("1/s (reversed)"), "{text}");
}

/// Where ν = φ the refusal says what the paper has, and the model that has this flow rule; that model accepts the angles.
#[test]
fn equal_angles_are_refused_with_the_model_that_has_them() {
    let text = report(&["model.dilatancy_angle_deg=30"]).expect_err("ν = φ").to_string();
    for part in
        ["dilatancy_angle_deg", "found 30", "coaxial", "ω = s₂₁", "plastic-potential with equal"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    let text = report(&["model.dilatancy_angle_deg=31"]).expect_err("ν > φ").to_string();
    assert!(!text.contains("plastic-potential"), "{text}");
}
