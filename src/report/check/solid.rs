//! Check report of a solid: table and picture.

use super::{
    Disagreement, format_agreement, format_max_error, format_scientific, format_signed_scientific,
    format_significant, format_unmeasured_count,
};
use crate::case::Case;
use crate::report::format::{case_title, format_count, format_short};
use crate::report::parameters::with_parameters;
use crate::study::check::solid::{BandGapCheck, BranchCheck, MediumCheck, SolidCheck};
use crate::study::dispersion::WaveVector;
use agreement::solids::WaveResponse;
use figures::{DispersionBranch, DispersionFigure, FrequencyBand};
use models::solid::parameters::Isotropic;
use std::fmt::Write as _;

pub(super) const SOLID_CHECK_UNITS: [(&str, &str); 4] =
    [("frequency", "rad/s"), ("growth_rate", "1/s"), ("tolerance", "rad/s"), ("number", "1/m")];

/// Fraction of the largest phase speed up to which a phase speed counts as zero; branches of zero speed are not drawn.
const MIN_RELATIVE_SPEED: f64 = 1e-6;

impl SolidCheck {
    pub(super) fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\n", case_title(case));
        for medium in &self.medium_checks {
            medium.write_table(&mut text);
        }
        for blocks in &self.blocky_medium_checks {
            blocks.write_table(&mut text);
        }
        text
    }

    /// Returns the branches and band gaps that disagree; band gaps have the error 0.
    pub(super) fn disagreements(&self) -> Vec<Disagreement> {
        let mut all = Vec::new();
        for medium in &self.medium_checks {
            let place = medium.format_place();
            all.extend(collect_disagreements(&place, &medium.branch_checks));
            let bands = medium.band_gaps.iter().filter(|band| !band.is_in_agreement);
            all.extend(bands.map(|band| {
                let row = format!("{place}{}", format_band_gap(band));
                Disagreement { heading: String::new(), row, error: 0.0 }
            }));
        }
        for blocks in &self.blocky_medium_checks {
            let place = format!("{}: ", blocks.section_key);
            all.extend(collect_disagreements(&place, &blocks.branch_checks));
        }
        all
    }
}

/// Formats the check of a band gap as a line.
fn format_band_gap(band: &BandGapCheck) -> String {
    let at = |own: Option<f64>| own.map_or("none".to_owned(), format_significant);
    format!(
        "no {} waves between {} and {} rad/s: nearest measured {} and {}  {}\n",
        band.polarisation,
        format_significant(band.lower_edge),
        format_significant(band.upper_edge),
        at(band.nearest_frequencies[0]),
        at(band.nearest_frequencies[1]),
        format_agreement(band.is_in_agreement),
    )
}

impl MediumCheck {
    /// Returns the prefix of texts about this medium: the key of its region.
    fn format_place(&self) -> String {
        match self.region_key.is_empty() {
            true => String::new(),
            false => format!("{}: ", self.region_key),
        }
    }

    fn write_table(&self, text: &mut String) {
        let _ = writeln!(text, "{}{}", self.format_place(), self.medium_title);
        self.write_table_header(text);
        write_rows(&self.branch_checks, text);
        for band in &self.band_gaps {
            let _ = write!(text, "\n{}", format_band_gap(band));
        }
        let failed =
            self.branch_checks.iter().filter(|row| row.is_in_agreement == Some(false)).count();
        let verdict = match (failed, self.is_in_agreement) {
            (_, None) => String::new(),
            (0, Some(true)) => ": all agree".to_owned(),
            (0, Some(false)) => ": band gaps DISAGREE".to_owned(),
            (some, _) => format!(": {some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{}, {}{verdict}{}",
            format_count(self.branch_checks.len(), "wave"),
            format_max_error(self.max_relative_difference()),
            format_unmeasured_count(self.unmeasured_count()),
        );
    }

    fn write_table_header(&self, text: &mut String) {
        let measured = self.branch_checks.iter().find(|row| row.extrapolated_result.is_some());
        let cells = measured
            .iter()
            .flat_map(|row| &row.grid_results)
            .filter_map(|grid| grid.cells_per_period);
        let cells: Vec<String> = cells.map(|cells| cells.to_string()).collect();
        let coarse = cells.first().map_or("–", String::as_str);
        let _ = writeln!(
            text,
            "frequencies ω in rad/s; errors and growth rates γ relative to ω; {} cells per period along \
             each axis\n",
            cells.join(", ")
        );
        text.push_str(&column_headers(&format!("error (N = {coarse})")));
    }

    /// Creates the figure of measured frequencies on predicted curves. Measurements in all directions are drawn for the
    /// elastic and unloading response of an isotropic solid, otherwise only those in the direction of the first wave.
    pub(super) fn create_figure(&self, case: &Case) -> DispersionFigure {
        let greatest =
            self.branch_checks.iter().map(|row| row.wave.wave_number).fold(0.0, f64::max);
        let bands =
            self.predicted_branches.iter().flat_map(|(_, groups)| groups).flat_map(|group| {
                let inner = group
                    .band_gaps
                    .iter()
                    .filter(|band| band.lower > 0.0 && band.upper.is_finite());
                inner.map(|band| FrequencyBand {
                    label: format!("no {} waves", group.family.polarisation.name()),
                    low: band.lower,
                    high: band.upper,
                })
            });
        let mut measured =
            self.branch_checks.iter().filter(|row| row.extrapolated_result.is_some());
        let first = measured.next().map(|row| wave_direction(&row.wave));
        let are_several = measured.any(|row| Some(wave_direction(&row.wave)) != first);
        let is_alike = self.is_isotropic() && self.solid.plastic_state.is_none() && are_several;
        DispersionFigure {
            title: case_title(case),
            subtitle: with_parameters(
                &format!(
                    "{}: curves from the analysis, rings from the solver{}{}",
                    self.medium_title,
                    if is_alike { ", all directions" } else { "" },
                    format_unmeasured_count(self.unmeasured_count()),
                ),
                case,
            ),
            wave_number_label: "wave number k (1/m)".into(),
            frequency_label: "frequency ω (rad/s)".into(),
            speed_label: "phase speed ω/k (m/s)".into(),
            growth_label: String::new(),
            is_wave_number_log: false,
            is_frequency_log: false,
            branches: self.create_curves(greatest),
            bands: bands.collect(),
            cutoffs: Vec::new(),
            speed_limits: Vec::new(),
        }
    }

    fn is_isotropic(&self) -> bool {
        self.solid.elastic_law.downcast::<Isotropic>().is_some()
    }

    /// Returns the curves of all branches, up to 1.05 times the largest measured wave number `greatest`,
    /// 1/m.
    fn create_curves(&self, greatest: f64) -> Vec<DispersionBranch> {
        let speeds = self
            .branch_checks
            .iter()
            .map(|row| row.predicted_frequency.angular_frequency / row.wave.wave_number);
        let greatest_speed = speeds.fold(0.0, f64::max);
        let groups = self
            .predicted_branches
            .iter()
            .flat_map(|(response, groups)| groups.iter().map(move |group| (*response, group)));
        let mut curves = Vec::new();
        for (response, group) in groups {
            for (index, curve) in group.curves(1.05 * greatest).into_iter().enumerate() {
                let is_neutral = curve
                    .iter()
                    .all(|p| p.frequency <= MIN_RELATIVE_SPEED * p.wave_number * greatest_speed);
                let label = group.label(index);
                let name = if is_neutral { format!("{label}, neutral") } else { label.clone() };
                curves.push(DispersionBranch {
                    measured_frequency: self.collect_measured_points(response, &label, |_| true),
                    disagreeing_frequency: self.collect_measured_points(response, &label, |row| {
                        row.is_in_agreement == Some(false)
                    }),
                    label: match response {
                        WaveResponse::Elastic => name,
                        other => format!("{}: {name}", other.name()),
                    },
                    // A neutral branch is drawn at zero, not at its rounding error.
                    frequency: curve
                        .iter()
                        .map(|p| [p.wave_number, if is_neutral { 0.0 } else { p.frequency }])
                        .collect(),
                    group_speed: Vec::new(),
                    growth_rate: Vec::new(),
                });
            }
        }
        curves
    }

    /// Returns the wave numbers, 1/m, and measured frequencies, rad/s, of the rows of the branch named `label` that
    /// `is_selected` selects.
    fn collect_measured_points(
        &self,
        response: WaveResponse,
        label: &str,
        is_selected: impl Fn(&BranchCheck) -> bool,
    ) -> Vec<[f64; 2]> {
        let Some(first) = self.branch_checks.first().map(|row| row.wave) else { return Vec::new() };
        let is_isotropic = self.is_isotropic();
        let is_own = |row: &&BranchCheck| {
            let is_along = wave_direction(&row.wave) == wave_direction(&first);
            row.response == response
                && row.branch_label == label
                && (is_along || (is_isotropic && response != WaveResponse::Loading))
        };
        let own = self.branch_checks.iter().filter(is_own).filter(|row| is_selected(row));
        own.filter_map(|row| Some([row.wave.wave_number, row.extrapolated_result?.frequency]))
            .collect()
    }
}

/// Returns the direction of a wave vector in the plane of x₁ and x₂ and its elevation above that plane, degrees.
fn wave_direction(wave: &WaveVector) -> [f64; 2] {
    [wave.direction_deg, wave.elevation_deg]
}

/// Writes the results of all branches, grouped by wave vector.
pub(super) fn write_rows(rows: &[BranchCheck], text: &mut String) {
    let mut last: Option<WaveVector> = None;
    for row in merge_equal_branches(rows) {
        let wave = row.wave;
        if last != Some(wave) {
            let _ = writeln!(text, "{}", format_wave_vector(&wave));
            last = Some(wave);
        }
        row.write_row(text);
    }
}

fn format_wave_vector(wave: &WaveVector) -> String {
    let up = match wave.elevation_deg {
        0.0 => String::new(),
        up => format!(", {}° above the plane", format_short(up)),
    };
    let (k, along) = (format_short(wave.wave_number), format_short(wave.direction_deg));
    format!("k = {k} 1/m at {along}°{up}")
}

/// Collects the rows that disagree, each once; `place` is the prefix of their wave vectors.
fn collect_disagreements<'a>(
    place: &'a str,
    rows: &'a [BranchCheck],
) -> impl Iterator<Item = Disagreement> + 'a {
    let rows = merge_equal_branches(rows).into_iter();
    rows.filter(|row| row.is_in_agreement == Some(false)).map(move |row| {
        let mut text = String::new();
        row.write_row(&mut text);
        Disagreement {
            heading: format!("{place}{}", format_wave_vector(&row.wave)),
            row: text,
            error: row.measured_difference.map_or(f64::INFINITY, |own| own.max_norm()),
        }
    })
}

/// Returns one row for each branch of each wave: of branches of equal frequency, which have the same name, the first that
/// disagrees or was not measured, else the one with the largest error.
fn merge_equal_branches(rows: &[BranchCheck]) -> Vec<&BranchCheck> {
    const EQUAL_FREQUENCY_TOLERANCE: f64 = 1e-9;
    let is_same = |one: &BranchCheck, other: &BranchCheck| {
        let [first, second] = [one, other].map(|row| row.predicted_frequency.angular_frequency);
        (first - second).abs() <= EQUAL_FREQUENCY_TOLERANCE * first.abs()
            && one.wave == other.wave
            && one.response == other.response
            && one.branch_label == other.branch_label
    };
    let rank = |row: &BranchCheck| {
        let error = row.measured_difference.map_or(f64::INFINITY, |own| own.frequency.abs());
        (row.is_in_agreement != Some(true), error)
    };
    let mut merged: Vec<&BranchCheck> = Vec::new();
    for row in rows {
        match merged.last_mut().filter(|last| is_same(last, row)) {
            Some(last) if rank(row) > rank(last) => *last = row,
            Some(_) => {}
            None => merged.push(row),
        }
    }
    merged
}

/// Returns the line of column headers; `coarse` is that of the error on the coarsest grid.
pub(super) fn column_headers(coarse: &str) -> String {
    format!(
        "{:<42}{:>12}{:>12}{:>10}{:>10}{:>10}{:>11}{:>16}{:>6}\n",
        "", "predicted", "measured", "error", "expected", "growth", "tolerance", coarse, "order",
    )
}

impl BranchCheck {
    pub(super) fn write_row(&self, text: &mut String) {
        let name = match self.response {
            WaveResponse::Elastic => self.branch_label.clone(),
            other => format!("{}: {}", other.name(), self.branch_label),
        };
        let predicted = self.predicted_frequency.angular_frequency;
        let (Some(limit), Some(found), Some(expected)) =
            (self.extrapolated_result, self.measured_difference, self.expected_difference)
        else {
            let reason = self.unmeasured_reason.as_deref().unwrap_or_default();
            let predicted = format_significant(predicted);
            let verdict = match self.is_in_agreement {
                Some(is_in_agreement) => format!("  {}", format_agreement(is_in_agreement)),
                None => String::new(),
            };
            let _ =
                writeln!(text, "  {name:<40}{predicted:>12}  not measurable: {reason}{verdict}");
            return;
        };
        let _ = writeln!(
            text,
            "  {:<40}{:>12}{:>12}{:>10}{:>10}{:>10}{:>11}{:>16}{:>6}  {}",
            name,
            format_significant(predicted),
            format_significant(limit.frequency),
            format_signed_scientific(found.frequency),
            format_signed_scientific(expected.frequency),
            format_signed_scientific(found.growth_rate),
            format_scientific(limit.tolerance / predicted),
            self.grid_results.first().map_or_else(String::new, |grid| format_signed_scientific(
                grid.relative_frequency_error
            )),
            self.convergence_order.map_or("–".into(), |order| format!("{order:.2}")),
            format_agreement(self.is_in_agreement == Some(true)),
        );
    }
}
