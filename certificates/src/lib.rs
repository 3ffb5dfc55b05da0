//! Certificates of verdicts that are proved for all states of a box of parameters, and their verification.
//!
//! A [`Certificate`] states what is proved and on which enclosures the proof rests. [`Certificate::verify`] shares no code with
//! the proof: it writes the deciding quantities as polynomials in the parameters of the box, in tangents of half angles and in
//! the direction, and finds their signs from Bernstein coefficients, in fractions and in intervals of 192 bits.
//! That the signs decide is a theorem, which `docs/theory.md` states for each [`Test`].

mod angle;
mod cone;
mod coverage;
mod flow;
mod interval;
mod layers;
mod numbers;
mod polynomial;
mod quantity;
mod test;
mod verification;

pub use test::Test;
pub use verification::{Verification, VerificationError};

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Version of the format of certificates; raised when a key changes its name or meaning.
pub const FORMAT_VERSION: u32 = 1;

/// Proof that a verdict holds for all states of a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Certificate {
    /// [`FORMAT_VERSION`].
    pub certificate: u32,
    /// Statement of the verdict and the method, for readers; not verified.
    pub statement: String,
    /// Test that decides the verdict.
    pub test: Test,
    /// The verdict on all states of the box.
    pub verdict: ProvedVerdict,
    /// Numbers that are constant.
    pub numbers: Vec<Number>,
    /// Numbers that run over the box, at most two.
    #[serde(rename = "box")]
    pub axes: Vec<Axis>,
    /// Parts of the box, which cover it.
    pub parts: Vec<Part>,
    /// Least of the [margins](Claim::margin) of all claims.
    pub least_margin: f64,
}

impl Certificate {
    /// What is verified, in words: test, verdict and numbers.
    pub fn describe(&self) -> String {
        let is_zero = |key: &str| self.numbers.iter().any(|own| own.key == key && own.value == 0.0);
        let verdict = match self.verdict {
            ProvedVerdict::IllPosed => "is ill-posed".to_owned(),
            ProvedVerdict::WellPosed => match self.test.lower_order_condition() {
                Some((key, premise)) if !is_zero(key) => {
                    format!("has a well-posed leading symbol{premise}")
                }
                _ => "is well-posed".to_owned(),
            },
        };
        let axes = self.axes.iter();
        let axes = axes.map(|own| {
            format!("{} from {} to {}", own.key, format_number(own.from), format_number(own.to))
        });
        let numbers = self.numbers.iter();
        let numbers = numbers.map(|own| format!("{} = {}", own.key, format_number(own.value)));
        let all: Vec<String> = axes.chain(numbers).collect();
        format!("{} {verdict} for {}", self.test.title(), all.join(", "))
    }
}

/// A number as text, in powers of ten if it is very large or small.
pub fn format_number(value: f64) -> String {
    let is_moderate = value == 0.0 || (1e-5..1e15).contains(&value.abs());
    if is_moderate { value.to_string() } else { format!("{value:e}") }
}

/// Verdict on all states of a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProvedVerdict {
    /// All are well-posed, or have a well-posed leading symbol where docs/theory.md says so.
    WellPosed,
    /// All are ill-posed.
    IllPosed,
}

/// Constant number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Number {
    /// Key in case files.
    pub key: String,
    /// Value, in the unit of the key: the shortest decimal of the double, exactly.
    pub value: f64,
}

/// Number that runs over a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// Key in case files.
    pub key: String,
    /// Least value, in the unit of the key: the shortest decimal of the double, exactly.
    pub from: f64,
    /// Largest value.
    pub to: f64,
}

/// Part of a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Part {
    /// Least and largest value of the number of each axis.
    #[serde(rename = "box")]
    pub ends: Vec<[f64; 2]>,
    /// Enclosures on which the proof rests.
    pub claims: Vec<Claim>,
}

/// Enclosure of a deciding quantity over a part of a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Name of the quantity.
    pub quantity: Cow<'static, str>,
    /// Directions for which the claim holds; `None` of a quantity without direction.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub directions: Option<Directions>,
    /// Lower and upper bound on all values.
    pub range: [f64; 2],
}

impl Claim {
    /// Distance of the enclosure from zero by its largest magnitude, from 0 to 1; zero if it contains zero.
    pub fn margin(&self) -> f64 {
        let [low, high] = self.range;
        let nearest = if low > 0.0 { low } else { (-high).max(0.0) };
        if nearest > 0.0 { nearest / low.abs().max(high.abs()) } else { 0.0 }
    }
}

/// Directions of a claim.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Directions {
    /// One direction: components of the wave normal along and across the normal of layers, or squares of its components along
    /// the principal axes. Of any length.
    One(Vec<f64>),
    /// The wave normals (1, s) with s from the first to the second number.
    AlongNormal([f64; 2]),
    /// The wave normals (s, 1).
    AlongLayers([f64; 2]),
}
