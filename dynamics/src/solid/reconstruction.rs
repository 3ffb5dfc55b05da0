//! Reconstruction: from cell averages the characteristic variables at faces, averaged over the step. First order
//! (Godunov 1959), limited piecewise linear (van Leer 1977; Roe 1985), or linear of fourth order (Strang 1962).

use super::cell::CellConstants;
use super::riemann::{RiemannInvariants, State};
use crate::simd::{Number, Real};
use models::solid::waves::Pair;

/// Cells beyond each end of a line that a sweep reads.
pub const GHOSTS: usize = 2;

/// Width of the halo along a cut axis, in cells for each step of a pass: each of the two sweeps of a step along an axis
/// reads [`GHOSTS`] cells beyond those it updates.
pub const HALO: usize = 2 * GHOSTS;

/// The slopes of the reconstruction in cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// Constant in a cell: first order (Godunov 1959).
    Godunov,
    /// Straight in a cell, with the mean of the differences to both sides within what makes no new extrema, and zero at
    /// extrema: monotonised central (van Leer 1977), with the bounds that depend on the Courant number (Roe 1985). Those
    /// that do not, twice the smaller difference, take more of smooth crests. Second order where the wave is smooth.
    Limited,
    /// The cubic through the integrals of the wave over the four cells around a face, two of them upwind: fourth order,
    /// linear, and of all schemes on these cells the most accurate one (Strang 1962). Steps overshoot.
    FourthOrder,
}

impl Slopes {
    /// The cell of a pair of waves at a Courant number, which rounding may have taken beyond 1; `is_mixed` in problems with
    /// other media or interlayers.
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

    /// Time-averaged outflow minus cell mean of a piecewise linear reconstruction: (1 − C)/2 × limited slope.
    /// Arguments: the differences upwind and downwind.
    ///
    /// With corrections l a wave w in cell i becomes w − C(w + l − w′ − l′), where w′ and l′ are those of the
    /// cell upwind. With d = w − w′, corrections of the sign of d with |l| ≤ |d|(1 − C)/C (Roe 1985) and |l′| ≤
    /// |d| make the update a convex combination of w and w′, hence TVD (Harten 1983).
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

    /// [`Self::half_slope_correction`] beside an interface with a medium of other impedance or Courant number (contrast 1), or of the same
    /// (contrast 0): beside contrasts limited half slopes are ⅜(1 − C) minmod of the differences. The bounds of one
    /// medium let energy grow there (`tests/solid/energy.rs` finds such states; ½ instead of ⅜ still does).
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

    /// Stencil data of the next cell: its invariants (fourth order), else the difference to it.
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

    /// Stencil data of the previous cell: its invariants (fourth order), else the difference from it.
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

    /// Left and right state of the Riemann problem at the lower face of cell i, in one medium: s − zv and s + zv, averaged
    /// over the step. Also returns the stencil data that the next face needs, its `known`.
    ///
    /// `known`: the invariants of cell i − 2 (fourth order), else the left state. `own`: the invariants of cell i. `behind`
    /// and `ahead`: the results of [`Self::behind`] and [`Self::ahead`].
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

    /// [`Self::face_values`] between cells of any media: i − 2, i − 1, i and i + 1.
    #[inline(always)]
    pub(crate) fn face_values_between_media<N: Number>(
        self,
        known: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 4],
    ) -> ([N; 2], RiemannInvariants<N>) {
        self.face_values_beside_interlayers(known, states, cells, [N::ONE; 3])
    }

    /// [`Self::face_values_between_media`] with interlayers at some of the three faces between the cells: `joined` is 0 at
    /// interlayers, 1 at other faces. The stencil does not reach across an interlayer: differences across it are taken to be zero, as if the
    /// state went on unchanged, and cells on both sides of it are never those of one medium. By this no wave gains energy,
    /// whatever the interlayer sends back (tests of [`crate::solid::interface`]).
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
                // At a material interface the outgoing waves differ from the scattered incoming ones. Mapped
                // back through the scattering matrix this gives one more difference in the stencil.
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
                // In one medium to the bit as there, signs of zeros included: what is subtracted then is +0.
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

    /// Initial stencil data for the first face of a line: see [`Self::face_values_beside_interlayers`].
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

/// Face value of the wave that runs to the right: cell mean plus weighted differences, from the upwind one on.
#[inline(always)]
fn corrected_right<N: Number>(
    mean: N,
    [a, b, c]: [N; 3],
    [upwind, central, downwind]: [N; 3],
) -> N {
    mean + a * upwind + b * central + c * downwind
}

/// Face value of the wave that runs to the left, whose differences have the other sign.
#[inline(always)]
fn corrected_left<N: Number>(mean: N, [a, b, c]: [N; 3], [upwind, central, downwind]: [N; 3]) -> N {
    mean - a * upwind - b * central - c * downwind
}

/// Cell means of both invariants, and their time-averaged outflow minus the mean.
#[derive(Clone, Copy)]
struct Reconstruction<N> {
    mean: RiemannInvariants<N>,
    half_slope: RiemannInvariants<N>,
}

impl<N: Number> Reconstruction<N> {
    /// From a cell's own waves, and the differences of the waves from the cell before and to the cell after it, of
    /// the same medium.
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

    /// From the states of cells i − 1, i and i + 1, which may be of several media; `joined` is 0 at interlayers between them
    /// and 1 at other faces.
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

    /// Time-averaged outflow to the left: the mean over the leftmost fraction C of the cell.
    #[inline(always)]
    fn to_left(self) -> N {
        self.mean.left - self.half_slope.left
    }

    /// Time-averaged outflow to the right, which the next face needs.
    #[inline(always)]
    fn known(self) -> RiemannInvariants<N> {
        RiemannInvariants { right: self.mean.right + self.half_slope.right, left: N::ZERO }
    }
}
