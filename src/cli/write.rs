//! Output of reports to results folders and standard output.

use super::folder::{OutputError, REPORT_PAGE_FILE, ResultFolder};
use super::{CommandError, Options, OutputFormat};
use crate::case::Case;
use crate::report::run::DisplayTime;
use crate::report::{PictureOptions, RenderedReport, Report, SCHEMA_VERSION};
use crate::study::simulate::Bytes;
use serde_json::json;
use std::io::Write;

/// Selects the results folder of a verb. A dry run only warns of results that the verb would refuse to overwrite.
///
/// # Errors
/// The folder cannot be written, or the verb may not overwrite the results in it.
pub(super) fn select_folder(case: &Case, options: &Options) -> Result<ResultFolder, OutputError> {
    let (out, force) = (options.output_folder.as_deref(), options.force);
    let folder = ResultFolder::from_case(case, out, force)?;
    refuse_or_warn(folder.check_other_results(), options.is_dry_run)?;
    Ok(folder)
}

/// Returns the error of a check that a folder may be written; a dry run, which writes nothing, prints it as a warning.
///
/// # Errors
/// The check failed, and this is no dry run.
pub(super) fn refuse_or_warn(
    check: Result<(), OutputError>,
    is_dry_run: bool,
) -> Result<(), OutputError> {
    match check {
        Err(error) if is_dry_run => {
            // A closed standard error is ignored.
            let _ = writeln!(std::io::stderr(), "warning: {error}");
            Ok(())
        }
        other => other,
    }
}

/// Writes all files of a report to the results folder, and its text or JSON to standard output.
///
/// # Errors
/// A file cannot be rendered or written.
pub(super) fn write_report<R: Report>(
    report: &R,
    case: &Case,
    folder: &ResultFolder,
    options: &Options,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let rendered = write_report_files(report, case, folder, &options.pictures)?;
    print_report(&rendered, folder, &options.pictures, options.format, stdout)
}

/// Writes all files of a report to the results folder and returns the report as text.
///
/// # Errors
/// A file cannot be rendered or written.
pub(super) fn write_report_files<'r, R: Report>(
    report: &'r R,
    case: &Case,
    folder: &ResultFolder,
    pictures: &PictureOptions,
) -> Result<RenderedReport<'r>, CommandError> {
    let mut rendered = RenderedReport::new(report, case)?;
    let mut publication = folder.start_publication();
    let absent = report.absent_file_names().into_iter();
    for name in absent.filter(|name| folder.path().join(name).exists()) {
        publication.schedule_removal(&name);
    }
    let of_page = rendered.write_files(pictures, |name, write| {
        publication.stage_with(name, |file| write(file)).map_err(CommandError::from)
    })?;
    if pictures.has_page {
        publication.set_page_section(rendered.create_page_section(&of_page)?);
    }
    publication.publish()?;
    Ok(rendered)
}

/// Prints the report as text or JSON. The text ends with the path of the first picture, or with that of the results
/// folder if the report [does not end with a picture path](Report::ENDS_WITH_PICTURE_PATH) or has no picture.
///
/// # Errors
/// Standard output cannot be written.
pub(super) fn print_report(
    rendered: &RenderedReport,
    folder: &ResultFolder,
    pictures: &PictureOptions,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    match format {
        OutputFormat::Json => stdout.write_all(rendered.json().as_bytes())?,
        OutputFormat::Text => {
            stdout.write_all(rendered.text().as_bytes())?;
            match rendered.first_picture_name(pictures) {
                Some(name) => {
                    writeln!(stdout, "picture: {}", folder.path().join(name).display())?;
                }
                None => writeln!(stdout, "results: {}", folder.path().display())?,
            }
        }
    }
    Ok(())
}

/// Returns the paths of the files that a verb would write: the common files, the page if it is asked for, and `names`, in which each picture is listed
/// as PNG and SVG; its files are those of the options.
pub(super) fn list_planned_paths(
    folder: &ResultFolder,
    names: &[impl AsRef<str>],
    pictures: &PictureOptions,
) -> Vec<String> {
    let common = ResultFolder::COMMON_FILE_NAMES.into_iter().map(str::to_owned);
    let page = pictures.has_page.then(|| REPORT_PAGE_FILE.to_owned());
    let names = common.chain(page).chain(select_pictures(names, pictures));
    names.map(|name| folder.path().join(name).display().to_string()).collect()
}

/// Replaces the PNG and SVG files in a list of files by the formats of the options.
fn select_pictures(names: &[impl AsRef<str>], pictures: &PictureOptions) -> Vec<String> {
    let is_listed =
        |stem: &str| names.iter().any(|own| own.as_ref().strip_suffix(".svg") == Some(stem));
    let select = |name: &str| match name.strip_suffix(".png").filter(|stem| is_listed(stem)) {
        Some(stem) => pictures.file_names(stem).collect(),
        None if name.ends_with(".svg") => Vec::new(),
        None => vec![name.to_owned()],
    };
    names.iter().flat_map(|name| select(name.as_ref())).collect()
}

/// Estimated cost of a verb, for dry runs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CostEstimate {
    /// Wall time, s, or for runs the time of one thread; `None` if unknown.
    pub(super) seconds: Option<f64>,
    /// Peak memory, bytes; `None` if unknown.
    pub(super) memory_bytes: Option<f64>,
    /// Whether the description of the work states time and memory.
    pub(super) is_in_plan: bool,
}

impl CostEstimate {
    /// Creates the estimate of a wall time, s.
    pub(super) fn from_seconds(seconds: f64) -> Self {
        Self { seconds: Some(seconds), ..Self::default() }
    }
}

/// Prints the plan of a verb: a description of its work, such as "assess 12 states", its estimated time, and the files
/// that it would write.
pub(super) fn print_plan(
    plan: &str,
    paths: &[String],
    estimate: CostEstimate,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let CostEstimate { seconds, memory_bytes, is_in_plan } = estimate;
    match format {
        OutputFormat::Json => {
            let plan = json!({
                "schema": SCHEMA_VERSION,
                "would": plan,
                "would_write": paths,
                "seconds": seconds,
                "memory_bytes": memory_bytes,
            });
            writeln!(stdout, "{plan:#}")?;
        }
        OutputFormat::Text => {
            writeln!(stdout, "would {plan}")?;
            if let Some(seconds) = seconds.filter(|_| !is_in_plan) {
                writeln!(stdout, "would take about {}", DisplayTime(seconds))?;
            }
            if let Some(memory) = memory_bytes.filter(|_| !is_in_plan) {
                writeln!(stdout, "would need {} of memory", Bytes(memory))?;
            }
            for path in paths {
                writeln!(stdout, "would write {path}")?;
            }
        }
    }
    Ok(())
}
