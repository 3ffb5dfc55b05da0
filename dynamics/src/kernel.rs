//! The sweep of [`crate::line`] on many lines at once, in the instructions that the processor has.
//!
//! Cells lie in groups, as many as fill a line of the cache, and whichever axis is swept, the neighbours of
//! a group's cells are the cells of another group in the same lanes: a walk from group to group moves as
//! many lines as there are lanes, and none of them looks at another. At the ends of a row, where the
//! neighbours are in the next lane, moved copies stand as ghosts. Every cell sees what the plain sweep does, in
//! the same order: the bits are the same.

use crate::line::{Cell, Joint, Pieces, Slopes, State, Waves, updated};
use crate::real::{Number, Real, Vector, Work};
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
    pub(crate) fn run<T: Real>(self, work: impl Work<T>) {
        match self {
            // SAFETY: the processor has AVX2.
            Self::Avx2 if self.is_available() => unsafe { T::avx2(work) },
            // SAFETY: the processor has all three.
            Self::Avx512 if self.is_available() => unsafe { T::avx512(work) },
            _ => work.run::<T::Lanes>(),
        }
    }
}

/// Places of the fields of a pair of waves in a row, and of its constants in the table.
#[derive(Clone, Debug)]
pub(crate) struct Wave {
    pub(crate) velocity: usize,
    pub(crate) stress: usize,
    pub(crate) followers: Vec<usize>,
    /// Place of the constants among those of a pattern.
    pub(crate) constants: usize,
    /// Places of the followers' ratios among those of a pattern.
    pub(crate) ratios: Vec<usize>,
}

/// Constants of the media by pattern: which medium each lane of a group has.
#[derive(Clone, Debug)]
pub(crate) struct Table<T: Real> {
    pub(crate) cells: Vec<Cell<T::Lanes>>,
    /// Constants of a pattern: waves that have the same share them.
    pub(crate) waves: usize,
    pub(crate) ratios: Vec<T::Lanes>,
    /// Ratios of a pattern, shared likewise.
    pub(crate) followers: usize,
}

impl<T: Real> Table<T> {
    #[inline(always)]
    pub(crate) fn cell(&self, pattern: u32, wave: &Wave) -> &Cell<T::Lanes> {
        &self.cells[pattern as usize * self.waves + wave.constants]
    }

    #[inline(always)]
    pub(crate) fn ratio(&self, pattern: u32, wave: &Wave, follower: usize) -> &T::Lanes {
        &self.ratios[pattern as usize * self.followers + wave.ratios[follower]]
    }
}

/// Fields by wave at most: 24 by 6 in Cosserat's space, 12 by 3 in its plane.
pub(crate) const MOST_SHARE: usize = 4;

/// Calls for what stands so far behind the beginning of a slice, whether there is anything or not: `soon` it will
/// be wanted, or else called for again before.
#[inline(always)]
fn prefetch<N>(from: &[N], distance: usize, soon: bool) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the address is not read from; the instruction does nothing where it is not one of ours.
    unsafe {
        use std::arch::x86_64::{_MM_HINT_T0, _MM_HINT_T1, _mm_prefetch};
        let address = from.as_ptr().wrapping_add(distance).cast::<i8>();
        for line in (0..size_of::<N>()).step_by(64) {
            match soon {
                true => _mm_prefetch::<_MM_HINT_T0>(address.wrapping_add(line)),
                false => _mm_prefetch::<_MM_HINT_T1>(address.wrapping_add(line)),
            }
        }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (from, distance, soon);
}

/// What a walk along a line carries from a group to the next, by wave.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<N> {
    /// What leaves the group behind towards the one at hand.
    to_right: N,
    /// The joint in front of the group behind, as that sees it.
    joint: Joint<N>,
}

impl<V: Number> Carried<V> {
    /// Nothing.
    pub(crate) fn empty() -> Self {
        Self { to_right: V::ZERO, joint: Joint::between_like([V::ZERO, V::ZERO]) }
    }

    #[inline(always)]
    fn load<T: Real>(from: &Carried<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self { to_right: V::load(&from.to_right), joint: Joint::load(&from.joint) }
    }

    #[inline(always)]
    fn store<T: Real>(self, to: &mut Carried<T::Lanes>)
    where
        V: Vector<T>,
    {
        self.to_right.store(&mut to.to_right);
        self.joint.store(&mut to.joint);
    }
}

/// A group on a way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stop {
    /// Its number.
    pub(crate) group: usize,
    /// Where its first field stands: the others so far behind as their places say.
    pub(crate) data: usize,
}

impl Stop {
    /// The same of another line.
    #[inline(always)]
    pub(crate) fn of_line(self, line: usize) -> Self {
        Self { group: self.group + line, data: self.data + line }
    }
}

/// Lines that lie side by side, and the part of their way that is to be gone.
pub(crate) struct Lines<'a, T: Real> {
    /// By row, field and group.
    pub(crate) data: &'a mut [T::Lanes],
    /// Fields of a group.
    pub(crate) fields: usize,
    /// From a field of a group to the next one.
    pub(crate) pitch: usize,
    pub(crate) table: &'a Table<T>,
    pub(crate) waves: &'a [Wave],
    pub(crate) slopes: Slopes,
    /// Of all groups.
    pub(crate) patterns: &'a [u32],
    /// Groups of the first line in the order of the way: all but the first and the last are at hand one after
    /// the other, while the one before is written and the one after is read. Those of the other lines follow
    /// each of them.
    pub(crate) way: &'a [Stop],
    /// Whether the way begins with the ghosts in front, where nothing is carried yet. They are written like all
    /// groups, and must be filled anew for another walk.
    pub(crate) begins: bool,
    /// How far behind those at hand fields are called for that the way reads next, so many lines or the next row: rows
    /// and layers lie too far apart for the processor to guess them.
    pub(crate) next: usize,
    /// The same of whatever comes in later, and which of each wave's [`MOST_SHARE`] fields are called for.
    pub(crate) later: (usize, Range<usize>),
    /// By line and wave.
    pub(crate) carried: &'a mut [Carried<T::Lanes>],
}

impl<T: Real> Work<T> for Lines<'_, T> {
    /// Loops of their own for all kinds of slopes.
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        match self.slopes {
            Slopes::Godunov => self.walk::<V>(Slopes::Godunov),
            Slopes::Limited => self.walk::<V>(Slopes::Limited),
            Slopes::Unlimited => self.walk::<V>(Slopes::Unlimited),
        }
    }
}

impl<T: Real> Lines<'_, T> {
    /// Lines of one pattern together; the others in runs through groups of one pattern, and runs from each pattern
    /// to another.
    #[inline(always)]
    fn walk<V: Vector<T>>(mut self, slopes: Slopes) {
        let lines = self.carried.len() / self.waves.len().max(1);
        let steps = self.way.len().saturating_sub(2);
        if self.begins {
            self.carried.fill(Carried::empty());
        }
        let (mut line, mut place) = (0, 0);
        while line < lines {
            let pattern = self.pattern(line, place);
            let mut end = place;
            while end < steps && self.pattern(line, end + 1) == pattern {
                end += 1;
            }
            let mut last = line + 1;
            if (place, end) == (0, steps) {
                let way = &self.way[..=steps];
                let is_like = |line: usize| {
                    way.iter().all(|stop| self.patterns[stop.group + line] == pattern)
                };
                while last < lines && is_like(last) {
                    last += 1;
                }
            }
            let middle = end;
            while end < steps && self.pattern(line, end) != self.pattern(line, end + 1) {
                end += 1;
            }
            let (lines_run, runs) = (line..last, [place..middle, middle..end]);
            for index in 0..self.waves.len() {
                // Loops of their own for all numbers of followers, of which Hooke's law has two at most.
                debug_assert!(self.waves[index].followers.len() <= 2);
                match self.waves[index].followers.len() {
                    0 => self.advance::<V, 0>(&lines_run, &runs, index, slopes),
                    1 => self.advance::<V, 1>(&lines_run, &runs, index, slopes),
                    _ => self.advance::<V, 2>(&lines_run, &runs, index, slopes),
                }
            }
            (line, place) = if end < steps { (line, end) } else { (last, 0) };
        }
    }

    /// A wave on its way through groups of one pattern, and on through such of which each has another one than the
    /// one before.
    #[inline(always)]
    fn advance<V: Vector<T>, const FOLLOWERS: usize>(
        &mut self,
        lines: &Range<usize>,
        [through, across]: &[Range<usize>; 2],
        index: usize,
        slopes: Slopes,
    ) {
        if !through.is_empty() {
            self.run_through::<V, FOLLOWERS>(lines.clone(), through.clone(), index, slopes);
        }
        if !across.is_empty() {
            self.run_across::<V, FOLLOWERS>(lines.start, across.clone(), index, slopes);
        }
    }

    /// How far behind a group at hand stands the share of fields that a wave calls for.
    #[inline(always)]
    fn later_share(&self, index: usize) -> usize {
        self.later.0 + index * self.fields.div_ceil(self.waves.len()) * self.pitch
    }

    #[inline(always)]
    fn pattern(&self, line: usize, place: usize) -> u32 {
        self.patterns[self.way[place].group + line]
    }

    #[inline(always)]
    fn read<V: Vector<T>>(&self, line: usize, place: usize, wave: &Wave) -> State<V> {
        let group = &self.data[self.way[place].data + line..];
        let [velocity, stress] = [&group[wave.velocity], &group[wave.stress]];
        State { velocity: V::load(velocity), stress: V::load(stress) }
    }

    /// A wave on its way through groups of which each has another pattern than the one before.
    #[inline(always)]
    fn run_across<V: Vector<T>, const FOLLOWERS: usize>(
        &mut self,
        line: usize,
        run: Range<usize>,
        index: usize,
        slopes: Slopes,
    ) {
        let (wave, near, pitch) = (&self.waves[index], self.next, self.pitch);
        let (velocity, stress) = (wave.velocity, wave.stress);
        let later = self.later_share(index);
        let slot = line * self.waves.len() + index;
        let mut carried: Carried<V> = Carried::load(&self.carried[slot]);
        let mut pattern = self.pattern(line, run.start);
        let mut last: Cell<V> = Cell::load(self.table.cell(pattern, wave));
        let mut before: State<V> = self.read(line, run.start, wave);
        let mut own = self.read(line, run.start + 1, wave);
        for place in run {
            let here = self.pattern(line, place + 1);
            let cell = Cell::load(self.table.cell(here, wave));
            let next = self.read(line, place + 2, wave);
            let ahead = &self.data[self.way[place + 2].data + line..];
            prefetch(ahead, near + velocity, true);
            prefetch(ahead, near + stress, true);
            for index in self.later.1.clone() {
                prefetch(ahead, later + index * pitch, false);
            }
            let pieces = Pieces::of([before, own, next], &cell, slopes);
            let waves = [carried.to_right, pieces.to_left()];
            let [joint, beyond] = Joint::between([last.impedance, cell.impedance], waves);
            let moved = updated(before, [carried.joint, joint], &last);
            carried = Carried { to_right: pieces.to_right(), joint: beyond };
            let group = &mut self.data[self.way[place].data + line..];
            moved.velocity.store(&mut group[velocity]);
            moved.stress.store(&mut group[stress]);
            let change = moved.stress - before.stress;
            for follower in 0..FOLLOWERS {
                let place = wave.followers[follower];
                let ratio = V::load(self.table.ratio(pattern, wave, follower));
                (V::load(&group[place]) + ratio * change).store(&mut group[place]);
            }
            (before, own, last, pattern) = (own, next, cell, here);
        }
        carried.store(&mut self.carried[slot]);
    }

    /// A wave on its way through groups of one pattern.
    #[inline(always)]
    fn run_through<V: Vector<T>, const FOLLOWERS: usize>(
        &mut self,
        lines: Range<usize>,
        run: Range<usize>,
        index: usize,
        slopes: Slopes,
    ) {
        let (wave, pattern) = (&self.waves[index], self.pattern(lines.start, run.start));
        let cell: Cell<V> = Cell::load(self.table.cell(pattern, wave));
        let mut followers = [(0, V::ZERO); FOLLOWERS];
        for (index, (place, ratio)) in followers.iter_mut().enumerate() {
            *place = wave.followers[index];
            *ratio = V::load(self.table.ratio(pattern, wave, index));
        }
        let (velocity, stress, pitch) = (wave.velocity, wave.stress, self.pitch);
        // Once, and not in every group.
        let extent = (self.fields - 1) * pitch + 1;
        assert!(velocity < extent && stress < extent);
        assert!(followers.iter().all(|(place, _)| *place < extent));
        let near = self.next;
        let later = self.later_share(index);
        let way = &self.way[run.start..run.end + 2];
        for line in lines {
            let slot = line * self.waves.len() + index;
            // A row is a line alone.
            if self.carried.len() > self.waves.len() {
                prefetch(self.carried, slot + self.next * self.waves.len(), true);
            }
            let mut carried: Carried<V> = Carried::load(&self.carried[slot]);
            for stop in &way[..2] {
                let group = &self.data[stop.data + line..][..extent];
                prefetch(group, near + velocity, true);
                prefetch(group, near + stress, true);
            }
            let mut last: State<V> = self.read(line, run.start, wave);
            let mut here = self.read(line, run.start + 1, wave);
            let mut own = Waves::of(here, &cell);
            let mut before = Waves::of(last, &cell).to(own);
            for (behind, next) in way.iter().zip(&way[2..]) {
                let next = &self.data[next.data + line..][..extent];
                prefetch(next, near + velocity, true);
                prefetch(next, near + stress, true);
                for index in self.later.1.clone() {
                    prefetch(next, later + index * pitch, false);
                }
                let next =
                    State { velocity: V::load(&next[velocity]), stress: V::load(&next[stress]) };
                let waves = Waves::of(next, &cell);
                let after = own.to(waves);
                let pieces = Pieces::new(own, [before, after], &cell, slopes);
                let joint = Joint::between_like([carried.to_right, pieces.to_left()]);
                let moved = updated(last, [carried.joint, joint], &cell);
                carried = Carried { to_right: pieces.to_right(), joint };
                let group = &mut self.data[behind.data + line..][..extent];
                for (place, _) in followers {
                    prefetch(group, near + place, true);
                }
                moved.velocity.store(&mut group[velocity]);
                moved.stress.store(&mut group[stress]);
                if FOLLOWERS > 0 {
                    let change = moved.stress - last.stress;
                    for (place, ratio) in followers {
                        (V::load(&group[place]) + ratio * change).store(&mut group[place]);
                    }
                }
                (last, here, own, before) = (here, next, waves, after);
            }
            carried.store(&mut self.carried[slot]);
        }
    }
}
