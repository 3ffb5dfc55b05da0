//! Reconstruction: from cell averages the characteristic variables at faces, averaged over the step. First order
//! (Godunov 1959), limited piecewise linear (van Leer 1977; Roe 1985), or linear of fourth order (Strang 1962).

use super::cell::Cell;
use super::riemann::{RiemannInvariants, State};
use crate::simd::{Number, Real};
use models::solid::waves::Pair;

/// Cells beyond each end of a line that a sweep reads.
pub const GHOSTS: usize = 2;

/// Layers of a halo for each step of a pass: so many ghosts for each of both sweeps along the last axis.
pub const HALO: usize = 2 * GHOSTS;

/// How waves are reconstructed.
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
    pub(crate) fn cell_of<T: Real>(self, pair: &Pair, courant: f64, is_mixed: bool) -> Cell<T> {
        let (impedance, courant) = (pair.impedance(), courant.min(1.0));
        match (self, is_mixed) {
            (Self::Godunov, _) => Cell::constant(impedance, courant),
            (Self::FourthOrder, true) => Cell::among_others(impedance, courant),
            _ => Cell::new(impedance, courant),
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
        cell: &Cell<N>,
    ) -> N {
        let mean = cell.mean_slope * (upwind + downwind);
        match self {
            Self::Limited => mean.bounded(cell.steepest * upwind, downwind),
            Self::Godunov | Self::FourthOrder => N::ZERO,
        }
    }

    /// The same beside an interface with a medium of other impedance or Courant number (contrast 1), or of the same
    /// (contrast 0): beside contrasts limited leads are ⅜(1 − C) minmod of the differences. The bounds of one
    /// medium let energy grow there (`tests/energy.rs` finds such states; ½ instead of ⅜ still does).
    #[inline(always)]
    fn half_slope_correction_at_contrast<N: Number>(
        self,
        [upwind, downwind]: [N; 2],
        cell: &Cell<N>,
        contrast: N,
    ) -> N {
        let mean = cell.mean_slope * (upwind + downwind);
        match self {
            Self::Limited => {
                let most = cell.mean_slope + N::HALF * cell.mean_slope;
                let steepest = cell.steepest + contrast * (most - cell.steepest);
                let foremost = N::ONE + contrast * (most - N::ONE);
                mean.bounded(steepest * upwind, foremost * downwind)
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

    /// The same of the previous cell.
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

    /// The left and the right face value of the Riemann problem between the cell behind and the cell at hand, in one
    /// medium: s − zv and s + zv, averaged over the step. And what the next face needs of these cells, `known` there.
    ///
    /// `known`: to fourth order the waves in the cell before the one behind, else the left face value. `own`: the waves in
    /// the cell at hand; `behind`, `ahead`: what [`Self::behind`] and [`Self::ahead`] give.
    #[inline(always)]
    pub(crate) fn reach<N: Number>(
        self,
        known: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
        [behind, ahead]: [RiemannInvariants<N>; 2],
        cell: &Cell<N>,
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

    /// The same between cells of any media: the two behind, that at hand, and the one after it.
    #[inline(always)]
    pub(crate) fn reach_between_media<N: Number>(
        self,
        known: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&Cell<N>; 4],
    ) -> ([N; 2], RiemannInvariants<N>) {
        self.reach_beside_interlayers(known, states, cells, [N::ONE; 3])
    }

    /// The same with interlayers at some of the three faces between the cells, by what is `joined`: 0 at interlayers, 1 at
    /// other faces. The stencil does not reach across an interlayer: differences across it are taken to be zero, as if the
    /// state went on unchanged, and cells on both sides of it are never those of one medium. By this no wave gains energy,
    /// whatever the interlayer sends back (tests of [`crate::solid::interface`]).
    #[inline(always)]
    pub(crate) fn reach_beside_interlayers<N: Number>(
        self,
        known: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&Cell<N>; 4],
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
                    .continued(known, cell_behind.reflection(cell_before))
                    .difference(own_behind)
                    .scaled(joined_behind);
                let before = own.continued(own_behind, -reflection).difference(own);
                let before = before.scaled(joined_here);
                let after = own.difference(own.continued(next, cell.reflection(cell_after)));
                let after = after.scaled(joined_after);
                // At a material interface the outgoing waves differ from the scattered incoming ones. Mapped
                // back through the scattering matrix this gives one more difference in the stencil.
                let beyond = own_behind.continued(own, reflection);
                let right = cell.staying() * before.right;
                let left = joined_here * (cell_behind.staying() * (own_behind.left - beyond.left));
                let across = RiemannInvariants {
                    right: right + reflection * (left - right),
                    left: left + reflection * (left - right),
                };
                let [to_first, to_middle, to_last] = Cell::alike(cells);
                let to_first = joined_behind * to_first;
                let to_middle = joined_here * to_middle;
                let to_last = joined_after * to_last;
                let alike = [to_first, to_middle, to_last];
                let (weights, weight) = cell_behind.weights(alike);
                let right = own_behind.right + weight * across.right;
                let right = led(right, weights, [first.right, before.right, after.right]);
                let (weights, weight) = cell.weights([to_last, to_middle, to_first]);
                let left = own.left + weight * across.left;
                let left = led_left(left, weights, [after.left, before.left, first.left]);
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

    /// Initial stencil data for the first face of a line: see [`Self::reach_beside_interlayers`].
    pub(crate) fn known<N: Number>(
        self,
        states: [State<N>; 3],
        cells: [&Cell<N>; 3],
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

/// A mean and what leads: weights times differences, from that upwind on.
#[inline(always)]
fn led<N: Number>(mean: N, [a, b, c]: [N; 3], [upwind, central, downwind]: [N; 3]) -> N {
    mean + a * upwind + b * central + c * downwind
}

/// The same of a wave that runs to the left, whose differences have the other sign.
#[inline(always)]
fn led_left<N: Number>(mean: N, [a, b, c]: [N; 3], [upwind, central, downwind]: [N; 3]) -> N {
    mean - a * upwind - b * central - c * downwind
}

/// Cell means of both invariants, and their time-averaged outflow minus the mean.
#[derive(Clone, Copy)]
struct Reconstruction<N> {
    mean: RiemannInvariants<N>,
    lead: RiemannInvariants<N>,
}

impl<N: Number> Reconstruction<N> {
    /// From a cell's own waves, and the differences of the waves from the cell before and to the cell after it, of
    /// the same medium.
    #[inline(always)]
    fn new(
        mean: RiemannInvariants<N>,
        [before, after]: [RiemannInvariants<N>; 2],
        cell: &Cell<N>,
        slopes: Slopes,
    ) -> Self {
        let lead = RiemannInvariants {
            right: slopes.half_slope_correction([before.right, after.right], cell),
            left: slopes.half_slope_correction([after.left, before.left], cell),
        };
        Self { mean, lead }
    }

    /// From the states of the cell before, of the cell, and of the cell after it, which may be of other media, or beyond
    /// interlayers where 0 of 1 is `joined`.
    #[inline(always)]
    fn of(
        [before, own, after]: [State<N>; 3],
        [cell_before, cell, cell_after]: [&Cell<N>; 3],
        [joined_before, joined_after]: [N; 2],
        slopes: Slopes,
    ) -> Self {
        let mean = RiemannInvariants::of(own, cell);
        let (before, after) =
            (RiemannInvariants::of(before, cell_before), RiemannInvariants::of(after, cell_after));
        let before = mean.continued(before, cell.reflection(cell_before)).difference(mean);
        let after = mean.difference(mean.continued(after, cell.reflection(cell_after)));
        let (before, after) = (before.scaled(joined_before), after.scaled(joined_after));
        let contrast = cell.contrast(cell_before).greatest(cell.contrast(cell_after));
        let lead = RiemannInvariants {
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
        Self { mean, lead }
    }

    /// Time-averaged outflow to the left: the mean over the leftmost fraction C of the cell.
    #[inline(always)]
    fn to_left(self) -> N {
        self.mean.left - self.lead.left
    }

    /// Time-averaged outflow to the right, which the next face needs.
    #[inline(always)]
    fn known(self) -> RiemannInvariants<N> {
        RiemannInvariants { right: self.mean.right + self.lead.right, left: N::ZERO }
    }
}
