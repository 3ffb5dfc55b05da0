//! Report on the dispersion relation of a solid.

use super::format::{case_title, format_short};
use super::parameters::with_parameters;
use super::{DataFile, Report, ReportPicture};
use crate::Error;
use crate::case::Case;
use crate::study::dispersion::{BranchFamily, DispersionResult};
use figures::{DispersionBranch, DispersionFigure, FrequencyBand, ReferenceLevel};
use models::solid::parameters::Isotropic;
use std::fmt::Write as _;

impl Report for DispersionResult {
    const NAME: &'static str = "dispersion";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("frequency", "rad/s"), ("speed", "m/s"), ("number", "1/m")];

    fn to_text(&self, case: &Case) -> String {
        let wave = self.wave;
        let mut text = format!(
            "{}\nmodel: {}\nwaves along {}°, {}° above the plane; frequencies in rad/s, speeds in m/s\n",
            case_title(case),
            case.medium().title(),
            format_short(wave.direction_deg),
            format_short(wave.elevation_deg),
        );
        for family in &self.families {
            family.write_table(wave.wave_number, &mut text);
        }
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = create_figure(case, self);
        Ok(vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))])
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(vec![("dispersion.csv", create_table(&self.families))])
    }
}

impl BranchFamily {
    fn write_table(&self, wave_number: f64, text: &mut String) {
        let count = match self.family_count {
            1 => String::new(),
            2 => " (double)".to_owned(),
            count => format!(" ({count}-fold)"),
        };
        let _ = writeln!(text, "\n{}{count}", self.polarisation);
        let speeds = self.characteristic_speeds.iter().zip(&self.imaginary_characteristic_speeds);
        let speeds: Vec<String> = speeds
            .map(|(real, imaginary)| match imaginary {
                0.0 => format_short(*real),
                _ => format!("{} ± {}i", format_short(*real), format_short(*imaginary)),
            })
            .collect();
        let _ = writeln!(text, "  characteristic speeds   {}", speeds.join(", "));
        if !self.cut_off_frequencies.is_empty() {
            let _ = writeln!(
                text,
                "  cut-off frequencies     {}",
                format_numbers(&self.cut_off_frequencies)
            );
        }
        if !self.short_wave_limits.is_empty() {
            let limits = format_numbers(&self.short_wave_limits);
            let _ = writeln!(text, "  frequencies as k → ∞    {limits} (speed zero)");
        }
        for [from, to] in &self.band_gaps {
            let from = format_short(*from);
            let _ = match to.is_finite() {
                true => {
                    writeln!(text, "  no such waves between   {from} and {}", format_short(*to))
                }
                false => writeln!(text, "  no such waves above     {from}"),
            };
        }
        for (label, point) in self.labels.iter().zip(&self.branches) {
            let growth = match point.growth_rate {
                0.0 => String::new(),
                rate => format!(", growth rate {} 1/s", format_short(rate)),
            };
            let _ = writeln!(
                text,
                "  at k = {} 1/m: ω = {}{growth}, phase speed {}, group speed {}  [{label}]",
                format_short(wave_number),
                format_short(point.frequency),
                format_short(point.phase_speed),
                format_short(point.group_speed),
            );
        }
    }
}

fn format_numbers(values: &[f64]) -> String {
    values.iter().map(|&x| format_short(x)).collect::<Vec<_>>().join(", ")
}

fn create_table(families: &[BranchFamily]) -> DataFile<'_> {
    let header = ["branch", "number", "frequency", "phase_speed", "group_speed", "growth_rate"];
    let rows = families.iter().flat_map(|family| {
        family.labels.iter().zip(&family.curves).flat_map(|(label, curve)| {
            curve.iter().map(move |p| -> Vec<files::csv::CsvCell> {
                vec![
                    label.as_str().into(),
                    p.wave_number.into(),
                    p.frequency.into(),
                    p.phase_speed.into(),
                    p.group_speed.into(),
                    p.growth_rate.into(),
                ]
            })
        })
    });
    DataFile::table("dispersion.csv", header, rows)
}

fn create_figure(case: &Case, found: &DispersionResult) -> DispersionFigure {
    let wave = found.wave;
    let branches = found.families.iter().flat_map(|family| {
        family.labels.iter().zip(&family.curves).map(|(label, curve)| DispersionBranch {
            label: label.clone(),
            frequency: curve.iter().map(|p| [p.wave_number, p.frequency]).collect(),
            group_speed: curve.iter().map(|p| [p.wave_number, p.group_speed]).collect(),
            measured_frequency: Vec::new(),
            disagreeing_frequency: Vec::new(),
            growth_rate: match curve.iter().any(|p| p.growth_rate > 0.0) {
                true => curve.iter().map(|p| [p.wave_number, p.growth_rate]).collect(),
                false => Vec::new(),
            },
        })
    });
    // Only band gaps bounded on both sides are drawn: a gap from 0 to a cut-off frequency is shown by the dashed line
    // of that frequency, and a gap without upper edge has no end.
    let bands = found.families.iter().flat_map(|family| {
        let between = |band: &&[f64; 2]| band[0] > 0.0 && band[1].is_finite();
        family.band_gaps.iter().filter(between).map(|&[from, to]| FrequencyBand {
            label: format!("no {} waves", family.polarisation),
            low: from,
            high: to,
        })
    });
    DispersionFigure {
        title: case_title(case),
        subtitle: with_parameters(
            &format!(
                "{}, waves along {}°{}; solid: phase speed, dashed: group speed",
                case.medium().title(),
                format_short(wave.direction_deg),
                match wave.elevation_deg {
                    0.0 => String::new(),
                    up => format!(", {}° above the plane", format_short(up)),
                },
            ),
            case,
        ),
        wave_number_label: "wave number k (1/m)".into(),
        frequency_label: "frequency ω (rad/s)".into(),
        speed_label: "speed (m/s)".into(),
        growth_label: "growth rate Re ς (1/s)".into(),
        is_wave_number_log: false,
        is_frequency_log: false,
        branches: branches.collect(),
        bands: bands.collect(),
        cutoffs: collect_cutoffs(&found.families),
        speed_limits: compute_closed_form_speeds(found),
    }
}

fn collect_cutoffs(families: &[BranchFamily]) -> Vec<ReferenceLevel> {
    let mut cutoffs: Vec<ReferenceLevel> = Vec::new();
    for &value in families.iter().flat_map(|family| &family.cut_off_frequencies) {
        if cutoffs.iter().all(|level| (level.value - value).abs() > 1e-9 * value) {
            cutoffs.push(ReferenceLevel { label: format!("{} rad/s", format_short(value)), value });
        }
    }
    cutoffs
}

/// Returns the closed-form speeds of short elastic waves in an isotropic solid, m/s; empty for other solids.
fn compute_closed_form_speeds(found: &DispersionResult) -> Vec<ReferenceLevel> {
    let solid = &found.solid;
    let Some(elastic) = solid.elastic_law.downcast::<Isotropic>() else { return Vec::new() };
    let speeds = elastic.speeds();
    let of_elastic = if solid.plastic_state.is_some() { "elastic " } else { "" };
    let level =
        |label: &str, value: f64| ReferenceLevel { label: format!("{of_elastic}{label}"), value };
    [
        Some(level("c_p", speeds.longitudinal)),
        Some(level("c_s", speeds.shear)),
        // In plane strain the rotation vector is normal to the plane: no wave rotates about its wave vector (torsion).
        speeds.torsion.filter(|_| solid.dimensions == 3).map(|c| level("c_m", c)),
        speeds.rotation.map(|c| level("c_ω", c)),
    ]
    .into_iter()
    .flatten()
    .collect()
}
