//! Snapshots of a run of a solid as a Zarr store, for xarray.

use super::CommandError;
use super::folder::{
    OutputError, Publication, SNAPSHOT_LIST_FILE, ZARR_STORE_FILE, snapshot_file_name,
};
use crate::case::Case;
use crate::case::dynamics::SolidRun;
use crate::report::format::case_title;
use dynamics::simulation::RegularTimes;
use files::read_regular_file;
use files::vti::{ArrayDeclaration, list_arrays, parse_collection, read_array_bytes};
use files::zarr::{ZarrArray, ZarrNumber, ZarrWriter};
use serde_json::{Map, Value, json};
use std::io;
use std::path::Path;

/// Indices and times, s, of the snapshots of a run in a folder.
///
/// # Errors
/// The list of snapshots cannot be read.
pub(super) fn list_snapshots(
    folder: &Path,
    solid_run: &SolidRun,
) -> Result<Vec<(usize, f64)>, OutputError> {
    let interval = solid_run.output.snapshot_interval;
    if interval == 0.0 {
        return Ok(Vec::new());
    }
    let path = folder.join(SNAPSHOT_LIST_FILE);
    let list =
        read_regular_file(&path).map_err(|error| OutputError::from_read_error(&path, &error))?;
    let count = parse_collection(&String::from_utf8_lossy(&list)).len();
    let times = RegularTimes::new(interval, solid_run.time.duration);
    Ok((0..count).filter_map(|index| Some((index, times.time(index)?))).collect())
}

/// Stages the Zarr store of all snapshots, in chunks of at most `chunk_edge` cells along each axis. The values of one array
/// of one snapshot are in memory beside the file of the snapshot.
///
/// # Errors
/// The run has no snapshots, one of them is damaged, or the store cannot be written.
pub(super) fn stage_zarr_store(
    publication: &mut Publication,
    (folder, case, solid_run): (&Path, &Case, &SolidRun),
    chunk_edge: usize,
) -> Result<(), CommandError> {
    let moments = list_snapshots(folder, solid_run)?;
    if moments.is_empty() {
        return Err(OutputError {
            path: folder.to_owned(),
            cause: "has no snapshots for a Zarr store".to_owned(),
            remedy: "set output.snapshot_interval in the case",
        }
        .into());
    }
    let layout =
        StoreLayout { solid_run, times: moments.iter().map(|own| own.1).collect(), chunk_edge };
    publication.stage_with(ZARR_STORE_FILE, |file| {
        let mut store = ZarrWriter::new(file);
        layout.write_coordinates(&mut store)?;
        for (place, (index, _)) in moments.iter().enumerate() {
            let path = folder.join(snapshot_file_name(case, *index));
            let odd =
                || io::Error::other(OutputError::from_invalid_content(&path, "not a snapshot"));
            let bytes = read_regular_file(&path)?;
            for array in list_arrays(&bytes).ok_or_else(odd)? {
                let values = read_array_bytes(&bytes, &array).ok_or_else(odd)?;
                layout.write_snapshot_array(&mut store, place, &array, &values)?;
            }
        }
        let attributes = json!({ "title": case_title(case), "source": "wellposed" });
        store.finish(attributes.as_object().cloned().unwrap_or_default())
    })?;
    Ok(())
}

/// Dimensions and chunks of the arrays of a store.
struct StoreLayout<'a> {
    solid_run: &'a SolidRun,
    /// Times of the snapshots, s.
    times: Vec<f64>,
    chunk_edge: usize,
}

impl StoreLayout<'_> {
    /// Writes the times of the snapshots and the centres of the cells.
    fn write_coordinates<W: io::Write>(&self, store: &mut ZarrWriter<W>) -> io::Result<()> {
        let grid = &self.solid_run.grid;
        let mut write = |name: &str, unit: &str, values: &[f64]| {
            let array = ZarrArray {
                name: name.to_owned(),
                number: ZarrNumber::F64,
                dimensions: vec![(name.to_owned(), values.len())],
                chunk_shape: vec![values.len()],
                attributes: Map::from_iter([("units".to_owned(), json!(unit))]),
            };
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            store.write_part(&array, &[], &bytes)
        };
        write("time", "s", &self.times)?;
        for axis in 0..grid.dimensions() {
            let centres: Vec<f64> =
                (0..grid.cells[axis]).map(|index| grid.cell_centre(axis, index)).collect();
            let unit = if grid.is_polar() && axis == 0 { "degree" } else { "m" };
            write(&format!("x{}", axis + 1), unit, &centres)?;
        }
        Ok(())
    }

    /// Writes the values of an array of a snapshot, each component of a vector as an array of its own.
    fn write_snapshot_array<W: io::Write>(
        &self,
        store: &mut ZarrWriter<W>,
        place: usize,
        declaration: &ArrayDeclaration,
        values: &[u8],
    ) -> io::Result<()> {
        let grid = &self.solid_run.grid;
        let number = match declaration.vtk_type {
            "Float64" => ZarrNumber::F64,
            "Float32" => ZarrNumber::F32,
            _ => ZarrNumber::I32,
        };
        let (name, unit) = declaration
            .name
            .strip_suffix(']')
            .and_then(|own| own.split_once(" ["))
            .unwrap_or((&declaration.name, "1"));
        // Vectors have three components in files for ParaView; those on polar grids are Cartesian there.
        let names: Vec<String> = match (name, grid.is_polar()) {
            ("velocity", true) => vec!["vx".to_owned(), "vy".to_owned()],
            ("velocity", false) => (1..=grid.dimensions()).map(|axis| format!("v{axis}")).collect(),
            _ => vec![name.to_owned()],
        };
        let mut dimensions = vec![("time".to_owned(), self.times.len())];
        let mut chunk_shape = vec![1];
        for axis in (0..grid.dimensions()).rev() {
            dimensions.push((format!("x{}", axis + 1), grid.cells[axis]));
            chunk_shape.push(grid.cells[axis].min(self.chunk_edge));
        }
        let size = number.size();
        for (component, name) in names.into_iter().enumerate() {
            let array = ZarrArray {
                name,
                number,
                dimensions: dimensions.clone(),
                chunk_shape: chunk_shape.clone(),
                attributes: self.attributes(unit, number),
            };
            let cells = values.chunks_exact(declaration.components * size);
            let own = cells.flat_map(|cell| &cell[size * component..size * (component + 1)]);
            let mut own: Vec<u8> = own.copied().collect();
            if let Some(share) = self.negligible_share() {
                match number {
                    ZarrNumber::F64 => {
                        clear_negligible(&mut own, share, f64::from_le_bytes);
                    }
                    ZarrNumber::F32 => {
                        clear_negligible(&mut own, share, |bytes| f32::from_le_bytes(bytes).into());
                    }
                    ZarrNumber::I32 => {}
                }
            }
            store.write_part(&array, &[place], &own)?;
        }
        Ok(())
    }

    /// Share of the largest magnitude of a snapshot below which values are written as zero: with rounding to digits, two
    /// decades below the last digit of the largest value. Before a front the solver leaves numbers of any size, which
    /// would take as much space as the waves. `None` without rounding.
    fn negligible_share(&self) -> Option<f64> {
        let digits = self.solid_run.output.snapshot_options.digits?;
        Some(10_f64.powi(-(digits as i32) - 2)) // at most 15 digits
    }

    fn attributes(&self, unit: &str, number: ZarrNumber) -> Map<String, Value> {
        let mut attributes = Map::from_iter([("units".to_owned(), json!(unit))]);
        let digits = self.solid_run.output.snapshot_options.digits;
        if let Some((digits, share)) =
            digits.zip(self.negligible_share()).filter(|_| number != ZarrNumber::I32)
        {
            attributes.insert("significant_digits".to_owned(), json!(digits));
            attributes.insert("zero_below_share_of_largest".to_owned(), json!(share));
        }
        attributes
    }
}

/// Sets numbers to zero whose magnitude is below a share of the largest one.
fn clear_negligible<const N: usize>(bytes: &mut [u8], share: f64, value: impl Fn([u8; N]) -> f64) {
    let (numbers, _) = bytes.as_chunks_mut::<N>();
    let magnitudes = numbers.iter().map(|own| value(*own).abs());
    let limit = share * magnitudes.filter(|own| own.is_finite()).fold(0.0, f64::max);
    numbers.iter_mut().filter(|own| value(**own).abs() < limit).for_each(|own| *own = [0; N]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small numbers become zero; the others, and those that are no numbers, keep their bits.
    #[test]
    fn negligible_numbers_become_zero() {
        let numbers = [1.0, -1e-5, 2e-7, -3e-7, f64::NAN, 0.0];
        let mut bytes: Vec<u8> = numbers.iter().flat_map(|own: &f64| own.to_le_bytes()).collect();
        clear_negligible(&mut bytes, 1e-6, f64::from_le_bytes);
        let (found, _) = bytes.as_chunks::<8>();
        let found: Vec<u64> = found.iter().map(|own| u64::from_le_bytes(*own)).collect();
        let expected = [1.0, -1e-5, 0.0, 0.0, f64::NAN, 0.0];
        assert_eq!(found, expected.map(f64::to_bits));
    }
}
