//! Fields on a rectangular grid, and a step of theirs.
//!
//! A step of Δt is two-cyclic (Marchuk 1968; Strang 1968): with x, y, z the sweeps of half a step along the
//! axes, K what sources and gravity add in half a step, and Q the rotation of spins against antisymmetric
//! stress by a whole one,
//!
//! ```text
//! U ← x y z  then  K Q K  then  z y x.
//! ```
//!
//! Second order, since every factor is; each keeps or lowers the energy at Courant numbers
//! c(Δt/2)/h ≤ 1, and so does the step. Given values of sides are those in the middle of each half. Where
//! stresses yield, with the projection P onto the yield set in the norm of the energy, the correction stands
//! either last, or in the middle between two halves of Q as the reflection 2P − I, which no more than P
//! makes a state longer ([`Placement`]).
//!
//! Fields are those of the deviation from an initial stress that rests in itself: it moves nothing, and
//! yield conditions see the sum.
//!
//! Every sixteen steps what is smaller in size than 2⁴⁰ times the least normal number becomes zero, in single precision
//! what is smaller than 1.3·10⁻²⁶: many processors are slow with numbers below the normal ones, and tails of waves would
//! be full of them. No ledger notes what goes with it.
//!
//! Where sweeps alternate ([`Splitting::Alternating`](crate::problem::Splitting)) the step is
//!
//! ```text
//! U ← x y z  then  K √Q x √Q K  then  z y,
//! ```
//!
//! with x by a quarter of a step at the very beginning. With X = x² this is (√x … x … √x)ⁿ without the last √x.
//! `complete` applies it to a copy of each cell for output; next to reflecting boundaries output is the mean of the
//! states before and after X. Every factor keeps or lowers the energy.
//!
//! A row along the first axis is folded into as many lanes as fill a line of the cache: of G groups the cell
//! x is in group x mod G and lane x div G, so that cells follow each other lane by lane. A row holds its fields one
//! after the other, each with all groups. Behind the last cell two ghosts stand in the row itself, and there are two
//! groups at least: what is next to a row's first and last groups is in the next lanes, not farther.
//!
//! A step is one pass over the memory. Layers across the last axis come in by a few, and of these a few rows at
//! a time; while they are in the cache, sweeps across rows and layers follow as far behind as they must, and
//! what stands after them in the step behind those. In space a block of the rows of all layers goes through the
//! step before the next one does, so that layers that wait for others do not leave the cache. In the plane, where
//! layers are rows and many of them fit in the cache, the next step follows in the same pass: a row that has come
//! through one step comes into the other.
//!
//! Sweeps run over many lines at once ([`crate::kernel`]); with [`Detail::Full`](crate::problem::Detail::Full) all
//! layers come in together, sweeps run line by line ([`crate::line`]) and keep the account of the scheme's own
//! dissipation. The bits of the fields are the same.
//!
//! Where a domain is cut, or comes round, along the last axis, it has a halo of [`HALO`] layers for each step that
//! a pass may have. They are filled in the pass with what the first sweeps within layers have made of the outermost
//! layers beyond the cut, which so are made once: those in front before the first layers come in, those behind
//! before the last ones do. What is in them after it does not matter.

mod build;
mod complete;
mod fill;
mod local;
mod plastic;
mod sweep;

pub(crate) use fill::{Fill, FillEnd, FillOneSided};

use crate::boundary::Signal;
use crate::kernel::{Carried, Instructions, Stop, Table, Wave};
use crate::ledger::{Energy, Ledger, Total};
use crate::line::{Account, Cell, GHOSTS, HALO};
use crate::medium::{Medium, component};
use crate::problem::{DomainError, Grid, Placement, Problem, Scheme};
use crate::real::{Group, Number, Real};
use crate::row::RowEnds;
use crate::side::{Side, set_time};
use complete::ClosingSides;
use local::combined;
use models::solid::stress::Stress;
use models::solid::waves::Field;
use plastic::Sets;
use std::ops::Range;

/// Rows or layers that come in at a time, unless all do: what a sweep carries from one of these chunks to the next is
/// little beside them, and they stay in the cache.
const CHUNK: usize = 8;

/// How many rows or layers have come through three stages when so many have come in: each of two sweeps
/// across them reads two more than it writes.
fn come_through(come: usize, all: usize) -> [usize; 3] {
    let written = |ready: usize| if ready == all { all } else { ready.saturating_sub(GHOSTS) };
    [come, written(come), written(written(come))]
}

/// Those that come through each of three stages.
fn stages(before: [usize; 3], ready: [usize; 3]) -> [Range<usize>; 3] {
    std::array::from_fn(|stage| before[stage]..ready[stage])
}

/// Steps of a pass at most, in the plane: in space few layers fit in the cache.
const STEPS: usize = 2;

/// The first rows that come to a sweep must be two: the ghosts in front of them are not there any more when others
/// follow. Each sweep has two rows less than the one before it. (In space [`AtATime`] keeps to it.)
const _: () = assert!(CHUNK >= 2 * STEPS * GHOSTS);

/// Steps of a pass at most, where the smallest part of a domain has so many layers: all that are in the halo of
/// another part must be there.
pub(crate) fn most_steps<const D: usize>(layers: usize) -> usize {
    if D == 2 { (layers / HALO).clamp(1, STEPS) } else { 1 }
}

/// Fields at most: three velocities, three spins and nine stresses and couple stresses each.
const MOST_FIELDS: usize = 24;

/// Bytes of rows of layers that come in together, so that they stay in a core's own cache while they go through the
/// step.
const OWN_CACHE: usize = 1 << 20;

/// Bytes of a block of rows in the layers that are within the step, so that they stay in the cache that cores share.
const SHARED_CACHE: usize = 7 << 20;

/// How many layers and rows come in at a time.
#[derive(Clone, Copy, Debug)]
struct AtATime {
    layers: usize,
    /// Rows of these layers.
    rows: usize,
    /// Rows of a block: all layers go through the step in these before the next block does.
    block: usize,
}

impl AtATime {
    /// All at once.
    const ALL: Self = Self { layers: usize::MAX, rows: usize::MAX, block: usize::MAX };

    /// For the plane, where layers are rows.
    const ROWS: Self = Self { layers: CHUNK, rows: 1, block: 1 };

    /// In space, where a row takes so many bytes. Rows that come round are each other's ghosts, and must all be
    /// there.
    fn in_space(row: usize, come_round: bool) -> Self {
        let fits = |layers: &usize| layers * CHUNK * row <= OWN_CACHE;
        let layers = (2 * GHOSTS..=CHUNK).rev().step_by(2).find(fits).unwrap_or(2 * GHOSTS);
        let block = SHARED_CACHE / ((layers + 2 * GHOSTS) * row) / CHUNK;
        match come_round {
            true => Self { layers, ..Self::ALL },
            false => Self { layers, rows: CHUNK, block: block.max(1) * CHUNK },
        }
    }
}

/// Groups of a row, at most, that go through the middle of a step together, so that their layers stay in the cache.
const TILE: usize = 32;

/// Some groups of a row, the same in all layers; never beyond its end, so that sums do not depend on how many rows
/// come in.
struct Tile {
    row: usize,
    groups: Range<usize>,
}

/// Memory that a domain takes, bytes, in numbers of kind `T`: so many fields, and what goes with them.
pub fn memory<T: Real>(cells: &[usize], fields: usize) -> f64 {
    let length = cells.first().copied().unwrap_or(0).max(1);
    let count: f64 = cells.iter().map(|&count| count as f64).product();
    let groups = groups::<T>(length);
    let per_row = pitch(groups) * fields * size_of::<T::Lanes>() + groups * size_of::<u32>();
    count / length as f64 * per_row as f64 + count * size_of::<u16>() as f64
}

/// Groups of a row: its cells, and the ghosts behind them; neighbours in other lanes are next to each
/// other.
fn groups<T: Real>(cells: usize) -> usize {
    (cells + GHOSTS).div_ceil(T::Lanes::COUNT).max(GHOSTS)
}

/// Room of a field in a row of so many groups. No multiple of four lines of the cache: fewer of those that are at one
/// place of different fields and rows have to share one in it.
fn pitch(groups: usize) -> usize {
    if groups.is_multiple_of(4) { groups + 1 } else { groups }
}

/// What crosses the cuts of a domain, at the ends towards smaller (0) and towards greater coordinates (1), in the
/// order of these.
pub(crate) trait Halo<T> {
    /// Hands over pieces of an outermost layer at an end.
    fn begin(&mut self, end: usize, data: &[T], pieces: impl Iterator<Item = Range<usize>>);

    /// Brings those of the neighbour at an end; where there is none they are left as they are.
    fn finish(&mut self, end: usize, data: &mut [T], pieces: impl Iterator<Item = Range<usize>>);
}

/// No neighbours.
impl<T> Halo<T> for () {
    fn begin(&mut self, _: usize, _: &[T], _: impl Iterator<Item = Range<usize>>) {}

    fn finish(&mut self, _: usize, _: &mut [T], _: impl Iterator<Item = Range<usize>>) {}
}

/// A source on cells of its own part.
#[derive(Clone)]
struct Kick {
    /// Groups, lanes and shares, in order.
    cells: Vec<(usize, usize, f64)>,
    /// Place of the field, and amplitude.
    amplitudes: Vec<(usize, f64)>,
    signal: Signal,
    /// By half step of the pass: the mean of the signal times its duration, and its change.
    now: Vec<[f64; 2]>,
}

/// Constants of the rotation by a time: cos, √(αj) sin, sin/√(αj).
type Turn<N> = [N; 3];

/// Fields and what moves them.
#[derive(Clone)]
pub struct Domain<T: Real, const D: usize> {
    grid: Grid<D>,
    /// Layers of the halo in front of the own ones and behind.
    halo: [usize; 2],
    /// Whether the own layers are each other's halo.
    is_own_halo: bool,
    media: Vec<Medium>,
    /// Of all cells, those of the halo included, as everything that follows.
    of_cell: Vec<u16>,
    step: f64,
    /// Steps of a pass at most.
    most_steps: usize,
    /// Steps of the pass under way.
    pass_steps: usize,
    scheme: Scheme,
    instructions: Instructions,
    waves: [Vec<Wave>; D],
    /// Along the first axis by a quarter of a step, where sweeps alternate; else none.
    quarter_waves: Vec<Wave>,
    table: Table<T>,
    /// By pattern: a whole and a half of Q.
    turns: Vec<[Turn<T::Lanes>; 2]>,
    /// By pattern: whether anything yields there.
    yields: Vec<bool>,
    /// Spin and both stresses that turn against each other.
    turning: Vec<[usize; 3]>,
    energy_terms: EnergyTerms<T>,
    /// Pieces of a row that others must know of those in their halo.
    exchanged: Vec<Range<usize>>,
    /// Groups of a row.
    groups: usize,
    /// Groups from where a field begins in a row to where the next one does: the place of a field is so many times
    /// its index.
    pitch: usize,
    /// Rows of a layer across the last axis.
    rows: usize,
    /// Groups of such a layer.
    across: usize,
    row_ends: RowEnds<T>,
    /// By group: those of the rows, and ghosts beyond the ends of the lines at hand.
    patterns: Vec<u32>,
    /// By axis and group: how many groups that follow along the axis have the same pattern, so far as this number
    /// goes; empty where there is one pattern.
    alike: [Vec<u8>; D],
    /// Of the ghosts of each row: in front of it and behind, the nearest first; empty where there is one pattern.
    row_patterns: Vec<[u32; 2 * GHOSTS]>,
    /// By row, field and group, the rows as patterns are.
    data: Vec<T::Lanes>,
    /// As they are in the half steps of a pass.
    sides: Vec<[[Side<T>; 2]; D]>,
    /// Where sweeps alternate those of the first axis, as they are when each step of a pass is completed.
    closing_sides: Vec<ClosingSides<T>>,
    kicks: Vec<Kick>,
    acceleration: [f64; D],
    initial_stress: Option<(usize, Vec<Stress>)>,
    sets: Option<Sets<T>>,
    /// Plastic dissipation by group and lane, J/m³; empty where nothing yields.
    dissipated: Vec<f64>,
    /// Places of velocities and spins, and Δt times the sum of their values, the first one halved, by cell.
    integrals: Vec<(usize, Vec<f64>)>,
    /// Steps done.
    steps: usize,
    /// Own cells that are recorded after each step, in their order.
    watched: Vec<usize>,
    /// By step of the pass: what [`Self::show`] gives of them.
    records: Vec<Vec<f64>>,
    at_a_time: AtATime,
    /// Rows from those that have come in last to those that come next.
    ahead: usize,
    /// By half step of the pass and by layer across the last axis: sums do not depend on who does them. Behind them
    /// the work at both ends of that axis, as layers are swept along it when others of the part have come in. What
    /// each half adds comes in an order of its own: how they follow each other depends on what else has
    /// come in.
    ledgers: Vec<Vec<Ledger>>,
    /// Of all steps before, by own layers.
    totals: Vec<Total>,
    buffer: Buffer<T>,
}

/// Terms of the energy density: places of two fields, by medium or pattern a coefficient. Kinetic terms
/// stand first.
#[derive(Clone)]
struct EnergyTerms<T: Real> {
    places: Vec<[usize; 2]>,
    kinetic: usize,
    /// By pattern and term.
    factors: Vec<Vec<T::Lanes>>,
}

/// Room for the sweeps.
#[derive(Clone)]
struct Buffer<T: Real> {
    /// What sweeps carry by line and wave, by axis and half step of the pass; of those that run within layers or
    /// rows by layer or row at hand.
    carried: [Vec<Vec<Carried<T::Lanes>>>; 3],
    /// Groups on the way along a line.
    way: Vec<Stop>,
    /// Groups that are yet to be corrected.
    left: Vec<usize>,
    velocity: Vec<T>,
    stress: Vec<T>,
    cells: Vec<Cell<T>>,
    accounts: Vec<Account>,
}

impl<T: Real, const D: usize> Domain<T, D> {
    /// A domain at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>) -> Result<Self, DomainError> {
        problem.check()?;
        Ok(Self::slab(problem, 0..problem.grid.cells[D - 1], [false; 2], 1))
    }

    /// Uses other instructions than the best; results do not depend on them.
    pub fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// The components of the state.
    pub fn fields(&self) -> &[Field] {
        &self.media[0].fields
    }

    /// The grid.
    pub fn grid(&self) -> Grid<D> {
        self.grid
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.step
    }

    /// The values of a field, the first axis running fastest; `None` if there is no such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        let place = self.place(field)?;
        Some(self.own_cells().map(|cell| self.at(cell, place)).collect())
    }

    /// Sets the values of a field, the first axis running fastest; of those beyond the end of either
    /// nothing happens.
    pub fn set(&mut self, field: Field, values: &[T]) {
        let Some(place) = self.place(field) else { return };
        for (cell, &value) in self.own_cells().zip(values) {
            *self.at_mut(cell, place) = value;
        }
    }

    /// Sets everything to zero, what is no cell included.
    pub(crate) fn clear(&mut self) {
        self.data.fill(T::Lanes::ZERO);
    }

    /// The value of a field in a cell; `None` if there is no such field or cell.
    pub fn value(&self, field: Field, cell: usize) -> Option<T> {
        let cell = self.own_cells().nth(cell)?;
        self.place(field).map(|place| self.at(cell, place))
    }

    /// The first value that is not finite: its field and its cell.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let is_broken = |cell: &usize| {
            self.places().find(|(_, place)| !self.at(*cell, *place).wide().is_finite())
        };
        let cell = self.own_cells().find(|cell| is_broken(cell).is_some())?;
        is_broken(&cell).map(|(field, _)| (field, cell - self.own_cells().start))
    }

    /// The own cells among all.
    fn own_cells(&self) -> Range<usize> {
        let first = self.halo[0] * self.layer();
        first..first + self.grid.count()
    }

    /// All layers, those of the halo included.
    fn layers(&self) -> usize {
        self.totals.len() + self.halo[0] + self.halo[1]
    }

    /// The own layers among all.
    fn own_layers(&self) -> Range<usize> {
        self.halo[0]..self.layers() - self.halo[1]
    }

    /// All fields, and their places in a row.
    fn places(&self) -> impl Iterator<Item = (Field, usize)> {
        self.fields().iter().copied().zip((0..).step_by(self.pitch))
    }

    fn place(&self, field: Field) -> Option<usize> {
        self.places().find(|own| own.0 == field).map(|own| own.1)
    }

    /// From where a row begins in the data to where the next one does.
    #[inline(always)]
    fn row_size(&self) -> usize {
        self.fields().len() * self.pitch
    }

    /// A group of a row.
    #[inline(always)]
    fn stop(&self, row: usize, group: usize) -> Stop {
        Stop { group: row * self.groups + group, data: row * self.row_size() + group }
    }

    /// Group and lane of a cell.
    #[inline(always)]
    fn slot(&self, cell: usize) -> (Stop, usize) {
        let length = self.grid.cells[0];
        let (row, x) = (cell / length, cell % length);
        (self.stop(row, x % self.groups), x / self.groups)
    }

    #[inline(always)]
    fn at(&self, cell: usize, place: usize) -> T {
        let (stop, lane) = self.slot(cell);
        self.data[stop.data + place].lanes()[lane]
    }

    #[inline(always)]
    fn at_mut(&mut self, cell: usize, place: usize) -> &mut T {
        let (stop, lane) = self.slot(cell);
        &mut self.data[stop.data + place].lanes_mut()[lane]
    }

    /// Cells of a layer across the last axis.
    fn layer(&self) -> usize {
        self.grid.faces(D - 1)
    }

    /// What steps did to the energy so far.
    pub fn ledger(&self) -> Ledger {
        Total::sum(&self.totals)
    }

    /// The same by layer across the last axis.
    pub(crate) fn totals(&self) -> &[Total] {
        &self.totals
    }

    /// Takes over steps done and totals by layer, as after so many steps.
    pub(crate) fn take_over(&mut self, steps: usize, totals: impl Iterator<Item = Total>) {
        self.steps = steps;
        for (own, total) in self.totals.iter_mut().zip(totals) {
            *own = total;
        }
    }

    /// Steps of a pass at most.
    pub(crate) fn most_steps(&self) -> usize {
        self.most_steps
    }

    /// Steps done.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Energy of the deviation from the initial stress.
    pub fn energy(&self) -> Energy {
        Energy::sum(&self.energies())
    }

    /// Advances all fields by Δt.
    pub fn advance(&mut self) {
        self.pass(1, &mut ());
    }

    /// Advances all fields by some steps in one pass over the memory: one at least, and no more than
    /// [`Self::most_steps`].
    pub(crate) fn pass(&mut self, steps: usize, neighbours: &mut impl Halo<T::Lanes>) {
        debug_assert!((1..=self.most_steps).contains(&steps));
        if self.steps == 0 && !self.scheme.alternates() {
            let all = 0..self.layers() * self.layer();
            self.integrate(all, 0.5);
        }
        self.steps += steps;
        self.pass_steps = steps;
        self.set_times();
        let rows = self.rows;
        let mut come = 0;
        while come < rows {
            let block = come..rows.min(come.saturating_add(self.at_a_time.block));
            come = block.end;
            self.advance_block(&block, steps, neighbours);
        }
        let (own, layers) = (self.own_layers(), self.layers());
        for ledgers in &mut self.ledgers[..2 * steps] {
            for (end, layer) in [own.start, own.end - 1].into_iter().enumerate() {
                ledgers[layer].inflow += ledgers[layers + end].inflow;
            }
            for (total, step) in self.totals.iter_mut().zip(&ledgers[own.clone()]) {
                total.add(*step);
            }
            ledgers.fill(Ledger::default());
        }
    }

    /// Brings a block of the rows of all layers through some steps, as far as the rows behind it do not matter.
    fn advance_block(
        &mut self,
        block: &Range<usize>,
        steps: usize,
        neighbours: &mut impl Halo<T::Lanes>,
    ) {
        let (all, own, rows) = (self.layers(), self.own_layers(), self.rows);
        let swept = come_through(block.start, rows)[1]..come_through(block.end, rows)[1];
        self.send(block, &swept, neighbours);
        if self.is_own_halo {
            self.fill_own_halo(&swept);
        }
        self.receive(0, &swept, neighbours);
        let mut ready = [[0; 3]; STEPS];
        while ready[steps - 1][2] < all {
            let mut come = all.min(ready[0][0].saturating_add(self.at_a_time.layers));
            // As late as may be: a neighbour may be behind for a while before anyone waits for it.
            if ready[0][0] <= own.end && own.end < come {
                self.receive(1, &swept, neighbours);
            }
            for (step, ready) in ready[..steps].iter_mut().enumerate() {
                let before = std::mem::replace(ready, come_through(come, all));
                // What no later sweep looks at is left alone: each looks GHOSTS layers beyond what it writes.
                let needed = std::array::from_fn(|stage| {
                    let beyond = (steps - 1 - step) * HALO + (2 - stage) * GHOSTS;
                    own.start.saturating_sub(beyond)..all.min(own.end + beyond)
                });
                let layers = std::array::from_fn(|stage| {
                    let Range { start, end } = needed[stage];
                    before[stage].clamp(start, end)..ready[stage].clamp(start, end)
                });
                self.advance_layers(&layers, &needed, block, 2 * step);
                if block.end == rows {
                    if !self.scheme.alternates() {
                        let layer = self.layer();
                        self.integrate(layers[2].start * layer..layers[2].end * layer, 1.0);
                    }
                    self.record(layers[2].clone(), step);
                }
                come = ready[2];
            }
        }
    }

    /// Whether this half step of the pass is the first of all.
    fn is_first(&self, half: usize) -> bool {
        half == 0 && self.steps == self.pass_steps
    }

    /// The waves of a sweep along an axis.
    fn waves_of(&self, axis: usize, half: usize) -> &[Wave] {
        match self.scheme.alternates() && axis == 0 && self.is_first(half) {
            true => &self.quarter_waves,
            false => &self.waves[axis],
        }
    }

    /// Sides and sources as they are in the steps of the pass.
    fn set_times(&mut self) {
        let before = self.steps - self.pass_steps;
        for half in 0..2 * self.pass_steps {
            let start = (before + half / 2) as f64 * self.step;
            let end = (before + half / 2 + 1) as f64 * self.step;
            let middle = start + 0.5 * self.step;
            let [from, to] = [[start, middle], [middle, end]][half % 2];
            for sides in &mut self.sides[half] {
                set_time(sides, start + [0.25, 0.75][half % 2] * self.step);
            }
            if self.scheme.alternates() {
                // The middle of each sweep along the first axis.
                let time = match half % 2 {
                    0 if self.is_first(half) => start + 0.125 * self.step,
                    0 => start,
                    _ => middle,
                };
                set_time(&mut self.sides[half][0], time);
                if half % 2 == 1 {
                    self.closing_sides[half / 2].set_time(end, self.step);
                }
            }
            for kick in &mut self.kicks {
                // Before the beginning there is none: what is there at once comes with the first step.
                let before = if from > 0.0 { (kick.signal)(from) } else { 0.0 };
                let mean = (kick.signal)(0.5 * (from + to));
                kick.now[half] = [mean * (to - from), (kick.signal)(to) - before];
            }
        }
    }

    /// Brings a block of layers through the stages of a step, of which this is the first half in the pass: some of
    /// them up to the first sweep along the last axis, some from there to the second one, some through what stands
    /// after that; those from end to end are all that come through each. Rows of theirs follow each other likewise.
    fn advance_layers(
        &mut self,
        layers: &[Range<usize>; 3],
        ends: &[Range<usize>; 3],
        block: &Range<usize>,
        first: usize,
    ) {
        let (all, second) = (self.rows, first + 1);
        let steps_done = self.steps - self.pass_steps + first / 2 + 1;
        let mut ready = come_through(block.start, all);
        while ready[0] < block.end {
            let rows = self.next_rows(ready[0], block, self.at_a_time.layers);
            let before = std::mem::replace(&mut ready, come_through(rows.end, all));
            let rows = stages(before, ready);
            for layer in layers[0].clone() {
                if first > 0 || !self.is_exchanged(layer) {
                    self.sweep_layer(layer, &rows, first);
                }
            }
            // Parts of a row that are as long as each other. Rows that are swept along the first axis in between go
            // through the middle together: their ghosts are made in lanes.
            let length = self.groups.div_ceil(self.groups.div_ceil(TILE));
            let all = self.groups;
            let tiles = |row: usize| {
                let starts = (0..all).step_by(length);
                starts.map(move |start| Tile { row, groups: start..all.min(start + length) })
            };
            let rows_of_middle = rows[1].clone();
            if self.scheme.alternates() {
                for start in rows_of_middle.clone().step_by(CHUNK) {
                    let together = start..rows_of_middle.end.min(start + CHUNK);
                    for tile in together.clone().flat_map(tiles) {
                        self.sweep_last(&layers[0], &ends[0], &tile, first);
                    }
                    self.sweep_middle(&layers[1], &together, first);
                    for tile in together.flat_map(tiles) {
                        self.sweep_last(&layers[1], &ends[1], &tile, second);
                    }
                }
            } else {
                for tile in rows_of_middle.flat_map(tiles) {
                    self.sweep_last(&layers[0], &ends[0], &tile, first);
                    self.turn_and_kick(&layers[1], &tile, first);
                    self.sweep_last(&layers[1], &ends[1], &tile, second);
                }
            }
            for layer in layers[2].clone() {
                self.sweep_layer(layer, &rows, second);
                if self.scheme.placement == Placement::Last {
                    // Row by row, as sums are the same however many have come in.
                    for row in rows[2].clone() {
                        let tile = Tile { row, groups: 0..self.groups };
                        self.correct(&(layer..layer + 1), &tile, second, false);
                    }
                }
                self.forget_traces(layer, &rows[2], steps_done);
            }
        }
    }

    /// The rows of a block that come in next, and which ones will after them is noted for those who call for them;
    /// so many layers come in together.
    fn next_rows(&mut self, come: usize, block: &Range<usize>, layers: usize) -> Range<usize> {
        let end = block.end.min(come.saturating_add(self.at_a_time.rows));
        // Behind the last ones of the block come its first ones in the layers that follow.
        self.ahead = match end < block.end {
            true => end - come,
            false => layers.saturating_mul(self.rows) - (come - block.start),
        };
        come..end
    }

    /// K Q K, with the correction where it stands in the middle.
    fn turn_and_kick(&mut self, layers: &Range<usize>, tile: &Tile, first: usize) {
        self.kick(layers, tile, first);
        if self.scheme.placement == Placement::Middle && !self.dissipated.is_empty() {
            self.rotate(layers, tile, 1);
            self.correct(layers, tile, first + 1, true);
            self.rotate(layers, tile, 1);
        } else {
            self.rotate(layers, tile, 0);
        }
        self.kick(layers, tile, first + 1);
    }

    /// The middle of a step with alternating sweeps, between the two sweeps along the last axis: K, half of Q, the sweep
    /// along rows, half of Q, K. Integrals in time take the mean of the states before and after it, which is second order in the
    /// middle of the step.
    fn sweep_middle(&mut self, layers: &Range<usize>, rows: &Range<usize>, first: usize) {
        let groups = 0..self.groups;
        let tiles = rows.clone().map(|row| Tile { row, groups: groups.clone() });
        for tile in tiles.clone() {
            self.kick(layers, &tile, first);
            self.rotate(layers, &tile, 1);
            self.integrate_row(layers, tile.row);
        }
        if D == 2 {
            // Layers are rows here.
            self.sweep_rows_of(layers.clone(), first + 1);
        } else {
            for layer in layers.clone() {
                let start = layer * self.rows;
                self.sweep_rows_of(start + rows.start..start + rows.end, first + 1);
            }
        }
        for tile in tiles {
            self.integrate_row(layers, tile.row);
            self.rotate(layers, &tile, 1);
            self.kick(layers, &tile, first + 1);
        }
    }

    /// Half a step of the integrals in time in a row of some layers.
    fn integrate_row(&mut self, layers: &Range<usize>, row: usize) {
        let length = self.grid.cells[0];
        for layer in layers.clone() {
            let row = layer * self.rows + row;
            self.integrate(row * length..(row + 1) * length, 0.5);
        }
    }

    /// Whether a layer is in the halo of this part, or may be in a neighbour's.
    fn is_exchanged(&self, layer: usize) -> bool {
        layer < 2 * self.halo[0] || layer + 2 * self.halo[1] >= self.layers()
    }

    /// Does the first sweeps of a pass in a block of the own layers that are in halos, and hands over the rows that
    /// are ready. Layers that are their own halo are sent to nobody.
    fn send(
        &mut self,
        block: &Range<usize>,
        ready: &Range<usize>,
        neighbours: &mut impl Halo<T::Lanes>,
    ) {
        let own = self.own_layers();
        for layer in own.clone() {
            if !self.is_exchanged(layer) {
                continue;
            }
            let mut come = block.start;
            while come < block.end {
                let rows = self.next_rows(come, block, 1);
                come = rows.end;
                self.sweep_layer(layer, &[rows, 0..0, 0..0], 0);
            }
            let depths = [layer - own.start, own.end - 1 - layer];
            for end in (0..2).filter(|end| depths[*end] < self.halo[*end]) {
                neighbours.begin(end, &self.data, self.pieces(layer, ready));
            }
        }
    }

    /// Fills rows of the halo at an end.
    fn receive(&mut self, end: usize, rows: &Range<usize>, neighbours: &mut impl Halo<T::Lanes>) {
        let first = [0, self.own_layers().end][end];
        let mut data = std::mem::take(&mut self.data);
        for layer in first..first + self.halo[end] {
            neighbours.finish(end, &mut data, self.pieces(layer, rows));
        }
        self.data = data;
    }

    /// Where the exchanged pieces of rows of a layer stand.
    fn pieces(&self, layer: usize, rows: &Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let rows = layer * self.rows + rows.start..layer * self.rows + rows.end;
        let firsts = rows.map(|row| row * self.row_size());
        let pieces =
            |first| self.exchanged.iter().map(move |own| first + own.start..first + own.end);
        firsts.flat_map(pieces)
    }

    /// Where the fields of rows of a layer stand.
    fn stored(&self, layer: usize, rows: &Range<usize>) -> Range<usize> {
        let first = layer * self.rows;
        (first + rows.start) * self.row_size()..(first + rows.end) * self.row_size()
    }

    /// Fills rows of the halo from the own layers.
    fn fill_own_halo(&mut self, rows: &Range<usize>) {
        let own = self.own_layers();
        for index in (0..own.start).chain(own.end..self.layers()) {
            let source = own.start + (index + own.len() * own.start - own.start) % own.len();
            let [from, to] = [source, index].map(|layer| self.stored(layer, rows));
            self.data.copy_within(from, to.start);
        }
    }

    /// The integrals in time of the problem in a cell, m or rad.
    pub(crate) fn integrals(&self, cell: usize) -> impl Iterator<Item = f64> {
        // Of the trapezoidal rule; where sweeps alternate the rule is that of midpoints.
        let last = if self.scheme.alternates() { 0.0 } else { 0.5 * self.step };
        let is_under_way = self.steps > 0;
        let cell = cell + self.own_cells().start;
        self.integrals.iter().map(move |(place, sums)| match is_under_way {
            true => sums[cell] - last * self.at(cell, *place).wide(),
            false => 0.0,
        })
    }

    /// How many sums steps add up by cell, besides the dissipation.
    pub(crate) fn integral_count(&self) -> usize {
        self.integrals.len()
    }

    /// What steps added up by cell: dissipation, where anything yields, and the sums of integrals.
    pub(crate) fn sums(&self) -> Vec<Vec<f64>> {
        let own = self.own_cells();
        let is_plastic = !self.dissipated.is_empty();
        let cells = own.clone().filter(|_| is_plastic);
        let dissipated = cells.map(|cell| self.dissipated[self.lane_of(cell)]).collect();
        let integrals = self.integrals.iter().map(|(_, sums)| sums[own.clone()].to_vec());
        std::iter::once(dissipated).chain(integrals).collect()
    }

    /// Takes over such sums from the place of the first own cell on.
    pub(crate) fn set_sums(&mut self, sums: &[Vec<f64>], first: usize) {
        let Some((dissipated, integrals)) = sums.split_first() else { return };
        let own = self.own_cells();
        for (cell, &sum) in own.clone().zip(dissipated.get(first..).unwrap_or(&[])) {
            let lane = self.lane_of(cell);
            self.dissipated[lane] = sum;
        }
        for ((_, own_sums), all) in self.integrals.iter_mut().zip(integrals) {
            own_sums[own.clone()].copy_from_slice(&all[first..first + own.len()]);
        }
    }

    /// The place of a cell among the lanes of all groups.
    fn lane_of(&self, cell: usize) -> usize {
        let (stop, lane) = self.slot(cell);
        stop.group * T::Lanes::COUNT + lane
    }

    /// The domain with its stresses in their yield sets: what is shown of it.
    #[must_use]
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        for row in 0..self.rows {
            let tile = Tile { row, groups: 0..self.groups };
            shown.correct(&(0..self.layers()), &tile, 1, false);
        }
        shown.ledgers.iter_mut().for_each(|half| half.fill(Ledger::default()));
        shown.dissipated.clone_from(&self.dissipated);
        shown
    }

    /// The first cell whose stress is not in its yield set.
    pub(crate) fn first_beyond_yield(&self) -> Option<usize> {
        (0..self.grid.count()).find(|&cell| {
            let stress = self.whole_stress(cell);
            self.medium(cell).project(&stress).stress != stress
        })
    }

    /// Records own cells, in their order, after each step from now on.
    pub(crate) fn watch(&mut self, cells: impl Iterator<Item = usize>) {
        self.watched = cells.collect();
    }

    /// Records what is watched in layers that have come through a step of the pass.
    fn record(&mut self, layers: Range<usize>, step: usize) {
        let mut records = std::mem::take(&mut self.records[step]);
        let first = self.own_cells().start;
        let [from, to] = [layers.start, layers.end]
            .map(|layer| self.watched.partition_point(|cell| first + cell < layer * self.layer()));
        let sides = self.closing_sides.get(step);
        for &cell in &self.watched[from..to] {
            self.show_between(cell, sides, &mut records);
        }
        self.records[step] = records;
    }

    /// Appends what the pass recorded, by step and then by cell, and forgets it.
    pub(crate) fn hand_over(&mut self, records: &mut Vec<f64>) {
        self.records.iter_mut().for_each(|step| records.append(step));
    }

    /// Appends all fields of a cell as they are shown: the whole stress, the initial one included, in its
    /// yield set. Behind them the integrals of the problem.
    pub fn show(&self, cell: usize, values: &mut Vec<f64>) {
        self.show_between(cell, self.sides_now().as_ref(), values);
    }

    /// The same with the sides that [`Self::sides_now`] gives, for many cells.
    pub(crate) fn show_between(
        &self,
        cell: usize,
        sides: Option<&ClosingSides<T>>,
        values: &mut Vec<f64>,
    ) {
        let own = self.completed(cell + self.own_cells().start, sides);
        let stress = self.stress_of(&own);
        let whole = combined(&stress, &self.initial_stress(cell + self.own_cells().start), 1.0);
        let stress = self.medium(cell).project(&whole).stress;
        for (&field, value) in self.fields().iter().zip(own) {
            values.push(component(field, &stress).unwrap_or_else(|| value.wide()));
        }
        values.extend(self.integrals(cell));
    }

    /// The medium of an own cell.
    fn medium(&self, cell: usize) -> &Medium {
        &self.media[usize::from(self.of_cell[cell + self.own_cells().start])]
    }
}
