//! Numbers, units and orders as words for a reader.

use crate::case::Case;
use analysis::solids::angles_deg;
use analysis::sphere::Flutter;
use models::elementary::Elementary;
use serde_json::{Value, json};

/// How verdicts come about that a formula of the model decides.
pub const CLOSED_FORM: &str = "closed form of the model's growth rate, where its sign and ten digits of it stand out of rounding";

/// How all other verdicts come about.
pub const ROUTE: &str = "exact dispersion polynomial of the linearised equations, all directions (no model's closed form)";

/// What a verdict on frozen coefficients means.
pub const VALIDITY: &str = "Validity: coefficients are frozen, which says little of waves that are not much shorter than \
     the length on which the background varies.";

/// Title for people, whatever the case has.
pub fn case_title(case: &Case) -> String {
    if case.title.is_empty() { case.name.clone() } else { case.title.clone() }
}

/// A number for a reader: four significant digits.
pub fn short(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    if !(1e-3..1e5).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    let digits = (3 - x.abs().cr_log10().floor() as i32).max(0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
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

/// An order as a fraction where it is one.
pub fn order_words(order: f64) -> String {
    for denominator in 1..=12 {
        let numerator = order * f64::from(denominator);
        if (numerator - numerator.round()).abs() < 1e-9 {
            return match denominator {
                1 => format!("{}", numerator.round()),
                _ => format!("{}/{denominator}", numerator.round()),
            };
        }
    }
    format!("{order}")
}

/// `²` for 2, `^(2/5)` for 0.4.
pub fn superscript(order: f64) -> String {
    let words = order_words(order);
    let raised: Option<String> = words
        .chars()
        .map(|c| match c {
            '0' => Some('⁰'),
            '1' => Some('¹'),
            '2' => Some('²'),
            '3' => Some('³'),
            '4' => Some('⁴'),
            '5' => Some('⁵'),
            '6' => Some('⁶'),
            '7' => Some('⁷'),
            '8' => Some('⁸'),
            '9' => Some('⁹'),
            _ => None,
        })
        .collect();
    match raised {
        Some(_) if words == "1" => String::new(),
        Some(raised) => raised,
        None => format!("^({words})"),
    }
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

/// A normal as JSON: its components and angles.
pub fn normal_json(normal: [f64; 3]) -> Value {
    let [direction, elevation] = angles_deg(normal);
    json!({ "vector": normal, "direction_deg": direction, "elevation_deg": elevation })
}

/// Flutter as JSON; null without.
pub fn flutter_json(flutter: Option<Flutter>) -> Value {
    flutter.map_or(Value::Null, |flutter| {
        json!({
            "growth": flutter.growth,
            "squared_speed": [flutter.speed_squared.re, flutter.speed_squared.im],
            "normal": normal_json(flutter.normal),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, words) in [
            (0.0, "0"),
            (-45.0, "-45"),
            (0.968_245_8, "0.9682"),
            (22.25, "22.25"),
            (9_999.96, "10000"),
            (234_376.0, "2.344e5"),
            (-1e-7, "-1.000e-7"),
        ] {
            assert_eq!(short(number), words);
        }
    }

    #[test]
    fn orders_are_fractions() {
        assert_eq!(order_words(2.0 / 5.0), "2/5");
        assert_eq!(superscript(2.0), "²");
        assert_eq!(superscript(1.0), "");
        assert_eq!(superscript(0.5), "^(1/2)");
        assert_eq!(coefficient_unit(2.0), "m²/s");
    }
}
