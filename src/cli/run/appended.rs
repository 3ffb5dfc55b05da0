//! The files that a run appends to.

use super::checkpoint::Checkpoint;
use crate::case::{Case, InTime};
use crate::cli::Error;
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, SNAPSHOTS};
use crate::study::simulate::{Column, Head, Records, Table, TableKind, column_unit};
use dynamics::simulation::State;
use files::append::{Appender, Written};
use files::vti::{ImageData, collection};
use std::fs::File;
use std::io::Write as _;

/// The tables of a run, and its snapshots.
pub(super) struct Files<'a> {
    folder: &'a ResultFolder,
    /// None before the run begins.
    tables: Vec<(AppendedFile, Appender)>,
    /// Keeps other runs out of the folder.
    lock: Option<File>,
}

impl From<TableKind> for AppendedFile {
    fn from(table: TableKind) -> Self {
        match table {
            TableKind::Receivers => Self::Receivers,
            TableKind::Ledger => Self::Ledger,
            TableKind::Spectrum => Self::Spectrum,
        }
    }
}

impl<'a> Files<'a> {
    pub(super) fn new(folder: &'a ResultFolder) -> Self {
        Self { folder, tables: Vec::new(), lock: None }
    }

    /// Makes the folder ready for a run from its beginning.
    pub(super) fn create(&mut self, tables: &[Head], has_snapshots: bool) -> Result<(), Error> {
        let folder = self.folder;
        self.lock = Some(folder.lock()?);
        folder.open_run()?;
        for Head { kind, columns, .. } in tables {
            let file = AppendedFile::from(*kind);
            let header: Vec<&str> = columns.iter().map(String::as_str).collect();
            let own = Appender::create(&folder.path_of(file), &header);
            self.tables.push((file, own.map_err(OutputError::of_table)?));
        }
        if has_snapshots {
            folder.write(SNAPSHOTS, &snapshot_list(&[] as &[(f64, &str)])?)?;
        }
        Ok(())
    }

    /// The same for one that goes on from a checkpoint, whose state `restore` takes over if it can; hands back the
    /// number of snapshots that there are.
    pub(super) fn resume(
        &mut self,
        tables: &[Head],
        from: &Checkpoint,
        restore: &mut dyn FnMut(&State) -> Option<usize>,
    ) -> Result<usize, Error> {
        let folder = self.folder;
        self.lock = Some(folder.lock()?);
        folder.sweep()?;
        let due = restore(&from.state).filter(|_| from.tables.len() == tables.len());
        let due = due.ok_or_else(|| Checkpoint::refused(folder))?;
        for (head, written) in tables.iter().zip(&from.tables) {
            let file = AppendedFile::from(head.kind);
            let own = Appender::resume(&folder.path_of(file), *written);
            self.tables.push((file, own.map_err(OutputError::of_table)?));
        }
        Ok(due)
    }

    /// Adds a row to a table, if there is such a one.
    pub(super) fn write(&mut self, table: AppendedFile, row: &[f64]) -> Result<(), Error> {
        match self.tables.iter_mut().find(|own| own.0 == table) {
            Some((_, file)) => Ok(file.write_row(row).map_err(OutputError::of_table)?),
            None => Ok(()),
        }
    }

    /// Writes a state for ParaView, the last one of a list of all so far with their times.
    pub(super) fn snapshot(&self, image: &ImageData, list: &[(f64, String)]) -> Result<(), Error> {
        if let Some((_, name)) = list.last() {
            self.folder.write(name, &image.bytes())?;
        }
        Ok(self.folder.write(SNAPSHOTS, &snapshot_list(list)?)?)
    }

    /// Brings the tables to the disk, and says what they hold.
    pub(super) fn sync(&mut self) -> Result<Vec<Written>, Error> {
        let tables = self.tables.iter_mut();
        Ok(tables
            .map(|own| own.1.sync())
            .collect::<Result<_, _>>()
            .map_err(OutputError::of_table)?)
    }

    /// Wall times and speeds, which no result holds. A log that cannot be written stops nothing.
    pub(super) fn log(&self, text: &str) {
        let path = self.folder.path_of(AppendedFile::Log);
        if let Ok(mut file) = std::fs::OpenOptions::new().create(true).append(true).open(path) {
            let _ = writeln!(file, "{text}");
        }
    }
}

/// The list of the snapshots, by times and names.
fn snapshot_list<S: AsRef<str>>(list: &[(f64, S)]) -> Result<Vec<u8>, Error> {
    Ok(collection(list).map_err(crate::Error::from)?)
}

/// That no snapshot of those that are due is missing.
pub(super) fn check_snapshots(
    folder: &ResultFolder,
    mut due: impl Iterator<Item = String>,
) -> Result<(), Error> {
    match due.find(|name| !folder.path().join(name).exists()) {
        Some(name) => Err(OutputError::unusable(&folder.path().join(name), "is missing").into()),
        None => Ok(()),
    }
}

/// The tables of a folder of results.
///
/// # Errors
/// One is missing, or no table.
pub(in crate::cli) fn records(case: &Case, folder: &ResultFolder) -> Result<Records, Error> {
    let read = |kind| table(case, folder, kind);
    let has_receivers = match case.in_time()? {
        InTime::Solid(dynamics) => !dynamics.receivers.is_empty(),
        InTime::Flow(run) => !run.receivers.is_empty(),
    };
    Ok(Records {
        receivers: has_receivers.then(|| read(TableKind::Receivers)).transpose()?,
        ledger: read(TableKind::Ledger)?,
        spectrum: case.flow.as_ref().map(|_| read(TableKind::Spectrum)).transpose()?,
        snapshots: Vec::new(),
    })
}

/// Columns of a table of numbers.
fn table(case: &Case, folder: &ResultFolder, kind: TableKind) -> Result<Table, Error> {
    let path = folder.path_of(kind.into());
    let text =
        std::fs::read_to_string(&path).map_err(|error| OutputError::unreadable(&path, &error))?;
    let mut lines = text.lines();
    let column = |name: &str| {
        let unit = column_unit(case, kind, name);
        Column { name: name.to_owned(), unit, values: Vec::new() }
    };
    let mut columns: Vec<Column> =
        lines.next().unwrap_or_default().split(',').map(column).collect();
    for (index, line) in lines.enumerate() {
        for (column, cell) in columns.iter_mut().zip(line.split(',')) {
            let number = cell.parse();
            let odd = |_| OutputError::unusable(&path, format!("line {}: '{cell}'", index + 2));
            column.values.push(number.map_err(odd)?);
        }
    }
    Ok(Table { columns })
}
