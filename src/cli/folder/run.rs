//! Results folders of simulations: locking, resuming and redrawing.

use super::names::{CASE, FINISHED, PROGRAM, is_of_run};
use super::origin::Origin;
use super::{
    AppendedFile, OutputError, ResultFolder, names_in, not_locked, not_written, remove, write_file,
};
use crate::case::Case;
use crate::cli::Error;
use files::checksums::Checksums;
use files::lock::{Lock, LockError};
use files::{Staged, Written, stage_with};
use std::io::Write as _;
use std::path::Path;

/// Unfinished run whose folder is locked by this process.
pub struct Begun {
    /// Results folder.
    pub folder: ResultFolder,
    /// Case of the run.
    pub case: Case,
    /// Lock that excludes other runs.
    pub lock: Lock,
}

impl ResultFolder {
    /// Opens and locks the folder of an unfinished run and loads its case.
    ///
    /// # Errors
    /// The folder holds no run, a finished run, a run in progress, a run of another program version, or a run whose
    /// case was changed after it began.
    pub fn of_run(path: &Path) -> Result<Begun, Error> {
        let refused = |cause: &str, remedy| OutputError {
            path: path.to_owned(),
            cause: cause.to_owned(),
            remedy,
        };
        if !path.join(CASE).is_file() {
            let remedy = "name the folder of results of wellposed run";
            return Err(refused("no run: it holds no case.toml", remedy).into());
        }
        // Only the path is known here: the folder is locked before its content is read.
        let nameless = Self {
            path: path.to_owned(),
            case: String::new(),
            without_plot_options: String::new(),
            force: false,
        };
        let lock = nameless.lock_run()?;
        if path.join(FINISHED).exists() {
            return Err(refused("the run is finished", "wellposed plot draws it again").into());
        }
        let (folder, case) = Self::of_own_case(path)?;
        if !folder.origin()?.is_version {
            let remedy = "resume it with that version, or run the case again with --force";
            return Err(refused("a run of another version of this program", remedy).into());
        }
        folder.check_case()?;
        Ok(Begun { folder, case, lock })
    }

    /// Opens the folder of a finished run for redrawing and loads its case.
    ///
    /// # Errors
    /// The folder holds no finished run, or its case was changed in more than the plot options.
    pub fn finished(path: &Path) -> Result<(Self, Case), Error> {
        if !path.join(FINISHED).exists() || !path.join(CASE).is_file() {
            let remedy = "name the folder of results of wellposed run; resume an unfinished one";
            let (path, cause) = (path.to_owned(), "no finished run".to_owned());
            return Err(OutputError { path, cause, remedy }.into());
        }
        let (folder, case) = Self::of_own_case(path)?;
        folder.check_case()?;
        Ok((folder, case))
    }

    /// Opens a folder with the case stored in it.
    pub(super) fn of_own_case(path: &Path) -> Result<(Self, Case), Error> {
        let case = Case::load_in_time(&path.join(CASE), &[])?;
        let (text, without_plot_options) = (case.to_toml(), case.without_plot_options().to_toml());
        Ok((Self { path: path.to_owned(), case: text, without_plot_options, force: false }, case))
    }

    fn origin(&self) -> Result<Origin, OutputError> {
        Origin::of(&self.path, &self.without_plot_options)
    }

    /// Checks that the case of the folder is the one its results were begun with.
    fn check_case(&self) -> Result<(), OutputError> {
        let origin = self.origin()?;
        if origin.is_case {
            return Ok(());
        }
        let cause = match origin.is_version {
            true => "not what the run began with, in more than output.picture and output.contours",
            false => "of a run of another version of this program",
        };
        Err(OutputError {
            path: self.path.join(CASE),
            cause: cause.to_owned(),
            remedy: "take the change back, or run the case again with --force",
        })
    }

    /// Checks that a run may begin: no run is in progress, and without `force` no finished or interrupted run would be
    /// discarded.
    ///
    /// # Errors
    /// A run is in progress, or an existing run would be discarded; the error states the remedy.
    pub fn check_runs(&self) -> Result<(), OutputError> {
        if self.has_living_run()? { Err(self.busy()) } else { self.check_dead_runs() }
    }

    fn check_dead_runs(&self) -> Result<(), OutputError> {
        let refused = |cause: &str, remedy| {
            Err(OutputError { path: self.path.clone(), cause: cause.to_owned(), remedy })
        };
        if self.force {
            Ok(())
        } else if self.path.join(FINISHED).exists() {
            refused("the folder holds this run, finished", "compute it again with --force")
        } else if self.path_of(AppendedFile::Checkpoint).exists() {
            let remedy = "go on with wellposed resume, or begin again with --force";
            refused("the folder holds this run, interrupted", remedy)
        } else {
            Ok(())
        }
    }

    /// Acquires the run lock, held until the returned value is dropped; changes nothing else.
    fn lock_run(&self) -> Result<Lock, OutputError> {
        let _brief = self.lock_briefly()?;
        self.lock_run_within()
    }

    /// Acquires the run lock; the caller holds the short-term lock.
    fn lock_run_within(&self) -> Result<Lock, OutputError> {
        let path = self.path_of(AppendedFile::Lock);
        Lock::try_acquire(&path).map_err(|error| match error {
            LockError::Busy => self.busy(),
            LockError::Refused(error) => not_locked(&path, &error),
        })
    }

    /// Prepares the folder for a run from its beginning: removes files of earlier runs, results of another case if
    /// allowed, and leftovers of killed processes.
    ///
    /// # Errors
    /// The folder may not be used for a run, or a file cannot be written or removed.
    pub fn begin_run(&self) -> Result<RunFolder<'_>, OutputError> {
        let _brief = self.lock_briefly()?;
        let lock = self.lock_run_within()?;
        let is_foreign = self.refuse_foreign()?;
        if !is_foreign {
            self.check_dead_runs()?;
        }
        self.begin_within(is_foreign)?;
        Ok(RunFolder::new(self, lock))
    }

    /// Prepares the folder for the restart of a run that was killed before its first checkpoint.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn begin_again(&self, lock: Lock) -> Result<RunFolder<'_>, OutputError> {
        let _brief = self.lock_briefly()?;
        self.begin_within(false)?;
        Ok(RunFolder::new(self, lock))
    }

    fn begin_within(&self, is_foreign: bool) -> Result<(), OutputError> {
        self.sweep()?;
        match is_foreign {
            true => self.remove_results()?,
            false => self.unlist_run()?,
        }
        self.write_origin()?;
        let names = names_in(&self.path)?;
        let mut own =
            names.iter().filter(|name| is_of_run(name) || *name == AppendedFile::Log.name());
        own.try_for_each(|name| remove(&self.path.join(name)))
    }
}

/// Folder of a run in progress, locked against other runs until dropped.
pub struct RunFolder<'a> {
    folder: &'a ResultFolder,
    lock: Lock,
    /// Checksums of the files written so far.
    list: Checksums,
    /// Staged report, published last: its existence marks the run as finished.
    report: Option<Staged>,
}

impl<'a> RunFolder<'a> {
    fn new(folder: &'a ResultFolder, lock: Lock) -> Self {
        Self { folder, lock, list: Checksums::default(), report: None }
    }

    /// Opens the folder of a run resumed from a checkpoint, with the files written up to it.
    ///
    /// # Errors
    /// Leftovers of killed processes cannot be removed.
    pub fn resumed(folder: &'a ResultFolder, lock: Lock) -> Result<Self, OutputError> {
        let _brief = folder.lock_briefly()?;
        folder.sweep()?;
        Ok(Self::new(folder, lock))
    }

    /// Writes one of the [`results`](super::results) atomically; the report becomes visible when the run [is
    /// finished](Self::finish).
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<Written, OutputError> {
        debug_assert!(is_of_run(name), "{name} is not listed");
        let path = self.folder.path.join(name);
        if name == FINISHED {
            let staged = stage_with(&path, |file| file.write_all(bytes));
            self.report = Some(staged.map_err(|error| not_written(&path, &error))?);
        } else {
            write_file(&path, bytes)?;
        }
        let written = Written::of(bytes);
        self.list.insert(name, written);
        Ok(written)
    }

    /// Adds the checksum of a file that was written elsewhere.
    pub fn insert(&mut self, name: &str, written: Written) {
        self.list.insert(name, written);
    }

    /// Removes one of the [`results`](super::results) if it exists.
    ///
    /// # Errors
    /// The file cannot be removed.
    pub fn remove(&mut self, name: &str) -> Result<(), OutputError> {
        self.list.remove(name);
        remove(&self.folder.path.join(name))
    }

    /// Finishes the run: writes the checksums of all its files, publishes the report and removes the checkpoint.
    ///
    /// # Errors
    /// A file cannot be written or removed.
    pub fn finish(self) -> Result<(), OutputError> {
        let Self { folder, lock, list: own, report } = self;
        let _brief = folder.lock_briefly()?;
        let mut list = folder.checksums_or_none();
        own.iter().for_each(|(name, written)| list.insert(name, written));
        folder.list_as_found(&mut list, &[CASE, PROGRAM])?;
        folder.write_checksums(&list)?;
        if let Some(report) = report {
            let path = folder.path.join(FINISHED);
            report.publish().map_err(|error| not_written(&path, &error))?;
        }
        remove(&folder.path_of(AppendedFile::Checkpoint))?;
        drop(lock.without_trace());
        Ok(())
    }
}
