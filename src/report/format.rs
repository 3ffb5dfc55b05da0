//! Formatting of numbers, units and orders of growth as text.

pub use crate::study::format::{format_count, format_order, format_short, format_superscript};

use crate::case::Case;
use analysis::solids::angles_deg;

/// Text for verdicts that follow from a closed form of the growth rate of the model.
pub const CLOSED_FORM_ROUTE: &str =
    "closed form of the model's growth rate, where rounding leaves its sign and ten digits";

/// Text on the range of validity of a verdict with frozen coefficients.
pub const VALIDITY_NOTE: &str = "Validity: coefficients are frozen; the verdict holds for waves much shorter than the length \
     scale on which the background varies.";

/// Returns the title of a case, or its name if it has none.
pub fn case_title(case: &Case) -> String {
    if case.title.is_empty() { case.name.clone() } else { case.title.clone() }
}

/// Formats the unit of a number as the suffix of that number: ` m/s`, `°` for degrees, nothing without a unit.
pub fn format_unit_suffix(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "deg" => "°".into(),
        other => format!(" {other}"),
    }
}

/// Formats an angle, degrees, with at most two decimals, as figures do: angles of one kind then have the same precision.
pub fn format_angle(degrees: f64) -> String {
    let text = format!("{:.2}", (100.0 * degrees).round() / 100.0 + 0.0);
    format!("{}°", text.trim_end_matches('0').trim_end_matches('.'))
}

/// Formats the note that a model is coaxial (Δ = 0) although the case gives the non-coaxiality Δ = `noncoaxiality_deg`.
pub fn format_coaxial_note(noncoaxiality_deg: f64) -> String {
    format!("(coaxial: Δ = 0 instead of {}°)", format_short(noncoaxiality_deg))
}

/// Returns the unit of the growth coefficient lim Re ς / k^order as k → ∞.
pub fn coefficient_unit(order: f64) -> String {
    format!("m{}/s", format_superscript(order))
}

/// Formats a unit normal vector as its angles: `at 30°, 12° above the plane`.
pub fn format_normal(normal: [f64; 3]) -> String {
    let [direction, elevation] = angles_deg(normal).map(format_angle);
    match elevation.as_str() {
        "0°" => format!("at {direction}"),
        up => format!("at {direction}, {up} above the plane"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_have_two_decimals() {
        for (degrees, text) in
            [(147.648, "147.65°"), (40.51, "40.51°"), (90.0, "90°"), (0.004, "0°"), (-0.001, "0°")]
        {
            assert_eq!(format_angle(degrees), text);
        }
    }

    #[test]
    fn coefficient_unit_contains_the_order() {
        assert_eq!(coefficient_unit(2.0), "m²/s");
    }
}
