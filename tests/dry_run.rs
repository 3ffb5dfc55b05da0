//! Verifies that `--dry-run` of every verb lists exactly the files that the verb writes.

use crate::program;

use program::{list_entries, run_with_arguments};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Output;

/// Runs the program in the root of the repository.
fn run_in_root(arguments: &[&str]) -> Output {
    run_with_arguments(Path::new(env!("CARGO_MANIFEST_DIR")), arguments)
}

/// Returns the names of the files announced by a dry run; a range of snapshots is expanded.
fn parse_announced_files(text: &str, folder: &Path) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for line in text.lines().filter_map(|line| line.strip_prefix("would write ")) {
        let line = line.strip_prefix(folder.to_str().expect("text")).expect("of the folder");
        let line = line.trim_start_matches('/');
        let Some((first, last)) = line.split_once(" to ") else {
            assert!(names.insert(line.to_owned()), "{line} twice");
            continue;
        };
        let number = |name: &str| -> usize {
            name.trim_matches(|c: char| !c.is_ascii_digit()).parse().expect("a number")
        };
        let extension = first.rsplit_once('.').expect("an extension").1;
        names.extend(
            (number(first)..=number(last)).map(|index| format!("snapshot-{index:08}.{extension}")),
        );
    }
    names
}

/// Checks that a verb on a bundled case with settings writes the announced files; `names` must be among them.
fn check_announced_files(verb: &str, case: &str, sets: &[&str], names: &[&str]) {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let out = scratch.path().join("out");
    let case = format!("cases/{case}");
    let mut arguments = vec![verb, &case, "--out", out.to_str().expect("text")];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    if verb == "run" {
        arguments.push("--accept-ill-posed");
    }
    let dry = run_in_root(&[&arguments[..], &["--dry-run"]].concat());
    let text = String::from_utf8(dry.stdout).expect("text");
    let errors = String::from_utf8_lossy(&dry.stderr).into_owned();
    assert!(dry.status.success() && !out.exists(), "{verb} {case}: {errors}");
    let real = run_in_root(&arguments);
    let errors = String::from_utf8_lossy(&real.stderr).into_owned();
    // Coarse grids of a refinement may disagree, which is a valid result.
    let has_results = real.status.success() || (verb == "check" && errors.ends_with("disagree\n"));
    assert!(has_results, "{verb} {case}: {errors}");
    let written: BTreeSet<String> = list_entries(&out).into_iter().collect();
    assert_eq!(parse_announced_files(&text, &out), written, "{verb} {case}\n{text}");
    for name in names {
        assert!(out.join(name).exists(), "{verb} {case}: {name}");
    }
}

#[test]
fn dry_run_lists_files_of_state_studies() {
    let bound = "granular-flow/noncoaxiality-bound.toml";
    check_announced_files("map", bound, &["map.x.points=5", "map.y.points=3"], &["map.png"]);
    check_announced_files(
        "map",
        "cosserat/flutter.toml",
        &["map.x.points=3", "map.y.points=3"],
        &[],
    );
    check_announced_files("point", bound, &[], &["growth.png"]);
    // A state that is not fully deforming: no curves are plotted.
    check_announced_files("point", bound, &["background.deviatoric_stress=1"], &["point.json"]);
    check_announced_files("point", "cosserat/forbidden-band.toml", &[], &["point.json"]);
    check_announced_files("dispersion", "cosserat/forbidden-band.toml", &[], &["dispersion.csv"]);
    check_announced_files("diagram", "rheology/porous-elastic.toml", &[], &["diagram.csv"]);
    check_announced_files("speeds", "cosserat/flutter.toml", &[], &["speeds.csv"]);
    check_announced_files("speeds", "cosserat/shear-band.toml", &[], &["sphere.csv"]);
    check_announced_files("shocks", "porous/foam-collapse.toml", &[], &["shocks.csv"]);
    check_announced_files("shocks", "porous/sand-spall.toml", &[], &["spall.csv"]);
}

#[test]
#[ignore = "takes long; part of .ci/long"]
fn dry_run_lists_files_of_checks() {
    let short = ["check.numbers=[1]", "check.directions_deg=[30]", "check.cells=[12, 16]"];
    check_announced_files("check", "check/cubic-plane.toml", &short, &["check.png"]);
    // This case cannot be measured, since no solver supports it.
    check_announced_files("check", "granular-flow/dilatant-domain.toml", &[], &["check.png"]);
    let short = ["check.numbers=[1000]", "check.directions_deg=[30]"];
    check_announced_files("check", "flow/decay.toml", &short, &["check.png"]);
    let short = ["check.numbers=[1000]", "check.directions_deg=[30]", "check.cells=[16, 24]"];
    check_announced_files("check", "check/grid-dependence.toml", &short, &["refinement.png"]);
}

/// Verifies the announced files for a perturbation with so few waves that its fastest wave is the same on all grids: no
/// order of growth is defined, but a plot is written.
#[test]
fn dry_run_lists_files_of_check_with_equal_fastest_wave_on_all_grids() {
    let sets = [
        "check.numbers=[1000]",
        "check.directions_deg=[30]",
        "check.cells=[16, 24]",
        "initial[0].to=6",
    ];
    check_announced_files("check", "check/grid-dependence.toml", &sets, &["refinement.png"]);
}

#[test]
fn dry_run_lists_files_of_runs() {
    let sets = ["time.duration=0.002", "output.snapshot_interval=0.0005"];
    let names = ["seismograms.png", "snapshot-00000004.vti", "animation.gif"];
    check_announced_files("run", "dynamics/point-source.toml", &sets, &names);
    check_announced_files(
        "run",
        "dynamics/foundation.toml",
        &["time.duration=0.002"],
        &["dissipation.png"],
    );
    check_announced_files(
        "run",
        "dynamics/plane-waves.toml",
        &["time.duration=0.0001"],
        &["ledger.csv"],
    );
    let sets = ["grid.cells=[36, 36]", "initial[0].to=8", "time.duration=1e-4"];
    let sets = [&sets[..], &["output.snapshot_interval=1e-4"]].concat();
    let names = ["spectrum.png", "snapshot-00000001.vts"];
    check_announced_files("run", "flow/decay.toml", &sets, &names);
}

/// Verifies that a dry run refuses an ill-posed flow as the run does.
#[test]
fn dry_run_of_ill_posed_flow_is_refused() {
    let arguments = ["run", "cases/flow/outside-the-bound.toml", "--dry-run"];
    let refused = run_in_root(&arguments);
    assert_eq!(refused.status.code(), Some(2));
    assert!(refused.stdout.is_empty());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--accept-ill-posed"));
    let accepted = run_in_root(&[&arguments[..], &["--accept-ill-posed"]].concat());
    assert_eq!(accepted.status.code(), Some(0));
}

/// Verifies that a dry run with `--format json` prints its plan as JSON on standard output, where a run would print its
/// results.
#[test]
fn dry_run_prints_json_for_programs() {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let out = scratch.path().join("out");
    let out = out.to_str().expect("text");
    for (verb, case) in [
        ("point", "granular-flow/noncoaxiality-bound.toml"),
        ("map", "granular-flow/noncoaxiality-bound.toml"),
        ("speeds", "cosserat/flutter.toml"),
        ("shocks", "porous/foam-collapse.toml"),
        ("dispersion", "cosserat/forbidden-band.toml"),
        ("diagram", "rheology/creep.toml"),
        ("check", "check/cubic-plane.toml"),
        ("run", "dynamics/point-source.toml"),
    ] {
        let case = format!("cases/{case}");
        let output = run_in_root(&[verb, &case, "--out", out, "--dry-run", "--format", "json"]);
        assert_eq!(output.status.code(), Some(0), "{verb}");
        let plan: serde_json::Value = serde_json::from_slice(&output.stdout).expect(verb);
        assert!(plan["would"].is_string(), "{verb}: {plan}");
        let paths = plan["would_write"].as_array().expect(verb);
        assert!(
            paths.len() > 3 && paths.iter().all(|path| path.as_str().expect(verb).starts_with(out))
        );
    }
}
