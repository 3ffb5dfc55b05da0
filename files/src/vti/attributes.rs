//! Formatting and escaping of XML attribute values.

use super::error::VtiError;

pub(super) fn finite(time: f64) -> Result<f64, VtiError> {
    if time.is_finite() { Ok(time) } else { Err(VtiError::Time(time)) }
}

/// Formats a name as attribute value; refuses characters that XML does not allow.
pub(super) fn attribute(name: &str) -> Result<String, VtiError> {
    let foreign = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    if name.is_empty() || name.contains(foreign) {
        return Err(VtiError::Name(name.to_owned()));
    }
    Ok(escaped(name))
}

pub(super) fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;")
}
