//! `wellposed point`: analyses one state.

use super::load::load_case;
use super::progress::run_with_progress;
use super::write::{planned_paths, print_plan, write_report};
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{Error, Options};
use crate::report::format::case_title;
use crate::{report, study};
use std::io::Write;

/// Runs `point`.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_point(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = load_case(options)?;
    let folder = ResultFolder::from_case(&case, options.output_folder.as_deref(), options.force)?;
    let pool = create_thread_pool(options.threads)?;
    let found =
        run_with_progress(&pool, "point", |on_progress| study::analyse_point(&case, on_progress))?;
    if options.is_dry_run {
        let plan = format!("analyse {}", case_title(&case));
        let written = report::file_names(&found, &case)?;
        let is_written = |name: &&str| written.iter().any(|own| own == name);
        let names: Vec<&str> = folder::POINT_FILES.into_iter().filter(is_written).collect();
        let paths = planned_paths(&folder, &names);
        return print_plan(&plan, &paths, options.format, stdout);
    }
    write_report(&found, &case, &folder, options.format, stdout)
}
