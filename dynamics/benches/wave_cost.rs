//! Time to a given accuracy of plane waves in the plane, for each reconstruction: error after twenty wavelengths in twelve
//! directions, and rate on one thread.
//!
//! `cargo bench -p wellposed-dynamics --bench wave_cost` prints, for P and S waves of a classical solid with λ = μ on
//! square cells, the number of cells per wavelength and the Courant number of each row, the largest error of the twelve
//! directions (of the velocity, relative to its amplitude), and the time for a square of one wavelength and one period:
//! the number of cell-updates divided by the rate. A cell-update advances one cell by half a time step, with one sweep
//! along every axis. Rates are the fastest of interleaved rounds on a grid of 1000² cells.

use models::solid::parameters::Isotropic;
use models::solid::waves::SolidField;
use std::f64::consts::TAU;
use std::time::Instant;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::domain::Domain;
use wellposed_dynamics::line::{Slopes, WideOrder};
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme, Splitting};

/// Number of wavelengths that waves travel.
const WAVELENGTHS: f64 = 20.0;

/// Number of periods along each axis of the grid, in twelve directions.
const DIRECTIONS: [[i32; 2]; 12] = [
    [1, 0],
    [0, 1],
    [1, 1],
    [1, -1],
    [2, 1],
    [1, 2],
    [2, -1],
    [3, 1],
    [1, 3],
    [3, 2],
    [-2, 3],
    [4, 3],
];

const SIXTH: Slopes = Slopes::Wide(WideOrder::Sixth);
const EIGHTH: Slopes = Slopes::Wide(WideOrder::Eighth);
const TWO_CYCLIC: Splitting = Splitting::TwoCyclic;
const ALTERNATING: Splitting = Splitting::Alternating;

/// Reconstruction, splitting, cells per wavelength and Courant number of the fastest wave.
type Row = (Slopes, Splitting, [(f64, f64); 2]);

/// Schemes with an error of 1 % of P waves and of S waves at the least cost.
const ROWS: [Row; 7] = [
    (Slopes::Limited, TWO_CYCLIC, [(64.0, 1.0), (80.0, 1.0)]),
    (Slopes::FourthOrder, TWO_CYCLIC, [(28.0, 0.35), (32.0, 0.25)]),
    (Slopes::FourthOrder, ALTERNATING, [(27.0, 0.7), (32.0, 0.5)]),
    (SIXTH, TWO_CYCLIC, [(13.5, 0.177), (13.5, 0.088)]),
    (SIXTH, ALTERNATING, [(13.5, 0.35), (13.5, 0.177)]),
    (EIGHTH, TWO_CYCLIC, [(9.5, 0.125), (9.5, 0.0625)]),
    (EIGHTH, ALTERNATING, [(9.5, 0.25), (9.5, 0.125)]),
];

/// Creates a problem of periodic cells of length 1; the wave speeds are √3 and 1.
fn periodic_problem(
    cells: [usize; 2],
    (slopes, splitting): (Slopes, Splitting),
    courant: f64,
) -> Problem<2> {
    let medium = Medium::new(Isotropic::new(1.0, 1.0, 1.0, None).expect("sound moduli"), 2);
    let grid = Grid { cells, spacing: [1.0; 2] };
    let step = 2.0 * courant / medium.max_speed();
    let scheme = Scheme { splitting, ..Scheme::new(slopes, PlasticStep::ReturnMapping) };
    let periodic = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    Problem::new(grid, vec![medium], vec![0; grid.count()], periodic, step, scheme)
}

/// Returns the amplitudes of velocities and stresses of a plane wave that moves in the direction (cos, sin), and its speed.
fn plane_wave(is_shear: bool, [cos, sin]: [f64; 2], field: SolidField) -> f64 {
    let (speed, [p, q]) = if is_shear { (1.0, [-sin, cos]) } else { (3.0f64.sqrt(), [cos, sin]) };
    // Stress rate C : sym(∇v) with ∂ₜ = −c ∂ₙ.
    let dilatation = cos * p + sin * q;
    let stress = |i: usize, j: usize| {
        let (n, v) = ([cos, sin, 0.0], [p, q, 0.0]);
        let equal = if i == j { dilatation } else { 0.0 };
        -(equal + n[i] * v[j] + n[j] * v[i]) / speed
    };
    match field {
        SolidField::Velocity(axis) => [p, q, 0.0][axis],
        SolidField::Stress(i, j) => stress(i, j),
        _ => 0.0,
    }
}

/// Computes the error of the velocity after [`WAVELENGTHS`] wavelengths, relative to the amplitude.
fn wave_error(
    is_shear: bool,
    direction: [i32; 2],
    scheme: (Slopes, Splitting),
    (per_wavelength, courant): (f64, f64),
) -> f64 {
    let [m, n] = direction.map(f64::from);
    let periods = m.hypot(n);
    let length = (per_wavelength * periods).round();
    let cells = [length as usize, if n == 0.0 { 8 } else { length as usize }];
    let cells = if m == 0.0 { [8, cells[1]] } else { cells };
    let speed = if is_shear { 1.0 } else { 3.0f64.sqrt() };
    // A whole number of steps for the distance.
    let time = WAVELENGTHS * length / periods / speed;
    let mut problem = periodic_problem(cells, scheme, courant);
    let steps = (time / problem.step).ceil();
    problem.step = time / steps;
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
    let unit = [m / periods, n / periods];
    let value = |field: SolidField, cell: usize| {
        let [x, y] = [cell % cells[0], cell / cells[0]].map(|place| place as f64 / length);
        plane_wave(is_shear, unit, field) * (TAU * (m * x + n * y)).cos()
    };
    for field in domain.fields().to_vec() {
        let values: Vec<f64> = (0..problem.grid.count()).map(|cell| value(field, cell)).collect();
        domain.set_field(field, &values);
    }
    let mut remaining = steps as usize;
    while remaining > 0 {
        let pass = remaining.min(domain.max_pass_steps());
        let Ok(()) = domain.advance_pass(pass, &mut ());
        remaining -= pass;
    }
    let count = domain.fields().len();
    let all: Vec<usize> = (0..problem.grid.count()).collect();
    let found = domain.field_deviations(&all);
    let mut square = 0.0;
    for (place, field) in domain.fields().iter().enumerate() {
        if let SolidField::Velocity(_) = field {
            for cell in 0..problem.grid.count() {
                square += (found[cell * count + place] - value(*field, cell)).powi(2);
            }
        }
    }
    // The mean square of a cosine is ½.
    (2.0 * square / problem.grid.count() as f64).sqrt()
}

/// Returns the rates of the schemes, million cell-updates per second.
fn measure_rates() -> Vec<f64> {
    let mut domains: Vec<Domain<f64, 2>> = ROWS
        .iter()
        .map(|(slopes, splitting, _)| {
            let problem = periodic_problem([1000; 2], (*slopes, *splitting), 0.5);
            let mut domain = Domain::new(&problem).expect("sound");
            for field in domain.fields().to_vec() {
                let values: Vec<f64> = (0..1_000_000).map(|cell| (cell as f64).sin()).collect();
                domain.set_field(field, &values);
            }
            domain
        })
        .collect();
    let mut best = vec![f64::INFINITY; domains.len()];
    for _ in 0..9 {
        for (domain, best) in domains.iter_mut().zip(&mut best) {
            let start = Instant::now();
            let steps = 8;
            let mut done = 0;
            while done < steps {
                let pass = domain.max_pass_steps();
                let Ok(()) = domain.advance_pass(pass, &mut ());
                done += pass;
            }
            *best = best.min(start.elapsed().as_secs_f64() / (2 * done) as f64);
        }
    }
    best.into_iter().map(|seconds| 1.0 / seconds).collect()
}

fn main() {
    let rates = measure_rates();
    println!("| order | splitting | wave | cells, Courant number | error | rate, M/s | ms |");
    println!("|---|---|---|---|---|---|---|");
    for ((slopes, splitting, choices), rate) in ROWS.iter().zip(rates) {
        for (is_shear, choice) in [false, true].into_iter().zip(choices) {
            let error = DIRECTIONS
                .map(|direction| wave_error(is_shear, direction, (*slopes, *splitting), *choice))
                .into_iter()
                .fold(0.0, f64::max);
            let (cells, courant) = *choice;
            let speed_ratio = if is_shear { 3.0f64.sqrt() } else { 1.0 };
            // Half steps of a period: the fastest wave passes C cells in each.
            let updates = cells * cells * (cells * speed_ratio / courant);
            let wave = if is_shear { "S" } else { "P" };
            let name = format!("{slopes:?} | {splitting:?} | {wave}");
            let time = updates / rate / 1e3;
            println!("| {name} | {cells}, {courant} | {error:.4} | {rate:.0} | {time:.4} |");
        }
    }
}
