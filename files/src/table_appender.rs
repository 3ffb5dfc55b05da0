//! CSV tables extended row by row, with resumption of interrupted runs.
//!
//! Rows are buffered in memory and written to disk by [`Appender::sync`]; before that call a reader may find an
//! incomplete last line. An interrupted run resumes at the length returned by the last `sync`, if the file is unchanged
//! up to this length; later bytes are removed and their rows are written again.

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;

use crate::atomic_write::sync_parent_folder;
use crate::csv::format_shortest;
use crate::regular_file::open_for_update;

/// Error of creating, resuming or extending a table.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct AppendError {
    /// Path of the table.
    pub path: PathBuf,
    /// Cause of the error.
    #[source]
    pub problem: AppendProblem,
}

/// Cause of an [`AppendError`].
#[derive(Debug, thiserror::Error)]
pub enum AppendProblem {
    /// The operating system refused an operation.
    #[error("cannot {action}: {source}")]
    Io {
        /// Attempted action, a phrase that follows "cannot".
        action: &'static str,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The table to be resumed is shorter than the part already written.
    #[error("has {found} bytes, less than the {length} after which it should go on")]
    TruncatedFile {
        /// Length of the file, in bytes.
        found: u64,
        /// Length of the part already written, bytes.
        length: u64,
    },
    /// The part already written was changed.
    #[error("has other content in its first {length} bytes than was written")]
    ChangedContent {
        /// Length of the part already written, bytes.
        length: u64,
    },
    /// The first `length` bytes are not a header followed by complete rows.
    #[error("has no header and whole rows in its first {length} bytes")]
    InvalidHeader {
        /// Length to resume at, bytes.
        length: u64,
    },
    /// A row has another number of cells than the header.
    #[error("a row has {found} cells where the header names {expected} columns")]
    RowLength {
        /// Number of cells in the row.
        found: usize,
        /// Number of columns named in the header.
        expected: usize,
    },
}

pub use crate::regular_file::FileDigest;

/// Table being extended. On drop, buffered rows are passed to the operating system and errors are ignored: call
/// [`Appender::sync`] first.
#[derive(Debug)]
pub struct Appender {
    path: PathBuf,
    header: Vec<String>,
    writer: csv::Writer<HashedFile>,
}

/// File with the running checksum of its content.
#[derive(Debug)]
struct HashedFile {
    file: File,
    length: u64,
    hasher: Hasher,
}

impl HashedFile {
    /// Length and checksum of the bytes written so far.
    fn digest(&self) -> FileDigest {
        FileDigest { length: self.length, checksum: self.hasher.clone().finalize() }
    }
}

impl Write for HashedFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.file.write(bytes)?;
        self.hasher.update(&bytes[..count]);
        self.length += count as u64;
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// Adds path and attempted action (a phrase that follows "cannot") to an error of the operating system.
fn map_io_error(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> AppendError {
    move |source| AppendError::new(path, AppendProblem::Io { action, source })
}

impl AppendError {
    fn new(path: &Path, problem: AppendProblem) -> Self {
        Self { path: path.to_path_buf(), problem }
    }
}

impl Appender {
    /// Creates a table and writes its header to disk. A file of the same name is replaced; a missing folder is an
    /// error.
    pub fn create(path: &Path, header: &[&str]) -> Result<Self, AppendError> {
        // A new file, so that other hard links to the previous file remain unchanged.
        match fs::remove_file(path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(map_io_error(path, "be created")(error));
            }
            _ => {}
        }
        let file = File::create_new(path).map_err(map_io_error(path, "be created"))?;
        let header = header.iter().map(|&name| name.to_owned()).collect();
        let start = HashedFile { file, length: 0, hasher: Hasher::new() };
        let mut appender = Self::from_file(path, header, start);
        let written = appender.writer.write_record(&appender.header);
        written.map_err(|error| map_io_error(path, "be written")(error.into()))?;
        appender.sync()?;
        sync_parent_folder(path);
        Ok(appender)
    }

    /// Resumes a table after the part already written, which must be unchanged, i.e. have the length and checksum
    /// `digest`; later bytes are removed.
    pub fn resume(path: &Path, digest: FileDigest) -> Result<Self, AppendError> {
        InterruptedTable::open(path, digest)?.resume()
    }

    fn from_file(path: &Path, header: Vec<String>, file: HashedFile) -> Self {
        Self { path: path.to_path_buf(), header, writer: csv::Writer::from_writer(file) }
    }

    /// Column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// Appends a row. Numbers have the shortest form that reads back to the same bits; not-a-number becomes an empty
    /// cell, infinities become `inf` and `-inf`.
    pub fn write_row(&mut self, row: &[f64]) -> Result<(), AppendError> {
        let (found, expected) = (row.len(), self.header.len());
        if found != expected {
            return Err(AppendError::new(&self.path, AppendProblem::RowLength { found, expected }));
        }
        let written = self.writer.write_record(row.iter().map(|&number| format_shortest(number)));
        written.map_err(|error| map_io_error(&self.path, "be written")(error.into()))
    }

    /// Writes all rows to disk and returns length and checksum of the file, for [`Appender::resume`].
    pub fn sync(&mut self) -> Result<FileDigest, AppendError> {
        let mut flush = || {
            self.writer.flush()?;
            self.writer.get_ref().file.sync_data()
        };
        flush().map_err(map_io_error(&self.path, "be written"))?;
        Ok(self.writer.get_ref().digest())
    }
}

/// Interrupted table that has been verified and can be resumed; the file has not been changed yet.
#[derive(Debug)]
pub struct InterruptedTable {
    path: PathBuf,
    header: Vec<String>,
    prefix: HashedFile,
}

impl InterruptedTable {
    /// Opens an interrupted table and verifies that the part already written is unchanged, i.e. has the length and
    /// checksum `digest`.
    ///
    /// # Errors
    /// The part already written was changed or truncated or is not a header with complete rows, or the file is not a
    /// regular file or cannot be opened or read.
    pub fn open(path: &Path, digest: FileDigest) -> Result<Self, AppendError> {
        let length = digest.length;
        let mut file = open_for_update(path).map_err(map_io_error(path, "be opened"))?;
        let found = file.metadata().map_err(map_io_error(path, "be read"))?.len();
        if found < length {
            return Err(AppendError::new(path, AppendProblem::TruncatedFile { found, length }));
        }
        let hasher = hash_prefix(&file, length).map_err(map_io_error(path, "be read"))?;
        let start = HashedFile {
            file: file.try_clone().map_err(map_io_error(path, "be opened"))?,
            length,
            hasher,
        };
        if start.digest() != digest {
            return Err(AppendError::new(path, AppendProblem::ChangedContent { length }));
        }
        let header = read_header(&mut file, length).map_err(map_io_error(path, "be read"))?;
        let header = header
            .ok_or_else(|| AppendError::new(path, AppendProblem::InvalidHeader { length }))?;
        Ok(Self { path: path.to_path_buf(), header, prefix: start })
    }

    /// Truncates the file to the verified part and resumes the table.
    ///
    /// # Errors
    /// The file cannot be truncated.
    pub fn resume(self) -> Result<Appender, AppendError> {
        let Self { path, header, prefix: start } = self;
        let mut file = &start.file;
        let truncated = file
            .set_len(start.length)
            .and_then(|()| file.sync_all())
            .and_then(|()| file.seek(SeekFrom::Start(start.length)));
        truncated.map_err(map_io_error(&path, "be shortened"))?;
        Ok(Appender::from_file(&path, header, start))
    }
}

/// CRC-32 hasher of the first `length` bytes of a file, or of all bytes of a shorter file.
fn hash_prefix(mut file: &File, length: u64) -> io::Result<Hasher> {
    file.rewind()?;
    let mut prefix = file.take(length);
    let (mut hasher, mut bytes) = (Hasher::new(), vec![0; 1 << 16]);
    loop {
        match prefix.read(&mut bytes)? {
            0 => return Ok(hasher),
            count => hasher.update(&bytes[..count]),
        }
    }
}

/// Reads the column names; `None` if the first `length` bytes are not complete lines with a header.
fn read_header(file: &mut File, length: u64) -> io::Result<Option<Vec<String>>> {
    let Some(last) = length.checked_sub(1) else { return Ok(None) };
    let mut end = [0];
    file.seek(SeekFrom::Start(last))?;
    file.read_exact(&mut end)?;
    file.rewind()?;
    let start = BufReader::new(&*file).take(length);
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
    use super::*;

    /// Length and checksum of the first `length` bytes of a text.
    fn prefix_digest(text: &str, length: usize) -> FileDigest {
        let length = length.min(text.len());
        FileDigest { length: length as u64, checksum: crc32fast::hash(&text.as_bytes()[..length]) }
    }

    #[test]
    fn rows_are_formatted_as_in_csv_tables() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ledger.csv");
        let mut table = Appender::create(&path, &["time [s]", "energy, \"all\" [J]"]).unwrap();
        let header = "time [s],\"energy, \"\"all\"\" [J]\"\n";
        assert_eq!(fs::read_to_string(&path).unwrap(), header);
        table.write_row(&[0.1, f64::NAN]).unwrap();
        table.write_row(&[1e-7, f64::NEG_INFINITY]).unwrap();
        let written = table.sync().unwrap();
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(text, format!("{header}0.1,\n1e-7,-inf\n"));
        assert_eq!(written, prefix_digest(&text, text.len()));
    }

    #[test]
    fn resumed_table_equals_uninterrupted_table() {
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
        let written = first.sync().unwrap();
        rows(&mut first, 2000..3000);
        drop(first);
        let file = fs::File::options().append(true).open(&paths[1]).unwrap();
        file.set_len(written.length + 7).unwrap();
        let mut second = Appender::resume(&paths[1], written).unwrap();
        assert_eq!(second.header(), &header.map(str::to_owned)[..]);
        assert_eq!(second.sync().unwrap(), written);
        assert_eq!(fs::metadata(&paths[1]).unwrap().len(), written.length);
        rows(&mut second, 2000..5000);
        assert_eq!(second.sync().unwrap(), end);
        assert_eq!(fs::read(&paths[0]).unwrap(), fs::read(&paths[1]).unwrap());
    }

    #[test]
    fn refused_resumption_leaves_file_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table");
        let text = "a,b\n1,2\n3,4\n";
        fs::write(&path, text).unwrap();
        let refused = |written| Appender::resume(&path, written).unwrap_err();
        for length in [13, u64::MAX] {
            let error = refused(FileDigest { length, checksum: 0 });
            assert!(
                matches!(error.problem, AppendProblem::TruncatedFile { found: 12, .. }),
                "{error}"
            );
        }
        for length in [0, 1, 3, 5, 11] {
            let error = refused(prefix_digest(text, length));
            assert!(matches!(error.problem, AppendProblem::InvalidHeader { .. }), "{error}");
        }
        for changed in ["a,b\n1,2\n3,5\n", "A,b\n1,2\n3,4\n"] {
            let error = refused(prefix_digest(changed, 12));
            assert!(
                matches!(error.problem, AppendProblem::ChangedContent { length: 12 }),
                "{error}"
            );
            let expected = "table: has other content in its first 12 bytes than was written";
            assert!(error.to_string().ends_with(expected), "{error}");
        }
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        fs::write(&path, b"\xff\n").unwrap();
        let checksum = crc32fast::hash(b"\xff\n");
        let error = refused(FileDigest { length: 2, checksum });
        assert!(matches!(error.problem, AppendProblem::InvalidHeader { .. }), "{error}");
        fs::write(&path, b"\n\n").unwrap();
        assert!(matches!(
            refused(prefix_digest("\n\n", 2)).problem,
            AppendProblem::InvalidHeader { .. }
        ));
        let absent =
            Appender::resume(&folder.path().join("absent"), prefix_digest(text, 4)).unwrap_err();
        assert!(absent.to_string().contains("absent: cannot be opened: "), "{absent}");
        let nowhere = Appender::create(&folder.path().join("absent/table"), &["a"]).unwrap_err();
        assert!(nowhere.to_string().contains("table: cannot be created: "), "{nowhere}");
    }

    #[test]
    fn row_of_wrong_length_is_refused_and_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table");
        let mut table = Appender::create(&path, &["a", "b"]).unwrap();
        let header = table.sync().unwrap();
        table.write_row(&[1.0, 2.0]).unwrap();
        let refused = table.write_row(&[3.0]).unwrap_err().problem;
        assert!(matches!(refused, AppendProblem::RowLength { found: 1, expected: 2 }), "{refused}");
        table.sync().unwrap();
        drop(table);
        let mut table = Appender::resume(&path, header).unwrap();
        let refused = table.write_row(&[3.0; 3]).unwrap_err().problem;
        assert!(matches!(refused, AppendProblem::RowLength { expected: 2, .. }), "{refused}");
        table.write_row(&[5.0, 6.0]).unwrap();
        table.sync().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "a,b\n5,6\n");
    }

    #[test]
    fn opening_interrupted_table_leaves_file_unchanged() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table");
        let text = "a,b\n1,2\n3,4\n";
        fs::write(&path, text).unwrap();
        let found = InterruptedTable::open(&path, prefix_digest(text, 8)).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        drop(found);
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        drop(InterruptedTable::open(&path, prefix_digest(text, 8)).unwrap().resume().unwrap());
        assert_eq!(fs::read_to_string(&path).unwrap(), &text[..8]);
    }

    /// Verifies that a new table leaves the target of a symbolic link and other hard links unchanged.
    #[cfg(unix)]
    #[test]
    fn links_are_not_followed() {
        let folder = tempfile::tempdir().unwrap();
        let [path, target] = ["table", "target"].map(|name| folder.path().join(name));
        fs::write(&target, "a,b\n1,2\n").unwrap();
        std::os::unix::fs::symlink(&target, &path).unwrap();
        let error = Appender::resume(&path, prefix_digest("a,b\n1,2\n", 4)).unwrap_err();
        assert!(error.to_string().ends_with("table: cannot be opened: a symbolic link"), "{error}");
        drop(Appender::create(&path, &["c"]).unwrap());
        fs::remove_file(&path).unwrap();
        fs::hard_link(&target, &path).unwrap();
        drop(Appender::create(&path, &["c"]).unwrap());
        assert_eq!(fs::read(&target).unwrap(), b"a,b\n1,2\n");
        assert_eq!(fs::read(&path).unwrap(), b"c\n");
    }
}
