//! Check report of plane waves in granular and porous media: tables and picture.

use super::{
    Disagreement, format_agreement, format_max_error, format_scientific, format_signed_scientific,
    format_significant, format_unmeasured_count,
};
use crate::case::Case;
use crate::report::format::{case_title, format_short};
use crate::study::check::shocks::{ColumnCheck, QuantityCheck, ShockCheck};
use figures::{CurvePanel, LabelledCurve, NoteFigure, PanelsFigure};
use std::fmt::Write as _;

pub(super) const SHOCK_CHECK_UNITS: [(&str, &str); 1] = [("time", "s")];

const MEGAPASCAL: f64 = 1e6;
const MILLISECOND: f64 = 1e-3;

/// Returns the line of column headers.
pub(super) fn column_headers() -> String {
    format!(
        "  {:<44}{:>6} {:>13}{:>13}{:>12}{:>11}\n",
        "", "", "predicted", "measured", "difference", "tolerance",
    )
}

impl ShockCheck {
    /// Returns the quantities that disagree.
    pub(super) fn disagreements(&self) -> Vec<Disagreement> {
        let rows = self
            .columns
            .iter()
            .flat_map(|column| column.quantity_checks.iter().map(move |row| (column, row)));
        rows.filter(|(_, row)| row.is_in_agreement == Some(false))
            .map(|(column, row)| {
                let mut text = String::new();
                row.write_row(&mut text);
                Disagreement {
                    heading: column.format_heading(),
                    row: text,
                    error: row.relative_difference.map_or(f64::INFINITY, f64::abs),
                }
            })
            .collect()
    }

    pub(super) fn to_text(&self, case: &Case, medium_title: &str) -> String {
        let mut text = format!("{}\n{medium_title}\n", case_title(case));
        for column in &self.columns {
            column.write_table(&mut text);
        }
        let [all, failed] = self.item_and_failure_counts();
        let verdict = match (failed, self.is_in_agreement()) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{all} quantities, {}{verdict}{}",
            format_max_error(self.max_relative_difference()),
            format_unmeasured_count(self.unmeasured_count()),
        );
        text
    }

    /// Creates the figure of the finest column of each problem; a note if there is no measurement.
    pub(super) fn create_figure(&self, case: &Case) -> Result<PanelsFigure, NoteFigure> {
        let mut columns: Vec<&ColumnCheck> = Vec::new();
        for own in self.columns.iter().filter(|own| own.unmeasured_reason.is_none()) {
            columns.retain(|other| other.problem != own.problem);
            columns.push(own);
        }
        let title = case_title(case);
        if columns.is_empty() {
            let reason = self.columns.iter().find_map(|own| own.unmeasured_reason.clone());
            let text = format!("not measurable: {}", reason.unwrap_or_default());
            return Err(NoteFigure {
                title,
                subtitle: String::new(),
                text,
                is_disagreement: false,
            });
        }
        let describe = |own: &&ColumnCheck| {
            let time = format_short(own.time / MILLISECOND);
            format!("{}: {} cells, t = {time} ms", own.problem, own.cells)
        };
        let descriptions: Vec<String> = columns.iter().map(describe).collect();
        let subtitle = descriptions.join("; ");
        Ok(PanelsFigure {
            title,
            subtitle,
            panels: columns.iter().flat_map(|own| own.create_panels()).collect(),
        })
    }
}

impl ColumnCheck {
    fn format_heading(&self) -> String {
        format!("{}: {} cells", self.problem, self.cells)
    }

    fn write_table(&self, text: &mut String) {
        let _ = writeln!(text, "\n{}", self.format_heading());
        if let Some(reason) = &self.unmeasured_reason {
            let _ = writeln!(text, "not measurable: {reason}");
            return;
        }
        let _ = writeln!(
            text,
            "{} steps, profile at t = {} s; differences relative to the predicted value, or to the load where that is 0\n\n{}",
            self.steps,
            format_short(self.time),
            column_headers().trim_end_matches('\n'),
        );
        for row in &self.quantity_checks {
            row.write_row(text);
        }
    }

    /// Creates the panels of pressure and velocity.
    fn create_panels(&self) -> [CurvePanel; 2] {
        let x_label = match self.problem {
            "spall" => "distance from the free end d (m)",
            _ => "position x₁ (m)",
        };
        let end = self.measured_profile.last().map_or(0.0, |own| own[0]);
        // A quantity that disagrees is shown by the panel of its unit; positions and times concern both.
        let disagrees = |other_unit: &str| {
            let mut failed =
                self.quantity_checks.iter().filter(|own| own.is_in_agreement == Some(false));
            failed.any(|own| own.unit != other_unit)
        };
        let panel =
            |[y_label, other_unit]: [&str; 2], exact: Vec<[f64; 2]>, measured: Vec<[f64; 2]>| {
                let disagrees = disagrees(other_unit);
                let label = if disagrees { "solver, disagrees" } else { "solver" };
                CurvePanel {
                    x_label: x_label.into(),
                    y_label: y_label.into(),
                    curves: vec![LabelledCurve { label: label.into(), points: measured }],
                    disagreeing_label: disagrees.then(|| label.into()),
                    reference_lines: vec![LabelledCurve {
                        label: "exact solution".into(),
                        points: exact,
                    }],
                    ..CurvePanel::default()
                }
            };
        let exact = |value: fn(&crate::study::shocks::FrontState) -> f64| {
            let points = self.exact_profile.iter();
            points.map(|own| [own.position.min(end), value(&own.state)]).collect()
        };
        let measured = |value: fn(&[f64; 3]) -> f64| {
            self.measured_profile.iter().map(|own| [own[0], value(own)]).collect()
        };
        let mut pressure = panel(
            ["pressure −σ₁₁ (MPa)", "m/s"],
            exact(|own| own.pressure / MEGAPASCAL),
            measured(|own| own[2] / MEGAPASCAL),
        );
        // Where no pressure remains, the axis shows the deviations beside the pressure of the pulse.
        let scales = self.quantity_checks.iter().filter(|own| own.unit == "Pa");
        let scale = scales.map(|own| own.scale / MEGAPASCAL).fold(0.0, f64::max);
        let drawn = pressure.curves.iter().chain(&pressure.reference_lines);
        let [least, greatest] = drawn
            .flat_map(|curve| &curve.points)
            .fold([0.0, scale], |[least, greatest]: [f64; 2], point| {
                [least.min(point[1]), greatest.max(point[1])]
            });
        pressure.y_values = Some([least, greatest]);
        [
            pressure,
            panel(["velocity (m/s)", "Pa"], exact(|own| own.velocity), measured(|own| own[1])),
        ]
    }
}

impl QuantityCheck {
    fn write_row(&self, text: &mut String) {
        let _ = write!(
            text,
            "  {:<44}{:>6} {:>13}",
            self.quantity,
            self.unit,
            format_significant(self.predicted)
        );
        let (Some(measured), Some(difference)) = (self.measured, self.relative_difference) else {
            let reason = self.unmeasured_reason.as_deref().unwrap_or_default();
            let _ = writeln!(text, "  not measurable: {reason}");
            return;
        };
        let _ = writeln!(
            text,
            "{:>13}{:>12}{:>11}  {}",
            format_significant(measured),
            format_signed_scientific(difference),
            format_scientific(self.tolerance),
            format_agreement(self.is_in_agreement == Some(true)),
        );
    }
}
