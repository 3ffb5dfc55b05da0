//! `wellposed cases`: lists the cases shipped with the program.

use crate::case::{CASES, Case};
use crate::cli::CommandError;
use std::io::Write;

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
