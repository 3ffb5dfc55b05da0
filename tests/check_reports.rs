//! Tests of what `wellposed check` prints: rows that disagree, estimates of its time.

use crate::{program, support};

use program::*;
use serde_json::Value;
use std::fs;
use support::bundled_case;
use wellposed::case::Case;
use wellposed::study::check::{CheckExtent, CheckOutcome, CheckResult};
use wellposed::study::ignore_progress;

const TEST_FOLDER: &str = "check-reports";
const SHORT_SETTINGS: [&str; 3] =
    ["check.numbers=[1]", "check.directions_deg=[0]", "check.cells=[12, 16]"];

fn run_short_check(name: &str) -> (Case, CheckResult) {
    let case = wellposed::load(bundled_case(name), SHORT_SETTINGS).expect("a case");
    let found = wellposed::check_agreement(&case, CheckExtent::Short, &ignore_progress);
    (case, found.expect("a result"))
}

/// Verifies that only rows that disagree are printed, each once and with its wave vector, those of largest error first.
#[test]
fn disagreeing_rows_are_sorted_by_error() {
    let (case, mut found) = run_short_check("cosserat/forbidden-band.toml");
    let text = found.render_disagreements(&case);
    assert_eq!(text.lines().count(), 2, "{text}");
    assert!(text.ends_with(": all agree\n"), "{text}");

    let CheckOutcome::Solid(solid) = &mut found.outcome else { panic!("a solid") };
    let medium = &mut solid.medium_checks[0];
    let rows = &mut medium.branch_checks;
    assert!(rows.len() >= 3);
    for (row, error) in rows.iter_mut().zip([0.001, 0.3, 0.02]) {
        row.is_in_agreement = Some(false);
        row.measured_difference.as_mut().expect("measured").frequency = error;
    }
    medium.band_gaps[0].is_in_agreement = false;
    let text = found.render_disagreements(&case);
    let lines: Vec<&str> = text.lines().collect();
    let errors: Vec<Option<&str>> = lines
        .iter()
        .filter(|line| line.ends_with("DISAGREES"))
        .map(|line| {
            line.split_whitespace().find(|word| word.starts_with('+') && word.contains("e-"))
        })
        .collect();
    // The second and third row have equal frequencies and are one row; the last one is the band gap.
    assert_eq!(errors, [Some("+3.0e-1"), Some("+1.0e-3"), None], "{text}");
    assert!(lines[1].contains("predicted") && lines[2].starts_with("k = 1 1/m at 0°"), "{text}");
    assert!(lines[lines.len() - 2].starts_with("no ") && text.contains(" DISAGREE\n"), "{text}");
}

/// Verifies that dry runs of `check` estimate its time, for cases of all kinds and for a folder.
#[test]
fn dry_runs_estimate_the_time_of_checks() {
    let here = create_folder(TEST_FOLDER, "estimate");
    let seconds = |arguments: &str| {
        let (text, _) =
            run_with_exit_code(0, &here, &format!("check {arguments} --dry-run --format json"));
        let plan: Value = serde_json::from_str(&text).expect("JSON");
        plan["seconds"].as_f64().unwrap_or_else(|| panic!("{plan}"))
    };
    fs::create_dir(here.join("cases")).expect("a folder");
    for name in ["cubic-plane", "decay", "heat", "foam-collapse", "creep"] {
        assert!(seconds(name) > 0.0, "{name}");
        let (_, text) = wellposed::case::find_bundled_case(name).expect("a case");
        fs::write(here.join(format!("cases/{name}.toml")), text).expect("a file");
    }
    assert!(seconds("cases") > 0.0);
    assert!(!here.join("out").exists());
}

/// Verifies that a folder is checked to its end, and that `--disagreeing` prints invalid cases only.
#[test]
fn disagreeing_cases_of_a_folder_are_listed() {
    let here = create_folder(TEST_FOLDER, "folder");
    let (_, heat) = wellposed::case::find_bundled_case("heat").expect("a case");
    fs::write(here.join("b.toml"), heat).expect("a file");
    let (all, _) = run_with_exit_code(0, &here, "check .");
    assert!(all.starts_with("./b.toml ") && all.contains("agrees"), "{all}");
    let (none, _) = run_with_exit_code(0, &here, "check . --disagreeing");
    assert_eq!(none, "");
}

/// A case of a folder that cannot be read is listed with its fault; the others are checked, and the exit code is 2.
#[test]
fn unreadable_cases_of_a_folder_are_listed() {
    let here = create_folder(TEST_FOLDER, "unreadable");
    fs::create_dir(here.join("all")).unwrap();
    fs::write(here.join("all/broken.toml"), "title = 'a'\n[model").unwrap();
    fs::copy(bundled_case("equations/heat.toml"), here.join("all/heat.toml")).unwrap();
    let (text, error) = run_with_exit_code(2, &here, "check all");
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].contains("CANNOT BE READ: all/broken.toml:2: "), "{text}");
    assert!(lines[1].starts_with("all/heat.toml ") && lines[1].ends_with("agrees"), "{text}");
    assert!(error.contains("1 of 2 cases cannot be read"), "{error}");
    // A fault of a setting concerns all cases.
    let (text, error) = run_with_exit_code(2, &here, "check all --set check.numbers=x");
    assert!(!text.contains("heat.toml") && error.contains("check.numbers"), "{text} {error}");
}
