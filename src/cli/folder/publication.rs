//! Joint publication of the files of a verb.

use super::names::{CASE, FINISHED, PROGRAM, is_result};
use super::{AppendedFile, OutputError, ResultFolder, not_written, remove};
use files::{Staged, Written, stage_with};
use std::io::Write as _;

/// Origin of the files to be published.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    /// A verb that computes results of a case.
    Case,
    /// Redrawn pictures of a finished run.
    FinishedRun,
}

/// Files of a verb, complete on disk under temporary names, which are removed on drop.
pub struct Publication<'a> {
    folder: &'a ResultFolder,
    owner: Owner,
    staged: Vec<(String, Staged, Written)>,
    /// Names of files to be removed.
    removed: Vec<String>,
}

impl ResultFolder {
    /// Starts a publication of results of the case.
    pub fn publication(&self) -> Publication<'_> {
        Publication { folder: self, owner: Owner::Case, staged: Vec::new(), removed: Vec::new() }
    }

    /// Starts a publication of redrawn pictures of the finished run in this folder.
    pub fn redrawing(&self) -> Publication<'_> {
        Publication {
            folder: self,
            owner: Owner::FinishedRun,
            staged: Vec::new(),
            removed: Vec::new(),
        }
    }
}

impl Publication<'_> {
    /// Adds one of the [`results`](super::results) under a temporary name.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn put(&mut self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(is_result(name), "{name} is not listed");
        let path = self.folder.path.join(name);
        let staged = stage_with(&path, |file| file.write_all(bytes));
        let staged = staged.map_err(|error| not_written(&path, &error))?;
        self.staged.push((name.to_owned(), staged, Written::of(bytes)));
        Ok(())
    }

    /// Marks one of the [`results`](super::results) for removal if it exists.
    pub fn remove(&mut self, name: &str) {
        self.removed.push(name.to_owned());
    }

    /// Publishes all files with resolved case, program version and checksums, and removes results of another case and
    /// leftovers of killed processes. The files of a run in progress are untouched.
    ///
    /// # Errors
    /// The folder was changed by another process meanwhile, or a file cannot be written.
    pub fn publish(self) -> Result<(), OutputError> {
        let Self { folder, owner, staged, removed } = self;
        let _brief = folder.lock_briefly()?;
        let lives = folder.has_run_lock();
        match owner {
            Owner::Case => {
                if folder.refuse_foreign()? {
                    if lives {
                        return Err(folder.busy());
                    }
                    folder.remove_results()?;
                }
            }
            Owner::FinishedRun if lives || !folder.path.join(FINISHED).exists() => {
                return Err(folder.busy());
            }
            Owner::FinishedRun => {}
        }
        folder.sweep()?;
        if !lives && folder.path.join(FINISHED).exists() {
            // Left by a run killed after its last result was written.
            remove(&folder.path_of(AppendedFile::Checkpoint))?;
            remove(&folder.path_of(AppendedFile::Lock))?;
        }
        let mut list = folder.checksums()?;
        let changed = staged
            .iter()
            .filter(|(name, _, own)| list.get(name).is_some_and(|old| old != *own))
            .map(|(name, ..)| name);
        let gone: Vec<&String> = changed.chain(&removed).collect();
        if !gone.is_empty() {
            gone.into_iter().for_each(|name| list.remove(name));
            folder.write_checksums(&list)?;
        }
        if owner == Owner::Case && !lives {
            folder.write_origin()?;
        }
        removed.iter().try_for_each(|name| remove(&folder.path.join(name)))?;
        for (name, staged, written) in staged {
            let path = folder.path.join(&name);
            staged.publish().map_err(|error| not_written(&path, &error))?;
            list.insert(&name, written);
        }
        match owner {
            Owner::Case => {
                for (name, bytes) in folder.origin_files() {
                    list.insert(name, Written::of(&bytes));
                }
            }
            // The plot options of the case may have been edited.
            Owner::FinishedRun => folder.list_as_found(&mut list, &[CASE, PROGRAM])?,
        }
        folder.write_checksums(&list)
    }
}
