//! Helpers that run the program in test folders and read its result files.
#![allow(dead_code, reason = "each test uses a part")]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};
use testkit::random::RandomNumbers;

/// Path of the program under test.
pub const PROGRAM_PATH: &str = env!("CARGO_BIN_EXE_wellposed");

/// Time-domain case of a yielding solid with receivers and snapshots; it runs for about a second.
pub const SOLID_CASE: &str = include_str!("../data/program-solid.toml");

/// Time-domain case of a blocky medium with breaking and saturated joints, receivers and snapshots; it runs for about a
/// second.
pub const JOINT_CASE: &str = include_str!("../data/program-joints.toml");

/// Arguments that run the case in `case.toml` with a checkpoint after every batch of steps.
pub const RUN_ARGUMENTS: &str = "run case.toml --out out --checkpoint-every 0 --threads 1";

/// Verbs that take a case.
pub const VERBS_WITH_CASE: [&str; 11] = [
    "map",
    "point",
    "dispersion",
    "diagram",
    "homogenise",
    "speeds",
    "shocks",
    "split",
    "time",
    "run",
    "check",
];

/// Creates an empty folder for one test.
pub fn create_folder(test: &str, name: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    path
}

/// Creates a folder for one test that contains the file `case.toml` alone.
pub fn create_case_folder(test: &str, name: &str, case: &str) -> PathBuf {
    let path = create_folder(test, name);
    fs::write(path.join("case.toml"), case).unwrap();
    path
}

/// Creates a command that executes the program in a folder, with the arguments of one line, without input and output.
pub fn create_command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(PROGRAM_PATH);
    command.current_dir(folder).args(arguments.split_whitespace());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Starts the program with the arguments of one line.
pub fn start_program(folder: &Path, arguments: &str) -> Child {
    create_command(folder, arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs the program with a list of arguments, which may contain spaces, and returns its output. Without `--threads` it
/// has one thread: for estimates of the cost and on small grids several take more processor time.
pub fn run_with_arguments(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(PROGRAM_PATH);
    command.current_dir(folder).args(arguments).env("RAYON_NUM_THREADS", "1").output().unwrap()
}

/// Runs the program with the arguments of one line and returns its output.
pub fn run_program(folder: &Path, arguments: &str) -> Output {
    start_program(folder, arguments).wait_with_output().unwrap()
}

/// Runs the program, which must end with `code`; returns standard output and standard error.
pub fn run_with_exit_code(code: i32, folder: &Path, arguments: &str) -> (String, String) {
    let output = run_program(folder, arguments);
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{stdout}\n{stderr}");
    (stdout, stderr)
}

/// Lists the names of the entries of a folder, sorted; empty if there is no folder.
pub fn list_entries(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Reads all files of a folder; contents by name.
pub fn read_files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let file = |entry: fs::DirEntry| {
        let bytes = fs::read(entry.path()).ok()?;
        Some((entry.file_name().into_string().unwrap(), bytes))
    };
    entries.filter_map(file).collect()
}

/// Reads all result files of a folder, i.e. all files except the log and the lock; contents by name.
pub fn read_result_files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = read_files(folder);
    files.retain(|name, _| name != "log.txt" && name != "lock");
    files
}

/// Waits until a run in progress has written a file; panics after 120 s.
pub fn wait_for_file(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends a signal, given by its name, to a process.
pub fn send_signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    // The process may have ended already.
    let _ = Command::new("kill").args([&format!("-{name}"), &id]).stderr(Stdio::null()).status();
}

/// Starts a run in a folder and interrupts it as by Ctrl-C as soon as its result file `name` exists.
pub fn interrupt_run(folder: &Path, arguments: &str, name: &str) {
    let mut child = create_command(folder, arguments).spawn().unwrap();
    wait_for_file(&folder.join("out").join(name));
    send_signal(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(folder.join("out/checkpoint").exists());
}

/// Starts a run and interrupts it after its second snapshot; returns its folder.
pub fn create_interrupted_run(test: &str, name: &str) -> PathBuf {
    let folder = create_case_folder(test, name, SOLID_CASE);
    interrupt_run(&folder, RUN_ARGUMENTS, "snapshot-00000001.vti");
    folder
}

/// Damages a non-empty file in one of six random ways; returns a description.
pub fn damage_file(path: &Path, random: &mut RandomNumbers) -> String {
    let bytes = fs::read(path).unwrap();
    loop {
        let mut damaged = bytes.clone();
        let at = random.uniform_index(bytes.len());
        let description = match random.uniform_index(6) {
            0 => {
                let bit = random.uniform_index(8);
                damaged[at] ^= 1 << bit;
                format!("bit {bit} of byte {at} turned")
            }
            1 => {
                damaged.truncate(at);
                format!("cut to {at} bytes")
            }
            2 => {
                damaged.extend(&bytes[at..]);
                format!("its end from byte {at} on once more")
            }
            3 => {
                let end = (at + 1 + random.uniform_index(5000)).min(bytes.len());
                damaged[at..end].fill(0);
                format!("zeros from byte {at} to {end}")
            }
            4 => {
                damaged.swap(at, bytes.len() / 2);
                format!("byte {at} swapped with the middle one")
            }
            _ => {
                fs::remove_file(path).unwrap();
                return "removed".to_owned();
            }
        };
        if damaged != bytes {
            fs::write(path, damaged).unwrap();
            return description;
        }
    }
}
