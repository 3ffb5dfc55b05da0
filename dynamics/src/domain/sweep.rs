//! Half a step along an axis: ghosts, work at the sides, and the sweeps themselves.

use super::{Buffer, Domain};
use crate::kernel::{Axis, Columns, Rows, Wave};
use crate::line::{self, Account, Cell, GHOSTS, State};
use crate::problem::Detail;
use crate::real::{Group, Real};
use crate::side::Side;

/// A line of cells.
#[derive(Clone, Copy)]
enum Line {
    /// A row, along the first axis.
    Row(usize),
    /// A lane across the rows of [`Columns`].
    Column(Column, usize),
}

/// The rows across which lines run along an axis.
#[derive(Clone, Copy)]
struct Column {
    axis: usize,
    /// The first row, the distance to the next one, and their number.
    start: usize,
    stride: usize,
    count: usize,
    /// Number of the column among those of the axis.
    number: usize,
}

/// Sweeps, their ghosts and their work.
impl<T: Real, const D: usize> Domain<T, D> {
    /// Half a step along an axis.
    pub(super) fn sweep(&mut self, axis: usize) {
        let is_full = self.scheme.detail == Detail::Full;
        if axis == 0 {
            for row in 0..self.front_patterns.len() {
                self.fill_row(row);
                match is_full {
                    true => self.sweep_plainly(Line::Row(row)),
                    false => self.note_work(Line::Row(row)),
                }
            }
            if !is_full {
                self.sweep_at_once(None);
            }
            return;
        }
        let length = self.grid.cells[0];
        let stride = self.grid.cells[..axis].iter().product::<usize>() / length.max(1);
        let count = self.grid.cells[axis];
        for number in 0..self.front_patterns.len() / count.max(1) {
            let start = number / stride * stride * count + number % stride;
            let column = Column { axis, start, stride, count, number };
            self.fill_ends(column);
            for x in 0..length {
                match is_full {
                    true => self.sweep_plainly(Line::Column(column, x)),
                    false => self.note_work(Line::Column(column, x)),
                }
            }
            if !is_full {
                self.sweep_at_once(Some(column));
            }
        }
    }

    /// All rows, or the lines of a column, in the widest instructions.
    fn sweep_at_once(&mut self, column: Option<Column>) {
        let Self { table, waves, patterns, groups, data, buffer, .. } = self;
        let axis = Axis {
            table,
            waves: &waves[column.map_or(0, |column| column.axis)],
            slopes: self.scheme.slopes,
            patterns,
            groups: *groups,
            fields: self.media[0].fields.len(),
        };
        match column {
            None => {
                let (fronts, front_patterns) = (&buffer.fronts, &self.front_patterns);
                self.instructions.run(Rows { axis, data, fronts, front_patterns });
            }
            Some(Column { start, stride, count, .. }) => {
                let Buffer { ghosts, ghost_patterns, carried, .. } = buffer;
                self.instructions.run(Columns {
                    axis,
                    data,
                    start,
                    stride,
                    count,
                    ghosts,
                    ghost_patterns,
                    carried,
                });
            }
        }
    }

    /// The ghosts of a row: in the group in front of it, and in itself behind its last cell.
    fn fill_row(&mut self, row: usize) {
        let (lanes, length) = (T::Lanes::COUNT, self.grid.cells[0]);
        let fields = self.fields().len();
        let base = row * self.groups * fields;
        // What is neither a cell nor a ghost stays at rest.
        for x in length..self.groups * lanes {
            for place in 0..fields {
                self.data[base + x / lanes * fields + place].lanes_mut()[x % lanes] = T::ZERO;
            }
        }
        let pairs = self.waves[0].len();
        for pair in 0..pairs {
            let Wave { velocity, stress, .. } = self.waves[0][pair];
            for end in 0..2 {
                for depth in 0..GHOSTS {
                    // Lines shorter than the ghosts repeat themselves.
                    let from_end = |end: usize| match end {
                        0 => depth % length,
                        _ => length - 1 - depth % length,
                    };
                    let own = |domain: &Self, x: usize| State {
                        velocity: domain.at(row * length + x, velocity),
                        stress: domain.at(row * length + x, stress),
                    };
                    let ghost = match &self.sides[0][end] {
                        Side::Mirror(mirror) => {
                            let mut inside = own(self, from_end(end));
                            // A single cell is seen through the other mirror.
                            if let (true, Side::Mirror(other)) =
                                (depth >= length, &self.sides[0][1 - end])
                            {
                                inside = other.ghost(pair, row, inside);
                            }
                            mirror.ghost(pair, row, inside)
                        }
                        Side::Periodic | Side::Cut => own(self, from_end(1 - end)),
                    };
                    if end == 0 {
                        let front = &mut self.buffer.fronts[row * pairs + pair];
                        front[0].lanes_mut()[lanes - 1 - depth] = ghost.velocity;
                        front[1].lanes_mut()[lanes - 1 - depth] = ghost.stress;
                    } else {
                        let x = length + depth;
                        let group = base + x / lanes * fields;
                        self.data[group + velocity].lanes_mut()[x % lanes] = ghost.velocity;
                        self.data[group + stress].lanes_mut()[x % lanes] = ghost.stress;
                    }
                }
            }
        }
    }

    /// The ghosts at both ends of a column.
    fn fill_ends(&mut self, column: Column) {
        let Column { axis, start, stride, count, number } = column;
        let (lanes, length, groups) = (T::Lanes::COUNT, self.grid.cells[0], self.groups);
        let (pairs, fields) = (self.waves[axis].len(), self.fields().len());
        // Rows of a layer across the last axis.
        let rows = self.layer() / length.max(1);
        for end in 0..2 {
            for depth in 0..GHOSTS {
                let place = end * GHOSTS + depth;
                let from_end = |end: usize| match end {
                    0 => start + depth % count * stride,
                    _ => start + (count - 1 - depth % count) * stride,
                };
                let halo = (depth * rows + number) * groups;
                let source = match self.sides[axis][end] {
                    Side::Mirror(_) => from_end(end),
                    Side::Periodic | Side::Cut => from_end(1 - end),
                };
                for group in 0..groups {
                    self.buffer.ghost_patterns[place * groups + group] = match self.sides[axis][end]
                    {
                        Side::Cut => self.halo_patterns[end][halo + group],
                        _ => self.patterns[source * groups + group],
                    };
                    for pair in 0..pairs {
                        let Wave { velocity, stress, .. } = self.waves[axis][pair];
                        let base = (source * groups + group) * fields;
                        let own = [self.data[base + velocity], self.data[base + stress]];
                        let ghost = match &self.sides[axis][end] {
                            Side::Cut => self.halos[end][(halo + group) * pairs + pair],
                            Side::Periodic => own,
                            Side::Mirror(mirror) => {
                                let mut ghost = own;
                                for lane in 0..lanes.min(length - (group * lanes).min(length)) {
                                    let [velocity, stress] = own.map(|own| own.lanes()[lane]);
                                    let face = number * length + group * lanes + lane;
                                    let mut own = State { velocity, stress };
                                    if let (true, Side::Mirror(other)) =
                                        (depth >= count, &self.sides[axis][1 - end])
                                    {
                                        own = other.ghost(pair, face, own);
                                    }
                                    let own = mirror.ghost(pair, face, own);
                                    ghost[0].lanes_mut()[lane] = own.velocity;
                                    ghost[1].lanes_mut()[lane] = own.stress;
                                }
                                ghost
                            }
                        };
                        self.buffer.ghosts[(place * groups + group) * pairs + pair] = ghost;
                    }
                }
            }
        }
    }

    /// The number of a line's cells and its axis.
    fn extent(&self, line: Line) -> (usize, usize) {
        match line {
            Line::Row(_) => (self.grid.cells[0], 0),
            Line::Column(column, _) => (column.count, column.axis),
        }
    }

    /// The cell at a place of a line.
    fn cell(&self, line: Line, place: usize) -> usize {
        let length = self.grid.cells[0];
        match line {
            Line::Row(row) => row * length + place,
            Line::Column(column, x) => (column.start + place * column.stride) * length + x,
        }
    }

    /// State and constants at a place of a line, ghosts included.
    fn read(&self, line: Line, place: isize, pair: usize) -> (State<T>, Cell<T>) {
        let (lanes, groups) = (T::Lanes::COUNT, self.groups);
        let (count, axis) = self.extent(line);
        let wave = &self.waves[axis][pair];
        let pairs = self.waves[axis].len();
        let inside = |row: usize, x: usize| {
            let group = row * groups + x / lanes;
            let base = group * self.fields().len();
            let pattern = self.patterns[group];
            ([self.data[base + wave.velocity], self.data[base + wave.stress]], pattern, x % lanes)
        };
        let (state, pattern, lane) = match (line, usize::try_from(place)) {
            // Behind a row its ghosts stand in it.
            (Line::Row(row), Ok(x)) => inside(row, x),
            (Line::Row(row), Err(_)) => {
                let front = self.buffer.fronts[row * pairs + pair];
                (front, self.front_patterns[row], lanes - place.unsigned_abs())
            }
            (Line::Column(column, x), Ok(place)) if place < count => {
                inside(column.start + place * column.stride, x)
            }
            (Line::Column(_, x), found) => {
                let ghost = found.map_or(place.unsigned_abs() - 1, |place| GHOSTS + place - count);
                let group = ghost * groups + x / lanes;
                let state = self.buffer.ghosts[group * pairs + pair];
                (state, self.buffer.ghost_patterns[group], x % lanes)
            }
        };
        let [velocity, stress] = state.map(|own| own.lanes()[lane]);
        let cell = self.table.cell(pattern, wave);
        let constants = Cell {
            impedance: cell.impedance.lanes()[lane],
            courant: cell.courant.lanes()[lane],
            rest: cell.rest.lanes()[lane],
            to_velocity: cell.to_velocity.lanes()[lane],
            to_stress: cell.to_stress.lanes()[lane],
        };
        (State { velocity, stress }, constants)
    }

    /// A face times the time of a sweep: accounts are powers per area.
    fn face_time(&self, axis: usize) -> f64 {
        self.grid.volume() / self.grid.spacing[axis] * 0.5 * self.step
    }

    /// Adds the work at the ends of a line that its sweep is about to do.
    fn note_work(&mut self, line: Line) {
        let (count, axis) = self.extent(line);
        let layer = self.layer();
        for end in 0..2 {
            if !matches!(&self.sides[axis][end], Side::Mirror(mirror) if mirror.works) {
                continue;
            }
            let first = [-2, count as isize - 2][end];
            let last_cell = self.cell(line, [0, count - 1][end]);
            for pair in 0..self.waves[axis].len() {
                let four = [0, 1, 2, 3].map(|i| self.read(line, first + i, pair));
                let cells = [four[1].1, four[2].1];
                let work = line::work_between(four.map(|own| own.0), cells, self.scheme.slopes);
                let inflow = if end == 0 { -work } else { work };
                self.ledgers[last_cell / layer].inflow += self.face_time(axis) * inflow;
            }
        }
    }

    /// The sweep of a line, cell by cell, with its account.
    fn sweep_plainly(&mut self, line: Line) {
        let (count, axis) = self.extent(line);
        let (unit, layer) = (self.face_time(axis), self.layer());
        for pair in 0..self.waves[axis].len() {
            let end = count + 2 * GHOSTS;
            for i in 0..end {
                let (state, cell) = self.read(line, i as isize - GHOSTS as isize, pair);
                self.buffer.velocity[i] = state.velocity;
                self.buffer.stress[i] = state.stress;
                self.buffer.cells[i] = cell;
            }
            let Buffer { velocity, stress, cells, accounts, .. } = &mut self.buffer;
            let accounts = &mut accounts[..count];
            accounts.fill(Account::default());
            let (velocity, stress) = (&mut velocity[..end], &mut stress[..end]);
            line::sweep(velocity, stress, &cells[..end], self.scheme.slopes, Some(accounts));
            for i in 0..count {
                let cell = self.cell(line, i);
                let [v, s] = [self.buffer.velocity[GHOSTS + i], self.buffer.stress[GHOSTS + i]];
                let wave = &self.waves[axis][pair];
                let (velocity, stress, followers) =
                    (wave.velocity, wave.stress, wave.followers.len());
                let change = s - self.at(cell, stress);
                *self.at_mut(cell, velocity) = v;
                *self.at_mut(cell, stress) = s;
                for index in 0..followers {
                    let medium = usize::from(self.of_cell[cell]);
                    let ratio = T::of(self.media[medium].pairs[axis][pair].followers[index].1);
                    let value = self.at_mut(cell, self.waves[axis][pair].followers[index]);
                    *value = *value + ratio * change;
                }
                let account = self.buffer.accounts[i];
                // What crosses a cut, or comes round, stays inside.
                let is_outside = |end: usize| matches!(self.sides[axis][end], Side::Mirror(_));
                let ends = [i == 0, i + 1 == count];
                let is_edge = (0..2).any(|end| ends[end] && is_outside(end));
                let ledger = &mut self.ledgers[cell / layer];
                ledger.inflow += if is_edge { unit * account.inflow } else { 0.0 };
                ledger.gained += unit * account.gained;
                ledger.lost += unit * account.lost;
            }
        }
    }
}
