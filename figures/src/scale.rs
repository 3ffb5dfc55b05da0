//! Axis scales: mapping from numbers to axis positions, ticks and tick labels.

/// Magnitude above which numbers are treated as infinite, since differences would overflow.
pub(crate) const FINITE_LIMIT: f64 = 1e300;

/// A tick: position and label; a minor tick has an empty label.
pub(crate) type Tick = (f64, String);

/// Computes ticks at round values between `low` and `high`, at most `max_count` ≥ 2 of them. If `is_angle`, steps above
/// 2° are divisors of the circle, e.g. 15°, 30°, 45° and 90°. Empty if the range is empty, infinite or too narrow for
/// distinct ticks.
pub(crate) fn linear_ticks(low: f64, high: f64, max_count: usize, is_angle: bool) -> Vec<Tick> {
    let rough = (high - low) / max_count.max(2) as f64;
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let power = 10_f64.powf(rough.log10().floor());
    let decimal = [1.0, 2.0, 5.0, 10.0, 20.0].map(|factor| factor * power);
    let round: &[f64] = if is_angle && rough > 2.0 {
        &[5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0]
    } else {
        &decimal
    };
    // With ticks at both ends there is one tick more than steps.
    let fits =
        |step: f64| (high / step + 1e-9).floor() - (low / step - 1e-9).ceil() < max_count as f64;
    let largest = decimal[4];
    let step = round.iter().copied().find(|&step| fits(step)).unwrap_or(largest);
    let first = (low / step - 1e-9).ceil();
    let last = (high / step + 1e-9).floor();
    // More than 2⁵³ steps from zero neighbouring ticks would be equal doubles.
    if first.abs().max(last.abs()) > 9e15 {
        return Vec::new();
    }
    let values: Vec<f64> = (first as i64..=last as i64).map(|count| count as f64 * step).collect();
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    values.into_iter().map(|value| (value, format_tick(value, step, largest))).collect()
}

/// Computes the ticks of [`linear_ticks`] with short labels. Numbers that would be in scientific notation are divided by a
/// common power of ten, and numbers that differ only behind their first four digits are written as differences from one
/// of them. Returns the ticks and the text that states power and difference: ` (×10⁻⁶)`, ` (1000 + …)`; empty if there
/// are none.
pub(crate) fn linear_ticks_with_multiplier(
    low: f64,
    high: f64,
    max_count: usize,
) -> (Vec<Tick>, String) {
    let ticks = linear_ticks(low, high, max_count, false);
    let [first, second, ..] = &ticks[..] else { return (ticks, String::new()) };
    // The difference of large numbers is rounded; a step just below a power of ten would have one digit more.
    let (step, least) = ((second.0 - first.0) * (1.0 + 1e-6), first.0);
    let largest = ticks.iter().fold(0.0_f64, |largest, (value, _)| largest.max(value.abs()));
    let is_offset = largest / step > 2000.0;
    let origin = if is_offset { least } else { 0.0 };
    let largest =
        ticks.iter().fold(0.0_f64, |largest, (value, _)| largest.max((value - origin).abs()));
    let exponent = common_exponent([largest].into_iter());
    if exponent == 0 && !is_offset {
        return (ticks, String::new());
    }
    let unit = 10_f64.powi(exponent);
    if !(unit > 0.0 && unit.is_finite()) {
        return (ticks, String::new());
    }
    let label = |value: f64| format_tick((value - origin) / unit, step / unit, largest / unit);
    let labelled = ticks.iter().map(|(value, _)| (*value, label(*value))).collect();
    let power = if exponent == 0 { String::new() } else { format_power_of_ten(false, exponent) };
    let multiplier = match (is_offset, power.is_empty()) {
        (true, true) => format!(" ({} + …)", format_number_with_digits(origin, step)),
        (true, false) => format!(" ({} + … × {power})", format_number_with_digits(origin, step)),
        (false, _) => format!(" (×{power})"),
    };
    (labelled, multiplier)
}

/// Returns the exponent of the common power of ten of numbers; 0 if their largest magnitude needs no factor.
pub(crate) fn common_exponent(values: impl Iterator<Item = f64>) -> i32 {
    let largest = values.fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest == 0.0 || (1e-3..1e5).contains(&largest) {
        return 0;
    }
    (largest.log10() + 1e-9).floor() as i32
}

/// Appends the common factor of the ticks of an axis to its label: to the unit, if the label has one.
pub(crate) fn label_with_multiplier(label: &str, multiplier: &str) -> String {
    let unit = label.rsplit_once(" (").filter(|(_, unit)| unit.contains(')'));
    let power = multiplier.strip_prefix(" (×").and_then(|own| own.strip_suffix(')'));
    match (unit, power) {
        (Some((name, unit)), Some(power)) => format!("{name} ({power} {unit}"),
        _ => format!("{label}{multiplier}"),
    }
}

/// Formats a number to the digit of `step`, without trailing zeros.
fn format_number_with_digits(value: f64, step: f64) -> String {
    let text = format_tick(value, step, value.abs());
    match text.contains('.') && !text.contains('×') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// Formats a tick label of an axis with step `step` and largest tick `largest`.
fn format_tick(value: f64, step: f64, largest: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if (1e-4..1e5).contains(&largest) {
        let decimals = (-step.log10().floor()).max(0.0) as usize;
        return format!("{value:.decimals$}").replace('-', "−");
    }
    // As many digits as distinguish neighbouring ticks.
    let power = |size: f64| (size.log10() + 1e-9).floor();
    let digits = (power(value.abs()) - power(step)).max(0.0) as usize;
    format_scientific(value, digits)
}

/// Formats a number in scientific notation with up to `digits` decimals: 3.2×10⁵.
pub(crate) fn format_scientific(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$e}");
    let Some((mantissa, exponent)) = text.split_once('e') else { return text };
    let mantissa = match mantissa.split_once('.') {
        Some(_) => mantissa.trim_end_matches('0').trim_end_matches('.'),
        None => mantissa,
    };
    let power = format!("10{}", format_superscript(exponent));
    match mantissa {
        "1" => power,
        "-1" => format!("−{power}"),
        _ => format!("{}×{power}", mantissa.replace('-', "−")),
    }
}

/// Formats a number with at most four significant digits; magnitudes from 10⁴ to 10⁵ are rounded to whole numbers.
pub(crate) fn format_number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-3..1e5).contains(&size) {
        let decimals = if size == 0.0 { 0 } else { (3.0 - size.log10().floor()).max(0.0) as usize };
        let text = format!("{value:.decimals$}").replace('-', "−");
        match text.split_once('.') {
            Some(_) => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
            None => text,
        }
    } else {
        format_scientific(value, 3)
    }
}

/// Formats a signed power of ten: −10⁴.
pub(crate) fn format_power_of_ten(is_negative: bool, exponent: i32) -> String {
    let sign = if is_negative { "−" } else { "" };
    match exponent {
        0 => format!("{sign}1"),
        1 => format!("{sign}10"),
        _ => format!("{sign}10{}", format_superscript(&exponent.to_string())),
    }
}

fn format_superscript(digits: &str) -> String {
    const SUPERSCRIPT_DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raise = |c: char| c.to_digit(10).map_or('⁻', |digit| SUPERSCRIPT_DIGITS[digit as usize]);
    digits.chars().map(raise).collect()
}

/// Computes the ticks of a logarithmic axis, with range and positions in log₁₀: powers of ten if the range contains at
/// least three, otherwise 1-2-5 values or round values.
pub(crate) fn log_ticks(low: f64, high: f64, max_count: usize) -> Vec<Tick> {
    let (first, last) = ((low - 1e-9).ceil() as i32, (high + 1e-9).floor() as i32);
    if last - first >= 2 {
        let step = (last - first) / max_count.max(2) as i32 + 1;
        return (first..=last)
            .filter(|exponent| exponent.rem_euclid(step) == 0)
            .map(|exponent| (f64::from(exponent), format_power_of_ten(false, exponent)))
            .collect();
    }
    let fine: Vec<Tick> = (first - 1..=last)
        .flat_map(|exponent| [1.0, 2.0, 5.0].map(|m: f64| (m.log10() + f64::from(exponent), m)))
        .filter(|(value, _)| (low - 1e-9..=high + 1e-9).contains(value))
        .map(|(value, _)| (value, format_number(10_f64.powf(value))))
        .collect();
    if fine.len() >= 3 {
        return fine;
    }
    let values = linear_ticks(10_f64.powf(low), 10_f64.powf(high), max_count.min(6), false);
    values.into_iter().map(|(value, label)| (value.log10(), label)).collect()
}

/// Symmetric logarithmic scale for values of both signs: linear up to a threshold in magnitude, whose position is 1; at
/// larger magnitudes the position increases by 1 per decade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SymmetricLog {
    /// Exponent of the threshold 10^`threshold_exponent`.
    pub threshold_exponent: i32,
}

impl SymmetricLog {
    /// Default maximum number of whole decades between the threshold and the largest magnitude.
    pub const DEFAULT_DECADES: i32 = 7;

    /// Chooses the threshold, a power of ten, such that all but the smallest tenth of the finite non-zero magnitudes
    /// are in the logarithmic part, but not more than seven decades below the power of ten next below the largest
    /// magnitude.
    pub fn from_values(values: impl Iterator<Item = f64>) -> Self {
        Self::from_values_with_decades(values, Self::DEFAULT_DECADES)
    }

    /// Chooses the threshold as [`from_values`](Self::from_values), but at most `decades` decades below the power of
    /// ten next below the largest magnitude.
    pub fn from_values_with_decades(values: impl Iterator<Item = f64>, decades: i32) -> Self {
        let mut sizes: Vec<f64> =
            values.map(f64::abs).filter(|size| *size > 0.0 && size.is_finite()).collect();
        sizes.sort_by(f64::total_cmp);
        let Some(largest) = sizes.last() else { return Self { threshold_exponent: -1 } };
        let max_exponent = (largest.log10() - 1e-9).floor() as i32;
        let small = sizes[sizes.len() / 10].log10().floor() as i32;
        Self { threshold_exponent: small.clamp(max_exponent - decades, max_exponent) }
    }

    /// Maps a value to its position on the scale.
    pub fn to_position(self, value: f64) -> f64 {
        let size = value.abs() / self.threshold();
        if size <= 1.0 {
            value / self.threshold()
        } else {
            (1.0 + value.abs().log10() - f64::from(self.threshold_exponent)).copysign(value)
        }
    }

    fn threshold(self) -> f64 {
        10_f64.powi(self.threshold_exponent)
    }

    /// Maps a position on the scale to its value.
    #[cfg(test)]
    fn to_value(self, position: f64) -> f64 {
        if position.abs() <= 1.0 {
            position * self.threshold()
        } else {
            10_f64
                .powf(position.abs() - 1.0 + f64::from(self.threshold_exponent))
                .copysign(position)
        }
    }

    /// Computes the ticks between two positions: zero and powers of ten. About `label_count` of them have labels; the
    /// other labels are empty.
    pub fn ticks(self, low: f64, high: f64, label_count: usize) -> Vec<Tick> {
        let step = ((high - low) / label_count.max(2) as f64).ceil().max(1.0) as i32;
        let mut ticks = vec![(0.0, "0".to_owned())];
        for negative in [false, true] {
            let end = if negative { -low } else { high };
            for decade in 0..end.floor().max(0.0) as i32 {
                let exponent = self.threshold_exponent + decade;
                let place = f64::from(decade + 1);
                let labelled = exponent.rem_euclid(step) == 0 && place + 0.3 >= f64::from(step);
                let label =
                    if labelled { format_power_of_ten(negative, exponent) } else { String::new() };
                ticks.push((if negative { -place } else { place }, label));
            }
        }
        ticks
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tick_labels(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|(_, label)| label.as_str()).collect()
    }

    #[test]
    fn linear_ticks_are_round_numbers() {
        let degrees = linear_ticks(-91.0, 91.0, 13, true);
        assert_eq!(tick_labels(&degrees)[..3], ["−90", "−75", "−60"]);
        assert_eq!(degrees.len(), 13);
        assert_eq!(
            tick_labels(&linear_ticks(0.0, 1.0, 6, false)),
            ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        let far = linear_ticks(1000.0, 1000.003, 4, false);
        assert_eq!(tick_labels(&far), ["1000.000", "1000.001", "1000.002", "1000.003"]);
        assert_eq!(tick_labels(&linear_ticks(0.0, 2.5e6, 4, false)), ["0", "10⁶", "2×10⁶"]);
        let short = linear_ticks(1.5e6, 1.52e6, 3, false);
        assert_eq!(tick_labels(&short), ["1.5×10⁶", "1.51×10⁶", "1.52×10⁶"]);
        let halves = linear_ticks(-1.0007e5, -9.993e4, 4, false);
        assert_eq!(tick_labels(&halves), ["−1.0005×10⁵", "−10⁵", "−9.995×10⁴"]);
        for (low, high) in [(1.0, 1.0), (0.0, f64::INFINITY), (f64::NAN, 1.0), (2.0, 1.0)] {
            assert!(linear_ticks(low, high, 5, false).is_empty());
        }
    }

    #[test]
    fn common_factors_and_offsets_are_written_once() {
        let (ticks, multiplier) = linear_ticks_with_multiplier(-2.1e-13, 2.2e-13, 5);
        assert_eq!(tick_labels(&ticks), ["−2", "−1", "0", "1", "2"]);
        assert_eq!(multiplier, " (×10⁻¹³)");
        let (ticks, multiplier) = linear_ticks_with_multiplier(1000.0, 1000.03, 4);
        assert_eq!(tick_labels(&ticks), ["0", "0.01", "0.02", "0.03"]);
        assert_eq!(multiplier, " (1000 + …)");
        let (ticks, multiplier) = linear_ticks_with_multiplier(1e5, 1e5 + 1e-5, 3);
        assert_eq!(tick_labels(&ticks), ["0", "0.5", "1.0"]);
        assert_eq!(multiplier, " (100000 + … × 10⁻⁵)");
        assert_eq!(linear_ticks_with_multiplier(0.0, 2.5e6, 4).1, " (×10⁶)");
        assert_eq!(label_with_multiplier("pressure p (Pa)", " (×10⁶)"), "pressure p (10⁶ Pa)");
        assert_eq!(
            label_with_multiplier("σ (Pa), in tension", " (×10⁶)"),
            "σ (10⁶ Pa), in tension"
        );
        assert_eq!(label_with_multiplier("share", " (×10⁶)"), "share (×10⁶)");
        assert_eq!(label_with_multiplier("p (Pa)", " (1000 + …)"), "p (Pa) (1000 + …)");
        let plain = linear_ticks_with_multiplier(0.0, 1.0, 6);
        assert_eq!(plain, (linear_ticks(0.0, 1.0, 6, false), String::new()));
    }

    #[test]
    fn tick_count_is_limited() {
        for max_count in 2..20 {
            for exponent in -12..12 {
                for (low, high) in
                    [(0.0, 1.0), (-3.3, 7.1), (99.0, 100.0), (-1.0, -0.93), (9.992, 10.007)]
                {
                    let scale = 10_f64.powi(exponent);
                    let ticks =
                        linear_ticks(low * scale, high * scale, max_count, exponent % 2 == 0);
                    assert!(
                        ticks.len() <= max_count && !ticks.is_empty(),
                        "{low} {high} {scale} {max_count}"
                    );
                    let inside = |value: f64| {
                        value >= (low - 1e-6) * scale && value <= (high + 1e-6) * scale
                    };
                    assert!(ticks.iter().all(|(value, _)| inside(*value)));
                    let mut labels = tick_labels(&ticks);
                    labels.dedup();
                    assert_eq!(labels.len(), ticks.len(), "{labels:?}");
                }
            }
        }
    }

    #[test]
    fn logarithmic_ticks_are_powers_or_round_numbers() {
        assert_eq!(
            tick_labels(&log_ticks(-1.2, 3.1, 9)),
            ["0.1", "1", "10", "100"]
                .map(|s| match s {
                    "0.1" => "10⁻¹",
                    "100" => "10²",
                    other => other,
                })
                .into_iter()
                .chain(["10³"])
                .collect::<Vec<_>>()
        );
        assert_eq!(tick_labels(&log_ticks(0.0, 1.0, 9)), ["1", "2", "5", "10"]);
        assert_eq!(tick_labels(&log_ticks(4.01_f64.log10(), 4.05_f64.log10(), 6)).len(), 5);
        assert!(log_ticks(-300.0, 300.0, 8).len() <= 10);
    }

    #[test]
    fn numbers_have_at_most_four_digits() {
        let texts = [0.0, 45.0, -0.25, 1234.0, 3.0e7, -1e-9].map(format_number);
        assert_eq!(texts, ["0", "45", "−0.25", "1234", "3×10⁷", "−10⁻⁹"]);
    }

    #[test]
    fn symmetric_logarithm_is_monotone_odd_and_invertible() {
        for threshold_exponent in [-7, 0, 3] {
            let scale = SymmetricLog { threshold_exponent };
            let sizes = (-1400..1400).map(|step| 10_f64.powf(0.01 * f64::from(step)));
            let mut last = 0.0;
            for size in sizes {
                let place = scale.to_position(size);
                assert!(place > last, "{size}");
                last = place;
                assert_eq!(scale.to_position(-size), -place);
                let back = scale.to_value(place);
                assert!((back - size).abs() <= 1e-12 * size, "{size} {back}");
            }
            assert_eq!(scale.to_position(0.0), 0.0);
            assert!((scale.to_position(10_f64.powi(threshold_exponent)) - 1.0).abs() < 1e-12);
            assert!((scale.to_position(10_f64.powi(threshold_exponent + 3)) - 4.0).abs() < 1e-12);
            assert_eq!(scale.to_position(f64::NEG_INFINITY), f64::NEG_INFINITY);
        }
    }

    #[test]
    fn threshold_follows_the_data() {
        let of =
            |values: &[f64]| SymmetricLog::from_values(values.iter().copied()).threshold_exponent;
        assert_eq!(of(&[-1e6, 250.0, 1e4, f64::INFINITY, f64::NAN, 0.0]), 2);
        assert_eq!(of(&[1e-30, 1e4]), -4);
        assert_eq!(of(&[0.0]), -1);
        assert_eq!(of(&[3.0; 5]), 0);
        let wide = SymmetricLog::from_values_with_decades([1e-12, 1e4].into_iter(), 20);
        assert_eq!(wide.threshold_exponent, -12);
    }

    #[test]
    fn symmetric_logarithmic_ticks_are_powers_of_ten() {
        let ticks = SymmetricLog { threshold_exponent: 2 }.ticks(-5.2, 3.4, 20);
        let mut sorted = ticks.clone();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let expected = ["−10⁶", "−10⁵", "−10⁴", "−10³", "−10²", "0", "10²", "10³", "10⁴"];
        assert_eq!(tick_labels(&sorted), expected);
        let few = SymmetricLog { threshold_exponent: 2 }.ticks(-5.2, 3.4, 5);
        let few: Vec<&str> =
            tick_labels(&few).into_iter().filter(|label| !label.is_empty()).collect();
        assert_eq!(few, ["0", "10⁴", "−10⁴", "−10⁶"]);
    }
}
