//! Number type of generic formulas: a scalar, or SIMD lanes of scalars.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A floating-point number or SIMD lanes of numbers; every operation except [`any_gt`](Self::any_gt) acts lane by lane.
pub trait Number:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// The number 0.
    const ZERO: Self;
    /// The number 1.
    const ONE: Self;
    /// The number ½.
    const HALF: Self;
    /// The number nearest to ⅓.
    const THIRD: Self;
    /// The number ¼.
    const QUARTER: Self;
    /// The smallest positive normal number; smaller positive numbers are subnormal.
    const MIN_POSITIVE: Self;
    /// Machine epsilon: distance from 1 to the next number.
    const EPSILON: Self;

    /// The number nearest to a double, in all lanes.
    fn from_f64(value: f64) -> Self;

    /// Maximum of two numbers, lane by lane; `other` where `self > other` is false, including NaN.
    fn max(self, other: Self) -> Self;

    /// Minimum of two numbers, lane by lane; `other` where `self < other` is false, including NaN.
    fn min(self, other: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Minmod limiter of three arguments: the argument of smallest magnitude, or zero if `one` and `other` differ in
    /// sign. `self` must be a mean of `one` and `other`, so that it has their sign where the two signs agree.
    fn minmod3(self, one: Self, other: Self) -> Self;

    /// Flushes numbers of magnitude below `limit` to zero, since subnormal arithmetic is slow; NaN is unchanged.
    fn flush_below(self, limit: Self) -> Self;

    /// Whether any lane is greater than its counterpart in `other`.
    fn any_gt(self, other: Self) -> bool;

    /// Returns `if_greater` where `self > other`, else `otherwise` (also for NaN), lane by lane.
    fn select_gt(self, other: Self, if_greater: Self, otherwise: Self) -> Self;
}

/// Correctly rounded x/3 without a division: with the rounded product q = x·⅓ both differences in (x − 2q) − q are
/// exact (Sterbenz 1974), and x/3 is at least a sixth of a unit in the last place away from a rounding boundary. Near
/// underflow the last bit may differ; −0 becomes 0, and infinite x gives NaN.
#[inline(always)]
pub fn divide_by_three<N: Number>(x: N) -> N {
    let quotient = x * N::THIRD;
    let remainder = (x - (quotient + quotient)) - quotient;
    quotient + remainder * N::THIRD
}

macro_rules! number {
    ($kind:ty) => {
        impl Number for $kind {
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const THIRD: Self = 1.0 / 3.0;
            const QUARTER: Self = 0.25;
            const MIN_POSITIVE: Self = Self::MIN_POSITIVE;
            const EPSILON: Self = Self::EPSILON;

            #[inline(always)]
            #[allow(clippy::unnecessary_cast, reason = "it is one for f32")]
            fn from_f64(value: f64) -> Self {
                value as Self
            }

            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }

            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn minmod3(self, one: Self, other: Self) -> Self {
                let smaller = |one: Self, other: Self| if one < other { one } else { other };
                let smallest = smaller(smaller(self.abs(), one.abs()), other.abs());
                let signs_differ = one.is_sign_negative() != other.is_sign_negative();
                if signs_differ { 0.0 } else { smallest.copysign(one) }
            }

            #[inline(always)]
            fn flush_below(self, limit: Self) -> Self {
                if self.abs() < limit { 0.0 } else { self }
            }

            #[inline(always)]
            fn any_gt(self, other: Self) -> bool {
                self > other
            }

            #[inline(always)]
            fn select_gt(self, other: Self, if_greater: Self, otherwise: Self) -> Self {
                if self > other { if_greater } else { otherwise }
            }
        }
    };
}

number!(f32);
number!(f64);
