//! Folders of results: which may be written to, and what stands in every one of them.

mod error;
mod names;
mod origin;
mod run;

pub use error::OutputError;
pub use names::{
    AppendedFile, CHECK, DISPERSION, MAP, POINT, RUN, SNAPSHOTS, SPEEDS, is_snapshot, results,
    snapshot_name,
};

use crate::case::Case;
use files::FileError;
use names::{CASE, PROBE, PROGRAM, is_result};
use origin::{foreign, holds, program};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// A folder that may take the results of a case.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
    case: String,
    undrawn: String,
    /// Whether results of another case are to go.
    is_foreign: bool,
}

impl ResultFolder {
    /// The folder `out`, or else `out/<case name>`. Looks whether it takes files, and leaves
    /// nothing behind.
    ///
    /// An absent or empty folder will do, and one that holds results of the very same case from
    /// the very same program: they will be the same bits. Anything else needs `force`. The file
    /// that the case was loaded from is never overwritten by anything else than itself.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check(case: &Case, out: Option<&Path>, force: bool) -> Result<Self, OutputError> {
        let path = out.map_or_else(|| Path::new("out").join(&case.name), Path::to_owned);
        let (text, undrawn) = (case.to_toml(), case.undrawn().to_toml());
        let foreign = foreign(&path, &text, &undrawn)?;
        if let Some(name) = case.source().and_then(|source| overwritten(&path, source, &text)) {
            return Err(OutputError {
                path: path.join(name),
                cause: "this is the case file itself, which would be overwritten".into(),
                remedy: "name another folder with --out",
            });
        }
        if let (Some(cause), false) = (foreign, force) {
            return Err(OutputError {
                path,
                cause: cause.into(),
                remedy: "name another folder with --out, or overwrite with --force",
            });
        }
        probe(&path)?;
        Ok(Self { path, case: text, undrawn, is_foreign: foreign.is_some() })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The resolved case without what decides over its pictures alone.
    pub fn undrawn(&self) -> &str {
        &self.undrawn
    }

    /// Names of the files that stand in every folder of results.
    pub const ALWAYS: [&str; 2] = [CASE, PROGRAM];

    /// Where a file stands.
    pub fn path_of(&self, file: AppendedFile) -> PathBuf {
        self.path.join(file.name())
    }

    /// Removes a file, if it is there.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn remove(&self, file: AppendedFile) -> Result<(), OutputError> {
        remove(&self.path_of(file))
    }

    /// Removes one of the [`results`], if it is there.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn remove_result(&self, name: &str) -> Result<(), OutputError> {
        remove(&self.path.join(name))
    }

    /// Makes the folder ready: creates it, removes results of another case and what a killed run
    /// left half-written, writes the resolved case and the program's version.
    ///
    /// # Errors
    /// What cannot be written, and why.
    pub fn open(&self) -> Result<(), OutputError> {
        fs::create_dir_all(&self.path).map_err(|e| OutputError::new(&self.path, e))?;
        self.sweep()?;
        let stale =
            names_in(&self.path)?.into_iter().filter(|name| self.is_foreign && is_result(name));
        for name in stale {
            remove(&self.path.join(name))?;
        }
        // The case file itself may stand here, word for word.
        if !holds(&self.path.join(CASE), &self.case) {
            write_file(&self.path.join(CASE), self.case.as_bytes())?;
        }
        write_file(&self.path.join(PROGRAM), format!("{:#}\n", program(&self.undrawn)).as_bytes())
    }

    /// Writes one of the [`results`], whole or not at all.
    ///
    /// # Errors
    /// The file, and why it cannot be written.
    pub fn write(&self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(is_result(name), "{name} is not listed");
        write_file(&self.path.join(name), bytes)
    }
}

/// Removes a file, if it is there.
fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(OutputError {
            path: path.to_owned(),
            cause: error.to_string(),
            remedy: "let it be removed, or name another folder with --out",
        }),
        _ => Ok(()),
    }
}

/// Names in a folder; none where there is no folder.
fn names_in(folder: &Path) -> Result<Vec<String>, OutputError> {
    let at = |error| OutputError::new(folder, error);
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(at)?,
    };
    entries.map(|entry| Ok(entry.map_err(at)?.file_name().to_string_lossy().into_owned())).collect()
}

/// The file of the folder that is the case file `source` and would be overwritten with anything
/// else than it holds.
fn overwritten(folder: &Path, source: &Path, case: &str) -> Option<&'static str> {
    let source = source.canonicalize().ok()?;
    let is_source = |name: &&str| folder.join(name).canonicalize().is_ok_and(|p| p == source);
    let name = results().chain([CASE, PROGRAM]).find(is_source)?;
    (name != CASE || !holds(&source, case)).then_some(name)
}

/// Creates a file in the folder, or in the nearest one above that exists, and removes it again:
/// permission bits do not tell what a file system takes.
fn probe(folder: &Path) -> Result<(), OutputError> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    // A link that leads nowhere stands in the way as well.
    let nearest = folder.ancestors().find(|above| above.symlink_metadata().is_ok());
    let nearest = nearest.unwrap_or(Path::new("."));
    let at = |error| OutputError::new(nearest, error);
    if !fs::metadata(nearest).map_err(at)?.is_dir() {
        return Err(OutputError::new(nearest, "not a folder"));
    }
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = nearest.join(format!(".{PROBE}.{}-{count}.partial", std::process::id()));
        match File::create_new(&path) {
            // Left by a process that had the same number.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(at(error)),
            Ok(_) => return fs::remove_file(&path).map_err(at),
        }
    }
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// The file, and why it cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    files::write_atomically(path, bytes).map_err(|error| not_written(path, &error))
}

/// That a file was not written; its name once, not that of the temporary file.
pub fn not_written(path: &Path, error: &FileError) -> OutputError {
    OutputError::new(path, format!("cannot {}: {}", error.action, error.source))
}
