//! Formatting and escaping of XML attribute values.

use super::error::VtiError;

pub(super) fn check_time(time: f64) -> Result<f64, VtiError> {
    if time.is_finite() { Ok(time) } else { Err(VtiError::Time(time)) }
}

/// Formats a name as attribute value; refuses empty names, control characters, U+FFFE and U+FFFF.
pub(super) fn format_attribute(name: &str) -> Result<String, VtiError> {
    let foreign = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    if name.is_empty() || name.contains(foreign) {
        return Err(VtiError::Name(name.to_owned()));
    }
    Ok(escape_xml(name))
}

pub(super) fn escape_xml(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;")
}

/// Replaces the entities that [`escape_xml`] has made by their characters.
pub(super) fn unescape_xml(text: &str) -> String {
    let text = text.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">");
    text.replace("&amp;", "&")
}
