//! Floating-point numbers with a running rounding-error bound.
//!
//! Verdicts on well-posedness depend on signs. A sign is certain only if the magnitude of the value exceeds a bound on
//! its error, so the linearised equations are written in [`Rounded`]: a double with a running error bound (Wilkinson's
//! running error analysis). A value with a zero bound is exact. Products and sums propagate structural zeros (value and
//! bound zero) exactly.

use crate::common::elementary::Elementary;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// Unit roundoff u, half a unit in the last place of 1: the largest relative error of one rounding to nearest.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// Factor by which bounds, themselves rounded to nearest, are inflated to stay upper bounds.
const BOUND_INFLATION: f64 = 1.0 + 2.0 * f64::EPSILON;

/// The smallest positive double: bounds the error of an operation that underflows.
const MIN_SUBNORMAL: f64 = f64::from_bits(1);

/// A double `value` within `bound` of the exact number that it approximates.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Rounded {
    /// Computed value.
    pub value: f64,
    /// Bound on the error: |value − exact| ≤ bound.
    pub bound: f64,
}

impl Rounded {
    /// The exact zero.
    pub const ZERO: Self = Self::from_exact(0.0);
    /// The exact one.
    pub const ONE: Self = Self::from_exact(1.0);

    /// An exact double, with bound 0.
    #[inline]
    pub const fn from_exact(value: f64) -> Self {
        Self { value, bound: 0.0 }
    }

    /// A double rounded from a real number, such as a decimal from a file: bound u·|value|, u the unit roundoff.
    #[inline]
    pub fn from_rounded(value: f64) -> Self {
        Self { value, bound: UNIT_ROUNDOFF * value.abs() }
    }

    /// An angle in radians converted from decimal degrees: bound 3u·|value| for the rounding of the decimal, of π/180
    /// and of their product.
    pub fn from_angle(radians: f64) -> Self {
        Self { value: radians, bound: 3.0 * UNIT_ROUNDOFF * radians.abs() * BOUND_INFLATION }
    }

    /// Whether the number is exactly zero (value and bound zero), not zero by rounding.
    #[inline]
    pub fn is_structural_zero(self) -> bool {
        self.value == 0.0 && self.bound == 0.0
    }

    /// The certain sign: ±1 if |value| > bound, 0 for a structural zero, else `None`.
    #[inline]
    pub fn sign(self) -> Option<i8> {
        if self.value.abs() > self.bound {
            Some(if self.value > 0.0 { 1 } else { -1 })
        } else if self.bound == 0.0 {
            Some(0)
        } else {
            None
        }
    }

    /// Sine. Its bound is the bound of the argument, since |d sin x/dx| ≤ 1, plus one unit in the last place for the
    /// evaluation.
    pub fn sin(self) -> Self {
        if self.is_structural_zero() {
            return Self::ZERO;
        }
        let value = self.value.cr_sin();
        Self::with_rounding_error(value, self.bound + UNIT_ROUNDOFF * value.abs())
    }

    /// Cosine. Its bound is the bound of the argument, since |d cos x/dx| ≤ 1, plus one unit in the last place for the
    /// evaluation.
    pub fn cos(self) -> Self {
        let value = self.value.cr_cos();
        Self::with_rounding_error(value, self.bound + UNIT_ROUNDOFF * value.abs())
    }

    /// Sine and cosine, as [`sin`](Self::sin) and [`cos`](Self::cos).
    pub fn sin_cos(self) -> (Self, Self) {
        if self.is_structural_zero() {
            return (Self::ZERO, self.cos());
        }
        let (sin, cos) = self.value.cr_sin_cos();
        let with_error =
            |value: f64| Self::with_rounding_error(value, self.bound + UNIT_ROUNDOFF * value.abs());
        (with_error(sin), with_error(cos))
    }

    /// Arc sine of a number whose exact value lies in [−1, 1]. Its bound is the larger of the distances to the arc
    /// sines of value ± bound, the ends of the interval of possible arguments, plus rounding errors.
    pub fn asin(self) -> Self {
        let at = |x: f64| x.clamp(-1.0, 1.0).cr_asin();
        let value = at(self.value);
        let (low, high) = (at(self.value - self.bound), at(self.value + self.bound));
        let spread = (value - low).max(high - value);
        Self::with_rounding_error(value, spread + 3.0 * UNIT_ROUNDOFF * value.abs())
    }

    /// Square root of a number that is not negative. Its error is at most |√x − √v| ≤ |x − v|/√v, with the exact number
    /// x and the value v, plus one rounding.
    pub fn sqrt(self) -> Self {
        if self.is_structural_zero() {
            return Self::ZERO;
        }
        let value = self.value.sqrt();
        Self::with_rounding_error(value, self.bound / value)
    }

    /// Arc cosine of a number whose exact value lies in [−1, 1].
    pub fn acos(self) -> Self {
        self.apply_monotone(|x| x.clamp(-1.0, 1.0).cr_acos())
    }

    /// Arc tangent.
    pub fn atan(self) -> Self {
        self.apply_monotone(f64::cr_atan)
    }

    /// Exponential.
    pub fn exp(self) -> Self {
        self.apply_monotone(f64::cr_exp)
    }

    /// Natural logarithm; its bound is infinite if the number may be zero or negative.
    pub fn ln(self) -> Self {
        if self.value - self.bound <= 0.0 {
            return Self { value: self.value.cr_ln(), bound: f64::INFINITY };
        }
        self.apply_monotone(f64::cr_ln)
    }

    /// Tangent; its bound is infinite if the argument may be an odd multiple of π/2.
    pub fn tan(self) -> Self {
        // The interval [v − b, v + b] holds no pole if cos v is certainly larger than the change sin can make.
        if self.cos().sign() == Some(0) || self.cos().value.abs() <= self.bound {
            return Self { value: self.value.cr_tan(), bound: f64::INFINITY };
        }
        self.apply_monotone(f64::cr_tan)
    }

    /// Hyperbolic sine.
    pub fn sinh(self) -> Self {
        self.apply_monotone(f64::cr_sinh)
    }

    /// Hyperbolic cosine, monotone in |x|, which is known to within the same bound.
    pub fn cosh(self) -> Self {
        Self { value: self.value.abs(), bound: self.bound }.apply_monotone(|x| x.max(0.0).cr_cosh())
    }

    /// Hyperbolic tangent.
    pub fn tanh(self) -> Self {
        self.apply_monotone(f64::cr_tanh)
    }

    /// The polar angle in [−π, π] of the point (x, y), where y is `self`. The bound is the angle at which the errors of
    /// both coordinates are seen from the origin; infinite if the point may be the origin.
    pub fn atan2(self, x: Self) -> Self {
        let value = self.value.cr_atan2(x.value);
        let distance = self.value.root_sum_square(x.value);
        let error = self.bound.root_sum_square(x.bound);
        if distance <= error {
            return Self { value, bound: f64::INFINITY };
        }
        // On the negative x axis the angle jumps by 2π.
        if x.value < 0.0 && self.value.abs() <= self.bound && self.bound > 0.0 {
            return Self { value, bound: 2.0 * std::f64::consts::PI };
        }
        let seen = (error / distance * BOUND_INFLATION).min(1.0).cr_asin() * BOUND_INFLATION;
        Self::with_rounding_error(value, seen + UNIT_ROUNDOFF * value.abs())
    }

    /// Power with the exponent `power` of a positive number; its bound is infinite if the number may be zero or
    /// negative.
    pub fn powf(self, power: Self) -> Self {
        let value = self.value.cr_powf(power.value);
        let low = (self.value - self.bound).next_down();
        if low <= 0.0 {
            return Self { value, bound: f64::INFINITY };
        }
        // x^p is monotone in x and in p: its extremes on the rectangle of both bounds are at the corners.
        let bases = if self.bound == 0.0 {
            [self.value; 2]
        } else {
            [low, (self.value + self.bound).next_up()]
        };
        let exponents = if power.bound == 0.0 {
            [power.value; 2]
        } else {
            [(power.value - power.bound).next_down(), (power.value + power.bound).next_up()]
        };
        let corners = bases.iter().flat_map(|x| exponents.map(|p| x.cr_powf(p)));
        Self::from_extremes(value, corners)
    }

    /// A correctly rounded function that is monotone on the interval of possible arguments.
    fn apply_monotone(self, function: impl Fn(f64) -> f64) -> Self {
        let value = function(self.value);
        if self.bound == 0.0 {
            let exact = value == 0.0 && self.value == 0.0;
            return if exact { Self::ZERO } else { Self::with_rounding_error(value, 0.0) };
        }
        let ends = [(self.value - self.bound).next_down(), (self.value + self.bound).next_up()];
        Self::from_extremes(value, ends.map(function))
    }

    /// A correctly rounded value whose exact number lies between the extremes of `ends`, which are correctly rounded.
    fn from_extremes(value: f64, ends: impl IntoIterator<Item = f64>) -> Self {
        let spread = ends
            .into_iter()
            .map(|end| (end - value).abs() + 2.0 * UNIT_ROUNDOFF * end.abs())
            .fold(0.0, f64::max);
        Self::with_rounding_error(value, spread)
    }

    #[inline]
    fn with_rounding_error(value: f64, bound: f64) -> Self {
        Self {
            value,
            bound: (bound + UNIT_ROUNDOFF * value.abs()) * BOUND_INFLATION + MIN_SUBNORMAL,
        }
    }
}

impl From<f64> for Rounded {
    fn from(value: f64) -> Self {
        Self::from_rounded(value)
    }
}

impl Add for Rounded {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        if self.is_structural_zero() {
            return other;
        }
        if other.is_structural_zero() {
            return self;
        }
        Self::with_rounding_error(self.value + other.value, self.bound + other.bound)
    }
}

impl Sub for Rounded {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Rounded {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, bound: self.bound }
    }
}

impl Mul for Rounded {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_structural_zero() || other.is_structural_zero() {
            return Self::ZERO;
        }
        Self::with_rounding_error(
            self.value * other.value,
            self.value.abs() * other.bound
                + other.value.abs() * self.bound
                + self.bound * other.bound,
        )
    }
}

/// The bound of a quotient is infinite if the divisor may be zero within its bound.
impl Div for Rounded {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let min_divisor = other.value.abs() - other.bound;
        if min_divisor > 0.0 {
            if self.is_structural_zero() {
                return Self::ZERO;
            }
            Self::with_rounding_error(value, (self.bound + value.abs() * other.bound) / min_divisor)
        } else {
            Self { value, bound: f64::INFINITY }
        }
    }
}

/// Product with an exact factor, such as the literal 2 of `2 sin φ`.
impl Mul<Rounded> for f64 {
    type Output = Rounded;
    #[inline]
    fn mul(self, other: Rounded) -> Rounded {
        Rounded::from_exact(self) * other
    }
}

impl AddAssign for Rounded {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_of_a_right_angle_has_no_certain_sign() {
        let right_angle = 2.0 * Rounded::from_angle(std::f64::consts::FRAC_PI_4);
        assert_eq!(right_angle.cos().sign(), None);
        assert_eq!((right_angle + Rounded::from_rounded(1e-14)).cos().sign(), Some(-1));
        assert_eq!((right_angle - Rounded::from_rounded(1e-14)).cos().sign(), Some(1));
    }

    #[test]
    fn bound_covers_a_catastrophic_cancellation() {
        // (1/3 + 2/3) − 1 − 1e-17: the exact result −1e-17 is below the resolution of doubles near 1.
        let third = Rounded::from_rounded(1.0 / 3.0);
        let cancelled = third + 2.0 * third - Rounded::ONE - Rounded::from_exact(1e-17);
        assert!((cancelled.value + 1e-17).abs() <= cancelled.bound);
        assert_eq!(cancelled.sign(), None);
    }

    #[test]
    fn structural_zeros_stay_exact() {
        let x = Rounded::from_rounded(0.1);
        assert!((Rounded::ZERO * x).is_structural_zero());
        assert_eq!(Rounded::ZERO + x, x);
        assert_eq!((x - x).sign(), None);
    }
}
