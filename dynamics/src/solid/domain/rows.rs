//! Ghost cells at the ends of rows; [`super::layout`] states how rows are folded into lanes.

use super::table::{Table, WavePair};
use crate::simd::{Group, Number, Real, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BESIDE, BoundaryFaces, Closure, Slot, ghosts, image};
use crate::solid::reconstruction::{GHOSTS, Slopes};
use crate::solid::riemann::State;
use std::ops::Range;

/// Slots of cells and ghosts at the ends of a row.
#[derive(Clone)]
pub(crate) struct RowEnds<T: Real> {
    /// Number of groups of a row.
    groups: usize,
    /// Slots of the outermost cells at each end, on which ghosts depend; shorter rows are continued periodically.
    inside: [[Slot; BESIDE]; 2],
    /// Whether a row has a single cell.
    is_single: bool,
    /// Whether a row has fewer cells than its ghosts depend on.
    is_short: bool,
    /// Slots of the ghosts after the last cell.
    behind: [Slot; GHOSTS],
    /// By group, of the first [`GHOSTS`] of a row, and by depth: mask of the lane that holds that ghost after the last
    /// cell.
    in_first: [[u16; GHOSTS]; GHOSTS],
    /// Padding lanes after the last cell. During a sweep the first [`GHOSTS`] hold ghost values, and the sweep changes
    /// as many after them; otherwise all are zero.
    empty: Vec<Slot>,
    /// Ghost rule that copies values, the sign of zero included: for periodic ends.
    window: [T::Lanes; 5],
}

impl<T: Real> RowEnds<T> {
    /// Creates the ends of rows of `length` cells in `groups` groups.
    pub(crate) fn new(length: usize, groups: usize) -> Self {
        let slot = |place: usize| (place % groups, place / groups);
        let behind = std::array::from_fn(|depth| slot(length + depth));
        Self {
            groups,
            inside: [
                std::array::from_fn(|depth| slot(depth % length)),
                std::array::from_fn(|depth| slot(length - 1 - depth % length)),
            ],
            is_single: length < GHOSTS,
            is_short: length < BESIDE,
            behind,
            in_first: std::array::from_fn(|first| {
                behind.map(|(group, lane)| if group == first { 1 << lane } else { 0 })
            }),
            empty: (length..groups * T::Lanes::COUNT).take(2 * GHOSTS).map(slot).collect(),
            window: [
                T::Lanes::ONE,
                -T::Lanes::ZERO,
                T::Lanes::ONE,
                -T::Lanes::ZERO,
                T::Lanes::ZERO,
            ],
        }
    }
}

/// Adjacent rows that are about to be swept.
pub(crate) struct Rows<'a, T: Real> {
    pub(crate) ends: &'a RowEnds<T>,
    pub(crate) sides: &'a [BoundaryFaces<T>; 2],
    /// Index of the first row among the faces of the boundaries.
    pub(crate) face: usize,
    /// Data index of the first row.
    pub(crate) first: usize,
    /// Distance between two rows, and between the ghosts of two rows.
    pub(crate) size: usize,
    /// Data index of the ghosts of the first row: the nearest and the farther one before its first group, then the
    /// nearest and the farther one after its last group.
    pub(crate) ghosts: usize,
    /// Distance between two of these ghosts.
    pub(crate) apart: usize,
    /// Index of the first group of the first row.
    pub(crate) group: usize,
    pub(crate) table: &'a Table<T>,
    /// Lane patterns of all groups.
    pub(crate) patterns: &'a [u32],
}

impl<T: Real> Rows<'_, T> {
    /// Fills the ghosts of velocity and stress of a pair of waves: those after the last cell, in the row itself, and
    /// the groups before the first and after the last group of a row, whose values are in the adjacent lanes.
    #[inline(always)]
    pub(crate) fn fill<V: Vector<T>>(
        &self,
        data: &mut [T::Lanes],
        wave: &WavePair,
        pair: usize,
        rows: Range<usize>,
    ) {
        let &RowEnds { groups, inside: [first, last], .. } = self.ends;
        let near = if self.sides[0].mirror().is_some() { first } else { last };
        let far = if self.sides[1].mirror().is_some() { last } else { first };
        let is_one_sided = |end: usize| self.sides[end].closure().slopes != Slopes::Godunov;
        if !self.ends.is_short && (is_one_sided(0) || is_one_sided(1)) {
            return self.fill_one_sided::<V>(data, wave, pair, rows);
        }
        for row in rows {
            let (group, lane) =
                ((self.face + row) / T::Lanes::COUNT, (self.face + row) % T::Lanes::COUNT);
            let front: [V; 5] = splat(self.mirror(0, pair, group), lane);
            let back: [V; 5] = splat(self.mirror(1, pair, group), lane);
            let start = self.first + row * self.size;
            for (place, [front, back]) in [
                (wave.velocity, [[front[0], front[1]], [back[0], back[1]]]),
                (wave.stress, [[front[2], front[3]], [back[2], back[3]]]),
            ] {
                let field = &data[start + place..][..groups];
                let near: [V; GHOSTS] = [seen(field, near[0]), seen(field, near[1])];
                let far: [V; GHOSTS] = [seen(field, far[0]), seen(field, far[1])];
                let mut in_front = [image(front, near[0]), image(front, near[1])];
                let mut beyond = [image(back, far[0]), image(back, far[1])];
                if self.ends.is_single {
                    // In a row of a single cell the second ghost is the image of the ghost at the other end.
                    in_front[1] = image(front, image(back, near[1]));
                    beyond[1] = image(back, image(front, far[1]));
                }
                self.place(data, place, row, [in_front, beyond]);
            }
        }
    }

    /// Fills the same ghosts for waves with one-sided reconstruction: one row per lane at a time.
    #[inline(always)]
    fn fill_one_sided<V: Vector<T>>(
        &self,
        data: &mut [T::Lanes],
        wave: &WavePair,
        pair: usize,
        rows: Range<usize>,
    ) {
        let closures = [self.sides[0].closure(), self.sides[1].closure()];
        let mut start = rows.start;
        while start < rows.end {
            let end = rows.end.min(start + T::Lanes::COUNT);
            let [front, back] = [
                self.one_sided::<V>(closures[0], data, wave, pair, (start..end, 0)),
                self.one_sided::<V>(closures[1], data, wave, pair, (start..end, 1)),
            ];
            for row in start..end {
                let lane = row - start;
                for (place, which) in [(wave.velocity, 0), (wave.stress, 1)] {
                    let in_front = [
                        V::all(front[which][0].lanes()[lane]),
                        V::all(front[which][1].lanes()[lane]),
                    ];
                    let beyond = [
                        V::all(back[which][0].lanes()[lane]),
                        V::all(back[which][1].lanes()[lane]),
                    ];
                    self.place(data, place, row, [in_front, beyond]);
                }
            }
            start = end;
        }
    }

    /// Returns velocities and stresses of the ghosts at an end of some rows, one row per lane.
    #[inline(always)]
    fn one_sided<V: Vector<T>>(
        &self,
        closure: Closure,
        data: &[T::Lanes],
        wave: &WavePair,
        pair: usize,
        (rows, end): (Range<usize>, usize),
    ) -> [[T::Lanes; GHOSTS]; 2] {
        let inside = self.ends.inside[end];
        // Only open boundaries need the third cell.
        let depths = if closure.is_open { BESIDE } else { GHOSTS };
        let mut velocity = [T::Lanes::ZERO; BESIDE];
        let mut stress = [T::Lanes::ZERO; BESIDE];
        for row in rows.clone() {
            let lane = row - rows.start;
            let start = self.first + row * self.size;
            for depth in 0..depths {
                let (group, from) = inside[depth];
                velocity[depth].lanes_mut()[lane] =
                    data[start + wave.velocity + group].lanes()[from];
                stress[depth].lanes_mut()[lane] = data[start + wave.stress + group].lanes()[from];
            }
        }
        // Ghost rules by row, unless all faces are alike; constants by row, unless there is one pattern.
        let mut by_row = *self.mirror(end, pair, self.face / T::Lanes::COUNT);
        if !self.is_uniform(end) {
            for row in rows.clone() {
                let (lane, face) = (row - rows.start, self.face + row);
                let own = self.mirror(end, pair, face / T::Lanes::COUNT);
                for (to, from) in by_row.iter_mut().zip(own) {
                    to.lanes_mut()[lane] = from.lanes()[face % T::Lanes::COUNT];
                }
            }
        }
        let mirror = [
            V::load(&by_row[0]),
            V::load(&by_row[1]),
            V::load(&by_row[2]),
            V::load(&by_row[3]),
            V::load(&by_row[4]),
        ];
        let mut cells = [
            CellConstants::load(self.cell(rows.start, inside[0], wave)),
            CellConstants::load(self.cell(rows.start, inside[1], wave)),
            CellConstants::load(self.cell(rows.start, inside[2], wave)),
        ];
        if !self.table.is_of_one_pattern() {
            for (cell, slot) in cells.iter_mut().zip(inside) {
                *cell = self.cells_of(&rows, slot, wave);
            }
        }
        let beside = [
            State { velocity: V::load(&velocity[0]), stress: V::load(&stress[0]) },
            State { velocity: V::load(&velocity[1]), stress: V::load(&stress[1]) },
            State { velocity: V::load(&velocity[2]), stress: V::load(&stress[2]) },
        ];
        let coefficients = self.table.ghost_coefficients(wave, &cells[0]);
        let cells = [&cells[0], &cells[1], &cells[2]];
        let [one, two] = ghosts(closure, beside, mirror, end, cells, &coefficients);
        let mut made = [[T::Lanes::ZERO; GHOSTS]; 2];
        one.velocity.store(&mut made[0][0]);
        two.velocity.store(&mut made[0][1]);
        one.stress.store(&mut made[1][0]);
        two.stress.store(&mut made[1][1]);
        made
    }

    /// Returns the constants of a cell of some rows, one row per lane; surplus lanes have those of the last row.
    #[inline(always)]
    fn cells_of<V: Vector<T>>(
        &self,
        rows: &Range<usize>,
        slot: Slot,
        wave: &WavePair,
    ) -> CellConstants<V> {
        let mut cells = *self.cell(rows.start, slot, wave);
        for lane in 0..T::Lanes::COUNT {
            let row = rows.start + lane.min(rows.len() - 1);
            cells.set_lane(lane, &self.cell(row, slot, wave).lane(slot.1));
        }
        CellConstants::load(&cells)
    }

    /// Returns the constants of the group of a row that contains a cell.
    #[inline(always)]
    fn cell(&self, row: usize, (group, _): Slot, wave: &WavePair) -> &CellConstants<T::Lanes> {
        let pattern = self.patterns[self.group + row * self.ends.groups + group];
        self.table.cell(pattern, wave)
    }

    /// Zeroes the padding lanes of a field of a row: ghosts, and the lanes that the sweep has changed.
    #[inline(always)]
    pub(crate) fn clear(&self, data: &mut [T::Lanes], place: usize, row: usize) {
        let field = &mut data[self.first + row * self.size + place..][..self.ends.groups];
        for &(group, lane) in &self.ends.empty {
            field[group].lanes_mut()[lane] = T::ZERO;
        }
    }

    /// Whether the ghost rule is the same at all faces of an end.
    #[inline(always)]
    fn is_uniform(&self, end: usize) -> bool {
        self.sides[end].mirror().is_none_or(|mirror| mirror.is_uniform)
    }

    /// Returns the ghost rule at an end, by face: see [`GhostRule::face`](crate::solid::ghosts::GhostRule::face).
    #[inline(always)]
    fn mirror(&self, end: usize, pair: usize, group: usize) -> &[T::Lanes; 5] {
        match &self.sides[end] {
            BoundaryFaces::Physical(mirror) => mirror.face(pair, group),
            BoundaryFaces::Periodic | BoundaryFaces::Exchange => &self.ends.window,
        }
    }

    /// Stores the ghosts of a field at the lower and the upper end of a row.
    #[inline(always)]
    fn place<V: Vector<T>>(
        &self,
        data: &mut [T::Lanes],
        place: usize,
        row: usize,
        [in_front, beyond]: [[V; GHOSTS]; 2],
    ) {
        let &RowEnds { groups, behind, in_first, .. } = self.ends;
        let (data, ghosts) = data.split_at_mut(self.ghosts);
        let apart = self.apart;
        let start = row * self.size + place;
        let field = &mut data[self.first + start..][..groups];
        let ghosts = &mut ghosts[start..][..(2 * GHOSTS - 1) * apart + 1];
        for depth in 0..GHOSTS {
            let own = V::load(&field[groups - 1 - depth]);
            own.shift_in_low(in_front[depth]).store(&mut ghosts[depth * apart]);
            // With the ghosts after the last cell, which are stored in the row below.
            let own = V::load(&field[depth]).with_lanes(in_first[depth][0], beyond[0]);
            let own = own.with_lanes(in_first[depth][1], beyond[1]);
            own.shift_in_high(V::ZERO).store(&mut ghosts[(GHOSTS + depth) * apart]);
        }
        for depth in 0..GHOSTS {
            let (group, lane) = behind[depth];
            let own = V::load(&field[group]).with_lanes(1 << lane, beyond[depth]);
            own.store(&mut field[group]);
        }
    }
}

// No closures here, and no arrays made by them: closures are not inlined into the target-feature function and lose its
// SIMD instructions.

/// Broadcasts one lane of a ghost rule to all lanes.
#[inline(always)]
fn splat<T: Real, V: Vector<T>>(mirror: &[T::Lanes; 5], lane: usize) -> [V; 5] {
    let mut all = [V::ZERO; 5];
    for (own, lanes) in all.iter_mut().zip(mirror) {
        *own = V::all(lanes.lanes()[lane]);
    }
    all
}

/// Broadcasts one value of a field to all lanes.
#[inline(always)]
fn seen<T: Real, V: Vector<T>>(field: &[T::Lanes], (group, lane): Slot) -> V {
    V::all(field[group].lanes()[lane])
}
