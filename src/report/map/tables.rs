//! CSV table and NPZ archive of a map.

use crate::Error;
use crate::study::MapResult;
use crate::study::map::{MapPoint, PointSpeeds, PointStatus};
use analysis::flows::Route;
use analysis::solids::Hyperbolicity;

/// Returns the numeric columns of the CSV table, which are fields of the NPZ archive too: name and value at each point.
fn collect_numeric_columns(found: &MapResult) -> Vec<(&'static str, Vec<f64>)> {
    let column = |f: fn(&MapPoint) -> f64| found.points.iter().map(f).collect::<Vec<_>>();
    let mut columns = vec![
        ("order", column(|p| p.growth_order)),
        ("coefficient", column(|p| p.growth_coefficient)),
        ("direction_deg", column(|p| p.direction_deg)),
    ];
    match found.solid {
        None => columns.push(("noncoaxiality_bound_deg", column(|p| p.noncoaxiality_bound_deg))),
        Some(_) => {
            let speed = |f: fn(&PointSpeeds) -> f64| {
                let points = found.points.iter();
                points.map(|p| p.speeds.as_ref().map_or(f64::NAN, f)).collect::<Vec<_>>()
            };
            columns.extend([
                ("elevation_deg", column(|p| p.elevation_deg)),
                ("flutter", speed(|s| s.max_imaginary_speed)),
                ("least_squared_speed", speed(|s| s.min_squared_speed)),
                ("slowest_direction_deg", speed(|s| s.slowest_normal_deg[0])),
                ("slowest_elevation_deg", speed(|s| s.slowest_normal_deg[1])),
            ]);
        }
    }
    if found.options.computes_growth_rate {
        columns.push(("growth_rate", column(|p| p.growth_rate)));
    }
    if found.options.computes_bound {
        columns.push(("bound", column(|p| p.growth_bound)));
    }
    columns
}

/// Renders the CSV table, one row per point.
pub(super) fn format_csv(found: &MapResult) -> Result<Vec<u8>, Error> {
    let is_solid = found.solid.is_some();
    let columns = collect_numeric_columns(found);
    let (x, y) = (&found.x, &found.y);
    let mut header = vec![x.parameter.as_str(), y.parameter.as_str(), "verdict", "route"];
    header.extend(is_solid.then_some("hyperbolicity"));
    header.extend(columns.iter().map(|(name, _)| *name));
    let rows = found.points.iter().enumerate().map(|(index, point)| {
        let mut row: Vec<files::csv::CsvCell> = vec![
            x.values[index % x.point_count].into(),
            y.values[index / x.point_count].into(),
            point.status.name().into(),
            point.route.map_or("", Route::name).into(),
        ];
        if is_solid {
            row.push(point.speeds.map_or("", |speeds| speeds.hyperbolicity.name()).into());
        }
        row.extend(columns.iter().map(|(_, values)| files::csv::CsvCell::from(values[index])));
        row
    });
    Ok(files::csv::format_table(&header, rows)?)
}

/// Renders the NPZ archive: axes under the names of their parameters, fields of shape (y, x).
pub(super) fn encode_npz(found: &MapResult) -> Result<Vec<u8>, Error> {
    let (x, y) = (&found.x, &found.y);
    let shape = [y.point_count, x.point_count];
    let codes = |f: fn(&MapPoint) -> i8| found.points.iter().map(f).collect::<Vec<_>>();
    let mut npz = files::npz::NpzWriter::new();
    npz.add_f64(&x.parameter, &[x.point_count], &x.values)?;
    npz.add_f64(&y.parameter, &[y.point_count], &y.values)?;
    npz.add_text("axes", &[2], &[&y.parameter, &x.parameter])?;
    npz.add_text("units", &[2], &[y.unit, x.unit])?;
    let names = PointStatus::ALL.map(PointStatus::name);
    npz.add_text("verdict_names", &[names.len()], &names)?;
    npz.add_i8("verdict", &shape, &codes(|p| p.status as i8))?;
    let [closed_form, model_blind] = Route::ALL.map(Route::name);
    npz.add_text("route_names", &[3], &["none", closed_form, model_blind])?;
    let route = |p: &MapPoint| match p.route {
        None => 0,
        Some(Route::ClosedForm) => 1,
        Some(Route::ModelBlind) => 2,
    };
    npz.add_i8("route", &shape, &codes(route))?;
    if found.solid.is_some() {
        let names = ["none"].into_iter().chain(Hyperbolicity::ALL.map(Hyperbolicity::name));
        npz.add_text("hyperbolicity_names", &[5], &names.collect::<Vec<_>>())?;
        let number = |p: &MapPoint| p.speeds.map_or(0, |speeds| 1 + speeds.hyperbolicity as i8);
        npz.add_i8("hyperbolicity", &shape, &codes(number))?;
    }
    for (name, values) in collect_numeric_columns(found) {
        npz.add_f64(name, &shape, &values)?;
    }
    Ok(npz.finish()?)
}
