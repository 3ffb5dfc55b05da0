//! `wellposed verify`: compares result files with their checksums.

use super::folder::{Verification, verify_folder};
use super::{Error, OutputFormat};
use crate::report::SCHEMA_VERSION;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Runs `verify`.
///
/// # Errors
/// Files are damaged, or the folder holds no results.
pub fn verify(path: &Path, format: OutputFormat, stdout: &mut dyn Write) -> Result<(), Error> {
    let Verification { file_count, is_unfinished, damaged_files: damaged } = verify_folder(path)?;
    match format {
        OutputFormat::Json => {
            let all: Vec<_> = damaged
                .iter()
                .map(|own| json!({ "file": own.file, "found": own.description }))
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
                writeln!(stdout, "{}: {}", own.file, own.description)?;
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
        count => Err(Error::Damaged { damaged: count, folder: path.display().to_string() }),
    }
}
