//! Time of the steps of blocky media on the ranks of a launcher. The root appends it to the table in the results folder.

use super::{RankError, agree, await_beginning, end_together};
use crate::cli::time::{load_media, prepare_timing};
use crate::cli::write::write_report;
use crate::cli::{CommandError, Options, TimingSettings};
use crate::study::timing::{TimingResult, time_blocks_on_ranks};
use dynamics::decomposition::communicator::Communicator;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Runs the verb `time` on several ranks: measures steps of a blocky medium with each number of blocks on them. The table
/// in the results folder keeps its rows of other numbers of ranks, if they are of the same case and program version and of
/// as many steps and threads.
///
/// # Errors
/// Those of [`run_time`](crate::cli::run_time); numbers of ranks are given; or ranks have another program or case.
pub fn run_time_on_ranks(
    options: &Options,
    settings: &TimingSettings,
    communicator: &Arc<dyn Communicator>,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let threads = Some(options.thread_count.unwrap_or(1));
    let steps = settings.steps;
    end_together(communicator, || {
        if !communicator.is_root() {
            let media = load_media(options, settings);
            let content = media.as_ref().map(|media| describe_timing(media, steps));
            let content = content.map_err(ToString::to_string);
            let beginning = await_beginning(communicator, content, threads);
            let Some((threads, ..)) = beginning else { return Ok(()) };
            time_blocks_on_ranks(&media?, communicator, (threads, steps))?;
            return Ok(());
        }
        let prepared = match settings.rank_counts.is_empty() {
            true => prepare_timing(options, settings, stdout),
            false => Err(RankError::RankOption { count: communicator.size() }.into()),
        };
        let own = prepared.as_ref().ok().and_then(Option::as_ref);
        let content = own.map(|own| describe_timing(&own.media, steps));
        let agreed = agree(communicator, content, threads, (None, false));
        let Some(prepared) = prepared? else { return Ok(()) };
        let found = time_blocks_on_ranks(&prepared.media, communicator, (agreed?, steps))?;
        let Some(mut found) = found else { return Ok(()) };
        // With `--force` the folder may hold the table of another case.
        if !prepared.folder.has_foreign_results()?
            && let Some(earlier) = read_table(prepared.folder.path())
        {
            found.add_earlier_rows(earlier);
        }
        write_report(&found, &prepared.case, &prepared.folder, options, stdout)
    })
}

/// Returns what must be the same on all ranks.
fn describe_timing(media: &[(usize, crate::case::Case)], steps: usize) -> Vec<u8> {
    let cases = media.iter().map(|(_, case)| case.to_toml());
    (format!("{steps}\n") + &cases.collect::<String>()).into_bytes()
}

/// Reads the table in a results folder; `None` if there is none.
fn read_table(folder: &Path) -> Option<TimingResult> {
    serde_json::from_slice(&std::fs::read(folder.join("time.json")).ok()?).ok()
}
