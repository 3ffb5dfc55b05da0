//! Reference solver: the scheme of the fused solver, applied line by line and cell by cell.
//!
//! Fields are arrays by field and cell, sweeps run line by line on one thread, and every sweep computes its numerical
//! dissipation, so that the ledger is full: no term is computed as a residual.
//!
//! | file | contents |
//! |---|---|
//! | `step` | sequence of operations of a step |
//! | `sweep` | sweep along an axis, line by line, with ghosts, work at boundaries and the energy account |
//! | `interlayers` | faces with interlayers: positions and history variables |
//! | `contacts` | laws of contacts after each sweep |
//! | `cells` | sources, gravity, rotation, relaxation, return mapping, flushing of subnormals, time integrals |
//! | `output` | fields at the time of the solver, records, snapshots, energies |
//!
//! Results equal those of [`Domain`](crate::solid::domain::Domain) bit for bit, which tests verify with random
//! problems: both solvers use the same formulas ([`mod@line`], `cell_laws`, `ghosts`). Sums over cells are exact and
//! therefore equal, too.

mod cells;
mod contacts;
mod interlayers;
mod output;
mod step;
mod sweep;

use crate::simd::{LaneGroup, Real};
use crate::solid::axis_permutation::AxisPermutation;
use crate::solid::boundary::{Boundary, Load};
use crate::solid::contact_faces::ContactConstants;
use crate::solid::domain::SolverReal;
use crate::solid::ghosts::{BoundaryFaces, GhostRule, LaneIndex};
use crate::solid::ledger::{CellDissipation, Energy, Ledger, LedgerSums, WorkSums};
use crate::solid::line;
use crate::solid::problem::{DomainError, Grid, Problem};
use crate::solid::shear_steps::ShearSteps;
use cells::CellLaws;
use interlayers::InterlayerFaces;
use models::solid::waves::{SolidField, VelocityStressPair};
use sweep::ReferenceWavePair;

/// Reference solver of a solid: fields on a rectangular grid and their laws, without tiles, halo or threads, and
/// without SIMD lanes except in the return mapping of a cell.
#[derive(Clone)]
pub struct Reference<T: SolverReal, const D: usize> {
    /// Problem with the axes in the order of the sweeps.
    problem: Problem<D>,
    /// Permutation from the axes of the given problem to those of the sweeps.
    permutation: AxisPermutation<D>,
    /// Fields of the state, in the order of `fields`.
    state_fields: Vec<SolidField>,
    /// Reconstruction of the sweeps.
    slopes: line::Slopes,
    /// Wave pairs by axis, for sweeps of half a step.
    waves: [Vec<ReferenceWavePair<T>>; D],
    /// Wave pairs by axis in steps that sweep longitudinal waves only.
    held_shear_waves: [Vec<ReferenceWavePair<T>>; D],
    shear_steps: ShearSteps,
    /// Wave pairs along the first axis by layer, for sweeps of half a step, if cell lengths vary by layer; else empty.
    waves_by_layer: Vec<Vec<ReferenceWavePair<T>>>,
    /// Wave pairs along the first axis, for sweeps of a quarter of a step (alternating sweeps).
    quarter_step_waves: Vec<ReferenceWavePair<T>>,
    boundaries: [[BoundaryFaces<T>; 2]; D],
    /// Constants of the faces of contacts by axis and medium; empty without contacts.
    contact_faces: [Vec<ContactConstants<T>>; D],
    /// Those along the first axis by layer and medium, if cell lengths vary by layer; else empty.
    contact_faces_by_layer: Vec<Vec<ContactConstants<T>>>,
    /// Constants of the laws that act in cells between sweeps.
    cell_laws: CellLaws<T>,
    /// Values by field and cell (first axis fastest); stresses as deviation from the initial stress.
    fields: Vec<Vec<T>>,
    /// Interlayers: faces, laws and history variables.
    interlayers: InterlayerFaces<T, D>,
    work: WorkSums,
    /// Dissipation by cell, J/m³.
    dissipation: CellDissipation,
    /// Field indices of velocities and spins, and by cell their sums by the trapezoidal rule (alternating sweeps:
    /// midpoint rule), without its end correction.
    time_integrals: Vec<(usize, Vec<f64>)>,
    /// Cells recorded after each step, by index in the order of the sweeps.
    watched_cells: Vec<usize>,
    records: Vec<f64>,
    /// Number of steps done since time 0.
    steps: usize,
}

impl<T: SolverReal, const D: usize> Reference<T, D> {
    /// Creates the solver of a solid at rest.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(problem: &Problem<D>) -> Result<Self, DomainError> {
        Self::with_first_axis(0, problem)
    }

    /// Creates the solver of a solid at rest, with `axis` swept first; the others keep their order.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn with_first_axis(axis: usize, problem: &Problem<D>) -> Result<Self, DomainError> {
        let permutation = AxisPermutation::with_first_axis(axis, &problem.grid);
        let problem = permutation.check_and_permute(problem)?.into_owned();
        let Problem { media, grid, .. } = &problem;
        let (count, state_fields) = (grid.count(), problem.fields());
        let waves = |axis: usize, spacing: f64, share: &dyn Fn(&VelocityStressPair) -> f64| {
            let wave = |(index, pair): (usize, &VelocityStressPair)| {
                ReferenceWavePair::new(&problem, (axis, spacing), index, share(pair))
            };
            media[0].pairs[axis].iter().enumerate().map(wave).collect::<Vec<_>>()
        };
        let shear_steps = ShearSteps::new(&problem);
        let waves_of_steps = |in_held_steps: usize| {
            std::array::from_fn(|axis| {
                let share =
                    |pair: &VelocityStressPair| shear_steps.sweep_fractions(pair)[in_held_steps];
                waves(axis, grid.spacing[axis], &share)
            })
        };
        let layer_spacings = problem.metric.as_ref().map_or(&[][..], |metric| &metric.spacing);
        let index = |field: &SolidField| state_fields.iter().position(|own| own == field);
        Ok(Self {
            slopes: problem.scheme.sweep_slopes(),
            waves: waves_of_steps(0),
            held_shear_waves: waves_of_steps(1),
            waves_by_layer: layer_spacings
                .iter()
                .map(|spacing| waves(0, *spacing, &|_| 0.5))
                .collect(),
            quarter_step_waves: waves(0, grid.spacing[0], &|_| 0.25),
            shear_steps,
            boundaries: std::array::from_fn(|axis| {
                [0, 1].map(|end| create_boundary(&problem, axis, end))
            }),
            contact_faces: std::array::from_fn(|axis| match problem.has_contacts() {
                true => ContactConstants::by_medium(&problem, axis),
                false => Vec::new(),
            }),
            contact_faces_by_layer: match problem.has_contacts() {
                true => ContactConstants::by_layer(&problem, 0..grid.cells[D - 1]),
                false => Vec::new(),
            },
            cell_laws: CellLaws::new(&problem, &state_fields),
            fields: vec![vec![T::ZERO; count]; state_fields.len()],
            interlayers: InterlayerFaces::new(&problem),
            work: WorkSums::default(),
            dissipation: CellDissipation::new(&problem, || Ok::<_, DomainError>(vec![0.0; count]))?,
            time_integrals: problem
                .integrated_fields
                .iter()
                .filter_map(|field| Some((index(field)?, vec![0.0; count])))
                .collect(),
            watched_cells: Vec::new(),
            records: Vec::new(),
            steps: 0,
            state_fields,
            permutation,
            problem,
        })
    }

    /// Returns the fields of the state, in their order.
    pub fn fields(&self) -> &[SolidField] {
        &self.state_fields
    }

    /// Returns the grid, with the axes in the order of the sweeps.
    pub fn grid(&self) -> Grid<D> {
        self.problem.grid
    }

    /// Returns the time of the present state, s.
    pub fn time(&self) -> f64 {
        self.steps as f64 * self.problem.step
    }

    /// Returns the index of a field in the list of fields.
    fn field_index(&self, field: SolidField) -> Option<usize> {
        self.fields().iter().position(|own| *own == field)
    }

    /// Returns the stored values of a field (first axis fastest), without the completion of the step that output
    /// applies for alternating sweeps; `None` if there is no such field.
    pub fn values(&self, field: SolidField) -> Option<Vec<T>> {
        self.field_index(field).map(|place| self.permutation.unpermute(self.fields[place].clone()))
    }

    /// Sets the values of a field (first axis fastest); excess values are ignored, missing ones leave cells unchanged.
    /// If another axis than the first is swept first, the list must be complete.
    pub fn set_field(&mut self, field: SolidField, values: &[T]) {
        let values = self.permutation.permute(values);
        let Some(index) = self.field_index(field) else { return };
        for (own, &value) in self.fields[index].iter_mut().zip(values.iter()) {
            *own = value;
        }
    }

    /// Initialises interlayers with the mean velocity of the adjacent cells and without stress, see
    /// [`Domain::initialise_interlayers`](crate::solid::domain::Domain::initialise_interlayers).
    pub fn initialise_interlayers(&mut self) {
        let Self { state_fields, fields, interlayers, problem, .. } = self;
        let value = |field, cell: usize| {
            let index = state_fields.iter().position(|own| *own == field);
            index.map_or(T::ZERO, |own| fields[own][cell])
        };
        interlayers.initialise(problem, value);
    }

    /// Returns the history variables of all interlayers, in the order of
    /// [`Domain::interlayer_history`](crate::solid::domain::Domain::interlayer_history).
    pub fn interlayer_history(&self) -> Vec<T> {
        self.interlayers.history().to_vec()
    }

    /// Returns work and dissipation of the steps so far, J.
    pub fn ledger(&self) -> Ledger {
        let dissipation = self.dissipation.lists().map(|values| values.iter().copied().collect());
        let interlayers = self.interlayers.sum_energies(&self.problem);
        LedgerSums { work: self.work.clone(), dissipation, interlayers }
            .to_ledger(self.problem.grid.volume())
    }

    /// Returns the energy of the deviation from the initial stress, J.
    pub fn energy(&self) -> Energy {
        self.energy_sums().to_energy(self.problem.grid.volume())
    }
}

/// Converts a face index to its storage position: a group and a lane.
fn lane_index<T: Real>(face: usize) -> LaneIndex {
    (face / T::Lanes::COUNT, face % T::Lanes::COUNT)
}

/// Creates the boundary at an end of an axis in the form that the sweeps use.
fn create_boundary<T: Real, const D: usize>(
    problem: &Problem<D>,
    axis: usize,
    end: usize,
) -> BoundaryFaces<T> {
    let boundary = &problem.boundaries[axis][end];
    if *boundary == Boundary::Periodic {
        return BoundaryFaces::Periodic;
    }
    let count = problem.grid.faces(axis);
    let faces: Vec<(usize, LaneIndex)> =
        (0..count).map(|face| (face, lane_index::<T>(face))).collect();
    let is_at_end = |load: &&Load| (load.axis, load.end) == (axis, end);
    let loads: Vec<&Load> = problem.loads.iter().filter(is_at_end).collect();
    let pairs = problem.media[0].pairs[axis].len();
    let groups = count.div_ceil(T::Lanes::COUNT);
    let slopes = problem.boundary_slopes();
    let mut rule = GhostRule::new(boundary, pairs, (&faces, groups), !loads.is_empty(), slopes);
    for load in loads {
        let is_longitudinal = problem.media[0].pairs[axis][load.pair].is_longitudinal();
        rule.add_load(load, is_longitudinal, &faces);
    }
    BoundaryFaces::Physical(rule)
}
