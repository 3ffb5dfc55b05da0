//! Tests of killed, interrupted and damaged runs through the program.

use crate::program::{
    JOINT_CASE, PROGRAM_PATH, RUN_ARGUMENTS, SOLID_CASE, create_case_folder, create_command,
    interrupt_run, read_files, read_result_files, run_program, send_signal, wait_for_file,
};
use std::fs;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Creates a folder that contains [`SOLID_CASE`] as its only file.
fn create_solid_folder(name: &str) -> PathBuf {
    create_case_folder("resume", name, SOLID_CASE)
}

/// Verifies that runs killed at four times of their duration and resumed until finished give the same files.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn four_killed_runs_resume_to_bit_identical_files() {
    check_killed_runs("four", 4);
}

#[test]
#[ignore = "takes long"]
fn forty_killed_runs_resume_to_bit_identical_files() {
    check_killed_runs("forty", 40);
}

/// Checks `count` runs that are killed at equidistant times of their duration.
fn check_killed_runs(name: &str, count: u32) {
    let uninterrupted = create_solid_folder(&format!("{name}-whole"));
    let start = Instant::now();
    assert!(run_program(&uninterrupted, RUN_ARGUMENTS).status.success());
    let duration = start.elapsed();
    let expected = read_result_files(&uninterrupted.join("out"));
    assert!(expected.iter().any(|file| file.0 == "snapshot-00000000.vti"));
    for index in 0..count {
        let here = create_solid_folder(&format!("{name}-killed{index}"));
        let mut child = create_command(&here, RUN_ARGUMENTS).spawn().unwrap();
        std::thread::sleep(duration.mul_f64((f64::from(index) + 0.5) / f64::from(count + 1)));
        // SIGKILL; a run that finished earlier is valid, too.
        let _ = child.kill();
        child.wait().unwrap();
        if here.join("out/run.json").exists() {
            // A run killed during its last action may still have a checkpoint.
            let _ = fs::remove_file(here.join("out/checkpoint"));
        } else if !here.join("out/program.json").exists() {
            assert!(run_program(&here, &format!("{RUN_ARGUMENTS} --force")).status.success());
        } else {
            // The run is resumed with another number of threads and killed once more.
            let mut child = create_command(&here, "resume out --threads 2 --checkpoint-every 0")
                .spawn()
                .unwrap();
            std::thread::sleep(duration.mul_f64(0.1));
            let _ = child.kill();
            child.wait().unwrap();
            if !here.join("out/run.json").exists() {
                let output = run_program(&here, "resume out --threads 3");
                let text = String::from_utf8_lossy(&output.stderr).into_owned();
                assert!(output.status.success(), "{index}: {text}");
            } else {
                let _ = fs::remove_file(here.join("out/checkpoint"));
            }
        }
        let found = read_result_files(&here.join("out"));
        for (file, other) in found.iter().zip(&expected) {
            assert!(file == other, "{index}: {} differs from {}", file.0, other.0);
        }
        assert_eq!(found.len(), expected.len(), "{index}");
    }
}

/// Returns the largest absolute value of a quantity of the faces of joints in a file of lines.
fn largest_face_value(file: &[u8], name: &str) -> f64 {
    let values = files::vti::read_plain_values(file, name).expect(name);
    values.iter().filter(|value| !value.is_nan()).fold(0.0, |largest, own| largest.max(own.abs()))
}

/// Verifies that a run with joints, stopped after faces have slipped, broken and opened and while the fluid moves, has the
/// same files as the run without interruption: the checkpoint contains the memory of the faces.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn interrupted_runs_with_joints_resume_to_bit_identical_files() {
    let whole = create_case_folder("resume", "joints-whole", JOINT_CASE);
    assert!(run_program(&whole, RUN_ARGUMENTS).status.success());
    let expected = read_result_files(&whole.join("out"));
    for (name, snapshot, threads) in [("joints-early", 3, 2), ("joints-late", 9, 1)] {
        let here = create_case_folder("resume", name, JOINT_CASE);
        let name = format!("joints-{snapshot:08}.vtp");
        interrupt_run(&here, RUN_ARGUMENTS, &name);
        let stopped = read_files(&here.join("out"));
        assert!(!stopped.contains_key("run.json"), "the run is finished");
        let memory = ["slip [m]", "opening [m]", "fracture_time [s]", "pressure [Pa]"];
        for quantity in memory {
            assert!(largest_face_value(&stopped[&name], quantity) > 0.0, "{quantity}");
        }
        assert!(run_program(&here, &format!("resume out --threads {threads}")).status.success());
        let found = read_result_files(&here.join("out"));
        assert!(found.keys().eq(expected.keys()), "{:?}", found.keys());
        for (file, bytes) in &expected {
            assert!(found[file] == *bytes, "{name}: {file} differs");
        }
        // The state still changes after the interruption.
        assert!(stopped[&name] != found["joints.vtp"]);
    }
}

/// Starts a run and interrupts it after its first snapshot; returns its folder.
#[cfg(unix)]
fn create_interrupted_run(name: &str) -> PathBuf {
    let here = create_solid_folder(name);
    interrupt_run(&here, "run case.toml --out out --threads 1", "snapshot-00000000.vti");
    here
}

#[cfg(unix)]
#[test]
fn interrupted_runs_leave_a_checkpoint() {
    let here = create_interrupted_run("interrupted");
    let output = run_program(&here, "run case.toml --out out");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("go on with wellposed resume"));
    assert!(run_program(&here, "resume out").status.success());
    let output = run_program(&here, "resume out");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("the run is finished"));
    assert_eq!(run_program(&here, "run case.toml --out out").status.code(), Some(2));
    // Without one of the snapshots there is no animation.
    let snapshot = here.join("out/snapshot-00000000.vti");
    let image = fs::read(&snapshot).unwrap();
    fs::remove_file(&snapshot).unwrap();
    let output = run_program(&here, "plot out");
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("snapshot-00000000.vti: is missing; run the case again"), "{text}");
    fs::write(&snapshot, image).unwrap();
    // Plot options may change, computed results may not.
    let case = here.join("out/case.toml");
    let resolved = fs::read_to_string(&case).unwrap();
    let before = fs::read(here.join("out/run.svg")).unwrap();
    let drawn = resolved.replace("picture = \"speed\"", "picture = \"u2\"\ncontours = [1e-3]");
    fs::write(&case, drawn).unwrap();
    assert!(run_program(&here, "plot out").status.success());
    assert!(fs::read(here.join("out/run.svg")).unwrap() != before);
    fs::write(&case, resolved.replace("density = 1900", "density = 1800")).unwrap();
    let output = run_program(&here, "plot out");
    assert_eq!(output.status.code(), Some(2));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("case.toml: not what the run began with"), "{text}");
}

/// Verifies that a case changed after the start of the run is detected, also without a checkpoint.
#[cfg(unix)]
#[test]
fn changed_case_is_not_resumed() {
    let here = create_interrupted_run("changed");
    fs::remove_file(here.join("out/checkpoint")).unwrap();
    let case = here.join("out/case.toml");
    let resolved = fs::read_to_string(&case).unwrap();
    let changed = resolved.replace("density = 1900", "density = 1800");
    assert_ne!(changed, resolved);
    fs::write(&case, changed).unwrap();
    for arguments in ["resume out", "run out/case.toml --out out"] {
        let output = run_program(&here, arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments}");
    }
    // The same case in another notation is accepted.
    fs::write(&case, format!("# as it was\n{}", resolved.replace("1900.0", "1.9e3"))).unwrap();
    assert!(run_program(&here, "resume out").status.success());
}

/// Verifies that the first Ctrl-C ends the run after the step, and the second at once; the run can be resumed.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/long"]
fn second_interruption_ends_run_at_once() {
    let uninterrupted = create_solid_folder("uninterrupted");
    assert!(run_program(&uninterrupted, RUN_ARGUMENTS).status.success());
    for pause in [0, 5] {
        let here = create_solid_folder("twice");
        let child = create_command(&here, RUN_ARGUMENTS).stderr(Stdio::piped()).spawn().unwrap();
        wait_for_file(&here.join("out/checkpoint"));
        for _ in 0..2 {
            send_signal(&child, "INT");
            std::thread::sleep(Duration::from_millis(pause));
        }
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(130), "{text}");
        let message = "finishing the step and writing a checkpoint; press again to stop at once\n";
        assert_eq!(text.matches(message).count(), 1, "{text}");
        assert!(run_program(&here, "resume out").status.success());
        assert!(
            read_result_files(&here.join("out")) == read_result_files(&uninterrupted.join("out"))
        );
    }
}

/// Verifies that only one run at a time writes to a folder, and that SIGTERM ends it like Ctrl-C.
#[cfg(unix)]
#[test]
fn folder_accepts_one_run_at_a_time() {
    let here = create_solid_folder("busy");
    let mut child = create_command(&here, "run case.toml --out out --threads 1").spawn().unwrap();
    wait_for_file(&here.join("out/snapshot-00000000.vti"));
    for arguments in ["run case.toml --out out", "run case.toml --out out --force", "resume out"] {
        let output = run_program(&here, arguments);
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
        assert!(text.contains("a run is in progress here"), "{arguments}: {text}");
    }
    send_signal(&child, "TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(run_program(&here, "resume out").status.success());
}

/// Verifies that damaged checkpoints and folders without a checkpoint are refused.
#[cfg(unix)]
#[test]
fn damaged_checkpoints_are_refused() {
    let here = create_interrupted_run("damaged");
    let path = here.join("out/checkpoint");
    let sound = fs::read(&path).unwrap();
    let mut flipped = sound.clone();
    flipped[sound.len() / 2] ^= 4;
    for damaged in [flipped, sound[..sound.len() - 5].to_vec(), Vec::new()] {
        fs::write(&path, damaged).unwrap();
        let output = run_program(&here, "resume out");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains("--force") && text.matches("checkpoint").count() == 1, "{text}");
    }
    // An unreadable checkpoint is not reported as damaged.
    fs::remove_file(&path).unwrap();
    fs::create_dir(&path).unwrap();
    let output = run_program(&here, "resume out");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(text.contains("make it readable") && !text.contains("--force"), "{text}");
    fs::remove_dir(&path).unwrap();
    fs::write(&path, &sound).unwrap();
    // A table shorter than recorded in the checkpoint is refused.
    let table = here.join("out/receivers.csv");
    let rows = fs::read(&table).unwrap();
    fs::write(&table, &rows[..20]).unwrap();
    assert_eq!(run_program(&here, "resume out").status.code(), Some(2));
    // A table with other content than recorded in the checkpoint is refused.
    let mut changed = rows.clone();
    let first_row = rows.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    changed[first_row] = b'7';
    fs::write(&table, changed).unwrap();
    let output = run_program(&here, "resume out");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("receivers.csv: has other content in its first"), "{text}");
    fs::write(&table, rows).unwrap();
    // A missing snapshot is refused.
    let snapshot = here.join("out/snapshot-00000000.vti");
    let image = fs::read(&snapshot).unwrap();
    fs::remove_file(&snapshot).unwrap();
    let output = run_program(&here, "resume out");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("snapshot-00000000.vti: is missing"));
    fs::write(&snapshot, image).unwrap();
    assert!(run_program(&here, "resume out").status.success());
    for arguments in ["resume nowhere", "resume .", "plot nowhere"] {
        assert_eq!(run_program(&here, arguments).status.code(), Some(2), "{arguments}");
    }
    for seconds in ["nan", "inf", "-1", "soon"] {
        let output = run_program(&here, &format!("resume out --checkpoint-every={seconds}"));
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains("expected a finite number of at least 0"), "{text}");
    }
}

/// Verifies that a full disk, simulated by a limit on the file size, ends the run with a message and leaves the last
/// checkpoint unchanged.
#[cfg(unix)]
#[test]
fn full_disk_leaves_last_checkpoint_unchanged() {
    let here = create_interrupted_run("full");
    let path = here.join("out/checkpoint");
    let sound = fs::read(&path).unwrap();
    // `ulimit -f` counts blocks of 1 KiB; the signal SIGXFSZ for larger files is ignored.
    let limit = sound.len() / 1024 / 2;
    let script = format!(
        "trap '' XFSZ; ulimit -f {limit}; exec '{PROGRAM_PATH}' resume out --checkpoint-every 0 --threads 1"
    );
    let output = Command::new("bash").args(["-c", &script]).current_dir(&here).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("File too large"), "{text}");
    assert!(fs::read(&path).unwrap() == sound);
    assert!(run_program(&here, "resume out").status.success());
}
