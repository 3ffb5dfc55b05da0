//! Time loop of all time-domain simulations.
//!
//! A [`Simulation`] holds a state and advances it, an [`Observer`] receives the output, and [`run_simulation`] is the
//! loop:
//!
//! 1. If the initial state is unsound (see [`Simulation::check_state`]), the run ends at once with this fault.
//! 2. A new run delivers the record, the account and the snapshot of its initial state. For a resumed run all output
//!    due up to the restored state has been delivered before.
//! 3. Until the end of the duration, the simulation advances by a batch of steps towards the next time at which an
//!    account or a snapshot is due. The observer receives the records of these steps and the accounts and snapshots
//!    that are due, then the simulation itself (progress, checkpoints).
//! 4. A run ends at its duration, by a fault (an unsound state), by an error of the observer (which is how it is
//!    interrupted), or if the threads of the solver cannot be started. After a fault the simulation is at its last
//!    sound state, whose records and account are delivered if they have not been.
//!
//! Steps do not depend on the output. A run resumed from a saved [`SimulationState`] delivers the same bits as an
//! uninterrupted one. This module writes no files; observers do.

mod flow;
mod regular_times;
mod solid;
pub(crate) mod solver;
mod time_steps;

pub use crate::solid::snapshot::StatePart;
pub use flow::{FlowAccount, FlowFields, FlowSimulation};
pub use regular_times::RegularTimes;
pub use solid::{SolidAccount, SolidFault, SolidFields, SolidSimulation, StepFraction};
pub use solver::SolverChoice;
pub use time_steps::{StepLimit, TimeSteps, TooManySteps};

use crate::decomposition::ThreadStartError;
use std::borrow::Cow;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::io;

/// State of a simulation, or of the part of it that a rank holds, sufficient to continue it bit for bit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SimulationState {
    /// Number of steps done since time 0.
    pub steps: usize,
    /// Time of the state, s.
    pub time: f64,
    /// Energy at time 0: J (solids), J/m³ (flows).
    pub initial_energy: f64,
    /// Arrays by name, as little-endian bytes.
    pub sections: BTreeMap<String, Vec<u8>>,
}

impl SimulationState {
    /// Iterates over the sections whose names are `name` followed by 0, 1, …
    fn numbered_sections(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        (0..)
            .map_while(move |index| self.sections.get(&format!("{name}{index}")).map(Vec::as_slice))
    }
}

/// Gives sections the names `name` followed by 0, 1, …
fn number_sections<C>(
    name: &str,
    sections: impl Iterator<Item = C>,
) -> impl Iterator<Item = (String, C)> {
    sections.enumerate().map(move |(index, own)| (format!("{name}{index}"), own))
}

/// State that is read section by section, so that values of many cells need not be in memory twice.
pub trait StateSource {
    /// Returns the state without the sections of [`cell_sections`](Self::cell_sections). All ranks call it.
    fn state_without_cells(&self) -> SimulationState;

    /// Returns names and lengths, bytes, of the sections with values by cell of this process; none by default (flows).
    fn cell_sections(&self) -> Vec<(String, usize)> {
        Vec::new()
    }

    /// Passes the content of a section with values by cell to `append` in pieces; nothing if there is no such section.
    ///
    /// # Errors
    /// The first error of `append`.
    fn read_cell_section(
        &self,
        name: &str,
        append: &mut dyn FnMut(&[u8]) -> io::Result<()>,
    ) -> io::Result<()> {
        let _ = (name, append);
        Ok(())
    }

    /// Returns the whole state.
    fn state(&self) -> SimulationState {
        let mut state = self.state_without_cells();
        for (name, length) in self.cell_sections() {
            let mut content = Vec::with_capacity(length);
            let read = self.read_cell_section(&name, &mut |piece| {
                content.extend_from_slice(piece);
                Ok(())
            });
            debug_assert!(read.is_ok(), "a list takes all pieces");
            state.sections.insert(name, content);
        }
        state
    }
}

/// Sections with values by cell of a saved state, which are read one by one.
pub trait CellSections {
    /// Returns the length of a section, bytes; `None` if there is no such section.
    fn length(&self, name: &str) -> Option<usize>;

    /// Reads a section; `None` if it cannot be read.
    fn read(&mut self, name: &str) -> Option<Cow<'_, [u8]>>;
}

impl CellSections for &SimulationState {
    fn length(&self, name: &str) -> Option<usize> {
        self.sections.get(name).map(Vec::len)
    }

    fn read(&mut self, name: &str) -> Option<Cow<'_, [u8]>> {
        self.sections.get(name).map(Cow::from)
    }
}

/// Encodes `f64` values as little-endian bytes.
fn to_bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Decodes little-endian `f64` values; `None` if the length is no multiple of 8.
fn from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (numbers, []) = bytes.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// Reason why a simulation was not advanced.
#[derive(Clone, Debug, PartialEq)]
pub enum AdvanceError<F> {
    /// Fault of an unsound state.
    Fault(F),
    /// The threads of the solver cannot be started.
    Threads(ThreadStartError),
}

/// Reason why a run ended without an outcome.
#[derive(Clone, Debug, PartialEq)]
pub enum RunError<E> {
    /// Error that the observer returned.
    Observer(E),
    /// The threads of the solver cannot be started.
    Threads(ThreadStartError),
}

impl<E> From<ThreadStartError> for RunError<E> {
    fn from(error: ThreadStartError) -> Self {
        Self::Threads(error)
    }
}

/// Time-domain simulation: a state that is advanced step by step, and its output.
pub trait Simulation: StateSource {
    /// Energies of a state and the work and dissipation of the steps so far.
    type Account: Clone;
    /// Output fields at a time; of solids, whose fields are read from the simulation by layers, the
    /// [fraction of the step](StepFraction).
    type Fields;
    /// Reason why the simulation cannot continue.
    type Fault;

    /// Returns the number of steps done since time 0.
    fn steps(&self) -> usize;

    /// Returns the time of the present state, s.
    fn time(&self) -> f64;

    /// Whether the state has reached the end of the duration.
    fn is_finished(&self) -> bool;

    /// Compares `time`, s, with the time of the state: `Less` if it is earlier, `Equal` up to rounding.
    fn compare_time(&self, time: f64) -> Ordering;

    /// Checks whether the present state is sound. Solids: its energy is finite. Default (flows): every state is sound.
    ///
    /// # Errors
    /// The fault of an unsound state.
    fn check_state(&self) -> Result<(), Self::Fault> {
        Ok(())
    }

    /// Makes one or more steps, but none after the step that reaches or passes `due`, s; output at that time is then
    /// available from [`account_at`](Self::account_at) and [`fields_at`](Self::fields_at).
    ///
    /// # Errors
    /// A state is unsound: [`recover`](Self::recover) must then return to the last sound one. Or the threads of the
    /// solver cannot be started; the state is then unchanged.
    fn advance(&mut self, due: f64) -> Result<(), AdvanceError<Self::Fault>>;

    /// Returns to the last sound state after a fault, and returns the fault of the state that follows it. If steps must
    /// be repeated, `restore_saved` restores a saved state, if there is one, and `before_batch` is called before each batch
    /// of steps.
    ///
    /// # Errors
    /// The first error of `restore_saved` and `before_batch`, or the threads of the solver cannot be started; the
    /// simulation is unusable afterwards.
    fn recover<E: From<ThreadStartError>>(
        &mut self,
        fault: Self::Fault,
        restore_saved: impl FnOnce(&mut Self) -> Result<bool, E>,
        before_batch: impl FnMut() -> Result<(), E>,
    ) -> Result<Self::Fault, E> {
        let _ = (restore_saved, before_batch);
        Ok(fault)
    }

    /// Delivers the probe records since the last call: for each step its time, s, and the quantities of all probes,
    /// probe by probe.
    ///
    /// # Errors
    /// The first error of `deliver`.
    fn drain_records<E>(
        &mut self,
        deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E>;

    /// Returns the energy account of the present state.
    fn account(&self) -> Self::Account;

    /// Returns the account at `time`, s, which the last [`advance`](Self::advance) reached or passed.
    ///
    /// # Errors
    /// There is no sound state at that time.
    fn account_at(&self, time: f64) -> Result<Self::Account, Self::Fault>;

    /// Returns the output fields of the present state.
    fn fields(&self) -> Self::Fields;

    /// Whether output fields at `time`, s, lie within the next step and are interpolated from those of the present state,
    /// which the observer must keep until then. Default (flows): no.
    fn interpolates_from_present(&self, time: f64) -> bool {
        let _ = time;
        false
    }

    /// Returns the output fields at `time`, s, which the last [`advance`](Self::advance) reached or passed.
    ///
    /// # Errors
    /// There is no sound state at that time.
    fn fields_at(&self, time: f64) -> Result<Self::Fields, Self::Fault>;

    /// Returns which part of the state this process holds; `None` (flows) if there are no parts.
    fn state_part(&self) -> Option<StatePart> {
        None
    }

    /// Restores a state without recording it; `false` if it belongs to another problem.
    fn restore(&mut self, state: &SimulationState) -> bool {
        self.restore_with_cells(state, &mut &*state)
    }

    /// Restores a state, whose sections with values by cell are `cells`, as [`restore`](Self::restore) does. All ranks call
    /// it. If a section cannot be read, it returns `false`, and the simulation is unusable.
    fn restore_with_cells(&mut self, state: &SimulationState, cells: &mut dyn CellSections)
    -> bool;
}

/// Receiver of the output of a simulation.
pub trait Observer<S: Simulation> {
    /// Output failure or interruption of the run.
    type Error;

    /// Receives a record: the time, s, and the quantities of all probes, probe by probe.
    ///
    /// # Errors
    /// The record cannot be written.
    fn on_record(&mut self, time: f64, values: &[f64]) -> Result<(), Self::Error>;

    /// Receives an account that is due.
    ///
    /// # Errors
    /// The account cannot be written.
    fn on_account(&mut self, account: &S::Account) -> Result<(), Self::Error>;

    /// Receives a state whose fields a snapshot within the next step needs, see
    /// [`Simulation::interpolates_from_present`].
    ///
    /// # Errors
    /// The fields cannot be kept.
    fn on_state_before_snapshot(&mut self, simulation: &S) -> Result<(), Self::Error> {
        let _ = simulation;
        Ok(())
    }

    /// Receives a snapshot that is due.
    ///
    /// # Errors
    /// The snapshot cannot be written.
    fn on_snapshot(
        &mut self,
        simulation: &S,
        snapshot: DueSnapshot<S::Fields>,
    ) -> Result<(), Self::Error>;

    /// Called before steps are repeated to find the last sound state before a fault. No checkpoint can be made then;
    /// only those of earlier [`on_steps_done`](Self::on_steps_done) calls exist.
    ///
    /// # Errors
    /// The run is interrupted.
    fn on_replay(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Restores the last state that has been saved in [`on_steps_done`](Self::on_steps_done) or from which the run was
    /// resumed; `false` if there is none. Steps since then are repeated to find the last sound state before a fault, else
    /// all steps.
    ///
    /// # Errors
    /// The state cannot be read.
    fn restore_saved(&mut self, simulation: &mut S) -> Result<bool, Self::Error> {
        let _ = simulation;
        Ok(false)
    }

    /// Called between batches of steps after all output that is due: the [state](StateSource) can be saved as a
    /// checkpoint. `last` is the last account delivered.
    ///
    /// # Errors
    /// The run is interrupted, or the checkpoint cannot be written.
    fn on_steps_done(&mut self, simulation: &S, last: &S::Account) -> Result<(), Self::Error>;
}

/// Snapshot that is due: output fields at an output time.
#[derive(Clone, Debug)]
pub struct DueSnapshot<F> {
    /// Index of the output time, from 0.
    pub index: usize,
    /// Output time, s.
    pub time: f64,
    /// Output fields at this time.
    pub fields: F,
}

/// Times at which accounts and snapshots are due.
#[derive(Clone, Copy, Debug)]
pub struct OutputTimes {
    /// Times at which accounts are due.
    pub accounts: RegularTimes,
    /// Times at which snapshots are due; `None` without snapshots.
    pub snapshots: Option<RegularTimes>,
}

/// Result of a run: its last account, and the fault that ended it, if any.
#[derive(Clone, Debug)]
pub struct SimulationOutcome<S: Simulation> {
    /// Account of the last state.
    pub last_account: S::Account,
    /// Fault that ended the run; `None` if it reached its duration.
    pub fault: Option<S::Fault>,
}

/// Runs a simulation from its initial state or, if `is_resumed`, from a restored state to the end of its duration.
///
/// # Errors
/// The first error of the observer, or the threads of the solver cannot be started. Output up to the last call of
/// [`Observer::on_steps_done`] has then been delivered.
pub fn run_simulation<S: Simulation, O: Observer<S>>(
    simulation: &mut S,
    output: &OutputTimes,
    is_resumed: bool,
    observer: &mut O,
) -> Result<SimulationOutcome<S>, RunError<O::Error>> {
    let last = simulation.account();
    let mut driver = RunDriver {
        simulation,
        observer,
        output,
        account_count: 0,
        snapshot_count: 0,
        last_account: last,
    };
    if is_resumed {
        driver.account_count = output.accounts.count_reached(driver.simulation);
        driver.snapshot_count =
            output.snapshots.map_or(0, |own| own.count_reached(driver.simulation));
    }
    let fault = match driver.run_to_end(is_resumed) {
        Ok(()) => None,
        Err(EarlyEndCause::Fault(fault)) => Some(fault),
        Err(EarlyEndCause::Run(error)) => return Err(error),
    };
    Ok(SimulationOutcome { last_account: driver.last_account, fault })
}

/// Cause of the end of a run before its duration is over.
enum EarlyEndCause<F, E> {
    Fault(F),
    Run(RunError<E>),
}

impl<F, E> EarlyEndCause<F, E> {
    /// Creates the cause from an error of the observer.
    fn from_observer(error: E) -> Self {
        Self::Run(RunError::Observer(error))
    }
}

type DriverResult<S, O> =
    Result<(), EarlyEndCause<<S as Simulation>::Fault, <O as Observer<S>>::Error>>;

/// Run in progress: simulation, observer, and what has been delivered so far.
struct RunDriver<'a, S: Simulation, O> {
    simulation: &'a mut S,
    observer: &'a mut O,
    output: &'a OutputTimes,
    /// Number of accounts delivered or, in a resumed run, due before.
    account_count: usize,
    /// Number of snapshots delivered.
    snapshot_count: usize,
    /// Last account delivered; before the first one, that of the initial or restored state.
    last_account: S::Account,
}

impl<S: Simulation, O: Observer<S>> RunDriver<'_, S, O> {
    /// Runs to the end of the duration or to an early end, and delivers the output.
    fn run_to_end(&mut self, is_resumed: bool) -> DriverResult<S, O> {
        self.simulation.check_state().map_err(EarlyEndCause::Fault)?;
        let start = if is_resumed { Ok(()) } else { self.deliver_due_output() };
        match start.and_then(|()| self.run_steps()) {
            Err(EarlyEndCause::Fault(fault)) => {
                self.deliver_last_state().map_err(EarlyEndCause::from_observer)?;
                Err(EarlyEndCause::Fault(fault))
            }
            end => end,
        }
    }

    /// Advances in batches of steps to the end of the duration, and delivers the output that is due.
    fn run_steps(&mut self) -> DriverResult<S, O> {
        while !self.simulation.is_finished() {
            let due = self.next_output_time();
            if self
                .next_snapshot_time()
                .is_some_and(|own| self.simulation.interpolates_from_present(own))
            {
                self.observer
                    .on_state_before_snapshot(self.simulation)
                    .map_err(EarlyEndCause::from_observer)?;
            }
            match self.simulation.advance(due) {
                Ok(()) => {}
                Err(AdvanceError::Threads(error)) => return Err(EarlyEndCause::Run(error.into())),
                Err(AdvanceError::Fault(fault)) => {
                    let observer = RefCell::new(&mut *self.observer);
                    let restore_saved = |simulation: &mut S| {
                        observer.borrow_mut().restore_saved(simulation).map_err(RunError::Observer)
                    };
                    let before_batch =
                        || observer.borrow_mut().on_replay().map_err(RunError::Observer);
                    let found = self.simulation.recover(fault, restore_saved, before_batch);
                    return Err(found.map_or_else(EarlyEndCause::Run, EarlyEndCause::Fault));
                }
            }
            self.deliver_due_output()?;
            self.observer
                .on_steps_done(self.simulation, &self.last_account)
                .map_err(EarlyEndCause::from_observer)?;
        }
        Ok(())
    }

    /// Returns the next time at which an account or a snapshot is due, s; infinity if none is.
    fn next_output_time(&self) -> f64 {
        let account = self.output.accounts.time(self.account_count);
        account.into_iter().chain(self.next_snapshot_time()).fold(f64::INFINITY, f64::min)
    }

    /// Returns the next time at which a snapshot is due, s.
    fn next_snapshot_time(&self) -> Option<f64> {
        self.output.snapshots.and_then(|own| own.time(self.snapshot_count))
    }

    /// Delivers all records, and the accounts and snapshots that are due.
    fn deliver_due_output(&mut self) -> DriverResult<S, O> {
        self.deliver_probe_records().map_err(EarlyEndCause::from_observer)?;
        while let Some(time) = self.reached_time(self.output.accounts, self.account_count) {
            self.last_account = self.simulation.account_at(time).map_err(EarlyEndCause::Fault)?;
            self.observer.on_account(&self.last_account).map_err(EarlyEndCause::from_observer)?;
            self.account_count += 1;
        }
        let Some(times) = self.output.snapshots else { return Ok(()) };
        while let Some(time) = self.reached_time(times, self.snapshot_count) {
            let fields = self.simulation.fields_at(time).map_err(EarlyEndCause::Fault)?;
            let due = DueSnapshot { index: self.snapshot_count, time, fields };
            self.observer
                .on_snapshot(self.simulation, due)
                .map_err(EarlyEndCause::from_observer)?;
            self.snapshot_count += 1;
        }
        Ok(())
    }

    /// Passes the probe records since the last call to the observer.
    fn deliver_probe_records(&mut self) -> Result<(), O::Error> {
        self.simulation.drain_records(|time, values| self.observer.on_record(time, values))
    }

    /// Returns output time `index`, s, if the simulation has reached it.
    fn reached_time(&self, times: RegularTimes, index: usize) -> Option<f64> {
        times.time(index).filter(|time| self.simulation.compare_time(*time) != Ordering::Greater)
    }

    /// Delivers the records and, unless it was due, the account of the last sound state.
    fn deliver_last_state(&mut self) -> Result<(), O::Error> {
        self.deliver_probe_records()?;
        let last =
            self.account_count.checked_sub(1).and_then(|last| self.output.accounts.time(last));
        if last.is_some_and(|time| self.simulation.compare_time(time) == Ordering::Equal) {
            return Ok(());
        }
        self.last_account = self.simulation.account();
        self.observer.on_account(&self.last_account)
    }
}
