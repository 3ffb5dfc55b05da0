//! Tests of `wellposed homogenise`: reported constants, the written case in other verbs, refusals, JSON report.

use crate::program;

use program::{create_case_folder, run_with_exit_code};
use serde_json::Value;
use std::fs;
use std::path::Path;
use wellposed::case::{Case, ContinuumOptions};
use wellposed::cli::{self, CheckpointSettings, Options, OutputFormat};
use wellposed::study;

const TEST_FOLDER: &str = "homogenise";

const BLOCKY_CASE: &str = "
title = 'Blocks'
[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[[block]]
name = 'rock'
cells = [5, 5]
size = [0.05, 0.05]
repeat = [16, 8]
origin = [-0.4, -0.4]
[[joint]]
every = 'all'
kind = 'breaking'
thickness = 5e-3
density = 1500
longitudinal_speed = 1000
shear_speed = 500
shear_strength = 1e6
shear_friction = 0.5
tensile_strength = 5e5
[time]
duration = 2e-4
[[boundary]]
side = 'x1-'
kind = 'non-reflecting'
[[load]]
side = 'x2+'
field = 'sigma22'
from = -0.1
to = 0.1
amplitude = -4e6
time = { kind = 'step', start = 0.0, duration = 1e-4 }
[[receiver]]
name = 'below'
at = [0.025, -0.125]
interpolation = 'none'
";

fn run_json(folder: &Path, arguments: &str) -> Value {
    let (stdout, _) = run_with_exit_code(0, folder, arguments);
    serde_json::from_str(&stdout).expect("JSON")
}

/// Reference values by layer thickness δ, m: speeds of P waves, long S waves and short S waves, m/s; natural frequency
/// f* of block rotation, kHz; stiffness ratio K_t h/μ.
const REFERENCE_CONSTANTS: [(f64, [f64; 3], f64, f64); 3] = [
    (1e-4, [4769.6, 2670.5, 6463.5], 91.8, 7.7),
    (1e-3, [3551.9, 1565.6, 2418.2], 28.9, 0.77),
    (5e-3, [2010.1, 761.7, 1097.8], 12.65, 0.154),
];

#[test]
fn reported_constants_agree_with_reference_values() {
    let folder = create_case_folder(TEST_FOLDER, "table", BLOCKY_CASE);
    for (thickness, speeds, frequency, ratio) in REFERENCE_CONSTANTS {
        let arguments = format!(
            "homogenise case.toml --set joint[0].thickness={thickness:e} --out out.toml --force --format json"
        );
        let found = run_json(&folder, &arguments);
        let is_close = |value: &Value, expected: f64, tolerance: f64| {
            let value = value.as_f64().expect("a number");
            assert!((value / expected - 1.0).abs() < tolerance, "{value} for {expected}");
        };
        assert_eq!(found["model"], "cosserat-compliances");
        for (name, expected) in ["longitudinal", "long_shear", "short_shear"].iter().zip(speeds) {
            is_close(&found["speeds"][name], expected, 5e-5);
        }
        is_close(&found["natural_frequency_hz"], frequency * 1e3, 2e-3);
        is_close(&found["stiffness_ratio"], ratio, 5e-3);
        assert_eq!(found["blocks_are_rigid"], ratio < 0.2);
        assert_eq!(found["written"], "out.toml");
        let status = |name: &str| {
            let rows = found["constants"].as_array().expect("a list");
            let row = rows.iter().find(|row| row["name"] == name).expect("a constant");
            assert!(row["value"].is_number() && row["unit"].is_string());
            row["status"].as_str().expect("text").to_owned()
        };
        assert_eq!(
            [status("a1"), status("a2"), status("alpha2")],
            ["sure", "leading order", "not unique"]
        );
        let (text, _) = run_with_exit_code(0, &folder, &arguments.replace(" --format json", ""));
        assert_eq!(text.contains("warning: not small"), ratio > 0.2, "{text}");
        assert!(text.trim_end().ends_with("case: out.toml"));
    }
}

/// Verifies that `point`, `dispersion` and `run` read the written case, and that `--out` names its file or its folder.
#[test]
fn written_case_is_read_by_other_verbs() {
    let folder = create_case_folder(TEST_FOLDER, "round-trip", BLOCKY_CASE);
    fs::create_dir(folder.join("media")).expect("a folder");
    run_with_exit_code(
        0,
        &folder,
        "homogenise case.toml --out media --cells-per-block 2 --overturning",
    );
    let path = folder.join("media/case-continuum.toml");
    let case = Case::load(&path, &[]).expect("a case");
    assert_eq!(case.title, "Blocks, equivalent continuum");
    assert_eq!(case.solid_run.as_ref().expect("a simulation").grid.cells, [32, 16]);
    assert!((case.number("yield.couple_friction").expect("a number") - 0.025).abs() < 1e-12);
    let options = |name: &str| Options {
        case_path: path.clone(),
        format: OutputFormat::Json,
        output_folder: Some(folder.join(name)),
        ..Options::default()
    };
    let json = |bytes: &[u8]| serde_json::from_slice::<Value>(bytes).expect("JSON");
    let mut printed = Vec::new();
    cli::run_point(&options("point"), &mut printed).expect("a point");
    let point = json(&printed);
    assert_eq!(
        (&point["model"], &point["yield"]),
        (&"cosserat-compliances".into(), &"interlayer".into())
    );
    assert_eq!(point["verdict"], "well-posed");
    printed.clear();
    cli::run_dispersion(&options("dispersion"), &mut printed).expect("waves");
    assert_eq!(json(&printed)["model"], "cosserat-compliances");
    printed.clear();
    cli::run_simulation(&options("run"), CheckpointSettings { interval: 1e9 }, &mut printed)
        .expect("a run");
    assert!(folder.join("run/run.json").exists());
    assert!(folder.join("run/receivers.csv").exists());
}

#[test]
fn files_are_not_overwritten_without_force() {
    let folder = create_case_folder(TEST_FOLDER, "force", BLOCKY_CASE);
    let (plan, _) = run_with_exit_code(0, &folder, "homogenise case.toml --dry-run");
    assert!(plan.contains("would write case-continuum.toml"), "{plan}");
    assert!(!folder.join("case-continuum.toml").exists());
    run_with_exit_code(0, &folder, "homogenise case.toml");
    let before = fs::read(folder.join("case-continuum.toml")).expect("a file");
    let (_, stderr) = run_with_exit_code(2, &folder, "homogenise case.toml");
    assert!(stderr.contains("exists already") && stderr.contains("--force"), "{stderr}");
    run_with_exit_code(0, &folder, "homogenise case.toml --force");
    assert_eq!(fs::read(folder.join("case-continuum.toml")).expect("a file"), before);
    // The blocky case itself is not overwritten either.
    run_with_exit_code(2, &folder, "homogenise case.toml --out case.toml");
    assert_eq!(fs::read_to_string(folder.join("case.toml")).expect("a file"), BLOCKY_CASE);
}

/// Verifies that refusals name file, line, key, found value and allowed values.
#[test]
fn cases_without_equivalent_continuum_are_refused() {
    let folder = create_case_folder(TEST_FOLDER, "refused", BLOCKY_CASE);
    let refuse = |arguments: &str, key: &str, remedy: &str| {
        let line = format!("homogenise {arguments} --format json");
        let (_, stderr) = run_with_exit_code(2, &folder, &line);
        let error: Value = serde_json::from_str(stderr.trim()).expect("JSON");
        assert_eq!(error["key"], key, "{error}");
        assert!(error["found"].is_string() && error["exit_code"] == 2);
        assert!(error["allowed"].as_str().expect("text").contains(remedy), "{error}");
        error
    };
    let cracked = BLOCKY_CASE
        .replace("'breaking'", "'cracked'")
        .replace("shear_strength = 1e6\n", "")
        .replace("tensile_strength = 5e5\n", "");
    fs::write(folder.join("cracked.toml"), &cracked).expect("a file");
    let error = refuse("cracked.toml", "joint[0].kind", "elastic-plastic");
    let line = 1 + cracked.lines().position(|line| line.contains("cracked")).expect("a line");
    assert_eq!((&error["file"], &error["line"]), (&"cracked.toml".into(), &line.into()));
    let shift = "case.toml --set block[0].row_shift=0.03 --set block[0].cells=[10,10]";
    assert_eq!(refuse(shift, "block[0].row_shift", "aligned")["option"], "block[0].row_shift=0.03");
    refuse("case.toml --set joint[0].slip_hardening=1e9", "joint[0].slip_hardening", "harden");
    fs::write(
        folder.join("plain.toml"),
        "[model]\nkind = 'classical'\ndimensions = 2\nlambda = 1e9\nmu = 1e9\ndensity = 2000\n",
    )
    .expect("a file");
    refuse("plain.toml", "block", "[[block]]");
}

#[test]
fn library_returns_the_case_without_writing() {
    let case = Case::parse(BLOCKY_CASE, "case.toml", &[]).expect("a case");
    let found = study::homogenise(&case, &ContinuumOptions::default()).expect("a continuum");
    assert_eq!(found.written_path, None);
    assert_eq!(found.constants.len(), 11);
    let own = found.yield_set.expect("a yield set");
    assert_eq!([own.shear_strength, own.shear_friction], [1e6, 0.5]);
    assert!((own.couple_strength / (0.05 / 6.0 * 5e5) - 1.0).abs() < 1e-12);
    let again = Case::parse(&found.continuum_case.toml, "again.toml", &[]).expect("a case");
    assert_eq!(again.to_toml(), found.continuum_case.case.to_toml());
}
