//! Observer of the simulation driver that converts its output to table rows and fields for a recorder.

use super::stored_fields::StoredFields;
use super::{
    FieldSource, OutputFields, OutputPart, Recorder, RunProgress, RunRecords, SavedState,
    StepStatistics, StopReport, TableHeader, TableKind,
};
use crate::Error;
use crate::case::Case;
use crate::case::dynamics::ReceiverPoint;
use dynamics::simulation::{
    DueSnapshot, Observer, OutputTimes, RegularTimes, Simulation, run_simulation,
};
use std::cell::Cell;
use std::fmt::Display;
use std::io;
use std::ops::Range;

/// Converter of the output of a solver to table rows, output fields and reports.
pub(super) trait OutputConverter<S: Simulation> {
    /// Returns the receiver table, and for each of its columns after `time` the index in the probe record; `None`
    /// without receivers.
    fn receiver_table(&self) -> Option<(TableHeader, Vec<usize>)>;

    /// Converts the value at an index of the probe record to the unit of the receiver table.
    fn to_display_unit(&self, _index: usize, value: f64) -> f64 {
        value
    }

    /// Returns the headers of all tables that contain energy accounts.
    fn account_tables(&self) -> Vec<TableHeader>;

    /// Returns one row for each of the [`account_tables`](Self::account_tables) from an energy account.
    fn account_rows(&self, account: &S::Account) -> Vec<Vec<f64>>;

    /// Returns the number of layers of cells of this process across the last axis, and the number of cells of each, for
    /// [`convert_layers`](Self::convert_layers).
    fn layers(&self, simulation: &S) -> [usize; 2];

    /// Converts the output fields `fields` at `time`, s, in some layers of cells; without joints. Those of solids are those
    /// of the present state.
    fn convert_layers(
        &self,
        simulation: &S,
        fields: &S::Fields,
        layers: Range<usize>,
        time: f64,
    ) -> OutputFields;

    /// Returns the output fields as [`convert_layers`](Self::convert_layers) does without values by cell, with joints.
    fn describe_fields(&self, simulation: &S, fields: &S::Fields, time: f64) -> OutputFields;

    /// Returns the fraction of the last step at which solids interpolate output fields between the states before and after
    /// it; `None` if `fields` need no interpolation.
    fn step_fraction(&self, _fields: &S::Fields) -> Option<f64> {
        None
    }

    /// Estimates the largest strain of the fields of some cells; 0 for flows.
    fn find_largest_strain(&self, _fields: &OutputFields) -> f64 {
        0.0
    }

    /// Returns the part of the cells that this process holds; `None` (flows) if there are no parts.
    fn find_part(&self, _simulation: &S) -> Option<OutputPart> {
        None
    }

    /// Returns the statistics of the time steps; `last` is the most recent recorded account.
    fn step_statistics(&self, simulation: &S, last: &S::Account) -> StepStatistics;

    /// Creates the report of a stopped simulation; `saved` is the time of the last valid state, s.
    fn stop_report(&self, fault: &S::Fault, saved: f64) -> StopReport;
}

/// Result of a simulation before its conversion to a [`RunResult`](super::RunResult); `A` is the type of its energy
/// account.
pub(super) struct SimulationOutput<A> {
    /// Output fields of the final state, or their description if the recorder has written their values.
    pub(super) fields: OutputFields,
    /// Whether `fields` has the values by cell.
    pub(super) has_field_values: bool,
    /// Estimate of the largest strain of the final state.
    pub(super) largest_strain: f64,
    /// Energy account of the final state.
    pub(super) final_account: A,
    pub(super) step_count: usize,
    /// Simulated time reached, s.
    pub(super) final_time: f64,
    pub(super) stop_report: Option<StopReport>,
    pub(super) records: RunRecords,
}

/// Returns the output times within `duration`, s: energy accounts at intervals of `accounts`, s, and snapshots at
/// intervals of `snapshots`, s; 0 stands for no snapshots.
pub(super) fn create_output_times(accounts: f64, snapshots: f64, duration: f64) -> OutputTimes {
    let has_snapshots = snapshots > 0.0;
    OutputTimes {
        accounts: RegularTimes::new(accounts, duration),
        snapshots: has_snapshots.then(|| RegularTimes::new(snapshots, duration)),
    }
}

/// Runs a simulation of `duration`, s, from its beginning or from the state saved by the recorder.
pub(super) fn run_with_recorder<S: Simulation, V: OutputConverter<S>>(
    converter: &V,
    mut simulation: S,
    output: &OutputTimes,
    duration: f64,
    recorder: &mut dyn Recorder,
) -> Result<SimulationOutput<S::Account>, Error> {
    let (receivers, columns) = converter.receiver_table().unzip();
    let accounts = converter.account_tables();
    let tables: Vec<TableHeader> = receivers.into_iter().chain(accounts.iter().cloned()).collect();
    let is_resumed = recorder.is_resumed();
    if let Some(part) = converter.find_part(&simulation) {
        recorder.set_part(part);
    }
    recorder.start(&tables, output.snapshots, &mut |state, cells| {
        let is_own = simulation.restore_with_cells(state, cells);
        is_own.then(|| output.snapshots.map_or(0, |times| times.count_reached(&simulation)))
    })?;
    let mut watch = RecorderObserver {
        converter,
        recorder,
        receiver_columns: columns.unwrap_or_default(),
        account_table_kinds: accounts.iter().map(|head| head.kind).collect(),
        duration,
        fields_before: None,
    };
    let end = run_simulation(&mut simulation, output, is_resumed, &mut watch)?;
    let records =
        watch.report_progress_to_recorder(&simulation, &end.last_account, |recorder, now| {
            recorder.finish(now)
        })?;
    let present = simulation.fields();
    let source = TimeFields::new(converter, &simulation, (&present, simulation.time()), None);
    let fields = recorder.record_final_fields(&source)?;
    let largest_strain = source.largest_strain.get();
    Ok(SimulationOutput {
        has_field_values: fields.is_some(),
        fields: fields.unwrap_or_else(|| source.describe()),
        largest_strain,
        final_account: end.last_account,
        step_count: simulation.steps(),
        final_time: simulation.time(),
        stop_report: end.fault.map(|fault| converter.stop_report(&fault, simulation.time())),
        records,
    })
}

/// Output fields of a simulation at a time, within or at the end of its last step.
struct TimeFields<'a, S: Simulation, V> {
    converter: &'a V,
    simulation: &'a S,
    fields: &'a S::Fields,
    /// Time of the fields, s.
    time: f64,
    /// Fields before the last step, and the fraction of this step, between which fields are interpolated.
    before: Option<(&'a io::Result<StoredFields>, f64)>,
    /// Largest strain of the fields that have been read.
    largest_strain: Cell<f64>,
}

impl<'a, S: Simulation, V: OutputConverter<S>> TimeFields<'a, S, V> {
    fn new(
        converter: &'a V,
        simulation: &'a S,
        (fields, time): (&'a S::Fields, f64),
        before: Option<&'a io::Result<StoredFields>>,
    ) -> Self {
        let before = before.zip(converter.step_fraction(fields));
        Self { converter, simulation, fields, time, before, largest_strain: Cell::new(0.0) }
    }
}

impl<S: Simulation, V: OutputConverter<S>> FieldSource for TimeFields<'_, S, V> {
    fn describe(&self) -> OutputFields {
        let mut found = self.converter.describe_fields(self.simulation, self.fields, self.time);
        if let Some((Ok(before), fraction)) = self.before {
            before.interpolate_joints(fraction, &mut found);
        }
        found
    }

    fn layer_count(&self) -> usize {
        self.converter.layers(self.simulation)[0]
    }

    fn layer_size(&self) -> usize {
        self.converter.layers(self.simulation)[1]
    }

    fn read_layers(&self, layers: Range<usize>) -> io::Result<OutputFields> {
        let Self { converter, simulation, fields, time, .. } = self;
        let mut found = converter.convert_layers(simulation, fields, layers.clone(), *time);
        if let Some((before, fraction)) = self.before {
            let cause = |error: &io::Error| {
                io::Error::new(error.kind(), format!("fields before the step: {error}"))
            };
            before.as_ref().map_err(cause)?.interpolate_layers(&layers, fraction, &mut found)?;
        }
        let strain = converter.find_largest_strain(&found);
        self.largest_strain.set(self.largest_strain.get().max(strain));
        Ok(found)
    }
}

/// Observer that converts driver output and passes it to the recorder.
struct RecorderObserver<'a, V> {
    converter: &'a V,
    recorder: &'a mut dyn Recorder,
    /// Index in the probe record of each column of the receiver table after `time`.
    receiver_columns: Vec<usize>,
    /// Tables of energy accounts, in the order of the rows that the converter returns.
    account_table_kinds: Vec<TableKind>,
    /// Duration of the simulation, s.
    duration: f64,
    /// Output fields before the last step, if a snapshot within it needs them. A failure to store them is one of that
    /// snapshot: all ranks are then asked for the outcome.
    fields_before: Option<io::Result<StoredFields>>,
}

impl<V> RecorderObserver<'_, V> {
    fn report_progress_to_recorder<S: Simulation, R>(
        &mut self,
        simulation: &S,
        last: &S::Account,
        take: impl FnOnce(&mut dyn Recorder, &RunProgress) -> R,
    ) -> R
    where
        V: OutputConverter<S>,
    {
        let progress = RunProgress {
            step_count: simulation.steps(),
            time: simulation.time(),
            duration: self.duration,
            is_finished: simulation.is_finished(),
            statistics: self.converter.step_statistics(simulation, last),
            save_state: &|| {
                let without_cells = simulation.state_without_cells();
                Ok(SavedState { without_cells, cells: Some(simulation) })
            },
        };
        take(self.recorder, &progress)
    }
}

impl<S: Simulation, V: OutputConverter<S>> Observer<S> for RecorderObserver<'_, V> {
    type Error = Error;

    fn on_record(&mut self, time: f64, values: &[f64]) -> Result<(), Error> {
        let value = |&index: &usize| self.converter.to_display_unit(index, values[index]);
        let row: Vec<f64> =
            std::iter::once(time).chain(self.receiver_columns.iter().map(value)).collect();
        self.recorder.record_row(TableKind::Receivers, &row)
    }

    fn on_account(&mut self, account: &S::Account) -> Result<(), Error> {
        let rows = self.converter.account_rows(account);
        self.account_table_kinds
            .iter()
            .zip(rows)
            .try_for_each(|(table, row)| self.recorder.record_row(*table, &row))
    }

    fn on_state_before_snapshot(&mut self, simulation: &S) -> Result<(), Error> {
        // The fields of an earlier snapshot give way first.
        self.fields_before = None;
        let present = simulation.fields();
        let moment = (&present, simulation.time());
        let source = TimeFields::new(self.converter, simulation, moment, None);
        let store = self.recorder.create_field_store();
        self.fields_before = Some(StoredFields::new(&source, store));
        Ok(())
    }

    fn on_snapshot(
        &mut self,
        simulation: &S,
        snapshot: DueSnapshot<S::Fields>,
    ) -> Result<(), Error> {
        let DueSnapshot { index, time, fields } = snapshot;
        let before = self.fields_before.as_ref();
        let source = TimeFields::new(self.converter, simulation, (&fields, time), before);
        self.recorder.record_snapshot(index, &source)
    }

    fn on_replay(&mut self) -> Result<(), Error> {
        self.recorder.begin_replay()
    }

    fn restore_saved(&mut self, simulation: &mut S) -> Result<bool, Error> {
        self.recorder.restore_saved(&mut |state, cells| {
            simulation.restore_with_cells(state, cells).then_some(0)
        })
    }

    fn on_steps_done(&mut self, simulation: &S, last: &S::Account) -> Result<(), Error> {
        self.report_progress_to_recorder(simulation, last, |recorder, now| {
            recorder.handle_progress(now)
        })
    }
}

/// Creates the receiver table, and for each of its columns after `time` the index in the probe record, which holds all
/// quantities `names` receiver by receiver; `None` without receivers.
pub(super) fn create_receiver_table<F: Display>(
    case: &Case,
    receivers: &[ReceiverPoint<F>],
    names: &[impl AsRef<str>],
) -> Option<(TableHeader, Vec<usize>)> {
    let mut header = vec!["time".to_owned()];
    let mut columns = Vec::new();
    for (index, receiver) in receivers.iter().enumerate() {
        for name in receiver.fields.iter().map(ToString::to_string) {
            if let Some(quantity) = names.iter().position(|own| own.as_ref() == name) {
                header.push(format!("{}.{name}", receiver.name));
                columns.push(index * names.len() + quantity);
            }
        }
    }
    (!receivers.is_empty()).then(|| (TableHeader::new(case, TableKind::Receivers, header), columns))
}
