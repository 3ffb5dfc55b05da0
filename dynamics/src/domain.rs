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
//! Along the first axis cells lie in groups that fill a line of the cache per field; a group holds all its
//! fields. Sweeps run over many lines at once ([`crate::kernel`]); with [`Detail::Full`](crate::problem::Detail::Full) they run
//! line by line ([`crate::line`]) and keep the account of the scheme's own dissipation. The bits of
//! the fields are the same.

mod sweep;

use crate::boundary::{Boundary, Signal};
use crate::kernel::{Carried, Instructions, Table, Wave, Work};
use crate::ledger::{Energy, Ledger, Total};
use crate::line::{Account, Cell, GHOSTS};
use crate::medium::{Medium, component, energy_terms};
use crate::problem::{DomainError, Grid, Placement, Problem, Scheme};
use crate::real::{Group, Number, Real};
use crate::side::{Mirror, Side};
use models::cosserat::stress::Stress;
use models::cosserat::waves::Field;
use std::collections::HashMap;
use std::ops::Range;

/// Memory that a domain takes, bytes, in numbers of kind `T`: so many fields, and what goes with them.
pub fn memory<T: Real>(cells: &[usize], fields: usize) -> f64 {
    let length = cells.first().copied().unwrap_or(0).max(1);
    let count: f64 = cells.iter().map(|&count| count as f64).product();
    let per_row = groups::<T>(length) * (fields * size_of::<T::Lanes>() + size_of::<u32>());
    count / length as f64 * per_row as f64 + count * size_of::<u16>() as f64
}

/// Groups of a row: its cells, and the ghosts behind them.
fn groups<T: Real>(cells: usize) -> usize {
    (cells + GHOSTS).div_ceil(T::Lanes::COUNT)
}

/// A source on cells of its own part.
#[derive(Clone)]
struct Kick {
    cells: Vec<(usize, f64)>,
    /// Place of the field, and amplitude.
    amplitudes: Vec<(usize, f64)>,
    signal: Signal,
}

/// Constants of the rotation by a time: cos, √(αj) sin, sin/√(αj).
type Turn<N> = [N; 3];

/// Fields and what moves them.
#[derive(Clone)]
pub struct Domain<T: Real, const D: usize> {
    grid: Grid<D>,
    media: Vec<Medium>,
    of_cell: Vec<u16>,
    step: f64,
    scheme: Scheme,
    instructions: Instructions,
    waves: [Vec<Wave>; D],
    table: Table<T>,
    /// By pattern: a whole and a half of Q.
    turns: Vec<[Turn<T::Lanes>; 2]>,
    /// Spin and both stresses that turn against each other.
    turning: Vec<[usize; 3]>,
    /// Terms of the energy density by medium: places of two fields and a coefficient.
    energy_terms: Vec<Vec<(usize, usize, f64)>>,
    /// Groups of a row.
    groups: usize,
    /// By row and group.
    patterns: Vec<u32>,
    /// Of the group in front of each row.
    front_patterns: Vec<u32>,
    /// By row, group and field.
    data: Vec<T::Lanes>,
    sides: [[Side<T>; 2]; D],
    kicks: Vec<Kick>,
    acceleration: [f64; D],
    initial_stress: Option<(usize, Vec<Stress>)>,
    /// Plastic dissipation by cell, J/m³; empty where nothing yields.
    dissipated: Vec<f64>,
    /// Places of velocities and spins, and Δt times the sum of their values, the first one halved, by cell.
    integrals: Vec<(usize, Vec<f64>)>,
    /// What lies beyond cuts: by depth, row of the layer, group and pair; and the patterns there.
    halos: [Vec<[T::Lanes; 2]>; 2],
    halo_patterns: [Vec<u32>; 2],
    /// Steps done.
    steps: usize,
    /// Of the step under way, by layer across the last axis: sums do not depend on who does them.
    ledgers: Vec<Ledger>,
    /// Of all steps before, by the same layers.
    totals: Vec<Total>,
    buffer: Buffer<T>,
}

/// Room for the sweeps.
#[derive(Clone)]
struct Buffer<T: Real> {
    fronts: Vec<[T::Lanes; 2]>,
    ghosts: Vec<[T::Lanes; 2]>,
    ghost_patterns: Vec<u32>,
    carried: Vec<Carried<T::Lanes>>,
    velocity: Vec<T>,
    stress: Vec<T>,
    cells: Vec<Cell<T>>,
    accounts: Vec<Account>,
}

/// Patterns of media in groups, numbered as they turn up.
#[derive(Default)]
struct Patterns {
    known: HashMap<Vec<u16>, u32>,
    all: Vec<Vec<u16>>,
}

impl Patterns {
    fn number(&mut self, media: Vec<u16>) -> u32 {
        let (all, next) = (&mut self.all, self.known.len() as u32);
        *self.known.entry(media).or_insert_with_key(|media| {
            all.push(media.clone());
            next
        })
    }

    /// Patterns of the groups of a row, with the ghosts behind it, and of the group in front of it.
    fn row<T: Real>(&mut self, media: &[u16], is_periodic: bool) -> (Vec<u32>, u32) {
        let (lanes, length) = (T::Lanes::COUNT, media.len());
        // Mirror images, or what comes round; lanes that are neither cells nor ghosts have any medium.
        let inside = |beyond: usize| match is_periodic {
            true => media[beyond % length],
            false => media[length - 1 - beyond % length],
        };
        let at = |x: usize| media.get(x).copied().unwrap_or_else(|| inside(x - length));
        let own = (0..groups::<T>(length))
            .map(|group| self.number((group * lanes..(group + 1) * lanes).map(at).collect()))
            .collect();
        let front = (0..lanes).rev().map(|depth| match is_periodic {
            true => media[length - 1 - depth % length],
            false => media[depth % length],
        });
        (own, self.number(front.collect()))
    }
}

impl<T: Real, const D: usize> Domain<T, D> {
    /// A domain at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>) -> Result<Self, DomainError> {
        problem.check()?;
        Ok(Self::slab(problem, 0..problem.grid.cells[D - 1], [false; 2]))
    }

    /// The layers across the last axis of a sound problem, and whether there are others beyond.
    pub(crate) fn slab(problem: &Problem<D>, layers: Range<usize>, is_cut: [bool; 2]) -> Self {
        let whole = problem.grid;
        let mut grid = whole;
        grid.cells[D - 1] = layers.len();
        let [length, last] = [grid.cells[0], whole.cells[D - 1]];
        let layer = whole.faces(D - 1);
        let media = problem.media.clone();
        let fields = &media[0].fields;
        let place = |field: Field| fields.iter().position(|own| *own == field);

        let mut constants = [0, 0];
        let waves = std::array::from_fn(|axis| {
            let pairs = &media[0].pairs[axis];
            let wave = |pair: &models::cosserat::waves::Pair| {
                let followers: Vec<usize> =
                    pair.followers.iter().filter_map(|(field, _)| place(*field)).collect();
                let wave = Wave {
                    velocity: place(pair.velocity).unwrap_or(0),
                    stress: place(pair.stress).unwrap_or(0),
                    constants: constants[0],
                    ratios: constants[1],
                    followers,
                };
                constants = [constants[0] + 1, constants[1] + wave.followers.len()];
                wave
            };
            pairs.iter().map(wave).collect()
        });

        let mut known = Patterns::default();
        let is_periodic = problem.boundaries[0][0] == Boundary::Periodic;
        let mut patterns_of = |layer_at: usize| {
            let media = &problem.of_cell[layer_at * layer..(layer_at + 1) * layer];
            let rows = media.chunks(length.max(1));
            rows.map(|row| known.row::<T>(row, is_periodic)).collect::<Vec<_>>()
        };
        let rows: Vec<_> = layers.clone().flat_map(&mut patterns_of).collect();
        let patterns = rows.iter().flat_map(|row| row.0.iter().copied()).collect();
        let front_patterns = rows.iter().map(|row| row.1).collect();
        // Layers count round where the domain does.
        let mut beyond = |place: usize| -> Vec<u32> {
            patterns_of(place % last).into_iter().flat_map(|row| row.0).collect()
        };
        let halo_patterns = [
            (0..GHOSTS)
                .filter(|_| is_cut[0])
                .flat_map(|d| beyond(layers.start + last - 1 - d))
                .collect(),
            (0..GHOSTS).filter(|_| is_cut[1]).flat_map(|d| beyond(layers.end + d)).collect(),
        ];
        let groups = groups::<T>(length);
        let halo = GHOSTS * layer / length.max(1) * groups * media[0].pairs[D - 1].len();
        let halos = is_cut.map(|cut| vec![[T::Lanes::ZERO; 2]; if cut { halo } else { 0 }]);

        let sides = std::array::from_fn(|axis| {
            std::array::from_fn(|end| {
                let boundary = &problem.boundaries[axis][end];
                if axis + 1 == D && is_cut[end] {
                    return Side::Cut;
                }
                if *boundary == Boundary::Periodic {
                    return Side::Periodic;
                }
                // Of sides along the last axis the own layers' share.
                let own = grid.faces(axis);
                let first =
                    if axis + 1 == D { 0 } else { own / layers.len().max(1) * layers.start };
                let mut mirror =
                    Mirror::new(boundary, media[0].pairs[axis].len(), first..first + own);
                for load in problem.loads.iter().filter(|l| (l.axis, l.end) == (axis, end)) {
                    mirror.add(load, first);
                }
                Side::Mirror(mirror)
            })
        });
        let first = layers.start * layer;
        let own_cell = |&(cell, share): &(usize, f64)| {
            let own = cell.checked_sub(first).filter(|own| *own < layers.len() * layer)?;
            Some((own, share))
        };
        let kicks = problem.sources.iter().map(|source| Kick {
            cells: source.cells.iter().filter_map(own_cell).collect(),
            amplitudes: source
                .amplitudes
                .iter()
                .filter_map(|&(f, a)| Some((place(f)?, a)))
                .collect(),
            signal: source.signal.clone(),
        });
        let initial_stress =
            problem.initial_stress.clone().map(|(axis, stress)| match axis + 1 == D {
                true => (axis, stress[layers.clone()].to_vec()),
                false => (axis, stress),
            });
        let turning = (0..3).filter_map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            Some([place(Field::Spin(k))?, place(Field::Stress(i, j))?, place(Field::Stress(j, i))?])
        });
        let is_plastic = media.iter().any(|medium| medium.yields.is_some());
        let integrals = problem.integrals.iter().filter_map(|&field| place(field));
        let cells = grid.count();
        let longest = grid.cells.iter().copied().max().unwrap_or(0);
        let widest = media[0].pairs.iter().map(Vec::len).max().unwrap_or(0);
        let number = rows.len();
        let buffer = Buffer {
            fronts: vec![[T::Lanes::ZERO; 2]; number * media[0].pairs[0].len()],
            ghosts: vec![[T::Lanes::ZERO; 2]; 2 * GHOSTS * groups * widest],
            ghost_patterns: vec![0; 2 * GHOSTS * groups],
            carried: vec![Carried::default(); groups * widest],
            velocity: vec![T::ZERO; longest + 2 * GHOSTS],
            stress: vec![T::ZERO; longest + 2 * GHOSTS],
            cells: vec![Cell::new(1.0, 0.0); longest + 2 * GHOSTS],
            accounts: vec![Account::default(); longest],
        };
        let mut domain = Self {
            grid,
            of_cell: problem.of_cell[first..first + layers.len() * layer].to_vec(),
            step: problem.step,
            scheme: problem.scheme,
            instructions: Instructions::best(),
            waves,
            table: Table { cells: Vec::new(), waves: 0, ratios: Vec::new(), followers: 0 },
            turns: Vec::new(),
            turning: turning.collect(),
            energy_terms: media.iter().map(energy_terms).collect(),
            groups,
            patterns,
            front_patterns,
            data: vec![T::Lanes::ZERO; number * groups * fields.len()],
            sides,
            kicks: kicks.collect(),
            acceleration: problem.acceleration,
            initial_stress,
            dissipated: vec![0.0; if is_plastic { cells } else { 0 }],
            integrals: integrals.map(|place| (place, vec![0.0; cells])).collect(),
            halos,
            halo_patterns,
            steps: 0,
            ledgers: vec![Ledger::default(); layers.len()],
            totals: vec![Total::default(); layers.len()],
            buffer,
            media,
        };
        domain.tabulate(&known.all, constants);
        domain
    }

    /// The constants of all patterns.
    fn tabulate(&mut self, patterns: &[Vec<u16>], [waves, followers]: [usize; 2]) {
        let by_lane = |pattern: &[u16], value: &dyn Fn(&Medium) -> T| {
            let mut lanes = T::Lanes::ZERO;
            for (lane, &medium) in lanes.lanes_mut().iter_mut().zip(pattern) {
                *lane = value(&self.media[usize::from(medium)]);
            }
            lanes
        };
        let mut table = Table { cells: Vec::new(), waves, ratios: Vec::new(), followers };
        let mut turns = Vec::new();
        for pattern in patterns {
            for axis in 0..D {
                let ratio = 0.5 * self.step / self.grid.spacing[axis];
                for pair in 0..self.media[0].pairs[axis].len() {
                    let cell = |medium: &Medium| {
                        let own = &medium.pairs[axis][pair];
                        Cell::<T>::new(own.impedance(), (own.speed() * ratio).min(1.0))
                    };
                    table.cells.push(Cell {
                        impedance: by_lane(pattern, &|medium| cell(medium).impedance),
                        courant: by_lane(pattern, &|medium| cell(medium).courant),
                        rest: by_lane(pattern, &|medium| cell(medium).rest),
                        to_velocity: by_lane(pattern, &|medium| cell(medium).to_velocity),
                        to_stress: by_lane(pattern, &|medium| cell(medium).to_stress),
                    });
                    for follower in 0..self.media[0].pairs[axis][pair].followers.len() {
                        table.ratios.push(by_lane(pattern, &|medium| {
                            T::of(medium.pairs[axis][pair].followers[follower].1)
                        }));
                    }
                }
            }
            turns.push([1.0, 0.5].map(|part| {
                [0, 1, 2].map(|which| {
                    by_lane(pattern, &|medium| {
                        let Some(rotation) = medium.rotation else { return T::ZERO };
                        let (sin, cos) = (rotation.frequency * part * self.step).sin_cos();
                        T::of([cos, rotation.ratio * sin, sin / rotation.ratio][which])
                    })
                })
            }));
        }
        (self.table, self.turns) = (table, turns);
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
        Some((0..self.of_cell.len()).map(|cell| self.at(cell, place)).collect())
    }

    /// Sets the values of a field, the first axis running fastest; of those beyond the end of either
    /// nothing happens.
    pub fn set(&mut self, field: Field, values: &[T]) {
        let Some(place) = self.place(field) else { return };
        for (cell, &value) in values.iter().enumerate().take(self.of_cell.len()) {
            *self.at_mut(cell, place) = value;
        }
    }

    /// The value of a field in a cell; `None` if there is no such field or cell.
    pub fn value(&self, field: Field, cell: usize) -> Option<T> {
        (cell < self.of_cell.len()).then_some(())?;
        self.place(field).map(|place| self.at(cell, place))
    }

    /// The first value that is not finite: its field and its cell.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let is_broken = |cell: &usize| {
            (0..self.fields().len()).find(|&place| !self.at(*cell, place).wide().is_finite())
        };
        let cell = (0..self.of_cell.len()).find(|cell| is_broken(cell).is_some())?;
        is_broken(&cell).map(|place| (self.fields()[place], cell))
    }

    fn place(&self, field: Field) -> Option<usize> {
        self.fields().iter().position(|own| *own == field)
    }

    /// Group and lane of a value.
    #[inline(always)]
    fn slot(&self, cell: usize, place: usize) -> (usize, usize) {
        let length = self.grid.cells[0];
        let (row, x) = (cell / length, cell % length);
        let group = row * self.groups + x / T::Lanes::COUNT;
        (group * self.fields().len() + place, x % T::Lanes::COUNT)
    }

    #[inline(always)]
    fn at(&self, cell: usize, place: usize) -> T {
        let (group, lane) = self.slot(cell, place);
        self.data[group].lanes()[lane]
    }

    #[inline(always)]
    fn at_mut(&mut self, cell: usize, place: usize) -> &mut T {
        let (group, lane) = self.slot(cell, place);
        &mut self.data[group].lanes_mut()[lane]
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

    /// Steps done.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Energy of the deviation from the initial stress.
    pub fn energy(&self) -> Energy {
        Energy::sum(&self.energies())
    }

    /// The same by layer across the last axis.
    pub(crate) fn energies(&self) -> Vec<Energy> {
        let (lanes, length, volume) = (T::Lanes::COUNT, self.grid.cells[0], self.grid.volume());
        let rows = self.layer() / length.max(1);
        let fields = self.fields().len();
        // Velocities and spins stand first.
        let velocities = self.fields().iter().filter(|f| self.media[0].inertia(**f) > 0.0).count();
        let mut energies = vec![Energy::default(); self.ledgers.len()];
        for (index, energy) in energies.iter_mut().enumerate() {
            for row in index * rows..(index + 1) * rows {
                for x in 0..length {
                    let group = (row * self.groups + x / lanes) * fields;
                    let group = &self.data[group..group + fields];
                    let value = |place: usize| group[place].lanes()[x % lanes].wide();
                    let medium = usize::from(self.of_cell[row * length + x]);
                    let mut own = Energy::default();
                    for &(one, other, factor) in &self.energy_terms[medium] {
                        let kind =
                            if one < velocities { &mut own.kinetic } else { &mut own.stored };
                        *kind += factor * value(one) * value(other);
                    }
                    energy.kinetic += volume * own.kinetic;
                    energy.stored += volume * own.stored;
                }
            }
        }
        energies
    }

    /// Advances all fields by Δt.
    pub fn advance(&mut self) {
        self.advance_with(&mut |_| {});
    }

    /// The same, with something done before each sweep along the last axis.
    pub(crate) fn advance_with(&mut self, before_last: &mut dyn FnMut(&mut Self)) {
        let is_plastic = !self.dissipated.is_empty();
        let start = self.time();
        if self.steps == 0 {
            self.integrate(0.5);
        }
        self.set_time(start + 0.25 * self.step);
        for axis in 0..D {
            if axis + 1 == D {
                before_last(self);
            }
            self.sweep(axis);
        }
        let middle = start + 0.5 * self.step;
        self.kick([start, middle]);
        if is_plastic && self.scheme.placement == Placement::Middle {
            self.rotate(1);
            self.correct(true);
            self.rotate(1);
        } else {
            self.rotate(0);
        }
        self.steps += 1;
        self.kick([middle, self.time()]);
        self.set_time(start + 0.75 * self.step);
        for axis in (0..D).rev() {
            if axis + 1 == D {
                before_last(self);
            }
            self.sweep(axis);
        }
        if is_plastic && self.scheme.placement == Placement::Last {
            self.correct(false);
        }
        self.integrate(1.0);
        for (total, step) in self.totals.iter_mut().zip(&mut self.ledgers) {
            total.add(std::mem::take(step));
        }
    }

    /// Adds to the integrals in time by the trapezoidal rule.
    fn integrate(&mut self, steps: f64) {
        let mut integrals = std::mem::take(&mut self.integrals);
        for (place, sums) in &mut integrals {
            for (cell, sum) in sums.iter_mut().enumerate() {
                *sum += steps * self.step * self.at(cell, *place).wide();
            }
        }
        self.integrals = integrals;
    }

    /// The integrals in time of the problem in a cell, m or rad.
    pub(crate) fn integrals(&self, cell: usize) -> impl Iterator<Item = f64> {
        let last = 0.5 * self.step;
        let is_under_way = self.steps > 0;
        self.integrals.iter().map(move |(place, sums)| match is_under_way {
            true => sums[cell] - last * self.at(cell, *place).wide(),
            false => 0.0,
        })
    }

    /// What steps added up by cell: dissipation, and the sums of integrals.
    pub(crate) fn sums(&self) -> impl Iterator<Item = &Vec<f64>> {
        [&self.dissipated].into_iter().chain(self.integrals.iter().map(|(_, sums)| sums))
    }

    /// The same, to be set.
    pub(crate) fn sums_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        [&mut self.dissipated].into_iter().chain(self.integrals.iter_mut().map(|(_, sums)| sums))
    }

    /// The domain with its stresses in their yield sets: what is shown of it.
    #[must_use]
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        shown.correct(false);
        shown.ledgers.fill(Ledger::default());
        shown.dissipated.clone_from(&self.dissipated);
        shown
    }

    /// The first cell whose stress is not in its yield set.
    pub(crate) fn first_beyond_yield(&self) -> Option<usize> {
        (0..self.of_cell.len()).find(|&cell| {
            let stress = self.whole_stress(cell);
            self.media[usize::from(self.of_cell[cell])].project(&stress).stress != stress
        })
    }

    /// Appends all fields of a cell as they are shown: the whole stress, the initial one included, in its
    /// yield set. Behind them the integrals of the problem.
    pub fn show(&self, cell: usize, values: &mut Vec<f64>) {
        let medium = &self.media[usize::from(self.of_cell[cell])];
        let stress = medium.project(&self.whole_stress(cell)).stress;
        for (place, field) in self.fields().iter().enumerate() {
            values.push(match component(*field, &stress) {
                Some(value) => value,
                None => self.at(cell, place).wide(),
            });
        }
        values.extend(self.integrals(cell));
    }

    fn set_time(&mut self, time: f64) {
        for side in self.sides.iter_mut().flatten() {
            if let Side::Mirror(mirror) = side {
                mirror.set_time(time);
            }
        }
    }

    /// Sources and gravity over a time.
    fn kick(&mut self, [from, to]: [f64; 2]) {
        let (volume, layer) = (self.grid.volume(), self.layer());
        let kicks = std::mem::take(&mut self.kicks);
        for kick in &kicks {
            let impulse = (kick.signal)(0.5 * (from + to)) * (to - from);
            // Before the beginning there is none: what is there at once comes with the first step.
            let before = if from > 0.0 { (kick.signal)(from) } else { 0.0 };
            let moment = (kick.signal)(to) - before;
            for &(cell, share) in &kick.cells {
                let medium = usize::from(self.of_cell[cell]);
                for &(place, amplitude) in &kick.amplitudes {
                    let inertia = self.media[medium].inertia(self.fields()[place]);
                    let work = if inertia > 0.0 {
                        let change = amplitude * share * impulse / (inertia * volume);
                        self.push(cell, place, change, inertia)
                    } else {
                        let before = self.media[medium].stored_energy(&self.stress(cell));
                        let value =
                            self.at(cell, place).wide() - amplitude * share * moment / volume;
                        *self.at_mut(cell, place) = T::of(value);
                        self.media[medium].stored_energy(&self.stress(cell)) - before
                    };
                    self.ledgers[cell / layer].sources += volume * work;
                }
            }
        }
        self.kicks = kicks;
        for (axis, acceleration) in self.acceleration.into_iter().enumerate() {
            let Some(place) = self.place(Field::Velocity(axis)).filter(|_| acceleration != 0.0)
            else {
                continue;
            };
            let change = acceleration * (to - from);
            for cell in 0..self.of_cell.len() {
                let medium = &self.media[usize::from(self.of_cell[cell])];
                let inertia = medium.inertia(Field::Velocity(axis));
                let work = self.push(cell, place, change, inertia);
                self.ledgers[cell / layer].sources += volume * work;
            }
        }
    }

    /// Adds to a velocity; the energy that it takes, J/m³.
    fn push(&mut self, cell: usize, place: usize, change: f64, inertia: f64) -> f64 {
        let value = self.at_mut(cell, place);
        let before = value.wide();
        *value = T::of(before + change);
        let after = value.wide();
        inertia * (after - before) * 0.5 * (after + before)
    }

    /// The stress in a cell without the initial one.
    fn stress(&self, cell: usize) -> Stress {
        let mut stress = Stress::default();
        for (place, field) in self.fields().iter().enumerate() {
            let value = self.at(cell, place).wide();
            match *field {
                Field::Stress(i, j) => {
                    stress.force[i][j] = value;
                    // One field stands for both in classical solids.
                    if self.turning.is_empty() {
                        stress.force[j][i] = value;
                    }
                }
                Field::Couple(k, j) => stress.couple[k][j] = value,
                Field::Velocity(_) | Field::Spin(_) => {}
            }
        }
        stress
    }

    /// The initial stress in a cell.
    fn initial_stress(&self, cell: usize) -> Stress {
        let Some((axis, layers)) = &self.initial_stress else { return Stress::default() };
        let stride: usize = self.grid.cells[..*axis].iter().product();
        layers[cell / stride % self.grid.cells[*axis]]
    }

    /// The whole stress in a cell, the initial one included.
    pub fn whole_stress(&self, cell: usize) -> Stress {
        combined(&self.stress(cell), &self.initial_stress(cell), 1.0)
    }

    /// P, or with `reflects` 2P − I.
    fn correct(&mut self, reflects: bool) {
        let (volume, layer) = (self.grid.volume(), self.layer());
        let times = if reflects { 2.0 } else { 1.0 };
        for cell in 0..self.of_cell.len() {
            let medium = &self.media[usize::from(self.of_cell[cell])];
            if medium.yields.is_none() {
                continue;
            }
            let initial = self.initial_stress(cell);
            let trial = combined(&self.stress(cell), &initial, 1.0);
            let corrected = medium.project(&trial);
            if corrected.stress == trial {
                continue;
            }
            let plastic = combined(&trial, &corrected.stress, -1.0);
            let energy = |stress: &Stress| medium.stored_energy(stress);
            // ½|s̄|² − ½|2s − s̄|² = 2(½|s̄|² − ½|s|² − ½|s̄ − s|²).
            let beyond = if reflects { energy(&plastic) } else { 0.0 };
            let loss = times * (corrected.energy_lost - beyond);
            let released = match &self.initial_stress {
                // The product of both in the energy.
                Some(_) => {
                    let both = combined(&plastic, &initial, 1.0);
                    times * (energy(&both) - energy(&plastic) - energy(&initial))
                }
                None => 0.0,
            };
            let share = loss / energy(&trial).max(f64::MIN_POSITIVE);
            debug_assert!(
                share >= -1e-14,
                "the correction adds energy: {share:e} of what is there"
            );
            let ledger = &mut self.ledgers[cell / layer];
            ledger.plastic += volume * loss;
            ledger.released += volume * released;
            ledger.least_plastic = ledger.least_plastic.min(share);
            self.dissipated[cell] += loss;
            for place in 0..self.fields().len() {
                let of = |stress: &Stress| component(self.fields()[place], stress);
                let (Some(own), Some(plastic)) = (of(&corrected.stress), of(&plastic)) else {
                    continue;
                };
                let moved = if reflects { own - plastic } else { own };
                let moved = moved - of(&initial).unwrap_or(0.0);
                *self.at_mut(cell, place) = T::of(moved);
            }
        }
    }

    /// Spins against antisymmetric stress, over a whole step (0) or a half (1).
    fn rotate(&mut self, part: usize) {
        let fields = self.fields().len();
        self.instructions.run(Rotate {
            data: &mut self.data,
            fields,
            patterns: &self.patterns,
            turns: &self.turns,
            turning: &self.turning,
            part,
        });
    }
}

/// a + factor·b.
fn combined(a: &Stress, b: &Stress, factor: f64) -> Stress {
    let part = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
    };
    Stress { force: part(a.force, b.force), couple: part(a.couple, b.couple) }
}

/// Q on all groups.
struct Rotate<'a, N> {
    data: &'a mut [N],
    fields: usize,
    patterns: &'a [u32],
    turns: &'a [[Turn<N>; 2]],
    turning: &'a [[usize; 3]],
    part: usize,
}

impl<N: Number> Work for Rotate<'_, N> {
    #[inline(always)]
    fn run(self) {
        for (group, &pattern) in self.data.chunks_exact_mut(self.fields).zip(self.patterns) {
            let [cos, ratio_sin, sin_over_ratio] = self.turns[pattern as usize][self.part];
            for &[spin, first, second] in self.turning {
                let [omega, a, b] = [group[spin], group[first], group[second]];
                let half = N::HALF * (a - b);
                let turned = half * cos + ratio_sin * omega - half;
                group[spin] = omega * cos - half * sin_over_ratio;
                group[first] = a + turned;
                group[second] = b - turned;
            }
        }
    }
}

/// What crosses cuts.
impl<T: Real, const D: usize> Domain<T, D> {
    /// The outermost layers towards both ends of the last axis: what the sweeps along it read.
    pub(crate) fn outermost(&self, send: &mut [Vec<T::Lanes>; 2]) {
        let (fields, layers) = (self.fields().len(), self.ledgers.len());
        let rows = self.layer() / self.grid.cells[0].max(1);
        for (end, send) in send.iter_mut().enumerate() {
            send.clear();
            if !matches!(self.sides[D - 1][end], Side::Cut) {
                continue;
            }
            for depth in 0..GHOSTS {
                let layer = if end == 0 { depth } else { layers - 1 - depth };
                for group in layer * rows * self.groups..(layer + 1) * rows * self.groups {
                    for wave in &self.waves[D - 1] {
                        send.push(self.data[group * fields + wave.velocity]);
                        send.push(self.data[group * fields + wave.stress]);
                    }
                }
            }
        }
    }

    /// What stands beyond both cuts, to be set; empty where there is none.
    pub(crate) fn halos_mut(&mut self) -> [&mut [T::Lanes]; 2] {
        self.halos.each_mut().map(|halo| halo.as_flattened_mut())
    }
}
