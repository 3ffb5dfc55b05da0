//! Faces with memory along a line: reference implementation of what the fused solver applies to many lines at once.
//!
//! The two cells at an interlayer provide face values, averaged over the step and reconstructed one-sidedly: s − z⁻v
//! from the left and s + z⁺v from the right,
//!
//! ```text
//! R⁻ = −(s − z⁻v),    R⁺ = s + z⁺v.
//! ```
//!
//! The law ([`models::interface`]) gives v± and σ±, the fluxes of the cells. At Courant number 1 the face values are
//! cell values, and the scheme is the box closure itself. Cells of lines with interlayers use
//! [`CellConstants::among_others`].

use super::line::{Account, CellConstants, Slopes, advance, face_values};
use super::riemann::{InterfaceState, State};
use crate::simd::{Number, Real};
use models::interface::{FaceLaw, Incoming};

/// Interlayer at a face of a line.
#[derive(Clone, Copy, Debug)]
pub struct Interlayer<N: Number, L: FaceLaw<N>> {
    /// Index of the cell above the face, ghosts included. An interlayer between ghosts affects the reconstruction, but
    /// its memory is not advanced.
    pub place: usize,
    /// Law of the interlayer.
    pub law: L,
    /// Memory variables.
    pub memory: L::Memory,
}

impl<N: Number, L: FaceLaw<N>> Interlayer<N, L> {
    /// An interlayer at rest at the lower face of cell `place`.
    pub fn new(place: usize, law: L) -> Self {
        Self { place, law, memory: L::REST }
    }

    /// Returns kinetic plus stored energy, J/m².
    pub fn energy(&self) -> N {
        self.law.kinetic_energy(&self.memory) + self.law.stored_energy(&self.memory)
    }
}

/// Advances an interlayer with incident waves `left` = s − zv and `right` = s + yv; returns the interface states of
/// both cells and the dissipation, J/m².
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

/// [`sweep`](super::line::sweep) by `step`, s, along a line with interlayers, in the order of their places. Returns the
/// dissipation of the interlayers, J/m².
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
        dissipated += lost.to_f64();
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

    /// Linear congruential generator, the same on every machine.
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

    /// Emits prescribed waves to both sides whatever arrives: s + zv to the left, s − zv to the right.
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

    /// Dissipation of a sweep of a line segment between two interlayers, from the states of its cells and the waves
    /// that the interlayers emit; all in units of the square root of energy.
    fn dissipated(cells: &[CellConstants<f64>], slopes: Slopes, numbers: &[f64]) -> f64 {
        let count = cells.len();
        let (mut all, mut velocity, mut stress) = (Vec::new(), Vec::new(), Vec::new());
        for place in 0..count + 2 * GHOSTS {
            let inside = place.wrapping_sub(GHOSTS);
            let cell = cells[inside.min(if place < GHOSTS { 0 } else { count - 1 })];
            let (z, c) = (cell.impedance, cell.courant());
            all.push(cell);
            // The reconstruction must not read ghosts.
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

    /// Smallest eigenvalue of the quadratic form [`dissipated`].
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
