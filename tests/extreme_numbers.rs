//! Verifies that numbers out of the range of the computation are refused, and that no result contains non-finite
//! numbers.

use crate::program;

use program::*;
use std::path::Path;

const TEST_FOLDER: &str = "extreme-numbers";

/// Checks that a run with the settings and its dry run are refused with a message that contains `key` and `message`.
fn assert_refused(here: &Path, settings: &str, key: &str, message: &str) {
    let arguments = format!("run case.toml --out out --threads 1 --accept-ill-posed {settings}");
    for more in ["", " --dry-run"] {
        let (stdout, stderr) = run_with_exit_code(2, here, &format!("{arguments}{more}"));
        assert!(stdout.is_empty() && !here.join("out").exists(), "{settings}: {stdout}");
        for expected in [key, message] {
            assert!(stderr.contains(expected), "{settings}: no {expected} in {stderr}");
        }
    }
}

/// Verifies that the verb `point` either prints finite numbers or refuses the case.
#[test]
#[ignore = "takes long; part of .ci/run and .ci/long"]
fn solid_states_with_extreme_parameters_are_finite_or_refused() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let here = create_case_folder(TEST_FOLDER, "states", "");
    let mut computed = 0;
    for name in ["forbidden-band", "shear-band", "rotation-waves", "flutter", "microrotation"] {
        let case = root.join(format!("cases/cosserat/{name}.toml"));
        for setting in [
            "wave.number=1e3",
            "wave.number=1e6",
            "wave.number=1e9",
            "wave.number=1e12",
            "wave.number=1e-6",
            "wave.number=1e-12",
            "model.mu=1e20",
            "model.mu=1e154",
            "model.density=1e-20",
            "model.density=1e200",
        ] {
            let arguments = format!("point {} --set {setting} --out out --force", case.display());
            let output = run_program(&here, &arguments);
            let text = String::from_utf8_lossy(&output.stdout).into_owned();
            let errors = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(!text.contains("NaN") && !text.contains("inf"), "{arguments}: {text}");
            match output.status.code() {
                Some(0) => computed += 1,
                Some(2) => assert!(errors.contains("allowed") || errors.contains("; "), "{errors}"),
                code => panic!("{arguments}: {code:?} {errors}"),
            }
            // Short waves in these media are ordinary input.
            if setting == "wave.number=1e6" || setting == "wave.number=1e3" {
                assert_eq!(output.status.code(), Some(0), "{arguments}: {errors}");
            }
        }
    }
    assert!(computed > 25, "{computed}");
}

/// Verifies that waves whose speeds overflow are refused.
#[test]
fn dispersion_with_infinite_speeds_is_refused() {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/cosserat/forbidden-band.toml");
    let here = create_case_folder(TEST_FOLDER, "speeds", "");
    for value in ["1e-300", "1e-305"] {
        let arguments =
            format!("dispersion {} --out out --set model.density={value}", case.display());
        let (stdout, stderr) = run_with_exit_code(2, &here, &arguments);
        assert!(stdout.is_empty() && stderr.contains("frequencies and speeds"), "{stdout}{stderr}");
    }
}

/// Verifies that constants whose products overflow are refused: a yielding solid would behave as an elastic one.
#[test]
fn overflowing_constants_are_refused() {
    let here = create_case_folder(TEST_FOLDER, "constants", SOLID_CASE);
    for (settings, key) in [
        ("--set yield.strength=2e104", "yield.strength"),
        (
            "--set model.mu=8e107 --set model.lambda=1.2e108 --set model.alpha=3e107 \
             --set model.density=1.9e103 --set model.inertia=3e102",
            "model.",
        ),
        ("--set scheme.precision='f32' --set yield.strength=2e16", "yield.strength"),
    ] {
        let settings = settings.replace('\'', "\"");
        assert_refused(&here, &settings, key, "numbers from");
    }
}

/// Verifies that a solid in other units of mass, and hence of stress, gives bit-identical results up to the limits of
/// the range.
#[test]
fn results_are_bit_identical_under_change_of_mass_unit() {
    let scaled = |name: &str, factor: f64| {
        let here = create_case_folder(TEST_FOLDER, name, SOLID_CASE);
        let settings: String = [
            ("model.lambda", 1.2e8),
            ("model.mu", 8e7),
            ("model.alpha", 3e7),
            ("model.density", 1900.0),
            ("model.inertia", 300.0),
            ("yield.strength", 2e4),
            ("load[0].amplitude", -1e5),
        ]
        .iter()
        .map(|(key, value)| format!(" --set {key}={:e}", value * factor))
        .collect();
        let arguments = "run case.toml --out out --threads 1 --set output.snapshot_interval=0";
        run_with_exit_code(0, &here, &format!("{arguments}{settings}"));
        let text = std::fs::read_to_string(here.join("out/receivers.csv")).unwrap();
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(1)
            .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
            .collect();
        let names: Vec<String> =
            text.lines().next().unwrap().split(',').map(str::to_owned).collect();
        (names, rows)
    };
    let (names, rows) = scaled("own", 1.0);
    for (name, factor) in [("small", 2f64.powi(-60)), ("large", 2f64.powi(60))] {
        let (_, other) = scaled(name, factor);
        for (row, other) in rows.iter().zip(&other) {
            for ((name, a), b) in names.iter().zip(row).zip(other) {
                let factor = if name.contains("sigma") { factor } else { 1.0 };
                assert_eq!((a * factor).to_bits(), b.to_bits(), "{name}");
            }
        }
        assert_eq!(rows.len(), other.len());
    }
}

/// Verifies that loads below the threshold of flushing to zero are refused, and loads too large for the return mapping.
#[test]
fn loads_below_flush_threshold_are_refused() {
    let here = create_case_folder(TEST_FOLDER, "loads", SOLID_CASE);
    let f32 = "--set scheme.precision=\"f32\"";
    assert_refused(
        &here,
        &format!("{f32} --set load[0].amplitude=4e-20"),
        "load[0].amplitude",
        "f32",
    );
    assert_refused(&here, "--set load[0].amplitude=1e-150", "load[0].amplitude", "f64");
    // Products of stresses of this size overflow in the return mapping: the plastic dissipation would be far too small.
    assert_refused(&here, "--set load[0].amplitude=1e100", "load[0].amplitude", "f64");
    assert_refused(
        &here,
        &format!("{f32} --set load[0].amplitude=1e16"),
        "load[0].amplitude",
        "f32",
    );
    let arguments =
        format!("run case.toml --out out --threads 1 {f32} --set load[0].amplitude=1e-10");
    let (_, stderr) = run_with_exit_code(0, &here, &arguments);
    assert!(!stderr.contains("residual of the energy ledger"), "{stderr}");
}

/// Verifies that amplitudes whose products with time functions and profiles, or whose sums, are out of range are
/// refused, with the position of the table.
#[test]
fn overflowing_products_of_amplitudes_are_refused() {
    let more = "[[load]]\nside = 'x1+'\nfield = 'v1'\namplitude = 2\n\
                profile = { kind = 'table', samples = [[0, 1], [25, 2]] }\n\
                time = { kind = 'table', samples = [[0, 0], [0.1, 1]] }\n\
                [[source]]\nkind = 'explosion'\namplitude = 1e4\nat = [15, 10]\n\
                time = { kind = 'table', file = 'source.csv' }\n";
    let case = SOLID_CASE.replace("[output]", &format!("{more}[output]"));
    let here = create_case_folder(TEST_FOLDER, "products", &case);
    let write_samples =
        |last: &str| std::fs::write(here.join("source.csv"), format!("0,0\n0.1,{last}\n")).unwrap();
    write_samples("1");
    let arguments = "run case.toml --out out --dry-run";
    run_with_exit_code(0, &here, arguments);
    // The impedance is 5.5e5 Pa·s/m: each value alone is in the range, up to 1e90 and in single precision to 1e12.
    for (settings, key) in [
        ("load[1].time={kind=\"table\",samples=[[0,0],[0.1,1e85]]}", "load[1].time.samples"),
        ("load[1].time={kind=\"table\",samples=[[0,0],[0.1,-1e305]]}", "load[1].time.samples"),
        ("load[1].time={kind=\"table\",samples=[[0,0],[0.1,1e-150]]}", "load[1].time.samples"),
        ("load[1].profile={kind=\"table\",samples=[[0,0],[25,1e85]]}", "load[1].profile.samples"),
    ] {
        assert_refused(
            &here,
            &format!("--set {settings}"),
            key,
            "waves from 1e-140 to 1e90 in f64",
        );
    }
    let f32 = "--set scheme.precision=\"f32\"";
    let setting = "load[1].profile.samples=[[0,0],[25,1e7]]";
    let message = "found values up to 1e7 times 2: waves of";
    assert_refused(&here, &format!("{f32} --set {setting}"), "load[1].profile.samples", message);
    write_samples("1e10");
    assert_refused(
        &here,
        f32,
        "case.toml:41: source[0].time.file",
        "waves from 1e-20 to 1e12 in f32",
    );
    run_with_exit_code(0, &here, arguments);
    // Two loads, each of which is in the range.
    write_samples("1");
    let settings = "--set load[0].amplitude=6e89 --set source[0].amplitude=1.4e89";
    assert_refused(&here, settings, "source[0].amplitude", "the loads and sources before it");
}

/// Verifies that initial states, initial stresses and weights that overflow are refused.
#[test]
fn overflowing_initial_states_are_refused() {
    let pulse = "[[initial]]\nkind = 'plane-pulse'\nwave = 'S'\nat = [15, 12]\namplitude = 1\n\
                 time = { kind = 'table', samples = [[-0.01, 0], [0, 1], [0.01, 0]] }\n";
    let classical = SOLID_CASE
        .replace("'reduced-cosserat'", "'classical'")
        .replace("alpha = 3e7\n", "")
        .replace("inertia = 300\n", "")
        .replace(", 'phi3'", "")
        .replace("[yield]\nkind = 'von-mises'\nstrength = 2e4\n", "")
        .replace("[output]", &format!("{pulse}[output]"));
    let here = create_case_folder(TEST_FOLDER, "plane-pulses", &classical);
    run_with_exit_code(0, &here, "run case.toml --out out --dry-run");
    let setting = "--set initial[0].time.samples=[[-0.01,0],[0,1e85],[0.01,0]]";
    assert_refused(&here, setting, "initial[0].time.samples", "waves of");
    let terms = "[[initial]]\nkind = 'rotation'\nshape = 'everywhere'\nangle_deg = 0\n\
                 [[initial]]\nkind = 'rigid-rotation'\nshape = 'everywhere'\nat = [15, 12]\nrate = 0\n\
                 [initial_stress]\nsigma11 = 0\n\
                 [gravity]\nacceleration = [0, -9.81]\nbalanced = false\n";
    let case = SOLID_CASE.replace("[output]", &format!("{terms}[output]"));
    let here = create_case_folder(TEST_FOLDER, "initial-states", &case);
    run_with_exit_code(0, &here, "run case.toml --out out --dry-run");
    for (settings, key) in [
        ("initial[0].angle_deg=1e85", "initial[0]"),
        ("initial[1].rate=1e85", "initial[1]"),
        ("initial[1].rate=1.7e308", "initial[1]"),
        ("initial_stress.sigma11=1e91", "initial_stress.sigma11"),
        ("gravity.acceleration=[0,1e87]", "gravity.acceleration"),
        ("gravity.acceleration=[0,1e300] --set gravity.balanced=true", "gravity.acceleration"),
    ] {
        assert_refused(&here, &format!("--set {settings}"), key, "to 1e90 in f64");
    }
}

/// Verifies that joints whose constants, masses, stiffnesses or impedances are out of the range of the precision are
/// refused.
#[test]
fn joints_out_of_range_are_refused() {
    let case = include_str!("../cases/blocky/pulse-breaking.toml");
    let here = create_case_folder(TEST_FOLDER, "joints", case);
    let f32 = "--set scheme.precision=\"f32\"";
    run_with_exit_code(0, &here, &format!("run case.toml --out out --dry-run {f32}"));
    for (settings, key, message) in [
        (
            "--set joint[0].shear_strength=1e16",
            "joint[0].shear_strength",
            "numbers from 1e-15 to 1e15",
        ),
        ("--set joint[0].thickness=1e-16", "joint[0].thickness", "numbers from 1e-15 to 1e15"),
        ("--set joint[0].longitudinal_speed=1e14", "joint[0]", "the impedance √(mK) 1.5e17 Pa·s/m"),
        (
            "--set joint[0].thickness=1e-15 --set joint[0].longitudinal_speed=1e10 \
             --set joint[0].density=1e4",
            "joint[0]",
            "the stiffness 1.0e39 Pa/m",
        ),
        ("--set joint[0].density=1e9", "joint[0]", "the mass 1.0e6 kg/m²"),
    ] {
        assert_refused(&here, &format!("{f32} {settings}"), key, message);
        // In double precision all of these are in the range.
        run_with_exit_code(0, &here, &format!("run case.toml --out out --dry-run {settings}"));
    }
    assert_refused(&here, "--set joint[0].thickness=1e-95", "joint[0].thickness", "in f64");
    let mass = "--set joint[0].thickness=1e14 --set joint[0].density=1e6";
    assert_refused(&here, mass, "joint[0]", "the mass 1.0e20 kg/m²");
}

/// Verifies that sources and initial velocities below the threshold of flushing to zero are refused.
#[test]
fn sources_below_flush_threshold_are_refused() {
    let source = "[[source]]\nkind = 'force'\namplitude = [1e4, 0]\nat = [15, 10]\n\
                  time = { kind = 'pulse', duration = 0.02 }\n\
                  [[initial]]\nkind = 'plane-wave'\nbranch = 1\nwavelength = 5\namplitude = 1e-3\n";
    let case = SOLID_CASE.replace("[output]", &format!("{source}[output]"));
    let here = create_case_folder(TEST_FOLDER, "sources", &case);
    for (key, value) in [("source[0].amplitude", "[1e-20, 0]"), ("initial[0].amplitude", "1e-30")] {
        let settings = format!("--set scheme.precision=\"f32\" --set {key}={value}");
        assert_refused(&here, &settings.replace(", ", ","), key, "f32");
    }
}

#[test]
fn tolerances_below_rounding_are_refused() {
    let here = create_case_folder(TEST_FOLDER, "tolerances", "");
    run_with_exit_code(0, &here, "new harris-grekova --run --force case.toml");
    for key in ["time.tolerance", "time.pressure_tolerance"] {
        assert_refused(&here, &format!("--set {key}=1e-30"), key, "lost in rounding");
    }
}

#[test]
fn sources_much_wider_than_grid_are_refused() {
    let source = "[[source]]\nkind = 'explosion'\namplitude = 1e6\nat = [15, 10]\nradius = 4\n\
                  time = { kind = 'pulse', duration = 0.02 }\n";
    let here = create_case_folder(
        TEST_FOLDER,
        "bells",
        &SOLID_CASE.replace("[output]", &format!("{source}[output]")),
    );
    for radius in ["1e6", "1e15", "1e300"] {
        assert_refused(
            &here,
            &format!("--set source[0].radius={radius}"),
            "source[0].radius",
            "grid",
        );
    }
    run_with_exit_code(0, &here, "run case.toml --out out --dry-run --set source[0].radius=50");
}
