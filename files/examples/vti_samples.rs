//! Writes image data with known values, which `files/checks/vti.py` verifies with VTK's own reader:
//!
//!     cargo run -p wellposed-files --example vti_samples -- FOLDER

use std::error::Error;
use std::path::{Path, PathBuf};

use wellposed_files::vti::{ImageData, ImageGrid, Storage, VtkNumber, format_collection};
use wellposed_files::write_atomically;

/// Deformation gradient from plane grids to structured grids.
const DEFORMATION_GRADIENT: [[f64; 2]; 2] = [[1.0, 0.5], [-0.25, 1.25]];

/// Indices of all cells along three axes, the first axis fastest.
fn cell_indices(cells: &[usize]) -> Vec<[usize; 3]> {
    let along = |axis| 0..cells.get(axis).copied().unwrap_or(1);
    let planes = along(2).flat_map(|k| along(1).map(move |j| (j, k)));
    planes.flat_map(|(j, k)| along(0).map(move |i| [i, j, k])).collect()
}

/// Value that identifies cell and component, exactly representable in 32 bits.
fn sample_value([i, j, k]: [usize; 3], component: usize) -> f64 {
    i as f64 - 100.0 * j as f64 + 10_000.0 * k as f64 + 0.125 * component as f64
}

fn add_arrays<T: VtkNumber>(data: &mut ImageData, places: &[[usize; 3]], real: fn(f64) -> T) {
    let component_values = |component: usize| -> Vec<T> {
        places.iter().map(|&place| real(sample_value(place, component))).collect()
    };
    let interleaved: Vec<T> = places
        .iter()
        .flat_map(|&place| (0..6).map(move |component| real(sample_value(place, component))))
        .collect();
    let cases = [
        data.add_array("scalar [Pa]", 1, &component_values(0)),
        data.add_vector("vector <σ & \"ε\"> [m/s]", &[&component_values(0), &component_values(1)]),
        data.add_array("six [1]", 6, &interleaved),
    ];
    cases.into_iter().collect::<Result<(), _>>().expect("arrays of the right length");
}

fn sample_image(
    cells: &[usize],
    storage: Storage,
    is_single_precision: bool,
    deformation: Option<[[f64; 2]; 2]>,
) -> Result<ImageData, Box<dyn Error>> {
    let origin = [-1.5, 0.25, 1e-7][..cells.len()].to_vec();
    let spacing = [0.1, 1.0 / 3.0, 2.5e-8][..cells.len()].to_vec();
    let grid = ImageGrid { cells: cells.to_vec(), origin, spacing };
    let mut data = match deformation {
        None => ImageData::new(grid, storage)?,
        Some(matrix) => ImageData::with_deformation(grid, matrix, storage)?,
    };
    let places = cell_indices(cells);
    data.set_time(0.1)?;
    if is_single_precision {
        add_arrays(&mut data, &places, |value| value as f32);
    } else {
        add_arrays(&mut data, &places, |value| value);
        let special_values = [f64::NAN, f64::INFINITY, -0.0, 5e-324, f64::MAX, 1.0 / 3.0];
        let special: Vec<f64> =
            (0..places.len()).map(|index| special_values[index % special_values.len()]).collect();
        data.add_array("odd", 1, &special)?;
        let numbers: Vec<i32> = (0..).take(places.len()).collect();
        data.add_array("number", 1, &numbers)?;
    }
    Ok(data)
}

fn write_samples(folder: &Path) -> Result<(), Box<dyn Error>> {
    let mut files = Vec::new();
    // Grids of a single cell, of exactly one block (2^18 bytes, i.e. 2^15 numbers of 64 bits), and others.
    let grids: [&[usize]; 7] =
        [&[1, 1], &[5, 3], &[256, 128], &[301, 211], &[1, 1, 1], &[5, 4, 3], &[61, 53, 47]];
    for cells in grids {
        let lengths: Vec<String> = cells.iter().map(usize::to_string).collect();
        for (storage, storage_name) in [(Storage::Plain, "plain"), (Storage::Compressed, "zlib")] {
            for (narrow, bits) in [(false, 64), (true, 32)] {
                let deformations = [("vti", None), ("vts", Some(DEFORMATION_GRADIENT))];
                let kind_count = if cells.len() == 2 { 2 } else { 1 };
                for (kind, deformation) in &deformations[..kind_count] {
                    let name = format!("{}_{storage_name}_{bits}.{kind}", lengths.join("x"));
                    sample_image(cells, storage, narrow, *deformation)?
                        .write_file(&folder.join(&name))?;
                    files.push((files.len() as f64 / 8.0, name));
                }
            }
        }
    }
    write_atomically(&folder.join("samples.pvd"), &format_collection(&files)?)?;
    Ok(())
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("usage: vti_samples FOLDER")?;
    write_samples(&PathBuf::from(folder))
}
