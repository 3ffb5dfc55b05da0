//! Verifies the time-domain flow solver against the linearised equations: the right-hand side has the spectrum of
//! waves advected by the flow, and small perturbations evolve like these waves.

use analysis::kelvin::{KelvinEvolution, wave_vector, wave_vector_rate};
use analysis::pencil::Pencil;
use dynamics::flow::spectral::ModeNumbers;
use dynamics::flow::{Closure, FlowProblem, FlowSolver};
use models::LinearisedSystem;
use models::flow::state::{self, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use testkit::flows::FlowParameters;
use testkit::random::RandomNumbers;

const FLOW_KINDS: [FlowKind; 3] =
    [registry::HARRIS_GREKOVA, registry::DOUBLE_SHEARING, registry::PLASTIC_POTENTIAL];

/// Executes `task` on one thread, since the grids are too small for more.
fn run_on_one_thread(task: impl FnOnce() + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(task);
}

/// Homogeneous background flow with a steady stress angle.
struct HomogeneousFlow {
    kind: FlowKind,
    model: Model,
    flow: state::DeformingFlow,
}

impl HomogeneousFlow {
    fn new(kind: FlowKind, friction_angle: f64, cohesion: f64, given: MaterialState) -> Self {
        let parameters = FlowParameters {
            friction_angle,
            cohesion,
            dilatancy_angle: 0.0,
            moment_of_inertia: Some(1e-7),
            rotational_strength: Some(0.0),
        };
        let model = parameters.build_model(kind).expect("constants in range");
        let mut state = given;
        match kind {
            kind if kind == registry::DOUBLE_SHEARING => {
                // Double shearing: the half-vorticity at which the stress angle ψ is steady, Dψ/Dt = 0.
                let twice = 2.0 * given.noncoaxiality.unwrap_or(0.0);
                state.half_vorticity = given.shear_rate * twice.sin() / friction_angle.sin();
            }
            kind if kind == registry::PLASTIC_POTENTIAL => state.noncoaxiality = Some(0.0),
            _ => {}
        }
        let background = model.background(&state).expect("a state in range");
        let flow = *background.flow().expect("fully deforming");
        Self { kind, model, flow }
    }

    fn from_random(kind: FlowKind, random: &mut RandomNumbers) -> Self {
        let state = MaterialState {
            density: random.uniform(500.0, 3000.0),
            pressure: random.uniform(100.0, 5000.0),
            stress_angle: random.uniform(-1.5, 1.5),
            shear_rate: random.uniform(0.1, 10.0),
            half_vorticity: random.uniform(-5.0, 5.0),
            noncoaxiality: Some(loop {
                // Angles with cos 2Δ of either sign, except close to cos 2Δ = 0.
                let angle = random.uniform(-1.4, 1.4);
                if (2.0 * angle).cos().abs() > 0.1 {
                    break angle;
                }
            }),
            ..MaterialState::default()
        };
        Self::new(kind, random.uniform(0.15, 1.1), random.uniform(0.0, 500.0), state)
    }

    fn velocity_gradient(&self) -> [[f64; 2]; 2] {
        self.flow.velocity_gradient.map(|row| row.map(|entry| entry.value))
    }

    fn linearised_system(&self) -> LinearisedSystem<2> {
        let mut system = LinearisedSystem::default();
        self.model.write_symbol(&self.flow, &mut system);
        system
    }

    fn to_problem(&self, points: [usize; 2], lengths: [f64; 2]) -> FlowProblem {
        FlowProblem {
            closure: Closure::from_kind(self.kind).expect("a closure"),
            density: self.flow.density,
            friction_angle: self.model.coulomb().friction_angle,
            rotation_ratio: self.model.coulomb().friction_angle.sin(),
            cohesion: self.model.coulomb().cohesion,
            pressure: self.flow.stress.pressure,
            velocity_gradient: self.velocity_gradient(),
            stress_angle: self.flow.stress.angle,
            spin: self.flow.spin.map_or(0.0, |spin| spin.value),
            spin_acceleration: 0.0,
            points,
            lengths,
            tolerance: 1e-6,
            pressure_tolerance: 1e-12,
            min_shear_rate: 1e-3,
        }
    }
}

/// Computes the fields of a wave with the mode numbers `mode` at the grid points: velocity with the transverse
/// amplitude `velocity`, and internal variable with the amplitude `inner`.
fn compute_wave_fields(
    problem: &FlowProblem,
    mode: ModeNumbers,
    velocity: f64,
    inner: f64,
) -> ([Vec<f64>; 2], Vec<f64>) {
    let [columns, rows] = problem.points;
    let k = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / problem.lengths[axis]);
    let number = k[0].hypot(k[1]);
    let phases: Vec<f64> = (0..columns * rows)
        .map(|point| {
            let place =
                [(point % columns) as f64 / columns as f64, (point / columns) as f64 / rows as f64];
            TAU * (f64::from(mode[0]) * place[0] + f64::from(mode[1]) * place[1])
        })
        .collect();
    let across = [-k[1] / number, k[0] / number];
    let velocities =
        across.map(|component| phases.iter().map(|p| velocity * component * p.cos()).collect());
    (velocities, phases.iter().map(|p| inner * p.cos()).collect())
}

fn add_wave(
    flow: &mut FlowSolver,
    problem: &FlowProblem,
    mode: ModeNumbers,
    velocity: f64,
    inner: f64,
) {
    let ([v1, v2], inner) = compute_wave_fields(problem, mode, velocity, inner);
    flow.perturb([&v1, &v2], &inner).expect("a stress");
}

/// Returns the complex amplitudes of a mode: transverse velocity V, with v̂ = V(−k₂, k₁)/k, from the vorticity
/// amplitude ζ̂ = ikV; and internal variable (spin ω or stress angle ψ).
fn transverse_amplitudes(flow: &FlowSolver, mode: ModeNumbers) -> [Complex64; 2] {
    let [k1, k2] = flow.wave_vector(mode);
    let [[vorticity, inner], _] = flow.mode_amplitudes(mode).expect("kept");
    [vorticity / (Complex64::I * k1.hypot(k2)), inner]
}

/// Returns the time derivatives of the amplitudes of [`transverse_amplitudes`].
fn transverse_amplitude_rates(
    flow: &FlowSolver,
    mode: ModeNumbers,
    gradient: [[f64; 2]; 2],
) -> [Complex64; 2] {
    let k = flow.wave_vector(mode);
    let rate = wave_vector_rate(gradient, k);
    let square = k[0] * k[0] + k[1] * k[1];
    let stretch = (k[0] * rate[0] + k[1] * rate[1]) / square;
    let [velocity, _] = transverse_amplitudes(flow, mode);
    let [_, [vorticity, inner]] = flow.mode_amplitudes(mode).expect("kept");
    [vorticity / (Complex64::I * square.sqrt()) - velocity * stretch, inner]
}

/// Computes the matrix of the linearised rates of V and of the internal variable (ω or ψ), 1/s, by central differences
/// of the nonlinear right-hand side; for the plastic potential only its first entry is defined.
fn linearise_right_hand_side(
    problem: &FlowProblem,
    mode: ModeNumbers,
    gradient: [[f64; 2]; 2],
) -> [[Complex64; 2]; 2] {
    const RELATIVE_PERTURBATION: f64 = 5e-6;
    let mut flow = FlowSolver::new(problem).expect("a problem");
    let k = flow.wave_vector(mode);
    let rate = 0.5 * (gradient[0][0] - gradient[1][1]).hypot(gradient[0][1] + gradient[1][0]);
    let inner = match problem.closure {
        Closure::HarrisGrekova => RELATIVE_PERTURBATION * rate,
        Closure::DoubleShearing => RELATIVE_PERTURBATION,
        Closure::PlasticPotential => 0.0,
    };
    let amplitudes = [[RELATIVE_PERTURBATION * rate / k[0].hypot(k[1]), 0.0], [0.0, inner]];
    let columns = amplitudes.map(|[velocity, inner]| {
        add_wave(&mut flow, problem, mode, velocity, inner);
        let plus = transverse_amplitude_rates(&flow, mode, gradient);
        add_wave(&mut flow, problem, mode, -2.0 * velocity, -2.0 * inner);
        let minus = transverse_amplitude_rates(&flow, mode, gradient);
        add_wave(&mut flow, problem, mode, velocity, inner);
        // A cosine has two modes of half its amplitude.
        let amplitude = (velocity + inner).max(f64::MIN_POSITIVE);
        [0, 1].map(|i| (plus[i] - minus[i]) / amplitude)
    });
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

fn eigenvalues([[a, b], [c, d]]: [[Complex64; 2]; 2]) -> [Complex64; 2] {
    let half = 0.5 * (a + d);
    let root = (half * half - (a * d - b * c)).sqrt();
    // The larger eigenvalue is computed without cancellation, the other one from the determinant.
    let greater =
        if (half + root).norm() > (half - root).norm() { half + root } else { half - root };
    if greater == Complex64::ZERO { [greater; 2] } else { [greater, (a * d - b * c) / greater] }
}

/// Verifies for each model, with a thousand states, directions and wave numbers over five decades, that the matrix of
/// the linearised right-hand side has the eigenvalues of the advected waves. After −sin φ sin β (ξ·Γξ⊥)/(1 − sin φ
/// cos β) is subtracted from its first entry, it has the eigenvalues of the pencil with frozen coefficients. Here φ is
/// the friction angle, Γ the velocity gradient, ξ the unit wave normal, ξ⊥ the unit vector normal to it, and β twice
/// the angle from ξ to the stress axis.
#[test]
fn right_hand_side_has_spectrum_of_advected_waves() {
    run_on_one_thread(check_spectra);
}

fn check_spectra() {
    let mut random = RandomNumbers::with_salt(0, 7);
    for kind in FLOW_KINDS {
        for index in 0..1000 {
            let background = HomogeneousFlow::from_random(kind, &mut random);
            let gradient = background.velocity_gradient();
            let mode = [[1, 0], [0, 1], [1, 1], [1, -2], [2, 1]][index % 5];
            let length = 10f64.powf(random.uniform(-4.0, 1.0));
            let lengths = [length, length * random.uniform(0.3, 3.0)];
            let problem = background.to_problem([8, 8], lengths);
            let matrix = linearise_right_hand_side(&problem, mode, gradient);
            let k = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / lengths[axis]);
            let (number, theta) = (k[0].hypot(k[1]), k[1].atan2(k[0]));
            let system = background.linearised_system();
            let evolution = KelvinEvolution::new(&system, k, wave_vector_rate(gradient, k))
                .expect("determined");
            let reduced = evolution.reduced_rate_matrix();
            let mut pencil = Pencil::default();
            pencil.update(&system).expect("finite");
            let mut frozen = pencil.generalised_eigenvalues(number, theta);
            frozen.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
            let sin_phi = problem.friction_angle.sin();
            let beta = 2.0 * (problem.stress_angle - theta);
            let (along, across) = ([theta.cos(), theta.sin()], [-theta.sin(), theta.cos()]);
            let rotated_gradient: f64 =
                (0..4).map(|n| along[n / 2] * gradient[n / 2][n % 2] * across[n % 2]).sum();
            let rotation_term =
                -sin_phi * beta.sin() * rotated_gradient / (1.0 - sin_phi * beta.cos());
            let mut frozen_matrix = matrix;
            frozen_matrix[0][0] -= rotation_term;
            let (found, expected, found_frozen) = if reduced.nrows() == 1 {
                (vec![matrix[0][0]], vec![reduced[(0, 0)]], vec![frozen_matrix[0][0]])
            } else {
                let rows = [0, 1].map(|i| [0, 1].map(|j| reduced[(i, j)]));
                let pair = |matrix| eigenvalues(matrix).to_vec();
                (pair(matrix), pair(rows), pair(frozen_matrix))
            };
            let largest = expected.iter().map(|root| root.norm()).fold(0.0, f64::max);
            // Near the directions without leading decay the leading terms almost cancel. Their relative rounding error
            // is about ε/δ, with the perturbation δ = 5e-6 of the background in the central differences.
            let viscous = background.flow.stress.deviator.value * number * number
                / (2.0 * problem.density * background.flow.shear_rate)
                / (2.0 * background.flow.noncoaxiality).cos().abs();
            let tolerance = 1e-6 * largest + 1e-10 * viscous;
            // Two eigenvalues of equal magnitude and opposite sign may be in either order.
            let distance = |a: &[Complex64], b: &[Complex64]| {
                let max_distance = |b: &[Complex64]| {
                    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
                };
                let reversed: Vec<Complex64> = b.iter().rev().copied().collect();
                max_distance(b).min(max_distance(&reversed))
            };
            let message = || format!("{kind:?} {index}: {found:?} {expected:?} {frozen:?}");
            assert!(distance(&found, &expected) < tolerance, "{}", message());
            assert!(distance(&found_frozen, &frozen) < tolerance, "{}", message());
        }
    }
}

/// Computes the amplitudes of an advected (Kelvin) wave from the linearised equations, integrated with many steps of
/// the classical Runge–Kutta method.
fn integrate_kelvin_wave(
    background: &HomogeneousFlow,
    initial_wave_vector: [f64; 2],
    start_amplitudes: [Complex64; 2],
    duration: f64,
) -> [Complex64; 2] {
    const STEP_COUNT: usize = 4000;
    let (system, gradient) = (background.linearised_system(), background.velocity_gradient());
    let at = |time: f64| wave_vector(gradient, initial_wave_vector, time);
    let rates = |time: f64, state: &[Complex64]| -> Vec<Complex64> {
        let k = at(time);
        let evolution =
            KelvinEvolution::new(&system, k, wave_vector_rate(gradient, k)).expect("determined");
        let size = evolution.evolving_columns.len();
        (0..size)
            .map(|i| (0..size).map(|j| evolution.rate_matrix[(i, j)] * state[j]).sum())
            .collect()
    };
    let across = |[k1, k2]: [f64; 2]| [-k2 / k1.hypot(k2), k1 / k1.hypot(k2)];
    let [a1, a2] = across(initial_wave_vector);
    let mut state = vec![start_amplitudes[0] * a1, start_amplitudes[0] * a2, start_amplitudes[1]];
    if background.kind == registry::PLASTIC_POTENTIAL {
        state.pop();
    }
    let step = duration / STEP_COUNT as f64;
    for index in 0..STEP_COUNT {
        let now = index as f64 * step;
        let advance = |rates: &[Complex64], fraction: f64| -> Vec<Complex64> {
            state.iter().zip(rates).map(|(z, rate)| z + rate * fraction * step).collect()
        };
        let first = rates(now, &state);
        let second = rates(now + 0.5 * step, &advance(&first, 0.5));
        let third = rates(now + 0.5 * step, &advance(&second, 0.5));
        let fourth = rates(now + step, &advance(&third, 1.0));
        for i in 0..state.len() {
            state[i] += step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }
    let [a1, a2] = across(at(duration));
    [state[0] * a1 + state[1] * a2, state.get(2).copied().unwrap_or_default()]
}

/// Verifies that small perturbations evolve like advected waves with an error of second order in the time step, in
/// simple and in pure shear.
#[test]
fn small_perturbations_follow_linear_waves_at_second_order() {
    run_on_one_thread(check_small_perturbations);
}

fn check_small_perturbations() {
    for kind in FLOW_KINDS {
        for half_vorticity in [0.0, -1.0] {
            let state = MaterialState {
                density: 1600.0,
                pressure: 1000.0,
                stress_angle: 0.3,
                shear_rate: 1.0,
                half_vorticity,
                // Steady stress angle of double shearing: sin 2Δ = sin φ s₂₁/Q_D, with the half-vorticity s₂₁ and the
                // shear rate Q_D.
                noncoaxiality: Some(match kind {
                    kind if kind == registry::DOUBLE_SHEARING => {
                        0.5 * (0.5 * half_vorticity).asin()
                    }
                    _ => 0.3,
                }),
                ..MaterialState::default()
            };
            let background = HomogeneousFlow::new(kind, PI / 6.0, 0.0, state);
            let problem = background.to_problem([8, 8], [12.0, 9.0]);
            let mode = [1, -1];
            let (duration, amplitude) = (0.4, 1e-6);
            let mut errors = Vec::new();
            for steps in [16, 32, 64, 128] {
                let mut flow = FlowSolver::new(&problem).expect("a problem");
                add_wave(&mut flow, &problem, mode, amplitude, 0.5 * amplitude);
                let wave = flow.wave_vector(mode);
                let start = transverse_amplitudes(&flow, mode);
                for _ in 0..steps {
                    flow.advance_by(duration / f64::from(steps), 0).expect("a stress");
                }
                let expected = integrate_kelvin_wave(&background, wave, start, duration);
                let found = transverse_amplitudes(&flow, mode);
                let size = expected.iter().map(|z| z.norm()).fold(0.0, f64::max);
                // The amplitude has changed significantly.
                assert!((start[0] - expected[0]).norm() > 0.05 * size);
                errors.push(
                    (0..2).map(|i| (found[i] - expected[i]).norm()).fold(0.0, f64::max) / size,
                );
            }
            let orders: Vec<f64> =
                errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect();
            println!("{kind:?}, s21 = {half_vorticity}: errors {errors:?}, orders {orders:.2?}");
            assert!(orders[2] > 1.9 && errors[3] < 1e-3, "{kind:?}: {errors:?} {orders:?}");
        }
    }
}

/// Verifies homogeneous simple shear at the rate γ̇: perturbations of the stress angle grow at the rate γ̇ cot φ in
/// double shearing (Spencer 1964), with the friction angle φ; perturbations of the spin do not grow in the model of
/// Harris & Grekova.
#[test]
fn homogeneous_simple_shear_is_unstable_only_in_double_shearing() {
    run_on_one_thread(check_homogeneous_simple_shear);
}

fn check_homogeneous_simple_shear() {
    let (friction, rate) = (PI / 6.0, 2.0);
    let state = MaterialState {
        density: 1600.0,
        pressure: 1000.0,
        // Simple shear along x₁: the principal axis of the strain rate is at ψ_D = 45°, s₂₁ = −γ̇/2 = −Q_D, and
        // sin 2Δ = −sin φ.
        stress_angle: PI / 4.0 + 0.5 * friction,
        shear_rate: 0.5 * rate,
        half_vorticity: -0.5 * rate,
        noncoaxiality: Some(-0.5 * friction),
        ..MaterialState::default()
    };
    for (kind, expected) in
        [(registry::DOUBLE_SHEARING, rate / friction.tan()), (registry::HARRIS_GREKOVA, 0.0)]
    {
        let background = HomogeneousFlow::new(kind, friction, 0.0, state);
        let gradient = background.velocity_gradient();
        assert!((gradient[0][1] - rate).abs() + gradient[1][0].abs() < 1e-12, "{gradient:?}");
        let problem = FlowProblem { tolerance: 1e-9, ..background.to_problem([8, 8], [1.0, 1.0]) };
        // Half the difference of two solutions with opposite perturbations: the remaining nonlinear terms are cubic.
        let (amplitude, duration) = (1e-5, 1.0);
        let run_perturbed = |amplitude: f64| {
            let mut flow = FlowSolver::new(&problem).expect("a problem");
            let mean = |flow: &FlowSolver| flow.mode_amplitudes([0, 0]).expect("kept")[0][1].re;
            let start = mean(&flow);
            flow.perturb([&[0.0; 64], &[0.0; 64]], &[amplitude; 64]).expect("a stress");
            (1..=20)
                .map(|index| {
                    let time = duration * f64::from(index) / 20.0;
                    while flow.time() < time {
                        flow.advance(time).expect("a stress");
                    }
                    mean(&flow) - start
                })
                .collect::<Vec<f64>>()
        };
        let (above, below) = (run_perturbed(amplitude), run_perturbed(-amplitude));
        let logarithms: Vec<f64> =
            above.iter().zip(&below).map(|(a, b)| (0.5 * (a - b) / amplitude).ln()).collect();
        let found = logarithms[19] / duration;
        println!("{kind:?}: {found} 1/s of {expected}");
        assert!((found - expected).abs() <= 1e-6 * rate, "{kind:?}: {found}");
        // The growth rate is the same at all intermediate times.
        for (index, logarithm) in (1..).zip(&logarithms) {
            let time = duration * f64::from(index) / 20.0;
            assert!((logarithm - expected * time).abs() < 2e-6, "{kind:?} at {time}");
        }
    }
}
