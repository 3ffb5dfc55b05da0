//! The fused solver: fields on a rectangular grid, and their time step.
//!
//! | file | holds |
//! |---|---|
//! | `step` | **the recipe of a step**: the order of sweeps, sources, rotation, relaxation, return mapping |
//! | `schedule` | wavefront tiling: which rows and layers go through which stage when |
//! | `layout` | where cells and fields stand in memory |
//! | `materials`, `table` | media by lane pattern, constants of waves and energy |
//! | `kernel`, `rows`, `fill` | a sweep of many lines in SIMD lanes; ghosts at the ends of rows and lines |
//! | `sweep` | which lines a sweep takes, and the work at boundaries |
//! | `law`, `local`, `relaxation` | what acts in cells between sweeps: rotation, relaxation, subnormals |
//! | `correct`, `plastic`, `return_mapping`, `whole_stress` | return mapping: dispatch (`correct`); one kind of yield set, no initial stress (`plastic`); Newton's method for total stresses, reflections and mixed sets (`return_mapping`, its constants in `whole_stress`) |
//! | `cell_mapping` | the return mapping in lanes for single cells, for the reference solver |
//! | `curvilinear` | spacing by layer along rows, and the rotation of curved rows |
//! | `sources`, `boundaries` | what acts inside and at the ends |
//! | `interfaces`, `interlayers` | interlayers: their faces and history variables; input and output of these |
//! | `halo` | exchange with the parts beyond a cut |
//! | `complete`, `output`, `diagnostics` | fields at the time of the domain, records, ledger |
//! | `build` | a domain made of a [`Problem`] |
//!
//! The formulas of a sweep are those of [`crate::solid::line`], which applies them one line at a time; here they run over
//! many lines at once. The bits of the fields are the same, for any tiling, number of parts and instruction set, and those of
//! [`Reference`](crate::solid::reference::Reference), which also accounts for the dissipation of the scheme itself.
//!
//! Fields are the deviation from an initial stress in equilibrium: it moves nothing, and yield conditions see the sum.
//!
//! Every 16 steps values below 2⁴⁰ times the least normal number (in single precision 1.3·10⁻²⁶) are flushed to zero,
//! since subnormal arithmetic is slow on many processors and tails of waves would be full of it. The energy removed is
//! not in the ledger.
//!
//! Sums of the ledger are exact, so that they depend on no order; each own cell and face enters them once.
//!
//! Where a domain is cut along another axis, its halo there is exchanged before a pass: see `halo`. Where it is cut, or
//! periodic, along the last axis, it has a halo of [`HALO`](crate::solid::line::HALO) layers for
//! each step of a pass, recomputed redundantly. Block by block of rows, the neighbour does the first x and y sweeps of its
//! outermost layers, then sends them; the lower halo is received before the first layer is loaded, the upper one before
//! the tile that reaches it. The content of a halo after a pass is arbitrary.

mod boundaries;
mod build;
mod cell_mapping;
mod complete;
mod correct;
mod curvilinear;
mod diagnostics;
mod fill;
mod halo;
mod interfaces;
mod interlayers;
mod kernel;
mod law;
mod layout;
mod local;
mod materials;
mod memory;
mod output;
mod plastic;
mod relaxation;
mod return_mapping;
mod rows;
mod schedule;
mod solver_real;
mod sources;
mod step;
mod sweep;
mod table;
mod whole_stress;

pub(crate) use cell_mapping::CellMapping;
pub(crate) use complete::BOUNDARY_LAYER;
pub use halo::HaloExchange;
pub use layout::memory;
pub(crate) use schedule::most_steps;
pub use solver_real::SolverReal;

use crate::simd::{Group, Instructions, Number};
use crate::solid::cell_laws::MOST_FIELDS;
use crate::solid::ledger::{Energy, Ledger, WorkSums};
use crate::solid::problem::{DomainError, Grid, Problem, Scheme};
use boundaries::Boundaries;
use diagnostics::Diagnostics;
use interfaces::Interfaces;
use law::LocalLaws;
use layout::Layout;
use materials::Materials;
use memory::Buffer;
use models::solid::waves::Field;
use schedule::Schedule;
use sources::Sources;

/// Fields and what moves them.
#[derive(Clone)]
pub struct Domain<T: SolverReal, const D: usize> {
    grid: Grid<D>,
    /// Δt, s.
    step: f64,
    scheme: Scheme,
    instructions: Instructions,
    layout: Layout<D>,
    schedule: Schedule,
    materials: Materials<T, D>,
    boundary: Boundaries<T, D>,
    sources: Sources<D>,
    law: LocalLaws<T>,
    /// By row, field and group, behind them ghosts of the lines that are swept.
    data: Vec<T::Lanes>,
    interfaces: Interfaces<T, D>,
    diagnostics: Diagnostics,
    buffer: Buffer<T>,
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// A domain at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>) -> Result<Self, DomainError> {
        problem.check()?;
        let region = problem.uncut_region(1);
        Ok(Self::of_region(&problem.restricted(&region), &region, 1))
    }

    /// Uses other instructions than the best; results do not depend on them.
    pub fn set_instructions(&mut self, instructions: Instructions) {
        self.instructions = instructions;
    }

    /// Maps stresses into their yield sets one by one wherever the projection in lanes is that of one stress: with an
    /// initial stress, as a reflection, or with several kinds of sets. Results do not depend on it.
    #[doc(hidden)]
    pub fn map_stresses_one_by_one(&mut self) {
        self.law.maps_one_by_one = true;
    }

    /// The components of the state.
    pub fn fields(&self) -> &[Field] {
        &self.materials.fields
    }

    /// The grid.
    pub fn grid(&self) -> Grid<D> {
        self.grid
    }

    /// Time, s.
    pub fn time(&self) -> f64 {
        self.schedule.steps as f64 * self.step
    }

    /// The values of a field, the first axis running fastest; `None` if there is no such field.
    pub fn values(&self, field: Field) -> Option<Vec<T>> {
        let place = self.place(field)?;
        Some(self.layout.own_cells().map(|cell| self.at(cell, place)).collect())
    }

    /// Sets the values of a field, the first axis running fastest; of those beyond the end of either
    /// nothing happens.
    pub fn set(&mut self, field: Field, values: &[T]) {
        let Some(place) = self.place(field) else { return };
        let layout = self.layout.clone();
        for (cell, &value) in layout.own_cells().zip(values) {
            *self.at_mut(cell, place) = value;
        }
    }

    /// Sets the values of a field in all cells, those of the halo included, where there are such.
    pub(crate) fn set_all(&mut self, field: Field, value: impl Fn(usize) -> Option<T>) {
        let Some(place) = self.place(field) else { return };
        for cell in 0..self.layout.cells.iter().product() {
            if let Some(value) = value(cell) {
                *self.at_mut(cell, place) = value;
            }
        }
    }

    /// Sets everything to zero, what is no cell included.
    pub(crate) fn clear(&mut self) {
        self.data.fill(T::Lanes::ZERO);
        self.interfaces.memory.fill(T::Lanes::ZERO);
    }

    /// The value of a field in a cell; `None` if there is no such field or cell.
    pub fn value(&self, field: Field, cell: usize) -> Option<T> {
        let cell = (cell < self.grid.count()).then(|| self.layout.own_cell(cell))?;
        self.place(field).map(|place| self.at(cell, place))
    }

    /// The first value that is not finite: its field and its cell; of an interlayer those of the cell behind it.
    pub fn first_non_finite(&self) -> Option<(Field, usize)> {
        let is_broken = |cell: &usize| {
            self.places().find(|(_, place)| !self.at(*cell, *place).wide().is_finite())
        };
        let Some(cell) = self.layout.own_cells().find(|cell| is_broken(cell).is_some()) else {
            return self.first_non_finite_interlayer();
        };
        Some((is_broken(&cell)?.0, self.layout.own_number(cell)?))
    }

    /// All fields, and their places in a row.
    fn places(&self) -> impl Iterator<Item = (Field, usize)> {
        self.fields().iter().copied().zip((0..).step_by(self.layout.pitch))
    }

    fn place(&self, field: Field) -> Option<usize> {
        self.places().find(|own| own.0 == field).map(|own| own.1)
    }

    #[inline(always)]
    fn at(&self, cell: usize, place: usize) -> T {
        let (index, lane) = self.layout.slot(cell);
        self.data[index.data + place].lanes()[lane]
    }

    #[inline(always)]
    fn at_mut(&mut self, cell: usize, place: usize) -> &mut T {
        let (index, lane) = self.layout.slot(cell);
        &mut self.data[index.data + place].lanes_mut()[lane]
    }

    /// What steps did to the energy so far.
    pub fn ledger(&self) -> Ledger {
        self.ledger_sums().ledger(self.grid.volume())
    }

    /// What steps added up over faces and sources.
    pub(crate) fn work(&self) -> &WorkSums {
        &self.diagnostics.work
    }

    /// Takes over steps done and what they added up.
    pub(crate) fn restore_work(&mut self, steps: usize, work: WorkSums) {
        self.schedule.steps = steps;
        self.diagnostics.work = work;
    }

    /// Steps of a pass at most.
    pub fn most_steps(&self) -> usize {
        self.schedule.most_steps
    }

    /// Steps done.
    pub(crate) fn steps(&self) -> usize {
        self.schedule.steps
    }

    /// Energy of the deviation from the initial stress.
    pub fn energy(&self) -> Energy {
        self.energy_sums().energy(self.grid.volume())
    }
}
