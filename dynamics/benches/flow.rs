//! Time of one evaluation of the right-hand side of granular flow, relative to that of its Fourier transforms.
//!
//! ```text
//! cargo bench -p wellposed-dynamics --bench flow [-- POINTS …]
//! ```

use num_complex::Complex64;
use std::hint::black_box;
use std::time::Instant;
use wellposed_dynamics::flow::spectral::{Series, Waves};
use wellposed_dynamics::flow::{Closure, Flow, Problem};

/// Measures the median time of a call, s.
fn seconds(mut call: impl FnMut()) -> f64 {
    const TIMES: usize = 9;
    call();
    let mut all: Vec<f64> = (0..TIMES)
        .map(|_| {
            let clock = Instant::now();
            call();
            clock.elapsed().as_secs_f64()
        })
        .collect();
    all.sort_by(f64::total_cmp);
    all[TIMES / 2]
}

/// Returns the problem of simple shear along x₁ at 50 1/s.
fn problem(closure: Closure, points: usize) -> Problem {
    let (rate, friction_angle) = (25.0f64, 30f64.to_radians());
    let noncoaxiality: f64 = match closure {
        Closure::HarrisGrekova => 0.3,
        Closure::DoubleShearing => -0.5 * friction_angle,
        Closure::PlasticPotential => 0.0,
    };
    Problem {
        closure,
        density: 1600.0,
        friction_angle,
        rotation_ratio: friction_angle.sin(),
        cohesion: 0.0,
        pressure: 1000.0,
        velocity_gradient: [[0.0, 2.0 * rate], [0.0, 0.0]],
        stress_angle: 45f64.to_radians() - noncoaxiality,
        spin: -rate - rate * (2.0 * noncoaxiality).sin() / friction_angle.sin(),
        spin_acceleration: 0.0,
        points: [points; 2],
        lengths: [0.1; 2],
        tolerance: 1e-5,
        pressure_tolerance: 1e-9,
        least_shear_rate: 1e-3,
    }
}

/// Returns a flow with a smooth perturbation of velocity and internal variable.
fn flow(problem: &Problem) -> Flow {
    let mut flow = Flow::new(problem).expect("a problem");
    let [columns, rows] = problem.points;
    let at = |point: usize, axis: usize| {
        let index = [point % columns, point / columns][axis];
        std::f64::consts::TAU * index as f64 / problem.points[axis] as f64
    };
    let all = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f64> {
        (0..columns * rows).map(|point| value(at(point, 0), at(point, 1))).collect()
    };
    let v1 = all(&|_, y| 0.02 * y.cos() + 0.01 * (3.0 * y).sin());
    let v2 = all(&|x, _| 0.03 * x.sin() + 0.01 * (2.0 * x).cos());
    let inner = all(&|x, y| 0.1 * (x + y).cos());
    flow.perturb([&v1, &v2], &inner).expect("a stress");
    flow
}

fn main() {
    let asked: Vec<usize> = std::env::args().filter_map(|word| word.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![128, 256, 512, 1024] } else { asked };
    println!(
        "points  threads  transform ms  closure            evaluation ms  iterations  over its transforms"
    );
    for points in sizes {
        for threads in [1, 2] {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| row(points, threads));
        }
    }
}

fn row(points: usize, threads: usize) {
    let mut series = Series::new([points; 2]);
    let waves = Waves::new(&series, [0.1; 2], [[1.0, 0.0], [0.0, 1.0]]);
    let mut values: Vec<f64> = (0..points * points).map(|i| (i as f64).sin()).collect();
    let mut modes = vec![Complex64::ZERO; series.count()];
    let pair = seconds(|| {
        series.forward(|point| values[point], &mut modes);
        series.inverse(&modes, &waves, |_| Complex64::ONE, &mut values);
        black_box(&values);
    });
    let transform = 0.5 * pair;
    for closure in [Closure::HarrisGrekova, Closure::DoubleShearing, Closure::PlasticPotential] {
        let mut own = flow(&problem(closure, points));
        // Steps have many stages, so that the time per evaluation is that of a run.
        let step = 2e-5 * (512.0 / points as f64).powi(2);
        own.advance_by(step, 0).expect("a stress");
        let [evaluations, iterations] = own.effort();
        let clock = Instant::now();
        for _ in 0..3 {
            own.advance_by(step, 0).expect("a stress");
        }
        let time = clock.elapsed().as_secs_f64();
        let [more, further] = own.effort();
        let (evaluations, iterations) =
            ((more - evaluations) as f64, (further - iterations) as f64);
        // Transforms per evaluation. Pressure: three in each iteration and in each of the two residuals. Others (11):
        // two velocities, three velocity gradients, p, cos 2ψ, sin 2ψ, the source of p, two stresses. Internal
        // variable: ω or ψ and its two fluxes; for ψ also its rotation rate.
        let inner = match closure {
            Closure::HarrisGrekova => 3.0,
            Closure::DoubleShearing => 4.0,
            Closure::PlasticPotential => 0.0,
        };
        let transforms = 11.0 + inner + 3.0 * (2.0 + iterations / evaluations);
        println!(
            "{points:>6}  {threads:>7}  {:>12.3}  {closure:<17?}  {:>13.2}  {:>10.2}  {:>19.2}",
            1e3 * transform,
            1e3 * time / evaluations,
            iterations / evaluations,
            time / evaluations / (transforms * transform)
        );
    }
}
