//! Invariances of the linearised equations: rotation of the frame, superposed rigid spin, Galilean shift, change of
//! units; and reuse of the storage of a system.

use crate::support::RandomNumbers;
use crate::support::states::{self, RandomCase};
use std::f64::consts::FRAC_PI_2;
use testkit::flows::{FlowParameters, MODEL_CASES};
use wellposed_models::flow::state::MaterialState;
use wellposed_models::{LinearisedSystem, Rounded};

const STATE_COUNT: usize = 250;

fn rotate_vector([x, y]: [f64; 2], angle: f64) -> [f64; 2] {
    let (s, c) = angle.sin_cos();
    [c * x - s * y, s * x + c * y]
}

fn map_vectors(state: &MaterialState, f: impl Fn([f64; 2]) -> [f64; 2]) -> MaterialState {
    MaterialState {
        velocity: f(state.velocity),
        pressure_gradient: f(state.pressure_gradient),
        stress_angle_gradient: f(state.stress_angle_gradient),
        spin_gradient: f(state.spin_gradient),
        density_gradient: f(state.density_gradient),
        inertia_gradient: f(state.inertia_gradient),
        ..*state
    }
}

/// Matrix that rotates the first two unknowns or equations (in all models the velocities or momentum balances) by
/// `angle` and is the identity on the others.
fn rotation_matrix(size: usize, angle: f64) -> Vec<Vec<f64>> {
    let (s, c) = angle.sin_cos();
    let mut matrix = vec![vec![0.0; size]; size];
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    matrix[0][..2].copy_from_slice(&[c, -s]);
    matrix[1][..2].copy_from_slice(&[s, c]);
    matrix
}

/// Product L M Rᵀ of `left`, `matrix` and the transpose of `right`, with rounding bounds.
fn transform_matrix(
    left: &[Vec<f64>],
    matrix: impl Fn(usize, usize) -> Rounded,
    right: &[Vec<f64>],
) -> Vec<Vec<Rounded>> {
    (0..left.len())
        .map(|i| {
            (0..right.len())
                .map(|j| {
                    let mut sum = Rounded::ZERO;
                    for (m, &l) in left[i].iter().enumerate() {
                        for (n, &r) in right[j].iter().enumerate() {
                            if l * r != 0.0 {
                                sum += Rounded::from_rounded(l * r) * matrix(m, n);
                            }
                        }
                    }
                    sum
                })
                .collect()
        })
        .collect()
}

/// Under a rotation of the frame A and C transform as tensors in their velocity columns and momentum rows, and the Bⁱ
/// besides as the components of a vector with the index i.
///
/// Tolerance: twice the rounding bounds of both compared values. The vectors of the rotated state are rounded by a few
/// units in the last place, which the bounds of the terms that contain them cover.
#[test]
fn coefficients_transform_as_tensors_under_rotation_of_the_frame() {
    let mut worst = 0.0f64;
    states::for_random_cases(900, STATE_COUNT, |random, case| {
        let RandomCase { kind, dilatancy, model, state, .. } = case;
        let angle = random.signed_uniform(0.1, 3.0);
        let after = MaterialState {
            stress_angle: state.stress_angle + angle,
            ..map_vectors(&state, |v| rotate_vector(v, angle))
        };
        let before = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let after = states::assemble_symbol(&model, &states::complete_flow(&model, &after));
        let left = rotation_matrix(before.equations.len(), angle);
        let right = rotation_matrix(before.unknowns.len(), angle);

        let (s, c) = angle.sin_cos();
        let vector = |i: usize, j: usize, k: usize| {
            let (b1, b2) = (before.b[0][(i, j)], before.b[1][(i, j)]);
            if k == 0 { c * b1 - s * b2 } else { s * b1 + c * b2 }
        };
        let pairs = [
            (&after.a, transform_matrix(&left, |i, j| before.a[(i, j)], &right)),
            (&after.b[0], transform_matrix(&left, |i, j| vector(i, j, 0), &right)),
            (&after.b[1], transform_matrix(&left, |i, j| vector(i, j, 1), &right)),
            (&after.c, transform_matrix(&left, |i, j| before.c[(i, j)], &right)),
        ];
        for (number, (own, expected)) in pairs.iter().enumerate() {
            for (i, row) in expected.iter().enumerate() {
                for (j, expected) in row.iter().enumerate() {
                    let own = own[(i, j)];
                    let bound = 2.0 * (own.bound + expected.bound);
                    let off = (own.value - expected.value).abs();
                    worst = worst.max(off / (bound + 1e-300));
                    assert!(
                        off <= bound,
                        "{kind:?} {dilatancy:?} matrix {number} ({i}, {j}): {} for {}",
                        own.value,
                        expected.value
                    );
                }
            }
        }
    });
    println!("rotation of the frame: {worst:.2} of the tolerance");
}

/// A rotation by 90° maps axes to axes: the entries of A, B¹, B² and C are permuted up to signs, without cancellation.
#[test]
fn rotation_by_90_degrees_permutes_the_coefficients() {
    states::for_random_cases(920, STATE_COUNT, |_, case| {
        let RandomCase { model, state, .. } = case;
        let after = MaterialState {
            stress_angle: state.stress_angle + FRAC_PI_2,
            ..map_vectors(&state, |[x, y]| [-y, x])
        };
        let before = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let after = states::assemble_symbol(&model, &states::complete_flow(&model, &after));
        // New and old components: ∂₁' = −∂₂, ∂₂' = ∂₁, v₁' = −v₂, v₂' = v₁.
        let old = |i: usize| [(1, -1.0), (0, 1.0)].get(i).copied().unwrap_or((i, 1.0));
        for i in 0..before.equations.len() {
            for j in 0..before.unknowns.len() {
                let ((m, row), (n, column)) = (old(i), old(j));
                let sign = row * column;
                for (own, expected) in [
                    (after.a[(i, j)], sign * before.a[(m, n)]),
                    (after.b[0][(i, j)], -sign * before.b[1][(m, n)]),
                    (after.b[1][(i, j)], sign * before.b[0][(m, n)]),
                    (after.c[(i, j)], sign * before.c[(m, n)]),
                ] {
                    let off = (own.value - expected.value).abs();
                    assert!(off <= 4.0 * (own.bound + expected.bound));
                }
            }
        }
    });
}

/// A superposed rigid spin w shifts half the vorticity and the spin equally at constant Δ. Then C changes by ±ρw (the
/// antisymmetric part of ∇V) in the momentum rows and by ρw ∇I in the spin row; all other entries of A, B and C are
/// unchanged.
#[test]
fn superposed_rigid_spin_changes_only_the_expected_coefficients() {
    states::for_random_cases(940, STATE_COUNT, |random, case| {
        let RandomCase { kind, model, state, .. } = case;
        let w = random.signed_uniform(0.3, 3.0);
        let after = MaterialState { half_vorticity: state.half_vorticity + w, ..state };
        let (flow, flow_with_spin) =
            (states::complete_flow(&model, &state), states::complete_flow(&model, &after));
        if let (Some(before), Some(after)) = (flow.spin, flow_with_spin.spin) {
            assert!((after.value - before.value - w).abs() <= after.bound + before.bound);
        }
        assert_eq!(flow.relative_rotation, flow_with_spin.relative_rotation);
        assert_eq!(flow.internal_power, flow_with_spin.internal_power, "power is objective");
        let (before, after) = (
            states::assemble_symbol(&model, &flow),
            states::assemble_symbol(&model, &flow_with_spin),
        );
        assert_eq!(before.a, after.a);
        assert_eq!(before.b, after.b);
        let momentum = |i: usize| (i < 2).then_some(i);
        let spin_row = before.equations.iter().position(|name| *name == "spin");
        for i in 0..before.equations.len() {
            for j in 0..before.unknowns.len() {
                let change = match (momentum(i), j) {
                    (Some(0), 1) => -state.density * w,
                    (Some(1), 0) => state.density * w,
                    (None, 0 | 1) if Some(i) == spin_row => {
                        state.density * w * state.inertia_gradient[j]
                    }
                    _ => {
                        assert_eq!(before.c[(i, j)], after.c[(i, j)], "{kind:?} ({i}, {j})");
                        continue;
                    }
                };
                let (old, new) = (before.c[(i, j)], after.c[(i, j)]);
                let off = (new.value - old.value - change).abs();
                // The last term allows for the roundings of w and of s₂₁ + w.
                let bound = old.bound + new.bound + 4.0 * f64::EPSILON * change.abs();
                assert!(off <= bound, "{kind:?} ({i}, {j})");
            }
        }
    });
}

/// A Galilean shift changes only the velocity of the frame, `LinearisedSystem::velocity`; A, B and C are bitwise
/// unchanged.
#[test]
fn galilean_shift_changes_only_the_frame_velocity() {
    states::for_random_cases(960, STATE_COUNT, |random, case| {
        let RandomCase { model, state, .. } = case;
        let velocity = [random.signed_uniform(1.0, 1e6), random.signed_uniform(1.0, 1e6)];
        let after = MaterialState { velocity, ..state };
        let before = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let after = states::assemble_symbol(&model, &states::complete_flow(&model, &after));
        assert_eq!(before.velocity, state.velocity);
        assert_eq!(after.velocity, velocity);
        assert_eq!((&before.a, &before.b, &before.c), (&after.a, &after.b, &after.c));
    });
}

/// Under a change of units by powers of two every entry scales bitwise by the unit of its equation over the unit of its
/// unknown: there is no constant with a hidden unit and no absolute threshold.
#[test]
fn coefficients_scale_with_the_units() {
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(980 + seed as u64);
        for _ in 0..STATE_COUNT {
            let parameters = states::random_parameters(&mut random, kind, dilatancy);
            let state = states::random_state(&mut random, kind, dilatancy);
            let mut unit = || 2f64.powi(random.uniform_index(21) as i32 - 10);
            let (length, time, mass) = (unit(), unit(), unit());
            let stress = mass / length / time / time;
            let density = mass / length / length / length;
            let scale = |[x, y]: [f64; 2], unit: f64| [x * unit, y * unit];
            let other = FlowParameters {
                cohesion: parameters.cohesion * stress,
                moment_of_inertia: parameters.moment_of_inertia.map(|x| x * length * length),
                rotational_strength: parameters.rotational_strength.map(|x| x * stress),
                ..parameters
            };
            let after = MaterialState {
                density: state.density * density,
                pressure: state.pressure * stress,
                shear_rate: state.shear_rate / time,
                half_vorticity: state.half_vorticity / time,
                velocity: scale(state.velocity, length / time),
                pressure_gradient: scale(state.pressure_gradient, stress / length),
                stress_angle_gradient: scale(state.stress_angle_gradient, 1.0 / length),
                spin_gradient: scale(state.spin_gradient, 1.0 / time / length),
                density_gradient: scale(state.density_gradient, density / length),
                inertia_gradient: scale(state.inertia_gradient, length),
                inertia_rate: state.inertia_rate * length * length / time,
                spin_acceleration: state.spin_acceleration / time / time,
                ..state
            };
            let model = states::build_model(kind, &parameters);
            let flow = states::complete_flow(&model, &state);
            let before = states::assemble_symbol(&model, &flow);
            let model = states::build_model(kind, &other);
            let scaled = states::complete_flow(&model, &after);
            let after = states::assemble_symbol(&model, &scaled);
            assert_eq!(scaled.internal_power, flow.internal_power * stress / time);
            if let (Some(g), Some(scaled)) = (flow.body_moment, scaled.body_moment) {
                assert_eq!(scaled, g * length * length / time / time);
            }

            let row = |name: &str| match name {
                "momentum 1" | "momentum 2" => stress / length,
                "spin" => stress,
                "mass" => density / time,
                _ => 1.0 / time,
            };
            let column = |name: &str| match name {
                "velocity 1" | "velocity 2" => length / time,
                "spin" => 1.0 / time,
                "pressure" => stress,
                "density" => density,
                _ => 1.0,
            };
            let check = |own: Rounded, was: Rounded, factor: f64, matrix: &str| {
                assert_eq!(
                    (own.value, own.bound),
                    (was.value * factor, was.bound * factor),
                    "{matrix}"
                );
            };
            let names = |s: &LinearisedSystem<2>, i: usize, j: usize| {
                (row(s.equations[i]), column(s.unknowns[j].name))
            };
            for i in 0..before.equations.len() {
                for j in 0..before.unknowns.len() {
                    let (row, column) = names(&before, i, j);
                    check(after.a[(i, j)], before.a[(i, j)], row * time / column, "A");
                    for d in 0..2 {
                        let factor = row * length / column;
                        check(after.b[d][(i, j)], before.b[d][(i, j)], factor, "B");
                    }
                    check(after.c[(i, j)], before.c[(i, j)], row / column, "C");
                }
            }
        }
    }
}

/// Linearised equations written into a reused system equal those written into a new system, whatever model the reused
/// system held before.
#[test]
fn reused_system_equals_a_new_system() {
    let mut random = RandomNumbers::new(990);
    let mut reused = LinearisedSystem::default();
    for _ in 0..STATE_COUNT {
        // Models in random order, including different models of the same size.
        let (kind, dilatancy) = MODEL_CASES[random.uniform_index(MODEL_CASES.len())];
        let (_, model, state) = states::random_case(&mut random, kind, dilatancy);
        let flow = states::complete_flow(&model, &state);
        model.write_symbol(&flow, &mut reused);
        let fresh = states::assemble_symbol(&model, &flow);
        assert_eq!((&fresh.a, &fresh.b, &fresh.c), (&reused.a, &reused.b, &reused.c));
        assert_eq!(fresh.velocity, reused.velocity);
        assert_eq!((fresh.unknowns, fresh.equations), (reused.unknowns, reused.equations));
    }
}
