//! Simulation of a solid: batches of equal steps, each followed by a check that the energy is finite.
//!
//! A non-finite energy identifies the batch in which a value became non-finite, not the step. The simulation then
//! returns to the last [saved](Simulation::state) or restored state (else the initial one), repeats the sound batches,
//! and proceeds step by step to the last sound state. Output between two steps is interpolated linearly between the
//! states, so that stresses stay in their convex yield sets.

use super::solver::{Solver, SolverChoice};
use super::{Simulation, State, TimeSteps, from_bytes, number, to_bytes};
use crate::solid::ledger::{Energy, Ledger};
use crate::solid::probe::Probe;
use crate::solid::problem::{DomainError, Problem};
use crate::solid::snapshot::Snapshot;

use crate::solid::domain::SolverReal;
use models::solid::waves::Field;
use std::cell::RefCell;
use std::cmp::Ordering;

/// Maximum number of steps between two checks for non-finite energies.
const LOOK: usize = 64;

/// Maximum of cells × steps between two checks: a few seconds of one thread in three dimensions. A run can be
/// interrupted only between batches.
const CELLS: usize = 20_000_000;

/// Energy of a solid and its ledger.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidAccount {
    /// Time, s.
    pub time: f64,
    /// Present energy, J.
    pub energy: Energy,
    /// Work and dissipation of the steps so far, J.
    pub ledger: Ledger,
    /// Energy at time 0, J.
    pub initial_energy: f64,
}

impl SolidAccount {
    /// Returns the energy change not explained by the ledger, J: rounding if the ledger is full, else minus the
    /// numerical dissipation.
    pub fn balance(&self) -> f64 {
        self.energy.total() - self.initial_energy - self.ledger.change()
    }

    /// Whether energy and ledger are finite.
    fn is_sound(&self) -> bool {
        self.energy.total().is_finite() && self.ledger.change().is_finite()
    }
}

/// Output fields of a solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidFields {
    /// By quantity and cell (first axis fastest): all fields of the media with total stresses, then the time integrals
    /// of the problem.
    pub values: Vec<Vec<f64>>,
    /// Plastic dissipation by cell, J/m³; empty if no medium yields.
    pub dissipated: Vec<f64>,
}

impl SolidFields {
    /// Interpolates linearly to another state; `part` in \[0, 1\].
    fn towards(&self, other: &Self, part: f64) -> Self {
        let line = |(a, b): (&f64, &f64)| (1.0 - part) * a + part * b;
        let field = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(line).collect();
        Self {
            values: self.values.iter().zip(&other.values).map(field).collect(),
            dissipated: field((&self.dissipated, &other.dissipated)),
        }
    }
}

/// A state whose energy is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidFault {
    /// Time of the state, s.
    pub time: f64,
    /// Field and cell of the first non-finite value; `None` if only the energy is non-finite.
    pub place: Option<(Field, usize)>,
}

/// Time-domain simulation of a solid.
pub struct SolidSimulation<T: SolverReal, const D: usize> {
    problem: Problem<D>,
    steps: TimeSteps,
    /// Initial values by cell of the fields that are not zero at time 0.
    initial: Vec<(Field, Vec<f64>)>,
    /// Probes; cells are indices into `watched`.
    probes: Vec<Probe>,
    /// Cells that the probes need, ascending.
    watched: Vec<usize>,
    solver: Box<dyn Solver<T>>,
    threads: usize,
    /// Number of steps done.
    done: usize,
    /// Account after `done` steps.
    account: SolidAccount,
    /// Output fields before the last step, if output within that step is due.
    before: Option<SolidFields>,
    /// Records of the watched cells that have not been delivered yet.
    records: Vec<f64>,
    /// Number of steps done at the first of the records.
    first_record: usize,
    /// Last saved or restored state; `None`: the initial one.
    saved: RefCell<Option<Snapshot<T>>>,
}

impl<T: SolverReal, const D: usize> SolidSimulation<T, D> {
    /// A solid at time 0. `initial`: values by cell of fields that are not zero.
    ///
    /// # Errors
    /// See [`DomainError`].
    pub fn new(
        problem: Problem<D>,
        steps: TimeSteps,
        initial: Vec<(Field, Vec<f64>)>,
        probes: Vec<Probe>,
        choice: SolverChoice,
    ) -> Result<Self, DomainError> {
        let mut watched: Vec<usize> = probes.iter().flat_map(Probe::cells).collect();
        watched.sort_unstable();
        watched.dedup();
        let solver = choice.build_solver(&problem)?;
        let threads = choice.threads::<T, D>(&problem);
        let account = SolidAccount {
            time: 0.0,
            energy: Energy::default(),
            ledger: Ledger::default(),
            initial_energy: 0.0,
        };
        let mut own = Self {
            probes: probes.into_iter().map(|probe| probe.among(&watched)).collect(),
            problem,
            steps,
            initial,
            watched,
            solver,
            threads,
            done: 0,
            account,
            before: None,
            records: Vec::new(),
            first_record: 0,
            saved: RefCell::new(None),
        };
        own.set_initial();
        own.account = own.account_after(0);
        own.account.initial_energy = own.account.energy.total();
        own.solver.watch(&own.watched);
        own.solver.record();
        own.keep_records(0);
        Ok(own)
    }

    /// Sets the initial values; all fields must be zero.
    fn set_initial(&mut self) {
        for (field, values) in &self.initial {
            let values: Vec<T> = values.iter().map(|value| T::from_f64(*value)).collect();
            self.solver.set(*field, &values);
        }
        self.solver.initialise_interlayers();
    }

    /// Returns the problem.
    pub fn problem(&self) -> &Problem<D> {
        &self.problem
    }

    /// Returns the time steps.
    pub fn time_steps(&self) -> TimeSteps {
        self.steps
    }

    /// Returns the number of threads of the solver.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Returns the first cell whose stress is outside its yield set.
    pub fn first_beyond_yield(&self) -> Option<usize> {
        self.solver.first_beyond_yield()
    }

    /// Computes the account after `done` steps from the solver's state.
    fn account_after(&self, done: usize) -> SolidAccount {
        SolidAccount {
            time: self.steps.time(done),
            energy: self.solver.energy(),
            ledger: self.solver.ledger(),
            ..self.account
        }
    }

    /// Fetches the solver's records, the first of which is that of step `first`.
    fn keep_records(&mut self, first: usize) {
        if self.watched.is_empty() {
            return;
        }
        if self.records.is_empty() {
            self.first_record = first;
            self.records = self.solver.records();
        } else {
            self.records.extend(self.solver.records());
        }
    }

    /// Returns the number of steps between two checks.
    fn batch(&self) -> usize {
        (CELLS / self.problem.grid.count().max(1)).clamp(1, LOOK)
    }

    /// Returns the fault of the solver's state.
    fn fault(&self) -> SolidFault {
        SolidFault { time: self.solver.time(), place: self.solver.first_non_finite() }
    }

    /// Restores the last saved state and repeats the sound steps, with the same bits.
    fn replay<E>(&mut self, mut go_on: impl FnMut() -> Result<(), E>) -> Result<(), E> {
        let saved = self.saved.take().filter(|saved| saved.steps <= self.done);
        let start = match saved {
            Some(saved) if self.solver.restore(&saved) => saved.steps,
            _ => {
                self.solver.reset();
                self.set_initial();
                0
            }
        };
        self.solver.watch(&[]);
        let batch = self.batch();
        for first in (start..self.done).step_by(batch) {
            go_on()?;
            self.solver.advance(batch.min(self.done - first));
        }
        self.solver.watch(&self.watched);
        Ok(())
    }

    /// Advances step by step to the last sound state and returns the fault of the next one.
    fn step_to_fault(&mut self) -> SolidFault {
        loop {
            let sound = self.solver.snapshot();
            self.solver.advance(1);
            let account = self.account_after(self.done + 1);
            if !account.is_sound() || self.done == self.steps.count {
                let fault = self.fault();
                self.solver.restore(&sound);
                self.solver.watch(&self.watched);
                return fault;
            }
            self.keep_records(self.done + 1);
            (self.done, self.account) = (self.done + 1, account);
        }
    }
}

impl<T: SolverReal, const D: usize> Simulation for SolidSimulation<T, D> {
    type Account = SolidAccount;
    type Fields = SolidFields;
    type Fault = SolidFault;

    fn steps(&self) -> usize {
        self.done
    }

    fn time(&self) -> f64 {
        self.steps.time(self.done)
    }

    fn is_finished(&self) -> bool {
        self.done == self.steps.count
    }

    fn compare(&self, time: f64) -> Ordering {
        let (step, part) = self.steps.place(time);
        match part > 0.0 {
            true if step < self.done => Ordering::Less,
            true => Ordering::Greater,
            false => step.cmp(&self.done),
        }
    }

    fn check(&self) -> Result<(), SolidFault> {
        if self.account.energy.total().is_finite() { Ok(()) } else { Err(self.fault()) }
    }

    fn advance(&mut self, due: f64) -> Result<(), SolidFault> {
        let (step, part) = self.steps.place(due);
        let is_between = step == self.done && part > 0.0;
        self.before = is_between.then(|| self.fields());
        let next = step.saturating_sub(self.done).max(1);
        let next = next.min(self.batch()).min(self.steps.count - self.done);
        self.solver.advance(next);
        let account = self.account_after(self.done + next);
        if !account.is_sound() {
            return Err(self.fault());
        }
        self.keep_records(self.done + 1);
        (self.done, self.account) = (self.done + next, account);
        Ok(())
    }

    fn recover<E>(
        &mut self,
        _fault: SolidFault,
        go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<SolidFault, E> {
        self.replay(go_on)?;
        Ok(self.step_to_fault())
    }

    fn drain_records<E>(
        &mut self,
        mut deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E> {
        let width = self.solver.width();
        let Problem { media, of_cell, .. } = &self.problem;
        let mut state = Vec::with_capacity(self.probes.len() * width);
        let size = (self.watched.len() * width).max(1);
        for (index, cells) in self.records.chunks_exact(size).enumerate() {
            state.clear();
            for probe in &self.probes {
                probe.append(cells, width, media, of_cell, &mut state);
            }
            deliver(self.steps.time(self.first_record + index), &state)?;
        }
        self.records.clear();
        Ok(())
    }

    fn account(&self) -> SolidAccount {
        self.account
    }

    /// Returns the account of the present state, which is the end of the step that reached or passed `_time`.
    fn account_at(&self, _time: f64) -> Result<SolidAccount, SolidFault> {
        Ok(self.account)
    }

    fn fields(&self) -> SolidFields {
        SolidFields { values: self.solver.output_fields(), dissipated: self.solver.dissipated() }
    }

    fn fields_at(&self, time: f64) -> Result<SolidFields, SolidFault> {
        let (_, part) = self.steps.place(time);
        let now = self.fields();
        Ok(match self.before.as_ref().filter(|_| part > 0.0) {
            Some(before) => before.towards(&now, part),
            None => now,
        })
    }

    fn state(&self) -> State {
        // Drop the previous copy first, to limit memory to two copies of the fields.
        *self.saved.borrow_mut() = None;
        let snapshot = self.solver.snapshot();
        let Snapshot { steps, fields, work, sums, interlayers } = &snapshot;
        let narrow = |values: &[T]| values.iter().flat_map(|value| value.bytes()).collect();
        let fields = number("field", fields.iter().map(|values| narrow(values)));
        let sums = number("sums", sums.iter().map(|sums| to_bytes(sums)));
        let work = number("work", work.iter().map(|parts| to_bytes(parts)));
        let interlayers = (!interlayers.is_empty())
            .then(|| ("interlayers".to_owned(), narrow(interlayers.as_flattened())));
        let state = State {
            steps: *steps,
            time: self.account.time,
            initial_energy: self.account.initial_energy,
            sections: work.chain(fields).chain(sums).chain(interlayers).collect(),
        };
        *self.saved.borrow_mut() = Some(snapshot);
        state
    }

    fn restore(&mut self, state: &State) -> bool {
        let snapshot = || {
            let work = state.numbered("work").map(from_bytes).collect::<Option<Vec<_>>>()?;
            let interlayers = match state.sections.get("interlayers") {
                Some(bytes) => T::from_bytes(bytes)?,
                None => Vec::new(),
            };
            let (interlayers, []) = interlayers.as_chunks::<2>() else { return None };
            Some(Snapshot {
                steps: state.steps,
                fields: state.numbered("field").map(T::from_bytes).collect::<Option<_>>()?,
                work: work.try_into().ok()?,
                sums: state.numbered("sums").map(from_bytes).collect::<Option<_>>()?,
                interlayers: interlayers.to_vec(),
            })
        };
        let Some(snapshot) = snapshot().filter(|snapshot| self.solver.restore(snapshot)) else {
            return false;
        };
        *self.saved.get_mut() = Some(snapshot);
        self.done = state.steps;
        self.account.initial_energy = state.initial_energy;
        self.account = self.account_after(self.done);
        self.before = None;
        self.records.clear();
        true
    }
}
