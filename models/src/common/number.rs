//! Numbers that formulas are written over: one, or several side by side in the registers of a processor.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or several in lanes that do not see each other: every operation is that of the lanes.
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
    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// ½.
    const HALF: Self;
    /// ⅓.
    const THIRD: Self;
    /// ¼.
    const QUARTER: Self;
    /// The least normal number.
    const MIN_POSITIVE: Self;
    /// From 1 to the next number.
    const EPSILON: Self;

    /// The nearest number to a constant.
    fn from_f64(value: f64) -> Self;

    /// The greater of two numbers.
    fn max(self, other: Self) -> Self;

    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    /// √x.
    fn sqrt(self) -> Self;

    /// Of this and two bounds the one nearest to zero, or zero where they have different signs. This is a mean
    /// of some kind: where the bounds have one sign it has no other.
    fn minmod3(self, one: Self, other: Self) -> Self;

    /// The number, or zero where it is smaller in size than a limit; what is no number stays.
    fn flush_below(self, limit: Self) -> Self;

    /// Whether any is greater than its counterpart.
    fn any_gt(self, other: Self) -> bool;
}

/// x/3 to the nearest number, as a division by 3 rounds it, without one: with q = x·⅓, 3q is so close to x that both
/// differences of (x − 2q) − q are exact (Sterbenz 1974), and x/3 is a sixth of a unit in the last place or more from
/// where rounding changes. Next to underflow the last place may be another one; −0 becomes 0.
#[inline(always)]
pub fn third<N: Number>(x: N) -> N {
    let quotient = x * N::THIRD;
    let rest = (x - (quotient + quotient)) - quotient;
    quotient + rest * N::THIRD
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
            fn sqrt(self) -> Self {
                self.sqrt()
            }

            #[inline(always)]
            fn minmod3(self, one: Self, other: Self) -> Self {
                let smaller = |one: Self, other: Self| if one < other { one } else { other };
                let least = smaller(smaller(self.abs(), one.abs()), other.abs());
                let differ = one.is_sign_negative() != other.is_sign_negative();
                if differ { 0.0 } else { least.copysign(one) }
            }

            #[inline(always)]
            fn flush_below(self, limit: Self) -> Self {
                if self.abs() < limit { 0.0 } else { self }
            }

            #[inline(always)]
            fn any_gt(self, other: Self) -> bool {
                self > other
            }
        }
    };
}

number!(f32);
number!(f64);
