//! Why a verb was not carried out, and the exit code that says so.

use super::folder::OutputError;
use crate::case::{CaseError, NoSuchMedium};
use crate::study::simulate::{IllPosed, Stopped};

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
    /// Somebody ended a run, which may go on.
    #[error("interrupted at {time} s; wellposed resume {folder} goes on")]
    Interrupted {
        /// The time that it had come to, s.
        time: String,
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
    /// The program's exit code: 2, but 0 where the reader of a pipe had enough, 1 where a check disagreed, 3 where a run was stopped
    /// by its own state, 130 where it was interrupted.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stdout(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Disagrees { .. } => 1,
            Self::Stopped(_) => 3,
            Self::Interrupted { .. } => INTERRUPTED_CODE,
            _ => 2,
        }
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
