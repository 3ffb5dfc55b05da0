//! Time of one evaluation of the right-hand side of granular flow, relative to that of its Fourier transforms.
//!
//! ```text
//! cargo bench -p wellposed-dynamics --bench flow [-- POINTS …]
//! ```

#[path = "../tests/solid/support/shear_flow.rs"]
mod shear_flow;

use num_complex::Complex64;
use shear_flow::simple_shear;
use std::f64::consts::FRAC_PI_6;
use std::hint::black_box;
use std::time::Instant;
use wellposed_dynamics::flow::spectral::{FourierSeries, ModeWaveVectors};
use wellposed_dynamics::flow::{Closure, FlowProblem, FlowSolver};

/// Measures the median time of a call, s.
fn median_seconds(mut call: impl FnMut()) -> f64 {
    const MEASURED_CALLS: usize = 9;
    call();
    let mut durations: Vec<f64> = (0..MEASURED_CALLS)
        .map(|_| {
            let clock = Instant::now();
            call();
            clock.elapsed().as_secs_f64()
        })
        .collect();
    durations.sort_by(f64::total_cmp);
    durations[MEASURED_CALLS / 2]
}

/// Returns simple shear with a closure (constitutive model of granular flow) on a grid of `points` × `points` points.
fn build_problem(closure: Closure, points: usize) -> FlowProblem {
    let noncoaxiality = match closure {
        Closure::HarrisGrekova => 0.3,
        Closure::DoubleShearing => -0.5 * FRAC_PI_6,
        Closure::PlasticPotential => 0.0,
    };
    let problem = simple_shear(closure, points, noncoaxiality);
    FlowProblem { cohesion: 0.0, tolerance: 1e-5, pressure_tolerance: 1e-9, ..problem }
}

/// Returns a flow with a smooth perturbation of velocity and internal variable.
fn build_flow(problem: &FlowProblem) -> FlowSolver {
    let mut flow = FlowSolver::new(problem).expect("a problem");
    let [columns, rows] = problem.points;
    let coordinate = |point: usize, axis: usize| {
        let index = [point % columns, point / columns][axis];
        std::f64::consts::TAU * index as f64 / problem.points[axis] as f64
    };
    let sample = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        (0..columns * rows).map(|point| value(coordinate(point, 0), coordinate(point, 1))).collect()
    };
    let v1 = sample(&|_, y| 0.02 * y.cos() + 0.01 * (3.0 * y).sin());
    let v2 = sample(&|x, _| 0.03 * x.sin() + 0.01 * (2.0 * x).cos());
    let internal_variable = sample(&|x, y| 0.1 * (x + y).cos());
    flow.perturb([&v1, &v2], &internal_variable).expect("a stress");
    flow
}

fn main() {
    let requested: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let sizes = if requested.is_empty() { vec![128, 256, 512, 1024] } else { requested };
    println!(
        "points  threads  transform ms  closure            evaluation ms  iterations  over its transforms"
    );
    for points in sizes {
        for threads in [1, 2] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| print_rows(points, threads));
        }
    }
}

fn print_rows(points: usize, threads: usize) {
    let mut series = FourierSeries::new([points; 2]);
    let waves = ModeWaveVectors::new(&series, [0.1; 2], [[1.0, 0.0], [0.0, 1.0]]);
    let mut values: Vec<f64> = (0..points * points).map(|i| (i as f64).sin()).collect();
    let mut modes = vec![Complex64::ZERO; series.mode_count()];
    let pair = median_seconds(|| {
        series.transform_forward(|point| values[point], &mut modes);
        series.transform_inverse(&modes, &waves, |_| Complex64::ONE, &mut values);
        black_box(&values);
    });
    let transform = 0.5 * pair;
    for closure in [Closure::HarrisGrekova, Closure::DoubleShearing, Closure::PlasticPotential] {
        let mut flow = build_flow(&build_problem(closure, points));
        // The step is long enough for many stages, so that the time per evaluation is the same as in a complete run.
        let step = 2e-5 * (512.0 / points as f64).powi(2);
        flow.advance_by(step, 0).expect("a stress");
        let [evaluations, iterations] = flow.evaluation_counts();
        let clock = Instant::now();
        for _ in 0..3 {
            flow.advance_by(step, 0).expect("a stress");
        }
        let time = clock.elapsed().as_secs_f64();
        let [later_evaluations, later_iterations] = flow.evaluation_counts();
        let (evaluations, iterations) =
            ((later_evaluations - evaluations) as f64, (later_iterations - iterations) as f64);
        // Transforms per evaluation. Pressure: three in each iteration and in the residual of the guess. Others (11):
        // two velocities, three velocity gradients, p, cos 2ψ, sin 2ψ, the source of p, two stresses. Internal
        // variable: ω or ψ and its two fluxes; for ψ also its rotation rate.
        let internal_transforms = match closure {
            Closure::HarrisGrekova => 3.0,
            Closure::DoubleShearing => 4.0,
            Closure::PlasticPotential => 0.0,
        };
        let transforms = 11.0 + internal_transforms + 3.0 * (1.0 + iterations / evaluations);
        println!(
            "{points:>6}  {threads:>7}  {:>12.3}  {closure:<17?}  {:>13.2}  {:>10.2}  {:>19.2}",
            1e3 * transform,
            1e3 * time / evaluations,
            iterations / evaluations,
            time / evaluations / (transforms * transform)
        );
    }
}
