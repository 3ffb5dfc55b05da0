//! Origin of the results in a folder: the program version and the case that produced them.

use super::names::{CASE_FILE, PROGRAM_FILE, is_result_file_name, is_transient_name};
use super::{OutputError, list_file_names};
use files::read_regular_file;
use serde_json::Value;
use std::io::ErrorKind;
use std::path::Path;

/// Serialises the content of [`PROGRAM_FILE`] as JSON; `without_plot_options` is the TOML text of the case without its
/// plot options.
pub(super) fn serialise_program_file(without_plot_options: &str) -> Vec<u8> {
    format!("{:#}\n", describe_program(without_plot_options)).into_bytes()
}

/// Creates the content of [`PROGRAM_FILE`]: name, version and commit of the program, and the checksum of the case.
pub(super) fn describe_program(without_plot_options: &str) -> Value {
    serde_json::json!({
        "name": env!("CARGO_PKG_NAME"),
        "version": env!("CARGO_PKG_VERSION"),
        "commit": env!("WELLPOSED_COMMIT"),
        "case": format!("{:08x}", files::checksum(without_plot_options.as_bytes())),
    })
}

/// Comparison of the program version and case that produced the results in a folder with this program and a case.
pub(super) struct ResultOrigin {
    /// Whether this version and commit of the program produced the results.
    pub(super) is_same_version: bool,
    /// Whether the results are those of this case, apart from plot options.
    pub(super) is_same_case: bool,
}

impl ResultOrigin {
    /// Compares [`PROGRAM_FILE`] of the folder with this program and case; an absent file matches neither.
    pub(super) fn from_folder(
        folder: &Path,
        without_plot_options: &str,
    ) -> Result<Self, OutputError> {
        let path = folder.join(PROGRAM_FILE);
        let bytes = match read_regular_file(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            bytes => bytes.map_err(|error| OutputError::from_read_error(&path, &error))?,
        };
        let found: Value = serde_json::from_slice(&bytes).unwrap_or_default();
        let own = describe_program(without_plot_options);
        let is_same = |key: &str| found[key] == own[key];
        let is_same_version = ["name", "version", "commit"].into_iter().all(is_same);
        Ok(Self { is_same_version, is_same_case: is_same("case") })
    }
}

pub(super) fn has_equal_content(path: &Path, text: &str) -> bool {
    read_regular_file(path).is_ok_and(|bytes| bytes == text.as_bytes())
}

/// Returns the reason why the content of the folder must not be overwritten without `--force`; `None` if it may.
pub(super) fn overwrite_refusal_reason(
    folder: &Path,
    case: &str,
    without_plot_options: &str,
) -> Result<Option<&'static str>, OutputError> {
    let mut names = list_file_names(folder)?;
    names.retain(|name| !is_transient_name(name));
    if names.is_empty() {
        return Ok(None);
    }
    if !has_equal_content(&folder.join(CASE_FILE), case) {
        return Ok(Some(match names.iter().any(|name| name == CASE_FILE) {
            true => "the folder holds results of another case or of other settings",
            false => "the folder holds other files",
        }));
    }
    // A run that was killed early may have written only the case file, without results.
    let has_origin = names.iter().any(|name| name == PROGRAM_FILE || is_result_file_name(name));
    let origin = ResultOrigin::from_folder(folder, without_plot_options)?;
    Ok(match has_origin {
        true if !origin.is_same_version => {
            Some("the folder holds results of another version of this program")
        }
        true if !origin.is_same_case => {
            Some("the folder holds results of another case than its case.toml")
        }
        _ => None,
    })
}
