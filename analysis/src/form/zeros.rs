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
        if !self.is_nonzero() {
            return StackList::new();
        }
        if !self.factor_ends.is_empty() {
            let mut zeros: StackList<FormZero> =
                self.factors().flat_map(|f| Self::from_coefficients(f).zeros()).collect();
            merge_zeros(&mut zeros);
            return zeros;
        }
        if let Some(zeros) = self.zeros_with_axis_factors() {
            return zeros;
        }
        let extrema = self.extrema();
        let derivative = self.derivative();
        let second = derivative.derivative();
        let mut zeros = StackList::new();
        if self.degree() % 2 == 1 && extrema.is_empty() {
            return zeros;
        }
        // Value at an extremum; `None` if it may be zero, given that the angle of the extremum is uncertain by 4ε.
        let sign_at = |angle: f64| {
            let value = self.evaluate_at_angle(angle);
            let curvature = second.evaluate_at_angle(angle).value.abs();
            let reach = value.bound + 0.5 * curvature * (4.0 * f64::EPSILON).powi(2);
            (value.value.abs() > reach).then_some(value.value)
        };
        for (index, &left) in extrema.iter().enumerate() {
            let Some(start) = sign_at(left) else {
                // The form touches zero at this extremum.
                let (angle, bound) = locate_multiple_zero(self, left);
                let angle = angle.rem_euclid(PI);
                // All extrema inside a split multiple zero lead to the same zero.
                let is_known = |z: &FormZero| (z.angle - angle).abs() <= 2.0 * (z.bound + bound);
                if !zeros.iter().any(is_known) {
                    zeros.push(FormZero { angle, bound, has_sign_change: false });
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
            let angle = self.refine_bracketed_zero((left, start), (right, end));
            let value = self.evaluate_at_angle(angle);
            let slope = derivative.evaluate_at_angle(angle).value.abs();
            let bound = (value.value.abs() + value.bound) / slope + 4.0 * f64::EPSILON;
            zeros.push(FormZero { angle: angle.rem_euclid(PI), bound, has_sign_change: true });
        }
        zeros.sort_by(|a, b| a.angle.total_cmp(&b.angle));
        zeros
    }

    /// Zeros of a form that is exactly divisible by powers of κ₁ or κ₂; `None` for other forms.
    fn zeros_with_axis_factors(&self) -> Option<StackList<FormZero>> {
        let absent = |c: &&Rounded| c.is_structural_zero();
        let second = self.coefficients.iter().take_while(absent).count();
        let first = self.coefficients.iter().rev().take_while(absent).count();
        if first + second == 0 {
            return None;
        }
        let rest = &self.coefficients[second..=self.degree() - first];
        let mut zeros = Self::from_coefficients(rest).zeros();
        let axes = [(second, 0.0, 0.0), (first, FRAC_PI_2, f64::EPSILON)];
        let own = axes.into_iter().filter(|axis| axis.0 > 0);
        zeros.extend(own.map(|(power, angle, bound)| FormZero {
            angle,
            bound,
            has_sign_change: power % 2 == 1,
        }));
        merge_zeros(&mut zeros);
        Some(zeros)
    }

    /// Zero between two angles with values of opposite sign, by the Illinois variant of regula falsi, with bisection in
    /// every fourth round, until the value and the next secant step are of the size of rounding.
    fn refine_bracketed_zero(
        &self,
        (mut a, mut fa): (f64, f64),
        (mut b, mut fb): (f64, f64),
    ) -> f64 {
        for round in 0..120 {
            let secant = b - fb * (b - a) / (fb - fa);
            let inside = (secant - a) * (secant - b) < 0.0;
            let middle = if inside && round % 4 != 3 { secant } else { 0.5 * (a + b) };
            if inside && (secant - b).abs() <= 2.0 * f64::EPSILON {
                let last = self.evaluate_at_angle(b);
                if last.value.abs() <= last.bound {
                    return secant;
                }
            }
            if middle <= a.min(b) || middle >= a.max(b) {
                break;
            }
            let (sin, cos) = middle.cr_sin_cos();
            let f = self.value_at([cos, sin]);
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
        0.5 * (a + b)
    }
}

/// Position and rounding bound of a multiple zero near the extremum at `angle`.
///
/// Rounding splits a zero of multiplicity m by the m-th root of the rounding, with extrema between the resulting zeros.
/// They are one zero if all derivatives of order below m vanish within rounding at a nearby point: a simple zero of
/// derivative m − 1, which is well-conditioned. Only even m are tried, the highest first, since the form does not
/// change sign; without such m the position is `angle`.
fn locate_multiple_zero(form: &BinaryForm, angle: f64) -> (f64, f64) {
    const MAX_SHIFT: f64 = 0.03;
    let mut derivatives = list![form.clone()];
    for m in 0..form.degree() {
        derivatives.push(derivatives[m].derivative());
    }
    for m in (2..=form.degree()).rev().filter(|m| m % 2 == 0) {
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
            return (place, last.evaluate_at_angle(place).bound / slope.value.abs() + f64::EPSILON);
        }
    }
    let curvature = derivatives[2.min(form.degree())].evaluate_at_angle(angle).value.abs();
    let slope = derivatives[1].evaluate_at_angle(angle).bound;
    (angle, (slope / curvature).min(1.0) + f64::EPSILON)
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
