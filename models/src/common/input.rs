//! Errors of rejected model inputs.

/// A model input that was rejected: its name, the value found and the values allowed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{input}: found {found}; {allowed}")]
pub struct InputError {
    /// Name of the input: a parameter of the model or of its yield set, or a number of the state.
    pub input: &'static str,
    /// The rejected value; angles in degrees.
    pub found: String,
    /// The allowed values, as a sentence fragment.
    pub allowed: String,
}

/// Returns `Ok(())` if `holds`, else an [`InputError`] of the input `key` with the value `found` and the values
/// `allowed`. Pass [`format_args!`], not [`format!`]: the text is formatted only on error.
pub(crate) fn ensure(
    holds: bool,
    key: &'static str,
    found: impl std::fmt::Display,
    allowed: impl std::fmt::Display,
) -> Result<(), InputError> {
    if holds {
        Ok(())
    } else {
        Err(InputError { input: key, found: found.to_string(), allowed: allowed.to_string() })
    }
}

/// Converts an angle from rad to degrees, rounded to 1e-10° to hide the rounding error of the conversion.
pub(crate) fn degrees(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e10).round() / 1e10;
    if rounded.is_finite() { rounded } else { degrees }
}
