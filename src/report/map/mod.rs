//! Report on the verdict over two parameters of a case.

mod certified;
mod explorer;
mod figure;
mod tables;

use super::format::{
    CLOSED_FORM_ROUTE, VALIDITY_NOTE, case_title, format_count, format_short, format_superscript,
    format_unit_suffix,
};
use super::page::InteractivePicture;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::{Case, ModelKind};
use crate::study::MapResult;
use crate::study::map::PointStatus;
use crate::study::map::summary::FastestGrowthPoint;
use analysis::flows::FLOW_ROUTE;
use analysis::solids::{Hyperbolicity, PLANE_ROUTE, SPACE_ROUTE};

impl Report for MapResult {
    const NAME: &'static str = "map";

    fn to_arguments(&self, case: &Case) -> String {
        let options = self.options;
        let computes_growth = options.computes_bound || options.computes_growth_rate;
        let is_flow = matches!(case.material.kind, ModelKind::Flow(_));
        // As when the map is drawn again: its files do not tell whether a map without closed forms was asked for.
        let is_model_blind = is_flow && !computes_growth && self.route_counts[0].1 == 0;
        [
            (options.computes_bound, " --bound"),
            (options.computes_growth_rate, " --growth-rate"),
            (is_model_blind, " --model-blind"),
            (options.is_certified, " --certified"),
        ]
        .into_iter()
        .filter(|own| own.0)
        .fold("case.toml".to_owned(), |text, (_, option)| text + option)
    }

    fn to_text(&self, case: &Case) -> String {
        let mut lines = vec![case_title(case)];
        let (x, y) = (&self.x, &self.y);
        lines.push(format!(
            "{}: {} × {} points over {} ({}) and {} ({})",
            case.medium().title(),
            x.point_count,
            y.point_count,
            x.label,
            x.parameter,
            y.label,
            y.parameter
        ));
        self.add_count_lines(case, &mut lines);
        self.add_interval_lines(&mut lines);
        lines.extend(
            self.fastest_growth_point.as_ref().map(|worst| self.format_fastest_growth_line(worst)),
        );
        let blind = match (case.material.kind, case.material.numbers.dimensions) {
            (ModelKind::Flow(_) | ModelKind::Rheology | ModelKind::Equations, _) => FLOW_ROUTE,
            (ModelKind::Solid(_), 3) => SPACE_ROUTE,
            (ModelKind::Solid(_), _) => PLANE_ROUTE,
        };
        for ((_, count), route) in self.route_counts.into_iter().zip([CLOSED_FORM_ROUTE, blind]) {
            if count > 0 {
                lines.push(format!("Route of {}: {route}", format_count(count, "verdict")));
            }
        }
        lines.extend(self.certified.iter().flat_map(certified::summary_lines));
        lines.push(VALIDITY_NOTE.into());
        lines.join("\n") + "\n"
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = figure::create_figure(case, self);
        let mut pictures = vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))];
        if let Some(own) = &self.certified {
            let figure = certified::create_figure(case, self, own);
            pictures.push(ReportPicture::new("certified", move |format| figure.draw(format)));
        }
        Ok(pictures)
    }

    fn absent_file_names(&self) -> Vec<String> {
        let names = ["png", "svg", "pdf"].map(|extension| format!("certified.{extension}"));
        if self.certified.is_some() { Vec::new() } else { names.into() }
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(vec![("map.csv", tables::create_table(self)), ("map.npz", tables::create_arrays(self))])
    }

    fn create_interactive_picture(&self, case: &Case) -> Result<Option<InteractivePicture>, Error> {
        let create = |samples| explorer::create_picture(case, self, samples);
        self.samples.as_ref().map(create).transpose()
    }
}

impl MapResult {
    fn add_count_lines(&self, case: &Case, lines: &mut Vec<String>) {
        let all = self.points.len() as f64;
        for (name, count) in self.status_counts {
            if count > 0 {
                let share = 100.0 * count as f64 / all;
                lines.push(format!("  {share:5.1} %  {name} ({})", format_count(count, "point")));
            }
        }
        let of_solid = self.solid.iter().flat_map(|solid| solid.hyperbolicity_counts);
        for (hyperbolicity, (_, count)) in Hyperbolicity::ALL.into_iter().zip(of_solid) {
            if count > 0 {
                lines.push(format!(
                    "  {}: {}",
                    format_count(count, "point"),
                    hyperbolicity.description()
                ));
            }
        }
        if let Some(share) = self.well_posed_fraction {
            let which = match case.material.kind {
                ModelKind::Flow(_) | ModelKind::Rheology => "fully deforming states",
                ModelKind::Equations => "states that satisfy the equations",
                ModelKind::Solid(_) => "states with a response",
            };
            lines.push(
                match self.boundaries.is_status_on_lines(&self.points, PointStatus::WellPosed) {
                    true => format!(
                        "Of the {which}, only some on lines are well-posed, 0 % of the area."
                    ),
                    false => {
                        format!("Of the {which}, {} % are well-posed.", format_short(100.0 * share))
                    }
                },
            );
        }
        if self.unbounded_at_finite_wave_number > 0 {
            lines.push(format!(
                "At {} the growth rate is unbounded already at finite wave numbers.",
                format_count(self.unbounded_at_finite_wave_number, "ill-posed point")
            ));
        }
    }

    fn add_interval_lines(&self, lines: &mut Vec<String>) {
        let (x, y) = (&self.x, &self.y);
        let grid_step = match x.values[..] {
            [first, second, ..] if x.spacing.is_some() => {
                format!("the ratio of neighbouring points, {}", format_short(second / first))
            }
            [first, second, ..] => {
                let step = format_short((second - first).abs());
                format!("the grid step of {step}{}", format_unit_suffix(x.unit))
            }
            _ => {
                let value = x.values.first().map_or(f64::NAN, |value| *value);
                lines.push(format!(
                    "{} has the single value {}{}: intervals of well-posed states need two or more.",
                    x.label,
                    format_short(value),
                    format_unit_suffix(x.unit)
                ));
                return;
            }
        };
        lines.push(format!("Intervals of well-posed states, to within {grid_step}:"));
        for intervals in &self.well_posed_intervals {
            let at = format!(
                "  at {} = {}{}:",
                y.label,
                format_short(intervals.y),
                format_unit_suffix(y.unit)
            );
            let list: Vec<String> = intervals
                .x
                .iter()
                .map(|[a, b]| {
                    format!(
                        "{}{u} … {}{u}",
                        format_short(*a),
                        format_short(*b),
                        u = format_unit_suffix(x.unit)
                    )
                })
                .collect();
            lines.push(if list.is_empty() {
                format!("{at} nowhere well-posed")
            } else {
                format!("{at} well-posed for {} in {}", x.label, list.join(" and "))
            });
        }
    }

    fn format_fastest_growth_line(&self, worst: &FastestGrowthPoint) -> String {
        let (x, y) = (&self.x, &self.y);
        // Models in one dimension have waves in one direction only.
        let mut direction = match worst.direction_deg.is_nan() {
            true => String::new(),
            false => format!(", for waves at {}°", format_short(worst.direction_deg)),
        };
        if let Some(up) = worst.elevation_deg.filter(|up| !up.is_nan() && *up != 0.0) {
            direction += &format!(", {}° above the plane", format_short(up));
        }
        format!(
            "Largest growth on this grid: Re ς ≈ {} k{} (1/s, k in 1/m) as k → ∞{direction}, at {} = {}{}, {} = {}{}.",
            format_short(worst.growth_coefficient),
            format_superscript(worst.growth_order),
            x.label,
            format_short(worst.x),
            format_unit_suffix(x.unit),
            y.label,
            format_short(worst.y),
            format_unit_suffix(y.unit),
        )
    }
}
