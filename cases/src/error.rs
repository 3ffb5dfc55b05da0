//! Errors of case files, with position, key, value found and values allowed.

use crate::bundled::suggest_case;
use std::path::PathBuf;

/// Position in the input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SourcePosition {
    /// A line of a case file or of a sample file.
    Line {
        /// Path of the file as given.
        file: String,
        /// Line number, from 1.
        line: usize,
    },
    /// A case file as a whole, e.g. for missing keys.
    File(String),
    /// A `--set` option: its text.
    Option(String),
}

impl std::fmt::Display for SourcePosition {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line { file, line } => write!(formatter, "{file}:{line}"),
            Self::File(file) => write!(formatter, "{file}"),
            Self::Option(text) => write!(formatter, "--set {}", escape(text)),
        }
    }
}

/// Error of a case file, with a one-line message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read, is too large, or has too many tables or keys.
    #[error(
        "{}: {cause}; {}expected a case file, or the name of a bundled case (see wellposed cases)",
        .path.display(),
        suggest_case(.path)
    )]
    Unreadable {
        /// Path of the file.
        path: PathBuf,
        /// Cause, e.g. as given by the operating system.
        cause: String,
    },
    /// The text is not TOML or not UTF-8.
    #[error("{position}: {cause}; {remedy}")]
    Syntax {
        /// Position of the error.
        position: SourcePosition,
        /// Message of the parser with the text of the line, or a note that a byte is not UTF-8.
        cause: String,
        /// Way to write the line.
        remedy: &'static str,
    },
    /// A key is unknown, missing or unused, or has an invalid value.
    #[error("{position}: {key}: {found}; {allowed}")]
    Key {
        /// Position of the key.
        position: SourcePosition,
        /// Key with its section, or the text of an option without a valid key.
        key: String,
        /// Description of the fault: the invalid value found, or that the key is unknown, missing or unused.
        found: String,
        /// Values allowed, or the remedy.
        allowed: String,
    },
}

impl CaseError {
    /// Returns whether the error is in a `--set` option.
    pub fn is_in_setting(&self) -> bool {
        match self {
            Self::Unreadable { .. } => false,
            Self::Syntax { position, .. } | Self::Key { position, .. } => {
                matches!(position, SourcePosition::Option(_))
            }
        }
    }
}

/// Escapes control characters of user text and truncates it to 80 characters, for one-line messages.
pub(super) fn escape(text: &str) -> String {
    const MAX_CHARACTERS: usize = 80;
    let mut short: String =
        text.chars().take(MAX_CHARACTERS).flat_map(escape_control_character).collect();
    if text.chars().nth(MAX_CHARACTERS).is_some() {
        short.push('…');
    }
    short
}

/// Escapes a control character; returns other characters unchanged.
fn escape_control_character(c: char) -> impl Iterator<Item = char> {
    let control = c.is_control();
    control.then(|| c.escape_default()).into_iter().flatten().chain((!control).then_some(c))
}
