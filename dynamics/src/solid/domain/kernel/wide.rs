//! Sweep of lines of one medium with a wide stencil: the formulas of [`crate::solid::wide_stencil`] in SIMD lanes.

use super::super::layout::GroupIndex;
use super::{CarriedState, SweepLines, load_next, prefetch};
use crate::simd::{InstructionSet, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::WideOrder;
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};
use crate::solid::wide_stencil::{face_weights, interface_state};

/// Number of groups whose invariants a sweep keeps: the stencil moves along them, and only at their end are the last W − 1
/// of them copied to the front.
const WINDOW: usize = 64;

/// Kernel: sweep of all lines with W groups around a face.
struct WideKernel<'a, 'b, T: Real, const W: usize>(&'a mut SweepLines<'b, T>);

impl<T: Real, const W: usize> SimdKernel<T> for WideKernel<'_, '_, T, W> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let sweep = self.0;
        let lines = sweep.carried.len() / (sweep.waves.len() * (W / 2 - 1)).max(1);
        for index in 0..sweep.waves.len() {
            if let Some(rows) = &sweep.rows {
                rows.fill_ghosts::<V>(sweep.field_data, &sweep.waves[index], index, 0..lines);
            }
            debug_assert!(sweep.waves[index].passive_stresses.len() <= 2);
            match sweep.waves[index].passive_stresses.len() {
                0 => sweep.sweep_wide_pair::<V, 0, W>(lines, index),
                1 => sweep.sweep_wide_pair::<V, 1, W>(lines, index),
                _ => sweep.sweep_wide_pair::<V, 2, W>(lines, index),
            }
        }
    }
}

impl<T: Real> SweepLines<'_, T> {
    /// Sweeps all lines, which are of one lane pattern.
    pub(super) fn sweep_wide_path(mut self, order: WideOrder, instructions: InstructionSet) {
        debug_assert!(self.table.has_single_pattern());
        match order {
            WideOrder::Sixth => instructions.run_kernel(WideKernel::<T, 6>(&mut self)),
            WideOrder::Eighth => instructions.run_kernel(WideKernel::<T, 8>(&mut self)),
        }
    }

    /// Sweeps a pair of waves along all lines. The next group to be loaded is half a stencil above the group that is
    /// updated; the groups between them are not yet updated, and the invariants of those below it are carried.
    #[inline(always)]
    fn sweep_wide_pair<V: Vector<T>, const PASSIVE: usize, const W: usize>(
        &mut self,
        lines: usize,
        index: usize,
    ) {
        let (half, wave, path) = (W / 2, &self.waves[index], self.path);
        let offsets = self.field_offsets::<PASSIVE>(index, PASSIVE);
        let cell: CellConstants<V> = CellConstants::load(self.table.constants(0, wave));
        let computed_weights: [V; W] = face_weights(cell.half_courant + cell.half_courant);
        let mut weights = [V::ZERO; W];
        #[expect(clippy::manual_memcpy, reason = "the compiler keeps the copy in registers")]
        for place in 0..W {
            weights[place] = computed_weights[place];
        }
        let ratios: [V; PASSIVE] = self.load_ratios(0, wave);
        let distances = [self.prefetch_l1_distance, self.pitch];
        // Invariants of the last W − 1 groups, then of the groups that are loaded next.
        let mut window = [RiemannInvariants::<V>::ZERO; WINDOW];
        for line in 0..lines {
            let offset = GroupIndex { group: 0, start: 0 }.shift_to_line(line, self.line_stride);
            let slot = (line * self.waves.len() + index) * (half - 1);
            let mut lower_face = InterfaceState::riemann_equal_impedance([V::ZERO; 2]);
            // A line starts with its lowest face, which has ghosts below it and updates no cell.
            let loaded = if self.is_line_start { W - 1 } else { half };
            if !self.is_line_start {
                let carried = self.carried[slot..][..half - 1].iter();
                for (own, state) in window.iter_mut().zip(carried.map(CarriedState::<V>::load)) {
                    *own = state.carried_invariants;
                    lower_face = state.lower_face;
                }
            }
            for place in 0..loaded {
                let state: State<V> = self.load_state(&offsets, path[place].start + offset.start);
                window[W - 1 - loaded + place] = RiemannInvariants::from_state(state, &cell);
            }
            for first in (loaded..path.len()).step_by(WINDOW - W + 1) {
                let count = (path.len() - first).min(WINDOW - W + 1);
                for step in 0..count {
                    let [next_group, moved_group] = [first + step, first + step - half];
                    let next: State<V> = load_next::<T, V, PASSIVE>(
                        self.field_data,
                        &offsets,
                        distances,
                        path[next_group].start + offset.start,
                    );
                    window[step + W - 1] = RiemannInvariants::from_state(next, &cell);
                    let groups = window[step..].first_chunk().expect("room for a stencil");
                    let upper_face = interface_state(groups, &weights);
                    let group = &mut self.field_data[path[moved_group].start + offset.start..]
                        [..offsets.extent];
                    let before = State {
                        velocity: V::load(&group[offsets.velocity]),
                        stress: V::load(&group[offsets.stress]),
                    };
                    let moved = update_cell(before, [lower_face, upper_face], &cell);
                    moved.velocity.store(&mut group[offsets.velocity]);
                    moved.stress.store(&mut group[offsets.stress]);
                    let change = moved.stress - before.stress;
                    for (field, ratio) in offsets.passive_stresses.into_iter().zip(ratios) {
                        prefetch(group, self.prefetch_l1_distance + field, true);
                        (V::load(&group[field]) + ratio * change).store(&mut group[field]);
                    }
                    lower_face = upper_face;
                }
                window.copy_within(count..count + W - 1, 0);
            }
            if let Some(rows) = &self.rows {
                offsets.clear_padding(rows, self.field_data, line);
            } else {
                let carried = self.carried[slot..][..half - 1].iter_mut();
                for (&carried_invariants, target) in window.iter().zip(carried) {
                    CarriedState { carried_invariants, lower_face }.store(target);
                }
            }
        }
    }
}
