//! Extrema of the ratio of two forms.

use super::binary_form::BinaryForm;
use crate::list::StackList;
use models::common::elementary::{Elementary, Modulus, cr_arg};
use std::f64::consts::PI;

impl BinaryForm {
    /// Logarithmic derivative d log|F|/dθ, summed over the factors if known.
    fn logarithmic_derivative(&self, angle: f64) -> f64 {
        let (sin, cos) = angle.cr_sin_cos();
        let own = |f: &BinaryForm| f.slope_at([cos, sin]) / f.value_at([cos, sin]);
        match self.factor_ends.len() {
            0 => own(self),
            _ => self.factors().map(|f| own(&Self::from_coefficients(f))).sum(),
        }
    }
}

/// Candidate angles in [0, π) for the extrema of |a/b|: zeros of a′b − ab′.
pub fn ratio_extrema(a: &BinaryForm, b: &BinaryForm) -> StackList<f64> {
    let product = |p: &BinaryForm, q: &BinaryForm, sign: f64, sum: &mut BinaryForm| {
        for (i, x) in p.coefficients.iter().enumerate() {
            for (j, y) in q.coefficients.iter().enumerate() {
                sum.coefficients[i + j].value += sign * x.value * y.value;
            }
        }
    };
    let mut slope = BinaryForm::new_zero(a.degree() + b.degree());
    product(&a.derivative(), b, 1.0, &mut slope);
    product(a, &b.derivative(), -1.0, &mut slope);
    slope
        .unit_circle_roots()
        .filter(|z| (z.modulus() - 1.0).abs() < 1e-3)
        .map(|z| (0.5 * cr_arg(z)).rem_euclid(PI))
        .collect()
}

/// Position of a maximum of |a/b| between `left` and `right` (rad), at which the ratio is lower, by bisection of its
/// logarithmic derivative.
pub fn locate_ratio_maximum(a: &BinaryForm, b: &BinaryForm, mut left: f64, mut right: f64) -> f64 {
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
