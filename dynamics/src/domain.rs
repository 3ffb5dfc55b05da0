//! Fields on a rectangular grid, and a step of theirs: plain, one sweep after the other.
//!
//! A step of Δt is two-cyclic (Marchuk 1968; Strang 1968): with x, y, z the sweeps of half a step along the
//! axes and Q the rotation of spins against antisymmetric stress by a whole one,
//!
//! ```text
//! U ← x y z  then  Q  then  z y x.
//! ```
//!
//! Second order, since every factor is; each keeps or lowers the energy at Courant numbers
//! c(Δt/2)/h ≤ 1, and so does the step. Where stresses yield, with the projection P onto the yield set in
//! the norm of the energy, the correction stands either last, or in the middle between two halves of Q as
//! the reflection 2P − I, which no more than P makes a state longer ([`Placement`]).

use crate::line::{self, Account, Cell, GHOSTS, Slopes};
use crate::medium::Medium;
use crate::real::Real;
use models::cosserat::stress::Stress;
use models::cosserat::waves::Field;

/// A rectangular grid of `D` dimensions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid<const D: usize> {
    /// Cells along each axis.
    pub cells: [usize; D],
    /// Edges of a cell, m.
    pub spacing: [f64; D],
}

/// What a side does to a pair of waves that meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Condition {
    /// Velocity (m/s) or spin (rad/s) of the side.
    Velocity(f64),
    /// Traction (Pa) or couple (N/m) on the side: the stress, tension positive, whatever the side.
    Traction(f64),
}

/// What lies beyond a side.
#[derive(Clone, Debug, PartialEq)]
pub enum Boundary {
    /// The opposite side.
    Periodic,
    /// A body that does not move: all velocities and spins vanish.
    Fixed,
    /// Nothing: all tractions and couples vanish.
    Free,
    /// The same at rest without end: waves along the normal leave.
    NonReflecting,
    /// A condition for each pair of the axis, in their order.
    Given(Vec<Condition>),
}

impl Boundary {
    /// A side in which the medium is mirrored along `axis`: displacement along the normal vanishes, and
    /// so do the tractions across it. Spins are mirrored as axial vectors are, those about the normal
    /// unchanged.
    pub fn symmetry(medium: &Medium, axis: usize) -> Self {
        Self::mirror(medium, axis, true)
    }

    /// A side in which the medium is mirrored with the opposite sign.
    pub fn antisymmetry(medium: &Medium, axis: usize) -> Self {
        Self::mirror(medium, axis, false)
    }

    fn mirror(medium: &Medium, axis: usize, is_even: bool) -> Self {
        let condition = |field: Field| {
            let is_odd = match field {
                Field::Velocity(i) => i == axis,
                Field::Spin(k) => k != axis,
                Field::Stress(..) | Field::Couple(..) => false,
            };
            if is_odd == is_even { Condition::Velocity(0.0) } else { Condition::Traction(0.0) }
        };
        Self::Given(medium.pairs[axis].iter().map(|pair| condition(pair.velocity)).collect())
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

/// The choices of the scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scheme {
    /// How waves are reconstructed.
    pub slopes: Slopes,
    /// Where the correction stands.
    pub placement: Placement,
}

/// What steps do to the energy, J (in plane strain of a slice of unit thickness).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ledger {
    /// Work at the sides, positive inwards.
    pub inflow: f64,
    /// Variance that reconstruction adds; see [`Account`].
    pub gained: f64,
    /// Variance that averaging takes; see [`Account`].
    pub lost: f64,
    /// Plastic dissipation.
    pub plastic: f64,
    /// The least plastic dissipation of a cell in a step, over the energy stored there.
    pub least_plastic: f64,
}

impl Ledger {
    /// Energy that the scheme itself dissipates.
    pub fn numerical(&self) -> f64 {
        self.lost - self.gained
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
    /// As many conditions as pairs are needed.
    #[error("axis {axis}: {found} conditions are given for {needed} pairs of waves")]
    Conditions {
        /// The axis, from 0.
        axis: usize,
        /// Conditions given.
        found: usize,
        /// Pairs of the axis.
        needed: usize,
    },
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

/// Fields and what moves them.
#[derive(Clone, Debug)]
pub struct Domain<T, const D: usize> {
    grid: Grid<D>,
    media: Vec<Medium>,
    /// Medium of each cell, the first axis running fastest.
    of_cell: Vec<u16>,
    boundaries: [[Boundary; 2]; D],
    /// Time step Δt, s.
    step: f64,
    scheme: Scheme,
    /// Values by field, then by cell.
    state: Vec<Vec<T>>,
    buffer: Buffer<T>,
}

/// A line with its ghosts.
#[derive(Clone, Debug)]
struct Buffer<T> {
    velocity: Vec<T>,
    stress: Vec<T>,
    before: Vec<T>,
    cells: Vec<Cell<T>>,
}

impl<T: Real, const D: usize> Domain<T, D> {
    /// A domain at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(
        grid: Grid<D>,
        media: Vec<Medium>,
        of_cell: Vec<u16>,
        boundaries: [[Boundary; 2]; D],
        step: f64,
        scheme: Scheme,
    ) -> Result<Self, DomainError> {
        let needed: usize = grid.cells.iter().product();
        if of_cell.len() != needed {
            return Err(DomainError::Cells { found: of_cell.len(), needed });
        }
        let Some(first) = media.first() else { return Err(DomainError::Media) };
        let fields = first.fields.clone();
        if media.iter().any(|medium| medium.fields != fields) {
            return Err(DomainError::Media);
        }
        if let Some(cell) = of_cell.iter().position(|&m| usize::from(m) >= media.len()) {
            let medium = usize::from(of_cell[cell]);
            return Err(DomainError::NoSuchMedium { cell, medium, count: media.len() });
        }
        for (axis, sides) in boundaries.iter().enumerate() {
            let speeds = media.iter().flat_map(|m| &m.pairs[axis]).map(|pair| pair.speed());
            let courant = 0.5 * step * speeds.fold(0.0, f64::max) / grid.spacing[axis];
            // A step that was computed from the Courant number may miss it by rounding.
            if courant.is_nan() || courant > 1.0 + 4.0 * f64::EPSILON {
                return Err(DomainError::Courant { axis, courant });
            }
            let needed = media[0].pairs[axis].len();
            for side in sides {
                if let Boundary::Given(conditions) = side
                    && conditions.len() != needed
                {
                    return Err(DomainError::Conditions { axis, found: conditions.len(), needed });
                }
            }
            let [one, other] = sides.each_ref().map(|side| *side == Boundary::Periodic);
            if one != other {
                return Err(DomainError::Periodic(axis));
            }
        }
        let longest = grid.cells.iter().copied().max().unwrap_or(0) + 2 * GHOSTS;
        let at_rest = Cell { impedance: T::ONE, courant: T::ZERO };
        let buffer = Buffer {
            velocity: vec![T::ZERO; longest],
            stress: vec![T::ZERO; longest],
            before: vec![T::ZERO; longest],
            cells: vec![at_rest; longest],
        };
        let state = vec![vec![T::ZERO; needed]; fields.len()];
        Ok(Self { grid, media, of_cell, boundaries, step, scheme, state, buffer })
    }

    /// Values by field, then by cell.
    pub(crate) fn state(&self) -> &[Vec<T>] {
        &self.state
    }

    /// The same, to be set.
    pub(crate) fn state_mut(&mut self) -> &mut [Vec<T>] {
        &mut self.state
    }

    /// The components of the state.
    pub fn fields(&self) -> &[Field] {
        &self.media[0].fields
    }

    /// The values of a field, the first axis running fastest; `None` if there is no such field.
    pub fn values(&self, field: Field) -> Option<&[T]> {
        self.place(field).map(|place| self.state[place].as_slice())
    }

    /// The values of a field, to be set.
    pub fn values_mut(&mut self, field: Field) -> Option<&mut [T]> {
        self.place(field).map(|place| self.state[place].as_mut_slice())
    }

    fn place(&self, field: Field) -> Option<usize> {
        self.fields().iter().position(|own| *own == field)
    }

    /// Advances all fields by Δt, and keeps the ledger of the energy if there is one.
    pub fn advance(&mut self, ledger: Option<&mut Ledger>) {
        self.advance_with(&mut |_| {}, ledger);
    }

    /// The same, with something done before each sweep along the last axis.
    pub(crate) fn advance_with(
        &mut self,
        before_last: &mut dyn FnMut(&mut Self),
        mut ledger: Option<&mut Ledger>,
    ) {
        let is_plastic = self.media.iter().any(|medium| medium.correction.is_some());
        for axis in 0..D {
            if axis + 1 == D {
                before_last(self);
            }
            self.sweep(axis, ledger.as_deref_mut());
        }
        if is_plastic && self.scheme.placement == Placement::Middle {
            self.rotate(0.5);
            self.correct(true, ledger.as_deref_mut());
            self.rotate(0.5);
        } else {
            self.rotate(1.0);
        }
        for axis in (0..D).rev() {
            if axis + 1 == D {
                before_last(self);
            }
            self.sweep(axis, ledger.as_deref_mut());
        }
        if is_plastic && self.scheme.placement == Placement::Last {
            self.correct(false, ledger);
        }
    }

    /// The domain with its stresses in their yield sets: what is shown of it.
    pub fn admissible(&self) -> Self {
        let mut shown = self.clone();
        shown.correct(false, None);
        shown
    }

    /// The stress in a cell.
    fn stress(&self, cell: usize) -> Stress {
        let mut stress = Stress::default();
        for (field, values) in self.fields().iter().zip(&self.state) {
            let value = values[cell].wide();
            match *field {
                Field::Stress(i, j) => {
                    stress.force[i][j] = value;
                    // One field stands for both in classical solids.
                    if self.place(Field::Stress(j, i)).is_none() {
                        stress.force[j][i] = value;
                    }
                }
                Field::Couple(k, j) => stress.couple[k][j] = value,
                Field::Velocity(_) | Field::Spin(_) => {}
            }
        }
        stress
    }

    /// P, or with `reflects` 2P − I.
    fn correct(&mut self, reflects: bool, mut ledger: Option<&mut Ledger>) {
        let volume: f64 = self.grid.spacing.iter().product();
        let fields = self.fields().to_vec();
        for cell in 0..self.of_cell.len() {
            let medium = &self.media[usize::from(self.of_cell[cell])];
            let Some(correction) = medium.correction else { continue };
            let trial = self.stress(cell);
            let corrected = correction.project(&trial);
            if corrected.stress == trial {
                continue;
            }
            for (field, values) in fields.iter().zip(&mut self.state) {
                let (trial, projected) = match *field {
                    Field::Stress(i, j) => (trial.force[i][j], corrected.stress.force[i][j]),
                    Field::Couple(k, j) => (trial.couple[k][j], corrected.stress.couple[k][j]),
                    Field::Velocity(_) | Field::Spin(_) => continue,
                };
                let moved = if reflects { projected + (projected - trial) } else { projected };
                values[cell] = T::of(moved);
            }
            if let Some(ledger) = ledger.as_deref_mut() {
                // ½|s̄|² − ½|2s − s̄|² = 2s·(s̄ − s) = 2(energy lost − energy of the difference).
                let loss = match reflects {
                    true => 2.0 * (corrected.energy_lost - corrected.distance),
                    false => corrected.energy_lost,
                };
                ledger.plastic += volume * loss;
                let stored = corrected.energy_lost.max(f64::MIN_POSITIVE);
                ledger.least_plastic = ledger.least_plastic.min(loss / stored);
            }
        }
    }

    /// Half a step along an axis.
    fn sweep(&mut self, axis: usize, mut ledger: Option<&mut Ledger>) {
        let length = self.grid.cells[axis];
        let stride: usize = self.grid.cells[..axis].iter().product();
        let lines = self.of_cell.len() / length.max(1);
        // A face times the time of the sweep: the account is a power per area.
        let volume: f64 = self.grid.spacing.iter().product();
        let unit = volume / self.grid.spacing[axis] * 0.5 * self.step;
        for line in 0..lines {
            let start = line / stride * stride * length + line % stride;
            for pair in 0..self.media[0].pairs[axis].len() {
                let mut own = ledger.is_some().then(Account::default);
                self.sweep_line(axis, start, stride, pair, own.as_mut());
                if let (Some(ledger), Some(own)) = (ledger.as_deref_mut(), own) {
                    ledger.inflow += unit * own.inflow;
                    ledger.gained += unit * own.gained;
                    ledger.lost += unit * own.lost;
                }
            }
        }
    }

    fn sweep_line(
        &mut self,
        axis: usize,
        start: usize,
        stride: usize,
        pair: usize,
        account: Option<&mut Account>,
    ) {
        let length = self.grid.cells[axis];
        let waves = &self.media[0].pairs[axis][pair];
        let places = [waves.velocity, waves.stress].map(|field| self.place(field));
        let [Some(velocity), Some(stress)] = places else { return };
        let ratio = 0.5 * self.step / self.grid.spacing[axis];
        for i in 0..length {
            let cell = start + i * stride;
            let own = &self.media[usize::from(self.of_cell[cell])].pairs[axis][pair];
            self.buffer.velocity[GHOSTS + i] = self.state[velocity][cell];
            self.buffer.stress[GHOSTS + i] = self.state[stress][cell];
            self.buffer.before[i] = self.state[stress][cell];
            self.buffer.cells[GHOSTS + i] = Cell {
                impedance: T::of(own.impedance()),
                courant: T::of((own.speed() * ratio).min(1.0)),
            };
        }
        self.buffer.fill_ghosts(length, &self.boundaries[axis], pair);
        let end = length + 2 * GHOSTS;
        let Buffer { velocity: v, stress: s, cells, .. } = &mut self.buffer;
        line::sweep(&mut v[..end], &mut s[..end], &cells[..end], self.scheme.slopes, account);
        for i in 0..length {
            let cell = start + i * stride;
            self.state[velocity][cell] = v[GHOSTS + i];
            self.state[stress][cell] = s[GHOSTS + i];
        }
        // What follows the stress in a fixed ratio, the medium's own.
        for follower in 0..self.media[0].pairs[axis][pair].followers.len() {
            for i in 0..length {
                let cell = start + i * stride;
                let medium = usize::from(self.of_cell[cell]);
                let (field, ratio) = self.media[medium].pairs[axis][pair].followers[follower];
                if let Some(place) = self.place(field) {
                    let change = self.buffer.stress[GHOSTS + i] - self.buffer.before[i];
                    self.state[place][cell] += T::of(ratio) * change;
                }
            }
        }
    }

    /// Spins against antisymmetric stress, over a part of a step.
    fn rotate(&mut self, part: f64) {
        for k in 0..3 {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            let places = [Field::Spin(k), Field::Stress(i, j), Field::Stress(j, i)];
            let [Some(spin), Some(first), Some(second)] = places.map(|field| self.place(field))
            else {
                continue;
            };
            for cell in 0..self.of_cell.len() {
                let medium = &self.media[usize::from(self.of_cell[cell])];
                let Some(rotation) = medium.rotation else { continue };
                let (sin, cos) = (rotation.frequency * part * self.step).sin_cos();
                let (sin, cos, ratio) = (T::of(sin), T::of(cos), T::of(rotation.ratio));
                let [a, b] = [self.state[first][cell], self.state[second][cell]];
                let (omega, half) = (self.state[spin][cell], T::HALF * (a - b));
                let turned = half * cos + ratio * omega * sin;
                self.state[spin][cell] = omega * cos - half / ratio * sin;
                self.state[first][cell] = a + (turned - half);
                self.state[second][cell] = b - (turned - half);
            }
        }
    }
}

impl<T: Real> Buffer<T> {
    /// The ghosts beyond both ends of `length` cells: mirror images with one sign turned, or what comes
    /// round.
    fn fill_ghosts(&mut self, length: usize, boundaries: &[Boundary; 2], pair: usize) {
        for (end, boundary) in boundaries.iter().enumerate() {
            for depth in 0..GHOSTS {
                // Counted inwards from the end; lines shorter than the ghosts repeat themselves.
                let depth_inside = depth % length.max(1);
                let inside = |depth: usize| match end {
                    0 => GHOSTS + depth,
                    _ => GHOSTS + length - 1 - depth,
                };
                let ghost = match end {
                    0 => GHOSTS - 1 - depth,
                    _ => GHOSTS + length + depth,
                };
                let source = match boundary {
                    Boundary::Periodic => inside(length - 1 - depth_inside),
                    _ => inside(depth_inside),
                };
                let (v, s) = (self.velocity[source], self.stress[source]);
                (self.velocity[ghost], self.stress[ghost]) = match boundary {
                    Boundary::Periodic => (v, s),
                    Boundary::Fixed => (-v, s),
                    Boundary::Free => (v, -s),
                    Boundary::NonReflecting => (T::ZERO, T::ZERO),
                    Boundary::Given(conditions) => match conditions[pair] {
                        Condition::Velocity(given) => (T::of(2.0 * given) - v, s),
                        Condition::Traction(given) => (v, T::of(2.0 * given) - s),
                    },
                };
                self.cells[ghost] = self.cells[source];
            }
        }
    }
}
