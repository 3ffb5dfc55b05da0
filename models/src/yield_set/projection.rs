//! Return mapping: closest-point projection onto a yield set F in the energy norm,
//!
//! ```text
//! P(s̄) = argmin over s ∈ F of ½ (s − s̄)·D⁻¹(s − s̄):
//! ```
//!
//! with the elastic stiffness D: the implicit step of the variational inequality of associated flow from an elastic
//! trial stress s̄ (Sadovskii & Sadovskaya 2019, "Elastic-plastic Cosserat continuum"). Dilatancies are not used.
//!
//! With plastic multipliers λ ≥ 0 of the conditions f(s) = n·s − k ≤ 0 (for curved F, n is the gradient of f at s),
//! s̄ − s = D Σ λn. The elastic energy decreases by
//!
//! ```text
//! ½ s̄·D⁻¹s̄ − ½ s·D⁻¹s = s·D⁻¹(s̄ − s) + ½ (s̄ − s)·D⁻¹(s̄ − s) = Σ λk + ½ (s̄ − s)·D⁻¹(s̄ − s) ≥ 0.
//! ```
//!
//! A stress outside F by no more than rounding is returned unchanged, bit for bit, so the projection is idempotent.

use super::parameters::{InterlayerYieldSet, Mises};
use super::return_mapping::{
    Cone, ConsistencyEquation, EIGENSPACE_COUNT, EigenspaceDecomposition, ReturnMappingResult,
    YIELD_ROUNDING, compute_energy_lost, sum_active,
};
use crate::common::elementary::Elementary;
use crate::solid::parameters::{Isotropic, PlaneCompliances, Theory};
use crate::solid::stress::{Stress, StressShape, squared_norm};
use crate::solid::symbol::plane_layout;

/// Result of a projection: the projected stress and the elastic energy lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<S> {
    /// Projected stress P(s̄), in the yield set to within rounding.
    pub stress: S,
    /// Elastic energy lost, J/m³; ≥ 0.
    pub energy_lost: f64,
}

/// Relative threshold below which the excess of a condition or a stress component counts as zero: ε² (the error left by
/// iterative refinement) with the safety factor 2¹⁶ for nearly dependent normals.
const CANCELLATION_THRESHOLD: f64 = 65536.0 * f64::EPSILON * f64::EPSILON;

impl Mises {
    /// Pairs [p, D] of the weight in τ̄² = ½ Σ p|s|² and the stiffness (Pa or N) of the eigenspaces of Hooke's law:
    /// deviator and antisymmetric part of the force stress; deviator, mean and antisymmetric part of the couple stress.
    pub fn eigenspace_coefficients(&self, solid: &Isotropic) -> [[f64; 2]; EIGENSPACE_COUNT] {
        let [symmetric, antisymmetric] = self.couple_weights();
        let alpha = solid.microrotation.map_or(0.0, |m| m.alpha);
        let [spherical, gamma, eta] =
            solid.couple().map_or([0.0; 3], |c| [3.0 * c.beta + 2.0 * c.gamma, c.gamma, c.eta]);
        [
            [1.0, 2.0 * solid.mu],
            [self.antisymmetric_weight, 2.0 * alpha],
            [symmetric, 2.0 * gamma],
            [symmetric, spherical],
            [antisymmetric, 2.0 * eta],
        ]
    }

    /// Closest-point projection of a trial stress in the energy norm of `solid`.
    ///
    /// Eigenspaces of Hooke's law are the deviator (stiffness D = 2μ), mean (D = 3K with the bulk modulus K) and
    /// antisymmetric part (2α) of the force stress, and the symmetric deviator (2γ), mean (3β + 2γ) and antisymmetric
    /// part (2η) of the couple stress. With p their weights in τ̄² = ½ Σ p|s|², the plastic multiplier λ and
    /// x = λ/2τ̄ ≥ 0,
    ///
    /// ```text
    /// s = s̄/(1 + xDp),   σ_m = σ̄_m − κKλ,   h(x) = τ̄(x)(1 − ax) − r = 0,   a = 2κ²K,  r = k − κσ̄_m.
    /// ```
    ///
    /// h decreases strictly, so that its root is unique: every 1/(1 + xDp) decreases and every
    /// x/(1 + xDp) increases, hence τ̄ and −xτ̄ decrease. If h(∞) ≥ 0, P(s̄) is the apex.
    ///
    /// Newton's method for h/τ̄ needs no safeguard, since 1/τ̄(x) is a power mean with exponent −2 of the linear
    /// functions 1 + xDp and so concave: for r ≥ 0 the function 1 − ax − r/τ̄(x) is convex and decreasing; for r < 0
    /// and y = 1/x the function y − a + |r|/(xτ̄) is concave in y (a power mean of y + Dp) and increasing. Iterates
    /// from zero increase monotonically to the root; if all active eigenspaces have the same Dp, they converge in
    /// one step.
    pub fn project(&self, solid: &Isotropic, trial: &Stress) -> Projection<Stress> {
        let inside = Projection { stress: *trial, energy_lost: 0.0 };
        let cone = Cone::new(self, solid);
        let active = cone.active_eigenspaces();
        let parts = EigenspaceDecomposition::new(StressShape::GENERAL, &trial.force, &trial.couple);
        let squares = parts.weighted_squares(&cone, &active);
        let pressure = parts.force.0;
        let Cone { friction, strength, a, weighted_stiffnesses: rates, .. } = cone;

        let shear = sum_active(&squares, &active).sqrt();
        let shear_capacity = strength - friction * pressure;
        // Rounding errors scale with the stress components, which may exceed the deviators and antisymmetric parts
        // computed from them.
        let [force, couple] = cone.rounding_weights;
        let rounded =
            (force * squared_norm(&trial.force) + couple * squared_norm(&trial.couple)).sqrt();
        let size = shear + friction * pressure.abs() + strength + rounded;
        let excess = shear - shear_capacity;
        // A NaN stress is returned unchanged.
        if excess.is_nan() || excess <= YIELD_ROUNDING * size {
            return inside;
        }
        let (mapped, apex) = if shear_capacity < 0.0 {
            map_beyond_apex(&cone, &squares, &parts, &active, shear_capacity)
        } else {
            let root = ConsistencyEquation {
                squares,
                weighted_stiffnesses: rates,
                a,
                shear_capacity,
                active: &active,
            }
            .solve();
            let scale = [1.0, root.x];
            (
                ReturnMappingResult::new(
                    &cone,
                    &parts.squares,
                    scale,
                    root.reciprocal,
                    root.scale_factors,
                    &active,
                ),
                None,
            )
        };
        // Mean stress from the yield condition if the difference σ̄_m − κKλ would lose more digits.
        let mean = apex.unwrap_or_else(|| {
            if strength + mapped.shear < friction * (pressure.abs() + mapped.mean_drop) {
                (strength - mapped.shear) / friction
            } else {
                pressure - mapped.mean_drop
            }
        });
        let (force, couple) = parts.scale_parts(StressShape::GENERAL, &mapped.scale_factors, mean);
        Projection { stress: Stress { force, couple }, energy_lost: mapped.energy_lost }
    }
}

/// Return mapping of a stress with shear capacity r = k − κσ̄_m < 0, and the mean stress of the apex if the stress maps
/// to the apex; see [`Mises::project`].
fn map_beyond_apex(
    cone: &Cone<f64>,
    squares: &[f64; EIGENSPACE_COUNT],
    parts: &EigenspaceDecomposition<f64>,
    active: &[bool; EIGENSPACE_COUNT],
    shear_capacity: f64,
) -> (ReturnMappingResult<f64>, Option<f64>) {
    let Cone { strength, friction, mean_drop, a, weighted_stiffnesses: rates, .. } = *cone;
    // The function 1/(xτ̄(x)) of y = 1/x, and its derivative with respect to y.
    let reciprocal = |y: f64| {
        let (mut norm, mut slope) = (0.0, 0.0);
        for (square, rate) in squares.iter().zip(rates) {
            let fraction = 1.0 / (y + rate);
            if *square > 0.0 {
                norm += square * fraction * fraction;
                slope += square * fraction * fraction * fraction;
            }
        }
        let reciprocal = 1.0 / norm.sqrt();
        (reciprocal, slope / norm * reciprocal)
    };
    let is_apex = a + shear_capacity * reciprocal(0.0).0 <= 0.0;
    let mut y = 0.0;
    // If the stress maps to the apex, the solution is y = 0: the first Newton step is zero and ends the loop.
    loop {
        let (value, slope) = reciprocal(y);
        let previous_y = y;
        y += ((a - y + shear_capacity * value) / (1.0 - shear_capacity * slope)).max(0.0);
        if y == previous_y {
            break;
        }
    }
    let scale_factors = rates.map(|rate| if rate == 0.0 { 1.0 } else { y / (y + rate) });
    let mut mapped = ReturnMappingResult::new(
        cone,
        &parts.squares,
        [y, 1.0],
        reciprocal(y).0,
        scale_factors,
        active,
    );
    if !is_apex {
        return (mapped, None);
    }
    let apex = strength / friction;
    let multiplier = (parts.force.0 - apex) / mean_drop;
    mapped.energy_lost =
        compute_energy_lost(cone, &parts.squares, &mapped.lost_fractions, multiplier, active);
    (mapped, Some(apex))
}

/// Hooke's law between the in-plane stresses (σ₁₁, σ₂₂, σ₂₁, σ₁₂, m₃₁, m₃₂), factorised as D = L Lᵀ with the block
///
/// ```text
/// L = [p q; p −q],   p = √(½(D₁₁₁₁ + D₁₁₂₂)),   q = √(½(D₁₁₁₁ − D₁₁₂₂))
/// ```
///
/// for the normal stresses, the analogous block for the shear stresses, and √α₂ for the couple stresses. The modulus α
/// of the antisymmetric strain is 0 in a solid without microrotation, the couple modulus α₂ in a solid without couple
/// stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneMetric {
    normal: [f64; 2],
    shear: [f64; 2],
    couple: f64,
}

impl From<&Isotropic> for PlaneMetric {
    fn from(solid: &Isotropic) -> Self {
        let alpha = solid.microrotation.map_or(0.0, |m| m.alpha);
        Self {
            normal: [(solid.lambda + solid.mu).sqrt(), solid.mu.sqrt()],
            shear: [solid.mu.sqrt(), alpha.sqrt()],
            couple: solid.couple().map_or(0.0, |c| (c.gamma + c.eta).sqrt()),
        }
    }
}

impl From<&PlaneCompliances> for PlaneMetric {
    fn from(solid: &PlaneCompliances) -> Self {
        let roots = |a: f64, b: f64| [(0.5 / (a - b)).sqrt(), (0.5 / (a + b)).sqrt()];
        Self {
            normal: roots(solid.a1, solid.b1),
            // The stiffness of σ₂₁ + σ₁₂ is 1/(a₂ − b₂), as the stiffness of σ₁₁ + σ₂₂ is 1/(a₁ − b₁).
            shear: roots(solid.a2, solid.b2),
            couple: solid.alpha2.sqrt(),
        }
    }
}

type PlaneVector = [f64; 6];

fn dot(x: &PlaneVector, y: &PlaneVector) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

fn dot_absolute(x: &PlaneVector, y: &PlaneVector) -> f64 {
    x.iter().zip(y).map(|(x, y)| (x * y).abs()).sum()
}

impl PlaneMetric {
    /// Product of the factor L with the vector `z`.
    fn apply(&self, z: &PlaneVector) -> PlaneVector {
        let ([p, q], [r, t]) = (self.normal, self.shear);
        [
            p * z[0] + q * z[1],
            p * z[0] - q * z[1],
            r * z[2] + t * z[3],
            r * z[2] - t * z[3],
            self.couple * z[4],
            self.couple * z[5],
        ]
    }

    /// Norm of the row of L of one stress component: the square root of its diagonal entry of D.
    fn row_norm(&self, component: usize) -> f64 {
        match component {
            0 | 1 => self.normal[0].root_sum_square(self.normal[1]),
            2 | 3 => self.shear[0].root_sum_square(self.shear[1]),
            _ => self.couple,
        }
    }

    /// Product of the transposed factor Lᵀ with the vector `n`.
    fn apply_transposed(&self, n: &PlaneVector) -> PlaneVector {
        [
            self.normal[0] * (n[0] + n[1]),
            self.normal[1] * (n[0] - n[1]),
            self.shear[0] * (n[2] + n[3]),
            self.shear[1] * (n[2] - n[3]),
            self.couple * n[4],
            self.couple * n[5],
        ]
    }
}

/// A half-space n·s ≤ k with its scaled normal Lᵀn.
#[derive(Clone, Copy, Default)]
struct ScaledHalfSpace {
    normal: PlaneVector,
    strength: f64,
    /// Scaled normal Lᵀ n.
    scaled_normal: PlaneVector,
    /// Norm |Lᵀ n| of the scaled normal.
    scaled_norm: f64,
}

impl ScaledHalfSpace {
    /// Sum of the magnitudes of the terms of n·s − k, the scale of its rounding error.
    fn rounding_scale(&self, stress: &PlaneVector) -> f64 {
        dot_absolute(&self.normal, stress) + self.strength
    }
}

/// Active set of half-spaces with the QR factorisation of their scaled normals, Lᵀ(n₁ … n_q) = Q R.
#[derive(Default)]
struct ActiveSet {
    indices: [usize; 6],
    multipliers: [f64; 6],
    count: usize,
    q_columns: [PlaneVector; 6],
    r_columns: [[f64; 6]; 6],
}

impl ActiveSet {
    /// Splits a vector into its coordinates in the first `count` columns of Q, which span scaled normals of the active
    /// half-spaces, and the orthogonal remainder, by Gram–Schmidt with reorthogonalisation.
    fn orthogonalise(&self, vector: &PlaneVector, count: usize) -> ([f64; 6], PlaneVector) {
        let (mut coordinates, mut remainder) = ([0.0; 6], *vector);
        for _ in 0..2 {
            for (coordinate, direction) in coordinates.iter_mut().zip(&self.q_columns).take(count) {
                let along = dot(direction, &remainder);
                *coordinate += along;
                for (x, y) in remainder.iter_mut().zip(direction) {
                    *x -= along * y;
                }
            }
        }
        (coordinates, remainder)
    }

    /// Recomputes the factors Q and R of the scaled normals of the active half-spaces.
    fn factorise(&mut self, half_spaces: &[ScaledHalfSpace]) {
        for column in 0..self.count {
            let (coordinates, remainder) =
                self.orthogonalise(&half_spaces[self.indices[column]].scaled_normal, column);
            let length = dot(&remainder, &remainder).sqrt();
            self.r_columns[column] = coordinates;
            self.r_columns[column][column] = length;
            self.q_columns[column] = remainder.map(|x| x / length);
        }
    }

    /// Solves R x = c; the columns of R are the rows of `r_columns`.
    fn solve(&self, mut c: [f64; 6]) -> [f64; 6] {
        for i in (0..self.count).rev() {
            c[i] /= self.r_columns[i][i];
            for j in 0..i {
                c[j] -= self.r_columns[i][j] * c[i];
            }
        }
        c
    }

    /// Solves Rᵀ x = c.
    fn solve_transposed(&self, mut c: [f64; 6]) -> [f64; 6] {
        for i in 0..self.count {
            for j in 0..i {
                c[i] -= self.r_columns[i][j] * c[j];
            }
            c[i] /= self.r_columns[i][i];
        }
        c
    }

    /// Removes the half-space at `position` from the active set.
    fn remove(&mut self, position: usize, half_spaces: &[ScaledHalfSpace]) {
        self.indices.copy_within(position + 1..self.count, position);
        self.multipliers.copy_within(position + 1..self.count, position);
        self.count -= 1;
        self.factorise(half_spaces);
    }
}

impl InterlayerYieldSet {
    /// Closest-point projection of a trial stress (σ₁₁, σ₂₂, σ₂₁, σ₁₂, m₃₁, m₃₂) in plane strain.
    ///
    /// With s = s̄ − L z this is the shortest z with (Lᵀn)·z ≥ n·s̄ − k for up to eight half-spaces: a strictly convex
    /// quadratic program, solved by the dual active-set method of Goldfarb & Idnani (1983). The most violated
    /// half-space enters the active set, half-spaces whose multiplier would become negative leave it, and the distance
    /// grows in each step, so no active set recurs. A half-space that depends linearly on the active ones (apex, edges
    /// of zero strength) replaces one of them.
    ///
    /// The out-of-plane stress σ₃₃ enters no condition. It follows by Hooke's law from the same plastic strain,
    /// Δσ₃₃ = ν (Δσ₁₁ + Δσ₂₂) with Poisson's ratio ν = λ/2(λ + μ) (Lamé moduli λ, μ) in an isotropic solid; minimising
    /// the energy over all stresses including σ₃₃ gives the same result.
    pub fn project(&self, metric: &PlaneMetric, trial: &[f64; 6]) -> Projection<[f64; 6]> {
        let components = plane_layout(Theory::Cosserat).stresses;
        let mut half_space_storage = [ScaledHalfSpace::default(); 8];
        let mut half_space_count = 0;
        for (place, (condition, strength)) in half_space_storage.iter_mut().zip(self.half_spaces())
        {
            let normal = std::array::from_fn(|i| components[i].value_in(&condition.normal));
            let scaled_normal = metric.apply_transposed(&normal);
            *place = ScaledHalfSpace {
                normal,
                strength,
                scaled_normal,
                scaled_norm: dot(&scaled_normal, &scaled_normal).sqrt(),
            };
            half_space_count += 1;
        }
        let half_spaces = &half_space_storage[..half_space_count];
        let mut active = ActiveSet::default();
        let (mut stress, mut scaled_path, mut stress_error_scale) = (*trial, [0.0; 6], 0.0f64);

        // There are at most 2⁸ active sets and none recurs; fewer than a dozen iterations are observed.
        for _ in 0..256 {
            // Most violated half-space, measured by its distance in the energy norm.
            let mut most_violated = (0.0, None);
            for (index, half_space) in half_spaces.iter().enumerate() {
                let ScaledHalfSpace { normal, strength, scaled_norm, .. } = half_space;
                let excess = dot(normal, &stress) - strength;
                if excess
                    > YIELD_ROUNDING * half_space.rounding_scale(&stress)
                        + CANCELLATION_THRESHOLD * scaled_norm * stress_error_scale
                    && excess > most_violated.0 * scaled_norm
                    && !active.indices[..active.count].contains(&index)
                {
                    most_violated = (excess / scaled_norm, Some((index, excess)));
                }
            }
            let Some((index, mut excess)) = most_violated.1 else { break };
            let entering = &half_spaces[index];
            let mut multiplier = 0.0;
            loop {
                // A unit increase of the entering multiplier changes the other multipliers by −R⁻¹Qᵀ(Lᵀn), and z by
                // the component of Lᵀn orthogonal to Q.
                let (coordinates, remainder) =
                    active.orthogonalise(&entering.scaled_normal, active.count);
                let change = active.solve(coordinates);
                let length = dot(&remainder, &remainder).sqrt();
                let is_independent = active.count < 6 && length > 1e-12 * entering.scaled_norm;
                let full_step =
                    if is_independent { excess / (length * length) } else { f64::INFINITY };
                let mut blocking = (full_step, None);
                for (position, change) in change.iter().enumerate().take(active.count) {
                    let ratio = active.multipliers[position].max(0.0) / change;
                    if *change > 0.0 && ratio < blocking.0 {
                        blocking = (ratio, Some(position));
                    }
                }
                let (step, leaving) = blocking;
                if !step.is_finite() {
                    // Infeasible only by rounding: zero stress is in every half-space.
                    break;
                }
                multiplier += step;
                for (active_multiplier, change) in
                    active.multipliers.iter_mut().zip(change).take(active.count)
                {
                    *active_multiplier -= step * change;
                }
                if let Some(position) = leaving {
                    if is_independent {
                        excess -= step * length * length;
                    }
                    active.remove(position, half_spaces);
                } else {
                    active.indices[active.count] = index;
                    active.multipliers[active.count] = multiplier;
                    active.count += 1;
                    active.factorise(half_spaces);
                    break;
                }
            }

            // Recompute s, z and λ from the active half-spaces alone. Iterative refinement: each pass removes the
            // excess n·s − k that the rounding errors of the previous pass have left.
            (stress, scaled_path) = (*trial, [0.0; 6]);
            for _ in 0..3 {
                let mut excess = [0.0; 6];
                for (excess, &index) in excess.iter_mut().zip(&active.indices[..active.count]) {
                    *excess =
                        dot(&half_spaces[index].normal, &stress) - half_spaces[index].strength;
                }
                let coordinates = active.solve_transposed(excess);
                let mut step = [0.0; 6];
                for (along, direction) in
                    coordinates.iter().zip(&active.q_columns).take(active.count)
                {
                    for (x, y) in step.iter_mut().zip(direction) {
                        *x += along * y;
                    }
                }
                let change = metric.apply(&step);
                for i in 0..6 {
                    scaled_path[i] += step[i];
                    stress[i] -= change[i];
                }
            }
            let (coordinates, _) = active.orthogonalise(&scaled_path, active.count);
            active.multipliers = active.solve(coordinates);
            // `stress_error_scale`: scale of the rounding errors of s per row norm of L. It is |z| for the product L z,
            // and the magnitude of the terms of an active condition divided by |Lᵀn| for the correction of its excess.
            stress_error_scale = dot(&scaled_path, &scaled_path).sqrt();
            for &index in &active.indices[..active.count] {
                stress_error_scale = stress_error_scale.max(
                    half_spaces[index].rounding_scale(&stress) / half_spaces[index].scaled_norm,
                );
            }
            for i in 0..6 {
                if stress[i].abs()
                    <= CANCELLATION_THRESHOLD
                        * (trial[i].abs() + metric.row_norm(i) * stress_error_scale)
                {
                    stress[i] = 0.0;
                }
            }
        }

        let mut energy_lost = 0.5 * dot(&scaled_path, &scaled_path);
        for position in 0..active.count {
            let strength = half_spaces[active.indices[position]].strength;
            energy_lost += strength * active.multipliers[position].max(0.0);
        }
        Projection { stress, energy_lost }
    }
}
