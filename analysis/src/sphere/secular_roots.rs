//! Roots of the secular equation: the smallest real root, and the pair closest to becoming complex.

use super::eigenbasis::SIZE;
use super::secular_equation::Secular;
use models::common::elementary::cr_from_polar;
use num_complex::Complex64;

/// Relative size of a weight below which it may change sign between neighbouring directions of the coarse grid.
const SLIGHT: f64 = 0.004;
/// Relative distance above which two roots do not meet between neighbouring directions of the coarse grid.
const REACH: f64 = 0.1;

/// Threshold of rounding for (Im λ)², relative to the square of the largest number in the secular equation.
const NO_FLUTTER: f64 = 1e-13;

/// A pair of eigenvalues `middle` ± √`square`, complex for `square` < 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootPair {
    pub(super) middle: f64,
    pub(super) square: f64,
}

/// The relevant eigenvalues of a direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct SecularRoots {
    /// Smallest real eigenvalue; infinite if there is none.
    pub(super) least: f64,
    /// The complex pair, or the real pair closest to becoming complex, if one can.
    pub(super) pair: Option<RootPair>,
    pub(super) is_complex: bool,
}

impl RootPair {
    /// (Im c)² = (|λ| − Re λ)/2, and its analytic continuation to real pairs of positive `middle`, where it is
    /// negative. Real pairs of negative `middle` do not flutter: −`square` is returned.
    pub(super) fn growth_squared(&self) -> f64 {
        if self.square >= 0.0 && self.middle <= 0.0 {
            return -self.square;
        }
        let modulus = (self.middle * self.middle - self.square).max(0.0).sqrt();
        if self.middle > 0.0 {
            // Equivalent form without cancellation.
            -0.5 * self.square / (modulus + self.middle)
        } else {
            0.5 * (modulus - self.middle)
        }
    }
}

impl Secular {
    /// Roots of a secular equation with two poles.
    pub(super) fn quadratic(&self) -> RootPair {
        let [first, second] = [self.pole[0] - self.weight[0], self.pole[1] - self.weight[1]];
        let half = 0.5 * (first - second);
        RootPair {
            middle: 0.5 * (first + second),
            square: half * half + self.weight[0] * self.weight[1],
        }
    }

    /// Computes the relevant eigenvalues.
    pub(super) fn roots(&self) -> SecularRoots {
        let mut least =
            self.kept[..self.kept_count].iter().fold(f64::INFINITY, |least, &x| least.min(x));
        let mut pair = None;
        match (self.count, self.changes()) {
            (0, _) => {}
            (1, _) => least = least.min(self.pole[0] - self.weight[0]),
            (2, _) => pair = Some(self.quadratic()),
            (_, 1) => (least, pair) = self.real_roots(least),
            (_, 3) => (least, pair) = self.roots_with_last_two(least),
            _ => (least, pair) = self.roots_by_aberth(least),
        }
        let mut is_complex = false;
        if let Some(pair) = &pair {
            let size = self.size();
            is_complex = pair.square < -NO_FLUTTER * size * size;
            if !is_complex {
                // Smaller root of the real pair.
                let root = pair.square.max(0.0).sqrt();
                least = least.min(pair.middle - root);
            }
        }
        SecularRoots { least, pair, is_complex }
    }

    /// For real roots only: minimum of `least` and the roots, and the pair that a small weight may make complex in a
    /// neighbouring direction.
    fn real_roots(&self, mut least: f64) -> (f64, Option<RootPair>) {
        let mut pair = None;
        let least_index = usize::from(self.weight[0] < 0.0);
        let size = self.size();
        let slight = SLIGHT * size;
        if self.weight[..self.count].iter().all(|w| w.abs() > slight) {
            least = least.min(self.root(least_index, size, true));
        } else {
            // The sign of a slight weight may change in a neighbouring direction.
            let is_slight = |pole: usize| {
                self.weight[..self.count].get(pole).is_some_and(|w| w.abs() <= slight)
            };
            let mut previous = f64::NEG_INFINITY;
            for index in (0..=self.count).filter(|&index| self.is_odd(index)) {
                let is_beside = is_slight(index) || (index > 0 && is_slight(index - 1));
                if !is_beside && index != least_index {
                    previous = f64::NEG_INFINITY;
                    continue;
                }
                let root = self.root(index, size, true);
                if root - previous < REACH * size {
                    pair = self.nearer(pair, previous, root);
                }
                least = least.min(root);
                previous = root;
            }
        }
        (least, pair)
    }

    /// With at most one complex pair: minimum of `least` and the real roots, and that pair.
    fn roots_with_last_two(&self, mut least: f64) -> (f64, Option<RootPair>) {
        let (found, rest) = self.last_two();
        let found = &found[..self.count - 2];
        least = found.iter().fold(least, |least, &x| least.min(x));
        let mut pair = Some(rest);
        if rest.square >= 0.0 {
            // If one interval has three roots, any two of them may form the pair.
            let root = rest.square.sqrt();
            least = least.min(rest.middle - root);
            let last = [rest.middle - root, rest.middle + root];
            for &x in found {
                for y in last {
                    pair = self.nearer(pair, x, y);
                }
            }
        }
        (least, pair)
    }

    /// Roots by the Aberth–Ehrlich method: minimum of `least` and the real roots, and the complex pair of strongest
    /// growth or the real pair closest to becoming complex.
    fn roots_by_aberth(&self, mut least: f64) -> (f64, Option<RootPair>) {
        let mut pair: Option<RootPair> = None;
        let all = self.all();
        let all = &all[..self.count];
        for (index, root) in all.iter().enumerate() {
            let own = RootPair { middle: root.re, square: -(root.im * root.im) };
            if root.im == 0.0 {
                least = least.min(root.re);
                for other in all[..index].iter().filter(|other| other.im == 0.0) {
                    pair = self.nearer(pair, root.re, other.re);
                }
            } else if pair.is_none_or(|p| p.growth_squared() < own.growth_squared()) {
                pair = Some(own);
            }
        }
        (least, pair)
    }

    /// The pair of real roots x, y if no pole of more than slight weight lies between them and they are closer to
    /// becoming complex than `pair`; else `pair`.
    fn nearer(&self, pair: Option<RootPair>, x: f64, y: f64) -> Option<RootPair> {
        let half = 0.5 * (x - y);
        let own = RootPair { middle: 0.5 * (x + y), square: half * half };
        let slight = SLIGHT * self.size();
        let is_between =
            |(pole, weight): (&f64, &f64)| (pole - x) * (pole - y) < 0.0 && weight.abs() > slight;
        let is_far = pair.is_some_and(|pair| pair.growth_squared() >= own.growth_squared())
            || self.pole.iter().zip(&self.weight).take(self.count).any(is_between);
        if is_far { pair } else { Some(own) }
    }

    /// One root of each interval with an odd number of roots; the remaining two by their sum and by q: −¼(difference)²
    /// = q(x)/Π(x − found) at the midpoint x between them.
    pub(super) fn last_two(&self) -> ([f64; SIZE], RootPair) {
        let (mut found, mut count) = ([0.0; SIZE], 0);
        let mut sum = 0.0;
        for index in 0..self.count {
            sum += self.pole[index] - self.weight[index];
        }
        let size = self.size();
        for index in 0..=self.count {
            if count < self.count - 2 && self.is_odd(index) {
                found[count] = self.root(index, size, false);
                sum -= found[count];
                count += 1;
            }
        }
        let mut middle = 0.5 * sum;
        // If the midpoint is close to a found root, evaluate q at a shifted point.
        let is_near = |x: f64| found[..count].iter().any(|f| (x - f).abs() <= 1e-7 * size);
        let mut shift = 0.0;
        while is_near(middle + shift) && shift < size {
            shift = if shift == 0.0 { 1e-3 * size } else { 2.0 * shift };
        }
        let at = middle + shift;
        let mut value = self.polynomial(at).0;
        for f in &found[..count] {
            value /= at - f;
        }
        let mut square = shift * shift - value;
        // The sum suffers from cancellation; if the pair is complex and well separated, Newton's method restores its
        // accuracy.
        if square < -1e-10 * size * size {
            let mut root = Complex64::new(middle, (-square).sqrt());
            for _ in 0..2 {
                let (value, slope) = self.complex_polynomial(root);
                let next = root - value / slope;
                if next.is_finite() && (next - root).norm() < 0.1 * root.im {
                    root = next;
                }
            }
            middle = root.re;
            square = -(root.im * root.im);
        }
        (found, RootPair { middle, square })
    }

    /// All roots by the Aberth–Ehrlich method; roots within rounding of the real axis are made real.
    pub(super) fn all(&self) -> [Complex64; SIZE] {
        let mut roots = [Complex64::new(0.0, 0.0); SIZE];
        let size = self.size();
        for (index, root) in roots.iter_mut().enumerate().take(self.count) {
            let weight = self.weight[index].abs();
            *root = Complex64::new(self.pole[index], 0.0)
                + cr_from_polar(weight.max(1e-3 * size), 0.7 + 1.3 * index as f64);
        }
        for _ in 0..200 {
            let mut moved: f64 = 0.0;
            for index in 0..self.count {
                let x = roots[index];
                let (value, slope) = self.complex_polynomial(x);
                if value.norm() == 0.0 {
                    continue;
                }
                let mut repulsion = Complex64::new(0.0, 0.0);
                for other in (0..self.count).filter(|&other| other != index) {
                    repulsion += (x - roots[other]).inv();
                }
                let step = (slope / value - repulsion).inv();
                if step.is_finite() {
                    roots[index] = x - step;
                    moved = moved.max(step.norm());
                }
            }
            if moved <= 1e-15 * size {
                break;
            }
        }
        let limit = NO_FLUTTER.sqrt() * size;
        for root in &mut roots[..self.count] {
            if root.im.abs() <= limit {
                root.im = 0.0;
            }
        }
        roots
    }

    /// Whether q(x) proves that all eigenvalues are real: with three changes of sign, q has the opposite sign at `x` to
    /// its sign at the ends of an interval with an even number of roots.
    pub(super) fn is_real_by(&self, x: f64) -> bool {
        let index = self.pole[..self.count].iter().take_while(|&&pole| pole < x).count();
        !self.is_odd(index) && self.polynomial(x).0 * self.sign_above(index) < 0.0
    }
}
