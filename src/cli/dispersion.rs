//! `wellposed dispersion`: computes the dispersion relation of a solid, or the Bloch waves of a blocky medium.

use super::load::load_case;
use super::progress::{estimate_time, run_with_progress};
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::Case;
use crate::cli::folder;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::report::format::format_short;
use crate::{setup, study};
use std::io::Write;
use std::time::Instant;

/// Runs the verb `dispersion`: computes the dispersion relation of the case and writes its report.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_dispersion(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = load_case(options)?;
    if case.has_joints() {
        return run_bloch(&case, options, stdout);
    }
    let pool = create_thread_pool(options.thread_count)?;
    let start = Instant::now();
    let found = run_with_progress(&pool, "dispersion", |on_progress| {
        study::compute_dispersion(&case, on_progress)
    })?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let greatest = format_short(found.max_wave_number);
        let plan = format!("follow the waves up to k = {greatest} 1/m");
        let paths = list_planned_paths(&folder, &folder::DISPERSION_FILES, &options.pictures);
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options, stdout)
}

/// Runs the verb `dispersion` for a blocky medium: computes its Bloch waves and writes the report.
fn run_bloch(case: &Case, options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let folder = select_folder(case, options)?;
    let pool = create_thread_pool(options.thread_count)?;
    if options.is_dry_run {
        setup::blocky::BlochProblem::new(case).map_err(crate::Error::from)?;
        let plan = "compute Bloch waves along the path Γ–X–M–Γ of the Brillouin zone";
        let paths = list_planned_paths(&folder, &folder::BLOCH_FILES, &options.pictures);
        let seconds =
            estimate_time(&pool, |on_progress| study::compute_bloch_waves(case, on_progress))?;
        let estimate = CostEstimate::from_seconds(seconds);
        return print_plan(plan, &paths, estimate, options.format, stdout);
    }
    let found = run_with_progress(&pool, "dispersion", |on_progress| {
        study::compute_bloch_waves(case, on_progress)
    })?;
    write_report(&found, case, &folder, options, stdout)
}
