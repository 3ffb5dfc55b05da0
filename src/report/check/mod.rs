//! Report on the comparison of measured with predicted waves.

mod blocks;
mod equations;
mod flow;
mod shocks;
mod solid;

use super::format::case_title;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::check::{CheckOutcome, CheckResult};
use figures::NoteFigure;
use models::common::elementary::Elementary;

impl Report for CheckResult {
    const NAME: &'static str = "check";

    fn units(&self) -> &'static [(&'static str, &'static str)] {
        match &self.outcome {
            CheckOutcome::NotMeasurable { .. } => &[],
            CheckOutcome::Equations(_) => &equations::EQUATIONS_CHECK_UNITS,
            CheckOutcome::Solid(_) => &solid::SOLID_CHECK_UNITS,
            CheckOutcome::Flow(_) => &flow::FLOW_CHECK_UNITS,
            CheckOutcome::Shocks(_) => &shocks::SHOCK_CHECK_UNITS,
        }
    }

    fn to_text(&self, case: &Case) -> String {
        let text = self.outcome_to_text(case);
        match (&self.solid_verdict, text.split_once('\n')) {
            (Some(verdict), Some((title, rest))) => {
                format!("{title}\nverdict of the analysis: {verdict}\n{rest}")
            }
            _ => text,
        }
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        Ok(match &self.outcome {
            CheckOutcome::NotMeasurable { reason } => {
                let (title, subtitle) = (case_title(case), self.medium_title.clone());
                let text = format!("not measurable: {reason}");
                let figure = NoteFigure { title, subtitle, text, is_disagreement: false };
                vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))]
            }
            CheckOutcome::Equations(own) => {
                let (title, subtitle) = (case_title(case), self.medium_title.clone());
                let is_disagreement = !own.is_in_agreement();
                let figure = NoteFigure { title, subtitle, text: own.summary(), is_disagreement };
                vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))]
            }
            CheckOutcome::Solid(own) => {
                let figure = own.medium_checks[0].create_figure(case);
                vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))]
            }
            CheckOutcome::Shocks(own) => vec![match own.create_figure(case) {
                Ok(figure) => ReportPicture::new(Self::NAME, move |format| figure.draw(format)),
                Err(note) => ReportPicture::new(Self::NAME, move |format| note.draw(format)),
            }],
            CheckOutcome::Flow(own) => {
                let figure = own.create_figure(case);
                let refinement = own.create_refinement_figure(case);
                let refinement = refinement.map(|figure| {
                    ReportPicture::new("refinement", move |format| figure.draw(format))
                });
                let all = [ReportPicture::new(Self::NAME, move |format| figure.draw(format))];
                all.into_iter().chain(refinement).collect()
            }
        })
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(Vec::new())
    }
}

/// Row of a check whose measurement and prediction disagree.
struct Disagreement {
    /// Line above the row, such as the wave vector; empty if the row says all.
    heading: String,
    /// Line of the table, or lines.
    row: String,
    /// Relative error by which rows are sorted.
    error: f64,
}

impl CheckResult {
    fn outcome_to_text(&self, case: &Case) -> String {
        match &self.outcome {
            CheckOutcome::NotMeasurable { reason } => {
                let (title, medium) = (case_title(case), &self.medium_title);
                format!("{title}\n{medium}\n\nnot measurable: {reason}\n")
            }
            CheckOutcome::Equations(own) => own.to_text(case),
            CheckOutcome::Flow(own) => own.to_text(case),
            CheckOutcome::Solid(own) => own.to_text(case),
            CheckOutcome::Shocks(own) => own.to_text(case, &self.medium_title),
        }
    }

    /// Renders title, rows that disagree, from the largest relative error to the smallest, and summary.
    pub fn render_disagreements(&self, case: &Case) -> String {
        let mut text = format!("{}\n", case_title(case));
        let (mut rows, header) = match &self.outcome {
            CheckOutcome::NotMeasurable { reason } => {
                return format!("{text}not measurable: {reason}\n");
            }
            CheckOutcome::Equations(own) => (own.disagreements(), String::new()),
            CheckOutcome::Flow(own) => (own.disagreements(), flow::column_headers()),
            CheckOutcome::Solid(own) => {
                (own.disagreements(), solid::column_headers("error (coarse)"))
            }
            CheckOutcome::Shocks(own) => (own.disagreements(), shocks::column_headers()),
        };
        rows.sort_by(|one, other| other.error.total_cmp(&one.error));
        if !rows.is_empty() {
            text += &header;
        }
        let mut last = String::new();
        for own in rows {
            if !own.heading.is_empty() && own.heading != last {
                text += &format!("{}\n", own.heading);
            }
            text += &own.row;
            last = own.heading;
        }
        let [all, failed] = self.item_and_failure_counts();
        let verdict = if failed == 0 {
            ": all agree".to_owned()
        } else {
            format!(": {failed} of {all} DISAGREE")
        };
        let error = format_max_error(self.max_relative_difference());
        text + &format!("{error}{verdict}{}\n", format_unmeasured_count(self.unmeasured_count()))
    }
}

/// Formats `largest`, the largest relative error of measured rates; `None` stands for no measurement.
fn format_max_error(largest: Option<f64>) -> String {
    largest.map_or("nothing measured".to_owned(), |error| {
        format!("maximum error {}", format_scientific(error))
    })
}

/// Formats the number of branches or modes without measurement as the suffix of a line; empty if zero.
pub fn format_unmeasured_count(count: usize) -> String {
    if count == 0 { String::new() } else { format!("; {count} not measurable") }
}

/// Last word of a row whose measurement and prediction disagree.
const DISAGREES: &str = "DISAGREES";

fn format_agreement(is_in_agreement: bool) -> &'static str {
    if is_in_agreement { "agrees" } else { DISAGREES }
}

/// Formats a number in scientific notation with two significant digits: `3.2e-7`; zero as `0`.
pub fn format_scientific(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Formats a number in scientific notation with two significant digits and its sign: `+3.2e-7`; zero as `0`.
fn format_signed_scientific(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:+.1e}") }
}

/// Formats a frequency or rate like [`format_significant`], with its sign.
fn format_signed_significant(x: f64) -> String {
    format!("{}{}", if x.is_sign_negative() { "-" } else { "+" }, format_significant(x.abs()))
}

/// Formats a frequency or rate with seven significant digits, or six outside of 10⁻³ to 10⁶.
fn format_significant(x: f64) -> String {
    match x.abs() {
        0.0 => "0".into(),
        size if (1e-3..1e6).contains(&size) => {
            let after = (6 - size.cr_log10().floor() as i32).clamp(0, 9) as usize;
            format!("{x:.after$}")
        }
        _ => format!("{x:.5e}"),
    }
}
