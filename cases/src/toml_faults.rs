//! Faults and remedies of text that is not TOML.

use super::error::{CaseError, escape};

/// Whether a line has nothing after its sign of equality.
pub(super) fn has_no_value(line: &str) -> bool {
    line.split_once('=').is_some_and(|(_, value)| value.trim().is_empty())
}

/// Chooses the remedy for a line that is not TOML, from the message of the parser and the text of the line.
pub(super) fn choose_syntax_remedy(message: &str, line: &str) -> &'static str {
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    let has_decimal_comma = value.split_once(',').is_some_and(|(before, after)| {
        before.bytes().all(|byte| byte.is_ascii_digit())
            && after.starts_with(|c: char| c.is_ascii_digit())
    });
    if has_no_value(line) {
        "give a value after '=': a number, a text in quotes, a list [1, 2] or a table { key = value }"
    } else if message.contains("duplicate key") {
        "give each key once"
    } else if has_decimal_comma {
        "write a point for the decimal comma, as in 1.5e9"
    } else if message.contains("must be quoted") && !value.is_empty() {
        "put the text in quotes: key = \"text\""
    } else if message.contains("unclosed") {
        "close the bracket or quotation mark that the line opens"
    } else {
        "write 'key = value' or '[section]'; '#' begins a comment"
    }
}

/// Checks that the value of an option that is not TOML may be a text without quotes: that it does not begin like a
/// list, a table or a quoted text. The error is the result of `refused` for the fault and the remedy.
pub(super) fn check_bare_text(
    text: &str,
    error: &toml::de::Error,
    refused: impl FnOnce(&str, String) -> Result<Option<String>, CaseError>,
) -> Result<(), CaseError> {
    if !text.starts_with(['[', '{', '"', '\'']) {
        return Ok(());
    }
    // Without the quotes that a shell has removed, the parser takes the beginning of a text for that of a literal.
    let message = error.message();
    let detail = if message.contains("unclosed") { format!(": {message}") } else { String::new() };
    let found = format!("found '{}', which is not TOML{}", escape(text), escape(&detail));
    let allowed = match text.contains(char::is_alphabetic) {
        true => {
            "texts in lists and tables have double quotes, which a shell keeps only inside single quotes, as in \
             --set 'KEY=[\"text\"]'"
        }
        false => "close the bracket or quotation mark",
    };
    refused(&found, allowed.to_owned()).map(drop)
}
