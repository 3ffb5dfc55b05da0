//! Double-double arithmetic against 256-bit arithmetic, and 256-bit arithmetic against exact integers.

mod support;

use support::states::{Random, seeded};
use support::wide::{Wide, WideComplex};
use wellposed_analysis::extended::{Extended, ExtendedComplex};

fn wide(x: Extended) -> Wide {
    Wide::from(x.high) + Wide::from(x.low)
}

/// Random double-double number with parts that do not overlap.
fn random(random: &mut Random) -> Extended {
    let exponent = random.within(-40.0, 40.0).round();
    let high =
        (1.0 + random.unit()) * exponent.exp2() * if random.chance(0.5) { -1.0 } else { 1.0 };
    // Sometimes much smaller than half a unit in the last place, sometimes zero.
    let low = match random.bits() % 4 {
        0 => 0.0,
        1 => high * random.within(-1.0, 1.0) * (-90f64).exp2(),
        _ => high * random.within(-0.49, 0.49) * (-53f64).exp2(),
    };
    Extended { high, low }
}

fn relative(found: Extended, exact: Wide) -> f64 {
    if exact.is_zero() {
        assert_eq!(found.high, 0.0);
        return 0.0;
    }
    ((wide(found) - exact).abs() * exact.abs().recip()).to_f64()
}

/// Verifies sums and products to 2⁻¹⁰³ relative, cancellation included, and |low| ≤ ½ ulp(high).
#[test]
fn sums_and_products_are_right_to_twice_the_precision() {
    let generator = &mut seeded(11);
    let (mut sums, mut products) = (0.0f64, 0.0f64);
    for n in 0..400_000 {
        let x = random(generator);
        let y = if n % 3 == 0 {
            // Nearly cancels x.
            let nudge = Extended::from(x.high * (-generator.within(20.0, 90.0)).exp2());
            -x + nudge
        } else {
            random(generator)
        };
        for (result, exact, worst) in
            [(x + y, wide(x) + wide(y), &mut sums), (x * y, wide(x) * wide(y), &mut products)]
        {
            *worst = worst.max(relative(result, exact));
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
    let generator = &mut seeded(12);
    for _ in 0..100_000 {
        let (a, b) = (generator.signed(1e-20, 1e20), generator.signed(1e-20, 1e20));
        assert_eq!(wide(Extended::from(a) * Extended::from(b)), Wide::from(a) * Wide::from(b));
        let close = a * generator.within(0.25, 4.0);
        assert_eq!(
            wide(Extended::from(a) + Extended::from(close)),
            Wide::from(a) + Wide::from(close)
        );
        let x = random(generator);
        assert_eq!(wide(x + -x), Wide::ZERO);
        assert_eq!(wide(-x), -wide(x));
        assert_eq!(wide(x * Extended::from(0.5)), wide(x).shifted(-1));
    }
}

/// Verifies complex products and sums, with errors relative to the moduli.
#[test]
fn complex_arithmetic_is_right_to_twice_the_precision() {
    let generator = &mut seeded(13);
    let c = |x: ExtendedComplex| WideComplex { re: wide(x.re), im: wide(x.im) };
    let mut worst = 0.0f64;
    for _ in 0..100_000 {
        let mut z = || ExtendedComplex { re: random(generator), im: random(generator) };
        let (x, y) = (z(), z());
        let size = c(x).modulus() * c(y).modulus();
        worst = worst.max(((c(x * y) - c(x) * c(y)).modulus() * size.recip()).to_f64());
        let size = c(x).modulus() + c(y).modulus();
        worst = worst.max(((c(x + y) - (c(x) + c(y))).modulus() * size.recip()).to_f64());
    }
    assert!(worst < (-102f64).exp2(), "{worst:e}");
}

/// Verifies the 256-bit reference: integers against 128-bit integers, reciprocals, π, sine and cosine.
#[test]
fn the_reference_arithmetic_is_right() {
    let generator = &mut seeded(14);
    let integer = |x: i128| {
        let (high, low) = ((x >> 40) as f64, (x & ((1 << 40) - 1)) as f64);
        // Both parts fit in a double while |x| < 2⁹³.
        Wide::from(high).shifted(40) + Wide::from(low)
    };
    for _ in 0..100_000 {
        let mut draw = |bits: u32| {
            let x = i128::from(generator.bits() >> (64 - bits));
            if generator.chance(0.5) { -x } else { x }
        };
        let (a, b, d) = (draw(40), draw(46), draw(60));
        assert_eq!(integer(a) * integer(b) + integer(d), integer(a * b + d));
        assert_eq!(integer(a) - integer(a + 1), integer(-1));
        assert_eq!((integer(a) + integer(d)) > integer(b), a + d > b);
        let x = integer(a * 2 + 1);
        assert!((x * x.recip() - Wide::from(1.0)).abs().exponent() < -250);
        assert_eq!(Wide::from(x.to_f64()), x, "41 bits fit in a double");
        // Exponents far apart: the borrow passes through all limbs.
        let tiny = Wide::from(1.0).shifted(-200);
        assert_eq!((x + tiny) - x, tiny);
        assert_eq!((x - tiny) + tiny, x);
    }
    // π to 70 digits, ten at a time.
    let mut x = Wide::pi() - Wide::from(3.0);
    for digits in [
        1415926535.0,
        8979323846.0,
        2643383279.0,
        5028841971.0,
        6939937510.0,
        5820974944.0,
        5923078164.0,
    ] {
        x = x * Wide::from(1e10);
        let rest = x - Wide::from(digits);
        assert!(!rest.is_negative() && rest < Wide::from(1.0), "{digits}");
        x = rest;
    }
    for _ in 0..1000 {
        let angle = Wide::from(generator.signed(1e-20, 10.0));
        let other = Wide::from(generator.signed(1e-3, 10.0));
        let ((s, c), (t, d)) = (angle.sin_cos(), other.sin_cos());
        assert!((s * s + c * c - Wide::from(1.0)).abs().exponent() < -240);
        let sum = (angle + other).sin_cos().0;
        assert!((sum - (s * d + c * t)).abs().exponent() < -238);
        assert!((s.to_f64() - angle.to_f64().sin()).abs() <= 1e-15 * s.to_f64().abs());
    }
    let (s, c) = Wide::pi().shifted(-1).sin_cos();
    assert!(c.abs().exponent() < -245 && (s - Wide::from(1.0)).abs().exponent() < -245);
}
