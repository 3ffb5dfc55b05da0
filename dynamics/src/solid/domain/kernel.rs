//! Sweep kernel: the sweep of [`crate::solid::line`] on many lines at once, in SIMD lanes.
//!
//! A group of cells fills a cache line. For every axis the neighbours of the cells of a group are the cells of another
//! group in the same lanes: a sweep from group to group advances one line per lane, without shuffles. At the ends of a
//! row, where the neighbours are in the adjacent lane, shifted copies serve as ghosts. Each cell is updated by the same
//! operations in the same order as in the sweep of a single line: results are equal to the bit.

pub(super) mod interlayers;

use super::layout::GroupIndex;
use super::rows::Rows;
use super::table::{Table, WavePair};
use crate::simd::{Instructions, Number, Real, SimdKernel, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::reconstruction::{GHOSTS, Slopes};
use crate::solid::riemann::{InterfaceState, RiemannInvariants, State, updated};
use std::ops::Range;

/// Number of fields prefetched for each pair of waves: 24 by 6 pairs in a Cosserat solid in space, 12 by 3 in the
/// plane. Viscous strains, which sweeps do not read, are left to the hardware prefetcher.
pub(crate) const MAX_SHARE: usize = 4;

/// Prefetches the cache lines of `from[distance]`, which may be out of bounds, into L1 if `soon`, else into L2.
#[inline(always)]
fn prefetch<N>(from: &[N], distance: usize, soon: bool) {
    #[cfg(target_arch = "x86_64")]
    // SAFETY: the address is not dereferenced; prefetching an invalid address has no effect.
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

/// State that a sweep carries from a group to the next one of a line, for one pair of waves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carried<N> {
    /// Stencil data of the previous groups for the next face; see [`Slopes::face_values`].
    known: RiemannInvariants<N>,
    /// Interface state at the lower face of the group that is updated next, scaled by its impedance.
    lower_face: InterfaceState<N>,
}

impl<V: Number> Carried<V> {
    /// Returns the carried state of the first face of a line: zero.
    pub(crate) fn empty() -> Self {
        Self {
            known: RiemannInvariants::ZERO,
            lower_face: InterfaceState::riemann_equal_impedance([V::ZERO, V::ZERO]),
        }
    }

    #[inline(always)]
    fn load<T: Real>(from: &Carried<T::Lanes>) -> Self
    where
        V: Vector<T>,
    {
        Self {
            known: RiemannInvariants::load(&from.known),
            lower_face: InterfaceState::load(&from.lower_face),
        }
    }

    #[inline(always)]
    fn store<T: Real>(self, to: &mut Carried<T::Lanes>)
    where
        V: Vector<T>,
    {
        self.known.store(&mut to.known);
        self.lower_face.store(&mut to.lower_face);
    }
}

/// Adjacent lines, and the section of their path that is swept now.
pub(crate) struct Lines<'a, T: Real> {
    /// Data by row, field and group.
    pub(crate) data: &'a mut [T::Lanes],
    /// Number of fields of a group.
    pub(crate) fields: usize,
    /// Distance between two fields of a group.
    pub(crate) pitch: usize,
    pub(crate) table: &'a Table<T>,
    pub(crate) waves: &'a [WavePair],
    pub(crate) slopes: Slopes,
    /// By group, the number of its lane pattern.
    pub(crate) patterns: &'a [u32],
    /// By group: number of next groups along such a line with the same pattern, at most 255. At a cut the run may
    /// extend beyond the line: the group beyond has the pattern of the last one.
    pub(crate) run_lengths: &'a [u8],
    /// Groups of the first line in the order of the sweep: each one except the first and the last is current once,
    /// while the previous one is written and the next one is read. The groups of the other lines are offset from these
    /// by multiples of `across`.
    pub(crate) path: &'a [GroupIndex],
    /// Group of the first line before the path; the first group of the path if there is none.
    pub(crate) previous_group: GroupIndex,
    /// Distance between two lines.
    pub(crate) across: GroupIndex,
    /// Whether the path begins with the ghosts at the lower end, where no state is carried yet. The sweep overwrites
    /// ghosts like all groups: they must be filled again before another sweep.
    pub(crate) begins: bool,
    /// L1 prefetch distance, in groups: a few lines in sweeps across rows, one row in sweeps along rows, which are too far
    /// apart for the hardware prefetcher.
    pub(crate) next: usize,
    /// L2 prefetch distance, and which of the [`MAX_SHARE`] fields of each pair are prefetched.
    pub(crate) later: (usize, Range<usize>),
    /// Carried state by line and pair of waves.
    pub(crate) carried: &'a mut [Carried<T::Lanes>],
    /// Ends of the lines, if lines are rows.
    pub(crate) rows: Option<Rows<'a, T>>,
}

/// Sweep of adjacent lines, each of one and the same pattern, or `MIXED`: compiled separately to limit register
/// pressure.
struct Advance<'a, 'b, T: Real, const MIXED: bool> {
    all: &'a mut Lines<'b, T>,
    lines: Range<usize>,
    /// Pattern of all lines, unless they are mixed.
    pattern: u32,
}

impl<T: Real, const MIXED: bool> SimdKernel<T> for Advance<'_, '_, T, MIXED> {
    /// Selects the loop that is compiled for the reconstruction.
    #[inline(always)]
    fn run<V: Vector<T>>(self) {
        let Self { all, lines, pattern } = self;
        match all.slopes {
            Slopes::Limited => all.advance_lines::<V, MIXED>(lines, pattern, Slopes::Limited),
            // For first order the weights in the cell constants are zero.
            Slopes::Godunov | Slopes::FourthOrder => {
                all.advance_lines::<V, MIXED>(lines, pattern, Slopes::FourthOrder);
            }
        }
    }
}

impl<T: Real> Lines<'_, T> {
    /// Sweeps the lines with an instruction set: consecutive lines of one and the same pattern together, and
    /// consecutive lines of several patterns together.
    pub(super) fn walk(mut self, instructions: Instructions) {
        let lines = self.carried.len() / self.waves.len().max(1);
        // A single pattern: skip the lookup and its memory traffic.
        let own = |lines: &Self, line: usize| match lines.table.is_of_one_pattern() {
            true => Some(0),
            false => lines.own_pattern(line),
        };
        let mut start = 0;
        let mut next = (lines > 0).then(|| own(&self, 0));
        while let Some(pattern) = next {
            let mut end = start;
            while next == Some(pattern) {
                end += 1;
                next = (end < lines).then(|| own(&self, end));
            }
            let (all, lines) = (&mut self, start..end);
            match pattern {
                Some(pattern) => instructions.run(Advance::<T, false> { all, lines, pattern }),
                None => instructions.run(Advance::<T, true> { all, lines, pattern: 0 }),
            }
            start = end;
        }
    }

    /// Returns the pattern of a line that has the same pattern everywhere, ghosts included; else `None`.
    fn own_pattern(&self, line: usize) -> Option<u32> {
        let offset = line * self.across.group;
        let pattern = |place: usize| self.patterns[self.path[place].group + offset];
        let own = pattern(0);
        if self.patterns[self.previous_group.group + offset] != own {
            return None;
        }
        // The last groups may be ghosts, which `run_lengths` does not cover.
        if (1..=GHOSTS).any(|behind| pattern(self.path.len() - behind) != own) {
            return None;
        }
        let mut place = 0;
        while place + 2 < self.path.len() {
            if pattern(place + 1) != own {
                return None;
            }
            place += usize::from(self.run_lengths[self.path[place].group + offset]).max(1);
        }
        Some(own)
    }

    /// Sweeps adjacent lines of one and the same pattern, or `MIXED`.
    #[inline(always)]
    fn advance_lines<V: Vector<T>, const MIXED: bool>(
        &mut self,
        lines: Range<usize>,
        pattern: u32,
        slopes: Slopes,
    ) {
        for index in 0..self.waves.len() {
            if let Some(rows) = &self.rows {
                rows.fill::<V>(self.data, &self.waves[index], index, lines.clone());
            }
            // One compiled loop for each number of passive stresses, of which Hooke's law has at most two.
            let lines = lines.clone();
            debug_assert!(self.waves[index].passive_stresses.len() <= 2);
            match self.waves[index].passive_stresses.len() {
                0 => self.advance::<V, 0, MIXED>(lines, index, pattern, slopes),
                1 => self.advance::<V, 1, MIXED>(lines, index, pattern, slopes),
                _ => self.advance::<V, 2, MIXED>(lines, index, pattern, slopes),
            }
        }
    }

    /// Returns the range of distances, from a group of the path, of the fields that a pair of waves prefetches into L2.
    #[inline(always)]
    fn prefetch_l2_range(&self, index: usize) -> Range<usize> {
        let (behind, Range { start, end }) = self.later;
        let first = index * self.fields.div_ceil(self.waves.len());
        behind + (first + start) * self.pitch..behind + (first + end) * self.pitch
    }

    /// Loads the coupling ratios of the passive stresses of a pair of waves.
    #[inline(always)]
    fn ratios<V: Vector<T>, const PASSIVE: usize>(
        &self,
        pattern: u32,
        wave: &WavePair,
    ) -> [V; PASSIVE] {
        // No closure: closures are not inlined into the target-feature function and lose its SIMD instructions.
        let mut ratios = [V::ZERO; PASSIVE];
        for (passive, ratio) in ratios.iter_mut().enumerate() {
            *ratio = V::load(self.table.ratio(pattern, wave, passive));
        }
        ratios
    }

    #[inline(always)]
    fn read<V: Vector<T>, const PASSIVE: usize>(
        &self,
        places: &Places<PASSIVE>,
        data: usize,
    ) -> State<V> {
        let group = &self.data[data..][..places.extent];
        State { velocity: V::load(&group[places.velocity]), stress: V::load(&group[places.stress]) }
    }

    /// Sweeps a pair of waves along lines, of one pattern or `MIXED`.
    #[inline(always)]
    fn advance<V: Vector<T>, const PASSIVE: usize, const MIXED: bool>(
        &mut self,
        lines: Range<usize>,
        index: usize,
        mut pattern: u32,
        slopes: Slopes,
    ) {
        let wave = &self.waves[index];
        let extent = (self.fields - 1) * self.pitch + 1;
        let places = Places {
            velocity: wave.velocity,
            stress: wave.stress,
            passive_stresses: std::array::from_fn(|index| wave.passive_stresses[index]),
            extent,
            later: self.prefetch_l2_range(index),
        };
        // Checks the offsets once, not in every group.
        assert!(places.velocity < extent && places.stress < extent);
        assert!(places.passive_stresses.iter().all(|place| *place < extent));
        let (path, patterns, steps) = (self.path, self.patterns, self.path.len() - 2);
        let mut cell: CellConstants<V> = CellConstants::load(self.table.cell(pattern, wave));
        for line in lines {
            let slot = line * self.waves.len() + index;
            let offset = GroupIndex { group: 0, data: 0 }.of_line(line, self.across);
            if !self.begins {
                prefetch(self.carried, slot + self.next * self.waves.len(), true);
            }
            for stop in &path[..2] {
                let group = &self.data[stop.data + offset.data..][..extent];
                prefetch(group, self.next + places.velocity, true);
                prefetch(group, self.next + places.stress, true);
            }
            let mut farther = pattern;
            if MIXED {
                farther = patterns[self.previous_group.group + offset.group];
                pattern = patterns[path[0].group + offset.group];
                cell = CellConstants::load(self.table.cell(pattern, wave));
            }
            let last: State<V> = self.read(&places, path[0].data + offset.data);
            let here: State<V> = self.read(&places, path[1].data + offset.data);
            let carried = match self.begins {
                true => Carried::empty(),
                false => Carried::load(&self.carried[slot]),
            };
            let mut stencil = StencilState::of([last, here], &cell, carried, slopes);
            let mut place = 0;
            loop {
                let ratios: [V; PASSIVE] = self.ratios(pattern, wave);
                while place < steps
                    && (!MIXED
                        || (farther == pattern
                            && patterns[path[place + 1].group + offset.group] == pattern
                            && patterns[path[place + 2].group + offset.group] == pattern))
                {
                    let stops =
                        [path[place].data + offset.data, path[place + 2].data + offset.data];
                    let media = Media::Same(&cell, &ratios);
                    self.advance_group(&places, &mut stencil, stops, media, slopes);
                    place += 1;
                }
                // The following code is not compiled for lines of one pattern.
                if !MIXED || place == steps {
                    break;
                }
                let stops = [path[place].data + offset.data, path[place + 2].data + offset.data];
                let first: CellConstants<V> = CellConstants::load(self.table.cell(farther, wave));
                let (cell_behind, pattern_behind) = (cell, pattern);
                farther = pattern;
                pattern = patterns[path[place + 1].group + offset.group];
                cell = CellConstants::load(self.table.cell(pattern, wave));
                let next = patterns[path[place + 2].group + offset.group];
                let next: CellConstants<V> = CellConstants::load(self.table.cell(next, wave));
                let media =
                    Media::Other([&first, &cell_behind, &cell, &next], pattern_behind, wave);
                self.advance_group(&places, &mut stencil, stops, media, slopes);
                place += 1;
            }
            if let Some(rows) = &self.rows {
                rows.clear(self.data, places.velocity, line);
                rows.clear(self.data, places.stress, line);
                for place in places.passive_stresses {
                    rows.clear(self.data, place, line);
                }
            } else {
                stencil.carried.store(&mut self.carried[slot]);
            }
        }
    }

    /// Updates the previous group of the path and loads the next one.
    #[inline(always)]
    fn advance_group<V: Vector<T>, const PASSIVE: usize>(
        &mut self,
        places: &Places<PASSIVE>,
        stencil: &mut StencilState<V>,
        [behind, next]: [usize; 2],
        media: Media<'_, V, PASSIVE>,
        slopes: Slopes,
    ) {
        let &Places { velocity, stress, passive_stresses, extent, ref later } = places;
        let group = &self.data[next..][..extent];
        prefetch(group, self.next + velocity, true);
        prefetch(group, self.next + stress, true);
        let mut place = later.start;
        while place < later.end {
            prefetch(group, place, false);
            place += self.pitch;
        }
        let next: State<V> = self.read(places, next);
        let [cell_behind, cell] = match media {
            Media::Same(cell, _) => [cell; 2],
            Media::Other([_, behind, cell, _], ..) => [behind, cell],
        };
        let waves = RiemannInvariants::of(next, cell);
        let StencilState { carried, last, here, own, behind: waves_behind } = *stencil;
        let ahead = slopes.ahead(own, waves);
        let (reach, known) = match media {
            Media::Same(..) => slopes.face_values(carried.known, own, [waves_behind, ahead], cell),
            Media::Other(cells, ..) => {
                slopes.face_values_between_media(carried.known, [last, here, next], cells)
            }
        };
        let [lower_face, beyond] = match media {
            Media::Same(..) => [InterfaceState::riemann_equal_impedance(reach); 2],
            Media::Other(..) => {
                InterfaceState::riemann([cell_behind.impedance, cell.impedance], reach)
            }
        };
        let moved = updated(last, [carried.lower_face, lower_face], cell_behind);
        let group = &mut self.data[behind..][..extent];
        for place in passive_stresses {
            prefetch(group, self.next + place, true);
        }
        moved.velocity.store(&mut group[velocity]);
        moved.stress.store(&mut group[stress]);
        if PASSIVE > 0 {
            let change = moved.stress - last.stress;
            for (passive, place) in passive_stresses.into_iter().enumerate() {
                let ratio = match media {
                    Media::Same(_, ratios) => ratios[passive],
                    Media::Other(_, pattern, wave) => {
                        V::load(self.table.ratio(pattern, wave, passive))
                    }
                };
                (V::load(&group[place]) + ratio * change).store(&mut group[place]);
            }
        }
        let carried = Carried { known, lower_face: beyond };
        *stencil = match media {
            Media::Same(..) => {
                let behind = slopes.behind(own, waves);
                StencilState { carried, last: here, here: next, own: waves, behind }
            }
            Media::Other(..) => StencilState::of([here, next], cell, carried, slopes),
        };
    }
}

/// Materials of the stencil: of the current group and of the previous and next groups of the line.
#[derive(Clone, Copy)]
enum Media<'a, V, const PASSIVE: usize> {
    /// One medium: its constants, and the coupling ratios of the passive stresses.
    Same(&'a CellConstants<V>, &'a [V; PASSIVE]),
    /// Several media: constants of groups i − 2, i − 1, i (current) and i + 1. Coupling ratios are loaded on demand
    /// from the pattern of group i − 1 and the wave, to save registers.
    Other([&'a CellConstants<V>; 4], u32, &'a WavePair),
}

/// Offsets of the fields of a pair of waves in a group.
struct Places<const PASSIVE: usize> {
    velocity: usize,
    stress: usize,
    passive_stresses: [usize; PASSIVE],
    /// Upper bound of the offsets.
    extent: usize,
    /// Offsets of the fields that are prefetched into L2.
    later: Range<usize>,
}

/// State of the stencil: of the current and the previous group.
#[derive(Clone, Copy)]
struct StencilState<V> {
    carried: Carried<V>,
    last: State<V>,
    here: State<V>,
    /// Invariants of the current group.
    own: RiemannInvariants<V>,
    /// Stencil data of the previous group: see [`Slopes::behind`].
    behind: RiemannInvariants<V>,
}

impl<V: Number> StencilState<V> {
    #[inline(always)]
    fn of(
        [last, here]: [State<V>; 2],
        cell: &CellConstants<V>,
        carried: Carried<V>,
        slopes: Slopes,
    ) -> Self {
        let own = RiemannInvariants::of(here, cell);
        let behind = slopes.behind(RiemannInvariants::of(last, cell), own);
        Self { carried, last, here, own, behind }
    }
}
