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
            for group in 0..groups {
                let pattern = self.pattern(here, group);
                for (index, wave) in waves.iter().enumerate() {
                    let cell = table.cell(pattern, wave);
                    let own = self.read(here, group, index);
                    let difference = own.to(self.read(after, group, index));
                    let carried = self.carried[group * waves.len() + index];
                    let [velocity, stress] = carried.difference;
                    let differences = [State { velocity, stress }, difference];
                    let pieces = Pieces::new(own, differences, cell, slopes);
                    let mut joint = carried.joint;
                    if place >= 0 {
                        let previous = table.cell(self.pattern(before, group), wave);
                        let met = meet(
                            [previous.impedance, carried.to_right],
                            [cell.impedance, pieces.to_left(cell)],
                        );
                        joint = [met.velocity, met.stress];
                        if let (Row::Inside(row), true) = (before, place >= 1) {
                            let joints = [carried.joint, joint]
                                .map(|[velocity, stress]| State { velocity, stress });
                            let pattern = self.pattern(before, group);
                            let group = (row * groups + group) * fields;
                            write(
                                &mut self.data[group..group + fields],
                                joints,
                                previous,
                                (table, wave, pattern),
                            );
                        }
                    }
                    self.carried[group * waves.len() + index] = Carried {
                        difference: [difference.velocity, difference.stress],
                        to_right: pieces.to_right(cell),
                        joint,
                    };
                }
            }
        }
    }
}

/// Updates a wave of a group between its joints, and what follows the stress in the medium's own ratio.
#[inline(always)]
fn write<T: Real>(
    group: &mut [T::Lanes],
    joints: [State<T::Lanes>; 2],
    cell: Cell<T::Lanes>,
    (table, wave, pattern): (&Table<T>, &Wave, u32),
) {
    let own = State { velocity: group[wave.velocity], stress: group[wave.stress] };
    let moved = updated(own, joints, cell);
    (group[wave.velocity], group[wave.stress]) = (moved.velocity, moved.stress);
    for (index, &place) in wave.followers.iter().enumerate() {
        let change = moved.stress - own.stress;
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

/// Differences from each lane to the one behind it.
#[inline(always)]
fn differences<T, N: Group<T>>(own: State<N>, next: State<N>) -> State<N> {
    own.to(State {
        velocity: own.velocity.before(next.velocity),
        stress: own.stress.before(next.stress),
    })
}

/// The joints behind each lane, the last of them with what the group behind has and sends.
#[inline(always)]
fn joints<T, N: Group<T>>(own: &Passing<N>, impedance: N, to_left: N) -> State<N> {
    meet(
        [own.cell.impedance, own.to_right],
        [own.cell.impedance.before(impedance), own.to_left.before(to_left)],
    )
}

impl<T: Real> Rows<'_, T> {
    #[inline(always)]
    fn pass(
        axis: &Axis<'_, T>,
        wave: &Wave,
        own: State<T::Lanes>,
        [before, difference]: [State<T::Lanes>; 2],
        pattern: u32,
        slopes: Slopes,
    ) -> Passing<T::Lanes> {
        let cell = axis.table.cell(pattern, wave);
        let pieces = Pieces::new(own, [after(difference, before), difference], cell, slopes);
        let (to_right, to_left) = (pieces.to_right(cell), pieces.to_left(cell));
        Passing { cell, pattern, difference, to_right, to_left }
    }

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
                let difference = differences(front, own);
                let pattern = self.front_patterns[index];
                let mut previous =
                    Self::pass(&self.axis, wave, front, [zero, difference], pattern, slopes);
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
                            let pair = [previous.difference, differences(own, next)];
                            Self::pass(&self.axis, wave, own, pair, pattern, slopes)
                        }
                        None => Passing { to_left: T::Lanes::ZERO, ..previous },
                    };
                    let right = joints(&previous, here.cell.impedance, here.to_left);
                    if group > 0 {
                        let range = (group - 1) * fields..group * fields;
                        let constants = (table, wave, previous.pattern);
                        let both = [after(right, left), right];
                        write(&mut row[range], both, previous.cell, constants);
                    }
                    (left, previous, own) = (right, here, next);
                }
            }
        }
    }
}
