//! Shear bands of a classical solid with a yield cone in space: a quadratic form on a triangle.

use super::{BoxProof, BoxVerdict, claim};
use certificates::Directions;
use models::common::scalar::{Function, Scalar};
use models::common::taylor_model::TaylorModel;

/// An isotropic classical solid on the cone τ̄ + κ σ_m = k (von Mises: κ = κ̂ = 0), under a stress with these principal
/// values; only the direction of its deviator matters.
#[derive(Clone, Copy, Debug)]
pub struct YieldCone {
    /// First Lamé modulus λ, Pa.
    pub lambda: TaylorModel,
    /// Shear modulus μ, Pa.
    pub mu: TaylorModel,
    /// Friction κ.
    pub friction: TaylorModel,
    /// Dilatancy κ̂.
    pub dilatancy: TaylorModel,
    /// Plastic modulus H, Pa.
    pub hardening: TaylorModel,
    /// Principal stresses up to a common positive factor and a pressure.
    pub principal_stresses: [TaylorModel; 3],
}

impl YieldCone {
    /// The symmetric matrix A of the quadratic form ρ² Π c² h/(μ(λ + 2μ)) in xᵢ = νᵢ², with the components νᵢ of the
    /// wave normal along the principal axes and h = H + n·Dm.
    ///
    /// The acoustic tensor is μ + (λ + μ)ν νᵀ − α βᵀ/h with α = (μ s̃ + Kκ̂)ν and β = (μ s̃ + Kκ)ν, where s̃ is the
    /// deviator by τ̄ and K the bulk modulus. With d = ν·s̃ν its determinant by that of the elastic one is
    ///
    /// ```text
    /// 1 − (μd + Kκ̂)(μd + Kκ)/[h(λ + 2μ)] − μ(|s̃ν|² − d²)/h
    /// ```
    ///
    /// in which d and |s̃ν|² are linear in x, and Σ xᵢ = 1 (Rudnicki & Rice 1975, eq. 15).
    fn matrix(&self) -> Option<[[TaylorModel; 3]; 3]> {
        let Self { lambda, mu, friction, dilatancy, hardening, principal_stresses } = *self;
        let exact = TaylorModel::from_exact;
        let one = exact(1.0);
        let [first, second, third] = principal_stresses;
        let mean = (first + second + third) / exact(3.0);
        let deviator = principal_stresses.map(|own| own - mean);
        let squares = deviator.map(|own| own * own);
        let shear = (exact(0.5) * (squares[0] + squares[1] + squares[2])).apply(Function::Sqrt);
        // Stresses in this direction reach the cone.
        if (shear + friction * mean).certain_sign() != Some(1) {
            return None;
        }
        let bulk = lambda + exact(2.0) * mu / exact(3.0);
        let stiffness = hardening + mu + bulk * friction * dilatancy;
        if stiffness.certain_sign() != Some(1) || (lambda + mu).certain_sign() != Some(1) {
            return None;
        }
        let direction = deviator.map(|own| own / shear);
        let by_flow = direction.map(|own| mu * own + bulk * dilatancy);
        let by_normal = direction.map(|own| mu * own + bulk * friction);
        let inverse = one / (lambda + exact(2.0) * mu);
        let entry = |i: usize, j: usize| {
            let difference = direction[i] - direction[j];
            let longitudinal = by_flow[i] * by_normal[j] + by_flow[j] * by_normal[i];
            let half = exact(0.5);
            stiffness - half * inverse * longitudinal - half * mu * difference * difference
        };
        Some(std::array::from_fn(|i| std::array::from_fn(|j| entry(i.min(j), i.max(j)))))
    }

    /// Verdict on all states of the box.
    ///
    /// Flow direction and normal differ by a multiple of the identity, so that α and β have parallel components across ν:
    /// the equation 1 = w_p/(c_p² − c²) + w_s/(c_s² − c²) has w_s ≥ 0, its roots are real and the larger one is at least
    /// c_s² (Loret, Prevost & Harireche 1990). So all c² are positive exactly if the form is: A strictly copositive. By
    /// Hadeler (1983) that is aᵢᵢ > 0, eᵢⱼ = aᵢⱼ + √(aᵢᵢaⱼⱼ) > 0 and
    /// √(a₁₁a₂₂a₃₃) + a₁₂√a₃₃ + a₁₃√a₂₂ + a₂₃√a₁₁ + √(2 e₁₂ e₁₃ e₂₃) > 0. Ill-posed if the form is negative at one point.
    pub fn prove(&self) -> BoxProof {
        let Some(matrix) = self.matrix() else { return BoxProof::NONE };
        let point = least_point(&matrix);
        let least = value_at(&matrix, point);
        if least.certain_sign() == Some(-1) {
            let point = Some(Directions::One(point.to_vec()));
            let claims = vec![claim("xᵀAx", point, least.range())];
            return BoxProof { verdict: BoxVerdict::IllPosed, claims };
        }
        let sqrt = |x: TaylorModel| x.apply(Function::Sqrt);
        let roots: [TaylorModel; 3] = std::array::from_fn(|i| sqrt(matrix[i][i]));
        let pairs = [(0, 1, 2), (0, 2, 1), (1, 2, 0)];
        let edges = pairs.map(|(i, j, _)| matrix[i][j] + roots[i] * roots[j]);
        let product = TaylorModel::from_exact(2.0) * edges[0] * edges[1] * edges[2];
        let sum = pairs.iter().fold(roots[0] * roots[1] * roots[2], |sum, &(i, j, other)| {
            sum + matrix[i][j] * roots[other]
        });
        let diagonal: [TaylorModel; 3] = std::array::from_fn(|i| matrix[i][i]);
        let last = sum + sqrt(product);
        let quantities = diagonal.into_iter().chain(edges).chain([last]);
        let conditions: Vec<(&'static str, TaylorModel)> =
            COPOSITIVITY.into_iter().zip(quantities).collect();
        // A negative one is not that of the form at a point, which is searched for above.
        let found = BoxProof::from_conditions(&conditions);
        if found.verdict == BoxVerdict::WellPosed { found } else { BoxProof::NONE }
    }
}

/// Names of the quantities of Hadeler.
const COPOSITIVITY: [&str; 7] = [
    "a11",
    "a22",
    "a33",
    "a12 + √(a11 a22)",
    "a13 + √(a11 a33)",
    "a23 + √(a22 a33)",
    "√(a11 a22 a33) + a12 √a33 + a13 √a22 + a23 √a11 + √(2 e12 e13 e23)",
];

/// Enclosure of the form at a point of the triangle.
fn value_at(matrix: &[[TaylorModel; 3]; 3], point: [f64; 3]) -> TaylorModel {
    let mut sum = TaylorModel::ZERO;
    for (row, x) in matrix.iter().zip(point) {
        for (entry, y) in row.iter().zip(point) {
            sum = sum + TaylorModel::from_exact(x) * TaylorModel::from_exact(y) * *entry;
        }
    }
    sum
}

/// The point of the triangle xᵢ ≥ 0, Σ xᵢ = 1 with the least value of the form at the centre of the box, among vertices and
/// minima on edges: the least value is on the edge between the greatest and the least principal stress, since for a given
/// d the form falls with |s̃ν|².
fn least_point(matrix: &[[TaylorModel; 3]; 3]) -> [f64; 3] {
    let unit = |i: usize| {
        let mut point = [0.0; 3];
        point[i] = 1.0;
        point
    };
    let value = |point: &[f64; 3]| {
        let entries = (0..9).map(|k| point[k / 3] * point[k % 3] * matrix[k / 3][k % 3].value);
        entries.sum::<f64>()
    };
    let on_edge = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(i, j)| {
        let [a, b, c] = [(i, i), (i, j), (j, j)].map(|(i, j)| matrix[i][j].value);
        let x = (c - b) / (a + c - 2.0 * b);
        let mut point = [0.0; 3];
        (point[i], point[j]) = (x, 1.0 - x);
        (x > 0.0 && x < 1.0).then_some(point)
    });
    let candidates = (0..3).map(unit).chain(on_edge);
    candidates
        .fold((unit(0), f64::INFINITY), |best, own| {
            let here = value(&own);
            if here < best.1 { (own, here) } else { best }
        })
        .0
}
