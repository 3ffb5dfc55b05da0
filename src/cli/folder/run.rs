//! Folders of runs in time, which are locked, resumed and drawn again.

use super::names::{CASE, FINISHED, RUN, is_half_written};
use super::origin::Origin;
use super::{AppendedFile, OutputError, ResultFolder, is_snapshot, names_in, remove};
use crate::case::Case;
use crate::cli::Error;
use std::fs::{self, File};
use std::path::Path;

impl ResultFolder {
    /// The folder of a run that was not finished, and its case.
    ///
    /// # Errors
    /// It holds no run, a finished one, one of another version of the program, or one whose case was
    /// changed since it began.
    pub fn of_run(path: &Path) -> Result<(Self, Case), Error> {
        let refused = |cause: &str, remedy| OutputError {
            path: path.to_owned(),
            cause: cause.to_owned(),
            remedy,
        };
        if !path.join(CASE).is_file() {
            let remedy = "name the folder of results of wellposed run";
            return Err(refused("no run: it holds no case.toml", remedy).into());
        }
        if path.join(FINISHED).exists() {
            return Err(refused("the run is finished", "wellposed plot draws it again").into());
        }
        let (folder, case) = Self::of_own_case(path)?;
        if !folder.origin()?.is_version {
            let remedy = "resume it with that version, or run the case again with --force";
            return Err(refused("a run of another version of this program", remedy).into());
        }
        folder.check_case()?;
        Ok((folder, case))
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
    fn of_own_case(path: &Path) -> Result<(Self, Case), Error> {
        let case = Case::load_in_time(&path.join(CASE), &[])?;
        let (text, undrawn) = (case.to_toml(), case.undrawn().to_toml());
        Ok((Self { path: path.to_owned(), case: text, undrawn, is_foreign: false }, case))
    }

    fn origin(&self) -> Result<Origin, OutputError> {
        Origin::of(&self.path, &self.undrawn)
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

    /// Whether a run may begin here: a finished or an unfinished one is not thrown away unasked.
    ///
    /// # Errors
    /// What stands in the way, and the remedy.
    pub fn check_runs(&self, force: bool) -> Result<(), OutputError> {
        let refused = |cause: &str, remedy| {
            Err(OutputError { path: self.path.clone(), cause: cause.to_owned(), remedy })
        };
        if force {
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

    /// Keeps other runs out of the folder until what is handed back is dropped.
    ///
    /// # Errors
    /// Another run is in progress, or the folder takes no files.
    pub fn lock(&self) -> Result<File, OutputError> {
        fs::create_dir_all(&self.path).map_err(|error| OutputError::new(&self.path, error))?;
        let path = self.path_of(AppendedFile::Lock);
        let file = File::create(&path).map_err(|error| OutputError::new(&path, error))?;
        match file.try_lock() {
            Err(fs::TryLockError::WouldBlock) => Err(OutputError {
                path: self.path.clone(),
                cause: "a run is in progress here".into(),
                remedy: "wait for it, or name another folder with --out",
            }),
            // Where files cannot be locked nothing is guarded.
            Ok(()) | Err(fs::TryLockError::Error(_)) => Ok(file),
        }
    }

    /// Removes what a killed run left half-written.
    ///
    /// # Errors
    /// It cannot be removed.
    pub fn sweep(&self) -> Result<(), OutputError> {
        let mut half_written =
            names_in(&self.path)?.into_iter().filter(|name| is_half_written(name));
        half_written.try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Makes the folder ready for a run from its beginning: as [`open`](Self::open), and without anything
    /// of an earlier run.
    ///
    /// # Errors
    /// What cannot be written or removed, and why.
    pub fn open_run(&self) -> Result<(), OutputError> {
        self.open()?;
        let own = |name: &String| {
            let is_kept = *name == AppendedFile::Lock.name();
            is_snapshot(name)
                || *name == AppendedFile::Log.name()
                || (!is_kept && RUN.iter().any(|own| own == name))
        };
        names_in(&self.path)?
            .iter()
            .filter(|name| own(name))
            .try_for_each(|name| remove(&self.path.join(name)))
    }
}
