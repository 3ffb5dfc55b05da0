//! Double-double arithmetic against 256-bit arithmetic, and 256-bit arithmetic against exact integers.

use crate::support::real256::{Complex256, Real256};
use crate::support::states::{RandomNumbers, seeded_generator};
use wellposed_analysis::extended_precision::{ExtendedComplex, ExtendedReal};

fn to_real256(x: ExtendedReal) -> Real256 {
    Real256::from(x.high) + Real256::from(x.low)
}

/// Random double-double number with parts that do not overlap.
fn random_extended_real(random: &mut RandomNumbers) -> ExtendedReal {
    let exponent = random.uniform(-40.0, 40.0).round();
    let high = (1.0 + random.unit_interval())
        * exponent.exp2()
        * if random.bernoulli(0.5) { -1.0 } else { 1.0 };
    // Sometimes much smaller than half a unit in the last place, sometimes zero.
    let low = match random.next_bits() % 4 {
        0 => 0.0,
        1 => high * random.uniform(-1.0, 1.0) * (-90f64).exp2(),
        _ => high * random.uniform(-0.49, 0.49) * (-53f64).exp2(),
    };
    ExtendedReal { high, low }
}

fn relative_error(found: ExtendedReal, exact: Real256) -> f64 {
    if exact.is_zero() {
        assert_eq!(found.high, 0.0);
        return 0.0;
    }
    ((to_real256(found) - exact).abs() * exact.abs().reciprocal()).to_f64()
}

/// Verifies sums and products to 2⁻¹⁰³ relative, cancellation included, and |low| ≤ ½ ulp(high).
#[test]
fn sums_and_products_are_accurate_to_twice_the_precision() {
    let generator = &mut seeded_generator(11);
    let (mut sums, mut products) = (0.0f64, 0.0f64);
    for n in 0..400_000 {
        let x = random_extended_real(generator);
        let y = if n % 3 == 0 {
            // Nearly cancels x.
            let nudge = ExtendedReal::from(x.high * (-generator.uniform(20.0, 90.0)).exp2());
            -x + nudge
        } else {
            random_extended_real(generator)
        };
        for (result, exact, worst) in [
            (x + y, to_real256(x) + to_real256(y), &mut sums),
            (x * y, to_real256(x) * to_real256(y), &mut products),
        ] {
            *worst = worst.max(relative_error(result, exact));
            assert_eq!(result.high + result.low, result.high, "{x:?}, {y:?}: {result:?}");
        }
    }
    println!(
        "greatest errors in units of 2⁻¹⁰⁶: sums {:.2}, products {:.2}",
        sums * 106f64.exp2(),
        products * 106f64.exp2()
    );
    assert!(sums <= (-103f64).exp2() && products <= (-103f64).exp2());
}

/// Verifies exact cases: products of doubles, sums of doubles, zeros, signs.
#[test]
fn exact_results_are_exact() {
    let generator = &mut seeded_generator(12);
    for _ in 0..100_000 {
        let (a, b) =
            (generator.signed_log_uniform(1e-20, 1e20), generator.signed_log_uniform(1e-20, 1e20));
        assert_eq!(
            to_real256(ExtendedReal::from(a) * ExtendedReal::from(b)),
            Real256::from(a) * Real256::from(b)
        );
        let close = a * generator.uniform(0.25, 4.0);
        assert_eq!(
            to_real256(ExtendedReal::from(a) + ExtendedReal::from(close)),
            Real256::from(a) + Real256::from(close)
        );
        let x = random_extended_real(generator);
        assert_eq!(to_real256(x + -x), Real256::ZERO);
        assert_eq!(to_real256(-x), -to_real256(x));
        assert_eq!(
            to_real256(x * ExtendedReal::from(0.5)),
            to_real256(x).multiply_by_power_of_two(-1)
        );
    }
}

/// Verifies complex products and sums, with errors relative to the moduli.
#[test]
fn complex_arithmetic_is_accurate_to_twice_the_precision() {
    let generator = &mut seeded_generator(13);
    let c = |x: ExtendedComplex| Complex256 { re: to_real256(x.re), im: to_real256(x.im) };
    let mut worst = 0.0f64;
    for _ in 0..100_000 {
        let mut z = || ExtendedComplex {
            re: random_extended_real(generator),
            im: random_extended_real(generator),
        };
        let (x, y) = (z(), z());
        let size = c(x).modulus() * c(y).modulus();
        worst = worst.max(((c(x * y) - c(x) * c(y)).modulus() * size.reciprocal()).to_f64());
        let size = c(x).modulus() + c(y).modulus();
        worst = worst.max(((c(x + y) - (c(x) + c(y))).modulus() * size.reciprocal()).to_f64());
    }
    assert!(worst < (-102f64).exp2(), "{worst:e}");
}

/// Verifies the 256-bit reference: integers against 128-bit integers, reciprocals, π, sine and cosine.
#[test]
fn reference_arithmetic_agrees_with_integers_and_known_values() {
    let generator = &mut seeded_generator(14);
    let integer = |x: i128| {
        let (high, low) = ((x >> 40) as f64, (x & ((1 << 40) - 1)) as f64);
        // Both parts fit in a double while |x| < 2⁹³.
        Real256::from(high).multiply_by_power_of_two(40) + Real256::from(low)
    };
    for _ in 0..100_000 {
        let mut draw = |bits: u32| {
            let x = i128::from(generator.next_bits() >> (64 - bits));
            if generator.bernoulli(0.5) { -x } else { x }
        };
        let (a, b, d) = (draw(40), draw(46), draw(60));
        assert_eq!(integer(a) * integer(b) + integer(d), integer(a * b + d));
        assert_eq!(integer(a) - integer(a + 1), integer(-1));
        assert_eq!((integer(a) + integer(d)) > integer(b), a + d > b);
        let x = integer(a * 2 + 1);
        assert!((x * x.reciprocal() - Real256::from(1.0)).abs().exponent() < -250);
        assert_eq!(Real256::from(x.to_f64()), x, "41 bits fit in a double");
        // Exponents far apart: the borrow passes through all limbs.
        let tiny = Real256::from(1.0).multiply_by_power_of_two(-200);
        assert_eq!((x + tiny) - x, tiny);
        assert_eq!((x - tiny) + tiny, x);
    }
    // π to 70 digits, ten at a time.
    let mut x = Real256::pi() - Real256::from(3.0);
    for digits in [
        1415926535.0,
        8979323846.0,
        2643383279.0,
        5028841971.0,
        6939937510.0,
        5820974944.0,
        5923078164.0,
    ] {
        x = x * Real256::from(1e10);
        let rest = x - Real256::from(digits);
        assert!(!rest.is_negative() && rest < Real256::from(1.0), "{digits}");
        x = rest;
    }
    for _ in 0..1000 {
        let angle = Real256::from(generator.signed_log_uniform(1e-20, 10.0));
        let other = Real256::from(generator.signed_log_uniform(1e-3, 10.0));
        let ((s, c), (t, d)) = (angle.sin_cos(), other.sin_cos());
        assert!((s * s + c * c - Real256::from(1.0)).abs().exponent() < -240);
        let sum = (angle + other).sin_cos().0;
        assert!((sum - (s * d + c * t)).abs().exponent() < -238);
        assert!((s.to_f64() - angle.to_f64().sin()).abs() <= 1e-15 * s.to_f64().abs());
    }
    let (s, c) = Real256::pi().multiply_by_power_of_two(-1).sin_cos();
    assert!(c.abs().exponent() < -245 && (s - Real256::from(1.0)).abs().exponent() < -245);
}
