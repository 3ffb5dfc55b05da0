//! Zeros of a binary form: directions in which it vanishes, with error bounds.

use super::binary_form::BinaryForm;
use crate::list::{StackList, list};
use crate::roots;
use models::Rounded;
use models::common::elementary::{Elementary, Modulus, cr_arg};
use num_complex::Complex64;
use std::f64::consts::{FRAC_PI_2, PI};

/// A real direction in which a form vanishes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormZero {
    /// Angle of (κ₁, κ₂), rad, in [0, π).
    pub angle: f64,
    /// Bound on the error of `angle`, rad.
    pub bound: f64,
    /// Whether the form changes sign at the zero; otherwise it touches zero within its rounding bound.
    pub has_sign_change: bool,
}

impl FormZero {
    /// Cosine and sine of the angle.
    pub(crate) fn axis(&self) -> [Rounded; 2] {
        let (sin, cos) = Rounded::from_exact(self.angle).sin_cos();
        [cos, sin]
    }
}

impl BinaryForm {
    /// The angles in [0, π) at which dF/dθ vanishes, ascending.
    fn extrema(&self) -> StackList<f64> {
        let derivative = self.derivative();
        let curvature = derivative.derivative();
        let mut angles: StackList<f64> = derivative
            .unit_circle_roots()
            .filter(|z| (z.modulus() - 1.0).abs() < 1e-3)
            .map(|z| {
                let mut angle = cr_arg(z) / 2.0;
                for _ in 0..4 {
                    let (sin, cos) = angle.cr_sin_cos();
                    let [value, slope] = [&derivative, &curvature].map(|f| f.value_at([cos, sin]));
                    let step = value / slope;
                    if step.is_finite() && step.abs() < 0.1 {
                        angle -= step;
                    }
                    if step.abs() <= f64::EPSILON {
                        break;
                    }
                }
                angle.rem_euclid(PI)
            })
            .collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup_by(|a, b| (*a - *b).abs() < 4.0 * f64::EPSILON);
        angles
    }

    /// Roots z = exp 2iθ of the form: with w = exp iθ the form is w^(−d) times a polynomial in w².
    pub(super) fn unit_circle_roots(&self) -> impl Iterator<Item = Complex64> {
        let d = self.degree();
        let mut polynomial = list![Complex64::ZERO; d + 1];
        for (l, f) in self.coefficients.iter().enumerate() {
            // Term l of the polynomial in z: f_l (z + 1)^(d−l) (z − 1)^l i^(−l).
            let mut term: StackList<Complex64> = list![Complex64::ZERO; d + 1];
            term[0] = f.value * Complex64::new(0.0, -1.0).powi(l as i32);
            for factor in 0..d {
                // Multiplied in place by z ± 1.
                let constant = if factor < l { -1.0 } else { 1.0 };
                for i in (0..=factor).rev() {
                    let own = term[i];
                    term[i + 1] += own;
                    term[i] = constant * own;
                }
            }
            for (p, t) in polynomial.iter_mut().zip(term) {
                *p += t;
            }
        }
        // A leading coefficient of rounding size gives a root at infinity, which corresponds to no direction.
        let size = polynomial.iter().map(|c| c.modulus()).fold(0.0, f64::max);
        while polynomial.last().is_some_and(|c| c.modulus() <= 1e-14 * size) {
            polynomial.pop();
        }
        roots::solve(&polynomial).into_iter()
    }

    /// All directions in [0, π) in which the form crosses zero, or touches it within rounding.
    ///
    /// Between two neighbouring extrema the form is monotone: a change of sign brackets exactly
    /// one zero, however close the extrema are to zero. No sector between two zeros is missed
    /// unless the form inside it stays below its rounding bound.
    pub fn zeros(&self) -> StackList<FormZero> {
        self.find_zeros(true).unwrap_or_default()
    }

    /// [`Self::zeros`], or `None`, sooner, if the form touches zero in some direction.
    pub fn zeros_unless_touching(&self) -> Option<StackList<FormZero>> {
        self.find_zeros(false)
    }

    /// The zeros; `None` if the form touches zero in some direction, unless `may_touch`.
    fn find_zeros(&self, may_touch: bool) -> Option<StackList<FormZero>> {
        if !self.is_nonzero() {
            return Some(StackList::new());
        }
        let is_wanted = |zero: &FormZero| may_touch || zero.has_sign_change;
        if !self.factor_ends.is_empty() {
            let mut zeros: StackList<FormZero> =
                self.factors().flat_map(|f| Self::from_coefficients(f).zeros()).collect();
            merge_zeros(&mut zeros);
            return zeros.iter().all(is_wanted).then_some(zeros);
        }
        let [first, second] = self.axis_multiplicities();
        if first + second > 0 {
            let rest = &self.coefficients[second..=self.degree() - first];
            let mut zeros = Self::from_coefficients(rest).find_zeros(may_touch)?;
            let axes = [(second, 0.0, 0.0), (first, FRAC_PI_2, f64::EPSILON)];
            let own = axes.into_iter().filter(|axis| axis.0 > 0);
            zeros.extend(own.map(|(power, angle, bound)| FormZero {
                angle,
                bound,
                has_sign_change: power % 2 == 1,
            }));
            merge_zeros(&mut zeros);
            return zeros.iter().all(is_wanted).then_some(zeros);
        }
        match self.zeros_of_clear_quadratic() {
            Some(zeros) => Some(zeros),
            None => self.zeros_between_extrema(may_touch),
        }
    }

    /// Powers of κ₁ and κ₂ by which the form is exactly divisible.
    fn axis_multiplicities(&self) -> [usize; 2] {
        let absent = |c: &&Rounded| c.is_structural_zero();
        let second = self.coefficients.iter().take_while(absent).count();
        [self.coefficients.iter().rev().take_while(absent).count(), second]
    }

    /// Zeros by the extrema of the form; `None` if it touches zero in some direction, unless `may_touch`.
    pub(super) fn zeros_between_extrema(&self, may_touch: bool) -> Option<StackList<FormZero>> {
        let extrema = self.extrema();
        let second = self.derivative().derivative();
        let mut zeros = StackList::new();
        if self.degree() % 2 == 1 && extrema.is_empty() {
            return Some(zeros);
        }
        // Value at an extremum; `None` if it may be zero, given that the angle of the extremum is uncertain by 4ε.
        let sign_at = |angle: f64| {
            let (sin, cos) = Rounded::from_exact(angle).sin_cos();
            let value = self.evaluate(cos, sin);
            let curvature = second.value_at([cos.value, sin.value]).abs();
            let reach = value.bound + 0.5 * curvature * (4.0 * f64::EPSILON).powi(2);
            (value.value.abs() > reach).then_some(value.value)
        };
        let signs: StackList<Option<f64>> = extrema.iter().map(|&angle| sign_at(angle)).collect();
        if !may_touch && signs.contains(&None) {
            return None;
        }
        for (index, &left) in extrema.iter().enumerate() {
            let Some(start) = signs[index] else {
                // The form touches zero at this extremum.
                let zero = locate_multiple_zero(self, left);
                // All extrema inside a split multiple zero lead to the same zero.
                let is_known =
                    |z: &FormZero| (z.angle - zero.angle).abs() <= 2.0 * (z.bound + zero.bound);
                if !zeros.iter().any(is_known) {
                    zeros.push(zero);
                }
                continue;
            };
            let (right, flip) = match extrema.get(index + 1) {
                Some(&right) => (right, 1.0),
                None => (extrema[0] + PI, if self.degree() % 2 == 1 { -1.0 } else { 1.0 }),
            };
            let Some(end) = signs[(index + 1) % extrema.len()] else { continue };
            let end = flip * end;
            if start * end.signum() >= 0.0 {
                continue;
            }
            let angle = self.refine_bracketed_zero((left, start), (right, end));
            zeros.push(self.bracketed_zero_at(angle, &second));
        }
        zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        Some(zeros)
    }

    /// Zeros of a form of degree one or two in closed form, if their number is clear. A form of degree two is m + R cos
    /// (2θ − ψ): it has two zeros for |m| < R and none for |m| > R.
    pub(super) fn zeros_of_clear_quadratic(&self) -> Option<StackList<FormZero>> {
        /// Part of |m| + R by which |m| and R differ in a clear case.
        const CLEAR_DIFFERENCE: f64 = 1e-6;
        /// Error of the coefficients in a clear case, as part of that difference.
        const CLEAR_ERROR: f64 = 1e-3;
        let error: f64 = self.coefficients.iter().map(|c| c.bound).sum();
        let mut zeros = StackList::new();
        // Wave vectors in which the form vanishes.
        let vectors = match self.coefficients[..] {
            [first, second] => {
                let amplitude = first.value.root_sum_square(second.value);
                if error > CLEAR_ERROR * amplitude {
                    return None;
                }
                list![[second.value, -first.value]]
            }
            [first, mixed, last] => {
                let [a, b, c] = [first, mixed, last].map(|f| f.value);
                let amplitude = (0.5 * (a - c)).root_sum_square(0.5 * b);
                let mean = (0.5 * (a + c)).abs();
                let (sum, difference) = (amplitude + mean, amplitude - mean);
                // The negation also holds for numbers that are not finite.
                let is_clear = difference.abs() > CLEAR_DIFFERENCE * sum
                    && error <= CLEAR_ERROR * difference.abs();
                if !is_clear {
                    return None;
                }
                if difference < 0.0 {
                    return Some(zeros);
                }
                // Half of the larger of −b ± √(b² − 4ac), so that nothing cancels.
                let root = sum.sqrt() * difference.sqrt();
                let q = if b > 0.0 { -0.5 * b - root } else { root - 0.5 * b };
                list![[q, a], [c, q]]
            }
            _ => return None,
        };
        zeros.extend(vectors.iter().map(|[x, y]| self.zero_at(y.cr_atan2(*x))));
        zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        Some(zeros)
    }

    /// The crossing of zero near `angle` (rad), with its bound from value and slope there.
    fn zero_at(&self, angle: f64) -> FormZero {
        let angle = angle.rem_euclid(PI);
        let (sin, cos) = Rounded::from_exact(angle).sin_cos();
        let (value, slope) = (self.evaluate(cos, sin), self.slope_at([cos.value, sin.value]));
        let bound = (value.value.abs() + value.bound) / slope.abs() + 4.0 * f64::EPSILON;
        FormZero { angle, bound, has_sign_change: true }
    }

    /// [`Self::zero_at`] for a crossing that may be close to others: where the slope changes within the bound, as at a multiple
    /// zero split by rounding, the bound is doubled until the form has opposite certain signs on both sides. `second` is the
    /// second derivative.
    fn bracketed_zero_at(&self, angle: f64, second: &Self) -> FormZero {
        /// Part of the slope by which it may change within the bound.
        const MAX_SLOPE_CHANGE: f64 = 0.1;
        const MAX_BOUND: f64 = 0.03;
        let mut zero = self.zero_at(angle);
        let (sin, cos) = zero.angle.cr_sin_cos();
        let [slope, curvature] = [self.slope_at([cos, sin]), second.value_at([cos, sin])];
        let is_simple = (curvature * zero.bound).abs() <= MAX_SLOPE_CHANGE * slope.abs();
        if is_simple {
            return zero;
        }
        let sign = |offset: f64| self.evaluate_at_angle(zero.angle + offset).sign();
        let mut bound = zero.bound.max(4.0 * f64::EPSILON);
        while bound < MAX_BOUND
            && !matches!((sign(-bound), sign(bound)), (Some(a), Some(b)) if a != b)
        {
            bound *= 2.0;
        }
        zero.bound = bound;
        zero
    }

    /// Zero between two angles with values of opposite sign, by the Illinois variant of regula falsi, with bisection in
    /// every fourth round, until the value and the next secant step are of the size of rounding.
    ///
    /// The form is evaluated along the chord between the two directions, on which it has the same sign as on the arc.
    fn refine_bracketed_zero(
        &self,
        (mut left, mut start): (f64, f64),
        (mut right, mut end): (f64, f64),
    ) -> f64 {
        let direction = |angle: f64| {
            let (sin, cos) = angle.cr_sin_cos();
            [cos, sin]
        };
        while right - left > FRAC_PI_2 {
            let middle = 0.5 * (left + right);
            let value = self.value_at(direction(middle));
            if value == 0.0 {
                return middle;
            }
            if (value > 0.0) == (end > 0.0) {
                (right, end) = (middle, value);
            } else {
                (left, start) = (middle, value);
            }
        }
        let [from, to] = [left, right].map(direction);
        let chord = |part: f64| [0, 1].map(|i| from[i] + part * (to[i] - from[i]));
        let angle = |part: f64| {
            let [x, y] = chord(part);
            y.cr_atan2(x)
        };
        let ((mut a, mut fa), (mut b, mut fb)) = ((0.0, start), (1.0, end));
        for round in 0..120 {
            let secant: f64 = b - fb * (b - a) / (fb - fa);
            let inside = (secant - a) * (secant - b) < 0.0;
            let middle = if inside && round % 4 != 3 { secant } else { 0.5 * (a + b) };
            if inside && (secant - b).abs() <= 2.0 * f64::EPSILON {
                let [x, y] = chord(b).map(Rounded::from_rounded);
                let last = self.evaluate(x, y);
                if last.value.abs() <= last.bound {
                    return angle(secant);
                }
            }
            if middle <= a.min(b) || middle >= a.max(b) {
                break;
            }
            let f = self.value_at(chord(middle));
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
        angle(0.5 * (a + b))
    }
}

/// A zero of a multiplicity of two or more near the extremum at `angle`.
///
/// Rounding splits a zero of multiplicity m by the m-th root of the rounding, with extrema between the resulting zeros.
/// They are one zero if all derivatives of order below m vanish within rounding at a nearby point: a simple zero of
/// derivative m − 1, which is well-conditioned. The highest m are tried first; without such m the position is `angle`.
fn locate_multiple_zero(form: &BinaryForm, angle: f64) -> FormZero {
    const MAX_SHIFT: f64 = 0.03;
    /// Part of derivative m by which it may change within the bound on a zero of derivative m − 1 that is called simple.
    const MAX_CURVED_PART: f64 = 0.5;
    let degree = form.degree();
    let mut derivatives = list![form.clone()];
    for m in 0..degree {
        derivatives.push(derivatives[m].derivative());
    }
    for m in (2..=degree).rev() {
        let (last, change) = (&derivatives[m - 1], &derivatives[m]);
        let mut place = angle;
        for _ in 0..4 {
            let step = last.evaluate_at_angle(place).value / change.evaluate_at_angle(place).value;
            // For m = 2 the zero of the first derivative is `angle` already.
            if m > 2 {
                place -= step;
            }
            if step.is_nan() || step.abs() > MAX_SHIFT {
                break;
            }
        }
        let slope = change.evaluate_at_angle(place);
        let is_zero = |value: Rounded| value.value.abs() <= value.bound;
        let is_near = (place - angle).abs() < MAX_SHIFT && !is_zero(slope);
        if is_near && derivatives[..m].iter().all(|d| is_zero(d.evaluate_at_angle(place))) {
            let (rest, slope) = (last.evaluate_at_angle(place), slope.value.abs() - slope.bound);
            let reach = (rest.value.abs() + rest.bound) / slope;
            let curvature =
                derivatives.get(m + 1).map_or(0.0, |own| own.evaluate_at_angle(place).value);
            // A zero of derivative m − 1 with others nearby is at most this many times as far away (Henrici 1974).
            let is_simple = reach * curvature.abs() <= MAX_CURVED_PART * slope;
            let factor = if is_simple { 1.0 } else { (degree + 1 - m) as f64 };
            let bound = factor * reach + f64::EPSILON;
            return FormZero { angle: place.rem_euclid(PI), bound, has_sign_change: m % 2 == 1 };
        }
    }
    let curvature = derivatives[2.min(degree)].evaluate_at_angle(angle).value.abs();
    let slope = derivatives[1].evaluate_at_angle(angle);
    let reach = ((slope.value.abs() + slope.bound) / curvature).min(1.0);
    FormZero { angle: angle.rem_euclid(PI), bound: reach + f64::EPSILON, has_sign_change: false }
}

/// Sorts the zeros of several factors and merges zeros that agree within their bounds; at a merged zero the form
/// changes sign if an odd number of its constituents do.
pub fn merge_zeros(zeros: &mut StackList<FormZero>) {
    zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
    let near = |a: &FormZero, b: &FormZero, turn: f64| {
        (b.angle - a.angle + turn).abs() <= 2.0 * (a.bound + b.bound)
    };
    zeros.dedup_by(|later, earlier| {
        let same = near(earlier, later, 0.0);
        if same {
            earlier.has_sign_change ^= later.has_sign_change;
            earlier.bound = earlier.bound.max(later.bound);
        }
        same
    });
    if let [first, .., last] = zeros[..]
        && near(&first, &last, -PI)
    {
        zeros[0].has_sign_change ^= last.has_sign_change;
        zeros.pop();
    }
}
