//! Global maximum of the secular function over all wave normals, with a certificate.
//!
//! At a fixed λ the secular function of [deviatorically associated flow](super::deviatoric_associativity) is a form
//!
//! ```text
//! F(ν) = ν·Pν − q d² − r e²,   d = ν·Sν,   e = ν·Eν,   q, r ≥ 0,
//! ```
//!
//! with symmetric P, S and E. Newton's method on the sphere finds a stationary point ν*, with d*, e* and
//! M = P − 2q d*S − 2r e*E an eigenvector of M: Mν* = μν*. Since −d² ≤ d*² − 2 d* d, for every ν
//!
//! ```text
//! F(ν) ≤ ν·Mν + q d*² + r e*²,   with equality at ν*.
//! ```
//!
//! So **ν* is a global maximum if μ is the largest eigenvalue of M**; the other two eigenvectors of M are perpendicular
//! to ν*, and their eigenvalues follow from a 2 × 2 matrix. For r = 0 this certificate exists at every global maximum,
//! since the values (ν·Pν, ν·Sν) over the sphere form a convex set (Brickman 1961); for r > 0 it may be missing.
//!
//! Source: L. Brickman, On the field of values of a matrix, Proc. Amer. Math. Soc. 12 (1961) 61–66.

use super::unit_vectors::tangent_vectors;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

/// Excess of an eigenvalue of M over μ that counts as rounding, relative to the size of M.
const CERTIFICATE_TOLERANCE: f64 = 1e-12;
/// Maximum length of a Newton step, rad.
const MAX_STEP: f64 = 0.5;
/// Length of the last Newton step, rad: the value is then accurate to rounding.
const LAST_STEP: f64 = 1e-9;

/// Directions to the centres of the faces, edges and corners of a cube, one of each pair.
const LATTICE: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
];

/// The secular function at a fixed λ as a form on the sphere.
pub(super) struct SecularForm<'a> {
    /// Matrix P.
    pub(super) quadratic: Matrix3<f64>,
    /// Factors q ≥ 0 and r ≥ 0 of the squares of the forms S and E.
    pub(super) factors: [f64; 2],
    /// Symmetric matrices S and E.
    pub(super) squared: &'a [Matrix3<f64>; 2],
}

/// Maximum of a [`SecularForm`].
pub(super) struct SecularMaximum {
    pub(super) normal: Vector3<f64>,
    pub(super) value: f64,
    /// Whether the certificate proves that no other direction has a larger value.
    pub(super) is_global: bool,
}

/// Derivatives of a [`SecularForm`] in the tangent plane at a wave normal.
struct TangentDerivatives {
    tangents: [Vector3<f64>; 2],
    /// Half the gradient.
    gradient: Vector2<f64>,
    /// Half the second derivatives.
    hessian: Matrix2<f64>,
    /// M − μI in the tangent plane.
    excess: Matrix2<f64>,
}

impl SecularForm<'_> {
    /// The size of the numbers in the form.
    pub(super) fn size(&self) -> f64 {
        let [q, r] = self.factors;
        let [s, e] = self.squared.each_ref().map(Matrix3::norm_squared);
        self.quadratic.norm() + q * s + r * e
    }

    /// Value at the unit vector `normal`.
    fn evaluate(&self, normal: &Vector3<f64>) -> f64 {
        let mut value = normal.dot(&(self.quadratic * normal));
        for (matrix, factor) in self.squared.iter().zip(self.factors) {
            let form = normal.dot(&(matrix * normal));
            value -= factor * form * form;
        }
        value
    }

    fn differentiate(&self, normal: &Vector3<f64>) -> TangentDerivatives {
        let images = self.squared.each_ref().map(|matrix| matrix * normal);
        let mut linearised = self.quadratic;
        for ((matrix, image), factor) in self.squared.iter().zip(&images).zip(self.factors) {
            linearised -= matrix * (2.0 * factor * normal.dot(image));
        }
        let tangents = tangent_vectors(&(*normal).into()).map(Vector3::from);
        let image = linearised * normal;
        let multiplier = normal.dot(&image);
        let in_plane = |vector: &Vector3<f64>| Vector2::from(tangents.map(|t| t.dot(vector)));
        let [first, second] = tangents.map(|tangent| in_plane(&(linearised * tangent)));
        let excess = Matrix2::new(
            first[0] - multiplier,
            0.5 * (first[1] + second[0]),
            0.5 * (first[1] + second[0]),
            second[1] - multiplier,
        );
        let mut hessian = excess;
        for (image, factor) in images.iter().zip(self.factors) {
            let slope = in_plane(image);
            hessian -= slope * slope.transpose() * (4.0 * factor);
        }
        TangentDerivatives { tangents, gradient: in_plane(&image), hessian, excess }
    }

    /// Local maximum by Newton's method from the unit vector `start`, with steps uphill where the form is convex.
    fn climb(&self, start: Vector3<f64>, size: f64) -> (Vector3<f64>, f64) {
        let (mut normal, mut value) = (start, self.evaluate(&start));
        for _ in 0..60 {
            let TangentDerivatives { tangents, gradient, hessian, .. } =
                self.differentiate(&normal);
            let (curvatures, axes) = diagonalise(&hessian);
            let mut step = Vector2::zeros();
            for (curvature, axis) in curvatures.into_iter().zip(axes) {
                step += axis * (axis.dot(&gradient) / curvature.abs().max(1e-9 * size));
            }
            let mut length = step.norm();
            if length > MAX_STEP {
                step *= MAX_STEP / length;
                length = MAX_STEP;
            }
            let (before, mut is_higher) = (value, false);
            while !is_higher && length > 0.1 * LAST_STEP {
                let next = (normal + tangents[0] * step[0] + tangents[1] * step[1]).normalize();
                let next_value = self.evaluate(&next);
                // At the maximum the values differ by rounding only; the Newton step is still an improvement.
                is_higher =
                    next_value > before || (length < 1e-5 && next_value >= before - 1e-15 * size);
                if is_higher {
                    (normal, value) = (next, next_value);
                } else {
                    step *= 0.25;
                    length *= 0.25;
                }
            }
            if !is_higher || length <= LAST_STEP {
                break;
            }
        }
        (normal, value)
    }

    /// Maximum from the unit vector `start`: climbs, and as long as the certificate is missing, climbs from the highest
    /// point of the circle along which it is violated most, then from other directions.
    pub(super) fn maximise(&self, start: Vector3<f64>) -> SecularMaximum {
        let size = self.size();
        let (mut normal, mut value) = self.climb(start, size);
        for _ in 0..4 {
            let TangentDerivatives { tangents, excess, .. } = self.differentiate(&normal);
            let (excesses, axes) = diagonalise(&excess);
            let largest = usize::from(excesses[1] > excesses[0]);
            if excesses[largest] <= CERTIFICATE_TOLERANCE * size {
                return SecularMaximum { normal, value, is_global: true };
            }
            let axis = tangents[0] * axes[largest][0] + tangents[1] * axes[largest][1];
            let on_circle = |sine: f64| {
                let cosine = (1.0 - sine * sine).sqrt();
                [normal * cosine + axis * sine, normal * sine - axis * cosine]
            };
            let circle = [0.2, 0.4, 0.6, 0.8, -0.2, -0.4, -0.6, -0.8].map(on_circle);
            let highest =
                circle.into_iter().flatten().fold((normal, f64::NEG_INFINITY), |best, n| {
                    let value = self.evaluate(&n);
                    if value > best.1 { (n, value) } else { best }
                });
            let lattice = LATTICE.iter().map(|&direction| Vector3::from(direction).normalize());
            let starts = std::iter::once(highest.0).chain(lattice);
            let mut summits = starts.map(|start| self.climb(start, size));
            let Some(higher) = summits.find(|summit| summit.1 > value + 1e-14 * size) else {
                break;
            };
            (normal, value) = higher;
        }
        SecularMaximum { normal, value, is_global: false }
    }
}

/// Eigenvalues and orthonormal eigenvectors of a symmetric 2 × 2 matrix.
fn diagonalise(matrix: &Matrix2<f64>) -> ([f64; 2], [Vector2<f64>; 2]) {
    let (first, second, entry) = (matrix[(0, 0)], matrix[(1, 1)], matrix[(0, 1)]);
    if entry == 0.0 {
        return ([first, second], [Vector2::x(), Vector2::y()]);
    }
    let ratio = (second - first) / (2.0 * entry);
    let tangent = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
    let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
    let sine = tangent * cosine;
    (
        [first - tangent * entry, second + tangent * entry],
        [Vector2::new(cosine, -sine), Vector2::new(sine, cosine)],
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use testkit::random::RandomNumbers;

    fn random_symmetric(random: &mut RandomNumbers) -> Matrix3<f64> {
        let matrix = Matrix3::from_fn(|_, _| random.uniform(-1.0, 1.0));
        matrix + matrix.transpose()
    }

    fn random_normal(random: &mut RandomNumbers) -> Vector3<f64> {
        Vector3::from_fn(|_, _| random.uniform(-1.0, 1.0)).normalize()
    }

    /// No direction of a dense sample is above a certified maximum, every lower local maximum lacks the certificate, and
    /// with one concave term every form has a certified maximum (Brickman 1961).
    #[test]
    fn certificates_hold_for_global_maxima_only() {
        let random = &mut RandomNumbers::new(31);
        let (mut refused, mut missing) = (0, 0);
        for case in 0..400 {
            let squared = [random_symmetric(random), random_symmetric(random)];
            let second = if case % 2 == 0 { 0.0 } else { random.uniform(0.0, 3.0) };
            let form = SecularForm {
                quadratic: random_symmetric(random),
                factors: [random.uniform(0.0, 3.0), second],
                squared: &squared,
            };
            let size = form.size();
            let sampled = (0..2000)
                .map(|_| form.evaluate(&random_normal(random)))
                .fold(f64::NEG_INFINITY, f64::max);
            let found = form.maximise(random_normal(random));
            if found.is_global {
                assert!(sampled <= found.value + 1e-12 * size, "{sampled} {}", found.value);
                assert!(sampled > found.value - 0.05 * size);
            } else {
                missing += 1;
                assert!(second > 0.0, "no certificate with one concave term: {case}");
            }
            for _ in 0..10 {
                let (normal, value) = form.climb(random_normal(random), size);
                if value < sampled - 1e-9 * size {
                    let (excesses, _) = diagonalise(&form.differentiate(&normal).excess);
                    assert!(excesses[0].max(excesses[1]) > CERTIFICATE_TOLERANCE * size);
                    refused += 1;
                }
            }
        }
        println!("{refused} lower maxima refused, {missing} of 200 without a certificate");
        assert!(refused > 20 && missing < 60);
    }
}
