//! Files of a verb that take their names together.

use super::names::{CASE, FINISHED, PROGRAM, is_result};
use super::{AppendedFile, OutputError, ResultFolder, not_written, remove};
use files::{Staged, Written, stage_with};
use std::io::Write as _;

/// Whose files they are.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Owner {
    /// A verb that computes results of a case.
    Case,
    /// Pictures of a finished run, which are drawn again.
    FinishedRun,
}

/// Files of a verb, complete on the device under temporary names. Dropped, they are gone.
pub struct Publication<'a> {
    folder: &'a ResultFolder,
    owner: Owner,
    staged: Vec<(String, Staged, Written)>,
    /// Names of files that are to go.
    removed: Vec<String>,
}

impl ResultFolder {
    /// Collects results of the case.
    pub fn publication(&self) -> Publication<'_> {
        Publication { folder: self, owner: Owner::Case, staged: Vec::new(), removed: Vec::new() }
    }

    /// Collects pictures of the finished run that stands here.
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
    /// Adds one of the [`results`](super::results).
    ///
    /// # Errors
    /// The file, and why it cannot be written.
    pub fn put(&mut self, name: &str, bytes: &[u8]) -> Result<(), OutputError> {
        debug_assert!(is_result(name), "{name} is not listed");
        let path = self.folder.path.join(name);
        let staged = stage_with(&path, |file| file.write_all(bytes));
        let staged = staged.map_err(|error| not_written(&path, &error))?;
        self.staged.push((name.to_owned(), staged, Written::of(bytes)));
        Ok(())
    }

    /// Removes one of the [`results`](super::results), if it is there.
    pub fn remove(&mut self, name: &str) {
        self.removed.push(name.to_owned());
    }

    /// Puts all files in place: with the resolved case, the program's version and the checksums, without results of
    /// another case and what killed processes left. A run in progress keeps what it has.
    ///
    /// # Errors
    /// Meanwhile something stands in the way; what cannot be written, and why.
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
            // Left by a run that was killed after its last result.
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
            // What is drawn may have been changed by hand.
            Owner::FinishedRun => folder.list_as_found(&mut list, &[CASE, PROGRAM])?,
        }
        folder.write_checksums(&list)
    }
}
