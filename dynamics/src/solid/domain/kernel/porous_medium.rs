//! Sweep of lines of one porous medium, with limited slopes: one pair of waves after the other in blocks of groups. The
//! results are those of the sweep of lines of several media in [`super::contacts`], bit for bit.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::layout::GroupIndex;
use super::contacts::PathContacts;
use super::{CarriedState, FieldOffsets, StencilState, SweepLines, load_next, prefetch};
use crate::simd::{Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::contact_faces::{ContactConstants, OpenPoresStencil};
use crate::solid::reconstruction::Slopes;
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};

/// Number of groups of a block, few enough for the fields of a block to stay in the L1 cache.
const BLOCK: usize = 16;

/// Largest number of pairs of waves of a medium with contacts.
const MAX_PAIRS: usize = 3;

/// Number of passive stresses of the longitudinal pair; transverse pairs have none.
pub(super) const LONGITUDINAL_PASSIVE: usize = 2;

/// Kernel: sweep of adjacent lines of one porous medium.
pub(super) struct PorousMediumSweep<'a, 'b, T: Real>(pub(super) &'a mut SweepLines<'b, T>);

impl<T: Real> SimdKernel<T> for PorousMediumSweep<'_, '_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Some(contacts) = self.0.contacts else { return };
        let lines = self.0.carried.len() / self.0.waves.len().max(1);
        self.0.fill_contact_ghosts::<V>(&contacts, lines);
        self.0.sweep_porous_medium::<V>(&contacts, lines);
    }
}

/// Fields of a pair of waves in a line.
struct PairFields<'a, T: Real, V, const PASSIVE: usize> {
    data: &'a mut [T::Lanes],
    offsets: FieldOffsets<PASSIVE>,
    l1_distance: usize,
    pitch: usize,
    cell: CellConstants<V>,
    ratios: [V; PASSIVE],
}

impl<T: Real> SweepLines<'_, T> {
    /// Returns the fields of a pair.
    #[inline(always)]
    fn pair_fields<V: Vector<T>, const PASSIVE: usize>(
        &mut self,
        pair: usize,
    ) -> PairFields<'_, T, V, PASSIVE> {
        let wave = &self.waves[pair];
        PairFields {
            offsets: self.field_offsets(pair, PASSIVE),
            l1_distance: self.prefetch_l1_distance,
            pitch: self.pitch,
            cell: CellConstants::load(self.table.constants(0, wave)),
            ratios: self.load_ratios(0, wave),
            data: self.field_data,
        }
    }

    #[inline(always)]
    fn sweep_porous_medium<V: Vector<T>>(&mut self, contacts: &PathContacts<'_, T>, lines: usize) {
        let pair_count = self.waves.len();
        debug_assert!(pair_count <= MAX_PAIRS, "media with contacts have no spins");
        let longitudinal = contacts.longitudinal;
        let constants: ContactConstants<V> = ContactConstants::load(&contacts.constants[0]);
        let (path, steps) = (self.path, self.path.len() - 2);
        for line in 0..lines {
            let slot = line * pair_count;
            let offset = GroupIndex { group: 0, start: 0 }.shift_to_line(line, self.line_stride);
            let mut walks = [self.start_walk::<V>(0, slot, offset); MAX_PAIRS];
            for pair in 1..pair_count {
                walks[pair] = self.start_walk::<V>(pair, slot, offset);
            }
            let mut start = 0;
            while start < steps {
                let end = steps.min(start + BLOCK);
                // The groups of the block, and two beyond.
                let block = &path[start..end + 2];
                let fields = self.pair_fields::<V, LONGITUDINAL_PASSIVE>(longitudinal);
                let walk = &mut walks[longitudinal];
                fields.walk_longitudinal(contacts, &constants, (block, offset), walk);
                for pair in 0..pair_count {
                    if pair != longitudinal {
                        let fields = self.pair_fields::<V, 0>(pair);
                        fields.walk_transverse((block, offset), &mut walks[pair]);
                    }
                }
                start = end;
            }
            if self.rows.is_some() {
                self.clear_contact_padding(contacts, line);
            } else {
                for pair in 0..pair_count {
                    walks[pair].carried.store(&mut self.carried[slot + pair]);
                }
            }
        }
    }

    #[inline(always)]
    fn start_walk<V: Vector<T>>(
        &self,
        pair: usize,
        slot: usize,
        offset: GroupIndex,
    ) -> StencilState<V> {
        let wave = &self.waves[pair];
        let cell: CellConstants<V> = CellConstants::load(self.table.constants(0, wave));
        let offsets: FieldOffsets<0> = self.field_offsets(pair, 0);
        let previous: State<V> = self.load_state(&offsets, self.path[0].start + offset.start);
        let current: State<V> = self.load_state(&offsets, self.path[1].start + offset.start);
        let carried = match self.is_line_start {
            true => CarriedState::new(),
            false => CarriedState::load(&self.carried[slot + pair]),
        };
        StencilState::new([previous, current], &cell, carried, Slopes::Limited)
    }
}

impl<T: Real, V: Vector<T>, const PASSIVE: usize> PairFields<'_, T, V, PASSIVE> {
    /// Sweeps a transverse pair.
    #[inline(always)]
    fn walk_transverse(
        mut self,
        (block, offset): (&[GroupIndex], GroupIndex),
        walk: &mut StencilState<V>,
    ) {
        let mut own = *walk;
        let mut starts = [block[0].start + offset.start, block[1].start + offset.start];
        for next in &block[2..] {
            let next_start = next.start + offset.start;
            let next = self.load_next(next_start);
            let (face, outflow, waves, lower) = advance_face(&own, next, &self.cell);
            self.store_moved(starts[0], own.previous, [own.carried.lower_face, face]);
            own = StencilState {
                carried: CarriedState { carried_invariants: outflow, lower_face: face },
                previous: own.current,
                current: next,
                invariants: waves,
                lower_stencil: lower,
            };
            starts = [starts[1], next_start];
        }
        *walk = own;
    }

    /// Sweeps the longitudinal pair. The carried invariants of the walk are the state of the cell
    /// before the previous one.
    #[inline(always)]
    fn walk_longitudinal(
        mut self,
        contacts: &PathContacts<'_, T>,
        constants: &ContactConstants<V>,
        (block, offset): (&[GroupIndex], GroupIndex),
        walk: &mut StencilState<V>,
    ) {
        let Some(strain) = contacts.volumetric_strain else { return };
        assert!(strain < self.offsets.extent);
        let RiemannInvariants { right, left } = walk.carried.carried_invariants;
        let first = State { velocity: right, stress: left };
        let mut states = [first, walk.previous, walk.current];
        let mut lower_face = walk.carried.lower_face;
        let mut starts = [block[0].start + offset.start, block[1].start + offset.start];
        let mut upper_group = block[1].group + offset.group;
        let porosity = contacts.porosity(block[0].group + offset.group, constants);
        let opening = porosity + self.load(strain, starts[0]);
        let mut stencil = OpenPoresStencil::new(states, opening, constants);
        for next in &block[2..] {
            let next_start = next.start + offset.start;
            let next_state = self.load_next(next_start);
            let porosity = contacts.porosity(upper_group, constants);
            let opening = porosity + self.load(strain, starts[1]);
            let [first, lower, upper] = states;
            let stencil_states = [first, lower, upper, next_state];
            let face = stencil.solve(stencil_states, opening, &self.cell, constants);
            self.store_moved(starts[0], lower, [lower_face, face]);
            lower_face = face;
            states = [lower, upper, next_state];
            starts = [starts[1], next_start];
            upper_group = next.group + offset.group;
        }
        let [State { velocity, stress }, previous, current] = states;
        let carried_invariants = RiemannInvariants { right: velocity, left: stress };
        walk.carried = CarriedState { carried_invariants, lower_face };
        (walk.previous, walk.current) = (previous, current);
    }

    #[inline(always)]
    fn load_next(&self, start: usize) -> State<V> {
        let distances = [self.l1_distance, self.pitch];
        load_next::<T, V, PASSIVE>(self.data, &self.offsets, distances, start)
    }

    /// Loads a field of a group.
    #[inline(always)]
    fn load(&self, place: usize, start: usize) -> V {
        V::load(&self.data[start..][..self.offsets.extent][place])
    }

    /// Stores the state of a group after the sweep, with its passive stresses.
    #[inline(always)]
    fn store_moved(&mut self, start: usize, before: State<V>, faces: [InterfaceState<V>; 2]) {
        let moved = update_cell(before, faces, &self.cell);
        let group = &mut self.data[start..][..self.offsets.extent];
        moved.velocity.store(&mut group[self.offsets.velocity]);
        moved.stress.store(&mut group[self.offsets.stress]);
        let change = moved.stress - before.stress;
        for passive in 0..PASSIVE {
            let place = self.offsets.passive_stresses[passive];
            prefetch(group, self.l1_distance + place, true);
            (V::load(&group[place]) + self.ratios[passive] * change).store(&mut group[place]);
        }
    }
}

/// Solves the Riemann problem between the previous and the current group; returns also the carried invariants of the next
/// face, and the invariants of the next group and their difference from those of the current one.
#[inline(always)]
fn advance_face<V: Number>(
    own: &StencilState<V>,
    next: State<V>,
    cell: &CellConstants<V>,
) -> (InterfaceState<V>, RiemannInvariants<V>, RiemannInvariants<V>, RiemannInvariants<V>) {
    let waves = RiemannInvariants::from_state(next, cell);
    let upper = own.invariants.difference(waves);
    let (reach, outflow) = Slopes::Limited.face_values(
        own.carried.carried_invariants,
        own.invariants,
        [own.lower_stencil, upper],
        cell,
    );
    (InterfaceState::riemann_equal_impedance(reach), outflow, waves, upper)
}
