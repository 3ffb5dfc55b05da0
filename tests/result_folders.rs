//! Tests of results folders: concurrent writers, damage, and verification.

use crate::program::*;
use std::fs;
use std::path::{Path, PathBuf};
use testkit::random::RandomNumbers;

const TEST_FOLDER: &str = "result_folders";

fn create_solid_folder(name: &str) -> PathBuf {
    create_case_folder(TEST_FOLDER, name, SOLID_CASE)
}

fn create_flow_folder(name: &str) -> PathBuf {
    let here = create_case_folder(TEST_FOLDER, name, "");
    run_with_exit_code(0, &here, "new harris-grekova case.toml --force");
    let text = fs::read_to_string(here.join("case.toml")).unwrap();
    let few = |line: &str| match line.contains("points") {
        true => line.replace("points = 56", "points = 8").replace("points = 61", "points = 8"),
        false => line.to_owned(),
    };
    let text: String = text.lines().map(|line| few(line) + "\n").collect();
    fs::write(here.join("case.toml"), text).unwrap();
    here
}

/// Verifies that other verbs on the folder of a run in progress succeed and leave the results of the run
/// bit-identical: twice, with up to 21 verbs each.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/long"]
fn concurrent_verbs_leave_run_results_unchanged() {
    check_concurrent_verbs("", 2, 21);
}

#[cfg(unix)]
#[test]
#[ignore = "takes long"]
fn many_concurrent_verbs_leave_run_results_unchanged() {
    check_concurrent_verbs("many-", 6, 60);
}

/// Checks `trials` runs with up to `max_verbs` other verbs each, in folders whose names begin with `prefix`.
#[cfg(unix)]
fn check_concurrent_verbs(prefix: &str, trials: usize, max_verbs: usize) {
    let alone = create_solid_folder(&format!("{prefix}alone"));
    run_with_exit_code(0, &alone, RUN_ARGUMENTS);
    let expected = read_result_files(&alone.join("out"));
    for trial in 0..trials {
        let here = create_solid_folder(&format!("{prefix}beside{trial}"));
        let run = start_program(&here, RUN_ARGUMENTS);
        wait_for_file(&here.join("out/ledger.csv"));
        let mut beside = 0;
        while !here.join("out/run.json").exists() && beside < max_verbs {
            let verb = ["speeds", "dispersion", "point"][beside % 3];
            run_with_exit_code(0, &here, &format!("{verb} case.toml --out out --threads 1"));
            beside += 1;
        }
        let output = run.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        assert!(beside > 1, "the run was too short for anything beside it");
        let found = read_result_files(&here.join("out"));
        for (name, bytes) in &expected {
            // Other verbs have entries and sections there.
            let is_shared = ["checksums.txt", "report.html"].contains(&name.as_str());
            assert!(is_shared || found.get(name) == Some(bytes), "{trial}: {name}");
        }
        assert!(!found.contains_key("checkpoint"));
        let (stdout, _) = run_with_exit_code(0, &here, "verify out");
        assert!(stdout.contains("files are as they were written"), "{stdout}");
    }
}

/// Verifies that concurrent instances of one verb succeed and that no file is lost.
#[test]
fn concurrent_maps_lose_no_file() {
    let alone = create_flow_folder("map");
    run_with_exit_code(0, &alone, "map case.toml --out out --threads 1");
    let expected = read_files(&alone.join("out"));
    for trial in 0..10 {
        let here = create_flow_folder(&format!("maps{trial}"));
        let children = [0; 3].map(|_| start_program(&here, "map case.toml --out out --threads 1"));
        for child in children {
            let output = child.wait_with_output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        }
        let found = read_files(&here.join("out"));
        assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
        assert!(found == expected, "{trial}");
        run_with_exit_code(0, &here, "verify out");
    }
}

/// Verifies that two cases written to one folder concurrently with `--force` leave the complete results of one of
/// them, in four trials.
#[test]
fn concurrent_forced_cases_do_not_mix() {
    check_forced_cases("", 4);
}

#[test]
#[ignore = "takes long"]
fn many_concurrent_forced_cases_do_not_mix() {
    check_forced_cases("many-", 40);
}

/// Checks `trials` folders whose names begin with `prefix`.
fn check_forced_cases(prefix: &str, trials: usize) {
    let sets = ["background.pressure=500", "background.pressure=7000"];
    let point = |set: &str| format!("point case.toml --out out --threads 1 --force --set {set}");
    let expected = sets.map(|set| {
        let here = create_flow_folder(&format!("{prefix}one-case"));
        run_with_exit_code(0, &here, &point(set));
        read_files(&here.join("out"))
    });
    for trial in 0..trials {
        let here = create_flow_folder(&format!("{prefix}two-cases{trial}"));
        let children = [0, 1, 0, 1].map(|index| start_program(&here, &point(sets[index])));
        for child in children {
            let output = child.wait_with_output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        }
        let found = read_files(&here.join("out"));
        assert!(expected.contains(&found), "{trial}: a mixture");
    }
}

/// Verifies that `--force` does not overwrite the results of a run in progress, or of one that starts meanwhile.
#[cfg(unix)]
#[test]
fn results_of_running_run_are_not_overwritten() {
    let here = create_solid_folder("living");
    let run = start_program(&here, RUN_ARGUMENTS);
    wait_for_file(&here.join("out/ledger.csv"));
    let case = fs::read(here.join("out/case.toml")).unwrap();
    for arguments in [
        "point case.toml --out out --force --set yield.strength=3e4",
        "dispersion case.toml --out out --force --set model.mu=9e7",
        "run case.toml --out out --force --set model.mu=9e7",
        "run case.toml --out out",
        "run case.toml --out out --force",
        "resume out",
    ] {
        let (_, stderr) = run_with_exit_code(2, &here, arguments);
        assert!(stderr.contains("a run is in progress here"), "{arguments}: {stderr}");
    }
    assert_eq!(fs::read(here.join("out/case.toml")).unwrap(), case);
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    run_with_exit_code(0, &here, "verify out");
    // After its end the run may be overwritten.
    run_with_exit_code(0, &here, "point case.toml --out out --force --set yield.strength=3e4");
    assert!(!here.join("out/run.json").exists());
    run_with_exit_code(0, &here, "verify out");
}

/// Verifies that a damaged interrupted run is not resumed and that the refusal leaves its folder unchanged.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/long"]
fn damaged_runs_are_refused_and_left_unchanged() {
    let uninterrupted = create_solid_folder("undamaged");
    run_with_exit_code(0, &uninterrupted, RUN_ARGUMENTS);
    let expected = read_result_files(&uninterrupted.join("out"));
    let here = create_interrupted_run(TEST_FOLDER, "damaged");
    let out = here.join("out");
    // Tables of a killed run have rows after the checkpoint.
    let table = fs::read_to_string(out.join("ledger.csv")).unwrap();
    let last = table.lines().last().unwrap();
    fs::write(out.join("ledger.csv"), format!("{table}{last}\n{last}\n")).unwrap();
    let sound = read_files(&out);
    let mut random = RandomNumbers::new(7);
    for file in [
        "snapshot-00000000.vti",
        "snapshot-00000001.vti",
        "ledger.csv",
        "receivers.csv",
        "checkpoint",
    ] {
        for trial in 0..6 {
            let description = match file.ends_with(".csv") {
                // Rows after the checkpoint are not verified; damage is placed before them.
                true => {
                    let mut bytes = sound[file].clone();
                    let at = random.uniform_index(bytes.len() - 2 * last.len() - 2);
                    bytes[at] ^= 1;
                    fs::write(out.join(file), bytes).unwrap();
                    format!("byte {at} changed")
                }
                false if file == "checkpoint" => {
                    let mut bytes = sound[file].clone();
                    let at = random.uniform_index(bytes.len());
                    bytes[at] ^= 1;
                    fs::write(out.join(file), bytes).unwrap();
                    format!("byte {at} changed")
                }
                false => damage_file(&out.join(file), &mut random),
            };
            let before = read_files(&out);
            let (stdout, _) = run_with_exit_code(1, &here, "verify out");
            assert!(stdout.contains(&format!("{file}: ")), "{file} {description}: {stdout}");
            let (_, stderr) = run_with_exit_code(2, &here, "resume out --threads 1");
            assert!(stderr.contains(&format!("{file}: ")), "{file} {description}: {stderr}");
            assert!(
                read_files(&out) == before,
                "{file} {description}, trial {trial}: the refusal changed something"
            );
            fs::write(out.join(file), &sound[file]).unwrap();
        }
    }
    let (stdout, _) = run_with_exit_code(0, &here, "verify out");
    assert!(stdout.contains("the run is not finished"), "{stdout}");
    // The list of snapshots is derived from other files.
    fs::write(out.join("snapshots.pvd"), "damaged").unwrap();
    run_with_exit_code(0, &here, "resume out --threads 1");
    assert!(read_result_files(&out) == expected);
}

/// Damages files in finished folders of several verbs in random ways and checks that each damage is found.
fn check_damage_detection(name: &str, count: usize) {
    let solid = create_solid_folder(name);
    run_with_exit_code(0, &solid, "run case.toml --out out --threads 1");
    run_with_exit_code(0, &solid, "speeds case.toml --out out --threads 1");
    let flow = create_flow_folder(&format!("{name}-flow"));
    run_with_exit_code(0, &flow, "map case.toml --out out --threads 1");
    run_with_exit_code(0, &flow, "point case.toml --out out --threads 1");
    let mut random = RandomNumbers::new(count as u64);
    for trial in 0..count {
        let here = if trial % 2 == 0 { &solid } else { &flow };
        let out = here.join("out");
        fs::write(out.join("notes"), "of the user").unwrap();
        let sound = read_files(&out);
        let mut files: Vec<&String> = sound.keys().collect();
        files.retain(|name| *name != "log.txt" && *name != "notes");
        let file = match trial % 10 {
            0 | 1 => "checksums.txt",
            _ => files[random.uniform_index(files.len())],
        };
        let description = damage_file(&out.join(file), &mut random);
        let (stdout, stderr) = run_with_exit_code(1, here, "verify out");
        assert!(stdout.contains(&format!("{file}: ")), "{file} {description}: {stdout}");
        assert!(
            stderr.contains("out: 1 damaged or missing file; write the folder anew"),
            "{file} {description}: {stderr}"
        );
        let (stdout, _) = run_with_exit_code(1, here, "verify out --format json");
        let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(report["sound"], false);
        assert_eq!(report["damaged"][0]["file"], file, "{description}");
        fs::write(out.join(file), &sound[file]).unwrap();
    }
    for here in [&solid, &flow] {
        run_with_exit_code(0, here, "verify out");
        fs::write(here.join("out/log.txt"), "anything").unwrap();
        run_with_exit_code(0, here, "verify out");
    }
}

#[test]
fn fifteen_damages_are_detected() {
    check_damage_detection("fifteen", 15);
}

#[test]
#[ignore = "takes long"]
fn three_hundred_damages_are_detected() {
    check_damage_detection("three-hundred", 300);
}

/// Verifies that a folder without results cannot be verified, and that results without checksums are invalid.
#[test]
fn folders_without_results_are_not_verified() {
    let here = create_flow_folder("without");
    for arguments in ["verify nowhere", "verify .", "verify case.toml"] {
        let (stdout, stderr) = run_with_exit_code(2, &here, arguments);
        assert!(stdout.is_empty() && stderr.starts_with("error: "), "{stdout}{stderr}");
    }
    run_with_exit_code(0, &here, "point case.toml --out out");
    // A result file that is not in the list of checksums originates from a killed verb.
    fs::write(here.join("out/map.csv"), "").unwrap();
    let (stdout, _) = run_with_exit_code(1, &here, "verify out");
    assert_eq!(stdout, "map.csv: has no checksum\n");
}

/// Verifies that damaged files are not plotted and that verbs do not add them to a new list of checksums.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn damaged_files_are_not_plotted_or_listed_again() {
    let here = create_solid_folder("covered");
    run_with_exit_code(0, &here, "run case.toml --out out --threads 1");
    let out = here.join("out");
    for file in
        ["ledger.csv", "fields.npz", "receivers.csv", "snapshot-00000002.vti", "snapshots.pvd"]
    {
        let sound = fs::read(out.join(file)).unwrap();
        let mut bytes = sound.clone();
        let last = bytes.len() - 2;
        bytes[last] ^= 1;
        fs::write(out.join(file), bytes).unwrap();
        let before = read_files(&out);
        let (_, stderr) = run_with_exit_code(2, &here, "plot out");
        assert!(
            stderr.contains(&format!("{file}: has other content than was written")),
            "{stderr}"
        );
        assert!(read_files(&out) == before);
        run_with_exit_code(0, &here, "speeds case.toml --out out --threads 1");
        let (stdout, _) = run_with_exit_code(1, &here, "verify out");
        assert!(stdout.contains(file), "{stdout}");
        fs::write(out.join(file), sound).unwrap();
        run_with_exit_code(0, &here, "verify out");
    }
    // The next verb does not repair a damaged list.
    let list = out.join("checksums.txt");
    let sound = fs::read(&list).unwrap();
    fs::write(&list, &sound[..sound.len() - 9]).unwrap();
    let (_, stderr) = run_with_exit_code(2, &here, "speeds case.toml --out out --threads 1");
    assert!(stderr.contains("checksums.txt: is damaged; "), "{stderr}");
    run_with_exit_code(0, &here, "speeds case.toml --out out --threads 1 --force");
    let (stdout, _) = run_with_exit_code(1, &here, "verify out");
    assert!(stdout.contains("run.json: has no checksum"), "{stdout}");
    // A changed plot option of the case counts as damage only until the figures are plotted again.
    fs::write(&list, &sound).unwrap();
    let case = fs::read_to_string(out.join("case.toml")).unwrap();
    fs::write(out.join("case.toml"), case.replace("picture = \"speed\"", "picture = \"u2\""))
        .unwrap();
    run_with_exit_code(1, &here, "verify out");
    run_with_exit_code(0, &here, "plot out");
    run_with_exit_code(0, &here, "verify out");
}

/// Verifies that a symbolic link in place of a lock file is not followed and its target is unchanged.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/long"]
fn symbolic_links_in_place_of_locks_are_refused() {
    for name in ["lock", ".publishing"] {
        let here = create_solid_folder(&format!("link-{name}"));
        fs::create_dir(here.join("out")).unwrap();
        fs::write(here.join("precious"), "data").unwrap();
        let link = here.join("out").join(name);
        std::os::unix::fs::symlink("../precious", &link).unwrap();
        let (_, stderr) = run_with_exit_code(2, &here, "run case.toml --out out --threads 1");
        assert!(stderr.contains(&format!("{name}: cannot be locked: a symbolic link")), "{stderr}");
        assert_eq!(fs::read(here.join("precious")).unwrap(), b"data");
        assert_eq!(list_entries(&here.join("out")), [name]);
        fs::remove_file(&link).unwrap();
        run_with_exit_code(0, &here, "run case.toml --out out --threads 1");
    }
}

/// Verifies that a symbolic link in place of the log is not followed.
#[cfg(unix)]
#[test]
fn symbolic_link_in_place_of_log_is_not_followed() {
    let here = create_interrupted_run(TEST_FOLDER, "log");
    fs::write(here.join("precious"), "data").unwrap();
    fs::remove_file(here.join("out/log.txt")).unwrap();
    std::os::unix::fs::symlink("../precious", here.join("out/log.txt")).unwrap();
    run_with_exit_code(0, &here, "resume out --threads 1");
    assert_eq!(fs::read(here.join("precious")).unwrap(), b"data");
    run_with_exit_code(0, &here, "verify out");
}

/// Verifies that of several processes that resume one run, one succeeds; the others are refused or find it finished.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/long"]
fn only_one_process_resumes_a_run() {
    let uninterrupted = create_solid_folder("whole-resumed");
    run_with_exit_code(0, &uninterrupted, RUN_ARGUMENTS);
    let here = create_interrupted_run(TEST_FOLDER, "twice-resumed");
    let children = [0; 3].map(|_| start_program(&here, "resume out --threads 1"));
    let mut done = 0;
    for child in children {
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_refused = text.contains("a run is in progress") || text.contains("is finished");
        assert!(output.status.success() || is_refused, "{text}");
        done += usize::from(output.status.success());
    }
    assert_eq!(done, 1);
    assert!(read_result_files(&here.join("out")) == read_result_files(&uninterrupted.join("out")));
}

/// Verifies that a verb waits for a folder that is locked briefly, and fails if the lock is held for ten seconds.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn lock_held_for_ten_seconds_is_an_error() {
    let here = create_flow_folder("waiting");
    fs::create_dir(here.join("out")).unwrap();
    let path = here.join("out/.publishing");
    let lock = files::lock::Lock::try_acquire(Path::new(&path)).unwrap();
    let child = start_program(&here, "point case.toml --out out");
    std::thread::sleep(std::time::Duration::from_secs(2));
    drop(lock);
    assert!(child.wait_with_output().unwrap().status.success());
    let before = read_files(&here.join("out"));
    let lock = files::lock::Lock::try_acquire(Path::new(&path)).unwrap();
    let (_, stderr) = run_with_exit_code(2, &here, "point case.toml --out out");
    assert!(stderr.contains("another process has been putting files here for 10 s"), "{stderr}");
    drop(lock);
    assert!(read_files(&here.join("out")) == before);
}
