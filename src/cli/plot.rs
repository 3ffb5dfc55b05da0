//! `wellposed plot`: redraws the pictures of a finished run from its result files.

use super::load::print_hints;
use super::run::{ANIMATION_FILE, AnimationOutput, draw_animation, read_records};
use crate::case::TimeDomainRun;
use crate::cli::CommandError;
use crate::cli::folder::{
    AppendedFile, JOINT_ARCHIVE_FILE, OutputError, ResultFolder, SNAPSHOT_LIST_FILE,
    has_joint_files, is_snapshot_name,
};
use crate::report;
use std::io::Write;
use std::path::Path;

/// File name of the archive of the final fields.
const FIELDS_ARCHIVE_FILE: &str = "fields.npz";

/// Runs the verb `plot`: redraws the pictures of a finished run.
///
/// # Errors
/// The folder holds no finished run, its case was changed in more than the plot options, or a result file is damaged or
/// cannot be read or written.
pub fn plot(path: &Path, stdout: &mut dyn Write) -> Result<(), CommandError> {
    let (folder, case) = ResultFolder::open_finished_run(path)?;
    print_hints(&case);
    folder.check_files(|name| {
        let is_table = [AppendedFile::Receivers, AppendedFile::Ledger, AppendedFile::Spectrum];
        is_snapshot_name(name)
            || [FIELDS_ARCHIVE_FILE, JOINT_ARCHIVE_FILE, SNAPSHOT_LIST_FILE].contains(&name)
            || is_table.iter().any(|table| table.name() == name)
    })?;
    let archive = folder.path().join(FIELDS_ARCHIVE_FILE);
    let bytes = files::read_regular_file(&archive)
        .map_err(|error| OutputError::from_read_error(&archive, &error))?;
    let cells = match case.time_domain_run()? {
        TimeDomainRun::Solid(own) => own.grid.cell_count(),
        TimeDomainRun::Flow(own) => own.grid.point_count(),
    };
    let mut fields = report::run::read_fields(&bytes, cells)
        .map_err(|error| OutputError::from_invalid_content(&archive, error))?;
    if let Some(own) = case.solid_run.as_ref().filter(|_| has_joint_files(&case)) {
        let archive = folder.path().join(JOINT_ARCHIVE_FILE);
        let bytes = files::read_regular_file(&archive)
            .map_err(|error| OutputError::from_read_error(&archive, &error))?;
        fields.joint_faces = report::run::read_joints(&bytes, &own.grid)
            .map_err(|error| OutputError::from_invalid_content(&archive, error))?;
    }
    let pictures = report::run::create_pictures(&case, &fields, &read_records(&case, &folder)?)?;
    let mut publication = folder.start_redrawing();
    report::draw_pictures(&pictures, |name, bytes| {
        publication.stage_file(name, bytes).map_err(CommandError::from)
    })?;
    match draw_animation(&case, &folder)? {
        AnimationOutput::NoAnimation => {}
        AnimationOutput::AllZero => publication.schedule_removal(ANIMATION_FILE),
        AnimationOutput::Gif(bytes) => publication.stage_file(ANIMATION_FILE, &bytes)?,
    }
    publication.publish()?;
    writeln!(stdout, "picture: {}", folder.path().join("run.png").display())?;
    Ok(())
}
