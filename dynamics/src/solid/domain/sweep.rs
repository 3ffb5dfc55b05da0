//! Sweeps along the axes, ghosts beyond the ends of lines, and the work done at boundaries.

use super::ghost_kernels::{ImageGhostKernel, OneSidedGhostKernel, RowGhostKernel};
use super::kernel::interlayers::PathInterlayers;
use super::kernel::{CarriedState, MAX_PREFETCH_FIELDS, PrefetchL2, SweepLines};
use super::layout::{GroupIndex, RowSegment};
use super::material_table::WavePair;
use super::rows::Rows;
use super::schedule::CHUNK_SIZE;
use super::{Domain, SolverReal};
use crate::simd::LaneGroup;
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BoundaryFaces, CLOSURE_CELLS};
use crate::solid::line;
use crate::solid::reconstruction::{GHOSTS, MAX_GHOSTS, Slopes};
use crate::solid::riemann::State;
use models::interface::Interval;
use std::ops::Range;

/// L1 prefetch distance in lines, by axis; in sweeps along rows the next row is prefetched.
const PREFETCH_LINES: [Option<usize>; 3] = [None, Some(2), Some(3)];

/// Distance between two groups of a row.
const GROUP_STRIDE: GroupIndex = GroupIndex { group: 1, start: 1 };

/// Bundle of adjacent lines.
#[derive(Clone, Copy)]
struct LineBundle {
    axis: usize,
    /// Index of the half step in the pass: even for the first half of a step, odd for the second.
    half_step: usize,
    /// First group of the first line; the other lines are offset by multiples of `line_stride`.
    first: GroupIndex,
    /// Distance between two groups of a line.
    stride: GroupIndex,
    /// Number of groups of a line.
    count: usize,
    /// Number of lines of groups.
    lines: usize,
    /// Distance between two lines.
    line_stride: GroupIndex,
    /// Index of the boundary face at which the first line ends: a row index for lines along the first axis, otherwise
    /// the index of a group of faces.
    face: usize,
    /// Index of the first line in `Buffers::carried_states` of the axis and half step: the states that the sweep
    /// carries along the lines from one tile to the next.
    carried: usize,
}

impl LineBundle {
    /// Returns the group at a place (index along the line, ghosts excluded) of the first line.
    #[inline(always)]
    fn group_at(self, place: usize) -> GroupIndex {
        let Self { first, stride, .. } = self;
        GroupIndex {
            group: first.group + place * stride.group,
            start: first.start + place * stride.start,
        }
    }

    /// Returns the places of the ghosts at a depth beyond the lower and the upper end of a line of groups: −1 − depth
    /// and count + depth.
    fn ghost_positions(self, depth: usize) -> [isize; 2] {
        [-1 - depth as isize, (self.count + depth) as isize]
    }
}

/// Sweeps, their ghosts and the work at boundaries.
impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Applies the sweeps within a layer, along x and in space along y, of the half step with index `half_step` in the
    /// pass: x y in the first half of a step (even index), y x in the second half (odd index), there only y if the
    /// scheme is alternating. `entered`, `middle`, `last`: rows that pass each of the three stages of
    /// [`super::schedule::stage_progress`].
    pub(super) fn sweep_layer(
        &mut self,
        layer: usize,
        [entered, middle, last]: &[Range<usize>; 3],
        half_step: usize,
    ) {
        let (groups, first_row) = (self.layout.groups, layer * self.layout.rows);
        let is_second = half_step % 2 == 1;
        let of_layer = |rows: &Range<usize>| first_row + rows.start..first_row + rows.end;
        match is_second {
            false => {
                self.sweep_rows(of_layer(entered), half_step);
                self.apply_contact_laws(layer, entered);
            }
            // Completes the sweep along the last axis.
            true => self.apply_contact_laws(layer, middle),
        }
        if D == 3 && !self.sweep_if_idle(1, of_layer([entered, middle][half_step % 2]), half_step) {
            let bundle = LineBundle {
                axis: 1,
                half_step,
                first: self.layout.group_index(first_row, 0),
                stride: self.layout.group_index(1, 0),
                count: self.layout.cells[1],
                lines: groups,
                line_stride: GROUP_STRIDE,
                face: layer * groups,
                carried: layer * groups,
            };
            self.continue_sweep(bundle, [entered, middle][half_step % 2].clone());
            self.apply_contact_laws(layer, [middle, last][half_step % 2]);
        }
        if is_second && !self.scheme.is_alternating() {
            self.sweep_rows(of_layer(last), half_step);
            self.apply_contact_laws(layer, last);
        }
    }

    /// Sweeps adjacent rows along the first axis in the half step with index `half_step` in the pass, by half a step.
    /// If the scheme alternates between sweeps along the first axis and along the others, the very first sweep of the
    /// simulation is by a quarter of a step.
    pub(super) fn sweep_rows(&mut self, rows: Range<usize>, half_step: usize) {
        if self.sweep_if_idle(0, rows.clone(), half_step) {
            return;
        }
        // If rows differ in cell length, they are swept one at a time, with the constants of the row.
        let chunk = if self.materials.row_constants.is_some() { 1 } else { CHUNK_SIZE };
        for start in rows.clone().step_by(chunk) {
            self.fill_row_constants(start);
            self.sweep_row_bundle(start..rows.end.min(start + chunk), half_step);
        }
    }

    /// Sweeps at most [`CHUNK_SIZE`] rows by half a step along the first axis.
    fn sweep_row_bundle(&mut self, rows: Range<usize>, half_step: usize) {
        let bundle = LineBundle {
            axis: 0,
            half_step,
            first: self.layout.group_index(rows.start, 0),
            stride: GROUP_STRIDE,
            count: self.layout.groups,
            lines: rows.len(),
            line_stride: self.layout.group_index(1, 0),
            face: rows.start,
            carried: 0,
        };
        self.set_ghost_patterns(bundle);
        let works = |end_faces: &BoundaryFaces<T>| matches!(end_faces, BoundaryFaces::Physical(ghost_rule) if ghost_rule.can_do_work);
        if self.boundaries.faces[half_step][0].iter().any(works) {
            self.fill_row_ghosts(bundle);
            (0..2).for_each(|end| self.accumulate_boundary_work(bundle, end));
        }
        self.sweep_path(bundle, -1..self.layout.groups as isize + 1);
    }

    /// Returns the rows of a bundle along the first axis.
    fn bundle_rows(&self, bundle: LineBundle) -> Rows<'_, T> {
        let size = self.layout.row_size();
        Rows {
            ends: &self.boundaries.row_ends,
            boundaries: &self.boundaries.faces[bundle.half_step][0],
            first_face: bundle.face,
            first_data: bundle.first.start,
            size,
            first_ghost: self.layout.layers() * self.layout.rows * size,
            ghost_stride: self.layout.ghost_rows() * size,
            first_group: bundle.first.group,
            table: self.materials.axis_table(0),
            lane_pattern_indices: &self.materials.lane_pattern_indices,
        }
    }

    /// Fills the ghosts of rows, before the work at boundaries is computed; the sweep kernel fills them again.
    fn fill_row_ghosts(&mut self, bundle: LineBundle) {
        let mut field_data = std::mem::take(&mut self.field_data);
        let (waves, rows) = (self.sweep_waves(0, bundle.half_step), self.bundle_rows(bundle));
        let fill =
            RowGhostKernel { field_data: &mut field_data, waves, rows, row_count: bundle.lines };
        self.instructions.run_kernel::<T>(fill);
        self.field_data = field_data;
    }

    /// Continues a sweep of half a step along the last axis in a segment of a row. `ready`: layers that the previous
    /// stage has completed since the last call; `ends`: all layers of the sweep in this pass.
    pub(super) fn sweep_last_axis(
        &mut self,
        ready: &Range<usize>,
        ends: &Range<usize>,
        tile: &RowSegment,
        half_step: usize,
    ) {
        if self.sweep_last_axis_if_idle(ready, tile, half_step) {
            return;
        }
        let face = tile.row * self.layout.groups + tile.groups.start;
        let bundle = LineBundle {
            axis: D - 1,
            half_step,
            first: self
                .layout
                .group_index(ends.start * self.layout.rows + tile.row, tile.groups.start),
            stride: self.layout.group_index(self.layout.rows, 0),
            count: ends.len(),
            lines: tile.groups.len(),
            line_stride: GROUP_STRIDE,
            face,
            carried: face,
        };
        self.continue_sweep(bundle, ready.start - ends.start..ready.end - ends.start);
    }

    /// Continues a sweep across rows or layers: `ready` are the places along the lines that the previous stage has
    /// completed since the last call. The sweep updates the cells at places below `ready.end` minus the number of ghosts
    /// or, if `ready` reaches the upper end of the lines, all cells.
    fn continue_sweep(&mut self, bundle: LineBundle, ready: Range<usize>) {
        // The ghosts at the lower end depend on these cells: wait until they are loaded.
        let outer_cells = CLOSURE_CELLS.max(self.layout.ghosts);
        if ready.is_empty() || ready.end < outer_cells.min(bundle.count) {
            return;
        }
        let start = if ready.start < outer_cells { 0 } else { ready.start };
        let ready = start..ready.end;
        let ends = [ready.start == 0, ready.end == bundle.count];
        // Fill both ends first: in a line of a single cell the work at one end depends on the ghosts at the other.
        for end in (0..2).filter(|end| ends[*end]) {
            self.fill_end_ghosts(bundle, end);
        }
        for end in (0..2).filter(|end| ends[*end]) {
            self.accumulate_boundary_work(bundle, end);
        }
        let start = ready.start as isize - 1;
        let end = match ends[1] {
            true => bundle.count as isize + 1,
            false => ready.end as isize + 1 - self.layout.ghosts as isize,
        };
        self.sweep_path(bundle, start..end);
    }

    /// Sweeps a section of lines with the selected instruction set: the groups at `places` are current one after the
    /// other.
    fn sweep_path(&mut self, bundle: LineBundle, places: Range<isize>) {
        let LineBundle { axis, half_step, lines, .. } = bundle;
        let mut path = std::mem::take(&mut self.buffers.path);
        path.clear();
        // Beyond the current groups, the path holds those that the stencils reach.
        let (reach, count) = (self.layout.ghosts as isize - 1, bundle.count as isize);
        let (first, end) = (places.start - reach, places.end + reach);
        let previous_group = self.path_group(bundle, 0, (first - 1).max(-(GHOSTS as isize)));
        path.extend((first..0).map(|place| self.path_group(bundle, 0, place)));
        path.extend((first.max(0)..end.min(count)).map(|place| bundle.group_at(place as usize)));
        path.extend((first.max(count)..end).map(|place| self.path_group(bundle, 0, place)));
        let field_count = self.fields().len();
        let prefetch_l1_distance = PREFETCH_LINES[axis].unwrap_or(self.layout.row_size());
        let prefetch_l2 = self.choose_prefetch_l2(bundle);
        let slots =
            self.materials.waves[axis].len() * CarriedState::<T::Lanes>::slots(self.layout.ghosts);
        let before = bundle.carried * slots;
        let mut carried = std::mem::take(&mut self.buffers.carried_states[axis][half_step]);
        let mut field_data = std::mem::take(&mut self.field_data);
        let mut history = std::mem::take(&mut self.interfaces.history);
        let mut states = std::mem::take(&mut self.buffers.interlayer_states);
        let waves = self.sweep_waves(axis, half_step);
        let origin = self.axis_origin(bundle) as isize;
        let faces = self.interfaces.path_faces(axis, bundle.face, origin + first..origin + end);
        let interlayers = faces.map(|faces| {
            let (history, states) = (&mut *history, &mut states);
            let interval = self.sweep_interval(half_step);
            let holds_shear = self.shear_duration(half_step) == 0.0;
            PathInterlayers { faces, history, interval, holds_shear, states }
        });
        let lines = SweepLines {
            field_data: &mut field_data,
            field_count,
            pitch: self.layout.pitch,
            table: self.materials.axis_table(axis),
            waves,
            slopes: self.scheme.slopes,
            lane_pattern_indices: &self.materials.lane_pattern_indices,
            run_lengths: &self.materials.run_lengths[axis],
            path: &path,
            previous_group,
            line_stride: bundle.line_stride,
            is_line_start: places.start < 0,
            prefetch_l1_distance,
            prefetch_l2,
            carried: &mut carried[before..before + lines * slots],
            rows: (axis == 0).then(|| self.bundle_rows(bundle)),
            interlayers,
            contacts: self.path_contacts(axis, half_step),
        };
        lines.sweep_path(self.instructions);
        self.buffers.interlayer_states = states;
        self.interfaces.history = history;
        self.field_data = field_data;
        self.buffers.carried_states[axis][half_step] = carried;
        self.buffers.path = path;
    }

    /// Chooses the L2 prefetch distance to the rows that are loaded next, and the fields that this sweep prefetches.
    /// The sweeps across rows and layers share the fields among them, so that the requests are spread over time.
    fn choose_prefetch_l2(&self, bundle: LineBundle) -> PrefetchL2 {
        let LineBundle { axis, half_step, face, .. } = bundle;
        // `rows` and `layers`: distance of this sweep behind the rows loaded last, in units of as many rows and layers
        // as there are ghosts; in the plane, layers are rows.
        let (part, parts, rows, layers) = match (D, axis, half_step) {
            // In the plane, prefetch only in the last step of a pass: earlier requests would be evicted.
            (2, 1, half_step) if half_step + 2 >= 2 * self.schedule.pass_steps => {
                (half_step % 2, 2, half_step, 0)
            }
            // No other sweep across rows runs yet: this one prefetches all fields.
            (3, 1, 0) if self.layout.is_in_any_halo(face / self.layout.groups) => (0, 1, 0, 0),
            (3, 1, 0) => (0, 4, 0, 0),
            (3, 2, 0) => (1, 4, 1, 0),
            (3, 2, 1) => (2, 4, 1, 1),
            (3, 1, 1) => (3, 4, 1, 2),
            _ => return PrefetchL2 { distance: 0, fields: 0..0 },
        };
        let behind =
            self.schedule.prefetch_rows + self.layout.ghosts * (rows + layers * self.layout.rows);
        let share = MAX_PREFETCH_FIELDS / parts;
        PrefetchL2 {
            distance: behind * self.layout.row_size(),
            fields: part * share..(part + 1) * share,
        }
    }

    /// Returns the group at a place of a line, ghosts included: the ghosts of all lines at one end and depth are
    /// adjacent.
    fn path_group(&self, bundle: LineBundle, line: usize, place: isize) -> GroupIndex {
        let ghost = |end: usize, depth: usize| {
            let ghost_rows = (end * self.layout.ghosts + depth) * self.layout.ghost_rows();
            let row = self.layout.layers() * self.layout.rows + ghost_rows;
            self.layout.group_index(row, 0).shift_to_line(line, bundle.line_stride)
        };
        match usize::try_from(place) {
            Ok(place) if place < bundle.count => {
                bundle.group_at(place).shift_to_line(line, bundle.line_stride)
            }
            Ok(place) => ghost(1, place - bundle.count),
            Err(_) => ghost(0, place.unsigned_abs() - 1),
        }
    }

    /// Returns the state in a lane of a group.
    fn lane_state(&self, (stop, lane): (GroupIndex, usize), wave: &WavePair) -> State<T> {
        let group = &self.field_data[stop.start..];
        State {
            velocity: group[wave.velocity].lanes()[lane],
            stress: group[wave.stress].lanes()[lane],
        }
    }

    /// Sets the lane patterns of the ghosts of rows.
    fn set_ghost_patterns(&mut self, bundle: LineBundle) {
        for line in 0..bundle.lines {
            let Some(&ghost_patterns) =
                self.materials.ghost_pattern_indices.get(bundle.face + line)
            else {
                return;
            };
            for depth in 0..GHOSTS {
                for (end, place) in bundle.ghost_positions(depth).into_iter().enumerate() {
                    let ghost = self.path_group(bundle, line, place).group;
                    self.materials.lane_pattern_indices[ghost] =
                        ghost_patterns[end * GHOSTS + depth];
                }
            }
        }
    }

    /// Fills the ghosts at an end of lines that cross rows or layers. At the outer end of a halo their values are
    /// arbitrary but must stay bounded, since the kernel updates them in each sweep.
    fn fill_end_ghosts(&mut self, bundle: LineBundle, end: usize) {
        let LineBundle { axis, half_step, count, lines, face, .. } = bundle;
        let boundaries = &self.boundaries.faces[half_step][axis];
        let mut field_data = std::mem::take(&mut self.field_data);
        let ghosts = self.layout.ghosts;
        let places: [[GroupIndex; 2]; MAX_GHOSTS] = std::array::from_fn(|depth| {
            let depth = depth.min(ghosts - 1);
            let source_end =
                if matches!(boundaries[end], BoundaryFaces::Periodic) { 1 - end } else { end };
            let source_position = [depth % count, count - 1 - depth % count][source_end];
            [source_position as isize, bundle.ghost_positions(depth)[end]]
                .map(|place| self.path_group(bundle, 0, place))
        });
        if !self.materials.run_lengths[axis].is_empty() {
            for [source, ghost] in places.into_iter().take(ghosts) {
                for line in 0..lines {
                    let [source, ghost] =
                        [source, ghost].map(|stop| stop.shift_to_line(line, bundle.line_stride));
                    self.materials.lane_pattern_indices[ghost.group] =
                        self.materials.lane_pattern_indices[source.group];
                }
            }
        }
        if let Some(contacts) = self.path_contacts(axis, half_step) {
            for place in contacts.history_offsets() {
                for [source, ghost] in places.into_iter().take(ghosts) {
                    for line in 0..lines {
                        field_data[ghost.start + place + line] = match contacts.boundary_values[end]
                        {
                            Some(value) => T::Lanes::splat(value),
                            None => field_data[source.start + place + line],
                        };
                    }
                }
            }
        }
        match boundaries[end].ghost_rule() {
            Some(ghost_rule) if ghost_rule.is_one_sided && count >= CLOSURE_CELLS => {
                let outer_cells: [GroupIndex; CLOSURE_CELLS] = std::array::from_fn(|depth| {
                    let place = [depth, count - 1 - depth][end];
                    bundle.group_at(place)
                });
                let fill = OneSidedGhostKernel {
                    field_data: &mut field_data,
                    waves: self.sweep_waves(axis, half_step),
                    ghost_rule,
                    end,
                    outer_cells: outer_cells.map(|stop| stop.start),
                    ghosts: [places[0][1].start, places[1][1].start],
                    lines,
                    face,
                    table: &self.materials.table,
                    lane_pattern_indices: outer_cells
                        .map(|stop| &self.materials.lane_pattern_indices[stop.group..]),
                };
                self.instructions.run_kernel::<T>(fill);
            }
            _ => {
                for (depth, [source, ghost]) in places.into_iter().take(ghosts).enumerate() {
                    // In a line of a single cell the second ghost is the image of the ghost at the other end.
                    let applied_ends =
                        if depth < count { [None, Some(end)] } else { [Some(1 - end), Some(end)] };
                    let fill = ImageGhostKernel {
                        field_data: &mut field_data,
                        waves: self.sweep_waves(axis, half_step),
                        ghost_rules: applied_ends.map(|end| boundaries[end?].ghost_rule()),
                        source_and_ghost: [source.start, ghost.start],
                        lines,
                        face,
                    };
                    self.instructions.run_kernel::<T>(fill);
                }
            }
        }
        self.field_data = field_data;
    }

    /// Returns the number of cells of a line, and the number of lines of cells per line of groups.
    fn cell_and_line_counts(&self, bundle: LineBundle) -> (usize, usize) {
        match bundle.axis {
            0 => (self.layout.cells[0], 1),
            _ => (bundle.count, T::Lanes::COUNT),
        }
    }

    /// Whether a lane of a line of groups holds cells.
    fn has_cells(&self, bundle: LineBundle, line: usize, lane: usize) -> bool {
        let place = (bundle.first.group + line) % self.layout.groups;
        bundle.axis == 0 || lane * self.layout.groups + place < self.layout.cells[0]
    }

    /// Returns group and lane of a cell of a line.
    fn cell_position(
        &self,
        bundle: LineBundle,
        (line, lane): (usize, usize),
        place: usize,
    ) -> (GroupIndex, usize) {
        let (place, lane) = match bundle.axis {
            0 => (place % self.layout.groups, place / self.layout.groups),
            _ => (place, lane),
        };
        (self.path_group(bundle, line, place as isize), lane)
    }

    /// Reads state and constants of a pair of waves at a place of a line, ghosts included.
    fn read_cell(
        &self,
        bundle: LineBundle,
        (line, lane): (usize, usize),
        place: isize,
        pair: usize,
    ) -> (State<T>, CellConstants<T>) {
        let wave = &self.sweep_waves(bundle.axis, bundle.half_step)[pair];
        // The ghosts at the upper end of a row are stored in the row itself.
        let (length, beyond) = match bundle.axis {
            0 => (self.layout.cells[0], self.layout.ghosts),
            _ => (bundle.count, 0),
        };
        let (stop, lane) = match usize::try_from(place) {
            Ok(place) if place < length + beyond => self.cell_position(bundle, (line, lane), place),
            _ => (self.path_group(bundle, line, place), lane),
        };
        let state = self.lane_state((stop, lane), wave);
        let table = self.materials.axis_table(bundle.axis);
        let cell = table.constants(self.materials.lane_pattern_indices[stop.group], wave);
        (state, cell.lane(lane))
    }

    /// Returns the area of a face times the duration of the sweep of a wave pair, m² s, by which the power per area is
    /// multiplied to give the work.
    fn face_area_time(
        &self,
        LineBundle { axis, half_step, face, .. }: LineBundle,
        pair: usize,
    ) -> f64 {
        let is_quarter = self.scheme.is_alternating()
            && axis == 0
            && self.schedule.is_first_half_step(half_step);
        let spacing = match &self.materials.row_constants {
            Some(rows) if axis == 0 => rows.spacing[face],
            _ => self.grid.spacing[axis],
        };
        let relative_duration = match self.materials.media[0].pairs[axis][pair].is_longitudinal() {
            true => 1.0,
            false => self.shear_duration(half_step),
        };
        let duration = if is_quarter { 0.25 } else { 0.5 } * self.step * relative_duration;
        self.grid.volume() / spacing * duration
    }

    /// Returns the interval of a sweep, in a problem with interlayers, which exclude alternating sweeps.
    fn sweep_interval(&self, half_step: usize) -> Interval<T> {
        let before = self.schedule.steps - self.schedule.pass_steps + half_step / 2;
        let end = match half_step % 2 {
            0 => before as f64 * self.step + 0.5 * self.step,
            _ => (before + 1) as f64 * self.step,
        };
        let step = 0.5 * self.step;
        // Without shear waves the step of tangential components has no effect, but must not be zero.
        let tangential_step = step * self.shear_duration(half_step).max(1.0);
        Interval {
            end: T::from_f64(end),
            step: T::from_f64(step),
            tangential_step: T::from_f64(tangential_step),
        }
    }

    /// Returns the coordinate of the first place of a line along its axis; along the last axis this is the index of the
    /// layer, halo included.
    fn axis_origin(&self, bundle: LineBundle) -> usize {
        if bundle.axis + 1 == D { bundle.first.group / self.layout.layer_groups() } else { 0 }
    }

    /// Adds the work that the boundary at an end of lines does in the sweep that follows.
    fn accumulate_boundary_work(&mut self, bundle: LineBundle, end: usize) {
        let LineBundle { axis, half_step, lines, .. } = bundle;
        if !matches!(&self.boundaries.faces[half_step][axis][end], BoundaryFaces::Physical(ghost_rule) if ghost_rule.can_do_work)
        {
            return;
        }
        let (length, lanes) = self.cell_and_line_counts(bundle);
        for line in (0..lines).flat_map(|line| (0..lanes).map(move |lane| (line, lane))) {
            if !self.has_cells(bundle, line.0, line.1) {
                continue;
            }
            let (outermost, lane) = self.cell_position(bundle, line, [0, length - 1][end]);
            let cell = self.layout.cell_in_lane(outermost.group, lane);
            if cell.and_then(|cell| self.layout.owned_index(cell)).is_none() {
                continue;
            }
            for pair in 0..self.materials.waves[axis].len() {
                let power = self.boundary_power(bundle, line, pair, end);
                if power != 0.0 {
                    let work = self.face_area_time(bundle, pair) * power;
                    self.diagnostics.work.boundary_work.add(work);
                }
            }
        }
    }

    /// Returns the power per area that a boundary supplies at an end of a line, W/m², positive inwards. The ghosts must
    /// be filled.
    fn boundary_power(
        &self,
        bundle: LineBundle,
        line: (usize, usize),
        pair: usize,
        end: usize,
    ) -> f64 {
        let LineBundle { axis, half_step, .. } = bundle;
        let face = match axis {
            0 => {
                ((bundle.face + line.0) / T::Lanes::COUNT, (bundle.face + line.0) % T::Lanes::COUNT)
            }
            _ => (bundle.face + line.0, line.1),
        };
        match &self.boundaries.faces[half_step][axis][end] {
            BoundaryFaces::Physical(ghost_rule) if ghost_rule.can_do_work_at(pair, face) => {}
            _ => return 0.0,
        }
        let first = [0, self.cell_and_line_counts(bundle).0][end] as isize;
        let first = first - self.layout.ghosts as isize;
        let stencil = |place: usize| self.read_cell(bundle, line, first + place as isize, pair);
        let separates = self.lane_laws.contacts.as_ref().is_some_and(|own| own.separates);
        let slopes = if separates { Slopes::Godunov } else { self.scheme.slopes };
        let work = line::boundary_power(stencil, slopes);
        if end == 0 { -work } else { work }
    }
}
