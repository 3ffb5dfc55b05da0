//! SIMD kernels that fill ghost cells at the ends of lines.

use super::material_table::{MaterialTable, WavePair};
use super::rows::Rows;
use crate::simd::{Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{CLOSURE_CELLS, GhostRule, compute_ghosts, image};
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::State;

/// Kernel: fills the ghosts of all waves along rows before the sweep, to compute the work at boundaries.
pub(crate) struct RowGhostKernel<'a, T: Real> {
    pub(crate) field_data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    pub(crate) rows: Rows<'a, T>,
    pub(crate) row_count: usize,
}

impl<T: Real> SimdKernel<T> for RowGhostKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        for (pair, wave) in self.waves.iter().enumerate() {
            self.rows.fill_ghosts::<V>(self.field_data, wave, pair, 0..self.row_count);
        }
    }
}

/// Kernel: fills the ghosts at one depth beyond an end of adjacent lines, as mirror or periodic images, group by group.
pub(crate) struct ImageGhostKernel<'a, T: Real> {
    pub(crate) field_data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    /// Ghost rules to be applied, in this order.
    pub(crate) ghost_rules: [Option<&'a GhostRule<T>>; 2],
    /// Data indices of the first line's source group and of its ghost; the other lines follow group by group.
    pub(crate) source_and_ghost: [usize; 2],
    /// Number of groups of lines.
    pub(crate) lines: usize,
    /// Index of the first group of lines among the face groups of the boundary.
    pub(crate) face: usize,
}

impl<T: Real> SimdKernel<T> for ImageGhostKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { field_data, waves, ghost_rules, source_and_ghost: [source, ghost], lines, face } =
            self;
        for (pair, &WavePair { velocity, stress, .. }) in waves.iter().enumerate() {
            for line in 0..lines {
                let group = &field_data[source + line..];
                let mut ghost_state =
                    State { velocity: V::load(&group[velocity]), stress: V::load(&group[stress]) };
                for ghost_rule in ghost_rules.into_iter().flatten() {
                    let [v, a, s, b, _] = ghost_rule.group_coefficients(pair, face + line);
                    ghost_state.velocity = image([V::load(v), V::load(a)], ghost_state.velocity);
                    ghost_state.stress = image([V::load(s), V::load(b)], ghost_state.stress);
                }
                let group = &mut field_data[ghost + line..];
                ghost_state.velocity.store(&mut group[velocity]);
                ghost_state.stress.store(&mut group[stress]);
            }
        }
    }
}

/// Kernel: fills the ghosts beyond an end of adjacent lines where some wave has a one-sided reconstruction.
pub(crate) struct OneSidedGhostKernel<'a, T: Real> {
    pub(crate) field_data: &'a mut [T::Lanes],
    pub(crate) waves: &'a [WavePair],
    pub(crate) ghost_rule: &'a GhostRule<T>,
    pub(crate) end: usize,
    /// By depth, the data index of the group of outermost cells of the first line; the other lines follow group by
    /// group.
    pub(crate) outer_cells: [usize; CLOSURE_CELLS],
    /// By depth, the data index of the ghost of the first line.
    pub(crate) ghosts: [usize; GHOSTS],
    /// Number of groups of lines.
    pub(crate) lines: usize,
    /// Index of the first group of lines among the face groups of the boundary.
    pub(crate) face: usize,
    pub(crate) table: &'a MaterialTable<T>,
    /// By depth, indices of the lane patterns of the groups, from the group of the first line on.
    pub(crate) lane_pattern_indices: [&'a [u32]; CLOSURE_CELLS],
}

impl<T: Real> SimdKernel<T> for OneSidedGhostKernel<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { field_data, waves, ghost_rule, end, lines, face, table, .. } = self;
        let closure = ghost_rule.closure();
        for (pair, wave) in waves.iter().enumerate() {
            for line in 0..lines {
                let [first, second, third] = self.lane_pattern_indices;
                let cells: [CellConstants<V>; CLOSURE_CELLS] = [
                    CellConstants::load(table.constants(first[line], wave)),
                    CellConstants::load(table.constants(second[line], wave)),
                    CellConstants::load(table.constants(third[line], wave)),
                ];
                let [v, a, s, b, one_sided] = ghost_rule.group_coefficients(pair, face + line);
                let ghost_rule =
                    [V::load(v), V::load(a), V::load(s), V::load(b), V::load(one_sided)];
                let [first, second, third] = self.outer_cells;
                let outer_cells = [
                    load_state(&field_data[first + line..], wave),
                    load_state(&field_data[second + line..], wave),
                    load_state(&field_data[third + line..], wave),
                ];
                let coefficients = table.ghost_coefficients(wave, &cells[0]);
                let cells = [&cells[0], &cells[1], &cells[2]];
                let computed =
                    compute_ghosts(closure, outer_cells, ghost_rule, end, cells, &coefficients);
                for (place, state) in self.ghosts.into_iter().zip(computed) {
                    let group = &mut field_data[place + line..];
                    state.velocity.store(&mut group[wave.velocity]);
                    state.stress.store(&mut group[wave.stress]);
                }
            }
        }
    }
}

/// Loads velocity and stress of a pair of waves in a group.
#[inline(always)]
fn load_state<T: Real, V: Vector<T>>(group: &[T::Lanes], wave: &WavePair) -> State<V> {
    State { velocity: V::load(&group[wave.velocity]), stress: V::load(&group[wave.stress]) }
}
