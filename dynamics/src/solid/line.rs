//! Sweep of a wave pair along a line of cells: Godunov-type predictor–corrector on characteristic variables.
//!
//! In a cell of impedance z and Courant number C = cΔt/h ≤ 1 the pair
//!
//! ```text
//! m v̇ = ∂s,    ṡ = M ∂v
//! ```
//!
//! of velocity v and stress s, with inertia m and modulus M, has two waves: s − zv is right-going, s + zv left-going.
//! The time-averaged waves at a face are reconstructed from the cells around it; velocity and stress at the face are
//! continuous (Riemann problem),
//!
//! ```text
//! s* − z_L v* = (s − zv)_L,    s* + z_R v* = (s + zv)_R,
//! ```
//!
//! and the cells are updated with the fluxes of their faces (Godunov 1959; van Leer 1979). The sweep is exact for C =
//! 1, between cells of the same constants and at material interfaces; for C < 1 it has the order of the reconstruction,
//! [`Slopes`].
//!
//! The [`SweepAccount`] holds the work and the dissipation of the sweep, computed by cell from the fluxes.
//!
//! The formulas are generic over [`Number`](crate::simd::Number): [`sweep`] applies them to one line, cell by cell,
//! with the account; the kernel of [`crate::solid::domain`] applies them to many lines at once.

pub use super::cell::CellConstants;
pub use super::reconstruction::{GHOSTS, HALO, Slopes, WideOrder};
use super::riemann::{InterfaceState, State, update_cell};
use super::wide_stencil;
use crate::simd::Real;

/// Energy account of a sweep, W per m² of the cross-section of the line; multiplied by the time step, J/m².
///
/// With the energy of a cell in the same unit, h(½mv² + ½s²/M)/Δt = (zv² + s²/z)/(2C), energy after the sweep − energy
/// before = boundary work − dissipation, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SweepAccount {
    /// Work at the ends of the line, positive inwards: mean stress × mean velocity over the step.
    pub boundary_work: f64,
    /// Numerical dissipation. A wave w of a cell with fluxes F₋ and F₊ through its lower and upper face loses ±(F₊ −
    /// F₋)((w + w′) − (F₊ + F₋))/(4z), with + for the right-going wave and the wave w′ after the step. In the
    /// fourth-order scheme this may be negative in a cell, but the sum over all cells is not.
    pub dissipation: f64,
}

/// Sum of the accounts of several cells.
impl<'a> std::iter::Sum<&'a Self> for SweepAccount {
    fn sum<I: Iterator<Item = &'a Self>>(accounts: I) -> Self {
        accounts.fold(Self::default(), |sum, own| Self {
            boundary_work: sum.boundary_work + own.boundary_work,
            dissipation: sum.dissipation + own.dissipation,
        })
    }
}

/// Computes the face values of the right-going and the left-going wave from the four cells around a face; `continuity`
/// of the three faces between the cells is 0 at interlayers and 1 at other faces.
pub(super) fn face_values<T: Real>(
    states: [State<T>; 4],
    cells: [&CellConstants<T>; 4],
    continuity: [T; 3],
    slopes: Slopes,
) -> [T; 2] {
    let [first, left, right, _] = cells;
    let left_stencil = [states[0], states[1], states[2]];
    let carried_invariants = slopes.carried_invariants(
        left_stencil,
        [first, left, right],
        [continuity[0], continuity[1]],
    );
    let right_stencil = [states[1], states[2], states[3]];
    slopes.face_values_in_mixed_media(carried_invariants, right_stencil, cells, Some(continuity)).0
}

/// Computes the interface states of a face for its left and its right cell, from the two cells on either side.
fn solve_face<T: Real>(
    states: [State<T>; 4],
    cells: [&CellConstants<T>; 4],
    slopes: Slopes,
) -> [InterfaceState<T>; 2] {
    let impedance = [cells[1].impedance, cells[2].impedance];
    InterfaceState::riemann(impedance, face_values(states, cells, [T::ONE; 3], slopes))
}

/// Computes mean stress × mean velocity over the step at a face of a cell, W/m².
fn face_power<T: Real>(lower_face: &InterfaceState<T>, cell: &CellConstants<T>) -> f64 {
    lower_face.sum.to_f64() * lower_face.difference.to_f64() / (4.0 * cell.impedance.to_f64())
}

/// Computes mean stress × mean velocity over the step at the face in the middle of the cells of its stencil
/// (2 × [`Slopes::ghosts`]), W/m²; positive towards the first of them. Exact at boundaries with prescribed velocity or traction, where one factor is constant over the
/// step; at non-reflecting boundaries the correlation within the step is neglected.
pub(crate) fn boundary_power<T: Real>(
    stencil: impl Fn(usize) -> (State<T>, CellConstants<T>),
    slopes: Slopes,
) -> f64 {
    let (lower, upper) = (slopes.ghosts() - 1, slopes.ghosts());
    let cell = stencil(lower).1;
    let state = |place: usize| stencil(place).0;
    let faces = match slopes {
        Slopes::Wide(WideOrder::Sixth) => {
            wide_stencil::solve_face::<T, 6>(std::array::from_fn(state), &stencil(upper).1)
        }
        Slopes::Wide(WideOrder::Eighth) => {
            wide_stencil::solve_face::<T, 8>(std::array::from_fn(state), &stencil(upper).1)
        }
        Slopes::Godunov | Slopes::Limited | Slopes::FourthOrder => {
            let cells: [CellConstants<T>; 4] = std::array::from_fn(|place| stencil(place).1);
            solve_face(std::array::from_fn(state), cells.each_ref(), slopes)
        }
    };
    face_power(&faces[0], &cell)
}

/// Advances a wave pair by a step along a line whose first and last cells are ghosts, as many as [`Slopes::ghosts`]
/// states. Adds the account of each interior cell to `accounts`, if given; the work at the ends is assigned to the
/// outermost interior cells.
///
/// All slices have the same length, that of the interior and the ghosts; `accounts` has that of the interior. Lines
/// without interior cells are not changed. With a wide stencil all cells have the same constants.
pub fn sweep<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    slopes: Slopes,
    accounts: Option<&mut [SweepAccount]>,
) {
    match slopes {
        Slopes::Wide(WideOrder::Sixth) => {
            return wide_stencil::sweep::<T, 6>(velocity, stress, cells, accounts);
        }
        Slopes::Wide(WideOrder::Eighth) => {
            return wide_stencil::sweep::<T, 8>(velocity, stress, cells, accounts);
        }
        Slopes::Godunov | Slopes::Limited | Slopes::FourthOrder => {}
    }
    let at_face =
        |states: [State<T>; 4], cells: [&CellConstants<T>; 4], _| solve_face(states, cells, slopes);
    advance(velocity, stress, cells, at_face, accounts);
}

/// Advances a wave pair as [`sweep`] does, with interface states from `at_face`, which is called once per face, in
/// ascending order, with the states and constants of the W cells around the face and the index of the cell above it.
pub(super) fn advance<T: Real, const W: usize>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    mut at_face: impl FnMut([State<T>; W], [&CellConstants<T>; W], usize) -> [InterfaceState<T>; 2],
    mut accounts: Option<&mut [SweepAccount]>,
) {
    let length = cells.len().min(velocity.len()).min(stress.len());
    let ghosts = W / 2;
    if length <= 2 * ghosts {
        return;
    }
    let (first, end) = (ghosts, length - ghosts);
    let state = |velocity: &[T], stress: &[T], index: usize| State {
        velocity: velocity[index],
        stress: stress[index],
    };
    // Evaluates the lower face of cell `index` from the states before the step.
    let mut lower_face_of = |states: [State<T>; W], index: usize| {
        let stencil = std::array::from_fn(|i| &cells[index - ghosts + i]);
        at_face(states, stencil, index)
    };
    let mut stencil: [State<T>; W] = std::array::from_fn(|i| state(velocity, stress, i));
    let mut left = lower_face_of(stencil, first);
    for index in first..end {
        let cell_state = stencil[ghosts];
        stencil.rotate_left(1);
        stencil[W - 1] = state(velocity, stress, index + ghosts);
        let right = lower_face_of(stencil, index + 1);
        let updated = update_cell(cell_state, [left[1], right[0]], &cells[index]);
        (velocity[index], stress[index]) = (updated.velocity, updated.stress);
        if let Some(account) = accounts.as_deref_mut().and_then(|all| all.get_mut(index - first)) {
            if index == first {
                account.boundary_work -= face_power(&left[1], &cells[index]);
            }
            if index + 1 == end {
                account.boundary_work += face_power(&right[0], &cells[index]);
            }
            account.dissipation +=
                cell_dissipation([cell_state, updated], [&left[1], &right[0]], &cells[index]);
        }
        left = right;
    }
}

/// Computes the numerical dissipation of a cell, W/m², from its states before and after the step and the states of its
/// left and right face.
fn cell_dissipation<T: Real>(
    states: [State<T>; 2],
    [left, right]: [&InterfaceState<T>; 2],
    cell: &CellConstants<T>,
) -> f64 {
    let z = cell.impedance.to_f64();
    // Sign −1: right-going wave s − zv; sign 1: left-going wave s + zv.
    let by_wave = |sign: f64| {
        let wave = |own: State<T>| own.stress.to_f64() + sign * z * own.velocity.to_f64();
        let flux = |lower_face: &InterfaceState<T>| {
            0.5 * (lower_face.sum.to_f64() + sign * lower_face.difference.to_f64())
        };
        let (left, right) = (flux(left), flux(right));
        let outflow = -sign * (right - left);
        outflow * ((wave(states[0]) + wave(states[1])) - (left + right))
    };
    (by_wave(-1.0) + by_wave(1.0)) / (4.0 * z)
}

/// Computes the energy of the interior cells of a line, in the unit of [`SweepAccount`]; cells with Courant number 0
/// are left out.
pub fn energy<T: Real>(velocity: &[T], stress: &[T], cells: &[CellConstants<T>]) -> f64 {
    let inner = GHOSTS..cells.len().saturating_sub(GHOSTS);
    inner
        .filter(|&i| cells[i].half_courant != T::ZERO)
        .map(|i| {
            let (z, c) = (cells[i].impedance.to_f64(), cells[i].courant().to_f64());
            let (v, s) = (velocity[i].to_f64(), stress[i].to_f64());
            (z * v * v + s * s / z) / (2.0 * c)
        })
        .sum()
}
