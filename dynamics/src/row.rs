//! The ends of rows, which are folded into the lanes of groups: see [`crate::domain`].

use crate::kernel::{Table, Wave};
use crate::line::{Cell, GHOSTS, Slopes, State};
use crate::real::{Group, Number, Real, Vector};
use crate::side::{Side, Slot, ghosts, image};
use std::ops::Range;

/// Where the ends of a row stand in it.
#[derive(Clone)]
pub(crate) struct RowEnds<T: Real> {
    /// Groups of a row.
    groups: usize,
    /// What ghosts see of both ends, the outermost first; rows shorter than the ghosts repeat themselves.
    inside: [[Slot; GHOSTS]; 2],
    /// Whether a row is a single cell.
    is_single: bool,
    /// Where ghosts stand behind the last cell.
    behind: [Slot; GHOSTS],
    /// Of each of the first groups the lanes where those stand, by bits.
    in_first: [[u16; GHOSTS]; GHOSTS],
    /// What is no cell and may be moved: ghosts stand in the first of these while the row is swept, and the sweep
    /// reaches as far beyond them; else zeros in all, as ever in what is behind.
    empty: Vec<Slot>,
    /// The mirror that changes nothing, not even the sign of zero.
    window: [T::Lanes; 5],
}

impl<T: Real> RowEnds<T> {
    /// Of rows of so many cells in so many groups.
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

/// Rows that are about to be swept.
pub(crate) struct Rows<'a, T: Real> {
    pub(crate) ends: &'a RowEnds<T>,
    pub(crate) sides: &'a [Side<T>; 2],
    /// The first row among the faces of the sides.
    pub(crate) face: usize,
    /// Where that row begins.
    pub(crate) first: usize,
    /// From a row to the next one, and from its ghosts to those of the next one.
    pub(crate) size: usize,
    /// Where the ghosts of the first row begin: the nearest in front of it, the farther one, the nearest behind it, the
    /// farther one.
    pub(crate) ghosts: usize,
    /// From each of these to the next one.
    pub(crate) apart: usize,
    /// The first group of the first row.
    pub(crate) group: usize,
    pub(crate) table: &'a Table<T>,
    /// Of all groups.
    pub(crate) patterns: &'a [u32],
    pub(crate) slopes: Slopes,
}

impl<T: Real> Rows<'_, T> {
    /// Fills in the ghosts of the velocity and the stress of a pair of waves: those behind the last cell of a row in the
    /// row itself; and what is in front of its groups and behind them, which is in other lanes.
    #[inline(always)]
    pub(crate) fn fill<V: Vector<T>>(
        &self,
        data: &mut [T::Lanes],
        wave: &Wave,
        pair: usize,
        rows: Range<usize>,
    ) {
        let &RowEnds { groups, inside: [first, last], .. } = self.ends;
        // Rows come round at both ends or at none.
        let [near, far] = match self.sides[0] {
            Side::Mirror(_) => [first, last],
            Side::Periodic | Side::Cut => [last, first],
        };
        let is_one_sided = self.is_one_sided(0) || self.is_one_sided(1);
        for row in rows {
            let (group, lane) =
                ((self.face + row) / T::Lanes::COUNT, (self.face + row) % T::Lanes::COUNT);
            let front: [V; 5] = splat(self.mirror(0, pair, group), lane);
            let back: [V; 5] = splat(self.mirror(1, pair, group), lane);
            let start = self.first + row * self.size;
            let velocity = &data[start + wave.velocity..][..groups];
            let near_v: [V; GHOSTS] = [seen(velocity, near[0]), seen(velocity, near[1])];
            let far_v: [V; GHOSTS] = [seen(velocity, far[0]), seen(velocity, far[1])];
            let stress = &data[start + wave.stress..][..groups];
            let near_s: [V; GHOSTS] = [seen(stress, near[0]), seen(stress, near[1])];
            let far_s: [V; GHOSTS] = [seen(stress, far[0]), seen(stress, far[1])];
            let (mut front_v, mut back_v) =
                (images([front[0], front[1]], near_v), images([back[0], back[1]], far_v));
            let (mut front_s, mut back_s) =
                (images([front[2], front[3]], near_s), images([back[2], back[3]], far_s));
            if self.ends.is_single {
                // A single cell is seen through the other mirror.
                front_v[1] = image([front[0], front[1]], image([back[0], back[1]], near_v[1]));
                back_v[1] = image([back[0], back[1]], image([front[0], front[1]], far_v[1]));
                front_s[1] = image([front[2], front[3]], image([back[2], back[3]], near_s[1]));
                back_s[1] = image([back[2], back[3]], image([front[2], front[3]], far_s[1]));
            } else if is_one_sided {
                let cell: Cell<V> = self.cell(row, first[0], wave);
                let [one, two] = ghosts(pair_of(near_v, near_s), front, 0, &cell, self.slopes);
                (front_v, front_s) = ([one.velocity, two.velocity], [one.stress, two.stress]);
                let cell: Cell<V> = self.cell(row, last[0], wave);
                let [one, two] = ghosts(pair_of(far_v, far_s), back, 1, &cell, self.slopes);
                (back_v, back_s) = ([one.velocity, two.velocity], [one.stress, two.stress]);
            }
            self.place(data, wave.velocity, row, [front_v, back_v]);
            self.place(data, wave.stress, row, [front_s, back_s]);
        }
    }

    fn is_one_sided(&self, end: usize) -> bool {
        matches!(&self.sides[end], Side::Mirror(mirror) if mirror.is_one_sided)
    }

    /// The constants of the cell at a place of a row, in all lanes.
    #[inline(always)]
    fn cell<V: Vector<T>>(&self, row: usize, (group, lane): Slot, wave: &Wave) -> Cell<V> {
        let pattern = self.patterns[self.group + row * self.ends.groups + group];
        let cell = self.table.cell(pattern, wave);
        Cell {
            impedance: V::all(cell.impedance.lanes()[lane]),
            half_courant: V::all(cell.half_courant.lanes()[lane]),
            to_velocity: V::all(cell.to_velocity.lanes()[lane]),
            mean_slope: V::all(cell.mean_slope.lanes()[lane]),
            steepest: V::all(cell.steepest.lanes()[lane]),
        }
    }

    /// Sets to zero what is no cell in a field of a row: ghosts, and what the sweep made of them.
    #[inline(always)]
    pub(crate) fn clear(&self, data: &mut [T::Lanes], place: usize, row: usize) {
        let field = &mut data[self.first + row * self.size + place..][..self.ends.groups];
        for &(group, lane) in &self.ends.empty {
            field[group].lanes_mut()[lane] = T::ZERO;
        }
    }

    /// What lies beyond an end, by face: see [`Mirror::face`](crate::side::Mirror::face).
    #[inline(always)]
    fn mirror(&self, end: usize, pair: usize, group: usize) -> &[T::Lanes; 5] {
        match &self.sides[end] {
            Side::Mirror(mirror) => mirror.face(pair, group),
            Side::Periodic | Side::Cut => &self.ends.window,
        }
    }

    /// Puts the ghosts of a field in front of a row and behind it.
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
            own.after(in_front[depth]).store(&mut ghosts[depth * apart]);
            // With the ghosts that are about to stand there.
            let own = V::load(&field[depth]).with_lanes(in_first[depth][0], beyond[0]);
            let own = own.with_lanes(in_first[depth][1], beyond[1]);
            own.before(V::ZERO).store(&mut ghosts[(GHOSTS + depth) * apart]);
        }
        for depth in 0..GHOSTS {
            let (group, lane) = behind[depth];
            let own = V::load(&field[group]).with_lanes(1 << lane, beyond[depth]);
            own.store(&mut field[group]);
        }
    }
}

// No closures here, and no arrays made by them: they are not compiled for the instructions at hand.

/// The numbers of a lane of a mirror in all lanes.
#[inline(always)]
fn splat<T: Real, V: Vector<T>>(mirror: &[T::Lanes; 5], lane: usize) -> [V; 5] {
    let mut all = [V::ZERO; 5];
    for (own, lanes) in all.iter_mut().zip(mirror) {
        *own = V::all(lanes.lanes()[lane]);
    }
    all
}

#[inline(always)]
fn images<N: Number>(mirror: [N; 2], own: [N; GHOSTS]) -> [N; GHOSTS] {
    [image(mirror, own[0]), image(mirror, own[1])]
}

#[inline(always)]
fn pair_of<N: Number>(velocity: [N; GHOSTS], stress: [N; GHOSTS]) -> [State<N>; GHOSTS] {
    [
        State { velocity: velocity[0], stress: stress[0] },
        State { velocity: velocity[1], stress: stress[1] },
    ]
}

/// A number of a field in all lanes.
#[inline(always)]
fn seen<T: Real, V: Vector<T>>(field: &[T::Lanes], (group, lane): Slot) -> V {
    V::all(field[group].lanes()[lane])
}
