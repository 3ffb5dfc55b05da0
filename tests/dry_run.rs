//! Verifies that `--dry-run` of every verb lists exactly the files that the verb writes.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};

const PROGRAM: &str = env!("CARGO_BIN_EXE_wellposed");

fn wellposed(arguments: &[&str]) -> Output {
    let root = env!("CARGO_MANIFEST_DIR");
    Command::new(PROGRAM).current_dir(root).args(arguments).output().expect("the program")
}

/// Names of the files announced by a dry run; a range of snapshots is expanded.
fn announced(text: &str, folder: &Path) -> BTreeSet<String> {
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
            (number(first)..=number(last)).map(|own| format!("snapshot-{own:08}.{extension}")),
        );
    }
    names
}

fn written(folder: &Path) -> BTreeSet<String> {
    let entries = std::fs::read_dir(folder).expect("results");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.expect("an entry").file_name().into_string().expect("text")
    };
    entries.map(name).collect()
}

/// Compares announced and written files of a verb on a bundled case with settings; `names` must be among them.
fn compare(verb: &str, case: &str, sets: &[&str], names: &[&str]) {
    let scratch = tempfile::tempdir().expect("a scratch folder");
    let out = scratch.path().join("out");
    let case = format!("cases/{case}");
    let mut arguments = vec![verb, &case, "--out", out.to_str().expect("text")];
    sets.iter().for_each(|set| arguments.extend(["--set", set]));
    if verb == "run" {
        arguments.push("--accept-ill-posed");
    }
    let dry = wellposed(&[&arguments[..], &["--dry-run"]].concat());
    let text = String::from_utf8(dry.stdout).expect("text");
    let errors = String::from_utf8_lossy(&dry.stderr).into_owned();
    assert!(dry.status.success() && !out.exists(), "{verb} {case}: {errors}");
    let real = wellposed(&arguments);
    let errors = String::from_utf8_lossy(&real.stderr).into_owned();
    // Coarse grids of a refinement may disagree, which is a valid result.
    let has_results = real.status.success() || (verb == "check" && errors.ends_with("disagree\n"));
    assert!(has_results, "{verb} {case}: {errors}");
    assert_eq!(announced(&text, &out), written(&out), "{verb} {case}\n{text}");
    for name in names {
        assert!(out.join(name).exists(), "{verb} {case}: {name}");
    }
}

#[test]
fn of_states() {
    let bound = "granular-flow/noncoaxiality-bound.toml";
    compare("map", bound, &["map.x.points=5", "map.y.points=3"], &["map.png"]);
    compare("map", "cosserat/flutter.toml", &["map.x.points=3", "map.y.points=3"], &[]);
    compare("point", bound, &[], &["growth.png"]);
    // Not fully deforming: no curves are plotted.
    compare("point", bound, &["background.deviatoric_stress=1"], &["point.json"]);
    compare("point", "cosserat/forbidden-band.toml", &[], &["point.json"]);
    compare("dispersion", "cosserat/forbidden-band.toml", &[], &["dispersion.csv"]);
    compare("speeds", "cosserat/flutter.toml", &[], &["speeds.csv"]);
    compare("speeds", "cosserat/shear-band.toml", &[], &["sphere.csv"]);
}

#[test]
fn of_checks() {
    let short = ["check.numbers=[1]", "check.directions_deg=[30]", "check.cells=[12, 16]"];
    compare("check", "check/cubic-plane.toml", &short, &["check.png"]);
    // A case that cannot be measured.
    compare("check", "granular-flow/dilatant-domain.toml", &[], &["check.png"]);
    let short = ["check.numbers=[1000]", "check.directions_deg=[30]"];
    compare("check", "flow/decay.toml", &short, &["check.png"]);
    let short = ["check.numbers=[1000]", "check.directions_deg=[30]", "check.cells=[32, 48]"];
    compare("check", "check/grid-dependence.toml", &short, &["refinement.png"]);
}

/// The perturbation has so few waves that its fastest mode is the same on all grids: no order of growth is defined,
/// but a plot is written.
#[test]
fn of_a_check_whose_fastest_wave_is_that_of_all_grids() {
    let sets = [
        "check.numbers=[1000]",
        "check.directions_deg=[30]",
        "check.cells=[32, 48]",
        "initial[0].to=6",
    ];
    compare("check", "check/grid-dependence.toml", &sets, &["refinement.png"]);
}

#[test]
fn of_runs() {
    let sets = ["time.duration=0.002", "output.snapshot_interval=0.0005"];
    let names = ["seismograms.png", "snapshot-00000004.vti", "animation.gif"];
    compare("run", "dynamics/point-source.toml", &sets, &names);
    compare("run", "dynamics/foundation.toml", &["time.duration=0.002"], &["dissipation.png"]);
    compare("run", "dynamics/plane-waves.toml", &["time.duration=0.0001"], &["ledger.csv"]);
    let sets = ["grid.cells=[36, 36]", "initial[0].to=8", "time.duration=1e-4"];
    compare("run", "flow/decay.toml", &sets, &["spectrum.png"]);
    let sets = [&sets[..], &["output.snapshot_interval=1e-4"]].concat();
    compare("run", "flow/decay.toml", &sets, &["snapshot-00000001.vts"]);
}

/// Verifies that a dry run refuses an ill-posed flow as the run does.
#[test]
fn of_an_ill_posed_flow_is_refused_as_the_run_is() {
    let arguments = ["run", "cases/flow/outside-the-bound.toml", "--dry-run"];
    let refused = wellposed(&arguments);
    assert_eq!(refused.status.code(), Some(2));
    assert!(refused.stdout.is_empty());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--accept-ill-posed"));
    let accepted = wellposed(&[&arguments[..], &["--accept-ill-posed"]].concat());
    assert_eq!(accepted.status.code(), Some(0));
}
