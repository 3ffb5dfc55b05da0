//! `wellposed diagram`: computes the uniaxial diagram of a rheological scheme.

use super::load::print_hints;
use super::progress::run_with_progress;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::Case;
use crate::cli::folder;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::study;
use std::io::Write;
use std::time::Instant;

/// Runs the verb `diagram`: computes the response of the rheological scheme of a case to its load path and writes the
/// report.
///
/// # Errors
/// The case is invalid or has no rheological scheme, the scheme cannot follow the path, or results cannot be written.
pub fn run_diagram(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = Case::load(&options.case_path, &options.settings)?;
    print_hints(&case);
    let start = Instant::now();
    let pool = create_thread_pool(options.thread_count)?;
    let found = run_with_progress(&pool, "diagram", |_| study::compute_diagram(&case))?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let plan = format!("follow the load path in {} steps", found.steps);
        let paths = list_planned_paths(&folder, &folder::DIAGRAM_FILES, &options.pictures);
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options, stdout)
}
