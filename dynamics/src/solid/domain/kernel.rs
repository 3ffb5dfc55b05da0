//! Sweep kernel: the sweep of [`crate::solid::line`] on many lines at once, in SIMD lanes.
//!
//! A group holds one cell per SIMD lane and fills a cache line. The neighbours of these cells along an axis are in one
//! other group, in the same lanes. A sweep from group to group therefore advances all lanes at once, without shuffles.
//! Beyond the first and the last group of a row the neighbours are in the adjacent lanes; there, copies shifted by one
//! lane serve as ghosts. Each cell is updated by the same operations in the same order as in the sweep of a single
//! line: results are equal bit for bit.
//!
//! `StencilState` holds the cells that a reconstruction reads (the stencil). Groups that are needed soon are prefetched
//! into L1; rows and layers that are needed later are prefetched into L2. `sweep` and `schedule` set the distances.

mod contact_medium;
pub(crate) mod contacts;
mod field_offsets;
mod interlayer_law;
pub(crate) mod interlayers;
mod one_pattern;
mod wide;

use super::layout::GroupIndex;
use super::material_table::{MaterialTable, WavePair};
use super::rows::Rows;
use crate::simd::{InstructionSet, Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::{GHOSTS, InterlayerStencil, Slopes};
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};
use contacts::PathContacts;
use field_offsets::{FieldOffsets, load_next};
use interlayers::{InterlayerFaceStates, PathInterlayers};
use std::ops::Range;

/// Maximum number of fields prefetched per pair of waves: a Cosserat solid has 24 fields and 6 pairs in space, 12
/// fields and 3 pairs in the plane. Viscous strains, which sweeps do not read, are left to the hardware prefetcher.
pub(crate) const MAX_PREFETCH_FIELDS: usize = 4;

/// Prefetches the cache lines of `from[distance]`, which may be out of bounds, into L1 if `into_l1`, else into L2.
#[inline(always)]
pub(super) fn prefetch<N>(from: &[N], distance: usize, into_l1: bool) {
    for line in (0..size_of::<N>()).step_by(64) {
        let address = from.as_ptr().wrapping_add(distance).cast::<i8>();
        prefetch_line(address.wrapping_add(line), into_l1);
    }
}

/// Prefetches the cache line at an address, which may be invalid, into L1 if `into_l1`, else into L2.
#[inline(always)]
fn prefetch_line(address: *const i8, into_l1: bool) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the address is not dereferenced; prefetching an invalid address has no effect.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
        match into_l1 {
            true => _mm_prefetch::<_MM_HINT_T0>(address),
            false => _mm_prefetch::<_MM_HINT_T1>(address),
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (address, into_l1);
}

/// State that a sweep carries from a group to the next group of the line, for one pair of waves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CarriedState<N> {
    /// Invariants of the previous groups, for the next face; see [`Slopes::face_values`].
    carried_invariants: RiemannInvariants<N>,
    /// Interface state at the lower face of the group that is updated next, scaled by the impedance of that group.
    lower_face: InterfaceState<N>,
}

impl<V: Number> CarriedState<V> {
    /// Returns the number of carried states per line and pair of waves with `ghosts` ghosts: each holds the invariants of
    /// one group, and the first one also the interface state.
    pub(crate) const fn slots(ghosts: usize) -> usize {
        ghosts - 1
    }

    /// Returns the carried state of the first face of a line: zero.
    pub(crate) fn new() -> Self {
        Self {
            carried_invariants: RiemannInvariants::ZERO,
            lower_face: InterfaceState::riemann_equal_impedance([V::ZERO, V::ZERO]),
        }
    }

    #[inline(always)]
    fn load<T: Real>(from: &CarriedState<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self {
            carried_invariants: RiemannInvariants::load(&from.carried_invariants),
            lower_face: InterfaceState::load(&from.lower_face),
        }
    }

    #[inline(always)]
    fn store<T: Real>(self, to: &mut CarriedState<T::Lanes>)
    where
        V: Vector<T>,
    {
        self.carried_invariants.store(&mut to.carried_invariants);
        self.lower_face.store(&mut to.lower_face);
    }
}

/// Groups and fields that a sweep prefetches into L2.
#[derive(Clone, Debug)]
pub(crate) struct PrefetchL2 {
    /// Prefetch distance, in groups.
    pub(crate) distance: usize,
    /// Prefetched fields: a subrange of the [`MAX_PREFETCH_FIELDS`] fields of each pair of waves.
    pub(crate) fields: Range<usize>,
}

/// Adjacent lines of groups, and the section of their path that is swept now.
pub(crate) struct SweepLines<'a, T: Real> {
    /// Values of all fields, by row, field and group.
    pub(crate) field_data: &'a mut [T::Lanes],
    /// Number of fields of a group.
    pub(crate) field_count: usize,
    /// Distance between two fields of a group.
    pub(crate) pitch: usize,
    pub(crate) table: &'a MaterialTable<T>,
    pub(crate) waves: &'a [WavePair],
    pub(crate) slopes: Slopes,
    /// By group, the index of its lane pattern.
    pub(crate) lane_pattern_indices: &'a [u32],
    /// By group: number of next groups along a line of this axis with the same lane pattern, at most 255. The run may
    /// extend beyond a line that ends inside the halo; the ghosts there have the patterns of the last groups.
    pub(crate) run_lengths: &'a [u8],
    /// Groups of the first line in the order of the sweep. Each group except the first and the last is current once,
    /// while the previous one is written and the next one is read. The groups of the other lines are offset from these
    /// by multiples of `line_stride`.
    pub(crate) path: &'a [GroupIndex],
    /// Group of the first line before the path; the first group of the path if there is none.
    pub(crate) previous_group: GroupIndex,
    /// Distance between two lines.
    pub(crate) line_stride: GroupIndex,
    /// Whether the path begins with the ghosts at the lower end, where no state is carried yet. The sweep overwrites
    /// ghosts like all groups: they must be filled again before another sweep.
    pub(crate) is_line_start: bool,
    /// L1 prefetch distance, in groups: that of a few lines in sweeps across rows, that of one row in sweeps along
    /// rows; lines and rows are too far apart for the hardware prefetcher.
    pub(crate) prefetch_l1_distance: usize,
    pub(crate) prefetch_l2: PrefetchL2,
    /// Carried state by line and pair of waves.
    pub(crate) carried: &'a mut [CarriedState<T::Lanes>],
    /// Ends of the lines, if lines are rows.
    pub(crate) rows: Option<Rows<'a, T>>,
    /// Interlayers across the axis.
    pub(crate) interlayers: Option<PathInterlayers<'a, T>>,
    /// Contacts at the faces.
    pub(crate) contacts: Option<PathContacts<'a, T>>,
}

/// Lines of the same single lane pattern.
const UNIFORM: u8 = 0;

/// Lines of several lane patterns each.
const MIXED: u8 = 1;

/// Lines with interlayers, of one or several lane patterns each.
const WITH_INTERLAYERS: u8 = 2;

/// Kernel: sweep of adjacent lines of a `KIND`. The kinds are compiled separately to limit register pressure.
struct SweepKernel<'a, 'b, T: Real, const KIND: u8> {
    sweep: &'a mut SweepLines<'b, T>,
    lines: Range<usize>,
    /// Lane pattern of all lines, if they are [`UNIFORM`].
    pattern: u32,
}

impl<T: Real, const KIND: u8> SimdKernel<T> for SweepKernel<'_, '_, T, KIND> {
    /// Selects the loop that is compiled for the reconstruction.
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { sweep, lines, pattern } = self;
        match sweep.slopes {
            Slopes::Limited => sweep.advance_lines::<V, KIND>(lines, pattern, Slopes::Limited),
            // For first order the weights in the cell constants are zero.
            Slopes::Godunov | Slopes::FourthOrder | Slopes::Wide(_) => {
                sweep.advance_lines::<V, KIND>(lines, pattern, Slopes::FourthOrder);
            }
        }
    }
}

impl<T: Real> SweepLines<'_, T> {
    /// Sweeps the lines with an instruction set: consecutive lines of the same single lane pattern together, and
    /// consecutive lines of several patterns together.
    pub(super) fn sweep_path(mut self, instructions: InstructionSet) {
        if self.interlayers.is_some() {
            return self.sweep_path_with_interlayers(instructions);
        }
        if self.contacts.is_some() {
            return self.sweep_path_with_contacts(instructions);
        }
        if let Slopes::Wide(order) = self.slopes {
            return self.sweep_wide_path(order, instructions);
        }
        let lines = self.carried.len() / self.waves.len().max(1);
        // A single pattern: skip the lookup and its memory traffic.
        let line_pattern = |lines: &Self, line: usize| match lines.table.has_single_pattern() {
            true => Some(0),
            false => lines.uniform_pattern(line),
        };
        let mut start = 0;
        let mut next = (lines > 0).then(|| line_pattern(&self, 0));
        while let Some(pattern) = next {
            let mut end = start;
            while next == Some(pattern) {
                end += 1;
                next = (end < lines).then(|| line_pattern(&self, end));
            }
            let (sweep, lines) = (&mut self, start..end);
            match pattern {
                Some(pattern) => {
                    let kernel = SweepKernel::<T, UNIFORM> { sweep, lines, pattern };
                    instructions.run_kernel_or(kernel, |SweepKernel { sweep, lines, .. }| {
                        let general = SweepKernel::<T, MIXED> { sweep, lines, pattern: 0 };
                        InstructionSet::Baseline.run_kernel(general);
                    });
                }
                None => {
                    instructions.run_kernel(SweepKernel::<T, MIXED> { sweep, lines, pattern: 0 })
                }
            }
            start = end;
        }
    }

    /// Returns the lane pattern of a line that has the same pattern everywhere, ghosts included; else `None`.
    fn uniform_pattern(&self, line: usize) -> Option<u32> {
        let offset = line * self.line_stride.group;
        let pattern = |place: usize| self.lane_pattern_indices[self.path[place].group + offset];
        let first_pattern = pattern(0);
        if self.lane_pattern_indices[self.previous_group.group + offset] != first_pattern {
            return None;
        }
        // The last groups may be ghosts, which `run_lengths` does not cover.
        if (1..=GHOSTS).any(|depth| pattern(self.path.len() - depth) != first_pattern) {
            return None;
        }
        let mut place = 0;
        while place + 2 < self.path.len() {
            if pattern(place + 1) != first_pattern {
                return None;
            }
            place += usize::from(self.run_lengths[self.path[place].group + offset]).max(1);
        }
        Some(first_pattern)
    }

    /// Sweeps adjacent lines of a `KIND`. Ghosts of rows with interlayers have already been filled.
    #[inline(always)]
    fn advance_lines<V: Vector<T>, const KIND: u8>(
        &mut self,
        lines: Range<usize>,
        pattern: u32,
        slopes: Slopes,
    ) {
        for index in 0..self.waves.len() {
            if let Some(rows) = self.rows.as_ref().filter(|_| KIND != WITH_INTERLAYERS) {
                rows.fill_ghosts::<V>(self.field_data, &self.waves[index], index, lines.clone());
            }
            // Lines of one medium: a compiled loop for each number of passive stresses; Hooke's law has at most two per
            // pair of waves. Other lines: one loop for all numbers, since it takes long to compile.
            let lines = lines.clone();
            debug_assert!(self.waves[index].passive_stresses.len() <= 2);
            match self.waves[index].passive_stresses.len() {
                _ if KIND != UNIFORM => self.sweep_pair::<V, 2, KIND>(lines, index, slopes),
                0 => self.sweep_uniform_pair::<V, 0>(lines, index, pattern, slopes),
                1 => self.sweep_uniform_pair::<V, 1>(lines, index, pattern, slopes),
                _ => self.sweep_uniform_pair::<V, 2>(lines, index, pattern, slopes),
            }
        }
    }

    /// Returns the range of data offsets that are prefetched into L2 for a pair of waves, relative to a group of the
    /// path. The offsets are one pitch apart.
    #[inline(always)]
    fn prefetch_l2_offsets(&self, index: usize) -> Range<usize> {
        let PrefetchL2 { distance, fields: Range { start, end } } = self.prefetch_l2;
        let first = index * self.field_count.div_ceil(self.waves.len());
        distance + (first + start) * self.pitch..distance + (first + end) * self.pitch
    }

    /// Loads the coupling ratios of the passive stresses of a pair of waves.
    #[inline(always)]
    fn load_ratios<V: Vector<T>, const PASSIVE: usize>(
        &self,
        pattern: u32,
        wave: &WavePair,
    ) -> [V; PASSIVE] {
        // No closure: closures are not inlined into the target-feature function and lose its SIMD instructions.
        let mut ratios = [V::ZERO; PASSIVE];
        for (passive, ratio) in ratios.iter_mut().enumerate().take(wave.ratio_indices.len()) {
            *ratio = V::load(self.table.coupling_ratio(pattern, wave, passive));
        }
        ratios
    }

    #[inline(always)]
    fn load_state<V: Vector<T>, const PASSIVE: usize>(
        &self,
        offsets: &FieldOffsets<PASSIVE>,
        start: usize,
    ) -> State<V> {
        let group = &self.field_data[start..][..offsets.extent];
        State {
            velocity: V::load(&group[offsets.velocity]),
            stress: V::load(&group[offsets.stress]),
        }
    }

    /// Returns the offsets of the fields of a pair of waves, `passive_count` of which are passive stresses.
    #[inline(always)]
    fn field_offsets<const PASSIVE: usize>(
        &self,
        index: usize,
        passive_count: usize,
    ) -> FieldOffsets<PASSIVE> {
        let wave = &self.waves[index];
        let extent = (self.field_count - 1) * self.pitch + 1;
        let offsets = FieldOffsets {
            velocity: wave.velocity,
            stress: wave.stress,
            passive_stresses: std::array::from_fn(|index| {
                wave.passive_stresses.get(index).copied().unwrap_or_default()
            }),
            passive_count,
            extent,
            prefetch_l2_offsets: self.prefetch_l2_offsets(index),
        };
        // Checks the offsets once, not in every group.
        assert!(offsets.velocity < extent && offsets.stress < extent);
        assert!(offsets.passive_stresses.iter().all(|place| *place < extent));
        offsets
    }

    /// Sweeps a pair of waves along lines of a `KIND` that may have several lane patterns.
    #[inline(always)]
    fn sweep_pair<V: Vector<T>, const PASSIVE: usize, const KIND: u8>(
        &mut self,
        lines: Range<usize>,
        index: usize,
        slopes: Slopes,
    ) {
        let wave = &self.waves[index];
        let offsets: FieldOffsets<PASSIVE> = self.field_offsets(index, wave.passive_stresses.len());
        let extent = offsets.extent;
        let (path, lane_pattern_indices, steps) =
            (self.path, self.lane_pattern_indices, self.path.len() - 2);
        let is_one_medium = KIND == WITH_INTERLAYERS && self.has_stencils();
        for line in lines {
            let slot = line * self.waves.len() + index;
            let offset = GroupIndex { group: 0, start: 0 }.shift_to_line(line, self.line_stride);
            if !self.is_line_start {
                prefetch(self.carried, slot + self.prefetch_l1_distance * self.waves.len(), true);
            }
            for group_index in &path[..2] {
                let group = &self.field_data[group_index.start + offset.start..][..extent];
                prefetch(group, self.prefetch_l1_distance + offsets.velocity, true);
                prefetch(group, self.prefetch_l1_distance + offsets.stress, true);
            }
            let mut outer_pattern = lane_pattern_indices[self.previous_group.group + offset.group];
            let mut pattern = lane_pattern_indices[path[0].group + offset.group];
            let mut cell: CellConstants<V> =
                CellConstants::load(self.table.constants(pattern, wave));
            let previous: State<V> = self.load_state(&offsets, path[0].start + offset.start);
            let current: State<V> = self.load_state(&offsets, path[1].start + offset.start);
            let carried = match self.is_line_start {
                true => CarriedState::new(),
                false => CarriedState::load(&self.carried[slot]),
            };
            let mut stencil_state = StencilState::new([previous, current], &cell, carried, slopes);
            let mut place = 0;
            let mut next_states_index =
                if KIND == WITH_INTERLAYERS { self.first_states_index(line) } else { 0 };
            loop {
                let ratios: [V; PASSIVE] = self.load_ratios(pattern, wave);
                while place < steps
                    && (KIND != WITH_INTERLAYERS || self.stencil_index(line, place) == 0)
                    && (is_one_medium
                        || (outer_pattern == pattern
                            && lane_pattern_indices[path[place + 1].group + offset.group]
                                == pattern
                            && lane_pattern_indices[path[place + 2].group + offset.group]
                                == pattern))
                {
                    let group_starts =
                        [path[place].start + offset.start, path[place + 2].start + offset.start];
                    let media = StencilMedia::Uniform(&cell, &ratios);
                    self.advance_group(&offsets, &mut stencil_state, group_starts, media, slopes);
                    place += 1;
                }
                if place == steps {
                    break;
                }
                let group_starts =
                    [path[place].start + offset.start, path[place + 2].start + offset.start];
                let interlayer_states: Option<InterlayerFaceStates<V>> = match KIND {
                    WITH_INTERLAYERS => {
                        self.load_interlayer_states((line, place), index, &mut next_states_index)
                    }
                    _ => None,
                };
                if is_one_medium {
                    let stencil = self.load_stencil((line, place), wave);
                    let media = StencilMedia::BesideInterlayers(
                        &cell,
                        &ratios,
                        &stencil,
                        &interlayer_states,
                    );
                    self.advance_group(&offsets, &mut stencil_state, group_starts, media, slopes);
                    place += 1;
                    continue;
                }
                let first: CellConstants<V> =
                    CellConstants::load(self.table.constants(outer_pattern, wave));
                let (cell_behind, pattern_behind) = (cell, pattern);
                outer_pattern = pattern;
                pattern = lane_pattern_indices[path[place + 1].group + offset.group];
                cell = CellConstants::load(self.table.constants(pattern, wave));
                let next = lane_pattern_indices[path[place + 2].group + offset.group];
                let next: CellConstants<V> = CellConstants::load(self.table.constants(next, wave));
                let interlayer_data = match KIND {
                    WITH_INTERLAYERS => Some((self.continuity((line, place)), &interlayer_states)),
                    _ => None,
                };
                let cells = [&first, &cell_behind, &cell, &next];
                let media = StencilMedia::Mixed(cells, (pattern_behind, wave), interlayer_data);
                self.advance_group(&offsets, &mut stencil_state, group_starts, media, slopes);
                place += 1;
            }
            if let Some(rows) = &self.rows {
                offsets.clear_padding(rows, self.field_data, line);
            } else {
                stencil_state.carried.store(&mut self.carried[slot]);
            }
        }
    }

    /// Updates the previous group of the path and loads the next one.
    #[inline(always)]
    fn advance_group<V: Vector<T>, const PASSIVE: usize>(
        &mut self,
        offsets: &FieldOffsets<PASSIVE>,
        stencil: &mut StencilState<V>,
        [previous_data, next_data]: [usize; 2],
        media: StencilMedia<'_, V, PASSIVE>,
        slopes: Slopes,
    ) {
        let &FieldOffsets { velocity, stress, passive_stresses, passive_count, extent, .. } =
            offsets;
        let distances = [self.prefetch_l1_distance, self.pitch];
        let next: State<V> =
            load_next::<T, V, PASSIVE>(self.field_data, offsets, distances, next_data);
        let [cell_behind, cell] = match media {
            StencilMedia::Uniform(cell, _) | StencilMedia::BesideInterlayers(cell, ..) => [cell; 2],
            StencilMedia::Mixed([_, cell_behind, cell, _], ..) => [cell_behind, cell],
        };
        let waves = RiemannInvariants::from_state(next, cell);
        let StencilState { carried, previous, current, invariants, lower_stencil: waves_behind } =
            *stencil;
        let upper_stencil = slopes.upper_stencil(invariants, waves);
        let (reach, carried_invariants) = match media {
            StencilMedia::Uniform(..) => slopes.face_values(
                carried.carried_invariants,
                invariants,
                [waves_behind, upper_stencil],
                cell,
            ),
            StencilMedia::BesideInterlayers(_, _, stencil, _) => slopes
                .face_values_beside_interlayers(
                    carried.carried_invariants,
                    invariants,
                    [waves_behind, upper_stencil],
                    cell,
                    stencil,
                ),
            StencilMedia::Mixed(cells, _, interlayer_data) => slopes.face_values_in_mixed_media(
                carried.carried_invariants,
                [previous, current, next],
                cells,
                interlayer_data.map(|own| own.0),
            ),
        };
        let riemann = match media {
            StencilMedia::Uniform(..) | StencilMedia::BesideInterlayers(..) => {
                [InterfaceState::riemann_equal_impedance(reach); 2]
            }
            StencilMedia::Mixed(..) => {
                InterfaceState::riemann([cell_behind.impedance, cell.impedance], reach)
            }
        };
        let [lower_face, beyond] = match media {
            StencilMedia::BesideInterlayers(_, _, _, Some(interlayer_states))
            | StencilMedia::Mixed(_, _, Some((_, Some(interlayer_states)))) => {
                interlayer_states.replace_riemann_solution(riemann)
            }
            _ => riemann,
        };
        let moved = update_cell(previous, [carried.lower_face, lower_face], cell_behind);
        let group = &mut self.field_data[previous_data..][..extent];
        for place in passive_stresses.into_iter().take(passive_count) {
            prefetch(group, self.prefetch_l1_distance + place, true);
        }
        moved.velocity.store(&mut group[velocity]);
        moved.stress.store(&mut group[stress]);
        if PASSIVE > 0 {
            let change = moved.stress - previous.stress;
            for (passive, place) in passive_stresses.into_iter().enumerate().take(passive_count) {
                let ratio = match media {
                    StencilMedia::Uniform(_, ratios)
                    | StencilMedia::BesideInterlayers(_, ratios, ..) => ratios[passive],
                    StencilMedia::Mixed(_, (pattern, wave), _) => {
                        V::load(self.table.coupling_ratio(pattern, wave, passive))
                    }
                };
                (V::load(&group[place]) + ratio * change).store(&mut group[place]);
            }
        }
        let carried = CarriedState { carried_invariants, lower_face: beyond };
        *stencil = match media {
            StencilMedia::Uniform(..) | StencilMedia::BesideInterlayers(..) => {
                let lower_stencil = slopes.lower_stencil(invariants, waves);
                StencilState {
                    carried,
                    previous: current,
                    current: next,
                    invariants: waves,
                    lower_stencil,
                }
            }
            StencilMedia::Mixed(..) => StencilState::new([current, next], cell, carried, slopes),
        };
    }
}

/// Materials of the stencil of a face: those of the groups around the face in the line.
#[derive(Clone, Copy)]
enum StencilMedia<'a, V, const PASSIVE: usize> {
    /// One medium: its constants, and the coupling ratios of the passive stresses.
    Uniform(&'a CellConstants<V>, &'a [V; PASSIVE]),
    /// One medium with interlayers at some of the three faces: besides its constants and ratios, the reconstruction at
    /// the middle face and, if its history variables are advanced, its interface states.
    BesideInterlayers(
        &'a CellConstants<V>,
        &'a [V; PASSIVE],
        &'a InterlayerStencil<V>,
        &'a Option<InterlayerFaceStates<V>>,
    ),
    /// Several media: constants of groups i − 2, i − 1, i (current) and i + 1. Coupling ratios are loaded on demand
    /// from the pattern of group i − 1 and the wave, to save registers. With interlayers also the continuity of the
    /// three faces and the interface states of the middle one.
    Mixed(
        [&'a CellConstants<V>; 4],
        (u32, &'a WavePair),
        Option<([V; 3], &'a Option<InterlayerFaceStates<V>>)>,
    ),
}

/// Stencil of a sweep: states of the current and the previous group of the path, and the data derived from them.
#[derive(Clone, Copy)]
struct StencilState<V> {
    carried: CarriedState<V>,
    previous: State<V>,
    current: State<V>,
    /// Invariants of the current group.
    invariants: RiemannInvariants<V>,
    /// Invariants of the previous group or their difference from the current ones; see [`Slopes::lower_stencil`].
    lower_stencil: RiemannInvariants<V>,
}

impl<V: Number> StencilState<V> {
    #[inline(always)]
    fn new(
        [previous, current]: [State<V>; 2],
        cell: &CellConstants<V>,
        carried: CarriedState<V>,
        slopes: Slopes,
    ) -> Self {
        let invariants = RiemannInvariants::from_state(current, cell);
        let lower_stencil =
            slopes.lower_stencil(RiemannInvariants::from_state(previous, cell), invariants);
        Self { carried, previous, current, invariants, lower_stencil }
    }
}
