//! The verb `shocks`: waves of the bundled cases against closed forms, files, and refusals.

#[path = "shocks/check.rs"]
mod check;
#[path = "shocks/orders.rs"]
mod orders;

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use wellposed::cli::{self, Options, OutputFormat};
use wellposed::study::{ShocksResult, compute_shocks, ignore_progress};

fn case_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/porous").join(name)
}

fn solve(name: &str, sets: &[&str]) -> Result<ShocksResult, wellposed::Error> {
    compute_shocks(&wellposed::load(case_path(name), sets)?)
}

/// Kinds and speeds of the waves, the latter rounded to m/s.
fn waves(found: &ShocksResult) -> Vec<(&'static str, f64)> {
    let waves = &found.piston.as_ref().expect("a piston").waves;
    waves.iter().map(|wave| (wave.kind, wave.speed.round())).collect()
}

/// Closed forms for aluminium foam of the density 2700(1 − θ₀), in GPa: E₀ = 104.3, k_a = 71.58, k_b = 4.256,
/// τ_s = 0.0378; c_p⁰ = √(E₀/ρ), c_f⁰ = √(k_a/ρ), and the compaction shocks.
#[test]
fn slide_cases_have_the_speeds_of_the_closed_forms() {
    let (elastic, bulk, added, limit): (f64, f64, f64, f64) = (104.3e9, 71.58e9, 4.256e9, 37.8e6);
    let yield_strain = limit / 24.54e9;
    let density = |porosity: f64| 2700.0 * (1.0 - porosity);
    let speed = |modulus: f64, porosity: f64| (modulus / density(porosity)).sqrt();
    let compaction = |factor: f64, porosity: f64| {
        let rise = factor * limit - elastic * yield_strain;
        speed(bulk + added, porosity) * (rise / (rise + added * (porosity - yield_strain))).sqrt()
    };
    let first = elastic * yield_strain + added * (yield_strain - 0.001);
    let shock = speed(elastic + added, 0.001) * (first / (first + added * 0.001)).sqrt();
    let (precursor, second) = ("elastic wave", "plastic compaction shock");
    for (name, expected) in [
        (
            "foam-low-porosity.toml",
            [("compaction shock", shock), ("plastic wave", speed(bulk + added, 0.001))],
        ),
        (
            "foam-collapse.toml",
            [(precursor, speed(elastic, 0.01)), (second, compaction(25.0, 0.01))],
        ),
        (
            "foam-open.toml",
            [(precursor, speed(elastic, 0.05)), ("plastic wave", speed(bulk, 0.05))],
        ),
        (
            "foam-high-porosity.toml",
            [(precursor, speed(elastic, 0.05)), (second, compaction(125.0, 0.05))],
        ),
    ] {
        let found = solve(name, &[]).unwrap();
        let expected = expected.map(|(kind, speed)| (kind, speed.round()));
        assert_eq!(waves(&found), expected, "{name}");
        assert!(found.is_strictly_hyperbolic && found.solitary_threshold.is_none());
    }
}

#[test]
fn strong_foam_has_a_solitary_wave_above_its_threshold() {
    let found = solve("strong-foam.toml", &[]).unwrap();
    let threshold = found.solitary_threshold.unwrap();
    assert!((threshold - 2.8e9 * 5.384 / 105.0).abs() < 1e-6 * threshold);
    let kinds = |pressure: f64| {
        let set = format!("piston.pressure={pressure:e}");
        waves(&solve("strong-foam.toml", &[&set]).unwrap())
            .into_iter()
            .map(|own| own.0)
            .collect::<Vec<_>>()
    };
    assert_eq!(kinds(1.0001 * threshold), ["solitary wave"]);
    assert_eq!(kinds(0.9999 * threshold), ["elastic wave", "plastic compaction shock"]);
}

#[test]
fn sand_says_that_the_open_medium_is_not_strictly_hyperbolic() {
    let found = solve("sand-compaction.toml", &[]).unwrap();
    assert!(
        !found.is_strictly_hyperbolic && found.notes[0].starts_with("open: speed of sound zero")
    );
    let piston = found.piston.unwrap();
    assert_eq!((piston.speed, piston.initial_strain), (5.0, -0.01));
    assert_eq!(piston.waves[0].sound_speeds[0], 0.0);
    let spall = solve("sand-spall.toml", &[]).unwrap().spall.unwrap();
    assert_eq!(spall.layer_velocity, 4.0);
    assert!((spall.thickness - 0.5 * spall.sound_speed * 1e-3).abs() < 1e-12);
    assert!((spall.gap - 2.0 * 2.0 * 0.5e-3).abs() < 1e-12);
}

fn run_verb(
    verb: impl Fn(&Options, &mut dyn std::io::Write) -> Result<(), cli::CommandError>,
    name: &str,
    out: &Path,
    is_dry_run: bool,
) -> Result<String, String> {
    let options = Options {
        case_path: case_path(name),
        format: OutputFormat::Json,
        output_folder: Some(out.to_owned()),
        is_dry_run,
        ..Options::default()
    };
    let mut printed = Vec::new();
    verb(&options, &mut printed).map_err(|error| error.to_string())?;
    Ok(String::from_utf8(printed).unwrap())
}

#[test]
fn files_are_those_of_the_dry_run_and_the_report_is_printed() {
    for name in ["foam-collapse.toml", "foam-release.toml", "sand-spall.toml"] {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let plan: Value =
            serde_json::from_str(&run_verb(cli::run_shocks, name, &out, true).unwrap()).unwrap();
        assert!(!out.exists());
        let printed = run_verb(cli::run_shocks, name, &out, false).unwrap();
        assert_eq!(printed, fs::read_to_string(out.join("shocks.json")).unwrap());
        let mut planned: Vec<String> = plan["would_write"]
            .as_array()
            .unwrap()
            .iter()
            .map(|path| Path::new(path.as_str().unwrap()).file_name().unwrap())
            .map(|name| name.to_str().unwrap().to_owned())
            .collect();
        let mut written: Vec<String> = fs::read_dir(&out)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        planned.sort();
        written.sort();
        assert_eq!(planned, written, "{name}");
    }
}

/// Verifies the table of waves: a row per wave, with ρc[v] = [p].
#[test]
fn table_of_waves_has_consistent_jumps() {
    let folder = tempfile::tempdir().unwrap();
    run_verb(cli::run_shocks, "foam-release.toml", folder.path(), false).unwrap();
    let table = fs::read_to_string(folder.path().join("shocks.csv")).unwrap();
    let mut rows = table.lines();
    let header: Vec<&str> = rows.next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|own| *own == name).unwrap();
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split(',').collect();
        let number = |name: &str| cells[column(name)].parse::<f64>().unwrap();
        let jump =
            |name: &str| number(&format!("{name}_behind")) - number(&format!("{name}_ahead"));
        let impulse = 2697.3 * number("speed") * jump("velocity");
        assert!((impulse - jump("pressure")).abs() <= 1e-10 * impulse.abs(), "{row}");
        count += 1;
    }
    assert_eq!(count, 3);
}

#[test]
fn other_verbs_and_wrong_requests_are_refused_with_the_key() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    for verb in [cli::run_point, cli::run_dispersion, cli::run_speeds] {
        for is_dry_run in [true, false] {
            let error = run_verb(verb, "foam-collapse.toml", &out, is_dry_run).unwrap_err();
            assert!(
                error.contains("porous: not used here: this command takes solids without"),
                "{error}"
            );
        }
    }
    let case = wellposed::load(case_path("foam-collapse.toml"), wellposed::NO_SETTINGS).unwrap();
    assert!(wellposed::analyse_point(&case, &ignore_progress).is_err());
    for (name, set, expected) in [
        ("foam-collapse.toml", "model.mu=-1", "--set model.mu=-1: model.mu: found"),
        (
            "foam-release.toml",
            "piston.profile_time=1",
            "piston.profile_time: found 1; expected at most",
        ),
        ("sand-spall.toml", "spall.speed=100", "spall.speed: found 100; expected at most"),
        (
            "sand-spall.toml",
            "granular.friction=0.8",
            "granular.friction: found 0.8; expected at most",
        ),
        ("sand-compaction.toml", "granular.friction=-1", "granular.friction: found -1;"),
    ] {
        let error = solve(name, &[set]).unwrap_err().to_string();
        assert!(error.contains(expected), "{error}\n{expected}");
    }
    let plain = wellposed::load(
        Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/cosserat/forbidden-band.toml"),
        wellposed::NO_SETTINGS,
    )
    .unwrap();
    let error = compute_shocks(&plain).unwrap_err().to_string();
    assert!(error.contains("expected a classical solid with a section [porous]"), "{error}");
}
