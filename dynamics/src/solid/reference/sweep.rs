//! Sweep along an axis: line by line with ghosts, wave pair by wave pair.

use super::{Reference, slot};
use crate::simd::Real;
use crate::solid::cell::CellConstants;
use crate::solid::domain::SolverReal;
use crate::solid::ghosts::{BESIDE, BoundaryFaces, GhostCoefficients, ghosts, image, set_time};
use crate::solid::interface::sweep_with_interlayers;
use crate::solid::line::{self, Account};
use crate::solid::problem::Problem;
use crate::solid::reconstruction::GHOSTS;
use crate::solid::riemann::State;
use models::solid::waves::Field;

/// A wave pair along an axis.
#[derive(Clone)]
pub(super) struct WavePair<T: Real> {
    /// Cell length along the axis, m, and fraction of a time step per sweep.
    spacing: f64,
    share: f64,
    /// Field indices.
    pub(super) velocity: usize,
    pub(super) stress: usize,
    /// Cell constants by medium.
    pub(super) cells: Vec<CellConstants<T>>,
    coefficients: Vec<GhostCoefficients<T>>,
    /// Indices of the passive stresses of any medium, and by medium the coupling ratio r = ds′/ds.
    pub(super) passive_stresses: Vec<(usize, Vec<T>)>,
}

impl<T: Real> WavePair<T> {
    /// A wave pair along an axis with cell length `spacing`, m, and sweeps of a fraction of the time step.
    pub(super) fn new<const D: usize>(
        problem: &Problem<D>,
        (axis, spacing): (usize, f64),
        pair: usize,
        share: f64,
    ) -> Self {
        let Problem { media, scheme, step, .. } = problem;
        let fields = &media[0].fields;
        let place = |field: Field| fields.iter().position(|own| *own == field).unwrap_or(0);
        let pairs = || media.iter().map(|medium| &medium.pairs[axis][pair]);
        let mut places: Vec<usize> =
            pairs().flat_map(|own| &own.passive_stresses).map(|(field, _)| place(*field)).collect();
        places.sort_unstable();
        places.dedup();
        let passive = |index: usize| {
            let ratio = |own: &models::solid::waves::Pair| {
                let found = own.passive_stresses.iter().find(|own| own.0 == fields[index]);
                T::from_f64(found.map_or(0.0, |own| own.1))
            };
            (index, pairs().map(ratio).collect())
        };
        let cell = |own: &models::solid::waves::Pair| {
            let courant = own.speed() * (share * step / spacing);
            scheme.slopes.cell_of(own, courant, problem.is_mixed())
        };
        let cells: Vec<CellConstants<T>> = pairs().map(cell).collect();
        Self {
            spacing,
            share,
            velocity: place(media[0].pairs[axis][pair].velocity),
            stress: place(media[0].pairs[axis][pair].stress),
            coefficients: cells.iter().map(GhostCoefficients::new).collect(),
            cells,
            passive_stresses: places.into_iter().map(passive).collect(),
        }
    }
}

/// The cells of a line, and its index among the faces of its boundaries.
#[derive(Clone, Copy)]
pub(super) struct LineOfCells {
    pub(super) axis: usize,
    pub(super) first: usize,
    pub(super) stride: usize,
    pub(super) count: usize,
    pub(super) face: usize,
}

impl LineOfCells {
    pub(super) fn cell(&self, place: usize) -> usize {
        self.first + place * self.stride
    }

    /// Position at a depth from an end of the line; wraps around in shorter lines.
    fn inside(&self, end: usize, depth: usize) -> usize {
        [depth % self.count, self.count - 1 - depth % self.count][end]
    }
}

/// Fields of a wave pair along a line with ghosts.
pub(super) struct Strip<T> {
    pub(super) velocity: Vec<T>,
    pub(super) stress: Vec<T>,
    pub(super) cells: Vec<CellConstants<T>>,
    accounts: Vec<Account>,
}

impl<T: Real> Strip<T> {
    pub(super) fn new() -> Self {
        Self { velocity: Vec::new(), stress: Vec::new(), cells: Vec::new(), accounts: Vec::new() }
    }

    fn push(&mut self, (state, cell): (State<T>, CellConstants<T>)) {
        self.velocity.push(state.velocity);
        self.stress.push(state.stress);
        self.cells.push(cell);
    }
}

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Sweeps by half a step along an axis, with boundary values at `time`, s.
    pub(super) fn sweep(&mut self, axis: usize, time: f64) {
        let waves = std::mem::take(&mut self.waves[axis]);
        let of_rows = std::mem::take(&mut self.row_waves);
        self.sweep_axis(axis, |row| of_rows.get(row).filter(|_| axis == 0).unwrap_or(&waves), time);
        (self.waves[axis], self.row_waves) = (waves, of_rows);
    }

    /// Sweeps by a quarter of a step along the first axis.
    pub(super) fn quarter_sweep(&mut self, time: f64) {
        let waves = std::mem::take(&mut self.quarter_waves);
        self.sweep_axis(0, |_| &waves, time);
        self.quarter_waves = waves;
    }

    /// Sweeps along an axis; `waves`: wave pairs of a line by its face index.
    fn sweep_axis<'a>(
        &mut self,
        axis: usize,
        waves: impl Fn(usize) -> &'a Vec<WavePair<T>>,
        time: f64,
    ) {
        set_time(&mut self.sides[axis], time);
        let mut strip = Strip::new();
        let [length, layer] = [self.problem.grid.cells[0], self.problem.grid.faces(D - 1)];
        let count = self.problem.grid.cells[axis];
        let faces = self.problem.grid.faces(axis);
        // Strides between cells along the axis and between rows of lines, and number of lines per row.
        let (stride, next, lines) = match axis {
            0 => (1, length, 1),
            _ if axis + 1 == D => (layer, length, length),
            _ => (length, layer, length),
        };
        for face in 0..faces {
            let first = face / lines * next + face % lines;
            let line = LineOfCells { axis, first, stride, count, face };
            self.sweep_line(line, waves(face), &mut strip);
        }
    }

    fn sweep_line(&mut self, line: LineOfCells, waves: &[WavePair<T>], strip: &mut Strip<T>) {
        for (pair, wave) in waves.iter().enumerate() {
            let time = wave.share * self.problem.step;
            // Accounts are powers per area.
            let face_time = self.problem.grid.volume() / wave.spacing * time;
            let sides = &self.sides[line.axis];
            self.fill(strip, line, (pair, wave), sides);
            let works = [0, 1].map(|end| self.work_at(strip, line, pair, end));
            strip.accounts.clear();
            strip.accounts.resize(line.count, Account::default());
            let Strip { velocity, stress, cells, accounts } = strip;
            let mut interlayers = self.faces.of_line(pair, line);
            let (own, time) = (&mut interlayers, T::from_f64(time));
            let accounts = Some(accounts.as_mut_slice());
            let lost =
                sweep_with_interlayers(velocity, stress, cells, self.slopes, own, time, accounts);
            debug_assert_eq!(lost, 0.0, "elastic ones dissipate nothing");
            self.faces.keep(pair, line, &interlayers);
            for place in 0..line.count {
                let cell = line.cell(place);
                let medium = usize::from(self.problem.of_cell[cell]);
                let change = strip.stress[GHOSTS + place] - self.fields[wave.stress][cell];
                self.fields[wave.velocity][cell] = strip.velocity[GHOSTS + place];
                self.fields[wave.stress][cell] = strip.stress[GHOSTS + place];
                for (index, ratios) in &wave.passive_stresses {
                    let value = &mut self.fields[*index][cell];
                    *value = *value + ratios[medium] * change;
                }
                self.work.numerical.add(face_time * strip.accounts[place].dissipated);
            }
            for work in works.into_iter().filter(|work| *work != 0.0) {
                self.work.inflow.add(face_time * work);
            }
        }
    }

    /// Fills `strip` with velocities, stresses and constants of a wave pair along a line, ghosts included.
    pub(super) fn fill(
        &self,
        strip: &mut Strip<T>,
        line: LineOfCells,
        wave: (usize, &WavePair<T>),
        sides: &[BoundaryFaces<T>; 2],
    ) {
        strip.velocity.clear();
        strip.stress.clear();
        strip.cells.clear();
        let [front, back] = [0, 1].map(|end| self.beyond(line, wave, sides, end));
        front.into_iter().rev().for_each(|own| strip.push(own));
        (0..line.count).for_each(|place| strip.push(self.cell_of(line, wave.1, place)));
        back.into_iter().for_each(|own| strip.push(own));
    }

    /// Returns state and constants of a cell of a line.
    fn cell_of(
        &self,
        line: LineOfCells,
        wave: &WavePair<T>,
        place: usize,
    ) -> (State<T>, CellConstants<T>) {
        let cell = line.cell(place);
        let state = State {
            velocity: self.fields[wave.velocity][cell],
            stress: self.fields[wave.stress][cell],
        };
        (state, wave.cells[usize::from(self.problem.of_cell[cell])])
    }

    /// Computes the ghosts beyond an end, nearest first.
    fn beyond(
        &self,
        line: LineOfCells,
        (pair, wave): (usize, &WavePair<T>),
        sides: &[BoundaryFaces<T>; 2],
        end: usize,
    ) -> [(State<T>, CellConstants<T>); GHOSTS] {
        let at = |end: usize, depth: usize| self.cell_of(line, wave, line.inside(end, depth));
        let BoundaryFaces::Physical(rule) = &sides[end] else {
            return std::array::from_fn(|depth| at(1 - end, depth));
        };
        let face = slot::<T>(line.face);
        if line.count >= BESIDE {
            let beside: [_; BESIDE] = std::array::from_fn(|depth| at(end, depth));
            let medium = self.problem.of_cell[line.cell(line.inside(end, 0))];
            let coefficients = &wave.coefficients[usize::from(medium)];
            let (states, cells) = (beside.map(|own| own.0), beside.map(|own| own.1));
            let rule = rule.face_at(pair, face);
            let made =
                ghosts(sides[end].closure(), states, rule, end, cells.each_ref(), coefficients);
            return std::array::from_fn(|depth| (made[depth], cells[depth]));
        }
        let image_by = |rule: [T; 5], own: State<T>| State {
            velocity: image([rule[0], rule[1]], own.velocity),
            stress: image([rule[2], rule[3]], own.stress),
        };
        std::array::from_fn(|depth| {
            let (mut seen, cell) = at(end, depth);
            // A line of one cell: the second ghost is an image by the opposite boundary, too.
            if let (BoundaryFaces::Physical(other), true) = (&sides[1 - end], depth >= line.count) {
                seen = image_by(other.face_at(pair, face), seen);
            }
            (image_by(rule.face_at(pair, face), seen), cell)
        })
    }

    /// Computes the power per area of the boundary at an end of a line before its sweep, W/m², positive inwards.
    fn work_at(&self, strip: &Strip<T>, line: LineOfCells, pair: usize, end: usize) -> f64 {
        match &self.sides[line.axis][end] {
            BoundaryFaces::Physical(rule) if rule.does_work_on(pair, slot::<T>(line.face)) => {}
            _ => return 0.0,
        }
        let first = [0, line.count][end];
        let at =
            |place: usize| State { velocity: strip.velocity[place], stress: strip.stress[place] };
        let states = [0, 1, 2, 3].map(|i| at(first + i));
        let cells = [0, 1, 2, 3].map(|i| strip.cells[first + i]);
        let work = line::work_between(states, cells, self.slopes);
        if end == 0 { -work } else { work }
    }
}
