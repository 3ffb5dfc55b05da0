//! Rounding bounds in ill-conditioned cases, and invalid inputs that case files exclude.

mod support;

use support::states::{self, Dilatancy};
use support::{RIGHT_ANGLE, Random, Real, wide};
use wellposed_models::Rounded;
use wellposed_models::flow::state::State;
use wellposed_models::registry;

/// The rounding bound covers the error of Δ derived from a given spin by an arc sine, which amplifies the error of its
/// argument by 1/cos 2Δ.
#[test]
fn bounds_hold_where_the_spin_is_given() {
    let mut random = Random::new(77);
    let (mut beyond, mut worst) = (0, 0.0f64);
    for _ in 0..2000 {
        let parameters =
            states::random_parameters(&mut random, registry::HARRIS_GREKOVA, Dilatancy::Zero);
        let model = states::model(registry::HARRIS_GREKOVA, &parameters);
        let state = states::random_state(&mut random, registry::HARRIS_GREKOVA, Dilatancy::Zero);
        let delta = random.generic(0.0, 0.785);
        let turn = -state.shear_rate * (2.0 * delta).sin() / parameters.friction_angle.sin();
        let spin = state.half_vorticity + turn;
        let state = State { noncoaxiality: None, spin: Some(spin), ..state };
        let system = states::symbol(&model, &states::flow(&model, &state));
        let sine = (wide(state.half_vorticity) - wide(spin))
            * wide(parameters.friction_angle).sin()
            / wide(state.shear_rate);
        let cosine = (wide(1.0) - sine * sine).sqrt();
        let truth = -(wide(4.0 * state.shear_rate) * cosine);
        let own = system.c[(4, 4)];
        let error = (wide(own.value) - truth).value().abs() / own.bound;
        beyond += usize::from(error > 1.0);
        worst = worst.max(error);
    }
    assert_eq!(beyond, 0, "of 2000; the worst error is {worst:.0} bounds");
}

/// For a spin within two units in the last place of the largest admissible one the sign of cos 2Δ is uncertain.
#[test]
fn greatest_spin_is_marginal() {
    let parameters = testkit::flows::Parameters {
        friction_angle: 0.5,
        dilatancy_angle: 0.0,
        cohesion: 0.0,
        moment_of_inertia: Some(0.1),
        rotational_strength: Some(5.0),
    };
    let model = states::model(registry::HARRIS_GREKOVA, &parameters);
    let greatest = 1.0 / 0.5f64.sin();
    for ulps in 0..3 {
        let spin = f64::from_bits(greatest.to_bits() - ulps);
        let state = State {
            density: 1000.0,
            pressure: 100.0,
            shear_rate: 1.0,
            spin: Some(spin),
            ..State::default()
        };
        let system = states::symbol(&model, &states::flow(&model, &state));
        let own = system.c[(4, 4)];
        assert_eq!(own.sign(), None, "{ulps} units below the greatest spin: {own:?}");
    }
}

/// The bound of an angle converted from degrees covers the three roundings of the decimal, of π/180 and of the product.
#[test]
fn converted_angles_lie_within_their_bound() {
    let mut beyond = 0;
    for n in 1..9000 {
        let exact = wide(f64::from(n)) / wide(100.0) * (RIGHT_ANGLE / wide(90.0));
        let own = Rounded::angle((f64::from(n) / 100.0).to_radians());
        beyond += usize::from((wide(own.value) - exact).value().abs() > own.bound);
    }
    assert_eq!(beyond, 0, "of 8999 angles with two decimals");
}

/// NaN and infinity are rejected in every quantity of a state.
#[test]
fn every_number_of_a_state_must_be_finite() {
    let mut random = Random::new(5);
    let (kind, dilatancy) = (registry::HARRIS_GREKOVA, Dilatancy::Positive);
    let parameters = states::random_parameters(&mut random, kind, dilatancy);
    let model = states::model(kind, &parameters);
    let state = states::random_state(&mut random, kind, dilatancy);
    let mut accepted = vec![];
    for x in [f64::NAN, f64::INFINITY] {
        for (name, wrong) in [
            ("velocity", State { velocity: [x, 0.0], ..state }),
            ("stress_angle", State { stress_angle: x, ..state }),
            ("half_vorticity", State { half_vorticity: x, ..state }),
            ("noncoaxiality", State { noncoaxiality: Some(x), ..state }),
            ("rotational_stress", State { rotational_stress: Some(x), ..state }),
            ("pressure_gradient", State { pressure_gradient: [0.0, x], ..state }),
            ("stress_angle_gradient", State { stress_angle_gradient: [0.0, x], ..state }),
            ("spin_gradient", State { spin_gradient: [0.0, x], ..state }),
            ("density_gradient", State { density_gradient: [0.0, x], ..state }),
            ("inertia_rate", State { inertia_rate: x, ..state }),
            ("inertia_gradient", State { inertia_gradient: [0.0, x], ..state }),
            ("spin_acceleration", State { spin_acceleration: x, ..state }),
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
fn spin_of_a_model_without_one_is_refused() {
    for kind in [registry::DOUBLE_SHEARING, registry::PLASTIC_POTENTIAL] {
        let mut random = Random::new(6);
        let parameters = states::random_parameters(&mut random, kind, Dilatancy::Zero);
        let model = states::model(kind, &parameters);
        let state = states::random_state(&mut random, kind, Dilatancy::Zero);
        let state = State { spin: Some(0.1), noncoaxiality: None, ..state };
        assert_eq!(model.background(&state).expect_err("no such unknown").input, "spin");
    }
}

/// A product that underflows is not a structural zero.
#[test]
fn underflow_is_no_structural_zero() {
    let tiny = Rounded::given(1e-200);
    assert_eq!((tiny * tiny).sign(), None, "{:?}", tiny * tiny);
}

/// The computed bound is rounded upwards, so it is never below the error.
#[test]
fn bound_is_rounded_upwards() {
    let u = f64::EPSILON / 2.0;
    let a = Rounded { value: 1.0, bound: u };
    let b = Rounded { value: u, bound: u * u };
    // The largest exact value of a + b is 1 + 2u + u².
    let own = a + b;
    let exact = wide(1.0) + wide(2.0 * u) + wide(u * u);
    assert!((exact - wide(own.value) - wide(own.bound)).value() <= 0.0, "{own:?}");
}
