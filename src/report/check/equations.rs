//! Check report of a model given as equations.

use super::{format_agreement, format_max_error, format_scientific};
use crate::case::Case;
use crate::report::format::{case_title, format_short};
use crate::study::check::equations::EquationsCheck;
use std::fmt::Write as _;

pub(super) const EQUATIONS_CHECK_UNITS: [(&str, &str); 2] =
    [("wave_vector", "1/m"), ("rate", "1/s")];

impl EquationsCheck {
    pub(super) fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\n{}\n\n", case_title(case), case.medium().title());
        text.push_str(
            "symbol L(ς, ik) of the linearised equations against differences of the equations on Fourier fields; \
             errors relative to the terms of an entry\n\n",
        );
        for own in &self.wave_checks {
            let vector: Vec<String> = own.wave_vector.iter().map(|k| format_short(*k)).collect();
            let _ = writeln!(
                text,
                "k = ({}) 1/m, ς = {} {:+.3e} i 1/s: error {}{}, {}",
                vector.join(", "),
                format_short(own.rate[0]),
                own.rate[1],
                format_scientific(own.error),
                if own.error > 0.0 {
                    format!(" ({}, {})", own.equation, own.unknown)
                } else {
                    String::new()
                },
                format_agreement(own.is_in_agreement)
            );
        }
        let (largest, tolerance) =
            (format_max_error(self.max_error()), format_scientific(self.tolerance));
        let _ = writeln!(
            text,
            "\n{} waves, {largest}, tolerance {tolerance}\nnot measured: {}",
            self.wave_checks.len(),
            self.not_measured
        );
        text
    }

    fn max_error(&self) -> Option<f64> {
        self.wave_checks.iter().map(|own| own.error).reduce(f64::max)
    }

    /// Text for the picture.
    pub(super) fn summary(&self) -> String {
        let agree = self.wave_checks.iter().all(|own| own.is_in_agreement);
        format!(
            "{} waves, {}: {}",
            self.wave_checks.len(),
            format_max_error(self.max_error()),
            format_agreement(agree)
        )
    }
}
