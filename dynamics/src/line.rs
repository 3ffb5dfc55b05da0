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
//!
//! What is written here is arithmetic on [`Number`]s: [`sweep`] does it to a line, cell by cell, and
//! keeps the account; [`crate::kernel`] does the same to many lines at once.

use crate::real::{Group, Number, Real, Vector};

/// Cells beyond each end of a line that a sweep reads.
pub const GHOSTS: usize = 2;

/// Layers of a halo for each step of a pass: so many ghosts for each of both sweeps along the last axis.
pub const HALO: usize = 2 * GHOSTS;

/// How waves are reconstructed in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slopes {
    /// Constant: first order (Godunov 1959).
    Godunov,
    /// The mean of the differences to both sides within what makes no new extrema, and zero at extrema:
    /// monotonised central (van Leer 1977), with the bounds that depend on the Courant number (Roe 1985). Those
    /// that do not, twice the smaller difference, take more of smooth crests.
    Limited,
    /// The mean of the differences to both sides (Fromm 1968): second order.
    Unlimited,
}

impl Slopes {
    /// How much what leaves a cell during the step is beyond its mean, in the direction of its way: 1 − C times
    /// half the slope, by the differences from the cell upwind and to the one downwind.
    ///
    /// With leads l a wave w in cell i becomes w − C(w + l − w′ − l′), w′ and l′ being those of the cell upwind. Of
    /// one sign with d = w − w′ and within l ≤ d(1 − C)/C and l′ ≤ d, the leads make that a mean of w and w′ with
    /// weights from 0 to 1 (Harten 1983): nothing new stands out.
    #[inline(always)]
    pub(crate) fn lead<N: Number>(self, [upwind, downwind]: [N; 2], cell: &Cell<N>) -> N {
        let mean = cell.mean_slope * (upwind + downwind);
        match self {
            Self::Godunov => N::ZERO,
            Self::Unlimited => mean,
            Self::Limited => mean.bounded(cell.steepest * upwind, downwind),
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
            Self::Godunov => N::ZERO,
            Self::Unlimited => mean,
            Self::Limited => {
                let most = cell.mean_slope + N::HALF * cell.mean_slope;
                let steepest = cell.steepest + contrast * (most - cell.steepest);
                let foremost = N::ONE + contrast * (most - N::ONE);
                mean.bounded(steepest * upwind, foremost * downwind)
            }
        }
    }
}

/// What a cell is to a pair of waves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<N> {
    /// z, kg/(m²s) for translations.
    pub impedance: N,
    /// C/2: change of s per difference of 2zv between the joints.
    pub(crate) half_courant: N,
    /// C/(2z): change of v per difference of 2s between the joints.
    pub(crate) to_velocity: N,
    /// (1 − C)/4: of the sum of the differences to both sides, what leads if nothing bounds it.
    pub(crate) mean_slope: N,
    /// (1 − C)/C: of the difference upwind, what may lead.
    pub(crate) steepest: N,
}

impl<T: Real> Cell<T> {
    /// A cell by its impedance, kg/(m²s) for translations, and its Courant number in \[0, 1\].
    pub fn new(impedance: f64, courant: f64) -> Self {
        Self {
            impedance: T::of(impedance),
            half_courant: T::of(0.5 * courant),
            to_velocity: T::of(0.5 * courant / impedance),
            mean_slope: T::of(0.25 * (1.0 - courant)),
            // Nothing moves without speed, and nothing is infinite.
            steepest: T::of((1.0 - courant) / courant.max(1e-6)),
        }
    }

    /// C = cΔt/h, in \[0, 1\].
    pub fn courant(&self) -> T {
        self.half_courant + self.half_courant
    }
}

impl<V: Number> Cell<V> {
    /// 1 where another cell has another impedance or Courant number, 0 where it has the same.
    #[inline(always)]
    pub(crate) fn contrast(&self, other: &Self) -> V {
        let impedance = other.impedance - self.impedance;
        let courant = other.half_courant - self.half_courant;
        let size = impedance * impedance + courant * courant;
        (size * (V::ONE / V::LEAST)).least(V::ONE)
    }

    /// Those of a lane of a group.
    #[inline(always)]
    pub(crate) fn lane<T: Real>(&self, lane: usize) -> Cell<T>
    where
        V: Group<T>,
    {
        Cell {
            impedance: self.impedance.lanes()[lane],
            half_courant: self.half_courant.lanes()[lane],
            to_velocity: self.to_velocity.lanes()[lane],
            mean_slope: self.mean_slope.lanes()[lane],
            steepest: self.steepest.lanes()[lane],
        }
    }

    /// Sets those of a lane.
    #[inline(always)]
    pub(crate) fn set_lane<T: Real>(&mut self, lane: usize, own: &Cell<T>)
    where
        V: Group<T>,
    {
        self.impedance.lanes_mut()[lane] = own.impedance;
        self.half_courant.lanes_mut()[lane] = own.half_courant;
        self.to_velocity.lanes_mut()[lane] = own.to_velocity;
        self.mean_slope.lanes_mut()[lane] = own.mean_slope;
        self.steepest.lanes_mut()[lane] = own.steepest;
    }

    /// Those of a group.
    #[inline(always)]
    pub(crate) fn load<T: Real>(from: &Cell<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self {
            impedance: V::load(&from.impedance),
            half_courant: V::load(&from.half_courant),
            to_velocity: V::load(&from.to_velocity),
            mean_slope: V::load(&from.mean_slope),
            steepest: V::load(&from.steepest),
        }
    }
}

/// What a sweep does to energy, W/m² of the line's cross-section: times the time step J/m².
///
/// With the energy of a cell in the same unit, h(½mv² + ½s²/M)/Δt = (zv² + s²/z)/(2C):
/// energy after − energy before = inflow + gained − lost, to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Account {
    /// Work of the stress at the ends of the line over the step, positive inwards.
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

/// Cell by cell.
impl<'a> std::iter::Sum<&'a Self> for Account {
    fn sum<I: Iterator<Item = &'a Self>>(accounts: I) -> Self {
        accounts.fold(Self::default(), |sum, own| Self {
            inflow: sum.inflow + own.inflow,
            gained: sum.gained + own.gained,
            lost: sum.lost + own.lost,
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
#[derive(Clone, Copy)]
pub(crate) struct Waves<N> {
    pub(crate) right: N,
    pub(crate) left: N,
}

impl<N: Number> Waves<N> {
    #[inline(always)]
    pub(crate) fn of(state: State<N>, cell: &Cell<N>) -> Self {
        let zv = cell.impedance * state.velocity;
        Self { right: state.stress - zv, left: state.stress + zv }
    }

    /// The waves of a neighbour, continued across the interface with it as what scattering there makes of them, with
    /// the coefficient of reflection ρ = (y − z)/(y + z): the wave that comes from there is joined by the reflection
    /// of the own one that runs there, w = (1 − ρ) w′ + ρ ŵ; the one that runs there has the waves that leave the
    /// interface before it, reversed in time, which is the same formula. Unfolded like this a line has no interface:
    /// scattering keeps energy.
    #[inline(always)]
    fn continued(self, cell: &Cell<N>, neighbour: State<N>, its: &Cell<N>) -> Self {
        let reflection = (its.impedance - cell.impedance) / (its.impedance + cell.impedance);
        let waves = Self::of(neighbour, its);
        Self {
            right: waves.right + reflection * (self.left - waves.right),
            left: waves.left + reflection * (self.right - waves.left),
        }
    }

    /// The difference to the next cell.
    #[inline(always)]
    pub(crate) fn to(self, next: Self) -> Self {
        Self { right: next.right - self.right, left: next.left - self.left }
    }
}

/// Both waves in a cell, and how much what leaves it during the step is beyond their means.
#[derive(Clone, Copy)]
pub(crate) struct Pieces<N> {
    mean: Waves<N>,
    lead: Waves<N>,
}

impl<N: Number> Pieces<N> {
    /// From a cell's own waves, and the differences of the waves from the cell before and to the cell after it, of
    /// the same medium.
    #[inline(always)]
    pub(crate) fn new(
        mean: Waves<N>,
        [before, after]: [Waves<N>; 2],
        cell: &Cell<N>,
        slopes: Slopes,
    ) -> Self {
        let lead = Waves {
            right: slopes.lead([before.right, after.right], cell),
            left: slopes.lead([after.left, before.left], cell),
        };
        Self { mean, lead }
    }

    /// From the states of the cell before, of the cell, and of the cell after it, which may be of other media.
    #[inline(always)]
    pub(crate) fn of(
        [before, own, after]: [State<N>; 3],
        [cell_before, cell, cell_after]: [&Cell<N>; 3],
        slopes: Slopes,
    ) -> Self {
        let mean = Waves::of(own, cell);
        let before = mean.continued(cell, before, cell_before).to(mean);
        let after = mean.to(mean.continued(cell, after, cell_after));
        let contrast = cell.contrast(cell_before).greatest(cell.contrast(cell_after));
        let lead = Waves {
            right: slopes.lead_at_contrast([before.right, after.right], cell, contrast),
            left: slopes.lead_at_contrast([after.left, before.left], cell, contrast),
        };
        Self { mean, lead }
    }

    /// Mean over the step of what leaves to the right: the foremost part of length C.
    #[inline(always)]
    pub(crate) fn to_right(self) -> N {
        self.mean.right + self.lead.right
    }

    /// The same to the left.
    #[inline(always)]
    pub(crate) fn to_left(self) -> N {
        self.mean.left - self.lead.left
    }
}

impl<T: Real> Pieces<T> {
    /// The slopes of both over the whole cell: twice what leads over the part 1 − C that it leads. At Courant
    /// number 1 nothing does.
    fn slopes(&self, cell: &Cell<T>) -> Waves<T> {
        let staying = T::ONE - cell.courant();
        let slope = |lead: T| if staying > T::ZERO { (lead + lead) / staying } else { T::ZERO };
        Waves { right: slope(self.lead.right), left: slope(self.lead.left) }
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

/// What the cells to the left and to the right of a face see there: the mean over the step, and its change during
/// the step.
#[derive(Clone, Copy)]
struct Face<T> {
    mean: [Joint<T>; 2],
    change: [Joint<T>; 2],
    /// z to the left.
    impedance: T,
}

impl<T: Real> Face<T> {
    fn new([(own, cell), (other, next)]: [(&Pieces<T>, &Cell<T>); 2]) -> Self {
        let impedances = [cell.impedance, next.impedance];
        let changes =
            [-(cell.courant() * own.slopes(cell).right), next.courant() * other.slopes(next).left];
        Self {
            mean: Joint::between(impedances, [own.to_right(), other.to_left()]),
            change: Joint::between(impedances, changes),
            impedance: cell.impedance,
        }
    }

    /// ∫ s v dt over the step, per Δt: both are straight in time.
    fn work(&self) -> f64 {
        self.mean_work() + self.product(&self.change[0]) / 12.0
    }

    /// Mean s times mean v.
    fn mean_work(&self) -> f64 {
        self.product(&self.mean[0])
    }

    fn product(&self, joint: &Joint<T>) -> f64 {
        joint.sum.wide() * joint.difference.wide() / (4.0 * self.impedance.wide())
    }
}

/// Mean stress times mean velocity over the step at the joint in the middle of four cells, W/m²; positive towards the
/// first of them. Of these one is constant on sides that do work, so that this is their work; on open sides it
/// leaves out what the change of the wave during a step carries away.
pub(crate) fn work_between<T: Real>(
    states: [State<T>; 4],
    cells: [Cell<T>; 4],
    slopes: Slopes,
) -> f64 {
    let [left, right] = [0, 1].map(|i| {
        let around = [&cells[i], &cells[i + 1], &cells[i + 2]];
        Pieces::of([states[i], states[i + 1], states[i + 2]], around, slopes)
    });
    Face::new([(&left, &cells[1]), (&right, &cells[2])]).mean_work()
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
    let [before, ghost] = [2, 1].map(|depth| state(velocity, stress, first - depth));
    let (mut own, mut after) = (state(velocity, stress, first), state(velocity, stress, first + 1));
    let around = |place: usize| [&cells[place - 1], &cells[place], &cells[place + 1]];
    let front = Pieces::of([before, ghost, own], around(first - 1), slopes);
    let mut here = Pieces::of([ghost, own, after], around(first), slopes);
    let mut left = Face::new([(&front, &cells[first - 1]), (&here, &cells[first])]);
    for place in first..end {
        let beyond = state(velocity, stress, place + 2);
        let next = Pieces::of([own, after, beyond], around(place + 1), slopes);
        let right = Face::new([(&here, &cells[place]), (&next, &cells[place + 1])]);
        let moved = updated(own, [left.mean[1], right.mean[0]], &cells[place]);
        (velocity[place], stress[place]) = (moved.velocity, moved.stress);
        if let Some(account) = accounts.as_deref_mut().and_then(|all| all.get_mut(place - first)) {
            if place == first {
                account.inflow -= left.work();
            }
            if place + 1 == end {
                account.inflow += right.work();
            }
            note(account, &here, &cells[place], [&left, &right]);
        }
        (own, after, here, left) = (after, beyond, next, right);
    }
}

/// Adds what a cell gains and loses.
fn note<T: Real>(
    account: &mut Account,
    own: &Pieces<T>,
    cell: &Cell<T>,
    [left, right]: [&Face<T>; 2],
) {
    let (z, c) = (cell.impedance.wide(), cell.courant().wide());
    if c == 0.0 {
        // Nothing moves, and nothing is averaged.
        return;
    }
    // h·w²/(4M) per Δt.
    let unit = 0.25 / (z * c);
    let square = |x: f64| x * x;
    let slopes = own.slopes(cell);
    let [right_slope, left_slope] = [slopes.right, slopes.left].map(Real::wide);
    let slopes = square(right_slope) + square(left_slope);
    account.gained += unit * slopes / 12.0;
    // What came in occupies C of the cell, what stayed the rest.
    let variance = |came: [f64; 2], stayed: [f64; 2]| {
        let rest = 1.0 - c;
        c * rest * square(came[0] - stayed[0])
            + (c * square(came[1]) + rest * square(stayed[1])) / 12.0
    };
    // s − zv from the left, s + zv from the right.
    let came = |joints: [Joint<T>; 2], sign: f64| {
        joints.map(|joint| 0.5 * (joint.sum.wide() + sign * joint.difference.wide()))
    };
    let stayed = |value: T, slope: f64, sign: f64| {
        [value.wide() - sign * 0.5 * c * slope, (1.0 - c) * slope]
    };
    let from_left = came([left.mean[1], left.change[1]], -1.0);
    let from_right = came([right.mean[0], right.change[0]], 1.0);
    account.lost += unit
        * (variance(from_left, stayed(own.mean.right, right_slope, 1.0))
            + variance(from_right, stayed(own.mean.left, left_slope, -1.0)));
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
