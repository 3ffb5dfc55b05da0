//! Trial stresses in SIMD lanes, tests whether they are within their yield sets, and the energy changes of their
//! mapping.

use super::super::total_stress::StressTensors;
use crate::simd::{Number, Vector};
use models::common::number::divide_by_three;
use models::solid::stress::{StressShape, Tensor};
use models::yield_set::return_mapping::{
    Cone, EIGENSPACE_COUNT, EigenspaceDecomposition, YIELD_ROUNDING, sum_active,
};

/// Energy changes of the return mapping in lanes, J/m³.
pub(super) struct EnergyChange<V> {
    pub(super) dissipation: V,
    pub(super) initial_stress_work: V,
    /// Ratio of plastic dissipation to stored energy if negative, else zero.
    pub(super) dissipation_ratios: V,
}

impl<V: Number> EnergyChange<V> {
    pub(super) const ZERO: Self =
        Self { dissipation: V::ZERO, initial_stress_work: V::ZERO, dissipation_ratios: V::ZERO };
}

/// Trial stress in lanes, and its decomposition into eigenspaces.
pub(super) struct TrialStress<V> {
    pub(super) stress: StressTensors<V>,
    pub(super) parts: EigenspaceDecomposition<V>,
    /// Weighted squares ½p|s̄|² of the trial stress s̄ by eigenspace, Pa².
    pub(super) weighted_invariants: [V; EIGENSPACE_COUNT],
    /// Square of the equivalent shear stress τ̄, Pa².
    pub(super) squared_shear: V,
    /// Shear capacity r = k − κσ̄_m, Pa.
    pub(super) shear_capacity: V,
}

impl<V: Vector<f64>> TrialStress<V> {
    #[inline(always)]
    pub(super) fn new(
        shape: StressShape,
        active: &[bool; EIGENSPACE_COUNT],
        cone: &Cone<V>,
        stress: StressTensors<V>,
    ) -> Self {
        let parts = EigenspaceDecomposition::new(shape, &stress[0], &stress[1]);
        let weighted_invariants = parts.weighted_squares(cone, active);
        let shear_capacity = cone.strength - cone.friction * parts.force.0;
        Self {
            stress,
            parts,
            weighted_invariants,
            squared_shear: sum_active(&weighted_invariants, active),
            shear_capacity,
        }
    }

    /// Whether all lanes satisfy the yield condition τ̄ ≤ r without tolerance. Then no lane yields:
    /// [`Self::yielding_lanes`] allows for rounding.
    #[inline(always)]
    pub(super) fn is_inside(&self) -> bool {
        !self.squared_shear.any_gt(self.shear_capacity * self.shear_capacity)
            && !V::ZERO.any_gt(self.shear_capacity)
    }

    /// Returns the mask of the lanes beyond the set by more than rounding, as in
    /// [`Mises::project`](models::yield_set::parameters::Mises::project).
    #[inline(always)]
    pub(super) fn yielding_lanes(&self, shape: StressShape, cone: &Cone<V>, shear: V) -> u16 {
        let mean = self.parts.force.0;
        let size = shear + cone.friction * mean.max(-mean) + cone.strength;
        let excess = shear - self.shear_capacity;
        let possible = excess.greater_lanes(V::from_f64(YIELD_ROUNDING) * size);
        // The excess is mostly far greater than the rounding errors, so that the square root in their bound is not
        // needed.
        let allowed = V::from_f64(1.0 / YIELD_ROUNDING) * excess - size;
        let [force, couple] = cone.rounding_weights;
        let [deviator, antisymmetric, couple_deviator, couple_mean, couple_antisymmetric] =
            self.parts.squares;
        let three = V::from_f64(3.0);
        let rounded = force * (deviator + antisymmetric + three * mean * mean)
            + couple * (couple_deviator + couple_mean + couple_antisymmetric);
        let certain = (V::from_f64(0.999) * allowed * allowed).greater_lanes(rounded)
            & (V::from_f64(0.5 / YIELD_ROUNDING) * excess).greater_lanes(size);
        if possible & !certain == 0 {
            return possible;
        }
        let [force, couple] = [
            force * shape.squared_norm(0, &self.stress[0]),
            couple * shape.squared_norm(1, &self.stress[1]),
        ];
        let rounded = (force + couple).sqrt();
        excess.greater_lanes(V::from_f64(YIELD_ROUNDING) * (size + rounded))
    }

    /// Returns the mask of the lanes that may be mapped to the apex: negative shear capacity, or hardly any shear
    /// stress.
    #[inline(always)]
    pub(super) fn lanes_beyond_apex(&self) -> u16 {
        V::ZERO.greater_lanes(self.shear_capacity)
            | V::MIN_POSITIVE.greater_lanes(self.squared_shear)
    }
}

/// Whether a symmetric stress is within the set in all lanes, by fewer operations than [`TrialStress::is_inside`]. The
/// squared norm |s|² = ⅓ Σ (σᵢᵢ − σⱼⱼ)² + 2 Σ σᵢⱼ² (sums over i < j) of the deviator s differs by a few rounding errors
/// from that of the decomposition, while the yield condition allows for 32 of them ([`YIELD_ROUNDING`]).
#[inline(always)]
pub(super) fn is_symmetric_stress_inside<V: Vector<f64>>(
    shape: StressShape,
    cone: &Cone<V>,
    stress: &Tensor<V>,
) -> bool {
    let mut off_diagonal = V::ZERO;
    for (i, j) in [(0, 1), (0, 2), (1, 2)] {
        if shape.has_component(0, i, j) {
            off_diagonal = off_diagonal + stress[i][j] * stress[i][j];
        }
    }
    let [a, b, c] = [stress[0][0], stress[1][1], stress[2][2]];
    let (ab, bc, ca) = (a - b, b - c, c - a);
    let square = V::THIRD * (ab * ab + bc * bc + ca * ca) + (off_diagonal + off_diagonal);
    let shear_capacity = cone.strength - cone.friction * divide_by_three(a + b + c);
    !(cone.half_weights[0] * square).any_gt(shear_capacity * shear_capacity)
        && !V::ZERO.any_gt(shear_capacity)
}
