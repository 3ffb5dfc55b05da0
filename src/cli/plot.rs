//! `wellposed plot`: the pictures of a finished run again, from files of results alone.

use super::run::{animation, records};
use super::write::files_into;
use crate::cli::Error;
use crate::cli::folder::{OutputError, ResultFolder};
use crate::report;
use std::io::Write;
use std::path::Path;

/// Runs the verb.
///
/// # Errors
/// The folder holds no finished run, or a file of it cannot be read or written.
pub fn plot(path: &Path, stdout: &mut dyn Write) -> Result<(), Error> {
    let (folder, case) = ResultFolder::finished(path)?;
    let archive = folder.path().join("fields.npz");
    let bytes =
        std::fs::read(&archive).map_err(|error| OutputError::unreadable(&archive, &error))?;
    let fields =
        report::run::read_fields(&bytes).map_err(|error| OutputError::unusable(&archive, error))?;
    let pictures = report::run::pictures(&case, &fields, &records(&case, &folder)?)?;
    report::draw(&pictures, files_into(&folder))?;
    animation(&case, &folder)?;
    writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
    Ok(())
}
