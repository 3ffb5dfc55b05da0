//! Check report of a model given as equations.

use super::{
    Disagreement, format_agreement, format_max_error, format_scientific, format_signed_significant,
    format_significant,
};
use crate::case::Case;
use crate::report::format::{case_title, format_count, format_short};
use crate::study::check::equations::{EquationsCheck, EvolutionCheck, ModeCheck, WaveCheck};
use std::fmt::Write as _;

pub(super) const EQUATIONS_CHECK_UNITS: [(&str, &str); 5] = [
    ("wave_vector", "1/m"),
    ("rate", "1/s"),
    ("predicted", "1/s"),
    ("measured", "1/s"),
    ("rate_tolerance", "1/s"),
];

impl EquationsCheck {
    pub(super) fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\n{}\n\n", case_title(case), case.medium().title());
        text.push_str(
            "symbol L(ς, ik) of the linearised equations against differences of the equations on Fourier fields; \
             errors relative to the terms of an entry\n\n",
        );
        for own in &self.wave_checks {
            let _ = writeln!(text, "{}", own.format_row());
        }
        self.write_evolution(&mut text);
        let (largest, tolerance) =
            (format_max_error(self.max_error()), format_scientific(self.tolerance));
        let _ = write!(
            text,
            "\n{}, {largest}, tolerance {tolerance}\n{}",
            format_count(self.wave_checks.len(), "wave"),
            self.describe_rates(),
        );
        text
    }

    /// Returns the waves that disagree, with the modes that disagree.
    pub(super) fn disagreements(&self) -> Vec<Disagreement> {
        let waves = self.wave_checks.iter().filter(|own| !own.is_in_agreement);
        waves
            .map(|own| {
                let mut row = format!("{}\n", own.format_row());
                let mut error = own.error;
                if let Some(evolution) = &own.evolution {
                    let _ = writeln!(row, "  {}", evolution.summarise());
                    for mode in evolution.modes.iter().filter(|mode| !mode.is_in_agreement) {
                        let _ = writeln!(row, "{}", format_mode(mode));
                    }
                    error = error.max(evolution.max_relative_difference);
                }
                Disagreement { heading: String::new(), row, error }
            })
            .collect()
    }

    fn write_evolution(&self, text: &mut String) {
        if self.wave_checks.iter().all(|own| own.evolution.is_none()) {
            return;
        }
        text.push_str(
            "\nplane waves in time: the differences integrated by the Radau IIA method of order 5, against the roots ς of \
             the linearised equations; 1/s, in the frame of the background velocity\n",
        );
        for (own, evolution) in
            self.wave_checks.iter().filter_map(|own| Some((own, own.evolution.as_ref()?)))
        {
            let _ =
                writeln!(text, "\nk = {} 1/m: {}", own.format_wave_vector(), evolution.summarise());
            for mode in &evolution.modes {
                let _ = writeln!(text, "{}", format_mode(mode));
            }
        }
    }

    fn describe_rates(&self) -> String {
        let found: Vec<&EvolutionCheck> =
            self.wave_checks.iter().filter_map(|own| own.evolution.as_ref()).collect();
        let mut text = String::new();
        if !found.is_empty() {
            let modes: usize = found.iter().map(|own| own.modes.len()).sum();
            let largest = found.iter().map(|own| own.max_relative_difference).reduce(f64::max);
            let _ = writeln!(
                text,
                "{} waves in time, {modes} modes, {} of the largest root",
                found.len(),
                format_max_error(largest)
            );
        }
        if self.singular_count > 0 {
            let _ = writeln!(
                text,
                "not measured: evolution in time of {} waves, which the equations do not determine (singular pencil)",
                self.singular_count
            );
        }
        text
    }

    fn max_error(&self) -> Option<f64> {
        self.wave_checks.iter().map(|own| own.error).reduce(f64::max)
    }

    /// Text for the picture.
    pub(super) fn summary(&self) -> String {
        let agree = self.wave_checks.iter().all(|own| own.is_in_agreement);
        format!(
            "{}, {}: {}",
            format_count(self.wave_checks.len(), "wave"),
            format_max_error(self.max_error()),
            format_agreement(agree)
        )
    }
}

impl WaveCheck {
    /// Formats the comparison of the symbol as a line.
    fn format_row(&self) -> String {
        let place = match self.error > 0.0 {
            true => format!(" ({}, {})", self.equation, self.unknown),
            false => String::new(),
        };
        format!(
            "k = {} 1/m, ς = {} {:+.3e} i 1/s: error {}{place}, {}",
            self.format_wave_vector(),
            format_short(self.rate[0]),
            self.rate[1],
            format_scientific(self.error),
            format_agreement(self.is_symbol_in_agreement)
        )
    }

    fn format_wave_vector(&self) -> String {
        let components: Vec<String> = self.wave_vector.iter().map(|k| format_short(*k)).collect();
        format!("({})", components.join(", "))
    }
}

/// Formats the comparison of a mode as a line.
fn format_mode(mode: &ModeCheck) -> String {
    let rate = |[re, im]: [f64; 2]| {
        format!("{} {} i", format_significant(re), format_signed_significant(im))
    };
    format!(
        "  predicted {}, measured {}, tolerance {}, {}",
        rate(mode.predicted),
        rate(mode.measured),
        format_scientific(mode.tolerance),
        format_agreement(mode.is_in_agreement)
    )
}

impl EvolutionCheck {
    /// Numbers of roots and solutions, constraints, and the recurrence, in words.
    fn summarise(&self) -> String {
        let mut text = format!("roots: {}", self.root_count);
        let multiple = self.root_count - self.modes.len();
        if multiple > 0 {
            let _ = write!(text, ", of which multiple: {multiple}");
        }
        if self.solution_count != self.root_count {
            let _ = write!(text, "; solutions in time: {}, DISAGREES", self.solution_count);
        }
        if self.differentiation_count > 0 {
            let _ = write!(
                text,
                "; constraints differentiated: {}, residual {}",
                self.differentiation_count,
                format_scientific(self.constraint_residual)
            );
        }
        let agrees = self.recurrence_error <= self.recurrence_tolerance;
        let _ = write!(
            text,
            "; all modes together: error {}, tolerance {}, {}",
            format_scientific(self.recurrence_error),
            format_scientific(self.recurrence_tolerance),
            format_agreement(agrees)
        );
        text
    }
}
