//! Folders of runs in time, which are locked, resumed and drawn again.

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

/// A run that was not finished, and whose folder nobody else writes to as a run.
pub struct Begun {
    /// The folder of its results.
    pub folder: ResultFolder,
    /// Its case.
    pub case: Case,
    /// What keeps other runs out.
    pub lock: Lock,
}

impl ResultFolder {
    /// The folder of a run that was not finished, and its case.
    ///
    /// # Errors
    /// It holds no run, a finished one, one in progress, one of another version of the program, or one whose case was
    /// changed since it began.
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
        // A folder without anything but its place, to be locked before anything is believed of it.
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

    /// The folder of a finished run, to be drawn again, and its case.
    ///
    /// # Errors
    /// It holds no finished run, or one whose case was changed since in more than what is drawn.
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

    /// The folder of the case that it holds.
    pub(super) fn of_own_case(path: &Path) -> Result<(Self, Case), Error> {
        let case = Case::load_in_time(&path.join(CASE), &[])?;
        let (text, without_plot_options) = (case.to_toml(), case.without_plot_options().to_toml());
        Ok((Self { path: path.to_owned(), case: text, without_plot_options, force: false }, case))
    }

    fn origin(&self) -> Result<Origin, OutputError> {
        Origin::of(&self.path, &self.without_plot_options)
    }

    /// That the case of the folder is the one that its results began with.
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

    /// Whether a run may begin here: none is in progress, and a finished or an unfinished one is not thrown away unasked.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
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

    /// Keeps other runs out of the folder until what is handed back is dropped; changes nothing.
    fn lock_run(&self) -> Result<Lock, OutputError> {
        let _brief = self.lock_briefly()?;
        self.lock_run_within()
    }

    /// The same for who holds the other lock.
    fn lock_run_within(&self) -> Result<Lock, OutputError> {
        let path = self.path_of(AppendedFile::Lock);
        Lock::try_acquire(&path).map_err(|error| match error {
            LockError::Busy => self.busy(),
            LockError::Refused(error) => not_locked(&path, &error),
        })
    }

    /// Makes the folder ready for a run from its beginning: without anything of an earlier run, of another case, or
    /// that a killed process left half-written.
    ///
    /// # Errors
    /// Something stands in the way; what cannot be written or removed, and why.
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

    /// The same for a run that was killed before its first checkpoint.
    ///
    /// # Errors
    /// What cannot be written or removed, and why.
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

/// The folder of a run in progress. Until it is dropped no other run writes here.
pub struct RunFolder<'a> {
    folder: &'a ResultFolder,
    lock: Lock,
    /// Files written so far.
    list: Checksums,
    /// The report, which has its name last: the run is finished where it stands.
    report: Option<Staged>,
}

impl<'a> RunFolder<'a> {
    fn new(folder: &'a ResultFolder, lock: Lock) -> Self {
        Self { folder, lock, list: Checksums::default(), report: None }
    }

    /// That of a run that goes on from a checkpoint, with all of its files up to there.
    ///
    /// # Errors
    /// What killed processes left cannot be removed.
    pub fn resumed(folder: &'a ResultFolder, lock: Lock) -> Result<Self, OutputError> {
        let _brief = folder.lock_briefly()?;
        folder.sweep()?;
        Ok(Self::new(folder, lock))
    }

    /// Writes one of the [`results`](super::results), whole or not at all; that of the report of the run is seen when the run
    /// [is finished](Self::finish).
    ///
    /// # Errors
    /// The file, and why it cannot be written.
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

    /// Adds a file that was written elsewhere.
    pub fn insert(&mut self, name: &str, written: Written) {
        self.list.insert(name, written);
    }

    /// Removes one of the [`results`](super::results), if it is there.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn remove(&mut self, name: &str) -> Result<(), OutputError> {
        self.list.remove(name);
        remove(&self.folder.path.join(name))
    }

    /// The run is finished: lists all of its files with their checksums, gives the report its name and removes the
    /// checkpoint.
    ///
    /// # Errors
    /// What cannot be written or removed, and why.
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
