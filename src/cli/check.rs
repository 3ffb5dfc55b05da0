//! `wellposed check`: compares predicted with measured waves, for a case or for all cases in a folder.

use super::load::print_hints;
use super::progress::{
    DelayedProgressBar, ESTIMATE_TIME, estimate_time, estimate_time_within,
    run_in_series_with_progress, run_with_progress,
};
use super::write::{
    CostEstimate, list_planned_paths, print_plan, print_report, select_folder, write_report_files,
};
use crate::case::{Case, CaseError};
use crate::cli::folder::{self, OutputError};
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options, OutputFormat};
use crate::report::SCHEMA_VERSION;
use crate::report::check::{format_scientific, format_unmeasured_count};
use crate::report::format::format_count;
use crate::setup::check::CheckPlan;
use crate::study;
use crate::study::check::{CheckExtent, CheckOutcome, CheckResult};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time for the estimates of all cases of a folder, unless single steps of their checks take longer.
const FOLDER_ESTIMATE_TIME: Duration = Duration::from_secs(3);

/// Runs the verb `check` on a case, or on all cases in a folder.
///
/// # Errors
/// A case cannot be read or is invalid, its state cannot be analysed, the folder contains no case, the threads cannot
/// be started, results cannot be written, or measurement and prediction disagree. A case that no solver supports is no
/// error. The cases of a folder that cannot be read are counted after the check of the others.
pub fn run_check(options: &Options, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let pool = create_thread_pool(options.thread_count)?;
    match options.case_path.is_dir() {
        true => check_folder(options, &pool, stdout),
        false => check_case(options, &pool, stdout),
    }
}

fn check_case(
    options: &Options,
    pool: &ThreadPool,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let case = Case::load(&options.case_path, &options.settings)?;
    print_hints(&case);
    let plan = CheckPlan::new(&case, CheckExtent::Full)?;
    let folder = select_folder(&case, options)?;
    if options.is_dry_run {
        // The two pictures of a refinement are the last entries of `CHECK_FILES`.
        let refines =
            matches!(&plan, CheckPlan::Flow(flow) if !flow.refined_point_counts.is_empty());
        let count = if refines { folder::CHECK_FILES.len() } else { folder::CHECK_FILES.len() - 2 };
        let paths = list_planned_paths(&folder, &folder::CHECK_FILES[..count], &options.pictures);
        let seconds = estimate_time(pool, |on_progress| {
            study::check_agreement(&case, CheckExtent::Full, on_progress)
        })?;
        let estimate = CostEstimate::from_seconds(seconds);
        return print_plan(&describe_plan(&plan), &paths, estimate, options.format, stdout);
    }
    let found = run_with_progress(pool, "check", |on_progress| {
        study::check_agreement(&case, CheckExtent::Full, on_progress)
    })?;
    let rendered = write_report_files(&found, &case, &folder, &options.pictures)?;
    match options.only_disagreeing && options.format == OutputFormat::Text {
        true => stdout.write_all(found.render_disagreements(&case).as_bytes())?,
        false => print_report(&rendered, &folder, &options.pictures, options.format, stdout)?,
    }
    let [all, failed] = found.item_and_failure_counts();
    fail_on_disagreement(failed, all, "rows")
}

/// Describes the planned measurements for a dry run.
fn describe_plan(plan: &CheckPlan) -> String {
    match plan {
        CheckPlan::Solid { medium_plans: media, blocky_medium_plans: blocks } => {
            let count: usize = media.iter().map(|own| own.waves.waves.len()).sum();
            let of_blocks = match blocks.len() {
                0 => String::new(),
                count => format!(", and Bloch waves in {count} media of blocks and joints"),
            };
            format!("measure all branches at {}{of_blocks}", format_count(count, "wave vector"))
        }
        CheckPlan::Equations(count) => {
            format!(
                "compare the linearised equations with differences of the equations for {}",
                format_count(*count, "wave")
            )
        }
        CheckPlan::NotMeasurable(reason) => {
            format!("say that the case is not measurable: {reason}")
        }
        CheckPlan::Shocks(shocks) => {
            let cells: Vec<String> = shocks.cell_counts.iter().map(usize::to_string).collect();
            format!("run the plane waves in columns of {} cells", cells.join(", "))
        }
        CheckPlan::Flow(flow) => {
            let grids = match flow.refined_point_counts.len() {
                0 => String::new(),
                count => format!(", and one perturbation on {count} grids"),
            };
            format!("follow waves of {}{grids}", format_count(flow.waves.len(), "wave vector"))
        }
    }
}

fn fail_on_disagreement(
    failed: usize,
    total: usize,
    noun: &'static str,
) -> Result<(), CommandError> {
    match failed {
        0 => Ok(()),
        _ => {
            Err(CommandError::Disagreement { disagreeing_count: failed, total_count: total, noun })
        }
    }
}

/// Checks all cases in a folder and its subfolders with [`CheckExtent::Short`]; writes no files.
fn check_folder(
    options: &Options,
    pool: &ThreadPool,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let mut files = Vec::new();
    collect_case_files(&options.case_path, &mut files)?;
    files.sort();
    if files.is_empty() {
        return Err(CommandError::NoCaseFiles { folder: options.case_path.display().to_string() });
    }
    if options.is_dry_run {
        let plan = format!("check {} and write nothing", format_count(files.len(), "case"));
        let estimate = CostEstimate::from_seconds(estimate_folder(options, pool, &files)?);
        return print_plan(&plan, &[], estimate, options.format, stdout);
    }
    let progress = DelayedProgressBar::new("check", 1);
    let mut summaries = Vec::new();
    let mut unreadable_count = 0;
    for (index, path) in files.iter().enumerate() {
        let name = path.display().to_string();
        let place = [index as u64, files.len() as u64];
        let summary = match Case::load(path, &options.settings) {
            // An error in a setting concerns all cases.
            Err(error) if error.is_in_setting() => return Err(error.into()),
            Err(error) => {
                unreadable_count += 1;
                CaseCheckSummary::from_error("CANNOT BE READ", &name, &error)
            }
            Ok(case) => {
                progress.hide_during(|| print_hints(&case));
                let found = run_in_series_with_progress(pool, &progress, place, |on_progress| {
                    study::check_agreement(&case, CheckExtent::Short, on_progress)
                });
                match found {
                    Ok(found) => CaseCheckSummary::from_result(&name, &found),
                    Err(crate::Error::Case(error)) => {
                        CaseCheckSummary::from_error("FAILS", &name, &error)
                    }
                    Err(error) => return Err(error.into()),
                }
            }
        };
        let text = format!("{name:<56} {}", summary.text);
        if options.format == OutputFormat::Text && !options.only_disagreeing {
            progress.hide_during(|| writeln!(stdout, "{text}").and_then(|()| stdout.flush()))?;
        }
        summaries.push(CaseCheckSummary { text, ..summary });
    }
    drop(progress);
    let all = summaries.iter().filter(|own| own.is_in_agreement.is_some()).count();
    let failed = summaries.iter().filter(|own| own.is_in_agreement == Some(false)).count();
    if options.format == OutputFormat::Json {
        let list: Vec<Value> = summaries.into_iter().map(|own| own.json).collect();
        let report = json!({ "schema": SCHEMA_VERSION, "agrees": failed == 0, "cases": list });
        writeln!(stdout, "{report:#}")?;
    } else if options.only_disagreeing {
        summaries.retain(|own| own.is_in_agreement == Some(false));
        summaries.sort_by(|one, other| other.error.total_cmp(&one.error));
        for own in summaries {
            writeln!(stdout, "{}", own.text)?;
        }
    }
    if unreadable_count > 0 {
        let total_count = files.len();
        return Err(CommandError::UnreadableCases { unreadable_count, total_count });
    }
    fail_on_disagreement(failed, all, "cases")
}

/// Estimates the wall time of the check of a folder, s, as the sum over its cases.
fn estimate_folder(
    options: &Options,
    pool: &ThreadPool,
    files: &[PathBuf],
) -> Result<f64, CommandError> {
    // The more cases, the shorter the estimate of each.
    let limit = ESTIMATE_TIME.min(FOLDER_ESTIMATE_TIME / files.len() as u32);
    let mut seconds = 0.0;
    for path in files {
        // The check of a folder goes on with the next case.
        let Ok(case) = Case::load(path, &options.settings) else { continue };
        let estimate = estimate_time_within(pool, limit, |on_progress| {
            study::check_agreement(&case, CheckExtent::Short, on_progress)
        });
        match estimate {
            Ok(own) => seconds += own,
            Err(crate::Error::Case(_)) => {}
            Err(error) => return Err(error.into()),
        }
    }
    Ok(seconds)
}

/// Result of the check of one case of a folder, as a line of text and as JSON.
struct CaseCheckSummary {
    text: String,
    json: Value,
    /// Whether all measurements of the case agree; false for an invalid case; `None` if no solver supports the case.
    is_in_agreement: Option<bool>,
    /// Largest relative error; infinite for an invalid case.
    error: f64,
}

impl CaseCheckSummary {
    /// Returns the line of a case that cannot be read or checked.
    fn from_error(verdict: &str, name: &str, error: &CaseError) -> Self {
        Self {
            text: format!("{verdict}: {error}"),
            json: json!({ "case": name, "agrees": false, "failure": error.to_string() }),
            is_in_agreement: Some(false),
            error: f64::INFINITY,
        }
    }

    fn from_result(name: &str, found: &CheckResult) -> Self {
        if let CheckOutcome::NotMeasurable { reason } = &found.outcome {
            let text = format!("not measurable: {reason}");
            let json = json!({ "case": name, "not_measurable": reason });
            return Self { text, json, is_in_agreement: None, error: 0.0 };
        }
        let ([rows, wrong], greatest) =
            (found.item_and_failure_counts(), found.max_relative_difference());
        let is_in_agreement = wrong == 0;
        let left = format_unmeasured_count(found.unmeasured_count());
        let noun = match (&found.outcome, rows) {
            (CheckOutcome::Shocks(_), 1) => "quantity",
            (CheckOutcome::Shocks(_), _) => "quantities",
            (_, 1) => "wave",
            (_, _) => "waves",
        };
        let verdict = match (greatest, is_in_agreement) {
            (None, _) => "nothing measured".to_owned(),
            (Some(greatest), true) => {
                format!("maximum error {}: agrees", format_scientific(greatest))
            }
            (Some(greatest), false) => {
                format!("maximum error {}: DISAGREES", format_scientific(greatest))
            }
        };
        Self {
            text: format!("{rows:>3} {noun}, {verdict}{left}"),
            json: json!({
                "case": name,
                "agrees": greatest.map(|_| is_in_agreement),
                "waves": rows,
                "waves_not_measurable": found.unmeasured_count(),
                "greatest_difference": greatest,
            }),
            is_in_agreement: Some(is_in_agreement),
            error: greatest.unwrap_or(0.0),
        }
    }
}

/// Collects the case files (`*.toml`) of a folder and its subfolders.
fn collect_case_files(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), OutputError> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| OutputError::from_read_error(folder, &error))?;
    for entry in entries {
        let path = entry.map_err(|error| OutputError::from_read_error(folder, &error))?.path();
        if path.is_dir() {
            collect_case_files(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && path.file_name().is_none_or(|name| name != "Cargo.toml")
        {
            // `Cargo.toml` is a manifest, not a case file.
            files.push(path);
        }
    }
    Ok(())
}
