//! Tests of image data and collections.

use std::io::{Cursor, Read};

use super::arrays::ArrayDeclaration;
use super::collection::{format_collection, parse_collection};
use super::encoding::{BLOCK_LENGTH, Storage, encode_compressed, encode_plain};
use super::error::VtiError;
use super::grid::ImageGrid;
use super::image_data::ImageData;
use super::poly_data::{POINTS_ARRAY, PolyData};
use super::reader::{read_plain_time, read_plain_values};

fn plane_grid() -> ImageGrid {
    ImageGrid { cells: vec![3, 2], origin: vec![-1.0, 0.5], spacing: vec![0.25, 1e-7] }
}

fn sample_image(storage: Storage) -> ImageData {
    let mut data = ImageData::new(plane_grid(), storage).unwrap();
    data.set_time(0.125).unwrap();
    data.add_array("a<b & \"c\" [Pa]", 1, &[1.0, -0.0, f64::NAN, 4.0, 5.0, 6.0]).unwrap();
    data.add_vector("v [m/s]", &[&[1.0_f32; 6], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]]).unwrap();
    data.add_array("region", 1, &[0, 1, 2, 3, 4, -5]).unwrap();
    data
}

/// Text before the appended values, and the appended values.
fn split_header(bytes: &[u8]) -> (&str, &[u8]) {
    let mark = b"<AppendedData encoding=\"raw\">\n   _";
    let start = bytes.windows(mark.len()).position(|window| window == mark).unwrap();
    let start = start + mark.len();
    let tail = b"\n  </AppendedData>\n</VTKFile>\n";
    let values = bytes[start..].strip_suffix(tail).unwrap();
    (str::from_utf8(&bytes[..start]).unwrap(), values)
}

fn read_u64(bytes: &[u8], index: usize) -> usize {
    u64::from_le_bytes(bytes[8 * index..][..8].try_into().unwrap()) as usize
}

#[test]
fn plain_values_are_read_back() {
    let grid = ImageGrid { cells: vec![2, 3], origin: vec![0.0; 2], spacing: vec![0.5; 2] };
    let mut data = ImageData::new(grid, Storage::Plain).unwrap();
    data.add_array("first <&> [Pa]", 1, &[1.0, -2.0, f64::INFINITY, 4.0, 5.0, 1e-300]).unwrap();
    data.add_vector("second [m/s]", &[&[1.0; 6], &[2.0; 6]]).unwrap();
    let bytes = data.to_bytes();
    let first = [1.0, -2.0, f64::INFINITY, 4.0, 5.0, 1e-300];
    assert_eq!(read_plain_values(&bytes, "first <&> [Pa]").unwrap(), first);
    assert_eq!(read_plain_values(&bytes, "second [m/s]").unwrap()[..3], [1.0, 2.0, 0.0]);
    assert_eq!(read_plain_values(&bytes, "third"), None);
    for end in 0..bytes.len() - 60 {
        // A truncated file gives either all values of the array or none.
        let found = read_plain_values(&bytes[..end], "second [m/s]");
        assert!(found.is_none_or(|values| values.len() == 18), "{end}");
    }
    assert_eq!(read_plain_values(b"", "first"), None);
    assert_eq!(read_plain_time(&bytes), None);
    data.set_time(0.125).unwrap();
    assert_eq!(read_plain_time(&data.to_bytes()), Some(0.125));
}

#[test]
fn plain_file_has_expected_layout() {
    let bytes = sample_image(Storage::Plain).to_bytes();
    let (head, values) = split_header(&bytes);
    for expected in [
        "header_type=\"UInt64\">",
        "WholeExtent=\"0 3 0 2 0 0\" Origin=\"-1 0.5 0\" Spacing=\"0.25 1e-7 1\"",
        "Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">0.125<",
        "type=\"Float64\" Name=\"a&lt;b &amp; &quot;c&quot; [Pa]\" NumberOfComponents=\"1\" \
         format=\"appended\" offset=\"0\"",
        "type=\"Float32\" Name=\"v [m/s]\" NumberOfComponents=\"3\" format=\"appended\" \
         offset=\"56\"",
        "type=\"Int32\" Name=\"region\" NumberOfComponents=\"1\" format=\"appended\" \
         offset=\"136\"",
    ] {
        assert!(head.contains(expected), "{expected} is missing in\n{head}");
    }
    assert_eq!(values.len(), 8 + 48 + 8 + 72 + 8 + 24);
    assert_eq!([read_u64(values, 0), read_u64(values, 7)], [48, 72]);
    assert_eq!(values[8..16], 1.0_f64.to_le_bytes());
    let second: Vec<u8> = [1.0_f32, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(values[64 + 12..][..12], second);
}

#[test]
fn deformed_grid_is_written_with_its_nodes() {
    let matrix = [[1.0, 2.0], [0.5, 1.0]];
    let mut data = ImageData::with_deformation(plane_grid(), matrix, Storage::Plain).unwrap();
    data.set_time(0.125).unwrap();
    data.add_array("first [Pa]", 1, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let bytes = data.to_bytes();
    assert_eq!(read_plain_time(&bytes), Some(0.125));
    assert_eq!(read_plain_values(&bytes, "first [Pa]").unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let (head, values) = split_header(&bytes);
    for expected in [
        "<VTKFile type=\"StructuredGrid\" ",
        "  <StructuredGrid WholeExtent=\"0 3 0 2 0 0\">\n",
        "<Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"appended\" offset=\"56\"/>\n      </Points>",
    ] {
        assert!(head.contains(expected), "{expected} is missing in\n{head}");
    }
    // 4 × 3 nodes with three coordinates; the second node is one cell from the first along the first axis.
    assert_eq!(read_u64(&values[56..], 0), 12 * 3 * 8);
    let nodes: Vec<f64> =
        values[64..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    assert_eq!(nodes[..6], [-1.0 + 1.0, -0.5 + 0.5, 0.0, -0.75 + 1.0, -0.375 + 0.5, 0.0]);
    assert_eq!(nodes.len(), 36);

    let solid = ImageGrid { cells: vec![1; 3], origin: vec![0.0; 3], spacing: vec![1.0; 3] };
    let refused =
        |grid, found| ImageData::with_deformation(grid, found, Storage::Plain).err().unwrap();
    let expected = VtiError::Deformation { axes: 3, found: matrix };
    assert_eq!(refused(solid, matrix), expected);
    let odd = [[1.0, f64::INFINITY], [0.0, 1.0]];
    assert!(matches!(refused(plane_grid(), odd), VtiError::Deformation { axes: 2, .. }));
}

#[test]
fn compressed_blocks_unpack_to_the_values() {
    let per_block = BLOCK_LENGTH / 8;
    for (count, blocks, last) in
        [(1, 1, 8), (per_block, 1, 0), (per_block + 1, 2, 8), (2 * per_block, 2, 0)]
    {
        let values: Vec<f64> = (0..count).map(|index| (index as f64).sqrt()).collect();
        let bytes = encode_compressed(&values);
        assert_eq!([0, 1, 2].map(|i| read_u64(&bytes, i)), [blocks, BLOCK_LENGTH, last]);
        let mut start = 8 * (3 + blocks);
        let mut unpacked = Vec::new();
        for block in 0..blocks {
            let length = read_u64(&bytes, 3 + block);
            let mut decoder = flate2::read::ZlibDecoder::new(&bytes[start..][..length]);
            decoder.read_to_end(&mut unpacked).unwrap();
            start += length;
        }
        assert_eq!(start, bytes.len());
        assert_eq!(unpacked, encode_plain(&values)[8..]);
    }
}

#[test]
fn equal_content_gives_equal_bytes() {
    for storage in [Storage::Plain, Storage::Compressed] {
        assert_eq!(sample_image(storage).to_bytes(), sample_image(storage).to_bytes());
    }
    let constant = |storage| {
        let grid = ImageGrid { cells: vec![64; 2], ..plane_grid() };
        let mut data = ImageData::new(grid, storage).unwrap();
        data.add_array("zero", 1, &[0.0; 64 * 64]).unwrap();
        data.to_bytes().len()
    };
    assert!(constant(Storage::Compressed) < constant(Storage::Plain) / 20);
}

#[test]
fn a_file_on_disk_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fields/0.vti");
    let data = sample_image(Storage::Compressed);
    data.write_file(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), data.to_bytes());
}

#[test]
fn arrays_appended_in_pieces_give_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let count = 300 * 1000;
    let arrays = [("a [Pa]", "Float64", 1), ("v [m/s]", "Float32", 3), ("b", "Float32", 1)];
    let arrays = arrays.map(|(name, vtk_type, components)| ArrayDeclaration {
        name: name.to_owned(),
        vtk_type,
        components,
    });
    let values: Vec<Vec<u8>> = arrays
        .iter()
        .map(|array| {
            // Pseudorandom bytes cannot be compressed: the compressed values are too large to be kept in memory.
            let random = |i: u64| (i.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) as u8;
            (0..(count * array.cell_size()) as u64).map(random).collect()
        })
        .collect();
    let image = |storage| {
        let grid = ImageGrid { cells: vec![300, 1000], ..plane_grid() };
        let mut image = ImageData::new(grid, storage).unwrap();
        image.map_nodes(|[x, y]| [x + y, y]);
        image
    };
    for storage in [Storage::Plain, Storage::Compressed] {
        let mut whole = image(storage);
        for (array, values) in arrays.iter().zip(&values) {
            whole.add_encoded_array(array, values).unwrap();
        }
        let write = |layers: usize| {
            let mut file = Cursor::new(Vec::new());
            let written =
                image(storage).write_in_pieces(&arrays, &mut file, folder.path(), |pieces| {
                    for layer in (0..layers).step_by(7) {
                        let cells = 300 * layer..300 * (layer + 7).min(layers);
                        for (index, array) in arrays.iter().enumerate() {
                            let size = array.cell_size();
                            let bytes = cells.start * size..cells.end * size;
                            pieces.append(index, &values[index][bytes])?;
                        }
                    }
                    Ok(())
                });
            written.map(|()| file.into_inner())
        };
        assert!(write(1000).unwrap() == whole.to_bytes());
        // An array that lacks values is no file.
        assert!(write(999).is_err());
    }
}

#[test]
fn invalid_grids_are_refused() {
    let refused = |grid| ImageData::new(grid, Storage::Plain).err().unwrap();
    let grid = ImageGrid { origin: vec![0.0; 3], ..plane_grid() };
    assert_eq!(refused(grid), VtiError::Axes { cells: 2, origin: 3, spacing: 2 });
    let line = ImageGrid { cells: vec![1], origin: vec![0.0], spacing: vec![1.0] };
    assert!(matches!(refused(line), VtiError::Axes { .. }));
    for cells in [vec![3, 0], vec![1 << 31, 1]] {
        let grid = ImageGrid { cells: cells.clone(), ..plane_grid() };
        assert_eq!(refused(grid), VtiError::Size { cells });
    }
    let cells = vec![i32::MAX as usize; 3];
    let grid = ImageGrid { cells: cells.clone(), origin: vec![0.0; 3], spacing: vec![1.0; 3] };
    assert_eq!(refused(grid), VtiError::Size { cells });
    for length in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let grid = ImageGrid { spacing: vec![1.0, length], ..plane_grid() };
        assert!(matches!(refused(grid), VtiError::Spacing(_)), "{length}");
    }
    let grid = ImageGrid { origin: vec![f64::NAN, 0.0], ..plane_grid() };
    assert!(matches!(refused(grid), VtiError::Origin(_)));
}

#[test]
fn invalid_arrays_are_refused() {
    let mut data = sample_image(Storage::Plain);
    let before = data.to_bytes();
    let length = |found, expected| VtiError::Length { name: "n".to_owned(), found, expected };
    assert_eq!(data.add_array("n", 1, &[0.0; 5]), Err(length(5, 6)));
    assert_eq!(data.add_array("n", 2, &[0.0; 6]), Err(length(6, 12)));
    assert_eq!(data.add_array("n", usize::MAX, &[0.0; 6]), Err(length(6, usize::MAX)));
    assert_eq!(data.add_vector("n", &[&[0.0; 6], &[0.0; 7]]), Err(length(7, 6)));
    let components = |found| VtiError::Components { name: "n".to_owned(), found };
    assert_eq!(data.add_array::<f64>("n", 0, &[]), Err(components(0)));
    assert_eq!(data.add_vector::<f64>("n", &[]), Err(components(0)));
    assert_eq!(data.add_vector("n", &[&[0.0; 6][..]; 4]), Err(components(4)));
    assert_eq!(
        data.add_array("region", 1, &[0.0; 6]),
        Err(VtiError::DuplicateName("region".to_owned()))
    );
    for name in ["", "line\nbreak", "\0"] {
        assert_eq!(data.add_array(name, 1, &[0.0; 6]), Err(VtiError::Name(name.to_owned())));
    }
    assert!(matches!(data.set_time(f64::NAN), Err(VtiError::Time(_))));
    assert_eq!(data.to_bytes(), before);
}

#[test]
fn a_collection_names_files_and_times() {
    let written = format_collection(&[(0.0, "a.vti"), (1e-9, "b & c.vti")]).unwrap();
    let text = String::from_utf8(written).unwrap();
    let first = "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"a.vti\"/>";
    let second = "<DataSet timestep=\"1e-9\" group=\"\" part=\"0\" file=\"b &amp; c.vti\"/>";
    assert!(text.contains(first) && text.contains(second), "{text}");
    assert_eq!(parse_collection(&text), ["a.vti", "b & c.vti"]);
    assert!(format_collection(&[] as &[(f64, &str)]).unwrap().ends_with(b"</VTKFile>\n"));
    assert_eq!(format_collection(&[(f64::INFINITY, "a")]), Err(VtiError::Time(f64::INFINITY)));
    assert_eq!(format_collection(&[(0.0, "")]), Err(VtiError::Name(String::new())));
}

/// Verifies layout and values of lines: points, connectivity, offsets and arrays are parsed back from both storages.
#[test]
fn lines_are_read_back() {
    let lines = [[[0.0, -0.5], [0.0, 0.5]], [[0.0, 0.5], [1.0, 0.5]], [[1.0, 0.5], [1.0, 2.0]]];
    let slip = [0.0, 1e-6, f64::NAN];
    let data = |storage| {
        let mut data = PolyData::new(&lines, storage).unwrap();
        data.set_time(0.125).unwrap();
        data.add_array("slip <1> [m]", &slip).unwrap();
        data.add_array("joint", &[0, 1, -2]).unwrap();
        data
    };
    let bytes = data(Storage::Plain).to_bytes();
    let found = read_plain_values(&bytes, "slip <1> [m]").unwrap();
    assert!(found.iter().map(|value| value.to_bits()).eq(slip.map(f64::to_bits)));
    let points = read_plain_values(&bytes, POINTS_ARRAY).unwrap();
    assert_eq!(points[..6], [0.0, -0.5, 0.0, 0.0, 0.5, 0.0]);
    assert_eq!(points.len(), 18);
    assert_eq!(read_plain_time(&bytes), Some(0.125));
    let (head, values) = split_header(&bytes);
    for expected in [
        "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <PolyData>\n",
        "<Piece NumberOfPoints=\"6\" NumberOfVerts=\"0\" NumberOfLines=\"3\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">",
        "type=\"Int32\" Name=\"joint\" NumberOfComponents=\"1\" format=\"appended\" offset=\"32\"",
        "<Points>\n        <DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"appended\" offset=\"52\"/>",
        "<Lines>\n        <DataArray type=\"Int64\" Name=\"connectivity\" NumberOfComponents=\"1\" format=\"appended\" offset=\"204\"/>",
        "Name=\"offsets\" NumberOfComponents=\"1\" format=\"appended\" offset=\"260\"/>",
    ] {
        assert!(head.contains(expected), "{expected} is missing in\n{head}");
    }
    let integers = |start: usize| -> Vec<i64> {
        let count = read_u64(&values[start..], 0) / 8;
        let numbers = values[start + 8..].as_chunks().0.iter().take(count);
        numbers.map(|bytes| i64::from_le_bytes(*bytes)).collect()
    };
    assert_eq!(integers(204), [0, 1, 2, 3, 4, 5]);
    assert_eq!(integers(260), [2, 4, 6]);
    assert_eq!(values.len(), 260 + 8 + 24);

    let compressed = data(Storage::Compressed).to_bytes();
    let (head, values) = split_header(&compressed);
    assert!(head.contains("compressor=\"vtkZLibDataCompressor\""));
    // One block with its compressed length, then the block itself.
    let length = read_u64(values, 3);
    let mut decoded = Vec::new();
    flate2::read::ZlibDecoder::new(&values[32..32 + length]).read_to_end(&mut decoded).unwrap();
    assert_eq!(decoded, slip.map(f64::to_le_bytes).as_flattened());
}

#[test]
fn invalid_lines_are_refused() {
    let odd = [[[0.0, f64::INFINITY], [0.0, 0.5]]];
    assert_eq!(PolyData::new(&odd, Storage::Plain).err(), Some(VtiError::Point(f64::INFINITY)));
    let mut data = PolyData::new(&[[[0.0; 2], [1.0; 2]]], Storage::Plain).unwrap();
    let length = VtiError::Length { name: "a".to_owned(), found: 2, expected: 1 };
    assert_eq!(data.add_array("a", &[1.0, 2.0]), Err(length));
    data.add_array("a", &[1.0]).unwrap();
    for name in ["a", POINTS_ARRAY] {
        let duplicate = VtiError::DuplicateName(name.to_owned());
        assert_eq!(data.add_array(name, &[1.0]), Err(duplicate));
    }
    assert!(data.set_time(f64::NAN).is_err() && data.add_array("", &[1.0]).is_err());
    // Without lines the file is valid and empty.
    let empty = PolyData::new(&[], Storage::Plain).unwrap().to_bytes();
    assert_eq!(read_plain_values(&empty, POINTS_ARRAY), Some(Vec::new()));
}
