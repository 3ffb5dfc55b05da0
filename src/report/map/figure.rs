//! Figure of a map.

use crate::case::{Case, Kind, Parameter};
use crate::report::format::{case_title, coefficient_unit, short, superscript, unit};
use crate::study::MapResult;
use crate::study::map::summary::MapAxis;
use crate::study::map::{MapPoint, PointStatus};
use analysis::solids::Hyperbolicity;
use figures::{Axis, Category, Curve, Look, VerdictMap};
use models::common::elementary::Elementary;

/// Order of growth, and for solids the type of the characteristic speeds.
type Growing = (f64, Option<Hyperbolicity>);

fn growing(point: &MapPoint) -> Growing {
    (point.order, point.speeds.map(|speeds| speeds.hyperbolicity))
}

pub(super) fn figure(case: &Case, found: &MapResult) -> VerdictMap {
    let axis = |axis: &MapAxis| Axis {
        label: match axis.unit {
            "" => axis.label.clone(),
            "deg" => format!("{} (°)", axis.label),
            unit => format!("{} ({unit})", axis.label),
        },
        values: axis.values.clone(),
    };
    let points = &found.points;
    // One category per order of growth, and for solids per type of speeds, by descending order.
    let mut kinds: Vec<Growing> =
        points.iter().filter(|p| p.order.is_finite()).map(growing).collect();
    let place = |speeds: &Option<Hyperbolicity>| speeds.map_or(0, |h| h as u8);
    kinds.sort_by(|a, b| b.0.total_cmp(&a.0).then(place(&a.1).cmp(&place(&b.1))));
    kinds.dedup();
    let mut orders: Vec<f64> = kinds.iter().map(|(order, _)| *order).collect();
    orders.dedup();
    let (level_label, level) = level(points, &orders, case.material.numbers.wave.number);
    VerdictMap {
        title: case_title(case),
        subtitle: subtitle(case, found),
        x: axis(&found.x),
        y: axis(&found.y),
        categories: categories(&kinds),
        category: points.iter().map(|point| category(&kinds, point)).collect(),
        level,
        level_label,
        curves: noncoaxiality_curves(found),
    }
}

fn categories(kinds: &[Growing]) -> Vec<Category> {
    let mut categories = vec![Category { label: "well-posed".into(), look: Look::WellPosed }];
    categories.extend(kinds.iter().map(|(order, speeds)| Category {
        label: format!(
            "ill-posed{}: Re ς grows as k{}",
            speeds.map_or(String::new(), |speeds| format!(" by {}", speeds.cause())),
            superscript(*order)
        ),
        look: Look::IllPosed,
    }));
    categories.extend(
        [
            ("ill-posed: unbounded at finite k", Look::UnboundedAtFiniteWaveNumber),
            ("marginal: no sign asserted", Look::Marginal),
            ("indeterminate", Look::Indeterminate),
            ("not fully deforming", Look::Indeterminate),
            ("no such state", Look::OutsideModel),
            ("no response while yielding", Look::Indeterminate),
        ]
        .map(|(label, look)| Category { label: label.into(), look }),
    );
    categories
}

/// Returns the index of a point's category in [`categories`].
fn category(kinds: &[Growing], point: &MapPoint) -> u8 {
    let first_other = 1 + kinds.len();
    let index = match point.status {
        PointStatus::WellPosed => 0,
        PointStatus::IllPosed => match kinds.iter().position(|&kind| kind == growing(point)) {
            Some(i) => 1 + i,
            None => first_other,
        },
        PointStatus::Marginal => first_other + 1,
        PointStatus::Indeterminate => first_other + 2,
        PointStatus::NotFullyDeforming => first_other + 3,
        PointStatus::OutsideModel => first_other + 4,
        PointStatus::NoResponse => first_other + 5,
    };
    u8::try_from(index).unwrap_or(u8::MAX)
}

/// Returns label and values of the colour level: the growth coefficient if all points have one order, otherwise the
/// leading growth rate at `wave_number`, 1/m, since coefficients of different orders have different units.
fn level(points: &[MapPoint], orders: &[f64], wave_number: f64) -> (String, Vec<f64>) {
    match orders {
        [] | [_] => {
            let order = orders.first().copied().unwrap_or(1.0);
            let label = format!(
                "growth coefficient lim Re ς / k{} ({})",
                superscript(order),
                coefficient_unit(order)
            );
            (label, points.iter().map(|p| p.coefficient).collect())
        }
        _ => {
            let label = format!("leading growth rate at k = {} 1/m (1/s)", short(wave_number));
            let rate = |p: &MapPoint| p.coefficient * wave_number.cr_powf(p.order);
            (label, points.iter().map(rate).collect())
        }
    }
}

/// Describes the model and the fixed parameters most relevant to the verdict.
fn subtitle(case: &Case, found: &MapResult) -> String {
    let fixed = [
        "model.friction_angle_deg",
        "model.dilatancy_angle_deg",
        "model.rotational_strength",
        "background.noncoaxiality_deg",
        "yield.shear_friction",
        "yield.shear_dilatancy",
        "yield.friction",
        "yield.dilatancy",
    ]
    .into_iter()
    .filter(|name| *name != found.x.parameter && *name != found.y.parameter)
    .filter_map(Parameter::find)
    .filter(|parameter| parameter.key().is_used_by(case.medium()))
    .filter_map(|parameter| {
        let value = parameter.get(&case.material.numbers)?;
        Some(format!("{} = {}{}", parameter.label(), short(value), unit(parameter.unit())))
    });
    let space = match (case.material.kind, case.material.numbers.dimensions) {
        (Kind::Solid(_), 3) => Some("in space".to_owned()),
        (Kind::Solid(_), _) => Some("plane strain".to_owned()),
        _ => None,
    };
    let active = case.material.active.iter().map(|active| {
        let all = case.medium().condition_names();
        let names: Vec<&str> = active.iter().map(|&index| all[index]).collect();
        format!("active {}", names.join(" "))
    });
    [case.medium().title()]
        .into_iter()
        .chain(space)
        .chain(active)
        .chain(fixed)
        .collect::<Vec<_>>()
        .join(", ")
}

/// Returns the curves of the model's closed-form bound on |Δ| if Δ is one of the axes.
fn noncoaxiality_curves(found: &MapResult) -> Vec<Curve> {
    const DELTA: &str = "background.noncoaxiality_deg";
    let (nx, ny) = (found.x.points, found.y.points);
    let (along_x, count) = match (found.x.parameter.as_str(), found.y.parameter.as_str()) {
        (DELTA, _) => (true, ny),
        (_, DELTA) => (false, nx),
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
                let inside = bound >= range.from.min(range.to) && bound <= range.from.max(range.to);
                let other = other.values[i];
                inside.then_some(if along_x { [bound, other] } else { [other, bound] })
            })
            .collect();
        Curve { label: "bound on |Δ| for the leading order, closed form".into(), points }
    };
    [curve(-1.0), curve(1.0)].into_iter().filter(|c| c.points.len() > 1).collect()
}
