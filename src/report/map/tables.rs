//! Table and arrays of a map.

use crate::report::{ArrayData, DataArray, DataFile, DataTable, column_unit};
use crate::study::MapResult;
use crate::study::map::{CELL_PARTS, MapCode, MapNumber, PointStatus};
use analysis::flows::Route;
use analysis::solids::Hyperbolicity;
use files::csv::CsvCell;

/// Returns the numeric columns of the CSV table, which are fields of the NPZ archive too, with their names.
fn list_numeric_columns(found: &MapResult) -> Vec<(&'static str, MapNumber)> {
    let mut columns = vec![
        ("order", MapNumber::GrowthOrder),
        ("coefficient", MapNumber::GrowthCoefficient),
        ("direction_deg", MapNumber::Direction),
    ];
    match found.solid {
        None => columns.push(("noncoaxiality_bound_deg", MapNumber::NoncoaxialityBound)),
        Some(_) => columns.extend([
            ("elevation_deg", MapNumber::Elevation),
            ("flutter", MapNumber::Flutter),
            ("least_squared_speed", MapNumber::LeastSquaredSpeed),
            ("slowest_direction_deg", MapNumber::SlowestDirection),
            ("slowest_elevation_deg", MapNumber::SlowestElevation),
        ]),
    }
    if found.options.computes_growth_rate {
        columns.push(("growth_rate", MapNumber::GrowthRate));
    }
    if found.options.computes_bound {
        columns.push(("bound", MapNumber::GrowthBound));
    }
    columns
}

/// Creates the table, one row per point.
pub(super) fn create_table(found: &MapResult) -> DataFile<'_> {
    let is_solid = found.solid.is_some();
    let columns = list_numeric_columns(found);
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
        row.extend(columns.iter().map(|(_, own)| CsvCell::from(found.points.number(*own, index))));
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
    let codes = |name: &'static str, which: MapCode| {
        DataArray::new(name, &shape, "", ArrayData::I8(found.points.codes(which).into()))
    };
    let names = PointStatus::ALL.map(PointStatus::name);
    let [closed_form, model_blind] = Route::ALL.map(Route::name);
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
        codes("verdict", MapCode::Status),
        DataArray::texts("route_names", "route_name", &["none", closed_form, model_blind]),
        codes("route", MapCode::Route),
    ]);
    if found.solid.is_some() {
        let names = ["none"].into_iter().chain(Hyperbolicity::ALL.map(Hyperbolicity::name));
        let names: Vec<&str> = names.collect();
        arrays.push(DataArray::texts("hyperbolicity_names", "hyperbolicity_name", &names));
        arrays.push(codes("hyperbolicity", MapCode::Hyperbolicity));
    }
    arrays.extend(list_numeric_columns(found).into_iter().map(|(name, which)| {
        DataArray::numbers(name, &shape, unit(name), found.points.numbers(which))
    }));
    if let Some(own) = &found.certified {
        let [columns, rows] = own.cells.map(|count| count * CELL_PARTS);
        let names = own.area_shares.map(|share| share.0);
        arrays.push(DataArray::texts("certified_names", "certified_name", &names));
        let codes: Vec<i8> = own.parts.iter().map(|&code| code as i8).collect();
        let shape = [("certified_y", rows), ("certified_x", columns)];
        arrays.push(DataArray::new("certified", &shape, "", ArrayData::I8(codes.into())));
    }
    DataFile::Arrays(arrays)
}

/// Returns the unit of a field of a map.
pub(super) fn unit(name: &str) -> &'static str {
    column_unit("map.csv", name).unwrap_or_default()
}
