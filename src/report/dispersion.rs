//! Report on the dispersion relation of a solid.

use super::format::{case_title, short};
use super::{Picture, Report};
use crate::Error;
use crate::case::Case;
use crate::study::dispersion::{BranchFamily, Dispersion};
use figures::{Band, Branch, DispersionFigure, Level};
use models::solid::parameters::Isotropic;
use std::fmt::Write as _;

impl Report for Dispersion {
    const NAME: &'static str = "dispersion";
    const UNITS: &'static [(&'static str, &'static str)] =
        &[("frequency", "rad/s"), ("speed", "m/s"), ("number", "1/m")];

    fn text(&self, case: &Case) -> String {
        let wave = self.wave;
        let mut text = format!(
            "{}\nmodel: {}\nwaves along {}°, {}° above the plane; frequencies in rad/s, speeds in m/s\n",
            case_title(case),
            case.medium().title(),
            short(wave.direction_deg),
            short(wave.elevation_deg),
        );
        for family in &self.families {
            family.write(wave.number, &mut text);
        }
        text
    }

    fn pictures(&self, case: &Case) -> Result<Vec<Picture>, Error> {
        let figure = figure(case, self);
        Ok(vec![Picture::new(Self::NAME, move |format| figure.draw(format))])
    }

    fn tables(&self, _case: &Case) -> Result<Vec<(&'static str, Vec<u8>)>, Error> {
        Ok(vec![("dispersion.csv", csv(&self.families)?)])
    }
}

impl BranchFamily {
    fn write(&self, number: f64, text: &mut String) {
        let count = if self.count > 1 { format!(" (×{})", self.count) } else { String::new() };
        let _ = writeln!(text, "\n{}{count}", self.polarisation);
        let speeds = self.characteristic_speeds.iter().zip(&self.characteristic_growth);
        let speeds: Vec<String> = speeds
            .map(|(real, growth)| match growth {
                0.0 => short(*real),
                _ => format!("{} ± {}i", short(*real), short(*growth)),
            })
            .collect();
        let _ = writeln!(text, "  characteristic speeds   {}", speeds.join(", "));
        if !self.cut_off_frequencies.is_empty() {
            let _ = writeln!(text, "  cut-off frequencies     {}", list(&self.cut_off_frequencies));
        }
        if !self.short_wave_limits.is_empty() {
            let limits = list(&self.short_wave_limits);
            let _ = writeln!(text, "  frequencies as k → ∞    {limits} (speed zero)");
        }
        for [from, to] in &self.forbidden_bands {
            let from = short(*from);
            let _ = match to.is_finite() {
                true => writeln!(text, "  no such waves between   {from} and {}", short(*to)),
                false => writeln!(text, "  no such waves above     {from}"),
            };
        }
        for (label, point) in self.labels.iter().zip(&self.at_wave) {
            let growth = match point.growth_rate {
                0.0 => String::new(),
                rate => format!(", growth rate {} 1/s", short(rate)),
            };
            let _ = writeln!(
                text,
                "  at k = {} 1/m: ω = {}{growth}, phase speed {}, group speed {}  [{label}]",
                short(number),
                short(point.frequency),
                short(point.phase_speed),
                short(point.group_speed),
            );
        }
    }
}

fn list(values: &[f64]) -> String {
    values.iter().map(|&x| short(x)).collect::<Vec<_>>().join(", ")
}

fn csv(families: &[BranchFamily]) -> Result<Vec<u8>, Error> {
    let header = ["branch", "number", "frequency", "phase_speed", "group_speed", "growth_rate"];
    let rows = families.iter().flat_map(|family| {
        family.labels.iter().zip(&family.curves).flat_map(|(label, curve)| {
            curve.iter().map(move |p| -> Vec<files::csv::Cell> {
                vec![
                    label.as_str().into(),
                    p.number.into(),
                    p.frequency.into(),
                    p.phase_speed.into(),
                    p.group_speed.into(),
                    p.growth_rate.into(),
                ]
            })
        })
    });
    Ok(files::csv::table(&header, rows)?)
}

fn figure(case: &Case, found: &Dispersion) -> DispersionFigure {
    let wave = found.wave;
    let branches = found.families.iter().flat_map(|family| {
        family.labels.iter().zip(&family.curves).map(|(label, curve)| Branch {
            label: label.clone(),
            frequency: curve.iter().map(|p| [p.number, p.frequency]).collect(),
            group_speed: curve.iter().map(|p| [p.number, p.group_speed]).collect(),
            measured: Vec::new(),
            growth: match curve.iter().any(|p| p.growth_rate > 0.0) {
                true => curve.iter().map(|p| [p.number, p.growth_rate]).collect(),
                false => Vec::new(),
            },
        })
    });
    // Bands between 0 and a cut-off frequency are left to the dashed cut-off line.
    let bands = found.families.iter().flat_map(|family| {
        let between = |band: &&[f64; 2]| band[0] > 0.0 && band[1].is_finite();
        family.forbidden_bands.iter().filter(between).map(|&[from, to]| Band {
            label: format!("no {} waves", family.polarisation),
            from,
            to,
        })
    });
    DispersionFigure {
        title: case_title(case),
        subtitle: format!(
            "{}, waves along {}°{}; solid: phase speed, dashed: group speed",
            case.medium().title(),
            short(wave.direction_deg),
            match wave.elevation_deg {
                0.0 => String::new(),
                up => format!(", {}° above the plane", short(up)),
            },
        ),
        k_label: "wave number k (1/m)".into(),
        frequency_label: "frequency ω (rad/s)".into(),
        speed_label: "speed (m/s)".into(),
        growth_label: "growth rate Re ς (1/s)".into(),
        k_log: false,
        frequency_log: false,
        branches: branches.collect(),
        bands: bands.collect(),
        cutoffs: cutoffs(&found.families),
        speed_limits: speed_limits(found),
    }
}

fn cutoffs(families: &[BranchFamily]) -> Vec<Level> {
    let mut cutoffs: Vec<Level> = Vec::new();
    for &value in families.iter().flat_map(|family| &family.cut_off_frequencies) {
        if cutoffs.iter().all(|level| (level.value - value).abs() > 1e-9 * value) {
            cutoffs.push(Level { label: format!("{} rad/s", short(value)), value });
        }
    }
    cutoffs
}

/// Returns the closed-form speeds of short waves in an isotropic solid, m/s.
fn speed_limits(found: &Dispersion) -> Vec<Level> {
    let solid = &found.solid;
    let Some(elastic) = solid.elastic.downcast::<Isotropic>() else { return Vec::new() };
    let speeds = elastic.speeds();
    let of_elastic = if solid.plastic.is_some() { "elastic " } else { "" };
    let level = |label: &str, value: f64| Level { label: format!("{of_elastic}{label}"), value };
    [
        Some(level("c_p", speeds.longitudinal)),
        Some(level("c_s", speeds.shear)),
        // In plane strain no rotation is about the wave vector.
        speeds.torsion.filter(|_| solid.dimensions == 3).map(|c| level("c_m", c)),
        speeds.rotation.map(|c| level("c_ω", c)),
    ]
    .into_iter()
    .flatten()
    .collect()
}
