//! `wellposed time`: measures the time of a step of a blocky medium against the number of blocks.

use super::load::print_hints;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::Case;
use crate::cli::folder::TIME_FILES;
use crate::cli::{CommandError, Options};
use crate::report::format::format_count;
use crate::study::timing::time_blocks;
use std::io::Write;

/// Parts of a case that depend on its size, and are left out.
const OMITTED_SECTIONS: [&str; 4] = ["load=[]", "source=[]", "receiver=[]", "initial=[]"];

/// Settings of the verb `time`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TimingSettings {
    /// Numbers of blocks along each axis.
    pub block_counts: Vec<usize>,
    /// Numbers of ranks.
    pub rank_counts: Vec<usize>,
    /// Number of steps of a round.
    pub steps: usize,
}

/// Runs the verb `time`: measures steps of a blocky medium with each number of blocks and of ranks, and writes the report.
/// Loads, sources, receivers and the initial state of the case are left out.
///
/// # Errors
/// The case is invalid or no blocky medium with one entry of blocks, its grid cannot be cut into so many parts, or results
/// cannot be written.
pub fn run_time(
    options: &Options,
    settings: &TimingSettings,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let case = Case::load_simulation(&options.case_path, &options.settings)?;
    print_hints(&case);
    let mut blocks = settings.block_counts.clone();
    blocks.sort_unstable();
    let resize = |count: usize| -> Result<(usize, Case), CommandError> {
        let mut all = options.settings.clone();
        all.push(format!("block[0].repeat=[{count}, {count}]"));
        all.extend(OMITTED_SECTIONS.map(str::to_owned));
        Ok((count, Case::load_simulation(&options.case_path, &all)?))
    };
    let cases: Vec<(usize, Case)> =
        blocks.iter().map(|own| resize(*own)).collect::<Result<_, _>>()?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let count = cases.len() * settings.rank_counts.len();
        let plan = format!("time {}", format_count(count, "medium"));
        let paths = list_planned_paths(&folder, &TIME_FILES, &options.pictures);
        return print_plan(&plan, &paths, CostEstimate::default(), options.format, stdout);
    }
    let threads = options.thread_count.unwrap_or(1);
    let found = time_blocks(&cases, &settings.rank_counts, (threads, settings.steps))?;
    write_report(&found, &case, &folder, options, stdout)
}
