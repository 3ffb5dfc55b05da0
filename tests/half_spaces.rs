//! Tests of loads on the surface of half-planes and half-spaces with the bundled cases: against exact Rayleigh waves
//! and a quadrature over wave numbers, in three dimensions with a rigid block, and with yielding on three grids.

use files::npz::{Values, read};
use num_complex::Complex64;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::fs;
use wellposed::cli::Options;
use wellposed::cli::{self, Control};

const CONTROL: Control = Control { checkpoint_every: 1e9 };

/// Results of a run of a case, by name.
struct Results {
    fields: HashMap<String, Vec<f64>>,
    receivers: HashMap<String, Vec<f64>>,
    ledger: HashMap<String, Vec<f64>>,
    /// Names of the result files.
    files: Vec<String>,
}

/// Runs a bundled case with settings.
fn results(name: &str, sets: &[String]) -> Results {
    let folder = tempfile::tempdir().expect("a scratch folder");
    let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/dynamics/");
    let out = folder.path().join("out");
    let options = Options {
        case: format!("{cases}{name}.toml").into(),
        sets: sets.to_vec(),
        out: Some(out.clone()),
        ..Options::default()
    };
    cli::run(&options, CONTROL, &mut Vec::new()).expect("a sound case");
    let arrays = |file: &str| -> HashMap<String, Vec<f64>> {
        let arrays = read(&fs::read(out.join(file)).expect("a file")).expect("arrays");
        let numbers = arrays.into_iter().filter_map(|array| match array.values {
            Values::F64(values) => Some((array.name, values)),
            _ => None,
        });
        numbers.collect()
    };
    let text = fs::read_to_string(out.join("ledger.csv")).expect("a ledger");
    let mut lines = text.lines().map(|line| line.split(','));
    let names = lines.next().expect("a header");
    let mut ledger: Vec<(String, Vec<f64>)> = names.map(|n| (n.to_owned(), Vec::new())).collect();
    for line in lines {
        for (column, cell) in ledger.iter_mut().zip(line) {
            column.1.push(cell.parse().expect("a number"));
        }
    }
    let files = fs::read_dir(&out).expect("results");
    Results {
        fields: arrays("fields.npz"),
        receivers: arrays("receivers.npz"),
        ledger: ledger.into_iter().collect(),
        files: files.map(|f| f.expect("a file").file_name().into_string().unwrap()).collect(),
    }
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |greatest, value| greatest.max(value.abs()))
}

/// Time (s) of the maximum magnitude, from the parabola through it and its neighbours.
fn peak(time: &[f64], values: &[f64]) -> f64 {
    let middle = (1..values.len() - 1).max_by(|a, b| values[*a].abs().total_cmp(&values[*b].abs()));
    let middle = middle.expect("values");
    let [a, b, c] = [-1, 0, 1].map(|i: isize| values[middle.strict_add_signed(i)]);
    time[middle] + time[1] * 0.5 * (a - c) / (a - 2.0 * b + c)
}

/// Half-plane of `lamb-2d.toml`.
struct HalfPlane {
    lambda: f64,
    mu: f64,
    density: f64,
}

const HALF_PLANE: HalfPlane = HalfPlane { lambda: 8e7, mu: 8e7, density: 2000.0 };
const FORCE: f64 = -1e5;
const RADIUS: f64 = 1.0;
const FREQUENCY: f64 = 20.0;

impl HalfPlane {
    fn pressure_speed(&self) -> f64 {
        ((self.lambda + 2.0 * self.mu) / self.density).sqrt()
    }

    fn shear_speed(&self) -> f64 {
        (self.mu / self.density).sqrt()
    }

    /// Rayleigh speed, m/s: root of (2 − c²/c_s²)² = 4 √(1 − c²/c_p²) √(1 − c²/c_s²) below c_s, by bisection.
    fn rayleigh_speed(&self) -> f64 {
        let [p, s] = [self.pressure_speed(), self.shear_speed()];
        let value = |c: f64| {
            let [p, s] = [p, s].map(|own| 1.0 - (c / own).powi(2));
            (1.0 + s).powi(2) - 4.0 * (p * s).sqrt()
        };
        let [mut below, mut above] = [0.5 * s, s];
        for _ in 0..60 {
            let middle = 0.5 * (below + above);
            if value(middle) < 0.0 { below = middle } else { above = middle }
        }
        below
    }

    /// Displacements u₁ and u₂ (m) at points due to a force on the surface x₂ = 0, distributed as the bell, with the
    /// Ricker time function: by Fourier transform along x₁ and Laplace transform in time (Lamb 1904).
    ///
    /// Potentials φ = A exp(q_p x₂) and ψ = B exp(q_s x₂), with q² = k² + s²/c², satisfy zero shear stress and the
    /// pressure of the load on the surface. The sum over k represents a spatially periodic load; its period is so
    /// large that waves of the images do not arrive. The sum over s = a + iω represents a motion repeated after the
    /// time T, twice the requested duration, and reduced by the factor exp(aT).
    fn displacements(&self, time: &[f64], points: &[[f64; 2]]) -> Vec<[Vec<f64>; 2]> {
        let [p, s] = [self.pressure_speed(), self.shear_speed()];
        let period = 2.0 * time[time.len() - 1];
        let shift = 8.0 / period;
        let length = 2.0 * p * period;
        let spacing = 2.0 * PI / length;
        // At five times its frequency the Ricker spectrum is reduced to e⁻²⁵; the spectrum of the bell is truncated
        // at 10⁻³.
        let [rates, numbers] =
            [5.0 * FREQUENCY * period, 6.0 * PI / RADIUS / spacing].map(|n| n as usize);
        let zero = Complex64::ZERO;
        let mut sums = vec![[vec![zero; rates], vec![zero; rates]]; points.len()];
        let rate = |index: usize| Complex64::new(shift, 2.0 * PI * index as f64 / period);
        for index in 0..rates {
            let s_rate = rate(index);
            let (steps, step) = (4000, period / 4000.0);
            let load: Complex64 = (0..steps)
                .map(|i| {
                    let t = f64::from(i) * step;
                    let a = (PI * FREQUENCY * (t - 1.5 / FREQUENCY)).powi(2);
                    (1.0 - 2.0 * a) * (-a).exp() * step * (-s_rate * t).exp()
                })
                .sum();
            let [of_p, of_s] = [p, s].map(|speed| (s_rate / speed).powi(2));
            for number in 0..numbers {
                let k = number as f64 * spacing;
                let half = if number == 0 { 0.5 } else { 1.0 };
                let x = k * RADIUS;
                let bell = if x == 0.0 { 1.0 } else { x.sin() / x / (1.0 - (x / PI).powi(2)) };
                let [q_p, q_s] = [of_p, of_s].map(|own| (k * k + own).sqrt());
                let sum = 2.0 * k * k + of_s; // k² + q_s²
                let rayleigh = sum * sum - 4.0 * k * k * q_p * q_s;
                let a = FORCE * bell * load * half * spacing / PI * sum / (self.mu * rayleigh);
                // B = −ib, b real for real q.
                let b = 2.0 * k * q_p * a / sum;
                for (own, [x_1, x_2]) in sums.iter_mut().zip(points) {
                    let [by_p, by_s] = [q_p, q_s].map(|q| (q * x_2).exp());
                    own[0][index] -= (k * a * by_p - q_s * b * by_s) * (k * x_1).sin();
                    own[1][index] += (q_p * a * by_p - k * b * by_s) * (k * x_1).cos();
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
        sums.into_iter().map(|own| own.map(inverse)).collect()
    }
}

/// Verifies Lamb's problem in plane strain. Displacements converge to the quadrature with nearly second order;
/// tolerances on the finer grid are 1.5 times the errors found with 40 cells per Rayleigh wavelength. Speeds follow
/// from the peaks at receivers on the surface, far enough for the Rayleigh wave to be isolated, and below the load.
#[test]
fn lamb_in_the_plane() {
    let places = [
        ("near", [16.125, -0.125]),
        ("far", [36.125, -0.125]),
        ("below", [0.125, -30.125]),
        ("deep", [0.125, -45.125]),
    ];
    let [p, s, rayleigh] =
        [HALF_PLANE.pressure_speed(), HALF_PLANE.shear_speed(), HALF_PLANE.rayleigh_speed()];
    // For Poisson's ratio ¼: c² = (2 − 2/√3) c_s².
    assert!((rayleigh - s * (2.0 - 2.0 / 3f64.sqrt()).sqrt()).abs() < 1e-9 * s);
    let errors = [100, 200].map(|cells| {
        let h = 50.0 / f64::from(cells);
        let own = results(
            "lamb-2d",
            &[
                format!("grid.cells=[{}, {cells}]", 2 * cells),
                format!("grid.spacing={h}"),
                "grid.origin=[-50, -50]".to_owned(),
            ],
        );
        let time = &own.receivers["time"];
        let points = places.map(|(_, at)| at);
        let exact = HALF_PLANE.displacements(time, &points);
        let seen = |name: &str, component: &str| &own.receivers[&format!("{name}.{component}")];
        let speed = |from: usize, to: usize, axis: usize| {
            let [a, b] = [from, to].map(|index| peak(time, seen(places[index].0, "v2")));
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
            let v = seen(name, "v2");
            let arrival = (at[0].hypot(at[1]) - RADIUS) / p;
            let early: Vec<f64> =
                time.iter().zip(v).filter(|(t, _)| **t < arrival).map(|(_, v)| *v).collect();
            assert!(greatest(&early) < 1e-3 * greatest(v), "{name}");
        }
        let mut errors = Vec::new();
        for ((name, _), exact) in places.iter().zip(&exact) {
            // Below the load u₁ is zero except for the offset of half a cell.
            let components = if *name == "near" || *name == "far" { 0..2 } else { 1..2 };
            for axis in components {
                let u = seen(name, &format!("u{}", axis + 1));
                let differences: Vec<f64> =
                    u.iter().zip(&exact[axis]).map(|(a, b)| a - b).collect();
                let error = greatest(&differences) / greatest(&exact[axis]);
                println!("h = {h} m: u{} of {name} off by {error:.4} of its greatest", axis + 1);
                errors.push(error);
            }
        }
        errors
    });
    // Errors found: near u₁, u₂; far u₁, u₂; below u₂; deep u₂: 0.004, 0.005, 0.009, 0.011, 0.009 and 0.013.
    for (found, allowed) in errors[1].iter().zip([0.006, 0.008, 0.014, 0.016, 0.013, 0.019]) {
        assert!(*found < allowed, "{found} of {allowed}");
    }
    for (coarse, fine) in errors[0].iter().zip(&errors[1]).take(4) {
        assert!(coarse / fine > 2.8, "{coarse}, {fine}: order {}", (coarse / fine).log2());
    }
}

/// Verifies two layers with a block under a force: the block is at rest while the mirrored position moves; the
/// solution is symmetric about the plane of load and block; numerical dissipation is positive and smaller on the
/// finer grid.
#[test]
fn lamb_in_space() {
    let shares = [40, 60].map(|cells: usize| {
        let own = results(
            "lamb-3d",
            &[
                format!("grid.cells=[{cells}, {cells}, {}]", 3 * cells / 4),
                format!("grid.spacing={}", 60.0 / cells as f64),
                "load[0].time.frequency=8".to_owned(),
                "time.duration=0.25".to_owned(),
                format!("output.snapshot_interval={}", if cells == 40 { 0.125 } else { 0.0 }),
            ],
        );
        let seen = |name: &str| greatest(&own.receivers[name]);
        println!("u1: block {:.3e}, mirrored {:.3e} m", seen("block.u1"), seen("mirrored.u1"));
        assert!(seen("block.u1") < 0.02 * seen("mirrored.u1"));
        assert!(seen("block.v3") < 0.02 * seen("mirrored.v3"));
        assert!(seen("before.u1") > 0.0 && seen("behind.u1") > 0.0);
        // Index along x₁ varies fastest.
        for (name, sign) in [("v1", 1.0), ("v2", -1.0), ("v3", 1.0), ("sigma11", 1.0), ("u1", 1.0)]
        {
            let values = &own.fields[name];
            let most = greatest(values);
            assert!(most > 0.0, "{name}");
            for (index, value) in values.iter().enumerate() {
                let (x_1, rest) = (index % cells, index / cells);
                let (x_2, x_3) = (rest % cells, rest / cells);
                let mirrored = values[(x_3 * cells + cells - 1 - x_2) * cells + x_1];
                assert!((value - sign * mirrored).abs() < 1e-9 * most, "{name} at {index}");
            }
        }
        let last = |name: &str| own.ledger[name].last().copied().expect("lines");
        let share = last("balance") / last("sides");
        println!("{cells} cells: the scheme took {:.1} % of the work", -100.0 * share);
        let snapshots = own.files.iter().filter(|name| name.ends_with(".vti")).count();
        assert_eq!(snapshots, if cells == 40 { 3 } else { 0 });
        share
    });
    assert!(shares[0] < shares[1] && shares[1] < 0.0 && shares[0] > -0.3, "{shares:?}");
}

/// Permanent effects of a pulse on a yielding half-plane, on one grid.
struct Left {
    /// Area where more than 30 J/m³ were dissipated, m².
    zone: f64,
    /// Mean rotation over a square of 0.8 m below the edge of the loaded strip and over the square below it, rad.
    rotations: [f64; 2],
    /// Dissipated energy, J/m.
    dissipated: f64,
}

fn pulse(cells: usize, sets: &[&str]) -> (Left, Results) {
    let h = 12.0 / cells as f64;
    let mut all = vec![format!("grid.cells=[{}, {cells}]", 2 * cells), format!("grid.spacing={h}")];
    all.extend(sets.iter().map(|set| (*set).to_owned()));
    let own = results("surface-pulse", &all);
    let [x_1, x_2, rotation, dissipation] =
        ["x1", "x2", "phi3", "dissipation"].map(|name| &own.fields[name]);
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
    let left = Left {
        zone: dissipation.iter().filter(|own| **own > 30.0).count() as f64 * h * h,
        rotations: [mean([1.6, -0.8]), mean([1.6, -1.6])],
        dissipated: *own.ledger["plastic"].last().expect("lines"),
    };
    (left, own)
}

/// Verifies convergence of plastic zone, residual rotation and dissipated energy: on three grids with halved spacing
/// and the same load the differences decrease. The load is discontinuous in space and time; fronts that a scheme
/// spreads over several cells converge at least like √h (Godunov 1959).
#[test]
fn a_pulse_converges() {
    let found = [60, 120, 240].map(|cells| {
        let (left, own) = pulse(cells, &[]);
        println!(
            "h = {} m: zone {:.2} m², rotation {:.4e} and {:.4e}, dissipated {:.1} J/m",
            12.0 / cells as f64,
            left.zone,
            left.rotations[0],
            left.rotations[1],
            left.dissipated
        );
        let density: f64 = own.fields["dissipation"].iter().sum();
        let total = density * (12.0 / cells as f64).powi(2);
        assert!((total - left.dissipated).abs() < 1e-9 * total);
        left
    });
    let kinds: [fn(&Left) -> f64; 4] =
        [|l| l.zone, |l| l.rotations[0], |l| l.rotations[1], |l| l.dissipated];
    for kind in kinds {
        let [coarse, middle, fine] = [0, 1, 2].map(|grid| kind(&found[grid]));
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
fn the_ledger_of_a_pulse_closes() {
    let (left, own) = pulse(60, &["scheme.ledger=\"full\""]);
    let energy = own.ledger["kinetic"].iter().zip(&own.ledger["stored"]).map(|(a, b)| a + b);
    let most = greatest(&energy.collect::<Vec<_>>());
    let residual = greatest(&own.ledger["residual"]);
    println!("residual {residual:.2e} of {most:.4e} J/m");
    assert!(residual < 1e-12 * most, "{residual:e} of {most:e}");
    // In the step in which a front leaves through a boundary, reconstruction may add a small energy.
    let taken = &own.ledger["numerical"];
    assert!(taken.windows(2).all(|pair| pair[1] - pair[0] > -0.01 * greatest(taken)));
    assert!(taken.last().expect("lines") > &0.0);
    let triangle = "{ kind = \"triangle\", duration = 0.02 }";
    let sets = [0, 1].map(|load| format!("load[{load}].time={triangle}"));
    let (less, _) = pulse(60, &sets.each_ref().map(String::as_str));
    println!("a triangle dissipates {:.1} of {:.1} J/m", less.dissipated, left.dissipated);
    assert!(less.dissipated > 0.0 && less.dissipated < 0.5 * left.dissipated);
}
