//! Completion of a state to a background: yield regions, default values, derived quantities, rejected inputs; and the
//! index order of an asymmetric stress. Equation numbers refer to Harris & Grekova (2005).

use crate::support::states::{self, DilatancyKind, RandomCase};
use crate::support::{DifferentiableReal, RandomNumbers, dd};
use testkit::flows::{FlowParameters, MODEL_CASES};
use wellposed_models::InputError;
use wellposed_models::flow::state::{
    Background, MaterialState, MohrCoulomb, PlanarStress, YieldRegion,
};
use wellposed_models::flow::{FlowKind, Model};
use wellposed_models::registry;

const STATE_COUNT: usize = 250;

fn random_harris_grekova(
    random: &mut RandomNumbers,
    dilatancy: DilatancyKind,
) -> (FlowParameters, Model, MaterialState) {
    let (parameters, model, state) =
        states::random_case(random, registry::HARRIS_GREKOVA, dilatancy);
    (parameters, model, state)
}

fn find_region(model: &Model, state: &MaterialState) -> YieldRegion {
    model.background(state).expect("admissible").region()
}

fn rejection_error(model: &Model, state: &MaterialState) -> InputError {
    match model.background(state) {
        Err(error) => error,
        Ok(_) => panic!("accepted: {state:?}"),
    }
}

/// Parses the number that follows "residual" in an error message.
fn parse_residual(error: &InputError) -> f64 {
    let (_, rest) =
        error.allowed_values.split_once("residual ").expect("the message names a residual");
    let end = rest.find([';', ' ', ',', ')']).unwrap_or(rest.len());
    rest[..end].parse().expect("the residual is a number")
}

/// A deviatoric stress q within 1e-12 (relative) of yield counts as on yield and is replaced by the yield value; other
/// values of q are inside or outside yield. The yield deviator (eq. 13) is computed here with 31 digits.
#[test]
fn deviatoric_stress_determines_the_yield_region() {
    states::for_random_cases(600, STATE_COUNT, |_, case| {
        let RandomCase { parameters, model, state, .. } = case;
        let phi = dd(parameters.friction_angle);
        let q = (dd(state.pressure) * phi.sin() + dd(parameters.cohesion) * phi.cos()).to_f64();
        let with = |factor: f64| MaterialState { deviatoric_stress: Some(q * factor), ..state };
        assert_eq!(find_region(&model, &state), YieldRegion::FullyDeforming);
        for factor in [1.0, 1.0 + 9e-13, 1.0 - 9e-13] {
            assert_eq!(find_region(&model, &with(factor)), YieldRegion::FullyDeforming);
            // q is replaced by the yield deviator, so its relative deviation of up to 9e-13 from yield does not
            // enter the analysis.
            let (own, exact) = (
                states::complete_flow(&model, &with(factor)),
                states::complete_flow(&model, &state),
            );
            assert_eq!(own.stress.deviator, exact.stress.deviator);
        }
        for factor in [0.0, 0.5, 1.0 - 1.1e-12, 1.0 - 1e-9] {
            assert_eq!(find_region(&model, &with(factor)), YieldRegion::RigidOrIndeterminate);
        }
        for factor in [1.0 + 1.1e-12, 1.0 + 1e-9, 3.0] {
            assert_eq!(find_region(&model, &with(factor)), YieldRegion::OutsideYield);
        }
        // A state off yield has no flow, and its background contains the given deviatoric stress.
        let background = model.background(&with(0.5)).unwrap();
        assert!(background.flow().is_none());
        assert_eq!(background.stress().deviator.value, q * 0.5);
    });
}

/// A rotational stress r within 1e-12·m of 0 or ±m, with the rotational yield strength m, counts as equal to it;
/// otherwise |r| < m is indeterminate and |r| > m outside yield. A state is outside yield if either q or r is.
#[test]
fn rotational_stress_determines_the_yield_region() {
    let mut random = RandomNumbers::new(620);
    for _ in 0..STATE_COUNT {
        let (parameters, model, state) = random_harris_grekova(&mut random, DilatancyKind::Zero);
        let m = parameters.rotational_strength.unwrap();
        let with = |r: f64| MaterialState { rotational_stress: Some(r), ..state };
        for (given, taken) in
            [(0.0, 0.0), (m, m), (-m, -m), (m * (1.0 + 9e-13), m), (-m * (1.0 - 9e-13), -m)]
        {
            let flow = states::complete_flow(&model, &with(given));
            assert_eq!(flow.stress.rotational_stress, taken);
        }
        for factor in [0.5, -0.5, 1.0 - 1.1e-12, -1.0 + 1e-9, 1e-9] {
            assert_eq!(find_region(&model, &with(factor * m)), YieldRegion::RigidOrIndeterminate);
        }
        for factor in [1.0 + 1.1e-12, -1.0 - 1e-9, 2.0] {
            assert_eq!(find_region(&model, &with(factor * m)), YieldRegion::OutsideYield);
        }
        let q = model.coulomb().yield_deviator(state.pressure).value;
        let both = |q: f64, r: f64| MaterialState {
            deviatoric_stress: Some(q),
            rotational_stress: Some(r),
            ..state
        };
        assert_eq!(find_region(&model, &both(2.0 * q, 0.5 * m)), YieldRegion::OutsideYield);
        assert_eq!(find_region(&model, &both(0.5 * q, 2.0 * m)), YieldRegion::OutsideYield);
        assert_eq!(find_region(&model, &both(0.5 * q, m)), YieldRegion::RigidOrIndeterminate);
    }
    // Without rotational strength (m = 0) the only admissible value is r = 0.
    let (parameters, _, state) = random_harris_grekova(&mut random, DilatancyKind::Zero);
    let weak = FlowParameters { rotational_strength: Some(0.0), ..parameters };
    let model = states::build_model(registry::HARRIS_GREKOVA, &weak);
    assert_eq!(states::complete_flow(&model, &state).stress.rotational_stress, 0.0);
    assert_eq!(
        find_region(&model, &MaterialState { rotational_stress: Some(0.0), ..state }),
        YieldRegion::FullyDeforming
    );
    assert_eq!(
        find_region(&model, &MaterialState { rotational_stress: Some(1e-9), ..state }),
        YieldRegion::OutsideYield
    );
}

/// The default rotational stress is r = −m sign(ω − s₂₁), so that the rotational power −2r(ω − s₂₁) is not negative. In
/// a coaxial flow r is +0, not −0.
#[test]
fn default_rotational_stress_has_nonnegative_power() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(630);
        for _ in 0..STATE_COUNT {
            let (parameters, model, state) = random_harris_grekova(&mut random, dilatancy);
            let m = parameters.rotational_strength.unwrap();
            let flow = states::complete_flow(&model, &state);
            let relative = flow.spin.unwrap().value - state.half_vorticity;
            assert_eq!(flow.stress.rotational_stress, -m * relative.signum());
            // By the flow rule ω − s₂₁ and Δ have opposite signs.
            assert_eq!(flow.stress.rotational_stress.signum(), flow.noncoaxiality.signum());
            for delta in [Some(0.0), None] {
                let coaxial =
                    states::complete_flow(&model, &MaterialState { noncoaxiality: delta, ..state });
                assert_eq!(coaxial.stress.rotational_stress.to_bits(), 0.0f64.to_bits());
                assert_eq!(coaxial.spin.unwrap().value, state.half_vorticity);
            }
        }
    }
}

/// From a given spin the solution Δ of the flow rule with cos 2Δ > 0 is derived. If spin and Δ are both given, the
/// other solution is accepted too; a contradiction is rejected with the key and the residual in sin 2Δ.
#[test]
fn noncoaxiality_is_derived_from_a_given_spin() {
    for kind in [registry::HARRIS_GREKOVA, registry::FREE_ROTATING] {
        for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
            let mut random = RandomNumbers::new(640);
            for _ in 0..STATE_COUNT {
                let (parameters, model, state) = states::random_case(&mut random, kind, dilatancy);
                let delta = random.signed_uniform(0.01, 0.78);
                // Eq. (42) with Δ: ω − s₂₁ = −Q_D cos ν sin 2Δ / sin(φ − ν).
                let (phi, nu) = (parameters.friction_angle, parameters.dilatancy_angle);
                let turn = |delta: f64| {
                    -state.shear_rate * nu.cos() * (2.0 * delta).sin() / (phi - nu).sin()
                };
                let spin = state.half_vorticity + turn(delta);
                let only = MaterialState { noncoaxiality: None, spin: Some(spin), ..state };
                let flow = states::complete_flow(&model, &only);
                assert!((2.0 * flow.noncoaxiality).cos() > 0.0);
                // The arc sine loses half of the digits as Δ → 45°; the tolerance assumes cos 2Δ ≥ 0.01.
                let size = 1.0 + state.half_vorticity.abs() / turn(delta).abs();
                assert!((flow.noncoaxiality - delta).abs() < 1e-13 * size);
                let size = spin.abs() + 2.0 * state.half_vorticity.abs();
                assert!((flow.spin.unwrap().value - spin).abs() < 1e-14 * size);

                let other = std::f64::consts::FRAC_PI_2 - delta;
                for delta in [delta, other] {
                    let both = MaterialState { noncoaxiality: Some(delta), ..only };
                    let flow = states::complete_flow(&model, &both);
                    assert_eq!(flow.noncoaxiality, delta);
                }
                // Δ with a relative error of 1e-11 beside the exact spin is accepted.
                let printed = MaterialState { noncoaxiality: Some(delta * (1.0 + 1e-11)), ..only };
                assert_eq!(find_region(&model, &printed), YieldRegion::FullyDeforming);
                let wrong = delta + 1e-3 * (1.0 + random.uniform(0.0, 1.0));
                let error =
                    rejection_error(&model, &MaterialState { noncoaxiality: Some(wrong), ..only });
                assert_eq!(error.input, "spin");
                let expected = (2.0 * delta).sin() - (2.0 * wrong).sin();
                // Six digits are printed.
                assert!((parse_residual(&error).abs() / expected.abs() - 1.0).abs() < 1e-5);

                // A spin beyond its extreme value over all Δ, attained at Δ = 45°, is rejected.
                let too_much = MaterialState {
                    spin: Some(state.half_vorticity + 1.001 * turn(std::f64::consts::FRAC_PI_4)),
                    noncoaxiality: None,
                    ..state
                };
                assert_eq!(rejection_error(&model, &too_much).input, "spin");
            }
        }
    }
}

/// A redundant quantity of a state is accepted if it agrees with the derived value; if it differs by 1e-6 of its size,
/// it is rejected with its key and the residual of the violated equation.
#[test]
fn contradictory_inputs_are_rejected_with_their_residual() {
    states::for_random_cases(660, STATE_COUNT, |random, case| {
        let RandomCase { parameters, model, state, .. } = case;
        let flow = states::complete_flow(&model, &state);
        let gradient = flow.velocity_gradient.map(|row| row.map(|x| x.value));
        let acceleration = flow.acceleration.map(|x| x.value);
        let all = MaterialState {
            velocity_gradient: Some(gradient),
            acceleration: Some(acceleration),
            body_moment: flow.body_moment,
            stress_angle_rate: flow.stress_angle_rate,
            ..state
        };
        assert_eq!(states::complete_flow(&model, &all), flow);

        // Values with relative errors of 0.5e-10 to 1e-10 are accepted; the derived values are unchanged.
        let mut printed = |x: f64, size: f64| x + random.signed_uniform(0.5, 1.0) * 1e-10 * size;
        let rates = state.shear_rate + state.half_vorticity.abs();
        let force = acceleration[0].abs().max(acceleration[1].abs());
        let rounded = MaterialState {
            velocity_gradient: Some(gradient.map(|row| row.map(|x| printed(x, rates)))),
            acceleration: Some(acceleration.map(|x| printed(x, force))),
            body_moment: flow.body_moment.map(|x| printed(x, x.abs())),
            stress_angle_rate: flow.stress_angle_rate.map(|x| printed(x, x.abs())),
            ..state
        };
        assert_eq!(states::complete_flow(&model, &rounded), flow);

        let size = state.shear_rate + state.half_vorticity.abs();
        // Change one of tr d, d₁₁ − d₂₂, 2 d₁₂ and the vorticity at a time.
        for (change, part, factor) in [
            ([[1.0, 0.0], [0.0, 1.0]], "tr d", 2.0),
            ([[1.0, 0.0], [0.0, -1.0]], "d₁₁ − d₂₂", 2.0),
            ([[0.0, 1.0], [1.0, 0.0]], "2 d₁₂", 2.0),
            ([[0.0, -1.0], [1.0, 0.0]], "half_vorticity", 2.0),
        ] {
            let step = 1e-6 * size;
            let wrong =
                [0, 1].map(|i: usize| [0, 1].map(|j: usize| gradient[i][j] + step * change[i][j]));
            let error =
                rejection_error(&model, &MaterialState { velocity_gradient: Some(wrong), ..all });
            assert_eq!(error.input, "velocity_gradient");
            assert!(error.allowed_values.contains(part), "{}", error.allowed_values);
            assert!((parse_residual(&error) / (factor * step) - 1.0).abs() < 1e-5);
        }
        let size = acceleration[0].abs().max(acceleration[1].abs());
        for i in 0..2 {
            let mut wrong = acceleration;
            wrong[i] += 1e-6 * size;
            let error =
                rejection_error(&model, &MaterialState { acceleration: Some(wrong), ..all });
            assert_eq!(error.input, "acceleration");
            assert!(
                error.allowed_values.contains(["first", "second"][i]),
                "{}",
                error.allowed_values
            );
            assert!((parse_residual(&error) / (1e-6 * size) - 1.0).abs() < 1e-5);
        }
        if let Some(moment) = flow.body_moment {
            let size = (parameters.moment_of_inertia.unwrap() * state.spin_acceleration).abs()
                + (state.inertia_rate * flow.spin.unwrap().value).abs()
                + 2.0 * (flow.stress.rotational_stress / state.density).abs();
            let wrong = moment + 1e-6 * size;
            let error = rejection_error(&model, &MaterialState { body_moment: Some(wrong), ..all });
            assert_eq!(error.input, "body_moment");
            assert!((parse_residual(&error) / (1e-6 * size) - 1.0).abs() < 1e-5);
        }
        if let Some(rate) = flow.stress_angle_rate {
            let size = rate.abs() + 2.0 * state.half_vorticity.abs();
            let wrong = rate + 1e-6 * size;
            let error =
                rejection_error(&model, &MaterialState { stress_angle_rate: Some(wrong), ..all });
            assert_eq!(error.input, "stress_angle_rate");
            let expected = (1e-6 * size).to_degrees();
            assert!((parse_residual(&error) / expected - 1.0).abs() < 1e-3);
        } else {
            let given = MaterialState { stress_angle_rate: Some(0.1), ..all };
            assert_eq!(rejection_error(&model, &given).input, "stress_angle_rate");
        }
    });
}

/// Constants out of range and missing constants are rejected with their key; ν = 0, c = 0 and ν just below its limit
/// are accepted.
#[test]
fn constants_out_of_range_are_rejected_with_their_key() {
    let right = std::f64::consts::FRAC_PI_2;
    let good = FlowParameters {
        friction_angle: 0.6,
        dilatancy_angle: 0.2,
        cohesion: 120.0,
        moment_of_inertia: Some(0.05),
        rotational_strength: Some(30.0),
    };
    let nan_inf = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let refused =
        |kind: FlowKind, key: &str, change: &dyn Fn(&mut FlowParameters, f64), bad: &[f64]| {
            for &value in bad.iter().chain(&nan_inf) {
                let mut parameters = good;
                change(&mut parameters, value);
                let error = parameters.build_model(kind).expect_err("out of range");
                assert_eq!(error.input, key, "{kind:?} {value}");
            }
        };
    for kind in registry::STANDARD_FLOWS {
        assert!(good.build_model(kind).is_ok());
        refused(kind, "friction_angle", &|p, x| p.friction_angle = x, &[0.0, -0.1, right, 2.0]);
        refused(kind, "cohesion", &|p, x| p.cohesion = x, &[-1e-9]);
        let limit = if kind == registry::PLASTIC_POTENTIAL { right } else { good.friction_angle };
        refused(
            kind,
            "dilatancy_angle",
            &|p, x| p.dilatancy_angle = x,
            &[-1e-9, limit, limit + 0.1],
        );
        for nu in [0.0, limit * (1.0 - 1e-9)] {
            assert!((FlowParameters { dilatancy_angle: nu, ..good }).build_model(kind).is_ok());
        }
        assert!((FlowParameters { cohesion: 0.0, ..good }).build_model(kind).is_ok());
    }
    let kind = registry::HARRIS_GREKOVA;
    refused(kind, "moment_of_inertia", &|p, x| p.moment_of_inertia = Some(x), &[0.0, -1.0]);
    refused(kind, "rotational_strength", &|p, x| p.rotational_strength = Some(x), &[-1e-9]);
    for (key, missing) in [
        ("moment_of_inertia", FlowParameters { moment_of_inertia: None, ..good }),
        ("rotational_strength", FlowParameters { rotational_strength: None, ..good }),
    ] {
        assert_eq!(missing.build_model(kind).expect_err("missing").input, key);
    }
}

/// State quantities out of range, a nonzero Δ in the coaxial model and a density gradient for ν = 0 are rejected with
/// their key.
#[test]
fn states_out_of_range_are_rejected_with_their_key() {
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(680 + seed as u64);
        let (parameters, model, state) = states::random_case(&mut random, kind, dilatancy);
        let strength = -parameters.cohesion / parameters.friction_angle.tan();
        let nan_inf = [f64::NAN, f64::INFINITY];
        let refused = |key: &str, change: &dyn Fn(&mut MaterialState, f64), bad: &[f64]| {
            for &value in bad.iter().chain(&nan_inf) {
                let mut wrong = state;
                change(&mut wrong, value);
                assert_eq!(rejection_error(&model, &wrong).input, key, "{kind:?} {value}");
            }
        };
        refused("density", &|s, x| s.density = x, &[0.0, -1.0]);
        refused("shear_rate", &|s, x| s.shear_rate = x, &[0.0, -1.0]);
        refused("pressure", &|s, x| s.pressure = x, &[strength * (1.0 + 1e-9), 2.0 * strength]);
        refused("deviatoric_stress", &|s, x| s.deviatoric_stress = Some(x), &[-1e-9]);
        // A tension below c cot φ is admissible.
        let tension = MaterialState { pressure: 0.9 * strength, ..state };
        assert_eq!(find_region(&model, &tension), YieldRegion::FullyDeforming);

        if kind == registry::PLASTIC_POTENTIAL {
            let turned = MaterialState { noncoaxiality: Some(0.1), ..state };
            assert_eq!(rejection_error(&model, &turned).input, "noncoaxiality");
            let coaxial = MaterialState { noncoaxiality: Some(0.0), ..state };
            assert_eq!(find_region(&model, &coaxial), YieldRegion::FullyDeforming);
        }
        if dilatancy == DilatancyKind::Zero {
            let varying = MaterialState { density_gradient: [0.0, 1.0], ..state };
            assert_eq!(rejection_error(&model, &varying).input, "density_gradient");
        }
    }
}

/// States with |Δ| > 45°, negative internal power or either sign of r are accepted.
#[test]
fn noncoaxiality_beyond_45_degrees_is_accepted() {
    let mut random = RandomNumbers::new(700);
    let mut negative = 0;
    for _ in 0..STATE_COUNT {
        let (parameters, model, state) = random_harris_grekova(&mut random, DilatancyKind::Zero);
        let m = parameters.rotational_strength.unwrap();
        let delta = random.signed_uniform(0.9, 3.0);
        for r in [None, Some(m), Some(-m), Some(0.0)] {
            let state = MaterialState { noncoaxiality: Some(delta), rotational_stress: r, ..state };
            negative += usize::from(states::complete_flow(&model, &state).internal_power < 0.0);
        }
    }
    assert!(negative > 200);
}

/// The internal power equals the full contraction σᵢⱼ(∂ⱼvᵢ + εᵢⱼₖωₖ) with second index = face normal, in 2 dimensions
/// σᵢⱼ∂ⱼvᵢ + (σ₁₂ − σ₂₁) ω, for |Δ| below and above 45° (negative power). A transposed stress would change the sign of
/// the rotational power.
///
/// Tolerance: 1e-14 of the sum of the magnitudes of all terms.
#[test]
fn internal_power_is_the_contraction_of_stress_and_strain_rate() {
    let (mut negative, mut worst) = (0, 0.0f64);
    for (seed, (kind, dilatancy)) in MODEL_CASES.into_iter().enumerate() {
        let mut random = RandomNumbers::new(720 + seed as u64);
        for number in 0..STATE_COUNT {
            let (parameters, model, mut state) = states::random_case(&mut random, kind, dilatancy);
            if let Some(m) = parameters.rotational_strength {
                state.rotational_stress = [None, Some(m), Some(-m), Some(0.0)][number % 4];
            }
            let flow = states::complete_flow(&model, &state);
            let stress = flow.stress.to_tensor();
            // Spin conjugate to the antisymmetric stress; arbitrary if the stress is symmetric.
            let spin = flow.spin.map_or(0.7, |x| x.value);
            let levi_civita = [[0.0, 1.0], [-1.0, 0.0]];
            let (mut power, mut size) = (0.0, 0.0f64);
            for i in 0..2 {
                for j in 0..2 {
                    let strain = flow.velocity_gradient[i][j].value + levi_civita[i][j] * spin;
                    power += stress[i][j] * strain;
                    let terms = flow.velocity_gradient[i][j].value.abs() + spin.abs();
                    size += stress[i][j].abs() * terms;
                }
            }
            negative += usize::from(power < 0.0);
            worst = worst.max((flow.internal_power - power).abs() / size);
            assert!(
                (flow.internal_power - power).abs() <= 1e-14 * size,
                "{kind:?} {dilatancy:?}: {} against {power}",
                flow.internal_power
            );
        }
    }
    assert!(negative > 200);
    println!("power: {worst:.1e}");
}

/// The stress tensor gives the tractions t = σn, second index = face normal. The torque of the tractions on a small
/// square about its centre is 2r per area, the source of spin in eq. (9); in the index order of the paper, whose
/// first index is the face normal, it would be −2r. The greater principal value of the symmetric part is −p + q, at the
/// angle ψ from x₁.
#[test]
fn second_index_of_the_stress_tensor_is_the_face_normal() {
    let mut random = RandomNumbers::new(740);
    for _ in 0..STATE_COUNT {
        let coulomb =
            MohrCoulomb::new(random.uniform(0.1, 1.3), random.uniform(1.0, 100.0)).unwrap();
        let pressure = random.uniform(10.0, 900.0);
        let stress = PlanarStress {
            pressure,
            deviator: coulomb.yield_deviator(pressure),
            rotational_stress: random.signed_uniform(1.0, 50.0),
            angle: random.signed_uniform(0.1, 3.0),
        };
        let tensor = stress.to_tensor();
        let size = pressure + stress.deviator.value + stress.rotational_stress.abs();
        let side = 0.01;
        let mut torque = 0.0;
        for normal in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
            let centre = normal.map(|n| 0.5 * side * n);
            let traction =
                [0, 1].map(|i: usize| tensor[i][0] * normal[0] + tensor[i][1] * normal[1]);
            torque += side * (centre[0] * traction[1] - centre[1] * traction[0]);
        }
        let expected = 2.0 * stress.rotational_stress;
        assert!((torque / (side * side) - expected).abs() < 1e-14 * size);

        let shear = 0.5 * (tensor[0][1] + tensor[1][0]);
        let symmetric = [[tensor[0][0], shear], [shear, tensor[1][1]]];
        let along = [stress.angle.cos(), stress.angle.sin()];
        for i in 0..2 {
            let image = symmetric[i][0] * along[0] + symmetric[i][1] * along[1];
            let value = -pressure + stress.deviator.value;
            assert!((image - value * along[i]).abs() < 1e-14 * size);
        }
        // Definition (4) of the rotational stress r, with the stress tensor transposed to the index order of the paper.
        let paper = [[tensor[0][0], tensor[1][0]], [tensor[0][1], tensor[1][1]]];
        assert!(
            (0.5 * (paper[0][1] - paper[1][0]) - stress.rotational_stress).abs() < 1e-14 * size
        );
    }
}

/// The derived body moment G satisfies the balance of spin, eq. (9): I Dω/Dt + ω DI/Dt = (torque per area)/ρ + G.
#[test]
fn body_moment_satisfies_the_balance_of_spin() {
    let mut random = RandomNumbers::new(750);
    for _ in 0..STATE_COUNT {
        let (parameters, model, state) =
            random_harris_grekova(&mut random, DilatancyKind::Positive);
        let flow = states::complete_flow(&model, &state);
        let tensor = flow.stress.to_tensor();
        let gain = parameters.moment_of_inertia.unwrap() * state.spin_acceleration
            + state.inertia_rate * flow.spin.unwrap().value;
        let torque = tensor[1][0] - tensor[0][1];
        let moment = flow.body_moment.unwrap();
        let size = gain.abs() + moment.abs() + state.pressure / state.density;
        assert!((gain - torque / state.density - moment).abs() < 1e-13 * size);
    }
}

/// A background that is not fully deforming has a region and a stress but no flow.
#[test]
fn background_off_yield_has_stress_but_no_flow() {
    let mut random = RandomNumbers::new(760);
    let (_, model, state) = random_harris_grekova(&mut random, DilatancyKind::Zero);
    let state = MaterialState { deviatoric_stress: Some(1e9), ..state };
    let background = model.background(&state).unwrap();
    assert!(matches!(
        background,
        Background::NotDeforming { region: YieldRegion::OutsideYield, .. }
    ));
    assert!(background.flow().is_none());
    assert_eq!(background.stress().deviator.value, 1e9);
}

/// The registry finds every model by its name; an error message has the form "input: found value; allowed values".
#[test]
fn models_are_found_by_name_and_errors_name_the_input() {
    for kind in registry::STANDARD_FLOWS {
        assert_eq!(registry::find_flow(kind.name()), Some(kind));
        let mut random = RandomNumbers::new(770);
        let parameters = states::random_parameters(&mut random, kind, DilatancyKind::Positive);
        let model = states::build_model(kind, &parameters);
        assert_eq!(model.kind(), kind);
        assert!(model.is_dilatant());
        assert_eq!(model.noncoaxiality_bound().is_some(), kind == registry::HARRIS_GREKOVA);
        let error =
            (FlowParameters { cohesion: -2.5, ..parameters }).build_model(kind).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with("cohesion: found -2.5; "), "{text}");
        assert!(text.ends_with(&error.allowed_values));
    }
    assert_eq!(registry::find_flow("harris_grekova"), None);
}
