//! Reconstruction: time-averaged characteristic variables at faces from cell averages. First order (Godunov 1959),
//! limited piecewise linear (van Leer 1977; Roe 1985), or linear fourth order (Strang 1962).
//!
//! The limiter (case key `order = "eno2"`) is [`Slopes::half_slope_correction`], with tighter bounds beside other media.
//! `ghosts` derives its closure from the energy bounds of this limiter, and `tests/solid/energy.rs` searches for states in
//! which energy grows: a new limiter needs both.

use super::cell::CellConstants;
use super::riemann::{RiemannInvariants, State};
use crate::simd::{Number, Real};
use models::solid::waves::Pair;

/// Number of ghost cells beyond each end of a line.
pub const GHOSTS: usize = 2;

/// Width of the halo along a cut axis, in cells per step of a pass: each of the two sweeps of a step along an axis
/// reads [`GHOSTS`] cells beyond those it updates.
pub const HALO: usize = 2 * GHOSTS;

/// Reconstruction in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// Piecewise constant: first order (Godunov 1959).
    Godunov,
    /// Piecewise linear, monotonised central limiter (van Leer 1977) with bounds that depend on the Courant number (Roe
    /// 1985); the usual bounds, twice the smaller difference, clip smooth extrema more. Second order in smooth monotone
    /// regions.
    Limited,
    /// Unlimited linear fourth-order scheme: cubic interpolation of the integral of the wave over the four cells around
    /// a face, two of them upwind; the most accurate scheme on this stencil (Strang 1962). Overshoots at
    /// discontinuities.
    FourthOrder,
}

impl Slopes {
    /// Constants of a cell for a wave pair. The Courant number may exceed 1 by rounding. `is_mixed`: whether the
    /// problem has several media or interlayers.
    pub(crate) fn cell_of<T: Real>(
        self,
        pair: &Pair,
        courant: f64,
        is_mixed: bool,
    ) -> CellConstants<T> {
        let (impedance, courant) = (pair.impedance(), courant.min(1.0));
        match (self, is_mixed) {
            (Self::Godunov, _) => CellConstants::constant(impedance, courant),
            (Self::FourthOrder, true) => CellConstants::among_others(impedance, courant),
            _ => CellConstants::new(impedance, courant),
        }
    }

    /// Time-averaged outflow minus cell mean of a piecewise linear reconstruction: (1 − C)/2 × limited slope, from the
    /// upwind and downwind differences.
    ///
    /// With corrections l, a wave w in cell i becomes w − C(w + l − w′ − l′), w′ and l′ being those of the upwind cell.
    /// With d = w − w′, corrections of the sign of d with |l| ≤ |d|(1 − C)/C (Roe 1985) and |l′| ≤ |d| make the update
    /// a convex combination of w and w′, hence TVD (Harten 1983).
    #[inline(always)]
    pub(crate) fn half_slope_correction<N: Number>(
        self,
        [upwind, downwind]: [N; 2],
        cell: &CellConstants<N>,
    ) -> N {
        let mean = cell.mean_slope * (upwind + downwind);
        match self {
            Self::Limited => mean.minmod3(cell.steepest * upwind, downwind),
            Self::Godunov | Self::FourthOrder => N::ZERO,
        }
    }

    /// [`Self::half_slope_correction`] in a cell next to a cell of another impedance or Courant number (`contrast` 1)
    /// or not (0). At contrasts the limited half slope is ⅜(1 − C) minmod of the differences: the bounds for one
    /// medium, and ½ in place of ⅜, allow energy growth there (`tests/solid/energy.rs` finds such states).
    #[inline(always)]
    fn half_slope_correction_at_contrast<N: Number>(
        self,
        [upwind, downwind]: [N; 2],
        cell: &CellConstants<N>,
        contrast: N,
    ) -> N {
        let mean = cell.mean_slope * (upwind + downwind);
        match self {
            Self::Limited => {
                let most = cell.mean_slope + N::HALF * cell.mean_slope;
                let steepest = cell.steepest + contrast * (most - cell.steepest);
                let foremost = N::ONE + contrast * (most - N::ONE);
                mean.minmod3(steepest * upwind, foremost * downwind)
            }
            Self::Godunov | Self::FourthOrder => N::ZERO,
        }
    }

    /// Returns the stencil data of cell i + 1: its invariants (fourth order), else the difference to it.
    #[inline(always)]
    pub(crate) fn ahead<N: Number>(
        self,
        own: RiemannInvariants<N>,
        next: RiemannInvariants<N>,
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder => next,
            Self::Godunov | Self::Limited => own.difference(next),
        }
    }

    /// Returns the stencil data of cell i − 1: its invariants (fourth order), else the difference from it.
    #[inline(always)]
    pub(crate) fn behind<N: Number>(
        self,
        last: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder => last,
            Self::Godunov | Self::Limited => last.difference(own),
        }
    }

    /// Computes the left and right state of the Riemann problem at the lower face of cell i, in one medium: s − zv and
    /// s + zv, averaged over the step. Also returns the stencil data `known` for the next face.
    ///
    /// `known`: the invariants of cell i − 2 (fourth order), else the left state. `own`: the invariants of cell i.
    /// `behind`, `ahead`: results of [`Self::behind`] and [`Self::ahead`].
    #[inline(always)]
    pub(crate) fn face_values<N: Number>(
        self,
        known: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
        [behind, ahead]: [RiemannInvariants<N>; 2],
        cell: &CellConstants<N>,
    ) -> ([N; 2], RiemannInvariants<N>) {
        match self {
            Self::FourthOrder => {
                let right = cell.face_value([known.right, behind.right, own.right, ahead.right]);
                let left = cell.face_value([ahead.left, own.left, behind.left, known.left]);
                ([right, left], behind)
            }
            Self::Godunov | Self::Limited => {
                let pieces = Reconstruction::new(own, [behind, ahead], cell, self);
                ([known.right, pieces.to_left()], pieces.known())
            }
        }
    }

    /// [`Self::face_values`] for cells i − 2 … i + 1 of any media.
    #[inline(always)]
    pub(crate) fn face_values_between_media<N: Number>(
        self,
        known: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 4],
    ) -> ([N; 2], RiemannInvariants<N>) {
        self.face_values_beside_interlayers(known, states, cells, [N::ONE; 3])
    }

    /// [`Self::face_values_between_media`] with interlayers at some of the three faces between the cells: `joined` is 0
    /// at interlayers and 1 at other faces. The stencil does not extend across an interlayer: differences across it are
    /// zero (constant extrapolation), and the cells on its two sides count as different media. Then no wave gains
    /// energy for any response of the interlayer (tests of [`crate::solid::interface`]).
    #[inline(always)]
    pub(crate) fn face_values_beside_interlayers<N: Number>(
        self,
        known: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 4],
        [joined_behind, joined_here, joined_after]: [N; 3],
    ) -> ([N; 2], RiemannInvariants<N>) {
        let [behind, here, next] = states;
        let [cell_before, cell_behind, cell, cell_after] = cells;
        match self {
            Self::FourthOrder => {
                let (own_behind, own) =
                    (RiemannInvariants::of(behind, cell_behind), RiemannInvariants::of(here, cell));
                let next = RiemannInvariants::of(next, cell_after);
                let reflection = cell_behind.reflection(cell);
                let first = own_behind
                    .transmitted(known, cell_behind.reflection(cell_before))
                    .difference(own_behind)
                    .scaled(joined_behind);
                let before = own.transmitted(own_behind, -reflection).difference(own);
                let before = before.scaled(joined_here);
                let after = own.difference(own.transmitted(next, cell.reflection(cell_after)));
                let after = after.scaled(joined_after);
                // At a material interface the outgoing waves differ from the scattered incoming ones. Mapped back
                // through the scattering matrix, this gives an additional difference for the stencil.
                let beyond = own_behind.transmitted(own, reflection);
                let right = cell.one_minus_courant() * before.right;
                let left = joined_here
                    * (cell_behind.one_minus_courant() * (own_behind.left - beyond.left));
                let across = RiemannInvariants {
                    right: right + reflection * (left - right),
                    left: left + reflection * (left - right),
                };
                let [to_first, to_middle, to_last] = CellConstants::alike(cells);
                let to_first = joined_behind * to_first;
                let to_middle = joined_here * to_middle;
                let to_last = joined_after * to_last;
                let alike = [to_first, to_middle, to_last];
                let (weights, weight) = cell_behind.weights(alike);
                let right = own_behind.right + weight * across.right;
                let right =
                    corrected_right(right, weights, [first.right, before.right, after.right]);
                let (weights, weight) = cell.weights([to_last, to_middle, to_first]);
                let left = own.left + weight * across.left;
                let left = corrected_left(left, weights, [after.left, before.left, first.left]);
                // In one medium, identical to `face_values` bit for bit, signs of zeros included: +0 is subtracted.
                let of_one = to_first * to_middle * to_last;
                let rest = N::ONE - of_one;
                let to_right = [known.right, own_behind.right, own.right, next.right];
                let to_left = [next.left, own.left, own_behind.left, known.left];
                let right = of_one * cell_behind.face_value(to_right) - (N::ZERO - rest * right);
                let left = of_one * cell.face_value(to_left) - (N::ZERO - rest * left);
                ([right, left], own_behind)
            }
            Self::Godunov | Self::Limited => {
                let cells = [cell_behind, cell, cell_after];
                let joined = [joined_here, joined_after];
                let pieces = Reconstruction::of(states, cells, joined, self);
                ([known.right, pieces.to_left()], pieces.known())
            }
        }
    }

    /// Computes the stencil data for the first face of a line; see [`Self::face_values_beside_interlayers`].
    pub(crate) fn known<N: Number>(
        self,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 3],
        joined: [N; 2],
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder => RiemannInvariants::of(states[0], cells[0]),
            Self::Godunov | Self::Limited => {
                Reconstruction::of(states, cells, joined, self).known()
            }
        }
    }
}

/// Face value of the right-going wave: cell mean plus weighted differences, ordered from upwind to downwind.
#[inline(always)]
fn corrected_right<N: Number>(
    mean: N,
    [a, b, c]: [N; 3],
    [upwind, central, downwind]: [N; 3],
) -> N {
    mean + a * upwind + b * central + c * downwind
}

/// Face value of the left-going wave; the differences have the opposite sign.
#[inline(always)]
fn corrected_left<N: Number>(mean: N, [a, b, c]: [N; 3], [upwind, central, downwind]: [N; 3]) -> N {
    mean - a * upwind - b * central - c * downwind
}

/// Cell means of both invariants and their half-slope corrections.
#[derive(Clone, Copy)]
struct Reconstruction<N> {
    mean: RiemannInvariants<N>,
    half_slope: RiemannInvariants<N>,
}

impl<N: Number> Reconstruction<N> {
    /// In one medium, from the cell's invariants and the differences from cell i − 1 and to cell i + 1.
    #[inline(always)]
    fn new(
        mean: RiemannInvariants<N>,
        [before, after]: [RiemannInvariants<N>; 2],
        cell: &CellConstants<N>,
        slopes: Slopes,
    ) -> Self {
        let half_slope = RiemannInvariants {
            right: slopes.half_slope_correction([before.right, after.right], cell),
            left: slopes.half_slope_correction([after.left, before.left], cell),
        };
        Self { mean, half_slope }
    }

    /// In several media, from the states of cells i − 1, i and i + 1; `joined` is 0 at interlayers between them and 1
    /// at other faces.
    #[inline(always)]
    fn of(
        [before, own, after]: [State<N>; 3],
        [cell_before, cell, cell_after]: [&CellConstants<N>; 3],
        [joined_before, joined_after]: [N; 2],
        slopes: Slopes,
    ) -> Self {
        let mean = RiemannInvariants::of(own, cell);
        let (before, after) =
            (RiemannInvariants::of(before, cell_before), RiemannInvariants::of(after, cell_after));
        let before = mean.transmitted(before, cell.reflection(cell_before)).difference(mean);
        let after = mean.difference(mean.transmitted(after, cell.reflection(cell_after)));
        let (before, after) = (before.scaled(joined_before), after.scaled(joined_after));
        let contrast = cell.contrast(cell_before).max(cell.contrast(cell_after));
        let half_slope = RiemannInvariants {
            right: slopes.half_slope_correction_at_contrast(
                [before.right, after.right],
                cell,
                contrast,
            ),
            left: slopes.half_slope_correction_at_contrast(
                [after.left, before.left],
                cell,
                contrast,
            ),
        };
        Self { mean, half_slope }
    }

    /// Returns the time-averaged outflow to the left: the mean over the leftmost fraction C of the cell.
    #[inline(always)]
    fn to_left(self) -> N {
        self.mean.left - self.half_slope.left
    }

    /// Returns the time-averaged outflow to the right and the left state, as stencil data for the next face.
    #[inline(always)]
    fn known(self) -> RiemannInvariants<N> {
        RiemannInvariants { right: self.mean.right + self.half_slope.right, left: N::ZERO }
    }
}
