//! Tests of loads on the surface of half-planes and half-spaces with the bundled cases: against exact Rayleigh waves
//! and a quadrature over wave numbers, in three dimensions with a rigid block, and with yielding on three grids.

use crate::reference;
use crate::support;

use num_complex::Complex64;
use reference::{IsotropicSolid, REFERENCE_SOLID, RICKER};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::fs;
use support::{bundled_case, read_arrays_by_name, read_columns, run_case};
use wellposed::cli::Options;

/// Results of a run of a bundled case, by name of the column or field.
struct HalfSpaceRun {
    fields: HashMap<String, Vec<f64>>,
    receivers: HashMap<String, Vec<f64>>,
    ledger: HashMap<String, Vec<f64>>,
    /// Names of the result files.
    file_names: Vec<String>,
}

/// Runs a bundled case with settings and reads its results.
fn run_bundled_case(name: &str, sets: &[String]) -> HalfSpaceRun {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let out = folder.path().join("out");
    let options = Options {
        case_path: bundled_case(&format!("dynamics/{name}.toml")),
        settings: sets.to_vec(),
        output_folder: Some(out.clone()),
        thread_count: Some(1),
        ..Options::default()
    };
    run_case(&options).expect("a sound case");
    let files = fs::read_dir(&out).expect("results");
    HalfSpaceRun {
        fields: read_arrays_by_name(&out.join("fields.npz")),
        receivers: read_arrays_by_name(&out.join("receivers.npz")),
        ledger: read_columns(&out.join("ledger.csv")).into_iter().collect(),
        file_names: files.map(|f| f.expect("a file").file_name().into_string().unwrap()).collect(),
    }
}

/// Returns the maximum magnitude of values.
fn max_magnitude(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |max, value| max.max(value.abs()))
}

/// Returns the time, s, of the maximum magnitude, from the parabola through the maximum and its neighbours.
fn peak_time(time: &[f64], values: &[f64]) -> f64 {
    let middle = (1..values.len() - 1).max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()));
    let middle = middle.expect("values");
    let [a, b, c] = [-1, 0, 1].map(|i: isize| values[middle.strict_add_signed(i)]);
    time[middle] + time[1] * 0.5 * (a - c) / (a - 2.0 * b + c)
}

/// Amplitude of the load of `lamb-2d.toml` on the half-plane [`REFERENCE_SOLID`], N/m; its time function is [`RICKER`].
const LOAD_AMPLITUDE: f64 = -1e5;
/// Radius of the bell over which this load is distributed, m.
const LOAD_RADIUS: f64 = 1.0;

/// Computes the displacements u₁ and u₂, m, at points due to a force on the surface x₂ = 0, distributed as the bell,
/// with the Ricker time function: by Fourier transform along x₁ and Laplace transform in time (Lamb 1904).
///
/// Potentials φ = A exp(q_p x₂) and ψ = B exp(q_s x₂), with q² = k² + s²/c², satisfy zero shear stress and the
/// pressure of the load on the surface. The sum over k represents a spatially periodic load; its period is so
/// large that waves of the images do not arrive. The sum over s = a + iω represents a motion repeated after the
/// time T, twice the requested duration, and reduced by the factor exp(−aT).
fn compute_displacements(
    solid: &IsotropicSolid,
    time: &[f64],
    points: &[[f64; 2]],
) -> Vec<[Vec<f64>; 2]> {
    let [p, s] = [solid.pressure_speed(), solid.shear_speed()];
    let period = 2.0 * time[time.len() - 1];
    let shift = 8.0 / period;
    let length = 2.0 * p * period;
    let spacing = 2.0 * PI / length;
    // At five times its frequency the Ricker spectrum is reduced to e⁻²⁵; the spectrum of the bell is truncated
    // at 10⁻³.
    let [rates, numbers] =
        [5.0 * RICKER.frequency * period, 6.0 * PI / LOAD_RADIUS / spacing].map(|n| n as usize);
    let zero = Complex64::ZERO;
    let mut sums = vec![[vec![zero; rates], vec![zero; rates]]; points.len()];
    let rate = |index: usize| Complex64::new(shift, 2.0 * PI * index as f64 / period);
    for index in 0..rates {
        let s_rate = rate(index);
        let (steps, step) = (4000, period / 4000.0);
        let load: Complex64 = (0..steps)
            .map(|i| {
                let t = f64::from(i) * step;
                let a = (PI * RICKER.frequency * (t - 1.5 / RICKER.frequency)).powi(2);
                (1.0 - 2.0 * a) * (-a).exp() * step * (-s_rate * t).exp()
            })
            .sum();
        let [of_p, of_s] = [p, s].map(|speed| (s_rate / speed).powi(2));
        for number in 0..numbers {
            let k = number as f64 * spacing;
            let half = if number == 0 { 0.5 } else { 1.0 };
            let x = k * LOAD_RADIUS;
            let bell = if x == 0.0 { 1.0 } else { x.sin() / x / (1.0 - (x / PI).powi(2)) };
            let [q_p, q_s] = [of_p, of_s].map(|term| (k * k + term).sqrt());
            let square_sum = 2.0 * k * k + of_s; // k² + q_s²
            let rayleigh = square_sum * square_sum - 4.0 * k * k * q_p * q_s;
            let a = LOAD_AMPLITUDE * bell * load * half * spacing / PI * square_sum
                / (solid.mu * rayleigh);
            // The amplitude B is imaginary for real q: B = −ib with real b.
            let b = 2.0 * k * q_p * a / square_sum;
            for (sum, [x_1, x_2]) in sums.iter_mut().zip(points) {
                let [by_p, by_s] = [q_p, q_s].map(|q| (q * x_2).exp());
                sum[0][index] -= (k * a * by_p - q_s * b * by_s) * (k * x_1).sin();
                sum[1][index] += (q_p * a * by_p - k * b * by_s) * (k * x_1).cos();
            }
        }
    }
    let inverse = |sums: Vec<Complex64>| -> Vec<f64> {
        let at = |t: &f64| {
            let terms = sums.iter().enumerate().map(|(index, sum)| {
                let half = if index == 0 { 0.5 } else { 1.0 };
                half * (sum * (rate(index) * t).exp()).re
            });
            2.0 / period * terms.sum::<f64>()
        };
        time.iter().map(at).collect()
    };
    sums.into_iter().map(|components| components.map(inverse)).collect()
}

/// Verifies Lamb's problem in plane strain. Displacements converge to the quadrature with nearly second order;
/// tolerances on the finer grid are 1.5 times the errors found with 37 cells per Rayleigh wavelength. Speeds follow
/// from the peaks at receivers on the surface, far enough for the Rayleigh wave to be isolated, and below the load.
#[test]
fn plane_lamb_problem_converges_to_quadrature() {
    let places = [
        ("near", [16.125, -0.125]),
        ("far", [36.125, -0.125]),
        ("below", [0.125, -30.125]),
        ("deep", [0.125, -45.125]),
    ];
    let [p, s, rayleigh] = [
        REFERENCE_SOLID.pressure_speed(),
        REFERENCE_SOLID.shear_speed(),
        REFERENCE_SOLID.rayleigh_speed(),
    ];
    // For Poisson's ratio ¼: c² = (2 − 2/√3) c_s².
    assert!((rayleigh - s * (2.0 - 2.0 / 3f64.sqrt()).sqrt()).abs() < 1e-9 * s);
    let errors = [100, 200].map(|cells| {
        let h = 50.0 / f64::from(cells);
        let output = run_bundled_case(
            "lamb-2d",
            &[
                format!("grid.cells=[{}, {cells}]", 2 * cells),
                format!("grid.spacing={h}"),
                "grid.origin=[-50, -50]".to_owned(),
            ],
        );
        let time = &output.receivers["time"];
        let points = places.map(|(_, at)| at);
        let exact = compute_displacements(&REFERENCE_SOLID, time, &points);
        let record =
            |name: &str, component: &str| &output.receivers[&format!("{name}.{component}")];
        let speed = |from: usize, to: usize, axis: usize| {
            let [a, b] = [from, to].map(|index| peak_time(time, record(places[index].0, "v2")));
            (points[to][axis] - points[from][axis]).abs() / (b - a)
        };
        let (along, down) = (speed(0, 1, 0), speed(2, 3, 1));
        println!("h = {h} m: Rayleigh {along:.2} of {rayleigh:.2} m/s, P {down:.2} of {p:.2} m/s");
        if cells == 200 {
            assert!((along / rayleigh - 1.0).abs() < 0.01, "{along} instead of {rayleigh} m/s");
            assert!((down / p - 1.0).abs() < 0.01, "{down} instead of {p} m/s");
        }
        // No motion before the pressure wave, which starts with the load.
        for ((name, _), at) in places.iter().zip(&points) {
            let v = record(name, "v2");
            let arrival = (at[0].hypot(at[1]) - LOAD_RADIUS) / p;
            let early: Vec<f64> =
                time.iter().zip(v).filter(|(t, _)| **t < arrival).map(|(_, v)| *v).collect();
            assert!(max_magnitude(&early) < 1e-3 * max_magnitude(v), "{name}");
        }
        let mut errors = Vec::new();
        for ((name, _), exact) in places.iter().zip(&exact) {
            // Below the load u₁ is zero except for the offset of half a cell.
            let components = if *name == "near" || *name == "far" { 0..2 } else { 1..2 };
            for axis in components {
                let u = record(name, &format!("u{}", axis + 1));
                let differences: Vec<f64> =
                    u.iter().zip(&exact[axis]).map(|(a, b)| a - b).collect();
                let error = max_magnitude(&differences) / max_magnitude(&exact[axis]);
                println!("h = {h} m: u{} of {name} off by {error:.4} of its maximum", axis + 1);
                errors.push(error);
            }
        }
        errors
    });
    // Errors found at the receivers near (u₁, u₂), far (u₁, u₂), below (u₂) and deep (u₂): 0.004, 0.005, 0.009, 0.011,
    // 0.009 and 0.013.
    for (found, allowed) in errors[1].iter().zip([0.006, 0.008, 0.014, 0.016, 0.013, 0.019]) {
        assert!(*found < allowed, "{found} of {allowed}");
    }
    for (coarse, fine) in errors[0].iter().zip(&errors[1]).take(4) {
        assert!(coarse / fine > 2.8, "{coarse}, {fine}: order {}", (coarse / fine).log2());
    }
}

/// Verifies two layers with a rigid block under a force: the block is at rest while the mirror image of its position
/// moves; the solution is symmetric about the plane of load and block; numerical dissipation is positive and smaller on
/// the finer grid.
#[test]
#[ignore = "takes long; part of .ci/long"]
fn lamb_problem_with_rigid_block_is_symmetric_and_dissipative() {
    let shares = [40, 60].map(|cells: usize| {
        let output = run_bundled_case(
            "lamb-3d",
            &[
                format!("grid.cells=[{cells}, {cells}, {}]", 3 * cells / 4),
                format!("grid.spacing={}", 60.0 / cells as f64),
                "load[0].time.frequency=8".to_owned(),
                "time.duration=0.25".to_owned(),
                format!("output.snapshot_interval={}", if cells == 40 { 0.125 } else { 0.0 }),
            ],
        );
        let max_record = |name: &str| max_magnitude(&output.receivers[name]);
        println!(
            "u1: block {:.3e}, mirrored {:.3e} m",
            max_record("block.u1"),
            max_record("mirrored.u1")
        );
        assert!(max_record("block.u1") < 0.02 * max_record("mirrored.u1"));
        assert!(max_record("block.v3") < 0.02 * max_record("mirrored.v3"));
        assert!(max_record("before.u1") > 0.0 && max_record("behind.u1") > 0.0);
        // In the arrays of fields the index along x₁ varies fastest.
        for (name, sign) in [("v1", 1.0), ("v2", -1.0), ("v3", 1.0), ("sigma11", 1.0), ("u1", 1.0)]
        {
            let values = &output.fields[name];
            let largest = max_magnitude(values);
            assert!(largest > 0.0, "{name}");
            for (index, value) in values.iter().enumerate() {
                let (x_1, rest) = (index % cells, index / cells);
                let (x_2, x_3) = (rest % cells, rest / cells);
                let mirrored = values[(x_3 * cells + cells - 1 - x_2) * cells + x_1];
                assert!((value - sign * mirrored).abs() < 1e-9 * largest, "{name} at {index}");
            }
        }
        let last = |name: &str| output.ledger[name].last().copied().expect("lines");
        let share = last("balance") / last("boundary_work");
        println!("{cells} cells: the scheme took {:.1} % of the work", -100.0 * share);
        let snapshots = output.file_names.iter().filter(|name| name.ends_with(".vti")).count();
        assert_eq!(snapshots, if cells == 40 { 3 } else { 0 });
        share
    });
    assert!(shares[0] < shares[1] && shares[1] < 0.0 && shares[0] > -0.3, "{shares:?}");
}

/// Permanent effects of a surface pulse on a yielding half-plane, on one grid.
struct PlasticEffects {
    /// Area where more than 30 J/m³ were dissipated, m².
    yielded_area: f64,
    /// Mean rotations over two squares of edge 0.8 m, the upper one below the edge of the loaded strip and the lower
    /// one adjacent to it, rad.
    mean_rotations: [f64; 2],
    /// Plastically dissipated energy, J/m.
    dissipated_energy: f64,
}

/// Runs the surface pulse on a grid of 2 `cells` × `cells` cells with settings.
fn run_surface_pulse(cells: usize, sets: &[&str]) -> (PlasticEffects, HalfSpaceRun) {
    let h = 12.0 / cells as f64;
    let mut settings =
        vec![format!("grid.cells=[{}, {cells}]", 2 * cells), format!("grid.spacing={h}")];
    settings.extend(sets.iter().map(|set| (*set).to_owned()));
    let output = run_bundled_case("surface-pulse", &settings);
    let [x_1, x_2, rotation, dissipation] =
        ["x1", "x2", "phi3", "dissipation"].map(|name| &output.fields[name]);
    let mean = |from: [f64; 2]| {
        let (mut sum, mut count) = (0.0, 0.0);
        for (row, x_2) in x_2.iter().enumerate() {
            for (column, x_1) in x_1.iter().enumerate() {
                let is_in = |x: f64, from: f64| (from..from + 0.8).contains(&x);
                if is_in(*x_1, from[0]) && is_in(*x_2, from[1]) {
                    sum += rotation[row * 2 * cells + column];
                    count += 1.0;
                }
            }
        }
        sum / count
    };
    let effects = PlasticEffects {
        yielded_area: dissipation.iter().filter(|density| **density > 30.0).count() as f64 * h * h,
        mean_rotations: [mean([1.6, -0.8]), mean([1.6, -1.6])],
        dissipated_energy: *output.ledger["plastic_dissipation"].last().expect("lines"),
    };
    (effects, output)
}

/// Verifies convergence of plastic zone, residual rotation and dissipated energy: on three grids with halved spacing
/// and the same load the differences decrease. The load is discontinuous in space and time; fronts that a scheme
/// spreads over several cells converge at least like √h (Godunov 1959).
#[test]
#[ignore = "takes long; part of .ci/long"]
fn plastic_effects_of_surface_pulse_converge() {
    let effects = [60, 120, 240].map(|cells| {
        let (effects, output) = run_surface_pulse(cells, &[]);
        println!(
            "h = {} m: zone {:.2} m², rotation {:.4e} and {:.4e}, dissipated {:.1} J/m",
            12.0 / cells as f64,
            effects.yielded_area,
            effects.mean_rotations[0],
            effects.mean_rotations[1],
            effects.dissipated_energy
        );
        let density: f64 = output.fields["dissipation"].iter().sum();
        let total = density * (12.0 / cells as f64).powi(2);
        assert!((total - effects.dissipated_energy).abs() < 1e-9 * total);
        effects
    });
    let quantities: [fn(&PlasticEffects) -> f64; 4] = [
        |e| e.yielded_area,
        |e| e.mean_rotations[0],
        |e| e.mean_rotations[1],
        |e| e.dissipated_energy,
    ];
    for quantity in quantities {
        let [coarse, middle, fine] = [0, 1, 2].map(|grid| quantity(&effects[grid]));
        let [first, second] = [middle - coarse, fine - middle];
        println!("differences {first:.3e}, {second:.3e}");
        assert!(second.abs() < 0.8 * first.abs(), "{coarse} {middle} {fine}");
        // The remaining error is small if the differences continue to decrease at this rate.
        assert!(second.abs() < 0.05 * fine.abs(), "{middle} {fine}");
    }
}

/// Verifies that the per-cell energy account closes to rounding, and that a triangular pulse of the same height
/// dissipates less.
#[test]
fn ledger_of_surface_pulse_closes() {
    let (effects, output) = run_surface_pulse(60, &["scheme.ledger=\"full\""]);
    let energy = output.ledger["kinetic"].iter().zip(&output.ledger["stored"]).map(|(a, b)| a + b);
    let max_energy = max_magnitude(&energy.collect::<Vec<_>>());
    let residual = max_magnitude(&output.ledger["residual"]);
    println!("residual {residual:.2e} of {max_energy:.4e} J/m");
    assert!(residual < 1e-12 * max_energy, "{residual:e} of {max_energy:e}");
    // In the step in which a front leaves through a boundary, reconstruction may add a small energy.
    let numerical = &output.ledger["numerical_dissipation"];
    assert!(numerical.windows(2).all(|pair| pair[1] - pair[0] > -0.01 * max_magnitude(numerical)));
    assert!(numerical.last().expect("lines") > &0.0);
    let triangle = "{ kind = \"triangle\", duration = 0.02 }";
    let sets = [0, 1].map(|load| format!("load[{load}].time={triangle}"));
    let (triangle_effects, _) = run_surface_pulse(60, &sets.each_ref().map(String::as_str));
    println!(
        "a triangle dissipates {:.1} of {:.1} J/m",
        triangle_effects.dissipated_energy, effects.dissipated_energy
    );
    assert!(
        triangle_effects.dissipated_energy > 0.0
            && triangle_effects.dissipated_energy < 0.5 * effects.dissipated_energy
    );
}
