//! Verification of a certificate.

use crate::cone::Form;
use crate::coverage::{covers, covers_interval};
use crate::flow;
use crate::format_number;
use crate::interval::Interval;
use crate::layers::{Invariants, QUANTITIES};
use crate::numbers::{Numbers, Problem, decimal, exact};
use crate::polynomial::DIRECTION;
use crate::quantity::Quantity;
use crate::test::Test;
use crate::{Axis, Certificate, Claim, Directions, FORMAT_VERSION, Number, Part, ProvedVerdict};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use std::collections::BTreeMap;
use thiserror::Error;

/// Largest number of halvings of a part along each axis over which the direction of stress varies.
const MAX_HALVINGS: u32 = 6;

/// Largest number of parts: five halvings along two axes.
const MAX_PART_COUNT: usize = 1 << 10;

/// Largest number of claims on a part.
const MAX_CLAIM_COUNT: usize = 1 << 10;

/// Fault of a claim with directions.
const FOR_ALL_DIRECTIONS: &str = "it holds for all directions";

/// Name of the form of [`Test::YieldCone`].
const FORM: &str = "xᵀAx";

/// What has been verified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Verification {
    /// Number of parts of the box.
    pub part_count: usize,
}

/// Reason why a certificate proves nothing.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{}{problem}", .part.map(|index| format!("part {}: ", index + 1)).unwrap_or_default())]
pub struct VerificationError {
    /// Index of the part of the box; `None` of the whole certificate.
    pub part: Option<usize>,
    /// What is wrong.
    problem: Problem,
}

impl Certificate {
    /// Verifies that the certificate proves its verdict: its parts cover the box, the deciding quantities have the claimed
    /// signs in all of each part, and no claimed range leaves out a value at a corner or the middle of its part.
    ///
    /// # Errors
    /// The first of these that does not hold.
    pub fn verify(&self) -> Result<Verification, VerificationError> {
        let whole = |problem: Problem| VerificationError { part: None, problem };
        if self.certificate != FORMAT_VERSION {
            return Err(whole(Problem::Number {
                key: "certificate".to_owned(),
                value: self.certificate.to_string(),
                expected: "1, the format that this program reads",
            }));
        }
        let is_large = |part: &Part| part.claims.len() > MAX_CLAIM_COUNT;
        if self.parts.len() > MAX_PART_COUNT || self.parts.iter().any(is_large) {
            return Err(whole(Problem::Text("more than 1024 parts, or claims on a part")));
        }
        let constants = self.read_constants().map_err(whole)?;
        let axes = self.read_axes().map_err(whole)?;
        self.check_numbers(&constants, &axes).map_err(whole)?;
        let parts: Vec<Vec<[BigRational; 2]>> =
            self.parts.iter().map(read_ends).collect::<Result<_, _>>().map_err(whole)?;
        if !covers(&axes, &parts) {
            return Err(whole(Problem::Text("the parts do not cover the box, or overlap")));
        }
        let claims = || self.parts.iter().flat_map(|part| &part.claims);
        let least = claims().map(Claim::margin).fold(f64::INFINITY, f64::min);
        if self.least_margin != least {
            return Err(whole(Problem::Number {
                key: "least_margin".to_owned(),
                value: self.least_margin.to_string(),
                expected: "the least margin of the claims",
            }));
        }
        for (index, (part, ends)) in self.parts.iter().zip(parts).enumerate() {
            let axes = self.axes.iter().map(|own| own.key.as_str()).zip(ends).collect();
            let numbers = Numbers { constants: &constants, axes };
            self.verify_part(part, &numbers)
                .map_err(|problem| VerificationError { part: Some(index), problem })?;
        }
        Ok(Verification { part_count: self.parts.len() })
    }

    fn read_constants(&self) -> Result<BTreeMap<String, BigRational>, Problem> {
        let read = |own: &Number| {
            let number = decimal(own.value).ok_or_else(|| Problem::Number {
                key: own.key.clone(),
                value: own.value.to_string(),
                expected: "a finite number",
            })?;
            Ok((own.key.clone(), number))
        };
        self.numbers.iter().map(read).collect()
    }

    fn read_axes(&self) -> Result<Vec<[BigRational; 2]>, Problem> {
        let read = |own: &Axis| match [own.from, own.to].map(decimal) {
            [Some(low), Some(high)] if low < high => Ok([low, high]),
            _ => Err(Problem::Number {
                key: own.key.clone(),
                value: format!("{} to {}", format_number(own.from), format_number(own.to)),
                expected: "two finite numbers, the least first",
            }),
        };
        self.axes.iter().map(read).collect()
    }

    /// Checks that each number of the test is given once, and no other, and that the model takes them.
    fn check_numbers(
        &self,
        constants: &BTreeMap<String, BigRational>,
        axes: &[[BigRational; 2]],
    ) -> Result<(), Problem> {
        let names = || {
            let constants = self.numbers.iter().map(|own| own.key.as_str());
            constants.chain(self.axes.iter().map(|own| own.key.as_str()))
        };
        let keys = self.test.keys();
        let count = |key: &str| names().filter(|own| *own == key).count();
        if self.axes.len() > 2
            || names().count() != keys.len()
            || keys.iter().any(|own| count(own) != 1)
        {
            return Err(Problem::Keys { test: self.test.title(), keys: keys.join(", ") });
        }
        let ends = |key: &&str| -> Option<[BigRational; 2]> {
            match self.axes.iter().position(|own| own.key == **key) {
                Some(index) => Some(axes[index].clone()),
                None => constants.get(*key).map(|own| [own.clone(), own.clone()]),
            }
        };
        let ends: Option<Vec<[BigRational; 2]>> = keys.iter().map(ends).collect();
        self.test.check_ranges(&ends.unwrap_or_default()).map_err(Problem::Text)?;
        let is_never = matches!(self.test, Test::DoubleShearing | Test::PlasticPotential);
        match is_never && self.verdict == ProvedVerdict::WellPosed {
            true => Err(Problem::Text("this model is well-posed nowhere")),
            false => Ok(()),
        }
    }

    fn verify_part(&self, part: &Part, numbers: &Numbers) -> Result<(), Problem> {
        if part.claims.is_empty() {
            return Err(Problem::Text("nothing is claimed"));
        }
        match self.test {
            Test::HarrisGrekova | Test::DoubleShearing | Test::PlasticPotential => {
                self.verify_flow(part, numbers)
            }
            Test::SlippingLayersPositive => self.verify_layers(part, numbers, true),
            Test::SlippingLayersNegative => self.verify_layers(part, numbers, false),
            Test::YieldCone => self.verify_cone(part, numbers),
        }
    }

    /// Checks that a quantity has the sign that the verdict asks for.
    fn check_sign(&self, name: &str, quantity: &Quantity) -> Result<(), Problem> {
        let (has_sign, expected) = match self.verdict {
            ProvedVerdict::WellPosed => (quantity.is_positive(), "positive"),
            ProvedVerdict::IllPosed => (quantity.is_negative(), "negative"),
        };
        match has_sign {
            true => Ok(()),
            false => Err(Problem::Unsigned { quantity: name.to_owned(), expected }),
        }
    }

    /// Checks that the claims name each of these quantities if all must be positive, and else none but these.
    fn check_names(&self, part: &Part, names: &[&str]) -> Result<(), Problem> {
        let is_claimed = |name: &&str| part.claims.iter().any(|own| own.quantity == *name);
        if let Some(own) = part.claims.iter().find(|own| !names.contains(&own.quantity.as_ref())) {
            return Err(Problem::claim(&own.quantity, "unknown quantity"));
        }
        match names.iter().find(|name| !is_claimed(name)) {
            Some(name) if self.verdict == ProvedVerdict::WellPosed => {
                Err(Problem::claim(name, "nothing is claimed of it"))
            }
            _ => Ok(()),
        }
    }

    fn verify_flow(&self, part: &Part, numbers: &Numbers) -> Result<(), Problem> {
        let all = flow::conditions(self.test, numbers)?;
        let names: Vec<&str> = all.iter().map(|own| own.0).collect();
        self.check_names(part, &names)?;
        let samples = numbers.samples();
        let samples: Vec<_> = samples
            .iter()
            .map(|own| flow::conditions(self.test, own))
            .collect::<Result<_, Problem>>()?;
        for claim in &part.claims {
            if claim.directions.is_some() {
                return Err(Problem::claim(&claim.quantity, FOR_ALL_DIRECTIONS));
            }
            let index = names.iter().position(|own| *own == claim.quantity).unwrap_or(0);
            self.check_sign(&claim.quantity, &all[index].1)?;
            for sample in &samples {
                check_range(claim, sample[index].1.at_origin())?;
            }
        }
        Ok(())
    }

    fn verify_layers(
        &self,
        part: &Part,
        numbers: &Numbers,
        is_positive: bool,
    ) -> Result<(), Problem> {
        self.check_names(part, &QUANTITIES)?;
        let (one, samples) = (Interval::whole(1), numbers.samples());
        // By the wave normals (1, s) and (s, 1).
        let charts = |numbers: &Numbers| {
            Ok([
                Invariants::new(numbers, is_positive, Some(&one))?,
                Invariants::new(numbers, is_positive, None)?,
            ])
        };
        let over_box = charts(numbers)?;
        if !over_box[0].stiffness.is_positive() {
            return Err(Problem::NO_RESPONSE);
        }
        let at_samples: Vec<[Invariants; 2]> =
            samples.iter().map(charts).collect::<Result<_, Problem>>()?;
        let mut covered: [[Vec<[BigRational; 2]>; 2]; 3] = Default::default();
        for claim in &part.claims {
            let name = claim.quantity.as_ref();
            let index = QUANTITIES.iter().position(|own| *own == name).unwrap_or(0);
            let (chart, ends) = match (&claim.directions, self.verdict) {
                (Some(Directions::AlongNormal(ends)), ProvedVerdict::WellPosed) => (0, *ends),
                (Some(Directions::AlongLayers(ends)), ProvedVerdict::WellPosed) => (1, *ends),
                (Some(Directions::One(own)), ProvedVerdict::IllPosed) if own.len() == 2 => {
                    self.verify_direction(claim, index, own, (numbers, &samples), is_positive)?;
                    continue;
                }
                _ => return Err(Problem::claim(name, "directions do not suit the verdict")),
            };
            let [Some(low), Some(high)] = ends.map(exact) else {
                return Err(Problem::claim(name, "directions are no numbers"));
            };
            covered[index][chart].push([low.clone(), high.clone()]);
            let [low, high] = [low, high].map(Interval::Exact);
            let own = over_box[chart].forms[index].restrict(DIRECTION, &low, &high);
            self.check_sign(name, &own)?;
            for sample in &at_samples {
                for end in [&low, &high] {
                    let own = sample[chart].forms[index].restrict(DIRECTION, end, end);
                    check_range(claim, own.at_origin())?;
                }
            }
        }
        if self.verdict == ProvedVerdict::WellPosed {
            let all = [-1, 1].map(|own| BigRational::from_integer(own.into()));
            for (name, charts) in QUANTITIES.iter().zip(covered) {
                if !charts.into_iter().all(|own| covers_interval(&all, own)) {
                    return Err(Problem::claim(name, "its directions are not all covered"));
                }
            }
        }
        Ok(())
    }

    /// Verifies a claim on one wave normal.
    fn verify_direction(
        &self,
        claim: &Claim,
        index: usize,
        direction: &[f64],
        (numbers, samples): (&Numbers, &[Numbers]),
        is_positive: bool,
    ) -> Result<(), Problem> {
        let [Some(n), Some(t)] = [exact(direction[0]), exact(direction[1])] else {
            return Err(Problem::claim(&claim.quantity, "directions are no numbers"));
        };
        let [n, t] = [n, t].map(Interval::Exact);
        let value = |numbers: &Numbers| {
            let all = Invariants::new(numbers, is_positive, Some(&n))?;
            Ok(all.forms[index].restrict(DIRECTION, &t, &t))
        };
        self.check_sign(&claim.quantity, &value(numbers)?)?;
        samples.iter().try_for_each(|own| check_range(claim, value(own)?.at_origin()))
    }

    fn verify_cone(&self, part: &Part, numbers: &Numbers) -> Result<(), Problem> {
        let samples =
            numbers.samples().iter().map(Form::new).collect::<Result<Vec<_>, Problem>>()?;
        let point = match (self.verdict, &part.claims[..]) {
            (ProvedVerdict::WellPosed, claims) => {
                for sample in &samples {
                    let all = sample.copositivity().ok_or(Problem::Unsigned {
                        quantity: FORM.to_owned(),
                        expected: "positive",
                    })?;
                    self.check_names(part, &all.each_ref().map(|own| own.0))?;
                    for claim in claims {
                        if claim.directions.is_some() {
                            return Err(Problem::claim(&claim.quantity, FOR_ALL_DIRECTIONS));
                        }
                        let own = all.iter().find(|own| own.0 == claim.quantity);
                        check_range(claim, own.map(|own| own.1.clone()))?;
                    }
                }
                None
            }
            (ProvedVerdict::IllPosed, [claim]) => {
                self.check_names(part, &[FORM])?;
                let cause = "expected one point with squares of components, not negative";
                let Some(Directions::One(own)) = &claim.directions else {
                    return Err(Problem::claim(FORM, cause));
                };
                let point: Option<Vec<BigRational>> = own.iter().map(|&x| exact(x)).collect();
                let point: Option<[BigRational; 3]> = point.and_then(|own| own.try_into().ok());
                let is_valid = |own: &[BigRational; 3]| {
                    own.iter().all(|x| !x.is_negative()) && own.iter().any(|x| x.is_positive())
                };
                let point = point.filter(is_valid).ok_or(Problem::claim(FORM, cause))?;
                for sample in &samples {
                    check_range(claim, sample.at(&point).at_origin())?;
                }
                Some(point)
            }
            _ => return Err(Problem::claim(FORM, "expected one claim")),
        };
        self.verify_form(numbers, point.as_ref(), MAX_HALVINGS)
    }

    /// Verifies the sign of the form, and what it presumes, over a part, which is divided if the direction of stress varies in
    /// it.
    fn verify_form(
        &self,
        numbers: &Numbers,
        point: Option<&[BigRational; 3]>,
        halvings: u32,
    ) -> Result<(), Problem> {
        let check = || {
            let form = Form::new(numbers)?;
            if !form.premises.iter().all(Quantity::is_positive) {
                return Err(Problem::NO_RESPONSE);
            }
            match point {
                Some(point) => self.check_sign(FORM, &form.at(point)),
                None if form.is_positive() => Ok(()),
                None => Err(Problem::Unsigned { quantity: FORM.to_owned(), expected: "positive" }),
            }
        };
        let found = check();
        let varies = numbers.axes.iter().any(|own| own.0.starts_with("stress."));
        if found.is_ok() || !varies || halvings == 0 {
            return found;
        }
        let parts = numbers.divide();
        parts.iter().try_for_each(|own| self.verify_form(own, point, halvings - 1))
    }
}

/// The ends of a part, as decimals.
fn read_ends(part: &Part) -> Result<Vec<[BigRational; 2]>, Problem> {
    let read = |[low, high]: &[f64; 2]| match [decimal(*low), decimal(*high)] {
        [Some(low), Some(high)] => Ok([low, high]),
        _ => Err(Problem::Text("the ends of a part are no numbers")),
    };
    part.ends.iter().map(read).collect()
}

/// Checks that the claimed range contains a value.
fn check_range(claim: &Claim, value: Option<Interval>) -> Result<(), Problem> {
    let [low, high] = claim.range;
    let cause = "the range is no interval of numbers";
    let [Some(least), Some(most)] = [exact(low), exact(high)] else {
        return Err(Problem::claim(&claim.quantity, cause));
    };
    let value = value.ok_or_else(|| Problem::claim(&claim.quantity, "a divisor may vanish"))?;
    let [low_value, high_value] = value.ends();
    if low_value >= least && high_value <= most {
        return Ok(());
    }
    let outside = if low_value < least { low_value } else { high_value };
    Err(Problem::Outside {
        quantity: claim.quantity.to_string(),
        low,
        high,
        value: outside.to_f64().unwrap_or(f64::NAN),
    })
}
