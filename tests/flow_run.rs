//! Tests of time-domain flows through the program: decay and growth as assessed, results independent of the number of
//! threads and of interruptions, and the files of a run.

use crate::program;
use crate::support;

use program::{
    RUN_ARGUMENTS, create_case_folder, create_command, read_result_files, run_with_exit_code,
    send_signal, wait_for_file,
};
use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};
use support::{
    NO_CHECKPOINTS, bundled_case, column_values, create_run_options, read_arrays_by_name,
    read_columns, run_case,
};
use wellposed::case::Case;
use wellposed::cli::{self, CommandError, Options};
use wellposed::report::PictureOptions;
use wellposed::report::format::format_short;

const TEST_FOLDER: &str = "flow_run";

/// Formats the case of a flow in simple shear with an initial noise perturbation.
fn format_case(model: &str, background: &str, duration: f64, rest: &str) -> String {
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

const HARRIS_GREKOVA_MODEL: &str =
    "kind = 'harris-grekova'\nmoment_of_inertia = 1.25e-7\nrotational_strength = 0";

/// Formats the case of a perturbation that decays.
fn format_decaying_case(rest: &str) -> String {
    format_case(
        HARRIS_GREKOVA_MODEL,
        "shear_rate = 50\nhalf_vorticity = -50\nnoncoaxiality_deg = 20",
        1e-3,
        rest,
    )
}

const RECEIVERS_AND_SNAPSHOTS: &str = "
[[receiver]]
name = 'middle'
at = [0.05, 0.05]
[[receiver]]
at = [0.1, 0.02]
fields = ['psi_deg', 'v2']
[output]
snapshot_interval = 2.5e-4
";

/// Runs a flow, ill-posed or not, and returns the printed text.
fn run_flow(folder: &Path, case: &str, threads: usize) -> Result<String, CommandError> {
    run_case(&Options {
        thread_count: Some(threads),
        accept_ill_posed: true,
        ..create_run_options(folder, case)
    })
}

/// Reads the final fields of a run by name.
fn read_fields(out: &Path) -> HashMap<String, Vec<f64>> {
    read_arrays_by_name(&out.join("fields.npz"))
}

/// Verifies that perturbations decay inside the bound on non-coaxiality, that the ledger closes within the error of
/// the time steps, and that all files have the expected content.
#[test]
fn perturbations_decay_inside_noncoaxiality_bound() {
    let folder = tempfile::tempdir().unwrap();
    let text = run_flow(folder.path(), &format_decaying_case(RECEIVERS_AND_SNAPSHOTS), 1).unwrap();
    assert!(text.contains("kinetic energy") && text.contains("run.png"), "{text}");
    let out = folder.path().join("out");

    let ledger = read_columns(&out.join("ledger.csv"));
    let names: Vec<&str> = ledger.iter().map(|column| column.0.as_str()).collect();
    assert_eq!(names, ["time", "kinetic", "background", "stress", "balance", "power"]);
    let [time, kinetic, balance] =
        ["time", "kinetic", "balance"].map(|name| column_values(&ledger, name));
    assert_eq!((time.len(), time[0], time[200]), (201, 0.0, 1e-3));
    // Initial kinetic energy ½ρA², with the root mean square A of the velocity.
    let start = 0.5 * 1600.0 * 1e-5f64.powi(2);
    assert!((kinetic[0] - start).abs() < 1e-9 * start, "{} {start}", kinetic[0]);
    assert!(kinetic[200] < 0.8 * start, "{}", kinetic[200]);
    assert!(balance.iter().all(|residual| residual.abs() < 1e-3 * start), "{balance:?}");

    let spectrum = read_columns(&out.join("spectrum.csv"));
    let shells = |row: usize| spectrum[1..].iter().map(move |shell| shell.1[row]);
    assert_eq!(column_values(&spectrum, "time"), time);
    assert!((shells(0).sum::<f64>() - start).abs() < 1e-9 * start);
    assert!(shells(0).skip(9).all(|shell| shell < 1e-20 * start));

    let records = read_columns(&out.join("receivers.csv"));
    let names: Vec<&str> = records.iter().map(|column| column.0.as_str()).collect();
    let expected =
        ["v1", "v2", "w", "psi_deg", "p", "shear_rate"].map(|name| format!("middle.{name}"));
    assert_eq!(names[1..7], expected);
    assert_eq!(names[7..], ["r2.psi_deg", "r2.v2"]);
    let json = fs::read(out.join("run.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&json).unwrap();
    assert_eq!(records[0].1.len() as u64, report["steps"].as_u64().unwrap() + 1);
    assert_eq!((records[0].1.last(), report["time"].as_f64()), (Some(&1e-3), Some(1e-3)));
    assert!(column_values(&records, "r2.psi_deg").iter().all(|psi| (psi - 45.0).abs() < 1.0));
    assert!(report["stopped"].is_null());

    let fields = read_fields(&out);
    assert_eq!(fields["time"], [1e-3]);
    // Velocity gradient Γ = [[d, e − s], [e + s, −d]], 1/s, with d = 50 cos 130°, e = 50 sin 130° and the
    // half-vorticity s = −50.
    let found = &fields["deformation"];
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
        let values = &fields[name];
        assert!(values.len() == 1024 && values.iter().all(|value| value.is_finite()), "{name}");
    }
    let pressure = &fields["p"];
    assert!((pressure.iter().sum::<f64>() / 1024.0 - 1000.0).abs() < 1e-6);

    check_result_files(&out);
    check_pictures_of_all_fields(&out);
}

/// Checks the names of all files and the content of the snapshots.
fn check_result_files(out: &Path) {
    let mut names: Vec<String> = read_result_files(out).into_keys().collect();
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
        "report.html",
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
        assert_eq!(
            files::vti::read_plain_time(&image),
            Some([0.0, 2.5e-4, 5e-4, 7.5e-4, 1e-3][index])
        );
        assert_eq!(files::vti::read_plain_values(&image, "psi [rad]").unwrap().len(), 1024);
    }
}

/// Checks that every field can be plotted after the run.
fn check_pictures_of_all_fields(out: &Path) {
    let before = fs::read(out.join("run.svg")).unwrap();
    let resolved = fs::read_to_string(out.join("case.toml")).unwrap();
    for picture in ["v1", "v2", "w", "psi_deg", "p", "shear_rate"] {
        let drawn = resolved.replace("picture = \"speed\"", &format!("picture = \"{picture}\""));
        fs::write(out.join("case.toml"), drawn).unwrap();
        cli::plot(out, &PictureOptions::default(), &mut Vec::new()).unwrap();
        assert!(fs::read(out.join("run.svg")).unwrap() != before, "{picture}");
    }
    fs::write(out.join("case.toml"), &resolved).unwrap();
    cli::plot(out, &PictureOptions::default(), &mut Vec::new()).unwrap();
    assert!(fs::read(out.join("run.svg")).unwrap() == before);
}

#[test]
fn results_are_bit_identical_for_any_number_of_threads() {
    let results = [1, 3].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        run_flow(folder.path(), &format_decaying_case(RECEIVERS_AND_SNAPSHOTS), threads).unwrap();
        read_result_files(&folder.path().join("out"))
    });
    for other in &results[1..] {
        assert!(results[0].keys().eq(other.keys()), "{:?}", other.keys());
        for (name, bytes) in &results[0] {
            assert!(other[name] == *bytes, "{name}");
        }
    }
}

/// Verifies that growth in the plastic potential stops the run, that the message states the position, and that the
/// last finite results are saved.
#[test]
fn run_stopped_by_growth_saves_last_finite_results() {
    let folder = tempfile::tempdir().unwrap();
    let text = format_case(
        "kind = 'plastic-potential'",
        "shear_rate = 0.05",
        1e-2,
        RECEIVERS_AND_SNAPSHOTS,
    );
    let error = run_flow(folder.path(), &text, 1).expect_err("growth");
    assert_eq!(error.exit_code(), 3, "{error}");
    let message = error.to_string();
    assert!(message.contains(" m in the box at t = 0 after "), "{message}");
    assert!(message.ends_with(" s is saved"), "{message}");
    let out = folder.path().join("out");
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("run.json")).unwrap()).unwrap();
    assert_eq!(report["stopped"].as_str(), Some(message.as_str()));
    let time = report["time"].as_f64().unwrap();
    assert!(time < 1e-2);
    let ledger = read_columns(&out.join("ledger.csv"));
    assert_eq!(column_values(&ledger, "time").last(), Some(&time));
    let kinetic = column_values(&ledger, "kinetic");
    assert!(kinetic.last() > kinetic.first(), "{kinetic:?}");
    let rows = read_columns(&out.join("receivers.csv"));
    assert_eq!(rows[0].1.len() as u64, report["steps"].as_u64().unwrap() + 1);
    let fields = read_fields(&out);
    assert_eq!(fields["time"], [time]);
    let min_shear_rate = fields["shear_rate"].iter().copied().fold(f64::INFINITY, f64::min);
    assert!(min_shear_rate > 0.0, "{min_shear_rate}");
    assert!(!out.join("checkpoint").exists() && out.join("run.png").exists());
}

/// Verifies that an initial perturbation too large for the mean flow is refused as an error of the case.
#[test]
fn initial_perturbation_outside_flow_domain_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = format_decaying_case("").replace("amplitude = 1e-5", "amplitude = 1e3");
    let error = run_flow(folder.path(), &text, 1).expect_err("too much");
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(
        error.to_string().contains(": initial: ") && !folder.path().join("out").exists(),
        "{error}"
    );
}

/// Verifies that a run started from the saved fields of another run has these initial fields, up to the deformation
/// of the box.
#[test]
fn run_starts_from_fields_of_archive() {
    let folder = tempfile::tempdir().unwrap();
    let first = format_decaying_case("").replace("duration = 0.001", "duration = 1e-5");
    run_flow(folder.path(), &first, 1).unwrap();
    let out = folder.path().join("out");
    fs::copy(out.join("fields.npz"), folder.path().join("old.npz")).unwrap();
    let read_spin_and_kinetic_energy = || {
        let ledger = read_columns(&out.join("ledger.csv"));
        [read_fields(&out).remove("w").unwrap(), column_values(&ledger, "kinetic").to_vec()]
    };
    let [old, kinetic] = read_spin_and_kinetic_energy();
    let text = format_decaying_case("").split("[[initial]]").next().unwrap().to_owned()
        + "[[initial]]\nkind = 'file'\npath = 'old.npz'\n";
    let text = text.replace("duration = 0.001", "duration = 1e-9");
    run_flow(folder.path(), &text, 1).unwrap();
    let [new, start] = read_spin_and_kinetic_energy();
    let size = old.iter().fold(0.0f64, |a, b| a.max((b + 50.0).abs()));
    assert!(old.iter().zip(&new).all(|(a, b)| (a - b).abs() < 1e-3 * size));
    let [end, start] = [*kinetic.last().unwrap(), start[0]];
    assert!((end - start).abs() < 1e-4 * end, "{end} {start}");
}

/// Verifies that interrupted (Ctrl-C) or killed runs resumed with other numbers of threads give the same files.
#[cfg(unix)]
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn interrupted_runs_resume_to_bit_identical_files() {
    let text = format_decaying_case(RECEIVERS_AND_SNAPSHOTS)
        .replace("duration = 0.001", "duration = 0.004")
        .replace("snapshot_interval = 2.5e-4", "snapshot_interval = 1e-3");
    let uninterrupted = create_case_folder(TEST_FOLDER, "whole", &text);
    let start = Instant::now();
    run_with_exit_code(0, &uninterrupted, RUN_ARGUMENTS);
    let duration = start.elapsed();
    let expected = read_result_files(&uninterrupted.join("out"));
    for (index, signal) in ["INT", "TERM", "KILL"].into_iter().enumerate() {
        let here = create_case_folder(TEST_FOLDER, &format!("broken{index}"), &text);
        let mut child = create_command(&here, RUN_ARGUMENTS).spawn().unwrap();
        std::thread::sleep(duration.mul_f64((index as f64 + 0.5) / 4.0));
        while !here.join("out/checkpoint").exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(2));
        }
        send_signal(&child, signal);
        let code = child.wait().unwrap().code();
        if !here.join("out/run.json").exists() {
            assert_eq!(code, if signal == "KILL" { None } else { Some(130) });
            let (_, stderr) = run_with_exit_code(0, &here, "resume out --threads 2");
            assert!(stderr.contains("\nfrom "), "{stderr}");
        }
        let _ = fs::remove_file(here.join("out/checkpoint"));
        let found = read_result_files(&here.join("out"));
        for (file, other) in found.iter().zip(&expected) {
            assert!(file == other, "{index}: {} differs from {}", file.0, other.0);
        }
        assert_eq!(found.len(), expected.len(), "{index}");
    }
    // A finished run is neither resumed nor repeated without `--force`.
    for arguments in ["resume out", "run case.toml --out out"] {
        run_with_exit_code(2, &uninterrupted, arguments);
    }
}

/// Verifies that a damaged checkpoint is refused.
#[cfg(unix)]
#[test]
fn damaged_checkpoints_are_refused() {
    let text =
        format_decaying_case(RECEIVERS_AND_SNAPSHOTS).replace("duration = 0.001", "duration = 0.1");
    let here = create_case_folder(TEST_FOLDER, "damaged", &text);
    let mut child =
        create_command(&here, "run case.toml --out out --checkpoint-every 0").spawn().unwrap();
    wait_for_file(&here.join("out/checkpoint"));
    child.kill().unwrap();
    child.wait().unwrap();
    let path = here.join("out/checkpoint");
    let mut bytes = fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    fs::write(&path, bytes).unwrap();
    let (_, stderr) = run_with_exit_code(2, &here, "resume out");
    assert!(stderr.contains("checkpoint") && stderr.contains("--force"), "{stderr}");
}

/// Verifies the bundled cases against their descriptions: noise decays inside the bound and grows outside.
#[test]
fn bundled_flows_decay_or_grow_as_described() {
    for (name, grows) in [
        ("decay", false),
        ("outside-the-bound", true),
        ("double-shearing", true),
        ("plastic-potential-in-time", true),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let file = bundled_case(&format!("flow/{name}.toml"));
        let out = folder.path().join("out");
        let options = Options {
            case_path: file.clone(),
            output_folder: Some(out.clone()),
            thread_count: Some(1),
            // No animation.
            settings: vec!["output.snapshot_interval=0".to_owned()],
            accept_ill_posed: grows,
            ..Options::default()
        };
        if grows {
            // Without `--accept-ill-posed` the run is refused and writes nothing.
            let refused = Options { accept_ill_posed: false, ..options.clone() };
            let error = cli::run_simulation(&refused, NO_CHECKPOINTS, &mut Vec::new()).unwrap_err();
            assert!(
                matches!(error, CommandError::IllPosed(_)) && error.exit_code() == 2,
                "{error}"
            );
            assert!(!out.exists());
        }
        match cli::run_simulation(&options, NO_CHECKPOINTS, &mut Vec::new()) {
            Ok(()) => {}
            Err(error) => assert!(grows && error.exit_code() == 3, "{name}: {error}"),
        }
        let ledger = read_columns(&out.join("ledger.csv"));
        let kinetic = column_values(&ledger, "kinetic");
        // A perturbation of the stress angle alone starts with zero kinetic energy: compare with the second row.
        let first = kinetic[1];
        let last = *kinetic.last().unwrap();
        assert_eq!(last > first, grows, "{name}: {first} {last}");
        let case = Case::load(&file, &[]).unwrap();
        assert!(case.flow_run.is_some());
    }
}

/// Verifies the refusal of an ill-posed flow: order, coefficient and time of tenfold growth from the closed form; for
/// the plastic potential ς ≈ k² q tan²(φ/2)/(2ρQ_D), with the growth rate ς, the deviatoric stress q and the shear rate
/// Q_D.
#[test]
fn ill_posed_flow_is_refused_with_growth_rate() {
    let case = bundled_case("flow/plastic-potential-in-time.toml");
    let options = Options { case_path: case, ..Options::default() };
    let error =
        cli::run_simulation(&options, NO_CHECKPOINTS, &mut Vec::new()).unwrap_err().to_string();
    let coefficient = 500.0 * 15f64.to_radians().tan().powi(2) / (2.0 * 1600.0 * 5.0);
    let number = 21.0 * 2.0 * std::f64::consts::PI / 0.1;
    let tenfold = 10f64.ln() / (coefficient * number * number);
    for expected in [
        format!("at the rate {} k² 1/s", format_short(coefficient)),
        format!("k = {} 1/m, grow tenfold in {} s", format_short(number), format_short(tenfold)),
        "--accept-ill-posed".to_owned(),
    ] {
        assert!(error.contains(&expected), "{expected}: {error}");
    }
}
