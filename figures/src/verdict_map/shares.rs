//! Formatting of percentages.

/// Formats the ratio `part`/`whole` in percent; 0 % and 100 % are written only if exact.
pub(crate) fn format_percent(part: usize, whole: usize) -> String {
    let share = 100.0 * part as f64 / whole.max(1) as f64;
    if part == whole {
        "100 %".to_owned()
    } else if part == 0 {
        "0 %".to_owned()
    } else if share < 0.05 {
        "<0.1 %".to_owned()
    } else if share >= 99.95 {
        ">99.9 %".to_owned()
    } else {
        format!("{share:.1} %")
    }
}
