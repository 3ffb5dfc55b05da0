//! Faces at which granular media without tension separate or slide.
//!
//! A face has one traction (n, t) and one velocity. The friction cone K of stresses admits on a plane the tractions
//! |t| ≤ −fn, with f of [`GranularContact::traction_friction`](models::granular_medium::GranularContact::traction_friction).
//! The traction σ* is the one of this cone nearest to that of the closed face, σ, in the norm of the admittances
//! a = 1/z + 1/y of the sides. With this traction, characteristics give each side its own velocity; the gap between them
//! is a(σ − σ*), which is in the polar cone and does no work, σ*·a(σ − σ*) = 0. The side of smaller friction takes it as
//! strain, two equal sides half each, which in one medium is the velocity of the closed face. Such strain does no
//! positive work on any stress of K: a step without slopes does not increase the energy ½σ:a:σ of σ = π_K(s), since its
//! derivative in s along the strain is not positive. Smooth waves keep their accuracy, since their tractions are in the
//! cone.
//!
//! Where the contacts of both cells stay open during the sweep, by an estimate of the greatest strain, the face has no
//! traction in compression either: the stress stays zero.
//!
//! Differences across a face that separates or slides, or between cells without stress, say nothing about waves, and
//! slopes from them would increase the energy: the limiter takes them as zero. Beside physical boundaries, which always
//! transmit tension, ghosts are mirror images, without slope across the boundary.

#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::{BOUNDARY_HISTORY, ContactConstants, magnitude};
use crate::simd::Number;
use crate::solid::riemann::State;
use models::uniaxial::NO_LIMIT;

/// Invariants of the excess stress.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ExcessInvariants<N> {
    /// Sum of the normal components, Pa.
    sum: N,
    /// Norm of the deviator, Pa.
    deviator: N,
}

impl<N: Number> ExcessInvariants<N> {
    pub(crate) const ZERO: Self = Self { sum: N::ZERO, deviator: N::ZERO };

    /// Computes the invariants from the normal components and the sum of the squares of the shear components.
    #[inline(always)]
    pub(crate) fn new([a, b, c]: [N; 3], shear_squares: N) -> Self {
        let differences = (a - b) * (a - b) + (b - c) * (b - c) + (c - a) * (c - a);
        let squares = N::THIRD * differences + (shear_squares + shear_squares);
        Self { sum: a + b + c, deviator: squares.sqrt() }
    }

    /// Returns 1 beyond physical boundaries, else 0.
    #[inline(always)]
    pub(crate) fn is_outside(&self) -> N {
        N::from_f64(0.5 * BOUNDARY_HISTORY).select_gt(self.sum, N::ONE, N::ZERO)
    }

    /// Returns the longitudinal strain that at least is needed to close the contacts.
    #[inline(always)]
    pub(crate) fn opening(&self, contact: &ContactConstants<N>) -> N {
        let [of_sum, of_deviator] = contact.excess_compliances;
        of_sum * self.sum - of_deviator * self.deviator
    }
}

/// Estimates the greatest strain that the jumps at the face between two cells can cause during the sweep, in terms of
/// longitudinal strain. `states`: those of both cells by pair.
#[inline(always)]
pub(crate) fn face_strain<N: Number, const P: usize>(
    contact: &ContactConstants<N>,
    states: [[State<N>; 2]; P],
    longitudinal: usize,
) -> N {
    let mut strain = contact.face_strain(states[longitudinal]);
    let [of_velocity, of_stress] = contact.shear_strains;
    for pair in 0..P {
        if pair != longitudinal {
            let [lower, upper] = states[pair];
            strain = strain
                + (of_velocity * magnitude(upper.velocity - lower.velocity)
                    + of_stress * magnitude(upper.stress - lower.stress));
        }
    }
    strain
}

/// Returns 1 if contacts are open and stay so, else 0: open contacts have no stress. `stress`: sum of the magnitudes of
/// the tractions.
#[inline(always)]
pub(crate) fn stays_open<N: Number>(opening: N, greatest_strain: N, stress: N) -> N {
    let is_unstressed = stress.select_gt(N::ZERO, N::ZERO, N::ONE);
    opening.select_gt(greatest_strain, is_unstressed, N::ZERO)
}

/// Computes the magnitude of the tangential traction.
#[inline(always)]
pub(crate) fn tangential_magnitude<N: Number, const P: usize>(
    tractions: [N; P],
    longitudinal: usize,
) -> N {
    if P == 2 {
        return magnitude(tractions[1 - longitudinal.min(1)]);
    }
    let mut squares = N::ZERO;
    for pair in 0..P {
        if pair != longitudinal {
            squares = squares + tractions[pair] * tractions[pair];
        }
    }
    squares.sqrt()
}

/// Returns 1 if a traction is outside the cone, else 0.
#[inline(always)]
fn leaves_cone<N: Number>(friction: N, normal: N, tangential: N) -> N {
    let is_tensile = normal.select_gt(N::ZERO, N::ONE, N::ZERO);
    tangential.select_gt(-(friction * normal), N::ONE, is_tensile)
}

/// Returns 0 where two cells separate or slide, by the tractions of the face between their mean states, or have no stress;
/// else 1. `friction`: the smaller one of the cells; `stress`: sum of the magnitudes of the tractions in the cells.
#[inline(always)]
pub(crate) fn continuity<N: Number, const P: usize>(
    friction: N,
    tractions: [N; P],
    longitudinal: usize,
    stress: N,
) -> N {
    let tangential = tangential_magnitude(tractions, longitudinal);
    let leaves = leaves_cone(friction, tractions[longitudinal], tangential);
    let is_continuous =
        leaves.select_gt(N::ZERO, N::ZERO, stress.select_gt(N::ZERO, N::ONE, N::ZERO));
    N::from_f64(NO_LIMIT).select_gt(friction, is_continuous, N::ONE)
}

/// Cone of the tractions that a face admits, with the norm of the projection onto it.
#[derive(Clone, Copy)]
pub(crate) struct TractionCone<N> {
    friction: N,
    /// κf and 1/(1 + κf²), with the ratio κ of the admittances of transverse and longitudinal waves.
    weights: [N; 2],
}

impl<N: Number> TractionCone<N> {
    /// Creates a cone for the ratio κ of the admittances of transverse and longitudinal waves.
    #[inline(always)]
    pub(crate) fn new(friction: N, admittance_ratio: N) -> Self {
        let weight = admittance_ratio * friction;
        Self { friction, weights: [weight, N::ONE / (N::ONE + weight * friction)] }
    }

    /// Projects a traction; returns the normal traction and the factor of the tangential one.
    #[inline(always)]
    pub(crate) fn project(&self, normal: N, tangential: N) -> (N, N) {
        let [weight, inverse] = self.weights;
        let pressure = ((weight * tangential - normal) * inverse).max(N::ZERO);
        let factor = self.friction * pressure / tangential.max(N::MIN_POSITIVE);
        let leaves = leaves_cone(self.friction, normal, tangential);
        (
            leaves.select_gt(N::ZERO, N::ZERO - pressure, normal),
            leaves.select_gt(N::ZERO, factor.min(N::ONE), N::ONE),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::TractionCone;

    /// The projection is in the cone, and the rest is in its polar cone and orthogonal to it, in the norm of the
    /// admittances: the conditions for the nearest point (Moreau).
    #[test]
    fn projections_onto_the_cone_of_tractions_meet_the_conditions_of_moreau() {
        for friction in [0.0, 0.3, 1.0, 40.0] {
            for ratio in [1.0f64, 1.7] {
                let cone = TractionCone::new(friction, ratio);
                for normal in [-2.0, -0.4, -1e-3, 0.0, 0.2, 3.0] {
                    for tangential in [0.0, 1e-3, 0.1, 0.9, 5.0] {
                        let (n, factor) = cone.project(normal, tangential);
                        let t = factor * tangential;
                        let [rest_n, rest_t] = [normal - n, ratio * (tangential - t)];
                        assert!(t <= -friction * n + 1e-12 && n <= 0.0, "{normal} {tangential}");
                        assert!(rest_n >= friction * rest_t - 1e-12, "{normal} {tangential}");
                        assert!((rest_n * n + rest_t * t).abs() < 1e-12, "{normal} {tangential}");
                    }
                }
            }
        }
    }
}
