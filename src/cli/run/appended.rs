//! The files that a run appends to.

use super::checkpoint::Checkpoint;
use crate::case::{Case, InTime};
use crate::cli::Error;
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, RunFolder, SNAPSHOTS};
use crate::study::simulate::{Column, Head, Records, Table, TableKind, column_unit};
use dynamics::simulation::State;
use files::append::{Appender, Interrupted};
use files::lock::Lock;
use files::vti::{ImageData, collection};
use files::{Written, read_regular};
use std::io::Write as _;

/// The tables of a run, and its snapshots.
pub(super) struct Files<'a> {
    folder: &'a ResultFolder,
    /// Of a run that is resumed, until it goes on.
    lock: Option<Lock>,
    /// None before the run begins.
    run: Option<RunFolder<'a>>,
    tables: Vec<(AppendedFile, Appender)>,
    /// All snapshots so far.
    snapshots: Vec<Written>,
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
    /// A run that is resumed holds the lock of its folder.
    pub(super) fn new(folder: &'a ResultFolder, lock: Option<Lock>) -> Self {
        Self { folder, lock, run: None, tables: Vec::new(), snapshots: Vec::new() }
    }

    /// Makes the folder ready for a run from its beginning.
    pub(super) fn create(&mut self, tables: &[Head], has_snapshots: bool) -> Result<(), Error> {
        let folder = self.folder;
        let mut run = match self.lock.take() {
            None => folder.begin_run()?,
            Some(lock) => folder.begin_again(lock)?,
        };
        for Head { kind, columns, .. } in tables {
            let file = AppendedFile::from(*kind);
            let header: Vec<&str> = columns.iter().map(String::as_str).collect();
            let own = Appender::create(&folder.path_of(file), &header);
            self.tables.push((file, own.map_err(OutputError::of_table)?));
        }
        if has_snapshots {
            run.write(SNAPSHOTS, &snapshot_list(&[] as &[(f64, &str)])?)?;
        }
        self.run = Some(run);
        Ok(())
    }

    /// The same for one that goes on from a checkpoint, whose state `restore` takes over if it can and says how many
    /// snapshots are due; `snapshot` knows the time and the name of each by its number. Nothing is changed before all
    /// is found to be as it was at the checkpoint.
    pub(super) fn resume(
        &mut self,
        tables: &[Head],
        from: &Checkpoint,
        restore: &mut dyn FnMut(&State) -> Option<usize>,
        snapshot: impl Fn(usize) -> Option<(f64, String)>,
    ) -> Result<(), Error> {
        let folder = self.folder;
        let is_own =
            |due: &usize| from.tables.len() == tables.len() && from.snapshots.len() == *due;
        let due = restore(&from.state).filter(is_own).ok_or_else(|| Checkpoint::refused(folder))?;
        let list: Vec<(f64, String)> = (0..due).map_while(snapshot).collect();
        for ((_, name), written) in list.iter().zip(&from.snapshots) {
            folder.check_file(name, *written)?;
        }
        let mut found = Vec::new();
        for (head, written) in tables.iter().zip(&from.tables) {
            let file = AppendedFile::from(head.kind);
            let own = Interrupted::open(&folder.path_of(file), *written);
            found.push((file, own.map_err(OutputError::of_table)?));
        }
        let lock = self.lock.take().ok_or_else(|| Checkpoint::refused(folder))?;
        let mut run = RunFolder::resumed(folder, lock)?;
        for (file, own) in found {
            self.tables.push((file, own.resume().map_err(OutputError::of_table)?));
        }
        if !list.is_empty() {
            // It may have those of steps that are to be made again.
            run.write(SNAPSHOTS, &snapshot_list(&list)?)?;
        }
        list.iter().zip(&from.snapshots).for_each(|((_, name), own)| run.insert(name, *own));
        self.snapshots.clone_from(&from.snapshots);
        self.run = Some(run);
        Ok(())
    }

    /// Adds a row to a table, if there is such a one.
    pub(super) fn write(&mut self, table: AppendedFile, row: &[f64]) -> Result<(), Error> {
        match self.tables.iter_mut().find(|own| own.0 == table) {
            Some((_, file)) => Ok(file.write_row(row).map_err(OutputError::of_table)?),
            None => Ok(()),
        }
    }

    /// Writes a state for ParaView, the last one of a list of all so far with their times.
    pub(super) fn snapshot(
        &mut self,
        image: &ImageData,
        list: &[(f64, String)],
    ) -> Result<(), Error> {
        let Some(run) = &mut self.run else { return Ok(()) };
        if let Some((_, name)) = list.last() {
            self.snapshots.push(run.write(name, &image.bytes())?);
        }
        run.write(SNAPSHOTS, &snapshot_list(list)?)?;
        Ok(())
    }

    /// Brings the tables to the disk: a checkpoint of that state.
    pub(super) fn checkpoint(&mut self, state: State) -> Result<Checkpoint, Error> {
        Ok(Checkpoint { tables: self.sync()?, snapshots: self.snapshots.clone(), state })
    }

    /// Brings the tables to the disk, and says what they hold.
    pub(super) fn sync(&mut self) -> Result<Vec<Written>, Error> {
        let tables = self.tables.iter_mut();
        Ok(tables
            .map(|own| own.1.sync())
            .collect::<Result<_, _>>()
            .map_err(OutputError::of_table)?)
    }

    /// The folder of the run, which knows all of its files; `None` before the run begins.
    pub(super) fn into_folder(mut self) -> Result<Option<RunFolder<'a>>, Error> {
        let written = self.sync()?;
        let Some(run) = &mut self.run else { return Ok(None) };
        self.tables.iter().zip(written).for_each(|((file, _), own)| run.insert(file.name(), own));
        Ok(self.run)
    }

    /// Wall times and speeds, which no result holds. A log that cannot be written stops nothing.
    pub(super) fn log(&self, text: &str) {
        let path = self.folder.path_of(AppendedFile::Log);
        if let Ok(mut file) = files::open_to_append(&path) {
            let _ = writeln!(file, "{text}");
        }
    }
}

/// The list of the snapshots, by times and names.
fn snapshot_list<S: AsRef<str>>(list: &[(f64, S)]) -> Result<Vec<u8>, Error> {
    Ok(collection(list).map_err(crate::Error::from)?)
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
    let bytes = read_regular(&path).map_err(|error| OutputError::unreadable(&path, &error))?;
    let text = String::from_utf8_lossy(&bytes);
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
