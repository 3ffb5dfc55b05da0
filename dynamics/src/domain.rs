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
//! fields. Sweeps run over many lines at once ([`crate::kernel`]); with [`Detail::Full`] they run
//! line by line ([`crate::line`]) and keep the account of the scheme's own dissipation. The bits of
//! the fields are the same.

use crate::boundary::{Boundary, Condition, Load, Signal, Source};
use crate::kernel::{Axis, Carried, Columns, Instructions, Rows, Table, Wave, Work};
use crate::line::{self, Account, Cell, GHOSTS, Slopes, State};
use crate::medium::Medium;
use crate::real::{Group, Number, Real};
use models::cosserat::stress::Stress;
use models::cosserat::waves::Field;
use std::collections::HashMap;
use std::ops::Range;

/// A rectangular grid of `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    /// Cells along each axis.
    pub cells: [usize; D],
    /// Edges of a cell, m.
    pub spacing: [f64; D],
}

impl<const D: usize> Grid<D> {
    /// Cells in all.
    pub fn count(&self) -> usize {
        self.cells.iter().product()
    }

    /// Volume of a cell, m³; in plane strain of a slice of unit thickness.
    pub fn volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Faces of a side across `axis`.
    pub fn faces(&self, axis: usize) -> usize {
        self.count() / self.cells[axis].max(1)
    }
}

/// Where the correction stands in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placement {
    /// P after the elastic step: first order, and the state always in its set.
    Last,
    /// 2P − I between the halves of the elastic step: second order while the same conditions stay active.
    /// The state is in its set in the middle of steps; [`Domain::admissible`] is what to look at.
    #[default]
    Middle,
}

/// How much of the energy is accounted for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Detail {
    /// All but the dissipation of the scheme.
    #[default]
    Light,
    /// That of the scheme as well, from the pieces in every cell and sweep: many times slower.
    Full,
}

/// The choices of the scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// How waves are reconstructed.
    pub slopes: Slopes,
    /// Where the correction stands.
    pub placement: Placement,
    /// What the ledger holds.
    pub detail: Detail,
}

impl Scheme {
    /// A scheme with a light ledger.
    pub fn new(slopes: Slopes, placement: Placement) -> Self {
        Self { slopes, placement, detail: Detail::Light }
    }
}

/// What is to be solved.
#[derive(Clone)]
pub struct Problem<const D: usize> {
    /// The grid.
    pub grid: Grid<D>,
    /// The media: all of the same fields.
    pub media: Vec<Medium>,
    /// Medium of each cell, the first axis running fastest.
    pub of_cell: Vec<u16>,
    /// What lies beyond the sides: by axis, then by end.
    pub boundaries: [[Boundary; 2]; D],
    /// Time step Δt, s.
    pub step: f64,
    /// The choices of the scheme.
    pub scheme: Scheme,
    /// What sides are given in the course of time.
    pub loads: Vec<Load>,
    /// What acts inside.
    pub sources: Vec<Source>,
    /// Acceleration that acts on all cells, m/s².
    pub acceleration: [f64; D],
    /// An initial stress in equilibrium: an axis, and the stress in each layer across it; or none.
    pub initial_stress: Option<(usize, Vec<Stress>)>,
}

impl<const D: usize> Problem<D> {
    /// A problem without loads, sources or initial stress.
    pub fn new(
        grid: Grid<D>,
        media: Vec<Medium>,
        of_cell: Vec<u16>,
        boundaries: [[Boundary; 2]; D],
        step: f64,
        scheme: Scheme,
    ) -> Self {
        Self {
            grid,
            media,
            of_cell,
            boundaries,
            step,
            scheme,
            loads: Vec::new(),
            sources: Vec::new(),
            acceleration: [0.0; D],
            initial_stress: None,
        }
    }

    /// Looks whether it can be solved.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn check(&self) -> Result<(), DomainError> {
        let needed = self.grid.count();
        if self.of_cell.len() != needed {
            return Err(DomainError::Cells { found: self.of_cell.len(), needed });
        }
        let Some(first) = self.media.first() else { return Err(DomainError::Media) };
        if self.media.iter().any(|medium| medium.fields != first.fields) {
            return Err(DomainError::Media);
        }
        let count = self.media.len();
        if let Some(cell) = self.of_cell.iter().position(|&m| usize::from(m) >= count) {
            let medium = usize::from(self.of_cell[cell]);
            return Err(DomainError::NoSuchMedium { cell, medium, count });
        }
        for (axis, sides) in self.boundaries.iter().enumerate() {
            let speeds = self.media.iter().flat_map(|m| &m.pairs[axis]).map(|pair| pair.speed());
            let courant = 0.5 * self.step * speeds.fold(0.0, f64::max) / self.grid.spacing[axis];
            // A step that was computed from the Courant number may miss it by rounding.
            if courant.is_nan() || courant > 1.0 + 4.0 * f64::EPSILON {
                return Err(DomainError::Courant { axis, courant });
            }
            for side in sides {
                let found = match side {
                    Boundary::Given(conditions) => conditions.len(),
                    Boundary::ByFace(conditions)
                        if conditions.iter().any(|own| own.len() != self.grid.faces(axis)) =>
                    {
                        0
                    }
                    Boundary::ByFace(conditions) => conditions.len(),
                    _ => continue,
                };
                let needed = first.pairs[axis].len();
                if found != needed {
                    return Err(DomainError::Conditions { axis, found, needed });
                }
            }
            let [one, other] = sides.each_ref().map(|side| *side == Boundary::Periodic);
            if one != other {
                return Err(DomainError::Periodic(axis));
            }
        }
        self.check_actions()
    }

    /// That loads, sources and the initial stress have their places.
    fn check_actions(&self) -> Result<(), DomainError> {
        let is_lost = |load: &Load| {
            load.axis >= D
                || load.end > 1
                || load.pair >= self.media[0].pairs[load.axis].len()
                || load.faces.iter().any(|&(face, _)| face >= self.grid.faces(load.axis))
                || self.boundaries[load.axis][load.end] == Boundary::Periodic
        };
        if let Some(index) = self.loads.iter().position(is_lost) {
            return Err(DomainError::Load(index));
        }
        let fields = &self.media[0].fields;
        let is_lost = |source: &Source| {
            source.cells.iter().any(|&(cell, _)| cell >= self.of_cell.len())
                || source.amplitudes.iter().any(|(field, _)| !fields.contains(field))
        };
        if let Some(index) = self.sources.iter().position(is_lost) {
            return Err(DomainError::Source(index));
        }
        match &self.initial_stress {
            Some((axis, stress)) if self.grid.cells.get(*axis) != Some(&stress.len()) => {
                Err(DomainError::InitialStress)
            }
            _ => Ok(()),
        }
    }
}

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

/// What steps do to the energy, J (in plane strain of a slice of unit thickness).
///
/// Energy after − energy before = inflow + sources + released − plastic − numerical: none is what the
/// others leave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work at the sides, positive inwards.
    pub inflow: f64,
    /// Work of sources and gravity.
    pub sources: f64,
    /// Work of the initial stress on plastic strain.
    pub released: f64,
    /// Plastic dissipation.
    pub plastic: f64,
    /// Variance that reconstruction adds; see [`Account`]. Zero where the ledger is light.
    pub gained: f64,
    /// Variance that averaging takes; see [`Account`]. Zero where the ledger is light.
    pub lost: f64,
    /// The least plastic dissipation of a cell in a step, over the energy stored there.
    pub least_plastic: f64,
}

impl Ledger {
    /// Energy that the scheme itself dissipates.
    pub fn numerical(&self) -> f64 {
        self.lost - self.gained
    }

    /// What all terms together do to the energy.
    pub fn change(&self) -> f64 {
        self.inflow + self.sources + self.released - self.plastic - self.numerical()
    }

    /// Each term of both.
    fn with(self, other: Self, term: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            inflow: term(self.inflow, other.inflow),
            sources: term(self.sources, other.sources),
            released: term(self.released, other.released),
            plastic: term(self.plastic, other.plastic),
            gained: term(self.gained, other.gained),
            lost: term(self.lost, other.lost),
            least_plastic: self.least_plastic.min(other.least_plastic),
        }
    }
}

/// Sums over many steps, whose terms may be a thousand times the energy there is: each with what its last
/// digit could not hold (Kahan 1965).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Total {
    sum: Ledger,
    rest: Ledger,
}

impl Total {
    fn add(&mut self, step: Ledger) {
        let term = step.with(self.rest, |new, rest| new + rest);
        let sum = self.sum.with(term, |sum, new| sum + new);
        let added = sum.with(self.sum, |sum, before| sum - before);
        (self.sum, self.rest) = (sum, term.with(added, |new, added| new - added));
    }

    /// The sum of totals in their order.
    pub(crate) fn sum<'a>(totals: impl IntoIterator<Item = &'a Self>) -> Ledger {
        let mut all = Self::default();
        for own in totals {
            all.add(own.sum);
            all.add(own.rest);
        }
        all.sum
    }
}

/// Energy of the deviation from the initial stress, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Energy {
    /// Of motion and spin.
    pub kinetic: f64,
    /// Of the stress.
    pub stored: f64,
}

impl Energy {
    /// Both.
    pub fn total(&self) -> f64 {
        self.kinetic + self.stored
    }

    /// The sum of energies in their order.
    pub fn sum<'a>(energies: impl IntoIterator<Item = &'a Self>) -> Self {
        energies.into_iter().fold(Self::default(), |sum, own| Self {
            kinetic: sum.kinetic + own.kinetic,
            stored: sum.stored + own.stored,
        })
    }
}

/// A domain that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// Media of different theories, or none at all.
    #[error("all media of a domain must have the same fields, and there must be one")]
    Media,
    /// A cell whose medium is not in the list.
    #[error("cell {cell} has medium {medium}, of {count}")]
    NoSuchMedium {
        /// The cell.
        cell: usize,
        /// Its medium.
        medium: usize,
        /// How many there are.
        count: usize,
    },
    /// As many media as cells are needed.
    #[error("{found} cells have a medium, of {needed}")]
    Cells {
        /// Cells given.
        found: usize,
        /// Cells of the grid.
        needed: usize,
    },
    /// A step that is too long: the scheme would be unstable.
    #[error("Courant number {courant} along axis {axis}: at most 1 is stable")]
    Courant {
        /// The axis, from 0.
        axis: usize,
        /// c(Δt/2)/h.
        courant: f64,
    },
    /// As many conditions as pairs are needed, and by face as many as faces.
    #[error("axis {axis}: {found} conditions are given for {needed} pairs of waves")]
    Conditions {
        /// The axis, from 0.
        axis: usize,
        /// Conditions given.
        found: usize,
        /// Pairs of the axis.
        needed: usize,
    },
    /// A load on faces or pairs that are not there, or on a periodic side.
    #[error("load {0} acts on a side, a pair or a face that is not there")]
    Load(usize),
    /// A source on cells or fields that are not there.
    #[error("source {0} acts on a cell or a field that is not there")]
    Source(usize),
    /// As many initial stresses as layers are needed.
    #[error("an initial stress is needed for every layer across its axis")]
    InitialStress,
    /// Parts that are too many or none.
    #[error(
        "{found} parts: at least 1, and {GHOSTS} cells along the last axis in each, of {cells}"
    )]
    Parts {
        /// Parts asked for.
        found: usize,
        /// Cells along the last axis.
        cells: usize,
    },
    /// A periodic side whose opposite is not.
    #[error("both sides of axis {0} must be periodic, or neither")]
    Periodic(usize),
}

/// What lies beyond a side, ready for the sweeps.
#[derive(Clone)]
enum Side<T: Real> {
    /// The opposite side.
    Periodic,
    /// Another part of the same domain.
    Cut,
    /// A mirror: ghosts are (±v + a, ±s + b), or nothing.
    Mirror(Mirror<T>),
}

/// Signs and shifts by pair and face.
#[derive(Clone)]
struct Mirror<T: Real> {
    /// Sign of v, shift of v, sign of s, shift of s.
    by_face: Vec<[T; 4]>,
    /// Faces of a pair.
    faces: usize,
    loads: Vec<SideLoad>,
    /// Whether work may be done here.
    works: bool,
}

#[derive(Clone)]
struct SideLoad {
    /// Places in `by_face`, which of the four, and twice the amplitude.
    entries: Vec<(usize, usize, f64)>,
    /// The same places without any load.
    bases: Vec<f64>,
    signal: Signal,
}

impl<T: Real> Mirror<T> {
    fn new(boundary: &Boundary, pairs: usize, faces: Range<usize>) -> Self {
        let entry = |condition| match condition {
            Some(Condition::Velocity(given)) => [-1.0, 2.0 * given, 1.0, 0.0],
            Some(Condition::Traction(given)) => [1.0, 0.0, -1.0, 2.0 * given],
            Some(Condition::NonReflecting) | None => [0.0; 4],
        };
        let by_face: Vec<[f64; 4]> = (0..pairs)
            .flat_map(|pair| faces.clone().map(move |face| (pair, face)))
            .map(|(pair, face)| entry(boundary.condition(pair, face)))
            .collect();
        let works = by_face.iter().any(|e| e[0] == 0.0 || e[1] != 0.0 || e[3] != 0.0);
        let by_face = by_face.into_iter().map(|entry| entry.map(T::of)).collect();
        Self { by_face, faces: faces.len(), loads: Vec::new(), works }
    }

    /// Adds a load on faces counted from `first`; on faces of open sides there is nothing to be given.
    fn add(&mut self, load: &Load, first: usize) {
        let mut entries = Vec::new();
        for &(face, amplitude) in &load.faces {
            let Some(own) = face.checked_sub(first).filter(|own| *own < self.faces) else {
                continue;
            };
            let place = load.pair * self.faces + own;
            match self.by_face[place].map(T::wide) {
                [sign, ..] if sign < 0.0 => entries.push((place, 1, 2.0 * amplitude)),
                [sign, ..] if sign > 0.0 => entries.push((place, 3, 2.0 * amplitude)),
                _ => {}
            }
        }
        if !entries.is_empty() {
            let bases = entries.iter().map(|&(place, which, _)| self.by_face[place][which].wide());
            let (bases, signal) = (bases.collect(), load.signal.clone());
            self.loads.push(SideLoad { entries, bases, signal });
            self.works = true;
        }
    }

    /// The shifts at a time.
    fn set_time(&mut self, time: f64) {
        for load in &self.loads {
            for (&(place, which, _), &base) in load.entries.iter().zip(&load.bases) {
                self.by_face[place][which] = T::of(base);
            }
        }
        for load in &self.loads {
            let value = (load.signal)(time);
            for &(place, which, amplitude) in &load.entries {
                self.by_face[place][which] = self.by_face[place][which] + T::of(amplitude * value);
            }
        }
    }

    /// The ghost of a cell.
    #[inline(always)]
    fn ghost(&self, pair: usize, face: usize, own: State<T>) -> State<T> {
        let [v, a, s, b] = self.by_face[pair * self.faces + face];
        State { velocity: v * own.velocity + a, stress: s * own.stress + b }
    }
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

    /// Energy of the deviation from the initial stress.
    pub fn energy(&self) -> Energy {
        Energy::sum(&self.energies())
    }

    /// The same by layer across the last axis.
    pub(crate) fn energies(&self) -> Vec<Energy> {
        let (layer, volume) = (self.layer(), self.grid.volume());
        let velocities = self.fields().iter().filter(|f| self.media[0].inertia(**f) > 0.0).count();
        let mut energies = vec![Energy::default(); self.ledgers.len()];
        for (index, energy) in energies.iter_mut().enumerate() {
            for cell in index * layer..(index + 1) * layer {
                for &(one, other, factor) in &self.energy_terms[usize::from(self.of_cell[cell])] {
                    let term = factor * self.at(cell, one).wide() * self.at(cell, other).wide();
                    // Velocities and spins stand first.
                    let kind =
                        if one < velocities { &mut energy.kinetic } else { &mut energy.stored };
                    *kind += volume * term;
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
        let is_plastic = self.media.iter().any(|medium| medium.yields.is_some());
        let start = self.time();
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
        for (total, step) in self.totals.iter_mut().zip(&mut self.ledgers) {
            total.add(std::mem::take(step));
        }
    }

    /// The domain with its stresses in their yield sets: what is shown of it.
    #[must_use]
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        shown.correct(false);
        shown.ledgers.fill(Ledger::default());
        shown
    }

    /// Appends all fields of a cell as they are shown: the whole stress, the initial one included, in its
    /// yield set.
    pub fn show(&self, cell: usize, values: &mut Vec<f64>) {
        let medium = &self.media[usize::from(self.of_cell[cell])];
        let stress = medium.project(&self.whole_stress(cell)).stress;
        for (place, field) in self.fields().iter().enumerate() {
            values.push(match component(*field, &stress) {
                Some(value) => value,
                None => self.at(cell, place).wide(),
            });
        }
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
            let moment = (kick.signal)(to) - (kick.signal)(from);
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

/// The component of a stress that a field is.
fn component(field: Field, stress: &Stress) -> Option<f64> {
    match field {
        Field::Stress(i, j) => Some(stress.force[i][j]),
        Field::Couple(k, j) => Some(stress.couple[k][j]),
        Field::Velocity(_) | Field::Spin(_) => None,
    }
}

/// a + factor·b.
fn combined(a: &Stress, b: &Stress, factor: f64) -> Stress {
    let part = |a: [[f64; 3]; 3], b: [[f64; 3]; 3]| -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| a[i][j] + factor * b[i][j]))
    };
    Stress { force: part(a.force, b.force), couple: part(a.couple, b.couple) }
}

/// The energy density as products of fields: what the energies of one and of two components tell.
fn energy_terms(medium: &Medium) -> Vec<(usize, usize, f64)> {
    let fields = &medium.fields;
    let stress = |places: &[usize]| {
        let mut stress = Stress::default();
        for &place in places {
            match fields[place] {
                Field::Stress(i, j) => {
                    stress.force[i][j] = 1.0;
                    if medium.rotation.is_none() {
                        stress.force[j][i] = 1.0;
                    }
                }
                Field::Couple(k, j) => stress.couple[k][j] = 1.0,
                Field::Velocity(_) | Field::Spin(_) => {}
            }
        }
        medium.stored_energy(&stress)
    };
    let mut terms = Vec::new();
    for (one, &field) in fields.iter().enumerate() {
        let inertia = medium.inertia(field);
        let own = if inertia > 0.0 { 0.5 * inertia } else { stress(&[one]) };
        terms.push((one, one, own));
        for other in 0..one {
            let product = stress(&[one, other]) - own - stress(&[other]);
            if inertia == 0.0 && product.abs() > 1e-14 * own {
                terms.push((one, other, product));
            }
        }
    }
    terms.retain(|term| term.2 != 0.0);
    terms
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
    fn sweep(&mut self, axis: usize) {
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
                        Side::Mirror(mirror) => mirror.ghost(pair, row, own(self, from_end(end))),
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
                                    let own = State { velocity, stress };
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

/// What crosses cuts.
impl<T: Real, const D: usize> Domain<T, D> {
    /// The outermost layers towards both ends of the last axis: what the sweeps along it read.
    pub(crate) fn outermost(&self, send: &mut [Vec<T::Lanes>; 2]) {
        let (fields, layers) = (self.fields().len(), self.ledgers.len());
        let rows = self.layer() / self.grid.cells[0].max(1);
        for (end, send) in send.iter_mut().enumerate() {
            send.clear();
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
