//! Verifies runs that are killed at random times while other verbs, also killed, write to the same folder: the
//! results are bit-identical, and every process succeeds or is refused with a message.
#![cfg(unix)]

use crate::program::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Child;
use std::time::{Duration, Instant};
use testkit::random::RandomNumbers;

const TEST_FOLDER: &str = "kills";

/// Case with the verbs that are executed concurrently with its run.
struct KilledCase {
    text: &'static str,
    verbs: &'static [&'static str],
}

const KILLED_SOLID: KilledCase = KilledCase { text: SOLID_CASE, verbs: &CONCURRENT_VERBS };

/// Blocks with several laws of joints are not periodic: they have no Bloch waves.
const KILLED_JOINTS: KilledCase = KilledCase {
    text: JOINT_CASE,
    verbs: &[CONCURRENT_VERBS[0], CONCURRENT_VERBS[2], CONCURRENT_VERBS[3]],
};

const CONCURRENT_VERBS: [&str; 4] = [
    "speeds case.toml --out out --threads 1",
    "dispersion case.toml --out out --threads 1",
    "point case.toml --out out --threads 1",
    "verify out",
];

/// Admissible messages of refused verbs: the run has not created its folder, has no results yet, or is finished.
const REFUSAL_MESSAGES: [&str; 3] = ["no such folder", "holds no results", "the run is finished"];

/// Checks exit code and messages of a process.
fn check_exit_code_and_messages(arguments: &str, child: Child, was_killed: bool) {
    let output = child.wait_with_output().unwrap();
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    let is_clean = match output.status.code() {
        None => was_killed,
        Some(0) => true,
        // Files of a killed verb have no entry in the list of checksums.
        Some(1) => arguments.starts_with("verify") && stdout.contains("has no checksum"),
        Some(2) => {
            let last = stderr.lines().last().unwrap_or_default();
            last.starts_with("error: ")
                && REFUSAL_MESSAGES.iter().any(|message| last.contains(message))
        }
        Some(_) => false,
    };
    assert!(is_clean, "{arguments}: {:?}\n{stdout}\n{stderr}", output.status);
    assert!(!stderr.contains("panicked"), "{arguments}: {stderr}");
}

/// Arguments that resume the run in a folder, or start it if it cannot be resumed.
fn run_arguments(here: &Path) -> String {
    let out = here.join("out");
    match out.join("program.json").exists() && out.join("case.toml").exists() {
        true => "resume out --threads 1 --checkpoint-every 0".to_owned(),
        false => format!("{RUN_ARGUMENTS} --force"),
    }
}

/// Executes one run with at most `kills` kills, and `verbs` at the same time, until it is finished; returns the number of
/// kills.
fn run_with_kills(
    here: &Path,
    verbs: &[&str],
    kills: usize,
    duration: Duration,
    random: &mut RandomNumbers,
) -> usize {
    let mut killed = 0;
    for _ in 0..200 {
        if here.join("out/run.json").exists() {
            break;
        }
        let arguments = run_arguments(here);
        let mut run = start_program(here, &arguments);
        let may_kill = killed < kills;
        let end = Instant::now() + duration.mul_f64(1.1 * random.unit_interval());
        while run.try_wait().unwrap().is_none() && !(may_kill && Instant::now() > end) {
            let verb = verbs[random.uniform_index(verbs.len())];
            let mut other = start_program(here, verb);
            // Half of the concurrent verbs are killed as well.
            let is_killed = may_kill && random.uniform_index(2) == 0;
            if is_killed {
                std::thread::sleep(Duration::from_micros(random.next_bits() % 60_000));
                let _ = other.kill();
            }
            check_exit_code_and_messages(verb, other, is_killed);
        }
        let is_running = run.try_wait().unwrap().is_none();
        if may_kill && is_running {
            run.kill().unwrap();
            killed += 1;
        }
        check_exit_code_and_messages(&arguments, run, may_kill && is_running);
    }
    killed
}

/// Executes the run of a case and the concurrent verbs without kills; returns the result files and the duration of the
/// run.
fn run_without_kills(case: &KilledCase, seed: u64) -> (BTreeMap<String, Vec<u8>>, Duration) {
    let here = create_case_folder(TEST_FOLDER, &format!("whole{seed}"), case.text);
    let start = Instant::now();
    run_with_exit_code(0, &here, RUN_ARGUMENTS);
    let duration = start.elapsed();
    case.verbs.iter().for_each(|verb| drop(run_with_exit_code(0, &here, verb)));
    (read_result_files(&here.join("out")), duration)
}

/// Checks that runs of a case with `count` kills in all have the same result files as a run without kills.
fn check_runs_with_kills(case: &KilledCase, count: usize, seed: u64) {
    let (expected, duration) = run_without_kills(case, seed);
    let mut random = RandomNumbers::new(seed);
    let (mut killed, mut runs) = (0, 0);
    while killed < count {
        let here = create_case_folder(TEST_FOLDER, &format!("killed{seed}-{runs}"), case.text);
        let kills = 1 + random.uniform_index(4);
        killed += run_with_kills(&here, case.verbs, kills, duration, &mut random);
        runs += 1;
        assert!(here.join("out/run.json").exists(), "run {runs} is not finished");
        // Repeating the verbs restores the files missing after kills; there are no other files.
        case.verbs.iter().for_each(|verb| drop(run_with_exit_code(0, &here, verb)));
        let found = read_result_files(&here.join("out"));
        assert!(found.keys().eq(expected.keys()), "run {runs}: {:?}", found.keys());
        for (name, bytes) in &expected {
            assert!(found[name] == *bytes, "run {runs}: {name} differs");
        }
        fs::remove_dir_all(&here).unwrap();
    }
    println!("{killed} kills in {runs} runs");
}

#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn results_are_bit_identical_after_four_kills() {
    check_runs_with_kills(&KILLED_SOLID, 4, 1);
}

#[test]
#[ignore = "takes long"]
fn results_are_bit_identical_after_a_hundred_kills() {
    check_runs_with_kills(&KILLED_SOLID, 100, 2);
}

/// Verifies that the memory of joints (slip, fracture, pores, fluid) survives kills.
#[test]
#[ignore = "takes long"]
fn results_of_joints_are_bit_identical_after_twenty_kills() {
    check_runs_with_kills(&KILLED_JOINTS, 20, 3);
}
