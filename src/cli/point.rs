//! `wellposed point`: analyses the state that a case describes.

use super::load::load_case;
use super::progress::run_with_progress;
use super::write::{CostEstimate, list_planned_paths, print_plan, select_folder, write_report};
use crate::Error;
use crate::case::Case;
use crate::cli::folder::{self, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options, UsageError};
use crate::report::format::case_title;
use crate::report::point::CertifiedPoint;
use crate::report::{self, Report};
use crate::study::{self, BoxRange, PointResult};
use std::io::Write;
use std::time::{Duration, Instant};

/// Runs the verb `point`: analyses the state of a case and writes the report.
///
/// # Errors
/// The case is invalid, or results cannot be written.
pub fn run_point(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let case = load_case(options)?;
    let (folder, point, elapsed) = analyse(&case, options)?;
    finish(&point, (&case, &folder), elapsed, options, stdout)
}

/// Runs the verb `point` and proves the verdict for all states with up to two numbers in these ranges, or for the state of
/// the case if there are none.
///
/// # Errors
/// The case is invalid, no proof is known for it, or results cannot be written.
pub fn run_certified_point(
    options: &Options,
    ranges: &[BoxRange],
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let case = load_case(options)?;
    // The proof takes no time; its faults are told before the analysis.
    let certified = study::certify_state(&case, ranges).map_err(|error| match error {
        Error::BoxRange(own) => CommandError::Usage(UsageError {
            argument: format!("--over {}", own.key),
            found: own.found,
            allowed: own.allowed,
        }),
        other => other.into(),
    })?;
    let (folder, point, elapsed) = analyse(&case, options)?;
    finish(&CertifiedPoint { point, certified }, (&case, &folder), elapsed, options, stdout)
}

fn analyse(
    case: &Case,
    options: &Options,
) -> Result<(ResultFolder, PointResult, Duration), CommandError> {
    case.check_without_contacts()?;
    let folder = select_folder(case, options)?;
    let pool = create_thread_pool(options.thread_count)?;
    let start = Instant::now();
    let point =
        run_with_progress(&pool, "point", |on_progress| study::analyse_point(case, on_progress))?;
    Ok((folder, point, start.elapsed()))
}

/// Writes the report, or prints the plan of a dry run.
fn finish<R: Report>(
    found: &R,
    (case, folder): (&Case, &ResultFolder),
    elapsed: Duration,
    options: &Options,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    if options.is_dry_run {
        let plan = format!("analyse {}", case_title(case));
        let written = report::file_names(found, case, &options.pictures)?;
        let is_written = |name: &&str| written.iter().any(|own| own == name);
        let names: Vec<&str> = folder::POINT_FILES.into_iter().filter(is_written).collect();
        let paths = list_planned_paths(folder, &names, &options.pictures);
        let estimate = CostEstimate::from_seconds(elapsed.as_secs_f64());
        return print_plan(&plan, &paths, estimate, options.format, stdout);
    }
    write_report(found, case, folder, options, stdout)
}
