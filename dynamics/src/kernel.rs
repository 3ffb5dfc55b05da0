//! The sweep of [`crate::line`] on many lines at once, in the instructions that the processor has.
//!
//! Cells lie in groups along the first axis, as many as fill a line of the cache. Across that axis the
//! lanes of a group are lines of their own (`Columns`); along it they are neighbours, and what a lane
//! needs of its neighbour comes by a shift (`Rows`). Both do to every cell what the plain sweep does, in
//! the same order: the bits are the same.

use crate::line::{Cell, GHOSTS, Pieces, Slopes, State, meet, updated};
use crate::real::{Group, Number, Real};

/// Sets of instructions that a processor may have. Results do not depend on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instructions {
    /// What every processor of the kind has.
    Baseline,
    /// 256 bits at once.
    Avx2,
    /// 512 bits at once.
    Avx512,
}

impl Instructions {
    /// Whether this processor has the set.
    pub fn is_available(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return match self {
            Self::Baseline => true,
            Self::Avx2 => is_x86_feature_detected!("avx2"),
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
        };
        #[cfg(not(target_arch = "x86_64"))]
        return self == Self::Baseline;
    }

    /// The sets that this processor has, the widest last.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Baseline, Self::Avx2, Self::Avx512].into_iter().filter(|set| set.is_available())
    }

    /// The widest set that this processor has.
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Baseline)
    }

    /// Does the work in these instructions, or in the baseline's where the processor has not got them.
    pub(crate) fn run(self, work: impl Work) {
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2")]
            fn avx2(work: impl Work) {
                work.run();
            }
            #[target_feature(enable = "avx512f,avx512dq,avx512vl")]
            fn avx512(work: impl Work) {
                work.run();
            }
            match self {
                // SAFETY: the processor has AVX2.
                Self::Avx2 if self.is_available() => unsafe { avx2(work) },
                // SAFETY: the processor has all three.
                Self::Avx512 if self.is_available() => unsafe { avx512(work) },
                _ => work.run(),
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        work.run();
    }
}

/// Something to be done in any set of instructions: `run` and all that it calls must be inlined.
pub(crate) trait Work {
    fn run(self);
}

/// Where the fields of a pair of waves stand in a group, and its constants in the table.
#[derive(Clone, Debug)]
pub(crate) struct Wave {
    pub(crate) velocity: usize,
    pub(crate) stress: usize,
    pub(crate) followers: Vec<usize>,
    /// Place of the constants among those of a pattern.
    pub(crate) constants: usize,
    /// Place of the first follower's ratio among those of a pattern.
    pub(crate) ratios: usize,
}

/// Constants of the media by pattern: which medium each lane of a group has.
#[derive(Clone, Debug)]
pub(crate) struct Table<T: Real> {
    pub(crate) cells: Vec<Cell<T::Lanes>>,
    /// Constants of a pattern.
    pub(crate) waves: usize,
    pub(crate) ratios: Vec<T::Lanes>,
    /// Ratios of a pattern.
    pub(crate) followers: usize,
}

impl<T: Real> Table<T> {
    #[inline(always)]
    pub(crate) fn cell(&self, pattern: u32, wave: &Wave) -> Cell<T::Lanes> {
        self.cells[pattern as usize * self.waves + wave.constants]
    }

    #[inline(always)]
    fn ratio(&self, pattern: u32, wave: &Wave, follower: usize) -> T::Lanes {
        self.ratios[pattern as usize * self.followers + wave.ratios + follower]
    }
}

/// What all sweeps along an axis read.
#[derive(Clone, Copy)]
pub(crate) struct Axis<'a, T: Real> {
    pub(crate) table: &'a Table<T>,
    pub(crate) waves: &'a [Wave],
    pub(crate) slopes: Slopes,
    /// Patterns of the groups of all rows.
    pub(crate) patterns: &'a [u32],
    /// Groups of a row.
    pub(crate) groups: usize,
    /// Fields of a group.
    pub(crate) fields: usize,
}

/// Loops of their own for all kinds of slopes.
macro_rules! by_slopes {
    ($kind:ident) => {
        impl<T: Real> Work for $kind<'_, T> {
            #[inline(always)]
            fn run(self) {
                match self.axis.slopes {
                    Slopes::Godunov => self.go(Slopes::Godunov),
                    Slopes::Limited => self.go(Slopes::Limited),
                    Slopes::Unlimited => self.go(Slopes::Unlimited),
                }
            }
        }
    };
}

by_slopes!(Columns);
by_slopes!(Rows);

/// What a row leaves to the next one, by group and wave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<N> {
    difference: [N; 2],
    to_right: N,
    joint: [N; 2],
}

impl<N: Number> Default for Carried<N> {
    fn default() -> Self {
        Self { difference: [N::ZERO; 2], to_right: N::ZERO, joint: [N::ZERO; 2] }
    }
}

/// Lines across the groups: rows `start`, `start + stride`, … are their cells.
pub(crate) struct Columns<'a, T: Real> {
    pub(crate) axis: Axis<'a, T>,
    pub(crate) data: &'a mut [T::Lanes],
    pub(crate) start: usize,
    pub(crate) stride: usize,
    pub(crate) count: usize,
    /// By end, depth, group and wave: velocity and stress.
    pub(crate) ghosts: &'a [[T::Lanes; 2]],
    /// By end, depth and group.
    pub(crate) ghost_patterns: &'a [u32],
    /// By group and wave.
    pub(crate) carried: &'a mut [Carried<T::Lanes>],
}

/// A row of a column, real or ghost.
#[derive(Clone, Copy)]
enum Row {
    /// Its number among all rows.
    Inside(usize),
    /// Its end and depth as one number.
    Ghost(usize),
}

impl<T: Real> Columns<'_, T> {
    #[inline(always)]
    fn row(&self, place: isize) -> Row {
        match usize::try_from(place) {
            Ok(place) if place < self.count => Row::Inside(self.start + place * self.stride),
            Ok(place) => Row::Ghost(GHOSTS + place - self.count),
            Err(_) => Row::Ghost((-1 - place) as usize),
        }
    }

    #[inline(always)]
    fn read(&self, row: Row, group: usize, wave: usize) -> State<T::Lanes> {
        let Axis { groups, fields, waves, .. } = self.axis;
        match row {
            Row::Inside(row) => {
                let base = (row * groups + group) * fields;
                State {
                    velocity: self.data[base + waves[wave].velocity],
                    stress: self.data[base + waves[wave].stress],
                }
            }
            Row::Ghost(place) => {
                let [velocity, stress] = self.ghosts[(place * groups + group) * waves.len() + wave];
                State { velocity, stress }
            }
        }
    }

    #[inline(always)]
    fn pattern(&self, row: Row, group: usize) -> u32 {
        let groups = self.axis.groups;
        match row {
            Row::Inside(row) => self.axis.patterns[row * groups + group],
            Row::Ghost(place) => self.ghost_patterns[place * groups + group],
        }
    }

    #[inline(always)]
    fn go(self, slopes: Slopes) {
        let Axis { groups, fields, waves, table, .. } = self.axis;
        for group in 0..groups {
            for wave in 0..waves.len() {
                let first = self.read(self.row(-2), group, wave);
                let State { velocity, stress } = first.to(self.read(self.row(-1), group, wave));
                self.carried[group * waves.len() + wave].difference = [velocity, stress];
            }
        }
        // A row is written when what leaves its successor is known; this reads one row further.
        for place in -1..=self.count as isize {
            let (before, here, after) = (self.row(place - 1), self.row(place), self.row(place + 1));
            // In front of the first row nothing is written, and any row will do.
            let before = if place < 0 { here } else { before };
            for group in 0..groups {
                let (pattern, previous) = (self.pattern(here, group), self.pattern(before, group));
                for (index, wave) in waves.iter().enumerate() {
                    let slot = group * waves.len() + index;
                    let crossing = Crossing {
                        previous: table.cell(previous, wave),
                        cell: table.cell(pattern, wave),
                        written: self.read(before, group, index),
                        own: self.read(here, group, index),
                        next: self.read(after, group, index),
                        carried: self.carried[slot],
                    };
                    let (moved, carried) = crossing.passed::<T>(slopes);
                    self.carried[slot] = carried;
                    if let (Row::Inside(row), true) = (before, place >= 1) {
                        let group = (row * groups + group) * fields;
                        let group = &mut self.data[group..group + fields];
                        write(group, moved, (table, wave, previous));
                    }
                }
            }
        }
    }
}

/// What a wave of a group needs on its way across a row.
struct Crossing<N> {
    /// The row before, that is to be written.
    previous: Cell<N>,
    written: State<N>,
    /// The row itself.
    cell: Cell<N>,
    own: State<N>,
    /// The row behind.
    next: State<N>,
    carried: Carried<N>,
}

/// The numbers of a lane.
#[inline(always)]
fn lane_of<T: Real>(state: &State<T::Lanes>, lane: usize) -> State<T> {
    State { velocity: state.velocity.lanes()[lane], stress: state.stress.lanes()[lane] }
}

/// The constants of a lane.
#[inline(always)]
fn cell_of<T: Real>(cell: &Cell<T::Lanes>, lane: usize) -> Cell<T> {
    Cell {
        impedance: cell.impedance.lanes()[lane],
        courant: cell.courant.lanes()[lane],
        rest: cell.rest.lanes()[lane],
        to_velocity: cell.to_velocity.lanes()[lane],
        to_stress: cell.to_stress.lanes()[lane],
    }
}

impl<N: Number> Crossing<N> {
    /// The row before as it is after the step, and what is carried on: one loop over the lanes, which
    /// compilers turn into wide instructions where operations lane by lane defeat them.
    #[inline(always)]
    fn passed<T: Real<Lanes = N>>(&self, slopes: Slopes) -> (State<N>, Carried<N>)
    where
        N: Group<T>,
    {
        let mut moved = [N::ZERO; 2];
        let mut carried: Carried<N> = Carried::default();
        for lane in 0..N::COUNT {
            let cell = cell_of::<T>(&self.cell, lane);
            let previous = cell_of::<T>(&self.previous, lane);
            let own = lane_of::<T>(&self.own, lane);
            let difference = own.to(lane_of::<T>(&self.next, lane));
            let [velocity, stress] = self.carried.difference.each_ref().map(|x| x.lanes()[lane]);
            let before = State { velocity, stress };
            let pieces = Pieces::new(own, [before, difference], cell, slopes);
            let joint = meet(
                [previous.impedance, self.carried.to_right.lanes()[lane]],
                [cell.impedance, pieces.to_left(cell)],
            );
            let [velocity, stress] = self.carried.joint.each_ref().map(|x| x.lanes()[lane]);
            let left = State { velocity, stress };
            let after = updated(lane_of::<T>(&self.written, lane), [left, joint], previous);
            moved[0].lanes_mut()[lane] = after.velocity;
            moved[1].lanes_mut()[lane] = after.stress;
            carried.difference[0].lanes_mut()[lane] = difference.velocity;
            carried.difference[1].lanes_mut()[lane] = difference.stress;
            carried.to_right.lanes_mut()[lane] = pieces.to_right(cell);
            carried.joint[0].lanes_mut()[lane] = joint.velocity;
            carried.joint[1].lanes_mut()[lane] = joint.stress;
        }
        let [velocity, stress] = moved;
        (State { velocity, stress }, carried)
    }
}

/// Writes a wave of a group, and what follows the stress in the medium's own ratio.
#[inline(always)]
fn write<T: Real>(
    group: &mut [T::Lanes],
    moved: State<T::Lanes>,
    (table, wave, pattern): (&Table<T>, &Wave, u32),
) {
    let change = moved.stress - group[wave.stress];
    (group[wave.velocity], group[wave.stress]) = (moved.velocity, moved.stress);
    for (index, &place) in wave.followers.iter().enumerate() {
        group[place] = group[place] + table.ratio(pattern, wave, index) * change;
    }
}

/// Lines along the groups: whole rows, one after the other. Behind the last cell of a row two ghosts stand
/// in the row itself.
pub(crate) struct Rows<'a, T: Real> {
    pub(crate) axis: Axis<'a, T>,
    pub(crate) data: &'a mut [T::Lanes],
    /// Velocity and stress of the group in front of each row, by row and wave; its last two lanes matter.
    pub(crate) fronts: &'a [[T::Lanes; 2]],
    /// Its pattern, by row.
    pub(crate) front_patterns: &'a [u32],
}

/// A group on the way along a row.
#[derive(Clone, Copy)]
struct Passing<N> {
    cell: Cell<N>,
    pattern: u32,
    own: State<N>,
    /// To the next cells.
    difference: State<N>,
    to_right: N,
    to_left: N,
}

/// Each lane's neighbour before it.
#[inline(always)]
fn after<T, N: Group<T>>(own: State<N>, previous: State<N>) -> State<N> {
    State {
        velocity: own.velocity.after(previous.velocity),
        stress: own.stress.after(previous.stress),
    }
}

impl<N: Number> Passing<N> {
    /// A group between the one before it, of which the differences are known, and the one behind.
    #[inline(always)]
    fn new<T: Real<Lanes = N>>(
        own: State<N>,
        [before, next]: [State<N>; 2],
        (cell, pattern): (Cell<N>, u32),
        slopes: Slopes,
    ) -> Self
    where
        N: Group<T>,
    {
        let difference = own.to(State {
            velocity: own.velocity.before(next.velocity),
            stress: own.stress.before(next.stress),
        });
        let before = after(difference, before);
        let (mut to_right, mut to_left) = (N::ZERO, N::ZERO);
        for lane in 0..N::COUNT {
            let constants = cell_of::<T>(&cell, lane);
            let differences = [lane_of::<T>(&before, lane), lane_of::<T>(&difference, lane)];
            let pieces = Pieces::new(lane_of::<T>(&own, lane), differences, constants, slopes);
            to_right.lanes_mut()[lane] = pieces.to_right(constants);
            to_left.lanes_mut()[lane] = pieces.to_left(constants);
        }
        Self { cell, pattern, own, difference, to_right, to_left }
    }

    /// The joints behind each lane, the last of them with what the group behind has and sends.
    #[inline(always)]
    fn joints<T: Real<Lanes = N>>(&self, [impedance, to_left]: [N; 2]) -> State<N>
    where
        N: Group<T>,
    {
        let impedance = self.cell.impedance.before(impedance);
        let to_left = self.to_left.before(to_left);
        let mut met = [N::ZERO; 2];
        for lane in 0..N::COUNT {
            let joint = meet(
                [self.cell.impedance.lanes()[lane], self.to_right.lanes()[lane]],
                [impedance.lanes()[lane], to_left.lanes()[lane]],
            );
            met[0].lanes_mut()[lane] = joint.velocity;
            met[1].lanes_mut()[lane] = joint.stress;
        }
        let [velocity, stress] = met;
        State { velocity, stress }
    }

    /// The group after the step.
    #[inline(always)]
    fn moved<T: Real<Lanes = N>>(&self, [left, right]: [State<N>; 2]) -> State<N>
    where
        N: Group<T>,
    {
        let mut moved = [N::ZERO; 2];
        for lane in 0..N::COUNT {
            let joints = [lane_of::<T>(&left, lane), lane_of::<T>(&right, lane)];
            let constants = cell_of::<T>(&self.cell, lane);
            let state = updated(lane_of::<T>(&self.own, lane), joints, constants);
            moved[0].lanes_mut()[lane] = state.velocity;
            moved[1].lanes_mut()[lane] = state.stress;
        }
        let [velocity, stress] = moved;
        State { velocity, stress }
    }
}

impl<T: Real> Rows<'_, T> {
    #[inline(always)]
    fn go(self, slopes: Slopes) {
        let Axis { groups, fields, waves, table, patterns, .. } = self.axis;
        let zero = State { velocity: T::Lanes::ZERO, stress: T::Lanes::ZERO };
        for (index, row) in self.data.chunks_exact_mut(groups * fields).enumerate() {
            let patterns = &patterns[index * groups..(index + 1) * groups];
            for (place, wave) in waves.iter().enumerate() {
                let [velocity, stress] = self.fronts[index * waves.len() + place];
                let front = State { velocity, stress };
                let mut own = State { velocity: row[wave.velocity], stress: row[wave.stress] };
                let pattern = self.front_patterns[index];
                let constants = (table.cell(pattern, wave), pattern);
                let mut previous = Passing::new::<T>(front, [zero, own], constants, slopes);
                let mut left = zero;
                // A group is written when what leaves its successor is known.
                for group in 0..=groups {
                    let next = match row.get((group + 1) * fields..) {
                        Some(next) if !next.is_empty() => {
                            State { velocity: next[wave.velocity], stress: next[wave.stress] }
                        }
                        _ => zero,
                    };
                    let here = match patterns.get(group) {
                        Some(&pattern) => {
                            let constants = (table.cell(pattern, wave), pattern);
                            let around = [previous.difference, next];
                            Passing::new::<T>(own, around, constants, slopes)
                        }
                        None => Passing { to_left: T::Lanes::ZERO, ..previous },
                    };
                    let right = previous.joints::<T>([here.cell.impedance, here.to_left]);
                    if group > 0 {
                        let moved = previous.moved::<T>([after(right, left), right]);
                        let range = (group - 1) * fields..group * fields;
                        write(&mut row[range], moved, (table, wave, previous.pattern));
                    }
                    (left, previous, own) = (right, here, next);
                }
            }
        }
    }
}
