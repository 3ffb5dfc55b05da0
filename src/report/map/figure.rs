//! Figure of a map: the verdict over two parameters of a case.

use crate::case::Case;
use crate::report::format::{case_title, coefficient_unit, format_short, format_superscript};
use crate::report::parameters::format_subtitle;
use crate::report::symbols::{typeset_symbol, typeset_unit};
use crate::study::MapResult;
use crate::study::map::summary::MapAxis;
use crate::study::map::{MapPoint, PointStatus};
use analysis::solids::Hyperbolicity;
use figures::{FillStyle, Hatching, MapCurve, VerdictCategory, VerdictMap, VerdictMapAxis};
use models::common::elementary::Elementary;

/// Class of growth at a map point: order of growth in the wave number, and for solids the type of the characteristic
/// speeds.
type GrowthClass = (f64, Option<Hyperbolicity>);

fn classify_growth(point: &MapPoint) -> GrowthClass {
    (point.growth_order, point.speeds.map(|speeds| speeds.hyperbolicity))
}

pub(super) fn create_figure(case: &Case, found: &MapResult) -> VerdictMap {
    let axis = |axis: &MapAxis| VerdictMapAxis {
        label: match (case.equations.is_some(), axis.unit) {
            (true, unit) => format_axis_label(&typeset_symbol(&axis.label), &typeset_unit(unit)),
            (false, unit) => format_axis_label(&axis.label, unit),
        },
        values: axis.values.clone(),
        is_log: axis.spacing.is_some(),
    };
    let points = &found.points;
    // One category per order of growth, and for solids per type of speeds, by descending order.
    let mut kinds: Vec<GrowthClass> =
        points.iter().filter(|p| p.growth_order.is_finite()).map(classify_growth).collect();
    let rank = |speeds: &Option<Hyperbolicity>| speeds.map_or(0, |h| h as u8);
    kinds.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank(&a.1).cmp(&rank(&b.1))));
    kinds.dedup();
    let mut orders: Vec<f64> = kinds.iter().map(|(order, _)| *order).collect();
    orders.dedup();
    let (level_label, level) =
        compute_colour_level(points, &orders, case.material.numbers.wave.wave_number);
    VerdictMap {
        title: case_title(case),
        subtitle: format_subtitle(case, &[&found.x.parameter, &found.y.parameter]),
        x: axis(&found.x),
        y: axis(&found.y),
        categories: create_categories(&kinds),
        category_indices: points.iter().map(|point| category_index(&kinds, point)).collect(),
        growth_levels: level,
        level_label,
        boundaries: found.boundaries.step_fractions.clone(),
        is_line: found.boundaries.is_on_line.clone(),
        curves: collect_noncoaxiality_curves(found),
    }
}

/// Formats name and unit of an axis.
fn format_axis_label(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        "deg" => format!("{name} (°)"),
        unit => format!("{name} ({unit})"),
    }
}

fn create_categories(kinds: &[GrowthClass]) -> Vec<VerdictCategory> {
    let mut categories =
        vec![VerdictCategory { label: "well-posed".into(), fill_style: FillStyle::WellPosed }];
    categories.extend(kinds.iter().map(|(order, speeds)| VerdictCategory {
        label: format!(
            "ill-posed{}: Re ς grows as k{}",
            speeds.map_or(String::new(), |speeds| format!(" by {}", speeds.cause())),
            format_superscript(*order)
        ),
        fill_style: FillStyle::IllPosed(growth_hatching(*order, *speeds)),
    }));
    categories.extend(
        [
            ("ill-posed: unbounded at finite k", FillStyle::UnboundedAtFiniteWaveNumber),
            ("marginal: no sign asserted", FillStyle::Marginal),
            ("indeterminate", FillStyle::Indeterminate),
            ("not fully deforming", FillStyle::Indeterminate),
            ("no such state", FillStyle::OutsideModel),
            ("no response while yielding", FillStyle::Indeterminate),
        ]
        .map(|(label, look)| VerdictCategory { label: label.into(), fill_style: look }),
    );
    categories
}

/// Returns the hatching of a kind of growth, the same in all maps: of solids by the cause, of flows by the order.
fn growth_hatching(order: f64, speeds: Option<Hyperbolicity>) -> Hatching {
    match speeds {
        Some(Hyperbolicity::Flutter) => Hatching::Plain,
        Some(Hyperbolicity::FlutterAndShearBand) => Hatching::Grid,
        Some(_) => Hatching::Vertical,
        None if order == 2.0 => Hatching::Plain,
        None if order == 1.0 => Hatching::Rising,
        None if order < 1.0 => Hatching::Falling,
        None => Hatching::Horizontal,
    }
}

/// Returns the index of a point's category in [`create_categories`].
fn category_index(kinds: &[GrowthClass], point: &MapPoint) -> u8 {
    let first_other = 1 + kinds.len();
    let index = match point.status {
        PointStatus::WellPosed => 0,
        PointStatus::IllPosed => {
            match kinds.iter().position(|&kind| kind == classify_growth(point)) {
                Some(i) => 1 + i,
                None => first_other,
            }
        }
        PointStatus::Marginal => first_other + 1,
        PointStatus::Indeterminate => first_other + 2,
        PointStatus::NotFullyDeforming => first_other + 3,
        PointStatus::OutsideModel => first_other + 4,
        PointStatus::NoResponse => first_other + 5,
    };
    u8::try_from(index).unwrap_or(u8::MAX)
}

/// Returns label and values of the colour level: the growth coefficient if all points with an order have the same one,
/// otherwise the leading growth rate coefficient · k^order at `wave_number`, 1/m, since coefficients of different
/// orders have different units.
fn compute_colour_level(
    points: &[MapPoint],
    orders: &[f64],
    wave_number: f64,
) -> (String, Vec<f64>) {
    match orders {
        [] | [_] => {
            let order = orders.first().copied().unwrap_or(1.0);
            let label = format!(
                "growth coefficient Re ς / k{} as k → ∞ ({})",
                format_superscript(order),
                coefficient_unit(order)
            );
            (label, points.iter().map(|p| p.growth_coefficient).collect())
        }
        _ => {
            let label =
                format!("leading growth rate at k = {} 1/m (1/s)", format_short(wave_number));
            let rate = |p: &MapPoint| p.growth_coefficient * wave_number.cr_powf(p.growth_order);
            (label, points.iter().map(rate).collect())
        }
    }
}

/// Returns the curves of the closed-form bound of the model on the non-coaxiality |Δ|, degrees, if Δ is on one of the
/// axes: one curve for each sign of Δ, with the points inside the axis range.
fn collect_noncoaxiality_curves(found: &MapResult) -> Vec<MapCurve> {
    const NONCOAXIALITY_KEY: &str = "background.noncoaxiality_deg";
    let (nx, ny) = (found.x.point_count, found.y.point_count);
    let (along_x, count) = match (found.x.parameter.as_str(), found.y.parameter.as_str()) {
        (NONCOAXIALITY_KEY, _) => (true, ny),
        (_, NONCOAXIALITY_KEY) => (false, nx),
        _ => return Vec::new(),
    };
    let (range, other) = if along_x { (&found.x, &found.y) } else { (&found.y, &found.x) };
    let curve = |sign: f64| {
        let points: Vec<[f64; 2]> = (0..count)
            .filter_map(|i| {
                let slice: &mut dyn Iterator<Item = &MapPoint> = if along_x {
                    &mut found.points[i * nx..][..nx].iter()
                } else {
                    &mut found.points[i..].iter().step_by(nx)
                };
                let bound =
                    slice.map(|p| p.noncoaxiality_bound_deg).find(|b| b.is_finite())? * sign;
                let inside = bound >= range.first_value.min(range.last_value)
                    && bound <= range.first_value.max(range.last_value);
                let other = other.values[i];
                inside.then_some(if along_x { [bound, other] } else { [other, bound] })
            })
            .collect();
        MapCurve { label: "bound on |Δ| for the leading order, closed form".into(), points }
    };
    [curve(-1.0), curve(1.0)].into_iter().filter(|c| c.points.len() > 1).collect()
}
