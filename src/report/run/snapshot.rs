//! Snapshots as VTK image data for ParaView, and reading of their arrays.

use crate::Error;
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::OutputFields;
use files::vti::{ImageData, ImageGrid, Storage};

/// Creates the ParaView image of the fields of one time; for flows on the deformed grid.
///
/// # Errors
/// The case has no simulation, or the fields do not match its grid.
pub fn create_image(case: &Case, fields: &OutputFields) -> Result<ImageData, Error> {
    let grid = match case.time_domain_run()? {
        TimeDomainRun::Solid(solid_run) => {
            let own = &solid_run.grid;
            ImageGrid {
                cells: own.cells.clone(),
                origin: own.origin.clone(),
                spacing: own.spacing.clone(),
            }
        }
        TimeDomainRun::Flow(run) => ImageGrid {
            cells: run.grid.points.to_vec(),
            origin: vec![0.0; 2],
            spacing: [0, 1]
                .map(|axis| run.grid.lengths[axis] / run.grid.points[axis] as f64)
                .to_vec(),
        },
    };
    let mut image = match fields.deformation_gradient {
        Some(deformation) => ImageData::with_deformation(grid, deformation, Storage::Plain)?,
        None => ImageData::new(grid, Storage::Plain)?,
    };
    image.set_time(fields.time)?;
    let of_velocity = fields.quantities.iter().filter(|own| own.name.starts_with('v'));
    let axes: Vec<&[f64]> = of_velocity.map(|own| own.values.as_slice()).collect();
    image.add_vector("velocity [m/s]", &axes)?;
    for own in fields.quantities.iter().filter(|own| !own.name.starts_with('v')) {
        image.add_array(&format!("{} [{}]", own.name, own.unit), 1, &own.values)?;
    }
    if !fields.plastic_dissipation.is_empty() {
        image.add_array("dissipation [J/m3]", 1, &fields.plastic_dissipation)?;
    }
    if !fields.region_indices.is_empty() {
        let regions: Vec<i32> =
            fields.region_indices.iter().map(|&region| i32::from(region)).collect();
        image.add_array("region", 1, &regions)?;
    }
    Ok(image)
}

/// Reads the named array of a snapshot; an error message if it is absent or has fewer than `cells` values.
pub(super) fn read_array(bytes: &[u8], name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match files::vti::read_plain_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}
