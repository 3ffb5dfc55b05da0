//! Double-double arithmetic: numbers of twice the working precision as unevaluated sums of two doubles (Dekker 1971).
//!
//! Only the operations of the exact dispersion polynomial are implemented, without fused multiply-add, so that results
//! are bitwise equal on all platforms.

use num_complex::Complex64;
use std::ops::{Add, Mul, Neg};

/// `high + low` with |low| at most half a unit in the last place of `high`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtendedReal {
    /// Leading part: the value rounded to a double.
    pub high: f64,
    /// Trailing part: the remainder after rounding.
    pub low: f64,
}

/// Error-free sum of two doubles (TwoSum, Knuth 1969).
#[inline]
fn two_sum(a: f64, b: f64) -> ExtendedReal {
    let high = a + b;
    let virtual_b = high - a;
    ExtendedReal { high, low: (a - (high - virtual_b)) + (b - virtual_b) }
}

/// Error-free sum of two doubles with |a| ≥ |b| (FastTwoSum, Dekker 1971).
#[inline]
fn fast_two_sum(a: f64, b: f64) -> ExtendedReal {
    let high = a + b;
    ExtendedReal { high, low: b - (high - a) }
}

/// Error-free product of two doubles that neither overflows nor underflows (TwoProduct with Veltkamp's splitting,
/// Dekker 1971).
#[inline]
fn two_product(a: f64, b: f64) -> ExtendedReal {
    fn split_veltkamp(x: f64) -> (f64, f64) {
        let t = 134_217_729.0 * x; // 2²⁷ + 1
        let high = t - (t - x);
        (high, x - high)
    }
    let high = a * b;
    let ((ah, al), (bh, bl)) = (split_veltkamp(a), split_veltkamp(b));
    ExtendedReal { high, low: ((ah * bh - high) + ah * bl + al * bh) + al * bl }
}

impl From<f64> for ExtendedReal {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Add for ExtendedReal {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let sum = two_sum(self.high, other.high);
        let rest = two_sum(self.low, other.low);
        let sum = fast_two_sum(sum.high, sum.low + rest.high);
        fast_two_sum(sum.high, sum.low + rest.low)
    }
}

impl Neg for ExtendedReal {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Mul for ExtendedReal {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.high, other.high);
        fast_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

/// A complex number of twice the working precision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExtendedComplex {
    /// Real part.
    pub re: ExtendedReal,
    /// Imaginary part.
    pub im: ExtendedReal,
}

impl Add for ExtendedComplex {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Mul for ExtendedComplex {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re + -(self.im * other.im),
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl Mul<f64> for ExtendedReal {
    type Output = Self;
    #[inline]
    fn mul(self, other: f64) -> Self {
        let product = two_product(self.high, other);
        fast_two_sum(product.high, product.low + self.low * other)
    }
}

impl Mul<Complex64> for ExtendedComplex {
    type Output = Self;
    #[inline]
    fn mul(self, other: Complex64) -> Self {
        Self {
            re: self.re * other.re + -(self.im * other.im),
            im: self.re * other.im + self.im * other.re,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extended_reals_resolve_terms_below_the_rounding_of_doubles() {
        // (1 + 2⁻⁶⁰)² = 1 + 2⁻⁵⁹ + 2⁻¹²⁰
        let tiny = (-60f64).exp2();
        let x = ExtendedReal::from(1.0) + ExtendedReal::from(tiny);
        let square = x * x + ExtendedReal::from(-1.0);
        assert_eq!(square.high, 2.0 * tiny);
        // Ten times the double nearest to 0.1 exceeds 1 by exactly 2⁻⁵⁴, ten times its representation error.
        let rest = ExtendedReal::from(0.1) * ExtendedReal::from(10.0) + ExtendedReal::from(-1.0);
        assert_eq!(rest.high, (-54f64).exp2());
    }
}
