//! Legendre polynomials and Gauss–Legendre quadrature.

use models::common::elementary::Elementary;
use std::f64::consts::PI;

/// Maximum number of Newton steps for a quadrature node; convergence is quadratic.
const NEWTON_STEPS: usize = 20;

/// Values at ξ in [−1, 1] of the Legendre polynomials Pₘ of degree m ≤ `degree`, times √(2m + 1): orthonormal for the
/// mean over [−1, 1].
pub fn normalised_legendre(degree: usize, x: f64) -> Vec<f64> {
    let mut values = legendre(degree, x);
    for (m, value) in values.iter_mut().enumerate() {
        *value *= ((2 * m + 1) as f64).sqrt();
    }
    values
}

/// Values of P₀ to P_`degree` at x by the recurrence (m + 1)Pₘ₊₁ = (2m + 1)xPₘ − mPₘ₋₁.
fn legendre(degree: usize, x: f64) -> Vec<f64> {
    let mut values = vec![1.0];
    for m in 0..degree {
        let before = if m == 0 { 0.0 } else { values[m - 1] };
        let m = m as f64;
        values.push(((2.0 * m + 1.0) * x * values[m as usize] - m * before) / (m + 1.0));
    }
    values
}

/// Nodes in (−1, 1) and weights (sum 1) of Gauss–Legendre quadrature with `count` points, exact to degree 2·count − 1.
pub fn gauss_legendre(count: usize) -> Vec<[f64; 2]> {
    let node = |index: usize| {
        let mut x = (PI * (index as f64 + 0.75) / (count as f64 + 0.5)).cr_cos();
        let mut slope = 1.0;
        for _ in 0..NEWTON_STEPS {
            let values = legendre(count, x);
            let n = count as f64;
            slope = n * (values[count - 1] - x * values[count]) / (1.0 - x * x);
            let change = values[count] / slope;
            x -= change;
            if change.abs() < f64::EPSILON {
                break;
            }
        }
        [x, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(node).collect()
}

/// Integral over [−1, 1] of the derivatives of the normalised polynomials m and n, √((2m+1)(2n+1)) ∫PₘʹPₙʹdξ.
pub fn stiffness_integral(m: usize, n: usize) -> f64 {
    let least = m.min(n);
    match (m + n).is_multiple_of(2) {
        true => (((2 * m + 1) * (2 * n + 1)) as f64).sqrt() * (least * (least + 1)) as f64,
        false => 0.0,
    }
}

/// Integral over [−1, 1] of the normalised polynomial m and the derivative of the polynomial n,
/// √((2m+1)(2n+1)) ∫PₘPₙʹdξ.
pub fn gradient_integral(m: usize, n: usize) -> f64 {
    match n > m && !(m + n).is_multiple_of(2) {
        true => 2.0 * (((2 * m + 1) * (2 * n + 1)) as f64).sqrt(),
        false => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies the closed forms of the integrals against quadrature, and that the polynomials are orthonormal.
    #[test]
    fn integrals_equal_quadrature() {
        let degree = 9;
        let nodes = gauss_legendre(degree + 1);
        let derivative = |x: f64| {
            // Pₙʹ = Σ (2k + 1) Pₖ over k = n − 1, n − 3, ….
            let values = legendre(degree, x);
            (0..=degree)
                .map(|n| {
                    let lower = (0..n).rev().step_by(2);
                    let sum: f64 = lower.map(|k| (2 * k + 1) as f64 * values[k]).sum();
                    sum * ((2 * n + 1) as f64).sqrt()
                })
                .collect::<Vec<f64>>()
        };
        for m in 0..=degree {
            for n in 0..=degree {
                let mut sums = [0.0; 3];
                for &[x, weight] in &nodes {
                    let (values, slopes) = (normalised_legendre(degree, x), derivative(x));
                    sums[0] += weight * values[m] * values[n];
                    sums[1] += 2.0 * weight * slopes[m] * slopes[n];
                    sums[2] += 2.0 * weight * values[m] * slopes[n];
                }
                let expected = [
                    f64::from(u8::from(m == n)),
                    stiffness_integral(m, n),
                    gradient_integral(m, n),
                ];
                for (sum, expected) in sums.iter().zip(expected) {
                    assert!((sum - expected).abs() < 1e-11 * (1.0 + expected), "{m} {n}");
                }
            }
        }
    }
}
