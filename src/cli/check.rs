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
use crate::cli::ranks::RankError;
use crate::cli::{CommandError, Options, OutputFormat};
use crate::report::SCHEMA_VERSION;
use crate::report::check::{format_scientific, format_unmeasured_count};
use crate::report::format::format_count;
use crate::setup::check::CheckPlan;
use crate::study;
use crate::study::check::{CheckExtent, CheckOutcome, CheckResult};
use dynamics::decomposition::communicator::{Communicator, SingleProcess};
use rayon::ThreadPool;
use serde::{Deserialize, Serialize};
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
    if options.case_path.is_dir() {
        let files = list_case_files(&options.case_path)?;
        if options.is_dry_run {
            return plan_folder_check(options, &files, stdout);
        }
        let pool = create_thread_pool(options.thread_count)?;
        return check_files(options, &files, &pool, &SingleProcess, stdout);
    }
    check_case(options, &create_thread_pool(options.thread_count)?, stdout)
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

/// Returns the case files in a folder and its subfolders, sorted.
///
/// # Errors
/// A folder cannot be read, or there is no case file.
pub(super) fn list_case_files(folder: &Path) -> Result<Vec<PathBuf>, CommandError> {
    let mut files = Vec::new();
    collect_case_files(folder, &mut files)?;
    files.sort();
    match files.is_empty() {
        true => Err(CommandError::NoCaseFiles { folder: folder.display().to_string() }),
        false => Ok(files),
    }
}

/// Prints the plan of the check of case files.
pub(super) fn plan_folder_check(
    options: &Options,
    files: &[PathBuf],
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let pool = create_thread_pool(options.thread_count)?;
    let plan = format!("check {} and write nothing", format_count(files.len(), "case"));
    let estimate = CostEstimate::from_seconds(estimate_folder(options, &pool, files)?);
    print_plan(&plan, &[], estimate, options.format, stdout)
}

/// Checks case files with [`CheckExtent::Short`], of which each rank checks some; writes no files. All ranks call it with
/// the same files; the root prints the results in the order of the files.
pub(super) fn check_files(
    options: &Options,
    files: &[PathBuf],
    pool: &ThreadPool,
    communicator: &dyn Communicator,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let (rank, ranks) = (communicator.rank(), communicator.size());
    if !communicator.is_root() {
        for path in files.iter().skip(rank).step_by(ranks) {
            let own = check_file(options, path, |case| {
                pool.install(|| {
                    study::check_agreement(case, CheckExtent::Short, &study::ignore_progress)
                })
            });
            communicator.send_any_length(0, encode_summary(own));
        }
        return Ok(());
    }
    let progress = DelayedProgressBar::new("check", 1);
    let mut summaries = Vec::new();
    let mut failure = None;
    for (index, path) in files.iter().enumerate() {
        let place = [index as u64, files.len() as u64];
        let found = match index % ranks {
            0 if failure.is_some() => continue,
            0 => check_file(options, path, |case| {
                run_in_series_with_progress(pool, &progress, place, |on_progress| {
                    study::check_agreement(case, CheckExtent::Short, on_progress)
                })
            }),
            other => decode_summary(other, &communicator.receive_any_length(other)),
        };
        if failure.is_some() {
            continue;
        }
        let printed = found
            .and_then(|own| progress.hide_during(|| print_summary(options, path, own, stdout)));
        match printed {
            Ok(summary) => summaries.push(summary),
            Err(error) if ranks == 1 => return Err(error),
            // Other ranks end only after all of their messages are received.
            Err(error) => failure = Some(error),
        }
    }
    if let Some(error) = failure {
        return Err(error);
    }
    drop(progress);
    let all = summaries.iter().filter(|own| own.is_in_agreement.is_some()).count();
    let failed = summaries.iter().filter(|own| own.is_in_agreement == Some(false)).count();
    let unreadable_count = summaries.iter().filter(|own| own.is_unreadable).count();
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

/// Prints the hints on a case of a folder and, unless the whole output follows later, its line, which is returned as text
/// of the summary.
///
/// # Errors
/// Standard output cannot be written.
fn print_summary(
    options: &Options,
    path: &Path,
    summary: CaseCheckSummary,
    stdout: &mut dyn Write,
) -> Result<CaseCheckSummary, CommandError> {
    let text = format!("{:<56} {}", path.display().to_string(), summary.text);
    for hint in &summary.hints {
        // A closed standard error is ignored.
        let _ = writeln!(std::io::stderr(), "warning: {hint}");
    }
    if options.format == OutputFormat::Text && !options.only_disagreeing {
        writeln!(stdout, "{text}")?;
        stdout.flush()?;
    }
    Ok(CaseCheckSummary { text, ..summary })
}

/// Checks one case of a folder by `check`. A case that cannot be read or checked is no error.
///
/// # Errors
/// A fault that concerns all cases, such as one in a setting.
fn check_file(
    options: &Options,
    path: &Path,
    check: impl FnOnce(&Case) -> Result<CheckResult, crate::Error>,
) -> Result<CaseCheckSummary, CommandError> {
    let name = path.display().to_string();
    let case = match Case::load(path, &options.settings) {
        Ok(case) => case,
        Err(error) if error.is_in_setting() => return Err(error.into()),
        Err(error) => {
            let summary = CaseCheckSummary::from_error("CANNOT BE READ", &name, &error);
            return Ok(CaseCheckSummary { is_unreadable: true, ..summary });
        }
    };
    let summary = match check(&case) {
        Ok(found) => CaseCheckSummary::from_result(&name, &found),
        Err(crate::Error::Case(error)) => CaseCheckSummary::from_error("FAILS", &name, &error),
        Err(error) => return Err(error.into()),
    };
    Ok(CaseCheckSummary {
        hints: case.hints().iter().map(ToString::to_string).collect(),
        ..summary
    })
}

/// Key of the largest error in the JSON of a case.
const GREATEST_DIFFERENCE: &str = "greatest_difference";

/// Message on the check of a case: its summary with the bits of its largest error, which JSON does not keep; or the error.
type CaseCheckMessage = Result<(CaseCheckSummary, u64), String>;

/// Encodes the summary of a case, or the error of its check, for the root.
fn encode_summary(found: Result<CaseCheckSummary, CommandError>) -> Vec<u8> {
    let with_bits = |own: CaseCheckSummary| {
        let bits = own.error.to_bits();
        (own, bits)
    };
    let message: CaseCheckMessage = found.map(with_bits).map_err(|error| error.to_string());
    json!(message).to_string().into_bytes()
}

/// Decodes a message of [`encode_summary`] from a rank.
fn decode_summary(rank: usize, message: &[u8]) -> Result<CaseCheckSummary, CommandError> {
    let message: CaseCheckMessage = serde_json::from_slice(message)
        .unwrap_or_else(|error| Err(format!("its message on a case cannot be read: {error}")));
    let (own, bits) = message.map_err(|cause| RankError::OtherRank { rank, cause })?;
    let mut summary = CaseCheckSummary { error: f64::from_bits(bits), ..own };
    if summary.json[GREATEST_DIFFERENCE].is_number() {
        summary.json[GREATEST_DIFFERENCE] = json!(summary.error);
    }
    Ok(summary)
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
#[derive(Debug, Serialize, Deserialize)]
struct CaseCheckSummary {
    text: String,
    json: Value,
    /// Whether all measurements of the case agree; false for an invalid case; `None` if no solver supports the case.
    is_in_agreement: Option<bool>,
    /// Largest relative error; infinite for an invalid case.
    #[serde(skip)]
    error: f64,
    /// Hints on former names in the case.
    hints: Vec<String>,
    is_unreadable: bool,
}

impl CaseCheckSummary {
    /// Returns the line of a case that cannot be read or checked.
    fn from_error(verdict: &str, name: &str, error: &CaseError) -> Self {
        Self {
            text: format!("{verdict}: {error}"),
            json: json!({ "case": name, "agrees": false, "failure": error.to_string() }),
            is_in_agreement: Some(false),
            error: f64::INFINITY,
            hints: Vec::new(),
            is_unreadable: false,
        }
    }

    fn from_result(name: &str, found: &CheckResult) -> Self {
        if let CheckOutcome::NotMeasurable { reason } = &found.outcome {
            let text = format!("not measurable: {reason}");
            let json = json!({ "case": name, "not_measurable": reason });
            return Self {
                text,
                json,
                is_in_agreement: None,
                error: 0.0,
                hints: Vec::new(),
                is_unreadable: false,
            };
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
                GREATEST_DIFFERENCE: greatest,
            }),
            is_in_agreement: Some(is_in_agreement),
            error: greatest.unwrap_or(0.0),
            hints: Vec::new(),
            is_unreadable: false,
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
    use dynamics::decomposition::communicator::ThreadRank;
    use std::io;

    /// Standard output on a full disk.
    struct FullDisk;

    impl Write for FullDisk {
        fn write(&mut self, _: &[u8]) -> io::Result<usize> {
            Err(io::ErrorKind::StorageFull.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn all_messages_are_received_after_a_failed_write() {
        let files: Vec<PathBuf> = (0..7).map(|own| format!("absent-{own}.toml").into()).collect();
        let check = |rank: &ThreadRank| {
            let pool = create_thread_pool(Some(1)).expect("a thread");
            let found = check_files(&Options::default(), &files, &pool, rank, &mut FullDisk);
            let is_failed = matches!(found, Err(CommandError::Stdout(_)));
            assert_eq!((is_failed, found.is_ok()), (rank.is_root(), !rank.is_root()));
            // These are the first messages not received yet.
            assert_eq!(rank.gather_to_all(vec![rank.rank() as u8]), [[0], [1], [2]]);
        };
        std::thread::scope(|scope| {
            for rank in ThreadRank::create_all(3) {
                let check = &check;
                scope.spawn(move || check(&rank));
            }
        });
    }

    #[test]
    fn messages_keep_all_bits_and_malformed_ones_are_errors() {
        let error = 0.1 + 0.2;
        let summary = CaseCheckSummary {
            text: "line".into(),
            json: json!({ "case": "a", GREATEST_DIFFERENCE: error }),
            is_in_agreement: Some(true),
            error,
            hints: vec!["hint".into()],
            is_unreadable: false,
        };
        let message = encode_summary(Ok(summary));
        let found = decode_summary(1, &message).expect("a summary");
        assert_eq!((found.error, found.json[GREATEST_DIFFERENCE].as_f64()), (error, Some(error)));
        assert_eq!((found.text.as_str(), found.hints.len()), ("line", 1));
        for malformed in [&b""[..], b"{}", &message[1..]] {
            let found = decode_summary(2, malformed).expect_err("malformed").to_string();
            assert!(found.starts_with("rank 2: its message on a case cannot be read"), "{found}");
        }
        let failure = encode_summary(Err(RankError::Ended { exit_code: 2 }.into()));
        let found = decode_summary(3, &failure).expect_err("a failure").to_string();
        assert_eq!(found, "rank 3: rank 0 has ended the run");
    }
}
