//! Tests of `wellposed dispersion` and `wellposed point` for blocky media: branches, band gaps, long waves, damping,
//! refusals.

use files::npz;
use serde_json::Value;
use std::path::Path;
use wellposed::case::Case;
use wellposed::cli::folder::BLOCH_FILES;
use wellposed::cli::{self, Options, OutputFormat};
use wellposed::study::{compute_bloch_waves, ignore_progress};

const BLOCKY_CASE: &str = "
[model]
kind = 'classical'
lambda = 1.89e10
mu = 2.43e10
density = 2700
[[block]]
name = 'rock'
cells = [6, 6]
size = [0.05, 0.05]
repeat = [4, 4]
[time]
duration = 1e-5
[[joint]]
every = 'all'
thickness = 5e-3
density = 1500
longitudinal_speed = 1000
shear_speed = 500
";

fn elastic_case() -> String {
    format!("{BLOCKY_CASE}kind = 'elastic'\n")
}

fn viscous_case() -> String {
    // a₁ = 2/(ρ′c₂′²), retardation time 20 µs.
    format!(
        "{BLOCKY_CASE}kind = 'viscous'\ndelayed_compliance = 5.333333333333333e-9\nviscosity = 3750\n"
    )
}

fn run_dispersion(
    folder: &Path,
    case: &str,
    sets: &[&str],
    threads: usize,
    is_json: bool,
) -> Result<String, String> {
    let file = folder.join("blocks.toml");
    std::fs::write(&file, case).expect("a scratch file");
    let options = Options {
        case_path: file,
        settings: sets.iter().map(|set| (*set).to_owned()).collect(),
        format: if is_json { OutputFormat::Json } else { OutputFormat::Text },
        output_folder: Some(folder.join("out")),
        force: true,
        thread_count: Some(threads),
        ..Options::default()
    };
    let mut stdout = Vec::new();
    cli::run_dispersion(&options, &mut stdout).map_err(|error| error.to_string())?;
    Ok(String::from_utf8(stdout).expect("text"))
}

fn parse_json(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

/// Verifies the Bloch waves of blocks with elastic layers of 5 mm: band gap, long waves as in the continuum, verdict,
/// files, and bit-identical results for any number of threads.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn elastic_joints_have_band_gap_and_continuum_long_waves() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let text = run_dispersion(folder.path(), &elastic_case(), &[], 1, true).expect("a medium");
    let found = parse_json(&text);
    assert_eq!((&found["model"], &found["verdict"]), (&"blocky".into(), &"well-posed".into()));
    assert_eq!((&found["stable"], &found["bound"]), (&true.into(), &0.0.into()));
    assert!(found["evidence"]["wave_vectors"].as_u64() > Some(50));
    let names: Vec<&str> = found["path"]
        .as_array()
        .expect("a path")
        .iter()
        .filter_map(|at| at["name"].as_str())
        .collect();
    assert_eq!(names, ["Γ", "X", "M", "Γ"]);
    // Expected frequencies, computed with polynomials of degree 6 in each block.
    let gaps = found["forbidden_bands"].as_array().expect("gaps");
    for (edge, expected) in [100_956.0, 226_531.0].into_iter().enumerate() {
        let value = gaps[0][edge].as_f64().expect("a number");
        assert!((value / expected - 1.0).abs() < 1e-3, "{value}");
    }
    let long_waves = found["long_waves"].as_array().expect("directions");
    assert_eq!(long_waves.len(), 3);
    for wave in long_waves {
        for (index, expected) in [761.7, 2010.1].into_iter().enumerate() {
            let difference = wave["difference"][index].as_f64().expect("a number");
            assert!(difference.abs() < 1e-4, "{wave}");
            if wave["direction_deg"] == 0.0 {
                let speed = wave["medium"][index].as_f64().expect("a number");
                assert!((speed / expected - 1.0).abs() < 1e-4, "{speed}");
            }
        }
    }
    for name in BLOCH_FILES {
        assert!(folder.path().join("out").join(name).exists(), "{name}");
    }
    let read = |name: &str| std::fs::read(folder.path().join("out").join(name)).expect("a file");
    let table = String::from_utf8(read("dispersion.csv")).expect("text");
    for family in ["medium", "continuum", "chain P", "chain S"] {
        assert!(table.lines().any(|line| line.starts_with(family)), "{family}");
    }
    let arrays: Vec<String> = npz::read_arrays(&read("dispersion.npz"))
        .expect("arrays")
        .into_iter()
        .map(|own| own.name)
        .collect();
    for name in ["family", "branch", "distance", "frequency", "decay_rate", "longitudinal_share"] {
        assert!(arrays.iter().any(|own| own == name), "{arrays:?}");
    }
    let before = [read("dispersion.csv"), read("dispersion.json"), read("dispersion.png")];
    run_dispersion(folder.path(), &elastic_case(), &[], 2, true).expect("a medium");
    assert!(before == [read("dispersion.csv"), read("dispersion.json"), read("dispersion.png")]);
    let printed = String::from_utf8(read("dispersion.txt")).expect("text");
    for word in ["Verdict: well-posed, stable", "no waves between", "K_t h/μ = 0.15", "chain"] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
}

/// Verifies the frequencies of the chain of blocks at κh = π/4 and π/2 against exact values in kHz; κ is the wave
/// number and h the block size.
#[test]
fn chain_frequencies_agree_with_exact_values() {
    let case = Case::parse(&elastic_case(), "blocks.toml", &[]).expect("a case");
    let found = compute_bloch_waves(&case, &ignore_progress).expect("waves");
    let chain = found.chain_branches.iter().find(|chain| chain.name == "P").expect("a chain");
    let quarter = std::f64::consts::FRAC_PI_4 / 0.05;
    for (index, expected) in [(1.0, 5.11290), (2.0, 9.73241), (4.0, 14.47159)] {
        let near = |point: &&[f64; 2]| (point[0] - index * quarter).abs() < 1e-6 * quarter;
        let point = chain.curves[0].iter().find(near).expect("a point");
        let frequency = point[1] / (2e3 * std::f64::consts::PI);
        assert!((frequency / expected - 1.0).abs() < 1e-6, "{frequency} for {expected}");
    }
    // Branches at Γ start at zero; all energies are positive.
    assert!(found.path_waves[0].waves[1].frequency < 1.0 && found.evidence.has_positive_energy);
}

#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn viscous_joints_damp_waves() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let found = parse_json(
        &run_dispersion(folder.path(), &viscous_case(), &[], 2, true).expect("a medium"),
    );
    assert_eq!((&found["stable"], &found["forbidden_bands"]), (&true.into(), &Value::Null));
    let time = found["joints"][0]["retardation_time"].as_f64().expect("a number");
    assert!((time / 2e-5 - 1.0).abs() < 1e-9);
    // For slow waves the tangential joint stiffness K_t is a third of the instantaneous one.
    for wave in found["long_waves"].as_array().expect("directions") {
        for index in 0..2 {
            assert!(wave["difference"][index].as_f64().expect("a number").abs() < 1e-4, "{wave}");
        }
    }
    let table = std::fs::read_to_string(folder.path().join("out/dispersion.csv")).expect("a table");
    let is_decaying = |line: &str| {
        let rate: f64 = line.split(',').nth(6).expect("a column").parse().expect("a number");
        rate > 1e3
    };
    assert!(table.lines().skip(1).filter(|line| line.starts_with("medium")).any(is_decaying));
}

/// Verifies that masonry (blocks in shifted rows) has Bloch waves but no equivalent continuum.
#[test]
#[ignore = "takes half a minute"]
fn masonry_has_bloch_waves_but_no_continuum() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let found = parse_json(
        &run_dispersion(folder.path(), &elastic_case(), &["block[0].row_shift=0.025"], 2, true)
            .expect("masonry"),
    );
    assert!(found["no_continuum"].as_str().expect("a reason").contains("aligned"), "{found}");
    assert_eq!(found["stable"], true);
}

/// Verifies that joints of different laws normal to one axis are refused.
#[test]
fn mixed_laws_are_refused() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let mixed = elastic_case()
        + "[[joint]]\nat = [0.05, 0.025]\nkind = 'elastic'\nthickness = 1e-3\ndensity = 1500\nlongitudinal_speed = 1000\nshear_speed = 500\n";
    let error = run_dispersion(folder.path(), &mixed, &[], 1, true).expect_err("no period");
    assert!(error.contains("joint[1]") && error.contains("one law of joints"), "{error}");
}

#[test]
fn point_analyses_blocks_and_reports_part() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let file = folder.path().join("blocks.toml");
    std::fs::write(&file, elastic_case()).expect("a scratch file");
    for format in [OutputFormat::Json, OutputFormat::Text] {
        let options = Options {
            case_path: file.clone(),
            format,
            output_folder: Some(folder.path().join("out")),
            ..Options::default()
        };
        let mut stdout = Vec::new();
        cli::run_point(&options, &mut stdout).expect("a solid");
        let text = String::from_utf8(stdout).expect("text");
        match format {
            OutputFormat::Json => assert_eq!(parse_json(&text)["part"], "blocks"),
            OutputFormat::Text => assert!(text.contains("wellposed dispersion"), "{text}"),
        }
    }
}
