//! Numbers, units and orders as words for a reader.

pub use crate::study::words::{order_words, short, superscript};

use crate::case::Case;
use analysis::solids::angles_deg;

/// How verdicts come about that a formula of the model decides.
pub const CLOSED_FORM: &str = "closed form of the model's growth rate, where its sign and ten digits of it stand out of rounding";

/// What a verdict on frozen coefficients means.
pub const VALIDITY: &str = "Validity: coefficients are frozen, which says little of waves that are not much shorter than \
     the length on which the background varies.";

/// Title for people, whatever the case has.
pub fn case_title(case: &Case) -> String {
    if case.title.is_empty() { case.name.clone() } else { case.title.clone() }
}

/// A unit as printed.
pub fn unit(unit: &str) -> String {
    match unit {
        "" => String::new(),
        "deg" => "°".into(),
        other => format!(" {other}"),
    }
}

/// That a model is coaxial, though the case says Δ, degrees.
pub fn coaxial_words(noncoaxiality_deg: f64) -> String {
    format!("(coaxial: Δ = 0 in place of {}°)", short(noncoaxiality_deg))
}

/// Unit of lim Re ς / k^order.
pub fn coefficient_unit(order: f64) -> String {
    format!("m{}/s", superscript(order))
}

/// A normal for a reader: `at 30°, 12° above the plane`.
pub fn normal_words(normal: [f64; 3]) -> String {
    let [direction, elevation] = angles_deg(normal);
    match elevation {
        0.0 => format!("at {}°", short(direction)),
        up => format!("at {}°, {}° above the plane", short(direction), short(up)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_have_the_order() {
        assert_eq!(coefficient_unit(2.0), "m²/s");
    }
}
