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
use super::reconstruction::GHOSTS;
use super::riemann::{InterfaceState, State};
use crate::simd::{Number, Real};
use models::interface::{FaceLaw, Interval, RiemannData};

/// Interlayer at a face of a line.
#[derive(Clone, Debug)]
pub struct Interlayer<N, L> {
    /// Index of the cell above the face, ghosts included. An interlayer between ghosts affects the reconstruction, but
    /// its history variables are not advanced.
    pub upper_cell: usize,
    /// Law of the interlayer.
    pub law: L,
    /// History variables of the law.
    pub history: Vec<N>,
}

/// Advances an interlayer by a step with incident waves s − zv from the left and s + yv from the right for the
/// impedances z and y of the cells, by wave pair; returns the interface states of both cells by wave pair.
#[inline(always)]
pub(crate) fn advance_interlayer<N: Number, L: FaceLaw<N, P>, const P: usize>(
    law: &L,
    impedance: &[[N; 2]; P],
    incident: &[[N; 2]; P],
    interval: &Interval<N>,
    history: &mut [N],
) -> [[InterfaceState<N>; 2]; P] {
    let zero = RiemannData { impedance: [N::ZERO; 2], invariant: [N::ZERO; 2] };
    let mut incoming = [zero; P];
    for pair in 0..P {
        let [left, right] = incident[pair];
        incoming[pair] = RiemannData { impedance: impedance[pair], invariant: [-left, right] };
    }
    let face_states = law.advance(&incoming, interval, history);
    let mut states = [[InterfaceState { difference: N::ZERO, sum: N::ZERO }; 2]; P];
    for pair in 0..P {
        for side in 0..2 {
            let face = face_states[pair][side];
            let difference = impedance[pair][side] * face.velocity;
            states[pair][side] = InterfaceState {
                difference: difference + difference,
                sum: face.stress + face.stress,
            };
        }
    }
    states
}

/// Velocities, stresses and constants of a wave pair along a line, ghosts included.
pub struct LineState<'a, T: Real> {
    /// Velocity of each cell, m/s, or spin, rad/s.
    pub velocity: &'a mut [T],
    /// Stress of each cell, Pa, or couple stress, N/m.
    pub stress: &'a mut [T],
    /// Constants of each cell.
    pub cells: &'a [CellConstants<T>],
    /// Accounts of the interior cells, if wanted.
    pub accounts: Option<&'a mut [SweepAccount]>,
}

/// Sweeps a line with interlayers as [`sweep`](super::line::sweep) does for other lines, all wave pairs together;
/// `interlayers` in ascending order of their cells.
pub fn sweep_with_interlayers<T: Real, L: FaceLaw<T, P>, const P: usize>(
    mut lines: [LineState<'_, T>; P],
    slopes: Slopes,
    interlayers: &mut [Interlayer<T, L>],
    interval: &Interval<T>,
) {
    let upper_cells: Vec<usize> = interlayers.iter().map(|own| own.upper_cell).collect();
    let find = |upper_cell: usize| upper_cells.binary_search(&upper_cell).ok();
    let continuity = |upper_cell: usize| {
        [upper_cell - 1, upper_cell, upper_cell + 1]
            .map(|upper_cell| if find(upper_cell).is_some() { T::ZERO } else { T::ONE })
    };
    let length = lines.iter().map(|line| line.cells.len()).min().unwrap_or(0);
    // States of all interlayers that are not between two ghosts, from the states before the step.
    let mut interface_states = vec![None; interlayers.len()];
    for (own, states) in interlayers.iter_mut().zip(&mut interface_states) {
        let upper_cell = own.upper_cell;
        if upper_cell < GHOSTS || upper_cell + GHOSTS > length {
            continue;
        }
        let mut impedance = [[T::ZERO; 2]; P];
        let mut incident = [[T::ZERO; 2]; P];
        for (pair, line) in lines.iter().enumerate() {
            let adjacent_cells: [&CellConstants<T>; 4] =
                std::array::from_fn(|i| &line.cells[upper_cell - 2 + i]);
            let adjacent_states = std::array::from_fn(|i| State {
                velocity: line.velocity[upper_cell - 2 + i],
                stress: line.stress[upper_cell - 2 + i],
            });
            impedance[pair] = [adjacent_cells[1].impedance, adjacent_cells[2].impedance];
            incident[pair] =
                face_values(adjacent_states, adjacent_cells, continuity(upper_cell), slopes);
        }
        *states =
            Some(advance_interlayer(&own.law, &impedance, &incident, interval, &mut own.history));
    }
    for (pair, line) in lines.iter_mut().enumerate() {
        let at_face =
            |states: [State<T>; 4], adjacent_cells: [&CellConstants<T>; 4], upper_cell: usize| {
                if let Some(Some(states)) = find(upper_cell).map(|index| interface_states[index]) {
                    return states[pair];
                }
                let values = face_values(states, adjacent_cells, continuity(upper_cell), slopes);
                InterfaceState::riemann(
                    [adjacent_cells[1].impedance, adjacent_cells[2].impedance],
                    values,
                )
            };
        let accounts = line.accounts.as_deref_mut();
        advance(line.velocity, line.stress, line.cells, at_face, accounts);
    }
}

#[cfg(test)]
mod tests {
    use super::{Interlayer, LineState, sweep_with_interlayers};
    use crate::solid::line::{CellConstants, GHOSTS, Slopes, SweepAccount};
    use crate::solid::random_lines::LinearCongruentialGenerator;
    use models::interface::{FaceEnergy, FaceLaw, FaceState, Interval, RiemannData};
    use nalgebra::DMatrix;

    /// Emits prescribed waves to both cells, independent of the incoming waves: s + zv to the left, s − zv to the
    /// right.
    #[derive(Clone, Copy)]
    struct WaveEmitter;

    impl FaceLaw<f64, 1> for WaveEmitter {
        const HISTORY_VARIABLE_COUNT: usize = 2;

        fn initialise(&self, _: &[[f64; 2]; 1], _: &mut [f64]) {}

        fn advance(
            &self,
            incoming: &[RiemannData<f64>; 1],
            _: &Interval<f64>,
            emitted: &mut [f64],
        ) -> [[FaceState<f64>; 2]; 1] {
            let RiemannData { impedance: [z, y], invariant: [before, after] } = incoming[0];
            [[
                FaceState {
                    velocity: 0.5 * (emitted[0] + before) / z,
                    stress: 0.5 * (emitted[0] - before),
                },
                FaceState {
                    velocity: 0.5 * (after - emitted[1]) / y,
                    stress: 0.5 * (after + emitted[1]),
                },
            ]]
        }

        fn energy(&self, _: &[f64]) -> FaceEnergy<f64> {
            FaceEnergy::ZERO
        }
    }

    /// Computes the dissipation of a sweep of a line segment between two interlayers, from the states of its cells and
    /// the waves that the interlayers emit; `amplitudes`: all in units of the square root of energy.
    fn sweep_dissipation(cells: &[CellConstants<f64>], slopes: Slopes, amplitudes: &[f64]) -> f64 {
        let count = cells.len();
        let (mut line_cells, mut velocity, mut stress) = (Vec::new(), Vec::new(), Vec::new());
        for place in 0..count + 2 * GHOSTS {
            let cell_index = place.wrapping_sub(GHOSTS);
            let cell = cells[cell_index.min(if place < GHOSTS { 0 } else { count - 1 })];
            let (z, c) = (cell.impedance, cell.courant());
            line_cells.push(cell);
            // The reconstruction must not read ghosts.
            let cell_amplitudes = (cell_index < count)
                .then(|| [amplitudes[cell_index], amplitudes[count + cell_index]]);
            velocity.push(cell_amplitudes.map_or(7.0, |own| own[0] * (2.0 * c / z).sqrt()));
            stress.push(cell_amplitudes.map_or(-3.0, |own| own[1] * (2.0 * c * z).sqrt()));
        }
        let mut emitters = [GHOSTS, GHOSTS + count].map(|upper_cell| Interlayer {
            upper_cell,
            law: WaveEmitter,
            history: vec![0.0; 2],
        });
        emitters[0].history[1] = amplitudes[2 * count] * (4.0 * cells[0].impedance).sqrt();
        emitters[1].history[0] =
            amplitudes[2 * count + 1] * (4.0 * cells[count - 1].impedance).sqrt();
        let mut accounts = vec![SweepAccount::default(); count];
        let line = LineState {
            velocity: &mut velocity,
            stress: &mut stress,
            cells: &line_cells,
            accounts: Some(&mut accounts),
        };
        let interval = Interval::new(1.0, 1.0);
        sweep_with_interlayers([line], slopes, &mut emitters, &interval);
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
