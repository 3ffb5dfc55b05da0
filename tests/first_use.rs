//! First use of the program: help, lists of models and cases, dry runs; files and folders left by commands that fail.

use crate::{program, wrong_inputs};

use program::*;
use std::fs;
use wrong_inputs::read_error;

const TEST_FOLDER: &str = "first-use";

/// Returns the example command lines of a help text.
fn read_examples(help: &str) -> Vec<&str> {
    let examples = help.split("Examples:\n").nth(1).unwrap_or_else(|| panic!("{help}"));
    let lines = examples.lines().take_while(|line| !line.is_empty());
    // Two spaces separate the command line from its meaning.
    lines.map(|line| line.trim_start().split("  ").next().unwrap_or_default()).collect()
}

/// Verifies that help of the program and of each command states examples and exit codes, and that the examples are
/// accepted and name bundled cases.
#[test]
fn help_has_examples_and_exit_codes() {
    let here = create_folder(TEST_FOLDER, "help");
    let (help, _) = run_with_exit_code(0, &here, "--help");
    for part in ["wellposed map noncoaxiality-bound", "Exit codes:\n  0 ", "\n  130  interrupted"] {
        assert!(help.contains(part), "{help}");
    }
    let commands = help.split("Commands:\n").nth(1).unwrap();
    let names: Vec<&str> = commands
        .lines()
        .map_while(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty() && *name != "help")
        .collect();
    assert_eq!(names.len(), 21, "{help}");
    let is_case = |word: &str| wellposed::case::find_bundled_case(word).is_some();
    for name in names {
        let (help, _) = run_with_exit_code(0, &here, &format!("{name} --help"));
        assert!(help.contains("\n\nExit codes:\n  0    done\n"), "{help}");
        for example in read_examples(&help) {
            let arguments =
                example.strip_prefix("wellposed ").unwrap_or_else(|| panic!("{example}"));
            run_with_exit_code(0, &here, &format!("{arguments} --help"));
            let words: Vec<&str> = arguments.split(' ').collect();
            // An example of `check` may name a folder.
            if words[0] != "check" && VERBS_WITH_CASE.contains(&words[0]) {
                assert!(is_case(words[1]), "{example}");
            }
        }
    }
}

/// Verifies that a bundled case is found beside a folder of its name, such as that of its results.
#[test]
fn folders_do_not_hide_bundled_cases() {
    let here = create_folder(TEST_FOLDER, "hidden");
    run_with_exit_code(0, &here, "diagram creep --out creep --pictures none");
    run_with_exit_code(0, &here, "diagram creep --out creep --pictures none");
}

/// Verifies that models, yield sets, media with contacts and joints are listed with equations and references.
#[test]
fn models_are_listed_with_equations_and_references() {
    let here = create_folder(TEST_FOLDER, "models");
    let (models, _) = run_with_exit_code(0, &here, "models");
    for part in [
        "harris-grekova",
        "Harris & Grekova (2005)",
        "drucker-prager",
        "W = ½λ(tr Λ)²",
        "Nowacki (1986)",
        "porous-plastic",
    ] {
        assert!(models.contains(part), "{models}");
    }
}

/// Verifies that a dry run in a folder with results of another case is carried out, with a warning, where the command
/// itself is refused; and that the results stay as they were.
#[test]
fn dry_runs_are_not_refused_because_of_other_results() {
    let here = create_folder(TEST_FOLDER, "dry-run");
    run_with_exit_code(0, &here, "diagram creep --out p");
    let before = read_files(&here.join("p"));
    for arguments in [
        "point noncoaxiality-bound",
        "map noncoaxiality-bound --set map.x.points=3 --set map.y.points=3",
        "speeds flutter",
        "run decay",
        "shocks foam-open",
        "check heat",
    ] {
        let refusal = read_error(&here, &format!("{arguments} --out p"));
        let (stdout, stderr) =
            run_with_exit_code(0, &here, &format!("{arguments} --out p --dry-run"));
        assert!(stdout.starts_with("would "), "{stdout}");
        assert!(stderr.ends_with(&format!("warning: {refusal}\n")), "{stderr}");
    }
    // A finished run is not computed again, either.
    run_with_exit_code(0, &here, "run decay --set time.duration=1e-4 --out q");
    let arguments = "run decay --set time.duration=1e-4 --out q";
    let refusal = read_error(&here, arguments);
    let (_, stderr) = run_with_exit_code(0, &here, &format!("{arguments} --dry-run"));
    assert!(stderr.contains(&format!("warning: {refusal}")), "{stderr}");
    assert_eq!(read_files(&here.join("p")), before);
}

/// Verifies that a failing command leaves no folder behind.
#[test]
fn failing_homogenise_leaves_no_folder() {
    let here = create_folder(TEST_FOLDER, "no-folder");
    let name = "x".repeat(300);
    let arguments = format!("homogenise pulse-breaking --out new/below/{name}");
    run_with_exit_code(2, &here, &arguments);
    assert_eq!(list_entries(&here), [""; 0]);
    fs::create_dir(here.join("old")).unwrap();
    run_with_exit_code(2, &here, &format!("homogenise pulse-breaking --out old/below/{name}"));
    assert_eq!(list_entries(&here.join("old")), [""; 0]);
}

/// Verifies that the results of `run` and `check` of a solid state the verdict of the analysis.
#[test]
fn results_of_solids_state_the_verdict() {
    let here = create_folder(TEST_FOLDER, "verdict");
    let verdict = "well-posed: the equations are symmetric hyperbolic";
    for arguments in [
        "run point-source --set time.duration=1e-3",
        "check cubic-plane --set check.numbers=[1] --set check.cells=[8,12]",
    ] {
        let (text, _) = run_with_exit_code(0, &here, &format!("{arguments} --force"));
        assert!(text.contains(&format!("\nverdict of the analysis: {verdict}\n")), "{text}");
        let (json, _) = run_with_exit_code(0, &here, &format!("{arguments} --force --format json"));
        let report: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(report["verdict"], "well-posed", "{arguments}");
        assert_eq!(report["verdict_reason"], "the equations are symmetric hyperbolic");
    }
}
