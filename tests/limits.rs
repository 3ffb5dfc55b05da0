//! Tests of limits on the time, files, bytes and memory of runs, and of Ctrl-C during long steps.
#![cfg(unix)]

use crate::program::*;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::time::{Duration, Instant};
use testkit::random::RandomNumbers;

const TEST_FOLDER: &str = "limits";

/// Creates a folder with the template of a time-domain flow case.
fn create_flow_folder(name: &str) -> PathBuf {
    let here = create_case_folder(TEST_FOLDER, name, "");
    run_with_exit_code(0, &here, "new harris-grekova --run --force case.toml");
    here
}

/// Checks that a run is refused within seconds, naming `key`, unless forced.
fn assert_refused_unless_forced(
    name: &str,
    here: &std::path::Path,
    settings: &str,
    key: &str,
    message: &str,
) {
    let arguments = format!("run case.toml --out out --threads 1 --accept-ill-posed {settings}");
    for more in ["", " --dry-run"] {
        let start = Instant::now();
        let (stdout, stderr) = run_with_exit_code(2, here, &format!("{arguments}{more}"));
        assert!(stdout.is_empty() && start.elapsed() < Duration::from_secs(10), "{name}");
        for expected in [key, message, "found", "--force runs it all the same"] {
            assert!(stderr.contains(expected), "{name}: no {expected} in {stderr}");
        }
        assert!(!here.join("out").exists(), "{name}");
    }
    let (stdout, _) = run_with_exit_code(0, here, &format!("{arguments} --dry-run --force"));
    assert!(stdout.contains("would compute"), "{name}: {stdout}");
}

#[test]
fn excessive_solid_runs_are_refused() {
    for (name, settings, key, message) in [
        (
            "duration",
            "--set time.duration=1e8 --set output.snapshot_interval=0",
            "time.duration",
            "steps",
        ),
        ("files", "--set output.snapshot_interval=1e-12", "output.snapshot_interval", "snapshots"),
        ("least", "--set output.snapshot_interval=5e-324", "output.snapshot_interval", "snapshots"),
        (
            "bytes",
            "--set grid.cells=[2000,2000] --set output.snapshot_interval=1e-5",
            "output.snapshot_interval",
            "TiB",
        ),
    ] {
        let here = create_case_folder(TEST_FOLDER, name, SOLID_CASE);
        assert_refused_unless_forced(name, &here, settings, key, message);
    }
}

#[test]
fn excessive_flow_runs_are_refused() {
    for (name, settings, key, message) in [
        ("pressure", "--set background.pressure=1e100", "time.duration", "steps"),
        ("long", "--set time.duration=1e9", "time.duration", "days"),
        ("lines", "--set output.ledger_interval=1e-300", "output.ledger_interval", "tables of"),
        (
            "pictures",
            "--set output.snapshot_interval=1e-300",
            "output.snapshot_interval",
            "snapshots",
        ),
    ] {
        assert_refused_unless_forced(name, &create_flow_folder(name), settings, key, message);
    }
}

/// Verifies that a run announces its duration, files and bytes before it starts.
#[test]
fn run_announces_duration_files_and_bytes() {
    let here = create_case_folder(TEST_FOLDER, "said", SOLID_CASE);
    let (_, stderr) = run_with_exit_code(0, &here, RUN_ARGUMENTS);
    let first = stderr.lines().next().unwrap();
    let written: u64 = list_entries(&here.join("out"))
        .iter()
        .filter(|name| name.ends_with(".vti"))
        .map(|name| here.join("out").join(name).metadata().unwrap().len())
        .sum();
    let (_, snapshots) = first.split_once("KiB, 16 snapshots in ").expect(first);
    let announced: f64 = snapshots.trim_end_matches(" MiB").parse().expect(first);
    let written = written as f64 / (1 << 20) as f64;
    assert!((announced - written).abs() < 0.1 * written, "{first}: {written} MiB");
    assert!(first.contains(" s of one thread"), "{first}");
}

/// Verifies that Ctrl-C ends a run during a very long step.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn interrupted_step_ends_within_ten_seconds() {
    let here = create_case_folder(TEST_FOLDER, "long-step", SOLID_CASE);
    let settings =
        "--set grid.cells=[3000,3000] --set output.snapshot_interval=0 --set time.duration=1000";
    let mut child =
        create_command(&here, &format!("run case.toml --out out --threads 1 {settings} --force"))
            .spawn()
            .unwrap();
    wait_for_file(&here.join("out/ledger.csv"));
    send_signal(&child, "INT");
    let start = Instant::now();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

/// Verifies that Ctrl-C ends a check within a step on a fine grid.
#[test]
fn interrupted_check_ends_within_ten_seconds() {
    let here = create_case_folder(TEST_FOLDER, "long-check", "");
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/check/grid-dependence.toml");
    let arguments = format!("check {case} --out out --threads 1 --set check.cells=[510,512]");
    let mut child = create_command(&here, &arguments).spawn().unwrap();
    // The measurement on the grid takes minutes.
    std::thread::sleep(Duration::from_secs(2));
    assert!(child.try_wait().unwrap().is_none());
    send_signal(&child, "INT");
    let start = Instant::now();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    assert!(!here.join("out").exists());
}

/// Returns the announced memory and the peak resident memory of a run, bytes.
fn measure_memory(name: &str, case: &str, settings: &str) -> (f64, f64) {
    let here = create_case_folder(TEST_FOLDER, name, case);
    let arguments = format!("run case.toml --out out --threads 1 --checkpoint-every 0 {settings}");
    (announced_memory(&here, &arguments), measure_peak_memory(&here, &arguments))
}

/// Memory that the dry run of a run announces, bytes.
fn announced_memory(here: &std::path::Path, arguments: &str) -> f64 {
    let output = run_program(here, &format!("{arguments} --dry-run"));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let value_and_unit: Vec<&str> =
        text.split_once("memory ").expect(&text).1.split([' ', ';']).take(2).collect();
    let unit = ["KiB", "MiB", "GiB"].iter().position(|unit| *unit == value_and_unit[1]).unwrap();
    value_and_unit[0].parse::<f64>().unwrap() * 1024f64.powi(1 + unit as i32)
}

/// Runs a process and returns its peak resident memory, bytes.
fn measure_peak_memory(here: &std::path::Path, arguments: &str) -> f64 {
    let mut child = create_command(here, arguments).spawn().unwrap();
    let mut status = 0;
    // SAFETY: `rusage` may be all zeros, and `wait4` writes to both arguments.
    let usage = unsafe {
        let mut usage = std::mem::zeroed::<libc::rusage>();
        libc::wait4(child.id() as i32, &mut status, 0, &mut usage);
        usage
    };
    // `wait4` has already reaped the process.
    let _ = child.wait();
    assert_eq!(status, 0, "{arguments}");
    1024.0 * usage.ru_maxrss as f64
}

/// Verifies that a check prints a progress line within 20 s while it prepares a fine grid, which takes longer, without
/// a terminal.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn check_without_progress_prints_lines() {
    let here = create_case_folder(TEST_FOLDER, "progress-lines", "");
    let case = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/check/grid-dependence.toml");
    let arguments = format!("check {case} --out out --threads 1 --set check.cells=[1534,1536]");
    let start = Instant::now();
    let mut child = start_program(&here, &arguments);
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let first = lines.next().expect("a line").unwrap();
    let elapsed = start.elapsed();
    send_signal(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(first.starts_with("check: ") && first.contains(" %, "), "{first}");
    assert!(elapsed < Duration::from_secs(20), "{elapsed:?}");
}

/// Verifies that the memory of a map, its output included, is within 25 % of the announced one, for few and for many points.
#[test]
#[ignore = "peaks depend on the pages of the system: cargo test --release --test suite limits:: -- --ignored"]
fn memory_of_maps_is_announced() {
    let here = create_case_folder(TEST_FOLDER, "map-memory", "");
    for points in [100, 1000] {
        let arguments = format!(
            "map noncoaxiality-bound --set map.x.points={points} --set map.y.points={points} --threads 2 \
             --pictures png,svg --out out --force"
        );
        let plan = run_program(&here, &format!("{arguments} --dry-run --format json"));
        let plan: serde_json::Value = serde_json::from_slice(&plan.stdout).unwrap();
        let announced = plan["memory_bytes"].as_f64().unwrap();
        let peak = measure_peak_memory(&here, &arguments);
        println!("{points}: {peak:e}, announced {announced:e}");
        assert!((announced - peak).abs() < 0.25 * peak, "{peak}, announced {announced}");
    }
    let plan = run_program(&here, "map noncoaxiality-bound --dry-run");
    assert!(String::from_utf8_lossy(&plan.stdout).contains("MiB of memory\n"));
}

/// Checks that the announced memory of a run is within 15 % of its peak memory; within 30 % for grids that are 2 to 4 cells
/// thin, whose pictures take less.
fn assert_memory_is_announced(name: &str, case: &str, settings: &str, is_thin: bool) {
    let (announced, peak) = measure_memory(name, case, settings);
    println!("{settings}: {:.0} MiB, said {:.0}", peak / 1048576.0, announced / 1048576.0);
    let tolerance = if is_thin { 0.3 } else { 0.15 };
    let is_near = (announced - peak).abs() < tolerance * peak;
    assert!(is_near, "{settings}: {peak:e}, said {announced:e}");
}

/// Verifies the announced memory against the peak memory for media and grids of many shapes: large, small, wide, thin,
/// plates and columns.
#[test]
#[ignore = "peaks depend on the pages of the system: cargo test --release --test suite limits:: -- --ignored"]
fn peak_memory_agrees_with_announced_memory() {
    const SOLID_MODEL: &str = "
[model]
kind = 'classical'
lambda = 1.2e8
mu = 8e7
density = 1900
[grid]
spacing = 1
";
    let cosserat_model = SOLID_MODEL.replace(
        "'classical'",
        "'cosserat'\nalpha = 3e7\nbeta = 2e7\ngamma = 2e7\neta = 2e7\ninertia = 300",
    );
    let cosserat_model = cosserat_model.as_str();
    let snapshots = "--set output.snapshot_interval=5e-4";
    let f32_snapshots = "--set output.snapshot_interval=5e-4 --set scheme.precision=\"f32\"";
    let full_ledger = "--set scheme.ledger=\"full\"";
    for (index, (case, cells, settings)) in [
        (SOLID_MODEL, "1000,1000", ""),
        (SOLID_MODEL, "300000,1", ""),
        (SOLID_MODEL, "300000,1", snapshots),
        (SOLID_MODEL, "30000,40", ""),
        (SOLID_MODEL, "10,100000", ""),
        (SOLID_MODEL, "1000,700", snapshots),
        (SOLID_MODEL, "90,90,90", ""),
        (SOLID_MODEL, "600,600,1", ""),
        (SOLID_MODEL, "1,600,600", ""),
        (SOLID_MODEL, "4,300,300", ""),
        (SOLID_MODEL, "2,2,100000", ""),
        (SOLID_MODEL, "1000,700", f32_snapshots),
        (SOLID_MODEL, "500,400", full_ledger),
        (cosserat_model, "700,700", ""),
        (cosserat_model, "40000,2", ""),
        (cosserat_model, "700,500", snapshots),
        (cosserat_model, "60,60,60", snapshots),
        (cosserat_model, "400,400", full_ledger),
        (cosserat_model, "2,40000", ""),
        (cosserat_model, "2,80000", full_ledger),
        (SOLID_MODEL, "200,200", ""),
        (SOLID_MODEL, "1000,1000", full_ledger),
        (SOLID_MODEL, "200000,2", full_ledger),
    ]
    .into_iter()
    .enumerate()
    {
        let settings = format!("--set grid.cells=[{cells}] --set time.duration=1e-3 {settings}");
        let case = case.replace("spacing", "cells = [1, 1]\nspacing");
        let case = case.clone() + "[time]\nduration = 1\n";
        let thickness = cells.split(',').map(|own| own.parse().unwrap()).min();
        let is_thin = thickness.is_some_and(|own: usize| (2..=4).contains(&own));
        assert_memory_is_announced(&format!("memory-{index}"), &case, &settings, is_thin);
    }
}

/// Verifies the announced memory of blocky media against the peak memory, for few and many joints, with and without
/// snapshots.
#[test]
#[ignore = "peaks depend on the pages of the system: cargo test --release --test suite limits:: -- --ignored"]
fn peak_memory_of_blocky_media_agrees_with_announced_memory() {
    let case = include_str!("../cases/blocky/pulse-breaking.toml");
    for (index, settings) in [
        "",
        "--set output.snapshot_interval=0",
        "--set block[0].repeat=[200,100] --set block[0].cells=[10,10] --set block[0].origin=[-5,-5]",
        "--set block[0].repeat=[300,150] --set block[0].cells=[3,3] --set block[0].origin=[-7.5,-7.5] --set output.snapshot_interval=0",
    ]
    .into_iter()
    .enumerate()
    {
        let settings = format!("{settings} --set time.duration=1e-4");
        assert_memory_is_announced(&format!("blocky-memory-{index}"), case, &settings, false);
    }
}

/// Limits of the address space relative to the memory that a run announces, drawn in turn.
const LIMIT_KINDS: [LimitKind; 4] =
    [LimitKind::Insufficient, LimitKind::Near, LimitKind::Sufficient, LimitKind::Near];

#[derive(Clone, Copy, PartialEq)]
enum LimitKind {
    /// Less than announced: the run must be refused.
    Insufficient,
    /// From half to six times the announced memory: the run must be refused or finish.
    Near,
    /// Enough for the announced memory and for the address space that threads reserve: the run must finish.
    Sufficient,
}

/// Runs random grids under random limits of the address space: each run must be refused or finish, and none may abort.
/// The limits follow from the announced memory, so that a quarter of the runs must be refused and a quarter must finish,
/// whatever the seed and the machine.
fn survive_memory_limits(count: usize, seed: u64) {
    const SOLID_SECTIONS: &str = "
[model]
kind = 'classical'
lambda = 1.2e8
mu = 8e7
density = 1900
[yield]
kind = 'von-mises'
strength = 2e4
[grid]
cells = [1, 1]
spacing = 1
[time]
duration = 3e-3
[output]
snapshot_interval = 0
";
    let mut random = RandomNumbers::new(seed);
    let (mut finished, mut refused) = (0, 0);
    for index in 0..count {
        let here =
            create_case_folder(TEST_FOLDER, &format!("limited-{seed}-{index}"), SOLID_SECTIONS);
        let cells = match random.uniform_index(3) {
            0 => format!("{},{}", 100 + random.uniform_index(900), 100 + random.uniform_index(900)),
            1 => format!(
                "{},{},{}",
                20 + random.uniform_index(60),
                20 + random.uniform_index(60),
                20 + random.uniform_index(60)
            ),
            _ => {
                format!("{},{}", 20_000 + random.uniform_index(60_000), 1 + random.uniform_index(8))
            }
        };
        let mut settings = format!("--set grid.cells=[{cells}]");
        for more in
            ["scheme.precision=\"f32\"", "output.snapshot_interval=1e-3", "scheme.ledger=\"full\""]
        {
            if random.uniform_index(3) == 0 {
                settings += &format!(" --set {more}");
            }
        }
        let kind = LIMIT_KINDS[index % LIMIT_KINDS.len()];
        let announced =
            announced_memory(&here, &format!("run case.toml --out out --threads 1 {settings}"));
        let part = random.unit_interval();
        let limit = match kind {
            LimitKind::Insufficient => (0.3 + 0.7 * part) * announced,
            LimitKind::Near => 0.5 * 12f64.powf(part) * announced,
            // Each of the threads reserves 64 MiB of address space for its allocations.
            LimitKind::Sufficient => (1.5 + part) * announced + 512.0 * 1_048_576.0,
        };
        // The system cannot load the program in less than 40 MB.
        let kibibytes = (limit / 1024.0).max(40_000.0) as u64;
        let output = std::process::Command::new("sh")
            .current_dir(&here)
            .args(["-c", "ulimit -v $0 && exec $1 run case.toml --out out --threads 1 $2"])
            .args([&kibibytes.to_string(), PROGRAM_PATH, &settings])
            .output()
            .unwrap();
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        let report = format!("{kibibytes} KiB, {settings}: {:?}\n{errors}", output.status);
        match output.status.code() {
            Some(0) if kind != LimitKind::Insufficient => finished += 1,
            Some(2) if kind != LimitKind::Sufficient => {
                assert!(errors.contains("memory") || errors.contains("thread"), "{report}");
                refused += 1;
            }
            _ => panic!("{report}"),
        }
        let _ = std::fs::remove_dir_all(&here);
    }
    println!("{finished} finished, {refused} refused");
    assert!(finished > count / 5 && refused > count / 5, "{finished} finished, {refused} refused");
}

#[test]
#[ignore = "takes long; part of .ci/long"]
fn runs_under_eight_memory_limits_are_refused_or_finish() {
    survive_memory_limits(8, 1);
}

#[test]
#[ignore = "takes minutes"]
fn runs_under_fifty_memory_limits_are_refused_or_finish() {
    survive_memory_limits(50, 2);
}
