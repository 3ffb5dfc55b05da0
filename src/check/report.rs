//! The results of a solid: table, JSON and picture.

use super::{Checked, digits, exponent, unmeasured, unmeasured_words, worst, worst_words};
use crate::Error;
use crate::case::{Case, Wave};
use crate::report::format::{case_title, short};
use crate::setup;
use agreement::solids::{BandGap, BranchResult, GridResult, Measurement, Response};
use analysis::solids::branches;
use figures::{Band, Branch, DispersionFigure};
use serde_json::{Value, json};
use std::fmt::Write as _;

fn grid_json(row: &BranchResult, grid: &GridResult) -> Value {
    json!({
        "cells": grid.cells,
        "frequency": grid.measured.frequency,
        "growth_rate": grid.measured.growth,
        "expected_frequency": grid.expected.frequency,
        "expected_growth_rate": grid.expected.growth,
        "difference": row.relative(grid.measured).frequency,
        "tolerance": grid.tolerance,
        "agrees": grid.agrees(),
    })
}

/// Whether everything that was measured agrees; `None` where nothing was.
fn all_agree(checked: &[Checked]) -> Option<bool> {
    let all: Vec<bool> = checked.iter().filter_map(Checked::agrees).collect();
    (!all.is_empty()).then(|| all.into_iter().all(|own| own))
}

pub(super) fn report(case: &Case, checked: &[Checked]) -> Value {
    let row = |wave: Wave, row: &BranchResult| {
        let own = row.measured.as_ref().ok();
        let limit = own.map(|own| {
            let mut limit = grid_json(row, &own.limit);
            limit["cells"] = Value::Null;
            limit
        });
        let grids = own.iter().flat_map(|own| &own.grids);
        json!({
            "response": row.response.name(),
            "branch": row.branch,
            "wave": {
                "number": wave.number,
                "direction_deg": wave.direction_deg,
                "elevation_deg": wave.elevation_deg,
            },
            "predicted": { "frequency": row.predicted, "growth_rate": 0.0 },
            "limit": limit,
            "grids": grids.map(|grid| grid_json(row, grid)).collect::<Vec<_>>(),
            "not_measurable": row.measured.as_ref().err().map(ToString::to_string),
            "order": row.order(),
            "agrees": row.agrees(),
        })
    };
    let gap = |gap: &BandGap| {
        json!({
            "polarisation": gap.polarisation.name(),
            "from": gap.from,
            "to": gap.to,
            "nearest": gap.nearest,
            "agrees": gap.agrees,
        })
    };
    json!({
        "model": case.medium().title(),
        "agrees": all_agree(checked),
        "media": checked.iter().map(|own| json!({
            "place": own.place,
            "model": own.case.medium().title(),
            "agrees": own.agrees(),
            "rows": own.rows.iter().map(|result| row(own.wave(result), result)).collect::<Vec<_>>(),
            "forbidden_bands": own.gaps.iter().map(gap).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "units": { "frequency": "rad/s", "growth_rate": "1/s", "tolerance": "rad/s", "number": "1/m" },
    })
}

pub(super) fn words(case: &Case, checked: &[Checked]) -> String {
    let mut text = format!("{}\n", case_title(case));
    for own in checked {
        let place = if own.place.is_empty() { String::new() } else { format!("{}: ", own.place) };
        let _ = writeln!(text, "{place}{}", own.case.medium().title());
        let measured = own.rows.iter().find_map(|row| row.measured.as_ref().ok());
        let grids = measured.iter().flat_map(|own| &own.grids);
        let cells: Vec<String> = grids.map(|grid| grid.cells.to_string()).collect();
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
        let mut last: Option<Wave> = None;
        for row in &own.rows {
            let wave = own.wave(row);
            if last != Some(wave) {
                let up = match wave.elevation_deg {
                    0.0 => String::new(),
                    up => format!(", {}° above the plane", short(up)),
                };
                let (k, along) = (short(wave.number), short(wave.direction_deg));
                let _ = writeln!(text, "k = {k} 1/m at {along}°{up}");
                last = Some(wave);
            }
            let name = match row.response {
                Response::Elastic => row.branch.clone(),
                other => format!("{}: {}", other.name(), row.branch),
            };
            let (Ok(Measurement { grids, limit }), Some(found), Some(expected)) =
                (&row.measured, row.difference(), row.expected_difference())
            else {
                let reason = row.measured.as_ref().err().map_or(String::new(), ToString::to_string);
                let predicted = digits(row.predicted);
                let _ = writeln!(text, "  {name:<40}{predicted:>12}  not measurable: {reason}");
                continue;
            };
            let signed = |x: f64| if x == 0.0 { "0".into() } else { format!("{x:+.1e}") };
            let _ = writeln!(
                text,
                "  {:<40}{:>12}{:>12}{:>10}{:>10}{:>10}{:>10}{:>10}{:>6}  {}",
                name,
                digits(row.predicted),
                digits(limit.measured.frequency),
                signed(found.frequency),
                signed(expected.frequency),
                signed(found.growth),
                exponent(limit.tolerance / row.predicted),
                signed(row.relative(grids[0].measured).frequency),
                row.order().map_or("–".into(), |order| format!("{order:.2}")),
                if row.agrees() == Some(true) { "agrees" } else { "DISAGREES" },
            );
        }
        for gap in &own.gaps {
            let at = |own: Option<f64>| own.map_or("none".to_owned(), digits);
            let _ = writeln!(
                text,
                "\nno {} waves between {} and {} rad/s: measured next to it {} and {}  {}",
                gap.polarisation.name(),
                digits(gap.from),
                digits(gap.to),
                at(gap.nearest[0]),
                at(gap.nearest[1]),
                if gap.agrees { "agrees" } else { "DISAGREES" },
            );
        }
        let failed = own.rows.iter().filter(|row| row.agrees() == Some(false)).count();
        let verdict = match (failed, own.agrees()) {
            (_, None) => String::new(),
            (0, _) => ": all agree".to_owned(),
            (some, _) => format!(": {some} DISAGREE"),
        };
        let _ = writeln!(
            text,
            "\n{} waves, {}{verdict}{}",
            own.rows.len(),
            worst_words(worst(own.rows.iter())),
            unmeasured_words(unmeasured(&own.rows)),
        );
    }
    text
}

/// Phase speeds below this part of the greatest are zero: what stands still is not drawn.
const STILL: f64 = 1e-6;

/// Measured points on predicted curves: elastic ones of all directions, which are alike, where the solid is
/// isotropic; else of the first direction.
pub(super) fn figure(case: &Case, checked: &Checked) -> Result<DispersionFigure, Error> {
    let own = &checked.case;
    let solid = setup::solid::solid(own).map_err(|error| own.locate(error))?;
    let wave = checked.rows.first().map_or(own.numbers.wave, |row| checked.wave(row));
    let greatest = checked.rows.iter().map(|row| checked.wave(row).number).fold(0.0, f64::max);
    let speeds = checked.rows.iter().map(|row| row.predicted / checked.wave(row).number);
    let greatest_speed = speeds.fold(0.0, f64::max);
    let is_isotropic =
        solid.elastic.downcast::<models::cosserat::parameters::Isotropic>().is_some();
    let responses: &[(Response, bool)] = match solid.plastic {
        None => &[(Response::Elastic, true)],
        Some(_) => &[(Response::Unloading, true), (Response::Loading, false)],
    };
    let (mut curves, mut bands) = (Vec::new(), Vec::new());
    for &(response, stays_elastic) in responses {
        let all = branches(&solid, setup::solid::normal(&wave), greatest, stays_elastic)
            .map_err(|error| setup::locate(own, error.into()))?;
        for kind in &all {
            for (index, curve) in kind.curves(1.05 * greatest).into_iter().enumerate() {
                let label = kind.label(index);
                let is_own = |row: &&BranchResult| {
                    let other = checked.wave(row);
                    let is_along = (other.direction_deg, other.elevation_deg)
                        == (wave.direction_deg, wave.elevation_deg);
                    row.response == response
                        && row.branch == label
                        && (is_along || (is_isotropic && response != Response::Loading))
                };
                let measured = checked.rows.iter().filter(is_own);
                if curve.iter().all(|p| p.frequency <= STILL * p.number * greatest_speed) {
                    continue;
                }
                curves.push(Branch {
                    measured: measured
                        .filter_map(|row| {
                            let own = row.measured.as_ref().ok()?;
                            Some([checked.wave(row).number, own.limit.measured.frequency])
                        })
                        .collect(),
                    label: match response {
                        Response::Elastic => label,
                        other => format!("{}: {label}", other.name()),
                    },
                    frequency: curve.iter().map(|p| [p.number, p.frequency]).collect(),
                    group_speed: Vec::new(),
                    growth: Vec::new(),
                });
            }
            let inner = kind.bands.iter().filter(|band| band.from > 0.0 && band.to.is_finite());
            bands.extend(inner.map(|band| Band {
                label: format!("no {} waves", kind.family.polarisation.name()),
                from: band.from,
                to: band.to,
            }));
        }
    }
    Ok(DispersionFigure {
        title: case_title(case),
        subtitle: format!(
            "{}: curves from the analysis, rings from the solver{}{}",
            own.medium().title(),
            if is_isotropic && solid.plastic.is_none() { ", all directions" } else { "" },
            unmeasured_words(unmeasured(&checked.rows)),
        ),
        k_label: "wave number k (1/m)".into(),
        frequency_label: "angular frequency ω (rad/s)".into(),
        speed_label: "phase speed ω/k (m/s)".into(),
        growth_label: String::new(),
        k_log: false,
        frequency_log: false,
        branches: curves,
        bands,
        cutoffs: Vec::new(),
        speed_limits: Vec::new(),
    })
}
