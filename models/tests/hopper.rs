//! Section 8 of Harris & Grekova (2005): slip lines, and the exact solutions with zero spin, radial flow in a hopper and
//! simple shear.

use crate::support::states::{self, DilatancyKind};
use std::f64::consts::{FRAC_PI_4, PI};
use testkit::flows::{FlowParameters, MODEL_CASES};
use testkit::random::RandomNumbers;
use wellposed_models::flow::hopper::{RadialFields, RadialFlow, RadialScales};
use wellposed_models::flow::state::{DeformingFlow, MaterialState};
use wellposed_models::registry;

/// Friction angle φ, wall angle θ_w and wall friction angle δ_w, degrees. In the fourth the equations are nearly
/// singular at the wall; in the fifth the friction is largest between axis and wall.
const HOPPERS: [[f64; 3]; 6] = [
    [30.0, 20.0, 15.0],
    [30.0, 15.0, 0.0],
    [40.0, 30.0, 20.0],
    [25.0, 10.0, 24.9],
    [45.0, 45.0, 20.0],
    [15.0, 10.0, 12.0],
];

fn solve([friction, wall, wall_friction]: [f64; 3]) -> RadialFlow {
    RadialFlow::new(friction.to_radians(), wall.to_radians(), wall_friction.to_radians())
        .expect("a hopper with radial flow")
}

fn fields(flow: &RadialFlow, angle: f64) -> RadialFields {
    flow.fields_at(angle).expect("regular up to the wall")
}

fn complete(friction_angle: f64, state: &MaterialState) -> DeformingFlow {
    let parameters = FlowParameters {
        friction_angle,
        dilatancy_angle: 0.0,
        cohesion: 0.0,
        moment_of_inertia: Some(1.25e-7),
        rotational_strength: Some(0.0),
    };
    let model = parameters.build_model(registry::HARRIS_GREKOVA).expect("constants in range");
    *model.background(state).expect("admissible").flow().expect("fully deforming")
}

/// Values χ, γ, f/f(0) and their derivatives.
fn values(fields: &RadialFields) -> [[f64; 2]; 3] {
    [fields.pressure, fields.stress_angle, fields.speed]
}

/// The derivatives that the solution states are those of its values, by differences of eighth order over the angle; with
/// the balance of momentum and the flow rule below this is the whole solution.
#[test]
fn derivatives_are_those_of_the_fields() {
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    for hopper in HOPPERS {
        let flow = solve(hopper);
        // Differences lose their order near the singular wall of the fourth hopper.
        for part in [-0.8, -0.3, 0.0, 0.1, 0.45, 0.7] {
            let angle = part * flow.wall_angle();
            let step = 0.01 * flow.wall_angle();
            let at = |count: f64| values(&fields(&flow, angle + count * step));
            let exact = at(0.0);
            let mut found = [0.0; 3];
            for (index, weight) in WEIGHTS.iter().enumerate() {
                let [ahead, behind] = [at(index as f64 + 1.0), at(-(index as f64) - 1.0)];
                for (i, sum) in found.iter_mut().enumerate() {
                    *sum += weight * (ahead[i][0] - behind[i][0]) / step;
                }
            }
            for (i, found) in found.into_iter().enumerate() {
                let size = exact[i][0].abs().max(exact[i][1].abs()).max(1.0);
                let error = (found - exact[i][1]).abs() / size;
                assert!(error < 1e-9, "{hopper:?} at {part}, field {i}: {error:e}");
            }
        }
    }
}

/// The fields agree with those of the classical Runge–Kutta method on the equations as written, solved for the
/// derivatives by Cramer's rule; the traction of the wall has the angle δ_w.
#[test]
fn fields_agree_with_another_method_and_meet_the_wall_condition() {
    const STEPS: usize = 4000;
    for hopper in HOPPERS {
        let flow = solve(hopper);
        let s = hopper[0].to_radians().sin();
        let rates = |at: f64, [chi, gamma, f]: [f64; 3]| {
            let (sin, cos) = (2.0 * gamma).sin_cos();
            let first = [s * sin, 2.0 * chi * s * cos, at.cos() + chi * (1.0 - 3.0 * s * cos)];
            let second = [-(1.0 + s * cos), 2.0 * chi * s * sin, -3.0 * chi * s * sin - at.sin()];
            let determinant = |i: usize, j: usize| first[i] * second[j] - first[j] * second[i];
            [
                determinant(2, 1) / determinant(0, 1),
                determinant(0, 2) / determinant(0, 1),
                -2.0 * f * sin / (cos + s),
            ]
        };
        let add = |one: [f64; 3], factor: f64, other: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| one[i] + factor * other[i])
        };
        let end = 0.9 * flow.wall_angle();
        let step = end / STEPS as f64;
        let mut own = [fields(&flow, 0.0).pressure[0], 0.0, 1.0];
        for index in 0..STEPS {
            let at = index as f64 * step;
            let k1 = rates(at, own);
            let k2 = rates(at + 0.5 * step, add(own, 0.5 * step, k1));
            let k3 = rates(at + 0.5 * step, add(own, 0.5 * step, k2));
            let k4 = rates(at + step, add(own, step, k3));
            let sum = add(add(k1, 2.0, k2), 1.0, add(k4, 2.0, k3));
            own = add(own, step / 6.0, sum);
        }
        for (i, [found, _]) in values(&fields(&flow, end)).into_iter().enumerate() {
            let error = (found - own[i]).abs() / own[i].abs().max(1.0);
            assert!(error < 2e-13, "{hopper:?}, field {i}: {error:e}");
        }
        let (sin, cos) = (2.0 * fields(&flow, flow.wall_angle()).stress_angle[0]).sin_cos();
        let residual = s * sin - hopper[2].to_radians().tan() * (1.0 + s * cos);
        assert!(residual.abs() < 1e-12, "{hopper:?}: {residual:e}");
    }
}

/// As a background of the Harris–Grekova model the flow has spin 0, and its acceleration less the body force is (g, 0): it
/// needs no body force but gravity along −x₁, with inertia neglected. The model gets pressure, stress angle, their
/// gradients, shear rate, vorticity and non-coaxiality, which do not contain these equations.
#[test]
fn radial_flow_has_zero_spin_and_carries_its_weight() {
    const POINT_COUNT: usize = 100;
    let mut random = RandomNumbers::new(41);
    for hopper in HOPPERS {
        let flow = solve(hopper);
        for _ in 0..POINT_COUNT {
            let scales = RadialScales {
                density: random.uniform(500.0, 3000.0),
                gravity: random.uniform(1.0, 20.0),
                radius: random.uniform(0.05, 5.0),
                axis_flow: random.uniform(0.01, 2.0),
            };
            let angle = random.uniform(-1.0, 1.0) * flow.wall_angle();
            let state = fields(&flow, angle).to_state(&scales);
            let found = complete(hopper[0].to_radians(), &state);
            let spin = found.spin.expect("a spin").value;
            assert!(spin.abs() <= 1e-12 * state.shear_rate, "{hopper:?} at {angle}: spin {spin:e}");
            let [first, second] = found.acceleration.map(|a| a.value / scales.gravity);
            // At the singular wall the gradients that cancel each other are large.
            let size =
                1.0f64.max(state.pressure_gradient[1].abs() / (scales.density * scales.gravity));
            assert!((first - 1.0).abs() <= 1e-12 * size, "{hopper:?} at {angle}: {first:e}");
            assert!(second.abs() <= 1e-12 * size, "{hopper:?} at {angle}: {second:e}");
            assert_eq!(found.body_moment, Some(0.0));
        }
    }
}

/// The angle of the friction that the traction on a ray mobilises is −2Δ: at the wall Δ = −δ_w/2, and |Δ| ≤ φ/2 < 45°
/// everywhere, so that radial flow is well-posed at every point.
#[test]
fn twice_the_noncoaxiality_is_the_mobilised_friction() {
    for hopper in HOPPERS {
        let flow = solve(hopper);
        let phi = hopper[0].to_radians();
        for index in 0..=100 {
            let found = fields(&flow, f64::from(index) / 100.0 * flow.wall_angle());
            let (sin, cos) = (2.0 * found.stress_angle[0]).sin_cos();
            let mobilised = (phi.sin() * sin).atan2(1.0 + phi.sin() * cos);
            let delta = found.noncoaxiality();
            assert!((delta + 0.5 * mobilised).abs() < 1e-13, "{hopper:?}: {delta} {mobilised}");
            assert!(delta.abs() <= 0.5 * phi);
        }
        let wall = fields(&flow, flow.wall_angle()).noncoaxiality();
        assert!((wall + 0.5 * hopper[2].to_radians()).abs() < 1e-12, "{hopper:?}: {wall}");
    }
}

/// A wide hopper with smooth walls has no radial flow of a material with little friction; wrong angles are refused.
#[test]
fn hoppers_without_radial_flow_are_refused() {
    let refuse = |angles: [f64; 3]| {
        let [friction, wall, wall_friction] = angles.map(f64::to_radians);
        RadialFlow::new(friction, wall, wall_friction).expect_err("no radial flow")
    };
    for (angles, input) in [
        ([15.0, 45.0, 5.0], "wall_friction_angle"),
        ([30.0, 20.0, 30.0], "wall_friction_angle"),
        ([30.0, 20.0, -1.0], "wall_friction_angle"),
        ([30.0, 90.0, 10.0], "wall_angle"),
        ([30.0, f64::NAN, 10.0], "wall_angle"),
        ([90.0, 20.0, 10.0], "friction_angle"),
    ] {
        assert_eq!(refuse(angles).input, input, "{angles:?}");
    }
    let error = refuse([15.0, 45.0, 5.0]).to_string();
    let expected = "found 5; there is no radial flow in a hopper with walls at 45° from the axis";
    assert!(error.contains(expected), "{error}");
}

/// Random state without special values of every model that has slip lines: the velocity gradient is the rotation of the
/// material plus two dilatant slips, k (cos ν t + sin ν n) ⊗ n, with the unit vector t along the slip line and the normal n
/// on the side of the greater principal stress for the first, opposite for the second family.
#[test]
fn velocity_gradient_is_rotation_and_two_slips() {
    for (kind, dilatancy) in MODEL_CASES {
        let mut random = RandomNumbers::new(43);
        for _ in 0..200 {
            let (parameters, model, state) = states::random_case(&mut random, kind, dilatancy);
            let flow = states::complete_flow(&model, &state);
            let Some(slips) = model.slips(&flow) else {
                assert!(kind.is_coaxial());
                continue;
            };
            let rotation = flow.relative_rotation.value + flow.half_vorticity;
            let mut gradient = [[0.0, -rotation], [rotation, 0.0]];
            for (slip, sense) in slips.into_iter().zip([1.0, -1.0]) {
                let (sin, cos) = slip.angle.sin_cos();
                let (tangent, normal) = ([cos, sin], [-sense * sin, sense * cos]);
                let (sin_nu, cos_nu) = parameters.dilatancy_angle.sin_cos();
                for (i, row) in gradient.iter_mut().enumerate() {
                    for (j, entry) in row.iter_mut().enumerate() {
                        let direction = cos_nu * tangent[i] + sin_nu * normal[i];
                        *entry += slip.rate.value * direction * normal[j];
                    }
                }
            }
            // cos(φ − ν) is the smallest denominator.
            let size = (state.shear_rate + rotation.abs() + state.half_vorticity.abs())
                / (parameters.friction_angle - parameters.dilatancy_angle).cos();
            for (found, expected) in gradient.iter().zip(flow.velocity_gradient) {
                for (found, expected) in found.iter().zip(expected) {
                    let error = (found - expected.value).abs();
                    assert!(error <= 1e-13 * size, "{}: {error:e}", kind.name());
                }
            }
        }
    }
}

/// A slip is reversed exactly if |Δ| exceeds (φ − ν)/2; with zero spin, simple shear is slip on one family.
#[test]
fn slip_is_reversed_beyond_half_the_difference_of_the_angles() {
    let mut random = RandomNumbers::new(44);
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        for _ in 0..500 {
            let (parameters, model, state) =
                states::random_case(&mut random, registry::HARRIS_GREKOVA, dilatancy);
            let flow = states::complete_flow(&model, &state);
            let [first, second] =
                model.slips(&flow).expect("slip lines").map(|slip| slip.rate.value);
            let limit = 0.5 * (parameters.friction_angle - parameters.dilatancy_angle);
            assert_eq!(first.min(second) < 0.0, flow.noncoaxiality.abs() > limit);
        }
    }
}

/// A line of which the velocity jumps by w along its tangent is one of both slip lines: on it the flow rule holds for the
/// singular deformation rate ½w(t ⊗ n + n ⊗ t) with the spin, which is no singular quantity, left out.
#[test]
fn tangential_jumps_lie_on_slip_lines_only() {
    let mut random = RandomNumbers::new(45);
    for _ in 0..100 {
        let (_, model, state) =
            states::random_case(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Zero);
        let flow = states::complete_flow(&model, &state);
        let rule = model.flow_rule();
        let (ratio, twice) = (rule.rotation_ratio(), 2.0 * flow.stress.angle);
        // −2 s₂₁ e_r − c_r [(d₁₁ − d₂₂) sin 2ψ − 2 d₁₂ cos 2ψ] over c_r, for w = 1 on a line at the angle a.
        let residual = |a: f64| {
            let [half_vorticity, difference, shear] = [-0.5, -(2.0 * a).sin(), (2.0 * a).cos()];
            -2.0 * half_vorticity * ratio - (difference * twice.sin() - shear * twice.cos())
        };
        let slips = model.slips(&flow).expect("slip lines");
        for slip in slips {
            assert!(residual(slip.angle).abs() < 1e-14);
        }
        // The residual sin φ + cos 2(a − ψ) has two zeros in a half-turn.
        let count = (0..10_000).filter(|&i| {
            let at = |i: i32| residual(f64::from(i) * PI / 10_000.0) > 0.0;
            at(i) != at(i + 1)
        });
        assert_eq!(count.count(), 2);
    }
}

/// Simple shear v = (γ̇x₂, 0) with zero spin: sin 2(ψ − 45°) = sin φ, so that Δ = −φ/2 and the shear plane x₁ is a slip
/// line, ψ = 45° + φ/2.
#[test]
fn simple_shear_without_spin_is_noncoaxial_by_half_the_friction_angle() {
    let mut random = RandomNumbers::new(42);
    for _ in 0..100 {
        let phi = random.uniform(0.05, 1.5);
        let rate = random.uniform(0.01, 100.0);
        let state = MaterialState {
            density: 1600.0,
            pressure: 1000.0,
            stress_angle: FRAC_PI_4 + 0.5 * phi,
            shear_rate: 0.5 * rate,
            half_vorticity: -0.5 * rate,
            spin: Some(0.0),
            ..MaterialState::default()
        };
        let flow = complete(phi, &state);
        assert!((flow.noncoaxiality + 0.5 * phi).abs() <= 1e-15 + flow.noncoaxiality_rounding);
        assert!((flow.stress.angle + flow.noncoaxiality - FRAC_PI_4).abs() < 1e-7);
        let gradient = flow.velocity_gradient.map(|row| row.map(|x| x.value));
        for (found, expected) in gradient.iter().flatten().zip([0.0, rate, 0.0, 0.0]) {
            assert!((found - expected).abs() <= 1e-14 * rate + rate * flow.noncoaxiality_rounding);
        }
    }
}
