//! Verifies that hostile input is not read, overwritten or waited for: devices, pipes, decompression bombs, input
//! files of a case; invalid names and titles; limits of the system.
#![cfg(unix)]

mod program;

use program::*;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

const TEST: &str = "hostile";

/// Folder with a time-domain flow case that has the initial section `initial`.
fn flow_with(name: &str, initial: &str) -> PathBuf {
    let text = wellposed::cli::new::text_for(
        wellposed::case::Medium::new(
            wellposed::case::Kind::from_name("harris-grekova").unwrap(),
            None,
        )
        .unwrap(),
        wellposed::cli::new::Purpose::Run,
    );
    let mut case: Vec<String> = Vec::new();
    let mut is_initial = false;
    for line in text.lines() {
        if line.starts_with('[') {
            is_initial = line.starts_with("[[initial]]");
        }
        if !is_initial {
            case.push(line.to_owned());
        }
    }
    folder(TEST, name, &(case.join("\n") + "\n" + initial))
}

const SHORT: &str = "--threads 1 --accept-ill-posed --set grid.cells=[12,12] --set time.duration=1e-5 --set output.snapshot_interval=0";

fn run_of_flow(more: &str) -> String {
    format!("run case.toml --out out {SHORT} {more}")
}

const NOISE: &str =
    "[[initial]]\nkind = 'noise'\nfield = 'v'\nfrom = 1\nto = 3\namplitude = 1e-9\nseed = 1\n";

/// Runs the program; panics after 20 s, so that endless reading is detected.
fn ends_soon(folder: &Path, arguments: &str) -> std::process::Output {
    let mut child = starts(folder, arguments);
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            panic!("{arguments}: not done after 20 s");
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.wait_with_output().unwrap()
}

fn refused_soon(folder: &Path, arguments: &str, words: &str) {
    let output = ends_soon(folder, arguments);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{arguments}: {text}");
    assert!(text.contains(words), "{arguments}: {text}");
}

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Verifies that devices, pipes and folders are not read as initial states, with or without a checksum.
#[test]
fn runs_begin_with_files_alone() {
    for (name, checksum) in [("with", "checksum = '00000000'\n"), ("without", "")] {
        for path in ["/dev/zero", "pipe", "/dev"] {
            let initial = format!("[[initial]]\nkind = 'file'\npath = '{path}'\n{checksum}");
            let here = flow_with(&format!("irregular-{name}"), &initial);
            pipe(&here.join("pipe"));
            let words = if path == "/dev" { "is a directory" } else { "not a regular file" };
            refused_soon(&here, &run_of_flow(""), words);
            assert!(!here.join("out").exists());
        }
    }
}

/// Verifies that a 2 GiB array of zeros in an archive is not decompressed if it is not needed, and is refused if it
/// is needed.
#[test]
fn archives_inflate_no_further_than_wanted() {
    let script = "
import zipfile, struct, sys
def npy(shape, pieces):
    head = \"{'descr': '<f8', 'fortran_order': False, 'shape': (%s, ), }\" % ', '.join(map(str, shape))
    head += ' ' * (-(len(head) + 11) % 64) + '\\n'
    yield b'\\x93NUMPY\\x01\\x00' + struct.pack('<H', len(head)) + head.encode()
    yield from pieces
def add(archive, name, shape, pieces):
    with archive.open(name + '.npy', 'w', force_zip64=True) as entry:
        for piece in npy(shape, pieces):
            entry.write(piece)
small = [bytes(8 * 144)]
for path, large in (('beside.npz', 'large'), ('among.npz', 'w')):
    with zipfile.ZipFile(path, 'w', zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in ('v1', 'v2', 'w'):
            if name != large:
                add(archive, name, (12, 12), small)
        add(archive, large, (1 << 28,), (bytes(1 << 20) for _ in range(1 << 11)))
";
    let here = flow_with("inflated", "[[initial]]\nkind = 'file'\npath = 'beside.npz'\n");
    let made = Command::new("python3").args(["-c", script]).current_dir(&here).status();
    if !made.is_ok_and(|status| status.success()) {
        println!("no python3: nothing is tested");
        return;
    }
    // The archive file is larger than 64 arrays of the grid.
    refused_soon(&here, &run_of_flow(""), "bytes, more than the");
    // On a grid for which the file size is accepted, the archive is read within 1.5 GB of address space.
    let limited = |case: &str, cells: usize| {
        let arguments = run_of_flow(&format!("--set initial[0].path={case}"))
            .replace("[12,12]", &format!("[{cells},{cells}]"));
        let script = format!("ulimit -v 1500000; exec '{PROGRAM}' {arguments}");
        let output =
            Command::new("bash").args(["-c", &script]).current_dir(&here).output().unwrap();
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, text) = limited("beside.npz", 200);
    assert!(
        code == Some(2) && text.contains("v1 is of shape [12, 12], not [200, 200]"),
        "{code:?} {text}"
    );
    let (code, text) = limited("among.npz", 200);
    assert!(
        code == Some(2)
            && text.contains("entry \"w\" of the array archive is larger than it can be"),
        "{code:?} {text}"
    );
}

/// Verifies that neither `run` nor another verb overwrites an input file of the case in the results folder.
#[test]
fn inputs_inside_the_folder_are_not_overwritten() {
    let here = flow_with("input", NOISE);
    ends_with(0, &here, &run_of_flow(""));
    let archive = fs::read(here.join("out/fields.npz")).unwrap();
    let second = flow_with("input-second", "[[initial]]\nkind = 'file'\npath = 'out/fields.npz'\n");
    fs::create_dir(second.join("out")).unwrap();
    fs::write(second.join("out/fields.npz"), &archive).unwrap();
    for arguments in [
        run_of_flow(""),
        run_of_flow("--force"),
        run_of_flow("--force --dry-run"),
        "point case.toml --out out --force --threads 1 --set grid.cells=[12,12]".to_owned(),
        "point case.toml --out out/../out --force --threads 1 --set grid.cells=[12,12]".to_owned(),
    ] {
        let (_, stderr) = ends_with(2, &second, &arguments);
        assert!(
            stderr.contains("fields.npz: the case begins with this file"),
            "{arguments}: {stderr}"
        );
        assert_eq!(names(&second.join("out")), ["fields.npz"], "{arguments}");
        assert!(fs::read(second.join("out/fields.npz")).unwrap() == archive);
    }
    ends_with(0, &second, &run_of_flow("").replace("--out out", "--out other"));
    // The table of a load is not overwritten either.
    let table = SOLID.replace(
        "{ kind = 'pulse', duration = 0.05 }",
        "{ kind = 'table', file = 'out/receivers.csv' }",
    );
    let here = folder(TEST, "table", &table);
    fs::create_dir(here.join("out")).unwrap();
    fs::write(here.join("out/receivers.csv"), "0,0\n0.05,1\n0.1,0\n").unwrap();
    let (_, stderr) = ends_with(2, &here, "run case.toml --out out --force");
    assert!(stderr.contains("receivers.csv: the case begins with this file"), "{stderr}");
    assert_eq!(names(&here.join("out")), ["receivers.csv"]);
}

/// Verifies that invalid names, which would fail after hours when files are written, are refused at the start.
#[test]
fn names_that_no_archive_takes_are_refused_at_once() {
    let name = "r".repeat(70_000);
    let case = SOLID.replace("at = [12, 20]", &format!("at = [12, 20]\nname = '{name}'"));
    let here = folder(TEST, "name", &case);
    let (_, stderr) = ends_with(2, &here, "run case.toml --out out --threads 1");
    assert!(
        stderr.contains("receiver[0].name") && stderr.contains("at most 255 characters"),
        "{stderr}"
    );
    assert!(!here.join("out").exists());
    fs::write(here.join("case.toml"), case.replace(&name, &name[..255])).unwrap();
    ends_with(0, &here, "run case.toml --out out --threads 1 --set time.duration=0.01");
    let (_, stderr) = ends_with(2, &here, &format!("speeds case.toml --set name={}", &name[..256]));
    assert!(stderr.contains("at most 255"), "{stderr}");
}

/// Verifies that exceeding a limit on the file size is reported as a write error.
#[test]
fn a_file_that_becomes_too_large_is_an_error_in_words() {
    let here = folder(TEST, "limit", SOLID);
    for limit in [1, 8, 64, 4096] {
        for verb in ["run", "speeds", "dispersion"] {
            let out = format!("out-{verb}{limit}");
            let script = format!(
                "ulimit -f {limit}; exec '{PROGRAM}' {verb} case.toml --out {out} --threads 1"
            );
            let output =
                Command::new("bash").args(["-c", &script]).current_dir(&here).output().unwrap();
            let text = String::from_utf8_lossy(&output.stderr).into_owned();
            let is_done = output.status.code() == Some(0);
            assert!(is_done == (limit == 4096), "{verb} {limit}: {text}");
            if !is_done {
                assert_eq!(output.status.code(), Some(2), "{verb} {limit}: {text}");
                assert!(text.contains("File too large"), "{verb} {limit}: {text}");
                let left = names(&here.join(out));
                assert!(left.iter().all(|name| !name.ends_with(".partial")), "{left:?}");
            }
        }
    }
}

/// Verifies that `new` overwrites regular files only, even with `--force`.
#[test]
fn a_case_is_not_written_over_a_device() {
    let here = folder(TEST, "device", "");
    pipe(&here.join("pipe"));
    fs::create_dir(here.join("folder")).unwrap();
    fs::write(here.join("target"), "mine").unwrap();
    std::os::unix::fs::symlink("target", here.join("link")).unwrap();
    let before = names(&here);
    for file in ["pipe", "folder", "link"] {
        let (_, stderr) = ends_with(2, &here, &format!("new harris-grekova {file} --force"));
        assert!(stderr.contains(&format!("{file}: not a regular file")), "{stderr}");
    }
    assert_eq!(names(&here), before);
    assert_eq!(fs::read(here.join("target")).unwrap(), b"mine");
    assert!(!fs::symlink_metadata(here.join("pipe")).unwrap().is_file());
}

/// Verifies that a pipe in place of any file of a results folder does not block the program.
#[test]
fn pipes_among_results_are_not_waited_for() {
    let here = interrupted(TEST, "pipes");
    for file in ["checkpoint", "ledger.csv", "snapshot-00000000.vti", "lock", "program.json"] {
        let path = here.join("out").join(file);
        let bytes = fs::read(&path).ok();
        let _ = fs::remove_file(&path);
        pipe(&path);
        refused_soon(&here, "resume out --threads 1", file);
        fs::remove_file(&path).unwrap();
        bytes.into_iter().for_each(|bytes| fs::write(&path, bytes).unwrap());
    }
    let log = here.join("out/log.txt");
    fs::remove_file(&log).unwrap();
    pipe(&log);
    assert!(ends_soon(&here, "resume out --threads 1").status.success());
    ends_with(0, &here, "verify out");
}

/// Verifies that the size of a case is limited, since its memory is proportional to its size: a case of 40 MB is
/// refused, and cases of the largest size need less than 1.5 GB of address space whatever they contain.
#[test]
fn the_size_of_a_case_has_a_limit() {
    const LARGEST: usize = 16 << 20;
    let here = folder(TEST, "large", "");
    let filled = |piece: &str, length: usize| piece.repeat(length / piece.len());
    let table = |rows: String| {
        let samples = format!("{{ kind = 'table', samples = [[0, 1], [1, 1]], x = [{rows}] }}");
        SOLID.replace("{ kind = 'pulse', duration = 0.05 }", &samples)
    };
    let room = LARGEST - SOLID.len() - 200;
    for (case, words) in [
        (SOLID.to_owned() + &filled("[[receiver]]\nat = [1, 1]\n", 40_000_000), "so no case file"),
        (
            SOLID.to_owned() + &filled("[[receiver]]\nat = [1, 1]\n", room),
            "sections and tables, more than",
        ),
        (format!("{SOLID}x = [{}]\n", filled("{b=1},", room)), "sections and tables, more than"),
        (format!("{SOLID}x = [{}]\n", filled("{},", room)), "sections and tables, more than"),
        (SOLID.to_owned() + &filled("a.b=1\n", room), "keys, more than"),
        (SOLID.to_owned() + &filled("[a]\n", room), "sections and tables, more than"),
        (table(filled("1,", room)), "unknown key"),
        (table(filled("[0.125,1.5],", room)), "unknown key"),
        (SOLID.to_owned() + &filled("# x\n", room), ""),
    ] {
        fs::write(here.join("case.toml"), case).unwrap();
        let arguments = "run case.toml --out out --threads 1 --dry-run";
        let script = format!("ulimit -v 1500000; exec '{PROGRAM}' {arguments}");
        let output =
            Command::new("bash").args(["-c", &script]).current_dir(&here).output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        let code = if words.is_empty() { 0 } else { 2 };
        assert_eq!(output.status.code(), Some(code), "{words}: {text}");
        assert!(text.contains(words), "{words}: {text}");
    }
    // Many receivers from few entries.
    let line = "[[receiver]]\nfrom = [1, 1]\nto = [9, 9]\ncount = 10000\n";
    let case = SOLID.to_owned()
        + &(0..11).map(|i| format!("{line}name = 'line{i}'\n")).collect::<String>();
    fs::write(here.join("case.toml"), &case).unwrap();
    let (_, stderr) = ends_with(2, &here, "run case.toml --out out --dry-run");
    assert!(stderr.contains("at most 100000 in all"), "{stderr}");
}

/// Verifies that SIGINT, SIGTERM and SIGHUP end `map` with exit code 130 and without files, and do not crash `check`.
#[test]
fn signals_end_every_verb_with_130() {
    let here = folder(TEST, "signals", "");
    ends_with(0, &here, "new harris-grekova case.toml --force");
    for name in ["INT", "TERM", "HUP"] {
        let map = "map case.toml --bound --threads 1 --set map.x.points=400 --set map.y.points=400 --out out";
        let child = starts(&here, map);
        std::thread::sleep(Duration::from_millis(300));
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{name}");
        assert!(names(&here.join("out")).is_empty(), "{name}");
        let check = starts(&here, "check case.toml --threads 1 --out out");
        std::thread::sleep(Duration::from_millis(100));
        signal(&check, name);
        let code = check.wait_with_output().unwrap().status.code();
        assert!(matches!(code, Some(130 | 0 | 2)), "{name}: {code:?}");
        let _ = fs::remove_dir_all(here.join("out"));
    }
}

/// Verifies that the report of a run that stopped states this.
#[test]
fn a_stopped_run_says_so_in_its_report() {
    let load = "[[load]]\nside = 'x1+'\nfield = 'v1'\namplitude = 1e300\ntime = { kind = 'sine', frequency = 20, start = 0.02 }\n";
    let here =
        folder(TEST, "stopped", &SOLID.replace("[[receiver]]", &format!("{load}[[receiver]]")));
    let (stdout, _) = ends_with(3, &here, "run case.toml --out out --threads 1");
    let text = fs::read_to_string(here.join("out/run.txt")).unwrap();
    assert!(
        text.lines().any(|line| line.starts_with("stopped: ") && line.contains("not finite")),
        "{text}"
    );
    assert!(stdout.contains("stopped: "), "{stdout}");
    ends_with(0, &here, "verify out");
}

/// Verifies that extreme snapshot intervals do not cause a panic.
#[test]
fn absurd_intervals_are_no_panic() {
    let here = folder(TEST, "interval", SOLID);
    for interval in ["1e-300", "5e-324", "1e300"] {
        let output = ends_soon(
            &here,
            &format!("run case.toml --out out --dry-run --set output.snapshot_interval={interval}"),
        );
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(matches!(output.status.code(), Some(0 | 2)), "{interval}: {text}");
        assert!(!text.contains("panicked"), "{interval}: {text}");
    }
}

/// Verifies that a process started with `nohup` survives SIGHUP.
#[test]
fn an_ignored_hangup_stays_ignored() {
    let here = folder(TEST, "nohup", SOLID);
    let script = format!("trap '' HUP; exec '{PROGRAM}' {RUN}");
    let mut child = Command::new("bash").args(["-c", &script]).current_dir(&here).spawn().unwrap();
    wait_for(&here.join("out/snapshot-00000000.vti"));
    signal(&child, "HUP");
    assert_eq!(child.wait().unwrap().code(), Some(0));
    ends_with(0, &here, "verify out");
}
