//! Tests of binary forms.

use super::binary_form::BinaryForm;
use crate::list::list;
use models::Rounded;
use models::common::elementary::Elementary;
use std::f64::consts::PI;

fn form_with_coefficients(coefficients: &[f64]) -> BinaryForm {
    BinaryForm {
        coefficients: coefficients.iter().map(|&c| Rounded::from_rounded(c)).collect(),
        ..BinaryForm::default()
    }
}

/// Π sin(θ − θᵢ) as a form.
fn form_with_zeros(angles: &[f64]) -> BinaryForm {
    let mut p = list![Rounded::ONE];
    for &angle in angles {
        let (s, c) = (Rounded::from_exact(angle).sin(), Rounded::from_exact(angle).cos());
        let mut next = list![Rounded::ZERO; p.len() + 1];
        for (i, &x) in p.iter().enumerate() {
            next[i] += -(s * x);
            next[i + 1] += c * x;
        }
        p = next;
    }
    BinaryForm { coefficients: p, ..BinaryForm::default() }
}

/// (1 − t)³ (1 + t)(1 + t/2): rounding splits the triple zero, which is one crossing of zero.
#[test]
fn triple_zeros_are_single_crossings_within_their_bounds() {
    let form = form_with_coefficients(&[1.0, -1.5, -1.0, 2.0, 0.0, -0.5]);
    let wanted = [0.25 * PI, PI - 2f64.cr_atan(), 0.75 * PI];
    let zeros = form.zeros();
    assert_eq!(zeros.len(), 3, "{zeros:?}");
    for (zero, wanted) in zeros.iter().zip(wanted) {
        assert!((zero.angle - wanted).abs() <= zero.bound + f64::EPSILON, "{zero:?}");
        assert!(zero.has_sign_change && zero.bound < 1e-12, "{zero:?}");
    }
}

#[test]
fn simple_and_double_zeros_are_distinguished() {
    let zeros = form_with_zeros(&[0.3, 1.2, 2.9]).zeros();
    assert_eq!(zeros.len(), 3);
    for (z, wanted) in zeros.iter().zip([0.3, 1.2, 2.9]) {
        assert!((z.angle - wanted).abs() < 1e-14 && z.has_sign_change);
    }
    let zeros = form_with_zeros(&[0.3, 0.3, 2.0, 2.0]).zeros();
    assert_eq!(zeros.len(), 2, "{zeros:?}");
    for (z, wanted) in zeros.iter().zip([0.3, 2.0]) {
        assert!((z.angle - wanted).abs() < 1e-14 && !z.has_sign_change, "{z:?}");
    }
}

/// Verifies position and bound of zeros of multiplicity 4 and 6, whose curvature is rounding and cannot locate them.
#[test]
fn multiple_zeros_are_located_within_their_bounds() {
    for (angles, wanted) in [([0.7; 4].as_slice(), 0.7), ([0.7; 6].as_slice(), 0.7)] {
        let mut all = angles.to_vec();
        all.extend([2.0, 2.0]);
        let zeros = form_with_zeros(&all).zeros();
        let multiple: Vec<_> = zeros.iter().filter(|z| z.angle < 1.3).collect();
        assert_eq!(multiple.len(), 1, "{zeros:?}");
        assert!((multiple[0].angle - wanted).abs() <= multiple[0].bound, "{zeros:?}");
        assert!(multiple[0].bound < 1e-12, "{zeros:?}");
    }
    // A multiple zero on an axis, with rounding noise in coefficients that vanish exactly.
    let noise = |value: f64| Rounded { value, bound: 6e-12 };
    let coefficients = list![
        noise(-1.6e-14),
        noise(-1.7e-16),
        Rounded::from_rounded(-47.6),
        noise(-8e-16),
        noise(7e-15),
        noise(-1e-31),
        noise(8e-31)
    ];
    let zeros = BinaryForm { coefficients, ..BinaryForm::default() }.zeros();
    assert!(zeros.iter().all(|z| z.bound < 1e-11), "{zeros:?}");
}

#[test]
fn zeros_that_bound_thin_sectors_are_resolved() {
    // Inside the sector |F| is about width²/4 times the form of the other zeros, detectable while above rounding.
    for width in [1e-2, 1e-5, 1e-6] {
        let zeros = form_with_zeros(&[1.1, 1.1 + width, 2.0, 0.4]).zeros();
        let angles: Vec<_> = zeros.iter().map(|z| z.angle).collect();
        assert_eq!(angles.len(), 4, "{width}: {zeros:?}");
        assert!((angles[2] - angles[1] - width).abs() < 1e-3 * width, "{angles:?}");
    }
}

#[test]
fn factors_resolve_zeros_that_their_product_merges() {
    for width in [1e-9, 1e-13] {
        let (a, b) = ([1.1, 2.0], [1.1 + width, 0.4]);
        let mut f = form_with_zeros(&[a[0], a[1], b[0], b[1]]);
        assert!(f.zeros().len() == 3, "the product touches zero: {:?}", f.zeros());
        let negated = form_with_zeros(&b).coefficients.iter().map(|&c| -c).collect();
        f.set_factors(&[
            form_with_zeros(&a),
            BinaryForm { coefficients: negated, ..BinaryForm::default() },
        ]);
        let zeros = f.zeros();
        assert!(zeros.len() == 4 && zeros.iter().all(|z| z.has_sign_change), "{width}: {zeros:?}");
        let inside = f.evaluate_at_angle(0.5 * (zeros[1].angle + zeros[2].angle));
        let outside = f.evaluate_at_angle(zeros[1].angle - width);
        assert_eq!(inside.sign().unwrap(), -outside.sign().unwrap());
    }
    // A product that is not proportional to the form is rejected.
    let mut f = form_with_zeros(&[0.3, 1.2]);
    f.set_factors(&[form_with_zeros(&[0.3]), form_with_zeros(&[1.21])]);
    assert!(f.factor_ends.is_empty());
}

#[test]
fn positive_forms_and_constants_have_no_zero() {
    assert!(form_with_coefficients(&[1.0, 0.0, 2.0]).zeros().is_empty());
    assert!(form_with_coefficients(&[1.0, 0.0, 1.0]).zeros().is_empty());
    assert!(form_with_coefficients(&[3.0]).zeros().is_empty());
    // x² + y² with a perturbation far above rounding: still positive.
    assert!(form_with_coefficients(&[1.0, 1e-6, 1.0]).zeros().is_empty());
}

#[test]
fn rotation_keeps_values() {
    let f = form_with_coefficients(&[0.7, -1.3, 2.9, 0.11]);
    let angle = Rounded::from_exact(0.83);
    let g = f.to_rotated_axes(angle.cos(), angle.sin());
    for theta in [0.0, 0.4, 1.9] {
        let (direct, turned) = (f.evaluate_at_angle(theta + 0.83), g.evaluate_at_angle(theta));
        assert!((direct.value - turned.value).abs() <= direct.bound + turned.bound + 1e-15);
    }
}

#[test]
fn derivative_agrees_with_central_differences() {
    let f = form_with_coefficients(&[0.7, -1.3, 2.9, 0.11, 1.0]);
    let h = 1e-6;
    for theta in [0.2, 1.4, 2.8f64] {
        let slope = (f.evaluate_at_angle(theta + h).value - f.evaluate_at_angle(theta - h).value)
            / (2.0 * h);
        assert!((f.derivative().evaluate_at_angle(theta).value - slope).abs() < 1e-8);
        assert!((f.slope_at([theta.cr_cos(), theta.cr_sin()]) - slope).abs() < 1e-8);
    }
}

/// Zeros of forms of degree one and two in closed form, and the decision that there are none, against the general search
/// between extrema.
#[test]
fn clear_quadratic_forms_have_the_zeros_of_the_general_search() {
    let (mut with, mut without) = (0, 0);
    for index in 0..600 {
        // Points of a lattice that fills the cube.
        let entry = |step: f64| 2.0 * (step * f64::from(index)).fract() - 1.0;
        let coefficients = [0.754_877_666, 0.569_840_291, 0.430_159_709].map(entry);
        let size = 10f64.powi(index % 7 - 3);
        let coefficients = [size * coefficients[0], coefficients[1], coefficients[2] / size];
        let form = form_with_coefficients(&coefficients[..2 + index as usize % 2]);
        let Some(found) = form.zeros_of_clear_quadratic() else { continue };
        let general = form.zeros_between_extrema(true).unwrap();
        assert_eq!(found.len(), general.len(), "{coefficients:?}");
        for zero in &found {
            let gap = |other: &super::FormZero| {
                let gap = (zero.angle - other.angle).abs();
                gap.min(PI - gap)
            };
            let nearest = general.iter().min_by(|a, b| gap(a).total_cmp(&gap(b))).unwrap();
            let bound = zero.bound + nearest.bound;
            assert!(
                gap(nearest) <= bound && bound < 1e-9,
                "{coefficients:?}: {found:?} {general:?}"
            );
        }
        with += usize::from(!found.is_empty());
        without += usize::from(found.is_empty());
    }
    assert!(with > 200 && without > 50, "{with} {without}");
    // Nearly double zeros, and coefficients that are mostly error, are left to the general search.
    assert!(form_with_zeros(&[0.7, 0.7 + 1e-4]).zeros_of_clear_quadratic().is_none());
    let doubtful = Rounded { value: 1.0, bound: 0.1 };
    let coefficients = list![doubtful, doubtful, -doubtful];
    let form = BinaryForm { coefficients, ..BinaryForm::default() };
    assert!(form.zeros_of_clear_quadratic().is_none());
}

#[test]
fn touching_forms_are_recognised() {
    assert!(form_with_zeros(&[0.3, 0.3, 2.0]).zeros_unless_touching().is_none());
    let form = form_with_zeros(&[0.3, 0.4, 2.0]);
    assert_eq!(form.zeros_unless_touching(), Some(form.zeros()));
}
