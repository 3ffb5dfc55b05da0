//! Archive of the final fields, from the files of the parts.

use super::FieldParts;
use crate::case::dynamics::SolidGrid;
use crate::cli::CommandError;
use crate::report::run::create_field_arrays;
use crate::report::{ArrayData, DataArray};
use crate::study::simulate::{FieldQuantity, OutputFields};
use files::npz::NpzWriter;
use std::borrow::Cow;
use std::io::{Seek, Write};

/// Writes the archive `fields.npz`, with the values of one array at a time in memory.
///
/// # Errors
/// A file cannot be read or is damaged, or the archive cannot be written.
pub(in crate::cli) fn write_field_archive(
    parts: &FieldParts,
    grid: &SolidGrid,
    file: impl Write + Seek,
) -> Result<(), CommandError> {
    let cells = &grid.cells;
    let centres =
        |axis: usize| (0..cells[axis]).map(|index| grid.cell_centre(axis, index)).collect();
    let quantity = |name: &String| FieldQuantity::new(name.clone(), Vec::new());
    let placeholder = |is_present: bool| if is_present { 1 } else { 0 };
    let description = OutputFields {
        time: parts.time,
        coordinates: (0..cells.len()).map(centres).collect(),
        quantities: parts.names.iter().map(quantity).collect(),
        plastic_dissipation: vec![0.0; placeholder(parts.has_dissipation)],
        region_indices: vec![0; placeholder(parts.has_regions)],
        ..OutputFields::default()
    };
    let mut archive = NpzWriter::new(file);
    for array in create_field_arrays(Cow::Owned(description)) {
        let is_quantity = parts.names.iter().any(|name| *name == array.name);
        let values = match array.name.as_ref() {
            "region" => ArrayData::I32(parts.read_regions(cells)?),
            name if is_quantity || name == "dissipation" => {
                ArrayData::F64(parts.read_values(name, cells)?.into())
            }
            _ => array.values,
        };
        DataArray { values, ..array }.add_to(&mut archive)?;
    }
    archive.finish().map_err(crate::Error::from)?;
    Ok(())
}
