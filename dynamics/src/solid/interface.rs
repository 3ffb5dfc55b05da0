//! Faces with memory along a line: the readable reference of what the solver does to many lines at once.
//!
//! Both cells beside an interlayer send it their own face values, reconstructed without a look across it: with those from
//! the left s − z⁻v and from the right s + z⁺v, averaged over the step,
//!
//! ```text
//! R⁻ = −(s − z⁻v),    R⁺ = s + z⁺v.
//! ```
//!
//! Its law ([`models::interface`]) gives v± and σ±, and these are the fluxes of the cells. At Courant number 1 the face
//! values are those of the cells, and the scheme is that of the box closure alone. Cells of lines with interlayers are those
//! of several media ([`CellConstants::among_others`]).

use super::line::{Account, CellConstants, Slopes, advance, face_values};
use super::riemann::{InterfaceState, State};
use crate::simd::{Number, Real};
use models::interface::{FaceLaw, Incoming};

/// An interlayer at a face of a line.
#[derive(Clone, Copy, Debug)]
pub struct Interlayer<N: Number, L: FaceLaw<N>> {
    /// Place of the cell behind the face, among all cells of the line, ghosts included. An interlayer between ghosts is seen
    /// by the reconstruction, but its memory is left as it is.
    pub place: usize,
    /// Its law.
    pub law: L,
    /// What it remembers.
    pub memory: L::Memory,
}

impl<N: Number, L: FaceLaw<N>> Interlayer<N, L> {
    /// At rest in front of a place.
    pub fn new(place: usize, law: L) -> Self {
        Self { place, law, memory: L::REST }
    }

    /// Kinetic and stored energy, J/m².
    pub fn energy(&self) -> N {
        self.law.kinetic_energy(&self.memory) + self.law.stored_energy(&self.memory)
    }
}

/// An interlayer as the cells beside it see it, which s − zv reaches from the left and s + yv from the right; and what it
/// dissipates, J/m².
#[inline(always)]
pub(crate) fn interlayer_states<N: Number, L: FaceLaw<N>>(
    law: &L,
    impedance: [N; 2],
    [left, right]: [N; 2],
    step: N,
    memory: &mut L::Memory,
) -> ([InterfaceState<N>; 2], N) {
    let moved = law.advance(&Incoming { impedance, invariant: [-left, right] }, step, memory);
    let [before, after] = moved.states;
    let difference = [impedance[0] * before.velocity, impedance[1] * after.velocity];
    let seen = [
        InterfaceState {
            difference: difference[0] + difference[0],
            sum: before.stress + before.stress,
        },
        InterfaceState {
            difference: difference[1] + difference[1],
            sum: after.stress + after.stress,
        },
    ];
    (seen, moved.dissipated)
}

/// Advances a pair of fields by a step of `step` (s) along a line with interlayers, in the order of their places, as
/// [`sweep`](super::line::sweep) does without them; returns what the interlayers dissipated, J/m².
pub fn sweep_with_interlayers<T: Real, L: FaceLaw<T>>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    slopes: Slopes,
    interlayers: &mut [Interlayer<T, L>],
    step: T,
    accounts: Option<&mut [Account]>,
) -> f64 {
    let mut dissipated = 0.0;
    let find = |interlayers: &[Interlayer<T, L>], place: usize| {
        interlayers.binary_search_by_key(&place, |own| own.place).ok()
    };
    let at_face = |states: [State<T>; 4], around: [&CellConstants<T>; 4], place: usize| {
        let joined = [place - 1, place, place + 1]
            .map(|place| if find(interlayers, place).is_some() { T::ZERO } else { T::ONE });
        let values = face_values(states, around, joined, slopes);
        let impedance = [around[1].impedance, around[2].impedance];
        let Some(index) = find(interlayers, place) else {
            return InterfaceState::riemann(impedance, values);
        };
        let own = &mut interlayers[index];
        let (seen, lost) = interlayer_states(&own.law, impedance, values, step, &mut own.memory);
        dissipated += lost.wide();
        seen
    };
    advance(velocity, stress, cells, at_face, accounts);
    dissipated
}

#[cfg(test)]
mod tests {
    use super::{Interlayer, sweep_with_interlayers};
    use crate::solid::line::{Account, CellConstants, GHOSTS, Slopes};
    use models::interface::{FaceLaw, FaceState, FaceStep, Incoming};
    use nalgebra::DMatrix;

    /// Numbers that look random, the same on every machine.
    struct Random(u64);

    impl Random {
        fn within(&mut self, low: f64, high: f64) -> f64 {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * ((self.0 >> 11) as f64 / (1u64 << 53) as f64)
        }
    }

    /// Sends both sides a wave of its own, whatever they send: s + zv to smaller, s − zv to greater coordinates.
    #[derive(Clone, Copy)]
    struct Emitter;

    impl FaceLaw<f64> for Emitter {
        type Memory = [f64; 2];
        const REST: [f64; 2] = [0.0; 2];

        fn advance(&self, incoming: &Incoming<f64>, _: f64, sent: &mut [f64; 2]) -> FaceStep<f64> {
            let Incoming { impedance: [z, y], invariant: [before, after] } = *incoming;
            let states = [
                FaceState {
                    velocity: 0.5 * (sent[0] + before) / z,
                    stress: 0.5 * (sent[0] - before),
                },
                FaceState {
                    velocity: 0.5 * (after - sent[1]) / y,
                    stress: 0.5 * (after + sent[1]),
                },
            ];
            FaceStep { states, dissipated: 0.0 }
        }

        fn kinetic_energy(&self, _: &[f64; 2]) -> f64 {
            0.0
        }

        fn stored_energy(&self, _: &[f64; 2]) -> f64 {
            0.0
        }
    }

    /// What a sweep of a piece of line between two interlayers dissipates, by the states of its cells and the waves that
    /// the interlayers send, all in units of the root of energy.
    fn dissipated(cells: &[CellConstants<f64>], slopes: Slopes, numbers: &[f64]) -> f64 {
        let count = cells.len();
        let (mut all, mut velocity, mut stress) = (Vec::new(), Vec::new(), Vec::new());
        for place in 0..count + 2 * GHOSTS {
            let inside = place.wrapping_sub(GHOSTS);
            let cell = cells[inside.min(if place < GHOSTS { 0 } else { count - 1 })];
            let (z, c) = (cell.impedance, cell.courant());
            all.push(cell);
            // The reconstruction must not see ghosts.
            let own = (inside < count).then(|| [numbers[inside], numbers[count + inside]]);
            velocity.push(own.map_or(7.0, |own| own[0] * (2.0 * c / z).sqrt()));
            stress.push(own.map_or(-3.0, |own| own[1] * (2.0 * c * z).sqrt()));
        }
        let mut emitters = [GHOSTS, GHOSTS + count].map(|place| Interlayer::new(place, Emitter));
        emitters[0].memory[1] = numbers[2 * count] * (4.0 * cells[0].impedance).sqrt();
        emitters[1].memory[0] = numbers[2 * count + 1] * (4.0 * cells[count - 1].impedance).sqrt();
        let mut accounts = vec![Account::default(); count];
        sweep_with_interlayers(
            &mut velocity,
            &mut stress,
            &all,
            slopes,
            &mut emitters,
            1.0,
            Some(&mut accounts),
        );
        accounts.iter().sum::<Account>().dissipated
    }

    /// The least eigenvalue of that quadratic form.
    fn least_dissipation(cells: &[CellConstants<f64>]) -> f64 {
        let count = 2 * cells.len() + 2;
        let form = |numbers: &[f64]| dissipated(cells, Slopes::FourthOrder, numbers);
        let unit = |i: usize, j: usize| {
            let mut numbers = vec![0.0; count];
            numbers[i] += 1.0;
            numbers[j] += 1.0;
            form(&numbers)
        };
        let single: Vec<f64> = (0..count).map(|i| 0.25 * unit(i, i)).collect();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            if i == j { single[i] } else { 0.5 * (unit(i, j) - single[i] - single[j]) }
        });
        matrix.symmetric_eigenvalues().min()
    }

    #[test]
    fn no_piece_of_one_medium_gains_energy_whatever_comes_in() {
        let courants = (1..100).map(|i| 0.01 * f64::from(i)).chain([1e-4, 0.999, 0.999_999, 1.0]);
        let mut found = (f64::MAX, String::new());
        for courant in courants {
            for count in [1, 2, 3, 4, 5, 6, 9, 14] {
                let least =
                    least_dissipation(&vec![CellConstants::among_others(1.3, courant); count]);
                if least.is_nan() || least < found.0 {
                    found = (least, format!("C = {courant}, {count} cells"));
                }
            }
        }
        println!("{found:?}");
        assert!(found.0 > -1e-14, "{found:?}");
    }

    #[test]
    fn no_piece_of_several_media_gains_energy_whatever_comes_in() {
        let mut random = Random(2);
        let mut found = (f64::MAX, String::new());
        for attempt in 0..10_000 {
            let count = random.within(1.0, 12.0) as usize;
            let longest = [1.0, 2.0, 3.0, 8.0][attempt % 4];
            let decades = random.within(0.0, 3.0);
            let mut cells = Vec::new();
            while cells.len() < count {
                let own = CellConstants::<f64>::among_others(
                    10f64.powf(random.within(-decades, decades)),
                    10f64.powf(random.within(-3.0, 0.0)),
                );
                let length = random.within(1.0, longest + 1.0) as usize;
                cells.extend(vec![own; length.min(count - cells.len())]);
            }
            let least = least_dissipation(&cells);
            if least.is_nan() || least < found.0 {
                let shape: Vec<_> = cells.iter().map(|c| (c.impedance, c.courant())).collect();
                found = (least, format!("{shape:?}"));
            }
        }
        println!("{found:?}");
        assert!(found.0 > -1e-14, "{found:?}");
    }
}
