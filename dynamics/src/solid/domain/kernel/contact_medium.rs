//! Sweep of lines of one medium with contacts, with limited slopes: one pair of waves after the other in blocks of groups.
//! In granular media, which must separate at faces, those of a block are solved before its cells are updated. The results
//! are those of the sweep of lines of several media in [`super::contacts`], bit for bit.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::layout::GroupIndex;
use super::contacts::{PathContacts, load_excess};
use super::{CarriedState, FieldOffsets, StencilState, SweepLines, load_next, prefetch};
use crate::simd::{Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::contact_faces::separation::{
    self, ExcessInvariants, TractionCone, tangential_magnitude,
};
use crate::solid::contact_faces::{ContactConstants, OpenPoresStencil, magnitude};
use crate::solid::reconstruction::{InterlayerStencil, Slopes};
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};

/// Number of groups of a block, few enough for the fields of a block to stay in the L1 cache.
const BLOCK: usize = 16;

/// Largest number of pairs of waves of a medium with contacts.
const MAX_PAIRS: usize = 3;

/// Number of passive stresses of the longitudinal pair; transverse pairs have none.
pub(super) const LONGITUDINAL_PASSIVE: usize = 2;

/// Kernel: sweep of adjacent lines of one medium, granular if `IS_GRANULAR`, else porous.
pub(super) struct ContactMediumSweep<'a, 'b, T: Real, const IS_GRANULAR: bool>(
    pub(super) &'a mut SweepLines<'b, T>,
);

impl<T: Real, const IS_GRANULAR: bool> SimdKernel<T>
    for ContactMediumSweep<'_, '_, T, IS_GRANULAR>
{
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Some(contacts) = self.0.contacts else { return };
        let lines = self.0.carried.len() / self.0.waves.len().max(1);
        self.0.fill_contact_ghosts::<V>(&contacts, lines);
        self.0.sweep_contact_medium::<V, IS_GRANULAR>(&contacts, lines);
    }
}

/// Faces of a block of groups of a granular medium; face i is that between the groups i and i + 1.
struct BlockFaces<V> {
    /// 0 where the cells separate or slide, else 1.
    continuity: [V; BLOCK + 1],
    /// 1 where the contacts of both cells stay open, else 0.
    stays_open: [V; BLOCK],
    /// 1 at physical boundaries, else 0.
    is_boundary: [V; BLOCK],
    /// Interface states by pair.
    states: [[InterfaceState<V>; BLOCK]; MAX_PAIRS],
}

impl<V: Number> BlockFaces<V> {
    #[inline(always)]
    fn new() -> Self {
        let unsolved = InterfaceState { difference: V::ZERO, sum: V::ZERO };
        Self {
            continuity: [V::ONE; BLOCK + 1],
            stays_open: [V::ZERO; BLOCK],
            is_boundary: [V::ZERO; BLOCK],
            states: [[unsolved; BLOCK]; MAX_PAIRS],
        }
    }

    /// Cuts the tractions to the cone.
    #[inline(always)]
    fn separate<const P: usize>(
        &mut self,
        count: usize,
        cone: &TractionCone<V>,
        longitudinal: usize,
    ) {
        for place in 0..count {
            let mut tractions = [V::ZERO; P];
            for pair in 0..P {
                tractions[pair] = self.states[pair][place].sum;
            }
            let tangential = tangential_magnitude(tractions, longitudinal);
            let (normal, factor) = cone.project(tractions[longitudinal], tangential);
            for pair in 0..P {
                let closed = tractions[pair];
                let admitted = if pair == longitudinal { normal } else { factor * closed };
                let admitted = self.stays_open[place].select_gt(V::ZERO, V::ZERO, admitted);
                self.states[pair][place].sum =
                    self.is_boundary[place].select_gt(V::ZERO, closed, admitted);
            }
        }
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
    fn sweep_contact_medium<V: Vector<T>, const IS_GRANULAR: bool>(
        &mut self,
        contacts: &PathContacts<'_, T>,
        lines: usize,
    ) {
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
                match (IS_GRANULAR, pair_count) {
                    (true, 2) => self.sweep_granular_block::<V, 2>(
                        contacts,
                        &constants,
                        (block, offset),
                        &mut walks,
                    ),
                    (true, _) => self.sweep_granular_block::<V, 3>(
                        contacts,
                        &constants,
                        (block, offset),
                        &mut walks,
                    ),
                    (false, _) => {
                        let fields = self.pair_fields::<V, LONGITUDINAL_PASSIVE>(longitudinal);
                        let walk = &mut walks[longitudinal];
                        fields.walk_porous(contacts, &constants, (block, offset), walk);
                        for pair in 0..pair_count {
                            if pair != longitudinal {
                                let fields = self.pair_fields::<V, 0>(pair);
                                fields.walk_transverse((block, offset), &mut walks[pair]);
                            }
                        }
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

    /// Sweeps a block of a granular medium with `P` pairs.
    #[inline(always)]
    fn sweep_granular_block<V: Vector<T>, const P: usize>(
        &mut self,
        contacts: &PathContacts<'_, T>,
        constants: &ContactConstants<V>,
        (block, offset): (&[GroupIndex], GroupIndex),
        walks: &mut [StencilState<V>; MAX_PAIRS],
    ) {
        let longitudinal = contacts.longitudinal;
        let mut faces = BlockFaces::new();
        // In the place of a carried invariant that limited slopes do not use.
        let first_strain = walks[longitudinal].carried.carried_invariants.left;
        let strain = self.find_separations::<V, P>(
            contacts,
            constants,
            (block, offset),
            first_strain,
            &mut faces,
        );
        let transverse = if longitudinal == 0 { P - 1 } else { 0 };
        let ratio = self.admittance::<V>(transverse) / self.admittance::<V>(longitudinal);
        for pair in 0..P {
            let fields = self.pair_fields::<V, 0>(pair);
            fields.solve_faces((block, offset), &mut walks[pair], pair, &mut faces);
        }
        let cone = TractionCone::new(constants.friction, ratio);
        faces.separate::<P>(block.len() - 2, &cone, longitudinal);
        for pair in 0..P {
            let (states, walk) = (&faces.states[pair], &mut walks[pair]);
            match pair == longitudinal {
                true => {
                    let fields = self.pair_fields::<V, LONGITUDINAL_PASSIVE>(pair);
                    fields.move_block((block, offset), walk, states);
                }
                false => {
                    self.pair_fields::<V, 0>(pair).move_block((block, offset), walk, states);
                }
            }
        }
        walks[longitudinal].carried.carried_invariants.left = strain;
    }

    /// Finds the faces of a block that separate, and those that stay open; `first_strain`: estimate of the strain that the
    /// jumps at the face before the block can cause. Returns the estimate for the last face.
    #[inline(always)]
    fn find_separations<V: Vector<T>, const P: usize>(
        &self,
        contacts: &PathContacts<'_, T>,
        constants: &ContactConstants<V>,
        (block, offset): (&[GroupIndex], GroupIndex),
        first_strain: V,
        faces: &mut BlockFaces<V>,
    ) -> V {
        let Some(places) = contacts.excess else { return V::ZERO };
        let longitudinal = contacts.longitudinal;
        let mut impedances = [V::ONE; P];
        for pair in 0..P {
            let cell: CellConstants<V> =
                CellConstants::load(self.table.constants(0, &self.waves[pair]));
            impedances[pair] = cell.impedance;
        }
        let mut lower = self.load_pairs::<V, P>(block[0].start + offset.start);
        let mut lower_stress = V::ZERO;
        for pair in 0..P {
            lower_stress = lower_stress + magnitude(lower[pair].stress);
        }
        let mut strains = [V::ZERO, first_strain];
        let mut below = (ExcessInvariants::ZERO, V::ZERO);
        for face in 0..block.len() - 1 {
            let upper = self.load_pairs::<V, P>(block[face + 1].start + offset.start);
            let mut upper_stress = V::ZERO;
            let mut tractions = [V::ZERO; P];
            let mut states = [[lower[0], upper[0]]; P];
            for pair in 0..P {
                states[pair] = [lower[pair], upper[pair]];
                upper_stress = upper_stress + magnitude(upper[pair].stress);
                let right = lower[pair].stress - impedances[pair] * lower[pair].velocity;
                let left = upper[pair].stress + impedances[pair] * upper[pair].velocity;
                tractions[pair] = right + left;
            }
            let stress = lower_stress + upper_stress;
            faces.continuity[face] =
                separation::continuity(constants.friction, tractions, longitudinal, stress);
            let strain = separation::face_strain(constants, states, longitudinal);
            let group = &self.field_data[block[face].start + offset.start..];
            let own = (load_excess::<T, V>(group, places), lower_stress);
            if face > 0 {
                let greatest = strains[0] + strains[1] + strain;
                let (below_excess, below_stress) = below;
                let (own_excess, own_stress) = own;
                let opening = below_excess.opening(constants);
                let below_opens = separation::stays_open(opening, greatest, below_stress);
                let opening = own_excess.opening(constants);
                let own_opens = separation::stays_open(opening, greatest, own_stress);
                faces.stays_open[face - 1] = below_opens * own_opens;
                faces.is_boundary[face - 1] =
                    below_excess.is_outside().max(own_excess.is_outside());
            }
            strains = [strains[1], strain];
            below = own;
            (lower, lower_stress) = (upper, upper_stress);
        }
        strains[0]
    }

    /// Returns the sum of the admittances 1/z of both sides of a face.
    #[inline(always)]
    fn admittance<V: Vector<T>>(&self, pair: usize) -> V {
        let cell: CellConstants<V> =
            CellConstants::load(self.table.constants(0, &self.waves[pair]));
        V::ONE / cell.impedance + V::ONE / cell.impedance
    }

    /// Loads the states of all pairs of a group.
    #[inline(always)]
    fn load_pairs<V: Vector<T>, const P: usize>(&self, start: usize) -> [State<V>; P] {
        let mut states = [State { velocity: V::ZERO, stress: V::ZERO }; P];
        for pair in 0..P {
            states[pair] = self.load_pair(start, &self.waves[pair]);
        }
        states
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
    /// Solves the Riemann problems at the faces of a block of a granular medium, without separation.
    #[inline(always)]
    fn solve_faces(
        self,
        (block, offset): (&[GroupIndex], GroupIndex),
        walk: &mut StencilState<V>,
        pair: usize,
        faces: &mut BlockFaces<V>,
    ) {
        let mut own = *walk;
        for place in 0..block.len() - 2 {
            let next = self.load_next(block[place + 2].start + offset.start);
            let waves = RiemannInvariants::from_state(next, &self.cell);
            let upper = own.invariants.difference(waves);
            let continuity = [V::ONE, faces.continuity[place], faces.continuity[place + 1]];
            let stencil = InterlayerStencil { continuity, weights: [[V::ZERO; 4]; 2] };
            let ([right, left], outflow) = Slopes::Limited.face_values_beside_interlayers(
                own.carried.carried_invariants,
                own.invariants,
                [own.lower_stencil, upper],
                &self.cell,
                &stencil,
            );
            // Mirror images have no slope across a boundary.
            let below = RiemannInvariants::from_state(own.previous, &self.cell);
            let is_boundary = faces.is_boundary[place];
            faces.states[pair][place] = InterfaceState::riemann_equal_impedance([
                is_boundary.select_gt(V::ZERO, below.right, right),
                is_boundary.select_gt(V::ZERO, own.invariants.left, left),
            ]);
            own = StencilState {
                carried: CarriedState { carried_invariants: outflow, ..own.carried },
                previous: own.current,
                current: next,
                invariants: waves,
                lower_stencil: upper,
            };
        }
        *walk = own;
    }

    /// Updates the cells of a block from the states of its faces.
    #[inline(always)]
    fn move_block(
        mut self,
        (block, offset): (&[GroupIndex], GroupIndex),
        walk: &mut StencilState<V>,
        faces: &[InterfaceState<V>; BLOCK],
    ) {
        for place in 0..block.len() - 2 {
            let start = block[place].start + offset.start;
            let before = State {
                velocity: self.load(self.offsets.velocity, start),
                stress: self.load(self.offsets.stress, start),
            };
            self.store_moved(start, before, [walk.carried.lower_face, faces[place]]);
            walk.carried.lower_face = faces[place];
        }
    }

    /// Sweeps a transverse pair of a porous medium.
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

    /// Sweeps the longitudinal pair of a porous medium. The carried invariants of the walk are the state of the cell
    /// before the previous one.
    #[inline(always)]
    fn walk_porous(
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
