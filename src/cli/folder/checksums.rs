//! Checksum list of a results folder.

use super::names::is_run_file_name;
use super::{OutputError, ResultFolder, write_file};
use files::checksums::Checksums;
use files::{FileDigest, read_regular_file};
use std::io::ErrorKind;
use std::path::Path;

/// Damage to a result file: it differs from its recorded length and checksum, is missing, cannot be read, or has no
/// checksum.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Damage {
    /// Name of the damaged file in its folder.
    #[serde(rename = "file")]
    pub file_name: String,
    /// Description of the damage.
    #[serde(rename = "found")]
    pub description: String,
}

impl Damage {
    pub(super) fn new(file: &str, description: impl Into<String>) -> Self {
        Self { file_name: file.to_owned(), description: description.into() }
    }

    /// Compares a file of a folder with the recorded length and checksum; `None` if they are equal.
    pub(super) fn detect(folder: &Path, name: &str, written: FileDigest) -> Option<Self> {
        let found = match FileDigest::from_file(&folder.join(name)) {
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

/// Reads the checksum list of a folder; `None` if there is none, an error message if it cannot be read or parsed.
pub(super) fn read_checksums(folder: &Path) -> Result<Option<Checksums>, String> {
    match read_regular_file(&folder.join(Checksums::FILE_NAME)) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(format!("cannot be read: {error}")),
        Ok(bytes) => Checksums::parse(&bytes).map(Some).ok_or_else(|| "is damaged".to_owned()),
    }
}

impl ResultFolder {
    /// Reads the checksum list, empty if there is none. With `--force` a list that is damaged or cannot be read counts
    /// as empty; files listed in it then have no checksum.
    ///
    /// # Errors
    /// The list is damaged or cannot be read, and `--force` was not given.
    pub(super) fn load_checksums(&self) -> Result<Checksums, OutputError> {
        match read_checksums(&self.path) {
            Err(_) if self.can_overwrite => Ok(Checksums::default()),
            Err(cause) => Err(OutputError {
                path: self.path.join(Checksums::FILE_NAME),
                cause,
                remedy: "look with wellposed verify, or overwrite with --force",
            }),
            Ok(list) => Ok(list.unwrap_or_default()),
        }
    }

    /// Reads the checksum list for a run that finishes; empty if it is missing or damaged, so that the run does not
    /// fail.
    pub(super) fn load_checksums_or_empty(&self) -> Checksums {
        read_checksums(&self.path).ok().flatten().unwrap_or_default()
    }

    pub(super) fn write_checksums(&self, list: &Checksums) -> Result<(), OutputError> {
        write_file(&self.path.join(Checksums::FILE_NAME), &list.to_bytes())
    }

    /// Adds the present lengths and checksums of the named files to `list`.
    pub(super) fn add_current_checksums(
        &self,
        list: &mut Checksums,
        names: &[&str],
    ) -> Result<(), OutputError> {
        for name in names {
            let path = self.path.join(name);
            let found = FileDigest::from_file(&path);
            list.insert(name, found.map_err(|error| OutputError::from_read_error(&path, &error))?);
        }
        Ok(())
    }

    /// Removes the entries of run files from the checksum list, before the files are removed.
    pub(super) fn remove_run_checksums(&self) -> Result<(), OutputError> {
        let mut list = self.load_checksums()?;
        let own: Vec<String> = list
            .iter()
            .map(|(name, _)| name.to_owned())
            .filter(|name| is_run_file_name(name))
            .collect();
        if own.is_empty() {
            return Ok(());
        }
        own.iter().for_each(|name| list.remove(name));
        self.write_checksums(&list)
    }

    /// Checks a file against its recorded length and checksum.
    ///
    /// # Errors
    /// The file differs, is missing or cannot be read.
    pub fn check_file(&self, name: &str, written: FileDigest) -> Result<(), OutputError> {
        match Damage::detect(&self.path, name, written) {
            Some(Damage { description, .. }) => {
                Err(OutputError::from_invalid_content(&self.path.join(name), description))
            }
            None => Ok(()),
        }
    }

    /// Checks the files selected by `is_needed` against the checksum list; a file without entry in the list passes, and
    /// if there is no list, all files pass.
    ///
    /// # Errors
    /// The list or one of the files is damaged.
    pub fn check_files(&self, is_needed: impl Fn(&str) -> bool) -> Result<(), OutputError> {
        let list = read_checksums(&self.path).map_err(|cause| {
            OutputError::from_invalid_content(&self.path.join(Checksums::FILE_NAME), cause)
        })?;
        let list = list.unwrap_or_default();
        let mut needed = list.iter().filter(|(name, _)| is_needed(name));
        needed.try_for_each(|(name, written)| self.check_file(name, written))
    }
}
