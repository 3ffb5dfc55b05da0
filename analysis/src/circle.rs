//! Flutter and shear bands of a yielding solid in plane strain, over all directions of the wave normal.
//!
//! The counterpart in the plane of [`sphere`](crate::sphere), for any number of active conditions. With
//! n = (cos θ, sin θ) the acoustic tensor is
//!
//! ```text
//! Γ(θ) = cos²θ Γ₁₁ + cos θ sin θ (Γ₁₂ + Γ₂₁) + sin²θ Γ₂₂,    Γᵢⱼ = M^(−½) Gⁱᵀ D Gʲ M^(−½).
//! ```
//!
//! The matrix has two or three rows and its eigenvalues cost less than a microsecond, so the circle is sampled every
//! half degree. Narrower sectors of flutter are found only if a hint lies in them: the caller passes the directions
//! found by the verdict from the exact dispersion polynomial.

use crate::search::{argmax_unimodal, bisect, sectors};
use crate::sphere::{Extremes, Flutter, Slowest};
use models::common::elementary::Elementary;
use models::common::product::triple_product;
use models::common::rates::RateEquations;
use nalgebra::{DMatrix, Matrix3};
use num_complex::Complex64;
use std::f64::consts::PI;

/// Directions sampled over half a turn.
const DIRECTIONS: usize = 360;
/// Threshold of rounding for (Im c²)², relative to the largest |c²|²: a double root is perturbed by the square root of
/// the rounding.
const NO_FLUTTER: f64 = 1e-13;
/// Threshold of rounding for |c²|, relative to the largest |c²|.
const NO_SPEED: f64 = 1e-13;
/// Number of bisection steps: to the last bit of an angle.
const STEPS: usize = 60;

/// The acoustic tensor of a solid in plane strain, for all directions.
#[derive(Clone, Debug)]
pub struct AcousticTensor2 {
    size: usize,
    /// Γ₁₁, Γ₁₂ + Γ₂₁, Γ₂₂, m²/s².
    terms: [Matrix3<f64>; 3],
    /// Bound on |c²| over all directions, m²/s².
    unit: f64,
}

impl AcousticTensor2 {
    /// Assembles the acoustic tensor from the rate equations of a solid. Velocities whose gradients are not strains
    /// (the spin of a reduced Cosserat solid) carry no waves and are omitted.
    pub fn new(equations: &RateEquations<2>) -> Self {
        let carries =
            |&v: &usize| equations.gradient.iter().any(|g| g.column(v).iter().any(|&x| x != 0.0));
        let moving: Vec<usize> = (0..equations.velocities()).filter(carries).collect();
        let stiffness = equations.stiffness_values();
        let strain = equations.gradient.each_ref().map(|gradient| {
            let scaled = |s: usize, v: usize| {
                gradient[(s, moving[v])] / equations.inertia[moving[v]].value.sqrt()
            };
            DMatrix::from_fn(equations.stresses(), moving.len(), scaled)
        });
        let between = |i: usize, j: usize| {
            let product = triple_product(&strain[i].transpose(), &stiffness, &strain[j]);
            let entry = |a: usize, b: usize| match a.max(b) < moving.len() {
                true => product[(a, b)],
                false => 0.0,
            };
            Matrix3::from_fn(entry)
        };
        let terms = [between(0, 0), between(0, 1) + between(1, 0), between(1, 1)];
        let unit = terms.iter().map(Matrix3::norm).fold(0.0, f64::max);
        Self { size: moving.len(), terms, unit }
    }

    /// Squared characteristic speeds c² with the wave normal (cos θ, sin θ), m²/s², by descending real part; one for
    /// each velocity that carries waves.
    pub fn squared_speeds(&self, theta: f64) -> Vec<Complex64> {
        let (values, size) = self.eigenvalues(theta);
        let mut values = values[..size].to_vec();
        values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        values
    }

    fn eigenvalues(&self, theta: f64) -> ([Complex64; 3], usize) {
        let (sin, cos) = theta.cr_sin_cos();
        let [first, mixed, last] = &self.terms;
        let gamma = first * (cos * cos) + mixed * (cos * sin) + last * (sin * sin);
        let pair = |a: f64, b: f64, c: f64, d: f64| {
            let (middle, half) = (0.5 * (a + d), 0.5 * (a - d));
            let root = Complex64::new(half * half + b * c, 0.0).sqrt();
            [middle + root, middle - root]
        };
        let [zero, not_a_number] = [0.0, f64::NAN].map(Complex64::from);
        let block = pair(gamma[(0, 0)], gamma[(0, 1)], gamma[(1, 0)], gamma[(1, 1)]);
        if self.size < 3 {
            return ([block[0], block[1], zero], self.size);
        }
        let coupling = [(0, 2), (1, 2), (2, 0), (2, 1)].map(|entry| gamma[entry]);
        if coupling == [0.0; 4] {
            return ([block[0], block[1], gamma[(2, 2)].into()], 3);
        }
        if !gamma.iter().all(|x| x.is_finite()) {
            return ([not_a_number; 3], 3);
        }
        let all = gamma.complex_eigenvalues();
        ([all[0], all[1], all[2]], 3)
    }

    /// Strongest flutter at `theta`: largest |Im c|, m/s, with its c², m²/s²; zero if no pair is complex.
    fn flutter(&self, theta: f64) -> (f64, Complex64) {
        let (values, size) = self.eigenvalues(theta);
        let is_complex =
            |value: &&Complex64| value.im * value.im > NO_FLUTTER * self.unit * self.unit;
        values[..size]
            .iter()
            .filter(is_complex)
            .map(|value| (value.sqrt().im.abs(), *value))
            .fold((0.0, Complex64::from(0.0)), |a, b| if b.0 > a.0 { b } else { a })
    }

    /// Smallest real c² at `theta`, m²/s²; infinite if all are complex.
    fn least(&self, theta: f64) -> f64 {
        let (values, size) = self.eigenvalues(theta);
        let is_real =
            |value: &&Complex64| value.im * value.im <= NO_FLUTTER * self.unit * self.unit;
        values[..size].iter().filter(is_real).map(|value| value.re).fold(f64::INFINITY, f64::min)
    }

    /// Strongest flutter and slowest wave over all directions; `hints` (rad) are sampled in addition to the grid.
    pub fn search(&self, hints: &[f64]) -> Extremes {
        let angles: Vec<f64> = angles().chain(hints.iter().copied()).collect();
        let normal = |theta: f64| [theta.cr_cos(), theta.cr_sin(), 0.0];
        let strongest = greatest(|theta| self.flutter(theta).0, &angles);
        let (growth, speed_squared) = self.flutter(strongest);
        let flutter =
            (growth > 0.0).then(|| Flutter { growth, speed_squared, normal: normal(strongest) });
        let slowest = greatest(|theta| -self.least(theta), &angles);
        let slowest = Slowest {
            speed_squared: self.least(slowest),
            normal: normal(slowest),
            rounding: NO_SPEED * self.unit,
        };
        Extremes { flutter, slowest }
    }

    /// Sectors of complex speeds: first and last direction, rad, the first in \[0, π); ends by bisection. `[0, π]` if
    /// speeds are complex in all directions.
    pub fn flutter_sectors(&self) -> Vec<[f64; 2]> {
        let is_complex = |theta: f64| self.flutter(theta).0 > 0.0;
        sectors(angles(), PI / DIRECTIONS as f64, PI, STEPS, is_complex)
    }

    /// Whether some c² is zero in all directions.
    pub fn is_always_stationary(&self) -> bool {
        let (tolerance, offset) = (NO_SPEED * self.unit, 0.5 * PI / DIRECTIONS as f64);
        angles().all(|theta| self.least(theta + offset).abs() <= tolerance)
    }

    /// Directions of the wave normal in which a speed vanishes, rad, in \[0, π), ascending: simple and double zeros of
    /// c². Empty if a speed vanishes in [all directions](Self::is_always_stationary).
    pub fn vanishing(&self) -> Vec<f64> {
        if self.is_always_stationary() {
            return Vec::new();
        }
        let step = PI / DIRECTIONS as f64;
        // Offset the samples by half a step: zeros of symmetric solids lie at multiples of the step.
        let angles: Vec<f64> = angles().map(|theta| theta + 0.5 * step).collect();
        let value = |theta: f64| self.least(theta);
        let tolerance = NO_SPEED * self.unit;
        let mut found: Vec<f64> = Vec::new();
        for &theta in &angles {
            let [before, here, after] = [theta - step, theta, theta + step].map(value);
            if (here > 0.0) != (after > 0.0) && here.is_finite() && after.is_finite() {
                let [low, high] = bisect([theta, theta + step], STEPS, |theta| value(theta) > 0.0);
                // A jump marks the end of a sector of flutter, where a pair becomes complex; it is no zero.
                if value(low).abs().max(value(high).abs()) <= 1e3 * tolerance {
                    found.push(0.5 * (low + high));
                }
            } else if here.abs() <= before.abs() && here.abs() <= after.abs() {
                let touching =
                    argmax_unimodal(|theta| -value(theta).abs(), theta - step, theta + step);
                if value(touching).abs() <= tolerance {
                    found.push(touching);
                }
            }
        }
        // A double zero is located to the square root of the rounding only.
        const SAME: f64 = 1e-5;
        for theta in &mut found {
            *theta = theta.rem_euclid(PI);
            if PI - *theta < SAME {
                *theta = 0.0;
            }
        }
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < SAME);
        found
    }
}

/// Uniform grid of directions in [0, π), rad.
fn angles() -> impl Iterator<Item = f64> {
    (0..DIRECTIONS).map(|i| PI * i as f64 / DIRECTIONS as f64)
}

/// Angle of the maximum of `value`: the best of `angles`, refined by golden sections between its neighbours.
fn greatest(value: impl Fn(f64) -> f64, angles: &[f64]) -> f64 {
    let step = PI / DIRECTIONS as f64;
    let (mut best, mut at) = (f64::NEG_INFINITY, 0.0);
    for &angle in angles {
        let here = value(angle);
        if here > best {
            (best, at) = (here, angle);
        }
    }
    let refined = argmax_unimodal(&value, at - step, at + step);
    if value(refined) > best { refined } else { at }
}
