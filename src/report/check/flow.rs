//! Check report of a flow: table and pictures.

use super::{
    Disagreement, format_agreement, format_max_error, format_scientific, format_signed_scientific,
    format_significant, format_unmeasured_count,
};
use crate::case::Case;
use crate::report::format::{case_title, format_coaxial_note, format_order, format_short};
use crate::report::parameters::with_parameters;
use crate::study::check::flow::{FlowCheck, ModeCheck, RateCurve};
use crate::study::check::refinement::{FastestModeCheck, GrowthOrders, RefinementCheck};
use figures::{LabelledCurve, SpectrumFigure};
use std::fmt::Write as _;

pub(super) const FLOW_CHECK_UNITS: [(&str, &str); 5] = [
    ("growth_rate", "1/s"),
    ("frequency", "rad/s"),
    ("tolerance", "1/s"),
    ("number", "1/m"),
    ("duration", "s"),
];

/// Names of the modes of a wave, by descending growth rate.
const MODE_NAMES: [&str; 2] = ["first", "second"];

/// Returns the line of column headers.
pub(super) fn column_headers() -> String {
    format!(
        "{:<24}{:>13}{:>13}{:>10}{:>11}{:>7}{:>21}\n",
        "", "predicted", "measured", "error", "tolerance", "order", "(γ_frozen − γ)/Q_D"
    )
}

impl FlowCheck {
    /// Returns the modes and grid refinements that disagree.
    pub(super) fn disagreements(&self) -> Vec<Disagreement> {
        let rows = self.mode_checks.iter().filter(|row| row.is_in_agreement == Some(false));
        let mut all: Vec<Disagreement> = rows
            .map(|row| {
                let mut text = String::new();
                row.write_row(self.shear_rate, &mut text);
                let error = row.rate_difference.map(|own| own.max_norm() / row.rate_scale);
                Disagreement {
                    heading: row.format_wave_vector(),
                    row: text,
                    error: error.unwrap_or(f64::INFINITY),
                }
            })
            .collect();
        let refinements = self.refinements.iter().filter(|own| !own.is_in_agreement);
        all.extend(refinements.map(|own| {
            let mut row = String::new();
            own.write_table(&mut row);
            let errors =
                own.fastest_modes.iter().map(|grid| grid.relative_error(own.shear_rate).abs());
            Disagreement { heading: String::new(), row, error: errors.fold(0.0, f64::max) }
        }));
        all
    }

    pub(super) fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\n{}\n", case_title(case), case.medium().title());
        text.push_str(
            "growth rates γ in 1/s of waves advected by the mean flow; errors relative to max(|γ|, Q_D), Q_D \
             the shear rate\n\n",
        );
        text.push_str(&column_headers());
        let mut last = None;
        for row in &self.mode_checks {
            if last != Some(row.wave) {
                let _ = writeln!(text, "{}", row.format_wave_vector());
                last = Some(row.wave);
            }
            row.write_row(self.shear_rate, &mut text);
        }
        for refinement in &self.refinements {
            refinement.write_table(&mut text);
        }
        let [all, failed] = self.item_and_failure_counts();
        let found = match (failed, self.is_in_agreement()) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} of {all} DISAGREE"),
        };
        let error = format_max_error(self.max_relative_difference());
        let _ =
            writeln!(text, "\n{error}{found}{}", format_unmeasured_count(self.unmeasured_count()));
        text
    }

    /// Creates the figure of growth and decay rates |γ|, 1/s, against the wave number: curves of rates predicted at the
    /// initial wave vector, and rings for measured rates.
    pub(super) fn create_figure(&self, case: &Case) -> SpectrumFigure {
        let line = |curve: &RateCurve| {
            let sign = if curve.is_growing { "grows" } else { "decays" };
            LabelledCurve {
                label: format!("at {}°: {sign}", format_short(curve.direction_deg)),
                points: curve.predicted_points.clone(),
            }
        };
        SpectrumFigure {
            title: case_title(case),
            subtitle: with_parameters(
                &format!(
                    "{}: curves from the analysis, rings from the solver{}",
                    case.medium().title(),
                    format_unmeasured_count(self.unmeasured_count()),
                ),
                case,
            ),
            x_label: "initial wave number k (1/m)".to_owned(),
            y_label: "growth or decay rate |γ| (1/s)".to_owned(),
            spectra: self.rate_curves.iter().map(line).collect(),
            measured_points: self
                .rate_curves
                .iter()
                .map(|curve| curve.measured_points.clone())
                .collect(),
            disagreeing_points: self.collect_disagreeing_points(),
            remarks: Vec::new(),
        }
    }

    /// Returns the measured points of the rate curves that disagree with the prediction.
    fn collect_disagreeing_points(&self) -> Vec<[f64; 2]> {
        let rows = self.mode_checks.iter().filter(|row| row.is_in_agreement == Some(false));
        let points = rows.filter_map(|row| {
            Some([row.wave.wave_number, row.extrapolated_rate?.growth_rate.abs()])
        });
        let is_drawn = |point: &[f64; 2]| {
            self.rate_curves.iter().any(|curve| curve.measured_points.contains(point))
        };
        points.filter(is_drawn).collect()
    }

    /// Creates the figure of the growth rate of the fastest growing wave of each grid, 1/s, against its wave number,
    /// with one curve per model. The curve has no points if the fastest mode does not grow on every grid; a remark in the
    /// legend then names the model. `None` without refinement.
    pub(super) fn create_refinement_figure(&self, case: &Case) -> Option<SpectrumFigure> {
        let points =
            |own: &RefinementCheck, value: fn(&FastestModeCheck) -> f64| -> Vec<[f64; 2]> {
                let grids = own.fastest_modes.iter().filter(|_| own.is_growing);
                grids.map(|grid| [grid.wave_number, value(grid)]).collect()
            };
        let first = self.refinements.first()?;
        let counts: Vec<String> =
            first.fastest_modes.iter().map(|grid| format!("{}²", grid.point_counts[0])).collect();
        let line = |own: &RefinementCheck| LabelledCurve {
            label: own.model_title.to_owned(),
            points: points(own, |grid| grid.predicted_growth),
        };
        let without_growth = self
            .refinements
            .iter()
            .filter(|own| !own.is_growing)
            .map(|own| format!("{}: nothing grows on any grid", own.model_title));
        let failed = self
            .refinements
            .iter()
            .filter(|own| own.is_growing)
            .flat_map(|own| own.fastest_modes.iter().filter(|grid| !grid.is_in_agreement));
        let disagreeing = failed.map(|grid| [grid.wave_number, grid.measured_growth]);
        Some(SpectrumFigure {
            title: case_title(case),
            subtitle: with_parameters(
                &format!(
                    "grids of {} points: lines from the analysis, rings from the solver",
                    counts.join(", ")
                ),
                case,
            ),
            x_label: "wave number k of the fastest growing wave (1/m)".to_owned(),
            y_label: "growth rate γ (1/s)".to_owned(),
            spectra: self.refinements.iter().map(line).collect(),
            measured_points: self
                .refinements
                .iter()
                .map(|own| points(own, |grid| grid.measured_growth))
                .collect(),
            disagreeing_points: disagreeing.collect(),
            remarks: without_growth.collect(),
        })
    }
}

impl ModeCheck {
    fn format_wave_vector(&self) -> String {
        let (k, along) =
            (format_short(self.wave.wave_number), format_short(self.wave.direction_deg));
        format!("k = {k} 1/m at {along}°")
    }

    fn write_row(&self, shear_rate: f64, text: &mut String) {
        let name = MODE_NAMES[(self.mode_number - 1).min(1)];
        let predicted = self.predicted_rate.growth_rate;
        let (Some(limit), Some(difference), Some(tolerance)) =
            (self.extrapolated_rate, self.rate_difference, self.tolerance)
        else {
            let reason = self.unmeasured_reason.as_deref().unwrap_or_default();
            let growth = format_significant(predicted);
            let _ = writeln!(text, "  {name:<22}{growth:>13}  not measurable: {reason}");
            return;
        };
        let _ = writeln!(
            text,
            "  {:<22}{:>13}{:>13}{:>10}{:>11}{:>7}{:>21}  {}",
            name,
            format_significant(predicted),
            format_significant(limit.growth_rate),
            format_signed_scientific(difference.growth_rate / self.rate_scale),
            format_scientific(tolerance / self.rate_scale),
            self.convergence_order.map_or("–".into(), |order| format!("{order:.2}")),
            format!("{:+.3}", (self.frozen_rate.growth_rate - predicted) / shear_rate),
            format_agreement(self.is_in_agreement == Some(true)),
        );
    }
}

impl FastestModeCheck {
    /// Returns measured minus predicted growth rate, relative to max(|γ|, Q_D), Q_D the shear rate, 1/s.
    fn relative_error(&self, shear_rate: f64) -> f64 {
        (self.measured_growth - self.predicted_growth) / self.predicted_growth.abs().max(shear_rate)
    }
}

impl RefinementCheck {
    fn write_table(&self, text: &mut String) {
        let title = self.model_title;
        let _ = writeln!(text, "\n{title}: the fastest growing wave of each grid, rates in 1/s");
        if let Some(delta) = self.replaced_noncoaxiality_deg {
            let _ = writeln!(text, "  {}", format_coaxial_note(delta));
        }
        for grid in &self.fastest_modes {
            let [columns, rows] = grid.point_counts;
            let _ = writeln!(
                text,
                "  {:<22}{:>13}{:>13}{:>10}  {}",
                format!("{columns} × {rows} points"),
                format_significant(grid.predicted_growth),
                format_significant(grid.measured_growth),
                format_signed_scientific(grid.relative_error(self.shear_rate)),
                format_agreement(grid.is_in_agreement),
            );
        }
        let verdict = format_agreement(self.is_in_agreement);
        let _ = match self.growth_orders {
            Some(GrowthOrders { predicted_order: predicted, measured_order: measured }) => {
                writeln!(
                    text,
                    "  order in k: predicted {predicted:.4}, measured {measured:.4}, as k → ∞ {}  {verdict}",
                    format_order(self.verdict_order),
                )
            }
            None if self.is_growing => writeln!(
                text,
                "  one wave number is the fastest on all grids: no order in k  {verdict}",
            ),
            None => writeln!(
                text,
                "  nothing grows faster than the mean flow deforms{}  {verdict}",
                if self.verdict_order > 0.0 { ": too coarse for an order" } else { "" },
            ),
        };
    }
}
