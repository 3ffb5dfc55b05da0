//! `wellposed shocks`: computes plane waves in granular and porous media exactly.

use super::load::load_case;
use super::progress::run_with_progress;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::cli::folder;
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::study;
use std::io::Write;
use std::time::Instant;

/// Runs the verb `shocks`: computes the waves behind a piston and at a free end, and writes the report.
///
/// # Errors
/// The case is invalid or has no granular or porous medium, or results cannot be written.
pub fn run_shocks(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = load_case(options)?;
    let start = Instant::now();
    let pool = create_thread_pool(options.thread_count)?;
    let found = run_with_progress(&pool, "shocks", |_| study::compute_shocks(&case))?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let is_written = |name: &&str| match *name {
            "shocks.json" | "shocks.txt" => true,
            name if name.starts_with("spall") => found.spall.is_some(),
            _ => found.piston.is_some(),
        };
        let names: Vec<&str> = folder::SHOCKS_FILES.into_iter().filter(is_written).collect();
        let paths = list_planned_paths(&folder, &names, &options.pictures);
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan("solve plane waves exactly", &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options, stdout)
}
