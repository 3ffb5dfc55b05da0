//! Section of a run in the report page.

use crate::case::Case;
use crate::cli::CommandError;
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder};
use crate::report;
use crate::report::page::{PagePicture, PageSection, PageTable};
use crate::study::simulate::{TableKind, column_unit, create_job};
use std::io::ErrorKind;

/// Name of the table of the final state of joints.
const JOINT_TABLE: &str = "joints.csv";

/// Creates the section of a run from its reports as text and JSON, its pictures, and the tables in its folder.
///
/// # Errors
/// A table cannot be read, or the case is not one of a run.
pub(in crate::cli) fn create_page_section(
    case: &Case,
    folder: &ResultFolder,
    [text, json]: &[impl AsRef<str>; 2],
    pictures: &[PagePicture],
) -> Result<PageSection, CommandError> {
    let mut tables = Vec::new();
    for kind in [TableKind::Ledger, TableKind::Spectrum, TableKind::Receivers] {
        let unit = |name: &str| column_unit(case, kind, name).to_owned();
        tables.extend(read_table(folder, AppendedFile::from(kind).name(), unit)?);
    }
    let unit = |name: &str| report::column_unit(JOINT_TABLE, name).unwrap_or_default().to_owned();
    tables.extend(read_table(folder, JOINT_TABLE, unit)?);
    let verdict = report::find_verdict(json.as_ref());
    let arguments = match create_job(case)?.find_ill_posedness()? {
        Some(_) => "case.toml --accept-ill-posed",
        None => "case.toml",
    };
    let words = (text.as_ref(), verdict.as_deref());
    Ok(PageSection::new("run", arguments, words, pictures, None, &tables))
}

/// Reads a table of the folder; `None` if the run has no such table.
fn read_table(
    folder: &ResultFolder,
    name: &str,
    unit: impl Fn(&str) -> String,
) -> Result<Option<PageTable>, OutputError> {
    let path = folder.path().join(name);
    let table = match files::open_regular_file(&path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        file => file.and_then(|file| PageTable::read(name, file, unit)),
    };
    table.map(Some).map_err(|error| OutputError::from_read_error(&path, &error))
}
