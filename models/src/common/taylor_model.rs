//! Taylor models of first order: enclosures of functions of two parameters over a box.
//!
//! Interval arithmetic loses the dependence of intermediate results on each other, so the enclosure of a difference of
//! two nearly equal quantities is as wide as their sum. A Taylor model (Makino & Berz 2003, Int. J. Pure Appl. Math. 4,
//! 379–456) keeps the linear part of this dependence and is wrong by the square of the size of the box. All operations
//! are rounded to nearest; bounds on the rounding errors are added to the remainder. The functions are those of formulas in
//! general ([`Scalar`]).

use super::elementary::Elementary;
use super::rounding::{Rounded, UNIT_ROUNDOFF};
use super::scalar::{Function, Scalar};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Factor by which sums of bounds, themselves rounded to nearest, are inflated to stay upper bounds. No such sum here has
/// more than sixteen roundings.
const INFLATION: f64 = 1.0 + 32.0 * UNIT_ROUNDOFF;

/// Bounds the error of the few operations of a formula that underflow.
const UNDERFLOW: f64 = f64::from_bits(16);

/// Range of magnitudes whose third powers neither overflow nor underflow; reciprocals, roots and logarithms of other numbers
/// are not enclosed.
const SAFE_MAGNITUDES: std::ops::RangeInclusive<f64> = 1e-90..=1e90;

/// Least argument of an exponential that is enclosed, so that the result is a normal number.
const LEAST_EXPONENT: f64 = -600.0;

/// Relative widening of an enclosure of f″ whose ends are rounded a few times.
const CURVATURE_ROUNDING: f64 = 32.0 * UNIT_ROUNDOFF;

/// All functions f of (u, v) with |f(u, v) − `value` − `slopes`₀ u − `slopes`₁ v| ≤ `remainder` for −1 ≤ u, v ≤ 1. The
/// box of the two parameters is mapped linearly to that square.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TaylorModel {
    /// Value of the linear part at the centre of the box.
    pub value: f64,
    /// Changes of the linear part from the centre to the upper edges of the box.
    pub slopes: [f64; 2],
    /// Bound on the difference between function and linear part; infinite if the function may not exist in all of the
    /// box.
    pub remainder: f64,
}

impl TaylorModel {
    /// The exact zero.
    pub const ZERO: Self = Self { value: 0.0, slopes: [0.0; 2], remainder: 0.0 };

    /// The parameter of an axis (0 or 1), which runs from `low` to `high` over the box; both ends are exact.
    pub fn parameter(axis: usize, low: f64, high: f64) -> Self {
        let mut slopes = [0.0; 2];
        slopes[axis] = 0.5 * high - 0.5 * low;
        let remainder = 2.0 * UNIT_ROUNDOFF * (low.abs() + high.abs()) * INFLATION + UNDERFLOW;
        Self { value: 0.5 * low + 0.5 * high, slopes, remainder }
    }

    /// Whether the function is exactly zero.
    pub fn is_structural_zero(self) -> bool {
        self == Self::ZERO
    }

    /// Upper bound on |f − `value`| over the box.
    pub fn radius(self) -> f64 {
        (self.slopes[0].abs() + self.slopes[1].abs() + self.remainder) * INFLATION
    }

    /// Lower and upper bound on f over the box.
    pub fn range(self) -> [f64; 2] {
        let radius = self.radius();
        [(self.value - radius).next_down(), (self.value + radius).next_up()]
    }

    /// The sign in the whole box: ±1, or 0 for an exact zero; `None` if undecided.
    pub fn certain_sign(self) -> Option<i8> {
        // False if a number is not a number.
        if self.value.abs() > self.radius() {
            Some(if self.value > 0.0 { 1 } else { -1 })
        } else if self.is_structural_zero() {
            Some(0)
        } else {
            None
        }
    }

    /// No knowledge about the function.
    fn unbounded(value: f64) -> Self {
        Self { value, slopes: [0.0; 2], remainder: f64::INFINITY }
    }

    /// Any function with values in [`low`, `high`].
    fn from_range(low: f64, high: f64) -> Self {
        let radius = (0.5 * high - 0.5 * low) * INFLATION + UNDERFLOW;
        let remainder = radius + 2.0 * UNIT_ROUNDOFF * (low.abs() + high.abs());
        Self { value: 0.5 * low + 0.5 * high, slopes: [0.0; 2], remainder }
    }

    /// A function g of this one: g(c + h) = g(c) + g′(c) h + ½ g″(ξ) h² with the centre c, |h| ≤ `radius` and ξ in
    /// `range`. `value` and `slope`, g(c) and g′(c), are rounded a few times; `curvature` encloses g″ over the range up
    /// to rounding.
    fn compose(self, value: f64, slope: f64, curvature: [f64; 2]) -> Self {
        let widened = |end: f64, sign: f64| end + sign * CURVATURE_ROUNDING * end.abs();
        let low = widened(curvature[0], -1.0).min(0.0);
        let high = widened(curvature[1], 1.0).max(0.0);
        let square = 0.25 * self.radius() * self.radius();
        let shift = square * (low + high);
        let slopes = self.slopes.map(|own| slope * own);
        let rounding = 16.0
            * UNIT_ROUNDOFF
            * (value.abs() + slopes[0].abs() + slopes[1].abs() + square * (high - low));
        let remainder = slope.abs() * self.remainder + square * (high - low) + rounding;
        Self { value: value + shift, slopes, remainder: remainder * INFLATION + UNDERFLOW }
    }

    /// The reciprocal; unbounded if the function may vanish.
    fn reciprocal(self) -> Self {
        let [low, high] = self.range();
        // Also false for ends that are not numbers.
        let has_sign = low > 0.0 || high < 0.0;
        if !(has_sign && [low, high].iter().all(|own| SAFE_MAGNITUDES.contains(&own.abs()))) {
            return Self::unbounded(1.0 / self.value);
        }
        let inverse = 1.0 / self.value;
        let curvature = |x: f64| 2.0 / (x * x * x);
        self.compose(inverse, -inverse * inverse, [curvature(high), curvature(low)])
    }

    fn sqrt(self) -> Self {
        if self.is_structural_zero() {
            return Self::ZERO;
        }
        let [low, high] = self.range();
        let root = self.value.sqrt();
        if !(SAFE_MAGNITUDES.contains(&low) && SAFE_MAGNITUDES.contains(&high)) {
            return Self::unbounded(root);
        }
        let curvature = |x: f64| -0.25 / (x * x.sqrt());
        self.compose(root, 0.5 / root, [curvature(low), curvature(high)])
    }

    /// Enclosure of g″ from its value at the centre, a bound on |g‴| and bounds on g″ everywhere.
    fn curvature_near(self, at_centre: f64, third: f64, [least, most]: [f64; 2]) -> [f64; 2] {
        let change = third * self.radius() + 4.0 * UNIT_ROUNDOFF * at_centre.abs();
        // `max` and `min` prefer numbers to NaN, which `at_centre` is only if the value is.
        [(at_centre - change).max(least), (at_centre + change).min(most)]
    }

    fn sin(self) -> Self {
        if self.is_structural_zero() {
            return Self::ZERO;
        }
        let (sine, cosine) = self.value.cr_sin_cos();
        self.compose(sine, cosine, self.curvature_near(-sine, 1.0, [-1.0, 1.0]))
    }

    fn cos(self) -> Self {
        let (sine, cosine) = self.value.cr_sin_cos();
        self.compose(cosine, -sine, self.curvature_near(-cosine, 1.0, [-1.0, 1.0]))
    }

    fn tan(self) -> Self {
        let cosine = self.value.cr_cos();
        let value = self.value.cr_tan();
        // |cos x| ≥ |cos c| − |x − c|: no pole in the range.
        let has_no_pole = cosine.abs() > self.radius() * INFLATION;
        if !has_no_pole {
            return Self::unbounded(value);
        }
        // g″ = 2 tan x (1 + tan² x) rises from pole to pole.
        let curvature = |x: f64| 2.0 * x.cr_tan() * (1.0 + x.cr_tan() * x.cr_tan());
        self.compose(value, 1.0 + value * value, self.range().map(curvature))
    }

    fn asin(self) -> Self {
        let [low, high] = self.range();
        let value = self.value.cr_asin();
        if !(low > -1.0 && high < 1.0) {
            return Self::unbounded(value);
        }
        // g′² = 1/((1 − x)(1 + x)); g″ = x g′³ rises with x.
        let slope = |x: f64| 1.0 / ((1.0 - x) * (1.0 + x)).sqrt();
        let curvature = |x: f64| x * slope(x) * slope(x) * slope(x);
        self.compose(value, slope(self.value), [curvature(low), curvature(high)])
    }

    fn atan(self) -> Self {
        let slope = 1.0 / (1.0 + self.value * self.value);
        // |g″| ≤ 3√3/8, |g‴| ≤ 2.
        let curvature = self.curvature_near(-2.0 * self.value * slope * slope, 2.0, [-0.65, 0.65]);
        self.compose(self.value.cr_atan(), slope, curvature)
    }

    fn ln(self) -> Self {
        let [low, high] = self.range();
        let value = self.value.cr_ln();
        if !(SAFE_MAGNITUDES.contains(&low) && SAFE_MAGNITUDES.contains(&high)) {
            return Self::unbounded(value);
        }
        self.compose(value, 1.0 / self.value, [-1.0 / (low * low), -1.0 / (high * high)])
    }

    fn exp(self) -> Self {
        let value = self.value.cr_exp();
        let is_normal = self.range()[0] > LEAST_EXPONENT;
        if !is_normal {
            return Self::unbounded(value);
        }
        self.compose(value, value, self.range().map(Elementary::cr_exp))
    }

    fn tanh(self) -> Self {
        let value = self.value.cr_tanh();
        let slope = 1.0 / (self.value.cr_cosh() * self.value.cr_cosh());
        // |g″| ≤ 4/(3√3), |g‴| ≤ 2.
        let curvature = self.curvature_near(-2.0 * value * slope, 2.0, [-0.77, 0.77]);
        self.compose(value, slope, curvature)
    }

    /// |f|: ±f where the sign is certain, else only bounds.
    fn abs(self) -> Self {
        match self.certain_sign() {
            Some(0) => Self::ZERO,
            Some(1) => self,
            Some(_) => -self,
            None => {
                let [low, high] = self.range();
                match low < 0.0 && high > 0.0 && self.is_finite() {
                    true => Self::from_range(0.0, high.max(-low)),
                    false => Self::unbounded(self.value.abs()),
                }
            }
        }
    }
}

/// A constant function.
impl From<Rounded> for TaylorModel {
    fn from(own: Rounded) -> Self {
        Self { value: own.value, slopes: [0.0; 2], remainder: own.bound }
    }
}

impl Add for TaylorModel {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        if self.is_structural_zero() {
            return other;
        }
        if other.is_structural_zero() {
            return self;
        }
        let value = self.value + other.value;
        let slopes = [self.slopes[0] + other.slopes[0], self.slopes[1] + other.slopes[1]];
        let rounding = UNIT_ROUNDOFF * (value.abs() + slopes[0].abs() + slopes[1].abs());
        Self { value, slopes, remainder: (self.remainder + other.remainder + rounding) * INFLATION }
    }
}

impl Neg for TaylorModel {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: self.slopes.map(|own| -own), ..self }
    }
}

impl Sub for TaylorModel {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for TaylorModel {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        if self.is_structural_zero() || other.is_structural_zero() {
            return Self::ZERO;
        }
        let ([a0, a1], [b0, b1]) = (self.slopes, other.slopes);
        // u² and v² lie in [0, 1]: half of their coefficients is added to the value and bounds the rest. |uv| ≤ 1.
        let squares = [0.5 * (a0 * b0), 0.5 * (a1 * b1)];
        let mixed = [a0 * b1, a1 * b0];
        let product = self.value * other.value;
        let value = product + (squares[0] + squares[1]);
        let parts = [self.value * b0, self.value * b1, other.value * a0, other.value * a1];
        let slopes = [parts[0] + parts[2], parts[1] + parts[3]];
        let sizes = parts.iter().chain(&squares).chain(&mixed).map(|own| own.abs()).sum::<f64>();
        let rounding = 4.0 * UNIT_ROUNDOFF * (product.abs() + sizes);
        let quadratic = squares[0].abs() + squares[1].abs() + (mixed[0] + mixed[1]).abs();
        let remainder = self.remainder * (other.value.abs() + other.radius())
            + other.remainder * (self.value.abs() + a0.abs() + a1.abs());
        Self {
            value,
            slopes,
            remainder: (remainder + quadratic + rounding) * INFLATION + UNDERFLOW,
        }
    }
}

/// The quotient is unbounded if the divisor may vanish in the box.
impl Div for TaylorModel {
    type Output = Self;
    #[inline]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "by the reciprocal")]
    fn div(self, other: Self) -> Self {
        self * other.reciprocal()
    }
}

impl Scalar for TaylorModel {
    fn from_exact(value: f64) -> Self {
        Self { value, ..Self::ZERO }
    }

    fn from_rounded(value: f64) -> Self {
        let remainder = UNIT_ROUNDOFF * value.abs() * INFLATION + UNDERFLOW;
        Self { value, remainder, ..Self::ZERO }
    }

    fn value(self) -> f64 {
        self.value
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.radius().is_finite()
    }

    fn sign(self) -> Option<i8> {
        self.certain_sign()
    }

    fn apply(self, function: Function) -> Self {
        let one = Self::from_exact(1.0);
        match function {
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => Self::from_rounded(FRAC_PI_2) - self.asin(),
            Function::Atan => self.atan(),
            Function::Sinh => {
                let exponential = self.exp();
                Self::from_exact(0.5) * (exponential - one / exponential)
            }
            Function::Cosh => {
                let exponential = self.exp();
                Self::from_exact(0.5) * (exponential + one / exponential)
            }
            Function::Tanh => self.tanh(),
            Function::Abs => self.abs(),
            Function::Sign => match self.certain_sign() {
                Some(sign) => Self::from_exact(f64::from(sign)),
                None => Self { remainder: 1.0, ..Self::ZERO },
            },
        }
    }

    fn power(self, exponent: Self) -> Self {
        (exponent * self.ln()).exp()
    }

    fn atan2(self, x: Self) -> Self {
        // By the quotient that is smaller in magnitude, if both divisors have a sign.
        let is_steep = self.value.abs() > x.value.abs();
        match (self.sign(), x.sign()) {
            (Some(0) | None, Some(1)) => (self / x).atan(),
            (_, Some(1)) if !is_steep => (self / x).atan(),
            (Some(1), _) => Self::from_rounded(FRAC_PI_2) - (x / self).atan(),
            (Some(-1), _) => -Self::from_rounded(FRAC_PI_2) - (x / self).atan(),
            (Some(0), Some(-1)) => Self::from_rounded(PI),
            (_, Some(-1)) => Self::from_range(-PI.next_up(), PI.next_up()),
            _ => Self::unbounded(self.value.cr_atan2(x.value)),
        }
    }
}
