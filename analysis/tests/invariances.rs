//! Invariance of verdicts and roots under rotated axes, superposed rotation, moving observers and other units, and
//! symmetry under −k.

use crate::support::exact::{System256, match_roots, solve_roots};
use crate::support::real256::{Complex256, Real256};
use crate::support::states::{
    DilatancyKind, FlowSample, RandomNumbers, sample_order_one, seeded_generator,
};
use crate::support::verdicts::compute_verdict;
use models::flow::state::MaterialState;
use models::registry;
use num_complex::Complex64;
use std::f64::consts::PI;
use testkit::flows::{FlowParameters, SQUARE_MODEL_CASES};
use wellposed_analysis::growth::Verdict;
use wellposed_analysis::pencil::{Pencil, PencilRoots};

const STATE_COUNT: u64 = 350;

/// Random samples of all models, with the random-number generator for further draws.
fn random_samples(seed: u64) -> impl Iterator<Item = (u64, RandomNumbers, FlowSample)> {
    (0..STATE_COUNT).map(move |n| {
        let mut random = seeded_generator(seed + n);
        let (kind, dilatancy) = SQUARE_MODEL_CASES[n as usize % SQUARE_MODEL_CASES.len()];
        let sample = sample_order_one(
            &mut random,
            kind,
            dilatancy,
            (n as usize / SQUARE_MODEL_CASES.len()).is_multiple_of(2),
        );
        (n, random, sample)
    })
}

fn build_pencil(sample: &FlowSample) -> Pencil {
    let mut pencil = Pencil::default();
    pencil.update(&sample.system).expect("finite coefficients");
    pencil
}

fn sample_verdict(sample: &FlowSample) -> Verdict {
    compute_verdict(&sample.system)
}

/// Finite roots of a sample.
fn finite_roots(sample: &FlowSample, k: f64, direction: f64) -> Vec<Complex64> {
    match build_pencil(sample).roots(k, direction) {
        PencilRoots::Regular { finite, .. } => finite,
        singular => panic!("{singular:?}"),
    }
}

/// Verifies that two verdicts agree in name, order and, up to a `factor`, coefficient; if growth is unbounded at finite
/// k, also in direction, up to a `turn` (rad).
fn assert_same_verdict(before: &Verdict, after: &Verdict, factor: impl Fn(f64) -> f64, turn: f64) {
    match (before, after) {
        (
            Verdict::IllPosed { growth: a, direction: x },
            Verdict::IllPosed { growth: b, direction: y },
        ) => {
            match (a, b) {
                (None, None) => {
                    let gap = (x + turn - y).rem_euclid(PI);
                    // There are two such directions; the verdict may report either.
                    assert!(gap < 1e-7 || PI - gap < 1e-7 || gap > 1e-3);
                }
                (Some(a), Some(b)) => {
                    assert_eq!(a.order, b.order, "{before:?}, {after:?}");
                    let ratio = b.coefficient / (a.coefficient * factor(a.order.to_f64()));
                    assert!((ratio - 1.0).abs() < 1e-7, "{ratio}: {before:?}, {after:?}");
                }
                _ => panic!("{before:?}, {after:?}"),
            }
        }
        _ => assert_eq!(before.name(), after.name(), "{before:?}, {after:?}"),
    }
}

/// Verifies that two sets of roots agree to a relative tolerance.
fn assert_roots_close(before: &[Complex64], after: &[Complex64], tolerance: f64) {
    assert_eq!(before.len(), after.len());
    let wanted: Vec<Complex256> = before.iter().map(|&z| z.into()).collect();
    for (found, wanted) in match_roots(after, &wanted) {
        let wanted = wanted.to_complex64();
        let gap = (found - wanted).norm();
        assert!(gap <= tolerance * wanted.norm(), "{before:?}, {after:?}");
    }
}

/// Rotates vectors by the angle `turn`, rad.
fn rotate(turn: f64, [x, y]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = turn.sin_cos();
    [cos * x - sin * y, sin * x + cos * y]
}

/// The state with all gradients rotated by the angle `turn`, rad.
fn rotate_gradients(turn: f64, state: MaterialState) -> MaterialState {
    MaterialState {
        pressure_gradient: rotate(turn, state.pressure_gradient),
        stress_angle_gradient: rotate(turn, state.stress_angle_gradient),
        spin_gradient: rotate(turn, state.spin_gradient),
        density_gradient: rotate(turn, state.density_gradient),
        inertia_gradient: rotate(turn, state.inertia_gradient),
        ..state
    }
}

/// Verifies that rotating all vectors and angles leaves the verdict and the roots unchanged and rotates the direction
/// in which growth is unbounded at finite k.
#[test]
fn rotating_the_axes_rotates_the_verdict() {
    for (_, mut random, sample) in random_samples(0x107a) {
        let turn = random.uniform(-4.0, 4.0);
        let state = MaterialState {
            stress_angle: sample.state.stress_angle + turn,
            velocity: rotate(turn, sample.state.velocity),
            ..rotate_gradients(turn, sample.state)
        };
        let turned = FlowSample::new(sample.kind(), sample.parameters, state);
        let (before, after) = (sample_verdict(&sample), sample_verdict(&turned));
        assert_same_verdict(&before, &after, |_| 1.0, turn);
        let (k, direction) = (random.log_uniform(1e-2, 1e4), random.uniform(0.0, PI));
        assert_roots_close(
            &finite_roots(&sample, k, direction),
            &finite_roots(&turned, k, direction + turn),
            1e-8,
        );
    }
}

/// Verifies that the verdict is invariant under rotation for degenerate directions along the axes and the diagonals,
/// where coefficients of the polynomial vanish that do not vanish in general axes.
#[test]
fn verdict_is_invariant_for_degenerate_directions_along_the_axes() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (n, (kind, dilatancy)) in SQUARE_MODEL_CASES.into_iter().enumerate() {
        for phi in [20.0f64, 30.0, 40.0, 60.0] {
            let nu = match dilatancy {
                DilatancyKind::Zero => 0.0,
                DilatancyKind::Positive => 10.0,
                DilatancyKind::Associated => phi,
            };
            for target in [0.0, 45.0, 90.0, 135.0] {
                for half in [45.0 - 0.5 * phi, 0.5 * phi - 45.0, 45.0 - 0.5 * nu, 0.0, 45.0] {
                    for gradients in [false, true] {
                        let random = &mut seeded_generator(0xa115 + n as u64);
                        let sample = sample_order_one(random, kind, dilatancy, gradients);
                        let at = |turn_deg: f64| {
                            let parameters = FlowParameters {
                                friction_angle: phi.to_radians(),
                                dilatancy_angle: nu.to_radians(),
                                ..sample.parameters
                            };
                            let noncoaxiality =
                                (kind != registry::PLASTIC_POTENTIAL).then_some(0.2);
                            let state = MaterialState {
                                stress_angle: (target + half + turn_deg).to_radians(),
                                noncoaxiality,
                                ..rotate_gradients(turn_deg.to_radians(), sample.state)
                            };
                            sample_verdict(&FlowSample::new(kind, parameters, state))
                        };
                        count += 1;
                        let (aligned, turned) = (at(0.0), at(17.3));
                        let same = match (&aligned, &turned) {
                            (
                                Verdict::IllPosed { growth: Some(a), .. },
                                Verdict::IllPosed { growth: Some(b), .. },
                            ) => {
                                a.order == b.order
                                    && (a.coefficient / b.coefficient - 1.0).abs() < 1e-7
                            }
                            _ => aligned.name() == turned.name(),
                        };
                        if !same {
                            wrong.push(format!(
                                "{kind:?} φ {phi} ν {nu}, Ψ {}, gradients {gradients}: {aligned:?}, \
                                 turned {turned:?}",
                                target + half
                            ));
                        }
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
}

/// Verifies that a superposed velocity W leaves the verdict unchanged bit for bit and shifts the roots by −ik·W.
#[test]
fn verdict_and_growth_are_galilean_invariant() {
    for (_, mut random, sample) in random_samples(0x6a11) {
        let shift = [random.signed_log_uniform(1e-2, 1e2), random.signed_log_uniform(1e-2, 1e2)];
        let [v1, v2] = sample.state.velocity;
        let state = MaterialState { velocity: [v1 + shift[0], v2 + shift[1]], ..sample.state };
        let moved = FlowSample::new(sample.kind(), sample.parameters, state);
        assert_eq!(sample_verdict(&sample), sample_verdict(&moved));
        let (k, direction) = (random.log_uniform(1e-2, 1e4), random.uniform(0.0, PI));
        let (sin, cos) = direction.sin_cos();
        let convection = Complex64::new(0.0, k * (shift[0] * cos + shift[1] * sin));
        let (before, after) =
            (finite_roots(&sample, k, direction), finite_roots(&moved, k, direction));
        assert_eq!(before.len(), after.len());
        let wanted: Vec<Complex256> = before.iter().map(|&z| (z - convection).into()).collect();
        for (found, wanted) in match_roots(&after, &wanted) {
            let wanted = wanted.to_complex64();
            let size = wanted.norm() + k * (v1.hypot(v2) + 2.0 * shift[0].hypot(shift[1]));
            assert!((found - wanted).norm() <= 4.0 * f64::EPSILON * size, "{found}, {wanted}");
            // The growth rate does not change beyond its last bit.
            assert!((found.re - wanted.re).abs() <= f64::EPSILON * found.re.abs());
        }
    }
}

/// Verifies a superposed rotation at the rate s, which adds s to half the vorticity and to the spin at constant
/// rotational stress: in C, with J the rotation by 90°, the velocities gain ρs J in the momentum equations and ρs ∇I
/// (moment of inertia I) in the equation of the spin. The growth of short waves is unchanged.
#[test]
fn superposed_rotation_leaves_growth_unchanged() {
    for n in 0..STATE_COUNT {
        let mut random = seeded_generator(0x5917 + n);
        let dilatancy =
            if n.is_multiple_of(2) { DilatancyKind::Zero } else { DilatancyKind::Positive };
        let sample = sample_order_one(&mut random, registry::HARRIS_GREKOVA, dilatancy, n % 4 < 2);
        let rate = random.signed_log_uniform(1e-2, 10.0);
        let state = MaterialState {
            half_vorticity: sample.state.half_vorticity + rate,
            rotational_stress: Some(sample.flow.stress.rotational_stress),
            ..sample.state
        };
        let rotating = FlowSample::new(sample.kind(), sample.parameters, state);
        let [before, after] = [&sample, &rotating].map(|s| s.flow.spin.expect("it spins").value);
        assert!((after - before - rate).abs() <= 1e-14 * (after.abs() + before.abs()));
        assert_same_verdict(&sample_verdict(&sample), &sample_verdict(&rotating), |_| 1.0, 0.0);

        let mut wanted = System256::from_linearised(&sample.system);
        let density = Real256::from(sample.state.density);
        let turn = density
            * (Real256::from(state.half_vorticity) - Real256::from(sample.state.half_vorticity));
        wanted.entries[0][1][3] += -turn;
        wanted.entries[1][0][3] += turn;
        for j in 0..2 {
            wanted.entries[2][j][3] += turn * Real256::from(sample.state.inertia_gradient[j]);
        }
        let (k, direction) = (random.log_uniform(1e-2, 1e4), random.uniform(0.0, PI));
        let (sin, cos) = direction.sin_cos();
        let [v1, v2] = sample.state.velocity;
        let convection = Complex64::new(0.0, k * (v1 * cos + v2 * sin));
        let wanted: Vec<Complex64> = solve_roots(&wanted.coefficients_at_wave([k * cos, k * sin]))
            .into_iter()
            .map(|z| z.to_complex64() - convection)
            .collect();
        assert_roots_close(&wanted, &finite_roots(&rotating, k, direction), 1e-8);
    }
}

/// Verifies verdicts and roots in arbitrary units of mass, length and time.
#[test]
fn verdict_and_roots_do_not_depend_on_units() {
    for (_, mut random, sample) in random_samples(0x517) {
        let mut unit = || random.log_uniform(1e-3, 1e3);
        let (mass, length, time) = (unit(), unit(), unit());
        let stress = mass / (length * time * time);
        let by = |factor: f64| move |v: [f64; 2]| v.map(|x| x * factor);
        let (s, p) = (sample.state, sample.parameters);
        let parameters = FlowParameters {
            cohesion: p.cohesion * stress,
            moment_of_inertia: p.moment_of_inertia.map(|i| i * length * length),
            rotational_strength: p.rotational_strength.map(|m| m * stress),
            ..p
        };
        let density = mass / (length * length * length);
        let state = MaterialState {
            density: s.density * density,
            pressure: s.pressure * stress,
            shear_rate: s.shear_rate / time,
            half_vorticity: s.half_vorticity / time,
            velocity: by(length / time)(s.velocity),
            pressure_gradient: by(stress / length)(s.pressure_gradient),
            stress_angle_gradient: by(1.0 / length)(s.stress_angle_gradient),
            spin_gradient: by(1.0 / (time * length))(s.spin_gradient),
            density_gradient: by(density / length)(s.density_gradient),
            inertia_rate: s.inertia_rate * length * length / time,
            inertia_gradient: by(length)(s.inertia_gradient),
            ..s
        };
        let other = FlowSample::new(sample.kind(), parameters, state);
        let factor = |order: f64| length.powf(order) / time;
        assert_same_verdict(&sample_verdict(&sample), &sample_verdict(&other), factor, 0.0);
        let (k, direction) = (random.log_uniform(1e-2, 1e4), random.uniform(0.0, PI));
        let before: Vec<Complex64> =
            finite_roots(&sample, k, direction).into_iter().map(|z| z / time).collect();
        assert_roots_close(&before, &finite_roots(&other, k / length, direction), 1e-8);
    }
}

/// Verifies ς(−k) = conj ς(k), since the fields are real.
#[test]
fn opposite_wave_vectors_have_conjugate_roots() {
    for (_, mut random, sample) in random_samples(0xc0) {
        let (k, direction) = (random.log_uniform(1e-2, 1e8), random.uniform(0.0, PI));
        let before: Vec<Complex64> =
            finite_roots(&sample, k, direction).into_iter().map(|z| z.conj()).collect();
        assert_roots_close(&before, &finite_roots(&sample, -k, direction), 1e-14);
        assert_roots_close(&before, &finite_roots(&sample, k, direction + PI), 1e-8);
    }
}
