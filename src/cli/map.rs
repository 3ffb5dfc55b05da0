//! `wellposed map`: computes the verdict over two parameters of a case.

use super::load::load_case;
use super::progress::{estimate_time, run_with_progress};
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::case::{Case, MapAxes};
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options};
use crate::report::format::format_count;
use crate::study;
use crate::study::{MapOptions, MapResult};
use rayon::ThreadPool;
use std::io::Write;

/// Number of points from which on a map prints the memory that it needs before it begins.
const MIN_LARGE_MAP: usize = 1_000_000;

/// Runs the verb `map`: assesses all points of the map of a case and writes the report.
///
/// # Errors
/// The case cannot be read, has no map or is invalid at all of its points, memory is insufficient, or results cannot be
/// written.
pub fn run_map(
    options: &Options,
    map_options: MapOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let Some((case, folder)) = prepare_map(options, map_options, stdout)? else { return Ok(()) };
    let pool = create_thread_pool(options.thread_count)?;
    let found = run_with_progress(&pool, "assessing states", |on_progress| {
        study::compute_map(&case, map_options, on_progress)
    })?;
    write_map(found, (&case, &folder), options, &pool, stdout)
}

/// Checks the case of a map and its results folder; `None` if that is all, by `--dry-run`.
pub(super) fn prepare_map(
    options: &Options,
    map_options: MapOptions,
    stdout: &mut dyn Write,
) -> Result<Option<(Case, ResultFolder)>, CommandError> {
    let case = load_case(options)?;
    case.check_without_contacts()?;
    let map = *case.require_map()?;
    warn_of_varied_settings(&map, options);
    study::check_map_memory(&case, map_options)?;
    let memory = study::estimate_map_memory(&case, map_options)?;
    let folder = select_folder(&case, options)?;
    let states = map.x.point_count * map.y.point_count;
    if !options.is_dry_run {
        if states >= MIN_LARGE_MAP {
            // A closed standard error is ignored.
            let count = format_count(states, "point");
            let _ = writeln!(std::io::stderr(), "map of {count}, memory {memory}");
        }
        return Ok(Some((case, folder)));
    }
    let pool = create_thread_pool(options.thread_count)?;
    run_with_progress(&pool, "checking states", |on_progress| {
        study::check_map(&case, on_progress)
    })?;
    let seconds =
        estimate_time(&pool, |on_progress| study::compute_map(&case, map_options, on_progress))?;
    let plan = format!("assess {}: {} × {}", format_count(states, "state"), map.x, map.y);
    let memory_bytes = Some(memory.0);
    let estimate = CostEstimate { memory_bytes, ..CostEstimate::from_seconds(seconds) };
    let files: Vec<&str> = match map_options.is_certified {
        true => folder::MAP_FILES.iter().chain(&folder::CERTIFIED_MAP_FILES).copied().collect(),
        false => folder::MAP_FILES.to_vec(),
    };
    let paths = list_planned_paths(&folder, &files, &options.pictures);
    print_plan(&plan, &paths, estimate, options.format, stdout)?;
    Ok(None)
}

/// Writes the report of a map, with the curves of the page if it is asked for.
pub(super) fn write_map(
    mut found: MapResult,
    (case, folder): (&Case, &ResultFolder),
    options: &Options,
    pool: &ThreadPool,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    if options.pictures.has_page {
        add_samples(&mut found, case, pool)?;
    }
    write_report(&found, case, folder, options, stdout)
}

/// Prints a warning for each option `--set` of a number that the map varies.
fn warn_of_varied_settings(map: &MapAxes, options: &Options) {
    for setting in &options.settings {
        let key = setting.split('=').next().unwrap_or_default().trim();
        for (axis, sweep) in [("x", &map.x), ("y", &map.y)] {
            if key == sweep.parameter.name() {
                // A closed standard error is ignored.
                let _ = writeln!(
                    std::io::stderr(),
                    "warning: --set {setting}: no effect, since map.{axis} varies {key}"
                );
            }
        }
    }
}

/// Computes the curves that the page shows of a map.
///
/// # Errors
/// [`crate::Error::Cancelled`].
pub(super) fn add_samples(
    found: &mut MapResult,
    case: &Case,
    pool: &ThreadPool,
) -> Result<(), CommandError> {
    let map = &*found;
    let samples = run_with_progress(pool, "growth curves", |on_progress| {
        study::sample_map(case, map, on_progress)
    })?;
    found.samples = Some(samples);
    Ok(())
}
