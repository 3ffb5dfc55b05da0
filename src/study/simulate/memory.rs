//! Recorder that keeps the output of a simulation in memory.

use super::{Column, Fields, Head, Moment, Recorder, Records, Table, TableKind};
use crate::Error;
use crate::study::OnProgress;
use dynamics::simulation::{RegularTimes, State};

/// Number of progress steps.
const PARTS: usize = 1000;

/// Recorder in memory, with a progress callback.
pub(super) struct InMemory<'a> {
    records: Records,
    progress: OnProgress<'a>,
}

impl<'a> InMemory<'a> {
    pub(super) fn new(progress: OnProgress<'a>) -> Self {
        Self { records: Records::default(), progress }
    }

    fn table(&mut self, kind: TableKind) -> &mut Table {
        match kind {
            TableKind::Receivers => self.records.receivers.get_or_insert_default(),
            TableKind::Ledger => &mut self.records.ledger,
            TableKind::Spectrum => self.records.spectrum.get_or_insert_default(),
        }
    }

    fn tell(&self, done: usize) -> Result<(), Error> {
        if (self.progress)(done, PARTS).is_break() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

impl Recorder for InMemory<'_> {
    fn start(
        &mut self,
        tables: &[Head],
        _snapshots: Option<RegularTimes>,
        _restore: &mut dyn FnMut(&State) -> Option<usize>,
    ) -> Result<(), Error> {
        for head in tables {
            let names = head.columns.iter().zip(&head.units);
            let column = |(name, &unit): (&String, &&'static str)| Column {
                name: name.clone(),
                unit,
                values: Vec::new(),
            };
            self.table(head.kind).columns = names.map(column).collect();
        }
        self.tell(0)
    }

    fn row(&mut self, table: TableKind, row: &[f64]) -> Result<(), Error> {
        let columns = self.table(table).columns.iter_mut();
        columns.zip(row).for_each(|(column, value)| column.values.push(*value));
        Ok(())
    }

    fn snapshot(&mut self, _index: usize, fields: Fields) -> Result<(), Error> {
        self.records.snapshots.push(fields);
        Ok(())
    }

    fn after_steps(&mut self, moment: &Moment) -> Result<(), Error> {
        self.tell((PARTS as f64 * moment.time / moment.duration) as usize)
    }

    fn replay(&mut self) -> Result<(), Error> {
        self.tell(0)
    }

    fn finish(&mut self, _moment: &Moment) -> Result<Records, Error> {
        Ok(std::mem::take(&mut self.records))
    }
}
