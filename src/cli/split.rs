//! `wellposed split`: plans the distribution of the cells of a run over ranks.

use super::load::print_hints;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::Case;
use crate::cli::folder::SPLIT_FILES;
use crate::cli::{CommandError, Options};
use crate::report::format::format_count;
use crate::study::simulate::plan_split;
use std::io::Write;
use std::time::Instant;

/// Runs the verb `split`: plans the parts of as many ranks as a run would have, and writes the report.
///
/// # Errors
/// The case is invalid or has no simulation of a solid, its grid cannot be cut into so many parts, or results cannot be
/// written.
pub fn run_split(
    options: &Options,
    rank_count: usize,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let case = Case::load_simulation(&options.case_path, &options.settings)?;
    print_hints(&case);
    let start = Instant::now();
    let found = plan_split(&case, rank_count, options.thread_count.unwrap_or(1))?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let has_sections = found.cell_counts.len() == 3;
        let is_written = |name: &&str| match name.rsplit_once('.') {
            Some((stem, "png" | "svg")) => stem.contains('-') == has_sections,
            _ => true,
        };
        let names: Vec<&str> = SPLIT_FILES.into_iter().filter(is_written).collect();
        let paths = list_planned_paths(&folder, &names, &options.pictures);
        let plan = format!("plan the parts of {}", format_count(rank_count, "rank"));
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(&found, &case, &folder, options, stdout)
}
