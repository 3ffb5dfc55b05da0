//! `wellposed homogenise`: writes the case of the equivalent Cosserat continuum of a blocky medium.

use super::load::load_case;
use super::new::check_new_file;
use super::write::{CostEstimate, print_plan};
use super::{CommandError, Options, OutputFormat};
use crate::case::ContinuumOptions;
use crate::cli::folder::{OutputError, create_folder, write_file};
use crate::report::{self, Report};
use crate::study;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Runs the verb `homogenise`: writes the case of the equivalent continuum of a blocky medium.
/// [`Options::output_folder`] is the path of the file to write; if it is a folder or ends with a slash, the file is
/// written to that folder. By default the file is `<case name>-continuum.toml`.
///
/// # Errors
/// The case has no equivalent continuum, the file exists and `force` is not set, or it cannot be written.
pub fn run_homogenise(
    options: &Options,
    continuum: &ContinuumOptions,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    let case = load_case(options)?;
    let start = Instant::now();
    let mut found = study::homogenise(&case, continuum)?;
    let path = output_path(options.output_folder.as_deref(), &found.continuum_case.case.name);
    check_new_file(&path, options.force)?;
    let name = path.display().to_string();
    if options.is_dry_run {
        let plan = "homogenise the blocky medium";
        let estimate = CostEstimate::from_seconds(start.elapsed().as_secs_f64());
        return print_plan(plan, &[name], estimate, options.format, stdout);
    }
    write_in_new_folder(&path, found.continuum_case.toml.as_bytes())?;
    found.written_path = Some(name.clone());
    match options.format {
        OutputFormat::Json => writeln!(stdout, "{:#}", report::to_json(&found)?)?,
        OutputFormat::Text => {
            stdout.write_all(found.to_text(&case).as_bytes())?;
            writeln!(stdout, "case: {name}")?;
        }
    }
    Ok(())
}

/// Writes a file into a folder that is created if necessary. If the file cannot be written, no created folder is left.
fn write_in_new_folder(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let created: Vec<&Path> =
        folder.iter().flat_map(|own| own.ancestors()).take_while(|own| !own.exists()).collect();
    let written = folder.map_or(Ok(()), create_folder).and_then(|()| write_file(path, bytes));
    if written.is_err() {
        for own in created {
            // Only empty folders are removed.
            let _ = std::fs::remove_dir(own);
        }
    }
    written
}

/// Returns the path of the file to write, from the value of the option `--out` and the name of the case.
fn output_path(out: Option<&Path>, name: &str) -> PathBuf {
    let file = format!("{name}.toml");
    match out {
        None => file.into(),
        Some(out) if out.is_dir() || out.to_string_lossy().ends_with('/') => out.join(file),
        Some(out) => out.to_owned(),
    }
}
