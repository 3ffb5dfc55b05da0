//! Linear reconstruction from W = 6 or 8 cells around a face: the scheme of order W of the line (Strang 1962).
//!
//! The primitive of the cell averages, interpolated on W + 1 faces centred on the face at x, and taken at x and at
//! x − Ch, gives the time-averaged wave exactly for polynomials of degree W − 1. In one medium the energy of no wave
//! grows for Courant numbers 0 ≤ C ≤ 1 (Strang 1962). Beyond a symmetry plane, and at a free or fixed boundary without
//! load, the arriving wave and its mirror images are a wave in a line without boundary, so that the sweep gains no energy
//! there either. Non-reflecting boundaries are refused: beside ghosts that are zero a leaving wave would return short waves.

use super::cell::CellConstants;
use super::line::{SweepAccount, advance};
use super::riemann::{InterfaceState, RiemannInvariants, State};
use crate::simd::{Number, Real};

/// Computes the weights of W cells in the time-averaged wave at the face in their middle, in the direction of
/// propagation; the sum of the weights is 1.
///
/// Face m (0: the face itself, counted in the direction of propagation) has the weight ℓ(m) = −C(1/m) Π (C + n)/(n − m)
/// in the interpolation at x − Ch, with the product over the other faces n ≠ 0. The primitive at face m is the sum of the
/// cells between the faces 0 and m. Hence the weight of a cell is the sum of ℓ/C over the faces at and beyond its outer
/// end, with the sign + for upwind cells and − for downwind cells.
#[inline(always)]
pub(crate) fn face_weights<N: Number, const W: usize>(courant: N) -> [N; W] {
    let half = W / 2;
    let mut weights = [N::ZERO; W];
    let mut upwind_sum = N::ZERO;
    let mut downwind_sum = N::ZERO;
    for distance in 0..half {
        let outermost = (half - distance) as i32;
        upwind_sum = upwind_sum + interpolation_weight::<N, W>(-outermost, courant);
        weights[distance] = upwind_sum;
        downwind_sum = downwind_sum + interpolation_weight::<N, W>(outermost, courant);
        weights[W - 1 - distance] = N::ZERO - downwind_sum;
    }
    weights
}

/// Computes the weight ℓ(m)/C of face m ≠ 0; see [`face_weights`].
#[inline(always)]
fn interpolation_weight<N: Number, const W: usize>(face: i32, courant: N) -> N {
    let half = (W / 2) as i32;
    let mut factor = -1.0 / f64::from(face);
    let mut product = N::ONE;
    for other in -half..=half {
        if other != face && other != 0 {
            product = product * (courant + N::from_f64(f64::from(other)));
            factor /= f64::from(other - face);
        }
    }
    N::from_f64(factor) * product
}

/// Computes the Riemann solution at the face in the middle of W cells, from the invariants of the cells from the lower to
/// the upper one; `weights`: result of [`face_weights`].
#[inline(always)]
pub(crate) fn interface_state<N: Number, const W: usize>(
    cells: &[RiemannInvariants<N>; W],
    weights: &[N; W],
) -> InterfaceState<N> {
    let mut right = weights[0] * cells[0].right;
    let mut left = weights[0] * cells[W - 1].left;
    for place in 1..W {
        right = right + weights[place] * cells[place].right;
        left = left + weights[place] * cells[W - 1 - place].left;
    }
    InterfaceState::riemann_equal_impedance([right, left])
}

/// Returns the interface states of a face for its left and its right cell, from the states of W cells around it.
pub(super) fn solve_face<T: Real, const W: usize>(
    states: [State<T>; W],
    cell: &CellConstants<T>,
) -> [InterfaceState<T>; 2] {
    let invariants = states.map(|state| RiemannInvariants::from_state(state, cell));
    [interface_state(&invariants, &face_weights(cell.courant())); 2]
}

/// Advances a wave pair as [`super::line::sweep`] does, with W cells around each face.
pub(super) fn sweep<T: Real, const W: usize>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    accounts: Option<&mut [SweepAccount]>,
) {
    let at_face =
        |states: [State<T>; W], cells: [&CellConstants<T>; W], _| solve_face(states, cells[W / 2]);
    advance(velocity, stress, cells, at_face, accounts);
}

#[cfg(test)]
mod tests {
    use super::{face_weights, sweep};
    use crate::solid::cell::CellConstants;

    /// Verifies that with four cells the weights are those of the fourth-order scheme, which has its own formula.
    #[test]
    fn weights_of_four_cells_are_those_of_fourth_order() {
        for courant in [0.0, 0.1, 0.35, 0.5, 0.9, 1.0] {
            let weights: [f64; 4] = face_weights(courant);
            let cell = CellConstants::<f64>::new(1.0, courant);
            for place in 0..4 {
                let mut values = [0.0; 4];
                values[place] = 1.0;
                let expected = cell.face_value(values);
                assert!((weights[place] - expected).abs() < 1e-15, "{courant} {weights:?}");
            }
        }
    }

    /// Verifies that the face value is the mean over the step of a polynomial of degree W − 1 given by its cell means.
    fn check_polynomials<const W: usize>() {
        for courant in [1e-3, 0.2, 0.5, 0.77, 1.0] {
            let weights: [f64; W] = face_weights(courant);
            for degree in 0..W as i32 {
                // Cell means of x^p over [a, a + 1]; the face is at x = 0.
                let mean = |from: f64, to: f64| {
                    (to.powi(degree + 1) - from.powi(degree + 1))
                        / (f64::from(degree + 1) * (to - from))
                };
                let face_value: f64 = (0..W)
                    .map(|place| {
                        let lower = place as f64 - (W / 2) as f64;
                        weights[place] * mean(lower, lower + 1.0)
                    })
                    .sum();
                let expected = mean(-courant, 0.0);
                let scale = ((W / 2) as f64).powi(degree);
                assert!((face_value - expected).abs() < 1e-14 * scale, "{courant} {degree}");
            }
        }
    }

    #[test]
    fn face_values_of_polynomials_are_exact() {
        check_polynomials::<6>();
        check_polynomials::<8>();
    }

    /// Advects one period of a sine by one wavelength on a periodic line; returns the largest error of the cell means.
    fn wave_error<const W: usize>(count: usize) -> f64 {
        let ghosts = W / 2;
        let angle = |cell: usize| std::f64::consts::TAU * cell as f64 / count as f64;
        let courant = 0.5;
        let cells = vec![CellConstants::<f64>::new(2.0, courant); count + 2 * ghosts];
        let exact: Vec<f64> = (0..count).map(|cell| angle(cell).sin()).collect();
        let mut stress = exact.clone();
        for _ in 0..2 * count {
            let padded = |values: &[f64], factor: f64| -> Vec<f64> {
                let periodic = (0..count + 2 * ghosts).map(|i| (i + count - ghosts) % count);
                periodic.map(|cell| factor * values[cell]).collect()
            };
            // A right-going wave.
            let (mut v, mut s) = (padded(&stress, -0.5), padded(&stress, 1.0));
            sweep::<f64, W>(&mut v, &mut s, &cells, None);
            stress.copy_from_slice(&s[ghosts..ghosts + count]);
        }
        stress.iter().zip(&exact).map(|(own, exact)| (own - exact).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn sweeps_converge_at_their_orders() {
        let orders = [
            (wave_error::<6>(12) / wave_error::<6>(24)).log2(),
            (wave_error::<8>(12) / wave_error::<8>(24)).log2(),
        ];
        assert!((orders[0] - 6.0).abs() < 0.15 && (orders[1] - 8.0).abs() < 0.2, "{orders:?}");
    }
}
