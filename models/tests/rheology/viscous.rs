//! Schemes with dampers: the exact formula of the implicit Euler method at every step, and its convergence with order 1
//! to the exponentials of the continuous problem.

use super::{assert_near, build, compute_response};
use wellposed_models::rheology::load_path::Activity;
use wellposed_models::rheology::scheme::LoadControl;

const ROUNDING: f64 = 1e-12;

/// Asserts that errors at numbers of steps doubled each time fall with the order 1.
fn assert_first_order(errors: &[f64]) {
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((0.95..1.05).contains(&order), "{order}: {errors:?}");
    }
}

/// Compression at the rate −r from rest: σ = −ηr(1 − e^(−Et/η)).
#[test]
fn granular_maxwell_medium_relaxes_in_compression() {
    let [modulus, viscosity, rate, duration] = [2.0, 0.6, 0.5, 0.7];
    let scheme = build("granular-maxwell", &[modulus, viscosity]);
    let limit = viscosity * rate;
    let mut errors = Vec::new();
    for steps in [100, 200, 400] {
        let points = [[0.0, 0.0], [duration, -rate * duration]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, steps);
        let step = duration / steps as f64;
        let factor = 1.0 / (1.0 + modulus * step / viscosity);
        for (number, point) in response.iter().enumerate() {
            let expected = -limit * (1.0 - factor.powi(number as i32));
            assert_near(point.state.stress, expected, limit, ROUNDING);
        }
        let exact = -limit * (1.0 - (-modulus * duration / viscosity).exp());
        errors.push((response.last().expect("points").state.stress - exact).abs());
    }
    assert_first_order(&errors);
}

/// Turned to the rate +r at the stress σ₁, the contact opens after (η/E) ln(1 − σ₁/(ηr)).
#[test]
fn granular_maxwell_medium_opens_at_the_time_of_the_closed_form() {
    let [modulus, viscosity, rate, duration] = [2.0, 0.6, 0.5, 0.7];
    let scheme = build("granular-maxwell", &[modulus, viscosity]);
    let limit = viscosity * rate;
    let mut errors = Vec::new();
    for steps in [1000, 2000, 4000] {
        let turn = -rate * duration;
        let points = [[0.0, 0.0], [duration, turn], [2.0 * duration, 0.0]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, steps);
        let step = duration / steps as f64;
        let turned = response[steps].state.stress;
        // Discrete: σₙ = ηr − (ηr − σ₁)qⁿ reaches 0 in step n with qⁿ = 1/(1 − σ₁/(ηr)).
        let factor = 1.0 / (1.0 + modulus * step / viscosity);
        let number = -(1.0 - turned / limit).ln() / factor.ln();
        let opened = (1..=steps).find(|own| response[steps + own].activities[2] == Activity::Open);
        assert_eq!(opened, Some(number.ceil() as usize));
        for own in 1..=steps {
            let expected = (limit - (limit - turned) * factor.powi(own as i32)).min(0.0);
            assert_near(response[steps + own].state.stress, expected, limit, ROUNDING);
        }
        let exact_turned = -limit * (1.0 - (-modulus * duration / viscosity).exp());
        let exact = viscosity / modulus * (1.0 - exact_turned / limit).ln();
        errors.push((number * step - exact).abs());
    }
    assert_first_order(&errors);
}

/// Turned at the strain −ε₁ from the rate −r to +r, the stress jumps by 2ηr; the contact opens at ε = −ηr/E; the element
/// creeps back as (ηr/E)e^(−Et/η), and the contact closes again where the path meets it.
#[test]
fn granular_kelvin_voigt_medium_opens_before_zero_strain_and_creeps_back() {
    let [modulus, viscosity, rate] = [2.0, 0.25, 0.5];
    let scheme = build("granular-kelvin-voigt", &[modulus, viscosity]);
    let opening = viscosity * rate / modulus;
    let [turn, creep_time] = [4.0 * opening, 0.3];
    let times = [turn / rate, (turn - opening) / rate];
    let mut errors = Vec::new();
    for steps in [300, 600, 1200] {
        // The path turns at −ε₁, passes the opening strain at a point, moves on, and comes back.
        let [t1, t2] = [times[0], times[0] + times[1]];
        let [t3, t4] = [t2 + creep_time, t2 + creep_time + 1e-9];
        let high = -opening + rate * creep_time;
        let points = [[0.0, 0.0], [t1, -turn], [t2, -opening], [t3, high], [t4, -opening]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, steps);
        let scale = modulus * turn;
        for point in &response[1..=steps] {
            let expected = modulus * point.state.strain - viscosity * rate;
            assert_near(point.state.stress, expected, scale, ROUNDING);
        }
        for point in &response[steps + 1..2 * steps] {
            let expected = modulus * point.state.strain + viscosity * rate;
            assert_near(point.state.stress, expected, scale, 1e-11);
            assert_eq!(point.activities[2], Activity::Closed);
        }
        let jump = response[steps + 1].state.stress - response[steps].state.stress;
        let step = times[1] / steps as f64;
        assert_near(jump, 2.0 * viscosity * rate + modulus * rate * step, scale, 1e-11);
        // Open from here on: creep without stress.
        let step = creep_time / steps as f64;
        let factor = 1.0 / (1.0 + modulus * step / viscosity);
        for number in 1..=steps {
            let point = &response[2 * steps + number];
            assert_eq!(point.activities[2], Activity::Open);
            assert_near(point.state.stress, 0.0, scale, ROUNDING);
            let expected = -opening * factor.powi(number as i32);
            assert_near(point.state.elements[0].strain, expected, opening, ROUNDING);
        }
        let exact = -opening * (-modulus * creep_time / viscosity).exp();
        errors.push((response[3 * steps].state.elements[0].strain - exact).abs());
        // On the fast way back the contact closes where the path meets the element.
        let crept = response[3 * steps].state.elements[0].strain;
        for point in &response[3 * steps + 1..] {
            let is_closed = point.activities[2] == Activity::Closed;
            assert_eq!(is_closed, point.state.strain < crept, "{} {crept}", point.state.strain);
        }
    }
    assert_first_order(&errors);
}

/// At a constant rate the overstress of the viscoplastic skeleton tends to ηr.
#[test]
fn viscoplastic_overstress_tends_to_viscosity_times_rate() {
    let [a, b, porosity, compressive, tensile, viscosity] = [2.0, 5.0, 9.0, 0.04, 0.07, 0.3];
    let constants = [a, b, porosity, compressive, tensile, viscosity];
    let scheme = build("porous-viscoplastic", &constants);
    let [rate, duration] = [0.1, 0.2];
    let limit = viscosity * rate;
    let mut errors = Vec::new();
    for steps in [100, 200, 400] {
        for (sign, strength) in [(-1.0, compressive), (1.0, tensile)] {
            let yielding = strength / a;
            let first = yielding / rate;
            let points = [
                [0.0, 0.0],
                [first, sign * yielding],
                [first + duration, sign * (yielding + rate * duration)],
            ];
            let response = compute_response(&scheme, LoadControl::Strain, &points, steps);
            let step = duration / steps as f64;
            let factor = 1.0 / (1.0 + a * step / viscosity);
            for number in 0..=steps {
                let overstress = limit * (1.0 - factor.powi(number as i32));
                let expected = sign * (strength + overstress);
                assert_near(response[steps + number].state.stress, expected, strength, ROUNDING);
            }
            if sign < 0.0 {
                let exact = strength + limit * (1.0 - (-a * duration / viscosity).exp());
                errors.push((response[2 * steps].state.stress + exact).abs());
            }
        }
    }
    assert_first_order(&errors);
    // Much later the overstress is ηr to rounding.
    let points = [[0.0, 0.0], [30.0, -3.0]];
    let response = compute_response(&scheme, LoadControl::Strain, &points, 300);
    let last = response.last().expect("points").state.stress;
    assert_near(last, -(compressive + limit), limit, 1e-10);
}

/// Creep under the stress S₀ from t = 0: S₀[a₀ + a₁(1 − e^(−t/(ηa₁)))].
#[test]
fn poynting_thomson_solid_creeps() {
    let [a0, a1, viscosity, stress, duration] = [0.5, 1.25, 0.4, 0.3, 0.8];
    let scheme = build("poynting-thomson", &[1.0 / a0, 1.0 / a1, viscosity]);
    let mut errors = Vec::new();
    for steps in [100, 200, 400] {
        let points = [[0.0, stress], [duration, stress]];
        let response = compute_response(&scheme, LoadControl::Stress, &points, steps);
        let factor = 1.0 / (1.0 + duration / steps as f64 / (viscosity * a1));
        // The first point is the state at rest, the second one the jump.
        assert_eq!((response[0].state.strain, response[1].time), (0.0, 0.0));
        for number in 0..=steps {
            let expected = stress * (a0 + a1 * (1.0 - factor.powi(number as i32)));
            assert_near(response[1 + number].state.strain, expected, 1.0, ROUNDING);
        }
        let exact = stress * (a0 + a1 * (1.0 - (-duration / (viscosity * a1)).exp()));
        errors.push((response[1 + steps].state.strain - exact).abs());
    }
    assert_first_order(&errors);
}

/// Relaxation at the strain ε₀ from ε₀/a₀ to ε₀/(a₀ + a₁) with the time ηa₀a₁/(a₀ + a₁).
#[test]
fn poynting_thomson_solid_relaxes() {
    let [a0, a1, viscosity, strain, duration] = [0.5, 1.25, 0.4, 0.3, 0.2];
    let scheme = build("poynting-thomson", &[1.0 / a0, 1.0 / a1, viscosity]);
    let [first, last] = [strain / a0, strain / (a0 + a1)];
    let time = viscosity * a0 * a1 / (a0 + a1);
    let mut errors = Vec::new();
    for steps in [100, 200, 400] {
        let points = [[0.0, strain], [duration, strain]];
        let response = compute_response(&scheme, LoadControl::Strain, &points, steps);
        let factor = 1.0 / (1.0 + duration / steps as f64 / time);
        for number in 0..=steps {
            let expected = last + (first - last) * factor.powi(number as i32);
            assert_near(response[1 + number].state.stress, expected, first, ROUNDING);
        }
        let exact = last + (first - last) * (-duration / time).exp();
        errors.push((response[1 + steps].state.stress - exact).abs());
    }
    assert_first_order(&errors);
}
