//! Tests of the program as a process: verbs, exit codes, results folders, mutated files.

use crate::mutation::{generate_mutants, shrink_map_grid};
use crate::program::{
    PROGRAM_PATH, SOLID_CASE, create_case_folder, create_folder, list_entries, run_with_exit_code,
};
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use wellposed::CASES;
use wellposed::case::{Case, ModelKind, TimeDomainRun};
use wellposed::cli::folder::result_file_names;

const TEST_FOLDER: &str = "command_line";

#[test]
fn usage_errors_exit_with_2_and_help_with_0() {
    let here = create_folder(TEST_FOLDER, "usage");
    for arguments in [
        "",
        "plot",
        "map",
        "map a.toml --format xml",
        "point a.toml --threads 0",
        "point a.toml --bound",
        "new granite",
    ] {
        let (stdout, stderr) = run_with_exit_code(2, &here, arguments);
        assert!(stdout.is_empty(), "{arguments}: {stdout}");
        assert!(stderr.contains("Usage:") || stderr.contains("error:"), "{arguments}: {stderr}");
    }
    for arguments in ["--help", "map --help", "point --help", "new --help"] {
        assert!(run_with_exit_code(0, &here, arguments).0.contains("Usage:"));
    }
    assert!(list_entries(&here).is_empty());
}

#[test]
fn version_contains_commit() {
    let (stdout, _) = run_with_exit_code(0, &create_folder(TEST_FOLDER, "version"), "--version");
    let (version, commit) = stdout.trim_end().split_once(" (").unwrap();
    assert_eq!(version, concat!("wellposed ", env!("CARGO_PKG_VERSION")));
    let commit = commit.strip_suffix(')').unwrap();
    let is_hash = commit.len() >= 9 && commit.bytes().all(|byte| byte.is_ascii_hexdigit());
    assert!(is_hash || commit == "unknown", "{commit}");
}

#[test]
fn cases_are_listed_with_their_titles() {
    let (stdout, _) = run_with_exit_code(0, &create_folder(TEST_FOLDER, "cases"), "cases");
    assert_eq!(stdout.lines().count(), CASES.len());
    for (line, (path, text)) in stdout.lines().zip(CASES) {
        let title = Case::parse(text, path, &[]).unwrap().title;
        assert!(line.starts_with(path) && line.ends_with(&title), "{line}");
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
        assert_eq!(fs::read_to_string(file).unwrap(), *text, "{path}");
    }
}

/// Verifies the files of every bundled case, of simulations after the first 1 % of the duration and of flows on 64 × 64
/// points at most.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn every_bundled_case_runs() {
    let here = create_folder(TEST_FOLDER, "bundled");
    for (path, text) in CASES {
        let name = Path::new(path).file_name().unwrap().to_str().unwrap();
        fs::write(here.join(name), shrink_map_grid(text)).unwrap();
        let case = Case::load(&here.join(name), &[]).unwrap();
        let start = |duration: f64| ("run", vec![format!("time.duration={:e}", 0.01 * duration)]);
        let (verb, sets) = match case.time_domain_run() {
            Ok(TimeDomainRun::Solid(own)) => start(own.time.duration),
            Ok(TimeDomainRun::Flow(own)) => {
                let (verb, mut sets) = start(own.time.duration);
                if own.grid.points.iter().any(|points| *points > 64) {
                    // The finest waves that this grid resolves.
                    sets.extend(["grid.cells=[64,64]", "initial[0].to=21"].map(String::from));
                }
                (verb, sets)
            }
            Err(_) if case.plane_wave.is_some() => ("shocks", Vec::new()),
            Err(_) if case.rheology.is_some() => ("diagram", Vec::new()),
            Err(_) if text.contains("[map]") => ("map", Vec::new()),
            Err(_) if text.contains("[background]") || case.equations.is_some() => {
                ("point", Vec::new())
            }
            Err(_) => ("dispersion", Vec::new()),
        };
        let ill_posed = if case.flow_run.is_some() { " --accept-ill-posed" } else { "" };
        // Frames of animations are drawn as the other pictures are.
        let pictures = if verb == "run" { " --animations none" } else { "" };
        let options: String = sets.iter().map(|set| format!(" --set {set}")).collect();
        let (stdout, _) =
            run_with_exit_code(0, &here, &format!("{verb} {name}{options}{ill_posed}{pictures}"));
        assert!(!stdout.is_empty());
        let out = here.join("out").join(name.trim_end_matches(".toml"));
        let case = Case::load(&here.join(name), &sets).unwrap();
        assert_eq!(fs::read_to_string(out.join("case.toml")).unwrap(), case.to_toml());
        let program = fs::read_to_string(out.join("program.json")).unwrap();
        let program: serde_json::Value = serde_json::from_str(&program).unwrap();
        assert_eq!(program["name"], "wellposed");
        assert_eq!(program["version"], env!("CARGO_PKG_VERSION"));
        assert!(program["commit"].is_string());
    }
}

/// Verifies that verbs read former names of sections and print a warning with file and line.
#[test]
fn former_names_print_a_warning() {
    let case = SOLID_CASE.replace("[[boundary]]", "[[side]]");
    let here = create_case_folder(TEST_FOLDER, "former-names", &case);
    let line = 1 + case.lines().position(|line| line == "[[side]]").unwrap();
    let hint = "[[side]] is now [[boundary]]; the old name is read for one more version";
    for verb in ["run", "check", "dispersion", "speeds"] {
        let (_, stderr) = run_with_exit_code(0, &here, &format!("{verb} case.toml --dry-run"));
        let warning = format!("warning: case.toml:{line}: {hint}");
        assert_eq!(stderr.lines().filter(|line| *line == warning).count(), 1, "{verb}: {stderr}");
    }
    fs::write(here.join("case.toml"), SOLID_CASE).unwrap();
    let set = "side[0].kind=free";
    let (_, stderr) = run_with_exit_code(0, &here, &format!("run case.toml --dry-run --set {set}"));
    assert!(stderr.contains(&format!("warning: --set {set}: {hint}\n")), "{stderr}");
}

/// Verifies that a number that the map varies anyway is not set without a word.
#[test]
fn settings_of_varied_numbers_print_a_warning() {
    let here = create_case_folder(TEST_FOLDER, "varied-numbers", "");
    let set = "model.friction_angle_deg=40";
    let command =
        format!("map noncoaxiality-bound --dry-run --set {set} --set background.pressure=2000");
    let (_, stderr) = run_with_exit_code(0, &here, &command);
    let warning =
        format!("warning: --set {set}: no effect, since map.y varies model.friction_angle_deg\n");
    assert!(stderr.contains(&warning) && stderr.matches("warning").count() == 1, "{stderr}");
}

#[test]
fn new_overwrites_existing_case_only_with_force() {
    let here = create_folder(TEST_FOLDER, "new");
    for kind in ModelKind::all_kinds().into_iter().chain(ModelKind::WITHOUT_ENTRY) {
        let verbs: &[&str] = match kind {
            ModelKind::Flow(_) => &["point", "map"],
            ModelKind::Solid(_) => &["dispersion"],
            ModelKind::Rheology => &["diagram"],
            ModelKind::Equations => &["point", "map", "check"],
        };
        let kind = kind.name();
        let (_, stderr) = run_with_exit_code(0, &here, &format!("new {kind}"));
        assert!(stderr.contains(&format!("{kind}.toml")));
        for verb in verbs {
            run_with_exit_code(0, &here, &format!("{verb} {kind}.toml --dry-run"));
        }

        fs::write(here.join(format!("{kind}.toml")), "mine").unwrap();
        let (_, stderr) = run_with_exit_code(2, &here, &format!("new {kind}"));
        assert!(stderr.contains("exists already") && stderr.contains("--force"), "{stderr}");
        assert_eq!(fs::read_to_string(here.join(format!("{kind}.toml"))).unwrap(), "mine");
        run_with_exit_code(0, &here, &format!("new {kind} --force"));
        assert_ne!(fs::read_to_string(here.join(format!("{kind}.toml"))).unwrap(), "mine");
    }
    run_with_exit_code(0, &here, "new free-rotating other.toml");
    run_with_exit_code(2, &here, "new free-rotating other.toml/below.toml");
    assert_eq!(list_entries(&here).len(), 12, "{:?}", list_entries(&here));

    // Templates name the schema for editors, which lies beside them; one of another version is replaced.
    let template = fs::read_to_string(here.join("other.toml")).unwrap();
    assert!(template.starts_with("#:schema ./wellposed.schema.json\n# Analysis"), "{template}");
    let (schema, _) = run_with_exit_code(0, &here, "schema");
    let beside = here.join("wellposed.schema.json");
    assert_eq!(fs::read_to_string(&beside).unwrap(), schema);
    fs::write(&beside, "{}").unwrap();
    run_with_exit_code(0, &here, "new rheology scheme.toml");
    assert_eq!(fs::read_to_string(&beside).unwrap(), schema);
}

#[test]
fn invalid_requests_exit_with_2_and_write_nothing() {
    let here = create_folder(TEST_FOLDER, "bad");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    fs::write(here.join("file"), "").unwrap();
    fs::create_dir(here.join("full")).unwrap();
    fs::write(here.join("full/notes"), "").unwrap();
    let before = list_entries(&here);
    for (arguments, expected) in [
        ("map absent.toml", "error: absent.toml: no such file"),
        ("point .", "error: .: "),
        ("point case.toml --set background.presure=1", "error: --set background.presure=1: "),
        ("point case.toml --set model.friction_angle_deg=90", "--set model.friction_angle_deg=90"),
        ("map case.toml --set map.x.points=100000000", "at most 100000000 points"),
        ("map case.toml --set map.x.parameter=background.nothing", "'background.nothing'"),
        ("point case.toml --out file", "error: file: "),
        ("point case.toml --out file/below", "error: file"),
        ("point case.toml --out file/below --dry-run", "error: file"),
        ("point case.toml --out .", "./case.toml: this is the case file itself"),
        ("point case.toml --out . --force", "name another folder with --out"),
        ("point case.toml --out full", "--force"),
    ] {
        let (stdout, stderr) = run_with_exit_code(2, &here, arguments);
        assert!(stderr.contains(expected), "{arguments}: {stderr}");
        assert_eq!((stdout.as_str(), stderr.lines().count()), ("", 1), "{arguments}: {stderr}");
        assert_eq!(list_entries(&here), before, "{arguments}");
    }
}

#[test]
fn dry_run_writes_nothing() {
    let here = create_folder(TEST_FOLDER, "dry");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    for verb in ["map", "point"] {
        let (stdout, _) = run_with_exit_code(0, &here, &format!("{verb} case.toml --dry-run"));
        assert!(stdout.contains("out/case"), "{stdout}");
    }
    assert_eq!(list_entries(&here), ["case.toml", "wellposed.schema.json"]);
}

#[test]
fn results_of_another_case_are_overwritten_only_with_force() {
    let here = create_folder(TEST_FOLDER, "force");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    let point = "point case.toml --out results";
    run_with_exit_code(0, &here, point);
    // The same case may be repeated, also if its results folder contains results of a map.
    run_with_exit_code(0, &here, point);
    fs::write(here.join("results/map.csv"), "of the first case").unwrap();
    fs::write(here.join("results/notes"), "of the user").unwrap();
    run_with_exit_code(0, &here, point);
    assert_eq!(fs::read(here.join("results/map.csv")).unwrap(), b"of the first case");

    let other = format!("{point} --set background.pressure=2000");
    let (_, stderr) = run_with_exit_code(2, &here, &other);
    assert!(stderr.contains("results: ") && stderr.contains("--force"), "{stderr}");
    let resolved_case = fs::read_to_string(here.join("results/case.toml")).unwrap();
    assert!(resolved_case.contains("pressure = 1000.0"), "{resolved_case}");

    run_with_exit_code(0, &here, &format!("{other} --force"));
    let resolved_case = fs::read_to_string(here.join("results/case.toml")).unwrap();
    assert!(resolved_case.contains("pressure = 2000.0"), "{resolved_case}");
    assert!(!here.join("results/map.csv").exists(), "a stale result stands beside another case");
    assert!(here.join("results/notes").exists(), "a file of the user is gone");

    // A non-empty folder without results is refused, too.
    fs::create_dir(here.join("full")).unwrap();
    fs::write(here.join("full/notes"), "").unwrap();
    run_with_exit_code(2, &here, "point case.toml --out full");
    fs::create_dir(here.join("empty")).unwrap();
    run_with_exit_code(0, &here, "point case.toml --out empty");
}

/// Verifies that unwritable folders are detected by writing: no file can be created in /proc, although its permission
/// bits allow it.
#[cfg(target_os = "linux")]
#[test]
fn unwritable_folder_is_refused_before_computation() {
    let here = create_folder(TEST_FOLDER, "unwritable");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    std::os::unix::fs::symlink("nowhere", here.join("link")).unwrap();
    for (arguments, start) in [
        ("--out /proc/absent/below", "error: /proc/absent/below: "),
        ("--out /proc/self --force", "error: /proc/self: "),
        ("--out link", "error: link: "),
    ] {
        for verb in ["map", "point"] {
            let (_, stderr) =
                run_with_exit_code(2, &here, &format!("{verb} case.toml --dry-run {arguments}"));
            assert!(stderr.starts_with(start), "{stderr}");
        }
    }
    assert_eq!(list_entries(&here), ["case.toml", "link", "wellposed.schema.json"]);
}

#[test]
fn partial_files_of_killed_run_are_removed() {
    let here = create_folder(TEST_FOLDER, "killed");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    fs::create_dir(here.join("results")).unwrap();
    for name in [".case.toml.7.partial", ".map.png.123.partial", ".probe.5-0.partial"] {
        fs::write(here.join("results").join(name), "half").unwrap();
    }
    run_with_exit_code(0, &here, "point case.toml --out results --dry-run");
    assert_eq!(list_entries(&here.join("results")).len(), 3);
    run_with_exit_code(0, &here, "point case.toml --out results");
    let entries = list_entries(&here.join("results"));
    assert!(
        entries.len() > 3 && entries.iter().all(|name| !name.ends_with(".partial")),
        "{entries:?}"
    );

    // Partial files with other names are not removed.
    for name in [".notes.7.partial", ".map.png.partial", "map.png.7.partial", ".map.png.x.partial"]
    {
        let other = here.join("other");
        fs::create_dir(&other).unwrap();
        fs::write(other.join(name), "").unwrap();
        run_with_exit_code(2, &here, "point case.toml --out other");
        run_with_exit_code(0, &here, "point case.toml --out other --force");
        assert!(other.join(name).exists(), "{name} is gone");
        fs::remove_dir_all(&other).unwrap();
    }
}

#[test]
fn case_file_is_never_overwritten() {
    let here = create_folder(TEST_FOLDER, "itself");
    for (name, out) in [("results/case.toml", "results"), ("results/map.txt", "results/../results")]
    {
        fs::create_dir_all(here.join("results")).unwrap();
        run_with_exit_code(0, &here, &format!("new harris-grekova {name}"));
        let before = fs::read(here.join(name)).unwrap();
        for force in ["", "--force", "--dry-run --force"] {
            for verb in ["map", "point"] {
                let arguments = format!("{verb} {name} --out {out} {force}");
                let (_, stderr) = run_with_exit_code(2, &here, &arguments);
                assert!(stderr.contains("the case file itself"), "{stderr}");
                assert!(stderr.contains("name another folder with --out\n"), "{stderr}");
                assert_eq!(fs::read(here.join(name)).unwrap(), before);
            }
        }
        assert_eq!(list_entries(&here.join("results")).len(), 2);
        fs::remove_dir_all(here.join("results")).unwrap();
    }
}

#[test]
fn resolved_case_gives_bit_identical_results() {
    let here = create_folder(TEST_FOLDER, "again");
    let text = wellposed::cli::new::generate_state_template(
        ModelKind::from_name("double-shearing").expect("a kind"),
    );
    let text: String =
        text.lines().filter(|l| !l.starts_with("title")).map(|l| format!("{l}\n")).collect();
    fs::write(here.join("untitled.toml"), text).unwrap();
    let bits = |folder: &str| {
        let read = |name: String| (fs::read(here.join(folder).join(&name)).unwrap(), name);
        list_entries(&here.join(folder)).into_iter().map(read).collect::<Vec<_>>()
    };
    run_with_exit_code(0, &here, "point untitled.toml");
    let first = bits("out/untitled");
    // Run the resolved case with results in its own folder, where the case file is not rewritten, and in another
    // folder.
    let written = || fs::metadata(here.join("out/untitled/case.toml")).unwrap().modified().unwrap();
    let before = written();
    let (stdout, _) = run_with_exit_code(0, &here, "point out/untitled/case.toml");
    assert!(stdout.contains("out/untitled"), "{stdout}");
    assert_eq!(written(), before);
    run_with_exit_code(0, &here, "point out/untitled/case.toml --out elsewhere");
    assert!(bits("out/untitled") == first && bits("elsewhere") == first);
    // A case that was edited or is changed by an option is refused, since it would overwrite its file.
    run_with_exit_code(
        2,
        &here,
        "point out/untitled/case.toml --force --set background.pressure=7",
    );
    assert!(bits("out/untitled") == first);
}

#[test]
fn results_of_another_version_are_overwritten_only_with_force() {
    let here = create_folder(TEST_FOLDER, "version_of_results");
    run_with_exit_code(0, &here, "new harris-grekova case.toml");
    let point = "point case.toml --out results";
    let program = here.join("results/program.json");
    for key in ["version", "commit"] {
        run_with_exit_code(0, &here, point);
        fs::write(here.join("results/map.csv"), "of the old program").unwrap();
        let original = fs::read_to_string(&program).unwrap();
        let mut other: serde_json::Value = serde_json::from_str(&original).unwrap();
        other[key] = "another".into();
        fs::write(&program, format!("{other:#}\n")).unwrap();
        let (_, stderr) = run_with_exit_code(2, &here, point);
        assert!(stderr.contains("another version") && stderr.contains("--force"), "{stderr}");
        run_with_exit_code(0, &here, &format!("{point} --force"));
        assert_eq!(fs::read_to_string(&program).unwrap(), original);
        assert!(!here.join("results/map.csv").exists(), "an old result under a new version");
    }
    // A folder without the file of the program version is refused, too, unless it has no results yet.
    fs::remove_file(&program).unwrap();
    run_with_exit_code(2, &here, point);
    fs::create_dir(here.join("early")).unwrap();
    fs::copy(here.join("results/case.toml"), here.join("early/case.toml")).unwrap();
    run_with_exit_code(0, &here, "point case.toml --out early");
}

#[test]
fn shell_completions_are_printed() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (stdout, _) = run_with_exit_code(
            0,
            &create_folder(TEST_FOLDER, "completions"),
            &format!("completions {shell}"),
        );
        assert!(stdout.contains("wellposed") && stdout.contains("dry-run"), "{shell}");
    }
}

#[test]
fn closed_pipe_exits_with_0() {
    for arguments in [&["cases"][..], &["completions", "bash"], &["--help"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let output = Command::new(PROGRAM_PATH).args(arguments).stdout(writer).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn full_device_exits_with_2() {
    let full = File::options().write(true).open("/dev/full").unwrap();
    let output = Command::new(PROGRAM_PATH).arg("cases").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: standard output: "));
}

/// Runs a mutant; returns whether it was computed, or a description of a wrong reaction.
fn run_mutant(folder: &Path, index: usize, mutant: &[u8]) -> Result<bool, String> {
    // Time after which a hanging process is killed; generous, since the machine may be busy.
    const TIME_LIMIT: Duration = Duration::from_secs(20);
    let (case, log) = (folder.join(format!("{index}.toml")), folder.join(format!("{index}.log")));
    let out = folder.join(format!("{index}"));
    fs::write(&case, mutant).unwrap();
    let start = Instant::now();
    let mut child = Command::new(PROGRAM_PATH)
        .arg(["point", "map", "point", "map", "dispersion"][index % 5])
        .arg(&case)
        .args(["--threads", "1", "--out"])
        .arg(&out)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(&log).unwrap())
        .spawn()
        .unwrap();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > TIME_LIMIT {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err(format!("not done after {TIME_LIMIT:?}"));
        }
        std::thread::sleep(Duration::from_millis(1));
    };
    let message = String::from_utf8_lossy(&fs::read(&log).unwrap()).into_owned();
    let entries = list_entries(&out);
    match status.code() {
        _ if message.contains("panicked") => Err(message),
        Some(0) => {
            let is_known = |name: &String| {
                result_file_names().any(|known| known == name) || *name == "program.json"
            };
            match entries.iter().find(|name| !is_known(name) && *name != "case.toml") {
                Some(name) => Err(format!("{name} was left behind")),
                None if !entries.iter().any(|name| name == "case.toml") => {
                    Err("no results were written".into())
                }
                None => Ok(true),
            }
        }
        Some(2) if !entries.is_empty() => Err(format!("refused, but wrote {entries:?}")),
        Some(2) if !message.starts_with("error: ") || message.lines().count() != 1 => {
            Err(format!("not one message: {message}"))
        }
        Some(2) => Ok(false),
        code => Err(format!("exit code {code:?}: {message}")),
    }
}

/// Verifies every verb of [`run_mutant`] with some thirty mutants or more.
#[test]
fn mutants_are_run_or_refused() {
    check_mutants("mutants", 160);
}

#[test]
#[ignore = "takes minutes"]
fn two_thousand_mutants_are_run_or_refused() {
    check_mutants("more-mutants", 2000);
}

/// Checks that the first `count` mutants are run or refused.
fn check_mutants(name: &str, count: usize) {
    const THREAD_COUNT: usize = 2;
    let here = create_folder(TEST_FOLDER, name);
    let mutants: Vec<Vec<u8>> = generate_mutants(2).take(count).collect();
    let run = |thread: usize| {
        let (mut done, mut failures) = (0, Vec::new());
        for index in (thread..count).step_by(THREAD_COUNT) {
            match run_mutant(&here, index, &mutants[index]) {
                Ok(was_done) => done += usize::from(was_done),
                Err(message) => {
                    let text = String::from_utf8_lossy(&mutants[index]);
                    failures.push(format!("mutant {index}: {message}\n{text}"));
                }
            }
        }
        (done, failures)
    };
    let (done, failures) = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..THREAD_COUNT).map(|i| scope.spawn(move || run(i))).collect();
        let results = threads.into_iter().map(|thread| thread.join().unwrap());
        results.fold((0, Vec::new()), |(done, mut failures), (more, others)| {
            failures.extend(others);
            (done + more, failures)
        })
    });
    println!("{done} of {count} mutants were run to the end, the others refused");
    assert!(failures.is_empty(), "{} failures\n{}", failures.len(), failures[0]);
    // The mutants test little if nearly all or nearly none of them are refused.
    assert!(done > count / 20 && done < count * 3 / 4, "{done} of {count} were run");
}
