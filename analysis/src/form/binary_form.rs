//! Binary forms: products, sums, derivatives and rotations.

use crate::list::{StackList, list};
use models::Rounded;
use models::common::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

/// A binary form (homogeneous polynomial in two variables) of degree d by its d + 1 coefficients.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinaryForm {
    /// Coefficients; entry l multiplies κ₁^(d−l) κ₂^l.
    pub coefficients: StackList<Rounded>,
    /// Coefficients of the known factors of the form, one factor after the other; factors resolve close zeros that the
    /// expanded coefficients do not.
    pub(super) factors: StackList<Rounded>,
    /// Index in `factors` after the last coefficient of each factor.
    pub(super) factor_ends: StackList<usize, 4>,
}

/// Number of directions in which forms are compared: more than their degrees.
const SAMPLE_COUNT: usize = 20;

/// Cosines and sines of these directions.
static SAMPLE_DIRECTIONS: LazyLock<[[f64; 2]; SAMPLE_COUNT]> = LazyLock::new(|| {
    std::array::from_fn(|i| {
        let (sin, cos) = (0.1 + 0.37 * i as f64).cr_sin_cos();
        [cos, sin]
    })
});

impl BinaryForm {
    /// The zero form of degree `degree`.
    pub fn new_zero(degree: usize) -> Self {
        Self { coefficients: list![Rounded::ZERO; degree + 1], ..Self::default() }
    }

    pub(super) fn from_coefficients(coefficients: &[Rounded]) -> Self {
        Self { coefficients: StackList::from_slice(coefficients), ..Self::default() }
    }

    /// Coefficients of the known factors.
    pub(super) fn factors(&self) -> impl Iterator<Item = &[Rounded]> {
        let starts = [0].into_iter().chain(self.factor_ends.iter().copied());
        starts.zip(&self.factor_ends).map(|(start, &end)| &self.factors[start..end])
    }

    /// Stores `factors` as factorisation of the form, up to a constant factor; ignored if their product is not
    /// proportional to the form.
    pub fn set_factors(&mut self, factors: &[BinaryForm]) {
        let product = |direction: [f64; 2]| -> f64 {
            factors.iter().map(|f| f.value_at(direction)).product()
        };
        // Compare where the form is largest: the ratio of form and product must be constant.
        let mut samples: StackList<(f64, f64), SAMPLE_COUNT> = SAMPLE_DIRECTIONS
            .iter()
            .map(|&direction| (self.value_at(direction), product(direction)))
            .collect();
        samples.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        samples.truncate(samples.len() / 2);
        let ratio = samples[0].0 / samples[0].1;
        let holds = samples.iter().all(|(f, p)| (f - ratio * p).abs() <= 1e-9 * f.abs());
        if ratio.is_finite() && ratio != 0.0 && holds {
            (self.factors, self.factor_ends) = (StackList::new(), StackList::new());
            for (index, factor) in factors.iter().enumerate() {
                let scaled = |&c| if index == 0 { Rounded::from_exact(ratio) * c } else { c };
                self.factors.extend(factor.coefficients.iter().map(scaled));
                self.factor_ends.push(self.factors.len());
            }
        }
    }

    /// Degree d.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Whether some coefficient has a sign beyond rounding, so that the form does not vanish
    /// identically.
    pub fn is_nonzero(&self) -> bool {
        self.coefficients.iter().any(|c| matches!(c.sign(), Some(1 | -1)))
    }

    /// Value F(cos θ, sin θ) with rounding bound, from cos θ and sin θ.
    pub fn evaluate(&self, cos: Rounded, sin: Rounded) -> Rounded {
        if self.factor_ends.is_empty() {
            return evaluate_horner(&self.coefficients, cos, sin);
        }
        self.factors().map(|f| evaluate_horner(f, cos, sin)).fold(Rounded::ONE, |a, b| a * b)
    }

    /// Value F(cos θ, sin θ) with rounding bound at an exact angle θ, rad.
    pub fn evaluate_at_angle(&self, angle: f64) -> Rounded {
        let (sin, cos) = Rounded::from_exact(angle).sin_cos();
        self.evaluate(cos, sin)
    }

    /// Value F(`cos`, `sin`) by the expanded coefficients, without rounding bound.
    pub(super) fn value_at(&self, [cos, sin]: [f64; 2]) -> f64 {
        let mut value = self.coefficients[0].value;
        let mut power = 1.0;
        for f in &self.coefficients[1..] {
            power *= sin;
            value = value * cos + f.value * power;
        }
        value
    }

    /// Adds `factor` times another form, as functions on the unit circle; the degree of `other` has the same parity as
    /// that of the form and is not higher.
    pub fn add_scaled(&mut self, other: &BinaryForm, factor: Rounded) {
        let mut raised = other.coefficients.clone();
        while raised.len() < self.coefficients.len() {
            let mut next = list![Rounded::ZERO; raised.len() + 2];
            for (l, &f) in raised.iter().enumerate() {
                next[l] += f;
                next[l + 2] += f;
            }
            raised = next;
        }
        for (sum, &f) in self.coefficients.iter_mut().zip(&raised) {
            *sum += factor * f;
        }
        self.factors.clear();
        self.factor_ends.clear();
    }

    /// Whether `angle` (rad) is that of a coordinate axis and the form vanishes exactly there.
    pub fn is_zero_on_axis(&self, angle: f64) -> bool {
        let zero = |c: Option<&Rounded>| c.is_some_and(|c| c.is_structural_zero());
        (angle == 0.0 || angle == PI) && zero(self.coefficients.first())
            || (angle - FRAC_PI_2).abs() < 1e-15 && zero(self.coefficients.last())
    }

    /// dF/dθ in the direction with cosine `cos` and sine `sin`, without rounding bound: cos ∂F/∂κ₂ − sin ∂F/∂κ₁.
    pub(super) fn slope_at(&self, [cos, sin]: [f64; 2]) -> f64 {
        let mut value = self.coefficients[0].value;
        let (mut by_first, mut by_second, mut power) = (0.0, 0.0, 1.0);
        for (l, f) in self.coefficients.iter().enumerate().skip(1) {
            by_first = by_first * cos + value;
            by_second = by_second * cos + l as f64 * f.value * power;
            power *= sin;
            value = value * cos + f.value * power;
        }
        cos * by_second - sin * by_first
    }

    /// Derivative dF(cos θ, sin θ)/dθ, again a form of degree d.
    pub fn derivative(&self) -> Self {
        let d = self.degree();
        let mut result = Self::new_zero(d);
        for (l, &f) in self.coefficients.iter().enumerate() {
            // d/dθ (c^(d−l) s^l) = l c^(d−l+1) s^(l−1) − (d−l) c^(d−l−1) s^(l+1)
            if l > 0 {
                result.coefficients[l - 1] += l as f64 * f;
            }
            if l < d {
                result.coefficients[l + 1] += -((d - l) as f64 * f);
            }
        }
        result
    }

    /// The form in axes rotated by the angle θ with cosine `cos` and sine `sin`: G(κ, κ⊥) with
    /// κ₁ = κ cos θ − κ⊥ sin θ, κ₂ = κ sin θ + κ⊥ cos θ.
    pub fn to_rotated_axes(&self, cos: Rounded, sin: Rounded) -> Self {
        let d = self.degree();
        let mut result = Self::new_zero(d);
        // Rotate factor by factor: then small values near a common zero of the factors lose less to cancellation.
        let turned = self.factors().map(|f| Self::from_coefficients(f).to_rotated_axes(cos, sin));
        let product = turned.map(|f| f.coefficients).reduce(|p, q| {
            let mut product = list![Rounded::ZERO; p.len() + q.len() - 1];
            for (i, &x) in p.iter().enumerate() {
                for (j, &y) in q.iter().enumerate() {
                    product[i + j] += x * y;
                }
            }
            product
        });
        if let Some(coefficients) = product {
            result.coefficients = coefficients;
            return result;
        }
        for (l, &f) in self.coefficients.iter().enumerate() {
            if f.is_structural_zero() {
                continue;
            }
            let mut product: StackList<Rounded> = list![Rounded::ZERO; d + 1];
            product[0] = f;
            for factor in 0..d {
                // Multiplied in place by a κ + b κ⊥.
                let (a, b) = if factor < l { (sin, cos) } else { (cos, -sin) };
                for i in (0..=factor).rev() {
                    let own = product[i];
                    product[i + 1] += b * own;
                    product[i] = a * own;
                }
            }
            for (r, p) in result.coefficients.iter_mut().zip(product) {
                *r += p;
            }
        }
        result
    }
}

/// Evaluates a form by Horner's scheme in cos, with powers of sin.
fn evaluate_horner(coefficients: &[Rounded], cos: Rounded, sin: Rounded) -> Rounded {
    let mut value = coefficients[0];
    let mut power = Rounded::ONE;
    for &f in &coefficients[1..] {
        power = power * sin;
        value = value * cos + f * power;
    }
    value
}
