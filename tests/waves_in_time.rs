//! Verifies the bundled time-domain wave cases, and shorter variants, against dispersion relations and an exact
//! response that are independent of the solver.

use crate::support;

use num_complex::Complex64;
use serde_json::Value;
use std::f64::consts::PI;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use support::{
    COSSERAT_MODEL, Columns, bundled_case, column_values, format_periodic_boundaries,
    read_arrays_by_name, read_columns, run_case,
};
use wellposed::cli::{self, Options, OutputFormat};

/// Results of a run, with the temporary folder that contains its files.
struct WaveRun {
    folder: tempfile::TempDir,
    /// Columns of the receiver table.
    columns: Columns,
}

impl WaveRun {
    fn column(&self, name: &str) -> &[f64] {
        column_values(&self.columns, name)
    }

    /// Reads the final values of a field.
    fn final_field(&self, name: &str) -> Vec<f64> {
        read_arrays_by_name(&self.folder.path().join("out/fields.npz"))
            .remove(name)
            .expect("a field")
    }

    fn read_report(&self) -> Value {
        let text = fs::read(self.folder.path().join("out/run.json")).expect("a report");
        serde_json::from_slice(&text).expect("JSON")
    }
}

fn create_options(file: PathBuf, folder: &Path, sets: &[String]) -> Options {
    Options {
        case_path: file,
        settings: sets.to_vec(),
        output_folder: Some(folder.join("out")),
        thread_count: Some(1),
        force: true,
        ..Options::default()
    }
}

/// Runs a case file with settings and reads the receiver table.
fn run_case_file(file: PathBuf, sets: &[String]) -> WaveRun {
    let folder = tempfile::tempdir().expect("a scratch folder");
    run_case(&create_options(file, folder.path(), sets)).expect("a sound case");
    let columns = read_columns(&folder.path().join("out/receivers.csv"));
    WaveRun { folder, columns }
}

/// Computes polarisation and angular frequency, rad/s, of all branches at the wave vector of a case, by descending
/// frequency, with `wellposed dispersion`.
fn compute_branches(file: PathBuf, sets: &[String]) -> Vec<(String, f64)> {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let options =
        Options { format: OutputFormat::Json, ..create_options(file, folder.path(), sets) };
    let mut stdout = Vec::new();
    cli::run_dispersion(&options, &mut stdout).expect("a sound case");
    let report: Value = serde_json::from_slice(&stdout).expect("JSON");
    let mut branches = Vec::new();
    for family in report["families"].as_array().expect("families") {
        let name = family["polarisation"].as_str().expect("a name");
        for branch in family["at_wave"].as_array().expect("branches") {
            let frequency = branch["frequency"].as_f64().expect("a number");
            for _ in 0..family["count"].as_u64().expect("a count") {
                branches.push((name.to_owned(), frequency));
            }
        }
    }
    branches.sort_by(|a, b| b.1.total_cmp(&a.1));
    branches
}

/// Weight of a sample as a function of its relative position in the interval, in (0, 1).
type WindowFunction = fn(f64) -> f64;
const UNIFORM_WINDOW: WindowFunction = |_| 1.0;
/// Hann window, sin²(π position).
const HANN_WINDOW: WindowFunction = |position| (PI * position).sin().powi(2);

/// Returns the complex amplitude A of Re A exp(−iωt), ω = `frequency`, by weighted least squares.
fn fit_harmonic(time: &[f64], values: &[f64], frequency: f64, window: WindowFunction) -> Complex64 {
    let count = time.len() as f64;
    let (mut cc, mut cs, mut ss, mut c, mut s) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (index, (t, value)) in time.iter().zip(values).enumerate() {
        let weight = window((index as f64 + 0.5) / count);
        let (sin, cos) = (frequency * t).sin_cos();
        cc += weight * cos * cos;
        cs += weight * cos * sin;
        ss += weight * sin * sin;
        c += weight * cos * value;
        s += weight * sin * value;
    }
    let determinant = cc * ss - cs * cs;
    Complex64::new((ss * c - cs * s) / determinant, (cc * s - cs * c) / determinant)
}

/// Returns the indices of the samples in a time interval.
fn sample_range(time: &[f64], from: f64, to: f64) -> Range<usize> {
    time.partition_point(|t| *t < from)..time.partition_point(|t| *t < to)
}

/// Returns slope and intercept of the least-squares line.
fn fit_line(x: &[f64], y: &[f64]) -> [f64; 2] {
    let count = x.len() as f64;
    let (mx, my) = (x.iter().sum::<f64>() / count, y.iter().sum::<f64>() / count);
    let pairs = || x.iter().zip(y).map(|(x, y)| (x - mx, y - my));
    let slope = pairs().map(|(x, y)| x * y).sum::<f64>() / pairs().map(|(x, _)| x * x).sum::<f64>();
    [slope, my - slope * mx]
}

/// Verifies the bundled wave after one period (the duration): velocities and spin against the equations of motion.
#[test]
fn oblique_wave_returns_after_one_period() {
    let (mu, alpha, density): (f64, f64, f64) = (8.1e9, 1.005e9, 2700.0);
    let file = bundled_case("dynamics/plane-waves.toml");
    let frequency = compute_branches(file.clone(), &[])
        .into_iter()
        .rfind(|branch| branch.0 == "transverse")
        .expect("shear waves")
        .1;
    let results = run_case_file(file, &[]);
    let duration = results.read_report()["time"].as_f64().expect("a number");
    assert!((duration * frequency / (2.0 * PI) - 1.0).abs() < 1e-12, "{}", 2.0 * PI / frequency);
    // Exact v = A(4, −3)/5 cos(k·x) and ω₃ = A((μ + α)k² − ρω²)/(2αk) sin(k·x).
    let k = 2.0 * PI / 12.0;
    let spin = ((mu + alpha) * k * k - density * frequency * frequency) / (2.0 * alpha * k);
    let [x1, x2] = ["x1", "x2"].map(|name| results.final_field(name));
    for (name, factor, delay) in [("v1", 0.8, 0.0), ("v2", -0.6, 0.0), ("w3", spin, 0.5 * PI)] {
        let values = results.final_field(name);
        let mut max_difference = 0.0f64;
        let places = x2.iter().flat_map(|x2| x1.iter().map(move |x1| (x1, x2)));
        for ((x1, x2), value) in places.zip(&values) {
            let expected = 1e-3 * factor * (k * (0.6 * x1 + 0.8 * x2) - delay).cos();
            max_difference = max_difference.max((value - expected).abs());
        }
        let error = max_difference / (1e-3 * factor.abs());
        println!("{name}: {error:.2e}");
        assert!(error < 3e-3, "{name}: {error:e}");
    }
}

/// Returns the amplitude of an oscillating vector, and the sum of squares of the residuals.
fn fit_oscillation(time: &[f64], signals: &[&[f64]], frequency: f64) -> (f64, f64) {
    let (mut power, mut squared_residual) = (0.0, 0.0);
    for signal in signals {
        let amplitude = fit_harmonic(time, signal, frequency, UNIFORM_WINDOW);
        power += amplitude.norm_sqr();
        let residual = |(t, v): (&f64, &f64)| v - (amplitude * Complex64::cis(-frequency * t)).re;
        squared_residual +=
            time.iter().zip(*signal).map(|pair| residual(pair).powi(2)).sum::<f64>();
    }
    (power.sqrt(), squared_residual)
}

/// Verifies all waves along (1, 2, 2)/3 in three dimensions, except torsion, which has no velocity: the receiver
/// record of one and a half periods has the predicted frequency and the initial amplitude.
#[test]
fn oblique_waves_have_predicted_frequencies() {
    let model = COSSERAT_MODEL.replace("dimensions = 2", "dimensions = 3");
    let sections = "
        [wave]
        number = 0.5235987755982988
        direction_deg = 63.43494882292201
        elevation_deg = 41.810314895778596
        [grid]
        cells = [72, 36, 36]
        spacing = 0.5
        [time]
        duration = 0.001
        [[initial]]
        kind = 'plane-wave'
        branch = 1
        direction_deg = 63.43494882292201
        elevation_deg = 41.810314895778596
        wavelength = 12
        amplitude = 1e-3
        [[receiver]]
        at = [10.25, 7.75, 3.25]
        fields = ['v1', 'v2', 'v3']
        ";
    let boundaries = format_periodic_boundaries(&["x1-", "x1+", "x2-", "x2+", "x3-", "x3+"]);
    let folder = tempfile::tempdir().expect("a scratch folder");
    let file = folder.path().join("case.toml");
    fs::write(&file, format!("{model}{sections}{boundaries}")).expect("a scratch file");
    let branches = compute_branches(file.clone(), &[]);
    assert_eq!(branches.len(), 6);
    for (index, (polarisation, frequency)) in branches.iter().enumerate() {
        // One of both waves of the same frequency, which differ in polarisation only.
        let is_second = index > 0 && (branches[index - 1].1 / frequency - 1.0).abs() < 1e-9;
        if polarisation == "torsion" || is_second {
            continue;
        }
        let sets = [
            format!("initial[0].branch={}", index + 1),
            format!("time.duration={:?}", 3.0 * PI / frequency),
        ];
        let results = run_case_file(file.clone(), &sets);
        let time = results.column("time");
        let signals = ["r1.v1", "r1.v2", "r1.v3"].map(|name| results.column(name));
        // Golden-section search for the frequency with the smallest residual.
        let squared_residual = |ratio: f64| fit_oscillation(time, &signals, ratio * frequency).1;
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let (mut a, mut b) = (0.9, 1.1);
        while b - a > 1e-6 {
            let (c, d) = (b - golden * (b - a), a + golden * (b - a));
            if squared_residual(c) < squared_residual(d) { b = d } else { a = c }
        }
        let ratio = 0.5 * (a + b);
        let amplitude = fit_oscillation(time, &signals, ratio * frequency).0;
        println!("{polarisation} {frequency:.1}: {:.2e} {amplitude:e}", ratio - 1.0);
        assert!((ratio - 1.0).abs() < 2e-3, "{polarisation}: {ratio}");
        assert!((amplitude / 1e-3 - 1.0).abs() < 3e-2, "{polarisation}: {amplitude:e}");
    }
}

/// Returns the squared wave number k² of shear waves in the reduced Cosserat solid of the bundled case, 1/m².
fn squared_wave_number(frequency: f64) -> f64 {
    let (mu, alpha, density, inertia): (f64, f64, f64, f64) = (8.1e9, 1.005e9, 2700.0, 2700.0);
    let square = frequency * frequency;
    density * square * (4.0 * alpha - inertia * square)
        / (4.0 * alpha * mu - (mu + alpha) * inertia * square)
}

/// Returns depths, m, and complex amplitudes of v₁ at these depths under a harmonic load of angular `frequency`, rad/s,
/// from a time interval, s.
fn fit_amplitudes(
    results: &WaveRun,
    frequency: f64,
    [from, to]: [f64; 2],
) -> Vec<(f64, Complex64)> {
    let time = results.column("time");
    let span = sample_range(time, from, to);
    let report = results.read_report();
    let receivers = report["receivers"].as_array().expect("receivers");
    receivers
        .iter()
        .map(|receiver| {
            let name = receiver["name"].as_str().expect("a name");
            let depth = -receiver["cell"][1].as_f64().expect("a number");
            let values = &results.column(&format!("{name}.v1"))[span.clone()];
            (depth, fit_harmonic(&time[span.clone()], values, frequency, HANN_WINDOW))
        })
        .collect()
}

/// Verifies evanescent motion exp(−κd) in the bundled column against κ and the amplitude from the equations of
/// motion.
#[test]
fn motion_in_band_gap_decays_with_depth() {
    let results = run_case_file(bundled_case("dynamics/driven-column.toml"), &[]);
    let frequency = 2.0 * PI * 188.5;
    let number = (-squared_wave_number(frequency)).sqrt();
    // Waves at the band edges beat with the load at a period of 0.18 s; the window separates them.
    let amplitudes = fit_amplitudes(&results, frequency, [0.1, 0.7]);
    let depths: Vec<f64> = amplitudes.iter().map(|entry| entry.0).collect();
    let logarithms: Vec<f64> = amplitudes.iter().map(|entry| entry.1.norm().ln()).collect();
    for (depth, amplitude) in &amplitudes {
        println!("{depth:.3} m: {:.4e} at {:.4}", amplitude.norm(), amplitude.arg());
    }
    let [slope, start] = fit_line(&depths, &logarithms);
    let expected = number * 1e5 / (2700.0 * frequency);
    println!(
        "decay {} for {}, amplitude {:e} for {expected:e}",
        -1.0 / slope,
        1.0 / number,
        start.exp()
    );
    assert!((-slope / number - 1.0).abs() < 0.01, "{} for {number}", -slope);
    assert!((start.exp() / expected - 1.0).abs() < 0.02, "{:e} for {expected:e}", start.exp());
    // Equal phases: no energy is transported downwards.
    let phases: Vec<f64> =
        amplitudes.iter().map(|entry| (entry.1 / amplitudes[0].1).arg().abs()).collect();
    assert!(phases.iter().all(|phase| *phase < 0.05), "{phases:?}");
}

/// Verifies that below and above the band the same load generates waves with phase speed ω/k that do not decay.
#[test]
fn waves_outside_band_gap_propagate_without_decay() {
    for load in [160.0, 223.0] {
        // Before reflections from the bottom arrive: (2·290 − 5) m/(1836 m/s) = 0.31 s.
        let sets = [
            format!("load[0].time.frequency={load:?}"),
            "time.duration=0.3".into(),
            "grid.spacing=[2.5, 0.2]".into(),
            "grid.cells=[1, 1450]".into(),
            "grid.origin=[0, -290]".into(),
        ];
        let results = run_case_file(bundled_case("dynamics/driven-column.toml"), &sets);
        let frequency = 2.0 * PI * load;
        let number = squared_wave_number(frequency).sqrt();
        let amplitudes = fit_amplitudes(&results, frequency, [0.1, 0.3]);
        let expected = number * 1e5 / (2700.0 * frequency);
        let (mut phase, mut last) = (0.0, amplitudes[0].1);
        let (mut depths, mut phases) = (Vec::new(), Vec::new());
        for (depth, amplitude) in &amplitudes {
            phase += (amplitude / last).arg();
            last = *amplitude;
            depths.push(*depth);
            phases.push(phase);
            println!(
                "{load} Hz, {depth:.3} m: {:.4} of it, {phase:.4}",
                amplitude.norm() / expected
            );
            assert!((amplitude.norm() / expected - 1.0).abs() < 0.02, "{depth}: {amplitude}");
            assert!((amplitude.norm() / amplitudes[0].1.norm() - 1.0).abs() < 0.1);
        }
        let [slope, _] = fit_line(&depths, &phases);
        println!("phase speed {} for {}", frequency / slope, frequency / number);
        assert!((slope / number - 1.0).abs() < 0.02, "{slope} for {number}");
    }
}

/// Boundary condition at the surface of a half-space, in addition to the couple.
#[derive(Clone, Copy)]
enum SurfaceCondition {
    /// Zero displacement along x₁: v₁ = 0.
    FixedDisplacement,
    /// Zero shear traction: σ₁₂ = 0.
    ShearFree,
}

/// Constants of the bundled half-space in SI units: ρ, j, μ, α, γ + η.
const HALF_SPACE_CONSTANTS: [f64; 5] = [2000.0, 8.0, 2e8, 1e8, 7.2e5];

/// Returns the Laplace transform of the spin at a depth, m, due to a unit couple on the surface, for the variable s.
///
/// With u₁ = U e^(−qd), φ₃ = P e^(−qd) at depth d and m₃₂ = 1 at d = 0:
///
/// ```text
/// (ρs² − (μ + α)q²) U − 2αq P = 0,    (js² + 4α − (γ + η)q²) P + 2αq U = 0.
/// ```
fn spin_laplace_transform(s: Complex64, depth: f64, surface: SurfaceCondition) -> Complex64 {
    let [density, inertia, mu, alpha, couple] = HALF_SPACE_CONSTANTS;
    let (sum, square) = (mu + alpha, s * s);
    // Quadratic equation A q⁴ + B q² + C = 0 for q².
    let stiffness = inertia * square + 4.0 * alpha;
    let a = sum * couple;
    let b = 4.0 * alpha * alpha - sum * stiffness - density * couple * square;
    let c = density * square * stiffness;
    let root = (b * b - 4.0 * a * c).sqrt();
    let sum_of = if (root - b).norm() > (root + b).norm() { root - b } else { -root - b };
    let first = sum_of / (2.0 * a);
    let waves = [first, c / (a * first)].map(|square_q: Complex64| {
        let q = square_q.sqrt();
        let displacement = 2.0 * alpha * q / (density * square - sum * square_q);
        let held = match surface {
            SurfaceCondition::FixedDisplacement => displacement,
            SurfaceCondition::ShearFree => sum * q * displacement + 2.0 * alpha,
        };
        (q, held)
    });
    let [(q1, held1), (q2, held2)] = waves;
    // Ratio of the two solutions that satisfies the boundary condition.
    let ratio = -held1 / held2;
    let moment = couple * (q1 + q2 * ratio);
    s * ((-q1 * depth).exp() + ratio * (-q2 * depth).exp()) / moment
}

/// Computes the spin due to a couple sin(ωt) that starts at t = 0, by numerical inversion of the Laplace transform with
/// a Fourier series (Dubner & Abate 1968); error 10⁻⁶ of the maximum.
fn exact_spin(times: &[f64], frequency: f64, depth: f64, surface: SurfaceCondition) -> Vec<f64> {
    const TERM_COUNT: usize = 20_000;
    let half = 2.0 * times.iter().copied().fold(0.0, f64::max);
    let shift = 7.0 / half;
    let terms: Vec<Complex64> = (0..=TERM_COUNT)
        .map(|index| {
            let s = Complex64::new(shift, PI * index as f64 / half);
            let weight = if index == 0 { 0.5 } else { 1.0 };
            weight * frequency / (s * s + frequency * frequency)
                * spin_laplace_transform(s, depth, surface)
        })
        .collect();
    let at = |t: &f64| {
        let turn = Complex64::cis(PI * t / half);
        // The sum is evaluated by the Horner scheme.
        let sum = terms.iter().rev().fold(Complex64::default(), |sum, term| sum * turn + term);
        (shift * t).exp() / half * sum.re
    };
    times.iter().map(at).collect()
}

/// Verifies the bundled half-space driven at its natural frequency, at 1.5 times this frequency, and with a
/// shear-free surface, in half of its duration and to half of its depth.
#[test]
fn half_space_resonates_at_natural_rotation_frequency() {
    let natural_frequency = (4.0 * HALF_SPACE_CONSTANTS[3] / HALF_SPACE_CONSTANTS[1]).sqrt();
    let period = 2.0 * PI / natural_frequency;
    let run_and_fit = |ratio: f64, surface: SurfaceCondition| {
        // Cells twice as large as in the case: computing time is a quarter.
        let mut sets = vec![
            "grid.cells=[1, 875]".to_owned(),
            "grid.spacing=[0.8, 0.004]".to_owned(),
            "grid.origin=[0, -3.5]".to_owned(),
            format!("time.duration={:?}", 20.0 * period),
            format!("load[0].time.frequency={:?}", ratio / period),
        ];
        if let SurfaceCondition::ShearFree = surface {
            sets.push("boundary[2].fixed_components=[\"v2\"]".into());
        }
        let results = run_case_file(bundled_case("dynamics/resonance.toml"), &sets);
        let time = results.column("time");
        assert!((time[time.len() - 1] / (20.0 * period) - 1.0).abs() < 1e-5);
        let values = results.column("surface.w3");
        // Intervals of two natural periods contain full periods of both loads, so that natural oscillations do not
        // leak into the other frequency.
        let mut rows = Vec::new();
        for pair in 1..10 {
            let [from, to] = [2 * pair, 2 * pair + 2].map(|count| f64::from(count) * period);
            let span = sample_range(time, from, to - 1e-9 * period);
            let exact = exact_spin(&time[span.clone()], ratio * natural_frequency, 0.002, surface);
            let amplitude = |values: &[f64]| {
                fit_harmonic(&time[span.clone()], values, ratio * natural_frequency, UNIFORM_WINDOW)
                    .norm()
            };
            rows.push([0.5 * (from + to), amplitude(&values[span.clone()]), amplitude(&exact)]);
        }
        rows
    };
    let exponent = |rows: &[[f64; 3]], column: usize| {
        let logarithms =
            |column: usize| rows.iter().map(|row| row[column].ln()).collect::<Vec<_>>();
        fit_line(&logarithms(0), &logarithms(column))[0]
    };
    let last = |rows: &[[f64; 3]]| rows[rows.len() - 1];

    let [slow, fast, free] = [
        (1.0, SurfaceCondition::FixedDisplacement),
        (1.5, SurfaceCondition::FixedDisplacement),
        (1.0, SurfaceCondition::ShearFree),
    ]
    .map(|(ratio, surface)| run_and_fit(ratio, surface));
    for (name, rows) in [("own", &slow), ("1.5", &fast), ("free", &free)] {
        for [time, found, expected] in rows {
            println!(
                "{name} {:.0} periods: {found:.4e} {expected:.4e} {:.4}",
                time / period,
                found / expected
            );
            assert!((found / expected - 1.0).abs() < 0.01, "{name}: {found:e} for {expected:e}");
        }
    }
    // Fit to the rows from that centred at 5 periods to that centred at 19 periods.
    let [found, expected] = [1, 2].map(|column| exponent(&slow[1..], column));
    println!("exponent {found} for {expected}");
    assert!((found - expected).abs() < 0.01, "{found} for {expected}");
    assert!((expected - 0.5).abs() < 0.05, "{expected}");
    for column in [1, 2] {
        println!("bounded {}", exponent(&fast[1..], column));
        assert!(exponent(&fast[1..], column).abs() < 0.05);
        assert!(exponent(&free[1..], column) < 0.1);
    }
    let [found, expected] = [1, 2].map(|column| last(&slow)[column] / last(&fast)[column]);
    println!("factor {found} for {expected}");
    assert!(expected > 5.0 && (found / expected - 1.0).abs() < 0.02, "{found} for {expected}");
}

/// Column of 200 cells of 0.1 m whose lower side is loaded by normal and tangential traction; P waves, 2 m/s, are twice
/// as fast as S waves. The receiver is in the middle of the cell 50.
const LOADED_COLUMN: &str = "[model]\nkind = 'classical'\nlambda = 4\nmu = 2\ndensity = 2\n\
    [grid]\ncells = [200, 3]\nspacing = 0.1\n\
    [time]\nduration = 12\ncourant = 1\ncourant_of = 's'\n\
    [[boundary]]\nside = 'x1+'\nkind = 'non-reflecting'\n\
    [[boundary]]\nside = 'x2-'\nkind = 'periodic'\n\
    [[boundary]]\nside = 'x2+'\nkind = 'periodic'\n\
    [[load]]\nside = 'x1-'\nfield = 'sigma11'\namplitude = 3\ntime = { kind = 'sine', frequency = 0.6 }\n\
    [[load]]\nside = 'x1-'\nfield = 'sigma12'\namplitude = 2\ntime = { kind = 'sine', frequency = 0.4 }\n\
    [[receiver]]\nname = 'r'\nat = [5.05, 0.15]\nfields = ['v1', 'v2']\n";

/// Verifies that with `courant_of = 's'` both families of waves reach a receiver as exact plane waves: the cell shows
/// the traction in the middle of a sweep at the side, after one cell per sweep.
#[test]
fn waves_of_both_families_are_exact_with_courant_of_shear_waves() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let file = folder.path().join("column.toml");
    fs::write(&file, LOADED_COLUMN).expect("a writable folder");
    let results = run_case_file(file, &[]);
    let time = results.column("time");
    // Records after whole steps of the shear waves, of two sweeps by one cell each.
    assert!(time.iter().enumerate().all(|(index, t)| (t - 0.2 * index as f64).abs() < 1e-12));
    let mut max_error = 0.0f64;
    for (column, speed, amplitude, frequency) in [("r.v1", 2.0, 3.0, 0.6), ("r.v2", 1.0, 2.0, 0.4)]
    {
        for (t, value) in time.iter().zip(results.column(column)) {
            let phase = 2.0 * PI * frequency * (t - 5.05 / speed).max(0.0);
            let expected = -amplitude / (2.0 * speed) * phase.sin();
            max_error = max_error.max((value - expected).abs());
        }
    }
    println!("{max_error}");
    assert!(max_error < 1e-11, "{max_error}");
    let report = results.read_report();
    assert_eq!(report["steps"], 120);
}

/// Verifies that media and joints whose shear waves cannot have steps of their own are refused with place and remedy.
#[test]
fn impossible_courant_numbers_of_shear_waves_are_refused() {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let blocks = "[model]\nkind = 'classical'\nlambda = 4\nmu = 2\ndensity = 2\n\
        [[block]]\ncells = [4, 4]\nsize = 1\nrepeat = [2, 2]\n\
        [[joint]]\nevery = 'all'\nkind = 'cracked'\nthickness = 0.01\ndensity = 1\nlongitudinal_speed = 1\n\
        shear_speed = 0.5\n\
        [time]\nduration = 1\ncourant_of = 's'\n";
    let cosserat = format!(
        "{COSSERAT_MODEL}[grid]\ncells = [4, 4]\nspacing = 1\n[time]\nduration = 1\ncourant_of = 's'\n"
    );
    for (text, settings, expected) in [
        (
            LOADED_COLUMN,
            "model.lambda=5",
            ":12: time.courant_of: the ratio c1/c2 = 2.1213203435596424 / 1 is 2.1213203435596424; expected c1/c2 = 2 or 3",
        ),
        (
            blocks,
            "",
            "time.courant_of: joints of the kind cracked; expected joints whose normal and",
        ),
        (&cosserat, "", "time.courant_of: the solid has spins; expected c1/c2 = 2 or 3"),
        (LOADED_COLUMN, "scheme.splitting=alternating", "scheme.splitting: found 'alternating'; "),
        (
            &format!(
                "{LOADED_COLUMN}[[source]]\nkind = 'force'\namplitude = [1, 0]\nat = [5, 0.15]\n\
                time = {{ kind = 'pulse', duration = 1 }}\n"
            ),
            "",
            "source[0]: found the kernel spline; with time.courant_of = \"s\" expected a bell of at least 12 cells",
        ),
    ] {
        let file = folder.path().join("case.toml");
        fs::write(&file, text).expect("a writable folder");
        let sets: Vec<String> = settings.split_whitespace().map(str::to_owned).collect();
        let error = run_case(&create_options(file, folder.path(), &sets)).expect_err(settings);
        let error = error.to_string();
        assert!(error.contains(expected), "{error}");
        assert!(!folder.path().join("out").exists());
    }
}
