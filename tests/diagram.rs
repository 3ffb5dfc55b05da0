//! Tests of `wellposed diagram`: files, reported numbers, refusals, other verbs on rheological schemes.

use crate::program;

use program::{create_case_folder, create_folder, run_with_exit_code};
use serde_json::Value;
use std::fs;
use wellposed::case::Case;

const TEST_FOLDER: &str = "diagram";

const POROUS: &str = include_str!("../cases/rheology/porous-plastic.toml");

/// Runs the verb with `--format json` and returns the report.
fn report(folder: &std::path::Path, arguments: &str) -> Value {
    let line = format!("diagram case.toml --format json {arguments}");
    let (stdout, _) = run_with_exit_code(0, folder, &line);
    serde_json::from_str(&stdout).expect("JSON")
}

#[test]
fn files_and_numbers_of_a_diagram() {
    let folder = create_case_folder(TEST_FOLDER, "files", POROUS);
    let (plan, _) = run_with_exit_code(0, &folder, "diagram case.toml --dry-run");
    assert!(plan.starts_with("would follow the load path in 840 steps\n"), "{plan}");
    assert!(!folder.join("out").exists());
    let (text, _) = run_with_exit_code(0, &folder, "diagram case.toml");
    let out = folder.join("out/case");
    for name in wellposed::cli::folder::DIAGRAM_FILES {
        assert!(fs::metadata(out.join(name)).is_ok_and(|file| file.len() > 0), "{name}");
        assert!(plan.contains(name), "{name}");
    }
    assert!(text.contains("tree: (skeleton - hinge) | (particles - contact)"), "{text}");
    assert!(text.contains("hinge flows in compression, open"), "{text}");
    let case = fs::read_to_string(out.join("case.toml")).expect("a case");
    assert_eq!(Case::parse(&case, "case.toml", &[]).expect("a case").to_toml(), case);
    run_with_exit_code(0, &folder, "verify out/case");

    let json: Value =
        serde_json::from_str(&fs::read_to_string(out.join("diagram.json")).expect("it"))
            .expect("it");
    let number = |name: &str| json[name].as_f64().expect("a number");
    assert!(number("ledger_residual") <= 1e-12);
    // −σ⁻ − b(0.06 − θ₀), and σ⁺.
    let stress = [&json["stress"][0], &json["stress"][1]].map(|own| own.as_f64().expect("it"));
    assert!((stress[0] + 1.9e6).abs() < 1e-3 && (stress[1] - 5e5).abs() < 1e-6, "{stress:?}");
    // First compression 1e6 (0.06 − 0.01), extension 5e5 (0.07 − 0.015), then one full cycle (σ⁺ + σ⁻) 0.055.
    let dissipated = 1e6 * 0.05 + 5e5 * 0.055 + 1.5e6 * 0.055;
    assert!((number("dissipated_energy") - dissipated).abs() < 1e-9 * dissipated);
    let slopes: Vec<f64> = json["segments"]
        .as_array()
        .expect("segments")
        .iter()
        .map(|own| own["slope"].as_f64().expect("a slope"))
        .collect();
    assert_eq!(slopes[..3], [1e8, 0.0, 3e7]);
    assert!(slopes[3..6] == [1.3e8, 3e7, 0.0] || slopes[3..6] == [1.3e8, 1e8, 0.0], "{slopes:?}");
    let table = fs::read_to_string(out.join("diagram.csv")).expect("a table");
    assert_eq!(table.lines().count(), 842);
    assert!(
        table.starts_with("time,strain,stress,work,stored_energy,dissipated_energy,step_loss,")
    );
}

#[test]
fn settings_change_the_path() {
    let folder = create_case_folder(TEST_FOLDER, "settings", POROUS);
    let one = report(&folder, "--set load_path.cycles=1 --force");
    assert_eq!(one["steps"], 420);
    // The loss of the implicit steps falls with their number, all else equal.
    let fine = report(&folder, "--set load_path.cycles=1 --set load_path.steps=420 --force");
    let loss = |own: &Value| own["step_loss"].as_f64().expect("a number");
    assert!((loss(&one) / loss(&fine) - 2.0).abs() < 0.05);
    for name in ["dissipated_energy", "stored_energy"] {
        let [a, b] = [&one, &fine].map(|own| own[name].as_f64().expect("a number"));
        assert!((a - b).abs() <= 1e-9 * a.abs().max(1.0), "{name}: {a} {b}");
    }
}

#[test]
fn a_path_that_the_scheme_cannot_follow_is_refused() {
    let text = "[rheology]\nkind = 'granular-elastic'\nmodulus = 1e8\n[load_path]\ncontrol = 'stress'\n\
                points = [[0, -1e6], [1, 1e6]]\nsteps = 10\n";
    let folder = create_case_folder(TEST_FOLDER, "tension", text);
    let (_, error) = run_with_exit_code(2, &folder, "diagram case.toml");
    assert!(
        error.contains(
            "case.toml:6: load_path.points: at the time 0.6 s the stress 200000 Pa is not borne: the \
             stress of this scheme is from −∞ to 0 Pa; give values that the scheme can reach"
        ),
        "{error}"
    );
    assert!(!folder.join("out").exists());
}

#[test]
fn other_verbs_refuse_schemes_and_diagram_refuses_models() {
    let folder = create_case_folder(TEST_FOLDER, "other-verbs", POROUS);
    for verb in ["map", "point", "dispersion", "homogenise", "speeds"] {
        let (_, error) = run_with_exit_code(2, &folder, &format!("{verb} case.toml"));
        let message = "rheology: found a rheological scheme; expected a flow or a solid; wellposed diagram computes \
                       the response of a scheme";
        assert!(error.contains(message), "{verb}: {error}");
    }
    let (_, error) = run_with_exit_code(2, &folder, "run case.toml");
    assert!(
        error.contains("rheology: found a rheological scheme; compute its response"),
        "{error}"
    );
    let solid = "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1\nmu = 1\ndensity = 1\n";
    let folder = create_case_folder(TEST_FOLDER, "solid", solid);
    let (_, error) = run_with_exit_code(2, &folder, "diagram case.toml");
    assert!(
        error.contains("case.toml:2: model.kind: found classical; expected a rheological scheme"),
        "{error}"
    );
}

#[test]
fn the_template_is_a_case() {
    let folder = create_folder(TEST_FOLDER, "template");
    run_with_exit_code(0, &folder, "new rheology");
    let (text, _) = run_with_exit_code(0, &folder, "diagram rheology.toml");
    assert!(text.contains("scheme: porous medium with elastic-plastic skeleton"), "{text}");
}
