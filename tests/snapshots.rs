//! Verifies that snapshots have the requested times and that other results do not depend on them.

use crate::program::{create_case_folder, run_with_exit_code};
use crate::support;

use files::npz::read_arrays;
use files::vti::{list_arrays, read_plain_time, read_plain_values, read_values};
use std::fs;
use std::path::Path;
use support::{create_run_options, run_case};
use wellposed::cli::Options;

const SOLID_CASE: &str = include_str!("data/snapshots-solid.toml");

const FLOW_CASE: &str = include_str!("data/snapshots-flow.toml");

/// Runs a case on two threads.
fn run_on_two_threads(folder: &Path, case: &str) {
    let options = Options { thread_count: Some(2), ..create_run_options(folder, case) };
    run_case(&options).expect("a sound case");
}

fn create_scratch_folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a scratch folder")
}

/// Reads the content of a snapshot; `None` if there is none of this index.
fn read_snapshot(folder: &Path, index: usize, extension: &str) -> Option<Vec<u8>> {
    fs::read(folder.join(format!("out/snapshot-{index:08}.{extension}"))).ok()
}

/// Verifies that final fields and receiver records of solids and flows are bit-identical for all snapshot intervals.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn results_are_independent_of_snapshot_interval() {
    for (case, extension, intervals) in [
        (SOLID_CASE, "vti", [0.0, 2.7e-3, 9e-4, 0.0175, 1.0]),
        (FLOW_CASE, "vts", [0.0, 1.3e-4, 1.05e-4, 1e-3, 1.0]),
    ] {
        let mut first = None;
        for interval in intervals {
            let here = create_scratch_folder();
            let keys =
                format!("snapshot_interval = {interval}\nledger_interval = {}\n", 0.7 * interval);
            run_on_two_threads(here.path(), &format!("{case}{keys}"));
            let files = ["fields.npz", "receivers.npz"]
                .map(|name| fs::read(here.path().join("out").join(name)).expect(name));
            assert!(files.iter().all(|file| !read_arrays(file).expect("an archive").is_empty()));
            assert!(first.get_or_insert_with(|| files.clone()) == &files, "{interval}");
            // Snapshots are numbered from 0 and have the requested times; the last one is at the end.
            let mut times = Vec::new();
            while let Some(bytes) = read_snapshot(here.path(), times.len(), extension) {
                times.push(read_plain_time(&bytes).expect("a time"));
            }
            let duration = intervals[3];
            let expected: Vec<f64> = match interval {
                0.0 => Vec::new(),
                _ => (0..)
                    .map(|index| f64::from(index) * interval)
                    .take_while(|time| *time < duration * (1.0 - 1e-9))
                    .chain([duration])
                    .collect(),
            };
            assert_eq!(times, expected, "{interval}");
        }
    }
}

/// Verifies that a snapshot between two steps is the linear interpolation of both, and on a step the state itself.
#[test]
fn snapshots_between_steps_are_linear_interpolations() {
    let here = create_scratch_folder();
    run_on_two_threads(here.path(), SOLID_CASE);
    let json = fs::read(here.path().join("out/run.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    let step = report["step"].as_f64().expect("a number");
    let arrays = |interval: f64, index: usize| {
        let here = create_scratch_folder();
        run_on_two_threads(here.path(), &format!("{SOLID_CASE}snapshot_interval = {interval:?}\n"));
        let bytes = read_snapshot(here.path(), index, "vti").expect("a snapshot");
        ["sigma22 [Pa]", "velocity [m/s]", "u2 [m]", "dissipation [J/m3]"]
            .map(|name| read_plain_values(&bytes, name).expect(name))
    };
    let [before, after] = [arrays(step, 5), arrays(step, 6)];
    // 3 · 1.75 steps are 5.25 steps: snapshot 3 is a quarter of a step after step 5.
    let between = arrays(1.75 * step, 3);
    let on_step = arrays(2.5 * step, 2);
    for (((before, after), between), on_step) in
        before.iter().zip(&after).zip(&between).zip(&on_step)
    {
        let largest = after.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        assert!(largest > 0.0 && before != after);
        for ((before, after), between) in before.iter().zip(after).zip(between) {
            let expected = 0.75 * before + 0.25 * after;
            assert!((between - expected).abs() < 1e-9 * largest, "{between} {expected}");
        }
        assert!(before == on_step);
    }
}

/// Verifies a flow's snapshot in the middle of a step against the mean of the snapshots at its start and end, within
/// 5 % of the change.
#[test]
fn flow_snapshots_between_steps_are_second_order_accurate() {
    let values = |interval: f64, index: usize| {
        let here = create_scratch_folder();
        run_on_two_threads(here.path(), &format!("{FLOW_CASE}snapshot_interval = {interval:?}\n"));
        let bytes = read_snapshot(here.path(), index, "vts").expect("a snapshot");
        read_plain_values(&bytes, "velocity [m/s]").expect("velocities")
    };
    // Steps end at all multiples of 1/200 of the duration: 5e-6 s.
    let [before, after] = [values(5e-4, 1), values(5.05e-4, 1)];
    let between = values(5.025e-4, 1);
    let largest = after.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let change = before.iter().zip(&after).fold(0.0, |a: f64, (b, c)| a.max((b - c).abs()));
    assert!(change > 1e-6 * largest);
    for ((before, after), between) in before.iter().zip(&after).zip(&between) {
        // The error of linear interpolation is of second order in the change during a step.
        let error = between - 0.5 * (before + after);
        assert!(error.abs() < 0.05 * change, "{error} of {change}");
    }
}

/// Verifies that short numbers differ from those of the solver by at most the error that the file states, that snapshots
/// hold the fields that the case lists.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn short_numbers_have_the_stated_error() {
    let run = |keys: &str| {
        let here = create_scratch_folder();
        run_on_two_threads(here.path(), &format!("{SOLID_CASE}snapshot_interval = 9e-4\n{keys}"));
        here
    };
    let whole = run("");
    let whole = read_snapshot(whole.path(), 2, "vti").expect("a snapshot");
    for (keys, error) in [
        ("snapshot_digits = 4\n", 0.5f64.powi(15)),
        ("snapshot_precision = 'f32'\n", 0.5f64.powi(24)),
        ("snapshot_precision = 'f32'\nsnapshot_digits = 3\n", 0.5f64.powi(11) + 0.5f64.powi(24)),
    ] {
        let folder = run(&format!("{keys}snapshot_fields = ['v1', 'v2', 'sigma22']\n"));
        let short = read_snapshot(folder.path(), 2, "vti").expect("a snapshot");
        let names: Vec<String> =
            list_arrays(&short).expect("arrays").into_iter().map(|own| own.name).collect();
        assert_eq!(names[..2], ["velocity [m/s]", "sigma22 [Pa]"]);
        for name in &names[..2] {
            let [exact, short] =
                [&whole, &short].map(|bytes| read_values(bytes, name).expect("values"));
            assert!(exact.len() == short.len() && exact.iter().any(|value| *value != 0.0));
            let is_near = |(exact, short): (&f64, &f64)| {
                (short - exact).abs() <= error * exact.abs() + f64::from(f32::MIN_POSITIVE)
            };
            assert!(exact.iter().zip(&short).all(is_near), "{keys}: {name}");
        }
        let text = String::from_utf8_lossy(&short);
        let stated = text.split("RelativeRoundingError").nth(1).expect("an error");
        let stated = stated.split('>').nth(1).and_then(|text| text.split('<').next());
        assert_eq!(stated.expect("a number").parse(), Ok(error), "{keys}");
        assert!(short.len() < whole.len() / 2);
    }
}

/// The Zarr store does not depend on the number of threads, is a result like others, and is refused where there are no
/// snapshots of a solid.
#[test]
fn gather_writes_snapshots_as_a_zarr_store() {
    let stores = ["1", "2"].map(|threads| {
        let here = create_case_folder("snapshots", &format!("zarr{threads}"), SOLID_CASE);
        let settings = "--pictures none --set output.snapshot_interval=0.005";
        let run = format!("run case.toml --out out --threads {threads} {settings}");
        run_with_exit_code(0, &here, &run);
        let (text, _) = run_with_exit_code(0, &here, "gather out --zarr=8 --pictures none");
        assert!(text.contains("wrote out/snapshots.zarr.zip"), "{text}");
        run_with_exit_code(0, &here, "verify out");
        fs::read(here.join("out/snapshots.zarr.zip")).expect("a store")
    });
    assert!(stores[0] == stores[1]);
    let names = String::from_utf8_lossy(&stores[0]);
    for name in ["v1/c/0/0/0", "sigma22/zarr.json", "time/c/0", "x2/zarr.json"] {
        assert!(names.contains(name), "{name}");
    }
    let here = create_case_folder("snapshots", "zarr-none", SOLID_CASE);
    let run = "run case.toml --out out --pictures none --set output.snapshot_interval=0";
    run_with_exit_code(0, &here, run);
    let (_, text) = run_with_exit_code(2, &here, "gather out --zarr");
    assert!(text.contains("output.snapshot_interval"), "{text}");
    let here = create_case_folder("snapshots", "zarr-flow", FLOW_CASE);
    run_with_exit_code(0, &here, "run case.toml --out out --pictures none");
    let (_, text) = run_with_exit_code(2, &here, "gather out --zarr");
    assert!(text.contains("snapshots of solids"), "{text}");
    let (_, text) = run_with_exit_code(2, &here, "gather out --zarr=4");
    assert!(text.contains("8..=1024") || text.contains("8 to 1024"), "{text}");
}
