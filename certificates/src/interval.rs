//! Rational numbers and intervals of numbers.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

/// Significant bits of the ends of intervals.
const PRECISION: u64 = 192;

/// Number of terms of series of sine and cosine; the rest is below 10⁻⁷⁰ for arguments up to π.
const TERM_COUNT: u32 = 40;

/// A rational number, or all numbers between two ends. Operations on rational numbers are exact; the ends of intervals are
/// rounded outward to [`PRECISION`] bits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Interval {
    /// One number.
    Exact(BigRational),
    /// From `low` 2ᵉ to `high` 2ᵉ with e = `exponent`.
    Between { low: BigInt, high: BigInt, exponent: i64 },
}

use Interval::{Between, Exact};

impl Interval {
    pub(crate) fn whole(value: i64) -> Self {
        Exact(BigRational::from_integer(value.into()))
    }

    pub(crate) fn zero() -> Self {
        Self::whole(0)
    }

    /// All numbers from `low` to `high`.
    pub(crate) fn new(low: BigRational, high: BigRational) -> Self {
        if low == high {
            return Exact(low);
        }
        let magnitude = bits(low.numer()).max(bits(high.numer()));
        let size = bits(low.denom()).max(bits(high.denom()));
        let exponent = magnitude - size - PRECISION as i64;
        let scaled = |own: &BigRational| own / power_of_two(exponent);
        Between {
            low: scaled(&low).floor().to_integer(),
            high: scaled(&high).ceil().to_integer(),
            exponent,
        }
        .round()
    }

    /// The ends.
    pub(crate) fn ends(&self) -> [BigRational; 2] {
        match self {
            Exact(value) => [value.clone(), value.clone()],
            Between { low, high, exponent } => {
                let scale = power_of_two(*exponent);
                [low, high].map(|own| BigRational::from_integer(own.clone()) * &scale)
            }
        }
    }

    pub(crate) fn is_zero(&self) -> bool {
        matches!(self, Exact(value) if value.is_zero())
    }

    pub(crate) fn is_positive(&self) -> bool {
        match self {
            Exact(value) => value.is_positive(),
            Between { low, .. } => low.is_positive(),
        }
    }

    /// The lower end as a double, rounded somehow.
    pub(crate) fn approximate(&self) -> f64 {
        match self {
            Exact(value) => value.to_f64().unwrap_or(f64::NAN),
            Between { low, exponent, .. } => {
                let (excess, short) = match bits(low) - 64 {
                    excess @ 1.. => (excess, low >> excess as usize),
                    _ => (0, low.clone()),
                };
                let power = (exponent + excess).clamp(-2000, 2000) as i32;
                short.to_f64().unwrap_or(f64::NAN) * 2f64.powi(power)
            }
        }
    }

    /// As an interval even if it is one number.
    fn spread(&self) -> (BigInt, BigInt, i64) {
        match self {
            Between { low, high, exponent } => (low.clone(), high.clone(), *exponent),
            Exact(value) => {
                let exponent = bits(value.numer()) - bits(value.denom()) - PRECISION as i64;
                let scaled = value / power_of_two(exponent);
                (scaled.floor().to_integer(), scaled.ceil().to_integer(), exponent)
            }
        }
    }

    /// An interval of [`PRECISION`] bits with this number, if it is one number and not zero.
    pub(crate) fn widen(&self) -> Self {
        if self.is_zero() {
            return Self::zero();
        }
        let (low, high, exponent) = self.spread();
        Between { low, high, exponent }.round()
    }

    /// Rounds the ends outward.
    fn round(self) -> Self {
        let Between { low, high, exponent } = self else { return self };
        let excess = low.bits().max(high.bits()).saturating_sub(PRECISION);
        if excess == 0 {
            return Between { low, high, exponent };
        }
        // A shift to the right rounds down.
        let high = -(-high >> excess as usize);
        Between { low: low >> excess as usize, high, exponent: exponent + excess as i64 }
    }

    /// Half of it.
    pub(crate) fn halve(self) -> Self {
        match self {
            Exact(value) => Exact(value / BigRational::from_integer(2.into())),
            Between { low, high, exponent } => Between { low, high, exponent: exponent - 1 },
        }
    }

    /// The square root; `None` of an interval with negative numbers.
    pub(crate) fn sqrt(&self) -> Option<Self> {
        let (mut low, mut high, mut exponent) = self.spread();
        if low.is_negative() {
            return None;
        }
        // √(m 2ᵉ) = √(m 2²ᵏ) 2^(e/2 − k) for even e.
        let shift = PRECISION + u64::from(exponent.is_odd());
        low <<= shift as usize;
        high <<= shift as usize;
        exponent -= shift as i64;
        Some(Between { low: low.sqrt(), high: high.sqrt() + 1, exponent: exponent / 2 }.round())
    }

    /// The square, without negative numbers.
    pub(crate) fn square(&self) -> Self {
        match self * self {
            Between { low, high, exponent } => {
                Between { low: low.max(BigInt::zero()), high, exponent }
            }
            exact => exact,
        }
    }

    /// Tangent of half an angle in degrees between −180° and 180°, both not included; `None` of another.
    pub(crate) fn half_tangent(degrees: &BigRational) -> Option<Self> {
        if degrees.abs() >= BigRational::from_integer(180.into()) {
            return None;
        }
        let half = &(&Exact(degrees.clone()) * pi()) / &Self::whole(360);
        let [sine, cosine] = sine_and_cosine(&half);
        Some(&sine / &cosine)
    }
}

fn bits(own: &BigInt) -> i64 {
    own.bits() as i64
}

fn power_of_two(exponent: i64) -> BigRational {
    let power = BigRational::from_integer(BigInt::one() << exponent.unsigned_abs() as usize);
    if exponent < 0 { power.recip() } else { power }
}

/// π by the formula of Machin, 16 arctan(1/5) − 4 arctan(1/239).
pub(crate) fn pi() -> &'static Interval {
    static VALUE: OnceLock<Interval> = OnceLock::new();
    // Alternating series: the rest is smaller than the last term, 5⁻¹⁷⁹/179.
    let arctangent = |inverse: i64| {
        let square = Interval::whole(inverse * inverse);
        let mut power = &rest() + &Exact(BigRational::new(1.into(), inverse.into()));
        let mut sum = Interval::zero();
        for k in 0..90_i64 {
            let term = &power / &Interval::whole(2 * k + 1);
            sum = if k % 2 == 0 { &sum + &term } else { &sum - &term };
            power = &power / &square;
        }
        &sum + &rest()
    };
    VALUE.get_or_init(|| {
        &(&Interval::whole(16) * &arctangent(5)) - &(&Interval::whole(4) * &arctangent(239))
    })
}

/// Bound on the rest of a series, 10⁻⁷⁰.
fn rest() -> Interval {
    let rest = BigRational::new(1.into(), BigInt::from(10).pow(70));
    Interval::new(-rest.clone(), rest)
}

/// Sine and cosine of an interval within [−π, π], by their series.
fn sine_and_cosine(x: &Interval) -> [Interval; 2] {
    let square = x * x;
    [1, 0].map(|first| {
        let mut term = if first == 1 { x.clone() } else { Interval::whole(1) };
        let mut sum = term.clone();
        for k in 1..TERM_COUNT {
            let order = i64::from(2 * k) + first;
            term = -&(&(&term * &square) / &Interval::whole(order * (order - 1)));
            sum = &sum + &term;
        }
        &sum + &rest()
    })
}

impl Add for &Interval {
    type Output = Interval;
    fn add(self, other: Self) -> Interval {
        if let (Exact(a), Exact(b)) = (self, other) {
            return Exact(a + b);
        }
        if self.is_zero() {
            return other.clone();
        }
        if other.is_zero() {
            return self.clone();
        }
        let (a, b) = (self.spread(), other.spread());
        let exponent = a.2.min(b.2);
        let [a, b] = [a, b].map(|(low, high, own)| {
            let shift = (own - exponent) as usize;
            (low << shift, high << shift)
        });
        Between { low: a.0 + b.0, high: a.1 + b.1, exponent }.round()
    }
}

impl Sub for &Interval {
    type Output = Interval;
    fn sub(self, other: Self) -> Interval {
        self + &-other
    }
}

impl Neg for &Interval {
    type Output = Interval;
    fn neg(self) -> Interval {
        match self {
            Exact(value) => Exact(-value),
            Between { low, high, exponent } => {
                Between { low: -high, high: -low, exponent: *exponent }
            }
        }
    }
}

impl Mul for &Interval {
    type Output = Interval;
    fn mul(self, other: Self) -> Interval {
        if let (Exact(a), Exact(b)) = (self, other) {
            return Exact(a * b);
        }
        if self.is_zero() || other.is_zero() {
            return Interval::zero();
        }
        let (a, b) = (self.spread(), other.spread());
        let products = [&a.0 * &b.0, &a.0 * &b.1, &a.1 * &b.0, &a.1 * &b.1];
        let [first, rest @ ..] = &products;
        let low = rest.iter().fold(first, |least, own| least.min(own)).clone();
        let high = rest.iter().fold(first, |most, own| most.max(own)).clone();
        Between { low, high, exponent: a.2 + b.2 }.round()
    }
}

/// # Panics
/// The divisor contains zero.
impl Div for &Interval {
    type Output = Interval;
    fn div(self, other: Self) -> Interval {
        if let (Exact(a), Exact(b)) = (self, other) {
            return Exact(a / b);
        }
        let inverse = match other {
            Exact(value) => Exact(value.recip()),
            Between { low, high, exponent } => {
                assert!(low.is_positive() || high.is_negative(), "division by zero");
                let shift = 2 * PRECISION + low.bits().max(high.bits());
                let one = BigInt::one() << shift as usize;
                let (least, most) = (one.div_floor(high), one.div_ceil(low));
                Between { low: least, high: most, exponent: -exponent - shift as i64 }.round()
            }
        };
        self * &inverse
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contains(own: &Interval, value: f64) -> bool {
        // Up to the rounding of the double, of which a tangent near its pole has 180 times as much.
        let size = BigRational::from_float(value.abs() * 4e-14).expect("finite");
        let value = BigRational::from_float(value).expect("finite");
        let [low, high] = own.ends();
        low <= &value + &size && high >= &value - &size && high - low <= size
    }

    fn degrees(own: i64) -> BigRational {
        BigRational::from_integer(own.into())
    }

    #[test]
    fn functions_are_those_of_doubles() {
        assert!(contains(pi(), std::f64::consts::PI));
        for own in [-179, -90, -31, 1, 45, 60, 90, 120, 178] {
            let value = (own as f64 * std::f64::consts::PI / 360.0).tan();
            let found = Interval::half_tangent(&degrees(own)).expect("below 180°");
            assert!(contains(&found, value), "{own}: {found:?} {value}");
        }
        let root = Interval::whole(7).sqrt().expect("a positive number");
        assert!(contains(&root, 7f64.sqrt()));
        assert!(Interval::half_tangent(&degrees(180)).is_none());
    }

    /// tan 22.5° = √2 − 1 and tan 30° = 1/√3, to nearly the precision of the intervals.
    #[test]
    fn half_tangents_are_exact_to_the_precision() {
        let half = |own: i64| Interval::half_tangent(&degrees(own)).expect("below 180°");
        let one = Interval::whole(1);
        for (found, square) in [(&half(45) + &one, 2), (&one / &half(60), 3)] {
            let [low, high] = (&found * &found).ends();
            let square = degrees(square);
            assert!(low < square && high > square, "{low} {high}");
            assert!(&high - &low < power_of_two(-180), "{}", (high - low).to_f64().unwrap_or(1.0));
        }
    }

    /// Ends of operations on intervals against exact operations on their ends.
    #[test]
    fn operations_enclose_those_on_members() {
        let number = |n: i64| BigRational::new(n.into(), 7.into());
        let samples = [-9, -2, 3, 11];
        for (a, b) in samples.iter().flat_map(|&a| samples.map(|b| (a, b))) {
            let (low, high) = (number(a), number(a) + number(1));
            let (x, y) = (Interval::new(low.clone(), high.clone()), Exact(number(b)));
            let wide = Interval::new(number(b), number(b) + number(1));
            for (found, value) in [
                (&x + &y, &low + number(b)),
                (&x - &wide, &low - number(b)),
                (&x * &wide, &high * number(b)),
                (&x / &wide, &low / number(b)),
                (&y / &x, number(b) / &high),
                (x.square(), &low * &low),
            ] {
                let [least, most] = found.ends();
                assert!(least <= value && value <= most, "{a} {b}: {least} {value} {most}");
            }
        }
    }
}
