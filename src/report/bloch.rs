//! Report on the Bloch waves of a blocky medium.

use super::format::{case_title, format_short};
use super::{ArrayData, DataArray, DataFile, Report, ReportPicture, column_unit};
use crate::Error;
use crate::case::Case;
use crate::study::bloch::{BandStructureResult, JointLawSummary};
use figures::{BandFamily, BandFigure, BandStyle};
use files::csv::CsvCell;
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Limits of the longitudinal share of the kinetic energy of a wave: S-like up to the first, P-like above the second.
const LONGITUDINAL_SHARE_LIMITS: [f64; 2] = [0.4, 0.6];

impl Report for BandStructureResult {
    const NAME: &'static str = "dispersion";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("frequency", "rad/s"), ("speed", "m/s"), ("number", "1/m"), ("decay_rate", "1/s")];

    fn to_text(&self, case: &Case) -> String {
        let mut text = format!("{}\nmodel: Bloch waves of a blocky medium\n", case_title(case));
        self.write_medium(&mut text);
        self.write_waves(&mut text);
        self.write_long_waves(&mut text);
        self.write_verdict(&mut text);
        text
    }

    fn create_pictures(&self, case: &Case) -> Result<Vec<ReportPicture>, Error> {
        let figure = create_figure(case, self);
        Ok(vec![ReportPicture::new(Self::NAME, move |format| figure.draw(format))])
    }

    fn create_tables(&self, _case: &Case) -> Result<Vec<(&'static str, DataFile<'_>)>, Error> {
        Ok(vec![("dispersion.csv", create_table(self)), ("dispersion.npz", create_arrays(self))])
    }
}

impl BandStructureResult {
    fn is_damped(&self) -> bool {
        self.joints.iter().any(|joint| joint.retardation_time.is_some())
    }

    fn write_medium(&self, text: &mut String) {
        let blocks = &self.blocks;
        let [width, height] = blocks.side_lengths.map(format_short);
        let _ = writeln!(
            text,
            "blocks {width} × {height} m, ρ = {} kg/m³, c₁ = {} m/s, c₂ = {} m/s",
            format_short(blocks.density),
            format_short(blocks.longitudinal_speed),
            format_short(blocks.shear_speed),
        );
        if blocks.row_shift != 0.0 {
            let shift = format_short(blocks.row_shift);
            let _ = writeln!(text, "every second row is shifted by {shift} m: cell of two rows");
        }
        if blocks.can_yield {
            let _ = writeln!(text, "the blocks are within their yield set: no plastic flow");
        }
        let joint = |axis: &str, own: &JointLawSummary, text: &mut String| {
            let [normal, tangential] = own.fast_stiffnesses.map(format_short);
            let _ = writeln!(
                text,
                "joints normal to {axis}: {}, K_n = {normal} Pa/m, K_t = {tangential} Pa/m, {} kg/m²",
                own.layer_kind,
                format_short(own.areal_masses[0]),
            );
            if let Some(note) = own.linearisation_note {
                let _ = writeln!(text, "  linearised about the initial state: {note}");
            }
        };
        match self.joints[0] == self.joints[1] {
            true => joint("x₁ and x₂", &self.joints[0], text),
            false => {
                joint("x₁", &self.joints[0], text);
                joint("x₂", &self.joints[1], text);
            }
        }
    }

    fn write_waves(&self, text: &mut String) {
        let _ = writeln!(
            text,
            "\nBloch waves, lowest {} branches: polynomials of degree {} in each block{}",
            self.path_waves.first().map_or(0, |at| at.waves.len()),
            self.polynomial_degree,
            match self.achieved_accuracy {
                error if error.is_finite() =>
                    format!(", relative error of frequencies up to {error:.0e}"),
                _ => ", error of frequencies not estimated".to_owned(),
            },
        );
        for vertex in
            self.path_vertices.iter().take(self.path_vertices.len().saturating_sub(1)).skip(1)
        {
            let at = self.path_points.iter().position(|point| point.distance == vertex.distance);
            let Some(waves) = at.and_then(|index| self.path_waves.get(index)) else { continue };
            let lowest: Vec<String> = waves
                .waves
                .iter()
                .take(4)
                .map(|wave| format_short(wave.frequency / (TAU * 1e3)))
                .collect();
            let _ = writeln!(text, "  at {}: f = {} kHz", vertex.name, lowest.join(", "));
        }
        match &self.band_gaps {
            None => text.push_str("  band gaps are not defined: waves are damped\n"),
            Some(gaps) if gaps.is_empty() => {
                text.push_str("  no band gap between these branches\n")
            }
            Some(gaps) => {
                for [low, high] in gaps {
                    let [low, high] = [low, high].map(|value| format_short(value / (TAU * 1e3)));
                    let _ = writeln!(text, "  no waves between {low} and {high} kHz");
                }
            }
        }
        match (&self.continuum_constants, &self.missing_continuum) {
            (Some(continuum), _) => {
                let _ = writeln!(
                    text,
                    "  rotation of blocks in the continuum: f* = {} kHz; K_t h/μ = {}{}",
                    format_short(continuum.natural_frequency / (TAU * 1e3)),
                    format_short(continuum.stiffness_ratio),
                    match continuum.has_rigid_blocks() {
                        true => "",
                        false => ", not small: f* is an estimate of its order",
                    },
                );
            }
            (None, Some(reason)) => {
                let _ = writeln!(text, "  no equivalent continuum: {reason}");
            }
            (None, None) => {}
        }
        if !self.chain_branches.is_empty() {
            text.push_str(
                "  chain: exact relation of a stack along x₁, without joints normal to x₂\n",
            );
        }
    }

    fn write_long_waves(&self, text: &mut String) {
        let slow = if self.is_damped() { ", slow against the retardation time" } else { "" };
        let _ = writeln!(text, "\nLong waves{slow}: speeds in m/s");
        for wave in &self.long_waves {
            let direction = format_short(wave.direction_deg);
            let [shear, longitudinal] = wave.medium_speeds.map(format_speed);
            let _ = write!(text, "  at {direction:>4}°: S {shear}, P {longitudinal}");
            if let (Some(continuum), Some(difference)) =
                (wave.continuum_speeds, wave.relative_differences)
            {
                let [shear, longitudinal] = continuum.map(format_speed);
                let _ = write!(
                    text,
                    "; continuum S {shear}, P {longitudinal}, relative difference {:.0e}, {:.0e}",
                    difference[0], difference[1],
                );
            }
            text.push('\n');
        }
    }

    fn write_verdict(&self, text: &mut String) {
        let evidence = &self.evidence;
        let stability = if self.is_stable { "stable" } else { "unstable" };
        let _ = writeln!(text, "\nVerdict: {}, {stability}", self.verdict_name);
        text.push_str(
            "  blocks are symmetric-hyperbolic, joints act locally: growth rates are bounded\n",
        );
        let count = evidence.wave_vector_count;
        let _ = match evidence.min_squared_frequency {
            Some(least) => writeln!(
                text,
                "  least ω² of all waves at {count} wave vectors: {least:.1e} rad²/s², rounding {:.1e}",
                evidence.growth_rate_rounding.powi(2),
            ),
            None => writeln!(
                text,
                "  largest growth rate of all modes at {count} wave vectors: {:.1e} 1/s, rounding {:.1e}",
                evidence.max_growth_rate, evidence.growth_rate_rounding,
            ),
        };
        if evidence.has_positive_energy {
            text.push_str(
                "  the energy of blocks and joints is positive: no wave grows at any wave vector\n",
            );
        }
        let _ = writeln!(text, "  supremum of Re ς: {} 1/s", format_short(self.growth_bound));
    }
}

/// Formats a speed, m/s, with one decimal, since its difference from the speed in the continuum is small.
fn format_speed(speed: f64) -> String {
    format!("{speed:.1}")
}

/// Creates the rows of the tables: family of the branch, number of the branch from 1, [distance along the path,
/// components of the wave vector], 1/m, and [frequency, rad/s, decay rate, 1/s, longitudinal share].
fn create_table_rows(
    found: &BandStructureResult,
) -> Vec<(&'static str, usize, [f64; 3], [f64; 3])> {
    let mut rows = Vec::new();
    let at = |index: usize| {
        let point = &found.path_points[index];
        [point.distance, point.wave_vector[0], point.wave_vector[1]]
    };
    for branch in 0..found.path_waves.iter().map(|at| at.waves.len()).max().unwrap_or(0) {
        for (index, waves) in found.path_waves.iter().enumerate() {
            if let Some(wave) = waves.waves.get(branch) {
                let share = wave.longitudinal_share.unwrap_or(f64::NAN);
                let values = [wave.frequency, wave.decay_rate, share];
                rows.push(("medium", branch + 1, at(index), values));
            }
        }
    }
    for branch in 0..3 {
        for (index, own) in found.continuum_frequencies.iter().enumerate() {
            rows.push(("continuum", branch + 1, at(index), [own[branch], 0.0, f64::NAN]));
        }
    }
    for chain in &found.chain_branches {
        let name = if chain.name == "P" { "chain P" } else { "chain S" };
        let share = if chain.name == "P" { 1.0 } else { 0.0 };
        for (branch, curve) in chain.curves.iter().enumerate() {
            for &[distance, frequency] in curve {
                rows.push((name, branch + 1, [distance, distance, 0.0], [frequency, 0.0, share]));
            }
        }
    }
    rows
}

const NUMERIC_COLUMNS: [&str; 6] =
    ["distance", "number_1", "number_2", "frequency", "decay_rate", "longitudinal_share"];

fn create_table(found: &BandStructureResult) -> DataFile<'_> {
    let header = ["family", "branch"].into_iter().chain(NUMERIC_COLUMNS);
    let rows = create_table_rows(found).into_iter().map(|(family, branch, place, values)| {
        let mut row: Vec<CsvCell> = vec![family.into(), (branch as f64).into()];
        row.extend(place.into_iter().chain(values).map(CsvCell::from));
        row
    });
    DataFile::table("dispersion.csv", header, rows)
}

fn create_arrays(found: &BandStructureResult) -> DataFile<'_> {
    let rows = create_table_rows(found);
    let along = [("row", rows.len())];
    let families: Vec<&str> = rows.iter().map(|row| row.0).collect();
    let branches = rows.iter().map(|row| row.1 as i32).collect();
    let mut arrays = vec![
        DataArray::texts("family", "row", &families),
        DataArray::new("branch", &along, "", ArrayData::I32(branches)),
    ];
    let units = NUMERIC_COLUMNS.map(|name| column_unit("dispersion.csv", name).unwrap_or_default());
    for (column, (name, unit)) in NUMERIC_COLUMNS.into_iter().zip(units).enumerate() {
        let value = |row: &(_, _, [f64; 3], [f64; 3])| match column {
            0..3 => row.2[column],
            _ => row.3[column - 3],
        };
        let values: Vec<f64> = rows.iter().map(value).collect();
        arrays.push(DataArray::numbers(name, &along, unit, values));
    }
    let texts = units.map(|unit| if unit == "1" { "" } else { unit });
    arrays.push(DataArray::texts("units", "column", &texts));
    DataFile::Arrays(arrays)
}

/// Returns the curves of all branches, cut to those steps between two points of the path whose mean longitudinal share
/// satisfies `is_selected`.
fn select_curves(
    found: &BandStructureResult,
    value: impl Fn(&analysis::bloch::bands::BlochWave) -> f64,
    is_selected: impl Fn(Option<f64>) -> bool,
) -> Vec<Vec<[f64; 2]>> {
    let branches = found.path_waves.iter().map(|at| at.waves.len()).max().unwrap_or(0);
    let mut curves = Vec::new();
    for branch in 0..branches {
        let mut curve: Vec<[f64; 2]> = Vec::new();
        for (points, waves) in found.path_points.windows(2).zip(found.path_waves.windows(2)) {
            let ends = [0, 1].map(|end| waves[end].waves.get(branch));
            let [Some(first), Some(last)] = ends else { continue };
            let share = match (first.longitudinal_share, last.longitudinal_share) {
                (Some(one), Some(other)) => Some(0.5 * (one + other)),
                (one, other) => one.or(other),
            };
            if !is_selected(share) {
                continue;
            }
            let start = points[0].distance;
            if curve.last().is_none_or(|point| point[0] != start) {
                curve.extend([[start, f64::NAN], [start, value(first)]]);
            }
            curve.push([points[1].distance, value(last)]);
        }
        if !curve.is_empty() {
            curves.push(curve);
        }
    }
    curves
}

fn create_figure(case: &Case, found: &BandStructureResult) -> BandFigure {
    let kilohertz = |omega: f64| omega / (TAU * 1e3);
    let family = |label: &str, style, curves| BandFamily { label: label.to_owned(), style, curves };
    let mut frequencies = Vec::new();
    let mut decay_rates = Vec::new();
    let frequency = |wave: &analysis::bloch::bands::BlochWave| kilohertz(wave.frequency);
    if found.is_damped() {
        frequencies.push(family(
            "waves of the medium",
            BandStyle::FirstFamily,
            select_curves(found, frequency, |_| true),
        ));
        let rates = select_curves(found, |wave| 1e-3 * wave.decay_rate, |_| true);
        decay_rates.push(family("", BandStyle::FirstFamily, rates));
    } else {
        let [low, high] = LONGITUDINAL_SHARE_LIMITS;
        let kinds: [(&str, BandStyle, [f64; 2]); 3] = [
            ("P-like", BandStyle::FirstFamily, [high, f64::INFINITY]),
            ("S-like", BandStyle::SecondFamily, [f64::NEG_INFINITY, low]),
            ("mixed or rotation", BandStyle::ThirdFamily, [low, high]),
        ];
        for (label, style, [from, to]) in kinds {
            let is_selected =
                |share: Option<f64>| share.is_some_and(|share| from < share && share <= to);
            frequencies.push(family(label, style, select_curves(found, frequency, is_selected)));
        }
    }
    if !found.continuum_frequencies.is_empty() {
        let curve = |branch: usize| -> Vec<[f64; 2]> {
            let own = found.path_points.iter().zip(&found.continuum_frequencies);
            own.map(|(point, all)| [point.distance, kilohertz(all[branch])]).collect()
        };
        let label = "equivalent Cosserat continuum";
        frequencies.push(family(label, BandStyle::Comparison, (0..3).map(curve).collect()));
    }
    if !found.chain_branches.is_empty() {
        let curves = found.chain_branches.iter().flat_map(|chain| &chain.curves);
        let scaled = curves.map(|curve| curve.iter().map(|&[x, y]| [x, kilohertz(y)]).collect());
        let label = "chain along x₁, exact";
        frequencies.push(family(label, BandStyle::Reference, scaled.collect()));
    }
    let [normal, tangential] = found.joints[0].fast_stiffnesses.map(format_short);
    BandFigure {
        title: case_title(case),
        subtitle: format!(
            "Bloch waves: blocks of {} m, {} joints, K_n = {normal} Pa/m, K_t = {tangential} Pa/m",
            format_short(found.blocks.side_lengths[0]),
            found.joints[0].layer_kind,
        ),
        path_label: "wave vector κ along the path".into(),
        frequency_label: "frequency f = Re ω/2π (kHz)".into(),
        decay_label: "decay Im ω (10³/s)".into(),
        vertices: found
            .path_vertices
            .iter()
            .map(|own| (own.distance, own.name.to_owned()))
            .collect(),
        frequencies,
        decay_rates,
        gaps: found.band_gaps.iter().flatten().map(|gap| gap.map(kilohertz)).collect(),
        gap_label: "band gap".into(),
        gap_unit: "kHz".into(),
    }
}
