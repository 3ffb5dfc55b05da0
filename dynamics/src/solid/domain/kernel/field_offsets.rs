//! Fields of a pair of waves in the groups of a line.

use super::{Rows, prefetch};
use crate::simd::{Real, Vector};
use crate::solid::riemann::State;
use std::ops::Range;

/// Offsets of the fields of a pair of waves in a group.
pub(super) struct FieldOffsets<const PASSIVE: usize> {
    pub(super) velocity: usize,
    pub(super) stress: usize,
    pub(super) passive_stresses: [usize; PASSIVE],
    /// Number of passive stresses: `PASSIVE` in lines of one medium, at most that in others.
    pub(super) passive_count: usize,
    /// Upper bound, exclusive, of the offsets of all fields.
    pub(super) extent: usize,
    /// Range of the offsets that are prefetched into L2, prefetch distance included: one group at each pitch.
    pub(super) prefetch_l2_offsets: Range<usize>,
}

impl<const PASSIVE: usize> FieldOffsets<PASSIVE> {
    /// Sets the padding lanes of the fields of a row to zero.
    #[inline(always)]
    pub(super) fn clear_padding<T: Real>(
        &self,
        rows: &Rows<T>,
        field_data: &mut [T::Lanes],
        row: usize,
    ) {
        rows.clear_padding(field_data, self.velocity, row);
        rows.clear_padding(field_data, self.stress, row);
        for field in self.passive_stresses.into_iter().take(self.passive_count) {
            rows.clear_padding(field_data, field, row);
        }
    }
}

/// Loads the state of the next group of a line, and prefetches the groups that are needed soon; `l1_distance` and `pitch`:
/// those of the lines.
#[inline(always)]
pub(super) fn load_next<T: Real, V: Vector<T>, const PASSIVE: usize>(
    field_data: &[T::Lanes],
    offsets: &FieldOffsets<PASSIVE>,
    [l1_distance, pitch]: [usize; 2],
    start: usize,
) -> State<V> {
    let group = &field_data[start..][..offsets.extent];
    prefetch(group, l1_distance + offsets.velocity, true);
    prefetch(group, l1_distance + offsets.stress, true);
    let mut place = offsets.prefetch_l2_offsets.start;
    while place < offsets.prefetch_l2_offsets.end {
        prefetch(group, place, false);
        place += pitch;
    }
    State { velocity: V::load(&group[offsets.velocity]), stress: V::load(&group[offsets.stress]) }
}
