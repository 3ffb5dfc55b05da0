//! Helpers that run the program: folders, arguments, exit codes.
#![allow(dead_code)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_wellposed");

/// Time-domain case of a yielding solid with receivers and snapshots; it runs for about a second.
pub const SOLID: &str = "
[model]
kind = 'reduced-cosserat'
lambda = 1.2e8
mu = 8e7
alpha = 3e7
density = 1900
inertia = 300
[yield]
kind = 'von-mises'
strength = 2e4
[grid]
cells = [60, 50]
spacing = 0.5
[time]
duration = 0.15
[scheme]
ledger = 'full'
[[side]]
side = 'x1-'
kind = 'non-reflecting'
[[load]]
side = 'x2+'
field = 'sigma22'
from = 8
to = 14
amplitude = -1e5
time = { kind = 'pulse', duration = 0.05 }
[[receiver]]
at = [12, 20]
[output]
snapshot_interval = 0.01
integrals = ['u2', 'phi3']
[wave]
number = 1
";

/// Arguments that run the case in `case.toml` with a checkpoint after every batch of steps.
pub const RUN: &str = "run case.toml --out out --checkpoint-every 0 --threads 1";

/// Creates an empty folder for one test, with a case file.
pub fn folder(test: &str, name: &str, case: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test).join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("case.toml"), case).unwrap();
    path
}

pub fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(arguments.split_whitespace());
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Starts the program with the arguments of one line.
pub fn starts(folder: &Path, arguments: &str) -> Child {
    command(folder, arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

/// Runs the program and returns its output.
pub fn ends(folder: &Path, arguments: &str) -> Output {
    starts(folder, arguments).wait_with_output().unwrap()
}

/// Runs the program, which must end with `code`; returns standard output and standard error.
pub fn ends_with(code: i32, folder: &Path, arguments: &str) -> (String, String) {
    let output = ends(folder, arguments);
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|own| String::from_utf8_lossy(&own).into_owned());
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{stdout}\n{stderr}");
    (stdout, stderr)
}

/// Names of the entries of a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let mut names: Vec<String> =
        entries.map(|entry| entry.file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// Contents of all files of a folder, by name.
pub fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    let file = |entry: fs::DirEntry| {
        let bytes = fs::read(entry.path()).ok()?;
        Some((entry.file_name().into_string().unwrap(), bytes))
    };
    entries.filter_map(file).collect()
}

/// Contents of all result files, i.e. of all files except the log and the lock.
pub fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = contents(folder);
    all.retain(|name, _| name != "log.txt" && name != "lock");
    all
}

/// Waits until a run in progress has written a file.
pub fn wait_for(path: &Path) {
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(120), "{} does not come", path.display());
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Sends a signal, given by name, to a process.
pub fn signal(child: &Child, name: &str) {
    let id = child.id().to_string();
    // The process may have ended already.
    let _ = Command::new("kill").args([&format!("-{name}"), &id]).stderr(Stdio::null()).status();
}

/// Folder of a run that was interrupted after its second snapshot.
pub fn interrupted(test: &str, name: &str) -> PathBuf {
    let here = folder(test, name, SOLID);
    let mut child = command(&here, RUN).spawn().unwrap();
    wait_for(&here.join("out/snapshot-00000001.vti"));
    signal(&child, "INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(here.join("out/checkpoint").exists());
    here
}

/// Reproducible pseudo-random numbers.
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// SplitMix64 (Steele, Lea and Flood 2014).
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform integer below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }

    /// Uniform number from 0 to 1.
    pub fn part(&mut self) -> f64 {
        self.next() as f64 / u64::MAX as f64
    }
}

/// Damages a file in one of several random ways; returns a description.
pub fn damage(path: &Path, chance: &mut Chance) -> String {
    let bytes = fs::read(path).unwrap();
    loop {
        let mut other = bytes.clone();
        let at = chance.below(bytes.len());
        let how = match chance.below(6) {
            0 if !bytes.is_empty() => {
                let bit = chance.below(8);
                other[at] ^= 1 << bit;
                format!("bit {bit} of byte {at} turned")
            }
            1 => {
                other.truncate(at);
                format!("cut to {at} bytes")
            }
            2 => {
                other.extend(&bytes[at..]);
                format!("its end from byte {at} on once more")
            }
            3 if !bytes.is_empty() => {
                let end = (at + 1 + chance.below(5000)).min(bytes.len());
                other[at..end].fill(0);
                format!("zeros from byte {at} to {end}")
            }
            4 => {
                other.swap(at.min(bytes.len() - 1), bytes.len() / 2);
                format!("byte {at} swapped with the middle one")
            }
            _ => {
                fs::remove_file(path).unwrap();
                return "removed".to_owned();
            }
        };
        if other != bytes {
            fs::write(path, other).unwrap();
            return how;
        }
    }
}
