//! `wellposed verify`: compares result files with their checksums.

use super::folder::{VerificationResult, verify_folder};
use super::{CommandError, OutputFormat};
use crate::report::SCHEMA_VERSION;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Runs the verb `verify`: compares the files of a results folder with their checksums and prints the result.
///
/// # Errors
/// Files are damaged, or the folder holds no results.
pub fn verify(
    path: &Path,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let VerificationResult { file_count, is_unfinished, damaged_files: damaged } =
        verify_folder(path)?;
    match format {
        OutputFormat::Json => {
            let all: Vec<_> = damaged
                .iter()
                .map(|own| json!({ "file": own.file_name, "found": own.description }))
                .collect();
            let report = json!({
                "schema": SCHEMA_VERSION,
                "sound": damaged.is_empty(),
                "unfinished": is_unfinished,
                "files": file_count,
                "damaged": all,
            });
            writeln!(stdout, "{report:#}")?;
        }
        OutputFormat::Text => {
            for own in &damaged {
                writeln!(stdout, "{}: {}", own.file_name, own.description)?;
            }
            if damaged.is_empty() {
                let run = match is_unfinished {
                    true => "; the run is not finished: sound up to its last checkpoint",
                    false => "",
                };
                writeln!(stdout, "{file_count} files are as they were written{run}")?;
            }
        }
    }
    match damaged.len() {
        0 => Ok(()),
        count => Err(CommandError::DamagedFiles {
            damaged_count: count,
            folder: path.display().to_string(),
        }),
    }
}
