//! The files that a run appends to.

use super::checkpoint::Checkpoint;
use crate::Error;
use crate::case::dynamics::Receiver;
use crate::output::{AppendedFile, OutputError, ResultFolder, SNAPSHOTS};
use dynamics::simulation::State;
use files::append::{Appender, Written};
use files::vti::{ImageData, collection};
use std::fmt::Display;
use std::fs::File;
use std::io::Write as _;

/// A table and the names of its columns.
pub(super) type Table = (AppendedFile, Vec<String>);

/// The tables of a run, and its snapshots.
pub(super) struct Files<'a> {
    folder: &'a ResultFolder,
    tables: Vec<(AppendedFile, Appender)>,
}

impl<'a> Files<'a> {
    /// Makes the folder ready, for a run from its beginning or from a checkpoint, whose state `restore`
    /// takes over if it can; hands back what keeps other runs out of it as well.
    pub(super) fn open(
        folder: &'a ResultFolder,
        tables: &[Table],
        has_snapshots: bool,
        from: Option<&Checkpoint>,
        restore: impl FnOnce(&State) -> bool,
    ) -> Result<(Self, File), Error> {
        let lock = folder.lock()?;
        let mut open = Vec::new();
        match from {
            None => {
                folder.open_run()?;
                for (table, header) in tables {
                    let header: Vec<&str> = header.iter().map(String::as_str).collect();
                    let own = Appender::create(&folder.path_of(*table), &header);
                    open.push((*table, own.map_err(OutputError::of_table)?));
                }
                if has_snapshots {
                    folder.write(SNAPSHOTS, &collection(&[] as &[(f64, &str)])?)?;
                }
            }
            Some(from) => {
                folder.sweep()?;
                if !restore(&from.state) || from.tables.len() != tables.len() {
                    return Err(Checkpoint::refused(folder).into());
                }
                for ((table, _), written) in tables.iter().zip(&from.tables) {
                    let own = Appender::resume(&folder.path_of(*table), *written);
                    open.push((*table, own.map_err(OutputError::of_table)?));
                }
            }
        }
        Ok((Self { folder, tables: open }, lock))
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
        Ok(self.folder.write(SNAPSHOTS, &collection(list)?)?)
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

/// That no snapshot of those that are due is missing.
pub(super) fn check_snapshots(
    folder: &ResultFolder,
    mut due: impl Iterator<Item = String>,
) -> Result<(), OutputError> {
    match due.find(|name| !folder.path().join(name).exists()) {
        Some(name) => Err(OutputError::unusable(&folder.path().join(name), "is missing")),
        None => Ok(()),
    }
}

/// The header of the receivers' table, and where its columns stand in what is recorded at a time: all
/// quantities of those names, receiver by receiver.
pub(super) fn columns<F: Display>(
    receivers: &[Receiver<F>],
    names: &[impl AsRef<str>],
) -> (Vec<String>, Vec<usize>) {
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
    (header, columns)
}
