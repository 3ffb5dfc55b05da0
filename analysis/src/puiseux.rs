//! Puiseux series of the roots of a polynomial whose coefficients are powers of a large parameter k, up to the first
//! term with a nonzero real part (Newton; Puiseux 1850; Walker 1950, chapter IV).

use crate::list::{StackList, list};
use crate::newton_polygon::{GrowthOrder, newton_polygon_corners};
use crate::roots;
use crate::rounded_complex::RoundedComplex;
use models::common::elementary::Modulus;
use num_complex::Complex64;

/// A term `value` x^`x_power` k^(`k_power`/D) of a polynomial in x; the denominator D is common to all terms.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Monomial {
    pub(crate) x_power: usize,
    pub(crate) k_power: i64,
    pub(crate) value: RoundedComplex,
}

/// A nonzero root of a polynomial with multiplicity and error bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BoundedRoot {
    pub(crate) value: Complex64,
    pub(crate) multiplicity: usize,
    /// Bound on the distance of `value` from the root.
    pub(crate) bound: f64,
}

impl BoundedRoot {
    /// Whether the real part of the root may be zero.
    pub(crate) fn is_neutral(&self) -> bool {
        self.value.re.abs() <= self.bound
    }

    /// Whether the real part of the root is positive beyond its error bound.
    pub(crate) fn is_growing(&self) -> bool {
        self.value.re > self.bound
    }
}

/// Error bound, relative to a neutral root, above which the sign of its real part is undecided.
pub(crate) const UNDECIDED_RELATIVE_BOUND: f64 = 1e-7;

/// Largest part of a derivative by which it may change within the error bound of a root that is called isolated.
const MAX_CURVED_PART: f64 = 0.5;

/// Maximum number of terms of a Puiseux series.
const MAX_TERMS: usize = 6;

/// Asymptotic growth of the roots of one polynomial.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct RootGrowth {
    /// Largest order with a positive real part, and the coefficient.
    pub(crate) growth: Option<(GrowthOrder, f64)>,
    /// Order at which the sign of the real part is undecided, real part and its error bound.
    pub(crate) undecided_term: Option<(GrowthOrder, f64, f64)>,
}

impl RootGrowth {
    fn record_growth(&mut self, order: GrowthOrder, coefficient: f64) {
        let better = self.growth.is_none_or(|(o, c)| (order, coefficient) > (o, c));
        if better {
            self.growth = Some((order, coefficient));
        }
    }

    fn record_undecided(&mut self, order: GrowthOrder, value: f64, bound: f64) {
        self.undecided_term.get_or_insert((order, value, bound));
    }
}

/// Nonzero roots of Σ `polynomial[i]` xⁱ; roots that agree within their bounds are merged into a multiple root.
pub(crate) fn solve_nonzero_roots(polynomial: &[RoundedComplex]) -> StackList<BoundedRoot> {
    let first = polynomial.iter().take_while(|c| c.is_zero()).count();
    let end = polynomial.iter().rposition(|c| !c.is_zero()).map_or(0, |last| last + 1);
    if end <= first + 1 {
        return StackList::new();
    }
    // Coefficients that may be zero are dropped before the first and after the last one that is not. At x, `neglected`
    // bounds the sum of the low-order terms dropped, divided by x^`first` like the rest.
    let neglected = |x: Complex64| {
        let part = |(i, c): (usize, &RoundedComplex)| {
            (c.modulus() + c.bound) * x.modulus().powi(i as i32 - first as i32)
        };
        polynomial[..first].iter().enumerate().map(part).sum::<f64>()
    };
    let polynomial = &polynomial[first..end];
    let plain: StackList<Complex64> = polynomial.iter().map(|c| c.value).collect();
    let mut open = roots::solve(&plain);
    let mut found = StackList::new();
    while let Some(root) = open.first().copied() {
        let mut radius = 0.03;
        loop {
            let near = |other: &Complex64| (other - root).modulus() <= radius * root.modulus();
            let members: StackList<Complex64> = open.iter().copied().filter(near).collect();
            let count = members.len().max(1);
            let mean = members.iter().sum::<Complex64>() / count as f64;
            if let Some(root) = find_multiple_root(polynomial, neglected, mean, count) {
                open.retain(|other| !near(other));
                found.push(root);
                break;
            }
            if count == 1 {
                // Accept the root with a bound equal to its modulus.
                open.remove(0);
                found.push(BoundedRoot { value: root, multiplicity: 1, bound: root.modulus() });
                break;
            }
            radius *= 0.2;
        }
    }
    found
}

/// A root of the given multiplicity near a point, if all derivatives of order below multiplicity − 1 vanish there
/// within four times their bounds and the root is accurate to a tenth of its modulus (not required of a simple root);
/// `neglected` bounds the terms neglected in the polynomial at a point.
///
/// The bound is that of a zero of the derivative q of order multiplicity − 1. If q has only real or only neutral zeros, or
/// none in a half-plane, so does the polynomial (Gauss & Lucas): a zero of q that grows proves that a root does.
fn find_multiple_root(
    polynomial: &[RoundedComplex],
    neglected: impl Fn(Complex64) -> f64,
    near: Complex64,
    multiplicity: usize,
) -> Option<BoundedRoot> {
    // n-th derivative over n!.
    let derivative = |x: Complex64, n: usize| {
        let terms = polynomial.iter().enumerate().skip(n).rev();
        terms.fold(Complex64::ZERO, |sum, (i, c)| sum * x + binomial(i, n) * c.value)
    };
    let mut x = near;
    for _ in 0..3 {
        let step =
            derivative(x, multiplicity - 1) / (multiplicity as f64 * derivative(x, multiplicity));
        let (length, size) = (step.modulus(), x.modulus());
        if !step.is_finite() || length > 0.1 * size {
            break;
        }
        x -= step;
        if length <= f64::EPSILON * size {
            break;
        }
    }
    let size = x.modulus();
    let evaluation_error = 4.0 * polynomial.len() as f64 * f64::EPSILON;
    let coefficient_errors: StackList<f64> =
        polynomial.iter().map(|c| c.bound + evaluation_error * c.modulus()).collect();
    // Bound on the error of the n-th derivative over n!.
    let uncertainty = |n: usize| {
        let terms = coefficient_errors.iter().enumerate().skip(n).rev();
        terms.fold(0.0, |sum, (i, own)| sum * size + binomial(i, n) * own)
            + neglected(x) * size.powi(-(n as i32))
    };
    let vanishes = |n: usize| derivative(x, n).modulus() <= 4.0 * uncertainty(n);
    if !(0..multiplicity - 1).all(vanishes) {
        return None;
    }
    let slope = multiplicity as f64 * derivative(x, multiplicity).modulus();
    let value = derivative(x, multiplicity - 1).modulus();
    let error = uncertainty(multiplicity - 1);
    // q is linear within `reach` but for its curved part. If that is small, q has one zero there (Rouché); else only the degree
    // of q times |q/q′| bounds the distance to one (Henrici 1974): a cluster that is neither merged into one root nor resolved.
    let reach = 2.0 * (value + error) / slope;
    let degree = polynomial.len() - multiplicity;
    let curved = (2..=degree).rev().fold(0.0, |sum, k| {
        let order = multiplicity - 1 + k;
        (sum + binomial(order, k) * derivative(x, order).modulus()) * reach
    });
    let curved = (curved + multiplicity as f64 * uncertainty(multiplicity)) / slope;
    let bound = if curved < MAX_CURVED_PART {
        (2.0 * value + error) / (slope * (1.0 - curved))
    } else {
        let certain_slope = (slope - multiplicity as f64 * uncertainty(multiplicity)).max(0.0);
        degree as f64 * (value + error) / certain_slope
    };
    (bound < 0.1 * size || multiplicity == 1).then_some(BoundedRoot {
        value: x,
        multiplicity,
        bound,
    })
}

/// Binomial coefficient n over k.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    match k {
        0 => 1.0,
        1 => n as f64,
        _ => (0..k).fold(1.0, |product, i| product * (n - i) as f64 / (i + 1) as f64),
    }
}

/// Sums terms of equal powers and drops those that may be zero.
pub(crate) fn combine_like_terms(terms: &mut StackList<Monomial, 32>) {
    terms.sort_by_key(|t| (t.x_power, t.k_power));
    terms.dedup_by(|later, first| {
        let same = (later.x_power, later.k_power) == (first.x_power, first.k_power);
        if same {
            first.value += later.value;
        }
        same
    });
    terms.retain(|t| !t.value.is_zero());
}

/// Growth of the roots of Σ `terms` as k → ∞, restricted to roots of order below `order_bound`; `unit` is the
/// denominator D.
pub(crate) fn asymptotic_growth(
    terms: &[Monomial],
    unit: i64,
    order_bound: Option<GrowthOrder>,
) -> RootGrowth {
    let mut result = RootGrowth::default();
    continue_series(terms, unit, order_bound, MAX_TERMS, &mut result);
    result
}

/// Continues the roots on all edges of the Newton polygon to the next term of their Puiseux series, up to `depth`
/// terms.
fn continue_series(
    terms: &[Monomial],
    unit: i64,
    order_bound: Option<GrowthOrder>,
    depth: usize,
    result: &mut RootGrowth,
) {
    let corners = newton_polygon_corners(terms.iter().map(|t| (t.x_power as i64, t.k_power)));
    for pair in corners.windows(2) {
        let ((i1, j1), (i0, j0)) = (pair[0], pair[1]);
        if j0 <= j1 {
            continue;
        }
        let order = GrowthOrder::new(j0 - j1, (i1 - i0) * unit);
        if order_bound.is_some_and(|order_bound| order >= order_bound)
            || result.growth.is_some_and(|(known, _)| known > order)
        {
            continue;
        }
        let mut edge = list![RoundedComplex::default(); (i1 - i0) as usize + 1];
        for t in terms {
            let i = t.x_power as i64;
            if i >= i0 && i <= i1 && (t.k_power - j1) * (i1 - i0) == (j0 - j1) * (i1 - i) {
                edge[(i - i0) as usize] += t.value;
            }
        }
        for root in solve_nonzero_roots(&edge) {
            if root.is_growing() {
                result.record_growth(order, root.value.re);
            } else if root.is_neutral() {
                if root.bound > UNDECIDED_RELATIVE_BOUND * root.value.modulus() {
                    result.record_undecided(order, root.value.re, root.bound);
                } else if root.multiplicity == 1
                    && order.numerator * lcm(unit, order.denominator) <= order.denominator
                {
                    // The next term of a simple root is at most constant.
                } else if depth == 0 {
                    result.record_undecided(order, 0.0, root.bound);
                } else {
                    let (shifted, unit) = shift_by_root(terms, unit, order, &root);
                    continue_series(&shifted, unit, Some(order), depth - 1, result);
                }
            }
        }
    }
}

/// Terms of the polynomial in y = x − c k^m, with a root c of the edge polynomial of order m.
fn shift_by_root(
    terms: &[Monomial],
    unit: i64,
    order: GrowthOrder,
    root: &BoundedRoot,
) -> (StackList<Monomial, 32>, i64) {
    let unit_after = lcm(unit, order.denominator);
    let slope = order.numerator * (unit_after / order.denominator);
    let top = terms
        .iter()
        .map(|t| t.k_power * (unit_after / unit) + slope * t.x_power as i64)
        .max()
        .unwrap_or_default();
    let mut powers = list![RoundedComplex::new(Complex64::ONE, 0.0)];
    let c = RoundedComplex::new(root.value, root.bound);
    let greatest = terms.iter().map(|t| t.x_power).max().unwrap_or(0);
    for i in 0..greatest {
        powers.push(powers[i] * c);
    }
    let mut shifted = StackList::new();
    for t in terms {
        for i in 0..=t.x_power {
            let power = t.k_power * (unit_after / unit) + slope * (t.x_power - i) as i64;
            // These terms vanish exactly: c is a root of the edge polynomial.
            if i < root.multiplicity && power + slope * i as i64 == top {
                continue;
            }
            let factor = RoundedComplex::new(binomial(t.x_power, i).into(), 0.0);
            shifted.push(Monomial {
                x_power: i,
                k_power: power,
                value: t.value * powers[t.x_power - i] * factor,
            });
        }
    }
    combine_like_terms(&mut shifted);
    (shifted, unit_after)
}

/// Least common multiple.
pub(crate) fn lcm(a: i64, b: i64) -> i64 {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use models::Rounded;
    use models::common::elementary::Elementary;

    /// Polynomials with only neutral roots, most of them in one cluster: no root grows, in whatever groups they are found.
    #[test]
    fn clusters_of_neutral_roots_do_not_grow() {
        let mut state = 11u32;
        let mut draw = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        for round in 0..20_000 {
            let size = (-3.0 - 20.0 * draw()).cr_exp2();
            let count = 2 + round % 4;
            let mut polynomial = vec![RoundedComplex::from_i_power(Rounded::ONE, 0)];
            for index in 0..=count {
                let root = if index == count { -1.0 } else { 1.0 + size * draw() };
                // Times x − i·root.
                let factor = RoundedComplex::from_i_power(Rounded::from_exact(root), 3);
                let mut next = vec![RoundedComplex::default(); polynomial.len() + 1];
                for (i, &own) in polynomial.iter().enumerate() {
                    next[i + 1] += own;
                    next[i] += own * factor;
                }
                polynomial = next;
            }
            for root in solve_nonzero_roots(&polynomial) {
                assert!(!root.is_growing(), "round {round}, {size:e}: {root:?}");
            }
        }
    }
}
