//! Runs on several ranks under the MPI launchers of this machine: the files are those of one process, and what cannot
//! run in several processes ends with one message and exit code 2.
//!
//! Launchers that are looked for: `mpirun.openmpi` and `mpirun.mpich` (Debian), else `mpirun`; and `bin/mpiexec` with
//! `lib/libmpi_abi.so.1` in the folder that the environment variable `MPI_ABI_FOLDER` names.
#![cfg(target_os = "linux")]

use crate::program::*;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const TEST_FOLDER: &str = "ranks";

/// Longest time until a launcher notices that a rank has died, or that all have ended.
const END_TIMEOUT: Duration = Duration::from_secs(300);

/// MPI launcher of this machine.
#[derive(Clone, Debug)]
pub(crate) struct Launcher {
    program: PathBuf,
    /// File of the MPI library, if it is not where the system looks for libraries.
    library: Option<PathBuf>,
    is_open_mpi: bool,
}

impl Launcher {
    /// Finds the launchers of this machine, and says what there is not.
    pub(crate) fn find_all() -> Vec<Self> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        let find = |name: &str| {
            std::env::split_paths(&path).map(|own| own.join(name)).find(|own| own.is_file())
        };
        let launcher = |program: PathBuf, library| {
            let version = Command::new(&program).arg("--version").output().ok()?;
            let version = String::from_utf8_lossy(&version.stdout).into_owned();
            let is_open_mpi = ["Open MPI", "OpenRTE"].iter().any(|own| version.contains(own));
            Some(Self { program, library, is_open_mpi })
        };
        let debian = ["mpirun.openmpi", "mpirun.mpich"].into_iter().filter_map(find);
        let mut programs: Vec<_> = debian.collect();
        if programs.is_empty() {
            programs.extend(find("mpirun"));
        }
        let mut launchers: Vec<_> =
            programs.into_iter().filter_map(|program| launcher(program, None)).collect();
        if let Some(folder) = std::env::var_os("MPI_ABI_FOLDER").map(PathBuf::from) {
            let library = folder.join("lib/libmpi_abi.so.1");
            launchers.extend(launcher(folder.join("bin/mpiexec"), Some(library)));
        }
        for family in ["Open MPI", "MPICH", "the standard interface"] {
            let is_found = launchers.iter().any(|own| match family {
                "Open MPI" => own.is_open_mpi,
                "MPICH" => !own.is_open_mpi && own.library.is_none(),
                _ => own.library.is_some(),
            });
            if !is_found {
                println!("skipped: no launcher of {family}");
            }
        }
        launchers
    }

    /// Creates a command that starts `ranks` processes of the program in a folder, with one thread each.
    pub(crate) fn create_command(&self, folder: &Path, ranks: usize, arguments: &str) -> Command {
        self.create_command_of(PROGRAM_PATH, folder, ranks, arguments)
    }

    /// Creates a command that starts `ranks` processes of another program, as [`create_command`](Self::create_command).
    fn create_command_of(
        &self,
        program: &str,
        folder: &Path,
        ranks: usize,
        arguments: &str,
    ) -> Command {
        let mut command = Command::new(&self.program);
        if self.is_open_mpi {
            command.args(["--allow-run-as-root", "--oversubscribe", "--bind-to", "none"]);
            // Ranks that wait leave the cores to others.
            command.env("OMPI_MCA_mpi_yield_when_idle", "1");
        }
        if let Some(library) = &self.library {
            command.env("WELLPOSED_MPI", library);
        }
        let count = ranks.to_string();
        command.args(["-n", &count, program]).args(arguments.split_whitespace());
        command.current_dir(folder).env("RAYON_NUM_THREADS", "1").stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn run(&self, folder: &Path, ranks: usize, arguments: &str) -> Output {
        wait_for_end(self.create_command(folder, ranks, arguments).spawn().unwrap())
    }

    /// Runs the program, which must end with `code`; returns standard output and the errors that it printed.
    pub(crate) fn run_with_exit_code(
        &self,
        code: i32,
        folder: &Path,
        ranks: usize,
        arguments: &str,
    ) -> (String, Vec<String>) {
        check_output(code, self.run(folder, ranks, arguments), arguments)
    }
}

fn check_output(code: i32, output: Output, arguments: &str) -> (String, Vec<String>) {
    let [stdout, stderr] =
        [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert_eq!(output.status.code(), Some(code), "{arguments}\n{stdout}\n{stderr}");
    let errors = stderr.lines().filter(|line| line.starts_with("error: "));
    (stdout, errors.map(str::to_owned).collect())
}

/// Waits for the end of a process; kills it after [`END_TIMEOUT`].
pub(crate) fn wait_for_end(child: Child) -> Output {
    let (id, start) = (child.id(), Instant::now());
    let (end, ended) = std::sync::mpsc::channel::<()>();
    let watch = std::thread::spawn(move || {
        if ended.recv_timeout(END_TIMEOUT) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-KILL", &id.to_string()]).status();
        }
    });
    let output = child.wait_with_output().unwrap();
    drop(end);
    watch.join().unwrap();
    assert!(start.elapsed() < END_TIMEOUT, "no end: {output:?}");
    output
}

/// Options of runs whose pictures are not compared: rank 0 draws them from the files that are.
pub(crate) const WITHOUT_PICTURES: &str = "--pictures none --animations none";

/// Returns the yielding solid without the numerical dissipation in its ledger, which takes one process.
fn solid_case() -> String {
    SOLID_CASE.replace("ledger = 'full'", "ledger = 'light'")
}

/// Yielding Cosserat solid in space.
const SPACE_CASE: &str = include_str!("data/program-space.toml");

/// Keys of the section `[output]`, the last one of the case, for small snapshots.
const SHORT_NUMBERS: &str = "snapshot_fields = ['v1', 'v2', 'v3', 'sigma13', 'm23']\nsnapshot_precision = 'f32'\nsnapshot_digits = 4\n";

#[test]
fn results_on_ranks_are_those_of_one_process() {
    let launchers = Launcher::find_all();
    let cases = [
        ("solid", solid_case().replace("duration = 0.15", "duration = 0.04"), "--animations none"),
        ("joints", JOINT_CASE.replace("duration = 6e-4", "duration = 2e-4"), WITHOUT_PICTURES),
        ("space", SPACE_CASE.to_owned(), WITHOUT_PICTURES),
        ("digits", format!("{SPACE_CASE}{SHORT_NUMBERS}"), WITHOUT_PICTURES),
    ];
    for (case_index, (name, text, options)) in cases.into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, name, &text);
        let (expected_output, _) = run_with_exit_code(
            0,
            &folder,
            &format!("run case.toml --out one --threads 2 {options}"),
        );
        let expected = read_result_files(&folder.join("one"));
        for (index, launcher) in launchers.iter().enumerate() {
            // Each launcher has all numbers of ranks over the cases.
            let ranks = [2, 3, 4][(case_index + index) % 3];
            let arguments = format!("run case.toml --out out{index} {options}");
            let (stdout, errors) = launcher.run_with_exit_code(0, &folder, ranks, &arguments);
            assert!(errors.is_empty(), "{errors:?}");
            let (stdout, waiting) = stdout.split_once("\nwaiting for messages").expect("a table");
            assert_eq!(waiting.lines().filter(|line| line.ends_with('%')).count(), ranks);
            let lines = stdout.replace(&format!("out{index}"), "one");
            let whole_lines = expected_output.lines().filter(|line| !line.contains("picture"));
            assert!(lines.lines().filter(|line| !line.contains("picture")).eq(whole_lines));
            let parts = list_parts(&folder.join(format!("out{index}")));
            assert!((0..ranks).all(|rank| parts.contains(&format!("fields-{rank:06}.part"))));
            run_with_exit_code(0, &folder, &format!("verify out{index}"));
            let (_, error) = run_with_exit_code(2, &folder, &format!("plot out{index}"));
            assert!(error.contains("wellposed gather"), "{error}");
            run_with_exit_code(0, &folder, &format!("gather out{index} {options}"));
            assert!(list_parts(&folder.join(format!("out{index}"))).is_empty());
            let found = read_result_files(&folder.join(format!("out{index}")));
            assert!(found.keys().eq(expected.keys()), "{launcher:?}");
            for (file, bytes) in found {
                assert!(bytes == expected[&file], "{launcher:?}, {ranks} ranks: {file}");
            }
        }
    }
}

#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn wrong_set_ups_end_with_one_message() {
    for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("wrong{index}"), &solid_case());
        let check = |launcher: &Launcher, ranks: usize, arguments: &str, part: &str| {
            let (stdout, errors) = launcher.run_with_exit_code(2, &folder, ranks, arguments);
            assert_eq!((stdout.as_str(), errors.len()), ("", 1), "{errors:?}");
            assert!(errors[0].contains(part), "{arguments}: {errors:?}");
        };
        let missing = PathBuf::from("/nowhere/libmpi.so");
        let without_library = Launcher { library: Some(missing), ..launcher.clone() };
        check(
            &without_library,
            2,
            "run case.toml",
            "no MPI library can be loaded; tried: /nowhere",
        );
        check(
            &launcher,
            2,
            "point case.toml",
            "works in one process, and the launcher has started 2",
        );
        check(&launcher, 2, "check case.toml", "the launcher has started 2; start it without");
        check(&launcher, 2, "run absent.toml", "absent.toml");
        check(&launcher, 2, "run --no-such-option", "--no-such-option");
        let full = "run case.toml --set scheme.ledger=\"full\"";
        check(&launcher, 2, full, "numerical dissipation in its ledger runs in one process");
        check(
            &launcher,
            4,
            "run case.toml --set grid.cells=[6,6] --set load=[] --set receiver=[]",
            "ranks for",
        );
        check(
            &launcher,
            2,
            "run case.toml --set parallel.parts=[3,1]",
            "parallel.parts: 3 × 1 parts for 2 ranks; expected numbers that multiply to 2",
        );
        // Another case or none at rank 1.
        fs::write(folder.join("other.toml"), solid_case().replace("1900", "1901")).unwrap();
        for (other, part) in
            [("other.toml", "rank 1 has another case"), ("absent.toml", "rank 1: absent.toml")]
        {
            let mut command = launcher.create_command(&folder, 1, "run case.toml");
            command.args([":", "-n", "1", PROGRAM_PATH, "run", other]);
            let output = wait_for_end(command.spawn().unwrap());
            let (_, errors) = check_output(2, output, other);
            assert!(errors.len() == 1 && errors[0].contains(part), "{errors:?}");
        }
        // Another program at rank 1: a byte behind the end of the file does not keep it from running.
        let changed = folder.join("changed");
        fs::copy(PROGRAM_PATH, &changed).unwrap();
        fs::OpenOptions::new().append(true).open(&changed).unwrap().write_all(b"\n").unwrap();
        let mut others = vec![(changed, "rank 1 has another program")];
        // An empty file system hides the results folder from rank 1.
        let private = Command::new("unshare").args(["-m", "true"]).stderr(Stdio::null()).status();
        if private.is_ok_and(|status| status.success()) {
            let shared = folder.join("shared");
            fs::create_dir_all(&shared).unwrap();
            let mount = format!("mount -t tmpfs none {} && exec \"$@\"", shared.display());
            let hidden =
                write_program(&folder, "hidden", &format!("unshare -m sh -c '{mount}' sh"));
            others.push((hidden, "the results folder of rank 0 is not visible here"));
        } else {
            println!("skipped: file systems of one rank");
        }
        for (other, part) in others {
            let arguments = "run case.toml --out shared/out";
            let mut command = launcher.create_command(&folder, 1, arguments);
            command.args([":", "-n", "1"]).arg(&other).args(arguments.split_whitespace());
            let (_, errors) = check_output(2, wait_for_end(command.spawn().unwrap()), part);
            assert!(errors.len() == 1 && errors[0].contains(part), "{errors:?}");
        }
        // Rank 1 does not see the folder of cases that rank 0 sees, or sees one where rank 0 has a case.
        fs::create_dir_all(folder.join("cases")).unwrap();
        fs::write(folder.join("cases/case.toml"), solid_case()).unwrap();
        for (own, other, part) in [
            ("cases", "absent", "rank 1: absent: "),
            ("cases", "case.toml", "rank 1: case.toml: "),
            ("case.toml", "cases", "works in one process, and the launcher has started 2"),
        ] {
            let mut command = launcher.create_command(&folder, 1, &format!("check {own}"));
            command.args([":", "-n", "1", PROGRAM_PATH, "check", other]);
            let (_, errors) = check_output(2, wait_for_end(command.spawn().unwrap()), other);
            assert!(errors.len() == 1 && errors[0].contains(part), "{errors:?}");
        }
        // One rank checks a case as without a launcher.
        launcher.run_with_exit_code(0, &folder, 1, "check case.toml --dry-run");
        assert!(!folder.join("out").exists());
    }
}

#[test]
fn maps_on_ranks_are_those_of_one_process() {
    let folder = create_case_folder(TEST_FOLDER, "map", "");
    // More ranks than chunks of points, or fewer.
    for (points, ranks) in [(31, 3), (4, 4)] {
        let setting = format!("--set map.x.points={points} --set map.y.points=9");
        let arguments =
            format!("map noncoaxiality-bound {setting} --growth-rate --pictures none --force");
        let (expected_output, _) =
            run_with_exit_code(0, &folder, &format!("{arguments} --out one --threads 2"));
        let expected = read_result_files(&folder.join("one"));
        for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
            let arguments = format!("{arguments} --out out{index}");
            let (stdout, errors) = launcher.run_with_exit_code(0, &folder, ranks, &arguments);
            assert!(errors.is_empty(), "{errors:?}");
            assert_eq!(stdout.replace(&format!("out{index}"), "one"), expected_output);
            assert!(read_result_files(&folder.join(format!("out{index}"))) == expected);
        }
    }
    for launcher in Launcher::find_all() {
        let arguments = "map noncoaxiality-bound --set background.density=-1 --set map.x.points=9";
        let (_, expected) = run_with_exit_code(2, &folder, arguments);
        let (_, errors) = launcher.run_with_exit_code(2, &folder, 3, arguments);
        assert_eq!(errors, [expected.trim_end()]);
        let (plan, _) =
            launcher.run_with_exit_code(0, &folder, 2, "map noncoaxiality-bound --dry-run");
        assert_eq!(plan.matches("would assess").count(), 1, "{plan}");
    }
}

#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn folders_are_checked_on_ranks_as_by_one_process() {
    let folder = create_case_folder(TEST_FOLDER, "check", "");
    let cases = folder.join("cases");
    fs::create_dir_all(&cases).unwrap();
    let (heat, _) = run_with_exit_code(0, &folder, "cases show heat");
    for (name, text) in [("a", heat.as_str()), ("b", "[model]\n"), ("c", &heat), ("d", &heat)] {
        fs::write(cases.join(format!("{name}.toml")), text).unwrap();
    }
    for format in ["text", "json"] {
        let arguments = format!("check cases --format {format}");
        let (expected, _) = run_with_exit_code(2, &folder, &arguments);
        for launcher in Launcher::find_all() {
            let (stdout, errors) = launcher.run_with_exit_code(2, &folder, 3, &arguments);
            assert_eq!(stdout, expected);
            let found = errors.iter().filter(|line| line.contains("1 of 4 cases cannot be read"));
            assert!(format == "json" || found.count() == 1, "{errors:?}");
        }
    }
    for launcher in Launcher::find_all() {
        let (_, errors) =
            launcher.run_with_exit_code(2, &folder, 2, "check cases --set model.no=1");
        assert!(errors.len() == 1 && errors[0].contains("model.no"), "{errors:?}");
    }
}

/// Verifies that the numbers of ranks of launchers are added to the table of times of one process.
#[test]
fn ranks_are_timed_beside_the_earlier_table() {
    let text = JOINT_CASE;
    for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("time{index}"), text);
        let arguments = "time case.toml --blocks 4,8 --steps 2 --pictures none";
        run_with_exit_code(0, &folder, arguments);
        let (text, _) = launcher.run_with_exit_code(0, &folder, 2, arguments);
        assert!(text.contains("ranks 2: processes of a launcher, t_cell "), "{text}");
        let table = fs::read_to_string(folder.join("out/case/time.csv")).unwrap();
        let rows: Vec<Vec<&str>> =
            table.lines().skip(1).map(|line| line.split(',').take(3).collect()).collect();
        assert_eq!(rows, [["1", "0", "4"], ["1", "0", "8"], ["2", "1", "4"], ["2", "1", "8"]]);
        let arguments = format!("{arguments} --ranks 2");
        let (_, errors) = launcher.run_with_exit_code(2, &folder, 2, &arguments);
        assert!(errors.len() == 1 && errors[0].contains("leave --ranks out"), "{errors:?}");
    }
}

/// Verifies that ranks have the parts that `split` plans, with and without given numbers of parts.
#[test]
fn ranks_have_the_planned_parts() {
    let launchers = Launcher::find_all();
    let Some(launcher) = launchers.first() else { return };
    let text = solid_case().replace("duration = 0.15", "duration = 0.01");
    for (name, setting) in [("least", ""), ("given", "--set parallel.parts=[1,4]")] {
        let folder = create_case_folder(TEST_FOLDER, name, &text);
        let arguments = format!("run case.toml --out out {WITHOUT_PICTURES} {setting}");
        launcher.run_with_exit_code(0, &folder, 4, &arguments);
        let arguments = format!("split case.toml --ranks 4 --format json --out plan {setting}");
        let (plan, _) = run_with_exit_code(0, &folder, &arguments);
        let plan: serde_json::Value = serde_json::from_str(&plan).unwrap();
        let index = fs::read_to_string(folder.join("out/snapshot-00000000.pvti")).unwrap();
        for row in plan["ranks"].as_array().unwrap() {
            let end = |axis: usize, end: usize| row["cells"][axis][end].as_u64().unwrap();
            let [[a, b], [c, d]] = [0, 1].map(|axis| [0, 1].map(|own| end(axis, own)));
            let extent = format!("Extent=\"{a} {b} {c} {d} ");
            assert!(index.contains(&extent), "{extent}\n{index}");
        }
    }
}

/// Lists the files in a folder that ranks have written for their own cells.
pub(crate) fn list_parts(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder).unwrap().map(|own| own.unwrap().file_name());
    let names = names.map(|name| name.to_string_lossy().into_owned());
    names.filter(|name| name.ends_with(".part") || name.ends_with(".pvti")).collect()
}

/// Returns the processes of the program in a folder.
pub(crate) fn find_processes(folder: &Path) -> Vec<u32> {
    let process = |entry: fs::DirEntry| {
        let path = entry.path();
        let id = entry.file_name().to_str()?.parse().ok()?;
        let is_own = fs::read_link(path.join("exe")).ok()? == Path::new(PROGRAM_PATH)
            && fs::read_link(path.join("cwd")).ok()? == folder;
        is_own.then_some(id)
    };
    fs::read_dir("/proc").unwrap().filter_map(Result::ok).filter_map(process).collect()
}

#[test]
fn a_killed_rank_ends_the_others_and_the_run_resumes() {
    let Some(expected) = Launcher::find_all().first().map(|_| {
        let folder = create_case_folder(TEST_FOLDER, "whole", &solid_case());
        run_with_exit_code(
            0,
            &folder,
            &format!("run case.toml --threads 1 {WITHOUT_PICTURES} --out out"),
        );
        read_result_files(&folder.join("out"))
    }) else {
        return;
    };
    for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("killed{index}"), &solid_case());
        let arguments = format!("run case.toml --out out --checkpoint-every 0 {WITHOUT_PICTURES}");
        let mut command = launcher.create_command(&folder, 3, &arguments);
        // Messages of the launcher must not fill a pipe.
        let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        wait_for_file(&folder.join("out/snapshot-00000003.pvti"));
        let processes = find_processes(&fs::canonicalize(&folder).unwrap());
        assert_eq!(processes.len(), 3);
        let killed = processes[index % 3].to_string();
        assert!(Command::new("kill").args(["-KILL", &killed]).status().unwrap().success());
        let output = wait_for_end(child);
        assert!(!output.status.success());
        assert!(find_processes(&fs::canonicalize(&folder).unwrap()).is_empty());
        // Another number of ranks, or one process.
        match index {
            0 => {
                let arguments = format!("resume out --threads 2 {WITHOUT_PICTURES}");
                drop(run_with_exit_code(0, &folder, &arguments));
            }
            _ => {
                let arguments = format!("resume out {WITHOUT_PICTURES}");
                drop(launcher.run_with_exit_code(0, &folder, 2, &arguments));
                run_with_exit_code(0, &folder, &format!("gather out {WITHOUT_PICTURES}"));
            }
        }
        assert!(read_result_files(&folder.join("out")) == expected, "{launcher:?}");
    }
}

/// Verifies that the results of a run that stops at a value that is not finite do not depend on the checkpoint from which
/// the last valid state is searched, in one process and on ranks.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn stopped_runs_have_the_same_results_with_and_without_checkpoints() {
    // The phase of the sine overflows, after at least one batch of steps.
    let load = "[[load]]\nside = 'x1+'\nfield = 'v1'\namplitude = 1\n\
                time = { kind = 'sine', frequency = 1e308, start = 0.1 }\n";
    let case = solid_case().replace("[[receiver]]", &format!("{load}[[receiver]]"));
    let arguments = |interval: f64| {
        format!(
            "run case.toml --out out --checkpoint-every {interval} {WITHOUT_PICTURES} --threads 1"
        )
    };
    let stop = |name: &str, interval: f64| {
        let folder = create_case_folder(TEST_FOLDER, name, &case);
        run_with_exit_code(3, &folder, &arguments(interval));
        let log = fs::read_to_string(folder.join("out/log.txt")).unwrap();
        assert_eq!(log.contains("checkpoint at step"), interval == 0.0, "{log}");
        read_result_files(&folder.join("out"))
    };
    let expected = stop("stopped", 1e6);
    assert!(stop("stopped-checkpoints", 0.0) == expected);
    for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("stopped{index}"), &case);
        drop(launcher.run_with_exit_code(3, &folder, 3, &arguments(0.0)));
        run_with_exit_code(0, &folder, &format!("gather out {WITHOUT_PICTURES}"));
        assert!(read_result_files(&folder.join("out")) == expected, "{launcher:?}");
    }
}

/// Kills one rank at a random moment, and resumes with another number of ranks or in one process, which another kill may
/// interrupt.
#[test]
#[ignore = "twenty killed runs; part of .ci/long"]
fn runs_whose_ranks_are_killed_at_any_moment_resume_with_the_same_results() {
    let launchers = Launcher::find_all();
    let Some(launcher) = launchers.first() else { return };
    let cases = [solid_case(), JOINT_CASE.replace("duration = 6e-4", "duration = 3e-4")];
    let mut state = 0x2545_f491_4f6c_dd1d_u64;
    let mut random = move |count: u64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state % count
    };
    for (case_index, text) in cases.into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("moments{case_index}"), &text);
        let arguments = format!("run case.toml --threads 1 {WITHOUT_PICTURES} --out one");
        let start = Instant::now();
        run_with_exit_code(0, &folder, &arguments);
        let duration = start.elapsed();
        let expected = read_result_files(&folder.join("one"));
        for trial in 0..10 {
            let out = folder.join("out");
            let _ = fs::remove_dir_all(&out);
            let options = format!("--checkpoint-every 0 {WITHOUT_PICTURES}");
            let mut arguments = format!("run case.toml --out out {options}");
            for kill in 0..2 {
                let ranks = 2 + (trial + kill) % 3;
                let mut command = launcher.create_command(&folder, ranks, &arguments);
                let child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
                std::thread::sleep(duration.mul_f64(random(1500) as f64 / 1000.0));
                let processes = find_processes(&fs::canonicalize(&folder).unwrap());
                if let Some(process) = processes.get(random(4) as usize % processes.len().max(1)) {
                    // The run may have finished meanwhile.
                    let _ = Command::new("kill").args(["-KILL", &process.to_string()]).status();
                }
                let _ = wait_for_end(child);
                if out.join("case.toml").exists() {
                    arguments = format!("resume out {options}");
                }
            }
            if !out.join("run.json").exists() {
                match trial % 2 {
                    0 => drop(run_with_exit_code(0, &folder, &arguments)),
                    _ => drop(launcher.run_with_exit_code(0, &folder, 4, &arguments)),
                }
            }
            run_with_exit_code(0, &folder, &format!("gather out {WITHOUT_PICTURES}"));
            assert!(read_result_files(&out) == expected, "case {case_index}, trial {trial}");
            run_with_exit_code(0, &folder, "verify out");
        }
    }
}

/// Verifies that a run that one process refuses within a limit of its address space completes on four ranks with the same
/// limit each, results included.
#[test]
#[ignore = "a gigabyte in four processes; part of .ci/long"]
fn ranks_complete_a_run_that_exceeds_the_memory_of_one() {
    let launchers = Launcher::find_all();
    let Some(launcher) = launchers.first() else { return };
    let load = "[[load]]\nside = 'x2+'\nfield = 'sigma22'\namplitude = -1e6\n\
                time = { kind = 'pulse', duration = 1e-3 }\n";
    // 864 MB of fields, 216 MB per rank; two steps. MPI libraries take 350 MiB of addresses.
    let text = SPACE_CASE.split("[yield]").next().expect("a model").replace("dimensions = 3\n", "")
        + "[grid]\ncells = [3000, 3000]\nspacing = 0.5\n[time]\nduration = 1e-3\n"
        + load;
    let folder = create_case_folder(TEST_FOLDER, "memory", &text);
    let limited = write_limited_program(&folder, 900_000);
    let arguments = format!("run case.toml --out out {WITHOUT_PICTURES}");
    let mut single = Command::new(&limited);
    single.args(arguments.split_whitespace()).current_dir(&folder).stderr(Stdio::piped());
    let (_, errors) = check_output(2, wait_for_end(single.spawn().unwrap()), &arguments);
    assert!(errors[0].contains("the limit of the address space"), "{errors:?}");
    let limited = limited.to_str().expect("text");
    let command = launcher.create_command_of(limited, &folder, 4, &arguments).spawn();
    check_output(0, wait_for_end(command.unwrap()), &arguments);
    run_with_exit_code(0, &folder, "verify out");
}

/// Writes a program that limits its address space, KiB, and becomes the program under test; returns its path.
fn write_limited_program(folder: &Path, limit: usize) -> PathBuf {
    write_program(folder, "limited", &format!("ulimit -v {limit}; exec"))
}

/// Writes a program that starts the program under test by a shell command; returns its path.
fn write_program(folder: &Path, name: &str, command: &str) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join(name);
    fs::write(&path, format!("#!/bin/sh\n{command} {PROGRAM_PATH} \"$@\"\n")).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path
}

/// Verifies that all ranks end, with the message of the first one, if rank 1 has no memory for its part.
#[test]
#[ignore = "large grids under a limit that MPI libraries nearly exhaust; part of .ci/long"]
fn a_rank_without_memory_ends_the_others() {
    for (index, launcher) in Launcher::find_all().into_iter().enumerate() {
        let folder = create_case_folder(TEST_FOLDER, &format!("limited{index}"), JOINT_CASE);
        let limited = write_limited_program(&folder, 400_000);
        let limited = limited.to_str().expect("text");
        let blocks = "--set block[0].repeat=[320,200] --set time.duration=1e-6";
        for arguments in [
            format!("run case.toml --out out {WITHOUT_PICTURES} --threads 1 {blocks}"),
            "time case.toml --blocks 250 --steps 2 --pictures none --out time".to_owned(),
        ] {
            let mut command = launcher.create_command(&folder, 1, &arguments);
            command.args([":", "-n", "1", limited]).args(arguments.split_whitespace());
            let (_, errors) = check_output(2, wait_for_end(command.spawn().unwrap()), &arguments);
            // Threads with large stacks cannot be started either.
            let is_named = |error: &String| {
                ["memory", "cannot start the threads"].iter().any(|part| error.contains(part))
            };
            assert!(errors.iter().any(is_named), "{errors:?}");
        }
    }
}
