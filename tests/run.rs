//! Tests of time-domain runs of solids through the program: against exact waves, bit-identical results for any number
//! of threads, equilibrium under balanced weight, and cases that cannot be run.

use crate::support;

use files::npz::{ArrayValues, read_arrays};
use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation};
use num_complex::Complex64;
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use support::{
    COSSERAT_MODEL, column_values, create_run_options, format_periodic_boundaries,
    read_arrays_by_name, read_columns, run_case,
};
use wellposed::cli::{CommandError, Options};

const CLASSICAL_MODEL: &str = "
[model]
kind = 'classical'
lambda = 1.2e8
mu = 8e7
density = 1900
";

/// Runs a case and returns the printed text.
fn run_in_folder(folder: &Path, case: &str) -> Result<String, CommandError> {
    run_case(&create_run_options(folder, case))
}

/// Returns the message with which a case is refused, from the line number on.
fn refusal_message(case: &str) -> String {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let error = run_in_folder(folder.path(), case).expect_err("a wrong case");
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(!folder.path().join("out").exists(), "nothing is written");
    // The message without the folder, which differs between tests.
    error.to_string().rsplit_once("case.run.toml").expect("the file").1.to_owned()
}

/// Verifies plane waves of all branches in the medium of a unit test of SPECFEM++: the receiver record has the
/// frequency obtained here from the determinant of the equations of motion.
#[test]
fn plane_waves_have_frequencies_of_equations_of_motion() {
    let couple = Some(CoupleModuli { beta: 7.75e8, gamma: 1.5e8, eta: 3e8 });
    let rotation = Microrotation { alpha: 1.005e9, inertia: 2700.0, couple };
    let solid = Isotropic::new(8.1e9, 8.1e9, 2700.0, Some(rotation)).expect("sound moduli");
    // Along x₁ pressure waves have ρω² = (λ + 2μ)k². Shear, ρω² = (μ + α)k², and spin, jω² = (γ + η)k² + 4α, are
    // coupled by 2αk, so that the product of the differences ρω² − (μ + α)k² and jω² − (γ + η)k² − 4α is (2αk)².
    let (length, count) = (20.0, 100);
    let k = 2.0 * PI / length;
    let a = (8.1e9 + 1.005e9) * k * k / 2700.0;
    let b = ((1.5e8 + 3e8) * k * k + 4.0 * 1.005e9) / 2700.0;
    let c = (2.0 * 1.005e9 * k / 2700.0_f64).powi(2);
    let root = (0.25 * (a - b) * (a - b) + c).sqrt();
    let squares =
        [solid.speeds().longitudinal.powi(2) * k * k, 0.5 * (a + b) + root, 0.5 * (a + b) - root];
    let mut frequencies = squares.map(f64::sqrt);
    frequencies.sort_by(|a, b| b.total_cmp(a));
    for (branch, frequency) in frequencies.into_iter().enumerate() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let duration = 0.9 * 2.0 * PI / frequency;
        let case = format!(
            "{COSSERAT_MODEL}
            [grid]
            cells = [{count}, 4]
            spacing = {}
            [time]
            duration = {duration}
            {}
            [[initial]]
            kind = 'plane-wave'
            branch = {}
            wavelength = {length}
            amplitude = 1e-3
            [[receiver]]
            at = [7.1, 0.3]
            ",
            length / f64::from(count),
            format_periodic_boundaries(&["x1-", "x1+", "x2-", "x2+"]),
            branch + 1,
        );
        run_in_folder(folder.path(), &case).expect("a sound case");
        let records = read_columns(&folder.path().join("out/receivers.csv"));
        let time = column_values(&records, "time");
        let [along, across] = ["r1.v1", "r1.v2"].map(|name| column_values(&records, name));
        let is_pressure = along.iter().map(|v| v.abs()).sum::<f64>()
            > across.iter().map(|v| v.abs()).sum::<f64>();
        let velocity = if is_pressure { along } else { across };
        // Velocity 10⁻³ Re exp(i(kx − ωt)) m/s at the centre of the cell of the receiver, x = 7.1 m.
        let phase = k * 7.1;
        let error = time
            .iter()
            .zip(velocity)
            .map(|(t, v)| (v - 1e-3 * Complex64::cis(phase - frequency * t).re).abs())
            .fold(0.0, f64::max);
        assert!(error < 1e-2 * 1e-3, "branch {branch}: {error:e}");
    }
}

/// Formats a short case of two layers with gravity, yielding, fixed and non-reflecting boundaries, and additional
/// sections.
fn format_layered_case(extra: &str) -> String {
    format!(
        "{CLASSICAL_MODEL}
        [grid]
        cells = [30, 24]
        spacing = 0.5
        origin = [-7.5, -12]
        [time]
        duration = 0.05
        [scheme]
        ledger = 'full'
        [[region]]
        shape = 'layer'
        axis = 2
        from = -8
        to = 0
        yield = {{ kind = 'drucker-prager', strength = 2e4, friction = 0.5, dilatancy = 0.5 }}
        [[region]]
        shape = 'rest'
        model = {{ lambda = 4e9, mu = 4e9 }}
        [gravity]
        acceleration = [0, -9.81]
        lateral_ratio = 0.5
        [[boundary]]
        side = 'x1-'
        kind = 'non-reflecting'
        [[boundary]]
        side = 'x2-'
        kind = 'fixed'
        [[receiver]]
        name = 'edge'
        at = [1.5, -0.05]
        {extra}"
    )
}

const LOAD_AND_SOURCE: &str = "
[[load]]
side = 'x2+'
field = 'sigma22'
from = -1
to = 1
amplitude = -4e5
time = { kind = 'pulse', duration = 0.02 }
[[source]]
kind = 'force'
amplitude = [1e4, 0]
at = [-3, -3]
radius = 1
time = { kind = 'ricker', frequency = 60 }
";

/// Verifies that result files are bit-identical for 1, 2 and 7 threads, and that the per-cell energy account
/// closes.
#[test]
fn results_are_bit_identical_for_any_number_of_threads() {
    let mut results = Vec::new();
    for threads in [1, 2, 7] {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let case = create_run_options(folder.path(), &format_layered_case(LOAD_AND_SOURCE));
        run_case(&Options { thread_count: Some(threads), ..case }).expect("a sound case");
        let out = folder.path().join("out");
        let mut names: Vec<_> =
            fs::read_dir(&out).expect("results").map(|e| e.expect("a file").file_name()).collect();
        names.sort();
        let files: Vec<(_, Vec<u8>)> = names
            .into_iter()
            .filter(|name| name != "log.txt")
            .map(|n| (n.clone(), fs::read(out.join(n)).expect("a file")))
            .collect();
        let ledger = read_columns(&out.join("ledger.csv"));
        let residual =
            column_values(&ledger, "residual").iter().fold(0.0, |a: f64, b| a.max(b.abs()));
        let [kinetic, stored] = ["kinetic", "stored"].map(|name| column_values(&ledger, name));
        let largest = kinetic.iter().zip(stored).map(|(a, b)| a + b).fold(0.0, f64::max);
        assert!(residual < 1e-12 * largest, "{residual:e} of {largest:e}");
        let [plastic, initial_stress_work] =
            ["plastic_dissipation", "initial_stress_work"].map(|name| column_values(&ledger, name));
        assert!(*plastic.last().expect("lines") > 0.01 * largest);
        assert!(initial_stress_work.last().expect("lines").abs() > 1e-3 * largest);
        results.push(files);
    }
    for other in &results[1..] {
        for (first, other) in results[0].iter().zip(other) {
            assert!(first == other, "{:?}", first.0);
        }
        assert_eq!(results[0].len(), other.len());
    }
}

/// Verifies that weight balanced by the initial stress causes no motion; the output stress is lithostatic.
#[test]
fn balanced_weight_causes_no_motion() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_in_folder(folder.path(), &format_layered_case("")).expect("a sound case");
    let fields = read_arrays_by_name(&folder.path().join("out/fields.npz"));
    assert!(fields["v1"].iter().chain(&fields["v2"]).all(|v| *v == 0.0));
    let [x2, vertical, lateral, across] =
        ["x2", "sigma22", "sigma11", "sigma33"].map(|name| &fields[name]);
    for (row, x2) in x2.iter().enumerate() {
        // Weight of half the cell and of all cells above.
        let expected = 1900.0 * 9.81 * x2;
        for column in 0..30 {
            let cell = 30 * row + column;
            assert!((vertical[cell] - expected).abs() < 1e-12 * expected.abs());
            assert!((lateral[cell] - 0.5 * expected).abs() < 1e-12 * expected.abs());
            assert!((across[cell] - 0.5 * expected).abs() < 1e-12 * expected.abs());
        }
    }
}

/// Verifies that a run with non-finite values stops, that the message states the position, and that the last finite
/// results are saved.
#[test]
fn run_stopped_by_overflow_saves_last_finite_results() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    // The phase of the sine overflows; amplitudes that overflow are refused.
    let case = format_layered_case(
        "[[source]]\nkind = 'explosion'\namplitude = 1e4\nat = [1, -5]\n\
                     time = { kind = 'sine', frequency = 1e308, start = 0.02 }",
    );
    let error = run_in_folder(folder.path(), &case).expect_err("too much");
    assert_eq!(error.exit_code(), 3);
    let message = error.to_string();
    assert!(message.contains("not finite") && message.contains("is saved"), "{message}");
    let out = folder.path().join("out");
    let bytes = fs::read(out.join("fields.npz")).expect("fields");
    for array in read_arrays(&bytes).expect("arrays") {
        if let ArrayValues::F64(values) = array.values {
            assert!(values.iter().all(|v| v.is_finite()), "{}", array.name);
        }
    }
    let report: serde_json::Value =
        serde_json::from_slice(&fs::read(out.join("run.json")).expect("a report")).expect("JSON");
    assert!(report["stopped"].as_str().is_some_and(|text| text.contains("not finite")));
    assert_eq!(
        read_columns(&out.join("receivers.csv"))[0].1.len() as u64,
        report["steps"].as_u64().unwrap() + 1
    );
}

/// Formats the case of a classical solid with additional sections.
fn format_classical_case(extra: &str) -> String {
    format!(
        "{CLASSICAL_MODEL}[grid]\ncells = [8, 8]\nspacing = 1\n[time]\nduration = 0.01\n{extra}"
    )
}

const PULSE_TIME_FUNCTION: &str = "time = { kind = 'pulse', duration = 0.01 }";

/// Checks that each case is refused with a message that contains the expected text.
fn check_refusals<const N: usize>(cases: [(String, &str); N]) {
    for (case, expected) in cases {
        let message = refusal_message(&case);
        assert!(message.contains(expected), "{expected}: {message}");
        println!("{message}");
    }
}

#[test]
fn invalid_runs_are_refused() {
    check_refusals([
        (
            CLASSICAL_MODEL.replace("lambda", "dimensions = 2\nlambda"),
            ": grid: missing; add a section [grid], for example with cells = [200, 200] and spacing = 1.0, and [time] with a duration",
        ),
        // A missing grid is reported before other missing sections.
        (CLASSICAL_MODEL.to_owned(), ": grid: missing; add a section [grid]"),
        (
            wellposed::cli::new::generate_state_template(
                wellposed::case::ModelKind::flow_kinds()[0],
            ),
            ": grid: missing; add a section [grid], for example with cells = [64, 64] and length = 0.1",
        ),
        (
            format_classical_case(
                "[[region]]\nshape = 'layer'\naxis = 1\nfrom = 0\nto = 5\n[[region]]\nshape = 'layer'\naxis = 1\nfrom = 4\nto = 8\n",
            ),
            "regions must not overlap",
        ),
        (
            format_classical_case("[[region]]\nshape = 'layer'\naxis = 1\nfrom = 0\nto = 5\n"),
            "add [[region]] with shape = \"rest\"",
        ),
        (
            format_classical_case(
                "[[region]]\nshape = 'layer'\naxis = 1\nfrom = 0\nto = 4\n[[region]]\nshape = 'rest'\nmodel = { kind = 'cosserat', lambda = 1e8, mu = 1e8, alpha = 1e8, beta = 1, gamma = 1, eta = 1, density = 1, inertia = 1 }\n",
            ),
            "all media of a run need the same fields",
        ),
        (
            format_classical_case("[[region]]\nshape = 'rest'\nmodel = { mu = -1 }\n"),
            "positive definite only for μ > 0",
        ),
        (
            format_classical_case(&format!(
                "[[load]]\nside = 'x1-'\nfield = 'v1'\nfrom = 20\nto = 30\namplitude = 1\n{PULSE_TIME_FUNCTION}\n"
            )),
            "no face of the side has its middle in it",
        ),
        (
            format_classical_case(&format!(
                "[[source]]\nkind = 'moment'\namplitude = [[0, 1], [2, 0]]\nat = [4, 4]\n{PULSE_TIME_FUNCTION}\n"
            )),
            "not symmetric in a classical solid",
        ),
        (
            format_classical_case(
                "[[initial]]\nkind = 'plane-wave'\nbranch = 3\nwavelength = 2\namplitude = 1\n",
            ),
            "branch",
        ),
        (
            format_classical_case(
                "[gravity]\nacceleration = [-9.81, 0]\n[[region]]\nshape = 'layer'\naxis = 2\nfrom = 0\nto = 5\n[[region]]\nshape = 'rest'\nmodel = { density = 1000 }\n",
            ),
            "densities 1900 and 1000 side by side",
        ),
        (
            format_classical_case(
                "[initial_stress]\nsigma12 = 1e9\n[yield]\nkind = 'von-mises'\nstrength = 1e6\n",
            ),
            "beyond yield",
        ),
        (
            format_classical_case("[yield]\nkind = 'von-mises'\nstrength = 1e6\nhardening = 1e6\n"),
            "ideal plasticity",
        ),
        (format_classical_case("").replace("duration = 0.01", "duration = 1e300"), "10¹² steps"),
    ]);
}

#[test]
fn unsupported_states_are_refused() {
    check_refusals([
        (
            format_classical_case("[output]\npicture = 'dissipation'\n"),
            "'dissipation' in elastic media",
        ),
        (
            format_classical_case(&format!(
                "[[load]]\nside = 'x2+'\nfield = 'sigma22'\namplitude = 1\n{PULSE_TIME_FUNCTION}\n[[load]]\nside = \
                 'x2+'\nfield = 'v2'\namplitude = 1\n{PULSE_TIME_FUNCTION}\n"
            )),
            "load[1].field: v2 on faces with another load",
        ),
        (
            format_classical_case(
                "[yield]\nkind = 'drucker-prager'\nstrength = 1\nfriction = 0.5\ndilatancy = 0.1\n",
            ),
            "expected 0.5, the friction",
        ),
        (
            format_classical_case(
                "[yield]\nkind = 'von-mises'\nstrength = 1\n[[initial]]\nkind = 'uniform'\nshape = \
                 'everywhere'\nfield = 'sigma12'\namplitude = 2\n",
            ),
            "initial: a stress beyond yield in the cell at [0.5, 0.5]",
        ),
        (
            format!(
                "{}[grid]\ncells = [8, 4, 4]\nspacing = 1\n[time]\nduration = 0.01\n[[initial]]\nkind = \
                 'plane-wave'\nbranch = 4\nwavelength = 8\namplitude = 1\n",
                COSSERAT_MODEL.replace("dimensions = 2", "dimensions = 3")
            ),
            "a branch that moves nothing but spins",
        ),
    ]);
}

/// Verifies that a case larger than the free memory is refused, on systems that report free memory.
#[test]
fn runs_larger_than_free_memory_are_refused() {
    if Path::new("/proc/meminfo").exists() {
        let case = format!(
            "{CLASSICAL_MODEL}[grid]\ncells = [60000, 60000]\nspacing = 1\n[time]\nduration = 1\n"
        );
        let message = refusal_message(&case);
        assert!(message.contains("GiB that are free; ask for fewer cells"), "{message}");
    }
}

/// Verifies that later boundary sections override earlier ones, and that a source at a periodic boundary acts on both
/// sides of it.
#[test]
fn later_boundary_sections_override_and_periodic_sources_act_on_both_sides() {
    let run_with_source = |boundaries: &str, at: &str| {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let case = format!(
            "{CLASSICAL_MODEL}[grid]\ncells = [16, 16]\nspacing = 1\n[time]\nduration = 0.03\n{boundaries}
            [[source]]\nkind = 'explosion'\namplitude = 1e6\nat = {at}\nradius = 4\n\
            time = {{ kind = 'pulse', duration = 0.02 }}\n"
        );
        run_in_folder(folder.path(), &case).expect("a sound case");
        read_arrays_by_name(&folder.path().join("out/fields.npz"))
            .remove("sigma11")
            .expect("an array")
    };
    let format_boundaries = |kind: &str| {
        format!(
            "[[boundary]]\nside = 'x1-'\nkind = '{kind}'\n[[boundary]]\nside = 'x1+'\nkind = '{kind}'\n"
        )
    };
    let (periodic, free) = (format_boundaries("periodic"), format_boundaries("free"));
    let overridden = format!("{periodic}{free}");
    assert_eq!(run_with_source(&overridden, "[3, 8]"), run_with_source(&free, "[3, 8]"));
    let [edge, middle] = ["[0, 8]", "[8, 8]"].map(|at| run_with_source(&periodic, at));
    for row in 0..16 {
        for column in 0..16 {
            let [a, b] = [edge[16 * row + column], middle[16 * row + (column + 8) % 16]];
            assert!((a - b).abs() < 1e-9 * 1e6, "{row} {column}: {a} {b}");
        }
    }
}

/// Verifies that results in single and double precision agree to single precision.
#[test]
fn single_precision_agrees_with_double_precision() {
    let records = ["f64", "f32"].map(|precision| {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let case = format_layered_case(LOAD_AND_SOURCE)
            .replace("[scheme]", &format!("[scheme]\nprecision = '{precision}'"));
        run_in_folder(folder.path(), &case).expect("a sound case");
        let records = read_columns(&folder.path().join("out/receivers.csv"));
        column_values(&records, "edge.v2").to_vec()
    });
    let largest = records[0].iter().fold(0.0f64, |a, b| a.max(b.abs()));
    for (double, single) in records[0].iter().zip(&records[1]) {
        assert!((double - single).abs() < 1e-3 * largest, "{double} {single}");
    }
}

/// Verifies that receivers record the requested fields, including time integrals, and no others.
#[test]
fn receivers_record_only_requested_fields() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case = format_layered_case(LOAD_AND_SOURCE).replace(
        "name = 'edge'",
        "at = [0, -1]\nfields = ['v1']\n[[receiver]]\nat = [0, -2]\nfields = ['u2', 'sigma22']\n\
         [[receiver]]\nname = 'edge'",
    ) + "[output]\nintegrals = ['u2']\n";
    run_in_folder(folder.path(), &case).expect("a sound case");
    let records = read_columns(&folder.path().join("out/receivers.csv"));
    let names: Vec<&str> = records.iter().map(|column| column.0.as_str()).collect();
    assert_eq!(names[..4], ["time", "r1.v1", "r2.u2", "r2.sigma22"]);
    assert_eq!((names.len(), names[names.len() - 1]), (11, "edge.u2"));
    // The final time equals the duration of the case, to the last bit.
    let json = fs::read(folder.path().join("out/run.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    assert_eq!((report["time"].as_f64(), records[0].1.last()), (Some(0.05), Some(&0.05)));
}

/// Verifies that a dry run checks the complete case and writes nothing.
#[test]
fn dry_run_writes_nothing() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let case = create_run_options(folder.path(), &format_layered_case(LOAD_AND_SOURCE));
    let text = run_case(&Options { is_dry_run: true, ..case }).expect("a sound case");
    assert!(text.contains("30 × 24 cells of 6 fields") && text.contains("run.png"), "{text}");
    assert!(!folder.path().join("out").exists());
}

/// A pressure of 400 times λ + 2μ at the end of a column gives a strain of about 400: the report says so.
#[test]
fn large_strains_are_reported() {
    let case = |pressure: f64| {
        format!(
            "{CLASSICAL_MODEL}
[grid]
cells = [40, 1]
spacing = 1
[time]
duration = 0.04
[[boundary]]
side = 'x2-'
kind = 'periodic'
[[boundary]]
side = 'x2+'
kind = 'periodic'
[[load]]
side = 'x1-'
field = 'sigma11'
amplitude = -{pressure}
time = {{ kind = 'pulse', duration = 0.08 }}
"
        )
    };
    let folder = tempfile::tempdir().expect("a scratch folder");
    let text = run_in_folder(folder.path(), &case(400.0 * 2.8e8)).expect("a run");
    let report = fs::read_to_string(folder.path().join("out/run.json")).expect("a report");
    let report: serde_json::Value = serde_json::from_str(&report).expect("JSON");
    // The stress of a plane wave is at most the load: a strain −p/(λ + 2μ).
    let strain = report["large_strain"].as_f64().expect("a large strain");
    assert!((200.0..=440.0).contains(&strain), "{strain}");
    assert!(text.contains("warning: strains of about "), "{text}");
    let folder = tempfile::tempdir().expect("a scratch folder");
    let text = run_in_folder(folder.path(), &case(2.8e5)).expect("a run");
    assert!(!text.contains("warning"), "{text}");
}
