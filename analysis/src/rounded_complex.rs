//! Complex numbers with a rounding-error bound.

use models::Rounded;
use models::common::elementary::Modulus;
use num_complex::Complex64;
use std::ops::{Add, AddAssign, Mul};

/// Upper bound on the relative rounding error of a complex product or sum.
const RELATIVE_ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Complex number `value` whose error is at most `bound` in modulus.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RoundedComplex {
    pub(crate) value: Complex64,
    pub(crate) bound: f64,
}

impl RoundedComplex {
    pub(crate) fn new(value: Complex64, bound: f64) -> Self {
        Self { value, bound }
    }

    /// Whether the number may be zero within its bound.
    pub(crate) fn is_zero(self) -> bool {
        self.value.modulus() <= self.bound || self.value == Complex64::ZERO
    }

    /// Product x iⁿ with the n-th power of the imaginary unit.
    pub(crate) fn from_i_power(x: Rounded, n: i64) -> Self {
        Self { value: imaginary_power(n) * x.value, bound: x.bound }
    }

    pub(crate) fn modulus(self) -> f64 {
        self.value.modulus()
    }

    /// Product with a real number `factor`, whose error is at most `error`.
    pub(crate) fn scale(self, factor: f64, error: f64) -> Self {
        let (size, modulus) = (factor.abs(), self.modulus());
        let bound =
            self.bound * size + error * (modulus + self.bound) + RELATIVE_ROUNDING * modulus * size;
        Self { value: self.value * factor, bound }
    }
}

impl Add for RoundedComplex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        let rounding = if self.value == Complex64::ZERO || other.value == Complex64::ZERO {
            0.0
        } else {
            RELATIVE_ROUNDING * value.modulus()
        };
        Self { value, bound: self.bound + other.bound + rounding }
    }
}

impl AddAssign for RoundedComplex {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Mul for RoundedComplex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let value = self.value * other.value;
        let bound = self.bound * other.modulus()
            + other.bound * self.modulus()
            + self.bound * other.bound
            + RELATIVE_ROUNDING * value.modulus();
        Self { value, bound }
    }
}

/// Power iⁿ of the imaginary unit.
pub(crate) fn imaginary_power(n: i64) -> Complex64 {
    match n.rem_euclid(4) {
        0 => Complex64::ONE,
        1 => Complex64::I,
        2 => -Complex64::ONE,
        _ => -Complex64::I,
    }
}
