//! `wellposed map`: computes the verdict over two parameters of a case.

use super::progress::watched;
use super::write::{would_write, write};
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Options};
use crate::study;
use crate::study::MapOptions;
use std::io::Write;

/// Runs `map`.
///
/// # Errors
/// The case is invalid at all points of the map, or results cannot be written.
pub fn map(options: &Options, asked: MapOptions, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let map = *case.required_map()?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    let states = map.x.points * map.y.points;
    if options.dry_run {
        let pool = pool(options.threads)?;
        watched(&pool, "checking states", |on_progress| study::check_map(&case, on_progress))?;
        writeln!(stdout, "would judge {states} states: {} × {}", map.x, map.y)?;
        return would_write(&folder, &folder::MAP, stdout);
    }
    let pool = pool(options.threads)?;
    let found =
        watched(&pool, "judging states", |on_progress| study::map(&case, asked, on_progress))?;
    write(&found, &case, &folder, options.format, stdout)
}
