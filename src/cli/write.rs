//! Reports into folders of results and to standard output.

use super::folder::ResultFolder;
use super::{Error, Format};
use crate::case::Case;
use crate::report::{Rendered, Report};
use std::io::Write;

/// Writes all files of a report into the folder of results, and the text or the JSON report to standard output.
///
/// # Errors
/// Something cannot be made or written.
pub(super) fn write<R: Report>(
    report: &R,
    case: &Case,
    folder: &ResultFolder,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let rendered = Rendered::new(report, case)?;
    let mut publication = folder.publication();
    rendered.write(|name, bytes| publication.put(name, bytes).map_err(Error::from))?;
    publication.publish()?;
    print(&rendered, folder, format, stdout)
}

/// Prints the text or the JSON report, and where the results are.
///
/// # Errors
/// Standard output does not take it.
pub(super) fn print(
    rendered: &Rendered,
    folder: &ResultFolder,
    format: Format,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    match format {
        Format::Json => stdout.write_all(rendered.json().as_bytes())?,
        Format::Text => {
            stdout.write_all(rendered.text().as_bytes())?;
            match rendered.shown_picture() {
                Some(name) => {
                    writeln!(stdout, "picture: {}", folder.path().join(name).display())?;
                }
                None => writeln!(stdout, "results: {}", folder.path().display())?,
            }
        }
    }
    Ok(())
}

/// Says which files would be written: these, and those of every folder of results.
pub(super) fn would_write(
    folder: &ResultFolder,
    names: &[impl AsRef<str>],
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    for name in ResultFolder::ALWAYS.into_iter().chain(names.iter().map(AsRef::as_ref)) {
        writeln!(stdout, "would write {}", folder.path().join(name).display())?;
    }
    Ok(())
}
