//! `wellposed verify`: compares result files with their checksums.

use super::folder::{Verification, verify as look};
use super::{Error, Format};
use crate::report::SCHEMA;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Runs `verify`.
///
/// # Errors
/// Files are damaged, or the folder holds no results.
pub fn verify(path: &Path, format: Format, stdout: &mut dyn Write) -> Result<(), Error> {
    let Verification { files, is_unfinished, damaged } = look(path)?;
    match format {
        Format::Json => {
            let all: Vec<_> =
                damaged.iter().map(|own| json!({ "file": own.file, "found": own.found })).collect();
            let report = json!({
                "schema": SCHEMA,
                "sound": damaged.is_empty(),
                "unfinished": is_unfinished,
                "files": files,
                "damaged": all,
            });
            writeln!(stdout, "{report:#}")?;
        }
        Format::Text => {
            for own in &damaged {
                writeln!(stdout, "{}: {}", own.file, own.found)?;
            }
            if damaged.is_empty() {
                let run = match is_unfinished {
                    true => "; the run is not finished: sound up to its last checkpoint",
                    false => "",
                };
                writeln!(stdout, "{files} files are as they were written{run}")?;
            }
        }
    }
    match damaged.len() {
        0 => Ok(()),
        count => Err(Error::Damaged { damaged: count, folder: path.display().to_string() }),
    }
}
