//! Errors of rejected model inputs.

use super::decimal::format_exact;

/// A model input that was rejected: its name, the rejected value and the allowed values.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{input}: found {rejected_value}; {allowed_values}")]
pub struct InputError {
    /// Name of the input: a constant of a model or yield set, a quantity of the state, or a case key such as `kind`.
    pub input: &'static str,
    /// The rejected value as text, or a description of it; angles in degrees.
    pub rejected_value: String,
    /// The allowed values or the reason for the rejection, as a sentence fragment.
    pub allowed_values: String,
}

/// Returns `Ok(())` if `is_valid`, else an [`InputError`] of the input `key` with the rejected `value` and the
/// `allowed` values. Pass [`format_args!`], not [`format!`]: the text is formatted only on error.
pub(crate) fn ensure(
    is_valid: bool,
    key: &'static str,
    value: impl std::fmt::Display,
    allowed: impl std::fmt::Display,
) -> Result<(), InputError> {
    if is_valid {
        Ok(())
    } else {
        Err(InputError {
            input: key,
            rejected_value: shorten_number(value.to_string()),
            allowed_values: allowed.to_string(),
        })
    }
}

/// Returns a number in its shortest form, which for 1e300 is not 301 digits; other texts are returned unchanged.
fn shorten_number(text: String) -> String {
    text.parse().map_or(text, format_exact)
}

/// Converts an angle from rad to degrees, rounded to 1e-10° to hide the rounding error of the conversion; not rounded
/// if rounding would overflow.
pub(crate) fn to_rounded_degrees(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e10).round() / 1e10;
    if rounded.is_finite() { rounded } else { degrees }
}
