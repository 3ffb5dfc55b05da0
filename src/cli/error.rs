//! Errors of the command line verbs, with the exit code and the JSON object of each.

use super::folder::OutputError;
use super::ranks::RankError;
use crate::case::{CaseError, SourcePosition, YieldSetError};
use crate::report::SCHEMA_VERSION;
use crate::study::simulate::{IllPosedness, StopReport};
use certificates::VerificationError;
use dynamics::decomposition::ThreadStartError;
use serde_json::{Value, json};

/// Exit code of the program after an interrupt by a signal.
pub(super) const INTERRUPTED_CODE: u8 = 130;

/// Error of the arguments of the program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{argument}: {found}; {allowed}")]
pub struct UsageError {
    /// Argument or option, such as `--threads <N>`.
    pub argument: String,
    /// Description of the fault: the invalid value, or that the argument is unknown or missing.
    pub found: String,
    /// Values allowed, or the remedy.
    pub allowed: String,
}

/// Reason why a verb of the command line failed.
#[derive(Debug, thiserror::Error)]
pub enum CommandError {
    /// The case is invalid, or the study failed.
    #[error(transparent)]
    Study(crate::Error),
    /// The model cannot be combined with a yield set.
    #[error("--yield: {0}")]
    YieldSet(#[from] YieldSetError),
    /// Result files cannot be written or read.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A simulation was stopped because of its state, such as a non-finite field.
    #[error(transparent)]
    SimulationStopped(#[from] StopReport),
    /// The equations of the flow are ill-posed, and `--accept-ill-posed` was not given.
    #[error("{0}; --accept-ill-posed runs it all the same")]
    IllPosed(IllPosedness),
    /// Measured and predicted rates disagree in a check.
    #[error("{disagreeing_count} of {total_count} {noun} disagree")]
    Disagreement {
        /// Number of branches or cases that disagree.
        disagreeing_count: usize,
        /// Total number of checked branches or cases.
        total_count: usize,
        /// Noun of the message: `rows` or `cases`.
        noun: &'static str,
    },
    /// Cases of a checked folder cannot be read; the others were checked.
    #[error(
        "{unreadable_count} of {total_count} cases cannot be read: correct them, or name a folder without them"
    )]
    UnreadableCases {
        /// Number of cases that cannot be read.
        unreadable_count: usize,
        /// Total number of cases.
        total_count: usize,
    },
    /// The arguments of the program are invalid.
    #[error(transparent)]
    Usage(#[from] UsageError),
    /// No bundled case has this name.
    #[error("{name}: no bundled case; {suggestion}wellposed cases lists them")]
    NoBundledCase {
        /// Name that was asked for.
        name: String,
        /// Suggestion of a similar name, or empty.
        suggestion: String,
    },
    /// A signal interrupted a study before its results were written.
    #[error("interrupted before all results were written; run the command again")]
    InterruptedStudy,
    /// The folder to be checked contains no case file.
    #[error(
        "{folder}: no case file (*.toml) in the folder or below; name a case file, or a folder that holds some"
    )]
    NoCaseFiles {
        /// Path of the folder that contains no case file.
        folder: String,
    },
    /// Result files differ from their checksums, are missing or have no checksum.
    #[error("{folder}: {damaged_count} damaged or missing {}; write the folder anew by the command that made it, with --force", if *.damaged_count == 1 { "file" } else { "files" })]
    DamagedFiles {
        /// Number of files that are damaged, missing or without checksum.
        damaged_count: usize,
        /// Results folder.
        folder: String,
    },
    /// A certificate does not prove its verdict.
    #[error("{path}: the certificate proves nothing: {cause}")]
    FalseCertificate {
        /// Path of the certificate.
        path: String,
        /// What is wrong with it.
        cause: VerificationError,
    },
    /// A signal interrupted a run, which can be resumed.
    #[error("interrupted at {simulated_time} s; wellposed resume {folder} goes on")]
    Interrupted {
        /// Simulated time reached, s.
        simulated_time: String,
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
    /// The threads of the thread pool could not be started; contains the message of the operating system.
    #[error("cannot start the threads: {0}")]
    ThreadStart(String),
    /// The threads of a time step could not be started. Output and the last checkpoint are complete.
    #[error(
        "{cause}; wellposed resume {folder} goes on from the last checkpoint, or from the start without one"
    )]
    StepThreadStart {
        /// Reason why the threads could not be started.
        cause: ThreadStartError,
        /// Results folder.
        folder: String,
    },
    /// The program was started in several processes, and cannot work in them together.
    #[error(transparent)]
    Ranks(#[from] RankError),
    /// Standard output cannot be written.
    #[error("standard output: {0}")]
    Stdout(#[from] std::io::Error),
}

impl CommandError {
    /// Returns the program's exit code: 0 if standard output is a pipe that its reader has closed, 1 if a check
    /// disagreed, files are damaged or a certificate proves nothing, 3 if a run was stopped because of its state, 130 if it was interrupted,
    /// otherwise 2.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Stdout(error) if error.kind() == std::io::ErrorKind::BrokenPipe => 0,
            Self::Disagreement { .. }
            | Self::DamagedFiles { .. }
            | Self::FalseCertificate { .. } => 1,
            Self::SimulationStopped(_) => 3,
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } | Self::InterruptedStudy => {
                INTERRUPTED_CODE
            }
            Self::Ranks(RankError::Ended { exit_code }) => *exit_code,
            _ => 2,
        }
    }
}

impl CommandError {
    /// Converts the error of a run in the results folder `folder`. If threads could not be started, the error states
    /// that the run can be resumed.
    pub(super) fn from_run_error(error: crate::Error, folder: &str) -> Self {
        match error {
            crate::Error::Threads(error) => {
                Self::StepThreadStart { cause: error, folder: folder.to_owned() }
            }
            other => other.into(),
        }
    }

    /// Converts the error to a JSON object: kind, printed message and exit code. Errors of cases and files also contain
    /// the position or path, the value or fault found, and the allowed values or the remedy. A key that does not apply
    /// is `null`.
    pub fn to_json(&self) -> Value {
        let mut all = create_error_object(self.kind(), &self.to_string(), self.exit_code().into());
        match self {
            Self::Study(crate::Error::Case(error)) => add_case_position(&mut all, error),
            Self::Output(OutputError { path, cause, remedy }) => {
                all["file"] = path.display().to_string().into();
                all["found"] = cause.as_str().into();
                all["allowed"] = (*remedy).into();
            }
            Self::Usage(UsageError { argument, found, allowed }) => {
                all["option"] = argument.as_str().into();
                all["found"] = found.as_str().into();
                all["allowed"] = allowed.as_str().into();
            }
            _ => {}
        }
        all
    }

    /// Returns the kind of the error, one word: the value of `kind` in the JSON object.
    fn kind(&self) -> &'static str {
        match self {
            Self::Study(crate::Error::Case(_))
            | Self::YieldSet(_)
            | Self::UnreadableCases { .. } => "case",
            Self::Study(crate::Error::Memory { .. }) => "memory",
            Self::Study(crate::Error::IllPosed(_)) | Self::IllPosed(_) => "ill-posed",
            Self::Output(_) => "output",
            Self::SimulationStopped(_) => "stopped",
            Self::Disagreement { .. } => "disagreement",
            Self::DamagedFiles { .. } | Self::FalseCertificate { .. } => "damage",
            Self::NoCaseFiles { .. } | Self::NoBundledCase { .. } | Self::Usage(_) => "usage",
            Self::Interrupted { .. } | Self::InterruptedReplay { .. } | Self::InterruptedStudy => {
                "interrupted"
            }
            Self::Ranks(_) => "ranks",
            Self::ThreadStart(_)
            | Self::StepThreadStart { .. }
            | Self::Study(crate::Error::Threads(_)) => "threads",
            Self::Study(_) => "result",
            Self::Stdout(_) => "stdout",
        }
    }
}

/// Creates the JSON object of an error, with `null` for position, value and remedy.
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

/// Adds the position in the case file, the value found and the allowed values of a case error to a JSON object.
fn add_case_position(all: &mut Value, error: &CaseError) {
    let position = match error {
        CaseError::Unreadable { path, cause } => {
            all["file"] = path.display().to_string().into();
            all["found"] = cause.as_str().into();
            all["allowed"] = "a case file, or the name of a bundled case".into();
            return;
        }
        CaseError::Syntax { position, cause, remedy } => {
            all["found"] = cause.as_str().into();
            all["allowed"] = (*remedy).into();
            position
        }
        CaseError::Key { position, key, found, allowed } => {
            all["key"] = key.as_str().into();
            all["found"] = found.as_str().into();
            all["allowed"] = allowed.as_str().into();
            position
        }
    };
    match position {
        SourcePosition::Line { file, line } => {
            all["file"] = file.as_str().into();
            all["line"] = (*line).into();
        }
        SourcePosition::File(file) => all["file"] = file.as_str().into(),
        SourcePosition::Option(text) => all["option"] = text.as_str().into(),
    }
}

/// Unwraps the error from [`crate::Error::Recorder`] if a recorder of this module returned it.
impl From<crate::Error> for CommandError {
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
impl From<CommandError> for crate::Error {
    fn from(error: CommandError) -> Self {
        match error {
            CommandError::Study(error) => error,
            error => Self::Recorder(Box::new(error)),
        }
    }
}

impl From<CaseError> for CommandError {
    fn from(error: CaseError) -> Self {
        Self::Study(error.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Verifies exit code, kind and message of the error that the threads of a time step cannot be started.
    #[test]
    fn step_threads_that_cannot_start_exit_with_2() {
        let cause = "Resource temporarily unavailable".to_owned();
        let error = CommandError::from_run_error(ThreadStartError { cause }.into(), "out/case");
        assert_eq!(error.exit_code(), 2);
        assert_eq!(error.to_json()["kind"], "threads");
        let message = error.to_string();
        for part in ["cannot start the threads", "unavailable", "wellposed resume out/case"] {
            assert!(message.contains(part), "{message}");
        }
        let other = CommandError::from_run_error(crate::Error::Cancelled, "out/case");
        assert!(matches!(other, CommandError::Study(crate::Error::Cancelled)), "{other}");
    }
}
