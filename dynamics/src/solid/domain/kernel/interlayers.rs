//! Sweep of lines with interlayers, in two stages. First the interlayer laws of all faces with history variables are
//! applied, then the wave pairs are swept one after the other as in other lines.
//!
//! A law couples all wave pairs, but needs only the incident waves of the states before the sweep. It yields the
//! interface states of its face, which the sweep of each pair uses in place of the solution of the Riemann problem.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::interlayer_faces::{FacePattern, PathFaces};
use super::super::layout::GroupIndex;
use super::super::material_table::WavePair;
use super::interlayer_law::{FaceBatch, FaceLawEntry, GROUPS_PER_WAVE_PAIR, apply_law};
use super::{CarriedState, SweepKernel, SweepLines, WITH_INTERLAYERS, prefetch};
use crate::simd::{InstructionSet, Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::InterlayerStencil;
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State};
use models::interface::Interval;

/// Interlayers on the path of a sweep, and the buffer of their interface states.
pub(crate) struct PathInterlayers<'a, T: Real> {
    pub(crate) faces: PathFaces<'a, T>,
    /// History variables of all faces of the domain.
    pub(crate) history: &'a mut [T::Lanes],
    pub(crate) interval: Interval<T>,
    /// Whether the sweep leaves shear waves unchanged, and with them the history variables of tangential components.
    pub(crate) holds_shear: bool,
    pub(crate) states: &'a mut InterlayerStates<T>,
}

/// Interface states of the faces with history variables on the path of a sweep, line by line.
#[derive(Clone)]
pub(crate) struct InterlayerStates<T: Real> {
    /// By line and face, one entry for each law of the face.
    law_entries: Vec<FaceLawEntry>,
    /// By line, index of the first group of the line in `values`.
    line_starts: Vec<usize>,
    /// By face and wave pair, [`GROUPS_PER_WAVE_PAIR`] groups. Before the laws are applied, the first two are the
    /// incident waves from below and from above; afterwards, in the lanes with a law, the groups are difference and sum
    /// of the interface state of the lower cell, then of the upper cell.
    values: Vec<T::Lanes>,
}

impl<T: Real> Default for InterlayerStates<T> {
    fn default() -> Self {
        Self { law_entries: Vec::new(), line_starts: Vec::new(), values: Vec::new() }
    }
}

/// Interface states of the lower and the upper cell of a face for one wave pair, in the lanes with history variables.
#[derive(Clone, Copy)]
pub(super) struct InterlayerFaceStates<V> {
    /// Mask of the lanes with history variables.
    lanes: u16,
    states: [InterfaceState<V>; 2],
}

impl<V: Number> InterlayerFaceStates<V> {
    /// Replaces the solution of the Riemann problem in the lanes with history variables.
    #[inline(always)]
    pub(super) fn replace_riemann_solution<T: Real>(
        &self,
        riemann: [InterfaceState<V>; 2],
    ) -> [InterfaceState<V>; 2]
    where
        V: Vector<T>,
    {
        let mut states = riemann;
        for side in 0..2 {
            let (state, law_state) = (&mut states[side], &self.states[side]);
            state.difference = state.difference.blend_lanes(self.lanes, law_state.difference);
            state.sum = state.sum.blend_lanes(self.lanes, law_state.sum);
        }
        states
    }
}

/// Kernel: fills the ghosts of rows and computes the incident waves of all faces with history variables.
struct IncidentWaveKernel<'a, 'b, T: Real>(&'a mut SweepLines<'b, T>);

impl<T: Real> SimdKernel<T> for IncidentWaveKernel<'_, '_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let sweep = self.0;
        let lines = sweep.carried.len() / sweep.waves.len().max(1);
        for (index, wave) in sweep.waves.iter().enumerate() {
            if let Some(rows) = &sweep.rows {
                rows.fill_ghosts::<V>(sweep.field_data, wave, index, 0..lines);
            }
        }
        let Some(interlayers) = sweep.interlayers.take() else { return };
        let (faces, states) = (&interlayers.faces, &mut *interlayers.states);
        states.law_entries.clear();
        states.line_starts.clear();
        states.values.clear();
        for line in 0..lines {
            states.line_starts.push(states.values.len());
            let first_history_index = faces.first_history_index + line * faces.history_stride;
            for place in 0..sweep.path.len() - 2 {
                if faces.stencil_index(line, place) == 0 {
                    continue;
                }
                let pattern = faces.pattern(line, place + 1);
                if pattern.history_lanes == 0 {
                    continue;
                }
                let groups = sweep.groups_around(line, place);
                for &(law_index, lanes) in &pattern.laws {
                    states.law_entries.push(FaceLawEntry {
                        law_index,
                        lanes,
                        lane_pattern_indices: [1, 2]
                            .map(|side| sweep.lane_pattern_indices[groups[side].group]),
                        first_history_index: first_history_index + faces.history_offsets[place + 1],
                        first_value_index: states.values.len(),
                    });
                }
                for index in 0..sweep.waves.len() {
                    let incident: [V; 2] =
                        sweep.incident_waves(faces, (line, place), index, groups);
                    let mut values = [T::Lanes::ZERO; GROUPS_PER_WAVE_PAIR];
                    for side in 0..2 {
                        incident[side].store(&mut values[side]);
                    }
                    states.values.extend_from_slice(&values);
                }
            }
        }
        sweep.interlayers = Some(interlayers);
    }
}

impl<T: Real> PathFaces<'_, T> {
    /// Returns the pattern of the lower face of the group at a place of the path of a line.
    #[inline(always)]
    fn pattern(&self, line: usize, place: usize) -> &FacePattern {
        &self.patterns[self.pattern_indices[line * self.pattern_stride + place] as usize]
    }

    /// Returns the index of the stencil of the face between the groups at a place and the next place of the path of a
    /// line.
    #[inline(always)]
    pub(super) fn stencil_index(&self, line: usize, place: usize) -> u32 {
        self.stencil_indices[line * self.pattern_stride + place + 1]
    }

    /// Returns the continuity of the three faces of a stencil, the middle one between the groups at a place and the
    /// next place of the path of a line: 0 in lanes with an interlayer, 1 in other lanes.
    #[inline(always)]
    pub(super) fn continuity<V: Vector<T>>(&self, line: usize, place: usize) -> [V; 3] {
        let mut continuity = [V::ZERO; 3];
        for face in 0..3 {
            let lanes = self.pattern(line, place + face).interlayer_lanes;
            continuity[face] = <V as Number>::ONE.blend_lanes(lanes, <V as Number>::ZERO);
        }
        continuity
    }

    /// Loads a stencil for the constants of a wave pair; stencils exist only in a domain of one medium.
    #[inline(always)]
    pub(super) fn load_stencil<V: Vector<T>>(
        &self,
        stencil_index: u32,
        wave: &WavePair,
    ) -> InterlayerStencil<V> {
        let index = stencil_index as usize * self.cells_per_stencil + wave.constants_index;
        InterlayerStencil::load(&self.stencils[index])
    }
}

impl<T: Real> SweepLines<'_, T> {
    /// Sweeps lines with interlayers: applies the laws to batches of faces, then sweeps the wave pairs.
    pub(super) fn sweep_path_with_interlayers(&mut self, instructions: InstructionSet) {
        instructions.run_kernel(IncidentWaveKernel(self));
        let (table, waves) = (self.table, self.waves);
        if let Some(own) = &mut self.interlayers {
            let PathInterlayers { faces, history, interval, holds_shear, states } = own;
            let has_same_constants = |one: &FaceLawEntry, next: &FaceLawEntry| {
                (one.law_index, one.lane_pattern_indices)
                    == (next.law_index, next.lane_pattern_indices)
            };
            for entries in states.law_entries.chunk_by(has_same_constants) {
                let law = &faces.laws[usize::from(entries[0].law_index)];
                let values = &mut states.values;
                let normal_variable_count = law.normal_variable_count().filter(|_| *holds_shear);
                let batch = FaceBatch {
                    law,
                    faces: entries,
                    table,
                    waves,
                    interval: *interval,
                    history,
                    history_variable_count: faces.variable_count,
                    advanced_variable_count: normal_variable_count.unwrap_or(usize::MAX),
                    values,
                };
                apply_law(instructions, batch);
            }
        }
        let lines = 0..self.carried.len() / self.waves.len().max(1);
        instructions.run_kernel(SweepKernel::<T, WITH_INTERLAYERS> {
            sweep: self,
            lines,
            pattern: 0,
        });
    }

    /// Returns the groups i − 2, i − 1, i and i + 1 around the face between the groups at a place and the next place of
    /// the path of a line.
    #[inline(always)]
    fn groups_around(&self, line: usize, place: usize) -> [GroupIndex; 4] {
        let first = if place == 0 { self.previous_group } else { self.path[place - 1] };
        let mut groups = [first, self.path[place], self.path[place + 1], self.path[place + 2]];
        for group in &mut groups {
            *group = group.shift_to_line(line, self.line_stride);
        }
        groups
    }

    /// Computes the incident waves of the face between the groups at a place and the next place of the path of a line,
    /// from below and from above, for the wave pair `wave_index`. `groups`: result of [`Self::groups_around`].
    #[inline(always)]
    fn incident_waves<V: Vector<T>>(
        &self,
        faces: &PathFaces<'_, T>,
        (line, place): (usize, usize),
        wave_index: usize,
        groups: [GroupIndex; 4],
    ) -> [V; 2] {
        let (wave, slopes) = (&self.waves[wave_index], self.slopes);
        let first: State<V> = self.load_group(groups[0], wave);
        let mut states = [first; 4];
        for depth in 1..4 {
            states[depth] = self.load_group(groups[depth], wave);
            let group = &self.field_data[groups[depth].start..];
            prefetch(group, self.prefetch_l1_distance + wave.velocity, true);
            prefetch(group, self.prefetch_l1_distance + wave.stress, true);
        }
        // At the first face of the path, the group before the path has already been updated: the carried invariants are
        // those that the sweep has stored there.
        let stored = match (place, self.is_line_start) {
            (0, true) => Some(RiemannInvariants::ZERO),
            (0, false) => {
                let slot = line * self.waves.len() + wave_index;
                Some(CarriedState::load(&self.carried[slot]).carried_invariants)
            }
            _ => None,
        };
        if !faces.stencils.is_empty() {
            let cell: CellConstants<V> = self.load_cell(groups[2], wave);
            let stencil = faces.load_stencil(faces.stencil_index(line, place), wave);
            return slopes.incident_waves_beside_interlayers(stored, states, &cell, &stencil);
        }
        let first_cell: CellConstants<V> = self.load_cell(groups[0], wave);
        let mut cells = [first_cell; 4];
        for depth in 1..4 {
            cells[depth] = self.load_cell(groups[depth], wave);
        }
        let continuity: [V; 3] = faces.continuity(line, place);
        let carried = match stored {
            Some(stored) => stored,
            None => slopes.carried_invariants(
                [states[0], states[1], states[2]],
                [&cells[0], &cells[1], &cells[2]],
                [continuity[0], continuity[1]],
            ),
        };
        let around = [&cells[0], &cells[1], &cells[2], &cells[3]];
        let stencil_states = [states[1], states[2], states[3]];
        slopes.face_values_in_mixed_media(carried, stencil_states, around, Some(continuity)).0
    }

    /// Loads the wave constants of a group.
    #[inline(always)]
    fn load_cell<V: Vector<T>>(&self, group: GroupIndex, wave: &WavePair) -> CellConstants<V> {
        let pattern = self.lane_pattern_indices[group.group];
        CellConstants::load(self.table.constants(pattern, wave))
    }

    /// Loads the velocity and the stress of a group.
    #[inline(always)]
    fn load_group<V: Vector<T>>(&self, group: GroupIndex, wave: &WavePair) -> State<V> {
        let data = &self.field_data[group.start..];
        State { velocity: V::load(&data[wave.velocity]), stress: V::load(&data[wave.stress]) }
    }

    /// Loads the interface states of the face between the groups at a place and the next place of the path of a line,
    /// for the wave pair `wave_index`; `None` if the face has no history variables. `next_states_index`: index of the
    /// states of the next face of the line with history variables, which is advanced past the states of this face.
    #[inline(always)]
    pub(super) fn load_interlayer_states<V: Vector<T>>(
        &self,
        (line, place): (usize, usize),
        wave_index: usize,
        next_states_index: &mut usize,
    ) -> Option<InterlayerFaceStates<V>> {
        let PathInterlayers { faces, states, .. } = self.interlayers.as_ref()?;
        let lanes = faces.pattern(line, place + 1).history_lanes;
        if lanes == 0 {
            return None;
        }
        let first = *next_states_index + wave_index * GROUPS_PER_WAVE_PAIR;
        let values = &states.values[first..][..GROUPS_PER_WAVE_PAIR];
        *next_states_index += self.waves.len() * GROUPS_PER_WAVE_PAIR;
        let state = |side: usize| (&values[2 * side], &values[2 * side + 1]);
        let ([lower, upper], load) = ([state(0), state(1)], <V as Vector<T>>::load);
        let lower = InterfaceState { difference: load(lower.0), sum: load(lower.1) };
        let upper = InterfaceState { difference: load(upper.0), sum: load(upper.1) };
        Some(InterlayerFaceStates { lanes, states: [lower, upper] })
    }

    /// Returns whether stencils are stored: in lines with interlayers whose groups all have the same constants.
    #[inline(always)]
    pub(super) fn has_stencils(&self) -> bool {
        self.interlayers.as_ref().is_some_and(|interlayers| !interlayers.faces.stencils.is_empty())
    }

    /// Returns the index of the stencil of the face between the groups at a place and the next place of the path of a
    /// line; 0 without interlayers.
    #[inline(always)]
    pub(super) fn stencil_index(&self, line: usize, place: usize) -> u32 {
        self.interlayers
            .as_ref()
            .map_or(0, |interlayers| interlayers.faces.stencil_index(line, place))
    }

    /// Loads the stencil of a face; see [`Self::has_stencils`].
    #[inline(always)]
    pub(super) fn load_stencil<V: Vector<T>>(
        &self,
        (line, place): (usize, usize),
        wave: &WavePair,
    ) -> InterlayerStencil<V> {
        match &self.interlayers {
            Some(PathInterlayers { faces, .. }) => {
                faces.load_stencil(faces.stencil_index(line, place), wave)
            }
            None => unreachable!("only lines with interlayers have stencils"),
        }
    }

    /// Returns the continuity of the three faces of a stencil: 0 in lanes with an interlayer, 1 in other lanes.
    #[inline(always)]
    pub(super) fn continuity<V: Vector<T>>(&self, (line, place): (usize, usize)) -> [V; 3] {
        match &self.interlayers {
            Some(interlayers) => interlayers.faces.continuity(line, place),
            None => [<V as Number>::ONE; 3],
        }
    }

    /// Returns the index of the interface states of the first face with history variables in a line.
    #[inline(always)]
    pub(super) fn first_states_index(&self, line: usize) -> usize {
        self.interlayers.as_ref().map_or(0, |interlayers| interlayers.states.line_starts[line])
    }
}
