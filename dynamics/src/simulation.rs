//! One driver for all that is solved in time.
//!
//! A [`Simulation`] holds a state and makes steps, an [`Observer`] takes the output, and [`drive`] is the loop:
//!
//! 1. Where the state is unsound before the first step, the run ends with it.
//! 2. A run from its beginning delivers the record, the account and the snapshot of its first state. A resumed one has
//!    delivered all that was due up to its state, which the observer kept with it.
//! 3. Until the duration is over, the simulation makes a batch of steps towards the next time at which an account or
//!    a snapshot is due. The observer takes the records of all these steps, the accounts and the snapshots that are
//!    due by now, and then looks at the simulation itself: for progress and for checkpoints.
//! 4. A run ends at its duration; or by a fault, an unsound state: then the simulation stands at its last sound state,
//!    whose records and account are delivered if they have not been; or by an error of the observer, which is how it is
//!    interrupted.
//!
//! Steps do not depend on the output. What goes on from a saved [`State`] delivers the same bits as a run that was
//! never interrupted. No files here: they are the observer's.

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

/// All that the steps to come depend on, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Steps done.
    pub steps: usize,
    /// The time that these led to, s.
    pub time: f64,
    /// Energy at the beginning, J, of flows J/m³.
    pub initial_energy: f64,
    /// Numbers by name, as bytes, the least significant first.
    pub sections: BTreeMap<String, Vec<u8>>,
}

impl State {
    /// Sections of that name with their numbers from 0 on.
    fn numbered(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        (0..)
            .map_while(move |index| self.sections.get(&format!("{name}{index}")).map(Vec::as_slice))
    }
}

/// Sections under a name with their numbers from 0 on.
fn number(
    name: &str,
    sections: impl Iterator<Item = Vec<u8>>,
) -> impl Iterator<Item = (String, Vec<u8>)> {
    sections.enumerate().map(move |(index, own)| (format!("{name}{index}"), own))
}

fn to_bytes(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// `None` where one is not whole.
fn from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (numbers, []) = bytes.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// A state that makes steps in time.
pub trait Simulation {
    /// Energies of a state, and what steps have done to them.
    type Account: Clone;
    /// All fields of a state.
    type Fields;
    /// Why it does not go on.
    type Fault;

    /// Steps done.
    fn steps(&self) -> usize;

    /// Time of the state, s.
    fn time(&self) -> f64;

    /// Whether the duration is over.
    fn is_finished(&self) -> bool;

    /// How a time, s, compares with that of the state: `Less` where it is past, `Equal` where it is that of the
    /// state but for rounding.
    fn compare(&self, time: f64) -> Ordering;

    /// Whether the present state is sound.
    ///
    /// # Errors
    /// Why it is not.
    fn check(&self) -> Result<(), Self::Fault> {
        Ok(())
    }

    /// Makes one step or more: never more than end at or beyond `due`, s, a time to come, of which
    /// [`account_at`](Self::account_at) and [`fields_at`](Self::fields_at) are wanted then.
    ///
    /// # Errors
    /// A state is unsound: [`recover`](Self::recover) is to go back to the last one that is not.
    fn advance(&mut self, due: f64) -> Result<(), Self::Fault>;

    /// Goes back to the last sound state after a fault, and says what is wrong with the one after it. Where steps have to
    /// be made again for that, `go_on` is asked before each batch of them.
    ///
    /// # Errors
    /// The first one of `go_on`; the simulation is of no use then.
    fn recover<E>(
        &mut self,
        fault: Self::Fault,
        go_on: impl FnMut() -> Result<(), E>,
    ) -> Result<Self::Fault, E> {
        let _ = go_on;
        Ok(fault)
    }

    /// Hands over what the probes recorded since the last call, of each step its time, s, and the quantities of all
    /// probes, probe by probe.
    ///
    /// # Errors
    /// The first one of `deliver`.
    fn drain_records<E>(
        &mut self,
        deliver: impl FnMut(f64, &[f64]) -> Result<(), E>,
    ) -> Result<(), E>;

    /// The account of the present state.
    fn account(&self) -> Self::Account;

    /// The account at a time, s, that the last [`advance`](Self::advance) came to or passed.
    ///
    /// # Errors
    /// There is no sound state then.
    fn account_at(&self, time: f64) -> Result<Self::Account, Self::Fault>;

    /// The fields of the present state.
    fn fields(&self) -> Self::Fields;

    /// The fields at a time, s, that the last [`advance`](Self::advance) came to or passed.
    ///
    /// # Errors
    /// There is no sound state then.
    fn fields_at(&self, time: f64) -> Result<Self::Fields, Self::Fault>;

    /// All that the steps to come depend on.
    fn state(&self) -> State;

    /// Goes to a state of the same problem, of which nothing is recorded; `false` where it is one of another.
    fn restore(&mut self, state: &State) -> bool;
}

/// Takes the output of a simulation.
pub trait Observer<S: Simulation> {
    /// Why output cannot be taken, or that somebody has interrupted the run.
    type Error;

    /// What the probes recorded of a state: its time, s, and the quantities of all probes, probe by probe.
    ///
    /// # Errors
    /// It cannot be taken.
    fn record(&mut self, time: f64, values: &[f64]) -> Result<(), Self::Error>;

    /// An account that was due.
    ///
    /// # Errors
    /// It cannot be taken.
    fn account(&mut self, account: &S::Account) -> Result<(), Self::Error>;

    /// A snapshot that was due: its number from 0 on, its time, s, and the fields.
    ///
    /// # Errors
    /// It cannot be taken.
    fn snapshot(
        &mut self,
        simulation: &S,
        index: usize,
        time: f64,
        fields: S::Fields,
    ) -> Result<(), Self::Error>;

    /// Steps are about to be made again, to find the last sound state before a fault. There is no state to resume from
    /// then but those of earlier looks.
    ///
    /// # Errors
    /// The run is to end here.
    fn replay(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }

    /// A look at the simulation between two batches of steps, when all output that is due has been taken: its
    /// [`state`](Simulation::state) now is one to resume from. `last` is the last account delivered.
    ///
    /// # Errors
    /// The run is to end here.
    fn after_steps(&mut self, simulation: &S, last: &S::Account) -> Result<(), Self::Error>;
}

/// When output is due.
#[derive(Clone, Copy, Debug)]
pub struct OutputTimes {
    /// Accounts.
    pub accounts: RegularTimes,
    /// Snapshots, if there are to be any.
    pub snapshots: Option<RegularTimes>,
}

/// The end of a run.
#[derive(Clone, Debug)]
pub struct End<S: Simulation> {
    /// The account of the last state.
    pub last: S::Account,
    /// The unsound state that ended it.
    pub fault: Option<S::Fault>,
}

/// Makes all steps of a simulation, from its beginning or, where it `is_resumed`, from the state that it was restored
/// to.
///
/// # Errors
/// The first one of the observer.
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

/// What ends a run early.
enum Stop<F, E> {
    Fault(F),
    Observer(E),
}

type Run<S, O> = Result<(), Stop<<S as Simulation>::Fault, <O as Observer<S>>::Error>>;

/// A run under way.
struct Driver<'a, S: Simulation, O> {
    simulation: &'a mut S,
    observer: &'a mut O,
    output: &'a OutputTimes,
    /// Accounts delivered.
    accounts: usize,
    /// Snapshots delivered.
    snapshots: usize,
    /// The last account delivered; that of the first state before there is any.
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

    /// The next time at which an account or a snapshot is due, s.
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

    /// The time of that number, s, if the simulation has come to it.
    fn due(&self, times: RegularTimes, index: usize) -> Option<f64> {
        times.time(index).filter(|time| self.simulation.compare(*time) != Ordering::Greater)
    }

    /// Delivers the records and the account of the last sound state, if the account was not due.
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
