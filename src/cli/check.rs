//! `wellposed check`: compares predicted with measured waves, for a case or for all cases in a folder.

use super::load::{load_case, print_hints};
use super::progress::run_with_progress;
use super::write::{planned_paths, print_plan, write_report};
use crate::case::Case;
use crate::cli::folder::{self, OutputError, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{Error, Options, OutputFormat};
use crate::report::SCHEMA_VERSION;
use crate::report::check::{format_scientific, format_unmeasured_count};
use crate::setup::check::CheckPlan;
use crate::study;
use crate::study::check::{CheckExtent, CheckOutcome, CheckResult};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs `check` on a case, or on all cases in a folder.
///
/// # Errors
/// A case cannot be read or is invalid, its state cannot be analysed, the folder contains no case, the threads cannot
/// be started, results cannot be written, or measurement and prediction disagree. A case that no solver supports is no
/// error.
pub fn run_check(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let pool = create_thread_pool(options.threads)?;
    match options.case_path.is_dir() {
        true => check_folder(options, &pool, stdout),
        false => check_case(options, &pool, stdout),
    }
}

fn check_case(options: &Options, pool: &ThreadPool, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = load_case(options)?;
    let plan = CheckPlan::new(&case, CheckExtent::Full)?;
    let folder = ResultFolder::from_case(&case, options.output_folder.as_deref(), options.force)?;
    if options.is_dry_run {
        // The two pictures of a refinement are the last entries of `CHECK_FILES`.
        let refines = matches!(&plan, CheckPlan::Flow(flow) if !flow.grids.is_empty());
        let count = if refines { folder::CHECK_FILES.len() } else { folder::CHECK_FILES.len() - 2 };
        let paths = planned_paths(&folder, &folder::CHECK_FILES[..count]);
        return print_plan(&describe_plan(&plan), &paths, options.format, stdout);
    }
    let found = check_with_progress(&case, CheckExtent::Full, pool)?;
    write_report(&found, &case, &folder, options.format, stdout)?;
    let [all, failed] = found.row_counts();
    refuse_disagreement(failed, all, "rows")
}

fn check_with_progress(
    case: &Case,
    extent: CheckExtent,
    pool: &ThreadPool,
) -> Result<CheckResult, crate::Error> {
    run_with_progress(pool, "check", |on_progress| {
        study::check_agreement(case, extent, on_progress)
    })
}

/// Describes the planned measurements for a dry run.
fn describe_plan(plan: &CheckPlan) -> String {
    match plan {
        CheckPlan::Solid { media, blocks } => {
            let count: usize = media.iter().map(|own| own.waves.waves.len()).sum();
            let of_blocks = match blocks.len() {
                0 => String::new(),
                count => format!(", and Bloch waves in {count} media of blocks and joints"),
            };
            format!("send all branches at {count} wave vectors{of_blocks}")
        }
        CheckPlan::NotMeasurable(reason) => {
            format!("say that the case is not measurable: {reason}")
        }
        CheckPlan::Flow(flow) => {
            let grids = match flow.grids.len() {
                0 => String::new(),
                count => format!(", and one perturbation on {count} grids"),
            };
            format!("follow waves of {} wave vectors{grids}", flow.waves.len())
        }
    }
}

fn refuse_disagreement(failed: usize, total: usize, noun: &'static str) -> Result<(), Error> {
    match failed {
        0 => Ok(()),
        _ => Err(Error::Disagreement { failed, total, noun }),
    }
}

/// Checks all cases in a folder and its subfolders with [`CheckExtent::Short`]; writes no files.
fn check_folder(options: &Options, pool: &ThreadPool, stdout: &mut dyn Write) -> Result<(), Error> {
    let mut files = Vec::new();
    collect_case_files(&options.case_path, &mut files)?;
    files.sort();
    if files.is_empty() {
        return Err(Error::NoCases { folder: options.case_path.display().to_string() });
    }
    if options.is_dry_run {
        let plan = format!("check {} cases and write nothing", files.len());
        return print_plan(&plan, &[], options.format, stdout);
    }
    let (mut list, mut failed, mut all) = (Vec::new(), 0, 0);
    for path in files {
        let case = Case::load(&path, &options.settings)?;
        print_hints(&case);
        let name = path.display().to_string();
        let line = match check_with_progress(&case, CheckExtent::Short, pool) {
            Ok(found) => CaseLine::from_result(&name, &found),
            Err(crate::Error::Case(error)) => CaseLine {
                text: format!("FAILS: {error}"),
                json: json!({ "case": name, "agrees": false, "failure": error.to_string() }),
                agrees: Some(false),
            },
            Err(error) => return Err(error.into()),
        };
        all += usize::from(line.agrees.is_some());
        failed += usize::from(line.agrees == Some(false));
        if options.format == OutputFormat::Text {
            writeln!(stdout, "{name:<56} {}", line.text)?;
            stdout.flush()?;
        }
        list.push(line.json);
    }
    if options.format == OutputFormat::Json {
        writeln!(
            stdout,
            "{:#}",
            json!({ "schema": SCHEMA_VERSION, "agrees": failed == 0, "cases": list })
        )?;
    }
    refuse_disagreement(failed, all, "cases")
}

/// Result of the check of one case in a folder, as a line of text and as JSON.
struct CaseLine {
    text: String,
    json: Value,
    /// Whether no row disagrees; also false if the case is invalid; `None` if no solver supports the case.
    agrees: Option<bool>,
}

impl CaseLine {
    fn from_result(name: &str, found: &CheckResult) -> Self {
        if let CheckOutcome::NotMeasurable { reason } = &found.outcome {
            let text = format!("not measurable: {reason}");
            let json = json!({ "case": name, "not_measurable": reason });
            return Self { text, json, agrees: None };
        }
        let ([rows, wrong], greatest) = (found.row_counts(), found.max_relative_difference());
        let agrees = wrong == 0;
        let left = format_unmeasured_count(found.unmeasured_count());
        let verdict = match (greatest, agrees) {
            (None, _) => "nothing measured".to_owned(),
            (Some(greatest), true) => {
                format!("maximum error {}: agrees", format_scientific(greatest))
            }
            (Some(greatest), false) => {
                format!("maximum error {}: DISAGREES", format_scientific(greatest))
            }
        };
        Self {
            text: format!("{rows:>3} waves, {verdict}{left}"),
            json: json!({
                "case": name,
                "agrees": greatest.map(|_| agrees),
                "waves": rows,
                "waves_not_measurable": found.unmeasured_count(),
                "greatest_difference": greatest,
            }),
            agrees: Some(agrees),
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
