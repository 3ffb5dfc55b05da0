//! Verification of the files of a results folder against their checksums.

use super::checksums::{Damage, read_checksums};
use super::names::{
    CASE_FILE, FINISHED_RUN_FILE, PROGRAM_FILE, REPORT_PAGE_FILE, has_checksum, is_run_file_name,
};
use super::{AppendedFile, OutputError, ResultFolder, describe_missing_folder, list_file_names};
use crate::cli::CommandError;
use crate::cli::run::Checkpoint;
use files::FileDigest;
use files::checksums::Checksums;
use serde::Serialize;
use std::path::Path;

/// Result of the verification of a folder.
#[derive(Clone, Debug, Serialize)]
pub struct VerificationResult {
    /// Number of files checked.
    #[serde(rename = "files")]
    pub file_count: usize,
    /// Whether the folder holds an unfinished run, which is checked up to its last checkpoint.
    pub is_unfinished: bool,
    /// Files that are damaged, missing or without checksum, sorted by name.
    #[serde(rename = "damaged")]
    pub damaged_files: Vec<Damage>,
}

/// Compares all result files of a folder, except the log, with their checksums, and files of an unfinished run with the
/// last checkpoint of that run. Files of other programs are ignored.
///
/// # Errors
/// The folder holds no results or cannot be read.
pub fn verify_folder(path: &Path) -> Result<VerificationResult, CommandError> {
    let names = list_file_names(path)?;
    let holds = |name: &str| names.iter().any(|own| own == name);
    let is_result_file_name = |name: &String| {
        (has_checksum(name) && name != CASE_FILE)
            || is_run_file_name(name)
            || name == Checksums::FILE_NAME
    };
    if !names.iter().any(is_result_file_name) {
        return Err(OutputError {
            path: path.to_owned(),
            cause: describe_missing_folder(path).unwrap_or("holds no results").into(),
            remedy: "name a folder with the results of a command, such as out/<name of the case>",
        }
        .into());
    }
    let has_begun = holds(AppendedFile::Checkpoint.name()) || holds(AppendedFile::Lock.name());
    let list = read_checksums(path);
    let is_listed_finished =
        matches!(&list, Ok(Some(own)) if own.digest(FINISHED_RUN_FILE).is_some());
    let has_files = names.iter().any(|name| is_run_file_name(name)) && !is_listed_finished;
    let is_unfinished = !holds(FINISHED_RUN_FILE) && (has_begun || has_files);
    let mut all = Vec::new();
    let mut file_count = 0;
    let mut check = |name: &str, written: FileDigest| {
        file_count += 1;
        all.extend(Damage::detect(path, name, written));
    };
    if let Ok(Some(list)) = &list {
        // A finishing run writes its checksums just before it publishes its report. If it was killed between the two,
        // it counts as unfinished, and its files are compared with the checkpoint.
        let own = list.iter().filter(|(name, _)| !(is_unfinished && is_run_file_name(name)));
        own.for_each(|(name, written)| check(name, written));
    }
    let is_due = |name: &str| has_checksum(name) && !(is_unfinished && has_deferred_checksum(name));
    match list {
        Err(found) => all.push(Damage::new(Checksums::FILE_NAME, found)),
        Ok(None) if names.iter().any(|name| is_due(name)) => {
            all.push(Damage::new(Checksums::FILE_NAME, "is missing"));
        }
        Ok(None) => {}
        Ok(Some(list)) => {
            let others = names.iter().filter(|name| is_due(name) && list.digest(name).is_none());
            all.extend(others.map(|name| Damage::new(name, "has no checksum")));
        }
    }
    file_count += usize::from(holds(Checksums::FILE_NAME));
    if is_unfinished {
        file_count += check_unfinished_run(path, &mut all)?;
    }
    all.sort_by(|one, other| one.file_name.cmp(&other.file_name));
    Ok(VerificationResult { file_count, is_unfinished, damaged_files: all })
}

/// Returns whether a file gets its checksum entry only when its run finishes.
fn has_deferred_checksum(name: &str) -> bool {
    is_run_file_name(name) || [CASE_FILE, PROGRAM_FILE, REPORT_PAGE_FILE].contains(&name)
}

/// Compares the files of an unfinished run with its last checkpoint; returns the number of files checked.
fn check_unfinished_run(path: &Path, all: &mut Vec<Damage>) -> Result<usize, CommandError> {
    let (folder, case) = match ResultFolder::from_stored_case(path) {
        Ok(found) => found,
        Err(error) => {
            all.push(Damage::new(CASE_FILE, error.to_string()));
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
    let tables = checkpoint.list_table_files(&case)?;
    for (file, written) in &tables {
        match FileDigest::from_prefix(&folder.file_path(*file), written.length) {
            Ok(found) if found == *written => {}
            Ok(_) => all.push(Damage::new(file.name(), "has lost or changed rows")),
            Err(error) => all.push(Damage::new(file.name(), format!("cannot be read: {error}"))),
        }
    }
    let files = checkpoint.snapshots.iter().flat_map(|own| &own.files);
    for (name, written) in files.clone() {
        all.extend(Damage::detect(path, name, *written));
    }
    Ok(2 + tables.len() + files.count())
}
