//! Faces with history variables along a line: reference implementation of the kernel by which the fused solver sweeps
//! many lines with interlayers at once.
//!
//! The two cells at an interlayer provide face values, averaged over the step and reconstructed one-sidedly: s − z⁻v
//! from the left and s + z⁺v from the right, with stress s, velocity v and impedances z±,
//!
//! ```text
//! R⁻ = −(s − z⁻v),    R⁺ = s + z⁺v.
//! ```
//!
//! The law of the face ([`models::interface`]) gives velocities v± and tractions σ±, the fluxes of the cells. At
//! Courant number 1 the face values are cell values, and the box scheme of the interlayer law is the only
//! approximation. Cells of lines with interlayers use [`CellConstants::with_interfaces`].

use super::line::{CellConstants, Slopes, SweepAccount, advance, face_values};
use super::riemann::{InterfaceState, State};
use crate::simd::{Number, Real};
use models::interface::{FaceLaw, RiemannData};

/// Interlayer at a face of a line.
#[derive(Clone, Copy, Debug)]
pub struct Interlayer<N: Number, L: FaceLaw<N>> {
    /// Index of the cell above the face, ghosts included. An interlayer between ghosts affects the reconstruction, but
    /// its history variables are not advanced.
    pub upper_cell: usize,
    /// Law of the interlayer.
    pub law: L,
    /// History variables.
    pub history: L::History,
}

impl<N: Number, L: FaceLaw<N>> Interlayer<N, L> {
    /// Creates an interlayer at rest at the lower face of cell `upper_cell`.
    pub fn new(upper_cell: usize, law: L) -> Self {
        Self { upper_cell, law, history: L::REST_HISTORY }
    }

    /// Returns kinetic plus stored energy, J/m².
    pub fn energy(&self) -> N {
        self.law.kinetic_energy(&self.history) + self.law.stored_energy(&self.history)
    }
}

/// Advances an interlayer by `step`, s, with incident waves `left` = s − zv and `right` = s + yv for the impedances z
/// and y of the cells; returns the interface states of both cells and the dissipation, J/m².
#[inline(always)]
pub(crate) fn advance_interlayer<N: Number, L: FaceLaw<N>>(
    law: &L,
    impedance: [N; 2],
    [left, right]: [N; 2],
    step: N,
    history: &mut L::History,
) -> ([InterfaceState<N>; 2], N) {
    let moved = law.advance(&RiemannData { impedance, invariant: [-left, right] }, step, history);
    let [before, after] = moved.states;
    let difference = [impedance[0] * before.velocity, impedance[1] * after.velocity];
    let interface_states = [
        InterfaceState {
            difference: difference[0] + difference[0],
            sum: before.stress + before.stress,
        },
        InterfaceState {
            difference: difference[1] + difference[1],
            sum: after.stress + after.stress,
        },
    ];
    (interface_states, moved.dissipated_energy)
}

/// Sweeps a line with interlayers by `step`, s, as [`sweep`](super::line::sweep) does for other lines; `interlayers` in
/// ascending order of their cells. Returns the dissipation of the interlayers, J/m².
pub fn sweep_with_interlayers<T: Real, L: FaceLaw<T>>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    slopes: Slopes,
    interlayers: &mut [Interlayer<T, L>],
    step: T,
    accounts: Option<&mut [SweepAccount]>,
) -> f64 {
    let mut dissipated = 0.0;
    let interlayer_index = |interlayers: &[Interlayer<T, L>], place: usize| {
        interlayers.binary_search_by_key(&place, |own| own.upper_cell).ok()
    };
    let at_face = |states: [State<T>; 4], around: [&CellConstants<T>; 4], place: usize| {
        let continuity = [place - 1, place, place + 1].map(|place| {
            if interlayer_index(interlayers, place).is_some() { T::ZERO } else { T::ONE }
        });
        let values = face_values(states, around, continuity, slopes);
        let impedance = [around[1].impedance, around[2].impedance];
        let Some(index) = interlayer_index(interlayers, place) else {
            return InterfaceState::riemann(impedance, values);
        };
        let own = &mut interlayers[index];
        let (interface_states, energy_loss) =
            advance_interlayer(&own.law, impedance, values, step, &mut own.history);
        dissipated += energy_loss.to_f64();
        interface_states
    };
    advance(velocity, stress, cells, at_face, accounts);
    dissipated
}

#[cfg(test)]
mod tests {
    use super::{Interlayer, sweep_with_interlayers};
    use crate::solid::line::{CellConstants, GHOSTS, Slopes, SweepAccount};
    use crate::solid::random_lines::LinearCongruentialGenerator;
    use models::interface::{FaceLaw, FaceState, FaceStep, RiemannData};
    use nalgebra::DMatrix;

    /// Emits prescribed waves to both cells, independent of the incoming waves: s + zv to the left, s − zv to the
    /// right.
    #[derive(Clone, Copy)]
    struct WaveEmitter;

    impl FaceLaw<f64> for WaveEmitter {
        type History = [f64; 2];
        const REST_HISTORY: [f64; 2] = [0.0; 2];

        fn advance(
            &self,
            incoming: &RiemannData<f64>,
            _: f64,
            emitted: &mut [f64; 2],
        ) -> FaceStep<f64> {
            let RiemannData { impedance: [z, y], invariant: [before, after] } = *incoming;
            let states = [
                FaceState {
                    velocity: 0.5 * (emitted[0] + before) / z,
                    stress: 0.5 * (emitted[0] - before),
                },
                FaceState {
                    velocity: 0.5 * (after - emitted[1]) / y,
                    stress: 0.5 * (after + emitted[1]),
                },
            ];
            FaceStep { states, dissipated_energy: 0.0 }
        }

        fn kinetic_energy(&self, _: &[f64; 2]) -> f64 {
            0.0
        }

        fn stored_energy(&self, _: &[f64; 2]) -> f64 {
            0.0
        }
    }

    /// Computes the dissipation of a sweep of a line segment between two interlayers, from the states of its cells and
    /// the waves that the interlayers emit; `amplitudes`: all in units of the square root of energy.
    fn sweep_dissipation(cells: &[CellConstants<f64>], slopes: Slopes, amplitudes: &[f64]) -> f64 {
        let count = cells.len();
        let (mut all, mut velocity, mut stress) = (Vec::new(), Vec::new(), Vec::new());
        for place in 0..count + 2 * GHOSTS {
            let inside = place.wrapping_sub(GHOSTS);
            let cell = cells[inside.min(if place < GHOSTS { 0 } else { count - 1 })];
            let (z, c) = (cell.impedance, cell.courant());
            all.push(cell);
            // The reconstruction must not read ghosts.
            let own = (inside < count).then(|| [amplitudes[inside], amplitudes[count + inside]]);
            velocity.push(own.map_or(7.0, |own| own[0] * (2.0 * c / z).sqrt()));
            stress.push(own.map_or(-3.0, |own| own[1] * (2.0 * c * z).sqrt()));
        }
        let mut emitters =
            [GHOSTS, GHOSTS + count].map(|place| Interlayer::new(place, WaveEmitter));
        emitters[0].history[1] = amplitudes[2 * count] * (4.0 * cells[0].impedance).sqrt();
        emitters[1].history[0] =
            amplitudes[2 * count + 1] * (4.0 * cells[count - 1].impedance).sqrt();
        let mut accounts = vec![SweepAccount::default(); count];
        sweep_with_interlayers(
            &mut velocity,
            &mut stress,
            &all,
            slopes,
            &mut emitters,
            1.0,
            Some(&mut accounts),
        );
        accounts.iter().sum::<SweepAccount>().dissipation
    }

    /// Computes the smallest eigenvalue of the quadratic form [`sweep_dissipation`] of the amplitudes.
    fn min_dissipation(cells: &[CellConstants<f64>]) -> f64 {
        let count = 2 * cells.len() + 2;
        let form = |amplitudes: &[f64]| sweep_dissipation(cells, Slopes::FourthOrder, amplitudes);
        let unit = |i: usize, j: usize| {
            let mut amplitudes = vec![0.0; count];
            amplitudes[i] += 1.0;
            amplitudes[j] += 1.0;
            form(&amplitudes)
        };
        let single: Vec<f64> = (0..count).map(|i| 0.25 * unit(i, i)).collect();
        let matrix = DMatrix::from_fn(count, count, |i, j| {
            if i == j { single[i] } else { 0.5 * (unit(i, j) - single[i] - single[j]) }
        });
        matrix.symmetric_eigenvalues().min()
    }

    #[test]
    fn segments_of_one_medium_gain_no_energy_for_any_incoming_waves() {
        let courants = (1..100).map(|i| 0.01 * f64::from(i)).chain([1e-4, 0.999, 0.999_999, 1.0]);
        let mut minimum = (f64::MAX, String::new());
        for courant in courants {
            for count in [1, 2, 3, 4, 5, 6, 9, 14] {
                let dissipation =
                    min_dissipation(&vec![CellConstants::with_interfaces(1.3, courant); count]);
                if dissipation.is_nan() || dissipation < minimum.0 {
                    minimum = (dissipation, format!("C = {courant}, {count} cells"));
                }
            }
        }
        println!("{minimum:?}");
        assert!(minimum.0 > -1e-14, "{minimum:?}");
    }

    #[test]
    fn segments_of_several_media_gain_no_energy_for_any_incoming_waves() {
        let mut random = LinearCongruentialGenerator::new(2);
        let mut minimum = (f64::MAX, String::new());
        for attempt in 0..10_000 {
            let cells = random.cells([1.0, 12.0], attempt);
            let dissipation = min_dissipation(&cells);
            if dissipation.is_nan() || dissipation < minimum.0 {
                let shape: Vec<_> = cells.iter().map(|c| (c.impedance, c.courant())).collect();
                minimum = (dissipation, format!("{shape:?}"));
            }
        }
        println!("{minimum:?}");
        assert!(minimum.0 > -1e-14, "{minimum:?}");
    }
}
