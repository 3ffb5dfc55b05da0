//! The results of a flow: table, JSON and pictures.

use super::flow::{Checked, RefinedModel, Wave};
use super::setup::{locate, uniform_flow};
use super::{digits, exponent, unmeasured_words, worst_words};
use crate::Error;
use crate::case::Case;
use crate::report::format::{case_title, coaxial_words, order_words, short};
use agreement::fit::Rate;
use agreement::flows::{FastestMode, ModeResult, StepSequences};
use figures::{Line, SpectrumFigure};
use models::elementary::Elementary;
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Names of a wave's modes, the fastest growing first.
const MODES: [&str; 2] = ["first", "second"];

fn name(row: &ModeResult) -> &'static str {
    MODES[(row.mode - 1).min(1)]
}

/// A rate as γ and ω.
fn rate_json(rate: Rate) -> Value {
    json!({ "growth_rate": rate.growth, "frequency": rate.frequency })
}

impl Checked {
    /// As JSON.
    pub(super) fn report(&self, case: &Case) -> Value {
        let row = |row: &ModeResult| {
            let wave = self.waves[row.wave];
            json!({
                "wave": {
                    "number": wave.number,
                    "direction_deg": wave.direction_deg,
                },
                "mode": row.mode,
                "duration": row.duration,
                "predicted": rate_json(row.predicted),
                "frozen": rate_json(row.frozen),
                "measured": row.measured.iter().flat_map(|own| &own.sequences).map(|(steps, rate)| {
                    let mut own = rate_json(*rate);
                    own["steps"] = json!(steps);
                    own
                }).collect::<Vec<_>>(),
                "limit": row.measured.as_ref().ok().map(|own| rate_json(own.limit)),
                "tolerance": row.measured.as_ref().ok().map(|own| own.tolerance),
                "not_measurable": row.measured.as_ref().err().map(ToString::to_string),
                "order": row.order(),
                "agrees": row.agrees(),
            })
        };
        let refinement = |model: &RefinedModel| {
            let own = &model.refinement;
            json!({
                "model": model.kind.name(),
                "lost_noncoaxiality_deg": model.lost_noncoaxiality_deg,
                "limit_of_the_order": own.verdict_order,
                "orders": own.orders().map(|[predicted, measured]| {
                    json!({ "predicted": predicted, "measured": measured })
                }),
                "grids": own.grids.iter().map(|grid| json!({
                    "points": grid.points,
                    "mode": grid.mode,
                    "number": grid.number,
                    "predicted": grid.predicted,
                    "measured": grid.measured,
                    "agrees": own.grid_agrees(grid),
                })).collect::<Vec<_>>(),
                "agrees": own.agrees(),
            })
        };
        json!({
            "model": case.medium().title(),
            "agrees": self.agrees(),
            "rows": self.rows.iter().map(row).collect::<Vec<_>>(),
            "refinements": self.refinements.iter().map(refinement).collect::<Vec<_>>(),
            "units": {
                "growth_rate": "1/s", "frequency": "rad/s", "tolerance": "1/s", "number": "1/m",
                "duration": "s",
            },
        })
    }

    /// As tables.
    pub(super) fn words(&self, case: &Case) -> String {
        let mut text = format!("{}\n{}\n", case_title(case), case.medium().title());
        let signed = |x: f64| if x == 0.0 { "0".to_owned() } else { format!("{x:+.1e}") };
        text.push_str(
            "growth rates γ in 1/s of waves that the mean flow carries along; differences as parts of the \
             rate, or of the shear rate Q_D where that is greater\n\n",
        );
        let _ = writeln!(
            text,
            "{:<24}{:>13}{:>13}{:>10}{:>10}{:>7}{:>15}",
            "", "predicted", "measured", "differs", "within", "order", "frozen, in Q_D"
        );
        let mut last = None;
        for row in &self.rows {
            let wave = self.waves[row.wave];
            if last != Some(wave) {
                let (k, along) = (short(wave.number), short(wave.direction_deg));
                let _ = writeln!(text, "k = {k} 1/m at {along}°");
                last = Some(wave);
            }
            let scale = row.scale(self.shear_rate);
            let predicted = row.predicted;
            let StepSequences { limit, tolerance, .. } = match &row.measured {
                Ok(own) => own,
                Err(reason) => {
                    let (name, growth) = (name(row), digits(predicted.growth));
                    let _ = writeln!(text, "  {name:<22}{growth:>13}  not measurable: {reason}");
                    continue;
                }
            };
            let difference = *limit - predicted;
            let _ = writeln!(
                text,
                "  {:<22}{:>13}{:>13}{:>10}{:>10}{:>7}{:>15}  {}",
                name(row),
                digits(predicted.growth),
                digits(limit.growth),
                signed(difference.growth / scale),
                exponent(tolerance / scale),
                row.order().map_or("–".into(), |order| format!("{order:.2}")),
                format!("{:+.3}", (row.frozen - predicted).growth / self.shear_rate),
                verdict(row.agrees() == Some(true)),
            );
        }
        for model in &self.refinements {
            let _ = writeln!(
                text,
                "\n{}: the fastest growing wave of each grid, rates in 1/s",
                model.kind.title()
            );
            if let Some(delta) = model.lost_noncoaxiality_deg {
                let _ = writeln!(text, "  {}", coaxial_words(delta));
            }
            let own = &model.refinement;
            for grid in &own.grids {
                let [columns, rows] = grid.points;
                let scale = grid.predicted.abs().max(own.shear_rate);
                let _ = writeln!(
                    text,
                    "  {:<22}{:>13}{:>13}{:>10}  {}",
                    format!("{columns} × {rows} points"),
                    digits(grid.predicted),
                    digits(grid.measured),
                    signed((grid.measured - grid.predicted) / scale),
                    verdict(own.grid_agrees(grid)),
                );
            }
            let _ = match own.orders() {
                Some([predicted, measured]) => writeln!(
                    text,
                    "  order in k: predicted {predicted:.4}, measured {measured:.4}, as k → ∞ {}  {}",
                    order_words(own.verdict_order),
                    verdict(own.agrees())
                ),
                None => writeln!(
                    text,
                    "  nothing grows faster than the mean flow deforms{}  {}",
                    if own.verdict_order > 0.0 { ": too coarse for an order" } else { "" },
                    verdict(own.agrees())
                ),
            };
        }
        let [all, failed] = self.counts();
        let found = match (failed, self.agrees()) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} of {all} DISAGREE"),
        };
        let left = unmeasured_words(self.unmeasured());
        let _ = writeln!(text, "\n{}{found}{left}", worst_words(self.worst()));
        text
    }

    /// Rates against the wave number: curves from the analysis, rings from the solver.
    pub(super) fn figure(&self, case: &Case) -> Result<SpectrumFigure, Error> {
        let problem = uniform_flow(case)?;
        let numbers = || self.rows.iter().map(|row| self.waves[row.wave].number);
        let (least, most) =
            (0.5 * numbers().fold(f64::MAX, f64::min), 2.0 * numbers().fold(0.0, f64::max));
        let mut directions: Vec<f64> = Vec::new();
        for row in &self.rows {
            let direction_deg = self.waves[row.wave].direction_deg;
            if !directions.contains(&direction_deg) {
                directions.push(direction_deg);
            }
        }
        let (mut lines, mut rings) = (Vec::new(), Vec::new());
        for direction_deg in directions {
            let own = |mode: usize| {
                self.rows.iter().filter(move |row| {
                    self.waves[row.wave].direction_deg == direction_deg && row.mode == mode
                })
            };
            for mode in 1..=2 {
                let Some(first) = own(mode).next() else { continue };
                // What grows or decays no faster than the mean flow deforms is not short waves' doing; and next
                // to a degenerate direction the rate at the beginning is not that of the way.
                let is_slow = |row: &ModeResult| row.predicted.growth.abs() < 3.0 * self.shear_rate;
                let has_turned = |row: &ModeResult| {
                    (row.frozen - row.predicted).max_norm() > 0.1 * row.predicted.max_norm()
                };
                if own(mode).all(is_slow) || own(mode).any(has_turned) {
                    continue;
                }
                let sign = if first.predicted.growth > 0.0 { "grows" } else { "decays" };
                let point = |index: u32| {
                    let number = least * (most / least).cr_powf(f64::from(index) / 80.0);
                    let wave = Wave { number, direction_deg }.plane_wave();
                    let rates =
                        problem.initial_rates(&wave).map_err(|error| locate(case, error))?;
                    Ok([number, rates.get(mode - 1).map_or(f64::NAN, |own| own.re.abs())])
                };
                lines.push(Line {
                    label: format!("at {}°: {sign}", short(direction_deg)),
                    points: (0..=80).map(point).collect::<Result<_, Error>>()?,
                });
                let ring = |row: &ModeResult| {
                    let own = row.measured.as_ref().ok()?;
                    Some([self.waves[row.wave].number, own.limit.growth.abs()])
                };
                rings.push(own(mode).filter_map(ring).collect());
            }
        }
        Ok(SpectrumFigure {
            title: case_title(case),
            subtitle: format!(
                "{}: curves from the analysis, rings from the solver{}",
                case.medium().title(),
                unmeasured_words(self.unmeasured()),
            ),
            x_label: "wave number k at the beginning, 1/m".to_owned(),
            y_label: "growth or decay rate |γ|, 1/s".to_owned(),
            lines,
            rings,
        })
    }

    /// Rates of the fastest growing wave of each grid, model by model.
    pub(super) fn refinement_figure(&self, case: &Case) -> Option<SpectrumFigure> {
        let points = |own: &RefinedModel, value: fn(&FastestMode) -> f64| -> Vec<[f64; 2]> {
            let own = &own.refinement;
            let grids = own.grids.iter().filter(|_| own.orders().is_some());
            grids.map(|grid| [grid.number, value(grid)]).collect()
        };
        let grids = self.refinements.first().map_or(&[][..], |own| &own.refinement.grids);
        let counts: Vec<String> = grids.iter().map(|grid| format!("{}²", grid.points[0])).collect();
        (!self.refinements.is_empty()).then(|| SpectrumFigure {
            title: case_title(case),
            subtitle: "the fastest growing wave of each grid: lines from the analysis, rings from the solver"
                .to_owned(),
            x_label: format!("its wave number k on {} points, 1/m", counts.join(", ")),
            y_label: "growth rate γ, 1/s".to_owned(),
            lines: self
                .refinements
                .iter()
                .map(|own| Line {
                    label: match own.refinement.orders() {
                        Some(_) => own.kind.title().to_owned(),
                        None => format!("{}: nothing grows", own.kind.title()),
                    },
                    points: points(own, |grid| grid.predicted),
                })
                .collect(),
            rings: self.refinements.iter().map(|own| points(own, |grid| grid.measured)).collect(),
        })
    }
}

fn verdict(agrees: bool) -> &'static str {
    if agrees { "agrees" } else { "DISAGREES" }
}
