//! `wellposed speeds`: computes the characteristic speeds of a solid by direction.

use super::progress::watched;
use super::write::{would_write, write};
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Options};
use crate::{setup, study};
use analysis::solids::DirectionalSpeeds;
use std::io::Write;

/// Runs `speeds`.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn speeds(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let solid = setup::solid::solid(&case.material).map_err(|error| case.locate(error))?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if options.dry_run {
        writeln!(stdout, "would find speeds in {} directions", DirectionalSpeeds::DIRECTIONS)?;
        let in_plane = folder::SPEEDS.iter().filter(|name| !name.starts_with("sphere"));
        let names: Vec<&str> = match solid.dimensions {
            3 => folder::SPEEDS.to_vec(),
            _ => in_plane.copied().collect(),
        };
        return would_write(&folder, &names, stdout);
    }
    let pool = pool(options.threads)?;
    let found = watched(&pool, "speeds", |on_progress| study::speeds(&case, on_progress))?;
    write(&found, &case, &folder, options.format, stdout)
}
