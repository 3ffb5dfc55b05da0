//! Secular equation of the rank-one update in a direction (Golub 1973): polynomial, root intervals and single roots.

use super::eigenbasis::{EigenvalueGroups, MAX_VELOCITIES};
use num_complex::Complex64;

/// Secular equation 1 = Σ w_g/(λ_g − λ) of a direction, without vanishing weights.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct SecularEquation {
    /// Number of poles λ_g.
    pub(super) pole_count: usize,
    pub(super) poles: [f64; MAX_VELOCITIES],
    pub(super) weights: [f64; MAX_VELOCITIES],
    /// Eigenvalues that the update does not change.
    pub(super) unchanged_eigenvalues: [f64; MAX_VELOCITIES],
    /// Number of eigenvalues that the update does not change.
    pub(super) unchanged_count: usize,
}

impl SecularEquation {
    /// Values of q(x) = Π_g (x − λ_g) + Σ_g w_g Π_(h≠g) (x − λ_h), which vanishes at the eigenvalues, and of q′(x).
    pub(super) fn evaluate_polynomial(&self, x: f64) -> (f64, f64) {
        let (mut product, mut product_slope, mut sum, mut sum_slope) = (1.0, 0.0, 0.0, 0.0);
        for (pole, weight) in self.poles.iter().zip(&self.weights).take(self.pole_count) {
            let distance = x - pole;
            sum_slope = sum_slope * distance + sum + weight * product_slope;
            sum = sum * distance + weight * product;
            product_slope = product_slope * distance + product;
            product *= distance;
        }
        (product + sum, product_slope + sum_slope)
    }

    /// Values of q(x) and q′(x) at a complex point; see [`evaluate_polynomial`](Self::evaluate_polynomial).
    pub(super) fn evaluate_complex_polynomial(&self, x: Complex64) -> (Complex64, Complex64) {
        let [zero, one] = [Complex64::new(0.0, 0.0), Complex64::new(1.0, 0.0)];
        let (mut product, mut product_slope, mut sum, mut sum_slope) = (one, zero, zero, zero);
        for (pole, weight) in self.poles.iter().zip(&self.weights).take(self.pole_count) {
            let distance = x - pole;
            sum_slope = sum_slope * distance + sum + product_slope * weight;
            sum = sum * distance + product * weight;
            product_slope = product_slope * distance + product;
            product *= distance;
        }
        (product + sum, product_slope + sum_slope)
    }

    /// Number of sign changes in the sequence +, w₁ … w_g, −: with one change all eigenvalues are real, with three all
    /// but at most two.
    pub(super) fn sign_changes(&self) -> usize {
        let (mut changes, mut positive) = (0, true);
        for &weight in &self.weights[..self.pole_count] {
            if (weight > 0.0) != positive {
                changes += 1;
                positive = !positive;
            }
        }
        changes + usize::from(positive)
    }

    /// Largest magnitude of the numbers in the equation, the scale of rounding.
    pub(super) fn max_magnitude(&self) -> f64 {
        let all = self.poles[..self.pole_count].iter().chain(&self.weights[..self.pole_count]);
        all.fold(0.0, |largest: f64, x| largest.max(x.abs()))
    }

    /// Interval between pole `index` − 1 and pole `index`; below the first and above the last pole, a bound on the
    /// roots replaces the missing pole.
    fn root_interval(&self, index: usize) -> (f64, f64) {
        let part = |sign: f64| {
            self.weights[..self.pole_count].iter().fold(0.0, |sum, w| sum + (sign * w).max(0.0))
        };
        let low = if index == 0 { self.poles[0] - part(1.0) } else { self.poles[index - 1] };
        let high = if index == self.pole_count {
            self.poles[index - 1] + part(-1.0)
        } else {
            self.poles[index]
        };
        (low, high)
    }

    /// Whether the interval below pole `index` (above the last pole if `index` = `count`) has an odd number of roots.
    pub(super) fn has_odd_root_count(&self, index: usize) -> bool {
        let below = index == 0 || self.weights[index - 1] > 0.0;
        let above = index < self.pole_count && self.weights[index] > 0.0;
        below == above
    }

    /// The sign of q at the upper end of the interval below pole `index`.
    pub(super) fn sign_at_upper_end(&self, index: usize) -> f64 {
        // There q = w_index Π(λ_index − λ_h), with one negative factor for each pole above.
        if index == self.pole_count {
            return 1.0;
        }
        let flips = (self.pole_count - 1 - index) % 2 == 1;
        if (self.weights[index] > 0.0) == flips { -1.0 } else { 1.0 }
    }

    /// A step from `x` towards the root of the interval below pole `index`: the zero of the interpolant
    /// c + a/(λ_below − y) + b/(λ_above − y) that matches the value of the secular function and the slopes of its sums
    /// over the poles below and above (R.-C. Li 1993, "Solving secular equations stably and efficiently"). NaN if the
    /// interpolant has no zero.
    fn rational_step(&self, index: usize, x: f64) -> f64 {
        let (mut value, mut below, mut above) = (1.0, 0.0, 0.0);
        // Loop over all `MAX_VELOCITIES` poles, with zero weights beyond the last one, so that the divisions are
        // vectorised.
        let (mut parts, mut slopes) = ([0.0; MAX_VELOCITIES], [0.0; MAX_VELOCITIES]);
        for g in 0..MAX_VELOCITIES {
            let inverse = 1.0 / (self.poles[g] - x);
            parts[g] = self.weights[g] * inverse;
            slopes[g] = parts[g] * inverse;
        }
        for g in 0..self.pole_count {
            value -= parts[g];
            if g < index { below -= slopes[g] } else { above -= slopes[g] }
        }
        if index == 0 || index == self.pole_count {
            // One pole: c + b/(λ − y).
            let (pole, slope) = match index {
                0 => (self.poles[0], above),
                _ => (self.poles[self.pole_count - 1], below),
            };
            let distance = pole - x;
            return distance * value / (value - slope * distance);
        }
        let (left, right) = (self.poles[index - 1] - x, self.poles[index] - x);
        // The step s solves c (l − s)(r − s) + a (r − s) + b (l − s) = 0, where l and r are the distances from x to the
        // poles below and above, a = `below` l² and b = `above` r².
        let constant = value - below * left - above * right;
        let (a, b) = (below * left * left, above * right * right);
        let linear = constant * (left + right) + a + b;
        let last = value * left * right;
        let root = (linear * linear - 4.0 * constant * last).sqrt();
        // Root of the quadratic that vanishes with `value`.
        2.0 * last / (linear + root.copysign(linear))
    }

    /// A root in an interval with an odd number of roots: rational steps, then Newton's method, with bisection if a
    /// step leaves the interval. `size` is [`max_magnitude`](Self::max_magnitude); `is_simple` states that no interval
    /// has three roots.
    pub(super) fn solve_root(&self, index: usize, size: f64, is_simple: bool) -> f64 {
        let (mut low, mut high) = self.root_interval(index);
        let sign = self.sign_at_upper_end(index);
        let is_inner = 0 < index && index < self.pole_count;
        // From below all roots, if these are real, Newton's method converges monotonically to the smallest one.
        let mut x = if index == 0 { low } else { 0.5 * (low + high) };
        if is_inner || is_simple {
            let mut from = x;
            for _ in 0..8 {
                let step = self.rational_step(index, from);
                let next = from + step;
                if !(next > low && next < high) {
                    break;
                }
                from = next;
                if step.abs() <= 3e-2 * (high - low) {
                    x = next;
                    break;
                }
            }
        }
        let mut last = high - low;
        let rounding = f64::EPSILON * size;
        for _ in 0..120 {
            let (value, slope) = self.evaluate_polynomial(x);
            let step = value / slope;
            // If the step is at rounding level, the sign of q is meaningless.
            if value == 0.0 || step.abs() <= rounding {
                return if value == 0.0 { x } else { (x - step).clamp(low, high) };
            }
            if value * sign > 0.0 {
                high = x;
            } else {
                low = x;
            }
            let mut next = x - step;
            if !(next > low && next < high && step.abs() <= 0.9 * last) {
                next = 0.5 * (low + high);
            }
            last = (next - x).abs();
            if last <= rounding || next == x {
                return next;
            }
            x = next;
        }
        x
    }
}

/// Assembles the secular equation: a weight w_g is the sum of the products of components of α and β over a group of
/// equal eigenvalues; weights up to `threshold` count as zero.
pub(super) fn assemble_secular_equation(
    groups: &EigenvalueGroups,
    products: &[f64],
    threshold: f64,
) -> SecularEquation {
    let mut weight = [0.0; MAX_VELOCITIES];
    for (&product, &group) in products.iter().zip(&groups.group_index) {
        weight[usize::from(group)] += product;
    }
    let mut secular = SecularEquation::default();
    let members =
        groups.values.iter().zip(&groups.multiplicities).zip(&weight).take(groups.group_count);
    for ((&value, &multiplicity), &weight) in members {
        let is_free = weight.abs() <= threshold;
        for _ in usize::from(!is_free)..usize::from(multiplicity) {
            secular.unchanged_eigenvalues[secular.unchanged_count] = value;
            secular.unchanged_count += 1;
        }
        if !is_free {
            secular.poles[secular.pole_count] = value;
            secular.weights[secular.pole_count] = weight;
            secular.pole_count += 1;
        }
    }
    secular
}
