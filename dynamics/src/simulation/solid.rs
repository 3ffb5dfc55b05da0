//! Simulation of a solid: batches of equal steps, each followed by a check that energy and ledger are finite.
//!
//! If they are not, a value has become non-finite in the last batch, in a step that is not known. The simulation then
//! returns to the last saved state (else the initial one), repeats the sound batches, and proceeds step by step to the
//! last sound state. Fields between two steps are interpolated linearly between the
//! states, so that stresses stay in their convex yield sets; accounts are those of the end of the step.
//!
//! Initial values, records and output are physical fields; in polar blocks those of the solver have a factor by layer
//! ([`Problem::field_factor`]).

mod state;

use super::solver::{SolidSolver, SolverChoice};
use super::{AdvanceError, CellSections, Simulation, SimulationState, TimeSteps};
use crate::decomposition::ThreadStartError;
use crate::solid::interlayers::InterlayerFace;
use crate::solid::ledger::{Energy, Ledger};
use crate::solid::probe::Probe;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::region::Region;
use crate::solid::snapshot::StatePart;

use crate::solid::domain::SolverReal;
use models::interface::layer::FaceRecord;
use models::solid::waves::SolidField;
use std::cmp::Ordering;
use std::ops::Range;

/// Maximum number of steps between two checks for non-finite energies.
const MAX_BATCH_STEPS: usize = 64;

/// Maximum of the product of cells and steps between two checks, unless they are one step apart; a few seconds of one
/// thread in three dimensions. A run can be interrupted only between batches.
const MAX_BATCH_CELL_STEPS: usize = 20_000_000;

/// Energy account of a solid: energy and ledger.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolidAccount {
    /// Time of the account, s.
    pub time: f64,
    /// Energy at this time, J.
    pub energy: Energy,
    /// Work and dissipation of the steps so far, J.
    pub ledger: Ledger,
    /// Energy at time 0, J.
    pub initial_energy: f64,
}

impl SolidAccount {
    /// Returns the energy change not explained by the ledger, J: rounding error if the ledger is full (reference
    /// solver), else minus the numerical dissipation (fused solver).
    pub fn balance(&self) -> f64 {
        self.energy.total() - self.initial_energy - self.ledger.energy_change()
    }

    /// Whether energy and ledger are finite.
    fn is_finite(&self) -> bool {
        self.energy.total().is_finite() && self.ledger.energy_change().is_finite()
    }
}

/// Output fields of a solid: cell values, plastic dissipation and interlayers.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidFields {
    /// Values by quantity and cell of the process (first axis fastest): all fields of the media with total stresses, then
    /// the time integrals of the problem.
    pub values: Vec<Vec<f64>>,
    /// Plastic dissipation by cell, J/m³; empty if no medium yields.
    pub plastic_dissipation: Vec<f64>,
    /// Faces of interlayers in plane strain ([`InterlayerLaw::Plane`](crate::solid::interlayers::InterlayerLaw)), and
    /// their states; empty without such interlayers.
    pub interlayers: Vec<(InterlayerFace, FaceRecord<f64>)>,
}

/// Time of output as a fraction of the last step: fields are interpolated linearly between the states before and after
/// the step; 1 at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepFraction(pub f64);

/// A state whose energy or ledger is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidFault {
    /// Time of the faulty state, s.
    pub time: f64,
    /// Field and cell index of the first non-finite value; `None` if only the energy or the ledger is non-finite.
    pub location: Option<(SolidField, usize)>,
}

/// Time-domain simulation of a solid.
pub struct SolidSimulation<T: SolverReal, const D: usize> {
    problem: Problem<D>,
    time_steps: TimeSteps,
    /// Cells along each axis whose values this process holds: those of the rank, or the whole grid.
    own_cells: [Range<usize>; D],
    /// Initial values by cell of this process, of the fields that are not zero at time 0.
    initial_values: Vec<(SolidField, Vec<f64>)>,
    /// Probes; cells are indices into `watched_cells`.
    probes: Vec<Probe>,
    /// Cells that the probes need, ascending.
    watched_cells: Vec<usize>,
    solver: Box<dyn SolidSolver<T>>,
    thread_count: usize,
    /// Number of steps done since time 0.
    steps_done: usize,
    /// Account after `steps_done` steps.
    account: SolidAccount,
    /// Records of the watched cells that have not been delivered yet.
    records: Vec<f64>,
    /// Number of steps done in the state of the first of the records.
    first_record_step: usize,
}

impl<T: SolverReal, const D: usize> SolidSimulation<T, D> {
    /// Creates the simulation of a solid at time 0. `initial`: values of fields that are not zero, by cell of this process
    /// ([`SolverChoice::own_cells`]).
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(
        problem: Problem<D>,
        steps: TimeSteps,
        initial: Vec<(SolidField, Vec<f64>)>,
        probes: Vec<Probe>,
        choice: SolverChoice,
    ) -> Result<Self, DomainError> {
        let mut watched: Vec<usize> = probes.iter().flat_map(Probe::cells).collect();
        watched.sort_unstable();
        watched.dedup();
        let threads = choice.thread_count::<T, D>(&problem);
        let own_cells = choice.own_cells(&problem)?;
        let solver = T::build_solver(choice, &problem)?;
        let account = SolidAccount {
            time: 0.0,
            energy: Energy::default(),
            ledger: Ledger::default(),
            initial_energy: 0.0,
        };
        let mut simulation = Self {
            probes: probes.into_iter().map(|probe| probe.reindex_cells(&watched)).collect(),
            problem,
            time_steps: steps,
            own_cells,
            initial_values: initial,
            watched_cells: watched,
            solver,
            thread_count: threads,
            steps_done: 0,
            account,
            records: Vec::new(),
            first_record_step: 0,
        };
        simulation.set_initial_values();
        simulation.account = simulation.compute_account(0);
        simulation.account.initial_energy = simulation.account.energy.total();
        simulation.solver.watch_cells(&simulation.watched_cells);
        simulation.solver.record_watched_cells();
        simulation.collect_records(0);
        Ok(simulation)
    }

    /// Sets the initial values; all fields must be zero.
    fn set_initial_values(&mut self) {
        for (field, values) in &self.initial_values {
            let values = values.iter().enumerate();
            let values: Vec<T> = values
                .map(|(cell, value)| T::from_f64(self.field_factor_of_own_cell(cell) * value))
                .collect();
            self.solver.set_field(*field, &values);
        }
        self.solver.initialise_interlayers();
    }

    /// Returns the ratio of the fields in a cell of this process to the physical fields.
    fn field_factor_of_own_cell(&self, cell: usize) -> f64 {
        self.problem.field_factor(self.own_cells[D - 1].start + cell / self.layer_size())
    }

    /// Returns the cells along each axis whose values this process holds.
    pub fn own_cells(&self) -> &[Range<usize>; D] {
        &self.own_cells
    }

    /// Iterates over the indices of the media of the cells of some layers of this process, as [`fields_in`](Self::fields_in).
    pub fn cell_media_in(&self, layers: Range<usize>) -> impl Iterator<Item = usize> {
        let mut cells = self.own_cells.clone();
        let first = cells[D - 1].start;
        cells[D - 1] = first + layers.start..first + layers.end;
        let region = Region::from_box(self.problem.grid.cells, cells);
        region.owned_global_cell_iter().map(|cell| self.problem.medium_index(cell))
    }

    /// Returns the problem that is simulated.
    pub fn problem(&self) -> &Problem<D> {
        &self.problem
    }

    /// Returns number and size of the time steps.
    pub fn time_steps(&self) -> TimeSteps {
        self.time_steps
    }

    /// Returns the number of threads of the solver.
    pub fn threads(&self) -> usize {
        self.thread_count
    }

    /// Returns the first cell, in the order of the solver, whose stress is outside its yield set; `None` without such a
    /// cell.
    pub fn first_cell_outside_yield_set(&self) -> Option<usize> {
        self.solver.first_cell_outside_yield_set()
    }

    /// Returns the output fields of the present state in some layers of cells across the last axis, counted from the first
    /// layer of this process; without interlayers.
    pub fn fields_in(&self, layers: Range<usize>) -> SolidFields {
        let mut values = self.solver.output_values_in(layers.clone());
        let mut plastic_dissipation = self.solver.plastic_dissipation_in(layers.clone());
        if self.problem.has_field_factors() {
            let first = layers.start * self.layer_size();
            for of_quantity in &mut values {
                for (cell, value) in of_quantity.iter_mut().enumerate() {
                    *value /= self.field_factor_of_own_cell(first + cell);
                }
            }
            for (cell, value) in plastic_dissipation.iter_mut().enumerate() {
                *value /= self.field_factor_of_own_cell(first + cell).powi(2);
            }
        }
        SolidFields { values, plastic_dissipation, interlayers: Vec::new() }
    }

    /// Returns all output fields of the present state.
    pub fn all_fields(&self) -> SolidFields {
        let interlayers = self.interlayer_records();
        SolidFields { interlayers, ..self.fields_in(0..self.own_cells[D - 1].len()) }
    }

    /// Returns the faces of interlayers of this process and their states, see [`SolidFields::interlayers`].
    pub fn interlayer_records(&self) -> Vec<(InterlayerFace, FaceRecord<f64>)> {
        match self.problem.interlayers.is_empty() {
            true => Vec::new(),
            false => self
                .problem
                .interlayer_records_in(&self.own_cells, &self.solver.interlayer_history()),
        }
    }

    /// Returns the number of cells of this process in a layer across the last axis.
    pub fn layer_size(&self) -> usize {
        self.own_cells[..D - 1].iter().map(ExactSizeIterator::len).product()
    }

    /// Computes the account after `done` steps from the state of the solver.
    fn compute_account(&self, done: usize) -> SolidAccount {
        SolidAccount {
            time: self.time_steps.time(done),
            energy: self.solver.energy(),
            ledger: self.solver.ledger(),
            ..self.account
        }
    }

    /// Fetches the records of the solver, the first of which is that of the state after `first` steps.
    fn collect_records(&mut self, first: usize) {
        if self.watched_cells.is_empty() {
            return;
        }
        let mut records = self.solver.take_records();
        if self.problem.has_field_factors() {
            let cells = self.watched_cells.iter().cycle();
            for (record, cell) in records.chunks_exact_mut(self.solver.quantity_count()).zip(cells)
            {
                let factor = self.problem.field_factor_of_cell(*cell);
                record.iter_mut().for_each(|value| *value /= factor);
            }
        }
        if self.records.is_empty() {
            self.first_record_step = first;
            self.records = records;
        } else {
            self.records.extend(records);
        }
    }

    /// Returns the maximum number of steps between two checks, a multiple of those per step of the shear waves.
    fn batch_size(&self) -> usize {
        let steps =
            (MAX_BATCH_CELL_STEPS / self.problem.grid.count().max(1)).clamp(1, MAX_BATCH_STEPS);
        steps.next_multiple_of(self.time_steps.shear_interval)
    }

    /// Returns time and first non-finite value of the present state of the solver.
    fn locate_fault(&self) -> SolidFault {
        SolidFault { time: self.solver.time(), location: self.solver.first_non_finite() }
    }

    /// Restores the saved state, or the initial one, and repeats the sound steps, with the same bits.
    fn replay_sound_steps<E: From<ThreadStartError>>(
        &mut self,
        restore_saved: impl FnOnce(&mut Self) -> Result<bool, E>,
        mut before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<(), E> {
        let (sound, account) = (self.steps_done, self.account);
        if !(restore_saved(self)? && self.steps_done <= sound) {
            self.solver.reset();
            self.set_initial_values();
            self.steps_done = 0;
        }
        self.solver.watch_cells(&[]);
        let batch = self.batch_size();
        for first in (self.steps_done..sound).step_by(batch) {
            before_batch()?;
            self.solver.advance(batch.min(sound - first))?;
        }
        self.solver.watch_cells(&self.watched_cells);
        (self.steps_done, self.account) = (sound, account);
        Ok(())
    }

    /// Advances step by step to the last sound state and returns the fault of the next one.
    fn advance_to_fault(&mut self) -> Result<SolidFault, ThreadStartError> {
        loop {
            let sound = self.solver.snapshot();
            let next = self.time_steps.shear_interval;
            self.solver.advance(next)?;
            let account = self.compute_account(self.steps_done + next);
            if !account.is_finite() || self.steps_done == self.time_steps.count {
                let fault = self.locate_fault();
                self.solver.restore(&sound);
                self.solver.watch_cells(&self.watched_cells);
                return Ok(fault);
            }
            self.collect_records(self.steps_done + 1);
            (self.steps_done, self.account) = (self.steps_done + next, account);
        }
    }
}

impl<T: SolverReal, const D: usize> Simulation for SolidSimulation<T, D> {
    type Account = SolidAccount;
    type Fields = StepFraction;
    type Fault = SolidFault;

    fn steps(&self) -> usize {
        self.steps_done
    }

    fn time(&self) -> f64 {
        self.time_steps.time(self.steps_done)
    }

    fn is_finished(&self) -> bool {
        self.steps_done == self.time_steps.count
    }

    fn compare_time(&self, time: f64) -> Ordering {
        let (step, fraction) = self.time_steps.locate(time);
        match fraction > 0.0 {
            true if step < self.steps_done => Ordering::Less,
            true => Ordering::Greater,
            false => step.cmp(&self.steps_done),
        }
    }

    fn check_state(&self) -> Result<(), SolidFault> {
        if self.account.energy.total().is_finite() { Ok(()) } else { Err(self.locate_fault()) }
    }

    fn advance(&mut self, due: f64) -> Result<(), AdvanceError<SolidFault>> {
        let (step, _) = self.time_steps.locate(due);
        let next = step.saturating_sub(self.steps_done).max(self.time_steps.shear_interval);
        let next = next.min(self.batch_size()).min(self.time_steps.count - self.steps_done);
        self.solver.advance(next).map_err(AdvanceError::Threads)?;
        let account = self.compute_account(self.steps_done + next);
        if !account.is_finite() {
            return Err(AdvanceError::Fault(self.locate_fault()));
        }
        self.collect_records(self.steps_done + 1);
        (self.steps_done, self.account) = (self.steps_done + next, account);
        Ok(())
    }

    fn recover<E: From<ThreadStartError>>(
        &mut self,
        _fault: SolidFault,
        restore_saved: impl FnOnce(&mut Self) -> Result<bool, E>,
        before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<SolidFault, E> {
        self.replay_sound_steps(restore_saved, before_batch)?;
        Ok(self.advance_to_fault()?)
    }

    fn drain_records<E>(
        &mut self,
        mut deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        let width = self.solver.quantity_count();
        let medium = |cell: usize| &self.problem.media[self.problem.medium_index(cell)];
        let mut state = Vec::with_capacity(self.probes.len() * width);
        let size = (self.watched_cells.len() * width).max(1);
        for (index, cells) in self.records.chunks_exact(size).enumerate() {
            let step = self.first_record_step + index;
            // Within a step of the shear waves their state is not that of the longitudinal waves.
            if !step.is_multiple_of(self.time_steps.shear_interval) {
                continue;
            }
            state.clear();
            for probe in &self.probes {
                probe.append_values(cells, width, medium, &mut state);
            }
            deliver(self.time_steps.time(step), &state)?;
        }
        self.records.clear();
        Ok(())
    }

    fn account(&self) -> SolidAccount {
        self.account
    }

    /// Returns the account of the present state, at the end of the step that reached or passed `_time`, s.
    fn account_at(&self, _time: f64) -> Result<SolidAccount, SolidFault> {
        Ok(self.account)
    }

    fn fields(&self) -> StepFraction {
        StepFraction(1.0)
    }

    fn interpolates_from_present(&self, time: f64) -> bool {
        let (step, fraction) = self.time_steps.locate(time);
        step == self.steps_done && fraction > 0.0
    }

    fn fields_at(&self, time: f64) -> Result<StepFraction, SolidFault> {
        let (_, fraction) = self.time_steps.locate(time);
        Ok(StepFraction(if fraction > 0.0 { fraction } else { 1.0 }))
    }

    fn state_part(&self) -> Option<StatePart> {
        Some(self.solver.state_part())
    }

    fn restore_with_cells(
        &mut self,
        state: &SimulationState,
        cells: &mut dyn CellSections,
    ) -> bool {
        self.restore_sections(state, cells)
    }
}
