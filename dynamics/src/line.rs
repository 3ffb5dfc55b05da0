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
//! What is written here is arithmetic on [`Number`]s: [`sweep`] does it to a line, cell by cell, and
//! keeps the account; [`crate::kernel`] does the same to many lines at once.

pub use crate::cell::Cell;
use crate::real::{Number, Real, Vector};

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
    /// Of a piecewise linear reconstruction: the face value downwind less the cell mean, averaged over the step, (1 − C)
    /// times half the limited slope. Arguments: the differences upwind and downwind.
    ///
    /// With leads l a wave w in cell i becomes w − C(w + l − w′ − l′), w′ and l′ being those of the cell upwind. Of
    /// one sign with d = w − w′ and within l ≤ d(1 − C)/C and l′ ≤ d, the leads make that a mean of w and w′ with
    /// weights from 0 to 1 (Harten 1983): nothing new stands out.
    #[inline(always)]
    pub(crate) fn lead<N: Number>(self, [upwind, downwind]: [N; 2], cell: &Cell<N>) -> N {
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
    fn lead_at_contrast<N: Number>(
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

    /// What is looked at of the cell after the one at hand: to fourth order its waves, else their differences.
    #[inline(always)]
    pub(crate) fn ahead<N: Number>(self, own: Waves<N>, next: Waves<N>) -> Waves<N> {
        match self {
            Self::FourthOrder => next,
            Self::Godunov | Self::Limited => own.to(next),
        }
    }

    /// The same of the cell before the one at hand.
    #[inline(always)]
    pub(crate) fn behind<N: Number>(self, last: Waves<N>, own: Waves<N>) -> Waves<N> {
        match self {
            Self::FourthOrder => last,
            Self::Godunov | Self::Limited => last.to(own),
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
        known: Waves<N>,
        own: Waves<N>,
        [behind, ahead]: [Waves<N>; 2],
        cell: &Cell<N>,
    ) -> ([N; 2], Waves<N>) {
        match self {
            Self::FourthOrder => {
                let right = cell.face_value([known.right, behind.right, own.right, ahead.right]);
                let left = cell.face_value([ahead.left, own.left, behind.left, known.left]);
                ([right, left], behind)
            }
            Self::Godunov | Self::Limited => {
                let pieces = Pieces::new(own, [behind, ahead], cell, self);
                ([known.right, pieces.to_left()], pieces.known())
            }
        }
    }

    /// The same between cells of any media: the two behind, that at hand, and the one after it.
    #[inline(always)]
    pub(crate) fn reach_between_media<N: Number>(
        self,
        known: Waves<N>,
        states: [State<N>; 3],
        cells: [&Cell<N>; 4],
    ) -> ([N; 2], Waves<N>) {
        let [behind, here, next] = states;
        let [cell_before, cell_behind, cell, cell_after] = cells;
        match self {
            Self::FourthOrder => {
                let (own_behind, own) = (Waves::of(behind, cell_behind), Waves::of(here, cell));
                let next = Waves::of(next, cell_after);
                let reflection = cell_behind.reflection(cell);
                let first =
                    own_behind.continued(known, cell_behind.reflection(cell_before)).to(own_behind);
                let before = own.continued(own_behind, -reflection).to(own);
                let after = own.to(own.continued(next, cell.reflection(cell_after)));
                // Across an interface at the face what leaves it differs from what scattering makes of the waves that
                // arrive; scattered back this is a difference of those.
                let beyond = own_behind.continued(own, reflection);
                let right = cell.staying() * before.right;
                let left = cell_behind.staying() * (own_behind.left - beyond.left);
                let across = Waves {
                    right: right + reflection * (left - right),
                    left: left + reflection * (left - right),
                };
                let alike = Cell::alike(cells);
                let [to_first, to_middle, to_last] = alike;
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
                let pieces = Pieces::of(states, [cell_behind, cell, cell_after], self);
                ([known.right, pieces.to_left()], pieces.known())
            }
        }
    }

    /// What [`Self::reach_between_media`] wants to know of the first two of three cells and the one after them.
    fn known<N: Number>(self, states: [State<N>; 3], cells: [&Cell<N>; 3]) -> Waves<N> {
        match self {
            Self::FourthOrder => Waves::of(states[0], cells[0]),
            Self::Godunov | Self::Limited => Pieces::of(states, cells, self).known(),
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

/// Cell by cell.
impl<'a> std::iter::Sum<&'a Self> for Account {
    fn sum<I: Iterator<Item = &'a Self>>(accounts: I) -> Self {
        accounts.fold(Self::default(), |sum, own| Self {
            inflow: sum.inflow + own.inflow,
            dissipated: sum.dissipated + own.dissipated,
        })
    }
}

/// The velocity and the stress of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State<N> {
    pub(crate) velocity: N,
    pub(crate) stress: N,
}

/// Characteristic variables: s − zv, which runs to the right, and s + zv, which runs to the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Waves<N> {
    pub(crate) right: N,
    pub(crate) left: N,
}

impl<N: Number> Waves<N> {
    pub(crate) const ZERO: Self = Self { right: N::ZERO, left: N::ZERO };

    #[inline(always)]
    pub(crate) fn of(state: State<N>, cell: &Cell<N>) -> Self {
        let zv = cell.impedance * state.velocity;
        Self { right: state.stress - zv, left: state.stress + zv }
    }

    /// The waves of a neighbour, continued across the interface with it as what scattering there makes of them, with
    /// the coefficient of reflection ρ = (y − z)/(y + z), y being the impedance of the neighbour: the wave that comes from there is joined by the reflection
    /// of the own one that runs there, w = (1 − ρ) w′ + ρ ŵ; the one that runs there has the waves that leave the
    /// interface before it, reversed in time, which is the same formula. Unfolded like this a line has no interface:
    /// scattering keeps energy.
    #[inline(always)]
    fn continued(self, neighbour: Self, reflection: N) -> Self {
        Self {
            right: neighbour.right + reflection * (self.left - neighbour.right),
            left: neighbour.left + reflection * (self.right - neighbour.left),
        }
    }

    /// The difference to the next cell.
    #[inline(always)]
    pub(crate) fn to(self, next: Self) -> Self {
        Self { right: next.right - self.right, left: next.left - self.left }
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &Waves<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        Self { right: N::load(&from.right), left: N::load(&from.left) }
    }

    #[inline(always)]
    pub(crate) fn store<T: Real>(self, to: &mut Waves<T::Lanes>)
    where
        N: Vector<T>,
    {
        self.right.store(&mut to.right);
        self.left.store(&mut to.left);
    }
}

/// Both waves in a cell, and how much what leaves it during the step is beyond their means.
#[derive(Clone, Copy)]
struct Pieces<N> {
    mean: Waves<N>,
    lead: Waves<N>,
}

impl<N: Number> Pieces<N> {
    /// From a cell's own waves, and the differences of the waves from the cell before and to the cell after it, of
    /// the same medium.
    #[inline(always)]
    fn new(mean: Waves<N>, [before, after]: [Waves<N>; 2], cell: &Cell<N>, slopes: Slopes) -> Self {
        let lead = Waves {
            right: slopes.lead([before.right, after.right], cell),
            left: slopes.lead([after.left, before.left], cell),
        };
        Self { mean, lead }
    }

    /// From the states of the cell before, of the cell, and of the cell after it, which may be of other media.
    #[inline(always)]
    fn of(
        [before, own, after]: [State<N>; 3],
        [cell_before, cell, cell_after]: [&Cell<N>; 3],
        slopes: Slopes,
    ) -> Self {
        let mean = Waves::of(own, cell);
        let (before, after) = (Waves::of(before, cell_before), Waves::of(after, cell_after));
        let before = mean.continued(before, cell.reflection(cell_before)).to(mean);
        let after = mean.to(mean.continued(after, cell.reflection(cell_after)));
        let contrast = cell.contrast(cell_before).greatest(cell.contrast(cell_after));
        let lead = Waves {
            right: slopes.lead_at_contrast([before.right, after.right], cell, contrast),
            left: slopes.lead_at_contrast([after.left, before.left], cell, contrast),
        };
        Self { mean, lead }
    }

    /// Mean over the step of what leaves to the left: the foremost part of length C.
    #[inline(always)]
    fn to_left(self) -> N {
        self.mean.left - self.lead.left
    }

    /// What leaves to the right, which the next face wants to know.
    #[inline(always)]
    fn known(self) -> Waves<N> {
        Waves { right: self.mean.right + self.lead.right, left: N::ZERO }
    }
}

/// A joint as the cell at one of its sides sees it, by the z of that cell: the difference of the waves that the
/// cell has in it is 2zv, their sum 2s.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint<N> {
    difference: N,
    sum: N,
}

impl<N: Number> Joint<N> {
    /// Between cells of one impedance, which s − zv reaches from the left and s + zv from the right: both cells see
    /// the same.
    #[inline(always)]
    pub(crate) fn between_like([left, right]: [N; 2]) -> Self {
        Self { difference: right - left, sum: left + right }
    }

    /// Between cells of impedances z and y, which s − zv reaches from the left and s + yv from the right, as they
    /// see it: v = (right − left)/(z + y) and s = (y left + z right)/(z + y), with the coefficient of reflection
    /// (y − z)/(y + z). Where that is zero, this is [`Self::between_like`] to the bit. What a soft cell sees of v is
    /// rounded by ε times the ratio of impedances.
    #[inline(always)]
    pub(crate) fn between([z, y]: [N; 2], waves: [N; 2]) -> [Self; 2] {
        let reflection = (y - z) / (y + z);
        let Self { difference, sum } = Self::between_like(waves);
        let sum = sum - reflection * difference;
        [
            Self { difference: (N::ONE - reflection) * difference, sum },
            Self { difference: (N::ONE + reflection) * difference, sum },
        ]
    }

    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &Joint<T::Lanes>) -> Self
    where
        N: Vector<T>,
    {
        Self { difference: N::load(&from.difference), sum: N::load(&from.sum) }
    }

    #[inline(always)]
    pub(crate) fn store<T: Real>(self, to: &mut Joint<T::Lanes>)
    where
        N: Vector<T>,
    {
        self.difference.store(&mut to.difference);
        self.sum.store(&mut to.sum);
    }
}

/// A cell after the step between its joints.
#[inline(always)]
pub(crate) fn updated<N: Number>(
    own: State<N>,
    [left, right]: [Joint<N>; 2],
    cell: &Cell<N>,
) -> State<N> {
    State {
        velocity: own.velocity + cell.to_velocity * (right.sum - left.sum),
        stress: own.stress + cell.half_courant * (right.difference - left.difference),
    }
}

/// The joints of a face as the cells to its left and to its right see them, from the four cells around it.
fn face<T: Real>(states: [State<T>; 4], cells: [&Cell<T>; 4], slopes: Slopes) -> [Joint<T>; 2] {
    let [_, left, right, _] = cells;
    let known = slopes.known([states[0], states[1], states[2]], [cells[0], left, right]);
    let (reach, _) = slopes.reach_between_media(known, [states[1], states[2], states[3]], cells);
    Joint::between([left.impedance, right.impedance], reach)
}

/// Mean stress times mean velocity over the step, W/m².
fn work<T: Real>(joint: &Joint<T>, cell: &Cell<T>) -> f64 {
    joint.sum.wide() * joint.difference.wide() / (4.0 * cell.impedance.wide())
}

/// Mean stress times mean velocity over the step at the face in the middle of four cells, W/m²; positive towards the
/// first of them. Of these one is constant on sides that do work, so that this is their work; on open sides it
/// leaves out what the change of the wave during a step carries away.
pub(crate) fn work_between<T: Real>(
    states: [State<T>; 4],
    cells: [Cell<T>; 4],
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
    cells: &[Cell<T>],
    slopes: Slopes,
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
    // The face behind a place, from old states.
    let behind = |states: [State<T>; 4], place: usize| {
        let around = std::array::from_fn(|i| &cells[place - 2 + i]);
        face(states, around, slopes)
    };
    let mut around: [State<T>; 4] = std::array::from_fn(|i| state(velocity, stress, first - 2 + i));
    let mut left = behind(around, first);
    for place in first..end {
        let own = around[2];
        around = [around[1], own, around[3], state(velocity, stress, place + 2)];
        let right = behind(around, place + 1);
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
    [left, right]: [&Joint<T>; 2],
    cell: &Cell<T>,
) -> f64 {
    let z = cell.impedance.wide();
    // s − zv with sign −1, s + zv with sign 1.
    let by_wave = |sign: f64| {
        let wave = |own: State<T>| own.stress.wide() + sign * z * own.velocity.wide();
        let flux = |joint: &Joint<T>| 0.5 * (joint.sum.wide() + sign * joint.difference.wide());
        let (left, right) = (flux(left), flux(right));
        let outflow = -sign * (right - left);
        outflow * ((wave(states[0]) + wave(states[1])) - (left + right))
    };
    (by_wave(-1.0) + by_wave(1.0)) / (4.0 * z)
}

/// The energy of the cells of a line without its ghosts, in the unit of the [`Account`].
pub fn energy<T: Real>(velocity: &[T], stress: &[T], cells: &[Cell<T>]) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::Joint;

    /// Sums and products with what is exactly zero or one change nothing, signs of zeros included.
    #[test]
    fn a_joint_of_like_cells_is_the_same_to_the_bit() {
        let numbers = [0.0, -0.0, 1.0, -1.0 / 3.0, 1e-310, -7e200, 0.1, -0.1];
        for (left, right) in numbers.iter().flat_map(|l| numbers.map(|r| (*l, r))) {
            let like: Joint<f64> = Joint::between_like([left, right]);
            for seen in Joint::between([0.7; 2], [left, right]) {
                assert_eq!(seen.difference.to_bits(), like.difference.to_bits());
                assert_eq!(seen.sum.to_bits(), like.sum.to_bits());
            }
        }
    }
}
