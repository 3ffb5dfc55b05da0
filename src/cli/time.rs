//! `wellposed time`: measures the time of a step of a blocky medium against the number of blocks.

use super::load::print_hints;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::{Case, CaseError};
use crate::cli::folder::{ResultFolder, TIME_FILES};
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
    /// Numbers of ranks on threads of this process; empty for one rank, or for those of the launcher.
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
    let Some(prepared) = prepare_timing(options, settings, stdout)? else { return Ok(()) };
    let threads = options.thread_count.unwrap_or(1);
    let rank_counts = settings.rank_counts_or_one();
    let found = time_blocks(&prepared.media, rank_counts, (threads, settings.steps))?;
    write_report(&found, &prepared.case, &prepared.folder, options, stdout)
}

impl TimingSettings {
    fn rank_counts_or_one(&self) -> &[usize] {
        if self.rank_counts.is_empty() { &[1] } else { &self.rank_counts }
    }
}

/// Case of a timing, its media, and its results folder.
pub(super) struct PreparedTiming {
    pub(super) case: Case,
    /// Case of each number of blocks along each axis.
    pub(super) media: Vec<(usize, Case)>,
    pub(super) folder: ResultFolder,
}

/// Loads the cases of each number of blocks, in ascending order.
pub(super) fn load_media(
    options: &Options,
    settings: &TimingSettings,
) -> Result<Vec<(usize, Case)>, CaseError> {
    Case::load_simulation(&options.case_path, &options.settings)?.require_blocks()?;
    let mut blocks = settings.block_counts.clone();
    blocks.sort_unstable();
    let resize = |count: usize| -> Result<(usize, Case), CaseError> {
        let mut all = options.settings.clone();
        all.push(format!("block[0].repeat=[{count}, {count}]"));
        all.extend(OMITTED_SECTIONS.map(str::to_owned));
        Ok((count, Case::load_simulation(&options.case_path, &all)?))
    };
    blocks.iter().map(|own| resize(*own)).collect()
}

/// Checks the case of a timing and its results folder; `None` if that is all, by `--dry-run`.
pub(super) fn prepare_timing(
    options: &Options,
    settings: &TimingSettings,
    stdout: &mut dyn Write,
) -> Result<Option<PreparedTiming>, CommandError> {
    let case = Case::load_simulation(&options.case_path, &options.settings)?;
    print_hints(&case);
    let media = load_media(options, settings)?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        let count = media.len() * settings.rank_counts_or_one().len();
        let plan = format!("time {}", format_count(count, "medium"));
        let paths = list_planned_paths(&folder, &TIME_FILES, &options.pictures);
        print_plan(&plan, &paths, CostEstimate::default(), options.format, stdout)?;
        return Ok(None);
    }
    Ok(Some(PreparedTiming { case, media, folder }))
}
