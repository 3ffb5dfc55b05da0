//! `wellposed dispersion`: computes the dispersion relation of a solid.

use super::load::load_case;
use super::progress::run_with_progress;
use super::write::{planned_paths, print_plan, write_report};
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{Error, Options};
use crate::report::format::format_short;
use crate::study;
use std::io::Write;

/// Runs `dispersion`.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_dispersion(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = load_case(options)?;
    let pool = create_thread_pool(options.threads)?;
    let found = run_with_progress(&pool, "dispersion", |on_progress| {
        study::compute_dispersion(&case, on_progress)
    })?;
    let folder = ResultFolder::from_case(&case, options.output_folder.as_deref(), options.force)?;
    if options.is_dry_run {
        let greatest = format_short(found.max_wave_number);
        let plan = format!("follow the waves up to k = {greatest} 1/m");
        let paths = planned_paths(&folder, &folder::DISPERSION_FILES);
        return print_plan(&plan, &paths, options.format, stdout);
    }
    write_report(&found, &case, &folder, options.format, stdout)
}
