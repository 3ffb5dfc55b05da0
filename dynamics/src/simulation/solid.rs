//! Simulation of a solid: batches of equal steps, each followed by a check that energy and ledger are finite.
//!
//! If they are not, a value has become non-finite in the last batch, in a step that is not known. The simulation then
//! returns to the last [saved](Simulation::state) or restored state (else the initial one), repeats the sound batches,
//! and proceeds step by step to the last sound state. Fields between two steps are interpolated linearly between the
//! states, so that stresses stay in their convex yield sets; accounts are those of the end of the step.
//!
//! Initial values, records and output are physical fields; in polar blocks those of the solver have a factor by layer
//! ([`Problem::field_factor`]).

use super::solver::{SolidSolver, SolverChoice};
use super::{
    AdvanceError, Simulation, SimulationState, TimeSteps, from_bytes, number_sections, to_bytes,
};
use crate::decomposition::ThreadStartError;
use crate::solid::interlayers::InterlayerFace;
use crate::solid::ledger::{Energy, Ledger};
use crate::solid::probe::Probe;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::region::Region;
use crate::solid::snapshot::{Snapshot, StatePart};

use crate::solid::domain::SolverReal;
use models::interface::layer::FaceRecord;
use models::solid::waves::SolidField;
use std::cell::RefCell;
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

impl SolidFields {
    /// Interpolates linearly to the fields `other` of a later state, in their memory; `fraction`: fraction of the time
    /// between the states, in \[0, 1\]. Times of first slip and of fracture are those of the later state: laws record
    /// them at ends of steps.
    fn interpolate(&self, mut other: Self, fraction: f64) -> Self {
        let line = |(a, b): (&f64, &f64)| (1.0 - fraction) * a + fraction * b;
        let field = |a: &[f64], b: &mut [f64]| {
            a.iter().zip(b).for_each(|(before, after)| *after = line((before, after)));
        };
        for (before, after) in self.values.iter().zip(&mut other.values) {
            field(before, after);
        }
        field(&self.plastic_dissipation, &mut other.plastic_dissipation);
        Self {
            interlayers: self
                .interlayers
                .iter()
                .zip(&other.interlayers)
                .map(|((_, before), (face, after))| {
                    let state =
                        |value: fn(&FaceRecord<f64>) -> f64| line((&value(before), &value(after)));
                    let record = FaceRecord {
                        slip: state(|own| own.slip),
                        opening: state(|own| own.opening),
                        slip_time: after.slip_time,
                        fracture_time: after.fracture_time,
                        normal_stress: state(|own| own.normal_stress),
                        shear_stress: state(|own| own.shear_stress),
                        porosity: state(|own| own.porosity),
                        pressure: state(|own| own.pressure),
                        fluid_velocity: state(|own| own.fluid_velocity),
                    };
                    (face.clone(), record)
                })
                .collect(),
            ..other
        }
    }
}

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
    /// Output fields before the last step, if output within that step is due.
    fields_before_step: Option<SolidFields>,
    /// Records of the watched cells that have not been delivered yet.
    records: Vec<f64>,
    /// Number of steps done in the state of the first of the records.
    first_record_step: usize,
    /// Last saved or restored state; `None` stands for the initial one.
    saved_snapshot: RefCell<Option<Snapshot<T>>>,
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
            fields_before_step: None,
            records: Vec::new(),
            first_record_step: 0,
            saved_snapshot: RefCell::new(None),
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

    /// Restores the last saved state, or the initial one, and repeats the sound steps, with the same bits.
    fn replay_sound_steps<E: From<ThreadStartError>>(
        &mut self,
        mut before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<(), E> {
        let saved = self.saved_snapshot.take().filter(|saved| saved.steps <= self.steps_done);
        let start = match saved {
            Some(saved) if self.solver.restore(&saved) => saved.steps,
            _ => {
                self.solver.reset();
                self.set_initial_values();
                0
            }
        };
        self.solver.watch_cells(&[]);
        let batch = self.batch_size();
        for first in (start..self.steps_done).step_by(batch) {
            before_batch()?;
            self.solver.advance(batch.min(self.steps_done - first))?;
        }
        self.solver.watch_cells(&self.watched_cells);
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
    type Fields = SolidFields;
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
        let (step, fraction) = self.time_steps.locate(due);
        let is_between = step == self.steps_done && fraction > 0.0;
        self.fields_before_step = is_between.then(|| self.fields());
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
        before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<SolidFault, E> {
        self.replay_sound_steps(before_batch)?;
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

    fn fields(&self) -> SolidFields {
        let interlayers = self.interlayer_records();
        SolidFields { interlayers, ..self.fields_in(0..self.own_cells[D - 1].len()) }
    }

    fn fields_at(&self, time: f64) -> Result<SolidFields, SolidFault> {
        let (_, fraction) = self.time_steps.locate(time);
        let now = self.fields();
        Ok(match self.fields_before_step.as_ref().filter(|_| fraction > 0.0) {
            Some(before) => before.interpolate(now, fraction),
            None => now,
        })
    }

    fn state(&self) -> SimulationState {
        // Drop the previous snapshot first, to limit memory to two copies of the fields.
        *self.saved_snapshot.borrow_mut() = None;
        let snapshot = self.solver.snapshot();
        let Snapshot {
            steps,
            fields,
            work_sums: work,
            cell_sums: sums,
            interlayer_history: interlayers,
        } = &snapshot;
        let narrow = |values: &[T]| values.iter().flat_map(|value| value.to_bytes()).collect();
        let fields = number_sections("field", fields.iter().map(|values| narrow(values)));
        let sums = number_sections("sums", sums.iter().map(|sums| to_bytes(sums)));
        let work = number_sections("work", work.iter().map(|parts| to_bytes(parts)));
        let has_interlayers = !interlayers.is_empty();
        let faces = || {
            let StatePart { interlayers, .. } = self.solver.state_part();
            let numbers = interlayers
                .into_iter()
                .flat_map(|([layer, axis, cell], variables)| [layer, axis, cell, variables]);
            numbers.flat_map(|number| (number as u64).to_le_bytes()).collect::<Vec<u8>>()
        };
        let interlayers = has_interlayers.then(|| {
            [
                ("interlayers".to_owned(), narrow(interlayers)),
                ("interlayer_faces".to_owned(), faces()),
            ]
        });
        let state = SimulationState {
            steps: *steps,
            time: self.account.time,
            initial_energy: self.account.initial_energy,
            sections: work
                .chain(fields)
                .chain(sums)
                .chain(interlayers.into_iter().flatten())
                .collect(),
        };
        *self.saved_snapshot.borrow_mut() = Some(snapshot);
        state
    }

    fn state_part(&self) -> Option<StatePart> {
        Some(self.solver.state_part())
    }

    fn restore(&mut self, state: &SimulationState) -> bool {
        let snapshot = || {
            let work =
                state.numbered_sections("work").map(from_bytes).collect::<Option<Vec<_>>>()?;
            let interlayers = match state.sections.get("interlayers") {
                Some(bytes) => T::from_bytes(bytes)?,
                None => Vec::new(),
            };
            Some(Snapshot {
                steps: state.steps,
                fields: state
                    .numbered_sections("field")
                    .map(T::from_bytes)
                    .collect::<Option<_>>()?,
                work_sums: work.try_into().ok()?,
                cell_sums: state
                    .numbered_sections("sums")
                    .map(from_bytes)
                    .collect::<Option<_>>()?,
                interlayer_history: interlayers,
            })
        };
        // An empty snapshot belongs to no problem.
        let snapshot = snapshot().unwrap_or_default();
        if !self.solver.restore(&snapshot) {
            return false;
        }
        *self.saved_snapshot.get_mut() = Some(Snapshot { steps: state.steps, ..snapshot });
        self.steps_done = state.steps;
        self.account.initial_energy = state.initial_energy;
        self.account = self.compute_account(self.steps_done);
        self.fields_before_step = None;
        self.records.clear();
        true
    }
}
