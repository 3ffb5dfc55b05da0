//! Numbers in messages: short decimal texts.

use std::fmt::{Display, Formatter};

/// Significant digits of a computed number in messages.
const SIGNIFICANT_DIGITS: usize = 6;

/// Formats a number as it was given: with the fewest digits that parse to the same double, in scientific notation from
/// 10⁶ on and below 10⁻⁴; −0 as 0.
pub fn format_exact(x: f64) -> String {
    format_scientific(&format!("{x:e}"), x)
}

/// Formats a computed number with at most six significant digits, without trailing zeros; −0 as 0.
pub fn format_rounded(x: f64) -> String {
    format_with_digits(x, SIGNIFICANT_DIGITS)
}

/// Numbers of a case, or computed from them, in messages.
pub trait ToPlainText {
    /// Formats a number like [`format_exact`] up to nine digits, which given numbers rarely exceed, otherwise like
    /// [`format_rounded`]; lists in brackets.
    fn to_plain_text(&self) -> String;
}

impl ToPlainText for f64 {
    fn to_plain_text(&self) -> String {
        const MAX_DIGITS: usize = 9;
        let exact = format_exact(*self);
        let mantissa = exact.split('e').next().unwrap_or_default();
        match mantissa.bytes().filter(u8::is_ascii_digit).count() <= MAX_DIGITS {
            true => exact,
            false => format_rounded(*self),
        }
    }
}

impl ToPlainText for [f64] {
    fn to_plain_text(&self) -> String {
        let items: Vec<String> = self.iter().map(f64::to_plain_text).collect();
        format!("[{}]", items.join(", "))
    }
}

/// A computed number, displayed like [`format_rounded`].
#[derive(Clone, Copy, Debug)]
pub struct ShortNumber(pub f64);

impl Display for ShortNumber {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(&format_rounded(self.0))
    }
}

/// Formats two numbers like [`format_rounded`], with as many digits more as are needed to tell different ones apart.
pub fn format_distinct(numbers: [f64; 2]) -> [String; 2] {
    for digits in SIGNIFICANT_DIGITS..17 {
        let texts = numbers.map(|x| format_with_digits(x, digits));
        if texts[0] != texts[1] || numbers[0] == numbers[1] {
            return texts;
        }
    }
    numbers.map(format_exact)
}

/// Formats a list of numbers in brackets, each like [`format_rounded`].
pub fn format_rounded_list(numbers: &[f64]) -> String {
    let items: Vec<String> = numbers.iter().copied().map(format_rounded).collect();
    format!("[{}]", items.join(", "))
}

fn format_with_digits(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().unwrap_or(x);
    format_exact(rounded)
}

/// Formats a number from its scientific notation with the digits to be kept.
fn format_scientific(scientific: &str, x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let exponent = scientific.rsplit_once('e').and_then(|(_, digits)| digits.parse::<i32>().ok());
    match exponent {
        // Display never uses an exponent.
        Some(-4..=5) | None => x.to_string(),
        Some(_) => scientific.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn given_numbers_keep_their_digits() {
        for (x, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (-1000.0, "-1000"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e308, "1e308"),
            (4e9, "4e9"),
            (-2.5e-7, "-2.5e-7"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(format_exact(x), expected);
        }
    }

    #[test]
    fn computed_numbers_have_six_digits_unless_more_tell_them_apart() {
        for (x, expected) in [
            (0.1 + 0.2, "0.3"),
            (-173.205_080_756_887_75, "-173.205"),
            (-2_983_800_000_000.0, "-2.9838e12"),
            (999_999.6, "1e6"),
            (0.132_448_718_296_909_55, "0.132449"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(format_rounded(x), expected);
        }
        assert_eq!(format_distinct([1.0, 2.0]), ["1", "2"]);
        assert_eq!(format_distinct([1.000_000_01, 1.000_000_02]), ["1.00000001", "1.00000002"]);
        let next = f64::from_bits(1.0_f64.to_bits() + 1);
        assert_eq!(format_distinct([1.0, next]), ["1", "1.0000000000000002"]);
        let lengths = [0.1 + 0.2, 1_234_567.5, 1e-200, 40.0];
        assert_eq!(lengths.to_plain_text(), "[0.3, 1.2345675e6, 1e-200, 40]");
        assert_eq!(format_rounded_list(&[10.05, 1.0 / 3.0]), "[10.05, 0.333333]");
    }
}
