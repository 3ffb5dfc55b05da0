//! Sweep of lines in media with contacts: all pairs of waves together, since an open face has no traction of any pair.
//! The formulas of the faces are those of [`crate::solid::contact_faces`].
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::layout::GroupIndex;
use super::super::material_table::WavePair;
use super::contact_medium::{ContactMediumSweep, LONGITUDINAL_PASSIVE};
use super::{CarriedState, SweepLines, prefetch};
use crate::simd::{InstructionSet, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::contact_faces::separation::ExcessInvariants;
use crate::solid::contact_faces::{ContactConstants, FaceContacts, FaceStencil};
use crate::solid::contact_law::TensorPlaces;
use crate::solid::reconstruction::Slopes;
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, update_cell};

/// Contacts at the faces of a sweep.
#[derive(Clone, Copy)]
pub(crate) struct PathContacts<'a, T: Real> {
    /// Constants by lane pattern.
    pub(crate) constants: &'a [ContactConstants<T::Lanes>],
    /// By group, the factor of porosities; empty if it is 1.
    pub(crate) group_factors: &'a [T],
    /// Offset of the volumetric strain of porous media.
    pub(crate) volumetric_strain: Option<usize>,
    /// Offsets of the excess stress, if any medium separates.
    pub(crate) excess: Option<&'a TensorPlaces>,
    /// Index of the longitudinal pair of waves.
    pub(crate) longitudinal: usize,
    /// Values of the history variables in the ghosts at the lower and the upper end of rows; `None` where they are
    /// copied.
    pub(crate) boundary_values: [Option<T>; 2],
}

impl<T: Real> PathContacts<'_, T> {
    /// Returns the factor of the porosities of a group. Ghosts have none: beyond physical boundaries pores count as
    /// collapsed.
    #[inline(always)]
    pub(crate) fn group_factor(&self, group: usize) -> T {
        self.group_factors.get(group).copied().unwrap_or(T::ONE)
    }

    /// Returns the porosity of a group.
    #[inline(always)]
    pub(super) fn porosity<V: Vector<T>>(&self, group: usize, own: &ContactConstants<V>) -> V {
        match self.group_factors.is_empty() {
            true => own.porosity,
            false => <V as Vector<T>>::splat(self.group_factor(group)) * own.porosity,
        }
    }

    /// Returns the offsets of the history variables on which faces depend.
    #[inline(always)]
    pub(crate) fn history_offsets(&self) -> impl Iterator<Item = usize> {
        let excess = self.excess.into_iter().flat_map(|own| own.normal.iter().chain(&own.shear));
        self.volumetric_strain.into_iter().chain(excess.copied())
    }
}

/// Kernel: sweep of adjacent lines with contacts.
struct ContactSweep<'a, 'b, T: Real>(&'a mut SweepLines<'b, T>);

impl<T: Real> SimdKernel<T> for ContactSweep<'_, '_, T> {
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Some(contacts) = self.0.contacts else { return };
        match self.0.waves.len() {
            2 => self.0.sweep_with_contacts::<V, 2>(contacts),
            3 => self.0.sweep_with_contacts::<V, 3>(contacts),
            _ => debug_assert!(false, "media with contacts have no spins"),
        }
    }
}

/// What a sweep carries along a line for a pair of waves.
#[derive(Clone, Copy)]
struct PairWindow<V> {
    /// States of groups i − 2 … i + 1 around the face below group i.
    states: [State<V>; 4],
    /// Interface state at the lower face of group i − 1, scaled by its impedance.
    lower_face: InterfaceState<V>,
}

impl<T: Real> SweepLines<'_, T> {
    /// Sweeps lines with contacts.
    pub(super) fn sweep_path_with_contacts(&mut self, instructions: InstructionSet) {
        let Some(contacts) = &self.contacts else { return };
        let has_classical_pairs = self.waves.iter().enumerate().all(|(pair, wave)| {
            let is_longitudinal = pair == contacts.longitudinal;
            wave.passive_stresses.len() == if is_longitudinal { LONGITUDINAL_PASSIVE } else { 0 }
        });
        let has_one_medium = has_classical_pairs
            && self.table.has_single_pattern()
            && self.slopes == Slopes::Limited;
        // Groups of media that do not separate also have an excess stress if other media of the problem separate.
        let is_granular = match (contacts.excess, contacts.volumetric_strain) {
            _ if !has_one_medium => None,
            (Some(_), None) if contacts.constants[0].separates::<T>() => Some(true),
            (None, Some(_)) => Some(false),
            _ => None,
        };
        match is_granular {
            Some(true) => {
                instructions.run_kernel_or(ContactMediumSweep::<T, true>(self), |kernel| {
                    InstructionSet::Baseline.run_kernel(ContactSweep(kernel.0));
                });
            }
            Some(false) => {
                instructions.run_kernel_or(ContactMediumSweep::<T, false>(self), |kernel| {
                    InstructionSet::Baseline.run_kernel(ContactSweep(kernel.0));
                });
            }
            None => instructions.run_kernel(ContactSweep(self)),
        }
    }

    /// Fills the ghosts of rows.
    #[inline(always)]
    pub(super) fn fill_contact_ghosts<V: Vector<T>>(
        &mut self,
        contacts: &PathContacts<'_, T>,
        lines: usize,
    ) {
        let Some(rows) = &self.rows else { return };
        for (index, wave) in self.waves.iter().enumerate() {
            rows.fill_ghosts::<V>(self.field_data, wave, index, 0..lines);
        }
        for place in contacts.history_offsets() {
            let values = contacts.boundary_values;
            rows.fill_history_ghosts::<V>(self.field_data, place, values, 0..lines);
        }
    }

    /// Sets the padding lanes of a row to zero after its sweep.
    #[inline(always)]
    pub(super) fn clear_contact_padding(&mut self, contacts: &PathContacts<'_, T>, line: usize) {
        let Some(rows) = &self.rows else { return };
        for wave in self.waves {
            rows.clear_padding(self.field_data, wave.velocity, line);
            rows.clear_padding(self.field_data, wave.stress, line);
            for place in &wave.passive_stresses {
                rows.clear_padding(self.field_data, *place, line);
            }
        }
        for place in contacts.history_offsets() {
            rows.clear_padding(self.field_data, place, line);
        }
    }

    #[inline(always)]
    fn sweep_with_contacts<V: Vector<T>, const P: usize>(&mut self, contacts: PathContacts<'_, T>) {
        let lines = self.carried.len() / P;
        self.fill_contact_ghosts::<V>(&contacts, lines);
        for line in 0..lines {
            self.sweep_line_with_contacts::<V, P>(&contacts, line);
            self.clear_contact_padding(&contacts, line);
        }
    }

    #[inline(always)]
    fn sweep_line_with_contacts<V: Vector<T>, const P: usize>(
        &mut self,
        contacts: &PathContacts<'_, T>,
        line: usize,
    ) {
        let (path, steps) = (self.path, self.path.len() - 2);
        let slopes = match self.slopes {
            Slopes::Limited => Slopes::Limited,
            Slopes::Godunov | Slopes::FourthOrder | Slopes::Wide(_) => Slopes::Godunov,
        };
        let offset = GroupIndex { group: 0, start: 0 }.shift_to_line(line, self.line_stride);
        let slot = line * P;
        let mut windows = [PairWindow {
            states: [State { velocity: V::ZERO, stress: V::ZERO }; 4],
            lower_face: InterfaceState { difference: V::ZERO, sum: V::ZERO },
        }; P];
        for pair in 0..P {
            let wave = &self.waves[pair];
            let window = &mut windows[pair];
            window.states[2] = self.load_pair::<V>(path[0].start + offset.start, wave);
            window.states[3] = self.load_pair::<V>(path[1].start + offset.start, wave);
            if !self.is_line_start {
                // The group before the path has already been updated: its state before the sweep is stored.
                let carried = CarriedState::<V>::load(&self.carried[slot + pair]);
                let RiemannInvariants { right, left } = carried.carried_invariants;
                window.states[1] = State { velocity: right, stress: left };
                window.lower_face = carried.lower_face;
            }
        }
        let mut patterns = [0_u32; 4];
        patterns[1] = self.lane_pattern_indices[self.previous_group.group + offset.group];
        patterns[2] = self.lane_pattern_indices[path[0].group + offset.group];
        patterns[3] = self.lane_pattern_indices[path[1].group + offset.group];
        let mut beside =
            FaceContacts { volumetric_strain: None, porosity_factors: [V::ONE; 2], excess: None };
        self.load_history::<V>(
            contacts,
            path[0].shift_to_line(line, self.line_stride),
            &mut beside,
        );
        for place in 0..steps {
            let next = path[place + 2].start + offset.start;
            patterns = [
                patterns[1],
                patterns[2],
                patterns[3],
                self.lane_pattern_indices[path[place + 2].group + offset.group],
            ];
            for pair in 0..P {
                let wave = &self.waves[pair];
                let group = &self.field_data[next..];
                prefetch(group, self.prefetch_l1_distance + wave.velocity, true);
                prefetch(group, self.prefetch_l1_distance + wave.stress, true);
                let states = windows[pair].states;
                let state = self.load_pair::<V>(next, wave);
                windows[pair].states = [states[1], states[2], states[3], state];
            }
            let upper = path[place + 1].shift_to_line(line, self.line_stride);
            self.load_history::<V>(contacts, upper, &mut beside);
            let solutions = self.solve_faces::<V, P>(contacts, &windows, patterns, &beside, slopes);
            let start = path[place].start + offset.start;
            for pair in 0..P {
                let wave = &self.waves[pair];
                let cell: CellConstants<V> =
                    CellConstants::load(self.table.constants(patterns[1], wave));
                let window = &mut windows[pair];
                let before = window.states[1];
                let [below, above] = solutions[pair];
                let moved = update_cell(before, [window.lower_face, below], &cell);
                window.lower_face = above;
                let group = &mut self.field_data[start..];
                moved.velocity.store(&mut group[wave.velocity]);
                moved.stress.store(&mut group[wave.stress]);
                let change = moved.stress - before.stress;
                for (passive, &place) in wave.passive_stresses.iter().enumerate() {
                    let ratio: V = V::load(self.table.coupling_ratio(patterns[1], wave, passive));
                    (V::load(&group[place]) + ratio * change).store(&mut group[place]);
                }
            }
        }
        for pair in 0..P {
            let PairWindow { states, lower_face } = windows[pair];
            let State { velocity, stress } = states[1];
            let carried_invariants = RiemannInvariants { right: velocity, left: stress };
            CarriedState { carried_invariants, lower_face }.store(&mut self.carried[slot + pair]);
        }
    }

    /// Solves the Riemann problems of all pairs at a face.
    #[inline(always)]
    fn solve_faces<V: Vector<T>, const P: usize>(
        &self,
        contacts: &PathContacts<'_, T>,
        windows: &[PairWindow<V>; P],
        patterns: [u32; 4],
        beside: &FaceContacts<V>,
        slopes: Slopes,
    ) -> [[InterfaceState<V>; 2]; P] {
        let first: ContactConstants<V> =
            ContactConstants::load(&contacts.constants[patterns[0] as usize]);
        let mut constants = [first; 4];
        for depth in 1..4 {
            constants[depth] =
                ContactConstants::load(&contacts.constants[patterns[depth] as usize]);
        }
        let contact_constants = [&constants[0], &constants[1], &constants[2], &constants[3]];
        let mut cells = [self.load_cells::<V>(patterns, &self.waves[0]); P];
        let mut states = [windows[0].states; P];
        for pair in 1..P {
            cells[pair] = self.load_cells::<V>(patterns, &self.waves[pair]);
            states[pair] = windows[pair].states;
        }
        let mut cell_references = [[&cells[0][0]; 4]; P];
        for pair in 0..P {
            for depth in 0..4 {
                cell_references[pair][depth] = &cells[pair][depth];
            }
        }
        let stencil = FaceStencil {
            states,
            cells: cell_references,
            contacts: contact_constants,
            longitudinal: contacts.longitudinal,
        };
        stencil.solve(beside, slopes)
    }

    #[inline(always)]
    fn load_cells<V: Vector<T>>(
        &self,
        patterns: [u32; 4],
        wave: &WavePair,
    ) -> [CellConstants<V>; 4] {
        let first: CellConstants<V> = CellConstants::load(self.table.constants(patterns[0], wave));
        let mut cells = [first; 4];
        for depth in 1..4 {
            cells[depth] = CellConstants::load(self.table.constants(patterns[depth], wave));
        }
        cells
    }

    /// Loads the history variables of a group as those of the upper cell of a face; the former ones are those of the
    /// lower cell then.
    #[inline(always)]
    fn load_history<V: Vector<T>>(
        &self,
        contacts: &PathContacts<'_, T>,
        upper: GroupIndex,
        beside: &mut FaceContacts<V>,
    ) {
        if !contacts.group_factors.is_empty() {
            let factor = <V as Vector<T>>::splat(contacts.group_factor(upper.group));
            beside.porosity_factors = [beside.porosity_factors[1], factor];
        }
        let group = &self.field_data[upper.start..];
        if let Some(place) = contacts.volumetric_strain {
            let before = beside.volumetric_strain.unwrap_or([V::ZERO; 2]);
            beside.volumetric_strain = Some([before[1], V::load(&group[place])]);
        }
        if let Some(places) = contacts.excess {
            let before = beside.excess.unwrap_or([ExcessInvariants::ZERO; 2]);
            beside.excess = Some([before[1], load_excess::<T, V>(group, places)]);
        }
    }

    #[inline(always)]
    pub(super) fn load_pair<V: Vector<T>>(&self, start: usize, wave: &WavePair) -> State<V> {
        let group = &self.field_data[start..];
        State { velocity: V::load(&group[wave.velocity]), stress: V::load(&group[wave.stress]) }
    }
}

/// Loads the invariants of the excess stress of a group.
#[inline(always)]
pub(super) fn load_excess<T: Real, V: Vector<T>>(
    group: &[T::Lanes],
    places: &TensorPlaces,
) -> ExcessInvariants<V> {
    let [a, b, c] = places.normal;
    let mut squares = V::ZERO;
    for &place in &places.shear {
        let shear: V = V::load(&group[place]);
        squares = squares + shear * shear;
    }
    ExcessInvariants::new([V::load(&group[a]), V::load(&group[b]), V::load(&group[c])], squares)
}
