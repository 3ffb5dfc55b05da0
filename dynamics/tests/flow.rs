//! Time-domain granular flow: pressure equation, energy balance, convergence in space and time, limits of the fully
//! deforming region, bitwise reproducibility.

#[path = "solid/support/shear_flow.rs"]
mod shear_flow;

use num_complex::Complex64;
use shear_flow::simple_shear;
use std::f64::consts::{FRAC_PI_6, TAU};
use wellposed_dynamics::flow::{Closure, FlowError, FlowField, FlowProblem, FlowSolver};

const CLOSURES: [Closure; 3] =
    [Closure::HarrisGrekova, Closure::DoubleShearing, Closure::PlasticPotential];

/// Returns simple shear with a steady mean flow. The non-coaxiality angle Δ is 0.3 rad in the model of Harris &
/// Grekova; sin 2Δ = −sin φ in double shearing, with the friction angle φ; Δ = 0 for the plastic potential.
fn steady_shear(closure: Closure, points: usize) -> FlowProblem {
    match closure {
        Closure::HarrisGrekova => simple_shear(closure, points, 0.3),
        Closure::DoubleShearing => simple_shear(closure, points, -0.5 * FRAC_PI_6),
        Closure::PlasticPotential => simple_shear(closure, points, 0.0),
    }
}

/// Creates a flow perturbed by four plane waves, with the deviatoric strain rate Q_D = 25 1/s and the wave number k
/// (1/m): transverse velocity of amplitude `amplitude` Q_D/k, and an internal variable of amplitude ½ `amplitude` Q_D
/// (spin ω) or ½ `amplitude` (stress angle ψ, rad).
fn perturbed_flow(problem: &FlowProblem, amplitude: f64) -> FlowSolver {
    let mut flow = FlowSolver::new(problem).expect("a problem");
    let [columns, rows] = problem.points;
    let waves = [([1.0, 0.0], 0.3), ([0.0, 1.0], 1.1), ([1.0, 1.0], 2.0), ([2.0, -1.0], 0.7)];
    let unit = 25.0 * problem.lengths[0] / TAU;
    let mut velocity = [vec![0.0; columns * rows], vec![0.0; columns * rows]];
    let mut internal_variable = vec![0.0; columns * rows];
    for (wave, phase) in waves {
        let [k1, k2]: [f64; 2] = wave;
        let number = k1.hypot(k2);
        for point in 0..columns * rows {
            let position = [
                ((point % columns) as f64 + 0.5) / columns as f64,
                ((point / columns) as f64 + 0.5) / rows as f64,
            ];
            let cos = (TAU * (k1 * position[0] + k2 * position[1]) + phase).cos();
            velocity[0][point] -= amplitude * unit * k2 / (number * number) * cos;
            velocity[1][point] += amplitude * unit * k1 / (number * number) * cos;
            let scale = if problem.closure == Closure::HarrisGrekova { 25.0 } else { 1.0 };
            internal_variable[point] += 0.5 * amplitude * scale * cos;
        }
    }
    let [v1, v2] = &velocity;
    flow.perturb([v1, v2], &internal_variable).expect("a stress");
    flow
}

fn field_values(flow: &FlowSolver, field: FlowField) -> Vec<f64> {
    let index = flow.output_fields().iter().position(|own| *own == field).expect("a field");
    flow.output_values().swap_remove(index)
}

/// Computes the Fourier coefficient of grid values for a mode, given by its numbers of periods along both axes, by
/// direct summation.
fn fourier_coefficient(values: &[f64], columns: usize, mode: [i32; 2]) -> Complex64 {
    let rows = values.len() / columns;
    let sum: Complex64 = values
        .iter()
        .enumerate()
        .map(|(point, value)| {
            let turns = f64::from(mode[0]) * (point % columns) as f64 / columns as f64
                + f64::from(mode[1]) * (point / columns) as f64 / rows as f64;
            value * Complex64::cis(-TAU * turns)
        })
        .sum();
    sum / values.len() as f64
}

/// Verifies the pressure equation ∂ᵢ∂ⱼσᵢⱼ = ρ ∂ᵢvⱼ∂ⱼvᵢ, with the stress σ computed from the output fields and the left-
/// and right-hand sides computed from directly summed Fourier series; also ∂ᵢvᵢ = 0 and the prescribed mean pressure.
#[test]
fn pressure_equation_and_incompressibility_hold() {
    for closure in CLOSURES {
        let problem = steady_shear(closure, 16);
        let mut flow = perturbed_flow(&problem, 0.2);
        // A short run, so that the box is sheared and its lattice is not rectangular.
        flow.advance_by(2e-4, 0).expect("a stress");
        assert!(flow.pressure_residual() <= 1e-11);
        let [v1, v2, p, angle] = [
            FlowField::Velocity(0),
            FlowField::Velocity(1),
            FlowField::Pressure,
            FlowField::StressAngle,
        ]
        .map(|own| field_values(&flow, own));
        let mean = p.iter().sum::<f64>() / p.len() as f64;
        assert!((mean - 1000.0).abs() < 1e-9, "{mean}");
        let (sin, cos) = problem.friction_angle.sin_cos();
        let deviator = |i: usize| p[i] * sin + problem.cohesion * cos;
        let count = p.len();
        let stress = |i: usize| {
            let (s, c) = (2.0 * angle[i]).sin_cos();
            let q = deviator(i);
            [q * c - p[i], q * s, -q * c - p[i]]
        };
        // Derivatives of velocity by Fourier series.
        let modes: Vec<[i32; 2]> =
            (-5..=5).flat_map(|m1| (-5..=5).map(move |m2| [m1, m2])).collect();
        let derivative = |values: &[f64], axis: usize| -> Vec<f64> {
            let terms: Vec<(Complex64, [i32; 2])> = modes
                .iter()
                .map(|&mode| {
                    let k = flow.wave_vector(mode)[axis];
                    (Complex64::I * k * fourier_coefficient(values, 16, mode), mode)
                })
                .collect();
            (0..count)
                .map(|point| {
                    let position = [(point % 16) as f64 / 16.0, (point / 16) as f64 / 16.0];
                    let sum: Complex64 = terms
                        .iter()
                        .map(|(value, [m1, m2])| {
                            let turns = f64::from(*m1) * position[0] + f64::from(*m2) * position[1];
                            value * Complex64::cis(TAU * turns)
                        })
                        .sum();
                    sum.re
                })
                .collect()
        };
        let gradient: Vec<Vec<f64>> =
            [(&v1, 0), (&v1, 1), (&v2, 0), (&v2, 1)].map(|(v, axis)| derivative(v, axis)).to_vec();
        let max_gradient =
            gradient.iter().flatten().fold(0.0f64, |sum, value| sum.max(value.abs()));
        for (one, other) in gradient[0].iter().zip(&gradient[3]) {
            let divergence = one + other;
            assert!(divergence.abs() < 1e-13 * max_gradient, "{closure:?} {divergence:e}");
        }
        let shear = problem.velocity_gradient[0][1];
        let inertia: Vec<f64> = (0..count)
            .map(|i| {
                let [g11, g12, g21, g22] = [0, 1, 2, 3].map(|n| gradient[n][i]);
                // ∂ᵢvⱼ∂ⱼvᵢ of the total velocity, whose gradient includes the background shear rate Γ₁₂.
                problem.density * (g11 * g11 + g22 * g22 + 2.0 * (g12 + shear) * g21)
            })
            .collect();
        let components: Vec<Vec<f64>> =
            (0..3).map(|n| (0..count).map(|i| stress(i)[n]).collect()).collect();
        let mut max_stress_term = 0.0f64;
        let mut max_residual = 0.0f64;
        for &mode in modes.iter().filter(|mode| **mode != [0, 0]) {
            let [k1, k2] = flow.wave_vector(mode);
            let [s11, s12, s22] = [0, 1, 2].map(|n| fourier_coefficient(&components[n], 16, mode));
            let left = -(k1 * k1 * s11 + 2.0 * k1 * k2 * s12 + k2 * k2 * s22);
            let right = fourier_coefficient(&inertia, 16, mode);
            max_stress_term = max_stress_term.max(left.norm()).max(right.norm());
            max_residual = max_residual.max((left - right).norm());
        }
        println!("{closure:?}: {max_residual:e} of {max_stress_term:e}");
        assert!(
            max_residual < 1e-9 * max_stress_term,
            "{closure:?}: {max_residual:e} of {max_stress_term:e}"
        );
    }
}

/// Verifies that the mean number of iterations per pressure solution differs by at most one between grids. Also, in
/// slow flow with a non-uniform stress angle ψ, that the pressure is positive, non-uniform and proportional to its
/// mean.
#[test]
fn pressure_iterations_do_not_depend_on_the_grid() {
    for closure in CLOSURES {
        let iterations: Vec<f64> = [32, 64, 128, 256]
            .map(|points| {
                let flow = perturbed_flow(&steady_shear(closure, points), 0.3);
                let [evaluations, iterations] = flow.evaluation_counts();
                iterations as f64 / evaluations as f64
            })
            .to_vec();
        println!("{closure:?}: {iterations:?}");
        let (fewest, largest) =
            iterations.iter().fold((f64::MAX, 0.0f64), |(a, b), x| (a.min(*x), b.max(*x)));
        assert!(largest <= fewest + 1.0 && largest < 40.0, "{closure:?}: {iterations:?}");
    }
    let shape = |pressure: f64| {
        let slow = FlowProblem {
            pressure,
            cohesion: 0.0,
            velocity_gradient: [[0.0, 1e-6], [0.0, 0.0]],
            ..steady_shear(Closure::DoubleShearing, 32)
        };
        let mut flow = FlowSolver::new(&slow).expect("a problem");
        let zero = vec![0.0; 32 * 32];
        let wave = |point: usize| 0.4 * (TAU * (point % 32) as f64 / 32.0).cos();
        flow.perturb([&zero, &zero], &(0..32 * 32).map(wave).collect::<Vec<_>>())
            .expect("a stress");
        field_values(&flow, FlowField::Pressure).iter().map(|p| p / pressure).collect::<Vec<_>>()
    };
    let (one, two) = (shape(1000.0), shape(2000.0));
    assert!(one.iter().zip(&two).all(|(a, b)| (a - b).abs() < 1e-9));
    assert!(one.iter().fold(0.0f64, |sum, p| sum.max((p - 1.0).abs())) > 0.05);
    assert!(one.iter().all(|p| *p > 0.0));
}

/// Verifies that the change of kinetic energy equals the work of the background flow and of the stress, with an error
/// of second order in the step.
#[test]
fn kinetic_energy_changes_by_the_work_of_background_and_stress() {
    for closure in CLOSURES {
        let residuals: Vec<f64> = [20, 40, 80]
            .map(|steps| {
                let mut flow = perturbed_flow(&steady_shear(closure, 16), 0.1);
                let start = flow.energy();
                for _ in 0..steps {
                    flow.advance_by(5e-3 / f64::from(steps), 0).expect("a stress");
                }
                let now = flow.energy();
                let change = now.kinetic - start.kinetic;
                assert!(change.abs() > 1e-2 * start.kinetic, "{closure:?}: nothing happened");
                assert!(now.internal_power > 0.0);
                (change - now.background_work - now.stress_work).abs() / start.kinetic
            })
            .to_vec();
        let order = (residuals[1] / residuals[2]).log2();
        println!("{closure:?}: {residuals:?}, order {order}");
        assert!(order > 1.8 && residuals[2] < 1e-3, "{closure:?}: {residuals:?}");
    }
}

/// Computes the L2 norm of the difference of a field between flows on a coarse and a fine grid, from the lowest Fourier
/// modes.
fn low_mode_difference(coarse: &FlowSolver, fine: &FlowSolver, own: FlowField) -> f64 {
    let (coarse, fine) = (field_values(coarse, own), field_values(fine, own));
    let (coarse_points, fine_points) = (coarse.len().isqrt(), fine.len().isqrt());
    // Points are at cell centres and differ between the grids: a phase shift aligns the modes.
    let modes = (0..=2).flat_map(|m1| (-2..=2).map(move |m2| [m1, m2]));
    modes
        .map(|mode| {
            let shift = |points: usize| {
                Complex64::cis(-TAU * 0.5 * f64::from(mode[0] + mode[1]) / points as f64)
            };
            let coarse_coefficient =
                fourier_coefficient(&coarse, coarse_points, mode) * shift(coarse_points);
            let fine_coefficient =
                fourier_coefficient(&fine, fine_points, mode) * shift(fine_points);
            (coarse_coefficient - fine_coefficient).norm_sqr()
        })
        .sum::<f64>()
        .sqrt()
}

/// Verifies exponential convergence with the number of points for all closures.
#[test]
fn errors_decrease_exponentially_with_the_number_of_points() {
    for closure in CLOSURES {
        let end = |points: usize| {
            let mut flow = perturbed_flow(
                &FlowProblem { tolerance: 1e-9, ..steady_shear(closure, points) },
                0.1,
            );
            while flow.time() < 2e-5 {
                flow.advance(2e-5).expect("a stress");
            }
            flow
        };
        let finest = end(64);
        let errors = [12, 18, 24, 36]
            .map(|points| low_mode_difference(&end(points), &finest, FlowField::Velocity(1)));
        println!("{closure:?}: {errors:?}");
        // At second order the error would decrease by a factor of 2.25 from 12 to 18 points, of 1.8 from 18 to 24.
        assert!(
            errors[1] < errors[0] / 5.0 && errors[2] < errors[1] / 3.0,
            "{closure:?}: {errors:?}"
        );
        assert!(errors[3] < 1e-3 * errors[0], "{closure:?}: {errors:?}");
    }
}

/// Verifies that the error of a run decreases with the tolerance of the step control.
#[test]
fn errors_decrease_with_the_tolerance() {
    let end = |tolerance: f64| {
        let mut flow = perturbed_flow(
            &FlowProblem { tolerance, ..steady_shear(Closure::HarrisGrekova, 16) },
            0.1,
        );
        while flow.time() < 2e-2 {
            flow.advance(2e-2).expect("a stress");
        }
        (field_values(&flow, FlowField::Velocity(0)), flow.steps())
    };
    let (exact, _) = end(1e-9);
    let norm = exact.iter().map(|v| v * v).sum::<f64>().sqrt();
    let found = [1e-4, 1e-5, 1e-6, 1e-7].map(|tolerance| {
        let (values, steps) = end(tolerance);
        let square: f64 = values.iter().zip(&exact).map(|(a, b)| (a - b) * (a - b)).sum();
        (square.sqrt() / norm, steps)
    });
    println!("{found:?}");
    for (own, tolerance) in found.iter().zip([1e-4, 1e-5, 1e-6, 1e-7]) {
        assert!(own.0 < 100.0 * tolerance, "{found:?}");
    }
    assert!(found.windows(2).all(|pair| pair[1].0 < 0.5 * pair[0].0 && pair[1].1 > pair[0].1));
}

/// Verifies for the model of Harris & Grekova: within the bound of well-posedness finite perturbations decay, and
/// results on both grids agree; beyond the bound perturbations grow at rates proportional to k², hence faster on finer
/// grids.
#[test]
fn growth_depends_on_resolution_only_beyond_the_well_posedness_bound() {
    let growth = |noncoaxiality: f64, points: usize, amplitude: f64, duration: f64| {
        let mut flow =
            perturbed_flow(&simple_shear(Closure::HarrisGrekova, points, noncoaxiality), amplitude);
        // White noise, to excite all scales of the grid.
        let count = points * points;
        let mut seed = 1u64;
        let noise: Vec<f64> = (0..2 * count)
            .map(|_| {
                seed = seed.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
                1e-7 * ((seed >> 33) as f64 / 2f64.powi(31) - 0.5)
            })
            .collect();
        flow.perturb([&noise[..count], &noise[count..]], &vec![0.0; count]).expect("a stress");
        let start = flow.energy_spectrum();
        while flow.time() < duration {
            flow.advance(duration).expect("a stress");
        }
        let shell = points / 3 - 1;
        (flow.energy().kinetic, (flow.energy_spectrum()[shell] / start[shell]).ln())
    };
    let [coarse, fine] = [16, 32].map(|points| growth(0.3, points, 0.2, 1e-2).0);
    let start =
        perturbed_flow(&simple_shear(Closure::HarrisGrekova, 16, 0.3), 0.2).energy().kinetic;
    assert!(fine < 0.7 * start, "{fine} of {start}");
    assert!((coarse - fine).abs() < 1e-3 * fine, "{coarse} {fine}");
    let [coarse, fine] = [16, 32].map(|points| growth(1.0, points, 0.0, 2e-6).1);
    println!("outside: growth of the shortest waves {coarse} and {fine}");
    // Rates are proportional to k².
    assert!(coarse > 0.0 && fine > 3.0 * coarse, "{coarse} {fine}");
}

/// Verifies that a run stops, in its last valid state, when some point has no stress angle, and that the error states
/// the position of that point.
#[test]
fn points_without_a_stress_angle_stop_the_run() {
    // The background spin ω accelerates beyond the limit sin φ |ω − s₂₁| = Q_D, with the half-vorticity s₂₁ and the
    // deviatoric strain rate Q_D = 25 1/s.
    let fast =
        FlowProblem { spin_acceleration: -2e4, ..simple_shear(Closure::HarrisGrekova, 8, 0.3) };
    let mut flow = perturbed_flow(&fast, 1e-4);
    let failure = loop {
        match flow.advance(1.0) {
            Ok(()) => assert!(flow.time() < 1.0),
            Err(failure) => break failure,
        }
    };
    // Time t at which the spin ω = −25 − 25 sin 0.6/sin φ − 2e4 t, 1/s, reaches the limit −25 − 50 1/s.
    let expected = 50.0 * (1.0 - 0.6f64.sin()) / 2e4;
    assert!(failure.description.contains("no stress angle"), "{failure}");
    assert!((failure.time / expected - 1.0).abs() < 1e-2, "{} {expected}", failure.time);
    assert!(flow.time() <= failure.time && flow.time() > 0.98 * expected);
    // The fields are those of the last valid state.
    let mut restarted = FlowSolver::new(&fast).expect("a problem");
    assert!(restarted.restore(&flow.snapshot()));
    assert_eq!(flow.output_values(), restarted.output_values());
    assert_eq!(flow.energy(), restarted.energy());
    // Plastic potential: the perturbation cancels the shear rate at some points.
    let mut flow =
        FlowSolver::new(&steady_shear(Closure::PlasticPotential, 16)).expect("a problem");
    let cancelling_velocity: Vec<f64> =
        (0..256).map(|i| 50.0 * 0.1 / TAU * (TAU * f64::from(i / 16) / 16.0).cos()).collect();
    let failure = flow.perturb([&cancelling_velocity, &vec![0.0; 256]], &[]).expect_err("rigid");
    assert!(failure.description.contains("nearly rigid"), "{failure}");
    // The perturbation has ∂₂v₁ = −50 1/s, the opposite of the background, at a quarter of the box above the first
    // point.
    let position = failure.position.expect("a point");
    assert!((position[1] - 4.5 * 0.1 / 16.0).abs() < 1e-12, "{failure:?}");
}

/// Verifies that results do not depend, bit by bit, on the number of threads or on resuming from a snapshot.
#[test]
fn results_do_not_depend_on_threads_or_snapshots() {
    for closure in CLOSURES {
        let run = |threads: usize, resume: bool| {
            let pool =
                rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let problem = steady_shear(closure, 48);
                let mut flow = perturbed_flow(&problem, 0.1);
                for step in 0..12 {
                    if resume && step == 7 {
                        let snapshot = flow.snapshot();
                        flow = FlowSolver::new(&problem).expect("a problem");
                        assert!(flow.restore(&snapshot));
                    }
                    flow.advance(1e-3).expect("a stress");
                }
                (flow.time().to_bits(), flow.snapshot())
            })
        };
        let expected = run(1, false);
        let bits = |snapshot: &wellposed_dynamics::flow::FlowSnapshot| -> Vec<Vec<u64>> {
            snapshot
                .solver_arrays
                .iter()
                .map(|part| part.iter().map(|x| x.to_bits()).collect())
                .collect()
        };
        for found in [run(3, false), run(2, true)] {
            assert_eq!(expected.0, found.0, "{closure:?}");
            assert_eq!(bits(&expected.1), bits(&found.1), "{closure:?}");
        }
    }
    let mut flow = FlowSolver::new(&steady_shear(Closure::PlasticPotential, 8)).expect("a problem");
    let finer_snapshot = FlowSolver::new(&steady_shear(Closure::PlasticPotential, 16))
        .expect("a problem")
        .snapshot();
    assert!(!flow.restore(&finer_snapshot));
}

/// Verifies that an unperturbed flow takes less than 1000 steps to 0.5 s, and that a step which needs too many stages
/// is refused.
#[test]
fn step_size_and_number_of_stages_are_limited() {
    let unperturbed_problem =
        FlowProblem { lengths: [10.0, 10.0], ..simple_shear(Closure::HarrisGrekova, 8, 0.3) };
    let mut flow = FlowSolver::new(&unperturbed_problem).expect("a problem");
    let zero = vec![0.0; 64];
    flow.perturb([&zero, &zero], &zero).expect("a stress");
    while flow.time() < 0.5 {
        flow.advance(0.5).expect("a stress");
    }
    assert!(flow.steps() < 1000, "{}", flow.steps());
    let stiff = FlowProblem { lengths: [1e-6, 1e-6], ..unperturbed_problem };
    let mut flow = perturbed_flow(&stiff, 1e-3);
    let before = flow.snapshot();
    let failure = flow.advance_by(1.0, 0).expect_err("too many stages");
    assert!(failure.description.contains("too many stages"), "{failure}");
    assert_eq!(flow.snapshot().solver_arrays[1], before.solver_arrays[1]);
}

/// Verifies that a step calls back before each evaluation of the right-hand side, at times within the step.
#[test]
fn each_evaluation_of_a_step_is_announced() {
    let mut flow = perturbed_flow(&steady_shear(Closure::HarrisGrekova, 16), 1e-3);
    let [start, _] = flow.evaluation_counts();
    let mut times = Vec::new();
    for _ in 0..3 {
        flow.advance_with(1e-3, &mut |time| times.push(time)).expect("a step");
    }
    let [end, _] = flow.evaluation_counts();
    assert_eq!(times.len(), end - start);
    assert!(times.iter().all(|time| (0.0..=1e-3).contains(time)), "{times:?}");
    assert!(times.contains(&flow.time()));
}

#[test]
fn invalid_problems_are_refused() {
    let sound = steady_shear(Closure::HarrisGrekova, 8);
    let error = |problem: FlowProblem| FlowSolver::new(&problem).map(|_| ()).expect_err("refused");
    assert_eq!(
        error(FlowProblem { points: [8, 9], ..sound.clone() }),
        FlowError::PointCount([8, 9])
    );
    let negative = FlowProblem { density: -1.0, ..sound.clone() };
    assert_eq!(error(negative), FlowError::Parameter { name: "the density", value: -1.0 });
    let tension = FlowProblem { pressure: -1e3, ..sound.clone() };
    assert!(error(tension).to_string().starts_with("the deviatoric stress cannot be -"));
    let rotation = [[0.0, 1.0], [-1.0, 0.0]];
    let turning = FlowProblem { velocity_gradient: rotation, ..sound };
    assert_eq!(error(turning), FlowError::VelocityGradient(rotation));
}

/// Verifies the deformation of the box against exp(Γt) for velocity gradients Γ of simple shear, of pure shear, and
/// with rotation.
#[test]
fn box_deformation_is_the_exponential_of_the_velocity_gradient() {
    for gradient in
        [[[0.0, 3.0], [0.0, 0.0]], [[2.0, 0.0], [0.0, -2.0]], [[0.5, 2.0], [-1.0, -0.5]]]
    {
        let slow = FlowProblem {
            velocity_gradient: gradient,
            ..steady_shear(Closure::PlasticPotential, 8)
        };
        let slow = FlowProblem {
            stress_angle: 0.5
                * (gradient[0][1] + gradient[1][0]).atan2(gradient[0][0] - gradient[1][1]),
            ..slow
        };
        let mut flow = FlowSolver::new(&slow).expect("a problem");
        let zero = vec![0.0; 64];
        flow.perturb([&zero, &zero], &[]).expect("a stress");
        flow.advance_by(0.7, 0).expect("a stress");
        // Power series of the matrix exponential.
        let matrix = nalgebra::Matrix2::<f64>::from_fn(|i, j| 0.7 * gradient[i][j]);
        let mut sum = nalgebra::Matrix2::<f64>::identity();
        let mut term = sum;
        for n in 1..40 {
            term = term * matrix / f64::from(n);
            sum += term;
        }
        let found: [[f64; 2]; 2] = flow.deformation_gradient();
        for i in 0..2 {
            for j in 0..2 {
                assert!((found[i][j] - sum[(i, j)]).abs() < 1e-13, "{found:?} {sum}");
            }
        }
    }
}
