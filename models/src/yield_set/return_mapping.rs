//! Return mapping of von Mises, Drucker–Prager and Cosserat–Mises cones, generic over single stresses and SIMD lanes.
//!
//! Derivation: [`Mises::project`]. Valid for trial stresses with shear capacity k − κσ̄_m ≥ 0; `Mises::project` also
//! maps stresses beyond the apex.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use super::parameters::Mises;
use crate::common::number::Number;
use crate::solid::parameters::Isotropic;
use crate::solid::stress::{StressShape, Tensor};

/// Number of eigenspaces of Hooke's law that may enter the equivalent shear stress τ̄: deviator and antisymmetric part
/// of the force stress; deviator, mean and antisymmetric part of the couple stress. Arrays of this length are in this
/// order.
pub const EIGENSPACE_COUNT: usize = 5;

/// Bound on the rounding error of the value of a yield condition, relative to the sum of the magnitudes of its terms; a
/// power of 2.
pub const YIELD_ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Coefficients of the return mapping of a [`Mises`] cone in an isotropic solid with the bulk modulus K. Eigenspaces
/// with zero weight or zero stiffness are passive: the mapping leaves their stress unchanged; the others are active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone<N> {
    /// Strength k, Pa.
    pub strength: N,
    /// Friction κ.
    pub friction: N,
    /// Decrease of the mean stress per plastic multiplier, κK, Pa.
    pub mean_drop: N,
    /// Coefficient a = 2κ²K, Pa.
    pub a: N,
    /// Half weights ½p of the eigenspaces in τ̄² = ½ Σ p|s|², in 1/m² for the couple stress; zero for passive
    /// eigenspaces.
    pub half_weights: [N; EIGENSPACE_COUNT],
    /// Stiffnesses D of the eigenspaces, Pa or N; 1 for passive eigenspaces.
    pub stiffnesses: [N; EIGENSPACE_COUNT],
    /// Products Dp of stiffness and weight, Pa; zero for passive eigenspaces.
    pub weighted_stiffnesses: [N; EIGENSPACE_COUNT],
    /// Weights of the rounding errors of the stress components: max(h, 1) for the force stress, and the largest weight
    /// p for the couple stress, 1/m².
    pub rounding_weights: [N; 2],
}

impl Cone<f64> {
    /// Computes the coefficients of the cone `set` in `solid`.
    pub fn new(set: &Mises, solid: &Isotropic) -> Self {
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let Mises { friction, strength, .. } = *set;
        let parts = set.eigenspace_coefficients(solid);
        let is_active = |[weight, stiffness]: [f64; 2]| weight > 0.0 && stiffness > 0.0;
        let active =
            |part: [f64; 2], value: f64, other: f64| if is_active(part) { value } else { other };
        Self {
            strength,
            friction,
            mean_drop: friction * bulk,
            a: 2.0 * friction * friction * bulk,
            half_weights: parts.map(|part| active(part, 0.5 * part[0], 0.0)),
            stiffnesses: parts.map(|part| active(part, part[1], 1.0)),
            weighted_stiffnesses: parts.map(|part| active(part, part[1] * part[0], 0.0)),
            rounding_weights: [set.antisymmetric_weight.max(1.0), parts[2][0].max(parts[4][0])],
        }
    }

    /// A cone that never yields, for elastic solids: strength `strength` (Pa) far above every stress.
    pub fn with_unreachable_strength(strength: f64) -> Self {
        Self {
            strength,
            friction: 0.0,
            mean_drop: 0.0,
            a: 0.0,
            half_weights: [0.0; EIGENSPACE_COUNT],
            stiffnesses: [1.0; EIGENSPACE_COUNT],
            weighted_stiffnesses: [0.0; EIGENSPACE_COUNT],
            rounding_weights: [1.0, 0.0],
        }
    }

    /// Flags of the active eigenspaces.
    pub fn active_eigenspaces(&self) -> [bool; EIGENSPACE_COUNT] {
        self.half_weights.map(|weight| weight > 0.0)
    }
}

impl<N: Copy> Cone<N> {
    /// Builds a cone from other cones, e.g. one with SIMD lanes from single cones: `value` computes each coefficient,
    /// given a function that reads this coefficient of a cone.
    pub fn from_coefficients<M>(mut value: impl FnMut(&dyn Fn(&Cone<M>) -> M) -> N) -> Self
    where
        M: Copy,
    {
        Self {
            strength: value(&|cone| cone.strength),
            friction: value(&|cone| cone.friction),
            mean_drop: value(&|cone| cone.mean_drop),
            a: value(&|cone| cone.a),
            half_weights: std::array::from_fn(|part| value(&|cone| cone.half_weights[part])),
            stiffnesses: std::array::from_fn(|part| value(&|cone| cone.stiffnesses[part])),
            weighted_stiffnesses: std::array::from_fn(|part| {
                value(&|cone| cone.weighted_stiffnesses[part])
            }),
            rounding_weights: std::array::from_fn(|which| {
                value(&|cone| cone.rounding_weights[which])
            }),
        }
    }
}

/// A trial stress decomposed into the eigenspaces of Hooke's law.
#[derive(Clone, Copy, Debug)]
pub struct EigenspaceDecomposition<N> {
    /// Mean σ̄_m, deviator and antisymmetric part of the force stress.
    pub force: (N, Tensor<N>, Tensor<N>),
    /// Mean, deviator and antisymmetric part of the couple stress.
    pub couple: (N, Tensor<N>, Tensor<N>),
    /// Squared Frobenius norms |s̄|² of the components in the eigenspaces, Pa² or (N/m)².
    pub squares: [N; EIGENSPACE_COUNT],
}

impl<N: Number> EigenspaceDecomposition<N> {
    /// Decomposes a force and a couple stress of the given `shape`.
    #[inline(always)]
    pub fn new(shape: StressShape, force: &Tensor<N>, couple: &Tensor<N>) -> Self {
        let force = shape.split(force);
        let mut parts = Self {
            force,
            couple: (N::ZERO, [[N::ZERO; 3]; 3], [[N::ZERO; 3]; 3]),
            squares: [N::ZERO; EIGENSPACE_COUNT],
        };
        parts.squares[0] = shape.squared_norm(0, &force.1);
        if !shape.is_symmetric {
            parts.squares[1] = shape.squared_norm_antisymmetric(0, &force.2);
        }
        if shape.has_couples {
            parts.couple = shape.split(couple);
            let (mean, deviator, antisymmetric) = &parts.couple;
            parts.squares[2] = shape.squared_norm(1, deviator);
            parts.squares[3] = (N::ONE + N::ONE + N::ONE) * *mean * *mean;
            parts.squares[4] = shape.squared_norm_antisymmetric(1, antisymmetric);
        }
        parts
    }

    /// Weighted squares ½p|s̄|² of the active eigenspaces, Pa²; zero for passive eigenspaces.
    #[inline(always)]
    pub fn weighted_squares(
        &self,
        cone: &Cone<N>,
        active: &[bool; EIGENSPACE_COUNT],
    ) -> [N; EIGENSPACE_COUNT] {
        let mut weighted = [N::ZERO; EIGENSPACE_COUNT];
        for part in 0..EIGENSPACE_COUNT {
            if active[part] {
                weighted[part] = cone.half_weights[part] * self.squares[part];
            }
        }
        weighted
    }

    /// Force and couple stress with the component in each eigenspace scaled by its factor in `scale_factors` and the
    /// mean of the force stress replaced by `mean`.
    #[inline(always)]
    pub fn scale_parts(
        &self,
        shape: StressShape,
        scale_factors: &[N; EIGENSPACE_COUNT],
        mean: N,
    ) -> (Tensor<N>, Tensor<N>) {
        let [mut force, mut couple] = [[[N::ZERO; 3]; 3]; 2];
        for i in 0..3 {
            for j in 0..3 {
                let diagonal = if i == j { N::ONE } else { N::ZERO };
                if shape.has_component(0, i, j) {
                    let antisymmetric = match shape.is_symmetric {
                        true => N::ZERO,
                        false => scale_factors[1] * self.force.2[i][j],
                    };
                    force[i][j] =
                        scale_factors[0] * self.force.1[i][j] + antisymmetric + mean * diagonal;
                }
                if shape.has_component(1, i, j) {
                    couple[i][j] = scale_factors[2] * self.couple.1[i][j]
                        + scale_factors[3] * self.couple.0 * diagonal
                        + scale_factors[4] * self.couple.2[i][j];
                }
            }
        }
        (force, couple)
    }
}

/// Sum of `terms` over the active eigenspaces.
#[inline(always)]
pub fn sum_active<N: Number>(
    terms: &[N; EIGENSPACE_COUNT],
    active: &[bool; EIGENSPACE_COUNT],
) -> N {
    let mut sum = N::ZERO;
    for part in 0..EIGENSPACE_COUNT {
        if active[part] {
            sum = sum + terms[part];
        }
    }
    sum
}

/// The equation h(x) = τ̄(x)(1 − ax) − r = 0 for x = λ/2τ̄ with the plastic multiplier λ, where r = k − κσ̄_m ≥ 0 and
/// τ̄(x)² = Σ s/(1 + xDp)² over the active eigenspaces.
#[derive(Clone, Copy, Debug)]
pub struct ConsistencyEquation<'a, N> {
    /// Weighted squares s = ½p|s̄|² of the eigenspaces, Pa².
    pub squares: [N; EIGENSPACE_COUNT],
    /// Products Dp of stiffness and weight of the eigenspaces, Pa.
    pub weighted_stiffnesses: [N; EIGENSPACE_COUNT],
    /// Coefficient a = 2κ²K, Pa, with the friction κ and the bulk modulus K.
    pub a: N,
    /// Shear capacity r = k − κσ̄_m, Pa, with the strength k and the mean stress σ̄_m of the trial stress.
    pub shear_capacity: N,
    /// Flags of the active eigenspaces.
    pub active: &'a [bool; EIGENSPACE_COUNT],
}

/// An iterate of Newton's method with the terms of the equation at x.
#[derive(Clone, Copy, Debug)]
pub struct NewtonIterate<N> {
    /// Unknown x = λ/2τ̄, 1/Pa.
    pub x: N,
    /// Equivalent shear stress τ̄(x), Pa.
    pub shear: N,
    /// Reciprocal 1/τ̄(x), 1/Pa.
    pub reciprocal: N,
    /// Factors 1/(1 + xDp) by which the stresses of the eigenspaces are scaled.
    pub scale_factors: [N; EIGENSPACE_COUNT],
    /// Squared equivalent shear stress τ̄², Pa².
    pub shear_squared: N,
    /// Slope term Σ s Dp/(1 + xDp)³ = −τ̄ dτ̄/dx, Pa³.
    pub slope: N,
    /// Residual h/τ̄ = 1 − ax − r/τ̄.
    pub residual: N,
}

impl<N: Number> NewtonIterate<N> {
    /// Placeholder iterate of a cell that does not yield: x = 0, scale factors 1.
    pub const ELASTIC: Self = Self {
        x: N::ZERO,
        shear: N::ONE,
        reciprocal: N::ONE,
        scale_factors: [N::ONE; EIGENSPACE_COUNT],
        shear_squared: N::ONE,
        slope: N::ZERO,
        residual: N::ZERO,
    };
}

impl<N: Number> ConsistencyEquation<'_, N> {
    /// Equivalent shear stress τ̄(0) of the trial stress, Pa.
    #[inline(always)]
    pub fn trial_shear(&self) -> N {
        sum_active(&self.squares, self.active).max(N::MIN_POSITIVE).sqrt()
    }

    /// Computes the iterate at x = 0, given `shear` = τ̄(0).
    #[inline(always)]
    pub fn iterate_at_zero(&self, shear: N) -> NewtonIterate<N> {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..EIGENSPACE_COUNT {
            if self.active[part] {
                norm = norm + self.squares[part];
                slope = slope + self.squares[part] * self.weighted_stiffnesses[part];
            }
        }
        self.build_iterate(
            N::ZERO,
            [N::ONE; EIGENSPACE_COUNT],
            (norm.max(N::MIN_POSITIVE), shear),
            slope,
        )
    }

    /// Computes the iterate at x.
    #[inline(always)]
    pub fn iterate_at(&self, x: N) -> NewtonIterate<N> {
        let mut scale_factors = [N::ONE; EIGENSPACE_COUNT];
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..EIGENSPACE_COUNT {
            if self.active[part] {
                scale_factors[part] = N::ONE / (N::ONE + x * self.weighted_stiffnesses[part]);
                let term = self.squares[part] * scale_factors[part] * scale_factors[part];
                norm = norm + term;
                slope = slope + term * scale_factors[part] * self.weighted_stiffnesses[part];
            }
        }
        // Avoids division by zero at zero stress.
        let norm = norm.max(N::MIN_POSITIVE);
        self.build_iterate(x, scale_factors, (norm, norm.sqrt()), slope)
    }

    #[inline(always)]
    fn build_iterate(
        &self,
        x: N,
        scale_factors: [N; EIGENSPACE_COUNT],
        (norm, shear): (N, N),
        slope: N,
    ) -> NewtonIterate<N> {
        let reciprocal = N::ONE / shear;
        let residual = N::ONE - self.a * x - self.shear_capacity * reciprocal;
        NewtonIterate { x, shear, reciprocal, scale_factors, shear_squared: norm, slope, residual }
    }

    /// Next x by a Newton step from `iterate`.
    #[inline(always)]
    pub fn newton_step(&self, iterate: &NewtonIterate<N>) -> N {
        let slope = iterate.slope / iterate.shear_squared * iterate.reciprocal;
        iterate.x + (iterate.residual / (self.a + self.shear_capacity * slope)).max(N::ZERO)
    }

    /// Next x by a Newton step with one division instead of two, bitwise equal to [`Self::newton_step`]: the increment
    /// is computed with a relative error of at most 16 ε, and [`Self::newton_step`] is called if an error of this size
    /// could change the rounded sum of x and increment.
    #[inline(always)]
    pub fn fast_newton_step(&self, iterate: &NewtonIterate<N>) -> N {
        let slope = self.a * iterate.shear_squared
            + self.shear_capacity * (iterate.slope * iterate.reciprocal);
        let increment =
            (iterate.residual.max(N::ZERO) * iterate.shear_squared / slope).max(N::ZERO);
        let margin = increment * (N::from_f64(16.0) * N::EPSILON);
        let [low, high] = [iterate.x + (increment - margin), iterate.x + (increment + margin)];
        if high.any_gt(low) { self.newton_step(iterate) } else { low }
    }

    /// Solves h(x) = 0 by Newton's method; x = 0 if τ̄(0) ≤ r. The iterates increase monotonically from zero to the
    /// root (derivation: [`Mises::project`]):
    ///
    /// ```text
    /// x + (1 − ax − r/τ̄)/(a − r τ̄′/τ̄²),  τ̄′/τ̄² = −(Σ s Dp/(1 + xDp)³)/τ̄³.
    /// ```
    ///
    /// SIMD lanes iterate until all have converged; converged lanes do not change.
    #[inline(always)]
    pub fn solve(&self) -> NewtonIterate<N> {
        let mut iterate = self.iterate_at_zero(self.trial_shear());
        let mut next = self.newton_step(&iterate);
        while next.any_gt(iterate.x) {
            iterate = self.iterate_at(next);
            if !iterate.residual.any_gt(N::ZERO) {
                break;
            }
            next = self.fast_newton_step(&iterate);
        }
        iterate
    }
}

/// Result of the return mapping. The unknown x = v/u is given in homogeneous coordinates (u, v): (1, x), or (1/x, 1)
/// for trial stresses beyond the apex.
#[derive(Clone, Copy, Debug)]
pub struct ReturnMappingResult<N> {
    /// Ratio s/s̄ of projected stress to trial stress in each eigenspace.
    pub scale_factors: [N; EIGENSPACE_COUNT],
    /// Lost fraction (s̄ − s)/s̄ of the trial stress in each eigenspace.
    pub lost_fractions: [N; EIGENSPACE_COUNT],
    /// Equivalent shear stress τ̄ of the projected stress, Pa.
    pub shear: N,
    /// Decrease κKλ of the mean stress, Pa, with the plastic multiplier λ.
    pub mean_drop: N,
    /// Elastic energy lost, J/m³.
    pub energy_lost: N,
}

impl<N: Number> ReturnMappingResult<N> {
    /// Computes the result from (u, v), `reciprocal` u/τ̄ and the factors `scale_factors` = u/(u + vDp).
    #[inline(always)]
    pub fn new(
        cone: &Cone<N>,
        squares: &[N; EIGENSPACE_COUNT],
        [u, v]: [N; 2],
        reciprocal: N,
        scale_factors: [N; EIGENSPACE_COUNT],
        active: &[bool; EIGENSPACE_COUNT],
    ) -> Self {
        let mut lost_fractions = [N::ZERO; EIGENSPACE_COUNT];
        for part in 0..EIGENSPACE_COUNT {
            if active[part] {
                lost_fractions[part] =
                    v * cone.weighted_stiffnesses[part] / (u + v * cone.weighted_stiffnesses[part]);
            }
        }
        let multiplier = (v + v) / reciprocal;
        Self {
            scale_factors,
            lost_fractions,
            shear: u / reciprocal,
            mean_drop: cone.mean_drop * multiplier,
            energy_lost: compute_energy_lost(cone, squares, &lost_fractions, multiplier, active),
        }
    }
}

/// Elastic energy lost by the projection, λk + ½ (s̄ − s)·D⁻¹(s̄ − s), J/m³, where `multiplier` is the plastic
/// multiplier λ and `squares` are the squared norms |s̄|² of the trial stress in the eigenspaces.
#[inline(always)]
pub fn compute_energy_lost<N: Number>(
    cone: &Cone<N>,
    squares: &[N; EIGENSPACE_COUNT],
    lost_fractions: &[N; EIGENSPACE_COUNT],
    multiplier: N,
    active: &[bool; EIGENSPACE_COUNT],
) -> N {
    let mut sum = cone.strength * multiplier + N::QUARTER * cone.a * multiplier * multiplier;
    for part in 0..EIGENSPACE_COUNT {
        if active[part] {
            let energy = squares[part] / cone.stiffnesses[part];
            sum = sum + N::HALF * energy * lost_fractions[part] * lost_fractions[part];
        }
    }
    sum
}
