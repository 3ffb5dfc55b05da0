//! Figure of a map: the verdict over two parameters of a case.

use crate::case::Case;
use crate::report::format::{case_title, coefficient_unit, format_short, format_superscript};
use crate::report::parameters::format_subtitle;
use crate::report::symbols::{typeset_symbol, typeset_unit};
use crate::study::MapResult;
use crate::study::map::summary::MapAxis;
use crate::study::map::{MapNumber, MapPoint, PointStatus};
use analysis::solids::Hyperbolicity;
use figures::{FillStyle, Hatching, MapCurve, VerdictCategory, VerdictMap, VerdictMapAxis};
use models::common::elementary::Elementary;

const _: () = assert!(figures::STEP_PARTS == crate::study::map::STEP_PARTS);

/// Class of growth at a map point: order of growth in the wave number, and for solids the type of the characteristic
/// speeds.
type GrowthClass = (f64, Option<Hyperbolicity>);

fn classify_growth(point: &MapPoint) -> GrowthClass {
    (point.growth_order, point.speeds.map(|speeds| speeds.hyperbolicity))
}

/// Returns the axis of a picture with points at these values.
pub(super) fn create_axis(case: &Case, axis: &MapAxis, values: Vec<f64>) -> VerdictMapAxis {
    VerdictMapAxis {
        label: match (case.equations.is_some(), axis.unit) {
            (true, unit) => format_axis_label(&typeset_symbol(&axis.label), &typeset_unit(unit)),
            (false, unit) => format_axis_label(&axis.label, unit),
        },
        values,
        is_log: axis.spacing.is_some(),
    }
}

pub(super) fn create_figure(case: &Case, found: &MapResult) -> VerdictMap {
    let axis = |own: &MapAxis| create_axis(case, own, own.values.clone());
    let points = &found.points;
    // One category per order of growth, and for solids per type of speeds, by descending order.
    let mut kinds: Vec<GrowthClass> = Vec::new();
    for kind in points.iter().filter(|p| p.growth_order.is_finite()).map(|p| classify_growth(&p)) {
        if !kinds.contains(&kind) {
            kinds.push(kind);
        }
    }
    let rank = |speeds: &Option<Hyperbolicity>| speeds.map_or(0, |h| h as u8);
    kinds.sort_by(|a, b| b.0.total_cmp(&a.0).then(rank(&a.1).cmp(&rank(&b.1))));
    let mut orders: Vec<f64> = kinds.iter().map(|(order, _)| *order).collect();
    orders.dedup();
    let (level_label, level_factor) = colour_level(&orders, case.material.numbers.wave.wave_number);
    VerdictMap {
        title: case_title(case),
        subtitle: format_subtitle(case, &[&found.x.parameter, &found.y.parameter]),
        x: axis(&found.x),
        y: axis(&found.y),
        categories: create_categories(&kinds, level_factor),
        category_indices: points.iter().map(|point| category_index(&kinds, &point)).collect(),
        growth_levels: points.shared_numbers(MapNumber::GrowthCoefficient),
        level_label,
        boundaries: found.boundaries.step_parts.clone(),
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

/// `level_factor` returns the factor of growth coefficients of an order in the colour level.
fn create_categories(
    kinds: &[GrowthClass],
    level_factor: impl Fn(f64) -> f64,
) -> Vec<VerdictCategory> {
    let without_level = |label: &str, fill_style| VerdictCategory {
        label: label.into(),
        fill_style,
        level_factor: 1.0,
    };
    let mut categories = vec![without_level("well-posed", FillStyle::WellPosed)];
    categories.extend(kinds.iter().map(|(order, speeds)| VerdictCategory {
        label: format!(
            "ill-posed{}: Re ς grows as k{}",
            speeds.map_or(String::new(), |speeds| format!(" by {}", speeds.cause())),
            format_superscript(*order)
        ),
        fill_style: FillStyle::IllPosed(growth_hatching(*order, *speeds)),
        level_factor: level_factor(*order),
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
        .map(|(label, look)| without_level(label, look)),
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

/// Returns the label of the colour level, and the factor of growth coefficients of an order in it: the level is the growth
/// coefficient if all points with an order have the same one, otherwise the leading growth rate coefficient · k^order at
/// `wave_number`, 1/m, since coefficients of different orders have different units.
fn colour_level(orders: &[f64], wave_number: f64) -> (String, impl Fn(f64) -> f64) {
    let is_uniform = orders.len() < 2;
    let label = match is_uniform {
        true => {
            let order = orders.first().copied().unwrap_or(1.0);
            format!(
                "growth coefficient Re ς / k{} as k → ∞ ({})",
                format_superscript(order),
                coefficient_unit(order)
            )
        }
        false => format!("leading growth rate at k = {} 1/m (1/s)", format_short(wave_number)),
    };
    (label, move |order| if is_uniform { 1.0 } else { wave_number.cr_powf(order) })
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
                let (first, step, length) = if along_x { (i * nx, 1, nx) } else { (i, nx, ny) };
                let slice = (0..length).map(|place| {
                    found.points.number(MapNumber::NoncoaxialityBound, first + place * step)
                });
                let bound = slice.into_iter().find(|bound| bound.is_finite())? * sign;
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
