//! Sweep kernel of lines with interlayers, separate from the kernel of other lines, which thus has no overhead.
//!
//! The law of a face relates all wave pairs: they are swept together.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::interlayer_faces::{FacePattern, PathFaces};
use super::super::layout::GroupIndex;
use super::super::material_table::WavePair;
use super::interlayer_law::{FaceValues, LawLanes, apply_law};
use super::{CarriedState, SweepLines};
use crate::simd::{InstructionSet, Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::interlayers::MAX_PAIRS;
use crate::solid::riemann::{InterfaceState, State, update_cell};
use models::interface::Interval;

/// Adjacent lines of groups with interlayers.
pub(crate) struct InterlayerLines<'a, T: Real> {
    pub(crate) lines: SweepLines<'a, T>,
    /// Interlayers on the path.
    pub(crate) faces: PathFaces<'a, T>,
    pub(crate) history: &'a mut [T::Lanes],
    /// Time at the end of the sweep and its duration, s.
    pub(crate) interval: Interval<T>,
    pub(crate) instructions: InstructionSet,
}

impl<T: Real> SimdKernel<T> for InterlayerLines<'_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(mut self) {
        let waves = self.lines.waves;
        let count = self.lines.carried.len() / waves.len().max(1);
        for (index, wave) in waves.iter().enumerate() {
            if let Some(rows) = &self.lines.rows {
                rows.fill_ghosts::<V>(self.lines.field_data, wave, index, 0..count);
            }
        }
        for line in 0..count {
            self.sweep_line::<V>(line);
        }
    }
}

/// States and constants of a wave pair around the lower face of the current group of a line.
#[derive(Clone, Copy)]
struct PairTrack<V> {
    cells: [CellConstants<V>; 4],
    previous: State<V>,
    current: State<V>,
    next: State<V>,
    carried: CarriedState<V>,
}

impl<T: Real> InterlayerLines<'_, T> {
    /// Sweeps all pairs of waves along a line of groups. The number of pairs and the reconstruction are not constants, so
    /// that the loop is compiled once.
    #[inline(always)]
    fn sweep_line<V: Vector<T>>(&mut self, line: usize) {
        let slopes = self.lines.slopes;
        let pairs = self.lines.waves.len().min(MAX_PAIRS);
        let (waves, path, faces) = (self.lines.waves, self.lines.path, self.faces);
        let history_start = faces.first_history + line * faces.history_stride;
        let indices = &faces.pattern_indices[line * faces.pattern_stride..];
        let mut values = FaceValues::<T>::new();
        let first_cell: CellConstants<V> = self.load_cell(path[0], line, &waves[0]);
        let first_state: State<V> = self.load_state(path[0], line, &waves[0]);
        let mut tracks = [PairTrack {
            cells: [first_cell; 4],
            previous: first_state,
            current: first_state,
            next: first_state,
            carried: CarriedState::new(),
        }; MAX_PAIRS];
        for pair in 0..pairs {
            let (wave, track) = (&waves[pair], &mut tracks[pair]);
            track.cells[0] = self.load_cell(self.lines.previous_group, line, wave);
            track.cells[1] = self.load_cell(path[0], line, wave);
            track.cells[2] = self.load_cell(path[1], line, wave);
            track.previous = self.load_state(path[0], line, wave);
            track.current = self.load_state(path[1], line, wave);
            if !self.lines.is_line_start {
                track.carried = CarriedState::load(&self.lines.carried[line * pairs + pair]);
            }
        }
        let first = &faces.patterns[indices[0] as usize];
        let mut patterns = [first, first, &faces.patterns[indices[1] as usize]];
        for place in 0..path.len() - 2 {
            patterns = [patterns[1], patterns[2], &faces.patterns[indices[place + 2] as usize]];
            let continuity = [
                continuity::<T, V>(patterns[0]),
                continuity::<T, V>(patterns[1]),
                continuity::<T, V>(patterns[2]),
            ];
            let mut incident = [[V::ZERO; 2]; MAX_PAIRS];
            let mut impedance = [[V::ZERO; 2]; MAX_PAIRS];
            let mut states = [[InterfaceState { difference: V::ZERO, sum: V::ZERO }; 2]; MAX_PAIRS];
            for pair in 0..pairs {
                let (wave, track) = (&waves[pair], &mut tracks[pair]);
                track.next = self.load_state(path[place + 2], line, wave);
                track.cells[3] = self.load_cell(path[place + 2], line, wave);
                let around = [&track.cells[0], &track.cells[1], &track.cells[2], &track.cells[3]];
                let (reach, invariants) = slopes.face_values_with_interlayers(
                    track.carried.carried_invariants,
                    [track.previous, track.current, track.next],
                    around,
                    continuity,
                );
                track.carried.carried_invariants = invariants;
                incident[pair] = reach;
                impedance[pair] = [track.cells[1].impedance, track.cells[2].impedance];
                states[pair] = InterfaceState::riemann(impedance[pair], reach);
            }
            if patterns[1].history_lanes != 0 {
                let start = history_start + faces.history_offsets[place + 1];
                for pair in 0..pairs {
                    for side in 0..2 {
                        impedance[pair][side].store(&mut values.impedance[pair][side]);
                        incident[pair][side].store(&mut values.incident[pair][side]);
                        states[pair][side].store(&mut values.states[pair][side]);
                    }
                }
                for &(law, lanes) in &patterns[1].laws {
                    let face = LawLanes {
                        law: &faces.laws[usize::from(law)],
                        lanes,
                        interval: self.interval,
                        history: &mut self.history[start..start + faces.variables],
                        values: &mut values,
                    };
                    apply_law(self.instructions, pairs, face);
                }
                for pair in 0..pairs {
                    for side in 0..2 {
                        states[pair][side] = InterfaceState::load(&values.states[pair][side]);
                    }
                }
            }
            for pair in 0..pairs {
                let (wave, track) = (&waves[pair], &mut tracks[pair]);
                let lower_face = track.carried.lower_face;
                let moved =
                    update_cell(track.previous, [lower_face, states[pair][0]], &track.cells[1]);
                let before = track.previous;
                track.carried.lower_face = states[pair][1];
                (track.previous, track.current) = (track.current, track.next);
                track.cells = [track.cells[1], track.cells[2], track.cells[3], track.cells[3]];
                self.store_group(path[place], line, wave, (before, moved));
            }
        }
        for pair in 0..pairs {
            let wave = &waves[pair];
            match &self.lines.rows {
                Some(rows) => {
                    rows.clear_padding(self.lines.field_data, wave.velocity, line);
                    rows.clear_padding(self.lines.field_data, wave.stress, line);
                    for &place in &wave.passive_stresses {
                        rows.clear_padding(self.lines.field_data, place, line);
                    }
                }
                None => tracks[pair].carried.store(&mut self.lines.carried[line * pairs + pair]),
            }
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
        let pattern =
            self.lines.lane_pattern_indices[stop.shift_to_line(line, self.lines.line_stride).group];
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
        let pattern = self.lines.lane_pattern_indices[stop.group];
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
fn continuity<T: Real, V: Vector<T>>(face: &FacePattern) -> V {
    <V as Number>::ONE.blend_lanes(face.interlayer_lanes, <V as Number>::ZERO)
}
