//! Sweep of lines of a single lane pattern each: the loop in which runs spend most of their time.
//!
//! The bounds of all groups of a path are checked once for each pair of waves, not in every group. The state of a group
//! is loaded again when the group is updated, which takes fewer registers than carrying it from group to group.

use super::field_offsets::FieldOffsets;
use super::{CarriedState, StencilState, SweepLines, prefetch, prefetch_line};
use crate::simd::{Real, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::Slopes;
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};
use std::ops::Range;

/// A field of a line of groups, without bounds checks.
struct LineField<T: Real>(*mut T::Lanes);

impl<T: Real> LineField<T> {
    /// Loads the field of the group at `start`.
    ///
    /// # Safety
    /// The bounds of this group have been checked by [`SweepLines::check_bounds`].
    #[inline(always)]
    unsafe fn load<V: Vector<T>>(&self, start: usize) -> V {
        // SAFETY: the caller has checked the bounds.
        unsafe { V::load(&*self.0.add(start)) }
    }

    /// Stores the field of the group at `start`.
    ///
    /// # Safety
    /// The bounds of this group have been checked by [`SweepLines::check_bounds`].
    #[inline(always)]
    unsafe fn store<V: Vector<T>>(&self, start: usize, value: V) {
        // SAFETY: the caller has checked the bounds.
        unsafe { value.store(&mut *self.0.add(start)) }
    }

    /// Prefetches the field of the group at `start`, which may be out of bounds.
    #[inline(always)]
    fn prefetch(&self, start: usize, into_l1: bool) {
        prefetch_line(self.0.wrapping_add(start).cast(), into_l1);
    }
}

/// Fields of a pair of waves in a line of groups.
struct PairFields<T: Real, const PASSIVE: usize> {
    /// First field of the groups.
    first: LineField<T>,
    velocity: LineField<T>,
    stress: LineField<T>,
    passive_stresses: [LineField<T>; PASSIVE],
}

impl<T: Real, const PASSIVE: usize> PairFields<T, PASSIVE> {
    /// Loads the state of the group at `start`.
    ///
    /// # Safety
    /// As for [`LineField::load`].
    #[inline(always)]
    unsafe fn load_state<V: Vector<T>>(&self, start: usize) -> State<V> {
        // SAFETY: the caller has checked the bounds.
        unsafe { State { velocity: self.velocity.load(start), stress: self.stress.load(start) } }
    }

    /// Updates the group at `start` from the states of its faces.
    ///
    /// # Safety
    /// As for [`LineField::load`].
    #[inline(always)]
    unsafe fn update<V: Vector<T>>(
        &self,
        start: usize,
        faces: [InterfaceState<V>; 2],
        cell: &CellConstants<V>,
        ratios: &[V; PASSIVE],
    ) {
        // SAFETY: the caller has checked the bounds.
        unsafe {
            let before: State<V> = self.load_state(start);
            let after = update_cell(before, faces, cell);
            self.velocity.store(start, after.velocity);
            self.stress.store(start, after.stress);
            let change = after.stress - before.stress;
            for (field, ratio) in self.passive_stresses.iter().zip(ratios) {
                field.store(start, field.load::<V>(start) + *ratio * change);
            }
        }
    }
}

impl<T: Real> SweepLines<'_, T> {
    /// Checks the bounds of `extent` field values from the start of each group of the path in each of `lines`.
    ///
    /// # Panics
    /// Some of them are outside the field data.
    #[inline(always)]
    fn check_bounds(&self, lines: &Range<usize>, extent: usize) {
        let mut last_start = 0;
        for group in self.path {
            last_start = last_start.max(group.start);
        }
        let last_line = lines.end.saturating_sub(1).checked_mul(self.line_stride.start);
        let last_group = last_line.and_then(|offset| offset.checked_add(last_start));
        let end = last_group.and_then(|start| start.checked_add(extent));
        assert!(end.is_some_and(|end| end <= self.field_data.len()), "groups out of bounds");
    }

    /// Returns the fields of a pair of waves in the line at an offset.
    #[inline(always)]
    fn pair_fields_unchecked<const PASSIVE: usize>(
        &mut self,
        offset: usize,
        offsets: &FieldOffsets<PASSIVE>,
    ) -> PairFields<T, PASSIVE> {
        let line = self.field_data.as_mut_ptr().wrapping_add(offset);
        PairFields {
            first: LineField(line),
            velocity: LineField(line.wrapping_add(offsets.velocity)),
            stress: LineField(line.wrapping_add(offsets.stress)),
            passive_stresses: offsets
                .passive_stresses
                .map(|field| LineField(line.wrapping_add(field))),
        }
    }

    /// Prefetches into L1 the carried state and the first two groups of a line that is swept soon, at the L1 prefetch distance.
    #[inline(always)]
    fn prefetch_line_start<const PASSIVE: usize>(
        &self,
        slot: usize,
        fields: &PairFields<T, PASSIVE>,
    ) {
        if !self.is_line_start {
            let distance = self.prefetch_l1_distance * self.waves.len();
            prefetch(self.carried, slot + distance, true);
        }
        for group in &self.path[..2] {
            fields.velocity.prefetch(group.start + self.prefetch_l1_distance, true);
            fields.stress.prefetch(group.start + self.prefetch_l1_distance, true);
        }
    }

    /// Sweeps a pair of waves along lines of the same single lane pattern.
    #[inline(always)]
    pub(super) fn sweep_uniform_pair<V: Vector<T>, const PASSIVE: usize>(
        &mut self,
        lines: Range<usize>,
        index: usize,
        pattern: u32,
        slopes: Slopes,
    ) {
        let wave = &self.waves[index];
        let offsets: FieldOffsets<PASSIVE> = self.field_offsets(index, PASSIVE);
        let cell: CellConstants<V> = CellConstants::load(self.table.constants(pattern, wave));
        let ratios: [V; PASSIVE] = self.load_ratios(pattern, wave);
        let (l1_distance, pitch) = (self.prefetch_l1_distance, self.pitch);
        self.check_bounds(&lines, offsets.extent);
        for line in lines {
            let slot = line * self.waves.len() + index;
            let offset = line * self.line_stride.start;
            let fields = self.pair_fields_unchecked(offset, &offsets);
            self.prefetch_line_start(slot, &fields);
            let carried = match self.is_line_start {
                true => CarriedState::new(),
                false => CarriedState::load(&self.carried[slot]),
            };
            // SAFETY: `check_bounds` has checked all groups of the path in this line, and `field_offsets` that the
            // offsets of the fields are below the extent.
            let around: [State<V>; 2] = unsafe {
                [fields.load_state(self.path[0].start), fields.load_state(self.path[1].start)]
            };
            let StencilState { mut carried, mut invariants, mut lower_stencil, .. } =
                StencilState::new(around, &cell, carried, slopes);
            for [previous, _, next] in self.path.array_windows() {
                fields.velocity.prefetch(next.start + l1_distance, true);
                fields.stress.prefetch(next.start + l1_distance, true);
                for field in &fields.passive_stresses {
                    field.prefetch(previous.start + l1_distance, true);
                }
                let mut field = offsets.prefetch_l2_offsets.start;
                while field < offsets.prefetch_l2_offsets.end {
                    fields.first.prefetch(next.start + field, false);
                    field += pitch;
                }
                // SAFETY: as above.
                let next: State<V> = unsafe { fields.load_state(next.start) };
                let waves = RiemannInvariants::from_state(next, &cell);
                let upper_stencil = slopes.upper_stencil(invariants, waves);
                let (reach, carried_invariants) = slopes.face_values(
                    carried.carried_invariants,
                    invariants,
                    [lower_stencil, upper_stencil],
                    &cell,
                );
                let face = InterfaceState::riemann_equal_impedance(reach);
                // SAFETY: as above.
                unsafe {
                    fields.update(previous.start, [carried.lower_face, face], &cell, &ratios)
                };
                carried = CarriedState { carried_invariants, lower_face: face };
                lower_stencil = slopes.lower_stencil(invariants, waves);
                invariants = waves;
            }
            if let Some(rows) = &self.rows {
                offsets.clear_padding(rows, self.field_data, line);
            } else {
                carried.store(&mut self.carried[slot]);
            }
        }
    }
}
