//! Number types on which formulas are evaluated: doubles, numbers with rounding bounds, dual numbers;
//! [`TaylorModel`](super::taylor_model::TaylorModel)s enclose functions over a box of parameters.

use super::elementary::Elementary;
use super::rounding::Rounded;
use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Elementary functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Function {
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Ln,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Arc sine.
    Asin,
    /// Arc cosine.
    Acos,
    /// Arc tangent.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Absolute value.
    Abs,
    /// Sign.
    Sign,
}

/// A number type of formulas.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// An exact number.
    fn from_exact(value: f64) -> Self;
    /// A number rounded from a real number, such as a decimal from a file.
    fn from_rounded(value: f64) -> Self;
    /// The value as a double.
    fn value(self) -> f64;
    /// Whether the number, its bound and its slope are finite.
    fn is_finite(self) -> bool;
    /// The certain sign: ±1, or 0 for an exact zero; `None` if undecided.
    fn sign(self) -> Option<i8>;
    /// A function of one argument; `abs` and `sign` of an argument whose sign is certain and not zero.
    fn apply(self, function: Function) -> Self;
    /// The power with any exponent.
    fn power(self, exponent: Self) -> Self;
    /// The polar angle of the point (x, y), where y is `self`.
    fn atan2(self, x: Self) -> Self;

    /// The power with the whole exponent n, by repeated squaring.
    fn whole_power(self, n: u32) -> Self {
        let (mut result, mut square, mut rest) = (None, self, n);
        while rest > 0 {
            if rest % 2 == 1 {
                result = Some(result.map_or(square, |own| own * square));
            }
            rest /= 2;
            if rest > 0 {
                square = square * square;
            }
        }
        result.unwrap_or_else(|| Self::from_exact(1.0))
    }
}

impl Scalar for f64 {
    fn from_exact(value: f64) -> Self {
        value
    }

    fn from_rounded(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn is_finite(self) -> bool {
        f64::is_finite(self)
    }

    fn sign(self) -> Option<i8> {
        Some(if self > 0.0 {
            1
        } else if self < 0.0 {
            -1
        } else {
            0
        })
    }

    fn apply(self, function: Function) -> Self {
        match function {
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.cr_exp(),
            Function::Ln => self.cr_ln(),
            Function::Sin => self.cr_sin(),
            Function::Cos => self.cr_cos(),
            Function::Tan => self.cr_tan(),
            Function::Asin => self.cr_asin(),
            Function::Acos => self.cr_acos(),
            Function::Atan => self.cr_atan(),
            Function::Sinh => self.cr_sinh(),
            Function::Cosh => self.cr_cosh(),
            Function::Tanh => self.cr_tanh(),
            Function::Abs => self.abs(),
            Function::Sign => self.signum(),
        }
    }

    fn power(self, exponent: Self) -> Self {
        self.cr_powf(exponent)
    }

    fn atan2(self, x: Self) -> Self {
        self.cr_atan2(x)
    }
}

impl Scalar for Rounded {
    fn from_exact(value: f64) -> Self {
        Rounded::from_exact(value)
    }

    fn from_rounded(value: f64) -> Self {
        Rounded::from_rounded(value)
    }

    fn value(self) -> f64 {
        self.value
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.bound.is_finite()
    }

    fn sign(self) -> Option<i8> {
        Rounded::sign(self)
    }

    fn apply(self, function: Function) -> Self {
        let is_outside = |own: Self| own.value.abs() > 1.0 + own.bound;
        match function {
            Function::Asin | Function::Acos if is_outside(self) => Self::from_exact(f64::NAN),
            Function::Sqrt => self.sqrt(),
            Function::Exp => self.exp(),
            Function::Ln => self.ln(),
            Function::Sin => self.sin(),
            Function::Cos => self.cos(),
            Function::Tan => self.tan(),
            Function::Asin => self.asin(),
            Function::Acos => self.acos(),
            Function::Atan => self.atan(),
            Function::Sinh => self.sinh(),
            Function::Cosh => self.cosh(),
            Function::Tanh => self.tanh(),
            Function::Abs => Self { value: self.value.abs(), bound: self.bound },
            Function::Sign => Rounded::from_exact(self.value.signum()),
        }
    }

    fn power(self, exponent: Self) -> Self {
        self.powf(exponent)
    }

    fn atan2(self, x: Self) -> Self {
        Rounded::atan2(self, x)
    }
}

/// A dual number: a value and its derivative by one variable (forward mode of automatic differentiation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    /// Value.
    pub value: T,
    /// Derivative.
    pub slope: T,
}

impl<T: Scalar> Add for Dual<T> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slope: self.slope + other.slope }
    }
}

impl<T: Scalar> Sub for Dual<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slope: self.slope - other.slope }
    }
}

impl<T: Scalar> Neg for Dual<T> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, slope: -self.slope }
    }
}

impl<T: Scalar> Mul for Dual<T> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let slope = self.slope * other.value + self.value * other.slope;
        Self { value: self.value * other.value, slope }
    }
}

impl<T: Scalar> Div for Dual<T> {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self { value, slope: (self.slope - value * other.slope) / other.value }
    }
}

impl<T: Scalar> Scalar for Dual<T> {
    fn from_exact(value: f64) -> Self {
        Self { value: T::from_exact(value), slope: T::from_exact(0.0) }
    }

    fn from_rounded(value: f64) -> Self {
        Self { value: T::from_rounded(value), slope: T::from_exact(0.0) }
    }

    fn value(self) -> f64 {
        self.value.value()
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.slope.is_finite()
    }

    fn sign(self) -> Option<i8> {
        self.value.sign()
    }

    fn apply(self, function: Function) -> Self {
        let (x, one) = (self.value, T::from_exact(1.0));
        let value = x.apply(function);
        let slope = match function {
            Function::Sqrt => one / (value + value),
            Function::Exp => value,
            Function::Ln => one / x,
            Function::Sin => x.apply(Function::Cos),
            Function::Cos => -x.apply(Function::Sin),
            Function::Tan => one + value * value,
            Function::Asin => one / ((one - x) * (one + x)).apply(Function::Sqrt),
            Function::Acos => -(one / ((one - x) * (one + x)).apply(Function::Sqrt)),
            Function::Atan => one / (one + x * x),
            Function::Sinh => x.apply(Function::Cosh),
            Function::Cosh => x.apply(Function::Sinh),
            Function::Tanh => one - value * value,
            Function::Abs => x.apply(Function::Sign),
            Function::Sign => T::from_exact(0.0),
        };
        Self { value, slope: slope * self.slope }
    }

    fn power(self, exponent: Self) -> Self {
        let value = self.value.power(exponent.value);
        let by_base =
            exponent.value * self.value.power(exponent.value - T::from_exact(1.0)) * self.slope;
        let by_exponent = value * self.value.apply(Function::Ln) * exponent.slope;
        Self { value, slope: by_base + by_exponent }
    }

    fn atan2(self, x: Self) -> Self {
        let square = self.value * self.value + x.value * x.value;
        let slope = (x.value * self.slope - self.value * x.slope) / square;
        Self { value: self.value.atan2(x.value), slope }
    }
}

/// The number π.
pub(crate) fn pi<T: Scalar>() -> T {
    T::from_rounded(PI)
}
