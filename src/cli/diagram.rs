//! `wellposed diagram`: computes the uniaxial diagram of a rheological scheme.

use super::load::print_hints;
use super::write::{CostEstimate, list_planned_paths, print_plan, write_report};
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
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
    let found = study::compute_diagram(&case)?;
    let folder = ResultFolder::from_case(&case, options.output_folder.as_deref(), options.force)?;
    if options.is_dry_run {
        let plan = format!("follow the load path in {} steps", found.steps);
        let paths = list_planned_paths(&folder, &folder::DIAGRAM_FILES);
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options.format, stdout)
}
