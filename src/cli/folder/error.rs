//! Why results cannot be written or read.

use files::append::{AppendError, AppendProblem};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Results cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {cause}; {remedy}", .path.display())]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// Why not.
    pub cause: String,
    /// What to do about it.
    pub remedy: &'static str,
}

impl OutputError {
    /// Something that cannot be written.
    pub fn new(path: &Path, cause: impl ToString) -> Self {
        Self {
            path: path.to_owned(),
            cause: cause.to_string(),
            remedy: "name a place that can be written to",
        }
    }

    /// A result that the operating system does not hand out.
    pub fn unreadable(path: &Path, error: &std::io::Error) -> Self {
        match error.kind() {
            ErrorKind::NotFound => Self::unusable(path, "is missing"),
            _ => Self { path: path.to_owned(), cause: error.to_string(), remedy: "let it be read" },
        }
    }

    /// A result that is not what was written.
    pub fn unusable(path: &Path, cause: impl ToString) -> Self {
        let remedy = "run the case again with --force";
        Self { path: path.to_owned(), cause: cause.to_string(), remedy }
    }

    /// A table that cannot be appended to.
    pub fn of_table(error: AppendError) -> Self {
        match error.problem {
            AppendProblem::Refused { ref source, .. } if source.kind() != ErrorKind::NotFound => {
                Self::new(&error.path, error.problem)
            }
            problem => Self::unusable(&error.path, problem),
        }
    }
}
