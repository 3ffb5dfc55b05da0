//! Law of the interlayers in the lanes of one face of a group.
//!
//! Each kind of law is a kernel of its own, which is not inlined into the sweep: one loop with all laws would be too
//! long for the optimiser.
#![allow(clippy::needless_range_loop, reason = "closures would lose the SIMD instructions")]

use crate::simd::{InstructionSet, LaneGroup, Number, Real, SimdKernel, Vector};
use crate::solid::interface::advance_interlayer;
use crate::solid::interlayers::{InterlayerLaw, MAX_HISTORY_VARIABLES, MAX_PAIRS};
use crate::solid::riemann::InterfaceState;
use models::interface::layer::LayerLaw;
use models::interface::{FaceLaw, Interval};

/// Values of a face that a sweep and the law of the face exchange, by wave pair.
pub(super) struct FaceValues<T: Real> {
    pub(super) impedance: [[T::Lanes; 2]; MAX_PAIRS],
    /// Incident waves, see [`advance_interlayer`].
    pub(super) incident: [[T::Lanes; 2]; MAX_PAIRS],
    /// Interface states of both cells.
    pub(super) states: [[InterfaceState<T::Lanes>; 2]; MAX_PAIRS],
}

impl<T: Real> FaceValues<T> {
    pub(super) fn new() -> Self {
        let zero = [T::Lanes::ZERO; 2];
        let state = InterfaceState { difference: T::Lanes::ZERO, sum: T::Lanes::ZERO };
        Self {
            impedance: [zero; MAX_PAIRS],
            incident: [zero; MAX_PAIRS],
            states: [[state; 2]; MAX_PAIRS],
        }
    }
}

/// Face of a group, and the lanes in which a law acts.
pub(super) struct LawLanes<'a, T: Real> {
    pub(super) law: &'a InterlayerLaw<T>,
    pub(super) lanes: u16,
    /// Time at the end of the sweep and its duration, s.
    pub(super) interval: Interval<T>,
    pub(super) history: &'a mut [T::Lanes],
    pub(super) values: &'a mut FaceValues<T>,
}

/// Kernel of a kind of law for `P` wave pairs; `KIND`: 0 for independent elastic components, else that of the layer.
struct LawKernel<'a, T: Real, const KIND: usize, const P: usize>(LawLanes<'a, T>);

/// Runs the kernel of the kind of the law; `pairs`: number of wave pairs.
#[inline(never)]
pub(super) fn apply_law<T: Real>(
    instructions: InstructionSet,
    pairs: usize,
    face: LawLanes<'_, T>,
) {
    match (face.law, pairs) {
        (InterlayerLaw::Plane(layer, _), _) => apply_plane_law(instructions, layer, face),
        (_, 2) => LawKernel::<T, 0, 2>(face).run_with(instructions),
        (_, 3) => LawKernel::<T, 0, 3>(face).run_with(instructions),
        _ => LawKernel::<T, 0, 6>(face).run_with(instructions),
    }
}

#[inline(never)]
fn apply_plane_law<T: Real>(
    instructions: InstructionSet,
    layer: &LayerLaw<T>,
    face: LawLanes<'_, T>,
) {
    match layer {
        LayerLaw::Elastic(_) => LawKernel::<T, 1, 2>(face).run_with(instructions),
        LayerLaw::Plastic(_) => LawKernel::<T, 2, 2>(face).run_with(instructions),
        LayerLaw::Viscous(_) => LawKernel::<T, 3, 2>(face).run_with(instructions),
        LayerLaw::Porous(_) => LawKernel::<T, 4, 2>(face).run_with(instructions),
        LayerLaw::Saturated(_) => LawKernel::<T, 5, 2>(face).run_with(instructions),
        LayerLaw::Cracked(_) => LawKernel::<T, 6, 2>(face).run_with(instructions),
        LayerLaw::Breaking(_) => LawKernel::<T, 7, 2>(face).run_with(instructions),
    }
}

impl<T: Real> LawLanes<'_, T> {
    /// Advances the lanes one after the other, for the baseline: there the compiler would unroll the formulas of each
    /// law for all lanes.
    fn advance_lanes<const P: usize>(self) {
        let Self { law, lanes, interval, history: stored, values } = self;
        let mut history = [T::ZERO; MAX_HISTORY_VARIABLES];
        for lane in (0..T::Lanes::COUNT).filter(|lane| lanes >> lane & 1 == 1) {
            for (own, group) in history.iter_mut().zip(&*stored) {
                *own = group.lanes()[lane];
            }
            let sides = |all: &[[T::Lanes; 2]; MAX_PAIRS]| -> [[T; 2]; P] {
                std::array::from_fn(|pair| all[pair].each_ref().map(|side| side.lanes()[lane]))
            };
            let (impedance, incident) = (sides(&values.impedance), sides(&values.incident));
            let states = advance_interlayer(law, &impedance, &incident, &interval, &mut history);
            for (group, value) in stored.iter_mut().zip(history) {
                group.lanes_mut()[lane] = value;
            }
            for (own, new) in values.states.iter_mut().flatten().zip(states.as_flattened()) {
                own.difference.lanes_mut()[lane] = new.difference;
                own.sum.lanes_mut()[lane] = new.sum;
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
    /// Advances the history variables and sets the interface states in the lanes of the law. `order`: index of the wave
    /// pair of the first two traction components; further pairs are in order.
    #[inline(always)]
    fn advance<V: Vector<T>, L: FaceLaw<V, Q>, const Q: usize>(
        &mut self,
        law: &L,
        order: [usize; 2],
    ) {
        let LawLanes { lanes, interval, history: stored, values, .. } = &mut self.0;
        let interval = Interval {
            end: <V as Vector<T>>::splat(interval.end),
            step: <V as Vector<T>>::splat(interval.step),
        };
        let mut history = [V::ZERO; MAX_HISTORY_VARIABLES];
        let count = L::HISTORY_VARIABLES;
        for index in 0..count {
            history[index] = V::load(&stored[index]);
        }
        let (mut impedance, mut incident) = ([[V::ZERO; 2]; Q], [[V::ZERO; 2]; Q]);
        for component in 0..Q {
            let pair = if component < 2 { order[component] } else { component };
            for side in 0..2 {
                impedance[component][side] = V::load(&values.impedance[pair][side]);
                incident[component][side] = V::load(&values.incident[pair][side]);
            }
        }
        let states = advance_interlayer(law, &impedance, &incident, &interval, &mut history);
        for index in 0..count {
            let own = &mut stored[index];
            V::load(own).blend_lanes(*lanes, history[index]).store(own);
        }
        for component in 0..Q {
            let pair = if component < 2 { order[component] } else { component };
            for side in 0..2 {
                let own = &mut values.states[pair][side];
                let old: InterfaceState<V> = InterfaceState::load(own);
                let new = states[component][side];
                InterfaceState {
                    difference: old.difference.blend_lanes(*lanes, new.difference),
                    sum: old.sum.blend_lanes(*lanes, new.sum),
                }
                .store(own);
            }
        }
    }
}
