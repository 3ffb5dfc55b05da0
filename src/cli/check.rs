//! `wellposed check`: compares predicted with measured waves, for a case or for all cases in a folder.

use super::progress::watched;
use super::write::{would_write, write};
use crate::case::Case;
use crate::cli::folder::{self, OutputError, ResultFolder};
use crate::cli::options::pool;
use crate::cli::{Error, Format, Options};
use crate::report::SCHEMA;
use crate::report::check::{exponent, unmeasured_words};
use crate::setup::check::CheckPlan;
use crate::study;
use crate::study::check::{CheckResult, Extent, Outcome};
use rayon::ThreadPool;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs `check` on a case, or on all cases in a folder.
///
/// # Errors
/// The case is invalid or has no solver, results cannot be written, or measurement and prediction disagree.
pub fn check(options: &Options, stdout: &mut dyn Write) -> Result<(), Error> {
    let pool = pool(options.threads)?;
    match options.case.is_dir() {
        true => check_folder(options, &pool, stdout),
        false => check_case(options, &pool, stdout),
    }
}

fn check_case(options: &Options, pool: &ThreadPool, stdout: &mut dyn Write) -> Result<(), Error> {
    let case = Case::load(&options.case, &options.sets)?;
    let plan = CheckPlan::new(&case, Extent::Full)?;
    let folder = ResultFolder::check(&case, options.out.as_deref(), options.force)?;
    if options.dry_run {
        writeln!(stdout, "would {}", plan_words(&plan))?;
        // The two pictures of a refinement are the last entries of `CHECK`.
        let refines = matches!(&plan, CheckPlan::Flow(flow) if !flow.grids.is_empty());
        let count = if refines { folder::CHECK.len() } else { folder::CHECK.len() - 2 };
        return would_write(&folder, &folder::CHECK[..count], stdout);
    }
    let found = study(&case, Extent::Full, pool)?;
    write(&found, &case, &folder, options.format, stdout)?;
    let [all, failed] = found.counts();
    refuse_disagreement(failed, all, "rows")
}

fn study(case: &Case, extent: Extent, pool: &ThreadPool) -> Result<CheckResult, crate::Error> {
    watched(pool, "check", |on_progress| study::check(case, extent, on_progress))
}

/// Describes the planned measurements for a dry run.
fn plan_words(plan: &CheckPlan) -> String {
    match plan {
        CheckPlan::Solid(media) => {
            let count: usize = media.iter().map(|own| own.waves.waves.len()).sum();
            format!("send all branches at {count} wave vectors")
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

fn refuse_disagreement(failed: usize, all: usize, what: &'static str) -> Result<(), Error> {
    match failed {
        0 => Ok(()),
        _ => Err(Error::Disagrees { failed, all, what }),
    }
}

/// Checks all cases in a folder with [`Extent::Short`]; writes no files.
fn check_folder(options: &Options, pool: &ThreadPool, stdout: &mut dyn Write) -> Result<(), Error> {
    let mut files = Vec::new();
    collect(&options.case, &mut files)?;
    files.sort();
    if files.is_empty() {
        return Err(Error::NoCases { folder: options.case.display().to_string() });
    }
    if options.dry_run {
        writeln!(stdout, "would check {} cases; would write nothing", files.len())?;
        return Ok(());
    }
    let (mut list, mut failed, mut all) = (Vec::new(), 0, 0);
    for path in files {
        let case = Case::load(&path, &options.sets)?;
        let name = path.display().to_string();
        let line = match study(&case, Extent::Short, pool) {
            Ok(found) => CaseLine::from_result(&name, &found),
            Err(crate::Error::Case(error)) => CaseLine {
                text: format!("FAILS: {error}"),
                json: json!({ "case": name, "agrees": false, "failure": error.to_string() }),
                is_well: Some(false),
            },
            Err(error) => return Err(error.into()),
        };
        all += usize::from(line.is_well.is_some());
        failed += usize::from(line.is_well == Some(false));
        if options.format == Format::Text {
            writeln!(stdout, "{name:<56} {}", line.text)?;
            stdout.flush()?;
        }
        list.push(line.json);
    }
    if options.format == Format::Json {
        writeln!(
            stdout,
            "{:#}",
            json!({ "schema": SCHEMA, "agrees": failed == 0, "cases": list })
        )?;
    }
    refuse_disagreement(failed, all, "cases")
}

/// Result line of one case of a folder.
struct CaseLine {
    text: String,
    json: Value,
    /// Whether all rows agree; `None` if no solver applies to the case.
    is_well: Option<bool>,
}

impl CaseLine {
    fn from_result(name: &str, found: &CheckResult) -> Self {
        if let Outcome::NotMeasurable { not_measurable: reason } = &found.outcome {
            let text = format!("not measurable: {reason}");
            let json = json!({ "case": name, "not_measurable": reason });
            return Self { text, json, is_well: None };
        }
        let ([rows, wrong], greatest) = (found.counts(), found.greatest_difference());
        let is_well = wrong == 0;
        let left = unmeasured_words(found.unmeasured());
        let verdict = match (greatest, is_well) {
            (None, _) => "nothing measured".to_owned(),
            (Some(greatest), true) => format!("{} off: agrees", exponent(greatest)),
            (Some(greatest), false) => format!("{} off: DISAGREES", exponent(greatest)),
        };
        Self {
            text: format!("{rows:>3} waves, {verdict}{left}"),
            json: json!({
                "case": name,
                "agrees": greatest.map(|_| is_well),
                "waves": rows,
                "waves_not_measurable": found.unmeasured(),
                "greatest_difference": greatest,
            }),
            is_well: Some(is_well),
        }
    }
}

/// Collects the case files (`*.toml`) of a folder and its subfolders.
fn collect(folder: &Path, files: &mut Vec<PathBuf>) -> Result<(), OutputError> {
    let entries =
        std::fs::read_dir(folder).map_err(|error| OutputError::unreadable(folder, &error))?;
    for entry in entries {
        let path = entry.map_err(|error| OutputError::unreadable(folder, &error))?.path();
        if path.is_dir() {
            collect(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "toml")
            && path.file_name().is_none_or(|name| name != "Cargo.toml")
        {
            // `Cargo.toml` is a manifest, not a case file.
            files.push(path);
        }
    }
    Ok(())
}
