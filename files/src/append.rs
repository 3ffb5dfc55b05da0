//! Tables as comma-separated values that grow row by row, over runs that may be interrupted.
//!
//! Rows are collected in memory and reach the device with [`Appender::sync`]. A reader that looks
//! earlier may find the last line half-written; a run that was interrupted goes on from an offset
//! that it noted after a `sync`, and what lies behind that offset is written again.

use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::FileError;
use crate::atomic::sync_name;
use crate::csv::shortest;

/// A table that could not be started, resumed or extended.
#[derive(Debug, thiserror::Error)]
pub enum AppendError {
    /// The operating system refused.
    #[error(transparent)]
    File(#[from] FileError),
    /// The table to be resumed has lost rows that had been written.
    #[error(
        "{} has {found} bytes, which is less than the {offset} after which it should go on",
        path.display()
    )]
    Shorter {
        /// The table.
        path: PathBuf,
        /// Length of the file, in bytes.
        found: u64,
        /// Where the table should go on, in bytes from its start.
        offset: u64,
    },
    /// The table cannot go on at the offset: it is not the end of a line below a header.
    #[error("{} has no header and whole rows in its first {offset} bytes", path.display())]
    Offset {
        /// The table.
        path: PathBuf,
        /// Where the table should go on, in bytes from its start.
        offset: u64,
    },
    /// A row whose length differs from the header's.
    #[error(
        "a row for {} has {found} cells where the header names {expected} columns",
        path.display()
    )]
    Row {
        /// The table.
        path: PathBuf,
        /// Cells in the row.
        found: usize,
        /// Columns named in the header.
        expected: usize,
    },
}

/// A table that is being extended. Rows that are not yet on the device when it is dropped are
/// handed to the operating system, without a word about failures: call [`Appender::sync`] before.
#[derive(Debug)]
pub struct Appender {
    path: PathBuf,
    header: Vec<String>,
    writer: csv::Writer<File>,
    offset: u64,
}

/// Gives an error of the operating system the file and the action, a phrase that follows "cannot".
fn at(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> AppendError {
    move |source| FileError { path: path.to_path_buf(), action, source }.into()
}

impl Appender {
    /// Starts a table with its header; a file of the same name is replaced, a missing folder is
    /// an error. The header is on the device afterwards.
    pub fn create(path: &Path, header: &[&str]) -> Result<Self, AppendError> {
        let file = File::create(path).map_err(at(path, "create"))?;
        let header = header.iter().map(|&name| name.to_owned()).collect();
        let mut appender = Self::around(path, header, file, 0);
        let written = appender.writer.write_record(&appender.header);
        written.map_err(|error| at(path, "write")(error.into()))?;
        appender.sync()?;
        sync_name(path);
        Ok(appender)
    }

    /// Goes on with a table behind its first `offset` bytes, which must be a header and whole rows;
    /// the rest of the file is cut off.
    pub fn resume(path: &Path, offset: u64) -> Result<Self, AppendError> {
        let opened = File::options().read(true).write(true).open(path);
        let mut file = opened.map_err(at(path, "open"))?;
        let found = file.metadata().map_err(at(path, "read"))?.len();
        if found < offset {
            return Err(AppendError::Shorter { path: path.to_path_buf(), found, offset });
        }
        let header = header_of(&mut file, offset).map_err(at(path, "read"))?;
        let header =
            header.ok_or_else(|| AppendError::Offset { path: path.to_path_buf(), offset })?;
        let cut = file
            .set_len(offset)
            .and_then(|()| file.sync_all())
            .and_then(|()| file.seek(SeekFrom::Start(offset)));
        cut.map_err(at(path, "shorten"))?;
        Ok(Self::around(path, header, file, offset))
    }

    fn around(path: &Path, header: Vec<String>, file: File, offset: u64) -> Self {
        Self { path: path.to_path_buf(), header, writer: csv::Writer::from_writer(file), offset }
    }

    /// The column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// Adds a row, in which every number has the shortest form that reads back to the same bits;
    /// not-a-number becomes an empty cell, infinities become `inf` and `-inf`.
    pub fn write_row(&mut self, row: &[f64]) -> Result<(), AppendError> {
        if row.len() != self.header.len() {
            let (path, found, expected) = (self.path.clone(), row.len(), self.header.len());
            return Err(AppendError::Row { path, found, expected });
        }
        let written = self.writer.write_record(row.iter().map(|&number| shortest(number)));
        written.map_err(|error| at(&self.path, "write")(error.into()))
    }

    /// Brings all rows to the device and gives the offset behind them, in bytes from the table's
    /// start.
    pub fn sync(&mut self) -> Result<u64, AppendError> {
        let mut position = || {
            self.writer.flush()?;
            let mut file = self.writer.get_ref();
            file.sync_data()?;
            file.stream_position()
        };
        self.offset = position().map_err(at(&self.path, "write"))?;
        Ok(self.offset)
    }

    /// Where the rows end that are on the device since the last [`Appender::sync`], in bytes from
    /// the table's start: the offset from which [`Appender::resume`] loses none of them.
    pub fn offset(&self) -> u64 {
        self.offset
    }
}

/// The column names, none where the first `offset` bytes are not a header and whole lines.
fn header_of(file: &mut File, offset: u64) -> io::Result<Option<Vec<String>>> {
    let Some(last) = offset.checked_sub(1) else { return Ok(None) };
    let mut end = [0];
    file.seek(SeekFrom::Start(last))?;
    file.read_exact(&mut end)?;
    file.rewind()?;
    let start = BufReader::new(&*file).take(offset);
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(start);
    let mut header = csv::StringRecord::new();
    match reader.read_record(&mut header) {
        Ok(true) if end == *b"\n" => Ok(Some(header.iter().map(str::to_owned).collect())),
        Err(error) if error.is_io_error() => Err(error.into()),
        _ => Ok(None),
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn rows_as_in_other_tables() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ledger.csv");
        let mut table = Appender::create(&path, &["time [s]", "energy, \"all\" [J]"]).unwrap();
        let header = "time [s],\"energy, \"\"all\"\" [J]\"\n";
        assert_eq!(fs::read_to_string(&path).unwrap(), header);
        assert_eq!(table.offset(), header.len() as u64);
        table.write_row(&[0.1, f64::NAN]).unwrap();
        table.write_row(&[1e-7, f64::NEG_INFINITY]).unwrap();
        // Not on the device yet, and not counted.
        assert_eq!(table.offset(), header.len() as u64);
        let offset = table.sync().unwrap();
        assert_eq!(offset, table.offset());
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text, format!("{header}0.1,\n1e-7,-inf\n"));
        assert_eq!(text.len() as u64, offset);
    }

    #[test]
    fn an_interrupted_table_goes_on_as_if_nothing_had_happened() {
        let folder = tempfile::tempdir().unwrap();
        let paths = ["whole", "interrupted"].map(|name| folder.path().join(name));
        let header = ["a", "line\nbreak"];
        let rows = |table: &mut Appender, range: std::ops::Range<i32>| {
            for index in range {
                table.write_row(&[f64::from(index), 1.0 / f64::from(index)]).unwrap();
            }
        };
        let mut whole = Appender::create(&paths[0], &header).unwrap();
        rows(&mut whole, 1..5000);
        let end = whole.sync().unwrap();

        let mut first = Appender::create(&paths[1], &header).unwrap();
        rows(&mut first, 1..2000);
        let offset = first.sync().unwrap();
        rows(&mut first, 2000..3000);
        drop(first);
        fs::File::options().append(true).open(&paths[1]).unwrap().set_len(offset + 7).unwrap();
        let mut second = Appender::resume(&paths[1], offset).unwrap();
        assert_eq!((second.offset(), second.header()), (offset, &header.map(str::to_owned)[..]));
        assert_eq!(fs::metadata(&paths[1]).unwrap().len(), offset);
        rows(&mut second, 2000..5000);
        assert_eq!(second.sync().unwrap(), end);
        assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
    }

    #[test]
    fn what_cannot_be_resumed_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table");
        let text = "a,b\n1,2\n3,4\n";
        fs::write(&path, text).unwrap();
        let refused = |offset| Appender::resume(&path, offset).unwrap_err();
        assert!(matches!(refused(13), AppendError::Shorter { found: 12, offset: 13, .. }));
        assert!(matches!(refused(u64::MAX), AppendError::Shorter { .. }));
        for offset in [0, 1, 3, 5, 11] {
            assert!(matches!(refused(offset), AppendError::Offset { .. }), "{offset}");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        fs::write(&path, b"\xff\n").unwrap();
        assert!(matches!(refused(2), AppendError::Offset { .. }));
        fs::write(&path, b"\n\n").unwrap();
        assert!(matches!(refused(2), AppendError::Offset { .. }));
        let absent = Appender::resume(&folder.path().join("absent"), 4).unwrap_err();
        assert!(absent.to_string().starts_with("cannot open "), "{absent}");
        let nowhere = Appender::create(&folder.path().join("absent/table"), &["a"]).unwrap_err();
        assert!(nowhere.to_string().starts_with("cannot create "), "{nowhere}");
    }

    #[test]
    fn a_row_of_the_wrong_length_is_refused_and_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table");
        let mut table = Appender::create(&path, &["a", "b"]).unwrap();
        table.write_row(&[1.0, 2.0]).unwrap();
        let refused = table.write_row(&[3.0]).unwrap_err();
        assert!(matches!(refused, AppendError::Row { found: 1, expected: 2, .. }), "{refused}");
        table.sync().unwrap();
        drop(table);
        let mut table = Appender::resume(&path, 4).unwrap();
        assert!(matches!(table.write_row(&[3.0; 3]), Err(AppendError::Row { expected: 2, .. })));
        table.write_row(&[5.0, 6.0]).unwrap();
        table.sync().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "a,b\n5,6\n");
    }
}
