//! Closed-form verdicts against the determinant of the linearised equations, expanded in 31 digits and scanned over the
//! directions of the wave vector.

use crate::support::states::{self, DilatancyKind};
use crate::support::{DifferentiableReal, Polynomial, RandomNumbers, dd};
use std::f64::consts::{PI, TAU};
use testkit::flows::FlowParameters;
use wellposed_models::flow::state::{DeformingFlow, MaterialState};
use wellposed_models::flow::{FlowKind, Model};
use wellposed_models::registry;
use wellposed_models::{ClosedFormVerdict, LinearisedSystem};

/// Number of random states per case of a test; the Harris–Grekova tests use twice as many.
const STATE_COUNT: usize = 100;
/// Number of directions of the wave vector scanned per state.
const DIRECTION_COUNT: usize = 240;

/// Wave number, 1/m, at which terms of lower order in k are of relative size 1e-10 or less.
const SHORT_WAVE_NUMBER: f64 = 1e12;

/// Random parameters and state with all gradients and accelerations, but zero velocity, which would only shift ς by
/// −ik·V.
fn random_state_at_rest(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> (FlowParameters, MaterialState) {
    let parameters = states::random_parameters(random, kind, dilatancy);
    let state = states::random_state(random, kind, dilatancy);
    (parameters, MaterialState { velocity: [0.0; 2], ..state })
}

/// Random parameters and state at rest without gradients (other than the velocity gradient) and rotational stress, so
/// that DV/Dt = F.
fn random_uniform_state(
    random: &mut RandomNumbers,
    kind: FlowKind,
    dilatancy: DilatancyKind,
) -> (FlowParameters, MaterialState) {
    let (mut parameters, state) = random_state_at_rest(random, kind, dilatancy);
    parameters.rotational_strength = parameters.rotational_strength.map(|_| 0.0);
    (parameters, states::without_gradients(state))
}

/// Linearised equations, background flow and closed-form verdict of a state.
fn assess_state(
    kind: FlowKind,
    parameters: &FlowParameters,
    state: &MaterialState,
) -> (LinearisedSystem<2>, DeformingFlow, Option<ClosedFormVerdict>) {
    let model = states::build_model(kind, parameters);
    let flow = states::complete_flow(&model, state);
    (states::assemble_symbol(&model, &flow), flow, model.closed_form_verdict(&flow))
}

/// Determinant as a polynomial in ς at k = [`SHORT_WAVE_NUMBER`] for the wave vector at `angle` (rad).
fn dispersion_polynomial(system: &LinearisedSystem<2>, angle: f64) -> Polynomial {
    let (s, c) = dd(angle).sin_cos();
    states::dispersion_polynomial(system, [dd(SHORT_WAVE_NUMBER) * c, dd(SHORT_WAVE_NUMBER) * s])
}

/// Limit of Re ς/k² of the only root ς of order 2 in k, from the sum of all roots.
fn growth_coefficient_of_order_2(system: &LinearisedSystem<2>, angle: f64) -> f64 {
    let polynomial = dispersion_polynomial(system, angle);
    let [.., next, last] = polynomial[..] else { panic!("no roots") };
    let root = -(next / last);
    (root.re * dd(SHORT_WAVE_NUMBER.powi(-2))).to_f64()
}

/// Limit of |ς|/k of the two roots ς = ±ck of order 1, positive if they are real and negative if imaginary, from the
/// sum of the products of all pairs of roots, −c²k².
fn growth_coefficient_of_order_1(system: &LinearisedSystem<2>, angle: f64) -> f64 {
    let polynomial = dispersion_polynomial(system, angle);
    let [.., second, _, last] = polynomial[..] else { panic!("one root") };
    let square = -(second / last).re.to_f64() / SHORT_WAVE_NUMBER.powi(2);
    square.abs().sqrt().copysign(square)
}

/// Checks that a closed form has the order `expected_order`, and that its coefficient equals `growth_coefficient`, a
/// function of the angle of the wave vector, in its direction and is the maximum over [`DIRECTION_COUNT`] directions.
fn check_growth(
    found: Option<ClosedFormVerdict>,
    expected_order: u8,
    growth_coefficient: impl Fn(f64) -> f64,
) {
    let Some(ClosedFormVerdict::PowerLawGrowth { order, coefficient, direction }) = found else {
        panic!("grows with order {expected_order}, yet {found:?}")
    };
    assert_eq!(order, expected_order);
    assert!((0.0..PI).contains(&direction));
    assert!(
        (growth_coefficient(direction) / coefficient - 1.0).abs() < 1e-9,
        "{} {coefficient}",
        growth_coefficient(direction)
    );
    for n in 0..DIRECTION_COUNT {
        assert!(
            growth_coefficient(PI * n as f64 / DIRECTION_COUNT as f64)
                <= coefficient * (1.0 + 1e-9)
        );
    }
}

/// Double shearing: the growth is of order 1, and coefficient and direction of the closed form agree with the
/// determinant.
#[test]
fn double_shearing_grows_with_order_1() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(600);
        for _ in 0..STATE_COUNT {
            let (parameters, state) =
                random_state_at_rest(&mut random, registry::DOUBLE_SHEARING, dilatancy);
            let (system, _, found) = assess_state(registry::DOUBLE_SHEARING, &parameters, &state);
            check_growth(found, 1, |angle| growth_coefficient_of_order_1(&system, angle));
        }
    }
}

/// Plastic potential: the growth is of order 2, and coefficient and direction of the closed form agree with the
/// determinant.
#[test]
fn plastic_potential_grows_with_order_2() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(610);
        for _ in 0..STATE_COUNT {
            let (parameters, state) =
                random_state_at_rest(&mut random, registry::PLASTIC_POTENTIAL, dilatancy);
            let (system, _, found) = assess_state(registry::PLASTIC_POTENTIAL, &parameters, &state);
            if (parameters.friction_angle - parameters.dilatancy_angle).abs() > 0.05 {
                check_growth(found, 2, |angle| growth_coefficient_of_order_2(&system, angle));
            }
        }
    }
}

/// Harris–Grekova, ν = 0: the closed form agrees with the leading root in all directions, for |Δ| below and above 45°.
#[test]
fn harris_grekova_verdict_without_dilatancy_depends_on_the_noncoaxiality() {
    let mut random = RandomNumbers::new(620);
    let (mut well_posed, mut growing) = (0, 0);
    for _ in 0..2 * STATE_COUNT {
        let (parameters, state) =
            random_state_at_rest(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Zero);
        let (system, _, found) = assess_state(registry::HARRIS_GREKOVA, &parameters, &state);
        if found == Some(ClosedFormVerdict::WellPosed) {
            well_posed += 1;
            for n in 0..DIRECTION_COUNT {
                assert!(
                    growth_coefficient_of_order_2(&system, PI * n as f64 / DIRECTION_COUNT as f64)
                        < 1e-9
                );
            }
        } else {
            growing += 1;
            check_growth(found, 2, |angle| growth_coefficient_of_order_2(&system, angle));
        }
    }
    assert!(well_posed > STATE_COUNT / 2 && growing > STATE_COUNT / 2);
}

/// Harris–Grekova, ν > 0: the verdict agrees with the sign of the coefficient of the highest power of ς over all
/// directions, relative to the sign in a coaxial flow.
#[test]
fn harris_grekova_verdict_with_dilatancy_follows_the_sign_of_the_highest_coefficient() {
    let mut random = RandomNumbers::new(630);
    let (mut well_posed, mut unbounded) = (0, 0);
    for n in 0..2 * STATE_COUNT {
        let (parameters, mut state) =
            random_uniform_state(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Positive);
        if n % 4 == 0 {
            // For this Δ one of the two zeros of the highest coefficient is at 𝒜 = cos β − sin φ = 0.
            let turn = if n % 8 == 0 { 0.5 } else { -0.5 } * parameters.dilatancy_angle;
            state.noncoaxiality = Some((0.25 * PI + turn) * if n % 16 < 8 { 1.0 } else { -1.0 });
        }
        let (system, flow, found) = assess_state(registry::HARRIS_GREKOVA, &parameters, &state);
        let coaxial = MaterialState { noncoaxiality: Some(0.0), ..state };
        let (coaxial, ..) = assess_state(registry::HARRIS_GREKOVA, &parameters, &coaxial);
        let highest = |system: &LinearisedSystem<2>, angle: f64| {
            dispersion_polynomial(system, angle).last().expect("no determinant").re.to_f64()
        };
        let sign = highest(&coaxial, 0.3).signum();
        let positive = (0..DIRECTION_COUNT)
            .filter(|&n| sign * highest(&system, PI * n as f64 / DIRECTION_COUNT as f64) > 0.0)
            .count();
        match found {
            Some(ClosedFormVerdict::WellPosed) => {
                well_posed += 1;
                assert_eq!(positive, DIRECTION_COUNT);
            }
            Some(ClosedFormVerdict::UnboundedAtFiniteWaveNumber { direction }) => {
                unbounded += 1;
                let [left, right] =
                    [-1e-7, 1e-7].map(|turn| highest(&system, direction + turn).signum());
                assert!(left * right < 0.0, "no change of sign at {direction}");
                // The direction is away from 𝒜 = cos β − sin φ = 0, where the numerator of ς vanishes too.
                let gap =
                    (2.0 * (flow.stress.angle - direction)).cos() - parameters.friction_angle.sin();
                assert!(gap.abs() > 1e-3);
            }
            // No verdict: either the largest growth coefficient is the root of a quartic, since the highest coefficient
            // has the opposite sign in all directions, or |Δ| is too close to the bound.
            None => {
                let bound = states::build_model(registry::HARRIS_GREKOVA, &parameters)
                    .noncoaxiality_bound();
                let bound = bound.expect("the model has one");
                let delta = flow.noncoaxiality.abs();
                assert!(positive == 0 || (delta - bound).abs() < 1e-4);
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(
        well_posed > STATE_COUNT / 4 && unbounded > STATE_COUNT / 4,
        "{well_posed}, {unbounded}"
    );
}

/// The free-rotating model has one equation fewer than unknowns; with a prescribed spin it is determinate.
#[test]
fn free_rotating_verdict_is_indeterminate() {
    for dilatancy in [DilatancyKind::Zero, DilatancyKind::Positive] {
        let mut random = RandomNumbers::new(640);
        for _ in 0..STATE_COUNT {
            let (parameters, state) =
                random_state_at_rest(&mut random, registry::FREE_ROTATING, dilatancy);
            let (system, _, found) = assess_state(registry::FREE_ROTATING, &parameters, &state);
            let (rows, columns) = system.a.shape();
            let expected_order = ClosedFormVerdict::Indeterminate { rank: rows, unknowns: columns };
            assert_eq!(found, Some(expected_order));
            assert_eq!(rows + 1, columns);
            let spin = system.unknowns.iter().position(|u| u.name == "spin").expect("a spin");
            let mut pencil = states::assemble_pencil(&system, [dd(0.7), dd(-1.1)]);
            pencil.iter_mut().for_each(|row| drop(row.remove(spin)));
            let determinant = crate::support::polynomial_determinant(&pencil);
            assert!(determinant.iter().any(|c| c.abs() > 1e-9));
        }
    }
}

/// A formula returns no verdict if rounding errors, the range of doubles or its assumptions make it uncertain.
#[test]
fn uncertain_cases_have_no_closed_form_verdict() {
    let mut random = RandomNumbers::new(650);
    let assert_no_verdict =
        |kind, parameters: &FlowParameters, state: &MaterialState, reason: &str| {
            let model: Model = states::build_model(kind, parameters);
            let found = model.closed_form_verdict(&states::complete_flow(&model, state));
            assert_eq!(found, None, "{reason}");
        };
    for _ in 0..STATE_COUNT {
        let kind = registry::HARRIS_GREKOVA;
        let (parameters, state) = random_state_at_rest(&mut random, kind, DilatancyKind::Zero);
        for distance in [0.0, 1e-15, -1e-12, 1e-9] {
            let noncoaxiality = Some(0.25 * PI + distance);
            assert_no_verdict(
                kind,
                &parameters,
                &MaterialState { noncoaxiality, ..state },
                "beside 45°",
            );
        }
        // Near the largest spin that the flow rule allows, Δ has only half of its digits.
        let greatest = state.shear_rate / parameters.friction_angle.sin() * (1.0 - 1e-15);
        let spin = Some(state.half_vorticity + greatest);
        let fast = MaterialState { spin, noncoaxiality: None, rotational_stress: None, ..state };
        assert_no_verdict(kind, &parameters, &fast, "the greatest spin");
        assert_no_verdict(
            kind,
            &parameters,
            &MaterialState { density: 1e40, ..state },
            "out of range",
        );

        let (parameters, state) = random_state_at_rest(&mut random, kind, DilatancyKind::Positive);
        assert_no_verdict(kind, &parameters, &state, "dilatancy with gradients");
        let (mut parameters, state) =
            random_uniform_state(&mut random, kind, DilatancyKind::Positive);
        parameters.rotational_strength = Some(10.0);
        assert_no_verdict(kind, &parameters, &state, "dilatancy with rotational stress");

        let kind = registry::PLASTIC_POTENTIAL;
        let (mut parameters, state) =
            random_state_at_rest(&mut random, kind, DilatancyKind::Positive);
        parameters.dilatancy_angle = parameters.friction_angle + 1e-9;
        assert_no_verdict(kind, &parameters, &state, "nearly associated");

        let kind = registry::DOUBLE_SHEARING;
        let (mut parameters, state) = random_state_at_rest(&mut random, kind, DilatancyKind::Zero);
        parameters.friction_angle = 0.25 * TAU - 1e-3;
        assert_no_verdict(kind, &parameters, &state, "φ near 90°");
    }
}
