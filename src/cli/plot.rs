//! `wellposed plot`: redraws the pictures of a finished run from its result files.

use super::run::{ANIMATION, Animation, animation, records};
use crate::case::InTime;
use crate::cli::Error;
use crate::cli::folder::{AppendedFile, OutputError, ResultFolder, SNAPSHOTS, is_snapshot};
use crate::report;
use std::io::Write;
use std::path::Path;

/// Archive of the final fields.
const ARCHIVE: &str = "fields.npz";

/// Runs `plot`.
///
/// # Errors
/// The folder holds no finished run, or a result file cannot be read or written.
pub fn plot(path: &Path, stdout: &mut dyn Write) -> Result<(), Error> {
    let (folder, case) = ResultFolder::finished(path)?;
    folder.check_files(|name| {
        let is_table = [AppendedFile::Receivers, AppendedFile::Ledger, AppendedFile::Spectrum];
        is_snapshot(name)
            || [ARCHIVE, SNAPSHOTS].contains(&name)
            || is_table.iter().any(|table| table.name() == name)
    })?;
    let archive = folder.path().join(ARCHIVE);
    let bytes =
        files::read_regular(&archive).map_err(|error| OutputError::unreadable(&archive, &error))?;
    let cells = match case.in_time()? {
        InTime::Solid(own) => own.grid.count(),
        InTime::Flow(own) => own.grid.count(),
    };
    let fields = report::run::read_fields(&bytes, cells)
        .map_err(|error| OutputError::unusable(&archive, error))?;
    let pictures = report::run::pictures(&case, &fields, &records(&case, &folder)?)?;
    let mut publication = folder.redrawing();
    report::draw(&pictures, |name, bytes| publication.put(name, bytes).map_err(Error::from))?;
    match animation(&case, &folder)? {
        Animation::None => {}
        Animation::Empty => publication.remove(ANIMATION),
        Animation::Drawn(bytes) => publication.put(ANIMATION, &bytes)?,
    }
    publication.publish()?;
    writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
    Ok(())
}
