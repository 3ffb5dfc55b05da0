//! Flutter and shear bands of a yielding solid in plane strain, over all directions of the wave normal.
//!
//! The counterpart in the plane of [`acoustic_tensor3`](crate::acoustic_tensor3), for any number of active conditions.
//! With n = (cos θ, sin θ) the acoustic tensor is
//!
//! ```text
//! Γ(θ) = cos²θ Γ₁₁ + cos θ sin θ (Γ₁₂ + Γ₂₁) + sin²θ Γ₂₂,    Γᵢⱼ = M^(−½) Gⁱᵀ D Gʲ M^(−½).
//! ```
//!
//! Here M is the diagonal inertia matrix, Gⁱ are the gradient operators and D is the tangent stiffness of the [rate
//! equations](RateEquations). Γ has two or three rows and its eigenvalues cost less than a microsecond, so the circle
//! is sampled every half degree. Narrower sectors of flutter are found only if a hint lies in them: the caller passes
//! the directions found by the verdict from the exact dispersion polynomial.

use crate::acoustic_tensor3::{Flutter, SlowestSpeed, WaveExtremes};
use crate::line_search::{argmax_unimodal, bisect, find_sectors};
use models::common::elementary::Elementary;
use models::common::product::triple_product;
use models::common::rates::RateEquations;
use nalgebra::{DMatrix, Matrix3};
use num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Number of sampled directions over half a turn.
const DIRECTION_COUNT: usize = 360;
/// Threshold of rounding for (Im c²)², relative to the square of `max_squared_speed`: a double root is perturbed by the
/// square root of the rounding.
const FLUTTER_TOLERANCE: f64 = 1e-13;
/// Threshold of rounding for |c²|, relative to `max_squared_speed`.
const ZERO_SPEED_TOLERANCE: f64 = 1e-13;
/// Number of bisection steps: to the last bit of an angle.
const BISECTION_STEPS: usize = 60;

/// The acoustic tensor of a solid in plane strain, for all directions.
#[derive(Clone, Debug)]
pub struct AcousticTensor2 {
    velocity_count: usize,
    /// Γ₁₁, Γ₁₂ + Γ₂₁, Γ₂₂, m²/s².
    terms: [Matrix3<f64>; 3],
    /// Largest Frobenius norm of the three terms, m²/s²: the scale of |c²|, which is at most 3/2 of it.
    max_squared_speed: f64,
}

impl AcousticTensor2 {
    /// Assembles the acoustic tensor from the rate equations of a solid. Velocities whose gradients are not strains
    /// (the spin of a reduced Cosserat solid) carry no waves and are omitted.
    pub fn new(equations: &RateEquations<2>) -> Self {
        let carries =
            |&v: &usize| equations.gradient.iter().any(|g| g.column(v).iter().any(|&x| x != 0.0));
        let moving: Vec<usize> = (0..equations.velocity_count()).filter(carries).collect();
        let stiffness = equations.stiffness_values();
        let strain = equations.gradient.each_ref().map(|gradient| {
            let scaled = |s: usize, v: usize| {
                gradient[(s, moving[v])] / equations.inertia[moving[v]].value.sqrt()
            };
            DMatrix::from_fn(equations.stress_count(), moving.len(), scaled)
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
        let max_squared_speed = terms.iter().map(Matrix3::norm).fold(0.0, f64::max);
        Self { velocity_count: moving.len(), terms, max_squared_speed }
    }

    /// Squared characteristic speeds c² with the wave normal (cos θ, sin θ), m²/s², by descending real part; one for
    /// each velocity that carries waves.
    pub fn squared_speeds(&self, theta: f64) -> Vec<Complex64> {
        let (values, size) = self.eigenvalues(unit_vector(theta));
        let mut values = values[..size].to_vec();
        values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
        values
    }

    /// Squared speeds, in no order, with the wave normal (`cos`, `sin`), and their number.
    fn eigenvalues(&self, [cos, sin]: [f64; 2]) -> ([Complex64; 3], usize) {
        let [first, mixed, last] = &self.terms;
        let gamma = first * (cos * cos) + mixed * (cos * sin) + last * (sin * sin);
        let pair = |a: f64, b: f64, c: f64, d: f64| {
            let (middle, half) = (0.5 * (a + d), 0.5 * (a - d));
            let root = Complex64::new(half * half + b * c, 0.0).sqrt();
            [middle + root, middle - root]
        };
        let [zero, not_a_number] = [0.0, f64::NAN].map(Complex64::from);
        let block = pair(gamma[(0, 0)], gamma[(0, 1)], gamma[(1, 0)], gamma[(1, 1)]);
        if self.velocity_count < 3 {
            return ([block[0], block[1], zero], self.velocity_count);
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

    /// Whether c² is complex beyond rounding.
    fn is_complex(&self, squared_speed: Complex64) -> bool {
        squared_speed.im * squared_speed.im
            > FLUTTER_TOLERANCE * self.max_squared_speed * self.max_squared_speed
    }

    /// Strongest flutter at `theta`: largest |Im c|, m/s, with its c², m²/s²; zero if no c² is complex beyond rounding.
    fn strongest_flutter(&self, theta: f64) -> (f64, Complex64) {
        let (values, size) = self.eigenvalues(unit_vector(theta));
        self.strongest_of(&values[..size])
    }

    /// Largest |Im c| of these squared speeds, with its c².
    fn strongest_of(&self, squared_speeds: &[Complex64]) -> (f64, Complex64) {
        squared_speeds
            .iter()
            .filter(|value| self.is_complex(**value))
            .map(|value| (value.sqrt().im.abs(), *value))
            .fold((0.0, Complex64::from(0.0)), |a, b| if b.0 > a.0 { b } else { a })
    }

    /// Smallest real c² at `theta`, m²/s²; infinite if all are complex.
    fn smallest_squared_speed(&self, theta: f64) -> f64 {
        let (values, size) = self.eigenvalues(unit_vector(theta));
        self.smallest_of(&values[..size])
    }

    /// Smallest real c² of these squared speeds.
    fn smallest_of(&self, squared_speeds: &[Complex64]) -> f64 {
        let is_real = |value: &&Complex64| !self.is_complex(**value);
        squared_speeds.iter().filter(is_real).map(|value| value.re).fold(f64::INFINITY, f64::min)
    }

    /// Strongest flutter and slowest wave over all directions; `hints` (rad) are sampled in addition to the grid.
    pub fn search_extremes(&self, hints: &[f64]) -> WaveExtremes {
        let normal = |theta: f64| [theta.cr_cos(), theta.cr_sin(), 0.0];
        // Largest |Im c| and largest −c², each with its angle.
        let mut best = [(f64::NEG_INFINITY, 0.0); 2];
        let hinted = hints.iter().map(|&angle| (angle, unit_vector(angle)));
        for (angle, direction) in sample_angles().zip(*SAMPLE_VECTORS).chain(hinted) {
            let (values, size) = self.eigenvalues(direction);
            let values = &values[..size];
            for (best, here) in
                best.iter_mut().zip([self.strongest_of(values).0, -self.smallest_of(values)])
            {
                if here > best.0 {
                    *best = (here, angle);
                }
            }
        }
        let strongest = refine_maximum(|theta| self.strongest_flutter(theta).0, best[0]);
        let slowest = refine_maximum(|theta| -self.smallest_squared_speed(theta), best[1]);
        let (max_imaginary_speed, squared_speed) = self.strongest_flutter(strongest);
        let flutter = (max_imaginary_speed > 0.0).then(|| Flutter {
            max_imaginary_speed,
            squared_speed,
            normal: normal(strongest),
        });
        let slowest = SlowestSpeed {
            squared_speed: self.smallest_squared_speed(slowest),
            normal: normal(slowest),
            rounding: ZERO_SPEED_TOLERANCE * self.max_squared_speed,
        };
        WaveExtremes { flutter, slowest }
    }

    /// Sectors of complex speeds: first and last direction, rad, the first in \[0, π); ends by bisection. `[0, π]` if
    /// speeds are complex in all sampled directions. Sectors between two samples, half a degree apart, are missed.
    pub fn flutter_sectors(&self) -> Vec<[f64; 2]> {
        let is_complex = |theta: f64| self.strongest_flutter(theta).0 > 0.0;
        find_sectors(sample_angles(), PI / DIRECTION_COUNT as f64, PI, BISECTION_STEPS, is_complex)
    }

    /// Whether the smallest real c² is zero within rounding in all sampled directions.
    pub fn is_always_stationary(&self) -> bool {
        let (tolerance, offset) =
            (ZERO_SPEED_TOLERANCE * self.max_squared_speed, 0.5 * PI / DIRECTION_COUNT as f64);
        sample_angles().all(|theta| self.smallest_squared_speed(theta + offset).abs() <= tolerance)
    }

    /// Directions of the wave normal in which a speed vanishes, rad, in \[0, π), ascending: simple and double zeros of
    /// the smallest real c². Empty if a speed vanishes in [all directions](Self::is_always_stationary).
    pub fn zero_speed_directions(&self) -> Vec<f64> {
        if self.is_always_stationary() {
            return Vec::new();
        }
        let step = PI / DIRECTION_COUNT as f64;
        // Offset the samples by half a step: zeros of symmetric solids lie at multiples of the step.
        let angles: Vec<f64> = sample_angles().map(|theta| theta + 0.5 * step).collect();
        let value = |theta: f64| self.smallest_squared_speed(theta);
        let tolerance = ZERO_SPEED_TOLERANCE * self.max_squared_speed;
        let mut found: Vec<f64> = Vec::new();
        for &theta in &angles {
            let [before, here, after] = [theta - step, theta, theta + step].map(value);
            if (here > 0.0) != (after > 0.0) && here.is_finite() && after.is_finite() {
                let [low, high] =
                    bisect([theta, theta + step], BISECTION_STEPS, |theta| value(theta) > 0.0);
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
        const MERGE_DISTANCE: f64 = 1e-5;
        for theta in &mut found {
            *theta = theta.rem_euclid(PI);
            if PI - *theta < MERGE_DISTANCE {
                *theta = 0.0;
            }
        }
        found.sort_by(f64::total_cmp);
        found.dedup_by(|a, b| (*a - *b).abs() < MERGE_DISTANCE);
        found
    }
}

/// Uniform grid of directions in [0, π), rad.
fn sample_angles() -> impl Iterator<Item = f64> {
    (0..DIRECTION_COUNT).map(|i| PI * i as f64 / DIRECTION_COUNT as f64)
}

/// (cos θ, sin θ) of the sampled directions.
static SAMPLE_VECTORS: LazyLock<[[f64; 2]; DIRECTION_COUNT]> = LazyLock::new(|| {
    let mut vectors = [[0.0; 2]; DIRECTION_COUNT];
    vectors.iter_mut().zip(sample_angles()).for_each(|(own, theta)| *own = unit_vector(theta));
    vectors
});

fn unit_vector(theta: f64) -> [f64; 2] {
    let (sin, cos) = theta.cr_sin_cos();
    [cos, sin]
}

/// Angle of the maximum of `value`: the best sample (value, angle), refined by golden sections between its neighbours.
fn refine_maximum(value: impl Fn(f64) -> f64, (best, at): (f64, f64)) -> f64 {
    let step = PI / DIRECTION_COUNT as f64;
    let refined = argmax_unimodal(&value, at - step, at + step);
    if value(refined) > best { refined } else { at }
}
