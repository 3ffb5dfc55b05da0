//! One pair of fields along a line of cells and joints: a Godunov-type predictor–corrector on
//! characteristic variables.
//!
//! In a cell of impedance z and Courant number C = cΔt/h ≤ 1 the pair
//!
//! ```text
//! m v̇ = ∂s,    ṡ = M ∂v
//! ```
//!
//! is two waves: s − zv runs to greater x, s + zv to smaller x. Each is reconstructed as a straight piece
//! per cell with a limited slope, followed exactly to the joints, where velocity and stress are the same
//! from both sides,
//!
//! ```text
//! s* − z_L v* = (s − zv)_L,    s* + z_R v* = (s + zv)_R,
//! ```
//!
//! and averaged over the cells after the step (Godunov 1959; van Leer 1979). Exact for C = 1 where cells
//! meet cells of their kind or steps in the medium; of second order for C < 1, by [`Slopes::Godunov`] of
//! first.
//!
//! The [`Account`] holds what the step does to the energy, from the pieces themselves: averaging loses
//! their variance about the cell's mean, reconstruction adds the variance of the slopes. Neither is the
//! remainder of a balance.

use crate::real::Real;

/// Cells beyond each end of a line that a sweep reads.
pub const GHOSTS: usize = 2;

/// How waves are reconstructed in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// Constant: first order (Godunov 1959).
    Godunov,
    /// The mean of the differences to both sides, limited to twice the smaller of them and to zero at
    /// extrema (monotonised central, van Leer 1977): second order, no new extrema.
    Limited,
    /// The mean of the differences to both sides (Fromm 1968): second order.
    Unlimited,
}

impl Slopes {
    fn of<T: Real>(self, before: T, after: T) -> T {
        let mean = T::HALF * (before + after);
        match self {
            Self::Godunov => T::ZERO,
            Self::Unlimited => mean,
            Self::Limited => {
                let twice = |x: T| (x + x).abs();
                let size = mean.abs().least(twice(before)).least(twice(after));
                if before * after > T::ZERO {
                    if before > T::ZERO { size } else { -size }
                } else {
                    T::ZERO
                }
            }
        }
    }
}

/// What a cell is to a pair of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<T> {
    /// z, kg/(m²s) for translations.
    pub impedance: T,
    /// C = cΔt/h, in \[0, 1\].
    pub courant: T,
}

/// What a sweep does to energy, W/m² of the line's cross-section: times the time step J/m².
///
/// With the energy of a cell in the same unit, h(½mv² + ½s²/M)/Δt = (zv² + s²/z)/(2C):
/// energy after − energy before = inflow + gained − lost, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Work of the stress at both ends of the line over the step, positive inwards.
    pub inflow: f64,
    /// Variance of the reconstructed pieces.
    pub gained: f64,
    /// Variance of the pieces in each cell at the end of the step, which averaging takes away.
    pub lost: f64,
}

impl Account {
    /// Energy that the scheme itself dissipates.
    pub fn dissipated(&self) -> f64 {
        self.lost - self.gained
    }
}

/// Characteristic variables and their slopes in a cell: s − zv to the right, s + zv to the left.
#[derive(Clone, Copy)]
struct Pieces<T> {
    right: T,
    left: T,
    right_slope: T,
    left_slope: T,
}

/// Mean over the step and change during the step.
#[derive(Clone, Copy)]
struct Linear<T> {
    mean: T,
    change: T,
}

/// Velocity and stress at a joint.
#[derive(Clone, Copy)]
struct Joint<T> {
    velocity: Linear<T>,
    stress: Linear<T>,
}

fn pieces<T: Real>(
    velocity: &[T],
    stress: &[T],
    cell: Cell<T>,
    place: usize,
    slopes: Slopes,
) -> Pieces<T> {
    let z = cell.impedance;
    let right = |i: usize| stress[i] - z * velocity[i];
    let left = |i: usize| stress[i] + z * velocity[i];
    let [before, here, after] = [place - 1, place, place + 1];
    Pieces {
        right: right(here),
        left: left(here),
        // Both sides in the variables of this cell: v and s are continuous, z is not.
        right_slope: slopes.of(right(here) - right(before), right(after) - right(here)),
        left_slope: slopes.of(left(here) - left(before), left(after) - left(here)),
    }
}

/// The joint of two cells.
fn joint<T: Real>([left, right]: [(&Pieces<T>, Cell<T>); 2]) -> Joint<T> {
    let (own, cell) = left;
    let (other, next) = right;
    // What leaves a cell during the step is its foremost part of length C.
    let rest = |cell: Cell<T>| T::HALF * (T::ONE - cell.courant);
    let from_left = Linear {
        mean: own.right + rest(cell) * own.right_slope,
        change: -(cell.courant * own.right_slope),
    };
    let from_right = Linear {
        mean: other.left - rest(next) * other.left_slope,
        change: next.courant * other.left_slope,
    };
    let (z, y) = (cell.impedance, next.impedance);
    let velocity = |right: T, left: T| (left - right) / (z + y);
    let stress = |right: T, left: T| (y * right + z * left) / (z + y);
    Joint {
        velocity: Linear {
            mean: velocity(from_left.mean, from_right.mean),
            change: velocity(from_left.change, from_right.change),
        },
        stress: Linear {
            mean: stress(from_left.mean, from_right.mean),
            change: stress(from_left.change, from_right.change),
        },
    }
}

/// Advances a pair of fields by a step along a line whose first and last [`GHOSTS`] cells are ghosts,
/// and keeps the account of its energy if there is one.
///
/// All three slices have one length, of at least 2·[`GHOSTS`] + 1; shorter ones are left as they are.
pub fn sweep<T: Real>(
    velocity: &mut [T],
    stress: &mut [T],
    cells: &[Cell<T>],
    slopes: Slopes,
    mut account: Option<&mut Account>,
) {
    let length = cells.len().min(velocity.len()).min(stress.len());
    if length <= 2 * GHOSTS {
        return;
    }
    let (first, end) = (GHOSTS, length - GHOSTS);
    let ghost = pieces(velocity, stress, cells[first - 1], first - 1, slopes);
    let mut here = pieces(velocity, stress, cells[first], first, slopes);
    let mut left = joint([(&ghost, cells[first - 1]), (&here, cells[first])]);
    // A cell is written when its successor's pieces are known; these read the cell itself, too.
    let mut pending: Option<(usize, T, T)> = None;
    for place in first..end {
        let next = pieces(velocity, stress, cells[place + 1], place + 1, slopes);
        let right = joint([(&here, cells[place]), (&next, cells[place + 1])]);
        let Cell { impedance, courant } = cells[place];
        let v = velocity[place] + courant / impedance * (right.stress.mean - left.stress.mean);
        let s = stress[place] + courant * impedance * (right.velocity.mean - left.velocity.mean);
        if let Some(account) = account.as_deref_mut() {
            if place == first {
                account.inflow -= work(&left);
            }
            if place + 1 == end {
                account.inflow += work(&right);
            }
            note(account, &here, cells[place], &left, &right);
        }
        if let Some((place, v, s)) = pending.replace((place, v, s)) {
            (velocity[place], stress[place]) = (v, s);
        }
        (here, left) = (next, right);
    }
    if let Some((place, v, s)) = pending {
        (velocity[place], stress[place]) = (v, s);
    }
}

/// ∫ s v dt over the step, per Δt: both are straight in time.
fn work<T: Real>(joint: &Joint<T>) -> f64 {
    let product = |a: T, b: T| a.wide() * b.wide();
    product(joint.stress.mean, joint.velocity.mean)
        + product(joint.stress.change, joint.velocity.change) / 12.0
}

/// Adds what a cell gains and loses.
fn note<T: Real>(
    account: &mut Account,
    own: &Pieces<T>,
    cell: Cell<T>,
    left: &Joint<T>,
    right: &Joint<T>,
) {
    let (z, c) = (cell.impedance.wide(), cell.courant.wide());
    if c == 0.0 {
        // Nothing moves, and nothing is averaged.
        return;
    }
    // h·w²/(4M) per Δt.
    let unit = 0.25 / (z * c);
    let square = |x: f64| x * x;
    let slopes = square(own.right_slope.wide()) + square(own.left_slope.wide());
    account.gained += unit * slopes / 12.0;
    // What came in occupies C of the cell, what stayed the rest.
    let variance = |came: [f64; 2], stayed: [f64; 2]| {
        let rest = 1.0 - c;
        c * rest * square(came[0] - stayed[0])
            + (c * square(came[1]) + rest * square(stayed[1])) / 12.0
    };
    let incoming = |joint: &Joint<T>, sign: f64| {
        let value = |s: T, v: T| s.wide() + sign * z * v.wide();
        [
            value(joint.stress.mean, joint.velocity.mean),
            value(joint.stress.change, joint.velocity.change),
        ]
    };
    let stayed = |value: T, slope: T, sign: f64| {
        [value.wide() - sign * 0.5 * c * slope.wide(), (1.0 - c) * slope.wide()]
    };
    account.lost += unit
        * (variance(incoming(left, -1.0), stayed(own.right, own.right_slope, 1.0))
            + variance(incoming(right, 1.0), stayed(own.left, own.left_slope, -1.0)));
}

/// The energy of the cells of a line without its ghosts, in the unit of the [`Account`].
pub fn energy<T: Real>(velocity: &[T], stress: &[T], cells: &[Cell<T>]) -> f64 {
    let inner = GHOSTS..cells.len().saturating_sub(GHOSTS);
    inner
        .filter(|&i| cells[i].courant != T::ZERO)
        .map(|i| {
            let (z, c) = (cells[i].impedance.wide(), cells[i].courant.wide());
            let (v, s) = (velocity[i].wide(), stress[i].wide());
            (z * v * v + s * s / z) / (2.0 * c)
        })
        .sum()
}
