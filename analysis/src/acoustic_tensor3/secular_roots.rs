//! Roots of the secular equation: the smallest real root, and the pair closest to becoming complex.

use super::eigenbasis::MAX_VELOCITIES;
use super::secular_equation::SecularEquation;
use models::common::elementary::{Modulus, cr_from_polar};
use num_complex::Complex64;

/// Weights w_g below this fraction of the largest number in the secular equation may change sign between neighbouring
/// directions of the coarse grid.
const SLIGHT_WEIGHT: f64 = 0.004;
/// Distance of two roots, relative to the largest number in the secular equation, above which they do not meet between
/// neighbouring directions of the coarse grid.
const MAX_MEETING_DISTANCE: f64 = 0.1;

/// Threshold of rounding for (Im λ)², relative to the square of the largest number in the secular equation.
const FLUTTER_TOLERANCE: f64 = 1e-13;

/// A pair of eigenvalues `mean` ± √`squared_half_difference`, complex for `squared_half_difference` < 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct EigenvaluePair {
    pub(super) mean: f64,
    pub(super) squared_half_difference: f64,
}

/// The eigenvalues of Γ that matter in the search, in one direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct SecularRoots {
    /// Smallest real eigenvalue; infinite if there is none.
    pub(super) smallest_real: f64,
    /// The complex pair, or the real pair closest to becoming complex, if one can.
    pub(super) critical_pair: Option<EigenvaluePair>,
    pub(super) is_complex: bool,
}

impl SecularRoots {
    /// No eigenvalue.
    pub(super) const NONE: Self =
        Self { smallest_real: f64::INFINITY, critical_pair: None, is_complex: false };
}

impl EigenvaluePair {
    /// (Im c)² = (|λ| − Re λ)/2 of a complex pair λ = c², and its continuation to real pairs of positive `mean`, where
    /// it is not positive. Real pairs whose `mean` is not positive do not flutter: −`squared_half_difference` is
    /// returned.
    pub(super) fn squared_growth(&self) -> f64 {
        if self.squared_half_difference >= 0.0 && self.mean <= 0.0 {
            return -self.squared_half_difference;
        }
        let modulus = (self.mean * self.mean - self.squared_half_difference).max(0.0).sqrt();
        if self.mean > 0.0 {
            // Equivalent form without cancellation.
            -0.5 * self.squared_half_difference / (modulus + self.mean)
        } else {
            0.5 * (modulus - self.mean)
        }
    }
}

impl SecularEquation {
    /// Roots of a secular equation with two poles.
    pub(super) fn solve_quadratic(&self) -> EigenvaluePair {
        let [first, second] = [self.poles[0] - self.weights[0], self.poles[1] - self.weights[1]];
        let half = 0.5 * (first - second);
        EigenvaluePair {
            mean: 0.5 * (first + second),
            squared_half_difference: half * half + self.weights[0] * self.weights[1],
        }
    }

    /// Whether all eigenvalues are real here and in neighbouring directions of the coarse grid, by the signs of the
    /// weights.
    pub(super) fn is_far_from_flutter(&self) -> bool {
        let slight = SLIGHT_WEIGHT * self.max_magnitude();
        self.sign_changes() == 1 && self.weights[..self.pole_count].iter().all(|w| w.abs() > slight)
    }

    /// Computes the smallest real eigenvalue and the critical pair.
    pub(super) fn solve_roots(&self) -> SecularRoots {
        let mut smallest_real = self.unchanged_eigenvalues[..self.unchanged_count]
            .iter()
            .fold(f64::INFINITY, |smallest_real, &x| smallest_real.min(x));
        let mut pair = None;
        match (self.pole_count, self.sign_changes()) {
            (0, _) => {}
            (1, _) => smallest_real = smallest_real.min(self.poles[0] - self.weights[0]),
            (2, _) => pair = Some(self.solve_quadratic()),
            (_, 1) => (smallest_real, pair) = self.solve_real_roots(smallest_real),
            (_, 3) => (smallest_real, pair) = self.solve_with_deflated_pair(smallest_real),
            _ => (smallest_real, pair) = self.solve_by_aberth(smallest_real),
        }
        let mut is_complex = false;
        if let Some(pair) = &pair {
            let size = self.max_magnitude();
            is_complex = pair.squared_half_difference < -FLUTTER_TOLERANCE * size * size;
            if !is_complex {
                // Smaller root of the real pair.
                let root = pair.squared_half_difference.max(0.0).sqrt();
                smallest_real = smallest_real.min(pair.mean - root);
            }
        }
        SecularRoots { smallest_real, critical_pair: pair, is_complex }
    }

    /// For real roots only: minimum of `smallest_real` and the smallest root, and the pair that a small weight may make
    /// complex in a neighbouring direction.
    fn solve_real_roots(&self, mut smallest_real: f64) -> (f64, Option<EigenvaluePair>) {
        let mut pair = None;
        let least_index = usize::from(self.weights[0] < 0.0);
        let size = self.max_magnitude();
        let slight = SLIGHT_WEIGHT * size;
        if self.weights[..self.pole_count].iter().all(|w| w.abs() > slight) {
            smallest_real = smallest_real.min(self.solve_root(least_index, size, true));
        } else {
            // The sign of a slight weight may change in a neighbouring direction.
            let is_slight = |pole: usize| {
                self.weights[..self.pole_count].get(pole).is_some_and(|w| w.abs() <= slight)
            };
            let mut previous = f64::NEG_INFINITY;
            for index in (0..=self.pole_count).filter(|&index| self.has_odd_root_count(index)) {
                let is_beside = is_slight(index) || (index > 0 && is_slight(index - 1));
                if !is_beside && index != least_index {
                    previous = f64::NEG_INFINITY;
                    continue;
                }
                let root = self.solve_root(index, size, true);
                if root - previous < MAX_MEETING_DISTANCE * size {
                    pair = self.more_critical_pair(pair, previous, root);
                }
                smallest_real = smallest_real.min(root);
                previous = root;
            }
        }
        (smallest_real, pair)
    }

    /// With at most one complex pair: minimum of `smallest_real` and the real roots, and the complex pair or, if all
    /// roots are real, the pair closest to becoming complex.
    fn solve_with_deflated_pair(&self, mut smallest_real: f64) -> (f64, Option<EigenvaluePair>) {
        let (found, rest) = self.deflate_to_pair();
        let found = &found[..self.pole_count - 2];
        smallest_real = found.iter().fold(smallest_real, |smallest_real, &x| smallest_real.min(x));
        let mut pair = Some(rest);
        if rest.squared_half_difference >= 0.0 {
            // If one interval has three roots, any two of them may form the pair.
            let root = rest.squared_half_difference.sqrt();
            smallest_real = smallest_real.min(rest.mean - root);
            let last = [rest.mean - root, rest.mean + root];
            for &x in found {
                for y in last {
                    pair = self.more_critical_pair(pair, x, y);
                }
            }
        }
        (smallest_real, pair)
    }

    /// Roots by the Aberth–Ehrlich method: minimum of `smallest_real` and the real roots, and the complex pair of
    /// strongest growth or the real pair closest to becoming complex.
    fn solve_by_aberth(&self, mut smallest_real: f64) -> (f64, Option<EigenvaluePair>) {
        let mut pair: Option<EigenvaluePair> = None;
        let all = self.iterate_aberth();
        let all = &all[..self.pole_count];
        for (index, root) in all.iter().enumerate() {
            let own =
                EigenvaluePair { mean: root.re, squared_half_difference: -(root.im * root.im) };
            if root.im == 0.0 {
                smallest_real = smallest_real.min(root.re);
                for other in all[..index].iter().filter(|other| other.im == 0.0) {
                    pair = self.more_critical_pair(pair, root.re, other.re);
                }
            } else if pair.is_none_or(|p| p.squared_growth() < own.squared_growth()) {
                pair = Some(own);
            }
        }
        (smallest_real, pair)
    }

    /// The pair of real roots x, y if no pole of more than slight weight lies between them and they are closer to
    /// becoming complex than `pair`; else `pair`.
    fn more_critical_pair(
        &self,
        pair: Option<EigenvaluePair>,
        x: f64,
        y: f64,
    ) -> Option<EigenvaluePair> {
        let half = 0.5 * (x - y);
        let own = EigenvaluePair { mean: 0.5 * (x + y), squared_half_difference: half * half };
        let slight = SLIGHT_WEIGHT * self.max_magnitude();
        let is_between =
            |(pole, weight): (&f64, &f64)| (pole - x) * (pole - y) < 0.0 && weight.abs() > slight;
        let is_far = pair.is_some_and(|pair| pair.squared_growth() >= own.squared_growth())
            || self.poles.iter().zip(&self.weights).take(self.pole_count).any(is_between);
        if is_far { pair } else { Some(own) }
    }

    /// One root of each interval with an odd number of roots; the remaining two by their sum and by q: −¼(difference)²
    /// = q(x)/Π(x − found) at the midpoint x between them.
    pub(super) fn deflate_to_pair(&self) -> ([f64; MAX_VELOCITIES], EigenvaluePair) {
        let (mut found, mut count) = ([0.0; MAX_VELOCITIES], 0);
        let mut sum = 0.0;
        for index in 0..self.pole_count {
            sum += self.poles[index] - self.weights[index];
        }
        let size = self.max_magnitude();
        for index in 0..=self.pole_count {
            if count < self.pole_count - 2 && self.has_odd_root_count(index) {
                found[count] = self.solve_root(index, size, false);
                sum -= found[count];
                count += 1;
            }
        }
        let mut mean = 0.5 * sum;
        // If the midpoint is close to a found root, evaluate q at a shifted point.
        let is_near = |x: f64| found[..count].iter().any(|f| (x - f).abs() <= 1e-7 * size);
        let mut shift = 0.0;
        while is_near(mean + shift) && shift < size {
            shift = if shift == 0.0 { 1e-3 * size } else { 2.0 * shift };
        }
        let at = mean + shift;
        let mut value = self.evaluate_polynomial(at).0;
        for f in &found[..count] {
            value /= at - f;
        }
        let mut squared_half_difference = shift * shift - value;
        // The sum suffers from cancellation; if the pair is complex and well separated, Newton's method restores its
        // accuracy.
        if squared_half_difference < -1e-10 * size * size {
            let mut root = Complex64::new(mean, (-squared_half_difference).sqrt());
            for _ in 0..2 {
                let (value, slope) = self.evaluate_complex_polynomial(root);
                let next = root - value / slope;
                if next.is_finite() && (next - root).modulus() < 0.1 * root.im {
                    root = next;
                }
            }
            mean = root.re;
            squared_half_difference = -(root.im * root.im);
        }
        (found, EigenvaluePair { mean, squared_half_difference })
    }

    /// All roots by the Aberth–Ehrlich method; roots within rounding of the real axis are made real.
    pub(super) fn iterate_aberth(&self) -> [Complex64; MAX_VELOCITIES] {
        let mut roots = [Complex64::new(0.0, 0.0); MAX_VELOCITIES];
        let size = self.max_magnitude();
        for (index, root) in roots.iter_mut().enumerate().take(self.pole_count) {
            let weight = self.weights[index].abs();
            *root = Complex64::new(self.poles[index], 0.0)
                + cr_from_polar(weight.max(1e-3 * size), 0.7 + 1.3 * index as f64);
        }
        for _ in 0..200 {
            let mut moved: f64 = 0.0;
            for index in 0..self.pole_count {
                let x = roots[index];
                let (value, slope) = self.evaluate_complex_polynomial(x);
                if value.modulus() == 0.0 {
                    continue;
                }
                let mut repulsion = Complex64::new(0.0, 0.0);
                for other in (0..self.pole_count).filter(|&other| other != index) {
                    repulsion += (x - roots[other]).inv();
                }
                let step = (slope / value - repulsion).inv();
                if step.is_finite() {
                    roots[index] = x - step;
                    moved = moved.max(step.modulus());
                }
            }
            if moved <= 1e-15 * size {
                break;
            }
        }
        let limit = FLUTTER_TOLERANCE.sqrt() * size;
        for root in &mut roots[..self.pole_count] {
            if root.im.abs() <= limit {
                root.im = 0.0;
            }
        }
        roots
    }

    /// Whether q proves, at one point in each of the two intervals beside the negative weights, that all eigenvalues are
    /// real; with three changes of sign. The points are those where the sum of two terms w/(λ_g − λ) of opposite sides is
    /// stationary.
    pub(super) fn has_real_roots_by_signs(&self) -> bool {
        let weights = &self.weights[..self.pole_count];
        let Some(first) = weights.iter().position(|&w| w < 0.0) else { return true };
        let end = first + weights[first..].iter().take_while(|&&w| w < 0.0).count();
        let size = |range: &[f64]| range.iter().sum::<f64>().abs().sqrt();
        let [below, middle, above] =
            [&weights[..first], &weights[first..end], &weights[end..]].map(size);
        let point_between = |low: usize, from_low: f64, from_high: f64| {
            let share = from_low / (from_low + from_high);
            self.poles[low] + share * (self.poles[low + 1] - self.poles[low])
        };
        (end < self.pole_count
            && self.has_real_roots_by_sign_at(point_between(end - 1, middle, above)))
            || (first > 0
                && self.has_real_roots_by_sign_at(point_between(first - 1, below, middle)))
    }

    /// Whether q(x) proves that all eigenvalues are real: with three changes of sign, q has the opposite sign at `x` to
    /// its sign at the ends of an interval with an even number of roots.
    pub(super) fn has_real_roots_by_sign_at(&self, x: f64) -> bool {
        let index = self.poles[..self.pole_count].iter().take_while(|&&pole| pole < x).count();
        !self.has_odd_root_count(index)
            && self.evaluate_polynomial(x).0 * self.sign_at_upper_end(index) < 0.0
    }
}
