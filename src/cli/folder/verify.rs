//! Verification of the files of a results folder against their checksums.

use super::checksums::{Damage, read};
use super::names::{CASE, FINISHED, PROGRAM, is_listed, is_of_run};
use super::{AppendedFile, OutputError, ResultFolder, names_in};
use crate::cli::Error;
use crate::cli::run::Checkpoint;
use files::Written;
use files::checksums::Checksums;
use serde::Serialize;
use std::path::Path;

/// Result of the verification of a folder.
#[derive(Clone, Debug, Serialize)]
pub struct Verification {
    /// Number of files checked.
    pub files: usize,
    /// Whether the folder holds an unfinished run, which is checked up to its last checkpoint.
    pub is_unfinished: bool,
    /// Damaged files, sorted by name.
    pub damaged: Vec<Damage>,
}

/// Compares all result files of a folder except the log with their checksums, and files of an unfinished run with its
/// last checkpoint. Files of other programs are ignored.
///
/// # Errors
/// The folder holds no results.
pub fn verify(path: &Path) -> Result<Verification, Error> {
    let names = names_in(path)?;
    let holds = |name: &str| names.iter().any(|own| own == name);
    let is_result = |name: &String| {
        (is_listed(name) && name != CASE) || is_of_run(name) || name == Checksums::NAME
    };
    if !names.iter().any(is_result) {
        return Err(OutputError {
            path: path.to_owned(),
            cause: "holds no results".into(),
            remedy: "name the folder of results of a verb",
        }
        .into());
    }
    let has_begun = holds(AppendedFile::Checkpoint.name()) || holds(AppendedFile::Lock.name());
    let list = read(path);
    let is_listed_finished = matches!(&list, Ok(Some(own)) if own.get(FINISHED).is_some());
    let has_files = names.iter().any(|name| is_of_run(name)) && !is_listed_finished;
    let is_unfinished = !holds(FINISHED) && (has_begun || has_files);
    let mut all = Vec::new();
    let mut files = 0;
    let mut check = |name: &str, written: Written| {
        files += 1;
        all.extend(Damage::of(path, name, written));
    };
    if let Ok(Some(list)) = &list {
        // When a run finishes, its checksums are written just before its report is published.
        let own = list.iter().filter(|(name, _)| !(is_unfinished && is_of_run(name)));
        own.for_each(|(name, written)| check(name, written));
    }
    let is_due = |name: &str| is_listed(name) && !(is_unfinished && is_without_line(name));
    match list {
        Err(found) => all.push(Damage::new(Checksums::NAME, found)),
        Ok(None) if names.iter().any(|name| is_due(name)) => {
            all.push(Damage::new(Checksums::NAME, "is missing"));
        }
        Ok(None) => {}
        Ok(Some(list)) => {
            let others = names.iter().filter(|name| is_due(name) && list.get(name).is_none());
            all.extend(others.map(|name| Damage::new(name, "has no checksum")));
        }
    }
    files += usize::from(holds(Checksums::NAME));
    if is_unfinished {
        files += check_unfinished(path, &mut all)?;
    }
    all.sort_by(|one, other| one.file.cmp(&other.file));
    Ok(Verification { files, is_unfinished, damaged: all })
}

/// Returns whether a file has no checksum entry while its run is unfinished.
fn is_without_line(name: &str) -> bool {
    is_of_run(name) || [CASE, PROGRAM].contains(&name)
}

/// Compares the files of an unfinished run with its last checkpoint; returns the number of files checked.
fn check_unfinished(path: &Path, all: &mut Vec<Damage>) -> Result<usize, Error> {
    let (folder, case) = match ResultFolder::of_own_case(path) {
        Ok(found) => found,
        Err(error) => {
            all.push(Damage::new(CASE, error.to_string()));
            return Ok(1);
        }
    };
    let name = AppendedFile::Checkpoint.name();
    let checkpoint = match Checkpoint::read(&folder) {
        Ok(Some(checkpoint)) => checkpoint,
        Ok(None) => return Ok(1),
        Err(error) => {
            all.push(Damage::new(name, error.cause));
            return Ok(2);
        }
    };
    let tables = checkpoint.tables_of(&case)?;
    for (file, written) in &tables {
        match Written::of_start(&folder.path_of(*file), written.length) {
            Ok(found) if found == *written => {}
            Ok(_) => all.push(Damage::new(file.name(), "has lost or changed rows")),
            Err(error) => all.push(Damage::new(file.name(), format!("cannot be read: {error}"))),
        }
    }
    for (index, written) in checkpoint.snapshots.iter().enumerate() {
        all.extend(Damage::of(path, &super::snapshot_name(&case, index), *written));
    }
    Ok(2 + tables.len() + checkpoint.snapshots.len())
}
