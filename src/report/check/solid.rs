//! Check report of a solid: table and picture.

use super::{
    digits, exponent, greatest_difference_words, signed_exponent, unmeasured_words, verdict_words,
};
use crate::case::Case;
use crate::report::format::{case_title, short};
use crate::study::check::solid::{BranchCheck, MediumCheck, SolidCheck};
use crate::study::dispersion::WaveVector;
use agreement::solids::Response;
use figures::{Band, Branch, DispersionFigure};
use models::solid::parameters::Isotropic;
use std::fmt::Write as _;

pub(super) const UNITS: [(&str, &str); 4] =
    [("frequency", "rad/s"), ("growth_rate", "1/s"), ("tolerance", "rad/s"), ("number", "1/m")];

/// Phase speeds below this fraction of the greatest are zero: branches that do not propagate are not drawn.
const STILL: f64 = 1e-6;

impl SolidCheck {
    pub(super) fn text(&self, case: &Case) -> String {
        let mut text = format!("{}\n", case_title(case));
        for medium in &self.media {
            medium.write(&mut text);
        }
        text
    }
}

impl MediumCheck {
    fn write(&self, text: &mut String) {
        let place = if self.place.is_empty() { String::new() } else { format!("{}: ", self.place) };
        let _ = writeln!(text, "{place}{}", self.model);
        self.write_head(text);
        let mut last: Option<WaveVector> = None;
        for row in &self.rows {
            let wave = row.wave;
            if last != Some(wave) {
                let up = match wave.elevation_deg {
                    0.0 => String::new(),
                    up => format!(", {}° above the plane", short(up)),
                };
                let (k, along) = (short(wave.number), short(wave.direction_deg));
                let _ = writeln!(text, "k = {k} 1/m at {along}°{up}");
                last = Some(wave);
            }
            row.write(text);
        }
        for band in &self.forbidden_bands {
            let at = |own: Option<f64>| own.map_or("none".to_owned(), digits);
            let _ = writeln!(
                text,
                "\nno {} waves between {} and {} rad/s: measured next to it {} and {}  {}",
                band.polarisation,
                digits(band.from),
                digits(band.to),
                at(band.nearest[0]),
                at(band.nearest[1]),
                verdict_words(band.agrees),
            );
        }
        let failed = self.rows.iter().filter(|row| row.agrees == Some(false)).count();
        let verdict = match (failed, self.agrees) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{} waves, {}{verdict}{}",
            self.rows.len(),
            greatest_difference_words(self.greatest_difference()),
            unmeasured_words(self.unmeasured()),
        );
    }

    fn write_head(&self, text: &mut String) {
        let measured = self.rows.iter().find(|row| row.limit.is_some());
        let cells = measured.iter().flat_map(|row| &row.grids).filter_map(|grid| grid.cells);
        let cells: Vec<String> = cells.map(|cells| cells.to_string()).collect();
        let coarse = cells.first().map_or("–", String::as_str);
        let _ = writeln!(
            text,
            "frequencies ω in rad/s; differences and growth rates γ as parts of ω; {} cells to a period \
             along each axis\n",
            cells.join(", ")
        );
        let _ = writeln!(
            text,
            "{:<42}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>6}",
            "",
            "predicted",
            "measured",
            "differs",
            "expected",
            "growth",
            "within",
            format!("at {coarse}"),
            "order",
        );
    }

    /// Creates the figure of measured frequencies on predicted curves. Elastic points are of all directions if the
    /// solid is isotropic, other points of the first direction.
    pub(super) fn figure(&self, case: &Case) -> DispersionFigure {
        let greatest = self.rows.iter().map(|row| row.wave.number).fold(0.0, f64::max);
        let bands = self.branches.iter().flat_map(|(_, groups)| groups).flat_map(|group| {
            let inner = group.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
            inner.map(|band| Band {
                label: format!("no {} waves", group.family.polarisation.name()),
                from: band.from,
                to: band.to,
            })
        });
        let mut measured = self.rows.iter().filter(|row| row.limit.is_some());
        let first = measured.next().map(|row| direction(&row.wave));
        let are_several = measured.any(|row| Some(direction(&row.wave)) != first);
        let is_alike = self.is_isotropic() && self.solid.plastic.is_none() && are_several;
        DispersionFigure {
            title: case_title(case),
            subtitle: format!(
                "{}: curves from the analysis, rings from the solver{}{}",
                self.model,
                if is_alike { ", all directions" } else { "" },
                unmeasured_words(self.unmeasured()),
            ),
            k_label: "wave number k (1/m)".into(),
            frequency_label: "angular frequency ω (rad/s)".into(),
            speed_label: "phase speed ω/k (m/s)".into(),
            growth_label: String::new(),
            k_log: false,
            frequency_log: false,
            branches: self.curves(greatest),
            bands: bands.collect(),
            cutoffs: Vec::new(),
            speed_limits: Vec::new(),
        }
    }

    fn is_isotropic(&self) -> bool {
        self.solid.elastic.downcast::<Isotropic>().is_some()
    }

    /// Returns the curves of all propagating branches, up to 1.05 times the wave number `greatest`, 1/m.
    fn curves(&self, greatest: f64) -> Vec<Branch> {
        let speeds = self.rows.iter().map(|row| row.predicted.frequency / row.wave.number);
        let greatest_speed = speeds.fold(0.0, f64::max);
        let groups = self
            .branches
            .iter()
            .flat_map(|(response, groups)| groups.iter().map(move |group| (*response, group)));
        let mut curves = Vec::new();
        for (response, group) in groups {
            for (index, curve) in group.curves(1.05 * greatest).into_iter().enumerate() {
                if curve.iter().all(|p| p.frequency <= STILL * p.number * greatest_speed) {
                    continue;
                }
                let label = group.label(index);
                curves.push(Branch {
                    measured: self.measured(response, &label),
                    label: match response {
                        Response::Elastic => label,
                        other => format!("{}: {label}", other.name()),
                    },
                    frequency: curve.iter().map(|p| [p.number, p.frequency]).collect(),
                    group_speed: Vec::new(),
                    growth: Vec::new(),
                });
            }
        }
        curves
    }

    /// Returns the wave numbers, 1/m, and measured frequencies, rad/s, of a branch.
    fn measured(&self, response: Response, label: &str) -> Vec<[f64; 2]> {
        let Some(first) = self.rows.first().map(|row| row.wave) else { return Vec::new() };
        let is_isotropic = self.is_isotropic();
        let is_own = |row: &&BranchCheck| {
            let is_along = direction(&row.wave) == direction(&first);
            row.response == response
                && row.branch == label
                && (is_along || (is_isotropic && response != Response::Loading))
        };
        let own = self.rows.iter().filter(is_own);
        own.filter_map(|row| Some([row.wave.number, row.limit?.frequency])).collect()
    }
}

/// Returns direction in the plane and elevation above it, degrees.
fn direction(wave: &WaveVector) -> [f64; 2] {
    [wave.direction_deg, wave.elevation_deg]
}

impl BranchCheck {
    fn write(&self, text: &mut String) {
        let name = match self.response {
            Response::Elastic => self.branch.clone(),
            other => format!("{}: {}", other.name(), self.branch),
        };
        let predicted = self.predicted.frequency;
        let (Some(limit), Some(found), Some(expected)) =
            (self.limit, self.difference, self.expected_difference)
        else {
            let reason = self.not_measurable.as_deref().unwrap_or_default();
            let predicted = digits(predicted);
            let _ = writeln!(text, "  {name:<40}{predicted:>12}  not measurable: {reason}");
            return;
        };
        let _ = writeln!(
            text,
            "  {:<40}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>6}  {}",
            name,
            digits(predicted),
            digits(limit.frequency),
            signed_exponent(found.frequency),
            signed_exponent(expected.frequency),
            signed_exponent(found.growth),
            exponent(limit.tolerance / predicted),
            self.grids.first().map_or_else(String::new, |grid| signed_exponent(grid.difference)),
            self.order.map_or("–".into(), |order| format!("{order:.2}")),
            verdict_words(self.agrees == Some(true)),
        );
    }
}
