//! Snapshots for ParaView.

use crate::Error;
use crate::case::{Case, InTime};
use crate::study::simulate::Fields;
use files::vti::{Grid, ImageData, Storage};

/// Creates the ParaView image of the fields of one time; for flows on the deformed grid.
///
/// # Errors
/// The case has no simulation, or the fields do not match its grid.
pub fn image(case: &Case, fields: &Fields) -> Result<ImageData, Error> {
    let grid = match case.in_time()? {
        InTime::Solid(dynamics) => {
            let own = &dynamics.grid;
            Grid {
                cells: own.cells.clone(),
                origin: own.origin.clone(),
                spacing: own.spacing.clone(),
            }
        }
        InTime::Flow(run) => Grid {
            cells: run.grid.cells.to_vec(),
            origin: vec![0.0; 2],
            spacing: [0, 1]
                .map(|axis| run.grid.lengths[axis] / run.grid.cells[axis] as f64)
                .to_vec(),
        },
    };
    let mut image = match fields.deformation {
        Some(deformation) => ImageData::deformed(grid, deformation, Storage::Plain)?,
        None => ImageData::new(grid, Storage::Plain)?,
    };
    image.set_time(fields.time)?;
    let of_velocity = fields.quantities.iter().filter(|own| own.name.starts_with('v'));
    let axes: Vec<&[f64]> = of_velocity.map(|own| own.values.as_slice()).collect();
    image.add_vector("velocity [m/s]", &axes)?;
    for own in fields.quantities.iter().filter(|own| !own.name.starts_with('v')) {
        image.add(&format!("{} [{}]", own.name, own.unit), 1, &own.values)?;
    }
    if !fields.dissipation.is_empty() {
        image.add("dissipation [J/m3]", 1, &fields.dissipation)?;
    }
    if !fields.regions.is_empty() {
        let regions: Vec<i32> = fields.regions.iter().map(|&region| i32::from(region)).collect();
        image.add("region", 1, &regions)?;
    }
    Ok(image)
}

/// Reads the named array of a snapshot, of at least `cells` values; an error message if it is absent or shorter.
pub(super) fn array(bytes: &[u8], name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match files::vti::plain_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}
