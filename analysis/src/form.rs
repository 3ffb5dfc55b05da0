//! Binary forms F(κ₁, κ₂) = Σ f_l κ₁^(d−l) κ₂^l with rounding bounds, and where they vanish.

use crate::list::{List, list};
use crate::roots;
use models::Rounded;
use models::common::elementary::{Elementary, cr_arg};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// A binary form of degree d by its d + 1 coefficients.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// Entry l belongs to κ₁^(d−l) κ₂^l.
    pub coefficients: List<Rounded>,
    /// The form as a product, where that is known: two factors that vanish next to each other
    /// tell their zeros apart, the product of their coefficients does not. The coefficients of one
    /// factor after the other, and where each ends.
    factors: List<Rounded>,
    ends: List<usize, 4>,
}

/// A real direction in which a form vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Zero {
    /// Angle of (κ₁, κ₂), in [0, π).
    pub angle: f64,
    /// Bound on the error of `angle`, rad.
    pub bound: f64,
    /// Whether the form changes sign there; otherwise it touches zero within its rounding bound.
    pub crosses: bool,
}

impl Form {
    /// The zero form of that degree.
    pub fn zero(degree: usize) -> Self {
        Self { coefficients: list![Rounded::ZERO; degree + 1], ..Self::default() }
    }

    fn from_coefficients(coefficients: &[Rounded]) -> Self {
        Self { coefficients: List::from_slice(coefficients), ..Self::default() }
    }

    /// The coefficients of the factors that are known.
    fn factors(&self) -> impl Iterator<Item = &[Rounded]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.factors[start..end])
    }

    /// Remembers that the form is the product of `factors`, up to a positive or negative constant;
    /// does nothing if it turns out not to be.
    pub fn factorise(&mut self, factors: &[Form]) {
        let product =
            |angle: f64| factors.iter().map(|f| f.at_angle(angle)).fold(Rounded::ONE, |a, b| a * b);
        // Where the form is large: the ratio must be the same constant.
        let mut samples: List<(f64, f64), 32> = (0..4 * factors.len() + 8)
            .map(|i| 0.1 + 0.37 * i as f64)
            .map(|angle| (self.at_angle(angle).value, product(angle).value))
            .collect();
        samples.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
        samples.truncate(samples.len() / 2);
        let ratio = samples[0].0 / samples[0].1;
        let holds = samples.iter().all(|(f, p)| (f - ratio * p).abs() <= 1e-9 * f.abs());
        if ratio.is_finite() && ratio != 0.0 && holds {
            (self.factors, self.ends) = (List::new(), List::new());
            for (index, factor) in factors.iter().enumerate() {
                let scaled = |&c| if index == 0 { Rounded::exact(ratio) * c } else { c };
                self.factors.extend(factor.coefficients.iter().map(scaled));
                self.ends.push(self.factors.len());
            }
        }
    }

    /// Degree d.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Whether some coefficient has a sign beyond rounding, so that the form does not vanish
    /// identically.
    pub fn is_certain(&self) -> bool {
        self.coefficients.iter().any(|c| matches!(c.sign(), Some(1 | -1)))
    }

    /// F(cos, sin).
    pub fn at(&self, cos: Rounded, sin: Rounded) -> Rounded {
        if self.ends.is_empty() {
            return evaluate(&self.coefficients, cos, sin);
        }
        self.factors().map(|f| evaluate(f, cos, sin)).fold(Rounded::ONE, |a, b| a * b)
    }

    /// F at an angle that is meant literally.
    pub fn at_angle(&self, angle: f64) -> Rounded {
        let angle = Rounded::exact(angle);
        self.at(angle.cos(), angle.sin())
    }

    /// Adds `factor` times another form of the same parity and no higher degree, as functions on the
    /// unit circle.
    pub fn add(&mut self, other: &Form, factor: Rounded) {
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
        self.ends.clear();
    }

    /// Whether the form vanishes exactly at this angle, which is one of the axes.
    pub fn vanishes_on_axis(&self, angle: f64) -> bool {
        let zero = |c: Option<&Rounded>| c.is_some_and(|c| c.is_structural_zero());
        (angle == 0.0 || angle == PI) && zero(self.coefficients.first())
            || (angle - FRAC_PI_2).abs() < 1e-15 && zero(self.coefficients.last())
    }

    /// dF/dθ at an angle, without its rounding.
    fn derivative_at(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.cr_sin_cos();
        let d = self.degree() as i32;
        let term = |(l, f): (usize, &Rounded)| {
            let l = l as i32;
            let mut slope = 0.0;
            if l > 0 {
                slope += f64::from(l) * cos.powi(d - l + 1) * sin.powi(l - 1);
            }
            if l < d {
                slope -= f64::from(d - l) * cos.powi(d - l - 1) * sin.powi(l + 1);
            }
            f.value * slope
        };
        self.coefficients.iter().enumerate().map(term).sum()
    }

    /// d log|F|/dθ
    fn logarithmic_derivative(&self, angle: f64) -> f64 {
        let own = |f: &Form| f.derivative_at(angle) / f.at_angle(angle).value;
        match self.ends.len() {
            0 => own(self),
            _ => self.factors().map(|f| own(&Self::from_coefficients(f))).sum(),
        }
    }

    /// dF/dθ along (cos θ, sin θ): again a form of degree d.
    pub fn derivative(&self) -> Self {
        let d = self.degree();
        let mut result = Self::zero(d);
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

    /// The form in axes turned by the angle with this cosine and sine: G(κ, κ⊥) with
    /// κ₁ = cos κ − sin κ⊥, κ₂ = sin κ + cos κ⊥.
    pub fn rotated(&self, cos: Rounded, sin: Rounded) -> Self {
        let d = self.degree();
        let multiply = |p: &[Rounded], a: Rounded, b: Rounded| {
            let mut product = list![Rounded::ZERO; p.len() + 1];
            for (i, &x) in p.iter().enumerate() {
                product[i] += a * x;
                product[i + 1] += b * x;
            }
            product
        };
        let mut result = Self::zero(d);
        // Factor by factor, as small values near a common zero lose less.
        let turned = self.factors().map(|f| Self::from_coefficients(f).rotated(cos, sin));
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
            let mut product = list![f];
            for factor in 0..d {
                product = if factor < l {
                    multiply(&product, sin, cos)
                } else {
                    multiply(&product, cos, -sin)
                };
            }
            for (r, p) in result.coefficients.iter_mut().zip(product) {
                *r += p;
            }
        }
        result
    }

    /// The angles in [0, π) at which dF/dθ vanishes, ascending.
    fn extrema(&self) -> List<f64> {
        let derivative = self.derivative();
        let curvature = derivative.derivative();
        let mut angles: List<f64> = derivative
            .roots_on_the_circle()
            .filter(|z| (z.norm() - 1.0).abs() < 1e-3)
            .map(|z| {
                let mut angle = cr_arg(z) / 2.0;
                for _ in 0..4 {
                    let slope = curvature.at_angle(angle).value;
                    let step = derivative.at_angle(angle).value / slope;
                    if step.is_finite() && step.abs() < 0.1 {
                        angle -= step;
                    }
                }
                angle.rem_euclid(PI)
            })
            .collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|a, b| (*a - *b).abs() < 4.0 * f64::EPSILON);
        angles
    }

    /// Roots in z = exp 2iθ: with w = exp iθ the form is w^(−d) times a polynomial in w².
    fn roots_on_the_circle(&self) -> impl Iterator<Item = Complex64> {
        let d = self.degree();
        let mut polynomial = list![Complex64::ZERO; d + 1];
        for (l, f) in self.coefficients.iter().enumerate() {
            // (z + 1)^(d−l) (z − 1)^l i^(−l)
            let mut term =
                list![Complex64::from(f.value) * Complex64::new(0.0, -1.0).powi(l as i32)];
            for factor in 0..d {
                let constant = if factor < l { -1.0 } else { 1.0 };
                let mut next = list![Complex64::ZERO; term.len() + 1];
                for (i, &t) in term.iter().enumerate() {
                    next[i + 1] += t;
                    next[i] += constant * t;
                }
                term = next;
            }
            for (p, t) in polynomial.iter_mut().zip(term) {
                *p += t;
            }
        }
        // A top coefficient of rounding size is a root at infinity, which is no direction.
        let size = polynomial.iter().map(|c| c.norm()).fold(0.0, f64::max);
        while polynomial.last().is_some_and(|c| c.norm() <= 1e-14 * size) {
            polynomial.pop();
        }
        roots::of(&polynomial).into_iter()
    }

    /// All directions in [0, π) in which the form crosses zero, or touches it within rounding.
    ///
    /// Between two neighbouring extrema the form is monotone: a change of sign brackets exactly
    /// one zero, however close the extrema are to zero. No sector between two zeros is missed
    /// unless the form inside it stays below its rounding bound.
    pub fn zeros(&self) -> List<Zero> {
        if !self.is_certain() {
            return List::new();
        }
        if !self.ends.is_empty() {
            let mut zeros: List<Zero> =
                self.factors().flat_map(|f| Self::from_coefficients(f).zeros()).collect();
            merge(&mut zeros);
            return zeros;
        }
        // Powers of κ₁ and κ₂ that divide the form exactly.
        let absent = |c: &&Rounded| c.is_structural_zero();
        let second = self.coefficients.iter().take_while(absent).count();
        let first = self.coefficients.iter().rev().take_while(absent).count();
        if first + second > 0 {
            let rest = &self.coefficients[second..=self.degree() - first];
            let mut zeros = Self::from_coefficients(rest).zeros();
            let axes = [(second, 0.0, 0.0), (first, FRAC_PI_2, f64::EPSILON)];
            let own = axes.into_iter().filter(|axis| axis.0 > 0);
            zeros.extend(own.map(|(power, angle, bound)| Zero {
                angle,
                bound,
                crosses: power % 2 == 1,
            }));
            merge(&mut zeros);
            return zeros;
        }
        let extrema = self.extrema();
        let derivative = self.derivative();
        let second = derivative.derivative();
        let mut zeros = List::new();
        if self.degree() % 2 == 1 && extrema.is_empty() {
            return zeros;
        }
        // Value at an extremum; none where it may be zero, as its own place is uncertain by about a
        // unit in the last place.
        let sign_at = |angle: f64| {
            let value = self.at_angle(angle);
            let curvature = second.at_angle(angle).value.abs();
            let reach = value.bound + 0.5 * curvature * (4.0 * f64::EPSILON).powi(2);
            (value.value.abs() > reach).then_some(value.value)
        };
        for (index, &left) in extrema.iter().enumerate() {
            let Some(start) = sign_at(left) else {
                // A touching zero: its place is that of the extremum.
                let (angle, bound) = touching(self, left);
                let angle = angle.rem_euclid(PI);
                // The extrema inside a multiple zero all lead to it.
                let is_known = |z: &Zero| (z.angle - angle).abs() <= 2.0 * (z.bound + bound);
                if !zeros.iter().any(is_known) {
                    zeros.push(Zero { angle, bound, crosses: false });
                }
                continue;
            };
            let (right, flip) = match extrema.get(index + 1) {
                Some(&right) => (right, 1.0),
                None => (extrema[0] + PI, if self.degree() % 2 == 1 { -1.0 } else { 1.0 }),
            };
            let Some(end) = sign_at(extrema[(index + 1) % extrema.len()]) else { continue };
            let end = flip * end;
            if start * end.signum() >= 0.0 {
                continue;
            }
            // Regula falsi after Illinois, and bisection where that is slow.
            let (mut a, mut b) = (left, right);
            let (mut fa, mut fb) = (start, end);
            for round in 0..120 {
                let secant = b - fb * (b - a) / (fb - fa);
                let inside = (secant - a) * (secant - b) < 0.0;
                let middle = if inside && round % 4 != 3 { secant } else { 0.5 * (a + b) };
                if middle <= a.min(b) || middle >= a.max(b) {
                    break;
                }
                let f = self.at_angle(middle).value;
                if f == 0.0 {
                    (a, b) = (middle, middle);
                    break;
                }
                if (f > 0.0) == (fb > 0.0) {
                    fa *= 0.5;
                } else {
                    (a, fa) = (b, fb);
                }
                (b, fb) = (middle, f);
            }
            let angle = 0.5 * (a + b);
            let bound = self.at_angle(angle).bound / derivative.at_angle(angle).value.abs()
                + 4.0 * f64::EPSILON;
            zeros.push(Zero { angle: angle.rem_euclid(PI), bound, crosses: true });
        }
        zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        zeros
    }
}

/// The place of a zero that the form touches near its extremum at `angle`, and its rounding bound.
///
/// Zeros of multiplicity m come apart by the m-th root of the rounding, and so do the extrema between
/// them. They are one zero if there is a place near by at which all derivatives below the m-th are zero
/// within rounding: a simple zero of the last of these, as accurate as any.
fn touching(form: &Form, angle: f64) -> (f64, f64) {
    const NEAR: f64 = 0.03;
    let mut derivatives = list![form.clone()];
    for m in 0..form.degree() {
        derivatives.push(derivatives[m].derivative());
    }
    for m in (2..=form.degree()).rev().filter(|m| m % 2 == 0) {
        let (last, change) = (&derivatives[m - 1], &derivatives[m]);
        let mut place = angle;
        for _ in 0..4 {
            let step = last.at_angle(place).value / change.at_angle(place).value;
            // The first derivative's own zero is the angle already.
            if m > 2 {
                place -= step;
            }
            if step.is_nan() || step.abs() > NEAR {
                break;
            }
        }
        let slope = change.at_angle(place);
        let is_zero = |value: Rounded| value.value.abs() <= value.bound;
        let is_near = (place - angle).abs() < NEAR && !is_zero(slope);
        if is_near && derivatives[..m].iter().all(|d| is_zero(d.at_angle(place))) {
            return (place, last.at_angle(place).bound / slope.value.abs() + f64::EPSILON);
        }
    }
    let curvature = derivatives[2.min(form.degree())].at_angle(angle).value.abs();
    let slope = derivatives[1].at_angle(angle).bound;
    (angle, (slope / curvature).min(1.0) + f64::EPSILON)
}

/// Angles in [0, π) among which are all extrema of |a/b|: zeros of a′b − ab′.
pub fn extrema_of_ratio(a: &Form, b: &Form) -> List<f64> {
    let product = |p: &Form, q: &Form, sign: f64, sum: &mut Form| {
        for (i, x) in p.coefficients.iter().enumerate() {
            for (j, y) in q.coefficients.iter().enumerate() {
                sum.coefficients[i + j].value += sign * x.value * y.value;
            }
        }
    };
    let mut slope = Form::zero(a.degree() + b.degree());
    product(&a.derivative(), b, 1.0, &mut slope);
    product(a, &b.derivative(), -1.0, &mut slope);
    slope
        .roots_on_the_circle()
        .filter(|z| (z.norm() - 1.0).abs() < 1e-3)
        .map(|z| (0.5 * cr_arg(z)).rem_euclid(PI))
        .collect()
}

/// A maximum of |a/b| between two angles at which it vanishes or is lower, by bisection of its
/// logarithmic derivative.
pub fn maximum_of_ratio(a: &Form, b: &Form, mut left: f64, mut right: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (left + right);
        if middle <= left || middle >= right {
            break;
        }
        if a.logarithmic_derivative(middle) > b.logarithmic_derivative(middle) {
            left = middle;
        } else {
            right = middle;
        }
    }
    0.5 * (left + right)
}

/// Horner's scheme in cos, with powers of sin.
fn evaluate(coefficients: &[Rounded], cos: Rounded, sin: Rounded) -> Rounded {
    let mut value = coefficients[0];
    let mut power = Rounded::ONE;
    for &f in &coefficients[1..] {
        power = power * sin;
        value = value * cos + f * power;
    }
    value
}

/// Sorts zeros of several factors; those that agree within their bounds become one, which crosses
/// if an odd number of them does.
pub fn merge(zeros: &mut List<Zero>) {
    zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    let near = |a: &Zero, b: &Zero, turn: f64| {
        (b.angle - a.angle + turn).abs() <= 2.0 * (a.bound + b.bound)
    };
    zeros.dedup_by(|later, earlier| {
        let same = near(earlier, later, 0.0);
        if same {
            earlier.crosses ^= later.crosses;
            earlier.bound = earlier.bound.max(later.bound);
        }
        same
    });
    if let [first, .., last] = zeros[..]
        && near(&first, &last, -PI)
    {
        zeros[0].crosses ^= last.crosses;
        zeros.pop();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(coefficients: &[f64]) -> Form {
        Form {
            coefficients: coefficients.iter().map(|&c| Rounded::given(c)).collect(),
            ..Form::default()
        }
    }

    /// Π sin(θ − θᵢ) as a form.
    fn with_zeros(angles: &[f64]) -> Form {
        let mut p = list![Rounded::ONE];
        for &angle in angles {
            let (s, c) = (Rounded::exact(angle).sin(), Rounded::exact(angle).cos());
            let mut next = list![Rounded::ZERO; p.len() + 1];
            for (i, &x) in p.iter().enumerate() {
                next[i] += -(s * x);
                next[i + 1] += c * x;
            }
            p = next;
        }
        Form { coefficients: p, ..Form::default() }
    }

    #[test]
    fn zeros_of_products_are_found_with_their_kind() {
        let zeros = with_zeros(&[0.3, 1.2, 2.9]).zeros();
        assert_eq!(zeros.len(), 3);
        for (z, wanted) in zeros.iter().zip([0.3, 1.2, 2.9]) {
            assert!((z.angle - wanted).abs() < 1e-14 && z.crosses);
        }
        let zeros = with_zeros(&[0.3, 0.3, 2.0, 2.0]).zeros();
        assert_eq!(zeros.len(), 2, "{zeros:?}");
        for (z, wanted) in zeros.iter().zip([0.3, 2.0]) {
            assert!((z.angle - wanted).abs() < 1e-14 && !z.crosses, "{z:?}");
        }
    }

    /// The curvature of a fourfold zero is rounding: it says nothing of the zero's place.
    #[test]
    fn places_of_multiple_zeros_are_known() {
        for (angles, wanted) in [([0.7; 4].as_slice(), 0.7), ([0.7; 6].as_slice(), 0.7)] {
            let mut all = angles.to_vec();
            all.extend([2.0, 2.0]);
            let zeros = with_zeros(&all).zeros();
            let multiple: Vec<_> = zeros.iter().filter(|z| z.angle < 1.3).collect();
            assert_eq!(multiple.len(), 1, "{zeros:?}");
            assert!((multiple[0].angle - wanted).abs() <= multiple[0].bound, "{zeros:?}");
            assert!(multiple[0].bound < 1e-12, "{zeros:?}");
        }
        // On an axis, with rounding where the exact coefficients vanish.
        let noise = |value: f64| Rounded { value, bound: 6e-12 };
        let coefficients = list![
            noise(-1.6e-14),
            noise(-1.7e-16),
            Rounded::given(-47.6),
            noise(-8e-16),
            noise(7e-15),
            noise(-1e-31),
            noise(8e-31)
        ];
        let zeros = Form { coefficients, ..Form::default() }.zeros();
        assert!(zeros.iter().all(|z| z.bound < 1e-11), "{zeros:?}");
    }

    #[test]
    fn thin_sectors_are_not_missed() {
        // The form inside the sector is about width²/4 deep: seen while that is above rounding.
        for width in [1e-2, 1e-5, 1e-6] {
            let zeros = with_zeros(&[1.1, 1.1 + width, 2.0, 0.4]).zeros();
            let angles: Vec<_> = zeros.iter().map(|z| z.angle).collect();
            assert_eq!(angles.len(), 4, "{width}: {zeros:?}");
            assert!((angles[2] - angles[1] - width).abs() < 1e-3 * width, "{angles:?}");
        }
    }

    #[test]
    fn factors_tell_zeros_apart_that_their_product_cannot() {
        for width in [1e-9, 1e-13] {
            let (a, b) = ([1.1, 2.0], [1.1 + width, 0.4]);
            let mut f = with_zeros(&[a[0], a[1], b[0], b[1]]);
            assert!(f.zeros().len() == 3, "the product touches zero: {:?}", f.zeros());
            let negated = with_zeros(&b).coefficients.iter().map(|&c| -c).collect();
            f.factorise(&[with_zeros(&a), Form { coefficients: negated, ..Form::default() }]);
            let zeros = f.zeros();
            assert!(zeros.len() == 4 && zeros.iter().all(|z| z.crosses), "{width}: {zeros:?}");
            let inside = f.at_angle(0.5 * (zeros[1].angle + zeros[2].angle));
            let outside = f.at_angle(zeros[1].angle - width);
            assert_eq!(inside.sign().unwrap(), -outside.sign().unwrap());
        }
        // What is no factorisation is not taken for one.
        let mut f = with_zeros(&[0.3, 1.2]);
        f.factorise(&[with_zeros(&[0.3]), with_zeros(&[1.21])]);
        assert!(f.ends.is_empty());
    }

    #[test]
    fn positive_forms_and_constants_have_no_zero() {
        assert!(form(&[1.0, 0.0, 2.0]).zeros().is_empty());
        assert!(form(&[1.0, 0.0, 1.0]).zeros().is_empty());
        assert!(form(&[3.0]).zeros().is_empty());
        // x² + y² with a perturbation far above rounding: still positive.
        assert!(form(&[1.0, 1e-6, 1.0]).zeros().is_empty());
    }

    #[test]
    fn rotation_keeps_values() {
        let f = form(&[0.7, -1.3, 2.9, 0.11]);
        let angle = Rounded::exact(0.83);
        let g = f.rotated(angle.cos(), angle.sin());
        for theta in [0.0, 0.4, 1.9] {
            let (direct, turned) = (f.at_angle(theta + 0.83), g.at_angle(theta));
            assert!((direct.value - turned.value).abs() <= direct.bound + turned.bound + 1e-15);
        }
    }

    #[test]
    fn derivative_is_the_derivative() {
        let f = form(&[0.7, -1.3, 2.9, 0.11, 1.0]);
        let h = 1e-6;
        for theta in [0.2, 1.4, 2.8] {
            let slope = (f.at_angle(theta + h).value - f.at_angle(theta - h).value) / (2.0 * h);
            assert!((f.derivative().at_angle(theta).value - slope).abs() < 1e-8);
        }
    }
}
