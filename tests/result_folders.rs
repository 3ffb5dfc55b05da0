//! Tests of results folders: concurrent writers, damage, and verification.

mod program;

use program::*;
use std::fs;
use std::path::{Path, PathBuf};

const TEST: &str = "result_folders";

fn here(name: &str) -> PathBuf {
    folder(TEST, name, SOLID)
}

fn flow(name: &str) -> PathBuf {
    let here = folder(TEST, name, "");
    ends_with(0, &here, "new harris-grekova case.toml --force");
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
/// bit-identical.
#[cfg(unix)]
#[test]
fn verbs_beside_a_run_harm_nothing() {
    let alone = here("alone");
    ends_with(0, &alone, RUN);
    let expected = results(&alone.join("out"));
    for trial in 0..6 {
        let here = here(&format!("beside{trial}"));
        let run = starts(&here, RUN);
        wait_for(&here.join("out/ledger.csv"));
        let mut beside = 0;
        while !here.join("out/run.json").exists() && beside < 60 {
            let verb = ["speeds", "dispersion", "point"][beside % 3];
            ends_with(0, &here, &format!("{verb} case.toml --out out --threads 1"));
            beside += 1;
        }
        let output = run.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        assert!(beside > 1, "the run was too short for anything beside it");
        let found = results(&here.join("out"));
        for (name, bytes) in &expected {
            assert!(name == "checksums.txt" || found.get(name) == Some(bytes), "{trial}: {name}");
        }
        assert!(!found.contains_key("checkpoint"));
        let (stdout, _) = ends_with(0, &here, "verify out");
        assert!(stdout.contains("files are as they were written"), "{stdout}");
    }
}

/// Verifies that concurrent instances of one verb succeed and that no file is lost.
#[test]
fn maps_at_once_lose_nothing() {
    let alone = flow("map");
    ends_with(0, &alone, "map case.toml --out out --threads 1");
    let expected = contents(&alone.join("out"));
    for trial in 0..10 {
        let here = flow(&format!("maps{trial}"));
        let all = [0; 3].map(|_| starts(&here, "map case.toml --out out --threads 1"));
        for child in all {
            let output = child.wait_with_output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        }
        let found = contents(&here.join("out"));
        assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
        assert!(found == expected, "{trial}");
        ends_with(0, &here, "verify out");
    }
}

/// Verifies that two cases written to one folder concurrently with `--force` leave the complete results of one of
/// them.
#[test]
fn forced_cases_do_not_mix() {
    let sets = ["background.pressure=500", "background.pressure=7000"];
    let point = |set: &str| format!("point case.toml --out out --threads 1 --force --set {set}");
    let expected = sets.map(|set| {
        let here = flow("one-case");
        ends_with(0, &here, &point(set));
        contents(&here.join("out"))
    });
    for trial in 0..10 {
        let here = flow(&format!("two-cases{trial}"));
        let all = [0, 1, 0, 1].map(|index| starts(&here, &point(sets[index])));
        for child in all {
            let output = child.wait_with_output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{trial}: {text}");
        }
        let found = contents(&here.join("out"));
        assert!(expected.contains(&found), "{trial}: a mixture");
    }
}

/// Verifies that `--force` does not overwrite the results of a run in progress, or of one that starts meanwhile.
#[cfg(unix)]
#[test]
fn a_living_run_keeps_its_folder() {
    let here = here("living");
    let run = starts(&here, RUN);
    wait_for(&here.join("out/ledger.csv"));
    let case = fs::read(here.join("out/case.toml")).unwrap();
    for arguments in [
        "point case.toml --out out --force --set yield.strength=3e4",
        "dispersion case.toml --out out --force --set model.mu=9e7",
        "run case.toml --out out --force --set model.mu=9e7",
        "run case.toml --out out",
        "run case.toml --out out --force",
        "resume out",
    ] {
        let (_, stderr) = ends_with(2, &here, arguments);
        assert!(stderr.contains("a run is in progress here"), "{arguments}: {stderr}");
    }
    assert_eq!(fs::read(here.join("out/case.toml")).unwrap(), case);
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    ends_with(0, &here, "verify out");
    // After its end the run may be overwritten.
    ends_with(0, &here, "point case.toml --out out --force --set yield.strength=3e4");
    assert!(!here.join("out/run.json").exists());
    ends_with(0, &here, "verify out");
}

/// Verifies that a damaged interrupted run is not resumed and that the refusal leaves its folder unchanged.
#[cfg(unix)]
#[test]
fn damaged_runs_are_refused_and_stay_as_they_are() {
    let whole = here("undamaged");
    ends_with(0, &whole, RUN);
    let expected = results(&whole.join("out"));
    let here = interrupted(TEST, "damaged");
    let out = here.join("out");
    // Tables of a killed run have rows after the checkpoint.
    let table = fs::read_to_string(out.join("ledger.csv")).unwrap();
    let last = table.lines().last().unwrap();
    fs::write(out.join("ledger.csv"), format!("{table}{last}\n{last}\n")).unwrap();
    let sound = contents(&out);
    let mut chance = Chance::new(7);
    for file in [
        "snapshot-00000000.vti",
        "snapshot-00000001.vti",
        "ledger.csv",
        "receivers.csv",
        "checkpoint",
    ] {
        for trial in 0..6 {
            let how = match file.ends_with(".csv") {
                // Rows after the checkpoint are not verified; damage is placed before them.
                true => {
                    let mut bytes = sound[file].clone();
                    let at = chance.below(bytes.len() - 2 * last.len() - 2);
                    bytes[at] ^= 1;
                    fs::write(out.join(file), bytes).unwrap();
                    format!("byte {at} changed")
                }
                false if file == "checkpoint" => {
                    let mut bytes = sound[file].clone();
                    let at = chance.below(bytes.len());
                    bytes[at] ^= 1;
                    fs::write(out.join(file), bytes).unwrap();
                    format!("byte {at} changed")
                }
                false => damage(&out.join(file), &mut chance),
            };
            let before = contents(&out);
            let (stdout, _) = ends_with(1, &here, "verify out");
            assert!(stdout.contains(&format!("{file}: ")), "{file} {how}: {stdout}");
            let (_, stderr) = ends_with(2, &here, "resume out --threads 1");
            assert!(stderr.contains(&format!("{file}: ")), "{file} {how}: {stderr}");
            assert!(
                contents(&out) == before,
                "{file} {how}, trial {trial}: the refusal changed something"
            );
            fs::write(out.join(file), &sound[file]).unwrap();
        }
    }
    let (stdout, _) = ends_with(0, &here, "verify out");
    assert!(stdout.contains("the run is not finished"), "{stdout}");
    // The list of snapshots is derived from other files.
    fs::write(out.join("snapshots.pvd"), "damaged").unwrap();
    ends_with(0, &here, "resume out --threads 1");
    assert!(results(&out) == expected);
}

/// Damages files in finished folders of several verbs in random ways and checks that each damage is found.
fn damages_are_found(name: &str, count: usize) {
    let solid = here(name);
    ends_with(0, &solid, "run case.toml --out out --threads 1");
    ends_with(0, &solid, "speeds case.toml --out out --threads 1");
    let flow = flow(&format!("{name}-flow"));
    ends_with(0, &flow, "map case.toml --out out --threads 1");
    ends_with(0, &flow, "point case.toml --out out --threads 1");
    let mut chance = Chance::new(count as u64);
    for trial in 0..count {
        let here = if trial % 2 == 0 { &solid } else { &flow };
        let out = here.join("out");
        fs::write(out.join("notes"), "of the user").unwrap();
        let sound = contents(&out);
        let mut files: Vec<&String> = sound.keys().collect();
        files.retain(|name| *name != "log.txt" && *name != "notes");
        let file = match trial % 10 {
            0 | 1 => "checksums.txt",
            _ => files[chance.below(files.len())],
        };
        let how = damage(&out.join(file), &mut chance);
        let (stdout, stderr) = ends_with(1, here, "verify out");
        assert!(stdout.contains(&format!("{file}: ")), "{file} {how}: {stdout}");
        assert!(stderr.contains("out: 1 damaged or missing file\n"), "{file} {how}: {stderr}");
        let (stdout, _) = ends_with(1, here, "verify out --format json");
        let report: serde_json::Value = serde_json::from_str(&stdout).unwrap();
        assert_eq!(report["sound"], false);
        assert_eq!(report["damaged"][0]["file"], file, "{how}");
        fs::write(out.join(file), &sound[file]).unwrap();
    }
    for here in [&solid, &flow] {
        ends_with(0, here, "verify out");
        fs::write(here.join("out/log.txt"), "anything").unwrap();
        ends_with(0, here, "verify out");
    }
}

#[test]
fn thirty_damages_are_found() {
    damages_are_found("thirty", 30);
}

#[test]
#[ignore = "takes long"]
fn three_hundred_damages_are_found() {
    damages_are_found("three-hundred", 300);
}

/// Verifies that a folder without results cannot be verified, and that results without checksums are invalid.
#[test]
fn folders_without_results_are_not_verified() {
    let here = flow("without");
    for arguments in ["verify nowhere", "verify .", "verify case.toml"] {
        let (stdout, stderr) = ends_with(2, &here, arguments);
        assert!(stdout.is_empty() && stderr.starts_with("error: "), "{stdout}{stderr}");
    }
    ends_with(0, &here, "point case.toml --out out");
    // A result file of this program that is in no list originates from a killed verb.
    fs::write(here.join("out/map.csv"), "").unwrap();
    let (stdout, _) = ends_with(1, &here, "verify out");
    assert_eq!(stdout, "map.csv: has no checksum\n");
}

/// Verifies that damaged files are not plotted and that verbs do not add them to a new list of checksums.
#[test]
fn damage_is_not_covered_up() {
    let here = here("covered");
    ends_with(0, &here, "run case.toml --out out --threads 1");
    let out = here.join("out");
    for file in
        ["ledger.csv", "fields.npz", "receivers.csv", "snapshot-00000002.vti", "snapshots.pvd"]
    {
        let sound = fs::read(out.join(file)).unwrap();
        let mut bytes = sound.clone();
        let last = bytes.len() - 2;
        bytes[last] ^= 1;
        fs::write(out.join(file), bytes).unwrap();
        let before = contents(&out);
        let (_, stderr) = ends_with(2, &here, "plot out");
        assert!(
            stderr.contains(&format!("{file}: has other content than was written")),
            "{stderr}"
        );
        assert!(contents(&out) == before);
        ends_with(0, &here, "speeds case.toml --out out --threads 1");
        let (stdout, _) = ends_with(1, &here, "verify out");
        assert!(stdout.contains(file), "{stdout}");
        fs::write(out.join(file), sound).unwrap();
        ends_with(0, &here, "verify out");
    }
    // The next verb does not repair a damaged list.
    let list = out.join("checksums.txt");
    let sound = fs::read(&list).unwrap();
    fs::write(&list, &sound[..sound.len() - 9]).unwrap();
    let (_, stderr) = ends_with(2, &here, "speeds case.toml --out out --threads 1");
    assert!(stderr.contains("checksums.txt: is damaged; "), "{stderr}");
    ends_with(0, &here, "speeds case.toml --out out --threads 1 --force");
    let (stdout, _) = ends_with(1, &here, "verify out");
    assert!(stdout.contains("run.json: has no checksum"), "{stdout}");
    // Plotting again is not damage.
    fs::write(&list, &sound).unwrap();
    let case = fs::read_to_string(out.join("case.toml")).unwrap();
    fs::write(out.join("case.toml"), case.replace("picture = \"speed\"", "picture = \"u2\""))
        .unwrap();
    ends_with(1, &here, "verify out");
    ends_with(0, &here, "plot out");
    ends_with(0, &here, "verify out");
}

/// Verifies that a symbolic link in place of a lock file is not followed and its target is unchanged.
#[cfg(unix)]
#[test]
fn links_in_place_of_locks_are_refused() {
    for name in ["lock", ".publishing"] {
        let here = here(&format!("link-{name}"));
        fs::create_dir(here.join("out")).unwrap();
        fs::write(here.join("precious"), "data").unwrap();
        let link = here.join("out").join(name);
        std::os::unix::fs::symlink("../precious", &link).unwrap();
        let (_, stderr) = ends_with(2, &here, "run case.toml --out out --threads 1");
        assert!(stderr.contains(&format!("{name}: cannot be locked: a symbolic link")), "{stderr}");
        assert_eq!(fs::read(here.join("precious")).unwrap(), b"data");
        assert_eq!(names(&here.join("out")), [name]);
        fs::remove_file(&link).unwrap();
        ends_with(0, &here, "run case.toml --out out --threads 1");
    }
}

/// Verifies that a symbolic link in place of the log is not followed.
#[cfg(unix)]
#[test]
fn a_link_in_place_of_the_log_is_not_followed() {
    let here = interrupted(TEST, "log");
    fs::write(here.join("precious"), "data").unwrap();
    fs::remove_file(here.join("out/log.txt")).unwrap();
    std::os::unix::fs::symlink("../precious", here.join("out/log.txt")).unwrap();
    ends_with(0, &here, "resume out --threads 1");
    assert_eq!(fs::read(here.join("precious")).unwrap(), b"data");
    ends_with(0, &here, "verify out");
}

/// Verifies that of several processes that resume one run, one succeeds; the others are refused or find it finished.
#[cfg(unix)]
#[test]
fn one_resumes_at_a_time() {
    let whole = here("whole-resumed");
    ends_with(0, &whole, RUN);
    let here = interrupted(TEST, "twice-resumed");
    let all = [0; 3].map(|_| starts(&here, "resume out --threads 1"));
    let mut done = 0;
    for child in all {
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let is_refused = text.contains("a run is in progress") || text.contains("is finished");
        assert!(output.status.success() || is_refused, "{text}");
        done += usize::from(output.status.success());
    }
    assert_eq!(done, 1);
    assert!(results(&here.join("out")) == results(&whole.join("out")));
}

/// Verifies that a verb waits for a folder that is locked briefly, and fails if the lock is held for ten seconds.
#[cfg(unix)]
#[test]
fn who_waits_too_long_is_told() {
    let here = flow("waiting");
    fs::create_dir(here.join("out")).unwrap();
    let path = here.join("out/.publishing");
    let lock = files::lock::Lock::try_acquire(Path::new(&path)).unwrap();
    let child = starts(&here, "point case.toml --out out");
    std::thread::sleep(std::time::Duration::from_secs(2));
    drop(lock);
    assert!(child.wait_with_output().unwrap().status.success());
    let before = contents(&here.join("out"));
    let lock = files::lock::Lock::try_acquire(Path::new(&path)).unwrap();
    let (_, stderr) = ends_with(2, &here, "point case.toml --out out");
    assert!(stderr.contains("another process has been putting files here for 10 s"), "{stderr}");
    drop(lock);
    assert!(contents(&here.join("out")) == before);
}
