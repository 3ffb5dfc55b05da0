//! Sweeps along the axes, ghosts beyond the ends of lines, and the work done at boundaries.

use super::fill::{Fill, FillEnd, FillOneSided};
use super::kernel::interlayers::InterlayerLines;
use super::kernel::{Lines, MAX_SHARE};
use super::layout::{GroupIndex, RowSegment};
use super::rows::Rows;
use super::schedule::CHUNK;
use super::table::WavePair;
use super::{Domain, SolverReal};
use crate::simd::Group;
use crate::solid::cell::CellConstants;
use crate::solid::ghosts::{BESIDE, BoundaryFaces};
use crate::solid::line;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::State;
use std::ops::Range;

/// L1 prefetch distance in lines, by axis; along rows the next row is prefetched.
const LINES_AHEAD: [Option<usize>; 3] = [None, Some(2), Some(3)];

/// Distance between two groups of a row.
const NEXT_GROUP: GroupIndex = GroupIndex { group: 1, data: 1 };

/// Bundle of adjacent lines.
#[derive(Clone, Copy)]
struct Bundle {
    axis: usize,
    /// Half step of the pass.
    half: usize,
    /// First group of the first line; the other lines are offset by multiples of `across`.
    first: GroupIndex,
    /// Distance between two groups of a line.
    stride: GroupIndex,
    /// Number of groups of a line.
    count: usize,
    /// Number of lines of groups.
    lines: usize,
    /// Distance between two lines.
    across: GroupIndex,
    /// Across the first axis the first row, else the first group of faces at the ends of the lines.
    face: usize,
    /// Index of the first line among the carried states of this axis.
    carried: usize,
}

impl Bundle {
    /// Returns the group at a place (index along the line, ghosts excluded) of the first line.
    #[inline(always)]
    fn index(self, place: usize) -> GroupIndex {
        let Self { first, stride, .. } = self;
        GroupIndex {
            group: first.group + place * stride.group,
            data: first.data + place * stride.data,
        }
    }

    /// Returns the places of the ghosts at a depth beyond the lower and the upper end of a line of groups: −1 − depth
    /// and count + depth.
    fn beyond(self, depth: usize) -> [isize; 2] {
        [-1 - depth as isize, (self.count + depth) as isize]
    }
}

/// Sweeps, their ghosts and the work at boundaries.
impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Applies the in-plane sweeps of one half step in one layer: x y in the first half of a step, y x in the second
    /// (alternating sweeps: y only). Arguments: the rows that pass each of the three stages of
    /// [`super::schedule::stage_progress`].
    pub(super) fn sweep_layer(
        &mut self,
        layer: usize,
        [entered, middle, last]: &[Range<usize>; 3],
        half: usize,
    ) {
        let (groups, first_row) = (self.layout.groups, layer * self.layout.rows);
        let is_second = half % 2 == 1;
        let of_layer = |rows: &Range<usize>| first_row + rows.start..first_row + rows.end;
        if !is_second {
            self.sweep_rows_of(of_layer(entered), half);
        }
        if D == 3 {
            let bundle = Bundle {
                axis: 1,
                half,
                first: self.layout.index(first_row, 0),
                stride: self.layout.index(1, 0),
                count: self.layout.cells[1],
                lines: groups,
                across: NEXT_GROUP,
                face: layer * groups,
                carried: layer * groups,
            };
            self.sweep_on(bundle, [entered, middle][half % 2].clone());
        }
        if is_second && !self.scheme.alternates() {
            self.sweep_rows_of(of_layer(last), half);
        }
    }

    /// Sweeps adjacent rows by half a step along the first axis.
    pub(super) fn sweep_rows_of(&mut self, rows: Range<usize>, half: usize) {
        // Rows differ in cell length: one row at a time, with the constants of that row.
        let together = if self.materials.row_spacing.is_some() { 1 } else { CHUNK };
        for start in rows.clone().step_by(together) {
            self.fill_row_constants(start);
            self.sweep_rows(start..rows.end.min(start + together), half);
        }
    }

    /// Sweeps at most [`CHUNK`] rows by half a step along the first axis.
    fn sweep_rows(&mut self, rows: Range<usize>, half: usize) {
        let bundle = Bundle {
            axis: 0,
            half,
            first: self.layout.index(rows.start, 0),
            stride: NEXT_GROUP,
            count: self.layout.groups,
            lines: rows.len(),
            across: self.layout.index(1, 0),
            face: rows.start,
            carried: 0,
        };
        self.fill_row_patterns(bundle);
        let works = |side: &BoundaryFaces<T>| matches!(side, BoundaryFaces::Physical(mirror) if mirror.does_work);
        if self.boundary.faces[half][0].iter().any(works) {
            self.fill_rows(bundle);
            (0..2).for_each(|end| self.accumulate_boundary_work(bundle, end));
        }
        self.walk(bundle, -1..self.layout.groups as isize + 1);
    }

    /// Returns the rows of a bundle along the first axis.
    fn rows_of(&self, bundle: Bundle) -> Rows<'_, T> {
        let size = self.layout.row_size();
        Rows {
            ends: &self.boundary.row_ends,
            sides: &self.boundary.faces[bundle.half][0],
            face: bundle.face,
            first: bundle.first.data,
            size,
            ghosts: self.layout.layers() * self.layout.rows * size,
            apart: CHUNK * size,
            group: bundle.first.group,
            table: self.materials.table_along(0),
            patterns: &self.materials.patterns,
        }
    }

    /// Fills the ghosts of rows before the work is computed. The sweep kernel fills them itself.
    fn fill_rows(&mut self, bundle: Bundle) {
        let mut data = std::mem::take(&mut self.data);
        let (waves, rows) = (self.waves_of(0, bundle.half), self.rows_of(bundle));
        let fill = Fill { data: &mut data, waves, rows, count: bundle.lines };
        self.instructions.run::<T>(fill);
        self.data = data;
    }

    /// Continues half a step along the last axis over newly finished layers `ready` of the range `ends`, on a segment
    /// of a row.
    pub(super) fn sweep_last(
        &mut self,
        ready: &Range<usize>,
        ends: &Range<usize>,
        tile: &RowSegment,
        half: usize,
    ) {
        let face = tile.row * self.layout.groups + tile.groups.start;
        let bundle = Bundle {
            axis: D - 1,
            half,
            first: self.layout.index(ends.start * self.layout.rows + tile.row, tile.groups.start),
            stride: self.layout.index(self.layout.rows, 0),
            count: ends.len(),
            lines: tile.groups.len(),
            across: NEXT_GROUP,
            face,
            carried: face,
        };
        self.sweep_on(bundle, ready.start - ends.start..ready.end - ends.start);
    }

    /// Continues a y or z sweep over newly loaded rows or layers; it writes up to [`GHOSTS`] before `ready.end`.
    fn sweep_on(&mut self, bundle: Bundle, ready: Range<usize>) {
        // The ghosts at the lower end depend on BESIDE cells: wait until they are loaded.
        if ready.is_empty() || ready.end < BESIDE.min(bundle.count) {
            return;
        }
        let start = if ready.start < BESIDE { 0 } else { ready.start };
        let ready = start..ready.end;
        let ends = [ready.start == 0, ready.end == bundle.count];
        // Fill both ends first: in a line of a single cell the work at one end depends on the ghosts at the other.
        for end in (0..2).filter(|end| ends[*end]) {
            self.fill_end(bundle, end);
        }
        for end in (0..2).filter(|end| ends[*end]) {
            self.accumulate_boundary_work(bundle, end);
        }
        let start = ready.start as isize - 1;
        let end = if ends[1] { bundle.count as isize + 1 } else { ready.end as isize - 1 };
        self.walk(bundle, start..end);
    }

    /// Sweeps part of the path along lines with the selected instruction set: the groups at `places` are current one
    /// after the other.
    fn walk(&mut self, bundle: Bundle, places: Range<isize>) {
        let Bundle { axis, half, lines, .. } = bundle;
        let mut path = std::mem::take(&mut self.buffer.path);
        path.clear();
        let (first, end, count) = (places.start - 1, places.end + 1, bundle.count as isize);
        let previous_group = self.index_at(bundle, 0, (first - 1).max(-(GHOSTS as isize)));
        path.extend((first..0).map(|place| self.index_at(bundle, 0, place)));
        path.extend((first.max(0)..end.min(count)).map(|place| bundle.index(place as usize)));
        path.extend((first.max(count)..end).map(|place| self.index_at(bundle, 0, place)));
        let fields = self.fields().len();
        let next = LINES_AHEAD[axis].unwrap_or(self.layout.row_size());
        let later = self.later(bundle);
        let before = bundle.carried * self.materials.waves[axis].len();
        let mut carried = std::mem::take(&mut self.buffer.carried[axis][half]);
        let mut data = std::mem::take(&mut self.data);
        let mut memory = std::mem::take(&mut self.interfaces.memory);
        let mut faces = std::mem::take(&mut self.interfaces.path);
        faces.clear();
        if self.interfaces.has(axis) {
            let origin = self.origin(bundle) as isize;
            faces.extend(self.interfaces.faces(axis, origin + first..origin + end));
        }
        let waves = self.waves_of(axis, half);
        let lines = Lines {
            data: &mut data,
            fields,
            pitch: self.layout.pitch,
            table: self.materials.table_along(axis),
            waves,
            slopes: self.scheme.slopes,
            patterns: &self.materials.patterns,
            run_lengths: &self.materials.run_lengths[axis],
            path: &path,
            previous_group,
            across: bundle.across,
            begins: places.start < 0,
            next,
            later,
            carried: &mut carried[before..before + lines * waves.len()],
            rows: (axis == 0).then(|| self.rows_of(bundle)),
        };
        match self.interfaces.lines(axis, bundle.face) {
            None => lines.walk(self.instructions),
            Some((laws, first, line)) => {
                let step = T::from_f64(self.time_of_sweep());
                let lines = InterlayerLines {
                    lines,
                    faces: &faces,
                    memory: &mut memory,
                    first,
                    line,
                    laws,
                    step,
                };
                self.instructions.run::<T>(lines);
            }
        }
        (self.interfaces.memory, self.interfaces.path) = (memory, faces);
        self.data = data;
        self.buffer.carried[axis][half] = carried;
        self.buffer.path = path;
    }

    /// Returns the L2 prefetch distance to the rows that are loaded next, and the fields of each pair that this sweep
    /// prefetches. The sweeps across rows share the fields, to spread the requests.
    fn later(&self, bundle: Bundle) -> (usize, Range<usize>) {
        let Bundle { axis, half, face, .. } = bundle;
        // Lag behind the rows loaded last, in units of GHOSTS rows and of GHOSTS layers; in the plane layers are rows.
        let (part, parts, rows, layers) = match (D, axis, half) {
            // In the plane, prefetch only in the last step of a pass: earlier requests would be evicted.
            (2, 1, half) if half + 2 >= 2 * self.schedule.pass_steps => (half % 2, 2, half, 0),
            // No other sweep across rows runs yet: this one prefetches all fields.
            (3, 1, 0) if self.layout.is_in_a_halo(face / self.layout.groups) => (0, 1, 0, 0),
            (3, 1, 0) => (0, 4, 0, 0),
            (3, 2, 0) => (1, 4, 1, 0),
            (3, 2, 1) => (2, 4, 1, 1),
            (3, 1, 1) => (3, 4, 1, 2),
            _ => return (0, 0..0),
        };
        let behind = self.schedule.ahead + GHOSTS * (rows + layers * self.layout.rows);
        let share = MAX_SHARE / parts;
        (behind * self.layout.row_size(), part * share..(part + 1) * share)
    }

    /// Returns the group at a place of a line, ghosts included: the ghosts of all lines at one end and depth are
    /// adjacent.
    fn index_at(&self, bundle: Bundle, line: usize, place: isize) -> GroupIndex {
        let ghost = |end: usize, depth: usize| {
            let row = self.layout.layers() * self.layout.rows + (end * GHOSTS + depth) * CHUNK;
            self.layout.index(row, 0).of_line(line, bundle.across)
        };
        match usize::try_from(place) {
            Ok(place) if place < bundle.count => bundle.index(place).of_line(line, bundle.across),
            Ok(place) => ghost(1, place - bundle.count),
            Err(_) => ghost(0, place.unsigned_abs() - 1),
        }
    }

    /// Returns the state in a lane of a group.
    fn state(&self, (stop, lane): (GroupIndex, usize), wave: &WavePair) -> State<T> {
        let group = &self.data[stop.data..];
        State {
            velocity: group[wave.velocity].lanes()[lane],
            stress: group[wave.stress].lanes()[lane],
        }
    }

    /// Sets the patterns of the ghosts of rows.
    fn fill_row_patterns(&mut self, bundle: Bundle) {
        for line in 0..bundle.lines {
            let Some(&patterns) = self.materials.row_patterns.get(bundle.face + line) else {
                return;
            };
            for depth in 0..GHOSTS {
                for (end, place) in bundle.beyond(depth).into_iter().enumerate() {
                    let ghost = self.index_at(bundle, line, place).group;
                    self.materials.patterns[ghost] = patterns[end * GHOSTS + depth];
                }
            }
        }
    }

    /// Fills the ghosts at an end of lines across the groups. Beyond a halo their values are arbitrary but must stay
    /// bounded, since the kernel updates them in each sweep.
    fn fill_end(&mut self, bundle: Bundle, end: usize) {
        let Bundle { axis, half, count, lines, face, .. } = bundle;
        let sides = &self.boundary.faces[half][axis];
        let mut data = std::mem::take(&mut self.data);
        let places: [[GroupIndex; 2]; GHOSTS] = std::array::from_fn(|depth| {
            let end_seen =
                if matches!(sides[end], BoundaryFaces::Periodic) { 1 - end } else { end };
            let seen = [depth % count, count - 1 - depth % count][end_seen];
            [seen as isize, bundle.beyond(depth)[end]].map(|place| self.index_at(bundle, 0, place))
        });
        if !self.materials.run_lengths[axis].is_empty() {
            for [own, ghost] in places {
                for line in 0..lines {
                    let [own, ghost] = [own, ghost].map(|stop| stop.of_line(line, bundle.across));
                    self.materials.patterns[ghost.group] = self.materials.patterns[own.group];
                }
            }
        }
        match sides[end].mirror() {
            Some(mirror) if mirror.is_one_sided && count >= BESIDE => {
                let beside: [GroupIndex; BESIDE] = std::array::from_fn(|depth| {
                    let place = [depth, count - 1 - depth][end];
                    bundle.index(place)
                });
                let fill = FillOneSided {
                    data: &mut data,
                    waves: &self.materials.waves[axis],
                    mirror,
                    end,
                    beside: beside.map(|stop| stop.data),
                    ghosts: places.map(|[_, ghost]| ghost.data),
                    lines,
                    face,
                    table: &self.materials.table,
                    patterns: beside.map(|stop| &self.materials.patterns[stop.group..]),
                };
                self.instructions.run::<T>(fill);
            }
            _ => {
                for (depth, [own, ghost]) in places.into_iter().enumerate() {
                    // In a line of a single cell the second ghost is the image of the ghost at the other end.
                    let through =
                        if depth < count { [None, Some(end)] } else { [Some(1 - end), Some(end)] };
                    let fill = FillEnd {
                        data: &mut data,
                        waves: &self.materials.waves[axis],
                        mirrors: through.map(|end| sides[end?].mirror()),
                        places: [own.data, ghost.data],
                        lines,
                        face,
                    };
                    self.instructions.run::<T>(fill);
                }
            }
        }
        self.data = data;
    }

    /// Returns the number of cells of a line, and the number of lines of cells per line of groups.
    fn length(&self, bundle: Bundle) -> (usize, usize) {
        match bundle.axis {
            0 => (self.layout.cells[0], 1),
            _ => (bundle.count, T::Lanes::COUNT),
        }
    }

    /// Whether a lane of a line of groups holds cells.
    fn has_cells(&self, bundle: Bundle, line: usize, lane: usize) -> bool {
        let place = (bundle.first.group + line) % self.layout.groups;
        bundle.axis == 0 || lane * self.layout.groups + place < self.layout.cells[0]
    }

    /// Returns group and lane of a cell of a line.
    fn place_of(
        &self,
        bundle: Bundle,
        (line, lane): (usize, usize),
        place: usize,
    ) -> (GroupIndex, usize) {
        let (place, lane) = match bundle.axis {
            0 => (place % self.layout.groups, place / self.layout.groups),
            _ => (place, lane),
        };
        (self.index_at(bundle, line, place as isize), lane)
    }

    /// Reads state and constants at a place of a line, ghosts included.
    fn read(
        &self,
        bundle: Bundle,
        (line, lane): (usize, usize),
        place: isize,
        pair: usize,
    ) -> (State<T>, CellConstants<T>) {
        let wave = &self.waves_of(bundle.axis, bundle.half)[pair];
        // The ghosts at the upper end of a row are stored in the row itself.
        let (length, beyond) = match bundle.axis {
            0 => (self.layout.cells[0], GHOSTS),
            _ => (bundle.count, 0),
        };
        let (stop, lane) = match usize::try_from(place) {
            Ok(place) if place < length + beyond => self.place_of(bundle, (line, lane), place),
            _ => (self.index_at(bundle, line, place), lane),
        };
        let state = self.state((stop, lane), wave);
        let table = self.materials.table_along(bundle.axis);
        let cell = table.cell(self.materials.patterns[stop.group], wave);
        (state, cell.lane(lane))
    }

    /// Returns the area of a face times the duration of the sweep, m² s: work = power per area times this.
    fn face_time(&self, Bundle { axis, half, face, .. }: Bundle) -> f64 {
        let is_quarter = self.scheme.alternates() && axis == 0 && self.schedule.is_first(half);
        let spacing = match &self.materials.row_spacing {
            Some(rows) if axis == 0 => rows.spacing[face],
            _ => self.grid.spacing[axis],
        };
        self.grid.volume() / spacing * if is_quarter { 0.25 } else { 0.5 } * self.step
    }

    /// Returns the duration of a sweep with interlayers, s; these exclude alternating sweeps.
    fn time_of_sweep(&self) -> f64 {
        0.5 * self.step
    }

    /// Returns the coordinate of the first place of a line along its axis; along the last axis the layer, counted with
    /// the halo.
    fn origin(&self, bundle: Bundle) -> usize {
        if bundle.axis + 1 == D { bundle.first.group / self.layout.layer_groups() } else { 0 }
    }

    /// Adds the work at an end of lines in the sweep that follows.
    fn accumulate_boundary_work(&mut self, bundle: Bundle, end: usize) {
        let Bundle { axis, half, lines, .. } = bundle;
        if !matches!(&self.boundary.faces[half][axis][end], BoundaryFaces::Physical(mirror) if mirror.does_work)
        {
            return;
        }
        let (length, lanes) = self.length(bundle);
        for line in (0..lines).flat_map(|line| (0..lanes).map(move |lane| (line, lane))) {
            if !self.has_cells(bundle, line.0, line.1) {
                continue;
            }
            let (outermost, lane) = self.place_of(bundle, line, [0, length - 1][end]);
            let cell = self.layout.cell_of(outermost.group, lane);
            if cell.and_then(|cell| self.layout.own_number(cell)).is_none() {
                continue;
            }
            for pair in 0..self.materials.waves[axis].len() {
                let power = self.work_at(bundle, line, pair, end);
                if power != 0.0 {
                    self.diagnostics.work.inflow.add(self.face_time(bundle) * power);
                }
            }
        }
    }

    /// Returns the power per area that a boundary supplies at an end of a line, W/m², positive inwards. The ghosts must
    /// be filled.
    fn work_at(&self, bundle: Bundle, line: (usize, usize), pair: usize, end: usize) -> f64 {
        let Bundle { axis, half, .. } = bundle;
        let face = match axis {
            0 => {
                ((bundle.face + line.0) / T::Lanes::COUNT, (bundle.face + line.0) % T::Lanes::COUNT)
            }
            _ => (bundle.face + line.0, line.1),
        };
        match &self.boundary.faces[half][axis][end] {
            BoundaryFaces::Physical(mirror) if mirror.does_work_on(pair, face) => {}
            _ => return 0.0,
        }
        let first = [-2, self.length(bundle).0 as isize - 2][end];
        let four = [0, 1, 2, 3].map(|i| self.read(bundle, line, first + i, pair));
        let (states, cells) = (four.map(|own| own.0), four.map(|own| own.1));
        let work = line::work_between(states, cells, self.scheme.slopes);
        if end == 0 { -work } else { work }
    }
}
