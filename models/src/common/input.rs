//! Inputs that a model cannot take.

/// An input that a model cannot take.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{input}: found {found}; {allowed}")]
pub struct InputError {
    /// Name of the input: a parameter of the model or of its yield set, or a number of the state.
    pub input: &'static str,
    /// What was found; angles in degrees.
    pub found: String,
    /// What is allowed, as a sentence fragment.
    pub allowed: String,
}

/// `Ok` when `holds`; otherwise what was found and what is allowed. Pass [`format_args!`], not
/// [`format!`]: the words are made only where they are needed.
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

/// An angle in degrees without the noise of the conversion.
pub(crate) fn degrees(radians: f64) -> f64 {
    let degrees = radians.to_degrees();
    let rounded = (degrees * 1e10).round() / 1e10;
    if rounded.is_finite() { rounded } else { degrees }
}
