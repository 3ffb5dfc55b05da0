//! Ghost cells at the ends of rows; [`super::layout`] states how rows are folded into lanes.

use super::material_table::{MaterialTable, WavePair};
use crate::simd::{LaneGroup, Number, Real, Vector};
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{
    BoundaryClosure, BoundaryFaces, CLOSURE_CELLS, LaneIndex, compute_ghosts, image,
};
use crate::solid::reconstruction::{GHOSTS, MAX_GHOSTS, Slopes};
use crate::solid::riemann::State;
use std::ops::Range;

/// Storage positions (group and lane) of cells and ghosts at the ends of a row.
#[derive(Clone)]
pub(crate) struct RowEnds<T: Real> {
    /// Number of groups of a row.
    groups: usize,
    /// Number of ghosts beyond each end.
    ghosts: usize,
    /// Positions of the outermost cells at each end, on which ghosts depend; shorter rows are continued periodically.
    outer_cells: [[LaneIndex; MAX_GHOSTS]; 2],
    /// Whether a row has a single cell.
    has_single_cell: bool,
    /// Whether a row has fewer cells than its ghosts depend on.
    has_few_cells: bool,
    /// Positions of the ghosts after the last cell; behind them, the last one is repeated.
    ghosts_after_last_cell: [LaneIndex; MAX_GHOSTS],
    /// By group, for as many first groups of a row as there are ghosts, and by depth of the ghosts after the last cell:
    /// mask of the lane that holds the ghost, 0 if the ghost is in another group.
    first_group_masks: [[u16; MAX_GHOSTS]; MAX_GHOSTS],
    /// Positions of the padding lanes after the last cell. During a sweep the first of them hold the ghosts, and the
    /// sweep changes as many after these; otherwise all are zero.
    padding: Vec<LaneIndex>,
    /// Ghost rule that copies values, the sign of zero included: for periodic ends.
    copying_rule: [T::Lanes; 5],
}

impl<T: Real> RowEnds<T> {
    /// Creates the ends of rows of `length` cells in `groups` groups, with `ghosts` ghosts beyond each.
    pub(crate) fn new(length: usize, groups: usize, ghosts: usize) -> Self {
        let slot = |place: usize| (place % groups, place / groups);
        let ghosts_after_last_cell =
            std::array::from_fn(|depth| slot(length + depth.min(ghosts - 1)));
        Self {
            groups,
            ghosts,
            outer_cells: [
                std::array::from_fn(|depth| slot(depth % length)),
                std::array::from_fn(|depth| slot(length - 1 - depth % length)),
            ],
            has_single_cell: length < GHOSTS,
            has_few_cells: length < CLOSURE_CELLS,
            ghosts_after_last_cell,
            first_group_masks: std::array::from_fn(|first| {
                ghosts_after_last_cell
                    .map(|(group, lane)| if group == first { 1 << lane } else { 0 })
            }),
            padding: (length..groups * T::Lanes::COUNT).take(2 * ghosts).map(slot).collect(),
            copying_rule: [
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
    pub(crate) boundaries: &'a [BoundaryFaces<T>; 2],
    /// Index of the first row among the faces of the boundaries.
    pub(crate) first_face: usize,
    /// Data index of the first row.
    pub(crate) first_data: usize,
    /// Distance between two rows, and between the ghosts of two rows.
    pub(crate) size: usize,
    /// Data index of the ghosts of the first row: those before its first group, then those after its last group, each
    /// from the nearest to the farthest one.
    pub(crate) first_ghost: usize,
    /// Distance between two of these ghosts.
    pub(crate) ghost_stride: usize,
    /// Index of the first group of the first row.
    pub(crate) first_group: usize,
    pub(crate) table: &'a MaterialTable<T>,
    /// By group, the index of its lane pattern.
    pub(crate) lane_pattern_indices: &'a [u32],
}

impl<T: Real> Rows<'_, T> {
    /// Fills the ghosts of velocity and stress of a pair of waves: those after the last cell, in the row itself, and
    /// the groups before the first and after the last group of a row, whose values are in the adjacent lanes.
    #[inline(always)]
    pub(crate) fn fill_ghosts<V: Vector<T>>(
        &self,
        field_data: &mut [T::Lanes],
        wave: &WavePair,
        pair: usize,
        rows: Range<usize>,
    ) {
        let &RowEnds { groups, outer_cells: [first, last], .. } = self.ends;
        let lower_sources = if self.boundaries[0].ghost_rule().is_some() { first } else { last };
        let upper_sources = if self.boundaries[1].ghost_rule().is_some() { last } else { first };
        let is_one_sided = |end: usize| self.boundaries[end].closure().slopes != Slopes::Godunov;
        if !self.ends.has_few_cells && (is_one_sided(0) || is_one_sided(1)) {
            return self.fill_one_sided_ghosts::<V>(field_data, wave, pair, rows);
        }
        for row in rows {
            let (group, lane) = (
                (self.first_face + row) / T::Lanes::COUNT,
                (self.first_face + row) % T::Lanes::COUNT,
            );
            let lower_rule: [V; 5] = broadcast_rule(self.ghost_rule(0, pair, group), lane);
            let upper_rule: [V; 5] = broadcast_rule(self.ghost_rule(1, pair, group), lane);
            let start = self.first_data + row * self.size;
            for (place, [lower_rule, upper_rule]) in [
                (wave.velocity, [[lower_rule[0], lower_rule[1]], [upper_rule[0], upper_rule[1]]]),
                (wave.stress, [[lower_rule[2], lower_rule[3]], [upper_rule[2], upper_rule[3]]]),
            ] {
                let field = &field_data[start + place..][..groups];
                let mut lower_ghosts = [V::ZERO; MAX_GHOSTS];
                let mut upper_ghosts = [V::ZERO; MAX_GHOSTS];
                for depth in 0..self.ends.ghosts {
                    lower_ghosts[depth] =
                        image(lower_rule, broadcast_value(field, lower_sources[depth]));
                    upper_ghosts[depth] =
                        image(upper_rule, broadcast_value(field, upper_sources[depth]));
                }
                if self.ends.has_single_cell {
                    // In a row of a single cell the second ghost is the image of the ghost at the other end.
                    let lower_source = broadcast_value(field, lower_sources[1]);
                    let upper_source = broadcast_value(field, upper_sources[1]);
                    lower_ghosts[1] = image(lower_rule, image(upper_rule, lower_source));
                    upper_ghosts[1] = image(upper_rule, image(lower_rule, upper_source));
                }
                self.store_ghosts(field_data, place, row, [lower_ghosts, upper_ghosts]);
            }
        }
    }

    /// Fills the ghosts of a history variable at offset `place`: with the value of the end, or copied where there is
    /// none.
    #[inline(always)]
    pub(crate) fn fill_history_ghosts<V: Vector<T>>(
        &self,
        field_data: &mut [T::Lanes],
        place: usize,
        values: [Option<T>; 2],
        rows: Range<usize>,
    ) {
        let &RowEnds { groups, outer_cells: [first, last], .. } = self.ends;
        for row in rows {
            let field = &field_data[self.first_data + row * self.size + place..][..groups];
            let mut ghosts = [[V::ZERO; MAX_GHOSTS]; 2];
            for (ghosts, (value, sources)) in
                ghosts.iter_mut().zip(values.into_iter().zip([last, first]))
            {
                for depth in 0..self.ends.ghosts {
                    ghosts[depth] = match value {
                        Some(value) => V::splat(value),
                        None => broadcast_value(field, sources[depth]),
                    };
                }
            }
            self.store_ghosts(field_data, place, row, ghosts);
        }
    }

    /// Fills the ghosts as [`Self::fill_ghosts`] does, for waves with one-sided reconstruction: many rows at a time,
    /// one per lane.
    #[inline(always)]
    fn fill_one_sided_ghosts<V: Vector<T>>(
        &self,
        field_data: &mut [T::Lanes],
        wave: &WavePair,
        pair: usize,
        rows: Range<usize>,
    ) {
        let closures = [self.boundaries[0].closure(), self.boundaries[1].closure()];
        let mut start = rows.start;
        while start < rows.end {
            let end = rows.end.min(start + T::Lanes::COUNT);
            let [lower_rule, upper_rule] = [
                self.compute_one_sided_ghosts::<V>(
                    closures[0],
                    field_data,
                    wave,
                    pair,
                    (start..end, 0),
                ),
                self.compute_one_sided_ghosts::<V>(
                    closures[1],
                    field_data,
                    wave,
                    pair,
                    (start..end, 1),
                ),
            ];
            for row in start..end {
                let lane = row - start;
                for (place, which) in [(wave.velocity, 0), (wave.stress, 1)] {
                    let mut lower_ghosts = [V::ZERO; MAX_GHOSTS];
                    let mut upper_ghosts = [V::ZERO; MAX_GHOSTS];
                    for depth in 0..GHOSTS {
                        lower_ghosts[depth] = V::splat(lower_rule[which][depth].lanes()[lane]);
                        upper_ghosts[depth] = V::splat(upper_rule[which][depth].lanes()[lane]);
                    }
                    self.store_ghosts(field_data, place, row, [lower_ghosts, upper_ghosts]);
                }
            }
            start = end;
        }
    }

    /// Returns velocities and stresses of the ghosts at an end of some rows, one row per lane.
    #[inline(always)]
    fn compute_one_sided_ghosts<V: Vector<T>>(
        &self,
        closure: BoundaryClosure,
        field_data: &[T::Lanes],
        wave: &WavePair,
        pair: usize,
        (rows, end): (Range<usize>, usize),
    ) -> [[T::Lanes; GHOSTS]; 2] {
        let outer_cells: [LaneIndex; CLOSURE_CELLS] = [
            self.ends.outer_cells[end][0],
            self.ends.outer_cells[end][1],
            self.ends.outer_cells[end][2],
        ];
        // Only non-reflecting boundaries need the state of the third cell.
        let depths = if closure.has_open_faces { CLOSURE_CELLS } else { GHOSTS };
        let mut velocity = [T::Lanes::ZERO; CLOSURE_CELLS];
        let mut stress = [T::Lanes::ZERO; CLOSURE_CELLS];
        for row in rows.clone() {
            let lane = row - rows.start;
            let start = self.first_data + row * self.size;
            for depth in 0..depths {
                let (group, from) = outer_cells[depth];
                velocity[depth].lanes_mut()[lane] =
                    field_data[start + wave.velocity + group].lanes()[from];
                stress[depth].lanes_mut()[lane] =
                    field_data[start + wave.stress + group].lanes()[from];
            }
        }
        // Ghost rules by row, unless all faces have the same rule; constants by row, unless there is only one lane
        // pattern.
        let mut by_row = *self.ghost_rule(end, pair, self.first_face / T::Lanes::COUNT);
        if !self.has_uniform_rule(end) {
            for row in rows.clone() {
                let (lane, face) = (row - rows.start, self.first_face + row);
                let face_rule = self.ghost_rule(end, pair, face / T::Lanes::COUNT);
                for (to, from) in by_row.iter_mut().zip(face_rule) {
                    to.lanes_mut()[lane] = from.lanes()[face % T::Lanes::COUNT];
                }
            }
        }
        let ghost_rule = [
            V::load(&by_row[0]),
            V::load(&by_row[1]),
            V::load(&by_row[2]),
            V::load(&by_row[3]),
            V::load(&by_row[4]),
        ];
        let mut cells = [
            CellConstants::load(self.cell_constants(rows.start, outer_cells[0], wave)),
            CellConstants::load(self.cell_constants(rows.start, outer_cells[1], wave)),
            CellConstants::load(self.cell_constants(rows.start, outer_cells[2], wave)),
        ];
        if !self.table.has_single_pattern() {
            for (cell, slot) in cells.iter_mut().zip(outer_cells) {
                *cell = self.load_cells_by_row(&rows, slot, wave);
            }
        }
        let outer_states = [
            State { velocity: V::load(&velocity[0]), stress: V::load(&stress[0]) },
            State { velocity: V::load(&velocity[1]), stress: V::load(&stress[1]) },
            State { velocity: V::load(&velocity[2]), stress: V::load(&stress[2]) },
        ];
        let coefficients = self.table.ghost_coefficients(wave, &cells[0]);
        let cells = [&cells[0], &cells[1], &cells[2]];
        let [nearest, farther] =
            compute_ghosts(closure, outer_states, ghost_rule, end, cells, &coefficients);
        let mut ghost_values = [[T::Lanes::ZERO; GHOSTS]; 2];
        nearest.velocity.store(&mut ghost_values[0][0]);
        farther.velocity.store(&mut ghost_values[0][1]);
        nearest.stress.store(&mut ghost_values[1][0]);
        farther.stress.store(&mut ghost_values[1][1]);
        ghost_values
    }

    /// Returns the constants of a cell of some rows, one row per lane; surplus lanes have those of the last row.
    #[inline(always)]
    fn load_cells_by_row<V: Vector<T>>(
        &self,
        rows: &Range<usize>,
        slot: LaneIndex,
        wave: &WavePair,
    ) -> CellConstants<V> {
        let mut cells = *self.cell_constants(rows.start, slot, wave);
        for lane in 0..T::Lanes::COUNT {
            let row = rows.start + lane.min(rows.len() - 1);
            cells.set_lane(lane, &self.cell_constants(row, slot, wave).lane(slot.1));
        }
        CellConstants::load(&cells)
    }

    /// Returns the constants of the group of a row that contains a cell.
    #[inline(always)]
    fn cell_constants(
        &self,
        row: usize,
        (group, _): LaneIndex,
        wave: &WavePair,
    ) -> &CellConstants<T::Lanes> {
        let pattern = self.lane_pattern_indices[self.first_group + row * self.ends.groups + group];
        self.table.constants(pattern, wave)
    }

    /// Sets the padding lanes of a field of a row to zero: the ghosts, and the lanes after them that the sweep has
    /// changed.
    #[inline(always)]
    pub(crate) fn clear_padding(&self, field_data: &mut [T::Lanes], place: usize, row: usize) {
        let field =
            &mut field_data[self.first_data + row * self.size + place..][..self.ends.groups];
        for &(group, lane) in &self.ends.padding {
            field[group].lanes_mut()[lane] = T::ZERO;
        }
    }

    /// Whether the ghost rule is the same at all faces of an end.
    #[inline(always)]
    fn has_uniform_rule(&self, end: usize) -> bool {
        self.boundaries[end].ghost_rule().is_none_or(|ghost_rule| ghost_rule.is_uniform)
    }

    /// Returns the ghost rule at an end for a group of faces, see
    /// [`GhostRule::group_coefficients`](crate::solid::ghosts::GhostRule::group_coefficients); at ends without physical
    /// boundary the rule that copies values.
    #[inline(always)]
    fn ghost_rule(&self, end: usize, pair: usize, group: usize) -> &[T::Lanes; 5] {
        match &self.boundaries[end] {
            BoundaryFaces::Physical(ghost_rule) => ghost_rule.group_coefficients(pair, group),
            BoundaryFaces::Periodic | BoundaryFaces::HaloEnd => &self.ends.copying_rule,
        }
    }

    /// Stores the ghosts of a field at the lower and the upper end of a row.
    #[inline(always)]
    fn store_ghosts<V: Vector<T>>(
        &self,
        field_data: &mut [T::Lanes],
        place: usize,
        row: usize,
        [lower_ghosts, upper_ghosts]: [[V; MAX_GHOSTS]; 2],
    ) {
        let &RowEnds { groups, ghosts: count, ghosts_after_last_cell, first_group_masks, .. } =
            self.ends;
        let (field_data, ghosts) = field_data.split_at_mut(self.first_ghost);
        let ghost_stride = self.ghost_stride;
        let start = row * self.size + place;
        let field = &mut field_data[self.first_data + start..][..groups];
        let ghosts = &mut ghosts[start..][..(2 * count - 1) * ghost_stride + 1];
        for depth in 0..count {
            let values = V::load(&field[groups - 1 - depth]);
            values.shift_in_low(lower_ghosts[depth]).store(&mut ghosts[depth * ghost_stride]);
            // Insert the ghosts after the last cell, which are stored in the row itself only at the end of this
            // function.
            let mut values = V::load(&field[depth]);
            for (lanes, ghost) in first_group_masks[depth].into_iter().zip(upper_ghosts).take(count)
            {
                values = values.blend_lanes(lanes, ghost);
            }
            values.shift_in_high(V::ZERO).store(&mut ghosts[(count + depth) * ghost_stride]);
        }
        for depth in 0..count {
            let (group, lane) = ghosts_after_last_cell[depth];
            let values = V::load(&field[group]).blend_lanes(1 << lane, upper_ghosts[depth]);
            values.store(&mut field[group]);
        }
    }
}

// No closures here, and no arrays made by them: closures are not inlined into the target-feature function and lose its
// SIMD instructions.

/// Broadcasts one lane of a ghost rule to all lanes.
#[inline(always)]
fn broadcast_rule<T: Real, V: Vector<T>>(ghost_rule: &[T::Lanes; 5], lane: usize) -> [V; 5] {
    let mut broadcast = [V::ZERO; 5];
    for (own, lanes) in broadcast.iter_mut().zip(ghost_rule) {
        *own = V::splat(lanes.lanes()[lane]);
    }
    broadcast
}

/// Broadcasts one value of a field to all lanes.
#[inline(always)]
fn broadcast_value<T: Real, V: Vector<T>>(field: &[T::Lanes], (group, lane): LaneIndex) -> V {
    V::splat(field[group].lanes()[lane])
}
