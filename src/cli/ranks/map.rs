//! Maps on several ranks, each of which assesses a part of the points. The root writes the results.

use super::{agree, await_beginning, describe_case, end_together, require_all_ranks};
use crate::case::Case;
use crate::cli::map::{prepare_map, write_map};
use crate::cli::options::create_thread_pool;
use crate::cli::progress::run_with_progress;
use crate::cli::{CommandError, Options};
use crate::study::{self, MapOptions, MapResult};
use dynamics::decomposition::communicator::Communicator;
use rayon::ThreadPool;
use std::io::Write;
use std::sync::Arc;

/// Runs the verb `map` on several ranks. The results are those of one process, bit for bit.
///
/// # Errors
/// Those of [`run_map`](crate::cli::run_map); or ranks have another program or case.
pub fn run_map_on_ranks(
    options: &Options,
    map_options: MapOptions,
    communicator: &Arc<dyn Communicator>,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    end_together(communicator, || {
        if !communicator.is_root() {
            let case = Case::load(&options.case_path, &options.settings);
            let beginning =
                await_beginning(communicator, describe_case(&case), options.thread_count);
            let Some((threads, ..)) = beginning else { return Ok(()) };
            return compute_map(&case?, map_options, threads, &**communicator).map(drop);
        }
        let prepared = prepare_map(options, map_options, stdout);
        let own = prepared.as_ref().ok().and_then(Option::as_ref);
        let content = own.map(|(case, _)| case.to_toml().into_bytes());
        let threads = agree(communicator, content, options.thread_count, (None, false));
        let Some((case, folder)) = prepared? else { return Ok(()) };
        let (found, pool) = compute_map(&case, map_options, threads?, &**communicator)?;
        write_map(found, (&case, &folder), options, &pool, stdout)
    })
}

/// Computes the map of a case together with the other ranks, with the options of the root.
fn compute_map(
    case: &Case,
    options: MapOptions,
    threads: usize,
    communicator: &dyn Communicator,
) -> Result<(MapResult, ThreadPool), CommandError> {
    let ready = create_thread_pool(Some(threads))
        .and_then(|pool| Ok(study::check_map_memory(case, options).map(|()| pool)?));
    let pool = require_all_ranks(communicator, ready)?;
    let MapOptions { computes_bound, computes_growth_rate, is_model_blind, is_certified } = options;
    let flags = [computes_bound, computes_growth_rate, is_model_blind, is_certified].map(u8::from);
    let flags = communicator.broadcast(flags.to_vec());
    let flag = |index: usize| flags.get(index) == Some(&1);
    let options = MapOptions {
        computes_bound: flag(0),
        computes_growth_rate: flag(1),
        is_model_blind: flag(2),
        is_certified: flag(3),
    };
    let found = match communicator.is_root() {
        true => run_with_progress(&pool, "assessing states", |on_progress| {
            study::compute_map_on_ranks(case, options, communicator, on_progress)
        }),
        false => pool.install(|| {
            study::compute_map_on_ranks(case, options, communicator, &study::ignore_progress)
        }),
    };
    if let Err(error @ crate::Error::Memory { .. }) = &found {
        // The other ranks wait for the points of this one.
        communicator.abort(&error.to_string());
    }
    Ok((found?, pool))
}
