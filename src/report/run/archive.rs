//! NPZ archives of the final fields and of receiver records.

use crate::Error;
use crate::study::simulate::{FieldQuantity, OutputFields, RecordTable};
use files::npz::{ArrayValues, NpzArray, NpzError, NpzWriter, read_selected_arrays};

/// Renders the NPZ archive of the output fields at one time.
///
/// # Errors
/// The archive cannot be created.
pub(super) fn encode_fields(fields: &OutputFields) -> Result<Vec<u8>, Error> {
    let mut archive = NpzWriter::new();
    for (axis, along) in fields.coordinates.iter().enumerate() {
        archive.add_f64(&format!("x{}", axis + 1), &[along.len()], along)?;
    }
    archive.add_f64("time", &[], &[fields.time])?;
    if let Some(deformation) = &fields.deformation_gradient {
        archive.add_f64("deformation", &[2, 2], deformation.as_flattened())?;
    }
    let names: Vec<&str> = fields.quantities.iter().map(|own| own.name.as_str()).collect();
    let units: Vec<&str> = fields.quantities.iter().map(|own| own.unit).collect();
    archive.add_text("names", &[names.len()], &names)?;
    archive.add_text("units", &[units.len()], &units)?;
    // NPZ shapes list the slowest-varying axis first; in the fields the first axis varies fastest.
    let shape: Vec<usize> = fields.coordinates.iter().rev().map(Vec::len).collect();
    for own in &fields.quantities {
        archive.add_f64(&own.name, &shape, &own.values)?;
    }
    if !fields.plastic_dissipation.is_empty() {
        archive.add_f64("dissipation", &shape, &fields.plastic_dissipation)?;
    }
    if !fields.region_indices.is_empty() {
        let regions: Vec<i32> =
            fields.region_indices.iter().map(|&region| i32::from(region)).collect();
        archive.add_i32("region", &shape, &regions)?;
    }
    Ok(archive.finish()?)
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

/// Renders the NPZ archive of a table, with one array per column.
///
/// # Errors
/// The archive cannot be created.
pub(super) fn encode_table(table: &RecordTable) -> Result<Vec<u8>, Error> {
    let mut archive = NpzWriter::new();
    let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
    let units: Vec<&str> = table.columns.iter().map(|column| column.unit).collect();
    archive.add_text("names", &[names.len()], &names)?;
    archive.add_text("units", &[units.len()], &units)?;
    for column in &table.columns {
        archive.add_f64(&column.name, &[column.values.len()], &column.values)?;
    }
    Ok(archive.finish()?)
}
