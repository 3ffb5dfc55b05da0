//! Errors of writing and reading result files and folders.

use files::table_appender::{AppendError, AppendProblem};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Error of writing or reading a result file or folder.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {cause}; {remedy}", .path.display())]
pub struct OutputError {
    /// Path of the file or folder.
    pub path: PathBuf,
    /// Cause of the error.
    pub cause: String,
    /// Remedy that the message suggests.
    pub remedy: &'static str,
}

impl OutputError {
    /// Creates the error for a path that cannot be written.
    pub fn new(path: &Path, cause: impl ToString) -> Self {
        Self {
            path: path.to_owned(),
            cause: cause.to_string(),
            remedy: "name a folder that can be written to with --out DIR",
        }
    }

    /// Creates the error for a result file that the operating system cannot read.
    pub fn from_read_error(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::from_invalid_content(path, "is missing"),
            _ => {
                Self { path: path.to_owned(), cause: error.to_string(), remedy: "make it readable" }
            }
        }
    }

    /// Creates the error for a result file with invalid content.
    pub fn from_invalid_content(path: &Path, cause: impl ToString) -> Self {
        let remedy = "run the case again with --force";
        Self { path: path.to_owned(), cause: cause.to_string(), remedy }
    }

    /// Creates the error for a table to which rows cannot be appended. The remedy is a new run if the table is missing
    /// or has invalid content, otherwise another path.
    pub fn from_append_error(error: AppendError) -> Self {
        match error.problem {
            AppendProblem::Io { ref source, .. } if source.kind() != ErrorKind::NotFound => {
                Self::new(&error.path, error.problem)
            }
            problem => Self::from_invalid_content(&error.path, problem),
        }
    }
}
