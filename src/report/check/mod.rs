//! Report on the comparison of measured with predicted waves.

mod flow;
mod solid;

use super::format::case_title;
use super::{Picture, Report};
use crate::Error;
use crate::case::Case;
use crate::study::check::{CheckResult, Outcome};
use figures::NoteFigure;
use models::common::elementary::Elementary;

impl Report for CheckResult {
    const NAME: &'static str = "check";

    fn units(&self) -> &'static [(&'static str, &'static str)] {
        match &self.outcome {
            Outcome::NotMeasurable { .. } => &[],
            Outcome::Solid(_) => &solid::UNITS,
            Outcome::Flow(_) => &flow::UNITS,
        }
    }

    fn text(&self, case: &Case) -> String {
        match &self.outcome {
            Outcome::NotMeasurable { not_measurable } => {
                let (title, medium) = (case_title(case), &self.model);
                format!("{title}\n{medium}\n\nnot measurable: {not_measurable}\n")
            }
            Outcome::Flow(own) => own.text(case),
            Outcome::Solid(own) => own.text(case),
        }
    }

    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error> {
        Ok(match &self.outcome {
            Outcome::NotMeasurable { not_measurable } => {
                let (title, subtitle) = (case_title(case), self.model.clone());
                let figure = NoteFigure {
                    title,
                    subtitle,
                    text: format!("not measurable: {not_measurable}"),
                };
                vec![Picture::new(Self::NAME, move |format| figure.draw(format))]
            }
            Outcome::Solid(own) => {
                let figure = own.media[0].figure(case);
                vec![Picture::new(Self::NAME, move |format| figure.draw(format))]
            }
            Outcome::Flow(own) => {
                let figure = own.figure(case);
                let refinement = own.refinement_figure(case);
                let refinement = refinement
                    .map(|figure| Picture::new("refinement", move |format| figure.draw(format)));
                let all = [Picture::new(Self::NAME, move |format| figure.draw(format))];
                all.into_iter().chain(refinement).collect()
            }
        })
    }

    fn tables(&self, _case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        Ok(Vec::new())
    }
}

/// Describes the greatest relative difference of the measured waves.
fn greatest_difference_words(greatest: Option<f64>) -> String {
    greatest.map_or("nothing measured".to_owned(), |own| format!("{} off at most", exponent(own)))
}

/// Describes the number of waves without measurement; empty if zero.
pub fn unmeasured_words(count: usize) -> String {
    if count == 0 { String::new() } else { format!("; {count} not measurable") }
}

fn verdict_words(agrees: bool) -> &'static str {
    if agrees { "agrees" } else { "DISAGREES" }
}

/// Formats a number in scientific notation with two digits: `3.2e-7`.
pub fn exponent(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Formats a number in scientific notation with two digits and its sign.
fn signed_exponent(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:+.1e}") }
}

/// Formats a frequency or rate with seven significant digits, or six outside of 10⁻³ to 10⁶.
fn digits(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => {
            let after = (6 - size.cr_log10().floor() as i32).clamp(0, 9) as usize;
            format!("{x:.after$}")
        }
        _ => format!("{x:.5e}"),
    }
}
