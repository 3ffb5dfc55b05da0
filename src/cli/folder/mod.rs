//! Folders of results: which may be written to, by whom, and what stands in every one of them.
//!
//! A run holds `lock` from its beginning to its end, so that there is one at a time. Whoever puts files in place or
//! removes some, runs among them, holds a second lock for that moment alone, and looks again under it whether the folder
//! may be written to: files of another process may have come meanwhile. Until then files have temporary names of their
//! own. Files and their line in `checksums.txt` change together: a line goes before its file, and comes after it.

mod checksums;
mod error;
mod names;
mod origin;
mod publication;
mod run;
mod verify;

pub use checksums::Damage;
pub use error::OutputError;
pub use names::{
    AppendedFile, CHECK, DISPERSION, MAP, POINT, RUN, SNAPSHOTS, SPEEDS, is_snapshot, results,
    snapshot_name,
};

pub use publication::Publication;
pub use run::{Begun, RunFolder};
pub use verify::{Verification, verify};

use crate::case::{Case, LARGEST_FILE};
use files::FileError;
use files::checksums::Checksums;
use files::lock::{Lock, LockError};
use names::{BRIEF_LOCK, CASE, PROBE, PROGRAM, is_half_written, is_result};
use origin::{foreign, holds, program_bytes};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Longest wait for another process that puts files into a folder.
const PATIENCE: Duration = Duration::from_secs(10);

/// A folder that may take the results of a case.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
    case: String,
    without_plot_options: String,
    /// Whether results of another case are to go, and runs to begin again.
    force: bool,
}

impl ResultFolder {
    /// The folder `out`, or else `out/<case name>`. Looks whether it takes files, and leaves
    /// nothing behind.
    ///
    /// An absent or empty folder will do, and one that holds results of the very same case from
    /// the very same program: they will be the same bits. Anything else needs `force`, and must not be a run in
    /// progress. The file that the case was loaded from is never overwritten by anything else than itself, and no
    /// file that the case reads.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check(case: &Case, out: Option<&Path>, force: bool) -> Result<Self, OutputError> {
        let path = out.map_or_else(|| Path::new("out").join(&case.name), Path::to_owned);
        let (text, without_plot_options) = (case.to_toml(), case.without_plot_options().to_toml());
        let own = Self { path, case: text, without_plot_options, force };
        if own.case.len() as u64 > LARGEST_FILE {
            let bytes = own.case.len();
            return Err(OutputError {
                path: own.path.join(CASE),
                cause: format!(
                    "with all its defaults the case has {bytes} bytes, more than a case file may have"
                ),
                remedy: "ask for fewer receivers, or for shorter tables",
            });
        }
        let in_the_way = |name: &str, cause: &str| OutputError {
            path: own.path.join(name),
            cause: cause.to_owned(),
            remedy: "name another folder with --out",
        };
        if let Some(name) = case.source().and_then(|source| own.overwritten(source)) {
            return Err(in_the_way(
                name,
                "this is the case file itself, which would be overwritten",
            ));
        }
        if let Some(name) = case.input_files().find_map(|input| own.result_at(input)) {
            return Err(in_the_way(
                &name,
                "the case begins with this file, which would be overwritten",
            ));
        }
        let is_foreign = own.refuse_foreign()?;
        if is_foreign && own.has_living_run()? {
            return Err(own.busy());
        }
        probe(&own.path)?;
        Ok(own)
    }

    /// Whether there are results of another case, which are to go.
    ///
    /// # Errors
    /// There are, and they are not.
    fn refuse_foreign(&self) -> Result<bool, OutputError> {
        match foreign(&self.path, &self.case, &self.without_plot_options)? {
            Some(cause) if !self.force => Err(OutputError {
                path: self.path.clone(),
                cause: cause.into(),
                remedy: "name another folder with --out, or overwrite with --force",
            }),
            cause => Ok(cause.is_some()),
        }
    }

    /// The file of the folder that is the case file `source` and would be overwritten with anything
    /// else than it holds.
    fn overwritten(&self, source: &Path) -> Option<&'static str> {
        let source = source.canonicalize().ok()?;
        let is_source =
            |name: &&str| self.path.join(name).canonicalize().is_ok_and(|p| p == source);
        let name = results().chain([CASE, PROGRAM]).find(is_source)?;
        (name != CASE || !holds(&source, &self.case)).then_some(name)
    }

    /// The name under which a file stands in this folder as one that verbs write or remove.
    fn result_at(&self, input: &Path) -> Option<String> {
        let (input, own) = (input.canonicalize().ok()?, self.path.canonicalize().ok()?);
        let name = input.strip_prefix(own).ok()?.to_str()?;
        let is_own = is_result(name)
            || [CASE, PROGRAM, AppendedFile::Log.name()].contains(&name)
            || is_half_written(name);
        is_own.then(|| name.to_owned())
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The resolved case without what decides over its pictures alone.
    pub fn without_plot_options(&self) -> &str {
        &self.without_plot_options
    }

    /// Names of the files that stand in every folder of results.
    pub const ALWAYS: [&str; 3] = [CASE, PROGRAM, Checksums::NAME];

    /// Where a file stands.
    pub fn path_of(&self, file: AppendedFile) -> PathBuf {
        self.path.join(file.name())
    }

    /// Keeps others from putting files in place or removing some, for a moment.
    fn lock_briefly(&self) -> Result<Lock, OutputError> {
        fs::create_dir_all(&self.path).map_err(|error| OutputError::new(&self.path, error))?;
        let path = self.path.join(BRIEF_LOCK);
        match Lock::acquire(&path, PATIENCE) {
            Ok(lock) => Ok(lock.without_trace()),
            Err(LockError::Busy) => Err(OutputError {
                path: self.path.clone(),
                cause: "another process has been putting files here for 10 s".into(),
                remedy: "try again, or name another folder with --out",
            }),
            Err(LockError::Refused(error)) => Err(not_locked(&path, &error)),
        }
    }

    /// Whether a run is in progress here.
    fn has_living_run(&self) -> Result<bool, OutputError> {
        if self.path_of(AppendedFile::Lock).symlink_metadata().is_err() {
            return Ok(false);
        }
        let _brief = self.lock_briefly()?;
        Ok(self.has_run_lock())
    }

    /// The same for who holds the other lock.
    fn has_run_lock(&self) -> bool {
        Lock::is_held(&self.path_of(AppendedFile::Lock))
    }

    /// That a run is in progress here.
    fn busy(&self) -> OutputError {
        OutputError {
            path: self.path.clone(),
            cause: "a run is in progress here".into(),
            remedy: "wait for it, or name another folder with --out",
        }
    }

    /// Removes results of another case.
    fn remove_results(&self) -> Result<(), OutputError> {
        // A list would have lines of files that are gone.
        remove(&self.path.join(Checksums::NAME))?;
        let names = names_in(&self.path)?;
        let is_kept = |name: &str| name == AppendedFile::Lock.name() && self.has_run_lock();
        let mut own = names.iter().filter(|name| is_result(name) && !is_kept(name));
        own.try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Writes the resolved case and the program's version, where they do not stand here already.
    fn write_origin(&self) -> Result<(), OutputError> {
        for (name, bytes) in self.origin_files() {
            let path = self.path.join(name);
            // The case file itself may stand here, word for word.
            if !files::read_regular(&path).is_ok_and(|found| found == bytes) {
                write_file(&path, &bytes)?;
            }
        }
        Ok(())
    }

    /// The files that say what the results are of.
    fn origin_files(&self) -> [(&'static str, Vec<u8>); 2] {
        [
            (CASE, self.case.clone().into_bytes()),
            (PROGRAM, program_bytes(&self.without_plot_options)),
        ]
    }

    /// Removes what killed processes left half-written.
    fn sweep(&self) -> Result<(), OutputError> {
        let names = names_in(&self.path)?;
        let mut half_written = names.iter().filter(|name| is_half_written(name));
        half_written.try_for_each(|name| {
            let path = self.path.join(name);
            files::remove_abandoned(&path).map_err(|error| not_removed(&path, &error))
        })
    }
}

/// That a lock cannot be had.
fn not_locked(path: &Path, error: &std::io::Error) -> OutputError {
    OutputError {
        path: path.to_owned(),
        cause: format!("cannot be locked: {error}"),
        remedy: "remove it, or name another folder with --out",
    }
}

/// Removes a file, if it is there.
fn remove(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(not_removed(path, &error)),
        _ => Ok(()),
    }
}

fn not_removed(path: &Path, error: &std::io::Error) -> OutputError {
    OutputError {
        path: path.to_owned(),
        cause: error.to_string(),
        remedy: "let it be removed, or name another folder with --out",
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
            // Another process may have swept it away as a leftover.
            Ok(_) => match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(at(error)),
                _ => return Ok(()),
            },
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
