//! Verifies the time-domain flow solver against the linearised equations: the right-hand side has the spectrum of
//! waves advected by the flow, and small perturbations evolve like these waves.

use analysis::kelvin::{Evolution, wave_vector, wave_vector_rate};
use analysis::pencil::Pencil;
use dynamics::flow::spectral::Mode;
use dynamics::flow::{Closure, Flow, Problem};
use models::LinearisedSystem;
use models::flow::state::{self, State};
use models::flow::{FlowKind, Model};
use models::registry;
use num_complex::Complex64;
use std::f64::consts::{PI, TAU};
use testkit::flows::Parameters;
use testkit::random::Random;

const KINDS: [FlowKind; 3] =
    [registry::HARRIS_GREKOVA, registry::DOUBLE_SHEARING, registry::PLASTIC_POTENTIAL];

/// Executes `work` on one thread: the boxes are too small for more.
fn alone(work: impl FnOnce() + Send) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(work);
}

/// Homogeneous background flow with a steady stress angle.
struct Background {
    kind: FlowKind,
    model: Model,
    flow: state::Flow,
}

impl Background {
    fn new(kind: FlowKind, friction_angle: f64, cohesion: f64, given: State) -> Self {
        let parameters = Parameters {
            friction_angle,
            cohesion,
            dilatancy_angle: 0.0,
            moment_of_inertia: Some(1e-7),
            rotational_strength: Some(0.0),
        };
        let model = parameters.model(kind).expect("constants in range");
        let mut state = given;
        match kind {
            own if own == registry::DOUBLE_SHEARING => {
                // Dψ/Dt = 0
                let twice = 2.0 * given.noncoaxiality.unwrap_or(0.0);
                state.half_vorticity = given.shear_rate * twice.sin() / friction_angle.sin();
            }
            own if own == registry::PLASTIC_POTENTIAL => state.noncoaxiality = Some(0.0),
            _ => {}
        }
        let background = model.background(&state).expect("a state in range");
        let flow = *background.flow().expect("fully deforming");
        Self { kind, model, flow }
    }

    fn random(kind: FlowKind, random: &mut Random) -> Self {
        let state = State {
            density: random.within(500.0, 3000.0),
            pressure: random.within(100.0, 5000.0),
            stress_angle: random.within(-1.5, 1.5),
            shear_rate: random.within(0.1, 10.0),
            half_vorticity: random.within(-5.0, 5.0),
            noncoaxiality: Some(loop {
                // Both branches, except close to their common point.
                let angle = random.within(-1.4, 1.4);
                if (2.0 * angle).cos().abs() > 0.1 {
                    break angle;
                }
            }),
            ..State::default()
        };
        Self::new(kind, random.within(0.15, 1.1), random.within(0.0, 500.0), state)
    }

    fn gradient(&self) -> [[f64; 2]; 2] {
        self.flow.velocity_gradient.map(|row| row.map(|own| own.value))
    }

    fn system(&self) -> LinearisedSystem<2> {
        let mut system = LinearisedSystem::default();
        self.model.symbol(&self.flow, &mut system);
        system
    }

    fn problem(&self, points: [usize; 2], lengths: [f64; 2]) -> Problem {
        Problem {
            closure: Closure::of(self.kind).expect("a closure"),
            density: self.flow.density,
            friction_angle: self.model.coulomb().friction_angle,
            rotation_ratio: self.model.coulomb().friction_angle.sin(),
            cohesion: self.model.coulomb().cohesion,
            pressure: self.flow.stress.pressure,
            velocity_gradient: self.gradient(),
            stress_angle: self.flow.stress.angle,
            spin: self.flow.spin.map_or(0.0, |spin| spin.value),
            spin_acceleration: 0.0,
            points,
            lengths,
            tolerance: 1e-6,
            pressure_tolerance: 1e-12,
            least_shear_rate: 1e-3,
        }
    }
}

/// Fields of a wave of mode `mode` at the points: transverse velocity and internal variable.
fn wave(problem: &Problem, mode: Mode, velocity: f64, inner: f64) -> ([Vec<f64>; 2], Vec<f64>) {
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
    let velocities = across.map(|part| phases.iter().map(|p| velocity * part * p.cos()).collect());
    (velocities, phases.iter().map(|p| inner * p.cos()).collect())
}

fn perturb(flow: &mut Flow, problem: &Problem, mode: Mode, velocity: f64, inner: f64) {
    let ([v1, v2], inner) = wave(problem, mode, velocity, inner);
    flow.perturb([&v1, &v2], &inner).expect("a stress");
}

/// Amplitudes of the transverse velocity V, v̂ = V(−k₂, k₁)/k, from the vorticity mode ζ̂ = ikV, and of ω or ψ.
fn transverse(flow: &Flow, mode: Mode) -> [Complex64; 2] {
    let [k1, k2] = flow.wave_vector(mode);
    let [[vorticity, inner], _] = flow.mode(mode).expect("kept");
    [vorticity / (Complex64::I * k1.hypot(k2)), inner]
}

/// Time derivatives of the amplitudes of [`transverse`].
fn transverse_rates(flow: &Flow, mode: Mode, gradient: [[f64; 2]; 2]) -> [Complex64; 2] {
    let k = flow.wave_vector(mode);
    let rate = wave_vector_rate(gradient, k);
    let square = k[0] * k[0] + k[1] * k[1];
    let stretch = (k[0] * rate[0] + k[1] * rate[1]) / square;
    let [own, _] = transverse(flow, mode);
    let [_, [vorticity, inner]] = flow.mode(mode).expect("kept");
    [vorticity / (Complex64::I * square.sqrt()) - own * stretch, inner]
}

/// 2 × 2 matrix for V and ω or ψ, by central differences of the nonlinear right-hand side; for the plastic potential
/// only its first entry is defined.
fn linearised(problem: &Problem, mode: Mode, gradient: [[f64; 2]; 2]) -> [[Complex64; 2]; 2] {
    const PART: f64 = 5e-6;
    let mut flow = Flow::new(problem).expect("a problem");
    let k = flow.wave_vector(mode);
    let rate = 0.5 * (gradient[0][0] - gradient[1][1]).hypot(gradient[0][1] + gradient[1][0]);
    let inner = match problem.closure {
        Closure::HarrisGrekova => PART * rate,
        Closure::DoubleShearing => PART,
        Closure::PlasticPotential => 0.0,
    };
    let amplitudes = [[PART * rate / k[0].hypot(k[1]), 0.0], [0.0, inner]];
    let columns = amplitudes.map(|[velocity, inner]| {
        perturb(&mut flow, problem, mode, velocity, inner);
        let plus = transverse_rates(&flow, mode, gradient);
        perturb(&mut flow, problem, mode, -2.0 * velocity, -2.0 * inner);
        let minus = transverse_rates(&flow, mode, gradient);
        perturb(&mut flow, problem, mode, velocity, inner);
        // A cosine has two modes of half its amplitude.
        let amplitude = (velocity + inner).max(f64::MIN_POSITIVE);
        [0, 1].map(|i| (plus[i] - minus[i]) / amplitude)
    });
    [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
}

fn eigenvalues([[a, b], [c, d]]: [[Complex64; 2]; 2]) -> [Complex64; 2] {
    let half = 0.5 * (a + d);
    let root = (half * half - (a * d - b * c)).sqrt();
    // The larger eigenvalue without cancellation, the other one from the determinant.
    let greater =
        if (half + root).norm() > (half - root).norm() { half + root } else { half - root };
    if greater == Complex64::ZERO { [greater; 2] } else { [greater, (a * d - b * c) / greater] }
}

/// Verifies for each model, with a thousand states, directions and wave numbers over five decades, that the
/// linearised right-hand side has the spectrum of the advected waves, and, after −sin φ sin β (ξ·Γξ⊥)/(1 − sin φ cos
/// β) is subtracted from the first entry of its matrix, the spectrum of the frozen pencil.
#[test]
fn the_right_hand_side_has_the_spectrum_of_the_waves() {
    alone(spectra);
}

fn spectra() {
    let mut random = Random::with_salt(0, 7);
    for kind in KINDS {
        for index in 0..1000 {
            let background = Background::random(kind, &mut random);
            let gradient = background.gradient();
            let mode = [[1, 0], [0, 1], [1, 1], [1, -2], [2, 1]][index % 5];
            let length = 10f64.powf(random.within(-4.0, 1.0));
            let lengths = [length, length * random.within(0.3, 3.0)];
            let problem = background.problem([8, 8], lengths);
            let own = linearised(&problem, mode, gradient);
            let k = [0, 1].map(|axis| TAU * f64::from(mode[axis]) / lengths[axis]);
            let (number, theta) = (k[0].hypot(k[1]), k[1].atan2(k[0]));
            let system = background.system();
            let evolution =
                Evolution::new(&system, k, wave_vector_rate(gradient, k)).expect("determined");
            let reduced = evolution.reduced();
            let mut pencil = Pencil::default();
            pencil.update(&system).expect("finite");
            let mut frozen = pencil.generalised_eigenvalues(number, theta);
            frozen.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
            let sin_phi = problem.friction_angle.sin();
            let beta = 2.0 * (problem.stress_angle - theta);
            let (along, across) = ([theta.cos(), theta.sin()], [-theta.sin(), theta.cos()]);
            let turned: f64 =
                (0..4).map(|n| along[n / 2] * gradient[n / 2][n % 2] * across[n % 2]).sum();
            let moved = -sin_phi * beta.sin() * turned / (1.0 - sin_phi * beta.cos());
            let mut unmoved = own;
            unmoved[0][0] -= moved;
            let (found, expected, of_pencil) = if reduced.nrows() == 1 {
                (vec![own[0][0]], vec![reduced[(0, 0)]], vec![unmoved[0][0]])
            } else {
                let [one, two] = [0, 1].map(|i| [0, 1].map(|j| reduced[(i, j)]));
                let pair = |matrix| eigenvalues(matrix).to_vec();
                (pair(own), pair([one, two]), pair(unmoved))
            };
            let largest = expected.iter().map(|root| root.norm()).fold(0.0, f64::max);
            // Near the directions without leading decay the leading terms almost cancel: their rounding error is that
            // of the perturbations, 1e-16 divided by their size relative to the background.
            let viscous = background.flow.stress.deviator.value * number * number
                / (2.0 * problem.density * background.flow.shear_rate)
                / (2.0 * background.flow.noncoaxiality).cos().abs();
            let tolerance = 1e-6 * largest + 1e-10 * viscous;
            // Two eigenvalues of equal magnitude and opposite sign may be in either order.
            let distance = |a: &[Complex64], b: &[Complex64]| {
                let of = |b: &[Complex64]| {
                    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
                };
                let turned: Vec<Complex64> = b.iter().rev().copied().collect();
                of(b).min(of(&turned))
            };
            let message = || format!("{kind:?} {index}: {found:?} {expected:?} {frozen:?}");
            assert!(distance(&found, &expected) < tolerance, "{}", message());
            assert!(distance(&of_pencil, &frozen) < tolerance, "{}", message());
        }
    }
}

/// Amplitudes of a wave by the linearised equations, integrated with many steps of the classical Runge–Kutta method.
fn kelvin(
    background: &Background,
    wave: [f64; 2],
    start: [Complex64; 2],
    time: f64,
) -> [Complex64; 2] {
    const STEPS: usize = 4000;
    let (system, gradient) = (background.system(), background.gradient());
    let at = |time: f64| wave_vector(gradient, wave, time);
    let rates = |time: f64, state: &[Complex64]| -> Vec<Complex64> {
        let k = at(time);
        let evolution =
            Evolution::new(&system, k, wave_vector_rate(gradient, k)).expect("determined");
        let size = evolution.evolving.len();
        (0..size).map(|i| (0..size).map(|j| evolution.rates[(i, j)] * state[j]).sum()).collect()
    };
    let across = |[k1, k2]: [f64; 2]| [-k2 / k1.hypot(k2), k1 / k1.hypot(k2)];
    let [a1, a2] = across(wave);
    let mut state = vec![start[0] * a1, start[0] * a2, start[1]];
    if background.kind == registry::PLASTIC_POTENTIAL {
        state.pop();
    }
    let step = time / STEPS as f64;
    for index in 0..STEPS {
        let now = index as f64 * step;
        let moved = |rates: &[Complex64], part: f64| -> Vec<Complex64> {
            state.iter().zip(rates).map(|(z, rate)| z + rate * part * step).collect()
        };
        let first = rates(now, &state);
        let second = rates(now + 0.5 * step, &moved(&first, 0.5));
        let third = rates(now + 0.5 * step, &moved(&second, 0.5));
        let fourth = rates(now + step, &moved(&third, 1.0));
        for i in 0..state.len() {
            state[i] += step / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
    }
    let [a1, a2] = across(at(time));
    [state[0] * a1 + state[1] * a2, state.get(2).copied().unwrap_or_default()]
}

/// Verifies that small perturbations evolve like the waves with second-order error in the step, in simple and in pure
/// shear.
#[test]
fn small_perturbations_follow_the_waves() {
    alone(courses);
}

fn courses() {
    for kind in KINDS {
        for half_vorticity in [0.0, -1.0] {
            let state = State {
                density: 1600.0,
                pressure: 1000.0,
                stress_angle: 0.3,
                shear_rate: 1.0,
                half_vorticity,
                // Double shearing in steady simple shear: sin 2Δ = sin φ s₂₁/Q_D.
                noncoaxiality: Some(match kind {
                    own if own == registry::DOUBLE_SHEARING => 0.5 * (0.5 * half_vorticity).asin(),
                    _ => 0.3,
                }),
                ..State::default()
            };
            let background = Background::new(kind, PI / 6.0, 0.0, state);
            let problem = background.problem([8, 8], [12.0, 9.0]);
            let mode = [1, -1];
            let (duration, amplitude) = (0.4, 1e-6);
            let mut errors = Vec::new();
            for steps in [16, 32, 64, 128] {
                let mut flow = Flow::new(&problem).expect("a problem");
                perturb(&mut flow, &problem, mode, amplitude, 0.5 * amplitude);
                let wave = flow.wave_vector(mode);
                let start = transverse(&flow, mode);
                for _ in 0..steps {
                    flow.advance_by(duration / f64::from(steps), 0).expect("a stress");
                }
                let expected = kelvin(&background, wave, start, duration);
                let found = transverse(&flow, mode);
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

/// Verifies homogeneous simple shear at γ̇: perturbations of the stress angle grow at the rate γ̇ cot φ in double
/// shearing (Spencer 1964); those of the spin do not grow in the model of Harris & Grekova.
#[test]
fn homogeneous_simple_shear_is_unstable_in_double_shearing_alone() {
    alone(homogeneous_simple_shear);
}

fn homogeneous_simple_shear() {
    let (friction, rate) = (PI / 6.0, 2.0);
    let state = State {
        density: 1600.0,
        pressure: 1000.0,
        // Simple shear along x₁: ψ_D = 45°, s₂₁ = −γ̇/2 = −Q_D, sin 2Δ = −sin φ.
        stress_angle: PI / 4.0 + 0.5 * friction,
        shear_rate: 0.5 * rate,
        half_vorticity: -0.5 * rate,
        noncoaxiality: Some(-0.5 * friction),
        ..State::default()
    };
    for (kind, expected) in
        [(registry::DOUBLE_SHEARING, rate / friction.tan()), (registry::HARRIS_GREKOVA, 0.0)]
    {
        let background = Background::new(kind, friction, 0.0, state);
        let gradient = background.gradient();
        assert!((gradient[0][1] - rate).abs() + gradient[1][0].abs() < 1e-12, "{gradient:?}");
        let problem = Problem { tolerance: 1e-9, ..background.problem([8, 8], [1.0, 1.0]) };
        // Half the difference of two solutions with opposite perturbations: the remaining nonlinear terms are cubic.
        let (amplitude, duration) = (1e-5, 1.0);
        let course = |amplitude: f64| {
            let mut flow = Flow::new(&problem).expect("a problem");
            let mean = |flow: &Flow| flow.mode([0, 0]).expect("kept")[0][1].re;
            let start = mean(&flow);
            flow.perturb([&[0.0; 64], &[0.0; 64]], &[amplitude; 64]).expect("a stress");
            (1..=20)
                .map(|part| {
                    let time = duration * f64::from(part) / 20.0;
                    while flow.time() < time {
                        flow.advance(time).expect("a stress");
                    }
                    mean(&flow) - start
                })
                .collect::<Vec<f64>>()
        };
        let (above, below) = (course(amplitude), course(-amplitude));
        let logarithms: Vec<f64> =
            above.iter().zip(&below).map(|(a, b)| (0.5 * (a - b) / amplitude).ln()).collect();
        let found = logarithms[19] / duration;
        println!("{kind:?}: {found} 1/s of {expected}");
        assert!((found - expected).abs() <= 1e-6 * rate, "{kind:?}: {found}");
        // Growth at all intermediate times.
        for (part, logarithm) in (1..).zip(&logarithms) {
            let time = duration * f64::from(part) / 20.0;
            assert!((logarithm - expected * time).abs() < 2e-6, "{kind:?} at {time}");
        }
    }
}
