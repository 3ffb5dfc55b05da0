//! Cost of domain decomposition and of a metric: rate in million cell-updates per second in the fastest of nine
//! interleaved rounds, and its ratio to the rate of two subdomains along the last axis, or to the rate of a block
//! without a metric.
//!
//! `cargo bench -p wellposed-dynamics --bench decomposition`

#[path = "../tests/solid/support/noise.rs"]
mod noise;

use models::solid::parameters::{CoupleModuli, Isotropic, Microrotation, Theory};
use noise::noise;
use std::f64::consts::TAU;
use std::time::Instant;
use wellposed_dynamics::boundary::Boundary;
use wellposed_dynamics::decomposition::DecomposedDomain;
use wellposed_dynamics::line::Slopes;
use wellposed_dynamics::medium::Medium;
use wellposed_dynamics::problem::{Grid, PlasticStep, Problem, Scheme};
use wellposed_dynamics::solid::metric::Metric;

const MEASUREMENT_ROUNDS: usize = 9;

fn build_medium(theory: Theory, dimensions: usize) -> Medium {
    let couple = CoupleModuli { beta: 0.3, gamma: 0.7, eta: 0.45 };
    let couple = (theory == Theory::Cosserat).then_some(couple);
    let rotation = Microrotation { alpha: 0.6, inertia: 0.37, couple };
    let rotation = (theory != Theory::Classical).then_some(rotation);
    Medium::new(Isotropic::new(1.4, 0.9, 1.2, rotation).expect("sound moduli"), dimensions)
}

fn build_problem<const D: usize>(theory: Theory, cell_count: usize) -> Problem<D> {
    let medium = build_medium(theory, D);
    let grid = Grid { cells: [cell_count; D], spacing: [0.1; D] };
    let step = 0.18 / medium.max_speed();
    let boundaries = std::array::from_fn(|_| [Boundary::Free, Boundary::Free]);
    let scheme = Scheme::new(Slopes::FourthOrder, PlasticStep::ReturnMapping);
    Problem::new(grid, vec![medium], vec![0; grid.count()], boundaries, step, scheme)
}

/// Measures the time of the fastest round of each solver, s per cell and step.
fn measure_fastest<const D: usize>(
    solvers: &mut [DecomposedDomain<f64, D>],
    cell_count: usize,
    steps: usize,
) -> Vec<f64> {
    let mut best = vec![f64::INFINITY; solvers.len()];
    for _ in 0..MEASUREMENT_ROUNDS {
        for (solver, best) in solvers.iter_mut().zip(&mut best) {
            let start = Instant::now();
            solver.advance(steps).expect("threads");
            *best = best.min(start.elapsed().as_secs_f64() / (steps * cell_count) as f64);
        }
    }
    best
}

fn fill_fields_with_noise<const D: usize>(
    solver: &mut DecomposedDomain<f64, D>,
    cell_count: usize,
) {
    for (index, field) in solver.fields().to_vec().into_iter().enumerate() {
        let value = |cell: usize| noise((cell + 31 * index) as u64);
        solver.set_field(field, &(0..cell_count).map(value).collect::<Vec<_>>());
    }
    solver.advance(2).expect("threads");
}

fn compare_decompositions<const D: usize>(
    theory: Theory,
    cells: usize,
    steps: usize,
    subdomain_counts: &[[usize; D]],
) {
    let problem = build_problem::<D>(theory, cells);
    let cell_count = problem.grid.count();
    let decomposed = |parts: &[usize; D]| {
        let mut decomposed = DecomposedDomain::with_subdomains(0, &problem, *parts).expect("room");
        fill_fields_with_noise(&mut decomposed, cell_count);
        decomposed
    };
    let mut solvers: Vec<DecomposedDomain<f64, D>> =
        subdomain_counts.iter().map(decomposed).collect();
    let times = measure_fastest(&mut solvers, cell_count, steps);
    for (parts, time) in subdomain_counts.iter().zip(&times) {
        let rate = 2.0 / time / 1e6;
        println!("| {theory:?} {cells}^{D} | {parts:?} | {rate:.1} | {:.2} |", times[0] / time);
    }
}

/// Compares the rate of a classical solid on a Cartesian grid in the plane with that of a polar block of as many cells.
fn compare_metric(cells: usize, steps: usize) {
    let plain = build_problem::<2>(Theory::Classical, cells);
    let spacing = [TAU / cells as f64, 6.0 / cells as f64];
    let metric = Metric::new_polar(1.0, cells, spacing);
    let polar = Problem {
        grid: Grid { spacing, ..plain.grid },
        step: 1.8 * metric.spacing[0].min(spacing[1]) / plain.media[0].max_speed(),
        metric: Some(metric),
        ..plain.clone()
    };
    let cell_count = plain.grid.count();
    let mut solvers: Vec<_> = [plain, polar]
        .iter()
        .map(|problem| {
            let mut decomposed: DecomposedDomain<f64, 2> =
                DecomposedDomain::new(problem, 1).expect("sound");
            fill_fields_with_noise(&mut decomposed, cell_count);
            decomposed
        })
        .collect();
    let times = measure_fastest(&mut solvers, cell_count, steps);
    println!(
        "| classical {cells}^2 | polar, one part | {:.1} | {:.2} |",
        2.0 / times[1] / 1e6,
        times[0] / times[1]
    );
}

fn main() {
    println!("| block | parts | Mcu/s | of the first |\n|---|---|---|---|");
    compare_decompositions::<2>(Theory::Cosserat, 1000, 10, &[[1, 2], [2, 1], [1, 4], [2, 2]]);
    compare_decompositions::<3>(
        Theory::Cosserat,
        100,
        6,
        &[[1, 1, 2], [1, 2, 1], [2, 1, 1], [2, 2, 2]],
    );
    compare_metric(1000, 20);
}
