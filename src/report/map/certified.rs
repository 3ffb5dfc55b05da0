//! Text and picture of a certified map.

use super::super::format::{case_title, format_count, format_short};
use super::super::parameters::format_subtitle;
use super::figure::create_axis;
use crate::case::Case;
use crate::study::MapResult;
use crate::study::certified::CellVerdict;
use crate::study::map::summary::MapAxis;
use crate::study::map::{CELL_PARTS, CertifiedMap};
use figures::{FillStyle, Hatching, VerdictCategory, VerdictMap};
use models::common::elementary::Elementary;

pub(super) fn summary_lines(own: &CertifiedMap) -> Vec<String> {
    let cells = own.cells[0] * own.cells[1];
    let mut lines = vec![format!(
        "Proved for all states of cells between points ({}), with parts of 1/{CELL_PARTS} of a step:",
        own.method
    )];
    for ((name, count), (_, share)) in own.cell_counts.iter().zip(&own.area_shares) {
        if *count > 0 || *share > 0.0 {
            lines.push(format!(
                "  {name}: {} of {cells}, {} % of the area",
                format_count(*count, "cell"),
                format_short(100.0 * share)
            ));
        }
    }
    lines
}

pub(super) fn create_figure(case: &Case, found: &MapResult, own: &CertifiedMap) -> VerdictMap {
    let category = |verdict: CellVerdict| VerdictCategory {
        label: own.area_shares[verdict as usize].0.into(),
        fill_style: match verdict {
            CellVerdict::WellPosed => FillStyle::WellPosed,
            CellVerdict::IllPosed => FillStyle::IllPosed(Hatching::Plain),
            CellVerdict::NotDecided => FillStyle::Indeterminate,
            CellVerdict::NoState => FillStyle::OutsideModel,
        },
        level_factor: 1.0,
    };
    // The middle of each part of a cell.
    let axis = |axis: &MapAxis| {
        let middle = |[first, last]: [f64; 2], part: usize| {
            let place = (part as f64 + 0.5) / CELL_PARTS as f64;
            match axis.spacing {
                None => first + (last - first) * place,
                Some(_) => first * (last / first).cr_powf(place),
            }
        };
        let steps = axis.values.windows(2);
        let values = steps
            .flat_map(|pair| (0..CELL_PARTS).map(move |part| middle([pair[0], pair[1]], part)));
        create_axis(case, axis, values.collect())
    };
    VerdictMap {
        title: case_title(case),
        subtitle: format_subtitle(case, &[&found.x.parameter, &found.y.parameter]),
        x: axis(&found.x),
        y: axis(&found.y),
        categories: CellVerdict::ALL.map(category).into(),
        category_indices: own.parts.clone(),
        growth_levels: Default::default(),
        level_label: String::new(),
        boundaries: Default::default(),
        is_line: Default::default(),
        curves: Vec::new(),
    }
}
