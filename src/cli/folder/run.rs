//! Results folders of simulations: locking, resuming and redrawing.

use super::names::{
    CASE_FILE, FINISHED_RUN_FILE, PROGRAM_FILE, is_checkpoint_part_name, is_run_file_name,
};
use super::origin::ResultOrigin;
use super::{
    AppendedFile, OutputError, ResultFolder, create_lock_error, create_write_error,
    describe_missing_folder, list_file_names, list_part_names, remove_file_if_exists,
};
use crate::case::Case;
use crate::cli::CommandError;
use crate::report::format::case_title;
use crate::report::page::PageSection;
use files::checksums::Checksums;
use files::lock::{Lock, LockError};
use files::{DigestWriter, FileDigest, SeekableWriter, StagedFile, stage_file_with};
use std::io;
use std::path::Path;

/// Unfinished run whose folder is locked by this process.
pub struct UnfinishedRun {
    /// Results folder of the unfinished run.
    pub folder: ResultFolder,
    /// Case of the unfinished run.
    pub case: Case,
    /// Run lock of the folder, which excludes other runs.
    pub run_lock: Lock,
}

impl ResultFolder {
    /// Opens and locks the folder of an unfinished run and loads its case.
    ///
    /// # Errors
    /// The folder holds no run, a finished run, a run in progress, a run of another program version, or a run whose
    /// case was changed after it began.
    pub fn open_unfinished_run(path: &Path) -> Result<UnfinishedRun, CommandError> {
        let refused = |cause: &str, remedy| OutputError {
            path: path.to_owned(),
            cause: cause.to_owned(),
            remedy,
        };
        let remedy = "name a folder with the results of wellposed run";
        if let Some(cause) = describe_other_results(path) {
            return Err(refused(&cause, remedy).into());
        }
        if !path.join(CASE_FILE).is_file() {
            return Err(refused("no run: it holds no case.toml", remedy).into());
        }
        // Only the path is known here: the folder is locked before its content is read.
        let nameless = Self {
            path: path.to_owned(),
            case_title: String::new(),
            case_toml: String::new(),
            case_without_plot_options: String::new(),
            can_overwrite: false,
        };
        let lock = nameless.lock_run()?;
        if path.join(FINISHED_RUN_FILE).exists() {
            return Err(refused("the run is finished", "wellposed plot draws it again").into());
        }
        let (folder, case) = Self::from_stored_case(path)?;
        if !folder.read_origin()?.is_same_version {
            let remedy = "resume it with that version, or run the case again with --force";
            return Err(refused("a run of another version of this program", remedy).into());
        }
        folder.check_stored_case()?;
        Ok(UnfinishedRun { folder, case, run_lock: lock })
    }

    /// Opens the folder of a finished run for redrawing and loads its case.
    ///
    /// # Errors
    /// The folder holds no finished run, or its case was changed in more than the plot options.
    pub fn open_finished_run(path: &Path) -> Result<(Self, Case), CommandError> {
        if !path.join(FINISHED_RUN_FILE).exists() || !path.join(CASE_FILE).is_file() {
            let remedy = match has_run_files(path) {
                true => "wellposed resume finishes an interrupted run",
                false => "name a folder with the results of wellposed run",
            };
            let cause = describe_other_results(path).unwrap_or("no finished run".to_owned());
            return Err(OutputError { path: path.to_owned(), cause, remedy }.into());
        }
        let (folder, case) = Self::from_stored_case(path)?;
        folder.check_stored_case()?;
        Ok((folder, case))
    }

    /// Opens the folder of results of other verbs than `run` for redrawing and loads its case.
    ///
    /// # Errors
    /// The folder holds no case, or one that was changed in more than the plot options.
    pub fn open_study(path: &Path) -> Result<(Self, Case), CommandError> {
        let case = Case::load(&path.join(CASE_FILE), &[])?;
        let (folder, case) = Self::for_stored_case(path, case);
        folder.check_stored_case()?;
        Ok((folder, case))
    }

    /// Opens a folder for the case of a simulation stored in it, and loads that case.
    pub(super) fn from_stored_case(path: &Path) -> Result<(Self, Case), CommandError> {
        let case = Case::load_simulation(&path.join(CASE_FILE), &[])?;
        Ok(Self::for_stored_case(path, case))
    }

    fn for_stored_case(path: &Path, case: Case) -> (Self, Case) {
        let (text, case_without_plot_options) =
            (case.to_toml(), case.without_plot_options().to_toml());
        let folder = Self {
            path: path.to_owned(),
            case_title: case_title(&case),
            case_toml: text,
            case_without_plot_options,
            can_overwrite: false,
        };
        (folder, case)
    }

    fn read_origin(&self) -> Result<ResultOrigin, OutputError> {
        ResultOrigin::from_folder(&self.path, &self.case_without_plot_options)
    }

    /// Checks that the case in the folder is the one with which its run began, apart from plot options.
    fn check_stored_case(&self) -> Result<(), OutputError> {
        let origin = self.read_origin()?;
        if origin.is_same_case {
            return Ok(());
        }
        let cause = match origin.is_same_version {
            true => "not what the run began with, in more than output.picture and output.contours",
            false => "of a run of another version of this program",
        };
        Err(OutputError {
            path: self.path.join(CASE_FILE),
            cause: cause.to_owned(),
            remedy: "take the change back, or run the case again with --force",
        })
    }

    /// Checks that a run may begin: no run is in progress, and without `force` no finished or interrupted run would be
    /// discarded.
    ///
    /// # Errors
    /// A run is in progress, or an existing run would be discarded; the error states the remedy.
    pub fn check_run_may_start(&self) -> Result<(), OutputError> {
        if self.has_active_run()? {
            Err(self.create_active_run_error())
        } else {
            self.check_existing_runs()
        }
    }

    fn check_existing_runs(&self) -> Result<(), OutputError> {
        let refused = |cause: &str, remedy| {
            Err(OutputError { path: self.path.clone(), cause: cause.to_owned(), remedy })
        };
        if self.can_overwrite {
            Ok(())
        } else if self.path.join(FINISHED_RUN_FILE).exists() {
            refused("the folder holds this run, finished", "compute it again with --force")
        } else if self.file_path(AppendedFile::Checkpoint).exists() {
            let remedy = "go on with wellposed resume, or begin again with --force";
            refused("the folder holds this run, interrupted", remedy)
        } else {
            Ok(())
        }
    }

    /// Acquires the run lock, held until the returned value is dropped; changes nothing else.
    fn lock_run(&self) -> Result<Lock, OutputError> {
        let _brief = self.acquire_publication_lock()?;
        self.acquire_run_lock()
    }

    /// Acquires the run lock; the caller holds the publication lock.
    fn acquire_run_lock(&self) -> Result<Lock, OutputError> {
        let path = self.file_path(AppendedFile::Lock);
        Lock::try_acquire(&path).map_err(|error| match error {
            LockError::Busy => self.create_active_run_error(),
            LockError::Io(error) => create_lock_error(&path, &error),
        })
    }

    /// Prepares the folder for a run from its beginning: removes files of earlier runs, results of another case if
    /// allowed, and files of killed processes.
    ///
    /// # Errors
    /// The folder may not be used for a run, or a file cannot be written or removed.
    pub fn begin_run(&self) -> Result<RunFolder<'_>, OutputError> {
        let _brief = self.acquire_publication_lock()?;
        let lock = self.acquire_run_lock()?;
        let is_foreign = self.has_foreign_results()?;
        if !is_foreign {
            self.check_existing_runs()?;
        }
        self.remove_files_before_run(is_foreign)?;
        Ok(RunFolder::new(self, lock))
    }

    /// Prepares the folder for the restart of a run that was killed before its first checkpoint.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn restart_run(&self, lock: Lock) -> Result<RunFolder<'_>, OutputError> {
        let _brief = self.acquire_publication_lock()?;
        self.remove_files_before_run(false)?;
        Ok(RunFolder::new(self, lock))
    }

    /// Removes the parts of states for checkpoints, except those of the checkpoint after `kept_steps` steps.
    ///
    /// # Errors
    /// A file cannot be removed.
    pub fn remove_checkpoint_parts(&self, kept_steps: Option<usize>) -> Result<(), OutputError> {
        let steps = |name: &str| name.split('-').nth(1)?.parse::<usize>().ok();
        let names = list_file_names(&self.path)?;
        let mut old = names.iter().filter(|name| {
            is_checkpoint_part_name(name) && (kept_steps.is_none() || steps(name) != kept_steps)
        });
        old.try_for_each(|name| remove_file_if_exists(&self.path.join(name)))
    }

    fn remove_files_before_run(&self, is_foreign: bool) -> Result<(), OutputError> {
        self.remove_abandoned_files()?;
        match is_foreign {
            true => self.remove_results()?,
            false => {
                self.remove_run_checksums()?;
                self.remove_page_section("run")?;
            }
        }
        self.write_origin()?;
        let names = list_file_names(&self.path)?;
        let mut own =
            names.iter().filter(|name| is_run_file_name(name) || *name == AppendedFile::Log.name());
        own.try_for_each(|name| remove_file_if_exists(&self.path.join(name)))
    }
}

/// Returns whether a folder has files that a run in progress writes.
fn has_run_files(path: &Path) -> bool {
    let run_files = [AppendedFile::Checkpoint, AppendedFile::Log, AppendedFile::Ledger];
    run_files.iter().any(|file| path.join(file.name()).exists())
}

/// Returns the message that there is no folder of this path, or that it holds results of other verbs than `run`; `None`
/// if it holds files of a run, or no results.
fn describe_other_results(path: &Path) -> Option<String> {
    if let Some(fault) = describe_missing_folder(path) {
        return Some(fault.to_owned());
    }
    const VERBS: [&str; 10] = [
        "map",
        "point",
        "dispersion",
        "diagram",
        "speeds",
        "shocks",
        "check",
        "split",
        "time",
        "compare",
    ];
    if path.join(FINISHED_RUN_FILE).exists() || has_run_files(path) {
        return None;
    }
    let verbs: Vec<&str> =
        VERBS.into_iter().filter(|verb| path.join(format!("{verb}.json")).exists()).collect();
    (!verbs.is_empty())
        .then(|| format!("holds results of wellposed {}, but no run", verbs.join(" and ")))
}

/// Folder of a run in progress, locked against other runs until dropped.
pub struct RunFolder<'a> {
    folder: &'a ResultFolder,
    run_lock: Lock,
    /// Lengths and checksums of the files written so far.
    checksums: Checksums,
    /// Staged report, published last: its existence marks the run as finished.
    staged_report: Option<StagedFile>,
}

impl<'a> RunFolder<'a> {
    fn new(folder: &'a ResultFolder, lock: Lock) -> Self {
        Self { folder, run_lock: lock, checksums: Checksums::default(), staged_report: None }
    }

    /// Opens the folder of a run resumed from a checkpoint. The files written before it are kept; their checksums must
    /// be added with [`insert_checksum`](Self::insert_checksum).
    ///
    /// # Errors
    /// Leftovers of killed processes cannot be removed.
    pub fn from_checkpoint(folder: &'a ResultFolder, lock: Lock) -> Result<Self, OutputError> {
        let _brief = folder.acquire_publication_lock()?;
        folder.remove_abandoned_files()?;
        Ok(Self::new(folder, lock))
    }

    /// Writes a snapshot or another file of a simulation atomically; the report `run.json` becomes visible when the run
    /// [is finished](Self::finish).
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_result(&mut self, name: &str, bytes: &[u8]) -> Result<FileDigest, OutputError> {
        self.write_result_with(name, &mut |file| file.write_all(bytes))
    }

    /// Writes a file of a simulation as [`write_result`](Self::write_result) does, with the content that `write` produces.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_result_with(
        &mut self,
        name: &str,
        write: &mut dyn FnMut(&mut dyn SeekableWriter) -> io::Result<()>,
    ) -> Result<FileDigest, OutputError> {
        debug_assert!(is_run_file_name(name), "{name} is not listed");
        let path = self.folder.path.join(name);
        let at = |error| create_write_error(&path, &error);
        let mut written = FileDigest::default();
        let staged = stage_file_with(&path, |file| {
            let mut writer = DigestWriter::new(file);
            write(&mut writer)?;
            written = writer.finish()?;
            Ok(())
        });
        let staged = staged.map_err(at)?;
        match name {
            FINISHED_RUN_FILE => self.staged_report = Some(staged),
            _ => staged.publish().map_err(at)?,
        }
        self.checksums.insert(name, written);
        Ok(written)
    }

    /// Removes the checksum of a file that is no longer part of the results.
    pub fn remove_checksum(&mut self, name: &str) {
        self.checksums.remove(name);
    }

    /// Adds the length and checksum of a file that [`write_result`](Self::write_result) did not write.
    pub fn insert_checksum(&mut self, name: &str, written: FileDigest) {
        self.checksums.insert(name, written);
    }

    /// Removes one of the [`result_file_names`](super::result_file_names) if it exists.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove_result(&mut self, name: &str) -> Result<(), OutputError> {
        self.checksums.remove(name);
        remove_file_if_exists(&self.folder.path.join(name))
    }

    /// Finishes the run: writes its section of the page if there is one and the checksums of all its files, publishes the
    /// report, and removes the checkpoint and the run lock.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn finish(self, page_section: Option<&PageSection>) -> Result<(), OutputError> {
        let Self { folder, run_lock: lock, checksums: own, staged_report } = self;
        let _brief = folder.acquire_publication_lock()?;
        let mut checksums = folder.load_checksums_or_empty();
        own.iter().for_each(|(name, written)| checksums.insert(name, written));
        if let Some(section) = page_section {
            folder.write_page_with(&mut checksums, section)?;
        }
        folder.add_current_checksums(&mut checksums, &[CASE_FILE, PROGRAM_FILE])?;
        folder.write_checksums(&checksums)?;
        if let Some(staged_report) = staged_report {
            let path = folder.path.join(FINISHED_RUN_FILE);
            staged_report.publish().map_err(|error| create_write_error(&path, &error))?;
        }
        remove_file_if_exists(&folder.file_path(AppendedFile::Checkpoint))?;
        folder.remove_checkpoint_parts(None)?;
        // Parts of snapshots that were repeated by other ranks, or have been joined.
        for name in list_part_names(&folder.path)? {
            if own.digest(&name).is_none() {
                remove_file_if_exists(&folder.path.join(name))?;
            }
        }
        drop(lock.with_removal_on_drop());
        Ok(())
    }
}
