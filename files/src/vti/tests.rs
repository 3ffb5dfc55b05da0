//! Tests of image data and collections.

use std::io::Read;

use super::collection::{collected, collection};
use super::encoding::{BLOCK, Storage, compressed, plain};
use super::error::VtiError;
use super::grid::Grid;
use super::image_data::ImageData;
use super::reader::{plain_time, plain_values};

fn plane() -> Grid {
    Grid { cells: vec![3, 2], origin: vec![-1.0, 0.5], spacing: vec![0.25, 1e-7] }
}

fn sample(storage: Storage) -> ImageData {
    let mut data = ImageData::new(plane(), storage).unwrap();
    data.set_time(0.125).unwrap();
    data.add("a<b & \"c\" [Pa]", 1, &[1.0, -0.0, f64::NAN, 4.0, 5.0, 6.0]).unwrap();
    data.add_vector("v [m/s]", &[&[1.0_f32; 6], &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]]).unwrap();
    data.add("region", 1, &[0, 1, 2, 3, 4, -5]).unwrap();
    data
}

/// Text before the appended values, and the appended values.
fn parts(bytes: &[u8]) -> (&str, &[u8]) {
    let mark = b"<AppendedData encoding=\"raw\">\n   _";
    let start = bytes.windows(mark.len()).position(|window| window == mark).unwrap();
    let start = start + mark.len();
    let tail = b"\n  </AppendedData>\n</VTKFile>\n";
    let values = bytes[start..].strip_suffix(tail).unwrap();
    (str::from_utf8(&bytes[..start]).unwrap(), values)
}

fn number(bytes: &[u8], index: usize) -> usize {
    u64::from_le_bytes(bytes[8 * index..][..8].try_into().unwrap()) as usize
}

#[test]
fn plain_values_are_read_back() {
    let grid = Grid { cells: vec![2, 3], origin: vec![0.0; 2], spacing: vec![0.5; 2] };
    let mut data = ImageData::new(grid, Storage::Plain).unwrap();
    data.add("first <&> [Pa]", 1, &[1.0, -2.0, f64::INFINITY, 4.0, 5.0, 1e-300]).unwrap();
    data.add_vector("second [m/s]", &[&[1.0; 6], &[2.0; 6]]).unwrap();
    let bytes = data.bytes();
    let first = [1.0, -2.0, f64::INFINITY, 4.0, 5.0, 1e-300];
    assert_eq!(plain_values(&bytes, "first <&> [Pa]").unwrap(), first);
    assert_eq!(plain_values(&bytes, "second [m/s]").unwrap()[..3], [1.0, 2.0, 0.0]);
    assert_eq!(plain_values(&bytes, "third"), None);
    for end in 0..bytes.len() - 60 {
        // Truncated files are not completed.
        let found = plain_values(&bytes[..end], "second [m/s]");
        assert!(found.is_none_or(|values| values.len() == 18), "{end}");
    }
    assert_eq!(plain_values(b"", "first"), None);
    assert_eq!(plain_time(&bytes), None);
    data.set_time(0.125).unwrap();
    assert_eq!(plain_time(&data.bytes()), Some(0.125));
}

#[test]
fn the_layout_of_a_plain_file() {
    let bytes = sample(Storage::Plain).bytes();
    let (head, values) = parts(&bytes);
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
    assert_eq!([number(values, 0), number(values, 7)], [48, 72]);
    assert_eq!(values[8..16], 1.0_f64.to_le_bytes());
    let second: Vec<u8> = [1.0_f32, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    assert_eq!(values[64 + 12..][..12], second);
}

#[test]
fn deformed_grids_have_nodes_of_their_own() {
    let matrix = [[1.0, 2.0], [0.5, 1.0]];
    let mut data = ImageData::deformed(plane(), matrix, Storage::Plain).unwrap();
    data.set_time(0.125).unwrap();
    data.add("first [Pa]", 1, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]).unwrap();
    let bytes = data.bytes();
    assert_eq!(plain_time(&bytes), Some(0.125));
    assert_eq!(plain_values(&bytes, "first [Pa]").unwrap(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let (head, values) = parts(&bytes);
    for expected in [
        "<VTKFile type=\"StructuredGrid\" ",
        "  <StructuredGrid WholeExtent=\"0 3 0 2 0 0\">\n",
        "<Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" \
         format=\"appended\" offset=\"56\"/>\n      </Points>",
    ] {
        assert!(head.contains(expected), "{expected} is missing in\n{head}");
    }
    // 4 × 3 nodes with three coordinates; the second node is one cell from the first along the first axis.
    assert_eq!(number(&values[56..], 0), 12 * 3 * 8);
    let nodes: Vec<f64> =
        values[64..].as_chunks().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect();
    assert_eq!(nodes[..6], [-1.0 + 1.0, -0.5 + 0.5, 0.0, -0.75 + 1.0, -0.375 + 0.5, 0.0]);
    assert_eq!(nodes.len(), 36);

    let solid = Grid { cells: vec![1; 3], origin: vec![0.0; 3], spacing: vec![1.0; 3] };
    let refused = |grid, found| ImageData::deformed(grid, found, Storage::Plain).err().unwrap();
    let expected = VtiError::Deformation { axes: 3, found: matrix };
    assert_eq!(refused(solid, matrix), expected);
    let odd = [[1.0, f64::INFINITY], [0.0, 1.0]];
    assert!(matches!(refused(plane(), odd), VtiError::Deformation { axes: 2, .. }));
}

#[test]
fn compressed_blocks_unpack_to_the_values() {
    let per_block = BLOCK / 8;
    for (count, blocks, last) in
        [(1, 1, 8), (per_block, 1, 0), (per_block + 1, 2, 8), (2 * per_block, 2, 0)]
    {
        let values: Vec<f64> = (0..count).map(|index| (index as f64).sqrt()).collect();
        let bytes = compressed(&values);
        assert_eq!([0, 1, 2].map(|i| number(&bytes, i)), [blocks, BLOCK, last]);
        let mut start = 8 * (3 + blocks);
        let mut unpacked = Vec::new();
        for block in 0..blocks {
            let length = number(&bytes, 3 + block);
            let mut decoder = flate2::read::ZlibDecoder::new(&bytes[start..][..length]);
            decoder.read_to_end(&mut unpacked).unwrap();
            start += length;
        }
        assert_eq!(start, bytes.len());
        assert_eq!(unpacked, plain(&values)[8..]);
    }
}

#[test]
fn equal_content_gives_equal_bytes() {
    for storage in [Storage::Plain, Storage::Compressed] {
        assert_eq!(sample(storage).bytes(), sample(storage).bytes());
    }
    let constant = |storage| {
        let grid = Grid { cells: vec![64; 2], ..plane() };
        let mut data = ImageData::new(grid, storage).unwrap();
        data.add("zero", 1, &[0.0; 64 * 64]).unwrap();
        data.bytes().len()
    };
    assert!(constant(Storage::Compressed) < constant(Storage::Plain) / 20);
}

#[test]
fn a_file_on_disk_has_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fields/0.vti");
    let data = sample(Storage::Compressed);
    data.write(&path).unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), data.bytes());
}

#[test]
fn grids_that_cannot_be_written() {
    let refused = |grid| ImageData::new(grid, Storage::Plain).err().unwrap();
    let grid = Grid { origin: vec![0.0; 3], ..plane() };
    assert_eq!(refused(grid), VtiError::Axes { cells: 2, origin: 3, spacing: 2 });
    let line = Grid { cells: vec![1], origin: vec![0.0], spacing: vec![1.0] };
    assert!(matches!(refused(line), VtiError::Axes { .. }));
    for cells in [vec![3, 0], vec![1 << 31, 1]] {
        let grid = Grid { cells: cells.clone(), ..plane() };
        assert_eq!(refused(grid), VtiError::Size { cells });
    }
    let cells = vec![i32::MAX as usize; 3];
    let grid = Grid { cells: cells.clone(), origin: vec![0.0; 3], spacing: vec![1.0; 3] };
    assert_eq!(refused(grid), VtiError::Size { cells });
    for length in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let grid = Grid { spacing: vec![1.0, length], ..plane() };
        assert!(matches!(refused(grid), VtiError::Spacing(_)), "{length}");
    }
    let grid = Grid { origin: vec![f64::NAN, 0.0], ..plane() };
    assert!(matches!(refused(grid), VtiError::Origin(_)));
}

#[test]
fn arrays_that_cannot_be_added() {
    let mut data = sample(Storage::Plain);
    let before = data.bytes();
    let length = |found, expected| VtiError::Length { name: "n".to_owned(), found, expected };
    assert_eq!(data.add("n", 1, &[0.0; 5]), Err(length(5, 6)));
    assert_eq!(data.add("n", 2, &[0.0; 6]), Err(length(6, 12)));
    assert_eq!(data.add("n", usize::MAX, &[0.0; 6]), Err(length(6, usize::MAX)));
    assert_eq!(data.add_vector("n", &[&[0.0; 6], &[0.0; 7]]), Err(length(7, 6)));
    let components = |found| VtiError::Components { name: "n".to_owned(), found };
    assert_eq!(data.add::<f64>("n", 0, &[]), Err(components(0)));
    assert_eq!(data.add_vector::<f64>("n", &[]), Err(components(0)));
    assert_eq!(data.add_vector("n", &[&[0.0; 6][..]; 4]), Err(components(4)));
    assert_eq!(data.add("region", 1, &[0.0; 6]), Err(VtiError::Taken("region".to_owned())));
    for name in ["", "line\nbreak", "\0"] {
        assert_eq!(data.add(name, 1, &[0.0; 6]), Err(VtiError::Name(name.to_owned())));
    }
    assert!(matches!(data.set_time(f64::NAN), Err(VtiError::Time(_))));
    assert_eq!(data.bytes(), before);
}

#[test]
fn a_collection_names_files_and_times() {
    let written = collection(&[(0.0, "a.vti"), (1e-9, "b & c.vti")]).unwrap();
    let text = String::from_utf8(written).unwrap();
    let first = "<DataSet timestep=\"0\" group=\"\" part=\"0\" file=\"a.vti\"/>";
    let second = "<DataSet timestep=\"1e-9\" group=\"\" part=\"0\" file=\"b &amp; c.vti\"/>";
    assert!(text.contains(first) && text.contains(second), "{text}");
    assert_eq!(collected(&text), ["a.vti", "b & c.vti"]);
    assert!(collection(&[] as &[(f64, &str)]).unwrap().ends_with(b"</VTKFile>\n"));
    assert_eq!(collection(&[(f64::INFINITY, "a")]), Err(VtiError::Time(f64::INFINITY)));
    assert_eq!(collection(&[(0.0, "")]), Err(VtiError::Name(String::new())));
}
