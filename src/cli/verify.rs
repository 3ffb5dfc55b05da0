//! `wellposed verify`: compares result files with their checksums and checks certificates.

use super::folder::{OutputError, VerificationResult, verify_folder};
use super::{CommandError, OutputFormat};
use crate::report::SCHEMA_VERSION;
use crate::report::format::format_count;
use crate::report::point::CERTIFICATE_FILE;
use certificates::{Certificate, Verification};
use serde_json::{Value, json};
use std::io::Write;
use std::path::Path;

/// Runs the verb `verify`: compares the files of a results folder with their checksums, checks the proof of a certificate
/// in it, and prints the result. The path may also be that of a certificate.
///
/// # Errors
/// Files are damaged, the certificate proves nothing or cannot be read, or the folder holds no results.
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
        true => Some(Proof::check(&file)?),
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
        Ok(Self { certificate, found })
    }

    fn to_text(&self) -> String {
        let Verification { part_count, claim_count } = self.found;
        format!(
            "{CERTIFICATE_FILE}: verified in rational arithmetic ({}, {}): {}",
            format_count(part_count, "part"),
            format_count(claim_count, "enclosure"),
            self.certificate.describe()
        )
    }

    fn to_json(&self) -> Value {
        json!({
            "verified": self.certificate.describe(),
            "parts": self.found.part_count,
            "enclosures": self.found.claim_count,
        })
    }
}
