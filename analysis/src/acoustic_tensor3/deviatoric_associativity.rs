//! Absence of flutter and slowest wave by forms over the sphere, for deviatorically associated flow of isotropic solids.
//!
//! The sets of von Mises, Drucker and Prager, and their Cosserat counterparts, have a normal and a flow direction that
//! differ by a multiple of the unit tensor in the force stress only. Then, with T and C constant matrices, tr T = 0,
//! and κ > 0,
//!
//! ```text
//! α = (T + a₀)ν,  β = κ (T + b₀)ν  in the translations,   α = Cν,  β = κCν  in the spins,
//! w_p = κ (d + a₀)(d + b₀),  w_s = κ (|Tν|² − d²),  w_m = κ e²,  w_w = κ (|Cν|² − e²),   d = ν·Tν,  e = ν·Cν,
//! ```
//!
//! on longitudinal (p) and shear (s) waves and on the torsion (m) and rotation (w) waves of the spins, whose squared
//! speeds c_g² do not depend on ν. Only w_p may be negative; −w_p is at most N, the maximum of a quadratic over the
//! range of d, which is that of the principal values of the symmetric part of T.
//!
//! **Flutter.** All speeds are real if N = 0 or no wave faster than c_p has a weight: the signs of the weights in the order
//! of the poles then change only once. Else let c² be the squared speed of the slowest wave faster than
//! c_p. With c_p² < λ < c² and F(λ) = Σ w_g/(c_g² − λ), F ≤ 1 proves that two roots are real, in intervals beside λ,
//! and the others are real by the signs at the poles. This holds in all directions at one λ if √N + √V ≤ √(c² − c_p²)
//! with V = κ|C|² ≥ w_m + w_w, since N/(λ − c_p²) + V/(c² − λ) has the minimum (√N + √V)²/(c² − c_p²); or, more sharply,
//! if the [maximum of F over the sphere](super::secular_form) is below 1.
//!
//! **Slowest wave.** Below all c_g² the smallest eigenvalue of a direction is the smallest root of F(λ) = 1. The number of
//! roots there is odd. It is one with a single change of sign, and in all directions if the speeds are proved real as
//! above, since counting by the signs at the poles leaves no further roots. F ≤ 1 at λ* then proves that the direction
//! has no root below λ*. The least root λ* over all directions is that of max F = 1, found by Dinkelbach's iteration: λ
//! ← root in the direction ν that maximises F at the last λ (W. Dinkelbach, Management Science 13 (1967) 492–498).
//!
//! Without couple stress and with symmetric T the maximum is in the plane of the greatest and the least principal value
//! d₁ and d₃ of T, since for given d the largest w_s is κ(d₁ − d)(d − d₃). F is then a quadratic in d with the maximum at
//! d* = [(a₀ + b₀)(c_s² − λ) + (d₁ + d₃)(c_p² − λ)]/2(c_p² − c_s²), and max F = 1 a quadratic equation for λ if d* is
//! between d₃ and d₁. This is the start of the iteration, and its end in such solids.

use super::eigenbasis::{diagonalise, new_identity};
use super::isotropic_waves::IsotropicWaves;
use super::secular_form::SecularForm;
use super::tensor_update::TensorUpdate;
use nalgebra::{Matrix3, Vector3};

/// Tolerance of the test for deviatoric associativity, relative to the size of the matrices.
const ASSOCIATIVITY_TOLERANCE: f64 = 1e-13;
/// Margin of the strict inequalities, relative.
const MARGIN: f64 = 1e-9;

/// An isotropic solid under deviatorically associated flow.
pub(super) struct AssociatedDeviators<'a> {
    waves: &'a IsotropicWaves,
    update: &'a TensorUpdate,
    /// Factor κ > 0 of β relative to α.
    factor: f64,
    /// Multiples a₀ and b₀ of the unit matrix.
    offsets: [f64; 2],
    /// Symmetric parts S and E of T and C.
    symmetric: [Matrix3<f64>; 2],
    /// TᵀT and CᵀC.
    gram: [Matrix3<f64>; 2],
    /// Eigenvalues of S, ascending, with the eigenvectors.
    principal: [(f64, Vector3<f64>); 3],
    /// Squared speeds c_p², c_s², c_m², c_w²; those of the spins are infinite if C = 0.
    squared_speeds: [f64; 4],
    /// Upper bound N on −w_p.
    max_negative_weight: f64,
}

impl<'a> AssociatedDeviators<'a> {
    /// Tests whether flow is deviatorically associated and the methods here apply: c_s ≤ c_p, and c_w ≤ c_m if C ≠ 0.
    pub(super) fn new(waves: &'a IsotropicWaves, update: &'a TensorUpdate) -> Option<Self> {
        let part = |rows: &[[f64; 3]], first: usize| {
            Matrix3::from_fn(|i, j| rows.get(first + i).map_or(0.0, |row| row[j]))
        };
        let has_spins = waves.squared_speeds().len() == 4;
        let [translations, spins] = [0, 3].map(|first| {
            [&update.alpha, &update.beta].map(|rows| {
                if first == 0 || has_spins { part(rows, first) } else { Matrix3::zeros() }
            })
        });
        let means = translations.each_ref().map(|matrix| matrix.trace() / 3.0);
        let [traction, other_traction] = [0, 1].map(|i| {
            let mut deviator = translations[i];
            (0..3).for_each(|axis| deviator[(axis, axis)] -= means[i]);
            deviator
        });
        let [couple, other_couple] = spins;
        let size = traction.norm_squared() + couple.norm_squared();
        let factor = (traction.dot(&other_traction) + couple.dot(&other_couple)) / size;
        let defect =
            (other_traction - traction * factor).amax() + (other_couple - couple * factor).amax();
        let scale = factor * (translations[0].amax() + couple.amax());
        if !(factor > 0.0 && defect <= ASSOCIATIVITY_TOLERANCE * scale) {
            return None;
        }
        let mut squared_speeds = [f64::INFINITY; 4];
        let count = if couple.amax() > 0.0 { 4 } else { 2 };
        squared_speeds[..count].copy_from_slice(&waves.squared_speeds()[..count]);
        let [longitudinal, shear, torsion, rotation] = squared_speeds;
        if shear > longitudinal || rotation > torsion {
            return None;
        }
        let symmetric = [traction, couple].map(|matrix| (matrix + matrix.transpose()) * 0.5);
        let mut own = Self {
            waves,
            update,
            factor,
            offsets: [means[0], means[1] / factor],
            symmetric,
            gram: [traction, couple].map(|matrix| matrix.transpose() * matrix),
            principal: principal_values(&symmetric[0]),
            squared_speeds,
            max_negative_weight: 0.0,
        };
        own.max_negative_weight = own.bound_negative_weight();
        Some(own)
    }

    /// Computes N: the largest −κ(d + a₀)(d + b₀) over the range of d, or 0.
    fn bound_negative_weight(&self) -> f64 {
        let [a, b] = self.offsets;
        let d = (-0.5 * (a + b)).clamp(self.principal[0].0, self.principal[2].0);
        (-self.factor * (d + a) * (d + b)).max(0.0)
    }

    /// The secular function at λ as a form in the wave normal.
    fn form_at(&self, lambda: f64) -> SecularForm<'_> {
        let [p, s, m, w] = self.squared_speeds.map(|c| self.factor / (c - lambda));
        let [a, b] = self.offsets;
        SecularForm {
            quadratic: self.gram[0] * s
                + self.symmetric[0] * (p * (a + b))
                + self.gram[1] * w
                + Matrix3::from_diagonal_element(p * a * b),
            factors: [s - p, w - m],
            squared: &self.symmetric,
        }
    }

    /// Whether it is proved that all speeds are real in all directions.
    pub(super) fn excludes_flutter(&self) -> bool {
        let [longitudinal, _, torsion, rotation] = self.squared_speeds;
        let is_faster = |c: f64| c.is_finite() && c > (1.0 + MARGIN) * longitudinal;
        if self.max_negative_weight == 0.0 || !is_faster(torsion) {
            return true;
        }
        let least = if is_faster(rotation) { rotation } else { torsion };
        let (negative, positive) =
            (self.max_negative_weight.sqrt(), (self.factor * self.gram[1].trace()).sqrt());
        let room = least - longitudinal;
        if negative + positive <= (1.0 - MARGIN) * room.sqrt() {
            return true;
        }
        // Between two faster waves the form would not be concave in e.
        if !is_faster(rotation) {
            return false;
        }
        let (mut low, mut high) = (longitudinal, rotation);
        let mut lambda = longitudinal + room * negative / (negative + positive);
        let mut normal = self.start();
        for _ in 0..12 {
            let found = self.form_at(lambda).maximise(normal);
            if found.is_global && found.value < 1.0 - MARGIN {
                return true;
            }
            normal = found.normal;
            let weights = self.weights_at(&normal);
            let (value, slope) = self.secular_function(&weights, lambda);
            if value < 1.0 - MARGIN {
                return false;
            }
            if slope > 0.0 {
                high = lambda
            } else {
                low = lambda
            }
            // The minimum of the secular function in this direction, by bisection of its slope.
            let (mut left, mut right) = (low, high);
            for _ in 0..20 {
                let middle = 0.5 * (left + right);
                if self.secular_function(&weights, middle).1 > 0.0 {
                    right = middle;
                } else {
                    left = middle;
                }
            }
            lambda = 0.5 * (left + right);
            if self.secular_function(&weights, lambda).0 >= 1.0 - MARGIN {
                return false;
            }
        }
        false
    }

    /// Weights w_p, w_s, w_m, w_w in the direction `normal`.
    fn weights_at(&self, normal: &Vector3<f64>) -> [f64; 4] {
        let [d, e] = self.symmetric.each_ref().map(|matrix| normal.dot(&(matrix * normal)));
        let [square, couple_square] = self.gram.each_ref().map(|gram| normal.dot(&(gram * normal)));
        let [a, b] = self.offsets;
        [(d + a) * (d + b), square - d * d, e * e, couple_square - e * e].map(|x| self.factor * x)
    }

    /// F(λ) = Σ w_g/(c_g² − λ) and its slope.
    fn secular_function(&self, weights: &[f64; 4], lambda: f64) -> (f64, f64) {
        weights.iter().zip(self.squared_speeds).fold((0.0, 0.0), |(value, slope), (weight, c)| {
            let inverse = 1.0 / (c - lambda);
            (value + weight * inverse, slope + weight * inverse * inverse)
        })
    }

    /// The wave (normal, c²) at whose c² the maximum of F over all directions is proved to be 1; `None` if the certificate
    /// is missing. If [all speeds are real](Self::excludes_flutter), it is the slowest wave over all directions.
    pub(super) fn slowest_wave(&self) -> Option<([f64; 3], f64)> {
        let lowest = self.squared_speeds.into_iter().fold(f64::INFINITY, f64::min);
        let root_at = |normal: &Vector3<f64>| {
            self.waves
                .secular_equation_at(self.update, &(*normal).into())
                .solve_roots()
                .smallest_real
        };
        let mut normal = self.start();
        let mut lambda = root_at(&normal);
        if lambda >= lowest {
            normal = (self.principal[0].1 + self.principal[2].1).normalize();
            lambda = root_at(&normal);
        }
        for _ in 0..40 {
            if lambda.is_nan() || lambda >= lowest {
                return None;
            }
            let form = self.form_at(lambda);
            let found = form.maximise(normal);
            let next = root_at(&found.normal);
            let is_lower = next < lambda - 4.0 * f64::EPSILON * lambda.abs();
            if next <= lambda {
                (normal, lambda) = (found.normal, next);
            }
            if !is_lower {
                return found.is_global.then(|| (normal.into(), lambda));
            }
        }
        None
    }

    /// The direction of the slowest wave without couple stress and antisymmetric stress.
    fn start(&self) -> Vector3<f64> {
        let [(low, last), _, (high, first)] = self.principal;
        let [a, b] = self.offsets;
        let (range, sum, offset) = (high - low, high + low, a + b);
        let gap = self.squared_speeds[0] - self.squared_speeds[1];
        // The quadratic equation x Y² + y Y = z for Y = c_s² − λ.
        let x = 1.0 - self.factor * (offset + sum) * (offset + sum) / (4.0 * gap);
        let y = gap - self.factor * (0.5 * (offset + sum) * sum + a * b - high * low);
        let z = 0.25 * self.factor * gap * range * range;
        let root = (y * y + 4.0 * x * z).sqrt();
        let slowness = if y > 0.0 { 2.0 * z / (y + root) } else { (root - y) / (2.0 * x) };
        let d = (offset * slowness + sum * (slowness + gap)) / (2.0 * gap);
        let share = (d - low) / range;
        if !share.is_finite() {
            return (first + last).normalize();
        }
        let share = share.clamp(0.0, 1.0);
        first * share.sqrt() + last * (1.0 - share).sqrt()
    }
}

/// Eigenvalues, ascending, and eigenvectors of a symmetric matrix.
fn principal_values(matrix: &Matrix3<f64>) -> [(f64, Vector3<f64>); 3] {
    let (mut work, mut basis) = (new_identity(), new_identity());
    for i in 0..3 {
        for j in 0..3 {
            work[i][j] = matrix[(i, j)];
        }
    }
    diagonalise(&mut work, &mut basis, (0, 3));
    std::array::from_fn(|k| (work[k][k], Vector3::from_fn(|i, _| basis[i][k])))
}
