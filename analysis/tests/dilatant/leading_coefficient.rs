//! Leading coefficient (that of the highest power of ς) of the dispersion polynomial: its real zeros appear and vanish
//! at the bounds on the non-coaxiality.

use super::backgrounds::{ALL_FLAGS, Inside, Outside, Reversed, UNIFORM, sample_harris_grekova};
use crate::support::exact::DispersionReference;
use crate::support::maximise::maximise_over_half_turn;
use crate::support::real256::Real256;
use crate::support::states::{FlowSample, reference_system, seeded_generator, with_noncoaxiality};
use crate::support::verdicts::{compute_verdict, growth_coefficient};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, FRAC_PI_8, PI};
use testkit::flows::FlowParameters;
use wellposed_analysis::growth::Verdict;

/// Coefficients of cos²θ, cos θ sin θ, sin²θ in the coefficient of ς³ k², the highest powers of ς and k.
fn leading_quadratic_form(p: &DispersionReference) -> [Real256; 3] {
    assert_eq!(p.degree(), 3);
    let mut form = [Real256::ZERO; 3];
    for &([time, x, y], value) in &p.terms {
        assert!(time < 3 || x + y <= 2);
        if time == 3 && x + y == 2 {
            form[usize::from(y)] = value;
        }
    }
    form
}

/// Discriminant b² − 4ac of a quadratic form.
fn discriminant([a, b, c]: [Real256; 3]) -> Real256 {
    b * b - (a * c).multiply_by_power_of_two(2)
}

/// Verifies the bound of well-posedness on a uniform background against the determinant in 256 bits, independent of the
/// closed form: the coefficient of the highest power of ς is a quadratic form in the wave vector, so it changes sign
/// exactly if its discriminant is positive.
///
/// The rates enter the determinant linearly, with cos 2Δ or sin 2Δ, so the discriminant is a quadratic form X cos² 2Δ +
/// Y sin² 2Δ + Z sin 2Δ cos 2Δ. Three values of Δ give X < 0, Y > 0 and Z = 0, and a fourth, random value confirms the
/// form; the bound is |tan 2Δ| = √(−X/Y).
#[test]
fn noncoaxiality_bound_agrees_with_the_determinant() {
    check_noncoaxiality_bound(500);
}

/// Checks `count` random states.
fn check_noncoaxiality_bound(count: u64) {
    let deviations: Vec<f64> = (0..count)
        .into_par_iter()
        .map(|seed| {
            let random = &mut seeded_generator(0xb0_0000 + seed);
            let drawn = sample_harris_grekova(random, UNIFORM, Inside, seed % 2 == 0);
            let base = drawn.sample;
            // Include ν near 0 and near φ.
            let (phi, nu) = (base.parameters.friction_angle, base.parameters.dilatancy_angle);
            let dilatancy_angle = match seed / 2 % 4 {
                0 => phi * random.log_uniform(1e-6, 0.1),
                1 => phi * (1.0 - random.log_uniform(1e-6, 0.1)),
                _ => nu,
            };
            let parameters = FlowParameters { dilatancy_angle, ..base.parameters };
            let base = FlowSample::new(base.kind(), parameters, base.state);
            let at = |delta: f64| {
                let p = reference_system(&with_noncoaxiality(&base, delta)).polynomial();
                assert!(p.terms.iter().all(|&([time, x, y], _)| time < 3 || x + y == 2));
                leading_quadratic_form(&p)
            };

            // Whether x is zero to 60 digits relative to `than`.
            let is_small = |x: Real256, than: Real256| x.exponent() < than.exponent() - 200;
            let x = discriminant(at(0.0));
            let [plus, minus] = [FRAC_PI_4, -FRAC_PI_4].map(|delta| discriminant(at(delta)));
            let (sine, cosine) = Real256::from(FRAC_PI_2).sin_cos();
            let y = ((plus + minus).multiply_by_power_of_two(-1) - x * cosine * cosine)
                * (sine * sine).reciprocal();
            let [plus, minus] = [FRAC_PI_8, -FRAC_PI_8].map(|delta| discriminant(at(delta)));
            assert!(is_small(plus - minus, x) || is_small(plus - minus, y), "seed {seed}: Z");
            let delta = random.uniform(-FRAC_PI_2, FRAC_PI_2);
            let (sine, cosine) = Real256::from(2.0 * delta).sin_cos();
            let (sum, own) = (x * cosine * cosine + y * sine * sine, discriminant(at(delta)));
            assert!(is_small(sum - own, x) || is_small(sum - own, y), "seed {seed}: a form in 2Δ");

            assert!(x.is_negative() && !y.is_negative(), "seed {seed}");
            let bound = 0.5 * (-x * y.reciprocal()).to_f64().sqrt().atan();
            let closed_form = base.model.noncoaxiality_bound().expect("the model has one");
            let deviation = (closed_form / bound - 1.0).abs();

            // No real zeros in the zones [`Inside`] and [`Reversed`], two in [`Outside`]. The closed form of the bound
            // is accurate to 1e-14.
            for _ in 0..4 {
                let distance = random.log_uniform(1e-12, 0.3);
                let outside = bound + distance * (FRAC_PI_4 - bound).max(1e-12);
                let noncoaxialities = [
                    (bound * (1.0 - distance), false),
                    (outside, true),
                    (FRAC_PI_2 - outside, true),
                    (FRAC_PI_2 - bound * (1.0 - distance), false),
                ];
                // For ν near 0 the zone outside has almost no width.
                let is_wide = distance * (FRAC_PI_4 - bound) > 1e-14;
                for (size, has_zeros) in noncoaxialities {
                    if has_zeros && !is_wide {
                        continue;
                    }
                    for delta in [size, -size] {
                        let d = discriminant(at(delta));
                        assert_eq!(!d.is_negative(), has_zeros, "seed {seed}, {distance:e}");
                    }
                }
            }
            deviation
        })
        .collect();
    let worst = deviations.into_iter().fold(0.0, f64::max);
    println!("greatest deviation of the closed form: {worst:.1e}");
    // The closed form rounds two cosines and a square root; at φ = 1.5 the relative error of cos φ is tan φ = 14 times
    // the rounding error of φ.
    assert!(worst < 1e-14, "{worst:e}");
}

/// Verifies to 60 digits that the closed form cos 2Δ cos ν [cos e + sin ν sin φ − (sin φ cos e + sin ν) cos β] + sin 2Δ
/// sin ν cos φ cos e sin β, with e = φ − ν, β = 2(Ψ_Σ − ψ_K), the stress angle Ψ_Σ and the angle ψ_K of the wave
/// vector, is proportional to the coefficient in all directions, by a factor independent of Δ.
#[test]
fn leading_coefficient_agrees_with_the_closed_form() {
    check_leading_coefficient(150);
}

/// Checks `count` random states.
fn check_leading_coefficient(count: u64) {
    (0..count).into_par_iter().for_each(|seed| {
        let random = &mut seeded_generator(0xb1_0000 + seed);
        let base = sample_harris_grekova(random, UNIFORM, Inside, seed % 2 == 0).sample;
        let phi = Real256::from(base.parameters.friction_angle);
        let nu = Real256::from(base.parameters.dilatancy_angle);
        let ((sin_phi, cos_phi), (sin_nu, cos_nu)) = (phi.sin_cos(), nu.sin_cos());
        let (_, cos_e) = (phi - nu).sin_cos();
        let one = Real256::from(1.0);
        let mut factor = None;
        for _ in 0..3 {
            let delta = random.uniform(-FRAC_PI_2, FRAC_PI_2);
            let [a, b, c] = leading_quadratic_form(
                &reference_system(&with_noncoaxiality(&base, delta)).polynomial(),
            );
            let (sin_2d, cos_2d) = Real256::from(2.0 * delta).sin_cos();
            for _ in 0..4 {
                let angle = Real256::from(random.uniform(0.0, PI));
                let (s, c1) = angle.sin_cos();
                let form = a * c1 * c1 + b * c1 * s + c * s * s;
                let beta =
                    (Real256::from(base.state.stress_angle) - angle).multiply_by_power_of_two(1);
                let (sin_b, cos_b) = beta.sin_cos();
                let stated = cos_2d
                    * cos_nu
                    * (cos_e + sin_nu * sin_phi - (sin_phi * cos_e + sin_nu) * cos_b)
                    + sin_2d * sin_nu * cos_phi * cos_e * sin_b;
                let own = form * stated.reciprocal();
                let first = *factor.get_or_insert(own);
                // Next to a zero the quotient loses the digits that numerator and denominator have lost.
                let lost = (own * first.reciprocal() - one) * stated;
                assert!(lost.abs().to_f64() < 1e-60, "seed {seed}: {:e}", lost.to_f64());
            }
        }
    });
}

/// Verifies that in the zone [`Outside`] the direction of the verdict is a zero of the leading coefficient, to the
/// rounding of this form divided by its slope.
#[test]
fn verdict_direction_is_a_zero_of_the_leading_coefficient() {
    check_direction(300);
}

/// Checks `count` random states.
fn check_direction(count: u64) {
    let worst = (0..count)
        .into_par_iter()
        .map(|seed| {
            let random = &mut seeded_generator(0xb2_0000 + seed);
            let sample = sample_harris_grekova(random, UNIFORM, Outside, seed % 2 == 0).sample;
            let Verdict::IllPosed { direction, .. } = compute_verdict(&sample.system) else {
                panic!("seed {seed}: {sample:?}")
            };
            let form = leading_quadratic_form(&reference_system(&sample).polynomial());
            let size = form.iter().map(|x| x.exponent()).max().expect("three");
            let scaled = |x: Real256| x.multiply_by_power_of_two(-size).to_f64();
            // With the coefficients A of cos²θ and C of sin²θ the form is ½[A + C + R cos 2(θ − θ₀)], so R² − (A + C)²
            // is its discriminant.
            let middle = scaled(form[0] + form[2]);
            let root = discriminant(form).multiply_by_power_of_two(-2 * size).to_f64().sqrt();
            let shift = scaled(form[1]).atan2(scaled(form[0] - form[2]));
            let half = root.atan2(-middle);
            let error = [half, -half]
                .map(|x| (0.5 * (shift + x) - direction).rem_euclid(PI))
                .map(|x| x.min(PI - x));
            // The slope of the form is the square root of the discriminant.
            error[0].min(error[1]) * root / f64::EPSILON
        })
        .reduce(|| 0.0, f64::max);
    println!("greatest deviation of a direction: {worst:.1} roundings over the slope");
    assert!(worst < 200.0, "{worst}");
}

/// Verifies the coefficient of growth where the non-coaxiality |Δ| exceeds 90° − bound, ς ≈ k² F₂₄/F₃₂; Fₙₘ is the form
/// of degree m in the wave vector that multiplies ςⁿ in the dispersion polynomial. The reference is the maximum of
/// F₂₄/F₃₂ over directions, with coefficients in 256-bit arithmetic. Near the bound the minimum of |F₃₂| is much
/// smaller than the mean, and its relative error in double precision is ε times the ratio of mean to minimum.
#[test]
fn growth_coefficients_in_the_reversed_zone_agree_with_the_polynomial() {
    check_growth_coefficients(300);
}

/// Checks `count` random states.
fn check_growth_coefficients(count: u64) {
    let worst = (0..count)
        .into_par_iter()
        .map(|seed| {
            let random = &mut seeded_generator(0xb4_0000 + seed);
            let parts = if seed % 2 == 0 { UNIFORM } else { ALL_FLAGS };
            let sample = sample_harris_grekova(random, parts, Reversed, true).sample;
            let p = reference_system(&sample).polynomial();
            let form = |time: u8, degree: u8| {
                let mut list = vec![0.0; usize::from(degree) + 1];
                for &([i, x, y], value) in &p.terms {
                    if i == time && x + y == degree {
                        list[usize::from(y)] = value.to_f64();
                    }
                }
                move |angle: f64| {
                    let (s, c) = angle.sin_cos();
                    let power = |y: usize| c.powi(i32::from(degree) - y as i32) * s.powi(y as i32);
                    list.iter().enumerate().map(|(y, x)| x * power(y)).sum::<f64>()
                }
            };
            let (above, below) = (form(2, 4), form(3, 2));
            let (wanted, _) = maximise_over_half_turn(4000, |angle| above(angle) / below(angle));
            let error = (growth_coefficient(&compute_verdict(&sample.system)) / wanted - 1.0).abs();
            // Four times the product of minimum and maximum of F₃₂, which is minus the discriminant, over their squared
            // sum: about four times the ratio of minimum to maximum if that is small.
            let highest = leading_quadratic_form(&p);
            let sum = highest[0] + highest[2];
            let part = -(discriminant(highest) * (sum * sum).reciprocal()).to_f64();
            error / (1e-10 + 64.0 * f64::EPSILON / part)
        })
        .reduce(|| 0.0, f64::max);
    println!("greatest deviation over its bound: {worst:.2}");
    assert!(worst < 1.0, "{worst}");
}

#[test]
#[ignore = "takes ten seconds"]
fn leading_coefficients_of_many_states_agree() {
    check_noncoaxiality_bound(2000);
    check_leading_coefficient(500);
    check_direction(1000);
    check_growth_coefficients(1000);
}
