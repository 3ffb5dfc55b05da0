//! `wellposed check`: compares predicted with measured waves, for a case or for all cases in a folder.

use super::load::print_hints;
use super::progress::run_with_progress;
use super::verdict::print_solid_verdict;
use super::write::{
    CostEstimate, list_planned_paths, print_plan, print_report, write_report_files,
};
use crate::case::Case;
use crate::cli::folder::{self, OutputError, ResultFolder};
use crate::cli::options::create_thread_pool;
use crate::cli::{CommandError, Options, OutputFormat};
use crate::report::SCHEMA_VERSION;
use crate::report::check::{DISAGREES, format_scientific, format_unmeasured_count};
use crate::report::format::format_count;
use crate::setup::check::CheckPlan;
use crate::study;
use crate::study::check::{CheckExtent, CheckOutcome, CheckResult};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs the verb `check` on a case, or on all cases in a folder.
///
/// # Errors
/// A case cannot be read or is invalid, its state cannot be analysed, the folder contains no case, the threads cannot
/// be started, results cannot be written, or measurement and prediction disagree. A case that no solver supports is no
/// error.
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
    let folder = ResultFolder::from_case(&case, options.output_folder.as_deref(), options.force)?;
    if options.is_dry_run {
        // The two pictures of a refinement are the last entries of `CHECK_FILES`.
        let refines =
            matches!(&plan, CheckPlan::Flow(flow) if !flow.refined_point_counts.is_empty());
        let count = if refines { folder::CHECK_FILES.len() } else { folder::CHECK_FILES.len() - 2 };
        let paths = list_planned_paths(&folder, &folder::CHECK_FILES[..count]);
        return print_plan(
            &describe_plan(&plan),
            &paths,
            CostEstimate::default(),
            options.format,
            stdout,
        );
    }
    print_solid_verdict(&case);
    let found = check_with_progress(&case, CheckExtent::Full, pool)?;
    let rendered = write_report_files(&found, &case, &folder)?;
    match options.only_disagreeing && options.format == OutputFormat::Text {
        true => stdout.write_all(select_disagreements(rendered.text()).as_bytes())?,
        false => print_report(&rendered, &folder, options.format, stdout)?,
    }
    let [all, failed] = found.item_and_failure_counts();
    fail_on_disagreement(failed, all, "rows")
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
        CheckPlan::Solid { medium_plans: media, blocky_medium_plans: blocks } => {
            let count: usize = media.iter().map(|own| own.waves.waves.len()).sum();
            let of_blocks = match blocks.len() {
                0 => String::new(),
                count => format!(", and Bloch waves in {count} media of blocks and joints"),
            };
            format!("send all branches at {}{of_blocks}", format_count(count, "wave vector"))
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

/// Returns the title, the rows that disagree below their wave vectors, and the summaries of a report.
fn select_disagreements(text: &str) -> String {
    let mut selected = String::new();
    let mut wave_vector = None;
    for (index, line) in text.lines().enumerate() {
        if line.starts_with("k = ") {
            wave_vector = Some(line);
            continue;
        }
        let is_row = line.ends_with(DISAGREES);
        let is_summary = line.contains("maximum error") || line.starts_with("not measurable");
        if index == 0 || is_row || is_summary {
            let heading = wave_vector.take_if(|_| is_row && line.starts_with(' '));
            for line in heading.into_iter().chain([line]) {
                selected += line;
                selected.push('\n');
            }
        }
    }
    selected
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
        return print_plan(&plan, &[], CostEstimate::default(), options.format, stdout);
    }
    let (mut list, mut failed, mut all) = (Vec::new(), 0, 0);
    for path in files {
        let case = Case::load(&path, &options.settings)?;
        print_hints(&case);
        let name = path.display().to_string();
        let line = match check_with_progress(&case, CheckExtent::Short, pool) {
            Ok(found) => CaseCheckSummary::from_result(&name, &found),
            Err(crate::Error::Case(error)) => CaseCheckSummary {
                text: format!("FAILS: {error}"),
                json: json!({ "case": name, "agrees": false, "failure": error.to_string() }),
                is_in_agreement: Some(false),
            },
            Err(error) => return Err(error.into()),
        };
        all += usize::from(line.is_in_agreement.is_some());
        failed += usize::from(line.is_in_agreement == Some(false));
        let is_printed = !options.only_disagreeing || line.is_in_agreement == Some(false);
        if options.format == OutputFormat::Text && is_printed {
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
    fail_on_disagreement(failed, all, "cases")
}

/// Result of the check of one case of a folder, as a line of text and as JSON.
struct CaseCheckSummary {
    text: String,
    json: Value,
    /// Whether all measurements of the case agree; false for an invalid case; `None` if no solver supports the case.
    is_in_agreement: Option<bool>,
}

impl CaseCheckSummary {
    fn from_result(name: &str, found: &CheckResult) -> Self {
        if let CheckOutcome::NotMeasurable { reason } = &found.outcome {
            let text = format!("not measurable: {reason}");
            let json = json!({ "case": name, "not_measurable": reason });
            return Self { text, json, is_in_agreement: None };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_that_disagree_keep_their_wave_vector() {
        let text = "title\nmedium\n\nk = 1 1/m at 0°\n  first  agrees\n  second  DISAGREES\n  third  DISAGREES\n\
                    k = 2 1/m at 0°\n  first  agrees\n\n4 waves, maximum error 1.0e-3: 2 DISAGREE\n";
        let expected = "title\nk = 1 1/m at 0°\n  second  DISAGREES\n  third  DISAGREES\n\
                        4 waves, maximum error 1.0e-3: 2 DISAGREE\n";
        assert_eq!(select_disagreements(text), expected);
    }
}
