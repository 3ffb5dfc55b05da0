//! Time loop of all time-domain simulations.
//!
//! A [`Simulation`] holds a state and advances it, an [`Observer`] receives the output, and [`drive`] is the loop:
//!
//! 1. If the initial state is unsound, the run ends with it.
//! 2. A new run delivers the record, the account and the snapshot of its initial state. For a resumed run all output
//!    due up to the restored state has been delivered before.
//! 3. Until the end of the duration, the simulation advances by a batch of steps towards the next time at which an
//!    account or a snapshot is due. The observer receives the records of these steps and the accounts and snapshots
//!    that are due, then the simulation itself (progress, checkpoints).
//! 4. A run ends at its duration, by a fault (an unsound state), or by an error of the observer (which is how it is
//!    interrupted). After a fault the simulation is at its last sound state, whose records and account are delivered if
//!    they have not been.
//!
//! Steps do not depend on the output. A run resumed from a saved [`State`] delivers the same bits as an uninterrupted
//! one. This module writes no files; observers do.

mod flow;
mod regular_times;
mod solid;
mod solver;
mod time_steps;

pub use flow::{FlowAccount, FlowFields, FlowSimulation};
pub use regular_times::RegularTimes;
pub use solid::{SolidAccount, SolidFault, SolidFields, SolidSimulation};
pub use solver::SolverChoice;
pub use time_steps::{StepLimit, TimeSteps, TooManySteps};

use std::cmp::Ordering;
use std::collections::BTreeMap;

/// State of a simulation, sufficient to continue it bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Number of steps done.
    pub steps: usize,
    /// Time of the state, s.
    pub time: f64,
    /// Energy at time 0: J (solids), J/m³ (flows).
    pub initial_energy: f64,
    /// Arrays by name, as little-endian bytes.
    pub sections: BTreeMap<String, Vec<u8>>,
}

impl State {
    /// Iterates over the sections `name0`, `name1`, …
    fn numbered(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        (0..)
            .map_while(move |index| self.sections.get(&format!("{name}{index}")).map(Vec::as_slice))
    }
}

/// Names sections `name0`, `name1`, …
fn number(
    name: &str,
    sections: impl Iterator<Item = Vec<u8>>,
) -> impl Iterator<Item = (String, Vec<u8>)> {
    sections.enumerate().map(move |(index, own)| (format!("{name}{index}"), own))
}

fn to_bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// Decodes little-endian `f64` values; `None` if the length is no multiple of 8.
fn from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (numbers, []) = bytes.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// A state that can be advanced step by step.
pub trait Simulation {
    /// Energies of a state and the work and dissipation of the steps so far.
    type Account: Clone;
    /// All output fields of a state.
    type Fields;
    /// Reason why the simulation cannot continue.
    type Fault;

    /// Number of steps done.
    fn steps(&self) -> usize;

    /// Time of the state, s.
    fn time(&self) -> f64;

    /// Whether the duration is over.
    fn is_finished(&self) -> bool;

    /// Compares `time`, s, with the time of the state: `Less` if it is earlier, `Equal` up to rounding.
    fn compare(&self, time: f64) -> Ordering;

    /// Checks whether the present state is sound.
    ///
    /// # Errors
    /// The fault of an unsound state.
    fn check(&self) -> Result<(), Self::Fault> {
        Ok(())
    }

    /// Makes one step or more, and no further step once `due`, s, is reached or passed; output at that time is then
    /// available from [`account_at`](Self::account_at) and [`fields_at`](Self::fields_at).
    ///
    /// # Errors
    /// A state is unsound: [`recover`](Self::recover) must then return to the last sound one.
    fn advance(&mut self, due: f64) -> Result<(), Self::Fault>;

    /// Returns to the last sound state after a fault and gives the fault of the state after it. If steps must be
    /// repeated, `go_on` is called before each batch of them.
    ///
    /// # Errors
    /// The first error of `go_on`; the simulation is unusable afterwards.
    fn recover<E>(
        &mut self,
        fault: Self::Fault,
        go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Self::Fault, E> {
        let _ = go_on;
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

    /// Returns the output fields at `time`, s, which the last [`advance`](Self::advance) reached or passed.
    ///
    /// # Errors
    /// There is no sound state at that time.
    fn fields_at(&self, time: f64) -> Result<Self::Fields, Self::Fault>;

    /// Returns the state for a checkpoint.
    fn state(&self) -> State;

    /// Restores a state without recording it; `false` if it belongs to another problem.
    fn restore(&mut self, state: &State) -> bool;
}

/// Receiver of the output of a simulation.
pub trait Observer<S: Simulation> {
    /// Output failure or interruption of the run.
    type Error;

    /// Receives a record: the time, s, and the quantities of all probes, probe by probe.
    ///
    /// # Errors
    /// The record cannot be written.
    fn record(&mut self, time: f64, values: &[f64]) -> Result<(), Self::Error>;

    /// Receives an account that is due.
    ///
    /// # Errors
    /// The account cannot be written.
    fn account(&mut self, account: &S::Account) -> Result<(), Self::Error>;

    /// Receives a snapshot that is due: index from 0, time, s, and fields.
    ///
    /// # Errors
    /// The snapshot cannot be written.
    fn snapshot(
        &mut self,
        simulation: &S,
        index: usize,
        time: f64,
        fields: S::Fields,
    ) -> Result<(), Self::Error>;

    /// Called before steps are repeated to find the last sound state before a fault. No checkpoint can be made then;
    /// only those of earlier [`after_steps`](Self::after_steps) calls exist.
    ///
    /// # Errors
    /// The run is interrupted.
    fn replay(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// Called between batches of steps after all output that is due: the [`state`](Simulation::state) can be saved as a
    /// checkpoint. `last` is the last account delivered.
    ///
    /// # Errors
    /// The run is interrupted.
    fn after_steps(&mut self, simulation: &S, last: &S::Account) -> Result<(), Self::Error>;
}

/// Output times.
#[derive(Clone, Copy, Debug)]
pub struct OutputTimes {
    /// Times of accounts.
    pub accounts: RegularTimes,
    /// Times of snapshots, if any.
    pub snapshots: Option<RegularTimes>,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct End<S: Simulation> {
    /// Account of the last state.
    pub last: S::Account,
    /// Fault that ended the run.
    pub fault: Option<S::Fault>,
}

/// Runs a simulation from its initial state or, if `is_resumed`, from a restored state to the end of its duration.
///
/// # Errors
/// The first error of the observer.
pub fn drive<S: Simulation, O: Observer<S>>(
    simulation: &mut S,
    output: &OutputTimes,
    is_resumed: bool,
    observer: &mut O,
) -> Result<End<S>, O::Error> {
    let last = simulation.account();
    let mut driver = Driver { simulation, observer, output, accounts: 0, snapshots: 0, last };
    if is_resumed {
        driver.accounts = output.accounts.reached(driver.simulation);
        driver.snapshots = output.snapshots.map_or(0, |own| own.reached(driver.simulation));
    }
    let fault = match driver.run(is_resumed) {
        Ok(()) => None,
        Err(Stop::Fault(fault)) => Some(fault),
        Err(Stop::Observer(error)) => return Err(error),
    };
    Ok(End { last: driver.last, fault })
}

/// Cause of an early end of a run.
enum Stop<F, E> {
    Fault(F),
    Observer(E),
}

type Run<S, O> = Result<(), Stop<<S as Simulation>::Fault, <O as Observer<S>>::Error>>;

/// State of a run in progress.
struct Driver<'a, S: Simulation, O> {
    simulation: &'a mut S,
    observer: &'a mut O,
    output: &'a OutputTimes,
    /// Number of accounts delivered.
    accounts: usize,
    /// Number of snapshots delivered.
    snapshots: usize,
    /// Last account delivered; before the first one, that of the initial state.
    last: S::Account,
}

impl<S: Simulation, O: Observer<S>> Driver<'_, S, O> {
    fn run(&mut self, is_resumed: bool) -> Run<S, O> {
        self.simulation.check().map_err(Stop::Fault)?;
        let start = if is_resumed { Ok(()) } else { self.deliver() };
        match start.and_then(|()| self.steps()) {
            Err(Stop::Fault(fault)) => {
                self.close().map_err(Stop::Observer)?;
                Err(Stop::Fault(fault))
            }
            end => end,
        }
    }

    fn steps(&mut self) -> Run<S, O> {
        while !self.simulation.is_finished() {
            let due = self.next_output();
            if let Err(fault) = self.simulation.advance(due) {
                let found = self.simulation.recover(fault, || self.observer.replay());
                return Err(Stop::Fault(found.map_err(Stop::Observer)?));
            }
            self.deliver()?;
            self.observer.after_steps(self.simulation, &self.last).map_err(Stop::Observer)?;
        }
        Ok(())
    }

    /// Returns the next time at which an account or a snapshot is due, s.
    fn next_output(&self) -> f64 {
        let account = self.output.accounts.time(self.accounts);
        let snapshot = self.output.snapshots.and_then(|own| own.time(self.snapshots));
        account.into_iter().chain(snapshot).fold(f64::INFINITY, f64::min)
    }

    /// Delivers all records, and the accounts and snapshots that are due.
    fn deliver(&mut self) -> Run<S, O> {
        self.deliver_records().map_err(Stop::Observer)?;
        while let Some(time) = self.due(self.output.accounts, self.accounts) {
            self.last = self.simulation.account_at(time).map_err(Stop::Fault)?;
            self.observer.account(&self.last).map_err(Stop::Observer)?;
            self.accounts += 1;
        }
        let Some(times) = self.output.snapshots else { return Ok(()) };
        while let Some(time) = self.due(times, self.snapshots) {
            let fields = self.simulation.fields_at(time).map_err(Stop::Fault)?;
            self.observer
                .snapshot(self.simulation, self.snapshots, time, fields)
                .map_err(Stop::Observer)?;
            self.snapshots += 1;
        }
        Ok(())
    }

    fn deliver_records(&mut self) -> Result<(), O::Error> {
        self.simulation.drain_records(|time, values| self.observer.record(time, values))
    }

    /// Returns output time `index`, s, if the simulation has reached it.
    fn due(&self, times: RegularTimes, index: usize) -> Option<f64> {
        times.time(index).filter(|time| self.simulation.compare(*time) != Ordering::Greater)
    }

    /// Delivers the records and, unless it was due, the account of the last sound state.
    fn close(&mut self) -> Result<(), O::Error> {
        self.deliver_records()?;
        let last = self.accounts.checked_sub(1).and_then(|last| self.output.accounts.time(last));
        if last.is_some_and(|time| self.simulation.compare(time) == Ordering::Equal) {
            return Ok(());
        }
        self.last = self.simulation.account();
        self.observer.account(&self.last)
    }
}
