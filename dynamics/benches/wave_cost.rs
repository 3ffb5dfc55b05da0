//! Time to a given accuracy of plane waves in the plane, for each reconstruction: error after twenty wavelengths in twelve
//! directions, and rate on one thread.
//!
//! `cargo bench -p wellposed-dynamics --bench wave_cost -- [rates] [search]` prints, for P and S waves of a classical solid
//! with λ = μ and of a Cosserat solid on square cells, the number of cells per wavelength and the Courant number of each
//! row, the largest error of the twelve directions (of the velocity, relative to its amplitude), and the time for a square
//! of one wavelength and one period: the number of cell-updates divided by the rate. A cell-update advances one cell by
//! half a time step, with one sweep along every axis. Rates are the fastest of interleaved rounds on a grid of 1000² cells.
//!
//! `rates`: prints the rates only. `search`: looks for the cells (in steps of ½) and the Courant number of the least cost
//! near those of each row, instead of taking the row's.
//!
//! The Cosserat solid has α = μ, j = 0.01 ρl² and γ + η = 0.02 μl² for the wavelength l: internal lengths of a tenth of a
//! wavelength. `benches/stencil_compiler.py` states the same waves for the leapfrog of a stencil compiler.

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
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

/// Number of interleaved rounds that measure rates.
const ROUNDS: usize = 9;

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

/// Schemes with an error of 1 % of P waves and of S waves at the least cost, of a classical solid.
const CLASSICAL_ROWS: [Row; 7] = [
    (Slopes::Limited, TWO_CYCLIC, [(64.0, 1.0), (80.0, 1.0)]),
    (Slopes::FourthOrder, TWO_CYCLIC, [(28.0, 0.35), (32.0, 0.25)]),
    (Slopes::FourthOrder, ALTERNATING, [(26.0, 0.65), (29.0, 0.44)]),
    (SIXTH, TWO_CYCLIC, [(13.5, 0.177), (13.5, 0.088)]),
    (SIXTH, ALTERNATING, [(13.5, 0.367), (13.5, 0.21)]),
    (EIGHTH, TWO_CYCLIC, [(9.5, 0.125), (9.5, 0.0625)]),
    (EIGHTH, ALTERNATING, [(9.0, 0.253), (9.0, 0.136)]),
];

/// The same of the Cosserat solid, which needs shorter steps: microrotation is split from the sweeps.
const COSSERAT_ROWS: [Row; 3] = [
    (Slopes::FourthOrder, ALTERNATING, [(28.0, 0.372), (33.5, 0.0938)]),
    (SIXTH, ALTERNATING, [(14.0, 0.21), (14.5, 0.0421)]),
    (EIGHTH, ALTERNATING, [(9.0, 0.128), (9.5, 0.029)]),
];

/// A plane wave in a medium with λ = μ = ρ = 1.
struct PlaneWave {
    theory: Theory,
    is_shear: bool,
    /// Wavelength in cells of length 1.
    length: f64,
    /// Angular frequency.
    frequency: f64,
    /// Amplitude of the spin, a quarter period behind a velocity of amplitude 1.
    spin: f64,
}

/// Ratio of the moment of inertia to ρ and the square of the wavelength.
const INERTIA: f64 = 0.01;
/// Ratio of the bending modulus γ + η to μ and the square of the wavelength.
const BENDING: f64 = 0.02;

impl PlaneWave {
    fn new(theory: Theory, is_shear: bool, length: f64) -> Self {
        let k = TAU / length;
        let (inertia, bending) = (INERTIA * length * length, BENDING * length * length);
        let (frequency, spin) = match (is_shear, theory) {
            (false, _) => (3.0f64.sqrt() * k, 0.0),
            (true, Theory::Classical) => (k, 0.0),
            (true, _) => {
                // (ω² − 2k²)(jω² − Bk² − 4) = 4k² with μ = α = ρ = 1: the slower wave.
                let half = 0.5 * (2.0 * k * k + (bending * k * k + 4.0) / inertia);
                let product = (2.0 * k * k * (bending * k * k + 4.0) - 4.0 * k * k) / inertia;
                let square = half - (half * half - product).sqrt();
                (square.sqrt(), 2.0 * k / (inertia * square - bending * k * k - 4.0))
            }
        };
        Self { theory, is_shear, length, frequency, spin }
    }

    fn medium(&self) -> Medium {
        let square = self.length * self.length;
        let [gamma, eta] = [0.5 * BENDING * square; 2];
        let couple = Some(CoupleModuli { beta: 0.0, gamma, eta });
        let rotation = Microrotation { alpha: 1.0, inertia: INERTIA * square, couple };
        let rotation = (self.theory == Theory::Cosserat).then_some(rotation);
        Medium::new(Isotropic::new(1.0, 1.0, 1.0, rotation).expect("sound moduli"), 2)
    }

    /// Returns the amplitudes of a field in the wave along the unit vector (cos, sin), those of the cosine and of the sine
    /// of the phase k·x − ωt.
    fn amplitudes(&self, [cos, sin]: [f64; 2], field: SolidField) -> [f64; 2] {
        let k = TAU / self.length;
        let n = [cos, sin, 0.0];
        let v = if self.is_shear { [-sin, cos, 0.0] } else { n };
        // Stress rates by ∂ₜ cos = ω sin: tractions (μ + α) ∂ₙv − 2αω across the wave, (μ − α) ∂ₙv + 2αω conjugate to them.
        let alpha = if self.theory == Theory::Cosserat { 1.0 } else { 0.0 };
        let [direct, conjugate] = [
            (1.0 + alpha) * k + 2.0 * alpha * self.spin,
            (1.0 - alpha) * k - 2.0 * alpha * self.spin,
        ]
        .map(|rate| -rate / self.frequency);
        match field {
            SolidField::Velocity(axis) => [v[axis], 0.0],
            SolidField::Spin(2) => [0.0, self.spin],
            SolidField::Stress(i, j) if self.is_shear => {
                [direct * v[i] * n[j] + conjugate * n[i] * v[j], 0.0]
            }
            SolidField::Stress(i, j) => {
                let equal = if i == j { 1.0 } else { 0.0 };
                [-(equal + 2.0 * n[i] * n[j]) * k / self.frequency, 0.0]
            }
            SolidField::Couple(2, j) => {
                let bending = BENDING * self.length * self.length;
                [0.0, -bending * k * self.spin / self.frequency * n[j]]
            }
            _ => [0.0; 2],
        }
    }
}

/// Creates a problem of periodic cells of length 1; the speed of P waves, the fastest, is √3.
fn periodic_problem(
    cells: [usize; 2],
    medium: Medium,
    (slopes, splitting): (Slopes, Splitting),
    courant: f64,
) -> Problem<2> {
    let grid = Grid { cells, spacing: [1.0; 2] };
    let step = 2.0 * courant / medium.max_speed();
    let scheme = Scheme { splitting, ..Scheme::new(slopes, PlasticStep::ReturnMapping) };
    let periodic = std::array::from_fn(|_| [Boundary::Periodic, Boundary::Periodic]);
    Problem::new(grid, vec![medium], vec![0; grid.count()], periodic, step, scheme)
}

/// Computes the error of the velocity after [`WAVELENGTHS`] wavelengths, relative to the amplitude.
fn wave_error(
    (theory, is_shear): (Theory, bool),
    direction: [i32; 2],
    scheme: (Slopes, Splitting),
    (per_wavelength, courant): (f64, f64),
) -> f64 {
    let [m, n] = direction.map(f64::from);
    let periods = m.hypot(n);
    let length = (per_wavelength * periods).round();
    let cells = [length as usize, if n == 0.0 { 8 } else { length as usize }];
    let cells = if m == 0.0 { [8, cells[1]] } else { cells };
    let wave = PlaneWave::new(theory, is_shear, length / periods);
    // A whole number of steps for the distance.
    let time = WAVELENGTHS * TAU / wave.frequency;
    let mut problem = periodic_problem(cells, wave.medium(), scheme, courant);
    let steps = (time / problem.step).ceil();
    problem.step = time / steps;
    let mut domain: Domain<f64, 2> = Domain::new(&problem).expect("sound");
    let unit = [m / periods, n / periods];
    let value = |field: SolidField, cell: usize| {
        let [x, y] = [cell % cells[0], cell / cells[0]].map(|place| place as f64 / length);
        let (sin, cos) = (TAU * (m * x + n * y)).sin_cos();
        let [along_cos, along_sin] = wave.amplitudes(unit, field);
        along_cos * cos + along_sin * sin
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
fn measure_rates(theory: Theory, rows: &[Row]) -> Vec<f64> {
    let mut domains: Vec<Domain<f64, 2>> = rows
        .iter()
        .map(|(slopes, splitting, _)| {
            let medium = PlaneWave::new(theory, true, 10.0).medium();
            let problem = periodic_problem([1000; 2], medium, (*slopes, *splitting), 0.5);
            let mut domain = Domain::new(&problem).expect("sound");
            for field in domain.fields().to_vec() {
                let values: Vec<f64> = (0..1_000_000).map(|cell| (cell as f64).sin()).collect();
                domain.set_field(field, &values);
            }
            domain
        })
        .collect();
    let mut best = vec![f64::INFINITY; domains.len()];
    for _ in 0..ROUNDS {
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

/// Returns the largest error of the twelve directions, or the first one above the limit.
fn largest_error(
    wave: (Theory, bool),
    scheme: (Slopes, Splitting),
    choice: (f64, f64),
    limit: f64,
) -> f64 {
    let mut largest = 0.0f64;
    for direction in DIRECTIONS {
        largest = largest.max(wave_error(wave, direction, scheme, choice));
        if largest > limit {
            break;
        }
    }
    largest
}

/// Returns the number of cell-updates for a square of one wavelength and one period.
fn count_updates((theory, is_shear): (Theory, bool), (cells, courant): (f64, f64)) -> f64 {
    // Half steps of a period: the fastest wave passes C cells in each.
    let period = TAU / PlaneWave::new(theory, is_shear, cells).frequency;
    cells * cells * period * 3.0f64.sqrt() / courant
}

/// Looks for the least number of cell-updates with an error of at most 1 %, from three quarters to 9/8 of the given cells
/// and from twice the given Courant number downwards.
fn search(
    wave: (Theory, bool),
    scheme: (Slopes, Splitting),
    (near, courant): (f64, f64),
) -> (f64, f64) {
    let mut best = (f64::INFINITY, (near, courant));
    let mut cells = (1.5 * near).round() / 2.0;
    while cells <= 1.125 * near {
        let mut courant = (2.0 * courant).min(1.0);
        while count_updates(wave, (cells, courant)) < best.0 && courant > 0.01 {
            if largest_error(wave, scheme, (cells, courant), 0.01) <= 0.01 {
                best = (count_updates(wave, (cells, courant)), (cells, courant));
            }
            courant *= 0.95;
        }
        cells += 0.5;
    }
    best.1
}

fn main() {
    let is_asked = |word: &str| std::env::args().any(|argument| argument == word);
    println!(
        "| theory | order | splitting | wave | cells, Courant number | error | rate, M/s | ms |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let tables: [(Theory, &[Row]); 2] =
        [(Theory::Classical, &CLASSICAL_ROWS), (Theory::Cosserat, &COSSERAT_ROWS)];
    for (theory, rows) in tables {
        let rates = measure_rates(theory, rows);
        for ((slopes, splitting, choices), rate) in rows.iter().zip(rates) {
            let scheme = (*slopes, *splitting);
            if is_asked("rates") {
                println!("| {theory:?} | {slopes:?} | {splitting:?} | | | | {rate:.0} | |");
                continue;
            }
            for (is_shear, choice) in [false, true].into_iter().zip(*choices) {
                let wave = (theory, is_shear);
                let choice = if is_asked("search") { search(wave, scheme, choice) } else { choice };
                let error = largest_error(wave, scheme, choice, f64::INFINITY);
                let time = count_updates(wave, choice) / rate / 1e3;
                let letter = if is_shear { "S" } else { "P" };
                let name = format!("{theory:?} | {slopes:?} | {splitting:?} | {letter}");
                let (cells, courant) = choice;
                println!("| {name} | {cells}, {courant:.3} | {error:.4} | {rate:.0} | {time:.4} |");
            }
        }
    }
}
