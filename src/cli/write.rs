//! Output of reports to results folders and standard output.

use super::folder::ResultFolder;
use super::{Error, OutputFormat};
use crate::case::Case;
use crate::report::{RenderedReport, Report, SCHEMA_VERSION};
use serde_json::json;
use std::io::Write;

/// Writes all files of a report to the results folder, and its text or JSON to standard output.
///
/// # Errors
/// A file cannot be rendered or written.
pub(super) fn write_report<R: Report>(
    report: &R,
    case: &Case,
    folder: &ResultFolder,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let rendered = RenderedReport::new(report, case)?;
    let mut publication = folder.start_publication();
    rendered.write_files(|name, bytes| publication.stage_file(name, bytes).map_err(Error::from))?;
    publication.publish()?;
    print_report(&rendered, folder, format, stdout)
}

/// Prints the text or JSON report; the text ends with the path of the first picture, or of the folder if the report
/// [does not end with a picture](Report::ENDS_WITH_PICTURE) or has none.
///
/// # Errors
/// Standard output cannot be written.
pub(super) fn print_report(
    rendered: &RenderedReport,
    folder: &ResultFolder,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    match format {
        OutputFormat::Json => stdout.write_all(rendered.json().as_bytes())?,
        OutputFormat::Text => {
            stdout.write_all(rendered.text().as_bytes())?;
            match rendered.first_picture_name() {
                Some(name) => {
                    writeln!(stdout, "picture: {}", folder.path().join(name).display())?;
                }
                None => writeln!(stdout, "results: {}", folder.path().display())?,
            }
        }
    }
    Ok(())
}

/// Returns the paths of the files that a verb would write: the common files and `names`.
pub(super) fn planned_paths(folder: &ResultFolder, names: &[impl AsRef<str>]) -> Vec<String> {
    let names = ResultFolder::COMMON_FILES.into_iter().chain(names.iter().map(AsRef::as_ref));
    names.map(|name| folder.path().join(name).display().to_string()).collect()
}

/// Prints a description of the work of a verb, such as "assess 12 states", and the files that the verb would write.
pub(super) fn print_plan(
    plan: &str,
    paths: &[String],
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    match format {
        OutputFormat::Json => {
            let plan = json!({ "schema": SCHEMA_VERSION, "would": plan, "would_write": paths });
            writeln!(stdout, "{plan:#}")?;
        }
        OutputFormat::Text => {
            writeln!(stdout, "would {plan}")?;
            for path in paths {
                writeln!(stdout, "would write {path}")?;
            }
        }
    }
    Ok(())
}
