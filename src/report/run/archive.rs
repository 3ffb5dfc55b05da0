//! Arrays of fields and of records, and the reader of the archive of fields.

use crate::report::{ArrayData, DataArray};
use crate::study::simulate::{FieldQuantity, OutputFields, RecordTable};
use files::npz::{ArrayValues, NpzArray, NpzError, read_selected_arrays};
use std::borrow::Cow;

/// Creates the arrays of the output fields at one time; values of owned fields are moved.
pub fn create_field_arrays<'a>(fields: Cow<'a, OutputFields>) -> Vec<DataArray<'a>> {
    const AXES: [&str; 3] = ["x1", "x2", "x3"];
    // Shapes list the slowest-varying axis first; in the fields the first axis varies fastest.
    let lengths = fields.coordinates.iter().map(Vec::len);
    let mut shape: Vec<(&str, usize)> = AXES.into_iter().zip(lengths).collect();
    shape.reverse();
    let mut arrays: Vec<DataArray> = AXES
        .into_iter()
        .zip(&fields.coordinates)
        .map(|(axis, along)| DataArray::numbers(axis, &[(axis, along.len())], "m", along.clone()))
        .collect();
    arrays.push(DataArray::numbers("time", &[], "s", vec![fields.time]));
    if let Some(deformation) = &fields.deformation_gradient {
        let values = deformation.as_flattened().to_vec();
        arrays.push(DataArray::numbers("deformation", &[("row", 2), ("column", 2)], "1", values));
    }
    let names: Vec<&str> = fields.quantities.iter().map(|own| own.name.as_str()).collect();
    let units: Vec<&str> = fields.quantities.iter().map(|own| own.unit).collect();
    arrays.push(DataArray::texts("names", "quantity", &names));
    arrays.push(DataArray::texts("units", "quantity", &units));
    let regions: Vec<i32> = fields.region_indices.iter().map(|&region| i32::from(region)).collect();
    let mut add = |name: Cow<'a, str>, unit: &'static str, values: Cow<'a, [f64]>| {
        arrays.push(DataArray::numbers(name, &shape, unit, values));
    };
    match fields {
        Cow::Borrowed(fields) => {
            for own in &fields.quantities {
                add(own.name.as_str().into(), own.unit, own.values.as_slice().into());
            }
            if !fields.plastic_dissipation.is_empty() {
                add("dissipation".into(), "J/m3", fields.plastic_dissipation.as_slice().into());
            }
        }
        Cow::Owned(fields) => {
            for own in fields.quantities {
                add(own.name.into(), own.unit, own.values.into());
            }
            if !fields.plastic_dissipation.is_empty() {
                add("dissipation".into(), "J/m3", fields.plastic_dissipation.into());
            }
        }
    }
    if !regions.is_empty() {
        arrays.push(DataArray::new("region", &shape, "", ArrayData::I32(regions)));
    }
    arrays
}

/// Reads the fields to be drawn from an archive on a grid of `cells` cells or points; the deformation gradient of a
/// flow is not read.
///
/// # Errors
/// The archive is damaged or does not match the grid.
pub fn read_fields(bytes: &[u8], cells: usize) -> Result<OutputFields, NpzError> {
    let mut fields = OutputFields::default();
    let is_numbers = |name: &str| !["names", "units"].contains(&name);
    for NpzArray { name, values, .. } in read_selected_arrays(bytes, is_numbers, cells)? {
        match (name.as_str(), values) {
            ("time", ArrayValues::F64(time)) => fields.time = time.first().copied().unwrap_or(0.0),
            ("x1" | "x2" | "x3", ArrayValues::F64(along)) => fields.coordinates.push(along),
            ("dissipation", ArrayValues::F64(values)) => fields.plastic_dissipation = values,
            ("region", ArrayValues::I32(regions)) => {
                fields.region_indices = regions.iter().map(|&region| region as u16).collect();
            }
            ("deformation", _) => {}
            (_, ArrayValues::F64(values)) => {
                fields.quantities.push(FieldQuantity::new(name, values))
            }
            _ => {}
        }
    }
    Ok(fields)
}

/// Creates the arrays of a table, one per column; values of an owned table are moved.
pub fn create_record_arrays<'a>(table: Cow<'a, RecordTable>) -> Vec<DataArray<'a>> {
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let units: Vec<&str> = table.columns.iter().map(|column| column.unit).collect();
    let mut arrays = vec![
        DataArray::texts("names", "column", &names),
        DataArray::texts("units", "column", &units),
    ];
    let mut add = |name: Cow<'a, str>, unit: &'static str, values: Cow<'a, [f64]>| {
        arrays.push(DataArray::numbers(name, &[("time", values.len())], unit, values));
    };
    match table {
        Cow::Borrowed(table) => table
            .columns
            .iter()
            .for_each(|own| add(own.name.as_str().into(), own.unit, own.values.as_slice().into())),
        Cow::Owned(table) => table
            .columns
            .into_iter()
            .for_each(|own| add(own.name.into(), own.unit, own.values.into())),
    }
    arrays
}
