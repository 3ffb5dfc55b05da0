//! Snapshots as VTK image data for ParaView, and reading of their arrays.

use super::polar::reflect_components;
use crate::Error;
use crate::case::dynamics::{Precision, SnapshotOptions, SolidGrid};
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::{FieldQuantity, OutputFields, quantity_unit};
use files::vti::{ImageData, ImageGrid, Storage, round_to_digits, rounding_error};
use std::ops::Range;

/// Creates the ParaView image of the fields of one time; for flows on the deformed grid, for polar grids in Cartesian
/// coordinates, with Cartesian components of the velocity.
///
/// # Errors
/// The case has no simulation, or the fields do not match its grid.
pub fn create_image(case: &Case, fields: &OutputFields) -> Result<ImageData, Error> {
    let grid = create_image_grid(case)?;
    let cells: Vec<Range<usize>> = grid.cells.iter().map(|count| 0..*count).collect();
    create_image_piece(case, fields, &cells, snapshot_storage(case))
}

/// Returns the storage of the snapshots of a whole grid: compressed if their numbers are shortened.
pub fn snapshot_storage(case: &Case) -> Storage {
    match snapshot_options(case) {
        SnapshotOptions { precision: Precision::F64, digits: None, .. } => Storage::Plain,
        _ => Storage::Compressed,
    }
}

fn snapshot_options(case: &Case) -> SnapshotOptions {
    case.solid_run.as_ref().map(|run| run.output.snapshot_options.clone()).unwrap_or_default()
}

/// Returns the largest relative error of the numbers in snapshots of a solid; `None` if they are those of the solver.
fn find_rounding_error(case: &Case) -> Option<f64> {
    let run = case.solid_run.as_ref()?;
    let SnapshotOptions { precision, digits, .. } = run.output.snapshot_options;
    let narrows = precision == Precision::F32 && run.scheme.precision == Precision::F64;
    let narrowing = if narrows { 0.5 * f64::from(f32::EPSILON) } else { 0.0 };
    let error = digits.map_or(0.0, rounding_error) + narrowing;
    (error > 0.0).then_some(error)
}

/// Adds an array with interleaved components, rounded and narrowed as the options demand.
fn add_array(
    image: &mut ImageData,
    options: &SnapshotOptions,
    (name, components): (&str, usize),
    values: &[f64],
) -> Result<(), Error> {
    let round = |value: &f64| options.digits.map_or(*value, |own| round_to_digits(*value, own));
    match (options.precision, options.digits) {
        (Precision::F64, None) => image.add_array(name, components, values)?,
        (Precision::F64, Some(_)) => {
            image.add_array(name, components, &values.iter().map(round).collect::<Vec<f64>>())?;
        }
        (Precision::F32, _) => {
            let narrow = values.iter().map(|value| round(value) as f32);
            image.add_array(name, components, &narrow.collect::<Vec<f32>>())?;
        }
    }
    Ok(())
}

/// Interleaves the components of a vector; missing ones are zero.
fn interleave(axes: &[&[f64]]) -> Vec<f64> {
    let cells = axes.first().map_or(0, |values| values.len());
    let component = |cell: usize, axis: usize| axes.get(axis).map_or(0.0, |own| own[cell]);
    (0..cells).flat_map(|cell| [0, 1, 2].map(|axis| component(cell, axis))).collect()
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
    if let Some(error) = find_rounding_error(case) {
        image.set_rounding_error(error);
    }
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
    let options = &snapshot_options(case);
    let is_shown = |own: &&FieldQuantity| options.contains(&own.name);
    let of_velocity = fields.quantities.iter().filter(is_velocity).filter(is_shown);
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
            add_array(&mut image, options, ("velocity [m/s]", 3), &interleave(&[&x, &y]))?;
        }
        (_, []) => {}
        _ => add_array(&mut image, options, ("velocity [m/s]", 3), &interleave(&axes))?,
    }
    for own in fields.quantities.iter().filter(|own| !is_velocity(own)).filter(is_shown) {
        let name = format!("{} [{}]", own.name, own.unit);
        add_array(&mut image, options, (&name, 1), &own.values)?;
    }
    if !fields.plastic_dissipation.is_empty() && options.contains("dissipation") {
        let name = ("dissipation [J/m3]", 1);
        add_array(&mut image, options, name, &fields.plastic_dissipation)?;
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
    match files::vti::read_values(bytes, name) {
        None => Err(format!("no array {name}")),
        Some(all) if all.len() < cells => Err(format!("too few values of {name}")),
        Some(all) => Ok(all),
    }
}
