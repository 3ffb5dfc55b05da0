//! Results folders: write permission, locks, and the files that every folder contains.
//!
//! A run holds the file lock `lock` from beginning to end, so that only one run at a time writes to a folder. Every
//! process that publishes or removes files, including runs, holds a second lock, the publication lock, only during that
//! operation. Under this lock it checks again whether the folder may be written, since another process may have added
//! files. Files have unique temporary names until they are published. The checksum entry of a file is removed before
//! the file and added after it.

mod checksums;
mod error;
mod names;
mod origin;
mod page;
mod publication;
mod run;
mod verify;

pub use checksums::Damage;
pub use error::OutputError;
pub use names::{
    AppendedFile, BLOCH_FILES, CASE_FILE, CERTIFIED_MAP_FILES, CHECK_FILES, COMPARISON_FILES,
    DIAGRAM_FILES, DISPERSION_FILES, FIELDS_ARCHIVE_FILE, JOINT_ARCHIVE_FILE,
    JOINT_SNAPSHOT_LIST_FILE, MAP_FILES, POINT_FILES, PartFile, REPORT_PAGE_FILE, RUN_FILES,
    SHOCKS_FILES, SNAPSHOT_LIST_FILE, SPEEDS_FILES, SPLIT_FILES, TIME_FILES, ZARR_STORE_FILE,
    has_joint_files, is_part_name, is_snapshot_name, joint_snapshot_file_name, result_file_names,
    snapshot_file_name, snapshot_file_names, snapshot_index_name,
};

pub use publication::Publication;
pub use run::{RunFolder, UnfinishedRun};
pub use verify::{VerificationResult, verify_folder};

use crate::case::{Case, MAX_FILE_SIZE};
use crate::report::format::case_title;
use files::FileError;
use files::checksums::Checksums;
use files::lock::{Lock, LockError};
use names::{
    PROBE_FILE_STEM, PROGRAM_FILE, PUBLICATION_LOCK_FILE, is_result_file_name, is_temporary_name,
};
use origin::{has_equal_content, overwrite_refusal_reason, serialise_program_file};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Longest wait for the publication lock while another process publishes or removes files.
const PUBLICATION_LOCK_TIMEOUT: Duration = Duration::from_secs(10);

/// Folder to which the results of a case may be written.
#[derive(Clone, Debug)]
pub struct ResultFolder {
    path: PathBuf,
    case_title: String,
    case_toml: String,
    case_without_plot_options: String,
    /// Whether results of other cases may be overwritten and finished runs restarted (`--force`).
    can_overwrite: bool,
}

impl ResultFolder {
    /// Selects the results folder `out`, by default `out/<case name>`, and checks by a test write that it can be
    /// written to; no file is left in it, and the folder is not created. If the source file of the case is in the
    /// folder, it is overwritten only by identical content; input files of the case are never overwritten.
    ///
    /// # Errors
    /// The folder cannot be written, the source file or an input file of the case would be overwritten, or the resolved
    /// case is larger than a case file may be; the error states the remedy.
    pub fn from_case(case: &Case, out: Option<&Path>, force: bool) -> Result<Self, OutputError> {
        let path = out.map_or_else(|| Path::new("out").join(&case.name), Path::to_owned);
        let (text, case_without_plot_options) =
            (case.to_toml(), case.without_plot_options().to_toml());
        let own = Self {
            path,
            case_title: case_title(case),
            case_toml: text,
            case_without_plot_options,
            can_overwrite: force,
        };
        if own.case_toml.len() as u64 > MAX_FILE_SIZE {
            let bytes = own.case_toml.len();
            return Err(OutputError {
                path: own.path.join(CASE_FILE),
                cause: format!(
                    "with all its defaults the case has {bytes} bytes, more than a case file may have"
                ),
                remedy: "ask for fewer receivers, or for shorter tables",
            });
        }
        let create_conflict_error = |name: &str, cause: &str| OutputError {
            path: own.path.join(name),
            cause: cause.to_owned(),
            remedy: "name another folder with --out",
        };
        if let Some(name) =
            case.source_path().and_then(|source| own.find_overwritten_source(source))
        {
            return Err(create_conflict_error(
                name,
                "this is the case file itself, which would be overwritten",
            ));
        }
        if let Some(name) = case.input_files().find_map(|input| own.find_overwritten_input(input)) {
            return Err(create_conflict_error(
                &name,
                "the case begins with this file, which would be overwritten",
            ));
        }
        check_writable(&own.path)?;
        Ok(own)
    }

    /// Checks that results may be put into the folder: it may be absent, empty, or hold results of the same case by the
    /// same program version, which are bit-identical. Any other folder requires `force` and no run in progress.
    ///
    /// # Errors
    /// The folder contains other files, or a run in it is in progress; the error states the remedy.
    pub fn check_other_results(&self) -> Result<(), OutputError> {
        let is_foreign = self.has_foreign_results()?;
        if is_foreign && self.has_active_run()? {
            return Err(self.create_active_run_error());
        }
        Ok(())
    }

    /// Returns whether the folder contains results of another case or program version, which may be removed because of
    /// `--force`.
    ///
    /// # Errors
    /// The folder contains other results, and `force` is not set.
    pub fn has_foreign_results(&self) -> Result<bool, OutputError> {
        match overwrite_refusal_reason(
            &self.path,
            &self.case_toml,
            &self.case_without_plot_options,
        )? {
            Some(cause) if !self.can_overwrite => Err(OutputError {
                path: self.path.clone(),
                cause: cause.into(),
                remedy: "name another folder with --out, or overwrite with --force",
            }),
            cause => Ok(cause.is_some()),
        }
    }

    /// Returns the name under which the source file `source` of the case is in this folder, if publication would change
    /// its content.
    fn find_overwritten_source(&self, source: &Path) -> Option<&'static str> {
        let source = source.canonicalize().ok()?;
        let is_source =
            |name: &&str| self.path.join(name).canonicalize().is_ok_and(|p| p == source);
        let name = result_file_names().chain([CASE_FILE, PROGRAM_FILE]).find(is_source)?;
        (name != CASE_FILE || !has_equal_content(&source, &self.case_toml)).then_some(name)
    }

    /// Returns the name of the input file `input` in this folder, if verbs write or remove files of that name.
    fn find_overwritten_input(&self, input: &Path) -> Option<String> {
        let (input, own) = (input.canonicalize().ok()?, self.path.canonicalize().ok()?);
        let name = input.strip_prefix(own).ok()?.to_str()?;
        let is_own = is_result_file_name(name)
            || [CASE_FILE, PROGRAM_FILE, AppendedFile::Log.name()].contains(&name)
            || is_temporary_name(name);
        is_own.then(|| name.to_owned())
    }

    /// Returns the path of the results folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the resolved case as TOML without the options that only affect its pictures.
    pub fn case_without_plot_options(&self) -> &str {
        &self.case_without_plot_options
    }

    /// Names of the files that every results folder contains.
    pub const COMMON_FILE_NAMES: [&str; 3] = [CASE_FILE, PROGRAM_FILE, Checksums::FILE_NAME];

    /// Returns the path of an appended file in this folder.
    pub fn file_path(&self, file: AppendedFile) -> PathBuf {
        self.path.join(file.name())
    }

    /// Acquires the publication lock for publishing and removing files.
    fn acquire_publication_lock(&self) -> Result<Lock, OutputError> {
        create_folder(&self.path)?;
        let path = self.path.join(PUBLICATION_LOCK_FILE);
        match Lock::acquire(&path, PUBLICATION_LOCK_TIMEOUT) {
            Ok(lock) => Ok(lock.with_removal_on_drop()),
            Err(LockError::Busy) => Err(OutputError {
                path: self.path.clone(),
                cause: "another process has been putting files here for 10 s".into(),
                remedy: "try again, or name another folder with --out",
            }),
            Err(LockError::Io(error)) => Err(create_lock_error(&path, &error)),
        }
    }

    /// Returns whether a run is in progress in this folder; acquires the publication lock.
    fn has_active_run(&self) -> Result<bool, OutputError> {
        if self.file_path(AppendedFile::Lock).symlink_metadata().is_err() {
            return Ok(false);
        }
        let _brief = self.acquire_publication_lock()?;
        Ok(self.has_run_lock())
    }

    /// Returns whether a run is in progress; the caller holds the publication lock.
    fn has_run_lock(&self) -> bool {
        Lock::is_held(&self.file_path(AppendedFile::Lock))
    }

    /// Creates the error that a run is in progress in this folder.
    fn create_active_run_error(&self) -> OutputError {
        OutputError {
            path: self.path.clone(),
            cause: "a run is in progress here".into(),
            remedy: "wait for it, or name another folder with --out",
        }
    }

    /// Removes all result files, except the lock of a run in progress.
    fn remove_results(&self) -> Result<(), OutputError> {
        // The checksum list is removed first, so that it never lists absent files.
        remove_file_if_exists(&self.path.join(Checksums::FILE_NAME))?;
        let names = list_file_names(&self.path)?;
        let is_kept = |name: &str| name == AppendedFile::Lock.name() && self.has_run_lock();
        let mut own = names.iter().filter(|name| is_result_file_name(name) && !is_kept(name));
        own.try_for_each(|name| remove_file_if_exists(&self.path.join(name)))
    }

    /// Writes the resolved case and the program version; a file that exists with identical content is not rewritten.
    fn write_origin(&self) -> Result<(), OutputError> {
        for (name, bytes) in self.origin_files() {
            let path = self.path.join(name);
            // An identical case file is not rewritten.
            if !files::read_regular_file(&path).is_ok_and(|found| found == bytes) {
                write_file(&path, &bytes)?;
            }
        }
        Ok(())
    }

    /// Returns the files that identify case and program version.
    fn origin_files(&self) -> [(&'static str, Vec<u8>); 2] {
        [
            (CASE_FILE, self.case_toml.clone().into_bytes()),
            (PROGRAM_FILE, serialise_program_file(&self.case_without_plot_options)),
        ]
    }

    /// Removes temporary files left by killed processes.
    fn remove_abandoned_files(&self) -> Result<(), OutputError> {
        let names = list_file_names(&self.path)?;
        let mut half_written = names.iter().filter(|name| is_temporary_name(name));
        half_written.try_for_each(|name| {
            let path = self.path.join(name);
            files::remove_abandoned_file(&path).map_err(|error| create_removal_error(&path, &error))
        })
    }
}

/// Creates the error that a lock cannot be acquired.
fn create_lock_error(path: &Path, error: &std::io::Error) -> OutputError {
    OutputError {
        path: path.to_owned(),
        cause: format!("cannot be locked: {error}"),
        remedy: "remove it, or name another folder with --out",
    }
}

/// Removes a file if it exists.
fn remove_file_if_exists(path: &Path) -> Result<(), OutputError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => {
            Err(create_removal_error(path, &error))
        }
        _ => Ok(()),
    }
}

fn create_removal_error(path: &Path, error: &std::io::Error) -> OutputError {
    OutputError {
        path: path.to_owned(),
        cause: error.to_string(),
        remedy: "let it be removed, or name another folder with --out",
    }
}

/// Creates a folder and its parents where they do not exist.
///
/// # Errors
/// The folder cannot be created.
pub fn create_folder(path: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(path).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists | ErrorKind::NotADirectory => {
            OutputError::new(path, "a file is in the place of a folder")
        }
        _ => OutputError::new(path, error),
    })
}

/// Returns the message that a path is not that of a folder; `None` if it is.
fn describe_missing_folder(path: &Path) -> Option<&'static str> {
    match fs::metadata(path) {
        Ok(found) if found.is_dir() => None,
        Ok(_) => Some("a file, not a folder"),
        Err(error) if error.kind() == ErrorKind::NotFound => Some("no such folder"),
        Err(_) => None,
    }
}

/// Lists the names of the files in a folder that ranks have written for their own cells.
///
/// # Errors
/// The folder cannot be read.
pub fn list_part_names(folder: &Path) -> Result<Vec<String>, OutputError> {
    let names = list_file_names(folder)?.into_iter();
    Ok(names.filter(|name| is_part_name(name) && !names::is_checkpoint_part_name(name)).collect())
}

/// Lists the names in a folder; empty if the folder does not exist.
fn list_file_names(folder: &Path) -> Result<Vec<String>, OutputError> {
    let at = |error| OutputError::new(folder, error);
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(at)?,
    };
    entries.map(|entry| Ok(entry.map_err(at)?.file_name().to_string_lossy().into_owned())).collect()
}

/// Checks that files can be created, by creating and removing one in the folder or in its nearest existing ancestor;
/// permission bits do not determine whether the file system accepts files.
fn check_writable(folder: &Path) -> Result<(), OutputError> {
    static PROBE_COUNT: AtomicUsize = AtomicUsize::new(0);
    // `symlink_metadata`, so that a dangling link counts as existing.
    let nearest = folder.ancestors().find(|above| above.symlink_metadata().is_ok());
    let nearest = nearest.unwrap_or(Path::new("."));
    let at = |error: std::io::Error| match nearest == folder {
        true => OutputError::new(folder, error),
        false => OutputError::new(
            folder,
            format!("no folder can be created in {}: {error}", nearest.display()),
        ),
    };
    if !fs::metadata(nearest).map_err(at)?.is_dir() {
        return Err(match nearest == folder {
            true => OutputError::new(folder, "not a folder"),
            false => OutputError::new(folder, format!("{} is not a folder", nearest.display())),
        });
    }
    loop {
        let count = PROBE_COUNT.fetch_add(1, Ordering::Relaxed);
        let path =
            nearest.join(format!(".{PROBE_FILE_STEM}.{}-{count}.partial", std::process::id()));
        match File::create_new(&path) {
            // An earlier process with the same process id left this file; the next name is tried.
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(at(error)),
            // Another process may have removed the file already, as a file of a killed process.
            Ok(_) => match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => return Err(at(error)),
                _ => return Ok(()),
            },
        }
    }
}

/// Writes a file atomically: readers see the previous content or the complete new one.
///
/// # Errors
/// The file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    files::write_atomically(path, bytes).map_err(|error| create_write_error(path, &error))
}

/// Creates the error that a file was not written; it names the target, not the temporary file.
pub fn create_write_error(path: &Path, error: &FileError) -> OutputError {
    OutputError::new(path, format!("cannot {}: {}", error.action, error.source))
}
