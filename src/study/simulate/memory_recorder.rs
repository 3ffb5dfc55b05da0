//! Recorder that keeps the output of a simulation in memory.

use super::{
    FieldSource, RecordColumn, RecordTable, Recorder, RestoreState, RunProgress, RunRecords,
    SnapshotCallback, TableHeader, TableKind,
};
use crate::Error;
use crate::study::ProgressCallback;
use dynamics::simulation::RegularTimes;

/// Number of progress steps over the duration of a simulation.
const PROGRESS_STEP_COUNT: usize = 1000;

/// Recorder that keeps all output in memory, or passes the snapshots to a callback, and reports progress.
pub(super) struct MemoryRecorder<'a, 'b> {
    records: RunRecords,
    on_snapshot: Option<SnapshotCallback<'b>>,
    on_progress: ProgressCallback<'a>,
}

impl<'a, 'b> MemoryRecorder<'a, 'b> {
    pub(super) fn new(
        on_progress: ProgressCallback<'a>,
        on_snapshot: Option<SnapshotCallback<'b>>,
    ) -> Self {
        Self { records: RunRecords::default(), on_snapshot, on_progress }
    }

    fn table_mut(&mut self, kind: TableKind) -> &mut RecordTable {
        match kind {
            TableKind::Receivers => self.records.receivers.get_or_insert_default(),
            TableKind::Ledger => &mut self.records.ledger,
            TableKind::Spectrum => self.records.spectrum.get_or_insert_default(),
        }
    }

    fn report_step(&self, done: usize) -> Result<(), Error> {
        if (self.on_progress)(done, PROGRESS_STEP_COUNT).is_break() {
            Err(Error::Cancelled)
        } else {
            Ok(())
        }
    }
}

impl Recorder for MemoryRecorder<'_, '_> {
    fn start(
        &mut self,
        tables: &[TableHeader],
        _snapshots: Option<RegularTimes>,
        _restore: &mut RestoreState,
    ) -> Result<(), Error> {
        for head in tables {
            let names = head.columns.iter().zip(&head.units);
            let column = |(name, &unit): (&String, &&'static str)| RecordColumn {
                name: name.clone(),
                unit,
                values: Vec::new(),
            };
            self.table_mut(head.kind).columns = names.map(column).collect();
        }
        self.report_step(0)
    }

    fn record_row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        let columns = self.table_mut(table).columns.iter_mut();
        columns.zip(row).for_each(|(column, value)| column.values.push(*value));
        Ok(())
    }

    fn record_snapshot(&mut self, _index: usize, fields: &dyn FieldSource) -> Result<(), Error> {
        let fields = fields.read_all()?;
        match &mut self.on_snapshot {
            None => self.records.snapshots.push(fields),
            Some(take) => {
                if take(fields).is_break() {
                    return Err(Error::Cancelled);
                }
            }
        }
        Ok(())
    }

    fn handle_progress(&mut self, progress: &RunProgress) -> Result<(), Error> {
        self.report_step((PROGRESS_STEP_COUNT as f64 * progress.time / progress.duration) as usize)
    }

    fn begin_replay(&mut self) -> Result<(), Error> {
        self.report_step(0)
    }

    fn finish(&mut self, _moment: &RunProgress) -> Result<RunRecords, Error> {
        Ok(std::mem::take(&mut self.records))
    }
}
