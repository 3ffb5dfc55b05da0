//! Zeros of binary forms against products of linear factors with integer coefficients.

use crate::support::states::seeded_generator;
use crate::support::verdicts::angular_distance;
use models::Rounded;
use std::f64::consts::PI;
use wellposed_analysis::form::BinaryForm;

/// The product of factors with integer coefficients; exact while below 2⁵³.
fn product_form(factors: &[Vec<i64>]) -> BinaryForm {
    let mut p = vec![1i128];
    for factor in factors {
        let mut next = vec![0i128; p.len() + factor.len() - 1];
        for (i, x) in p.iter().enumerate() {
            for (j, &y) in factor.iter().enumerate() {
                next[i + j] += x * i128::from(y);
            }
        }
        p = next;
    }
    assert!(p.iter().all(|c| c.unsigned_abs() < 1 << 53), "not exact: {p:?}");
    let mut form = BinaryForm::new_zero(p.len() - 1);
    form.coefficients = p.iter().map(|&c| Rounded::from_exact(c as f64)).collect();
    form
}

/// Angle at which a κ₁ + b κ₂ = 0.
fn zero_angle([a, b]: [i64; 2]) -> f64 {
    (-(a as f64)).atan2(b as f64).rem_euclid(PI)
}

/// Verifies simple zeros of forms up to degree 7, some with definite quadratic factors: exactly these zeros are found,
/// each within its bound, and the bounds are small.
#[test]
fn simple_zeros_are_all_found_within_their_bounds() {
    let random = &mut seeded_generator(21);
    let (mut count, mut worst, mut greatest_bound) = (0, 0.0f64, 0.0f64);
    for _ in 0..3000 {
        let linear = (random.next_bits() % 6) as usize;
        let definite = (random.next_bits() % 2) as usize;
        let mut lines: Vec<[i64; 2]> = Vec::new();
        while lines.len() < linear {
            let line = [0; 2].map(|_| random.uniform(-30.0, 30.0).round() as i64);
            let apart =
                |own: &[i64; 2]| angular_distance(zero_angle(*own), zero_angle(line)) > 0.01;
            if line != [0, 0] && lines.iter().all(apart) {
                lines.push(line);
            }
        }
        let mut factors: Vec<Vec<i64>> = lines.iter().map(|l| l.to_vec()).collect();
        for _ in 0..definite {
            // a κ₁² + 2b κ₁κ₂ + c κ₂² with b² < ac, at a distance from touching zero.
            let b = random.uniform(-5.0, 5.0).round() as i64;
            factors.push(vec![b.abs() + 2, 2 * b, b.abs() + 3]);
        }
        if factors.is_empty() {
            continue;
        }
        let zeros = product_form(&factors).zeros();
        assert_eq!(zeros.len(), lines.len(), "{factors:?}: {zeros:?}");
        assert!(zeros.is_sorted_by(|a, b| a.angle <= b.angle));
        for line in &lines {
            let near = |z: &&wellposed_analysis::form::FormZero| {
                angular_distance(z.angle, zero_angle(*line)) < 1e-6
            };
            let zero = zeros.iter().find(near).unwrap_or_else(|| panic!("{line:?} in {zeros:?}"));
            let error = angular_distance(zero.angle, zero_angle(*line));
            assert!(zero.has_sign_change && (0.0..PI).contains(&zero.angle), "{zero:?}");
            assert!(error <= zero.bound + 2.0 * f64::EPSILON, "{error:e}: {zero:?}, {factors:?}");
            assert!(zero.bound < 1e-9, "{zero:?} in {factors:?}");
            worst = worst.max(error);
            greatest_bound = greatest_bound.max(zero.bound);
            count += 1;
        }
    }
    println!("{count} zeros, greatest error {worst:.1e}, greatest bound {greatest_bound:.1e}");
}

/// Verifies that an exactly double zero is found once and without change of sign, and that a triple zero is found
/// within 1e-3 rad.
#[test]
fn double_and_triple_zeros_are_distinguished() {
    verify_repeated_zeros(false);
}

/// Verifies double and triple zeros on an axis, where the form is exactly zero.
#[test]
fn repeated_zeros_on_axes_are_distinguished() {
    verify_repeated_zeros(true);
}

fn verify_repeated_zeros(axes: bool) {
    let random = &mut seeded_generator(22);
    for n in 0..1500 {
        let mut line = |axis: bool| loop {
            let mut line = [0; 2].map(|_| random.uniform(-20.0, 20.0).round() as i64);
            if axis {
                line[n % 2] = 0;
            }
            if line != [0, 0] && (axis || line.iter().all(|&x| x != 0)) {
                return line;
            }
        };
        let (double, single) = (line(axes), line(false));
        if angular_distance(zero_angle(double), zero_angle(single)) < 0.05 {
            continue;
        }
        let power = 2 + n / 2 % 2;
        let mut factors = vec![double.to_vec(); power];
        factors.push(single.to_vec());
        let zeros = product_form(&factors).zeros();
        let own: Vec<_> =
            zeros.iter().filter(|z| angular_distance(z.angle, zero_angle(double)) < 1e-3).collect();
        assert!(!own.is_empty(), "{factors:?}: {zeros:?}");
        if power == 2 {
            assert!(own.len() == 1 && !own[0].has_sign_change, "{factors:?}: {zeros:?}");
            assert!(
                angular_distance(own[0].angle, zero_angle(double)) < 1e-13,
                "{factors:?}: {zeros:?}"
            );
        }
        let other =
            zeros.iter().filter(|z| angular_distance(z.angle, zero_angle(single)) < 1e-12).count();
        assert_eq!(other, 1, "{factors:?}: {zeros:?}");
        assert_eq!(zeros.len(), own.len() + 1, "{factors:?}: {zeros:?}");
    }
}

/// Verifies two zeros at distances from about 0.2 down to 6e-9 rad: two crossings while the form between them exceeds
/// its rounding, otherwise one touching zero.
#[test]
fn nearly_double_zeros_are_separated_or_merged() {
    let random = &mut seeded_generator(23);
    let mut merged = Vec::new();
    for _ in 0..2000 {
        let size = random.log_uniform(1e1, 3e7);
        let a = random.uniform(0.2 * size, size).round() as i64;
        let b = random.signed_log_uniform(0.2 * size, size).round() as i64;
        let lines = [[a, b], [a + 1, b]];
        let other =
            [random.uniform(1.0, 5.0).round() as i64, -random.uniform(1.0, 5.0).round() as i64];
        let gap = angular_distance(zero_angle(lines[0]), zero_angle(lines[1]));
        if lines.iter().any(|l| angular_distance(zero_angle(*l), zero_angle(other)) < 0.05 + gap) {
            continue;
        }
        let zeros = product_form(&[lines[0].to_vec(), lines[1].to_vec(), other.to_vec()]).zeros();
        let own: Vec<_> =
            zeros.iter().filter(|z| angular_distance(z.angle, zero_angle(other)) > 0.01).collect();
        match own[..] {
            [first, second] => {
                assert!(first.has_sign_change && second.has_sign_change);
                for line in lines {
                    let error = [first, second]
                        .map(|z| (angular_distance(z.angle, zero_angle(line)), z.bound))
                        .into_iter()
                        .fold((f64::MAX, 0.0), |x, y| if y.0 < x.0 { y } else { x });
                    assert!(error.0 <= error.1 + 4.0 * f64::EPSILON, "{gap:e}: {own:?}");
                    assert!(error.0 < 1e-2 * gap.max(1e-13 / gap), "{gap:e}: {own:?}");
                }
            }
            [touching] => {
                assert!(!touching.has_sign_change, "{gap:e}: {own:?}");
                let error = angular_distance(touching.angle, zero_angle(lines[0]));
                assert!(error < 2.0 * gap, "{gap:e}: {error:e}");
                merged.push(gap);
            }
            _ => panic!("{gap:e}: {zeros:?}"),
        }
    }
    let widest = merged.iter().copied().fold(0.0, f64::max);
    println!("{} merged, the widest at {widest:.1e} rad", merged.len());
    assert!(widest < 3e-7, "zeros {widest:e} apart were merged");
}

/// Verifies that definite forms, one of which nearly touches zero, have no zeros, that their products with a linear
/// factor have one, and that zeros on the axes are counted once.
#[test]
fn zeros_of_definite_factors_and_axes_are_counted() {
    for power in 1..=3 {
        let mut factors = vec![vec![1000, 2, 1000]; power];
        factors.push(vec![1, 1]);
        let zeros = product_form(&factors).zeros();
        assert_eq!(zeros.len(), 1, "{zeros:?}");
    }
    // Definite, but small along 3κ₁ = 5κ₂: (3κ₁ − 5κ₂)² 10⁶ + κ₁².
    let near = product_form(&[vec![9_000_001, -30_000_000, 25_000_000]]);
    assert!(near.zeros().is_empty());
    // Zeros on the axes.
    let zeros = product_form(&[vec![1, 0], vec![0, 1]]).zeros();
    assert_eq!(zeros.len(), 2, "{zeros:?}");
    assert!(zeros[0].angle < 1e-15 && angular_distance(zeros[1].angle, PI / 2.0) < 1e-15);
    let zeros = product_form(&[vec![0, 1]]).zeros();
    assert_eq!(zeros.len(), 1, "{zeros:?}");
    let zeros = product_form(&[vec![1, 0]]).zeros();
    assert_eq!(zeros.len(), 1, "{zeros:?}");
}
