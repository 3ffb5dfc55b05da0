//! Verifies that mutated case files are accepted or refused, quickly and without a panic.

use crate::mutation::{mutants, shrunk};
use crate::support::parse;
use analysis::flows::Workspace;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};
use wellposed::CASES;
use wellposed::cli::Options;
use wellposed::setup;

/// Passes `count` mutants to `run`, which returns whether it accepts a mutant; none may panic or be slow.
fn survive(count: usize, mut run: impl FnMut(&str) -> bool) {
    const LIMIT: Duration = Duration::from_secs(20);
    let (mut taken, mut slowest, mut failures) = (0, Duration::ZERO, Vec::new());
    for (index, mutant) in mutants(1).take(count).enumerate() {
        // Invalid UTF-8 is refused by the program; see tests/command_line.rs.
        let text = String::from_utf8_lossy(&mutant);
        let start = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| run(&text))) {
            Ok(was_taken) => taken += usize::from(was_taken),
            Err(_) => failures.push(format!("mutant {index} panicked:\n{text}")),
        }
        let time = start.elapsed();
        slowest = slowest.max(time);
        if time > LIMIT {
            failures.push(format!("mutant {index} took {time:?}:\n{text}"));
        }
    }
    println!("{taken} of {count} mutants were taken; the slowest took {slowest:?}");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures[0]);
    // The mutants test little if nearly all or nearly none of them are refused.
    assert!(taken > count / 20 && taken < count * 3 / 4, "{taken} of {count} were taken");
}

#[test]
fn ten_thousand_mutants_are_taken_or_refused() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mutant.toml");
    let mut workspace = Workspace::default();
    let mut index = 0;
    survive(10_000, |text| {
        index += 1;
        let Ok(case) = parse(text) else { return false };
        let again = parse(&case.to_toml()).expect("a resolved case is a case");
        assert!(again == case, "the resolved case differs from the case");
        for kind in case.compare.iter().flatten() {
            let _ = setup::flow::assess(&case.for_kind(*kind), &mut workspace);
        }
        // All corners of the map.
        for map in case.map.iter().filter(|map| map.x.points.max(map.y.points) <= 1000) {
            for corner in 0..4 {
                let mut case = case.clone();
                case.set(map.x.parameter, map.x.value((corner % 2) * (map.x.points - 1)));
                case.set(map.y.parameter, map.y.value((corner / 2) * (map.y.points - 1)));
                let _ = setup::flow::assess(&case, &mut workspace);
            }
        }
        // A complete point costs more than its verdict: every tenth mutant only.
        if index % 10 == 0 {
            std::fs::write(&file, text).unwrap();
            let options = Options { case: file.clone(), dry_run: true, ..Options::default() };
            let _ = wellposed::cli::point(&options, &mut std::io::sink());
        }
        setup::flow::assess(&case, &mut workspace).is_ok()
    });
}

#[test]
fn shrinking_keeps_all_but_the_grid() {
    for (path, text) in CASES {
        let (case, small) = (parse(text).unwrap(), parse(&shrunk(text)).unwrap());
        assert_eq!(case.material.numbers, small.material.numbers, "{path}");
        assert_eq!(case.map.is_some(), small.map.is_some(), "{path}");
        assert!(small.map.is_none_or(|map| map.x.points * map.y.points == 12), "{path}");
    }
}
