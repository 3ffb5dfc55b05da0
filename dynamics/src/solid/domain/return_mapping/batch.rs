//! Batch of blocks with trial stresses outside their yield sets; Newton's method iterates on all blocks of a batch
//! together.
#![allow(clippy::needless_range_loop, reason = "indices are those of parts")]

use super::super::total_stress::StressTensors;
use crate::simd::Number;
use models::solid::stress::StressShape;
use models::yield_set::return_mapping::{
    Cone, ConsistencyEquation, EIGENSPACE_COUNT, EigenspaceDecomposition, NewtonIterate,
};

/// Number of blocks of a batch: enough independent iterations to hide the latency of divisions and roots.
pub(super) const BATCH_SIZE: usize = 8;

/// Block with lanes beyond their yield sets.
#[derive(Clone, Copy)]
pub(super) struct YieldingBlock<V> {
    pub(super) block_index: usize,
    /// Mask of the lanes mapped in this batch, and mask of those left to the scalar projection.
    pub(super) lanes: u16,
    pub(super) scalar_lanes: u16,
    /// Weighted squares ½p|s̄|² of the trial stress s̄ in the active eigenspaces, Pa², unused in the others; then the
    /// shear capacity r, Pa.
    pub(super) squares: [V; EIGENSPACE_COUNT],
    pub(super) shear_capacity: V,
    pub(super) iterate: NewtonIterate<V>,
    /// Mean, diagonal of the deviator and squared norm |s̄|² of the deviator of a symmetric trial stress.
    pub(super) symmetric_parts: (V, [V; 3], V),
}

impl<V: Number> YieldingBlock<V> {
    pub(super) const EMPTY: Self = Self {
        block_index: 0,
        lanes: 0,
        scalar_lanes: 0,
        squares: [V::ZERO; EIGENSPACE_COUNT],
        shear_capacity: V::ZERO,
        iterate: NewtonIterate::ELASTIC,
        symmetric_parts: (V::ZERO, [V::ZERO; 3], V::ZERO),
    };

    /// Stores an iterate of Newton's method, with the scale factors of the active eigenspaces.
    #[inline(always)]
    pub(super) fn set_iterate(
        &mut self,
        active: &[bool; EIGENSPACE_COUNT],
        iterate: &NewtonIterate<V>,
    ) {
        let stored = &mut self.iterate;
        (stored.x, stored.shear, stored.reciprocal) =
            (iterate.x, iterate.shear, iterate.reciprocal);
        (stored.shear_squared, stored.slope, stored.residual) =
            (iterate.shear_squared, iterate.slope, iterate.residual);
        for part in 0..EIGENSPACE_COUNT {
            if active[part] {
                stored.scale_factors[part] = iterate.scale_factors[part];
            }
        }
    }

    /// Returns the decomposition of the trial stress into eigenspaces.
    #[inline(always)]
    pub(super) fn stress_parts(
        &self,
        shape: StressShape,
        stress: &StressTensors<V>,
    ) -> EigenspaceDecomposition<V> {
        if !shape.is_symmetric {
            return EigenspaceDecomposition::new(shape, &stress[0], &stress[1]);
        }
        let (mean, diagonal, square) = self.symmetric_parts;
        let zero = [[V::ZERO; 3]; 3];
        let mut deviator = stress[0];
        for i in 0..3 {
            deviator[i][i] = diagonal[i];
        }
        let mut squares = [V::ZERO; EIGENSPACE_COUNT];
        squares[0] = square;
        EigenspaceDecomposition {
            force: (mean, deviator, zero),
            couple: (V::ZERO, zero, zero),
            squares,
        }
    }

    /// Returns the consistency equation of the block and its present iterate.
    #[inline(always)]
    pub(super) fn equation<'a>(
        &self,
        active: &'a [bool; EIGENSPACE_COUNT],
        cone: &Cone<V>,
    ) -> (ConsistencyEquation<'a, V>, NewtonIterate<V>) {
        let (mut squares, mut scale_factors) =
            ([V::ZERO; EIGENSPACE_COUNT], [V::ONE; EIGENSPACE_COUNT]);
        for part in 0..EIGENSPACE_COUNT {
            if active[part] {
                (squares[part], scale_factors[part]) =
                    (self.squares[part], self.iterate.scale_factors[part]);
            }
        }
        let equation = ConsistencyEquation {
            squares,
            weighted_stiffnesses: cone.weighted_stiffnesses,
            a: cone.a,
            shear_capacity: self.shear_capacity,
            active,
        };
        (equation, NewtonIterate { scale_factors, ..self.iterate })
    }
}

/// Blocks with lanes beyond their yield sets that are mapped together.
pub(super) struct Batch<V> {
    pub(super) count: usize,
    pub(super) blocks: [YieldingBlock<V>; BATCH_SIZE],
    /// Whether the last block tested had lanes beyond their sets.
    pub(super) has_last_yielded: bool,
}

/// Indices of the blocks of a batch whose iteration has not converged.
pub(super) struct PendingBlocks {
    pub(super) count: usize,
    pub(super) indices: [u8; BATCH_SIZE],
}

impl PendingBlocks {
    #[inline(always)]
    pub(super) fn push(&mut self, index: usize, is_pending: bool) {
        self.indices[self.count] = index as u8;
        self.count += usize::from(is_pending);
    }
}
