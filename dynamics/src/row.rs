//! The ends of rows, which are folded into the lanes of groups: see [`crate::domain`].

use crate::line::GHOSTS;
use crate::real::{Group, Number, Real, Vector};
use crate::side::{Side, Slot, shown};
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
    window: [T::Lanes; 4],
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
            window: [T::Lanes::ONE, -T::Lanes::ZERO, T::Lanes::ONE, -T::Lanes::ZERO],
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
}

impl<T: Real> Rows<'_, T> {
    /// Fills in the ghosts of the velocity and the stress of a pair of waves: those behind the last cell of a row in the
    /// row itself; and what is in front of its groups and behind them, which is in other lanes.
    #[inline(always)]
    pub(crate) fn fill<V: Vector<T>>(
        &self,
        data: &mut [T::Lanes],
        [velocity, stress]: [usize; 2],
        pair: usize,
        rows: Range<usize>,
    ) {
        self.fill_field::<V, 0>(data, velocity, pair, rows.clone());
        self.fill_field::<V, 2>(data, stress, pair, rows);
    }

    /// Sets to zero what is no cell in a field of a row: ghosts, and what the sweep made of them.
    #[inline(always)]
    pub(crate) fn clear(&self, data: &mut [T::Lanes], place: usize, row: usize) {
        let field = &mut data[self.first + row * self.size + place..][..self.ends.groups];
        for &(group, lane) in &self.ends.empty {
            field[group].lanes_mut()[lane] = T::ZERO;
        }
    }

    /// Sign of v, shift of v, sign of s, shift of s of what lies beyond an end, by face.
    #[inline(always)]
    fn mirror(&self, end: usize, pair: usize, group: usize) -> &[T::Lanes; 4] {
        match &self.sides[end] {
            Side::Mirror(mirror) => mirror.face(pair, group),
            Side::Periodic | Side::Cut => &self.ends.window,
        }
    }

    /// The ghosts of a field: `SIGN` is its place among the four of a mirror.
    #[inline(always)]
    fn fill_field<V: Vector<T>, const SIGN: usize>(
        &self,
        data: &mut [T::Lanes],
        place: usize,
        pair: usize,
        rows: Range<usize>,
    ) {
        let &RowEnds { groups, inside: [first, last], behind, in_first, .. } = self.ends;
        // Rows come round at both ends or at none.
        let [near, far] = match self.sides[0] {
            Side::Mirror(_) => [first, last],
            Side::Periodic | Side::Cut => [last, first],
        };
        let (data, ghosts) = data.split_at_mut(self.ghosts);
        let apart = self.apart;
        for row in rows {
            let start = row * self.size + place;
            let field = &mut data[self.first + start..][..groups];
            let ghosts = &mut ghosts[start..][..(2 * GHOSTS - 1) * apart + 1];
            let (group, lane) =
                ((self.face + row) / T::Lanes::COUNT, (self.face + row) % T::Lanes::COUNT);
            let [front, back] = [self.mirror(0, pair, group), self.mirror(1, pair, group)];
            // No closures, and no arrays made by them: they are not compiled for the instructions at hand.
            let front = [V::all(front[SIGN].lanes()[lane]), V::all(front[SIGN + 1].lanes()[lane])];
            let back = [V::all(back[SIGN].lanes()[lane]), V::all(back[SIGN + 1].lanes()[lane])];
            let near: [V; GHOSTS] = [seen(field, near[0]), seen(field, near[1])];
            let far: [V; GHOSTS] = [seen(field, far[0]), seen(field, far[1])];
            let mut in_front = [shown(front, near[0]), shown(front, near[1])];
            let mut beyond = [shown(back, far[0]), shown(back, far[1])];
            if self.ends.is_single {
                // A single cell is seen through the other mirror.
                in_front[1] = shown(front, shown(back, near[1]));
                beyond[1] = shown(back, shown(front, far[1]));
            }
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
}

/// A number of a field in all lanes.
#[inline(always)]
fn seen<T: Real, V: Vector<T>>(field: &[T::Lanes], (group, lane): Slot) -> V {
    V::all(field[group].lanes()[lane])
}
