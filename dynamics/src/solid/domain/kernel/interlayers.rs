//! Sweep kernel of lines with interlayers, separate from the kernel of other lines, which thus has no overhead.

use super::super::interlayer_faces::GroupFace;
use super::super::layout::GroupIndex;
use super::super::material_table::WavePair;
use super::{CarriedState, SweepLines};
use crate::simd::{Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::interface::advance_interlayer;
use crate::solid::interlayers::HISTORY_VARIABLES;
use crate::solid::reconstruction::Slopes;
use crate::solid::riemann::{InterfaceState, State, update_cell};
use models::interface::elastic::ElasticInterlayer;

/// Adjacent lines of groups with interlayers.
pub(crate) struct InterlayerLines<'a, T: Real> {
    pub(crate) lines: SweepLines<'a, T>,
    /// Lower faces of the groups of the path.
    pub(crate) faces: &'a [GroupFace],
    pub(crate) history: &'a mut [T::Lanes],
    /// Index of the history variables of the first line.
    pub(crate) first_history: usize,
    /// Distance between the history variables of two lines.
    pub(crate) history_stride: usize,
    /// Interlayer laws by pair of waves.
    pub(crate) laws: &'a [ElasticInterlayer<T>],
    /// Duration of the sweep, s.
    pub(crate) step: T,
}

impl<T: Real> SimdKernel<T> for InterlayerLines<'_, T> {
    /// Selects the loop that is compiled for the reconstruction.
    #[inline(always)]
    fn run<V: Vector<T>>(mut self) {
        match self.lines.slopes {
            Slopes::Limited => self.sweep_lines::<V>(Slopes::Limited),
            Slopes::Godunov | Slopes::FourthOrder => self.sweep_lines::<V>(Slopes::FourthOrder),
        }
    }
}

impl<T: Real> InterlayerLines<'_, T> {
    #[inline(always)]
    fn sweep_lines<V: Vector<T>>(&mut self, slopes: Slopes) {
        let waves = self.lines.waves;
        let count = self.lines.carried.len() / waves.len().max(1);
        for (index, wave) in waves.iter().enumerate() {
            if let Some(rows) = &self.lines.rows {
                rows.fill_ghosts::<V>(self.lines.field_data, wave, index, 0..count);
            }
            for line in 0..count {
                self.sweep_line::<V>(line, index, wave, slopes);
            }
        }
    }

    /// Sweeps a pair of waves along a line of groups.
    #[inline(always)]
    fn sweep_line<V: Vector<T>>(
        &mut self,
        line: usize,
        index: usize,
        wave: &WavePair,
        slopes: Slopes,
    ) {
        let law = self.laws[index];
        let law = ElasticInterlayer {
            mass: <V as Vector<T>>::splat(law.mass),
            compliance: <V as Vector<T>>::splat(law.compliance),
        };
        let step = <V as Vector<T>>::splat(self.step);
        let (path, slot) = (self.lines.path, line * self.lines.waves.len() + index);
        let history_start =
            self.first_history + line * self.history_stride + HISTORY_VARIABLES * index;
        let mut cells: [CellConstants<V>; 4] = [
            self.load_cell(self.lines.previous_group, line, wave),
            self.load_cell(path[0], line, wave),
            self.load_cell(path[1], line, wave),
            self.load_cell(path[1], line, wave),
        ];
        let mut previous: State<V> = self.load_state(path[0], line, wave);
        let mut current: State<V> = self.load_state(path[1], line, wave);
        let mut carried: CarriedState<V> = match self.lines.is_line_start {
            true => CarriedState::new(),
            false => CarriedState::load(&self.lines.carried[slot]),
        };
        for place in 0..path.len() - 2 {
            let next: State<V> = self.load_state(path[place + 2], line, wave);
            cells[3] = self.load_cell(path[place + 2], line, wave);
            let around = [&cells[0], &cells[1], &cells[2], &cells[3]];
            let face = self.faces[place + 1];
            let continuity = [
                continuity(self.faces[place]),
                continuity(face),
                continuity(self.faces[place + 2]),
            ];
            let states = [previous, current, next];
            let (reach, stencil_data) = slopes.face_values_with_interlayers(
                carried.stencil_data,
                states,
                around,
                continuity,
            );
            let impedance = [cells[1].impedance, cells[2].impedance];
            let mut interface_states = InterfaceState::riemann(impedance, reach);
            if face.history_lanes != 0 {
                let at = history_start + face.history_offset;
                let old = [V::load(&self.history[at]), V::load(&self.history[at + 1])];
                let mut new = old;
                let (layered, _) = advance_interlayer(&law, impedance, reach, step, &mut new);
                old[0].blend_lanes(face.history_lanes, new[0]).store(&mut self.history[at]);
                old[1].blend_lanes(face.history_lanes, new[1]).store(&mut self.history[at + 1]);
                interface_states = [
                    blend_states(face.history_lanes, interface_states[0], layered[0]),
                    blend_states(face.history_lanes, interface_states[1], layered[1]),
                ];
            }
            let moved = update_cell(previous, [carried.lower_face, interface_states[0]], &cells[1]);
            self.store_group(path[place], line, wave, (previous, moved));
            carried = CarriedState { stencil_data, lower_face: interface_states[1] };
            (previous, current) = (current, next);
            cells = [cells[1], cells[2], cells[3], cells[3]];
        }
        match &self.lines.rows {
            Some(rows) => {
                rows.clear_padding(self.lines.field_data, wave.velocity, line);
                rows.clear_padding(self.lines.field_data, wave.stress, line);
                for &place in &wave.passive_stresses {
                    rows.clear_padding(self.lines.field_data, place, line);
                }
            }
            None => carried.store(&mut self.lines.carried[slot]),
        }
    }

    /// Loads the wave constants of a group.
    #[inline(always)]
    fn load_cell<V: Vector<T>>(
        &self,
        stop: GroupIndex,
        line: usize,
        wave: &WavePair,
    ) -> CellConstants<V> {
        let pattern = self.lines.patterns[stop.shift_to_line(line, self.lines.line_stride).group];
        CellConstants::load(self.lines.table.constants(pattern, wave))
    }

    #[inline(always)]
    fn load_state<V: Vector<T>>(&self, stop: GroupIndex, line: usize, wave: &WavePair) -> State<V> {
        let group =
            &self.lines.field_data[stop.shift_to_line(line, self.lines.line_stride).start..];
        State { velocity: V::load(&group[wave.velocity]), stress: V::load(&group[wave.stress]) }
    }

    /// Writes the updated state of a group; its passive stresses change in proportion to its stress.
    #[inline(always)]
    fn store_group<V: Vector<T>>(
        &mut self,
        stop: GroupIndex,
        line: usize,
        wave: &WavePair,
        (before, moved): (State<V>, State<V>),
    ) {
        let stop = stop.shift_to_line(line, self.lines.line_stride);
        let pattern = self.lines.patterns[stop.group];
        let group = &mut self.lines.field_data[stop.start..];
        moved.velocity.store(&mut group[wave.velocity]);
        moved.stress.store(&mut group[wave.stress]);
        let change = moved.stress - before.stress;
        for (index, &place) in wave.passive_stresses.iter().enumerate() {
            let ratio = V::load(self.lines.table.coupling_ratio(pattern, wave, index));
            (V::load(&group[place]) + ratio * change).store(&mut group[place]);
        }
    }
}

/// Returns 0 in lanes with an interlayer, 1 in all other lanes.
#[inline(always)]
fn continuity<T: Real, V: Vector<T>>(face: GroupFace) -> V {
    <V as Number>::ONE.blend_lanes(face.interlayer_lanes, <V as Number>::ZERO)
}

/// Blends interface states: `other` in the given lanes, `one` elsewhere.
#[inline(always)]
fn blend_states<T: Real, V: Vector<T>>(
    lanes: u16,
    one: InterfaceState<V>,
    other: InterfaceState<V>,
) -> InterfaceState<V> {
    InterfaceState {
        difference: one.difference.blend_lanes(lanes, other.difference),
        sum: one.sum.blend_lanes(lanes, other.sum),
    }
}
