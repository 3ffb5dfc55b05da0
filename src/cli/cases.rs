//! `wellposed cases`: lists, prints and copies the cases shipped with the program.

use super::folder::{OutputError, create_folder, write_file};
use super::new::{SCHEMA_FILE, check_new_file, format_schema, is_same_file};
use crate::case::{CASES, Case, find_bundled_case, suggest_case};
use crate::cli::CommandError;
use std::io::Write;
use std::path::Path;

/// Prints one line per case: path and title.
///
/// # Errors
/// Standard output cannot be written.
pub fn list_cases(stdout: &mut dyn Write) -> Result<(), CommandError> {
    let width = CASES.iter().map(|(path, _)| path.len()).max().unwrap_or(0);
    for (path, text) in CASES {
        writeln!(stdout, "{path:width$}  {}", Case::parse(text, path, &[])?.title)?;
    }
    Ok(())
}

/// Prints the text of a case. Its first line names the schema in the folder of the case, not above it.
///
/// # Errors
/// No case has this name, or standard output cannot be written.
pub fn show_case(name: &str, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let (_, text) = find_bundled_case(name).ok_or_else(|| CommandError::NoBundledCase {
        name: name.to_owned(),
        suggestion: suggest_case(Path::new(name)),
    })?;
    let text = text.replacen("#:schema ../", "#:schema ./", 1);
    Ok(stdout.write_all(text.as_bytes())?)
}

/// Replaces the remedy of an error of writing by the option of this verb.
fn name_copy_option(error: OutputError) -> OutputError {
    OutputError { remedy: "name a folder that can be written to with --copy DIR", ..error }
}

/// Copies all cases to a folder, in subfolders as in the list, with their schema for editors, and prints the number of
/// cases.
///
/// # Errors
/// A file exists with another text and `force` is not set, or a file cannot be written.
pub fn copy_cases(folder: &Path, force: bool, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let schema = format_schema();
    let files = || {
        let cases = CASES.iter().map(|(path, text)| {
            (folder.join(path.strip_prefix("cases/").unwrap_or(path)), text.as_bytes())
        });
        cases.chain([(folder.join(SCHEMA_FILE), schema.as_bytes())])
    };
    // No file is written if one of them must not be.
    let mut changed = files().filter(|(path, text)| !is_same_file(path, text));
    changed.try_for_each(|(path, _)| check_new_file(&path, force))?;
    create_folder(folder).map_err(name_copy_option)?;
    for (path, text) in files().filter(|(path, text)| !is_same_file(path, text)) {
        if let Some(parent) = path.parent() {
            create_folder(parent).map_err(name_copy_option)?;
        }
        write_file(&path, text).map_err(name_copy_option)?;
    }
    writeln!(stdout, "{} cases in {}", CASES.len(), folder.display())?;
    Ok(())
}
