//! Sweep kernel of lines with interlayers, apart from that of other lines, which thus have no overhead.

use super::super::interfaces::Face;
use super::super::layout::GroupIndex;
use super::super::table::WavePair;
use super::{Carried, Lines};
use crate::simd::{Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::interface::interlayer_states;
use crate::solid::interlayers::MEMORY;
use crate::solid::reconstruction::Slopes;
use crate::solid::riemann::{InterfaceState, State, updated};
use models::interface::elastic::ElasticInterlayer;

/// Adjacent lines with interlayers.
pub(crate) struct InterlayerLines<'a, T: Real> {
    pub(crate) lines: Lines<'a, T>,
    /// Lower faces of the groups of the path.
    pub(crate) faces: &'a [Face],
    pub(crate) memory: &'a mut [T::Lanes],
    /// Index of the history variables of the first line.
    pub(crate) first: usize,
    /// Distance between the history variables of two lines.
    pub(crate) line: usize,
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
            Slopes::Limited => self.advance_all::<V>(Slopes::Limited),
            Slopes::Godunov | Slopes::FourthOrder => self.advance_all::<V>(Slopes::FourthOrder),
        }
    }
}

impl<T: Real> InterlayerLines<'_, T> {
    #[inline(always)]
    fn advance_all<V: Vector<T>>(&mut self, slopes: Slopes) {
        let waves = self.lines.waves;
        let count = self.lines.carried.len() / waves.len().max(1);
        for (index, wave) in waves.iter().enumerate() {
            if let Some(rows) = &self.lines.rows {
                rows.fill::<V>(self.lines.data, wave, index, 0..count);
            }
            for line in 0..count {
                self.advance::<V>(line, index, wave, slopes);
            }
        }
    }

    /// Sweeps a pair of waves along a line of groups.
    #[inline(always)]
    fn advance<V: Vector<T>>(
        &mut self,
        line: usize,
        index: usize,
        wave: &WavePair,
        slopes: Slopes,
    ) {
        let law = self.laws[index];
        let law = ElasticInterlayer {
            mass: <V as Vector<T>>::all(law.mass),
            compliance: <V as Vector<T>>::all(law.compliance),
        };
        let step = <V as Vector<T>>::all(self.step);
        let (path, slot) = (self.lines.path, line * self.lines.waves.len() + index);
        let memories = self.first + line * self.line + MEMORY * index;
        let mut cells: [CellConstants<V>; 4] = [
            self.cell(self.lines.previous_group, line, wave),
            self.cell(path[0], line, wave),
            self.cell(path[1], line, wave),
            self.cell(path[1], line, wave),
        ];
        let mut last: State<V> = self.state(path[0], line, wave);
        let mut here: State<V> = self.state(path[1], line, wave);
        let mut carried: Carried<V> = match self.lines.begins {
            true => Carried::empty(),
            false => Carried::load(&self.lines.carried[slot]),
        };
        for place in 0..path.len() - 2 {
            let next: State<V> = self.state(path[place + 2], line, wave);
            cells[3] = self.cell(path[place + 2], line, wave);
            let around = [&cells[0], &cells[1], &cells[2], &cells[3]];
            let face = self.faces[place + 1];
            let joined = [joined(self.faces[place]), joined(face), joined(self.faces[place + 2])];
            let states = [last, here, next];
            let (reach, known) =
                slopes.face_values_beside_interlayers(carried.known, states, around, joined);
            let impedance = [cells[1].impedance, cells[2].impedance];
            let mut seen = InterfaceState::riemann(impedance, reach);
            if face.active != 0 {
                let at = memories + face.start;
                let old = [V::load(&self.memory[at]), V::load(&self.memory[at + 1])];
                let mut new = old;
                let (layered, _) = interlayer_states(&law, impedance, reach, step, &mut new);
                old[0].with_lanes(face.active, new[0]).store(&mut self.memory[at]);
                old[1].with_lanes(face.active, new[1]).store(&mut self.memory[at + 1]);
                seen = [
                    chosen(face.active, seen[0], layered[0]),
                    chosen(face.active, seen[1], layered[1]),
                ];
            }
            let moved = updated(last, [carried.lower_face, seen[0]], &cells[1]);
            self.write(path[place], line, wave, (last, moved));
            carried = Carried { known, lower_face: seen[1] };
            (last, here) = (here, next);
            cells = [cells[1], cells[2], cells[3], cells[3]];
        }
        match &self.lines.rows {
            Some(rows) => {
                rows.clear(self.lines.data, wave.velocity, line);
                rows.clear(self.lines.data, wave.stress, line);
                for &place in &wave.passive_stresses {
                    rows.clear(self.lines.data, place, line);
                }
            }
            None => carried.store(&mut self.lines.carried[slot]),
        }
    }

    /// Loads the wave constants of a group.
    #[inline(always)]
    fn cell<V: Vector<T>>(
        &self,
        stop: GroupIndex,
        line: usize,
        wave: &WavePair,
    ) -> CellConstants<V> {
        let pattern = self.lines.patterns[stop.of_line(line, self.lines.across).group];
        CellConstants::load(self.lines.table.cell(pattern, wave))
    }

    #[inline(always)]
    fn state<V: Vector<T>>(&self, stop: GroupIndex, line: usize, wave: &WavePair) -> State<V> {
        let group = &self.lines.data[stop.of_line(line, self.lines.across).data..];
        State { velocity: V::load(&group[wave.velocity]), stress: V::load(&group[wave.stress]) }
    }

    /// Writes a group; its passive stresses change in proportion to its stress.
    #[inline(always)]
    fn write<V: Vector<T>>(
        &mut self,
        stop: GroupIndex,
        line: usize,
        wave: &WavePair,
        (before, moved): (State<V>, State<V>),
    ) {
        let stop = stop.of_line(line, self.lines.across);
        let pattern = self.lines.patterns[stop.group];
        let group = &mut self.lines.data[stop.data..];
        moved.velocity.store(&mut group[wave.velocity]);
        moved.stress.store(&mut group[wave.stress]);
        let change = moved.stress - before.stress;
        for (index, &place) in wave.passive_stresses.iter().enumerate() {
            let ratio = V::load(self.lines.table.ratio(pattern, wave, index));
            (V::load(&group[place]) + ratio * change).store(&mut group[place]);
        }
    }
}

/// Returns 0 in lanes with an interlayer, 1 in all other lanes.
#[inline(always)]
fn joined<T: Real, V: Vector<T>>(face: Face) -> V {
    <V as Number>::ONE.with_lanes(face.lanes, <V as Number>::ZERO)
}

/// Blends interface states: `other` in the given lanes, `one` elsewhere.
#[inline(always)]
fn chosen<T: Real, V: Vector<T>>(
    lanes: u16,
    one: InterfaceState<V>,
    other: InterfaceState<V>,
) -> InterfaceState<V> {
    InterfaceState {
        difference: one.difference.with_lanes(lanes, other.difference),
        sum: one.sum.with_lanes(lanes, other.sum),
    }
}
