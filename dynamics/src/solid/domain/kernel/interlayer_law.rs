//! Law of the interlayers of faces, in the lanes of groups.
//!
//! Each kind of law is a kernel of its own, which is not inlined into the sweep: one loop with all laws would be too
//! long for the optimiser.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use super::super::material_table::{MaterialTable, WavePair};
use super::interlayers::FACE_GROUPS;
use crate::simd::{InstructionSet, LaneGroup, Real, SimdKernel, Vector};
use crate::solid::interface::advance_interlayer;
use crate::solid::interlayers::{InterlayerLaw, MAX_HISTORY_VARIABLES};
use models::interface::layer::LayerLaw;
use models::interface::{FaceLaw, Interval};

/// A law of a face of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct LawFace {
    /// Index of the law.
    pub(super) law: u16,
    /// Mask of the lanes in which the law acts.
    pub(super) lanes: u16,
    /// Lane patterns of the groups on both sides.
    pub(super) patterns: [u32; 2],
    /// Index of the first history variable.
    pub(super) first_history: usize,
    /// Index of the first group of values: [`FACE_GROUPS`] for each wave pair.
    pub(super) first_value: usize,
}

/// Faces with the same law and lane patterns.
pub(super) struct LawFaces<'a, T: Real> {
    pub(super) law: &'a InterlayerLaw<T>,
    pub(super) faces: &'a [LawFace],
    pub(super) table: &'a MaterialTable<T>,
    pub(super) waves: &'a [WavePair],
    /// Time at the end of the sweep and its duration, s.
    pub(super) interval: Interval<T>,
    pub(super) history: &'a mut [T::Lanes],
    /// Number of history variables of a face.
    pub(super) variables: usize,
    /// Incident waves, replaced by interface states in the lanes of the law.
    pub(super) values: &'a mut [T::Lanes],
}

/// Kernel of a kind of law for `P` wave pairs; `KIND`: 0 for independent elastic components, else that of the layer.
struct LawKernel<'a, T: Real, const KIND: usize, const P: usize>(LawFaces<'a, T>);

/// Runs the kernel of the kind of the law.
#[inline(never)]
pub(super) fn apply_law<T: Real>(instructions: InstructionSet, faces: LawFaces<'_, T>) {
    match (faces.law, faces.waves.len()) {
        (InterlayerLaw::Plane(layer, _), _) => apply_plane_law(instructions, layer, faces),
        (_, 2) => LawKernel::<T, 0, 2>(faces).run_with(instructions),
        (_, 3) => LawKernel::<T, 0, 3>(faces).run_with(instructions),
        _ => LawKernel::<T, 0, 6>(faces).run_with(instructions),
    }
}

#[inline(never)]
fn apply_plane_law<T: Real>(
    instructions: InstructionSet,
    layer: &LayerLaw<T>,
    faces: LawFaces<'_, T>,
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

impl<T: Real> LawFaces<'_, T> {
    /// Advances the lanes one after the other, for the baseline: there the compiler would unroll the formulas of each
    /// law for all lanes.
    fn advance_lanes<const P: usize>(self) {
        let Self { law, faces, table, waves, interval, history: all, variables, values } = self;
        let mut history = [T::ZERO; MAX_HISTORY_VARIABLES];
        let patterns = faces.first().map_or([0; 2], |face| face.patterns);
        let impedances: [[T::Lanes; 2]; P] = std::array::from_fn(|pair| {
            patterns.map(|pattern| table.constants(pattern, &waves[pair]).impedance)
        });
        for face in faces {
            let stored = &mut all[face.first_history..][..variables];
            let values = &mut values[face.first_value..][..P * FACE_GROUPS];
            for lane in (0..T::Lanes::COUNT).filter(|lane| face.lanes >> lane & 1 == 1) {
                for (own, group) in history.iter_mut().zip(&*stored) {
                    *own = group.lanes()[lane];
                }
                let (mut impedance, mut incident) = ([[T::ZERO; 2]; P], [[T::ZERO; 2]; P]);
                for pair in 0..P {
                    for side in 0..2 {
                        impedance[pair][side] = impedances[pair][side].lanes()[lane];
                        incident[pair][side] = values[pair * FACE_GROUPS + side].lanes()[lane];
                    }
                }
                let states =
                    advance_interlayer(law, &impedance, &incident, &interval, &mut history);
                for (group, value) in stored.iter_mut().zip(history) {
                    group.lanes_mut()[lane] = value;
                }
                for (own, new) in values.chunks_exact_mut(2).zip(states.as_flattened()) {
                    own[0].lanes_mut()[lane] = new.difference;
                    own[1].lanes_mut()[lane] = new.sum;
                }
            }
        }
    }
}

impl<T: Real, const KIND: usize, const P: usize> LawKernel<'_, T, KIND, P> {
    fn run_with(self, instructions: InstructionSet) {
        instructions.run_kernel_or::<T, _>(self, |own| own.0.advance_lanes::<P>());
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
                let order = [normal, 1 - normal];
                match layer {
                    LayerLaw::Elastic(law) if KIND == 1 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Plastic(law) if KIND == 2 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Viscous(law) if KIND == 3 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Porous(law) if KIND == 4 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Saturated(law) if KIND == 5 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Cracked(law) if KIND == 6 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    LayerLaw::Breaking(law) if KIND == 7 => {
                        self.advance::<V, _, 2>(&law.map(splat), order);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }
}

impl<T: Real, const KIND: usize, const P: usize> LawKernel<'_, T, KIND, P> {
    /// Advances the history variables of all faces and sets the interface states in the lanes of the law. `order`: index
    /// of the wave pair of the first two traction components; further pairs are in order.
    #[inline(always)]
    fn advance<V: Vector<T>, L: FaceLaw<V, Q>, const Q: usize>(
        &mut self,
        law: &L,
        order: [usize; 2],
    ) {
        let LawFaces { faces, table, waves, interval, history: all, variables, values, .. } =
            &mut self.0;
        let interval = Interval {
            end: <V as Vector<T>>::splat(interval.end),
            step: <V as Vector<T>>::splat(interval.step),
        };
        let mut history = [V::ZERO; MAX_HISTORY_VARIABLES];
        // Outside of the loop, so that the compiler moves all that depends on the constants alone out of it, too.
        let mut impedance = [[V::ZERO; 2]; Q];
        let Some(first) = faces.first() else { return };
        for component in 0..Q {
            let pair = if component < 2 { order[component] } else { component };
            for side in 0..2 {
                let cell = table.constants(first.patterns[side], &waves[pair]);
                impedance[component][side] = V::load(&cell.impedance);
            }
        }
        for face in *faces {
            let stored = &mut all[face.first_history..][..*variables];
            let values = &mut values[face.first_value..][..Q * FACE_GROUPS];
            for index in 0..L::HISTORY_VARIABLE_COUNT {
                history[index] = V::load(&stored[index]);
            }
            let mut incident = [[V::ZERO; 2]; Q];
            for component in 0..Q {
                let pair = if component < 2 { order[component] } else { component };
                for side in 0..2 {
                    incident[component][side] = V::load(&values[pair * FACE_GROUPS + side]);
                }
            }
            let states = advance_interlayer(law, &impedance, &incident, &interval, &mut history);
            for index in 0..L::HISTORY_VARIABLE_COUNT {
                let own = &mut stored[index];
                V::load(own).blend_lanes(face.lanes, history[index]).store(own);
            }
            for component in 0..Q {
                let pair = if component < 2 { order[component] } else { component };
                for side in 0..2 {
                    let new = states[component][side];
                    let first = pair * FACE_GROUPS + 2 * side;
                    for (own, value) in [(first, new.difference), (first + 1, new.sum)] {
                        let own = &mut values[own];
                        V::load(own).blend_lanes(face.lanes, value).store(own);
                    }
                }
            }
        }
    }
}
