//! Batch of blocks of trial stresses beyond their yield sets, for which Newton's method runs together.
#![allow(clippy::needless_range_loop, reason = "indices are those of parts")]

use super::super::total_stress::Tensors;
use crate::simd::Number;
use models::solid::stress::Shape;
use models::yield_set::return_mapping::{Cone, Equation, Iterate, PARTS, Parts};

/// Number of blocks of a batch: enough independent iterations to hide the latency of divisions and roots.
pub(super) const BATCH: usize = 8;

/// Block with lanes beyond their sets.
#[derive(Clone, Copy)]
pub(super) struct Found<V> {
    pub(super) place: usize,
    /// Masks of the lanes mapped in this batch, and of those left to the scalar projection.
    pub(super) lanes: u16,
    pub(super) alone: u16,
    /// ½p|s̄|² of the parts with nonzero weight, all others being unused; then the shear capacity r.
    pub(super) squares: [V; PARTS],
    pub(super) room: V,
    pub(super) at: Iterate<V>,
    /// Mean, diagonal of the deviator and |s̄|² of a symmetric stress.
    pub(super) symmetric: (V, [V; 3], V),
}

impl<V: Number> Found<V> {
    pub(super) const NONE: Self = Self {
        place: 0,
        lanes: 0,
        alone: 0,
        squares: [V::ZERO; PARTS],
        room: V::ZERO,
        at: Iterate::NONE,
        symmetric: (V::ZERO, [V::ZERO; 3], V::ZERO),
    };

    /// Stores an iterate, for the parts with nonzero weight.
    #[inline(always)]
    pub(super) fn set(&mut self, seen: &[bool; PARTS], at: &Iterate<V>) {
        let own = &mut self.at;
        (own.x, own.shear, own.reciprocal) = (at.x, at.shear, at.reciprocal);
        (own.norm, own.slope, own.excess) = (at.norm, at.slope, at.excess);
        for part in 0..PARTS {
            if seen[part] {
                own.kept[part] = at.kept[part];
            }
        }
    }

    /// Returns the parts of the trial stress.
    #[inline(always)]
    pub(super) fn parts(&self, shape: Shape, stress: &Tensors<V>) -> Parts<V> {
        if !shape.is_symmetric {
            return Parts::new(shape, &stress[0], &stress[1]);
        }
        let (mean, diagonal, square) = self.symmetric;
        let zero = [[V::ZERO; 3]; 3];
        let mut deviator = stress[0];
        for i in 0..3 {
            deviator[i][i] = diagonal[i];
        }
        let mut squares = [V::ZERO; PARTS];
        squares[0] = square;
        Parts { force: (mean, deviator, zero), couple: (V::ZERO, zero, zero), squares }
    }

    /// Returns the equation of the block and its present iterate.
    #[inline(always)]
    pub(super) fn equation<'a>(
        &self,
        seen: &'a [bool; PARTS],
        cone: &Cone<V>,
    ) -> (Equation<'a, V>, Iterate<V>) {
        let (mut squares, mut kept) = ([V::ZERO; PARTS], [V::ONE; PARTS]);
        for part in 0..PARTS {
            if seen[part] {
                (squares[part], kept[part]) = (self.squares[part], self.at.kept[part]);
            }
        }
        let equation =
            Equation { squares, rates: cone.rates, a: cone.a, shear_capacity: self.room, seen };
        (equation, Iterate { kept, ..self.at })
    }
}

pub(super) struct Batch<V> {
    pub(super) count: usize,
    pub(super) found: [Found<V>; BATCH],
    /// Whether the last block tested had lanes beyond their sets.
    pub(super) was_found: bool,
}

/// Blocks of a batch whose iteration has not converged.
pub(super) struct Pending {
    pub(super) count: usize,
    pub(super) all: [u8; BATCH],
}

impl Pending {
    #[inline(always)]
    pub(super) fn push(&mut self, index: usize, is_pending: bool) {
        self.all[self.count] = index as u8;
        self.count += usize::from(is_pending);
    }
}
