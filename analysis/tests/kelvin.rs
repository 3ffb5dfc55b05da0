//! Kelvin waves in a homogeneous flow against the frozen pencil, a closed form and Runge–Kutta integration.

use crate::support::states::{RandomNumbers, seeded_generator};
use models::LinearisedSystem;
use models::flow::state::{DeformingFlow, MaterialState};
use models::flow::{FlowKind, Model};
use models::registry;
use num_complex::Complex64;
use testkit::flows::FlowParameters;
use wellposed_analysis::kelvin::{
    KelvinEvolution, integrate_kelvin_wave, wave_vector, wave_vector_rate,
};
use wellposed_analysis::pencil::Pencil;

const FLOW_KINDS: [FlowKind; 3] =
    [registry::HARRIS_GREKOVA, registry::DOUBLE_SHEARING, registry::PLASTIC_POTENTIAL];

/// A random uniform, incompressible flow.
fn random_flow(kind: FlowKind, random: &mut RandomNumbers) -> (Model, DeformingFlow) {
    let parameters = FlowParameters {
        friction_angle: random.uniform(0.1, 1.2),
        cohesion: random.uniform(0.0, 500.0),
        moment_of_inertia: Some(1e-7),
        rotational_strength: Some(0.0),
        dilatancy_angle: 0.0,
    };
    let model = parameters.build_model(kind).expect("constants in range");
    let noncoaxiality = match kind {
        own if own == registry::PLASTIC_POTENTIAL => 0.0,
        _ => random.uniform(-1.4, 1.4),
    };
    let state = MaterialState {
        density: random.uniform(500.0, 3000.0),
        pressure: random.uniform(100.0, 5000.0),
        stress_angle: random.uniform(-1.5, 1.5),
        shear_rate: random.uniform(0.1, 10.0),
        half_vorticity: random.uniform(-5.0, 5.0),
        noncoaxiality: Some(noncoaxiality),
        ..MaterialState::default()
    };
    let background = model.background(&state).expect("a state in range");
    (model, *background.flow().expect("fully deforming"))
}

/// Verifies that for a constant wave vector the admissible evolution has the finite roots of the pencil.
#[test]
fn constant_wave_vector_gives_the_roots_of_the_frozen_pencil() {
    let mut random = seeded_generator(1);
    for kind in FLOW_KINDS {
        for _ in 0..300 {
            let (model, flow) = random_flow(kind, &mut random);
            let mut system = LinearisedSystem::default();
            model.write_symbol(&flow, &mut system);
            let mut pencil = Pencil::default();
            pencil.update(&system).expect("finite");
            let (number, direction) =
                (10f64.powf(random.uniform(-1.0, 4.0)), random.uniform(0.0, 3.1));
            let wave = [number * direction.cos(), number * direction.sin()];
            let evolution = KelvinEvolution::new(&system, wave, [0.0; 2]).expect("determined");
            let mut own: Vec<Complex64> = eigenvalues(&evolution.reduced_rate_matrix());
            let mut frozen: Vec<Complex64> =
                pencil.generalised_eigenvalues(number, direction).into_iter().collect();
            assert_eq!(own.len(), frozen.len(), "{kind:?}");
            let order =
                |a: &Complex64, b: &Complex64| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im));
            own.sort_by(order);
            frozen.sort_by(order);
            let largest = frozen.iter().map(|root| root.norm()).fold(0.0, f64::max);
            for (own, frozen) in own.iter().zip(&frozen) {
                assert!((own - frozen).norm() < 1e-8 * largest, "{kind:?} {own} {frozen}");
            }
        }
    }
}

/// Eigenvalues of a matrix of one or two rows.
fn eigenvalues(matrix: &nalgebra::DMatrix<Complex64>) -> Vec<Complex64> {
    match matrix.nrows() {
        1 => vec![matrix[(0, 0)]],
        2 => {
            let half = 0.5 * matrix.trace();
            let root = (half * half - matrix.determinant()).sqrt();
            vec![half + root, half - root]
        }
        size => panic!("{size} rows"),
    }
}

/// Verifies the contribution of k̇ to the rate of the velocity against −sin φ sin β (ξ·Γξ⊥)/(1 − sin φ cos β), with the
/// unit wave vector ξ at the angle θ, the velocity gradient Γ, the stress angle Ψ and β = 2(Ψ − θ). The formula is
/// obtained by elimination of the pressure: k̇·v is the defect of the constraint, −k²(1 − sin φ cos β) the symbol of
/// the pressure, and ξ⊥·(ξ − sin φ n) = −sin φ sin β, with n at the angle 2Ψ − θ, the effect of the pressure across the
/// wave.
#[test]
fn rate_of_the_wave_vector_contributes_its_closed_form() {
    let mut random = seeded_generator(2);
    for kind in FLOW_KINDS {
        for _ in 0..300 {
            let (model, flow) = random_flow(kind, &mut random);
            let mut system = LinearisedSystem::default();
            model.write_symbol(&flow, &mut system);
            let (number, theta) = (10f64.powf(random.uniform(-1.0, 4.0)), random.uniform(0.0, 3.1));
            let (across, along) = ([-theta.sin(), theta.cos()], [theta.cos(), theta.sin()]);
            let wave = along.map(|x| number * x);
            let gradient = flow.velocity_gradient.map(|row| row.map(|own| own.value));
            let rate = wave_vector_rate(gradient, wave);
            let of_velocity = |rate: [f64; 2]| {
                let evolution = KelvinEvolution::new(&system, wave, rate).expect("determined");
                let mut sum = Complex64::ZERO;
                for i in 0..2 {
                    for j in 0..2 {
                        sum += across[i] * across[j] * evolution.rate_matrix[(i, j)];
                    }
                }
                sum
            };
            let (moving, frozen) = (of_velocity(rate), of_velocity([0.0; 2]));
            let sin_phi = model.coulomb().friction_angle.sin();
            let beta = 2.0 * (flow.stress.angle - theta);
            let turned: f64 = (0..2)
                .flat_map(|i| (0..2).map(move |j| (i, j)))
                .map(|(i, j)| along[i] * gradient[i][j] * across[j])
                .sum();
            let formula = -sin_phi * beta.sin() * turned / (1.0 - sin_phi * beta.cos());
            let rounding = 1e-12 * moving.norm();
            let difference = moving - frozen - formula;
            assert!(difference.norm() < 1e-9 * flow.shear_rate + rounding, "{kind:?} {difference}");
            // The contribution is not always small.
            if sin_phi > 0.5 && beta.sin().abs() > 0.5 && turned.abs() > 0.5 {
                assert!(formula.abs() > 0.05);
            }
        }
    }
}

/// Verifies the wave vector against its rate by differences, and in simple shear.
#[test]
fn wave_vector_agrees_with_its_rate() {
    let gradient = [[0.3, -1.2], [0.7, -0.3]];
    let (wave, step) = ([2.0, -1.0], 1e-5);
    let [before, after] = [-step, step].map(|t| wave_vector(gradient, wave, 0.4 + t));
    let rate = wave_vector_rate(gradient, wave_vector(gradient, wave, 0.4));
    for axis in 0..2 {
        assert!(((after[axis] - before[axis]) / (2.0 * step) - rate[axis]).abs() < 1e-9);
    }
    // Simple shear: k₂ falls by γ̇k₁t.
    let sheared = wave_vector([[0.0, 2.0], [0.0, 0.0]], [3.0, 1.0], 0.5);
    assert!((sheared[0] - 3.0).abs() < 1e-14 && (sheared[1] + 2.0).abs() < 1e-14, "{sheared:?}");
}

/// Verifies the evolution of a wave against the classical Runge–Kutta method, and its modes against the rate matrix.
#[test]
fn integrated_wave_agrees_with_runge_kutta() {
    let mut random = seeded_generator(3);
    for kind in FLOW_KINDS {
        let (model, flow) = random_flow(kind, &mut random);
        let mut system = LinearisedSystem::default();
        model.write_symbol(&flow, &mut system);
        let gradient = flow.velocity_gradient.map(|row| row.map(|own| own.value));
        let wave = [0.7, -0.4];
        let at = |time: f64| {
            let now = wave_vector(gradient, wave, time);
            KelvinEvolution::new(&system, now, wave_vector_rate(gradient, now)).expect("determined")
        };
        let modes = at(0.0).modes();
        assert!(modes.windows(2).all(|pair| pair[0].0.re >= pair[1].0.re));
        for (rate, mode) in &modes {
            let image = &at(0.0).rate_matrix * nalgebra::DVector::from_column_slice(mode);
            let reduced = at(0.0).reduced_rate_matrix().norm();
            // A mode z is admissible and z*Gz is its rate; Gz also has a component normal to the admissible subspace,
            // since the constraint changes with k.
            let along: Complex64 = mode.iter().take(2).zip(wave).map(|(v, k)| v * k).sum();
            assert!(along.norm() < 1e-12);
            let own: Complex64 = mode.iter().zip(image.iter()).map(|(z, r)| z.conj() * r).sum();
            assert!(
                (own - rate).norm() < 1e-9 * (reduced + flow.shear_rate),
                "{kind:?} {own} {rate}"
            );
        }
        let duration = 0.3 / flow.shear_rate;
        let start = &modes[0].1;
        let found = integrate_kelvin_wave(
            &|_| Some(system.clone()),
            gradient,
            wave,
            start,
            duration,
            [3, 40],
        )
        .expect("determined");
        let mut state = nalgebra::DVector::from_column_slice(start);
        let steps = 6000;
        let step = duration / f64::from(steps);
        for index in 0..steps {
            let now = f64::from(index) * step;
            let [begin, middle, end] =
                [0.0, 0.5, 1.0].map(|part| at(now + part * step).rate_matrix);
            let complex = |x: f64| Complex64::new(x, 0.0);
            let first = &begin * &state;
            let second = &middle * (&state + &first * complex(0.5 * step));
            let third = &middle * (&state + &second * complex(0.5 * step));
            let fourth = &end * (&state + &third * complex(step));
            state += (first + (second + third) * complex(2.0) + fourth) * complex(step / 6.0);
        }
        let difference: f64 = found[3].iter().zip(state.iter()).map(|(a, b)| (a - b).norm()).sum();
        assert!(difference < 1e-8 * state.norm(), "{kind:?}: {difference:e} of {}", state.norm());
    }
}
