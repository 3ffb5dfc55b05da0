//! The verb `check` of plane waves: all bundled cases agree on few cells, other laws of the solver are found, and what
//! cannot be measured is said.

use super::{case_path, run_verb};
use serde_json::Value;
use std::fs;
use wellposed::cli;
use wellposed::report::Report;
use wellposed::setup::check::CheckPlan;
use wellposed::study::check::shocks::{ShockCheck, check_shocks};
use wellposed::study::check::{CheckExtent, CheckOutcome};
use wellposed::study::ignore_progress;

/// Bundled cases.
const CASES: [&str; 10] = [
    "foam-collapse.toml",
    "foam-cone.toml",
    "foam-high-porosity.toml",
    "foam-low-porosity.toml",
    "foam-open.toml",
    "foam-release.toml",
    "sand-compaction.toml",
    "sand-spall.toml",
    "strong-foam-precursor.toml",
    "strong-foam.toml",
];

/// Number of cells, small since the tests run without optimisation of the crate that contains them.
const CELLS: &str = "check.cells=[300, 600]";

fn plan(case: &wellposed::case::Case) -> CheckPlan {
    CheckPlan::new(case, CheckExtent::Short).unwrap()
}

/// Checks the case `name` with the medium of the solver from the case changed by `sets`.
fn check(name: &str, cells: &str, sets: &[&str]) -> ShockCheck {
    let load = |sets: &[&str]| {
        let sets: Vec<&str> = [cells].iter().chain(sets).copied().collect();
        wellposed::load(case_path(name), &sets).unwrap()
    };
    let CheckPlan::Shocks(changed) = plan(&load(sets)) else { panic!("{name}") };
    check_shocks(&load(&[]), &changed, &ignore_progress).unwrap().unwrap()
}

#[test]
fn bundled_cases_agree_on_few_cells() {
    for name in CASES {
        let found = check(name, CELLS, &[]);
        let wrong: Vec<_> = found.columns[0]
            .quantity_checks
            .iter()
            .filter(|own| own.is_in_agreement == Some(false))
            .collect();
        assert!(found.is_in_agreement() == Some(true), "{name}: {wrong:#?}");
        assert_eq!(found.columns.len(), 1, "{name}");
    }
}

/// Yielding precursor, contact by cone and collapse, beside a plastic skeleton.
#[test]
fn plastic_skeleton_with_contact_by_cone_agrees() {
    let sets = [CELLS, "porous.yield_stress=4e6"];
    let case = wellposed::load(case_path("foam-cone.toml"), &sets).unwrap();
    let CheckPlan::Shocks(own) = plan(&case) else { panic!("{case:?}") };
    let found = check_shocks(&case, &own, &ignore_progress).unwrap().unwrap();
    assert_eq!(found.is_in_agreement(), Some(true), "{found:#?}");
}

/// Changes of the law in the solver alone, on columns that resolve the plateau between two fronts where there are two.
#[test]
fn other_laws_of_the_solver_are_found() {
    const FINE: &str = "check.cells=[1000, 2000]";
    for (name, cells, set) in [
        ("foam-collapse.toml", CELLS, "porous.contact_bulk_modulus=40e9"),
        ("foam-collapse.toml", FINE, "model.mu=30e9"),
        ("foam-open.toml", FINE, "model.lambda=65e9"),
        ("foam-cone.toml", CELLS, "porous.contact_bulk_modulus=5e9"),
        ("foam-release.toml", CELLS, "model.mu=30e9"),
        ("strong-foam.toml", CELLS, "porous.porosity=0.2"),
        ("sand-compaction.toml", CELLS, "model.density=2200"),
        ("sand-spall.toml", CELLS, "model.lambda=1.5e9"),
    ] {
        let found = check(name, cells, &[set]);
        assert_eq!(found.is_in_agreement(), Some(false), "{name} {set}: {found:#?}");
    }
}

#[test]
fn cases_beyond_solver_or_solution_are_not_measurable() {
    for (name, sets, key) in [
        (
            "foam-collapse.toml",
            &["porous.plastic_viscosity=100.0"],
            "porous.plastic_viscosity: found 100",
        ),
        (
            "sand-compaction.toml",
            &["granular.bulk_viscosity=1e6"],
            "granular.bulk_viscosity: found 1e6",
        ),
        ("foam-release.toml", &["piston.profile_time=1"], "piston.profile_time: found 1"),
        ("sand-spall.toml", &["granular.friction=0.8"], "granular.friction: found 0.8"),
    ] {
        let case = wellposed::load(case_path(name), sets).unwrap();
        let found = wellposed::check_agreement(&case, CheckExtent::Full, &ignore_progress).unwrap();
        let CheckOutcome::NotMeasurable { reason } = &found.outcome else { panic!("{name}") };
        assert!(reason.contains(key) && found.is_in_agreement.is_none(), "{reason}");
        assert!(found.to_text(&case).contains(key));
    }
}

#[test]
fn report_and_picture_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let options = cli::Options {
        case_path: case_path("sand-spall.toml"),
        settings: vec!["check.cells=[100, 200]".to_owned()],
        format: cli::OutputFormat::Json,
        output_folder: Some(out.clone()),
        ..cli::Options::default()
    };
    let mut printed = Vec::new();
    cli::run_check(&options, &mut printed).unwrap();
    let report: Value = serde_json::from_slice(&printed).unwrap();
    assert_eq!(report["agrees"], true);
    let columns = report["columns"].as_array().unwrap();
    let cells: Vec<u64> = columns.iter().map(|own| own["cells"].as_u64().unwrap()).collect();
    assert_eq!(cells, [100, 200]);
    for row in columns.iter().flat_map(|own| own["rows"].as_array().unwrap()) {
        assert_eq!(row["agrees"], true, "{row}");
        for key in ["predicted", "measured", "difference", "tolerance", "scale"] {
            assert!(row[key].is_f64(), "{row}");
        }
    }
    let text = fs::read_to_string(out.join("check.txt")).unwrap();
    assert!(text.contains("spall: 200 cells") && text.contains("all agree"), "{text}");
    let drawn = fs::read_to_string(out.join("check.svg")).unwrap();
    assert!(drawn.contains("exact solution") && drawn.contains("pressure −σ₁₁ (MPa)"));
    let plan = run_verb(cli::run_check, "sand-spall.toml", &out.join("other"), true).unwrap();
    assert!(plan.contains("columns of 2000 cells"), "{plan}");
}
