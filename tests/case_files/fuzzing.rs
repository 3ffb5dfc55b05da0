//! Verifies that mutated case files are accepted or refused, quickly and without a panic.

use crate::mutation::{generate_mutants, shrink_map_grid};
use crate::support::parse_case;
use analysis::flows::FlowWorkspace;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use wellposed::CASES;
use wellposed::cli::Options;
use wellposed::setup;

/// Passes `count` mutants to `run`, which returns whether it accepts a mutant; none may panic or be slow.
fn check_mutants(count: usize, mut run: impl FnMut(&str) -> bool) {
    // The greatest growth rate of ten equations in space takes ten seconds, more beside other tests.
    const TIME_LIMIT: Duration = Duration::from_secs(60);
    let (mut accepted, mut slowest, mut failures) = (0, Duration::ZERO, Vec::new());
    for (index, mutant) in generate_mutants(1).take(count).enumerate() {
        // Invalid UTF-8 is refused by the program; see tests/command_line.rs.
        let text = String::from_utf8_lossy(&mutant);
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| run(&text))) {
            Ok(was_accepted) => accepted += usize::from(was_accepted),
            Err(_) => failures.push(format!("mutant {index} panicked:\n{text}")),
        }
        let time = start.elapsed();
        slowest = slowest.max(time);
        if time > TIME_LIMIT {
            failures.push(format!("mutant {index} took {time:?}:\n{text}"));
        }
    }
    println!("{accepted} of {count} mutants were taken; the slowest took {slowest:?}");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures[0]);
    // The mutants test little if nearly all or nearly none of them are refused. Lines of other cases that a mutant takes
    // are the more foreign to it the more kinds of cases there are.
    assert!(accepted > count / 40 && accepted < count * 3 / 4, "{accepted} of {count} were taken");
}

#[test]
fn a_thousand_mutants_are_accepted_or_refused() {
    run_mutants(1_000);
}

#[test]
#[ignore = "takes long; a thousand always run"]
fn ten_thousand_mutants_are_accepted_or_refused() {
    run_mutants(10_000);
}

/// Reads, resolves and assesses `count` mutants.
fn run_mutants(count: usize) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mutant.toml");
    let mut workspace = FlowWorkspace::default();
    let mut index = 0;
    check_mutants(count, |text| {
        index += 1;
        let Ok(case) = parse_case(text) else { return false };
        let resolved = parse_case(&case.to_toml()).expect("a resolved case is a case");
        assert!(resolved == case, "the resolved case differs from the case");
        for kind in case.compared_kinds.iter().flatten() {
            let _ = setup::flow::assess_flow_state(&case.convert_to_kind(*kind), &mut workspace);
        }
        // All corners of the map are assessed.
        for map in case.map.iter().filter(|map| map.x.point_count.max(map.y.point_count) <= 1000) {
            for corner in 0..4 {
                let mut case = case.clone();
                case.set_number(
                    map.x.parameter,
                    map.x.sweep_value((corner % 2) * (map.x.point_count - 1)),
                );
                case.set_number(
                    map.y.parameter,
                    map.y.sweep_value((corner / 2) * (map.y.point_count - 1)),
                );
                let _ = setup::flow::assess_flow_state(&case, &mut workspace);
            }
        }
        // A complete point costs more than its verdict: every tenth mutant only.
        if index % 10 == 0 {
            std::fs::write(&file, text).unwrap();
            let options =
                Options { case_path: file.clone(), is_dry_run: true, ..Options::default() };
            let _ = wellposed::cli::run_point(&options, &mut std::io::sink());
        }
        setup::flow::assess_flow_state(&case, &mut workspace).is_ok()
    });
}

#[test]
fn shrinking_changes_only_the_map_grid() {
    for (path, text) in CASES {
        let (case, small) =
            (parse_case(text).unwrap(), parse_case(&shrink_map_grid(text)).unwrap());
        assert_eq!(case.material.numbers, small.material.numbers, "{path}");
        assert_eq!(case.map.is_some(), small.map.is_some(), "{path}");
        assert!(small.map.is_none_or(|map| map.x.point_count * map.y.point_count == 12), "{path}");
    }
}
