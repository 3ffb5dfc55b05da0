//! Snapshots as VTK image data for ParaView, and reading of their arrays.

use super::polar::reflect_components;
use crate::Error;
use crate::case::dynamics::{Precision, SnapshotOptions, SolidGrid};
use crate::case::{Case, TimeDomainRun};
use crate::study::simulate::{FieldQuantity, FieldSource, OutputFields, quantity_unit};
use files::SeekableWriter;
use files::vti::{
    ArrayDeclaration, ImageData, ImageGrid, PieceFile, Storage, VtkNumber, round_to_digits,
    rounding_error,
};
use std::ops::Range;
use std::path::Path;

/// Creates the ParaView image of the fields of one time; for flows on the deformed grid, for polar grids in Cartesian
/// coordinates, with Cartesian components of the velocity.
///
/// # Errors
/// The case has no simulation, or the fields do not match its grid.
pub fn create_image(case: &Case, fields: &OutputFields) -> Result<ImageData, Error> {
    let (cells, storage) = whole_image(case)?;
    let moment = (fields.time, fields.deformation_gradient);
    let mut image = create_empty_image(case, moment, &cells, storage)?;
    for array in list_arrays(case, fields, &cells) {
        image.add_encoded_array(&array.declaration, &array.encode())?;
    }
    Ok(image)
}

/// Returns the cells along each axis and the storage of the image of a whole grid.
///
/// # Errors
/// The case has no simulation.
pub fn whole_image(case: &Case) -> Result<(Vec<Range<usize>>, Storage), Error> {
    let cells = create_image_grid(case)?.cells.iter().map(|count| 0..*count).collect();
    Ok((cells, snapshot_storage(case)))
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

/// Array of an image, whose numbers are converted when they are written.
struct ImageArray<'a> {
    declaration: ArrayDeclaration,
    /// Number of cells.
    cell_count: usize,
    /// Number of significant digits to which numbers are rounded; `None` if they are not.
    digits: Option<usize>,
    /// Components at a cell; those beyond the number of components are not written.
    components: Box<dyn Fn(usize) -> [f64; 3] + 'a>,
}

impl<'a> ImageArray<'a> {
    /// Creates an array of numbers of the solver, rounded and narrowed as the options demand.
    fn new(
        options: &SnapshotOptions,
        (name, components): (String, usize),
        cell_count: usize,
        values: impl Fn(usize) -> [f64; 3] + 'a,
    ) -> Self {
        let vtk_type = match options.precision {
            Precision::F64 => f64::VTK_TYPE,
            Precision::F32 => f32::VTK_TYPE,
        };
        Self {
            declaration: ArrayDeclaration { name, vtk_type, components },
            cell_count,
            digits: options.digits,
            components: Box::new(values),
        }
    }

    /// Returns the bytes of all values with interleaved components.
    fn encode(&self) -> Vec<u8> {
        let ArrayDeclaration { vtk_type, components, .. } = self.declaration;
        let mut bytes = Vec::with_capacity(self.cell_count * self.declaration.cell_size());
        for cell in 0..self.cell_count {
            for &value in &(self.components)(cell)[..components] {
                let value = self.digits.map_or(value, |digits| round_to_digits(value, digits));
                match vtk_type {
                    f32::VTK_TYPE => (value as f32).append_bytes(&mut bytes),
                    i32::VTK_TYPE => (value as i32).append_bytes(&mut bytes),
                    _ => value.append_bytes(&mut bytes),
                }
            }
        }
        bytes
    }
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

/// Writes the image of the cells `cells` along each axis, whose fields are `fields`, a few layers of cells at a time.
/// Compressed values are collected in the folder `scratch_folder`.
///
/// # Errors
/// The case has no simulation, the fields do not match its grid or cannot be read, or the writer fails.
pub fn write_image(
    case: &Case,
    fields: &dyn FieldSource,
    (cells, storage): (&[Range<usize>], Storage),
    writer: &mut dyn SeekableWriter,
    scratch_folder: &Path,
) -> Result<(), Error> {
    let image = create_described_image(case, fields, cells, storage)?;
    let mut slabs = fields.slabs().peekable();
    let declarations = match slabs.peek() {
        Some(Ok(first)) => declare_arrays(case, first, cells),
        _ => Vec::new(),
    };
    image.write_in_pieces(&declarations, writer, scratch_folder, |pieces| {
        for slab in slabs {
            for (index, array) in list_arrays(case, &slab?, cells).iter().enumerate() {
                pieces.append(index, &array.encode())?;
            }
        }
        Ok(())
    })?;
    Ok(())
}

/// Formats the index of the pieces of an image, of which `fields` are the fields of one with the cells `cells`.
///
/// # Errors
/// As [`write_image`].
pub fn format_image_index(
    case: &Case,
    fields: &dyn FieldSource,
    cells: &[Range<usize>],
    pieces: &[PieceFile],
) -> Result<Vec<u8>, Error> {
    let mut image = create_described_image(case, fields, cells, Storage::Compressed)?;
    let first = fields.slabs().next().transpose()?.unwrap_or_default();
    image.declare_arrays(&declare_arrays(case, &first, cells));
    Ok(image.format_index(pieces))
}

/// Creates an image without arrays of the cells `cells`, whose fields are `fields`.
fn create_described_image(
    case: &Case,
    fields: &dyn FieldSource,
    cells: &[Range<usize>],
    storage: Storage,
) -> Result<ImageData, Error> {
    let OutputFields { time, deformation_gradient, .. } = fields.describe();
    create_empty_image(case, (time, deformation_gradient), cells, storage)
}

/// Returns names and types of the arrays of an image from the fields of some of its cells.
fn declare_arrays(
    case: &Case,
    fields: &OutputFields,
    cells: &[Range<usize>],
) -> Vec<ArrayDeclaration> {
    list_arrays(case, fields, cells).into_iter().map(|array| array.declaration).collect()
}

/// Lists the arrays of the image of the cells `cells` along each axis.
fn list_arrays<'a>(
    case: &'a Case,
    fields: &'a OutputFields,
    cells: &[Range<usize>],
) -> Vec<ImageArray<'a>> {
    let polar = case.solid_run.as_ref().map(|run| &run.grid).filter(|grid| grid.is_polar());
    let is_velocity = |own: &&FieldQuantity| {
        own.name.strip_prefix('v').is_some_and(|axis| ["1", "2", "3"].contains(&axis))
    };
    let options = &snapshot_options(case);
    let is_shown = |own: &&FieldQuantity| options.contains(&own.name);
    let of_velocity = fields.quantities.iter().filter(is_velocity).filter(is_shown);
    let axes: Vec<&[f64]> = of_velocity.map(|own| own.values.as_slice()).collect();
    let cell_count = axes.first().map_or(0, |values| values.len());
    let head = || ("velocity [m/s]".to_owned(), 3);
    let mut arrays = Vec::new();
    match (polar, axes.as_slice()) {
        (Some(grid), &[along_angle, along_radius]) => {
            let columns = cells[0].clone();
            arrays.push(ImageArray::new(options, head(), cell_count, move |cell| {
                // The angle depends on the first coordinate alone.
                let column = columns.start + cell % columns.len();
                let [x, y] =
                    reflect_components(grid, column, [along_angle[cell], along_radius[cell]]);
                [x, y, 0.0]
            }));
        }
        (_, []) => {}
        _ => arrays.push(ImageArray::new(options, head(), cell_count, move |cell| {
            [0, 1, 2].map(|axis| axes.get(axis).map_or(0.0, |own| own[cell]))
        })),
    }
    let scalar = |name: String, values: &'a [f64]| {
        ImageArray::new(options, (name, 1), values.len(), move |cell| [values[cell], 0.0, 0.0])
    };
    for own in fields.quantities.iter().filter(|own| !is_velocity(own)).filter(is_shown) {
        arrays.push(scalar(format!("{} [{}]", own.name, own.unit), &own.values));
    }
    if !fields.plastic_dissipation.is_empty() && options.contains("dissipation") {
        arrays.push(scalar("dissipation [J/m3]".to_owned(), &fields.plastic_dissipation));
    }
    let regions = &fields.region_indices;
    if !regions.is_empty() {
        let name = "region".to_owned();
        arrays.push(ImageArray {
            declaration: ArrayDeclaration { name, vtk_type: i32::VTK_TYPE, components: 1 },
            cell_count: regions.len(),
            digits: None,
            components: Box::new(|cell| [f64::from(regions[cell]), 0.0, 0.0]),
        });
    }
    arrays
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
