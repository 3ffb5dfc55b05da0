//! `wellposed new`: writes a commented case template, and the schema of case files for editors.

use crate::case::{MediumKind, ModelKind, generate_json_schema};
use crate::cli::folder::{OutputError, write_file};
use crate::cli::{CommandError, UsageError};
use models::registry;
use std::path::{Path, PathBuf};

pub use crate::case::template::{TemplateKind, generate_state_template, generate_template};

/// Name of the file of the JSON Schema beside case files, which their first line names for editors.
pub const SCHEMA_FILE: &str = "wellposed.schema.json";

/// Returns the text of [`SCHEMA_FILE`], as `wellposed schema` prints it.
pub fn format_schema() -> String {
    format!("{:#}\n", generate_json_schema())
}

/// Writes a case template for `medium` and `purpose` to `file`, by default `<kind>.toml`, of plane waves
/// `granular.toml` or `porous.toml`, and [`SCHEMA_FILE`] beside it, or in place of one of another version; returns the path
/// of the template.
///
/// # Errors
/// The model has no template for `purpose`, the file exists and `force` is not set, the path exists and is not a regular
/// file, or the file cannot be written.
pub fn write_template(
    medium: MediumKind,
    purpose: TemplateKind,
    file: Option<&Path>,
    force: bool,
) -> Result<PathBuf, CommandError> {
    let path =
        file.map_or_else(|| format!("{}.toml", purpose.file_stem(medium)).into(), Path::to_owned);
    let usage_error = |argument: &str, found: String, allowed: &str| UsageError {
        argument: argument.to_owned(),
        found,
        allowed: allowed.to_owned(),
    };
    let name = medium.kind.name();
    let is_simulation = purpose == TemplateKind::Simulation;
    if is_simulation && !matches!(medium.kind, ModelKind::Flow(_) | ModelKind::Solid(_)) {
        let found = format!("{name} cannot be run in time");
        return Err(usage_error("--run", found, "leave --run out, or name another kind").into());
    }
    if is_simulation
        && matches!(medium.kind, ModelKind::Flow(_))
        && medium.kind.simulation_rotation().is_none()
    {
        let found = format!("{name} cannot be run in time: it leaves the spin undetermined");
        return Err(usage_error("--run", found, "leave --run out, or name another kind").into());
    }
    let is_plane_wave =
        matches!(purpose, TemplateKind::GranularPlaneWave | TemplateKind::PorousPlaneWave);
    if is_plane_wave && medium != MediumKind::from(ModelKind::Solid(registry::CLASSICAL)) {
        let found = format!("not for the medium '{}'", medium.title());
        return Err(usage_error(
            "--shocks",
            found,
            "wellposed shocks takes classical solids: name the kind classical, without --yield",
        )
        .into());
    }
    check_new_file(&path, force)?;
    let text = generate_template(medium, purpose);
    write_file(&path, format!("#:schema ./{SCHEMA_FILE}\n{text}").as_bytes())?;
    let (schema_path, schema) = (path.with_file_name(SCHEMA_FILE), format_schema());
    if !is_same_file(&schema_path, schema.as_bytes()) {
        check_new_file(&schema_path, true)?;
        write_file(&schema_path, schema.as_bytes())?;
    }
    Ok(path)
}

/// Whether a file exists and has this text.
pub(super) fn is_same_file(path: &Path, text: &[u8]) -> bool {
    std::fs::read(path).is_ok_and(|found| found == text)
}

/// Checks that a file may be written: that there is none of this path, or with `force` a regular file.
pub(super) fn check_new_file(path: &Path, force: bool) -> Result<(), OutputError> {
    let Ok(found) = path.symlink_metadata() else { return Ok(()) };
    let (cause, remedy) = match (force, found.is_file()) {
        (true, true) => return Ok(()),
        (false, _) => ("exists already", "name another file, or overwrite with --force"),
        (true, false) => ("not a regular file", "name another file: only files are overwritten"),
    };
    Err(OutputError { path: path.to_owned(), cause: cause.into(), remedy })
}
