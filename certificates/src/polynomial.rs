//! Polynomials in the two parameters of a box and in the direction, with their signs by Bernstein coefficients.

use crate::interval::Interval;
use std::ops::{Add, Mul, Sub};

/// Number of variables: two parameters, from 0 to 1 over the box, and one of the direction.
const VARIABLE_COUNT: usize = 3;

/// The variable of the direction.
pub(crate) const DIRECTION: usize = 2;

/// Largest number of boxes into which a box is divided to find a sign.
const MAX_BOX_COUNT: usize = 1 << 14;

/// A polynomial Σ a(i, j, k) uⁱ vʲ sᵏ.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Polynomial {
    /// Numbers of coefficients by the powers of u, v and s.
    sizes: [usize; VARIABLE_COUNT],
    /// Coefficients, the power of s fastest.
    coefficients: Vec<Interval>,
}

impl Polynomial {
    pub(crate) fn constant(value: Interval) -> Self {
        Self { sizes: [1; VARIABLE_COUNT], coefficients: vec![value] }
    }

    pub(crate) fn whole(value: i64) -> Self {
        Self::constant(Interval::whole(value))
    }

    /// low + (high − low) x with the variable x of this index.
    pub(crate) fn linear(variable: usize, low: &Interval, high: &Interval) -> Self {
        let mut sizes = [1; VARIABLE_COUNT];
        sizes[variable] = 2;
        Self { sizes, coefficients: vec![low.clone(), high - low] }
    }

    fn index(&self, [i, j, k]: [usize; VARIABLE_COUNT]) -> usize {
        (i * self.sizes[1] + j) * self.sizes[2] + k
    }

    fn powers(sizes: [usize; VARIABLE_COUNT]) -> impl Iterator<Item = [usize; VARIABLE_COUNT]> {
        let [first, second, third] = sizes;
        (0..first)
            .flat_map(move |i| (0..second).flat_map(move |j| (0..third).map(move |k| [i, j, k])))
    }

    fn zero(sizes: [usize; VARIABLE_COUNT]) -> Self {
        Self { sizes, coefficients: vec![Interval::zero(); sizes.iter().product()] }
    }

    /// Indices of the coefficients that differ in the power of one variable only, for each combination of the others.
    fn lines(&self, variable: usize) -> Vec<Vec<usize>> {
        let mut starts = self.sizes;
        starts[variable] = 1;
        let line = |start: [usize; VARIABLE_COUNT]| {
            let place = |power| {
                let mut powers = start;
                powers[variable] = power;
                self.index(powers)
            };
            (0..self.sizes[variable]).map(place).collect()
        };
        Self::powers(starts).map(line).collect()
    }

    /// The polynomial in y with x = low + (high − low) y for the variable x.
    pub(crate) fn restrict(&self, variable: usize, low: &Interval, high: &Interval) -> Self {
        let size = high - low;
        let mut own = self.clone();
        for line in self.lines(variable) {
            // Taylor shift to low, then scale.
            for first in 0..line.len() {
                for i in (first..line.len() - 1).rev() {
                    let carried = low * &own.coefficients[line[i + 1]];
                    own.coefficients[line[i]] = &own.coefficients[line[i]] + &carried;
                }
            }
            let mut power = Interval::whole(1);
            for &place in &line {
                own.coefficients[place] = &own.coefficients[place] * &power;
                power = &power * &size;
            }
        }
        own
    }

    /// Divides by s²; `None` if the polynomial does not have this factor exactly.
    pub(crate) fn divide_by_direction_squared(&self) -> Option<Self> {
        let mut sizes = self.sizes;
        sizes[DIRECTION] = sizes[DIRECTION].checked_sub(2).filter(|&size| size > 0)?;
        let mut own = Self::zero(sizes);
        for powers @ [i, j, k] in Self::powers(self.sizes) {
            let coefficient = &self.coefficients[self.index(powers)];
            match k.checked_sub(2) {
                Some(k) => {
                    let place = own.index([i, j, k]);
                    own.coefficients[place] = coefficient.clone();
                }
                None if coefficient.is_zero() => {}
                None => return None,
            }
        }
        Some(own)
    }

    /// Bernstein coefficients for 0 ≤ u, v, s ≤ 1: bₖ = Σ_(i ≤ k) C(k, i)/C(d, i) aᵢ by each variable.
    pub(crate) fn bernstein(&self) -> Bernstein {
        let mut own = self.clone();
        for variable in 0..VARIABLE_COUNT {
            let degree = self.sizes[variable] - 1;
            for line in self.lines(variable) {
                for (i, &place) in line.iter().enumerate() {
                    let count = Interval::whole(binomial(degree, i));
                    own.coefficients[place] = &own.coefficients[place] / &count;
                }
                // Sums with C(k, i), as in the triangle of Pascal.
                for first in 1..=degree {
                    for k in (first..=degree).rev() {
                        let before = &own.coefficients[line[k - 1]];
                        own.coefficients[line[k]] = &own.coefficients[line[k]] + before;
                    }
                }
            }
        }
        Bernstein(own)
    }

    /// The polynomial with intervals as coefficients, which cost less than long fractions.
    pub(crate) fn spread(mut self) -> Self {
        self.coefficients.iter_mut().for_each(|own| *own = own.widen());
        self
    }

    /// The value at u = v = s = 0.
    pub(crate) fn at_origin(&self) -> &Interval {
        &self.coefficients[0]
    }

    /// Whether the polynomial is positive for 0 ≤ u, v, s ≤ 1.
    pub(crate) fn is_positive(&self) -> bool {
        self.bernstein().prove_positive()
    }
}

fn binomial(n: usize, k: usize) -> i64 {
    (0..k).fold(1, |own, i| own * (n - i) as i64 / (i + 1) as i64)
}

/// Bernstein coefficients of a polynomial over a box: it lies within their convex hull, and those at the corners are its values
/// there.
#[derive(Clone, Debug)]
pub(crate) struct Bernstein(Polynomial);

impl Bernstein {
    fn corner_places(&self) -> Vec<usize> {
        let last = self.0.sizes.map(|size| size - 1);
        let corner = |bits: usize| {
            self.0.index(std::array::from_fn(|variable| (bits >> variable & 1) * last[variable]))
        };
        (0..1 << VARIABLE_COUNT).map(corner).collect()
    }

    /// Values at the eight corners.
    fn corners(&self) -> Vec<&Interval> {
        self.corner_places().into_iter().map(|place| &self.0.coefficients[place]).collect()
    }

    /// Whether all coefficients are positive, so that the polynomial is.
    fn has_positive_coefficients(&self) -> bool {
        self.0.coefficients.iter().all(Interval::is_positive)
    }

    /// Whether the polynomial is positive in all of the box, which is halved until all coefficients are positive, or one at a
    /// corner is not.
    fn prove_positive(self) -> bool {
        let (mut open, mut count) = (vec![self], 0);
        while let Some(own) = open.pop() {
            count += 1;
            if own.has_positive_coefficients() {
                continue;
            }
            if count > MAX_BOX_COUNT || own.corners().iter().any(|value| !value.is_positive()) {
                return false;
            }
            let Some(variable) = own.most_varying() else { return false };
            open.extend(own.bisect(variable));
        }
        true
    }

    /// The variable along which neighbouring coefficients differ most; `None` if the polynomial is constant.
    fn most_varying(&self) -> Option<usize> {
        let variation = |variable: usize| {
            let lines = self.0.lines(variable);
            let pairs = lines.iter().flat_map(|line| line.windows(2));
            let change = |pair: &[usize]| {
                let [a, b] =
                    [pair[0], pair[1]].map(|place| self.0.coefficients[place].approximate());
                (a - b).abs()
            };
            pairs.map(change).fold(0.0, f64::max)
        };
        let variables = (0..VARIABLE_COUNT).map(|variable| (variable, variation(variable)));
        variables.filter(|own| own.1 > 0.0).max_by(|a, b| a.1.total_cmp(&b.1)).map(|own| own.0)
    }

    /// Coefficients on both halves of the box along a variable (de Casteljau).
    fn bisect(&self, variable: usize) -> [Self; 2] {
        let [mut low, mut high] = [self.0.clone(), self.0.clone()];
        for line in self.0.lines(variable) {
            let mut row: Vec<Interval> =
                line.iter().map(|&place| self.0.coefficients[place].clone()).collect();
            for k in 0..line.len() {
                low.coefficients[line[k]] = row[0].clone();
                let last = row.len() - 1;
                high.coefficients[line[last]] = row[last].clone();
                row = row.windows(2).map(|pair| (&pair[0] + &pair[1]).halve()).collect();
            }
        }
        [Self(low), Self(high)]
    }
}

/// Sum with `sign` times the second polynomial.
fn combine(a: &Polynomial, b: &Polynomial, sign: impl Fn(&Interval) -> Interval) -> Polynomial {
    let sizes = std::array::from_fn(|variable| a.sizes[variable].max(b.sizes[variable]));
    let mut sum = Polynomial::zero(sizes);
    for powers in Polynomial::powers(a.sizes) {
        let place = sum.index(powers);
        sum.coefficients[place] = a.coefficients[a.index(powers)].clone();
    }
    for powers in Polynomial::powers(b.sizes) {
        let place = sum.index(powers);
        sum.coefficients[place] =
            &sum.coefficients[place] + &sign(&b.coefficients[b.index(powers)]);
    }
    sum
}

impl Add for &Polynomial {
    type Output = Polynomial;
    fn add(self, other: Self) -> Polynomial {
        combine(self, other, Interval::clone)
    }
}

impl Sub for &Polynomial {
    type Output = Polynomial;
    fn sub(self, other: Self) -> Polynomial {
        combine(self, other, |own| -own)
    }
}

impl Mul for &Polynomial {
    type Output = Polynomial;
    fn mul(self, other: Self) -> Polynomial {
        let sizes = std::array::from_fn(|i| self.sizes[i] + other.sizes[i] - 1);
        let mut product = Polynomial::zero(sizes);
        for a in Polynomial::powers(self.sizes) {
            let first = &self.coefficients[self.index(a)];
            if first.is_zero() {
                continue;
            }
            for b in Polynomial::powers(other.sizes) {
                let second = &other.coefficients[other.index(b)];
                if second.is_zero() {
                    continue;
                }
                let place = product.index(std::array::from_fn(|i| a[i] + b[i]));
                product.coefficients[place] = &product.coefficients[place] + &(first * second);
            }
        }
        product
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variable(index: usize) -> Polynomial {
        Polynomial::linear(index, &Interval::zero(), &Interval::whole(1))
    }

    /// (u − ½)² + (v − s)² + c is positive for c > 0, not for c ≤ 0.
    #[test]
    fn sign_is_that_of_the_least_value() {
        let half = Polynomial::constant(&Interval::whole(1) / &Interval::whole(2));
        let (a, b) = (&variable(0) - &half, &variable(1) - &variable(2));
        let squares = &(&a * &a) + &(&b * &b);
        let fraction = |n: i64| Polynomial::constant(&Interval::whole(n) / &Interval::whole(500));
        assert!((&squares + &fraction(1)).is_positive());
        assert!(!(&squares + &fraction(0)).is_positive());
        assert!(!(&squares - &fraction(1)).is_positive());
    }

    #[test]
    fn restriction_and_division_are_those_of_values() {
        let s = variable(DIRECTION);
        // s² (1 + u s)
        let own = &(&s * &s) * &(&Polynomial::whole(1) + &(&variable(0) * &s));
        let divided = own.divide_by_direction_squared().expect("the factor s²");
        let (low, high) = (Interval::whole(-2), Interval::whole(3));
        let there = divided.restrict(DIRECTION, &low, &high).bernstein();
        // u = 0 and 1 by s = −2 and 3.
        let values: Vec<i64> = there.corners().iter().map(|own| own.approximate() as i64).collect();
        assert_eq!(values, [1, -1, 1, -1, 1, 4, 1, 4]);
        assert!(divided.divide_by_direction_squared().is_none());
    }
}
