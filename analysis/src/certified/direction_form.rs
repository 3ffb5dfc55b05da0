//! Signs of binary forms over all directions of the plane, by Bernstein coefficients in the direction.

use certificates::Directions;
use models::common::scalar::Scalar;
use models::common::taylor_model::TaylorModel;
use std::ops::{Add, Mul, Sub};

/// Largest number of bisections of a chart of directions: to 2⁻²⁰ of it.
const MAX_DEPTH: u32 = 20;

/// Number of directions on each chart among which the least value is searched.
const SAMPLE_COUNT: u32 = 64;

/// A form Σ cᵢ n₁^(d−i) n₂^i of degree d in the direction (n₁, n₂), with coefficients over a box of parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionForm {
    coefficients: Vec<TaylorModel>,
}

impl DirectionForm {
    /// Creates the form with the coefficients of n₁^d, n₁^(d−1) n₂, …, n₂^d.
    ///
    /// # Panics
    /// There is no coefficient.
    pub fn new(coefficients: Vec<TaylorModel>) -> Self {
        assert!(!coefficients.is_empty(), "a form has a coefficient");
        Self { coefficients }
    }

    fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Divides by n₂². The first two coefficients, which must vanish identically, are left out.
    pub(super) fn divide_by_second_squared(self) -> Self {
        Self::new(self.coefficients[2..].to_vec())
    }

    /// Enclosure of the value in a direction, whose components are exact.
    pub fn value_at(&self, [x, y]: [f64; 2]) -> TaylorModel {
        let powers = |base: f64| {
            let mut all = vec![TaylorModel::from_exact(1.0)];
            for index in 0..self.degree() {
                all.push(all[index] * TaylorModel::from_exact(base));
            }
            all
        };
        let (first, second) = (powers(x), powers(y));
        let terms = self.coefficients.iter().enumerate();
        terms.fold(TaylorModel::ZERO, |sum, (i, &own)| {
            sum + own * first[self.degree() - i] * second[i]
        })
    }

    /// Ranges of directions, which cover all, with a positive lower and an upper bound on the form for each, in all of the
    /// box; `None` if the form is not certainly positive.
    pub fn prove_positive(&self) -> Option<Vec<(Directions, [f64; 2])>> {
        let mut found = Vec::new();
        let mut is_positive = |is_swapped: bool| {
            let mut put = |ends, range| {
                let own = match is_swapped {
                    false => Directions::AlongNormal(ends),
                    true => Directions::AlongLayers(ends),
                };
                found.push((own, range));
            };
            bound_positive(&self.chart(is_swapped), [-1.0, 1.0], 0, &mut put)
        };
        (is_positive(false) && is_positive(true)).then_some(found)
    }

    /// A direction in which the form is certainly negative in all of the box, with bounds on it there: near that of the least
    /// value at the centre of the box. `None` if it is not certainly negative there.
    pub fn prove_negative(&self) -> Option<(Directions, [f64; 2])> {
        let value = |direction: [f64; 2]| {
            let [x, y] = direction;
            let own = |(i, c): (usize, &TaylorModel)| {
                c.value * x.powi((self.degree() - i) as i32) * y.powi(i as i32)
            };
            self.coefficients.iter().enumerate().map(own).sum::<f64>()
                / (x * x + y * y).powi(self.degree() as i32 / 2)
        };
        let chart = |is_swapped: bool, t: f64| if is_swapped { [t, 1.0] } else { [1.0, t] };
        let mut best = (f64::INFINITY, false, 0.0);
        let step = 2.0 / f64::from(SAMPLE_COUNT);
        for is_swapped in [false, true] {
            for index in 0..=SAMPLE_COUNT {
                let t = step * f64::from(index) - 1.0;
                let here = value(chart(is_swapped, t));
                if here < best.0 {
                    best = (here, is_swapped, t);
                }
            }
        }
        let (mut least, is_swapped, mut t) = best;
        // Halve the step about the least value: the minimum is narrower than the samples only in boxes that stay
        // undecided.
        let mut step = step;
        for _ in 0..20 {
            step *= 0.5;
            for other in [t - step, t + step] {
                let here = value(chart(is_swapped, other));
                if here < least {
                    (least, t) = (here, other);
                }
            }
        }
        let direction = chart(is_swapped, t);
        let found = self.value_at(direction);
        (found.certain_sign() == Some(-1))
            .then(|| (Directions::One(direction.to_vec()), found.range()))
    }

    /// Bernstein coefficients in s ∈ [0, 1] on the chart (1, t) or, swapped, (t, 1) with t = 2s − 1.
    fn chart(&self, is_swapped: bool) -> Vec<TaylorModel> {
        let degree = self.degree();
        let mut powers = self.coefficients.clone();
        if is_swapped {
            powers.reverse();
        }
        // Coefficients in s by a Taylor shift: p(t) at t = −1 + 2s.
        for first in 0..degree {
            for i in (first..degree).rev() {
                powers[i] = powers[i] - powers[i + 1];
            }
        }
        let mut scale = 1.0;
        for own in &mut powers {
            *own = TaylorModel::from_exact(scale) * *own;
            scale *= 2.0;
        }
        // bₖ = Σ_(i ≤ k) C(k, i)/C(d, i) aᵢ.
        let ratio = |k: usize, i: usize| -> TaylorModel {
            TaylorModel::from_exact(binomial(k, i)) / TaylorModel::from_exact(binomial(degree, i))
        };
        (0..=degree)
            .map(|k| (0..=k).fold(TaylorModel::ZERO, |sum, i| sum + ratio(k, i) * powers[i]))
            .collect()
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |own, i| own * (n - i) as f64 / (i + 1) as f64)
}

/// Whether a polynomial with these Bernstein coefficients on an interval is certainly positive there; passes parts of the interval
/// to `put`, with lower and upper bound. The polynomial lies within the convex hull of the coefficients, of which the first
/// and the last are its values at the ends.
fn bound_positive(
    coefficients: &[TaylorModel],
    [low, high]: [f64; 2],
    depth: u32,
    put: &mut impl FnMut([f64; 2], [f64; 2]),
) -> bool {
    let is_certain = |own: &TaylorModel| own.certain_sign() == Some(1);
    if coefficients.iter().all(is_certain) {
        let join = |[least, most]: [f64; 2], own: &TaylorModel| {
            let [low, high] = own.range();
            [least.min(low), most.max(high)]
        };
        put([low, high], coefficients.iter().fold([f64::INFINITY, f64::NEG_INFINITY], join));
        return true;
    }
    let [first, .., last] = coefficients else { return false };
    if depth == MAX_DEPTH || !is_certain(first) || !is_certain(last) {
        return false;
    }
    // Exact: at most twenty halvings.
    let middle = 0.5 * (low + high);
    let ends = [[low, middle], [middle, high]];
    let halves = bisect(coefficients);
    ends.into_iter().zip(&halves).all(|(ends, half)| bound_positive(half, ends, depth + 1, put))
}

/// Bernstein coefficients on both halves of the interval (de Casteljau).
fn bisect(coefficients: &[TaylorModel]) -> [Vec<TaylorModel>; 2] {
    let half = TaylorModel::from_exact(0.5);
    let mut row = coefficients.to_vec();
    let (mut low, mut high) = (vec![row[0]], vec![row[row.len() - 1]]);
    while row.len() > 1 {
        row = row.windows(2).map(|pair| half * (pair[0] + pair[1])).collect();
        low.push(row[0]);
        high.push(row[row.len() - 1]);
    }
    high.reverse();
    [low, high]
}

impl Add for &DirectionForm {
    type Output = DirectionForm;
    fn add(self, other: Self) -> DirectionForm {
        let pairs = self.coefficients.iter().zip(&other.coefficients);
        DirectionForm::new(pairs.map(|(a, b)| *a + *b).collect())
    }
}

impl Sub for &DirectionForm {
    type Output = DirectionForm;
    fn sub(self, other: Self) -> DirectionForm {
        let pairs = self.coefficients.iter().zip(&other.coefficients);
        DirectionForm::new(pairs.map(|(a, b)| *a - *b).collect())
    }
}

impl Mul for &DirectionForm {
    type Output = DirectionForm;
    fn mul(self, other: Self) -> DirectionForm {
        let mut product = vec![TaylorModel::ZERO; self.degree() + other.degree() + 1];
        for (i, &a) in self.coefficients.iter().enumerate() {
            for (j, &b) in other.coefficients.iter().enumerate() {
                product[i + j] = product[i + j] + a * b;
            }
        }
        DirectionForm::new(product)
    }
}

impl Mul<&DirectionForm> for TaylorModel {
    type Output = DirectionForm;
    fn mul(self, form: &DirectionForm) -> DirectionForm {
        DirectionForm::new(form.coefficients.iter().map(|&own| self * own).collect())
    }
}
