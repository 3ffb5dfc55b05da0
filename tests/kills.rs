//! Verifies runs that are killed at random times while other verbs, also killed, write to the same folder: the
//! results are bit-identical, and every process succeeds or is refused with a message.
#![cfg(unix)]

mod program;

use program::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};

const TEST: &str = "kills";

/// Verbs executed concurrently with the run.
const BESIDE: [&str; 4] = [
    "speeds case.toml --out out --threads 1",
    "dispersion case.toml --out out --threads 1",
    "point case.toml --out out --threads 1",
    "verify out",
];

/// Admissible messages of refused verbs: no results are written yet, or the run is finished.
const REFUSALS: [&str; 2] = ["holds no results", "the run is finished"];

/// Checks the exit code of a process.
fn check_end(arguments: &str, child: Child, was_killed: bool) {
    let output = child.wait_with_output().unwrap();
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|own| String::from_utf8_lossy(&own).into_owned());
    let is_clean = match output.status.code() {
        None => was_killed,
        Some(0) => true,
        // Files of a killed verb have no entry in the list of checksums.
        Some(1) => arguments.starts_with("verify") && stdout.contains("has no checksum"),
        Some(2) => {
            let last = stderr.lines().last().unwrap_or_default();
            last.starts_with("error: ") && REFUSALS.iter().any(|words| last.contains(words))
        }
        Some(_) => false,
    };
    assert!(is_clean, "{arguments}: {:?}\n{stdout}\n{stderr}", output.status);
    assert!(!stderr.contains("panicked"), "{arguments}: {stderr}");
}

/// Arguments that resume the run, or start it if it cannot be resumed.
fn arguments_of_run(here: &Path) -> String {
    let out = here.join("out");
    match out.join("program.json").exists() && out.join("case.toml").exists() {
        true => "resume out --threads 1 --checkpoint-every 0".to_owned(),
        false => format!("{RUN} --force"),
    }
}

/// Executes one run with at most `kills` kills until it is finished; returns the number of kills.
fn run_with_kills(here: &Path, kills: usize, duration: Duration, chance: &mut Chance) -> usize {
    let mut killed = 0;
    for _ in 0..200 {
        if here.join("out/run.json").exists() {
            break;
        }
        let arguments = arguments_of_run(here);
        let mut run = starts(here, &arguments);
        let is_to_die = killed < kills;
        let end = Instant::now() + duration.mul_f64(1.1 * chance.part());
        while run.try_wait().unwrap().is_none() && !(is_to_die && Instant::now() > end) {
            let beside = BESIDE[chance.below(BESIDE.len())];
            let mut other = starts(here, beside);
            // Half of the concurrent verbs are killed as well.
            let is_killed = is_to_die && chance.below(2) == 0;
            if is_killed {
                std::thread::sleep(Duration::from_micros(chance.next() % 60_000));
                let _ = other.kill();
            }
            check_end(beside, other, is_killed);
        }
        let is_running = run.try_wait().unwrap().is_none();
        if is_to_die && is_running {
            run.kill().unwrap();
            killed += 1;
        }
        check_end(&arguments, run, is_to_die && is_running);
    }
    killed
}

fn whole() -> (BTreeMap<String, Vec<u8>>, Duration) {
    let here = folder(TEST, "whole", SOLID);
    let start = Instant::now();
    ends_with(0, &here, RUN);
    let duration = start.elapsed();
    BESIDE.iter().for_each(|verb| drop(ends_with(0, &here, verb)));
    (results(&here.join("out")), duration)
}

fn many_kills(all: usize, seed: u64) {
    let (expected, duration) = whole();
    let mut chance = Chance::new(seed);
    let (mut killed, mut runs) = (0, 0);
    while killed < all {
        let here = folder(TEST, &format!("killed{seed}-{runs}"), SOLID);
        killed += run_with_kills(&here, 1 + chance.below(4), duration, &mut chance);
        runs += 1;
        assert!(here.join("out/run.json").exists(), "run {runs} does not come to its end");
        // Repeating the verbs restores the files missing after kills; there are no other files.
        BESIDE.iter().for_each(|verb| drop(ends_with(0, &here, verb)));
        let found = results(&here.join("out"));
        let names = |own: &BTreeMap<String, Vec<u8>>| own.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&found), names(&expected), "run {runs}");
        for (name, bytes) in &expected {
            assert!(found[name] == *bytes, "run {runs}: {name} differs");
        }
        fs::remove_dir_all(&here).unwrap();
    }
    println!("{killed} kills in {runs} runs");
}

#[test]
fn a_few_kills_change_no_bit() {
    many_kills(8, 1);
}

#[test]
#[ignore = "takes long"]
fn a_hundred_kills_change_no_bit() {
    many_kills(100, 2);
}
