//! Fused solver: fields on a rectangular grid, and their time integration.
//!
//! | file | contents |
//! |---|---|
//! | `step` | **the time step**: order of sweeps, sources, rotation, relaxation, return mapping |
//! | `schedule` | wavefront tiling: order in which rows and layers pass the stages of a step |
//! | `layout` | memory layout of cells and fields |
//! | `materials`, `material_table` | media by lane pattern, wave constants and energy coefficients |
//! | `kernel`, `rows`, `ghost_kernels` | sweep kernel for many lines in SIMD lanes; ghosts of rows and lines |
//! | `sweep` | sweeps by axis and the work done at boundaries |
//! | `idle_axes` | sweeps along axes of one cell, which change the signs of zeros only |
//! | `lane_laws`, `cell_operators`, `relaxation` | operators between sweeps: rotation, relaxation, flushing |
//! | `stress_mapping` | return mapping: dispatch to the following three; scalar formulas: `models::yield_set` |
//! | `plastic` | return mapping without initial stress, for one kind of yield set |
//! | `return_mapping`, `total_stress` | Newton's method for total stresses, reflections and mixed sets; constants |
//! | `cell_mapping` | return mapping of a single cell in SIMD lanes, for the reference solver |
//! | `curvilinear` | cell length along rows by layer, rotation by the curvature of rows |
//! | `sources`, `boundaries` | sources and gravity; boundary conditions |
//! | `interlayer_faces`, `interlayers` | interlayers: faces and history variables; their input and output |
//! | `fluid` | flow of the fluid along saturated interlayers |
//! | `halo` | halo exchange with neighbouring subdomains |
//! | `completion`, `output`, `diagnostics` | state at the time of the domain, output and records, energy ledger |
//! | `build` | construction of a domain from a [`Problem`] |
//!
//! The formulas of a sweep are those of [`crate::solid::line`], which sweeps one line at a time; here sweeps advance
//! many lines at once. Fields are equal bit for bit for any tiling, number of subdomains and instruction set, and equal
//! bit for bit to those of [`Reference`](crate::solid::reference::Reference), which also accounts for the dissipation
//! of the scheme itself.
//!
//! Fields are the deviation from an initial stress in equilibrium, which causes no motion; yield conditions are
//! evaluated for the total stress.
//!
//! Every 16 steps, values of magnitude below 2⁴⁰ times the smallest positive normal number (in single precision
//! 1.3·10⁻²⁶) are flushed to zero, since subnormal arithmetic is slow on many processors and the tails of waves would
//! be subnormal (`flush_subnormals` in `cell_operators`, limit in `cell_laws`). The energy removed is not in the
//! ledger.
//!
//! Sums of the ledger are exact and thus independent of the order of summation; each owned cell and face enters them
//! once.
//!
//! If a domain has neighbouring subdomains along an axis other than the last one, its halo there is exchanged before a
//! pass: see `halo`. If it has neighbours, or is periodic, along the last axis, it has a halo of
//! [`Slopes::halo`](crate::solid::line::Slopes::halo) layers for each step of a pass, which it recomputes redundantly.
//! For each block of rows a subdomain applies the first x and y sweeps to its outermost layers, then sends these layers; the lower
//! halo is received before the first layer is loaded, the upper halo before the first tile that includes it. After a
//! pass the values in the halo are arbitrary.

mod boundaries;
mod buffers;
mod build;
mod cell_mapping;
mod cell_operators;
mod completion;
mod component_offsets;
mod contacts;
mod curvilinear;
mod diagnostics;
mod fluid;
mod ghost_kernels;
mod halo;
mod idle_axes;
mod interlayer_faces;
mod interlayers;
mod kernel;
mod lane_laws;
mod layout;
mod material_table;
mod materials;
mod message_volume;
mod output;
mod plastic;
mod plastic_cone;
mod relaxation;
mod return_mapping;
mod rows;
mod schedule;
mod solver_real;
mod sources;
mod step;
mod stress_mapping;
mod sweep;
mod total_stress;

pub(crate) use cell_mapping::CellMapping;
pub(crate) use completion::{BOUNDARY_LAYER_CELLS, ClosingBoundaries};
pub use halo::HaloExchange;
pub use layout::memory_bytes;
pub(crate) use message_volume::message_volumes;
pub(crate) use schedule::max_pass_steps;
pub use solver_real::SolverReal;

use crate::simd::{InstructionSet, LaneGroup, Number};
use crate::solid::cell_laws::MAX_FIELDS;
use crate::solid::ledger::{Energy, Ledger, WorkSums};
use crate::solid::problem::{DomainError, Grid, Problem, Scheme};
use crate::solid::shear_steps::ShearSteps;
use boundaries::Boundaries;
use buffers::Buffers;
use diagnostics::Diagnostics;
use fluid::FluidStage;
use interlayer_faces::LaneInterlayers;
use lane_laws::LaneLaws;
use layout::Layout;
use materials::Materials;
use models::solid::waves::SolidField;
use schedule::Schedule;
use sources::Sources;

/// Domain or subdomain: fields, materials, boundary conditions and sources, and their time integration.
#[derive(Clone)]
pub struct Domain<T: SolverReal, const D: usize> {
    grid: Grid<D>,
    /// Time step Δt, s.
    step: f64,
    scheme: Scheme,
    /// Whether sweeps along each axis change nothing, see [`Problem::is_idle`].
    is_idle: [bool; D],
    shear_steps: ShearSteps,
    instructions: InstructionSet,
    layout: Layout<D>,
    schedule: Schedule,
    materials: Materials<T, D>,
    boundaries: Boundaries<T, D>,
    sources: Sources<D>,
    lane_laws: LaneLaws<T>,
    /// Field values in order of row, then field, then group of the row; after those of all rows, the ghosts of the
    /// lines that are being swept.
    field_data: Vec<T::Lanes>,
    interfaces: LaneInterlayers<T, D>,
    /// Flow of the fluid in saturated interlayers; `None` if there are none.
    fluid: Option<FluidStage<T>>,
    diagnostics: Diagnostics,
    buffers: Buffers<T>,
}

impl<T: SolverReal, const D: usize> Domain<T, D> {
    /// Creates a domain at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>) -> Result<Self, DomainError> {
        problem.validate()?;
        let region = problem.whole_region(1);
        Self::new_unchecked(&problem.restrict_to(&region), &region, 1)
    }

    /// Sets the instruction set, by default the widest one; results do not depend on it.
    pub fn set_instructions(&mut self, instructions: InstructionSet) {
        self.instructions = instructions;
    }

    /// Selects the scalar return mapping, cell by cell, in place of the mapping in lanes whose results are equal bit
    /// for bit: with initial stress, for reflections, and for several kinds of yield sets.
    #[doc(hidden)]
    pub fn use_scalar_mapping(&mut self) {
        self.lane_laws.uses_scalar_mapping = true;
    }

    /// Returns the fields of the state, in their order.
    pub fn fields(&self) -> &[SolidField] {
        &self.materials.fields
    }

    /// Returns the grid of owned cells.
    pub fn grid(&self) -> Grid<D> {
        self.grid
    }

    /// Returns the time of the present state, s.
    pub fn time(&self) -> f64 {
        self.schedule.steps as f64 * self.step
    }

    /// Returns the values of a field in owned cells, first axis fastest; `None` if there is no such field.
    pub fn values(&self, field: SolidField) -> Option<Vec<T>> {
        let offset = self.field_offset(field)?;
        Some(self.layout.owned_cells().map(|cell| self.value_at(cell, offset)).collect())
    }

    /// Sets the values of a field in owned cells, first axis fastest; excess values are ignored, missing ones leave
    /// cells unchanged.
    pub fn set_field(&mut self, field: SolidField, values: &[T]) {
        let Some(offset) = self.field_offset(field) else { return };
        let layout = self.layout.clone();
        for (cell, &value) in layout.owned_cells().zip(values) {
            *self.value_at_mut(cell, offset) = value;
        }
    }

    /// Sets values of a field in cells, halo included.
    pub(crate) fn set_cells(
        &mut self,
        field: SolidField,
        values: impl Iterator<Item = (usize, T)>,
    ) {
        let Some(offset) = self.field_offset(field) else { return };
        for (cell, value) in values {
            *self.value_at_mut(cell, offset) = value;
        }
    }

    /// Sets all fields to zero, ghosts and padding lanes included, and the history variables of interlayers.
    pub(crate) fn clear(&mut self) {
        self.field_data.fill(T::Lanes::ZERO);
        self.interfaces.history.fill(T::Lanes::ZERO);
    }

    /// Returns the value of a field in a cell, given by its index with halo; `None` if there is no such field or cell.
    pub(crate) fn value_with_halo(&self, field: SolidField, cell: usize) -> Option<T> {
        let offset = self.field_offset(field)?;
        (cell < self.layout.cells.iter().product()).then(|| self.value_at(cell, offset))
    }

    /// Returns the value of a field in an owned cell; `None` if there is no such field or cell.
    pub fn value(&self, field: SolidField, cell: usize) -> Option<T> {
        let cell = (cell < self.grid.count()).then(|| self.layout.local_cell(cell))?;
        self.field_offset(field).map(|offset| self.value_at(cell, offset))
    }

    /// Returns field and owned cell of the first value that is not finite; for an interlayer the cell above the face.
    /// `None` if all values are finite.
    pub fn first_non_finite(&self) -> Option<(SolidField, usize)> {
        let non_finite_field = |cell: &usize| {
            self.field_offsets()
                .find(|(_, offset)| !self.value_at(*cell, *offset).to_f64().is_finite())
        };
        let Some(cell) = self.layout.owned_cells().find(|cell| non_finite_field(cell).is_some())
        else {
            return self.first_non_finite_interlayer();
        };
        Some((non_finite_field(&cell)?.0, self.layout.owned_index(cell)?))
    }

    /// Returns all fields and their offsets in a row, in groups.
    fn field_offsets(&self) -> impl Iterator<Item = (SolidField, usize)> {
        self.fields().iter().copied().zip((0..).step_by(self.layout.pitch))
    }

    /// Returns the offset of a field in a row, in groups; `None` if there is no such field.
    fn field_offset(&self, field: SolidField) -> Option<usize> {
        self.field_offsets().find(|own| own.0 == field).map(|own| own.1)
    }

    #[inline(always)]
    /// Returns the value in a cell, given by its index with halo, of the field with an offset.
    fn value_at(&self, cell: usize, offset: usize) -> T {
        let (index, lane) = self.layout.lane_index(cell);
        self.field_data[index.start + offset].lanes()[lane]
    }

    #[inline(always)]
    fn value_at_mut(&mut self, cell: usize, offset: usize) -> &mut T {
        let (index, lane) = self.layout.lane_index(cell);
        &mut self.field_data[index.start + offset].lanes_mut()[lane]
    }

    /// Returns the energy ledger of all steps so far, J.
    pub fn ledger(&self) -> Ledger {
        self.ledger_sums().to_ledger(self.grid.volume())
    }

    /// Returns the sums of the work at boundaries and of sources, and the smallest dissipation ratio, over all steps so
    /// far.
    pub(crate) fn work(&self) -> &WorkSums {
        &self.diagnostics.work
    }

    /// Restores the number of steps and the work sums, as from a checkpoint.
    pub(crate) fn restore_work(&mut self, steps: usize, work: WorkSums) {
        self.schedule.steps = steps;
        self.diagnostics.work = work;
    }

    /// Returns the largest number of steps of a pass.
    pub fn max_pass_steps(&self) -> usize {
        self.schedule.max_pass_steps
    }

    /// Returns the number of completed steps.
    pub(crate) fn steps(&self) -> usize {
        self.schedule.steps
    }

    /// Returns the energy of the deviation from the initial stress, J.
    pub fn energy(&self) -> Energy {
        self.energy_sums().to_energy(self.grid.volume())
    }
}
