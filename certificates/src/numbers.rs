//! Numbers of a part of a box, as polynomials in its variables.

use crate::angle::Angle;
use crate::interval::Interval;
use crate::polynomial::Polynomial;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{ToPrimitive, Zero};
use std::collections::BTreeMap;
use thiserror::Error;

/// What is wrong with a certificate.
#[derive(Clone, Debug, PartialEq, Error)]
pub(crate) enum Problem {
    #[error("{0}")]
    Text(&'static str),
    #[error("{key} = {value}, expected {expected}")]
    Number { key: String, value: String, expected: &'static str },
    #[error("expected the numbers of {test}, each once, two of them at most over the box: {keys}")]
    Keys { test: &'static str, keys: String },
    #[error("there is no number {key}")]
    Missing { key: String },
    #[error("{quantity} is claimed to lie from {low:e} to {high:e}, but takes the value {value:e}")]
    Outside { quantity: String, low: f64, high: f64, value: f64 },
    #[error("{quantity} is not {expected} in all of it")]
    Unsigned { quantity: String, expected: &'static str },
    #[error("{quantity}: {cause}")]
    Claim { quantity: String, cause: &'static str },
}

impl Problem {
    pub(crate) const NO_RESPONSE: Self = Self::Text("the solid has no response, or does not yield");
    pub(crate) const UNSIGNED_STRESS: Self = Self::Text("the stress deviator may vanish");

    pub(crate) const fn new(text: &'static str) -> Self {
        Self::Text(text)
    }

    pub(crate) fn claim(quantity: &str, cause: &'static str) -> Self {
        Self::Claim { quantity: quantity.to_owned(), cause }
    }
}

/// The decimal that is printed for a double, exactly.
pub(crate) fn decimal(value: f64) -> Option<BigRational> {
    if !value.is_finite() {
        return None;
    }
    let text = format!("{value:e}");
    let (digits, exponent) = text.split_once('e')?;
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let number: BigInt = format!("{whole}{fraction}").parse().ok()?;
    let exponent = exponent.parse::<i32>().ok()? - i32::try_from(fraction.len()).ok()?;
    let power = BigRational::from_integer(BigInt::from(10).pow(exponent.unsigned_abs()));
    let number = BigRational::from_integer(number);
    Some(if exponent < 0 { number / power } else { number * power })
}

/// A double, exactly.
pub(crate) fn exact(value: f64) -> Option<BigRational> {
    BigRational::from_float(value)
}

/// Numbers of a part of a box.
#[derive(Clone)]
pub(crate) struct Numbers<'a> {
    pub(crate) constants: &'a BTreeMap<String, BigRational>,
    /// Key, least and largest value by axis.
    pub(crate) axes: Vec<(&'a str, [BigRational; 2])>,
}

impl Numbers<'_> {
    fn axis(&self, key: &str) -> Option<(usize, &[BigRational; 2])> {
        let index = self.axes.iter().position(|own| own.0 == key)?;
        Some((index, &self.axes[index].1))
    }

    /// The number, linear in the variable of its axis.
    pub(crate) fn value(&self, key: &str) -> Result<Polynomial, Problem> {
        if let Some((index, [low, high])) = self.axis(key) {
            let [low, high] = [low, high].map(|own| Interval::Exact(own.clone()));
            return Ok(Polynomial::linear(index, &low, &high));
        }
        let found = self.constants.get(key).ok_or(Problem::Missing { key: key.to_owned() })?;
        Ok(Polynomial::constant(Interval::Exact(found.clone())))
    }

    /// Interval of all values of the number.
    pub(crate) fn enclosure(&self, key: &str) -> Result<Interval, Problem> {
        match self.axis(key) {
            Some((_, [low, high])) => Ok(Interval::new(low.clone(), high.clone())),
            None => Ok(self.value(key)?.at_origin().clone()),
        }
    }

    pub(crate) fn is_zero(&self, key: &str) -> bool {
        self.axis(key).is_none() && self.constants.get(key).is_some_and(Zero::is_zero)
    }

    /// The angle given in degrees. Over the box its half tangent is the variable of its axis, between rational numbers that
    /// enclose those of its ends.
    pub(crate) fn angle(&self, key: &str) -> Result<Angle, Problem> {
        let tangent = |degrees: &BigRational| {
            Interval::half_tangent(degrees).ok_or_else(|| Problem::Number {
                key: key.to_owned(),
                value: degrees.to_f64().unwrap_or(f64::NAN).to_string(),
                expected: "an angle between -180 and 180",
            })
        };
        let t = match self.axis(key) {
            Some((index, [low, high])) => {
                let ([low, _], [_, high]) = (tangent(low)?.ends(), tangent(high)?.ends());
                Polynomial::linear(index, &Interval::Exact(low), &Interval::Exact(high))
            }
            None => {
                let found =
                    self.constants.get(key).ok_or(Problem::Missing { key: key.to_owned() })?;
                Polynomial::constant(tangent(found)?)
            }
        };
        Ok(Angle::from_half_tangent(&t))
    }

    /// The corners of the part and its middle, as numbers without a range.
    pub(crate) fn samples(&self) -> Vec<Self> {
        let at = |place: &dyn Fn(usize) -> [i64; 2]| {
            let axes = self.axes.iter().enumerate().map(|(index, (key, [low, high]))| {
                let [a, b] = place(index).map(|own| BigRational::new(own.into(), 2.into()));
                let value = low * a + high * b;
                (*key, [value.clone(), value])
            });
            Self { constants: self.constants, axes: axes.collect() }
        };
        let corners = (0..1_usize << self.axes.len())
            .map(|corner| at(&|index| if corner >> index & 1 == 0 { [2, 0] } else { [0, 2] }));
        corners.chain([at(&|_| [1, 1])]).collect()
    }

    /// The halves along each axis.
    pub(crate) fn divide(&self) -> Vec<Self> {
        let mut all = vec![self.clone()];
        for index in 0..self.axes.len() {
            let [low, high] = &self.axes[index].1;
            let middle = (low + high) / BigRational::from_integer(2.into());
            let halves = [[low.clone(), middle.clone()], [middle, high.clone()]];
            let own = all.iter().flat_map(|part| {
                halves.iter().map(|half| {
                    let mut part = part.clone();
                    part.axes[index].1 = half.clone();
                    part
                })
            });
            all = own.collect();
        }
        all
    }
}
