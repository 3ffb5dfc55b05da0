//! `wellposed verify`: compares result files with their checksums and checks certificates.

use super::folder::{CASE_FILE, OutputError, VerificationResult, verify_folder};
use super::{CommandError, OutputFormat};
use crate::case::Case;
use crate::report::SCHEMA_VERSION;
use crate::report::format::format_count;
use crate::report::point::CERTIFICATE_FILE;
use crate::study;
use certificates::{Certificate, Verification};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// Runs the verb `verify`: compares the files of a results folder with their checksums, checks the proof of a certificate
/// in it, and prints the result. The path may also be that of a certificate.
///
/// # Errors
/// Files are damaged, the certificate proves nothing, is not about the case of the folder or cannot be read, or the folder
/// holds no results.
pub fn verify(
    path: &Path,
    format: OutputFormat,
    stdout: &mut dyn Write,
) -> Result<(), CommandError> {
    if path.is_file() {
        let proof = Proof::check(path)?;
        return match format {
            OutputFormat::Json => {
                let report = json!({ "schema": SCHEMA_VERSION, "certificate": proof.to_json() });
                Ok(writeln!(stdout, "{report:#}")?)
            }
            OutputFormat::Text => Ok(writeln!(stdout, "{}", proof.to_text())?),
        };
    }
    let VerificationResult { file_count, is_unfinished, damaged_files: damaged } =
        verify_folder(path)?;
    let file = path.join(CERTIFICATE_FILE);
    let proof = match damaged.is_empty() && file.is_file() {
        true => Some(Proof::check_in_folder(path)?),
        false => None,
    };
    match format {
        OutputFormat::Json => {
            let all: Vec<_> = damaged
                .iter()
                .map(|own| json!({ "file": own.file_name, "found": own.description }))
                .collect();
            let mut report = json!({
                "schema": SCHEMA_VERSION,
                "sound": damaged.is_empty(),
                "unfinished": is_unfinished,
                "files": file_count,
                "damaged": all,
            });
            if let Some(proof) = proof {
                report["certificate"] = proof.to_json();
            }
            writeln!(stdout, "{report:#}")?;
        }
        OutputFormat::Text => {
            for own in &damaged {
                writeln!(stdout, "{}: {}", own.file_name, own.description)?;
            }
            if damaged.is_empty() {
                let run = match is_unfinished {
                    true => "; the run is not finished: sound up to its last checkpoint",
                    false => "",
                };
                writeln!(stdout, "{file_count} files are as they were written{run}")?;
            }
            if let Some(proof) = proof {
                writeln!(stdout, "{}", proof.to_text())?;
            }
        }
    }
    match damaged.len() {
        0 => Ok(()),
        count => Err(CommandError::DamagedFiles {
            damaged_count: count,
            folder: path.display().to_string(),
        }),
    }
}

/// A verified certificate.
struct Proof {
    file_name: String,
    certificate: Certificate,
    found: Verification,
}

impl Proof {
    fn check(path: &Path) -> Result<Self, CommandError> {
        let bytes = files::read_regular_file(path)
            .map_err(|error| OutputError::from_read_error(path, &error))?;
        let certificate: Certificate = serde_json::from_slice(&bytes).map_err(|error| {
            OutputError {
                path: path.to_owned(),
                cause: format!("not a certificate: {error}"),
                remedy: "name a results folder, or a file that wellposed point --certified has written",
            }
        })?;
        let found = certificate.verify().map_err(|cause| CommandError::FalseCertificate {
            path: path.display().to_string(),
            cause,
        })?;
        let file_name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { file_name, certificate, found })
    }

    /// Checks the certificate of a results folder, which must be about its case.
    fn check_in_folder(folder: &Path) -> Result<Self, CommandError> {
        let path = folder.join(CERTIFICATE_FILE);
        let own = Self::check(&path)?;
        let case = Case::load(&folder.join(CASE_FILE), &[]).map_err(crate::Error::from)?;
        if !study::is_certificate_of(&case, &own.certificate)? {
            return Err(OutputError {
                path,
                cause: "not about the case of this folder".to_owned(),
                remedy: "name the file itself to check it alone",
            }
            .into());
        }
        Ok(own)
    }

    fn to_text(&self) -> String {
        let parts = format_count(self.found.part_count, "part");
        format!("{}: verified ({parts}): {}", self.file_name, self.certificate.describe())
    }

    fn to_json(&self) -> Value {
        json!({ "verified": self.certificate.describe(), "parts": self.found.part_count })
    }
}
