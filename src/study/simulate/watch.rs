//! Observer of the driver that converts its output to rows and fields for a recorder.

use super::{Effort, Fields, Head, Moment, Recorder, Records, Stopped, TableKind};
use crate::Error;
use crate::case::Case;
use crate::case::dynamics::Receiver;
use dynamics::simulation::{Observer, OutputTimes, RegularTimes, Simulation, drive};
use std::fmt::Display;

/// Conversion of the output of one kind of simulation.
pub(super) trait View<S: Simulation> {
    /// Returns the receiver table, and the indices of its columns in the probe record; `None` without receivers.
    fn receivers(&self) -> Option<(Head, Vec<usize>)>;

    /// Converts a value at an index of the probe record to the unit of the table.
    fn to_display_unit(&self, _place: usize, value: f64) -> f64 {
        value
    }

    /// Returns the tables of energy accounts.
    fn tables(&self) -> Vec<Head>;

    /// Returns one row for each of these tables from an account.
    fn rows(&self, account: &S::Account) -> Vec<Vec<f64>>;

    /// Converts the output fields at `time`, s.
    fn fields(&self, simulation: &S, fields: S::Fields, time: f64) -> Fields;

    /// Returns the statistics of the time steps; `last` is the last account recorded.
    fn effort(&self, simulation: &S, last: &S::Account) -> Effort;

    /// Creates the report of a stopped simulation; `saved` is the time of the last valid state, s.
    fn stopped(&self, fault: &S::Fault, saved: f64) -> Stopped;
}

/// Raw result of a simulation; `A` is the type of its energy account.
pub(super) struct Found<A> {
    /// Final fields.
    pub(super) fields: Fields,
    /// Energy account of the final state.
    pub(super) last: A,
    pub(super) steps: usize,
    /// Simulated time reached, s.
    pub(super) time: f64,
    pub(super) stopped: Option<Stopped>,
    pub(super) records: Records,
}

/// Returns the times of accounts and snapshots at the given intervals within `duration`, s; a snapshot interval of 0
/// means none.
pub(super) fn output_times(accounts: f64, snapshots: f64, duration: f64) -> OutputTimes {
    let has_snapshots = snapshots > 0.0;
    OutputTimes {
        accounts: RegularTimes::new(accounts, duration),
        snapshots: has_snapshots.then(|| RegularTimes::new(snapshots, duration)),
    }
}

/// Runs a simulation of `duration`, s, from its beginning or from the state of the recorder.
pub(super) fn run<S: Simulation, V: View<S>>(
    view: &V,
    mut simulation: S,
    output: &OutputTimes,
    duration: f64,
    recorder: &mut dyn Recorder,
) -> Result<Found<S::Account>, Error> {
    let (receivers, columns) = view.receivers().unzip();
    let accounts = view.tables();
    let tables: Vec<Head> = receivers.into_iter().chain(accounts.iter().cloned()).collect();
    let is_resumed = recorder.is_resumed();
    recorder.start(&tables, output.snapshots, &mut |state| {
        let is_own = simulation.restore(state);
        is_own.then(|| output.snapshots.map_or(0, |times| times.reached(&simulation)))
    })?;
    let mut watch = Watch {
        view,
        recorder,
        columns: columns.unwrap_or_default(),
        accounts: accounts.iter().map(|head| head.kind).collect(),
        duration,
    };
    let end = drive(&mut simulation, output, is_resumed, &mut watch)?;
    let records = watch.look(&simulation, &end.last, |recorder, now| recorder.finish(now))?;
    Ok(Found {
        fields: view.fields(&simulation, simulation.fields(), simulation.time()),
        last: end.last,
        steps: simulation.steps(),
        time: simulation.time(),
        stopped: end.fault.map(|fault| view.stopped(&fault, simulation.time())),
        records,
    })
}

/// Observer that converts driver output and passes it to the recorder.
struct Watch<'a, V> {
    view: &'a V,
    recorder: &'a mut dyn Recorder,
    /// Indices of the receiver table columns in the probe record.
    columns: Vec<usize>,
    /// Tables of energy accounts.
    accounts: Vec<TableKind>,
    /// Duration, s.
    duration: f64,
}

impl<V> Watch<'_, V> {
    fn look<S: Simulation, R>(
        &mut self,
        simulation: &S,
        last: &S::Account,
        take: impl FnOnce(&mut dyn Recorder, &Moment) -> R,
    ) -> R
    where
        V: View<S>,
    {
        let moment = Moment {
            steps: simulation.steps(),
            time: simulation.time(),
            duration: self.duration,
            is_finished: simulation.is_finished(),
            effort: self.view.effort(simulation, last),
            state: &|| simulation.state(),
        };
        take(self.recorder, &moment)
    }
}

impl<S: Simulation, V: View<S>> Observer<S> for Watch<'_, V> {
    type Error = Error;

    fn record(&mut self, time: f64, values: &[f64]) -> Result<(), Error> {
        let value = |&place: &usize| self.view.to_display_unit(place, values[place]);
        let row: Vec<f64> = std::iter::once(time).chain(self.columns.iter().map(value)).collect();
        self.recorder.row(TableKind::Receivers, &row)
    }

    fn account(&mut self, account: &S::Account) -> Result<(), Error> {
        let rows = self.view.rows(account);
        self.accounts.iter().zip(rows).try_for_each(|(table, row)| self.recorder.row(*table, &row))
    }

    fn snapshot(
        &mut self,
        simulation: &S,
        index: usize,
        time: f64,
        fields: S::Fields,
    ) -> Result<(), Error> {
        self.recorder.snapshot(index, self.view.fields(simulation, fields, time))
    }

    fn replay(&mut self) -> Result<(), Error> {
        self.recorder.replay()
    }

    fn after_steps(&mut self, simulation: &S, last: &S::Account) -> Result<(), Error> {
        self.look(simulation, last, |recorder, now| recorder.after_steps(now))
    }
}

/// Creates the receiver table, and the indices of its columns in the probe record, which holds all quantities `names`
/// receiver by receiver; `None` without receivers.
pub(super) fn receivers_table<F: Display>(
    case: &Case,
    receivers: &[Receiver<F>],
    names: &[impl AsRef<str>],
) -> Option<(Head, Vec<usize>)> {
    let mut header = vec!["time".to_owned()];
    let mut columns = Vec::new();
    for (index, receiver) in receivers.iter().enumerate() {
        for name in receiver.fields.iter().map(ToString::to_string) {
            if let Some(place) = names.iter().position(|own| own.as_ref() == name) {
                header.push(format!("{}.{name}", receiver.name));
                columns.push(index * names.len() + place);
            }
        }
    }
    (!receivers.is_empty()).then(|| (Head::new(case, TableKind::Receivers, header), columns))
}
