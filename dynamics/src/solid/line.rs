//! One pair of fields along a line of cells and joints: a Godunov-type predictor–corrector on
//! characteristic variables.
//!
//! In a cell of impedance z and Courant number C = cΔt/h ≤ 1 the pair
//!
//! ```text
//! m v̇ = ∂s,    ṡ = M ∂v
//! ```
//!
//! is two waves: s − zv runs to greater x, s + zv to smaller x. Of each the mean over the step of what reaches a face is
//! reconstructed from the cells around it; velocity and stress at the face are the same from both sides,
//!
//! ```text
//! s* − z_L v* = (s − zv)_L,    s* + z_R v* = (s + zv)_R,
//! ```
//!
//! and the cells change by the fluxes of their faces (Godunov 1959; van Leer 1979). Exact for C = 1 where cells
//! meet cells of their kind or steps in the medium; for C < 1 of the order of the reconstruction, [`Slopes`].
//!
//! The [`Account`] holds what the step does to the energy, cell by cell and from the fluxes.
//!
//! The formulas are generic over [`Number`](crate::simd::Number): [`sweep`] applies them to a line, cell by cell, and keeps
//! the account; the kernel of [`crate::solid::domain`] applies them to many lines at once.

pub use super::cell::CellConstants;
pub use super::reconstruction::{GHOSTS, HALO, Slopes};
use super::riemann::{InterfaceState, State, updated};
use crate::simd::Real;

/// What a sweep does to energy, W/m² of the line's cross-section: times the time step J/m².
///
/// With the energy of a cell in the same unit, h(½mv² + ½s²/M)/Δt = (zv² + s²/z)/(2C):
/// energy after − energy before = inflow − dissipated, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Work at the ends of the line, positive inwards: of the mean stress over the step on the mean velocity.
    pub inflow: f64,
    /// What the scheme itself dissipates. A wave w that a cell changes by the fluxes F of its two faces loses
    /// (F₊ − F₋)((w + w′) − (F₊ + F₋))/4z there, w′ being the wave after the step: of the fourth order this may be
    /// negative in a cell, but not in all of them together.
    pub dissipated: f64,
}

/// By cell.
impl<'a> std::iter::Sum<&'a Self> for Account {
    fn sum<I: Iterator<Item = &'a Self>>(accounts: I) -> Self {
        accounts.fold(Self::default(), |sum, own| Self {
            inflow: sum.inflow + own.inflow,
            dissipated: sum.dissipated + own.dissipated,
        })
    }
}

/// The face values of the waves from the left and from the right of a face, from the four cells around it, where
/// `joined` is 0 at interlayers and 1 at other faces.
pub(super) fn face_values<T: Real>(
    states: [State<T>; 4],
    cells: [&CellConstants<T>; 4],
    joined: [T; 3],
    slopes: Slopes,
) -> [T; 2] {
    let [first, left, right, _] = cells;
    let in_front = [states[0], states[1], states[2]];
    let known = slopes.known(in_front, [first, left, right], [joined[0], joined[1]]);
    let around = [states[1], states[2], states[3]];
    slopes.face_values_beside_interlayers(known, around, cells, joined).0
}

/// The interface states of a face for the cells at its left and right, from the four cells around it.
fn face<T: Real>(
    states: [State<T>; 4],
    cells: [&CellConstants<T>; 4],
    slopes: Slopes,
) -> [InterfaceState<T>; 2] {
    let impedance = [cells[1].impedance, cells[2].impedance];
    InterfaceState::riemann(impedance, face_values(states, cells, [T::ONE; 3], slopes))
}

/// Mean stress times mean velocity over the step, W/m².
fn work<T: Real>(lower_face: &InterfaceState<T>, cell: &CellConstants<T>) -> f64 {
    lower_face.sum.wide() * lower_face.difference.wide() / (4.0 * cell.impedance.wide())
}

/// Mean stress times mean velocity over the step at the face in the middle of four cells, W/m²; positive
/// towards the first of them. Exact at driven boundaries, where one factor is constant in time; at
/// non-reflecting ones the correlation within the step is neglected.
pub(crate) fn work_between<T: Real>(
    states: [State<T>; 4],
    cells: [CellConstants<T>; 4],
    slopes: Slopes,
) -> f64 {
    work(&face(states, cells.each_ref(), slopes)[0], &cells[1])
}

/// Advances a pair of fields by a step along a line whose first and last [`GHOSTS`] cells are ghosts,
/// and adds to the accounts of the other cells, if there are any; work at the ends goes to the outermost.
///
/// All slices have one length, of at least 2·[`GHOSTS`] + 1, `accounts` one of so many less; lines that
/// are shorter are left as they are.
pub fn sweep<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    slopes: Slopes,
    accounts: Option<&mut [Account]>,
) {
    let at_face =
        |states: [State<T>; 4], cells: [&CellConstants<T>; 4], _| face(states, cells, slopes);
    advance(velocity, stress, cells, at_face, accounts);
}

/// [`sweep`] with the interface states that `at_face` gives for the lower face of a cell, from the states and constants of
/// the four cells around the face and the place of that cell: called once for each face, in ascending order.
pub(super) fn advance<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[CellConstants<T>],
    mut at_face: impl FnMut([State<T>; 4], [&CellConstants<T>; 4], usize) -> [InterfaceState<T>; 2],
    mut accounts: Option<&mut [Account]>,
) {
    let length = cells.len().min(velocity.len()).min(stress.len());
    if length <= 2 * GHOSTS {
        return;
    }
    let (first, end) = (GHOSTS, length - GHOSTS);
    let state = |velocity: &[T], stress: &[T], place: usize| State {
        velocity: velocity[place],
        stress: stress[place],
    };
    // The lower face of the cell at a place, from old states.
    let mut lower_face_of = |states: [State<T>; 4], place: usize| {
        let around = std::array::from_fn(|i| &cells[place - 2 + i]);
        at_face(states, around, place)
    };
    let mut around: [State<T>; 4] = std::array::from_fn(|i| state(velocity, stress, first - 2 + i));
    let mut left = lower_face_of(around, first);
    for place in first..end {
        let own = around[2];
        around = [around[1], own, around[3], state(velocity, stress, place + 2)];
        let right = lower_face_of(around, place + 1);
        let moved = updated(own, [left[1], right[0]], &cells[place]);
        (velocity[place], stress[place]) = (moved.velocity, moved.stress);
        if let Some(account) = accounts.as_deref_mut().and_then(|all| all.get_mut(place - first)) {
            if place == first {
                account.inflow -= work(&left[1], &cells[place]);
            }
            if place + 1 == end {
                account.inflow += work(&right[0], &cells[place]);
            }
            account.dissipated += dissipated([own, moved], [&left[1], &right[0]], &cells[place]);
        }
        left = right;
    }
}

/// What a cell dissipates by its states before and after, and the faces at its left and at its right.
fn dissipated<T: Real>(
    states: [State<T>; 2],
    [left, right]: [&InterfaceState<T>; 2],
    cell: &CellConstants<T>,
) -> f64 {
    let z = cell.impedance.wide();
    // s − zv with sign −1, s + zv with sign 1.
    let by_wave = |sign: f64| {
        let wave = |own: State<T>| own.stress.wide() + sign * z * own.velocity.wide();
        let flux = |lower_face: &InterfaceState<T>| {
            0.5 * (lower_face.sum.wide() + sign * lower_face.difference.wide())
        };
        let (left, right) = (flux(left), flux(right));
        let outflow = -sign * (right - left);
        outflow * ((wave(states[0]) + wave(states[1])) - (left + right))
    };
    (by_wave(-1.0) + by_wave(1.0)) / (4.0 * z)
}

/// The energy of the cells of a line without its ghosts, in the unit of the [`Account`].
pub fn energy<T: Real>(velocity: &[T], stress: &[T], cells: &[CellConstants<T>]) -> f64 {
    let inner = GHOSTS..cells.len().saturating_sub(GHOSTS);
    inner
        .filter(|&i| cells[i].half_courant != T::ZERO)
        .map(|i| {
            let (z, c) = (cells[i].impedance.wide(), cells[i].courant().wide());
            let (v, s) = (velocity[i].wide(), stress[i].wide());
            (z * v * v + s * s / z) / (2.0 * c)
        })
        .sum()
}
