//! Return mapping of von Mises, Drucker–Prager and Cosserat–Mises cones, generic over single stresses and SIMD lanes.
//!
//! Derivation: [`Mises::project`]. Valid for trial stresses with shear capacity k − κσ̄_m ≥ 0; `Mises::project` also
//! maps stresses beyond the apex.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use super::parameters::Mises;
use crate::common::number::Number;
use crate::solid::parameters::Isotropic;
use crate::solid::stress::{Shape, Tensor};

/// Number of stress parts (eigenspaces of Hooke's law): deviator and antisymmetric part of the force stress; deviator,
/// mean and antisymmetric part of the couple stress.
pub const PARTS: usize = 5;

/// Rounding error of the value of a yield condition, relative to the magnitudes of its terms; a power of 2.
pub const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// Coefficients of the return mapping of a [`Mises`] cone in an isotropic solid.
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
    /// Half weights ½p of the parts, in 1/m² for the couple stress; zero for a passive part, without weight or
    /// stiffness, which the mapping leaves unchanged.
    pub half_weights: [N; PARTS],
    /// Stiffnesses D, Pa or N; 1 for passive parts.
    pub stiffnesses: [N; PARTS],
    /// Products Dp, Pa.
    pub rates: [N; PARTS],
    /// Weights of the rounding errors of the stress components: max(h, 1) for the force stress, and the largest weight
    /// p for the couple stress, 1/m².
    pub rounding_weights: [N; 2],
}

impl Cone<f64> {
    /// Coefficients of the cone `set` in `solid`.
    pub fn new(set: &Mises, solid: &Isotropic) -> Self {
        let bulk = solid.lambda + 2.0 / 3.0 * solid.mu;
        let Mises { friction, strength, .. } = *set;
        let parts = set.parts(solid);
        let is_seen = |[weight, stiffness]: [f64; 2]| weight > 0.0 && stiffness > 0.0;
        let seen =
            |part: [f64; 2], value: f64, other: f64| if is_seen(part) { value } else { other };
        Self {
            strength,
            friction,
            mean_drop: friction * bulk,
            a: 2.0 * friction * friction * bulk,
            half_weights: parts.map(|part| seen(part, 0.5 * part[0], 0.0)),
            stiffnesses: parts.map(|part| seen(part, part[1], 1.0)),
            rates: parts.map(|part| seen(part, part[1] * part[0], 0.0)),
            rounding_weights: [set.antisymmetric_weight.max(1.0), parts[2][0].max(parts[4][0])],
        }
    }

    /// A cone that never yields, for elastic solids: strength `strength` (Pa) far above every stress.
    pub fn unbounded(strength: f64) -> Self {
        Self {
            strength,
            friction: 0.0,
            mean_drop: 0.0,
            a: 0.0,
            half_weights: [0.0; PARTS],
            stiffnesses: [1.0; PARTS],
            rates: [0.0; PARTS],
            rounding_weights: [1.0, 0.0],
        }
    }

    /// Flags of the active parts, which the mapping changes.
    pub fn seen(&self) -> [bool; PARTS] {
        self.half_weights.map(|weight| weight > 0.0)
    }
}

impl<N: Copy> Cone<N> {
    /// Builds a cone whose coefficients are computed by `value` from the same coefficient of other cones, e.g. SIMD
    /// lanes from single cones.
    pub fn gather<M>(mut value: impl FnMut(&dyn Fn(&Cone<M>) -> M) -> N) -> Self
    where
        M: Copy,
    {
        Self {
            strength: value(&|own| own.strength),
            friction: value(&|own| own.friction),
            mean_drop: value(&|own| own.mean_drop),
            a: value(&|own| own.a),
            half_weights: std::array::from_fn(|part| value(&|own| own.half_weights[part])),
            stiffnesses: std::array::from_fn(|part| value(&|own| own.stiffnesses[part])),
            rates: std::array::from_fn(|part| value(&|own| own.rates[part])),
            rounding_weights: std::array::from_fn(|which| {
                value(&|own| own.rounding_weights[which])
            }),
        }
    }
}

/// A trial stress decomposed into the eigenspaces of Hooke's law.
#[derive(Clone, Copy, Debug)]
pub struct Parts<N> {
    /// Mean σ̄_m, deviator and antisymmetric part of the force stress.
    pub force: (N, Tensor<N>, Tensor<N>),
    /// Mean, deviator and antisymmetric part of the couple stress.
    pub couple: (N, Tensor<N>, Tensor<N>),
    /// Squared norms |s̄|² of the parts.
    pub squares: [N; PARTS],
}

impl<N: Number> Parts<N> {
    /// Decomposes force and couple stress.
    #[inline(always)]
    pub fn new(shape: Shape, force: &Tensor<N>, couple: &Tensor<N>) -> Self {
        let force = shape.split(force);
        let mut parts = Self {
            force,
            couple: (N::ZERO, [[N::ZERO; 3]; 3], [[N::ZERO; 3]; 3]),
            squares: [N::ZERO; PARTS],
        };
        parts.squares[0] = shape.square(0, &force.1);
        if !shape.is_symmetric {
            parts.squares[1] = shape.square_antisymmetric(0, &force.2);
        }
        if shape.has_couples {
            parts.couple = shape.split(couple);
            let (mean, deviator, antisymmetric) = &parts.couple;
            parts.squares[2] = shape.square(1, deviator);
            parts.squares[3] = (N::ONE + N::ONE + N::ONE) * *mean * *mean;
            parts.squares[4] = shape.square_antisymmetric(1, antisymmetric);
        }
        parts
    }

    /// Weighted squares ½p|s̄|² of the active parts, Pa²; zero for passive parts.
    #[inline(always)]
    pub fn weighted(&self, cone: &Cone<N>, seen: &[bool; PARTS]) -> [N; PARTS] {
        let mut weighted = [N::ZERO; PARTS];
        for part in 0..PARTS {
            if seen[part] {
                weighted[part] = cone.half_weights[part] * self.squares[part];
            }
        }
        weighted
    }

    /// Force and couple stress with each part scaled by its factor in `kept` and the mean of the force stress replaced
    /// by `mean`.
    #[inline(always)]
    pub fn scaled(&self, shape: Shape, kept: &[N; PARTS], mean: N) -> (Tensor<N>, Tensor<N>) {
        let [mut force, mut couple] = [[[N::ZERO; 3]; 3]; 2];
        for i in 0..3 {
            for j in 0..3 {
                let diagonal = if i == j { N::ONE } else { N::ZERO };
                if shape.has(0, i, j) {
                    let antisymmetric = match shape.is_symmetric {
                        true => N::ZERO,
                        false => kept[1] * self.force.2[i][j],
                    };
                    force[i][j] = kept[0] * self.force.1[i][j] + antisymmetric + mean * diagonal;
                }
                if shape.has(1, i, j) {
                    couple[i][j] = kept[2] * self.couple.1[i][j]
                        + kept[3] * self.couple.0 * diagonal
                        + kept[4] * self.couple.2[i][j];
                }
            }
        }
        (force, couple)
    }
}

/// Sum of `terms` over the active parts.
#[inline(always)]
pub fn sum_of<N: Number>(terms: &[N; PARTS], seen: &[bool; PARTS]) -> N {
    let mut sum = N::ZERO;
    for part in 0..PARTS {
        if seen[part] {
            sum = sum + terms[part];
        }
    }
    sum
}

/// The equation h(x) = τ̄(x)(1 − ax) − r = 0 for x = λ/2τ̄, where r = k − κσ̄_m ≥ 0 and τ̄(x)² = Σ s/(1 + xDp)² over
/// the active parts.
#[derive(Clone, Copy, Debug)]
pub struct Equation<'a, N> {
    /// Weighted squares s = ½p|s̄|² of the parts, Pa².
    pub squares: [N; PARTS],
    /// Products Dp of the parts, Pa.
    pub rates: [N; PARTS],
    /// Coefficient a = 2κ²K, Pa.
    pub a: N,
    /// Shear capacity r = k − κσ̄_m, Pa.
    pub shear_capacity: N,
    /// Flags of the active parts.
    pub seen: &'a [bool; PARTS],
}

/// An iterate of Newton's method with the terms of the equation at x.
#[derive(Clone, Copy, Debug)]
pub struct Iterate<N> {
    /// Unknown x = λ/2τ̄, 1/Pa.
    pub x: N,
    /// Equivalent shear stress τ̄(x), Pa.
    pub shear: N,
    /// Reciprocal 1/τ̄(x), 1/Pa.
    pub reciprocal: N,
    /// Factors 1/(1 + xDp) by which the parts are scaled.
    pub kept: [N; PARTS],
    /// Squared equivalent shear stress τ̄², Pa².
    pub norm: N,
    /// Slope term Σ s Dp/(1 + xDp)³, Pa³.
    pub slope: N,
    /// Residual h/τ̄ = 1 − ax − r/τ̄.
    pub excess: N,
}

impl<N: Number> Iterate<N> {
    /// Placeholder iterate of an elastic cell: x = 0, factors 1.
    pub const NONE: Self = Self {
        x: N::ZERO,
        shear: N::ONE,
        reciprocal: N::ONE,
        kept: [N::ONE; PARTS],
        norm: N::ONE,
        slope: N::ZERO,
        excess: N::ZERO,
    };
}

impl<N: Number> Equation<'_, N> {
    /// Equivalent shear stress τ̄(0) of the trial stress, Pa.
    #[inline(always)]
    pub fn shear_at_zero(&self) -> N {
        sum_of(&self.squares, self.seen).max(N::MIN_POSITIVE).sqrt()
    }

    /// Computes the iterate at x = 0, given `shear` = τ̄(0).
    #[inline(always)]
    pub fn at_zero(&self, shear: N) -> Iterate<N> {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..PARTS {
            if self.seen[part] {
                norm = norm + self.squares[part];
                slope = slope + self.squares[part] * self.rates[part];
            }
        }
        self.iterate(N::ZERO, [N::ONE; PARTS], (norm.max(N::MIN_POSITIVE), shear), slope)
    }

    /// Computes the iterate at x.
    #[inline(always)]
    pub fn at(&self, x: N) -> Iterate<N> {
        let mut kept = [N::ONE; PARTS];
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..PARTS {
            if self.seen[part] {
                kept[part] = N::ONE / (N::ONE + x * self.rates[part]);
                let term = self.squares[part] * kept[part] * kept[part];
                norm = norm + term;
                slope = slope + term * kept[part] * self.rates[part];
            }
        }
        // Avoids division by zero at zero stress.
        let norm = norm.max(N::MIN_POSITIVE);
        self.iterate(x, kept, (norm, norm.sqrt()), slope)
    }

    #[inline(always)]
    fn iterate(&self, x: N, kept: [N; PARTS], (norm, shear): (N, N), slope: N) -> Iterate<N> {
        let reciprocal = N::ONE / shear;
        let excess = N::ONE - self.a * x - self.shear_capacity * reciprocal;
        Iterate { x, shear, reciprocal, kept, norm, slope, excess }
    }

    /// Next x by a Newton step from the iterate `at`.
    #[inline(always)]
    pub fn first(&self, at: &Iterate<N>) -> N {
        let slope = at.slope / at.norm * at.reciprocal;
        at.x + (at.excess / (self.a + self.shear_capacity * slope)).max(N::ZERO)
    }

    /// Next x by a Newton step with one division instead of two, bitwise equal to [`Self::first`]: the increment is
    /// computed with a relative error bound of 16 ε, and [`Self::first`] is called if the bound could change the
    /// rounded sum.
    #[inline(always)]
    pub fn next(&self, at: &Iterate<N>) -> N {
        let slope = self.a * at.norm + self.shear_capacity * (at.slope * at.reciprocal);
        let more = (at.excess.max(N::ZERO) * at.norm / slope).max(N::ZERO);
        let margin = more * (N::from_f64(16.0) * N::EPSILON);
        let [low, high] = [at.x + (more - margin), at.x + (more + margin)];
        if high.any_gt(low) { self.first(at) } else { low }
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
    pub fn solve(&self) -> Iterate<N> {
        let mut at = self.at_zero(self.shear_at_zero());
        let mut next = self.first(&at);
        while next.any_gt(at.x) {
            at = self.at(next);
            if !at.excess.any_gt(N::ZERO) {
                break;
            }
            next = self.next(&at);
        }
        at
    }
}

/// Result of the return mapping. The unknown x = v/u is given in homogeneous coordinates (u, v): (1, x), or (1/x, 1)
/// beyond the apex.
#[derive(Clone, Copy, Debug)]
pub struct Mapped<N> {
    /// Ratio s/s̄ of each part.
    pub kept: [N; PARTS],
    /// Lost fraction (s̄ − s)/s̄ of each part.
    pub lost: [N; PARTS],
    /// Equivalent shear stress τ̄ of the projected stress, Pa.
    pub shear: N,
    /// Decrease of the mean stress κKλ, Pa.
    pub mean_drop: N,
    /// Elastic energy lost, J/m³.
    pub energy_lost: N,
}

impl<N: Number> Mapped<N> {
    /// Computes the result from (u, v), `reciprocal` u/τ̄ and the factors `kept` = u/(u + vDp).
    #[inline(always)]
    pub fn new(
        cone: &Cone<N>,
        squares: &[N; PARTS],
        [u, v]: [N; 2],
        reciprocal: N,
        kept: [N; PARTS],
        seen: &[bool; PARTS],
    ) -> Self {
        let mut lost = [N::ZERO; PARTS];
        for part in 0..PARTS {
            if seen[part] {
                lost[part] = v * cone.rates[part] / (u + v * cone.rates[part]);
            }
        }
        let multiplier = (v + v) / reciprocal;
        Self {
            kept,
            lost,
            shear: u / reciprocal,
            mean_drop: cone.mean_drop * multiplier,
            energy_lost: energy_lost(cone, squares, &lost, multiplier, seen),
        }
    }
}

/// Elastic energy lost by the projection, Σ λk + ½ (s̄ − s)·D⁻¹(s̄ − s), J/m³; `squares` are |s̄|².
#[inline(always)]
pub fn energy_lost<N: Number>(
    cone: &Cone<N>,
    squares: &[N; PARTS],
    lost: &[N; PARTS],
    multiplier: N,
    seen: &[bool; PARTS],
) -> N {
    let mut sum = cone.strength * multiplier + N::QUARTER * cone.a * multiplier * multiplier;
    for part in 0..PARTS {
        if seen[part] {
            let energy = squares[part] / cone.stiffnesses[part];
            sum = sum + N::HALF * energy * lost[part] * lost[part];
        }
    }
    sum
}
