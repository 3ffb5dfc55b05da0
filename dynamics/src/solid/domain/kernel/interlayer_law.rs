//! Interlayer laws: history variables and interface states of the faces of a sweep, in SIMD lanes.
//!
//! Each kind of law is a kernel of its own, which is not inlined into the sweep: one loop with all laws would be too
//! long for the optimiser.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::material_table::{MaterialTable, WavePair};
use crate::simd::{InstructionSet, LaneGroup, Real, SimdKernel, Vector};
use crate::solid::interface::advance_interlayer;
use crate::solid::interlayers::{InterlayerLaw, MAX_HISTORY_VARIABLES};
use models::interface::layer::LayerLaw;
use models::interface::{FaceLaw, Interval};

/// Number of groups for a wave pair of a face in the buffer of interface states.
pub(super) const GROUPS_PER_WAVE_PAIR: usize = 4;

/// Law of the face of a group in some of its lanes; a face whose lanes have several laws has one entry for each.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceLawEntry {
    /// Index of the law among those of the axis.
    pub(super) law_index: u16,
    /// Mask of the lanes in which the law acts.
    pub(super) lanes: u16,
    /// Indices of the lane patterns of the groups below and above the face.
    pub(super) lane_pattern_indices: [u32; 2],
    /// Index of the first history variable of the face among those of all faces of the domain.
    pub(super) first_history_index: usize,
    /// Index of the first group of the face in the buffer of interface states, which holds [`GROUPS_PER_WAVE_PAIR`]
    /// groups for each wave pair of the face.
    pub(super) first_value_index: usize,
}

/// Consecutive faces with the same law and the same lane patterns, and the data that a kernel reads and writes.
pub(super) struct FaceBatch<'a, T: Real> {
    pub(super) law: &'a InterlayerLaw<T>,
    pub(super) faces: &'a [FaceLawEntry],
    pub(super) table: &'a MaterialTable<T>,
    pub(super) waves: &'a [WavePair],
    pub(super) interval: Interval<T>,
    pub(super) history: &'a mut [T::Lanes],
    /// Number of history variables of a face.
    pub(super) history_variable_count: usize,
    /// Number of history variables, from the first one on, that the sweep changes; at most those of the law.
    pub(super) advanced_variable_count: usize,
    /// Buffer of interface states: incident waves, which the kernel replaces by interface states in the lanes of the
    /// law.
    pub(super) values: &'a mut [T::Lanes],
}

/// Kernel of a kind of law for `P` wave pairs. `KIND`: 0 for independent elastic components
/// ([`InterlayerLaw::Elastic`]), 1 to 7 for the kinds of [`LayerLaw`] in their order.
struct LawKernel<'a, T: Real, const KIND: usize, const P: usize>(FaceBatch<'a, T>);

/// Advances the faces of a batch by the kernel for the kind of their law.
#[inline(never)]
pub(super) fn apply_law<T: Real>(instructions: InstructionSet, faces: FaceBatch<'_, T>) {
    match (faces.law, faces.waves.len()) {
        (InterlayerLaw::Plane(layer, _), _) => apply_plane_law(instructions, layer, faces),
        (_, 2) => LawKernel::<T, 0, 2>(faces).run_with(instructions),
        (_, 3) => LawKernel::<T, 0, 3>(faces).run_with(instructions),
        _ => LawKernel::<T, 0, 6>(faces).run_with(instructions),
    }
}

/// Advances the faces of a batch by the kernel for the kind of a layer in plane strain.
#[inline(never)]
fn apply_plane_law<T: Real>(
    instructions: InstructionSet,
    layer: &LayerLaw<T>,
    faces: FaceBatch<'_, T>,
) {
    match layer {
        LayerLaw::Elastic(_) => LawKernel::<T, 1, 2>(faces).run_with(instructions),
        LayerLaw::Plastic(_) => LawKernel::<T, 2, 2>(faces).run_with(instructions),
        LayerLaw::Viscous(_) => LawKernel::<T, 3, 2>(faces).run_with(instructions),
        LayerLaw::Porous(_) => LawKernel::<T, 4, 2>(faces).run_with(instructions),
        LayerLaw::Saturated(_) => LawKernel::<T, 5, 2>(faces).run_with(instructions),
        LayerLaw::Cracked(_) => LawKernel::<T, 6, 2>(faces).run_with(instructions),
        LayerLaw::Breaking(_) => LawKernel::<T, 7, 2>(faces).run_with(instructions),
    }
}

impl<T: Real> FaceBatch<'_, T> {
    /// Advances the lanes one after the other, without SIMD. Used with the baseline instruction set, for which the
    /// compiler would unroll the formulas of each law over all lanes.
    fn advance_lane_by_lane<const P: usize>(self) {
        let Self {
            law,
            faces,
            table,
            waves,
            interval,
            history: stored_history,
            history_variable_count,
            advanced_variable_count,
            values,
        } = self;
        let mut history = [T::ZERO; MAX_HISTORY_VARIABLES];
        let lane_pattern_indices = faces.first().map_or([0; 2], |face| face.lane_pattern_indices);
        let impedances: [[T::Lanes; 2]; P] = std::array::from_fn(|pair| {
            lane_pattern_indices.map(|pattern| table.constants(pattern, &waves[pair]).impedance)
        });
        for face in faces {
            let stored = &mut stored_history[face.first_history_index..][..history_variable_count];
            let values = &mut values[face.first_value_index..][..P * GROUPS_PER_WAVE_PAIR];
            for lane in (0..T::Lanes::COUNT).filter(|lane| face.lanes >> lane & 1 == 1) {
                for (value, group) in history.iter_mut().zip(&*stored) {
                    *value = group.lanes()[lane];
                }
                let (mut impedance, mut incident) = ([[T::ZERO; 2]; P], [[T::ZERO; 2]; P]);
                for pair in 0..P {
                    for side in 0..2 {
                        impedance[pair][side] = impedances[pair][side].lanes()[lane];
                        incident[pair][side] =
                            values[pair * GROUPS_PER_WAVE_PAIR + side].lanes()[lane];
                    }
                }
                let states =
                    advance_interlayer(law, &impedance, &incident, &interval, &mut history);
                for (group, value) in stored.iter_mut().zip(history).take(advanced_variable_count) {
                    group.lanes_mut()[lane] = value;
                }
                for (groups, state) in values.chunks_exact_mut(2).zip(states.as_flattened()) {
                    groups[0].lanes_mut()[lane] = state.difference;
                    groups[1].lanes_mut()[lane] = state.sum;
                }
            }
        }
    }
}

impl<T: Real, const KIND: usize, const P: usize> LawKernel<'_, T, KIND, P> {
    /// Runs the kernel with an instruction set; lane by lane with the baseline.
    fn run_with(self, instructions: InstructionSet) {
        instructions.run_kernel_or::<T, _>(self, |kernel| kernel.0.advance_lane_by_lane::<P>());
    }
}

impl<T: Real, const KIND: usize, const P: usize> SimdKernel<T> for LawKernel<'_, T, KIND, P> {
    #[inline(always)]
    fn run<V: Vector<T>>(mut self) {
        // `KIND` is constant: one branch is compiled.
        let splat = <V as Vector<T>>::splat;
        match *self.0.law {
            InterlayerLaw::Elastic(components) if KIND == 0 => {
                let law = InterlayerLaw::<T>::elastic_layer::<P>(&components).map(splat);
                self.advance::<V, _, P>(&law, [0, 1]);
            }
            InterlayerLaw::Plane(layer, normal) if KIND > 0 => {
                let first_pairs = [normal, 1 - normal];
                match layer {
                    LayerLaw::Elastic(law) if KIND == 1 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Plastic(law) if KIND == 2 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Viscous(law) if KIND == 3 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Porous(law) if KIND == 4 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Saturated(law) if KIND == 5 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Cracked(law) if KIND == 6 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    LayerLaw::Breaking(law) if KIND == 7 => {
                        self.advance::<V, _, 2>(&law.map(splat), first_pairs);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }
}

impl<T: Real, const KIND: usize, const P: usize> LawKernel<'_, T, KIND, P> {
    /// Advances the history variables of all faces and sets the interface states in the lanes of the law.
    /// `first_pairs`: indices of the wave pairs of the first two traction components of the law; each further component
    /// has the pair of its own index.
    #[inline(always)]
    fn advance<V: Vector<T>, L: FaceLaw<V, Q>, const Q: usize>(
        &mut self,
        law: &L,
        first_pairs: [usize; 2],
    ) {
        let FaceBatch {
            faces,
            table,
            waves,
            interval,
            history: stored_history,
            history_variable_count,
            advanced_variable_count,
            values,
            ..
        } = &mut self.0;
        let interval = Interval {
            end: <V as Vector<T>>::splat(interval.end),
            step: <V as Vector<T>>::splat(interval.step),
            tangential_step: <V as Vector<T>>::splat(interval.tangential_step),
        };
        let mut history = [V::ZERO; MAX_HISTORY_VARIABLES];
        // Loaded before the loop, so that the compiler hoists everything that depends only on constants.
        let mut impedance = [[V::ZERO; 2]; Q];
        let Some(first) = faces.first() else { return };
        for component in 0..Q {
            let pair = if component < 2 { first_pairs[component] } else { component };
            for side in 0..2 {
                let cell = table.constants(first.lane_pattern_indices[side], &waves[pair]);
                impedance[component][side] = V::load(&cell.impedance);
            }
        }
        for face in *faces {
            let stored = &mut stored_history[face.first_history_index..][..*history_variable_count];
            let values = &mut values[face.first_value_index..][..Q * GROUPS_PER_WAVE_PAIR];
            for index in 0..L::HISTORY_VARIABLE_COUNT {
                history[index] = V::load(&stored[index]);
            }
            let mut incident = [[V::ZERO; 2]; Q];
            for component in 0..Q {
                let pair = if component < 2 { first_pairs[component] } else { component };
                for side in 0..2 {
                    incident[component][side] =
                        V::load(&values[pair * GROUPS_PER_WAVE_PAIR + side]);
                }
            }
            let states = advance_interlayer(law, &impedance, &incident, &interval, &mut history);
            for index in 0..L::HISTORY_VARIABLE_COUNT.min(*advanced_variable_count) {
                let group = &mut stored[index];
                V::load(group).blend_lanes(face.lanes, history[index]).store(group);
            }
            for component in 0..Q {
                let pair = if component < 2 { first_pairs[component] } else { component };
                for side in 0..2 {
                    let state = states[component][side];
                    let first_group = pair * GROUPS_PER_WAVE_PAIR + 2 * side;
                    for (index, value) in
                        [(first_group, state.difference), (first_group + 1, state.sum)]
                    {
                        let group = &mut values[index];
                        V::load(group).blend_lanes(face.lanes, value).store(group);
                    }
                }
            }
        }
    }
}
