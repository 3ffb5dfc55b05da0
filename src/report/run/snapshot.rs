//! Snapshots as VTK image data for ParaView, and reading of their arrays.

use super::polar::reflect_components;
use crate::Error;
use crate::case::dynamics::SolidGrid;
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::{FieldQuantity, OutputFields, quantity_unit};
use files::vti::{ImageData, ImageGrid, Storage};
use std::ops::Range;

/// Creates the ParaView image of the fields of one time; for flows on the deformed grid, for polar grids in Cartesian
/// coordinates, with Cartesian components of the velocity.
///
/// # Errors
/// The case has no simulation, or the fields do not match its grid.
pub fn create_image(case: &Case, fields: &OutputFields) -> Result<ImageData, Error> {
    let grid = create_image_grid(case)?;
    let cells: Vec<Range<usize>> = grid.cells.iter().map(|count| 0..*count).collect();
    create_image_piece(case, fields, &cells, Storage::Plain)
}

/// Returns the grid of the ParaView images of a case.
fn create_image_grid(case: &Case) -> Result<ImageGrid, Error> {
    Ok(match case.time_domain_run()? {
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
    })
}

/// Creates an image without arrays of the cells `cells` along each axis, at a time, s.
///
/// # Errors
/// The case has no simulation, or the cells do not match its grid.
pub fn create_empty_image(
    case: &Case,
    (time, deformation_gradient): (f64, Option<[[f64; 2]; 2]>),
    cells: &[Range<usize>],
    storage: Storage,
) -> Result<ImageData, Error> {
    let grid = create_image_grid(case)?;
    let polar = case.solid_run.as_ref().map(|run| &run.grid).filter(|grid| grid.is_polar());
    let mut image = match deformation_gradient {
        Some(deformation) => ImageData::with_deformation(grid, deformation, storage)?,
        None => ImageData::new_piece(grid, cells, storage)?,
    };
    if polar.is_some() {
        image.map_nodes(SolidGrid::to_cartesian);
    }
    image.set_time(time)?;
    Ok(image)
}

/// Creates the image of a part of the cells as [`create_image`] does: `fields` are those of the cells `cells` along each
/// axis.
///
/// # Errors
/// As [`create_image`].
pub fn create_image_piece(
    case: &Case,
    fields: &OutputFields,
    cells: &[Range<usize>],
    storage: Storage,
) -> Result<ImageData, Error> {
    let moment = (fields.time, fields.deformation_gradient);
    let mut image = create_empty_image(case, moment, cells, storage)?;
    let polar = case.solid_run.as_ref().map(|run| &run.grid).filter(|grid| grid.is_polar());
    let is_velocity = |own: &&FieldQuantity| {
        own.name.strip_prefix('v').is_some_and(|axis| ["1", "2", "3"].contains(&axis))
    };
    let of_velocity = fields.quantities.iter().filter(is_velocity);
    let axes: Vec<&[f64]> = of_velocity.map(|own| own.values.as_slice()).collect();
    match (polar, axes.as_slice()) {
        (Some(grid), [along_angle, along_radius]) => {
            let [mut x, mut y] = [Vec::new(), Vec::new()];
            for (cell, (a, b)) in along_angle.iter().zip(*along_radius).enumerate() {
                // The angle depends on the first coordinate alone.
                let column = cells[0].start + cell % cells[0].len();
                let cartesian = reflect_components(grid, column, [*a, *b]);
                x.push(cartesian[0]);
                y.push(cartesian[1]);
            }
            image.add_vector("velocity [m/s]", &[&x, &y])?;
        }
        _ => image.add_vector("velocity [m/s]", &axes)?,
    }
    for own in fields.quantities.iter().filter(|own| !is_velocity(own)) {
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

/// Reads time, velocities, spin and stresses of a snapshot of a solid.
///
/// # Errors
/// A message if the bytes are not a snapshot of this case.
pub fn read_snapshot(case: &Case, bytes: &[u8]) -> Result<OutputFields, String> {
    const OPTIONAL_NAMES: [&str; 3] = ["sigma12", "sigma21", "w3"];
    let Some(run) = &case.solid_run else { return Err("no snapshot of a solid".to_owned()) };
    let (grid, cells) = (&run.grid, run.grid.cell_count());
    let time = files::vti::read_plain_time(bytes).ok_or("has no time")?;
    let velocity = read_array(bytes, "velocity [m/s]", 3 * cells)?;
    let mut quantities: Vec<FieldQuantity> = (0..grid.dimensions())
        .map(|axis| {
            let values = velocity.iter().skip(axis).step_by(3).copied().collect();
            FieldQuantity::new(format!("v{}", axis + 1), values)
        })
        .collect();
    let read = |name: &str| read_array(bytes, &format!("{name} [{}]", quantity_unit(name)), cells);
    quantities.push(FieldQuantity::new("sigma22".to_owned(), read("sigma22")?));
    for name in OPTIONAL_NAMES {
        quantities.extend(read(name).map(|values| FieldQuantity::new(name.to_owned(), values)));
    }
    let centres =
        |axis: usize| (0..grid.cells[axis]).map(|index| grid.cell_centre(axis, index)).collect();
    let coordinates = (0..grid.dimensions()).map(centres).collect();
    Ok(OutputFields { time, coordinates, quantities, ..OutputFields::default() })
}

/// Reads the named array of a snapshot; an error message if it is absent or has fewer than `cells` values.
pub(super) fn read_array(bytes: &[u8], name: &str, cells: usize) -> Result<Vec<f64>, String> {
    match files::vti::read_plain_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}
