//! Rounding bounds in ill-conditioned cases, and rejection of inputs that are not finite or not used by the model.

use crate::support::states::{self, DilatancyKind};
use crate::support::{DifferentiableReal, RIGHT_ANGLE, RandomNumbers, dd};
use wellposed_models::Rounded;
use wellposed_models::flow::state::MaterialState;
use wellposed_models::registry;

/// The rounding bound of the entry −4 Q_D cos 2Δ covers its error if Δ is derived from a given spin by an arc sine,
/// which amplifies the error of its argument by 1/cos 2Δ.
#[test]
fn rounding_bound_covers_the_noncoaxiality_from_a_given_spin() {
    let mut random = RandomNumbers::new(77);
    let (mut exceeded, mut worst) = (0, 0.0f64);
    for _ in 0..2000 {
        let (parameters, model, state) =
            states::random_case(&mut random, registry::HARRIS_GREKOVA, DilatancyKind::Zero);
        let delta = random.signed_uniform(0.0, 0.785);
        let relative_rotation =
            -state.shear_rate * (2.0 * delta).sin() / parameters.friction_angle.sin();
        let spin = state.half_vorticity + relative_rotation;
        let state = MaterialState { noncoaxiality: None, spin: Some(spin), ..state };
        let system = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let sine = (dd(state.half_vorticity) - dd(spin)) * dd(parameters.friction_angle).sin()
            / dd(state.shear_rate);
        let cosine = (dd(1.0) - sine * sine).sqrt();
        let truth = -(dd(4.0 * state.shear_rate) * cosine);
        let own = system.c[(4, 4)];
        let error = (dd(own.value) - truth).to_f64().abs() / own.bound;
        exceeded += usize::from(error > 1.0);
        worst = worst.max(error);
    }
    assert_eq!(exceeded, 0, "of 2000; the worst error is {worst:.0} bounds");
}

/// For a spin within two units in the last place of the largest admissible one the sign of cos 2Δ is uncertain.
#[test]
fn sign_is_uncertain_at_the_largest_admissible_spin() {
    let parameters = testkit::flows::FlowParameters {
        friction_angle: 0.5,
        dilatancy_angle: 0.0,
        cohesion: 0.0,
        moment_of_inertia: Some(0.1),
        rotational_strength: Some(5.0),
    };
    let model = states::build_model(registry::HARRIS_GREKOVA, &parameters);
    let max_spin = 1.0 / 0.5f64.sin();
    for ulps in 0..3 {
        let spin = f64::from_bits(max_spin.to_bits() - ulps);
        let state = MaterialState {
            density: 1000.0,
            pressure: 100.0,
            shear_rate: 1.0,
            spin: Some(spin),
            ..MaterialState::default()
        };
        let system = states::assemble_symbol(&model, &states::complete_flow(&model, &state));
        let own = system.c[(4, 4)];
        assert_eq!(own.sign(), None, "{ulps} units below the greatest spin: {own:?}");
    }
}

/// The bound of an angle converted from degrees covers the three roundings of the decimal, of π/180 and of the product.
#[test]
fn rounding_bound_covers_the_conversion_from_degrees() {
    let mut exceeded = 0;
    for n in 1..9000 {
        let exact = dd(f64::from(n)) / dd(100.0) * (RIGHT_ANGLE / dd(90.0));
        let own = Rounded::from_angle((f64::from(n) / 100.0).to_radians());
        exceeded += usize::from((dd(own.value) - exact).to_f64().abs() > own.bound);
    }
    assert_eq!(exceeded, 0, "of 8999 angles with two decimals");
}

/// NaN and infinity are rejected in every quantity of a state that may otherwise have any value; the optional
/// quantities spin, velocity gradient, acceleration and body moment are not tested.
#[test]
fn nonfinite_state_quantities_are_rejected() {
    let mut random = RandomNumbers::new(5);
    let (kind, dilatancy) = (registry::HARRIS_GREKOVA, DilatancyKind::Positive);
    let (_, model, state) = states::random_case(&mut random, kind, dilatancy);
    let mut accepted = vec![];
    for x in [f64::NAN, f64::INFINITY] {
        for (name, wrong) in [
            ("velocity", MaterialState { velocity: [x, 0.0], ..state }),
            ("stress_angle", MaterialState { stress_angle: x, ..state }),
            ("half_vorticity", MaterialState { half_vorticity: x, ..state }),
            ("noncoaxiality", MaterialState { noncoaxiality: Some(x), ..state }),
            ("rotational_stress", MaterialState { rotational_stress: Some(x), ..state }),
            ("pressure_gradient", MaterialState { pressure_gradient: [0.0, x], ..state }),
            ("stress_angle_gradient", MaterialState { stress_angle_gradient: [0.0, x], ..state }),
            ("spin_gradient", MaterialState { spin_gradient: [0.0, x], ..state }),
            ("density_gradient", MaterialState { density_gradient: [0.0, x], ..state }),
            ("inertia_rate", MaterialState { inertia_rate: x, ..state }),
            ("inertia_gradient", MaterialState { inertia_gradient: [0.0, x], ..state }),
            ("spin_acceleration", MaterialState { spin_acceleration: x, ..state }),
        ] {
            if let Ok(background) = model.background(&wrong) {
                accepted.push((name, x, background.region()));
            }
        }
    }
    assert!(accepted.is_empty(), "{accepted:?}");
}

/// A spin given to a model without spin is rejected with an error, not by a failed debug assertion.
#[test]
fn spin_is_rejected_in_models_without_spin() {
    for kind in [registry::DOUBLE_SHEARING, registry::PLASTIC_POTENTIAL] {
        let mut random = RandomNumbers::new(6);
        let (_, model, state) = states::random_case(&mut random, kind, DilatancyKind::Zero);
        let state = MaterialState { spin: Some(0.1), noncoaxiality: None, ..state };
        assert_eq!(model.background(&state).expect_err("no such unknown").input, "spin");
    }
}

/// A product that underflows is not a structural zero.
#[test]
fn underflowed_product_is_not_a_structural_zero() {
    let tiny = Rounded::from_rounded(1e-200);
    assert_eq!((tiny * tiny).sign(), None, "{:?}", tiny * tiny);
}

/// The computed rounding bound is rounded upwards, so it is never below the error.
#[test]
fn bound_is_rounded_upwards() {
    let u = f64::EPSILON / 2.0;
    let a = Rounded { value: 1.0, bound: u };
    let b = Rounded { value: u, bound: u * u };
    // The largest exact value of a + b is 1 + 2u + u².
    let own = a + b;
    let exact = dd(1.0) + dd(2.0 * u) + dd(u * u);
    assert!((exact - dd(own.value) - dd(own.bound)).to_f64() <= 0.0, "{own:?}");
}
