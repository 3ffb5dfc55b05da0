//! Tests of time-domain flows through the program: decay and growth as assessed, results independent of the number of
//! threads and of interruptions, and the files of a run.

use files::npz::{Array, Values, read};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use wellposed::case::Case;
use wellposed::cli::{self, Control};
use wellposed::cli::{Error, Options};
use wellposed::report::format::short;

const PROGRAM: &str = env!("CARGO_BIN_EXE_wellposed");
const CONTROL: Control = Control { checkpoint_every: 1e9 };

/// Case of a flow in simple shear with an initial noise perturbation.
fn case(model: &str, background: &str, duration: f64, rest: &str) -> String {
    format!(
        "[model]
        friction_angle_deg = 30
        {model}
        [background]
        density = 1600
        pressure = 1000
        stress_angle_deg = 45
        {background}
        [grid]
        cells = [32, 32]
        length = 0.1
        [time]
        duration = {duration:?}
        [[initial]]
        kind = 'noise'
        field = 'v'
        from = 1
        to = 8
        amplitude = 1e-5
        seed = 3
        {rest}"
    )
}

const SPINNING: &str =
    "kind = 'harris-grekova'\nmoment_of_inertia = 1.25e-7\nrotational_strength = 0";

fn decaying(rest: &str) -> String {
    case(SPINNING, "shear_rate = 50\nhalf_vorticity = -50\nnoncoaxiality_deg = 20", 1e-3, rest)
}

const RECORDED: &str = "
[[receiver]]
name = 'middle'
at = [0.05, 0.05]
[[receiver]]
at = [0.1, 0.02]
fields = ['psi_deg', 'v2']
[output]
snapshot_interval = 2.5e-4
";

fn carried_out(folder: &Path, case: &str, threads: usize) -> Result<String, Error> {
    let file = folder.join("case.run.toml");
    fs::write(&file, case).unwrap();
    let out = Some(folder.join("out"));
    let options = Options {
        case: file,
        out,
        force: true,
        threads: Some(threads),
        accept_ill_posed: true,
        ..Options::default()
    };
    let mut stdout = Vec::new();
    cli::run(&options, CONTROL, &mut stdout)?;
    Ok(String::from_utf8(stdout).unwrap())
}

fn columns(path: &Path) -> Vec<(String, Vec<f64>)> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines();
    let header = lines.next().unwrap().split(',');
    let mut columns: Vec<(String, Vec<f64>)> =
        header.map(|name| (name.to_owned(), Vec::new())).collect();
    for line in lines {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            column.1.push(cell.parse().unwrap());
        }
    }
    columns
}

fn column(columns: &[(String, Vec<f64>)], name: &str) -> Vec<f64> {
    columns.iter().find(|column| column.0 == name).unwrap().1.clone()
}

fn arrays(folder: &Path) -> Vec<Array> {
    read(&fs::read(folder.join("fields.npz")).unwrap()).unwrap()
}

fn values(arrays: &[Array], name: &str) -> Vec<f64> {
    let array = arrays.iter().find(|array| array.name == name).unwrap_or_else(|| panic!("{name}"));
    let Values::F64(values) = &array.values else { panic!("{name}") };
    values.clone()
}

/// Contents of all result files, i.e. of all files except the log and the lock.
fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<(String, Vec<u8>)> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap()))
        .filter(|(name, _)| name != "log.txt" && name != "lock")
        .collect();
    all.sort();
    all
}

/// Verifies that perturbations decay inside the bound on non-coaxiality, that the ledger closes within the error of
/// the time steps, and that all files have the expected content.
#[test]
fn perturbations_decay_inside_the_bound() {
    let folder = tempfile::tempdir().unwrap();
    let text = carried_out(folder.path(), &decaying(RECORDED), 2).unwrap();
    assert!(text.contains("kinetic energy") && text.contains("run.png"), "{text}");
    let out = folder.path().join("out");

    let ledger = columns(&out.join("ledger.csv"));
    let names: Vec<&str> = ledger.iter().map(|own| own.0.as_str()).collect();
    assert_eq!(names, ["time", "kinetic", "background", "stress", "balance", "power"]);
    let [time, kinetic, balance] = ["time", "kinetic", "balance"].map(|name| column(&ledger, name));
    assert_eq!((time.len(), time[0], time[200]), (201, 0.0, 1e-3));
    // Initial kinetic energy ½ρA², with the root mean square A of the velocity.
    let start = 0.5 * 1600.0 * 1e-5f64.powi(2);
    assert!((kinetic[0] - start).abs() < 1e-9 * start, "{} {start}", kinetic[0]);
    assert!(kinetic[200] < 0.8 * start, "{}", kinetic[200]);
    assert!(balance.iter().all(|left| left.abs() < 1e-3 * start), "{balance:?}");

    let spectrum = columns(&out.join("spectrum.csv"));
    let shells = |row: usize| spectrum[1..].iter().map(move |shell| shell.1[row]);
    assert_eq!(column(&spectrum, "time"), time);
    assert!((shells(0).sum::<f64>() - start).abs() < 1e-9 * start);
    assert!(shells(0).skip(9).all(|shell| shell < 1e-20 * start));

    let seen = columns(&out.join("receivers.csv"));
    let names: Vec<&str> = seen.iter().map(|own| own.0.as_str()).collect();
    let own = ["v1", "v2", "w", "psi_deg", "p", "shear_rate"].map(|name| format!("middle.{name}"));
    assert_eq!(names[1..7], own);
    assert_eq!(names[7..], ["r2.psi_deg", "r2.v2"]);
    let json = fs::read(out.join("run.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(seen[0].1.len() as u64, report["steps"].as_u64().unwrap() + 1);
    assert_eq!((seen[0].1.last(), report["time"].as_f64()), (Some(&1e-3), Some(1e-3)));
    assert!(column(&seen, "r2.psi_deg").iter().all(|psi| (psi - 45.0).abs() < 1.0));
    assert!(report["stopped"].is_null());

    let arrays = arrays(&out);
    assert_eq!(values(&arrays, "time"), [1e-3]);
    // Γ = [[d, d' − s], [d' + s, −d]] with d = 50 cos 130°, d' = 50 sin 130°, s = −50.
    let found = values(&arrays, "deformation");
    let [d, e] = [50.0 * 130f64.to_radians().cos(), 50.0 * 130f64.to_radians().sin()];
    let gradient = [d, e + 50.0, e - 50.0, -d];
    let first_order = [
        1.0 + 1e-3 * gradient[0],
        1e-3 * gradient[1],
        1e-3 * gradient[2],
        1.0 + 1e-3 * gradient[3],
    ];
    assert!(found.iter().zip(first_order).all(|(a, b)| (a - b).abs() < 1e-2 * 0.1), "{found:?}");
    for name in ["v1", "v2", "w", "psi", "p", "shear_rate"] {
        let own = values(&arrays, name);
        assert!(own.len() == 1024 && own.iter().all(|value| value.is_finite()), "{name}");
    }
    let pressure = values(&arrays, "p");
    assert!((pressure.iter().sum::<f64>() / 1024.0 - 1000.0).abs() < 1e-6);

    check_files(&out);
    check_other_pictures(&out);
}

/// Checks the names of all files and the content of the snapshots.
fn check_files(out: &Path) {
    let mut names: Vec<String> = results(out).into_iter().map(|own| own.0).collect();
    names.retain(|name| !name.starts_with("snapshot-"));
    let expected = [
        "animation.gif",
        "case.toml",
        "checksums.txt",
        "fields.npz",
        "ledger.csv",
        "ledger.png",
        "ledger.svg",
        "program.json",
        "receivers.csv",
        "receivers.npz",
        "run.json",
        "run.png",
        "run.svg",
        "run.txt",
        "seismograms.png",
        "seismograms.svg",
        "snapshots.pvd",
        "spectrum.csv",
        "spectrum.png",
        "spectrum.svg",
    ];
    assert_eq!(names, expected);
    for index in 0..=4 {
        let image = fs::read(out.join(format!("snapshot-{index:08}.vts"))).unwrap();
        assert_eq!(files::vti::plain_time(&image), Some([0.0, 2.5e-4, 5e-4, 7.5e-4, 1e-3][index]));
        assert_eq!(files::vti::plain_values(&image, "psi [rad]").unwrap().len(), 1024);
    }
}

/// Checks that the other fields can be plotted for the same run.
fn check_other_pictures(out: &Path) {
    let before = fs::read(out.join("run.svg")).unwrap();
    let resolved = fs::read_to_string(out.join("case.toml")).unwrap();
    for picture in ["v1", "v2", "w", "psi_deg", "p", "shear_rate"] {
        let drawn = resolved.replace("picture = \"speed\"", &format!("picture = \"{picture}\""));
        fs::write(out.join("case.toml"), drawn).unwrap();
        cli::plot(out, &mut Vec::new()).unwrap();
        assert!(fs::read(out.join("run.svg")).unwrap() != before, "{picture}");
    }
    fs::write(out.join("case.toml"), &resolved).unwrap();
    cli::plot(out, &mut Vec::new()).unwrap();
    assert!(fs::read(out.join("run.svg")).unwrap() == before);
}

#[test]
fn threads_change_no_bit() {
    let all = [1, 2, 3].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        carried_out(folder.path(), &decaying(RECORDED), threads).unwrap();
        results(&folder.path().join("out"))
    });
    for other in &all[1..] {
        assert_eq!(all[0].len(), other.len());
        for (one, other) in all[0].iter().zip(other) {
            assert!(one == other, "{}", one.0);
        }
    }
}

/// Verifies that growth in the plastic potential stops the run, that the message states the position, and that the
/// last finite results are saved.
#[test]
fn growth_ends_a_run_with_what_was_sound() {
    let folder = tempfile::tempdir().unwrap();
    let text = case("kind = 'plastic-potential'", "shear_rate = 0.05", 1e-2, RECORDED);
    let error = carried_out(folder.path(), &text, 1).expect_err("growth");
    assert_eq!(error.exit_code(), 3, "{error}");
    let message = error.to_string();
    assert!(message.contains(" m in the box at the beginning after "), "{message}");
    assert!(message.ends_with(" s is saved"), "{message}");
    let out = folder.path().join("out");
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    assert_eq!(report["stopped"].as_str(), Some(message.as_str()));
    let time = report["time"].as_f64().unwrap();
    assert!(time < 1e-2);
    let ledger = columns(&out.join("ledger.csv"));
    assert_eq!(column(&ledger, "time").last(), Some(&time));
    let kinetic = column(&ledger, "kinetic");
    assert!(kinetic.last() > kinetic.first(), "{kinetic:?}");
    let rows = columns(&out.join("receivers.csv"));
    assert_eq!(rows[0].1.len() as u64, report["steps"].as_u64().unwrap() + 1);
    let arrays = arrays(&out);
    assert_eq!(values(&arrays, "time"), [time]);
    let least = values(&arrays, "shear_rate").into_iter().fold(f64::INFINITY, f64::min);
    assert!(least > 0.0, "{least}");
    assert!(!out.join("checkpoint").exists() && out.join("run.png").exists());
}

/// Verifies that an initial perturbation too large for the mean flow is refused as an error of the case.
#[test]
fn what_is_left_before_it_begins_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = decaying("").replace("amplitude = 1e-5", "amplitude = 1e3");
    let error = carried_out(folder.path(), &text, 1).expect_err("too much");
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(
        error.to_string().contains(": initial: ") && !folder.path().join("out").exists(),
        "{error}"
    );
}

/// Verifies that a run started from the saved fields of another run has these initial fields, up to the deformation
/// of the box.
#[test]
fn a_run_goes_on_from_an_archive() {
    let folder = tempfile::tempdir().unwrap();
    let first = decaying("").replace("duration = 0.001", "duration = 1e-5");
    carried_out(folder.path(), &first, 1).unwrap();
    let out = folder.path().join("out");
    fs::copy(out.join("fields.npz"), folder.path().join("old.npz")).unwrap();
    let [old, kinetic] =
        [values(&arrays(&out), "w"), column(&columns(&out.join("ledger.csv")), "kinetic")];
    let text = decaying("").split("[[initial]]").next().unwrap().to_owned()
        + "[[initial]]\nkind = 'file'\npath = 'old.npz'\n";
    let text = text.replace("duration = 0.001", "duration = 1e-9");
    carried_out(folder.path(), &text, 1).unwrap();
    let [new, start] =
        [values(&arrays(&out), "w"), column(&columns(&out.join("ledger.csv")), "kinetic")];
    let size = old.iter().fold(0.0f64, |a, b| a.max((b + 50.0).abs()));
    assert!(old.iter().zip(&new).all(|(a, b)| (a - b).abs() < 1e-3 * size));
    let [end, start] = [*kinetic.last().unwrap(), start[0]];
    assert!((end - start).abs() < 1e-4 * end, "{end} {start}");
}

fn folder(name: &str, case: &str) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("flow_run").join(name);
    let _ = fs::remove_dir_all(&path);
    fs::create_dir_all(&path).unwrap();
    fs::write(path.join("case.toml"), case).unwrap();
    path
}

fn command(folder: &Path, arguments: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(arguments.split_whitespace());
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Verifies that interrupted (Ctrl-C) or killed runs resumed with other numbers of threads give the same files.
#[cfg(unix)]
#[test]
fn interrupted_runs_resume_to_the_same_files() {
    const RUN: &str = "run case.toml --out out --checkpoint-every 0 --threads 1";
    let text = decaying(RECORDED).replace("duration = 0.001", "duration = 0.004");
    let whole = folder("whole", &text);
    let start = Instant::now();
    assert!(command(&whole, RUN).status().unwrap().success());
    let duration = start.elapsed();
    let expected = results(&whole.join("out"));
    for (index, signal) in ["-INT", "-TERM", "-KILL", "-KILL", "-INT"].into_iter().enumerate() {
        let here = folder(&format!("broken{index}"), &text);
        let mut child = command(&here, RUN).spawn().unwrap();
        std::thread::sleep(duration.mul_f64((index as f64 + 0.5) / 6.0));
        while !here.join("out/checkpoint").exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        let id = child.id().to_string();
        // The process may have ended already.
        let kill = Command::new("kill").args([signal, &id]).stderr(Stdio::null()).status();
        kill.unwrap();
        let code = child.wait().unwrap().code();
        if !here.join("out/run.json").exists() {
            assert_eq!(code, if signal == "-KILL" { None } else { Some(130) });
            let output = command(&here, "resume out --threads 2").stderr(Stdio::piped()).output();
            let output = output.unwrap();
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(output.status.success() && said.contains("\nfrom "), "{said}");
        }
        let _ = fs::remove_file(here.join("out/checkpoint"));
        let found = results(&here.join("out"));
        for (one, other) in found.iter().zip(&expected) {
            assert!(one == other, "{index}: {} differs from {}", one.0, other.0);
        }
        assert_eq!(found.len(), expected.len(), "{index}");
    }
    // A finished run is neither resumed nor repeated without `--force`.
    for arguments in ["resume out", "run case.toml --out out"] {
        assert_eq!(command(&whole, arguments).status().unwrap().code(), Some(2), "{arguments}");
    }
}

/// Verifies that a checkpoint with other fields than those of the case is refused.
#[cfg(unix)]
#[test]
fn damaged_checkpoints_are_refused() {
    let text = decaying(RECORDED).replace("duration = 0.001", "duration = 0.1");
    let here = folder("damaged", &text);
    let mut child = command(&here, "run case.toml --out out --checkpoint-every 0").spawn().unwrap();
    let start = Instant::now();
    while !here.join("out/checkpoint").exists() {
        assert!(start.elapsed() < Duration::from_secs(60));
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let path = here.join("out/checkpoint");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(&path, bytes).unwrap();
    let output = command(&here, "resume out").stderr(Stdio::piped()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("checkpoint") && said.contains("--force"), "{said}");
}

/// Verifies the bundled cases against their descriptions: noise decays inside the bound and grows outside.
#[test]
fn bundled_flows_do_what_they_say() {
    for (name, grows) in [
        ("decay", false),
        ("outside-the-bound", true),
        ("double-shearing", true),
        ("plastic-potential-in-time", true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let file = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("cases/flow")
            .join(name)
            .with_extension("toml");
        let out = folder.path().join("out");
        let options = Options {
            case: file.clone(),
            out: Some(out.clone()),
            accept_ill_posed: grows,
            ..Options::default()
        };
        if grows {
            // Without `--accept-ill-posed` the run is refused and writes nothing.
            let unasked = Options { accept_ill_posed: false, ..options.clone() };
            let error = cli::run(&unasked, CONTROL, &mut Vec::new()).unwrap_err();
            assert!(matches!(error, Error::IllPosed(_)) && error.exit_code() == 2, "{error}");
            assert!(!out.exists());
        }
        match cli::run(&options, CONTROL, &mut Vec::new()) {
            Ok(()) => {}
            Err(error) => assert!(grows && error.exit_code() == 3, "{name}: {error}"),
        }
        let kinetic = column(&columns(&out.join("ledger.csv")), "kinetic");
        // A packet of the stress angle starts with zero kinetic energy.
        let first = kinetic[1];
        let last = *kinetic.last().unwrap();
        assert_eq!(last > first, grows, "{name}: {first} {last}");
        let case = Case::load(&file, &[]).unwrap();
        assert!(case.flow.is_some());
    }
}

/// Verifies the warning for an ill-posed run: order, coefficient and time of the closed form; for the plastic
/// potential ς ≈ k² q tan²(φ/2)/(2ρQ_D).
#[test]
fn ill_posed_flows_are_told_before_they_run() {
    let case =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/flow/plastic-potential-in-time.toml");
    let options = Options { case, ..Options::default() };
    let error = cli::run(&options, CONTROL, &mut Vec::new()).unwrap_err().to_string();
    let coefficient = 500.0 * 15f64.to_radians().tan().powi(2) / (2.0 * 1600.0 * 5.0);
    let number = 21.0 * 2.0 * std::f64::consts::PI / 0.1;
    let tenfold = 10f64.ln() / (coefficient * number * number);
    for part in [
        format!("at the rate {} k² 1/s", short(coefficient)),
        format!("k = {} 1/m, tenfold in {} s", short(number), short(tenfold)),
        "--accept-ill-posed".to_owned(),
    ] {
        assert!(error.contains(&part), "{part}: {error}");
    }
}
