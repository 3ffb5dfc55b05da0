//! The return mapping of Mises' sets, over any kind of number: a stress alone, or many side by side.
//!
//! [`Mises::project`] derives it. All that stands here holds for stresses with k − κσ̄_m ≥ 0; those beyond, which
//! may have to go to the apex, are left to that function.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors and parts")]

use super::parameters::Mises;
use crate::common::number::Number;
use crate::solid::parameters::Isotropic;
use crate::solid::stress::{Shape, Tensor};

/// Parts of the stress on which Hooke's law acts by a number: deviator, antisymmetric stress, deviator, mean
/// and antisymmetric part of the couple stress.
pub const PARTS: usize = 5;

/// Rounding of a condition's value, relative to the terms that it compares: a power of 2.
pub const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A set of Mises' with the solid whose stress it holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone<N> {
    /// k, Pa.
    pub strength: N,
    /// κ.
    pub friction: N,
    /// κK, Pa: by how much the mean falls per multiplier.
    pub fall: N,
    /// a = 2κ²K, Pa.
    pub a: N,
    /// ½p of the parts, of those of couple stress in 1/m²; zero where a part has no weight or no stiffness: it is left
    /// alone.
    pub half_weights: [N; PARTS],
    /// D, Pa or N; 1 where a part is left alone.
    pub stiffnesses: [N; PARTS],
    /// Dp, Pa.
    pub rates: [N; PARTS],
    /// The greater of h and 1, and the greatest weight of the couple stress, 1/m²: what the rounding of components
    /// counts for.
    pub rounding_weights: [N; 2],
}

impl Cone<f64> {
    /// The set of a solid.
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
            fall: friction * bulk,
            a: 2.0 * friction * friction * bulk,
            half_weights: parts.map(|part| seen(part, 0.5 * part[0], 0.0)),
            stiffnesses: parts.map(|part| seen(part, part[1], 1.0)),
            rates: parts.map(|part| seen(part, part[1] * part[0], 0.0)),
            rounding_weights: [set.antisymmetric_weight.max(1.0), parts[2][0].max(parts[4][0])],
        }
    }

    /// The set of a solid that does not yield, with a strength that nothing comes near.
    pub fn unbounded(strength: f64) -> Self {
        Self {
            strength,
            friction: 0.0,
            fall: 0.0,
            a: 0.0,
            half_weights: [0.0; PARTS],
            stiffnesses: [1.0; PARTS],
            rates: [0.0; PARTS],
            rounding_weights: [1.0, 0.0],
        }
    }

    /// Which parts it does not leave alone.
    pub fn seen(&self) -> [bool; PARTS] {
        self.half_weights.map(|weight| weight > 0.0)
    }
}

impl<N: Copy> Cone<N> {
    /// Each constant made of those of other cones.
    pub fn gather<M>(mut value: impl FnMut(&dyn Fn(&Cone<M>) -> M) -> N) -> Self
    where
        M: Copy,
    {
        Self {
            strength: value(&|own| own.strength),
            friction: value(&|own| own.friction),
            fall: value(&|own| own.fall),
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

/// A trial stress in parts.
#[derive(Clone, Copy, Debug)]
pub struct Parts<N> {
    /// Mean σ̄_m, deviator and antisymmetric part of the force stress.
    pub force: (N, Tensor<N>, Tensor<N>),
    /// Those of the couple stress.
    pub couple: (N, Tensor<N>, Tensor<N>),
    /// |s̄|².
    pub squares: [N; PARTS],
}

impl<N: Number> Parts<N> {
    /// The parts of force and couple stress.
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

    /// ½p|s̄|² of the parts that are seen.
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

    /// Force and couple stress with so much of each part, and this mean.
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

/// Σ over the parts that are seen.
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

/// The equation h(x) = τ̄(x)(1 − ax) − r = 0 for x = λ/2τ̄, where r = k − κσ̄_m ≥ 0 and τ̄(x)² = Σ s/(1 + xDp)² over the
/// parts that are seen.
#[derive(Clone, Copy, Debug)]
pub struct Equation<'a, N> {
    /// s = ½p|s̄|² of the parts, Pa².
    pub squares: [N; PARTS],
    /// Dp of the parts, Pa.
    pub rates: [N; PARTS],
    /// a = 2κ²K, Pa.
    pub a: N,
    /// r, Pa.
    pub room: N,
    /// The parts that are seen.
    pub seen: &'a [bool; PARTS],
}

/// An iterate of Newton's method, and what the equation is there.
#[derive(Clone, Copy, Debug)]
pub struct Iterate<N> {
    /// x = λ/2τ̄, 1/Pa.
    pub x: N,
    /// τ̄(x), Pa.
    pub shear: N,
    /// Its reciprocal, 1/Pa.
    pub reciprocal: N,
    /// 1/(1 + xDp): what is kept of each part.
    pub kept: [N; PARTS],
    /// τ̄², Pa².
    pub norm: N,
    /// Σ s Dp/(1 + xDp)³, Pa³.
    pub slope: N,
    /// 1 − ax − r/τ̄: h over τ̄.
    pub excess: N,
}

impl<N: Number> Iterate<N> {
    /// Of no equation.
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
    /// τ̄(0), Pa.
    #[inline(always)]
    pub fn shear_at_zero(&self) -> N {
        sum_of(&self.squares, self.seen).greatest(N::LEAST).root()
    }

    /// At zero, where τ̄ is this.
    #[inline(always)]
    pub fn at_zero(&self, shear: N) -> Iterate<N> {
        let (mut norm, mut slope) = (N::ZERO, N::ZERO);
        for part in 0..PARTS {
            if self.seen[part] {
                norm = norm + self.squares[part];
                slope = slope + self.squares[part] * self.rates[part];
            }
        }
        self.iterate(N::ZERO, [N::ONE; PARTS], (norm.greatest(N::LEAST), shear), slope)
    }

    /// At x.
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
        // Where there is no stress there is nothing to be found.
        let norm = norm.greatest(N::LEAST);
        self.iterate(x, kept, (norm, norm.root()), slope)
    }

    #[inline(always)]
    fn iterate(&self, x: N, kept: [N; PARTS], (norm, shear): (N, N), slope: N) -> Iterate<N> {
        let reciprocal = N::ONE / shear;
        let excess = N::ONE - self.a * x - self.room * reciprocal;
        Iterate { x, shear, reciprocal, kept, norm, slope, excess }
    }

    /// The iterate after zero.
    #[inline(always)]
    pub fn first(&self, at: &Iterate<N>) -> N {
        let slope = at.slope / at.norm * at.reciprocal;
        at.x + (at.excess / (self.a + self.room * slope)).greatest(N::ZERO)
    }

    /// The iterate after any other, as [`Self::first`] has it, but with one division in the place of two where that makes
    /// no difference: the quotient is known but for so many roundings, and next to the root it is small beside x.
    #[inline(always)]
    pub fn next(&self, at: &Iterate<N>) -> N {
        let slope = self.a * at.norm + self.room * (at.slope * at.reciprocal);
        let more = (at.excess.greatest(N::ZERO) * at.norm / slope).greatest(N::ZERO);
        let margin = more * (N::constant(16.0) * N::EPSILON);
        let [low, high] = [at.x + (more - margin), at.x + (more + margin)];
        if high.exceeds(low) { self.first(at) } else { low }
    }

    /// The root by Newton's method, zero where τ̄(0) ≤ r. Derived at [`Mises::project`]: from zero the iterates rise to it
    /// and never pass it, each
    ///
    /// ```text
    /// x + (1 − ax − r/τ̄)/(a − r τ̄′/τ̄²),  τ̄′/τ̄² = −(Σ s Dp/(1 + xDp)³)/τ̄³.
    /// ```
    ///
    /// Numbers in lanes go on until all are there; who is there stays.
    #[inline(always)]
    pub fn root(&self) -> Iterate<N> {
        let mut at = self.at_zero(self.shear_at_zero());
        let mut next = self.first(&at);
        while next.exceeds(at.x) {
            at = self.at(next);
            if !at.excess.exceeds(N::ZERO) {
                break;
            }
            next = self.next(&at);
        }
        at
    }
}

/// Where the return mapping leads, by u and v: 1 and x, or 1/x and 1.
#[derive(Clone, Copy, Debug)]
pub struct Mapped<N> {
    /// s/s̄ of each part.
    pub kept: [N; PARTS],
    /// (s̄ − s)/s̄ of each part.
    pub lost: [N; PARTS],
    /// τ̄ there, Pa.
    pub shear: N,
    /// κKλ, Pa: by how much the mean falls.
    pub fall: N,
    /// Elastic energy lost, J/m³.
    pub energy_lost: N,
}

impl<N: Number> Mapped<N> {
    /// With u and v, u/τ̄, and what is kept of each part: u/(u + vDp).
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
            fall: cone.fall * multiplier,
            energy_lost: energy_lost(cone, squares, &lost, multiplier, seen),
        }
    }
}

/// Σ λk + ½ (s̄ − s)·D⁻¹(s̄ − s), J/m³, of squares |s̄|².
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
