//! `wellposed point`: analyses one state.

use super::progress::watched;
use super::write::{would_write, write};
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Options};
use crate::report::format::case_title;
use crate::{report, study};
use std::io::Write;

/// Runs `point`.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn point(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let pool = pool(options.threads)?;
    let found = watched(&pool, "point", |on_progress| study::point(&case, on_progress))?;
    if options.dry_run {
        writeln!(stdout, "would analyse {}", case_title(&case))?;
        let written = report::file_names(&found, &case)?;
        let is_written = |name: &&str| written.iter().any(|own| own == name);
        let names: Vec<&str> = folder::POINT.into_iter().filter(is_written).collect();
        return would_write(&folder, &names, stdout);
    }
    write(&found, &case, &folder, options.format, stdout)
}
