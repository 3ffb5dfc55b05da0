//! Tests of `wellposed dispersion` through the library: results against closed forms, and refused input.

use serde_json::Value;
use std::path::Path;
use wellposed::cli::{self, Options, OutputFormat};

const REDUCED_COSSERAT_CASE: &str = "
[model]
kind = 'reduced-cosserat'
dimensions = 3
lambda = 8.1e9
mu = 8.1e9
alpha = 1.005e9
density = 2700
inertia = 2700
[wave]
number = 0.6
direction_deg = 25
elevation_deg = 40
";

/// Runs `wellposed dispersion` on a case; returns the report or the error message.
fn run_dispersion(folder: &Path, case: &str, sets: &[&str]) -> Result<Value, String> {
    let file = folder.join("solid.toml");
    std::fs::write(&file, case).expect("a scratch file");
    let options = Options {
        case_path: file,
        settings: sets.iter().map(|set| (*set).to_owned()).collect(),
        format: OutputFormat::Json,
        output_folder: Some(folder.join("out")),
        force: true,
        ..Options::default()
    };
    let mut stdout = Vec::new();
    cli::run_dispersion(&options, &mut stdout).map_err(|error| error.to_string())?;
    Ok(serde_json::from_slice(&stdout).expect("JSON"))
}

/// Returns the family of waves with a polarisation from a report.
fn find_family<'a>(report: &'a Value, polarisation: &str) -> &'a Value {
    let families = report["families"].as_array().expect("a list");
    families.iter().find(|f| f["polarisation"] == polarisation).expect("such waves")
}

fn assert_close(value: &Value, expected: f64, tolerance: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value / expected - 1.0).abs() < tolerance, "{value} for {expected}");
}

#[test]
fn band_gap_of_reduced_solid_agrees_with_closed_form() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let report = run_dispersion(folder.path(), REDUCED_COSSERAT_CASE, &[]).expect("a sound case");
    let (mu, alpha, density, inertia, k): (f64, f64, f64, f64, f64) =
        (8.1e9, 1.005e9, 2700.0, 2700.0, 0.6);
    let natural = (4.0 * alpha / inertia).sqrt();
    let shear = find_family(&report, "transverse");
    assert_eq!(shear["count"], 2);
    assert_close(&shear["cut_off_frequencies"][0], natural, 1e-12);
    assert_close(&shear["forbidden_bands"][0][0], natural / (1.0 + alpha / mu).sqrt(), 1e-12);
    assert_close(&shear["forbidden_bands"][0][1], natural, 1e-12);
    assert_close(&shear["characteristic_speeds"][0], ((mu + alpha) / density).sqrt(), 1e-12);
    // Dispersion relation k² = ρω²(4α − jω²)/(4αμ − (μ + α)jω²) on both branches.
    for branch in shear["at_wave"].as_array().expect("two branches") {
        let frequency = branch["frequency"].as_f64().expect("a number");
        let square = frequency * frequency;
        let found = density * square * (4.0 * alpha - inertia * square)
            / (4.0 * alpha * mu - (mu + alpha) * inertia * square);
        assert!((found.sqrt() / k - 1.0).abs() < 1e-11, "{found}");
        assert_close(&branch["phase_speed"], frequency / k, 1e-12);
    }
    // Group speeds are derivatives of ω(k), verified by central differences with relative error of order (1e-4)².
    let [before, after] = ["wave.number=0.59994", "wave.number=0.60006"].map(|set| {
        run_dispersion(folder.path(), REDUCED_COSSERAT_CASE, &[set]).expect("a sound case")
    });
    for branch in 0..2 {
        let frequency = |report: &Value| {
            find_family(report, "transverse")["at_wave"][branch]["frequency"]
                .as_f64()
                .expect("a number")
        };
        let slope = (frequency(&after) - frequency(&before)) / 0.00012;
        assert_close(&shear["at_wave"][branch]["group_speed"], slope, 1e-6);
    }
    assert_close(&find_family(&report, "longitudinal")["characteristic_speeds"][0], 3000.0, 1e-12);
    for name in wellposed::cli::folder::DISPERSION_FILES {
        assert!(folder.path().join("out").join(name).metadata().is_ok_and(|m| m.len() > 0));
    }
}

/// Verifies that moduli and compliances of one solid give the same dispersion.
#[test]
fn compliances_and_moduli_give_equal_dispersion() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let moduli = REDUCED_COSSERAT_CASE
        .replace("reduced-cosserat", "cosserat")
        .replace("density", "beta = 7.75e8\ngamma = 1.5e8\neta = 3e8\ndensity");
    let (lambda, mu, alpha) = (8.1e9, 8.1e9, 1.005e9);
    let compliances = format!(
        "[model]\nkind = 'cosserat-compliances'\na1 = {:?}\nb1 = {:?}\na2 = {:?}\nb2 = {:?}\n\
         alpha2 = 4.5e8\ndensity = 2700\ninertia = 2700\n[wave]\nnumber = 0.6\n",
        (lambda + 2.0 * mu) / (4.0 * mu * (lambda + mu)),
        lambda / (4.0 * mu * (lambda + mu)),
        (mu + alpha) / (4.0 * mu * alpha),
        (mu - alpha) / (4.0 * mu * alpha),
    );
    let [first, second] = [moduli, compliances]
        .map(|case| run_dispersion(folder.path(), &case, &[]).expect("a sound case"));
    let (first, second) = (find_family(&first, "transverse"), find_family(&second, "transverse"));
    for branch in 0..2 {
        for key in ["frequency", "group_speed"] {
            let expected = first["at_wave"][branch][key].as_f64().expect("a number");
            assert_close(&second["at_wave"][branch][key], expected, 1e-11);
        }
    }
}

#[test]
fn violated_inequalities_are_refused_with_location() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    for (set, expected) in [
        ("model.alpha=-1", ["model.alpha", "-1", "α > 0"]),
        ("model.lambda=-6e9", ["model.lambda", "3λ + 2μ = -1.8e9", "3λ + 2μ > 0"]),
        ("model.kind=harris-grekova", ["not used", "model.dimensions", ""]),
        (
            "wave.greatest_number=-1",
            ["wave.greatest_number", "found -1", "expected a positive number"],
        ),
    ] {
        let error = run_dispersion(folder.path(), REDUCED_COSSERAT_CASE, &[set]).expect_err(set);
        assert!(expected.iter().all(|word| error.contains(word)), "{set}: {error}");
    }
    let error = run_dispersion(folder.path(), &REDUCED_COSSERAT_CASE.replace("1.005e9", "0"), &[])
        .expect_err("no α");
    assert!(error.contains("solid.toml:7: model.alpha: "), "{error}");
    let flow =
        wellposed::cli::new::generate_state_template(wellposed::case::ModelKind::flow_kinds()[0]);
    let error = run_dispersion(folder.path(), &flow, &[]).expect_err("a flow");
    assert!(error.contains("harris-grekova, a flow"), "{error}");
}
