//! Formatting of numbers, units and orders of growth as text.

pub use crate::study::format::{format_order, format_short, format_superscript};

use crate::case::Case;
use analysis::solids::angles_deg;

/// Route of verdicts by a closed form of the model.
pub const CLOSED_FORM_ROUTE: &str =
    "closed form of the model's growth rate, where rounding leaves its sign and ten digits";

/// Range of validity of a verdict with frozen coefficients.
pub const VALIDITY_NOTE: &str = "Validity: coefficients are frozen; the verdict holds for waves much shorter than the length \
     scale on which the background varies.";

/// Returns the title of a case, or its name if it has none.
pub fn case_title(case: &Case) -> String {
    if case.title.is_empty() { case.name.clone() } else { case.title.clone() }
}

/// Formats a unit as a suffix.
pub fn format_unit_suffix(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "deg" => "°".into(),
        other => format!(" {other}"),
    }
}

/// Formats the note that a model is coaxial although the case gives Δ, degrees.
pub fn format_coaxial_note(noncoaxiality_deg: f64) -> String {
    format!("(coaxial: Δ = 0 instead of {}°)", format_short(noncoaxiality_deg))
}

/// Returns the unit of lim Re ς / k^order.
pub fn coefficient_unit(order: f64) -> String {
    format!("m{}/s", format_superscript(order))
}

/// Formats a unit normal as angles: `at 30°, 12° above the plane`.
pub fn format_normal(normal: [f64; 3]) -> String {
    let [direction, elevation] = angles_deg(normal);
    match elevation {
        0.0 => format!("at {}°", format_short(direction)),
        up => format!("at {}°, {}° above the plane", format_short(direction), format_short(up)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coefficient_unit_contains_the_order() {
        assert_eq!(coefficient_unit(2.0), "m²/s");
    }
}
