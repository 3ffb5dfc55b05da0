//! What is wrong with a case, where, and what to do about it.

use std::path::PathBuf;

/// Where something stands in the input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a case file, counted from 1.
    Line {
        /// The file, as it was named.
        file: String,
        /// The line.
        line: usize,
    },
    /// A case file as a whole: what is missing stands on no line.
    File(String),
    /// A `--set` option, with its text.
    Option(String),
}

impl std::fmt::Display for Place {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line { file, line } => write!(formatter, "{file}:{line}"),
            Self::File(file) => write!(formatter, "{file}"),
            Self::Option(text) => write!(formatter, "--set {}", shown(text)),
        }
    }
}

/// A case that cannot be used: one message with place, key, what was found and what is allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read at all.
    #[error("{}: {cause}; name a case file (wellposed cases lists some, wellposed new writes one)", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why not.
        cause: String,
    },
    /// The text is not TOML.
    #[error("{place}: {cause}; write 'key = value' or '[section]', each key once")]
    Syntax {
        /// Where.
        place: Place,
        /// What the parser says, and the line.
        cause: String,
    },
    /// A key is unknown, missing, not used, or has a wrong value.
    #[error("{place}: {key}: {found}; {allowed}")]
    Key {
        /// Where.
        place: Place,
        /// The key, with its section.
        key: String,
        /// What was found.
        found: String,
        /// What is allowed, or the remedy.
        allowed: String,
    },
}

/// Text of the user as it may stand in a one-line message: escaped and not too long.
pub(super) fn shown(text: &str) -> String {
    const LONGEST: usize = 80;
    let mut short: String = text.chars().take(LONGEST).flat_map(escaped).collect();
    if text.chars().nth(LONGEST).is_some() {
        short.push('…');
    }
    short
}

/// Control characters escaped, all others as they are.
fn escaped(c: char) -> impl Iterator<Item = char> {
    let control = c.is_control();
    control.then(|| c.escape_default()).into_iter().flatten().chain((!control).then_some(c))
}
