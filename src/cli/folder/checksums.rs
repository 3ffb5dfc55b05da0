//! The list of checksums of a folder.

use super::names::is_of_run;
use super::{OutputError, ResultFolder, write_file};
use files::checksums::Checksums;
use files::{Written, read_regular};
use std::io::ErrorKind;
use std::path::Path;

/// What is wrong with a file of results.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Damage {
    /// The name of the file.
    pub file: String,
    /// What was found.
    pub found: String,
}

impl Damage {
    pub(super) fn new(file: &str, found: impl Into<String>) -> Self {
        Self { file: file.to_owned(), found: found.into() }
    }

    /// Compares a file of a folder with what was written; `None` where it is the same.
    pub(super) fn of(folder: &Path, name: &str, written: Written) -> Option<Self> {
        let found = match Written::of_file(&folder.join(name)) {
            Ok(found) if found == written => return None,
            Ok(found) if found.length != written.length => {
                format!("has {} bytes, where {} were written", found.length, written.length)
            }
            Ok(_) => "has other content than was written".to_owned(),
            Err(error) if error.kind() == ErrorKind::NotFound => "is missing".to_owned(),
            Err(error) => format!("cannot be read: {error}"),
        };
        Some(Self::new(name, found))
    }
}

/// The list of a folder: `None` where there is none, an error in words where it cannot be used.
pub(super) fn read(folder: &Path) -> Result<Option<Checksums>, String> {
    match read_regular(&folder.join(Checksums::NAME)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("cannot be read: {error}")),
        Ok(bytes) => Checksums::parse(&bytes).map(Some).ok_or_else(|| "is damaged".to_owned()),
    }
}

impl ResultFolder {
    /// The list as far as there is one. With `--force` a damaged one counts as none: what it had lines of stays without.
    ///
    /// # Errors
    /// It is damaged.
    pub(super) fn checksums(&self) -> Result<Checksums, OutputError> {
        match read(&self.path) {
            Err(_) if self.force => Ok(Checksums::default()),
            Err(cause) => Err(OutputError {
                path: self.path.join(Checksums::NAME),
                cause,
                remedy: "look with wellposed verify, or overwrite with --force",
            }),
            Ok(list) => Ok(list.unwrap_or_default()),
        }
    }

    /// The same for a run that comes to its end: it does not fail for the damage of others.
    pub(super) fn checksums_or_none(&self) -> Checksums {
        read(&self.path).ok().flatten().unwrap_or_default()
    }

    pub(super) fn write_checksums(&self, list: &Checksums) -> Result<(), OutputError> {
        write_file(&self.path.join(Checksums::NAME), &list.to_bytes())
    }

    /// Gives files lines for what they hold now.
    pub(super) fn list_as_found(
        &self,
        list: &mut Checksums,
        names: &[&str],
    ) -> Result<(), OutputError> {
        for name in names {
            let path = self.path.join(name);
            let found = Written::of_file(&path);
            list.insert(name, found.map_err(|error| OutputError::unreadable(&path, &error))?);
        }
        Ok(())
    }

    /// Takes away the lines of a run, whose files are to go.
    pub(super) fn unlist_run(&self) -> Result<(), OutputError> {
        let mut list = self.checksums()?;
        let own: Vec<String> =
            list.iter().map(|(name, _)| name.to_owned()).filter(|name| is_of_run(name)).collect();
        if own.is_empty() {
            return Ok(());
        }
        own.iter().for_each(|name| list.remove(name));
        self.write_checksums(&list)
    }

    /// That a file is as it was written.
    ///
    /// # Errors
    /// It is not.
    pub fn check_file(&self, name: &str, written: Written) -> Result<(), OutputError> {
        match Damage::of(&self.path, name, written) {
            Some(Damage { found, .. }) => Err(OutputError::unusable(&self.path.join(name), found)),
            None => Ok(()),
        }
    }

    /// That files are as they were written, as far as there is a list of checksums.
    ///
    /// # Errors
    /// The list or one of them is damaged.
    pub fn check_files(&self, is_needed: impl Fn(&str) -> bool) -> Result<(), OutputError> {
        let list = read(&self.path)
            .map_err(|cause| OutputError::unusable(&self.path.join(Checksums::NAME), cause))?;
        let list = list.unwrap_or_default();
        let mut needed = list.iter().filter(|(name, _)| is_needed(name));
        needed.try_for_each(|(name, written)| self.check_file(name, written))
    }
}
