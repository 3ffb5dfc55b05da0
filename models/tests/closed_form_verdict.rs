//! Closed-form verdicts against the determinant of the linearised equations, expanded in 31 digits and scanned over the
//! directions of the wave vector.

mod support;

use std::f64::consts::{PI, TAU};
use support::states::{self, Dilatancy};
use support::{Polynomial, Random, Real, wide};
use testkit::flows::Parameters;
use wellposed_models::flow::state::{Flow, State};
use wellposed_models::flow::{FlowKind, Model};
use wellposed_models::registry;
use wellposed_models::{ClosedForm, LinearisedSystem};

/// Number of states of each test; [`DIRECTIONS`] is the number of directions scanned per state.
const STATES: usize = 100;
const DIRECTIONS: usize = 240;

/// Wave number, 1/m, at which terms of lower order in k are of relative size 1e-10 or less.
const SHORT: f64 = 1e12;

/// Random parameters and state with all gradients and accelerations, but zero velocity, which would only shift ς by
/// −ik·V.
fn sample(random: &mut Random, kind: FlowKind, dilatancy: Dilatancy) -> (Parameters, State) {
    let parameters = states::random_parameters(random, kind, dilatancy);
    let state = states::random_state(random, kind, dilatancy);
    (parameters, State { velocity: [0.0; 2], ..state })
}

/// Random parameters and state without gradients, accelerations and rotational stress.
fn uniform(random: &mut Random, kind: FlowKind, dilatancy: Dilatancy) -> (Parameters, State) {
    let (mut parameters, full) = sample(random, kind, dilatancy);
    parameters.rotational_strength = parameters.rotational_strength.map(|_| 0.0);
    let state = State {
        pressure_gradient: [0.0; 2],
        stress_angle_gradient: [0.0; 2],
        spin_gradient: [0.0; 2],
        density_gradient: [0.0; 2],
        inertia_gradient: [0.0; 2],
        inertia_rate: 0.0,
        ..full
    };
    (parameters, state)
}

/// Linearised equations, background flow and closed-form verdict of a state.
fn judged(
    kind: FlowKind,
    parameters: &Parameters,
    state: &State,
) -> (LinearisedSystem<2>, Flow, Option<ClosedForm>) {
    let model = states::model(kind, parameters);
    let flow = states::flow(&model, state);
    (states::symbol(&model, &flow), flow, model.closed_form(&flow))
}

/// Determinant as a polynomial in ς at k = [`SHORT`] for the wave vector at `angle` (rad).
fn dispersion(system: &LinearisedSystem<2>, angle: f64) -> Polynomial {
    let (s, c) = wide(angle).sin_cos();
    states::dispersion(system, [wide(SHORT) * c, wide(SHORT) * s])
}

/// Limit of ς/k² of the only root of order 2 in k, from the sum of all roots.
fn leading_of_order_2(system: &LinearisedSystem<2>, angle: f64) -> f64 {
    let polynomial = dispersion(system, angle);
    let [.., next, last] = polynomial[..] else { panic!("no roots") };
    let root = -(next / last);
    (root.re * wide(SHORT.powi(-2))).value()
}

/// Limit |ς|/k of two roots ±ck, positive if they are real and negative if imaginary, from the sum of the products of
/// all pairs of roots, −c²k².
fn leading_of_order_1(system: &LinearisedSystem<2>, angle: f64) -> f64 {
    let polynomial = dispersion(system, angle);
    let [.., second, _, last] = polynomial[..] else { panic!("one root") };
    let square = -(second / last).re.value() / SHORT.powi(2);
    square.abs().sqrt().copysign(square)
}

/// Checks the coefficient and direction of a closed form against the values `at` of all directions and their maximum.
fn check_growth(found: Option<ClosedForm>, wanted: u8, at: impl Fn(f64) -> f64) {
    let Some(ClosedForm::Grows { order, coefficient, direction }) = found else {
        panic!("grows with order {wanted}, yet {found:?}")
    };
    assert_eq!(order, wanted);
    assert!((0.0..PI).contains(&direction));
    assert!((at(direction) / coefficient - 1.0).abs() < 1e-9, "{} {coefficient}", at(direction));
    for n in 0..DIRECTIONS {
        assert!(at(PI * n as f64 / DIRECTIONS as f64) <= coefficient * (1.0 + 1e-9));
    }
}

/// Double shearing: order 1, coefficient and direction of the closed form agree with the determinant.
#[test]
fn double_shearing_grows_with_order_1() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        let mut random = Random::new(600);
        for _ in 0..STATES {
            let (parameters, state) = sample(&mut random, registry::DOUBLE_SHEARING, dilatancy);
            let (system, _, found) = judged(registry::DOUBLE_SHEARING, &parameters, &state);
            check_growth(found, 1, |angle| leading_of_order_1(&system, angle));
        }
    }
}

/// Plastic potential: order 2, coefficient and direction of the closed form agree with the determinant.
#[test]
fn plastic_potential_grows_with_order_2() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        let mut random = Random::new(610);
        for _ in 0..STATES {
            let (parameters, state) = sample(&mut random, registry::PLASTIC_POTENTIAL, dilatancy);
            let (system, _, found) = judged(registry::PLASTIC_POTENTIAL, &parameters, &state);
            if (parameters.friction_angle - parameters.dilatancy_angle).abs() > 0.05 {
                check_growth(found, 2, |angle| leading_of_order_2(&system, angle));
            }
        }
    }
}

/// Harris–Grekova, ν = 0: the closed form agrees with the leading root in all directions, for |Δ| below and above 45°.
#[test]
fn harris_grekova_without_dilatancy_turns_on_the_noncoaxiality() {
    let mut random = Random::new(620);
    let (mut well_posed, mut growing) = (0, 0);
    for _ in 0..2 * STATES {
        let (parameters, state) = sample(&mut random, registry::HARRIS_GREKOVA, Dilatancy::Zero);
        let (system, _, found) = judged(registry::HARRIS_GREKOVA, &parameters, &state);
        if found == Some(ClosedForm::WellPosed) {
            well_posed += 1;
            for n in 0..DIRECTIONS {
                assert!(leading_of_order_2(&system, PI * n as f64 / DIRECTIONS as f64) < 1e-9);
            }
        } else {
            growing += 1;
            check_growth(found, 2, |angle| leading_of_order_2(&system, angle));
        }
    }
    assert!(well_posed > STATES / 2 && growing > STATES / 2);
}

/// Harris–Grekova, ν > 0: the verdict agrees with the sign of the coefficient of the highest power of ς over all
/// directions, relative to the sign in a coaxial flow.
#[test]
fn harris_grekova_with_dilatancy_turns_on_the_highest_coefficient() {
    let mut random = Random::new(630);
    let (mut well_posed, mut unbounded) = (0, 0);
    for n in 0..2 * STATES {
        let (parameters, mut state) =
            uniform(&mut random, registry::HARRIS_GREKOVA, Dilatancy::Positive);
        if n % 4 == 0 {
            // For this Δ one of the two zeros is at 𝒜 = 0.
            let turn = if n % 8 == 0 { 0.5 } else { -0.5 } * parameters.dilatancy_angle;
            state.noncoaxiality = Some((0.25 * PI + turn) * if n % 16 < 8 { 1.0 } else { -1.0 });
        }
        let (system, flow, found) = judged(registry::HARRIS_GREKOVA, &parameters, &state);
        let coaxial = State { noncoaxiality: Some(0.0), ..state };
        let (coaxial, ..) = judged(registry::HARRIS_GREKOVA, &parameters, &coaxial);
        let highest = |system: &LinearisedSystem<2>, angle: f64| {
            dispersion(system, angle).last().expect("no determinant").re.value()
        };
        let sign = highest(&coaxial, 0.3).signum();
        let positive = (0..DIRECTIONS)
            .filter(|&n| sign * highest(&system, PI * n as f64 / DIRECTIONS as f64) > 0.0)
            .count();
        match found {
            Some(ClosedForm::WellPosed) => {
                well_posed += 1;
                assert_eq!(positive, DIRECTIONS);
            }
            Some(ClosedForm::UnboundedAtFiniteWaveNumber { direction }) => {
                unbounded += 1;
                let [left, right] =
                    [-1e-7, 1e-7].map(|turn| highest(&system, direction + turn).signum());
                assert!(left * right < 0.0, "no change of sign at {direction}");
                // The direction is away from 𝒜 = 0, where the numerator of ς vanishes too.
                let gap =
                    (2.0 * (flow.stress.angle - direction)).cos() - parameters.friction_angle.sin();
                assert!(gap.abs() > 1e-3);
            }
            // No verdict: either the coefficient is the root of a quartic, or |Δ| is too close to the bound.
            None => {
                let bound =
                    states::model(registry::HARRIS_GREKOVA, &parameters).noncoaxiality_bound();
                let bound = bound.expect("the model has one");
                let delta = flow.noncoaxiality.abs();
                assert!(positive == 0 || (delta - bound).abs() < 1e-4);
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(well_posed > STATES / 4 && unbounded > STATES / 4, "{well_posed}, {unbounded}");
}

/// The free-rotating model has one equation fewer than unknowns; with a prescribed spin it is determinate.
#[test]
fn free_rotating_lacks_one_equation() {
    for dilatancy in [Dilatancy::Zero, Dilatancy::Positive] {
        let mut random = Random::new(640);
        for _ in 0..STATES {
            let (parameters, state) = sample(&mut random, registry::FREE_ROTATING, dilatancy);
            let (system, _, found) = judged(registry::FREE_ROTATING, &parameters, &state);
            let (rows, columns) = system.a.shape();
            let wanted = ClosedForm::Indeterminate { rank: rows, unknowns: columns };
            assert_eq!(found, Some(wanted));
            assert_eq!(rows + 1, columns);
            let spin = system.unknowns.iter().position(|u| u.name == "spin").expect("a spin");
            let mut pencil = states::pencil(&system, [wide(0.7), wide(-1.1)]);
            pencil.iter_mut().for_each(|row| drop(row.remove(spin)));
            let determinant = support::determinant(&pencil);
            assert!(determinant.iter().any(|c| c.abs() > 1e-9));
        }
    }
}

/// A formula returns no verdict if rounding errors, the range of doubles or its assumptions make it uncertain.
#[test]
fn formulas_are_silent_where_there_is_doubt() {
    let mut random = Random::new(650);
    let silent = |kind, parameters: &Parameters, state: &State, why: &str| {
        let model: Model = states::model(kind, parameters);
        let found = model.closed_form(&states::flow(&model, state));
        assert_eq!(found, None, "{why}");
    };
    for _ in 0..STATES {
        let kind = registry::HARRIS_GREKOVA;
        let (parameters, state) = sample(&mut random, kind, Dilatancy::Zero);
        for distance in [0.0, 1e-15, -1e-12, 1e-9] {
            let noncoaxiality = Some(0.25 * PI + distance);
            silent(kind, &parameters, &State { noncoaxiality, ..state }, "beside 45°");
        }
        // Near the largest spin that the flow rule allows, Δ has only half of its digits.
        let greatest = state.shear_rate / parameters.friction_angle.sin() * (1.0 - 1e-15);
        let spin = Some(state.half_vorticity + greatest);
        let fast = State { spin, noncoaxiality: None, rotational_stress: None, ..state };
        silent(kind, &parameters, &fast, "the greatest spin");
        silent(kind, &parameters, &State { density: 1e40, ..state }, "out of range");

        let (parameters, state) = sample(&mut random, kind, Dilatancy::Positive);
        silent(kind, &parameters, &state, "dilatancy with gradients");
        let (mut parameters, state) = uniform(&mut random, kind, Dilatancy::Positive);
        parameters.rotational_strength = Some(10.0);
        silent(kind, &parameters, &state, "dilatancy with rotational stress");

        let kind = registry::PLASTIC_POTENTIAL;
        let (mut parameters, state) = sample(&mut random, kind, Dilatancy::Positive);
        parameters.dilatancy_angle = parameters.friction_angle + 1e-9;
        silent(kind, &parameters, &state, "nearly associated");

        let kind = registry::DOUBLE_SHEARING;
        let (mut parameters, state) = sample(&mut random, kind, Dilatancy::Zero);
        parameters.friction_angle = 0.25 * TAU - 1e-3;
        silent(kind, &parameters, &state, "φ near 90°");
    }
}
