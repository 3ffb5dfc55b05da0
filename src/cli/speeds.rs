//! `wellposed speeds`: computes the characteristic speeds of a solid by direction.

use super::load::load_case;
use super::progress::{estimate_time, run_with_progress};
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::cli::folder;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::{setup, study};
use analysis::solids::DirectionalSpeeds;
use std::io::Write;

/// Runs the verb `speeds`: computes the characteristic speeds of a solid and writes the report.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_speeds(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = load_case(options)?;
    case.check_without_contacts()?;
    let solid =
        setup::solid::create_solid(&case.material).map_err(|error| case.locate_error(error))?;
    let folder = select_folder(&case, options)?;
    let pool = create_thread_pool(options.thread_count)?;
    if options.is_dry_run {
        let seconds =
            estimate_time(&pool, |on_progress| study::compute_speeds(&case, on_progress))?;
        let estimate = CostEstimate::from_seconds(seconds);
        let plan = format!("find speeds in {} directions", DirectionalSpeeds::DIRECTIONS);
        let in_plane = folder::SPEEDS_FILES.iter().filter(|name| !name.starts_with("sphere"));
        let names: Vec<&str> = match solid.dimensions {
            3 => folder::SPEEDS_FILES.to_vec(),
            _ => in_plane.copied().collect(),
        };
        let paths = list_planned_paths(&folder, &names, &options.pictures);
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    let found = run_with_progress(&pool, "speeds", |on_progress| {
        study::compute_speeds(&case, on_progress)
    })?;
    write_report(&found, &case, &folder, options, stdout)
}
