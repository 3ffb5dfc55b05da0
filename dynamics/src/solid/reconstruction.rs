//! Reconstruction: time-averaged characteristic variables at faces from cell averages. First order (Godunov 1959),
//! limited piecewise linear (van Leer 1977; Roe 1985), or linear fourth, sixth or eighth order (Strang 1962).
//!
//! The limiter (case key `order = "eno2"`) is [`Slopes::half_slope_correction`], with tighter bounds beside other
//! media. The boundary closure in `ghosts` is derived from the energy bounds of this limiter, and
//! `tests/solid/energy.rs` searches for states in which energy grows: a new limiter needs its own closure and such a
//! search.

use super::cell::CellConstants;
use super::riemann::{RiemannInvariants, State};
use crate::simd::{Number, Real, Vector};
use models::solid::waves::VelocityStressPair;

/// Number of ghost cells beyond each end of a line, unless the stencil is wide: see [`Slopes::ghosts`].
pub const GHOSTS: usize = 2;

/// Largest number of ghost cells beyond each end of a line.
pub(crate) const MAX_GHOSTS: usize = 4;

/// Width of the halo beside a neighbouring subdomain, in cells per step of a pass, unless the stencil is wide: see
/// [`Slopes::halo`].
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
    /// Unlimited linear fourth-order scheme: reconstruction by the cubic polynomial with the means of the four cells
    /// around a face, two of them upwind; the most accurate scheme on this stencil (Strang 1962). It overshoots at
    /// discontinuities.
    FourthOrder,
    /// As [`Self::FourthOrder`] with more cells around a face: see `wide_stencil.rs`. One medium only, mirror images
    /// beyond boundaries, and no non-reflecting ones.
    Wide(WideOrder),
}

/// Order of a linear reconstruction from more than four cells around a face: the number of these cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WideOrder {
    /// Sixth order, from six cells.
    Sixth,
    /// Eighth order, from eight cells.
    Eighth,
}

/// Interlayers at some of the three faces between the four cells of a stencil, in one medium.
#[derive(Clone, Copy, Debug)]
pub(crate) struct InterlayerStencil<N> {
    /// 0 at an interlayer, 1 at any other face, from the lower to the upper face.
    pub(crate) continuity: [N; 3],
    /// Fourth order: [`CellConstants::interlayer_weights`] of the right-going and of the left-going wave.
    pub(crate) weights: [[N; 4]; 2],
}

impl<N: Number> InterlayerStencil<N> {
    /// Computes the stencil for the constants of a cell.
    pub(crate) fn new(cell: &CellConstants<N>, continuity: [N; 3]) -> Self {
        let [lower, middle, upper] = continuity;
        let weights =
            [cell.interlayer_weights(continuity), cell.interlayer_weights([upper, middle, lower])];
        Self { continuity, weights }
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &InterlayerStencil<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        let mut own = Self { continuity: [N::ZERO; 3], weights: [[N::ZERO; 4]; 2] };
        for face in 0..3 {
            own.continuity[face] = N::load(&from.continuity[face]);
        }
        for wave in 0..2 {
            for cell in 0..4 {
                own.weights[wave][cell] = N::load(&from.weights[wave][cell]);
            }
        }
        own
    }
}

impl Slopes {
    /// Returns the number of ghost cells beyond each end of a line: half of the number of cells around a face that the
    /// reconstruction reads.
    pub const fn ghosts(self) -> usize {
        match self {
            Self::Godunov | Self::Limited | Self::FourthOrder => GHOSTS,
            Self::Wide(WideOrder::Sixth) => 3,
            Self::Wide(WideOrder::Eighth) => MAX_GHOSTS,
        }
    }

    /// Returns the width of the halo beside a neighbouring subdomain, in cells per step of a pass: each of the two
    /// sweeps of a step along an axis reads [`Self::ghosts`] cells beyond those it updates.
    pub const fn halo(self) -> usize {
        2 * self.ghosts()
    }

    /// Whether the reconstruction reads more than four cells around a face: see `wide_stencil.rs`.
    pub const fn is_wide(self) -> bool {
        matches!(self, Self::Wide(_))
    }

    /// Creates the constants of a cell for a wave pair. The Courant number may exceed 1 by rounding. `has_interfaces`:
    /// whether the problem has several media or interlayers.
    pub(crate) fn cell_constants<T: Real>(
        self,
        pair: &VelocityStressPair,
        courant: f64,
        has_interfaces: bool,
    ) -> CellConstants<T> {
        let (impedance, courant) = (pair.impedance(), courant.min(1.0));
        match (self, has_interfaces) {
            (Self::Godunov, _) => CellConstants::with_constant_reconstruction(impedance, courant),
            (Self::FourthOrder, true) => CellConstants::with_interfaces(impedance, courant),
            _ => CellConstants::new(impedance, courant),
        }
    }

    /// Computes the time-averaged outflow minus the cell mean of a piecewise linear reconstruction: (1 − C)/2 × limited
    /// slope, from the upwind and downwind differences.
    ///
    /// With corrections l, a wave w in cell i becomes w − C(w + l − w′ − l′), where w′ and l′ belong to the upwind
    /// cell. With d = w − w′, corrections of the sign of d with |l| ≤ |d|(1 − C)/C (Roe 1985) and |l′| ≤ |d| make the
    /// update a convex combination of w and w′, hence total variation diminishing (Harten 1983).
    #[inline(always)]
    pub(crate) fn half_slope_correction<N: Number>(
        self,
        [upwind, downwind]: [N; 2],
        cell: &CellConstants<N>,
    ) -> N {
        let mean = cell.mean_slope_weight * (upwind + downwind);
        match self {
            Self::Limited => mean.minmod3(cell.upwind_bound * upwind, downwind),
            Self::Godunov | Self::FourthOrder | Self::Wide(_) => N::ZERO,
        }
    }

    /// Computes [`Self::half_slope_correction`] in a cell next to a cell of another impedance or Courant number
    /// (`contrast` 1) or of the same ones (0). At contrasts the limited half slope is ⅜(1 − C) minmod of the
    /// differences: the bounds for one medium, and ½ in place of ⅜, allow energy growth there (`tests/solid/energy.rs`
    /// finds such states).
    #[inline(always)]
    fn half_slope_correction_at_contrast<N: Number>(
        self,
        [upwind, downwind]: [N; 2],
        cell: &CellConstants<N>,
        contrast: N,
    ) -> N {
        let mean = cell.mean_slope_weight * (upwind + downwind);
        match self {
            Self::Limited => {
                let limit = cell.mean_slope_weight + N::HALF * cell.mean_slope_weight;
                let upwind_bound = cell.upwind_bound + contrast * (limit - cell.upwind_bound);
                let downwind_bound = N::ONE + contrast * (limit - N::ONE);
                mean.minmod3(upwind_bound * upwind, downwind_bound * downwind)
            }
            Self::Godunov | Self::FourthOrder | Self::Wide(_) => N::ZERO,
        }
    }

    /// Returns the data of cell i + 1 that the reconstruction reads, from the invariants of cells i (`own`) and i + 1:
    /// the invariants of cell i + 1 (fourth order), else the difference between the two cells.
    #[inline(always)]
    pub(crate) fn upper_stencil<N: Number>(
        self,
        own: RiemannInvariants<N>,
        next: RiemannInvariants<N>,
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder | Self::Wide(_) => next,
            Self::Godunov | Self::Limited => own.difference(next),
        }
    }

    /// Returns the data of cell i − 1 that the reconstruction reads, from the invariants of cells i − 1 and i (`own`):
    /// the invariants of cell i − 1 (fourth order), else the difference between the two cells.
    #[inline(always)]
    pub(crate) fn lower_stencil<N: Number>(
        self,
        last: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder | Self::Wide(_) => last,
            Self::Godunov | Self::Limited => last.difference(own),
        }
    }

    /// Computes both waves of the Riemann problem at the lower face of cell i, in one medium: s − zv from the left and
    /// s + zv from the right, averaged over the step. Also returns the `carried_invariants` of the next face.
    ///
    /// `carried_invariants`: the invariants of cell i − 2 (fourth order), else the right-going wave at the face. `own`:
    /// the invariants of cell i. `lower_stencil`, `upper_stencil`: results of [`Self::lower_stencil`] and
    /// [`Self::upper_stencil`].
    #[inline(always)]
    pub(crate) fn face_values<N: Number>(
        self,
        carried_invariants: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
        [lower_stencil, upper_stencil]: [RiemannInvariants<N>; 2],
        cell: &CellConstants<N>,
    ) -> ([N; 2], RiemannInvariants<N>) {
        match self {
            Self::FourthOrder | Self::Wide(_) => {
                let right = cell.face_value([
                    carried_invariants.right,
                    lower_stencil.right,
                    own.right,
                    upper_stencil.right,
                ]);
                let left = cell.face_value([
                    upper_stencil.left,
                    own.left,
                    lower_stencil.left,
                    carried_invariants.left,
                ]);
                ([right, left], lower_stencil)
            }
            Self::Godunov | Self::Limited => {
                let reconstruction =
                    Reconstruction::new(own, [lower_stencil, upper_stencil], cell, self);
                (
                    [carried_invariants.right, reconstruction.left_going_outflow()],
                    reconstruction.right_going_outflow(),
                )
            }
        }
    }

    /// Computes [`Self::face_values`] for cells of any media. `states`: those of cells i − 1, i and i + 1; `cells`: the
    /// constants of cells i − 2 … i + 1. `continuity`: `None` without interlayers, else for the three faces between the
    /// cells 0 at an interlayer and 1 at any other face. The stencil does not extend across an interlayer: differences
    /// across it are zero (constant extrapolation), and in the fourth-order scheme the two cells at it count as
    /// different media. In that scheme no wave then gains energy for any response of the interlayer (tests of
    /// [`crate::solid::interface`]).
    #[inline(always)]
    pub(crate) fn face_values_in_mixed_media<N: Number>(
        self,
        carried_invariants: RiemannInvariants<N>,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 4],
        continuity: Option<[N; 3]>,
    ) -> ([N; 2], RiemannInvariants<N>) {
        let [continuity_behind, continuity_here, continuity_after] =
            continuity.unwrap_or([N::ONE; 3]);
        let [lower_cell, here, next] = states;
        let [cell_before, cell_behind, cell, cell_after] = cells;
        match self {
            Self::FourthOrder | Self::Wide(_) => {
                let (own_behind, own) = (
                    RiemannInvariants::from_state(lower_cell, cell_behind),
                    RiemannInvariants::from_state(here, cell),
                );
                let next = RiemannInvariants::from_state(next, cell_after);
                let reflection = cell_behind.reflection_coefficient(cell);
                let first = own_behind
                    .transmit(carried_invariants, cell_behind.reflection_coefficient(cell_before))
                    .difference(own_behind)
                    .scale(continuity_behind);
                let before = own.transmit(own_behind, -reflection).difference(own);
                let before = before.scale(continuity_here);
                let after =
                    own.difference(own.transmit(next, cell.reflection_coefficient(cell_after)));
                let after = after.scale(continuity_after);
                // At a material interface the outgoing waves differ from the incoming waves after scattering. Mapped
                // back through the scattering matrix, this gives an additional difference for the stencil.
                let beyond = own_behind.transmit(own, reflection);
                let right = cell.one_minus_courant() * before.right;
                let left = continuity_here
                    * (cell_behind.one_minus_courant() * (own_behind.left - beyond.left));
                let across = RiemannInvariants {
                    right: right + reflection * (left - right),
                    left: left + reflection * (left - right),
                };
                let [to_first, to_middle, to_last] = CellConstants::equality_flags(cells);
                let same_medium = to_first * to_middle * to_last;
                let to_first = continuity_behind * to_first;
                let to_middle = continuity_here * to_middle;
                let to_last = continuity_after * to_last;
                let (weights, weight) =
                    cell_behind.interface_weights([to_first, to_middle, to_last]);
                let right = own_behind.right + weight * across.right;
                let right =
                    right_face_value(right, weights, [first.right, before.right, after.right]);
                let (weights, weight) = cell.interface_weights([to_last, to_middle, to_first]);
                let left = own.left + weight * across.left;
                let left = left_face_value(left, weights, [after.left, before.left, first.left]);
                // In one medium, identical to `face_values` and `face_values_beside_interlayers` bit for bit, signs of
                // zeros included: +0 is subtracted.
                let rest = N::ONE - same_medium;
                let to_right = [carried_invariants.right, own_behind.right, own.right, next.right];
                let to_left = [next.left, own.left, own_behind.left, carried_invariants.left];
                let (right_in_medium, left_in_medium) = match continuity {
                    None => (cell_behind.face_value(to_right), cell.face_value(to_left)),
                    Some([behind, here, after]) => (
                        CellConstants::weighted_face_value(
                            cell_behind.interlayer_weights([behind, here, after]),
                            to_right,
                        ),
                        CellConstants::weighted_face_value(
                            cell.interlayer_weights([after, here, behind]),
                            to_left,
                        ),
                    ),
                };
                let right = same_medium * right_in_medium - (N::ZERO - rest * right);
                let left = same_medium * left_in_medium - (N::ZERO - rest * left);
                ([right, left], own_behind)
            }
            Self::Godunov | Self::Limited => {
                let cells = [cell_behind, cell, cell_after];
                let continuity = [continuity_here, continuity_after];
                let reconstruction =
                    Reconstruction::from_mixed_media(states, cells, continuity, self);
                (
                    [carried_invariants.right, reconstruction.left_going_outflow()],
                    reconstruction.right_going_outflow(),
                )
            }
        }
    }

    /// Computes [`Self::face_values`] in one medium with interlayers at some of the three faces between the cells:
    /// [`Self::face_values_in_mixed_media`] for cells of equal constants, bit for bit. `stencil`: the interlayers; the
    /// other arguments are those of [`Self::face_values`].
    #[inline(always)]
    pub(crate) fn face_values_beside_interlayers<N: Number>(
        self,
        carried_invariants: RiemannInvariants<N>,
        own: RiemannInvariants<N>,
        [lower_stencil, upper_stencil]: [RiemannInvariants<N>; 2],
        cell: &CellConstants<N>,
        stencil: &InterlayerStencil<N>,
    ) -> ([N; 2], RiemannInvariants<N>) {
        match self {
            Self::FourthOrder | Self::Wide(_) => {
                let right = CellConstants::weighted_face_value(
                    stencil.weights[0],
                    [carried_invariants.right, lower_stencil.right, own.right, upper_stencil.right],
                );
                let left = CellConstants::weighted_face_value(
                    stencil.weights[1],
                    [upper_stencil.left, own.left, lower_stencil.left, carried_invariants.left],
                );
                ([right, left], lower_stencil)
            }
            Self::Godunov | Self::Limited => {
                let [_, here, after] = stencil.continuity;
                let differences = [lower_stencil.scale(here), upper_stencil.scale(after)];
                let reconstruction = Reconstruction::new(own, differences, cell, self);
                (
                    [carried_invariants.right, reconstruction.left_going_outflow()],
                    reconstruction.right_going_outflow(),
                )
            }
        }
    }

    /// Computes both waves of the Riemann problem as [`Self::face_values_beside_interlayers`] does, from the states of
    /// the cells i − 2 … i + 1, or with the carried invariants of the face if these are `stored`.
    #[inline(always)]
    pub(crate) fn incident_waves_beside_interlayers<N: Number>(
        self,
        stored: Option<RiemannInvariants<N>>,
        states: [State<N>; 4],
        cell: &CellConstants<N>,
        stencil: &InterlayerStencil<N>,
    ) -> [N; 2] {
        let mut waves = [RiemannInvariants::ZERO; 4];
        for depth in 0..4 {
            waves[depth] = RiemannInvariants::from_state(states[depth], cell);
        }
        let [first, before, own, next] = waves;
        let carried = match (stored, self) {
            (Some(stored), _) => stored,
            (None, Self::FourthOrder | Self::Wide(_)) => first,
            (None, Self::Godunov | Self::Limited) => {
                let [behind, here, _] = stencil.continuity;
                let differences =
                    [first.difference(before).scale(behind), before.difference(own).scale(here)];
                Reconstruction::new(before, differences, cell, self).right_going_outflow()
            }
        };
        let around = [self.lower_stencil(before, own), self.upper_stencil(own, next)];
        self.face_values_beside_interlayers(carried, own, around, cell, stencil).0
    }

    /// Computes the carried invariants of the face between the last two of three cells, from the states and constants
    /// of the three; see [`Self::face_values`]. `continuity` of the two faces between them: 0 at interlayers, 1 at
    /// other faces.
    #[inline(always)]
    pub(crate) fn carried_invariants<N: Number>(
        self,
        states: [State<N>; 3],
        cells: [&CellConstants<N>; 3],
        continuity: [N; 2],
    ) -> RiemannInvariants<N> {
        match self {
            Self::FourthOrder | Self::Wide(_) => RiemannInvariants::from_state(states[0], cells[0]),
            Self::Godunov | Self::Limited => {
                Reconstruction::from_mixed_media(states, cells, continuity, self)
                    .right_going_outflow()
            }
        }
    }
}

/// Computes the face value of the right-going wave: cell mean plus weighted differences, from upwind to downwind.
#[inline(always)]
fn right_face_value<N: Number>(
    mean: N,
    [a, b, c]: [N; 3],
    [upwind, central, downwind]: [N; 3],
) -> N {
    mean + a * upwind + b * central + c * downwind
}

/// Computes the face value of the left-going wave: as for the right-going wave, with differences of the opposite sign.
#[inline(always)]
fn left_face_value<N: Number>(
    mean: N,
    [a, b, c]: [N; 3],
    [upwind, central, downwind]: [N; 3],
) -> N {
    mean - a * upwind - b * central - c * downwind
}

/// Cell means of both invariants and their half-slope corrections.
#[derive(Clone, Copy)]
struct Reconstruction<N> {
    mean: RiemannInvariants<N>,
    half_slope: RiemannInvariants<N>,
}

impl<N: Number> Reconstruction<N> {
    /// Reconstructs in one medium, from the invariants of cell i and the differences from cell i − 1 and to cell i + 1.
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

    /// Reconstructs in several media, from the states of cells i − 1, i and i + 1; `continuity` is 0 at interlayers
    /// between them and 1 at other faces.
    #[inline(always)]
    fn from_mixed_media(
        [before, own, after]: [State<N>; 3],
        [cell_before, cell, cell_after]: [&CellConstants<N>; 3],
        [continuity_before, continuity_after]: [N; 2],
        slopes: Slopes,
    ) -> Self {
        let mean = RiemannInvariants::from_state(own, cell);
        let (before, after) = (
            RiemannInvariants::from_state(before, cell_before),
            RiemannInvariants::from_state(after, cell_after),
        );
        let before =
            mean.transmit(before, cell.reflection_coefficient(cell_before)).difference(mean);
        let after = mean.difference(mean.transmit(after, cell.reflection_coefficient(cell_after)));
        let (before, after) = (before.scale(continuity_before), after.scale(continuity_after));
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

    /// Returns the time-averaged outflow of the left-going wave: its mean over the leftmost fraction C of the cell.
    #[inline(always)]
    fn left_going_outflow(self) -> N {
        self.mean.left - self.half_slope.left
    }

    /// Returns the time-averaged outflow of the right-going wave, which the sweep carries to the next face; the
    /// left-going wave is zero.
    #[inline(always)]
    fn right_going_outflow(self) -> RiemannInvariants<N> {
        RiemannInvariants { right: self.mean.right + self.half_slope.right, left: N::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use super::{InterlayerStencil, Slopes};
    use crate::simd::Real;
    use crate::solid::cell::CellConstants;
    use crate::solid::line::face_values;
    use crate::solid::random_lines::LinearCongruentialGenerator;
    use crate::solid::riemann::{RiemannInvariants, State};

    /// Verifies that in one medium the formula for any media gives the face values of that for one medium bit for bit,
    /// for all states of four cells whose velocities and stresses are one of five numbers, zeros of both signs among
    /// them.
    fn check_formulas_in_one_medium<T: Real>() {
        let numbers = [0.0, -0.0, 1.0, -1.0, -0.3].map(T::from_f64);
        let digit = |index: usize, place: u32| numbers[index / 5_usize.pow(place) % 5];
        for slopes in [Slopes::Godunov, Slopes::Limited, Slopes::FourthOrder] {
            for courant in [0.3, 1.0] {
                let cell = CellConstants::<T>::new(1.0, courant);
                for index in 0..5_usize.pow(8) {
                    let states: [State<T>; 4] = std::array::from_fn(|place| State {
                        velocity: digit(index, 2 * place as u32),
                        stress: digit(index, 2 * place as u32 + 1),
                    });
                    let waves = states.map(|state| RiemannInvariants::from_state(state, &cell));
                    let at_face = |carried, [before, own, next]: [RiemannInvariants<T>; 3]| {
                        let stencil =
                            [slopes.lower_stencil(before, own), slopes.upper_stencil(own, next)];
                        slopes.face_values(carried, own, stencil, &cell)
                    };
                    let [first, second, third, fourth] = waves;
                    let carried = at_face(RiemannInvariants::ZERO, [first, second, third]).1;
                    let expected = at_face(carried, [second, third, fourth]).0;
                    let found = face_values(states, [&cell; 4], [T::ONE; 3], slopes);
                    assert_eq!(
                        found.map(|value| value.to_f64().to_bits()),
                        expected.map(|value| value.to_f64().to_bits()),
                        "{slopes:?}, C = {courant}: {states:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn formulas_for_one_and_for_any_media_agree_in_one_medium() {
        check_formulas_in_one_medium::<f64>();
        check_formulas_in_one_medium::<f32>();
    }

    /// Verifies that in one medium the stored weights give the face values of the formula for any media bit for bit, and
    /// that cells beyond an interlayer have no influence.
    #[test]
    fn stored_weights_beside_interlayers_equal_the_formula_for_any_media() {
        let mut random = LinearCongruentialGenerator::new(3);
        for slopes in [Slopes::FourthOrder, Slopes::Limited] {
            for attempt in 0..800 {
                let mut uniform = |low, high| random.uniform(low, high);
                let cell =
                    CellConstants::<f64>::with_interfaces(uniform(0.1, 10.0), uniform(0.0, 1.0));
                let continuity =
                    [0, 1, 2].map(|face| f64::from(u8::from(attempt >> face & 1 == 0)));
                let states = [0; 4]
                    .map(|_| State { velocity: uniform(-1.0, 1.0), stress: uniform(-1.0, 1.0) });
                let stencil = InterlayerStencil::new(&cell, continuity);
                let waves = |states| {
                    slopes.incident_waves_beside_interlayers(None, states, &cell, &stencil)
                };
                let found = waves(states);
                let expected = face_values(states, [&cell; 4], continuity, slopes);
                assert_eq!(
                    found.map(f64::to_bits),
                    expected.map(f64::to_bits),
                    "{slopes:?} {continuity:?}"
                );
                if continuity[1] == 0.0 {
                    let far = State { velocity: 7.0, stress: -3.0 };
                    assert_eq!(waves([states[0], states[1], far, far])[0], found[0]);
                    assert_eq!(waves([far, far, states[2], states[3]])[1], found[1]);
                }
            }
        }
    }
}
