//! Coefficients of the fourth-order boundary closure, [`compute_fourth_order_ghosts`].

#[cfg(doc)]
use super::compute_fourth_order_ghosts;
use crate::simd::{Number, Real, Vector};
use crate::solid::cell::CellConstants;

/// Reflecting closure: corrections of the flux divided by 1 − C, by flux, power of C and difference. Fluxes: arriving
/// wave at the last interior face and at the boundary, leaving wave at the last interior face. Differences: those of
/// the unfolded arriving wave over the two outermost cells and their two images, from the interior outwards.
pub(super) const REFLECTING_FLUX_COEFFICIENTS: [[[f64; 3]; 4]; 3] = [
    [
        [-0.020542, -0.082548, 0.066958],
        [-0.04781, -0.293982, 0.387252],
        [-1.061536, 1.881096, -1.321698],
        [0.833778, -1.02964, 0.880974],
    ],
    [
        [0.15665, -0.068548, -0.1103],
        [0.123486, 0.097652, -0.031454],
        [1.179124, -2.385758, 1.03048],
        [-1.56615, 2.452018, -0.87399],
    ],
    [
        [-0.077896, 0.134494, -0.011028],
        [0.258254, -0.701944, -0.190086],
        [-2.583206, 4.883552, -0.457988],
        [3.354494, -5.74239, 0.598212],
    ],
];

/// Non-reflecting closure: face value minus mean of the upwind cell, divided by 1 − C, by face, power of C and
/// difference. Faces: last interior face and boundary (arriving wave), last interior face (leaving wave). Differences:
/// those between the three outermost cells, in the direction of propagation.
pub(super) const OPEN_FACE_COEFFICIENTS: [[[f64; 2]; 3]; 3] = [
    [[1.0 / 12.0, 0.33211 + 1.0 / 12.0], [0.25089, -0.24095], [-0.0514, 0.02737]],
    [[0.0, 0.40692], [-0.25572, 0.25506], [0.24459, -0.22165]],
    [[0.5, -1.0 / 12.0], [0.12798, -0.15611], [-0.02068, 0.03919]],
];

/// Evaluates polynomials in the Courant number; `coefficients` by power, from the constant term on.
#[inline(always)]
fn evaluate_polynomials<N: Number, const POWERS: usize, const COUNT: usize>(
    coefficients: &[[f64; COUNT]; POWERS],
    courant: N,
) -> [N; COUNT] {
    let mut values = [N::ZERO; COUNT];
    for power in coefficients.iter().rev() {
        for (value, coefficient) in values.iter_mut().zip(power) {
            *value = *value * courant + N::from_f64(*coefficient);
        }
    }
    values
}

/// Coefficients of [`compute_fourth_order_ghosts`]: corrections of the ghost values per difference beside the boundary.
/// They depend only on the Courant number C of the outermost cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GhostCoefficients<N> {
    /// 0 for 1 − C ≤ 10⁻⁶ (exact shift by one cell at C = 1, no correction), else 1.
    pub(super) correction_flag: N,
    /// Reflecting boundary, per difference: arriving wave in the nearest and in the farther ghost, then leaving wave in
    /// both; the weights of the leaving wave are also per reflection coefficient.
    pub(super) reflecting_weights: [[N; 3]; 4],
    /// Non-reflecting boundary, per difference of the two: arriving wave in both ghosts, leaving wave in the nearest
    /// ghost; last row: leaving wave in the farther ghost, from its values in the nearest ghost and in the outermost
    /// cell, and from its difference between the two outermost cells.
    pub(super) open_weights: [[N; 3]; 4],
    /// Non-reflecting boundary beside several media: coefficient that cancels the upwind difference in the farther
    /// ghost.
    pub(super) upwind_cancellation: N,
}

impl<N: Number> GhostCoefficients<N> {
    #[inline(always)]
    pub(crate) fn new(cell: &CellConstants<N>) -> Self {
        let one_minus_courant = cell.one_minus_courant();
        let courant = N::ONE - one_minus_courant;
        let clamped_one_minus_courant = (one_minus_courant - N::from_f64(1e-6)).max(N::ZERO);
        let per_staying = N::ONE / one_minus_courant.max(N::from_f64(1e-6));
        // Reconstruction weights of fourth order divided by 1 − C.
        let twelfth = N::from_f64(1.0 / 12.0);
        let upwind = N::HALF * twelfth * (N::ONE + courant) * (N::ONE + N::ONE + courant);
        let central = N::HALF - twelfth * courant * (N::ONE + courant);
        let downwind = -(N::HALF * twelfth * (N::ONE + courant) * (N::ONE + N::ONE - courant));
        let (per_upwind, per_downwind) = (N::ONE / upwind, N::ONE / downwind);
        let passed = N::ONE + cell.upwind_weight - cell.central_weight;

        // Ghosts are downwind of the boundary for the arriving wave and upwind of it for the leaving wave.
        let [interior_flux, boundary_flux, leaving_flux] = [
            evaluate_polynomials(&REFLECTING_FLUX_COEFFICIENTS[0], courant),
            evaluate_polynomials(&REFLECTING_FLUX_COEFFICIENTS[1], courant),
            evaluate_polynomials(&REFLECTING_FLUX_COEFFICIENTS[2], courant),
        ];
        let mut reflecting_weights = [[N::ZERO; 3]; 4];
        for i in 0..3 {
            let out = interior_flux[i] * per_downwind;
            let back = -(leaving_flux[i] * per_upwind);
            reflecting_weights[0][i] = out;
            reflecting_weights[1][i] = out + (boundary_flux[i] - central * out) * per_downwind;
            reflecting_weights[2][i] = back;
            reflecting_weights[3][i] =
                (passed * back * per_staying - boundary_flux[i]) * per_upwind;
        }

        let [face, boundary, back] = [
            evaluate_polynomials(&OPEN_FACE_COEFFICIENTS[0], courant),
            evaluate_polynomials(&OPEN_FACE_COEFFICIENTS[1], courant),
            evaluate_polynomials(&OPEN_FACE_COEFFICIENTS[2], courant),
        ];
        let next = [(face[0] - upwind) * per_downwind, (face[1] - central) * per_downwind, N::ZERO];
        let farther = [
            next[0] + (boundary[0] - central * next[0]) * per_downwind,
            next[1] + (boundary[1] - upwind - central * next[1]) * per_downwind,
            N::ZERO,
        ];
        let back = [(central - back[0]) * per_upwind, (downwind - back[1]) * per_upwind, N::ZERO];
        let per_staying_upwind = per_staying * per_upwind;
        let from_next = [
            N::ONE + per_staying_upwind * (N::ONE - cell.central_weight),
            per_staying_upwind * cell.central_weight,
            per_staying_upwind * cell.downwind_weight,
        ];
        Self {
            correction_flag: (clamped_one_minus_courant * (N::ONE / N::MIN_POSITIVE)).min(N::ONE),
            reflecting_weights,
            open_weights: [next, farther, back, from_next],
            upwind_cancellation: upwind * per_downwind,
        }
    }

    const ZEROS: Self = Self {
        correction_flag: N::ZERO,
        upwind_cancellation: N::ZERO,
        reflecting_weights: [[N::ZERO; 3]; 4],
        open_weights: [[N::ZERO; 3]; 4],
    };

    /// Loads the coefficients of a group of lanes.
    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &GhostCoefficients<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        let mut coefficients = Self {
            correction_flag: N::load(&from.correction_flag),
            upwind_cancellation: N::load(&from.upwind_cancellation),
            ..Self::ZEROS
        };
        for form in 0..4 {
            for i in 0..3 {
                coefficients.reflecting_weights[form][i] =
                    N::load(&from.reflecting_weights[form][i]);
                coefficients.open_weights[form][i] = N::load(&from.open_weights[form][i]);
            }
        }
        coefficients
    }

    /// Stores the coefficients as a group of lanes.
    #[inline(always)]
    pub(crate) fn to_lanes<T: Real>(self) -> GhostCoefficients<T::Lanes>
    where
        N: Vector<T>,
    {
        let mut group = GhostCoefficients::ZEROS;
        self.correction_flag.store(&mut group.correction_flag);
        self.upwind_cancellation.store(&mut group.upwind_cancellation);
        for form in 0..4 {
            for i in 0..3 {
                self.reflecting_weights[form][i].store(&mut group.reflecting_weights[form][i]);
                self.open_weights[form][i].store(&mut group.open_weights[form][i]);
            }
        }
        group
    }
}
