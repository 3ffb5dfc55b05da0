//! Formatting of numbers, orders and verdicts as text in results and reports.

use analysis::growth::Verdict;
use models::common::elementary::Elementary;

/// Formats a number with four significant digits, without trailing zeros; from 10⁴ to 10⁵ as an integer of five digits;
/// in scientific notation with four digits if its magnitude is below 10⁻³, or 10⁵ or more.
pub fn format_short(x: f64) -> String {
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

/// Formats a count with its noun: `1 point`, `12 points`. The plural is the noun and `s`.
pub fn format_count(count: usize, noun: &str) -> String {
    match count {
        1 => format!("1 {noun}"),
        _ => format!("{count} {noun}s"),
    }
}

/// Formats an order of growth as an integer or a fraction with a denominator up to 12, otherwise as a decimal number.
pub fn format_order(order: f64) -> String {
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

/// Formats an order of growth as an exponent: empty for 1, `²` for 2, `^(2/5)` for 0.4.
pub fn format_superscript(order: f64) -> String {
    let exponent = format_order(order);
    let raised: Option<String> = exponent
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
        Some(_) if exponent == "1" => String::new(),
        Some(raised) => raised,
        None => format!("^({exponent})"),
    }
}

/// Describes as text the evidence on which a verdict in the plane is based.
pub fn describe_evidence(verdict: &Verdict) -> String {
    let angle = match verdict {
        Verdict::IllPosed { direction, .. } => direction.to_degrees(),
        _ => 0.0,
    };
    describe_evidence_for(verdict, &format!("wave vectors at {}°", format_short(angle)))
}

/// Describes as text the evidence on which a verdict is based; `waves` names the fastest growing ones.
pub fn describe_evidence_for(verdict: &Verdict, waves: &str) -> String {
    match verdict {
        Verdict::WellPosed => {
            "no root grows without bound as k → ∞ in any direction, layers around the degenerate \
             directions included"
                .into()
        }
        Verdict::IllPosed { growth: Some(growth), .. } => {
            let order = growth.order.to_f64();
            format!(
                "Re ς ≈ {} k{} as k → ∞, for {waves}",
                format_short(growth.coefficient),
                format_superscript(order)
            )
        }
        Verdict::IllPosed { growth: None, .. } => format!(
            "the growth rate is unbounded at finite wave numbers already: the coefficient of the \
             highest power of ς vanishes and changes sign for {waves}"
        ),
        Verdict::Marginal { quantity, value, rounding } => format!(
            "the {quantity} is {value:.1e} with a rounding bound of {rounding:.1e} (scaled): no \
             sign can be asserted"
        ),
        Verdict::Indeterminate { rank, unknowns } => {
            format!("the equations determine {rank} of {unknowns} unknowns: every ς is a root")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_significant_digits() {
        for (number, expected) in [
            (0.0, "0"),
            (-45.0, "-45"),
            (0.968_245_8, "0.9682"),
            (22.25, "22.25"),
            (9_999.96, "10000"),
            (234_376.0, "2.344e5"),
            (-1e-7, "-1.000e-7"),
        ] {
            assert_eq!(format_short(number), expected);
        }
    }

    #[test]
    fn nouns_of_one_are_singular() {
        assert_eq!(
            [0, 1, 2].map(|count| format_count(count, "point")),
            ["0 points", "1 point", "2 points"]
        );
    }

    #[test]
    fn orders_are_formatted_as_fractions() {
        assert_eq!(format_order(2.0 / 5.0), "2/5");
        assert_eq!(format_superscript(2.0), "²");
        assert_eq!(format_superscript(1.0), "");
        assert_eq!(format_superscript(0.5), "^(1/2)");
    }
}
