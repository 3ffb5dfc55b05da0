//! Table and arrays of a map.

use crate::report::{ArrayData, DataArray, DataFile, DataTable, column_unit};
use crate::study::MapResult;
use crate::study::map::{MapPoint, PointSpeeds, PointStatus};
use analysis::flows::Route;
use analysis::solids::Hyperbolicity;
use files::csv::CsvCell;

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

/// Creates the table, one row per point.
pub(super) fn create_table(found: &MapResult) -> DataFile<'_> {
    let is_solid = found.solid.is_some();
    let columns = collect_numeric_columns(found);
    let (x, y) = (&found.x, &found.y);
    let mut header = vec!["verdict", "route"];
    header.extend(is_solid.then_some("hyperbolicity"));
    header.extend(columns.iter().map(|(name, _)| *name));
    let rows = found.points.iter().enumerate().map(move |(index, point)| {
        let mut row: Vec<CsvCell> = vec![
            x.values[index % x.point_count].into(),
            y.values[index / x.point_count].into(),
            point.status.name().into(),
            point.route.map_or("", Route::name).into(),
        ];
        if is_solid {
            row.push(point.speeds.map_or("", |speeds| speeds.hyperbolicity.name()).into());
        }
        row.extend(columns.iter().map(|(_, values)| CsvCell::from(values[index])));
        row
    });
    let parameters = [x, y].map(|axis| (axis.parameter.clone(), axis.unit.into()));
    let others = header.into_iter().map(|name| (name.to_owned(), unit(name).into()));
    DataFile::Table(DataTable {
        columns: parameters.into_iter().chain(others).collect(),
        rows: Box::new(rows),
    })
}

/// Creates the arrays: axes under the names of their parameters, fields of shape (y, x).
pub(super) fn create_arrays(found: &MapResult) -> DataFile<'_> {
    let (x, y) = (&found.x, &found.y);
    let shape = [y, x].map(|own| (own.parameter.as_str(), own.point_count));
    let codes = |name: &'static str, code: fn(&MapPoint) -> i8| {
        DataArray::new(name, &shape, "", ArrayData::I8(found.points.iter().map(code).collect()))
    };
    let names = PointStatus::ALL.map(PointStatus::name);
    let [closed_form, model_blind] = Route::ALL.map(Route::name);
    let route = |p: &MapPoint| match p.route {
        None => 0,
        Some(Route::ClosedForm) => 1,
        Some(Route::ModelBlind) => 2,
    };
    let mut arrays: Vec<DataArray> = [x, y]
        .map(|own| {
            let along = [(own.parameter.as_str(), own.point_count)];
            DataArray::numbers(own.parameter.as_str(), &along, own.unit, own.values.as_slice())
        })
        .into();
    arrays.extend([
        DataArray::texts("axes", "axis", &[&y.parameter, &x.parameter]),
        DataArray::texts("units", "axis", &[y.unit, x.unit]),
        DataArray::texts("verdict_names", "verdict_name", &names),
        codes("verdict", |p| p.status as i8),
        DataArray::texts("route_names", "route_name", &["none", closed_form, model_blind]),
        codes("route", route),
    ]);
    if found.solid.is_some() {
        let names = ["none"].into_iter().chain(Hyperbolicity::ALL.map(Hyperbolicity::name));
        let names: Vec<&str> = names.collect();
        arrays.push(DataArray::texts("hyperbolicity_names", "hyperbolicity_name", &names));
        let number = |p: &MapPoint| p.speeds.map_or(0, |speeds| 1 + speeds.hyperbolicity as i8);
        arrays.push(codes("hyperbolicity", number));
    }
    let columns = collect_numeric_columns(found).into_iter();
    arrays
        .extend(columns.map(|(name, values)| DataArray::numbers(name, &shape, unit(name), values)));
    DataFile::Arrays(arrays)
}

/// Returns the unit of a field of a map.
pub(super) fn unit(name: &str) -> &'static str {
    column_unit("map.csv", name).unwrap_or_default()
}
