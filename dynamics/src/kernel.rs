//! The sweep of [`crate::line`] on many lines at once, in the instructions that the processor has.
//!
//! Cells lie in groups, as many as fill a line of the cache, and whichever axis is swept, the neighbours of
//! a group's cells are the cells of another group in the same lanes: a walk from group to group moves as
//! many lines as there are lanes, and none of them looks at another. Every cell sees what the plain sweep
//! does, in the same order: the bits are the same.

use crate::line::{Cell, GHOSTS, Pieces, Slopes, State, Waves, Weights, meet, updated};
use crate::real::{Number, Real};
use std::ops::Range;

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
    pub(crate) fn cell(&self, pattern: u32, wave: &Wave) -> &Cell<T::Lanes> {
        &self.cells[pattern as usize * self.waves + wave.constants]
    }

    #[inline(always)]
    pub(crate) fn ratio(&self, pattern: u32, wave: &Wave, follower: usize) -> T::Lanes {
        self.ratios[pattern as usize * self.followers + wave.ratios + follower]
    }
}

/// How many groups ahead of the one at hand numbers are called for: rows and layers lie too far apart for
/// the processor to guess what comes next.
const AHEAD: usize = 4;

/// Calls for what stands so far behind the beginning of a slice, whether there is anything or not.
#[inline(always)]
fn fetch<N>(from: &[N], distance: usize) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the address is not read from; the instruction does nothing where it is not one of ours.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        _mm_prefetch::<_MM_HINT_T0>(from.as_ptr().wrapping_add(distance).cast());
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (from, distance);
}

/// A velocity and a stress of a group.
pub(crate) type Ghost<N> = [N; 2];

/// What a walk along a line carries from a group to the next, by wave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<N> {
    /// The group behind, not yet written.
    behind: State<N>,
    /// The group at hand.
    own: State<N>,
    /// From the group behind to the one at hand.
    difference: State<N>,
    /// What leaves the group behind towards the one at hand.
    to_right: N,
    /// The joint in front of the group behind.
    joint: State<N>,
}

impl<N: Number> Carried<N> {
    /// Nothing.
    pub(crate) fn empty() -> Self {
        let zero = State { velocity: N::ZERO, stress: N::ZERO };
        Self { behind: zero, own: zero, difference: zero, to_right: N::ZERO, joint: zero }
    }

    /// On to the next group: the one behind as it is after the step. Differences on both sides of the
    /// group at hand are given in its own waves.
    #[inline(always)]
    fn pass(
        &mut self,
        next: State<N>,
        around: [Waves<N>; 2],
        [behind, cell]: [&Cell<N>; 2],
        (weights, slopes): (&Weights<N>, Slopes),
    ) -> State<N> {
        let pieces = Pieces::new(self.own, around, cell, slopes);
        let joint = meet(weights, [self.to_right, pieces.to_left(cell)]);
        let moved = updated(self.behind, [self.joint, joint], behind);
        let to_right = pieces.to_right(cell);
        *self =
            Self { behind: self.own, own: next, difference: self.own.to(next), to_right, joint };
        moved
    }
}

/// Lines that lie side by side, and the part of their way that is to be gone.
pub(crate) struct Lines<'a, T: Real> {
    pub(crate) data: &'a mut [T::Lanes],
    /// Fields of a group.
    pub(crate) fields: usize,
    pub(crate) table: &'a Table<T>,
    pub(crate) waves: &'a [Wave],
    pub(crate) slopes: Slopes,
    /// Of all groups.
    pub(crate) patterns: &'a [u32],
    /// The first group of the first line: those of the other lines follow.
    pub(crate) first: usize,
    /// Groups from one of a line to the next one.
    pub(crate) stride: usize,
    /// Groups of a line.
    pub(crate) count: usize,
    /// The groups to be at hand one after the other, of −1 to `count`: the one behind is written, the one
    /// after is read.
    pub(crate) places: Range<isize>,
    /// Beyond the ends, by line, end, depth and wave.
    pub(crate) ghosts: &'a [Ghost<T::Lanes>],
    /// By line, end and depth.
    pub(crate) ghost_patterns: &'a [u32],
    /// By line and wave.
    pub(crate) carried: &'a mut [Carried<T::Lanes>],
}

impl<T: Real> Work for Lines<'_, T> {
    /// Loops of their own for all kinds of slopes.
    #[inline(always)]
    fn run(self) {
        match self.slopes {
            Slopes::Godunov => self.walk(Slopes::Godunov),
            Slopes::Limited => self.walk(Slopes::Limited),
            Slopes::Unlimited => self.walk(Slopes::Unlimited),
        }
    }
}

impl<T: Real> Lines<'_, T> {
    /// In runs through groups of one pattern, and single steps from one to another and at the ends.
    #[inline(always)]
    fn walk(mut self, slopes: Slopes) {
        let Range { start, end } = self.places;
        // Where the group behind and the one after are there.
        let inner = 1..self.count as isize - 1;
        for line in 0..self.carried.len() / self.waves.len().max(1) {
            let mut place = start;
            while place < end {
                let pattern = self.pattern(line, place);
                if !inner.contains(&place) || self.pattern(line, place - 1) != pattern {
                    self.step(line, place, slopes);
                    place += 1;
                    continue;
                }
                let mut run = place as usize..place as usize + 1;
                let most = end.min(inner.end) as usize;
                while run.end < most && self.pattern(line, run.end as isize) == pattern {
                    run.end += 1;
                }
                place = run.end as isize;
                for index in 0..self.waves.len() {
                    // Loops of their own for all numbers of followers.
                    match self.waves[index].followers.len() {
                        0 => self.run_through::<0>(line, run.clone(), (index, pattern), slopes),
                        1 => self.run_through::<1>(line, run.clone(), (index, pattern), slopes),
                        _ => self.run_through::<2>(line, run.clone(), (index, pattern), slopes),
                    }
                }
            }
        }
    }

    /// The group at a place of a line, or else which ghost stands there.
    #[inline(always)]
    fn group(&self, line: usize, place: isize) -> Result<usize, usize> {
        match usize::try_from(place) {
            Ok(place) if place < self.count => Ok(self.first + line + place * self.stride),
            Ok(place) => Err((2 * line + 1) * GHOSTS + place - self.count),
            Err(_) => Err(2 * line * GHOSTS + (-1 - place) as usize),
        }
    }

    #[inline(always)]
    fn pattern(&self, line: usize, place: isize) -> u32 {
        match self.group(line, place) {
            Ok(group) => self.patterns[group],
            Err(ghost) => self.ghost_patterns[ghost],
        }
    }

    #[inline(always)]
    fn read(&self, line: usize, place: isize, wave: usize) -> State<T::Lanes> {
        let own = &self.waves[wave];
        match self.group(line, place) {
            Ok(group) => {
                let group = &self.data[group * self.fields..][..self.fields];
                State { velocity: group[own.velocity], stress: group[own.stress] }
            }
            Err(ghost) => {
                let [velocity, stress] = self.ghosts[ghost * self.waves.len() + wave];
                State { velocity, stress }
            }
        }
    }

    /// A step, whatever there is around.
    #[inline(always)]
    fn step(&mut self, line: usize, place: isize, slopes: Slopes) {
        let [behind, here] = [place - 1, place].map(|place| self.pattern(line, place));
        for (index, wave) in self.waves.iter().enumerate() {
            let slot = line * self.waves.len() + index;
            if place < 0 {
                let [first, own] = [-2, -1].map(|place| self.read(line, place, index));
                self.carried[slot] = Carried { own, difference: first.to(own), ..Carried::empty() };
            }
            let mut carried = self.carried[slot];
            let next = self.read(line, place + 1, index);
            let cells = [behind, here].map(|pattern| self.table.cell(pattern, wave));
            let weights = if behind == here {
                cells[1].between
            } else {
                Weights::new(cells[0].impedance, cells[1].impedance)
            };
            let around =
                [carried.difference, carried.own.to(next)].map(|own| Waves::of(own, cells[1]));
            let before = carried.behind;
            let moved = carried.pass(next, around, cells, (&weights, slopes));
            self.carried[slot] = carried;
            if let Ok(group) = self.group(line, place - 1) {
                let change = moved.stress - before.stress;
                let group = &mut self.data[group * self.fields..][..self.fields];
                (group[wave.velocity], group[wave.stress]) = (moved.velocity, moved.stress);
                for (index, &place) in wave.followers.iter().enumerate() {
                    group[place] = group[place] + self.table.ratio(behind, wave, index) * change;
                }
            }
        }
    }

    /// A wave on its way through groups of one pattern.
    #[inline(always)]
    fn run_through<const FOLLOWERS: usize>(
        &mut self,
        line: usize,
        run: Range<usize>,
        (index, pattern): (usize, u32),
        slopes: Slopes,
    ) {
        let wave = &self.waves[index];
        let cell = *self.table.cell(pattern, wave);
        let ratios: [_; FOLLOWERS] =
            std::array::from_fn(|follower| self.table.ratio(pattern, wave, follower));
        let followers: [usize; FOLLOWERS] = std::array::from_fn(|i| wave.followers[i]);
        let (velocity, stress) = (wave.velocity, wave.stress);
        let slot = line * self.waves.len() + index;
        let mut carried = self.carried[slot];
        let mut before = Waves::of(carried.difference, &cell);
        let step = self.stride * self.fields;
        let mut behind = (self.first + line + (run.start - 1) * self.stride) * self.fields;
        for _ in run {
            let next = &self.data[behind + 2 * step..][..self.fields];
            for place in [velocity, stress] {
                fetch(next, AHEAD * self.fields + place);
            }
            let next = State { velocity: next[velocity], stress: next[stress] };
            let after = Waves::of(carried.own.to(next), &cell);
            let unmoved = carried.behind.stress;
            let moved =
                carried.pass(next, [before, after], [&cell, &cell], (&cell.between, slopes));
            let group = &mut self.data[behind..][..self.fields];
            (group[velocity], group[stress]) = (moved.velocity, moved.stress);
            if FOLLOWERS > 0 {
                let change = moved.stress - unmoved;
                for (place, ratio) in followers.into_iter().zip(ratios) {
                    group[place] = group[place] + ratio * change;
                }
            }
            before = after;
            behind += step;
        }
        self.carried[slot] = carried;
    }
}
