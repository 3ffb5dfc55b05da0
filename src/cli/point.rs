//! `wellposed point`: analyses the state that a case describes.

use super::load::load_case;
use super::progress::run_with_progress;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::cli::folder;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::report::format::case_title;
use crate::{report, study};
use std::io::Write;
use std::time::Instant;

/// Runs the verb `point`: analyses the state of a case and writes the report.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_point(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = load_case(options)?;
    case.check_without_contacts()?;
    let folder = select_folder(&case, options)?;
    let pool = create_thread_pool(options.thread_count)?;
    let start = Instant::now();
    let found =
        run_with_progress(&pool, "point", |on_progress| study::analyse_point(&case, on_progress))?;
    if options.is_dry_run {
        let plan = format!("analyse {}", case_title(&case));
        let written = report::file_names(&found, &case, &options.pictures)?;
        let is_written = |name: &&str| written.iter().any(|own| own == name);
        let names: Vec<&str> = folder::POINT_FILES.into_iter().filter(is_written).collect();
        let paths = list_planned_paths(&folder, &names, &options.pictures);
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options, stdout)
}
