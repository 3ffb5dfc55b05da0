//! `wellposed dispersion`: computes the dispersion relation of a solid.

use super::progress::watched;
use super::write::{would_write, write};
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Options};
use crate::report::format::short;
use crate::study;
use std::io::Write;

/// Runs `dispersion`.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn dispersion(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let pool = pool(options.threads)?;
    let found = watched(&pool, "dispersion", |on_progress| study::dispersion(&case, on_progress))?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if options.dry_run {
        let greatest = short(found.greatest_number);
        writeln!(stdout, "would follow the waves up to k = {greatest} 1/m")?;
        return would_write(&folder, &folder::DISPERSION, stdout);
    }
    write(&found, &case, &folder, options.format, stdout)
}
