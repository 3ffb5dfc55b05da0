//! Why a verb was not carried out, and the exit code that says so.

use super::folder::OutputError;
use crate::case::{CaseError, NoSuchMedium, Place};
use crate::report::SCHEMA;
use crate::study::simulate::{IllPosed, Stopped};
use serde_json::{Value, json};

/// The program's exit code where it was interrupted.
pub(super) const INTERRUPTED_CODE: u8 = 130;

/// Why a verb was not carried out.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The case is wrong, or the question about it has no answer.
    #[error(transparent)]
    Study(crate::Error),
    /// A model that cannot have a yield set.
    #[error(transparent)]
    Medium(#[from] NoSuchMedium),
    /// Results cannot be written or read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A run ended by its own state.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A flow that is not to be run in time unasked.
    #[error("{0}; --accept-ill-posed runs it all the same")]
    IllPosed(IllPosed),
    /// What was measured is not what was predicted.
    #[error("{failed} of {all} {what} disagree")]
    Disagrees {
        /// How many do not agree.
        failed: usize,
        /// Of how many.
        all: usize,
        /// Rows or cases.
        what: &'static str,
    },
    /// A folder to be checked has no case in it.
    #[error(
        "{folder}: no case file (*.toml) in the folder or below; name a case file, or a folder that holds some"
    )]
    NoCases {
        /// The folder.
        folder: String,
    },
    /// Files of results are not as they were written.
    #[error("{folder}: {damaged} damaged or missing {}", if *.damaged == 1 { "file" } else { "files" })]
    Damaged {
        /// How many.
        damaged: usize,
        /// The folder of results.
        folder: String,
    },
    /// Somebody ended a run, which may go on.
    #[error("interrupted at {time} s; wellposed resume {folder} goes on")]
    Interrupted {
        /// The time that it had come to, s.
        time: String,
        /// The folder of its results.
        folder: String,
    },
    /// Somebody ended a run while it made steps again to find the last sound state before a fault.
    #[error(
        "interrupted after a fault, while steps were made again up to it; wellposed resume {folder} goes on from the last checkpoint"
    )]
    InterruptedReplay {
        /// The folder of its results.
        folder: String,
    },
    /// Threads could not be started.
    #[error("cannot start the threads: {0}")]
    Threads(String),
    /// Standard output does not take what is printed.
    #[error("standard output: {0}")]
    Stdout(#[from] std::io::Error),
}

impl Error {
    /// The program's exit code: 2, but 0 where the reader of a pipe had enough, 1 where a check disagreed or files are damaged, 3 where a run was stopped
    /// by its own state, 130 where it was interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stdout(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Disagrees { .. } | Self::Damaged { .. } => 1,
            Self::Stopped(_) => 3,
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } => INTERRUPTED_CODE,
            _ => 2,
        }
    }
}

impl Error {
    /// The error as a JSON object for programs: its kind, the printed message and the exit code; for errors of cases and
    /// files also the place, what was found and what is allowed. A key that does not apply is `null`.
    pub fn to_json(&self) -> Value {
        let mut all = error_object(self.kind(), &self.to_string(), self.exit_code().into());
        match self {
            Self::Study(crate::Error::Case(error)) => add_case(&mut all, error),
            Self::Output(OutputError { path, cause, remedy }) => {
                all["file"] = path.display().to_string().into();
                all["found"] = cause.as_str().into();
                all["allowed"] = (*remedy).into();
            }
            _ => {}
        }
        all
    }

    /// One word for each kind of error.
    fn kind(&self) -> &'static str {
        match self {
            Self::Study(crate::Error::Case(_)) | Self::Medium(_) => "case",
            Self::Study(crate::Error::Memory { .. }) => "memory",
            Self::Study(crate::Error::IllPosed(_)) | Self::IllPosed(_) => "ill-posed",
            Self::Study(_) => "result",
            Self::Output(_) => "output",
            Self::Stopped(_) => "stopped",
            Self::Disagrees { .. } => "disagreement",
            Self::Damaged { .. } => "damage",
            Self::NoCases { .. } => "usage",
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } => "interrupted",
            Self::Threads(_) => "threads",
            Self::Stdout(_) => "stdout",
        }
    }

    /// The same object for a wrong command line, which is refused in these words.
    pub fn usage_to_json(message: &str) -> Value {
        error_object("usage", message, 2)
    }
}

/// An error as a JSON object without a place.
fn error_object(kind: &str, message: &str, exit_code: i64) -> Value {
    json!({
        "schema": SCHEMA,
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

/// Where and what is wrong with a case.
fn add_case(all: &mut Value, error: &CaseError) {
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
        Place::Line { file, line } => {
            all["file"] = file.as_str().into();
            all["line"] = (*line).into();
        }
        Place::File(file) => all["file"] = file.as_str().into(),
        Place::Option(text) => all["option"] = text.as_str().into(),
    }
}

/// What the recorder of a run had to say is an error of the verb again.
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

/// A recorder ends the run.
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
