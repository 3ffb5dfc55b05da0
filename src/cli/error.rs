//! Errors of the verbs, and the exit code and JSON object of each.

use super::folder::OutputError;
use crate::case::{CaseError, SourcePosition, YieldSetError};
use crate::report::SCHEMA_VERSION;
use crate::study::simulate::{IllPosedness, StopReport};
use dynamics::decomposition::ThreadStartError;
use serde_json::{Value, json};

/// Exit code of an interrupted program.
pub(super) const INTERRUPTED_CODE: u8 = 130;

/// Reason why a verb failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case is invalid, or the study failed.
    #[error(transparent)]
    Study(crate::Error),
    /// The model cannot be combined with a yield set.
    #[error(transparent)]
    Medium(#[from] YieldSetError),
    /// Results cannot be written or read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A simulation was stopped by its own state, such as a non-finite field.
    #[error(transparent)]
    Stopped(#[from] StopReport),
    /// The equations of the flow are ill-posed, and `--accept-ill-posed` was not given.
    #[error("{0}; --accept-ill-posed runs it all the same")]
    IllPosed(IllPosedness),
    /// Measurement and prediction disagree in a check.
    #[error("{failed} of {total} {noun} disagree")]
    Disagreement {
        /// Number of rows or cases that disagree.
        failed: usize,
        /// Total number of rows or cases.
        total: usize,
        /// Noun of the message: rows or cases.
        noun: &'static str,
    },
    /// The folder to be checked contains no case file.
    #[error(
        "{folder}: no case file (*.toml) in the folder or below; name a case file, or a folder that holds some"
    )]
    NoCases {
        /// Path of the folder.
        folder: String,
    },
    /// Result files differ from their checksums, are missing or have no checksum.
    #[error("{folder}: {damaged} damaged or missing {}", if *.damaged == 1 { "file" } else { "files" })]
    Damaged {
        /// Number of files that are damaged, missing or without checksum.
        damaged: usize,
        /// Results folder.
        folder: String,
    },
    /// A signal interrupted a run, which can be resumed.
    #[error("interrupted at {time} s; wellposed resume {folder} goes on")]
    Interrupted {
        /// Simulated time reached, s.
        time: String,
        /// Results folder.
        folder: String,
    },
    /// A signal interrupted a run during the replay, which repeats the steps after the last checkpoint to find the last
    /// valid state before a fault.
    #[error(
        "interrupted after a fault, while steps were made again up to it; wellposed resume {folder} goes on from the last checkpoint"
    )]
    InterruptedReplay {
        /// Results folder.
        folder: String,
    },
    /// Threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
    /// The threads of a time step could not be started. Output and the last checkpoint are complete.
    #[error(
        "{error}; wellposed resume {folder} goes on from the last checkpoint, or from the start without one"
    )]
    StepThreads {
        /// Reason.
        error: ThreadStartError,
        /// Results folder.
        folder: String,
    },
    /// Standard output cannot be written.
    #[error("standard output: {0}")]
    Stdout(#[from] std::io::Error),
}

impl Error {
    /// Returns the program's exit code: 0 if standard output is a pipe that its reader has closed, 1 if a check
    /// disagreed or files are damaged, 3 if a run was stopped by its own state, 130 if it was interrupted, otherwise 2.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stdout(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Disagreement { .. } | Self::Damaged { .. } => 1,
            Self::Stopped(_) => 3,
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } => INTERRUPTED_CODE,
            _ => 2,
        }
    }
}

impl Error {
    /// Converts the error of a run in `folder`, which can be resumed if threads could not be started.
    pub(super) fn from_run_error(error: crate::Error, folder: &str) -> Self {
        match error {
            crate::Error::Threads(error) => Self::StepThreads { error, folder: folder.to_owned() },
            other => other.into(),
        }
    }

    /// Converts the error to a JSON object: kind, printed message and exit code; for errors of cases and files also the
    /// place, the value or fault found, and the values allowed or the remedy. A key that does not apply is `null`.
    pub fn to_json(&self) -> Value {
        let mut all = create_error_object(self.kind(), &self.to_string(), self.exit_code().into());
        match self {
            Self::Study(crate::Error::Case(error)) => add_case_place(&mut all, error),
            Self::Output(OutputError { path, cause, remedy }) => {
                all["file"] = path.display().to_string().into();
                all["found"] = cause.as_str().into();
                all["allowed"] = (*remedy).into();
            }
            _ => {}
        }
        all
    }

    /// Returns the value of `kind` in the JSON object, one word.
    fn kind(&self) -> &'static str {
        match self {
            Self::Study(crate::Error::Case(_)) | Self::Medium(_) => "case",
            Self::Study(crate::Error::Memory { .. }) => "memory",
            Self::Study(crate::Error::IllPosed(_)) | Self::IllPosed(_) => "ill-posed",
            Self::Output(_) => "output",
            Self::Stopped(_) => "stopped",
            Self::Disagreement { .. } => "disagreement",
            Self::Damaged { .. } => "damage",
            Self::NoCases { .. } => "usage",
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } => "interrupted",
            Self::Threads(_) | Self::StepThreads { .. } | Self::Study(crate::Error::Threads(_)) => {
                "threads"
            }
            Self::Study(_) => "result",
            Self::Stdout(_) => "stdout",
        }
    }

    /// Converts a command-line error with this message to the JSON object of [`Self::to_json`].
    pub fn usage_to_json(message: &str) -> Value {
        create_error_object("usage", message, 2)
    }
}

/// Creates the JSON object of an error, with `null` for the place.
fn create_error_object(kind: &str, message: &str, exit_code: i64) -> Value {
    json!({
        "schema": SCHEMA_VERSION,
        "kind": kind,
        "message": message,
        "exit_code": exit_code,
        "file": null,
        "line": null,
        "option": null,
        "key": null,
        "found": null,
        "allowed": null,
    })
}

/// Adds the place, the value found and the values allowed of a case error.
fn add_case_place(all: &mut Value, error: &CaseError) {
    let place = match error {
        CaseError::Unreadable { path, cause } => {
            all["file"] = path.display().to_string().into();
            all["found"] = cause.as_str().into();
            all["allowed"] = "a case file".into();
            return;
        }
        CaseError::Syntax { place, cause } => {
            all["found"] = cause.as_str().into();
            place
        }
        CaseError::Key { place, key, found, allowed } => {
            all["key"] = key.as_str().into();
            all["found"] = found.as_str().into();
            all["allowed"] = allowed.as_str().into();
            place
        }
    };
    match place {
        SourcePosition::Line { file, line } => {
            all["file"] = file.as_str().into();
            all["line"] = (*line).into();
        }
        SourcePosition::File(file) => all["file"] = file.as_str().into(),
        SourcePosition::Option(text) => all["option"] = text.as_str().into(),
    }
}

/// Unwraps an error of this type from [`crate::Error::Recorder`].
impl From<crate::Error> for Error {
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Recorder(own) => match own.downcast::<Self>() {
                Ok(own) => *own,
                Err(other) => Self::Study(crate::Error::Recorder(other)),
            },
            error => Self::Study(error),
        }
    }
}

/// Wraps an error for return by a recorder, which ends the run.
impl From<Error> for crate::Error {
    fn from(error: Error) -> Self {
        match error {
            Error::Study(error) => error,
            error => Self::Recorder(Box::new(error)),
        }
    }
}

impl From<CaseError> for Error {
    fn from(error: CaseError) -> Self {
        Self::Study(error.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies exit code, kind and message of an error of threads within a run.
    #[test]
    fn threads_of_a_step_that_do_not_start_exit_with_2() {
        let cause = "Resource temporarily unavailable".to_owned();
        let error = Error::from_run_error(ThreadStartError { cause }.into(), "out/case");
        assert_eq!(error.exit_code(), 2);
        assert_eq!(error.to_json()["kind"], "threads");
        let message = error.to_string();
        for part in ["cannot start the threads", "unavailable", "wellposed resume out/case"] {
            assert!(message.contains(part), "{message}");
        }
        let other = Error::from_run_error(crate::Error::Cancelled, "out/case");
        assert!(matches!(other, Error::Study(crate::Error::Cancelled)), "{other}");
    }
}
