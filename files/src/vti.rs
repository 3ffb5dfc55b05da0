//! Fields on regular grids in VTK's XML format for image data (`.vti`), or on such grids after a
//! deformation for structured grids (`.vts`), which ParaView and VisIt open, and collections that give
//! each of several files its time (`.pvd`).
//!
//! Values belong to cells. They are appended as raw little-endian bytes, so that they keep every
//! bit and a reader finds its way by offsets; compression is optional. The format has no place
//! for units that viewers show: put them into the array's name, as in `sigma11 [Pa]`.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::csv::shortest;
use crate::{FileError, write_atomically_with};

/// What cannot be written as image data, or as a collection of it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VtiError {
    /// The grid has neither two nor three axes, or its parts disagree on their number.
    #[error(
        "image data has 2 or 3 axes: found {cells} numbers of cells, {origin} coordinates of the \
         origin and {spacing} spacings"
    )]
    Axes {
        /// Numbers of cells given.
        cells: usize,
        /// Coordinates of the origin given.
        origin: usize,
        /// Spacings given.
        spacing: usize,
    },
    /// An axis without cells, or more cells than the format or the machine can count.
    #[error("image data cannot have {cells:?} cells along its axes")]
    Size {
        /// Cells along each axis.
        cells: Vec<usize>,
    },
    /// A coordinate of the origin is not finite.
    #[error("the origin of image data cannot lie at {0}")]
    Origin(f64),
    /// A spacing is not a positive, finite number.
    #[error("the spacing of image data cannot be {0}")]
    Spacing(f64),
    /// A deformation is not finite, or not one of a plane grid.
    #[error("image data of {axes} axes cannot be deformed by {found:?}")]
    Deformation {
        /// Axes of the grid.
        axes: usize,
        /// The deformation given.
        found: [[f64; 2]; 2],
    },
    /// A time is not finite.
    #[error("the time of image data cannot be {0}")]
    Time(f64),
    /// A name that is empty or has characters that XML does not allow.
    #[error("image data cannot hold the name {0:?}")]
    Name(String),
    /// A second array of the same name.
    #[error("image data already has an array \"{0}\"")]
    Taken(String),
    /// A number of components that is not possible: none at all, or a vector with more than three.
    #[error("array \"{name}\" of image data cannot have {found} components")]
    Components {
        /// Name of the array.
        name: String,
        /// Components asked for.
        found: usize,
    },
    /// The number of values is not what the grid and the components ask for.
    #[error("array \"{name}\" of image data has {found} values where {expected} are needed")]
    Length {
        /// Name of the array.
        name: String,
        /// Number of values given.
        found: usize,
        /// Number of values that fills the grid.
        expected: usize,
    },
}

/// A regular grid with axes along x, y and, if there are three, z.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Cells along each of the two or three axes.
    pub cells: Vec<usize>,
    /// Corner of the first cell, where all coordinates are smallest; a unit of length of the
    /// caller's choice.
    pub origin: Vec<f64>,
    /// Length of a cell along each axis, in the same unit.
    pub spacing: Vec<f64>,
}

impl Grid {
    /// The number of cells of a grid that can be written.
    fn count(&self) -> Result<usize, VtiError> {
        let axes = self.cells.len();
        if !(2..=3).contains(&axes) || self.origin.len() != axes || self.spacing.len() != axes {
            let (origin, spacing) = (self.origin.len(), self.spacing.len());
            return Err(VtiError::Axes { cells: axes, origin, spacing });
        }
        if let Some(&origin) = self.origin.iter().find(|origin| !origin.is_finite()) {
            return Err(VtiError::Origin(origin));
        }
        let fits = |spacing: &f64| spacing.is_finite() && *spacing > 0.0;
        if let Some(&spacing) = self.spacing.iter().find(|&spacing| !fits(spacing)) {
            return Err(VtiError::Spacing(spacing));
        }
        // Extents are signed integers of 32 bits.
        let counts = |&cells: &usize| cells > 0 && i32::try_from(cells).is_ok();
        let product = |product: usize, &cells: &usize| product.checked_mul(cells);
        let count = self.cells.iter().try_fold(1, product);
        count
            .filter(|_| self.cells.iter().all(counts))
            .ok_or_else(|| VtiError::Size { cells: self.cells.clone() })
    }

    /// First and last node along each of three axes. A plane grid has a single node along z, which
    /// makes its cells flat.
    fn extent(&self) -> String {
        let last = |axis| self.cells.get(axis).copied().unwrap_or(0);
        format!("0 {} 0 {} 0 {}", last(0), last(1), last(2))
    }
}

/// Three numbers, those that are missing replaced.
fn triple(numbers: &[f64], missing: f64) -> String {
    let texts = (0..3).map(|axis| shortest(numbers.get(axis).copied().unwrap_or(missing)));
    texts.collect::<Vec<_>>().join(" ")
}

mod private {
    pub trait Sealed {}
}

/// A kind of number that image data can hold: `f64`, `f32` or `i32`.
pub trait Number: private::Sealed + Copy + Default {
    /// The kind's name in the format.
    const KIND: &'static str;
    /// Adds the number's bytes, the least significant first.
    fn put(self, bytes: &mut Vec<u8>);
}

macro_rules! number {
    ($($kind:ty, $name:literal;)*) => {$(
        impl private::Sealed for $kind {}
        impl Number for $kind {
            const KIND: &'static str = $name;
            fn put(self, bytes: &mut Vec<u8>) {
                bytes.extend(self.to_le_bytes());
            }
        }
    )*};
}

number! {
    f64, "Float64";
    f32, "Float32";
    i32, "Int32";
}

/// How the values lie in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// As they are in memory.
    Plain,
    /// Compressed without loss (zlib), in blocks.
    Compressed,
}

struct Array {
    name: String,
    kind: &'static str,
    components: usize,
    /// The values with their lengths in front, as they stand in the file.
    bytes: Vec<u8>,
}

/// Image data under construction. The same arrays added in the same order give the same bytes.
///
/// ```
/// use wellposed_files::vti::{Grid, ImageData, Storage};
///
/// let grid = Grid { cells: vec![2, 1], origin: vec![0.0; 2], spacing: vec![0.5; 2] };
/// let mut data = ImageData::new(grid, Storage::Plain)?;
/// data.set_time(0.25)?;
/// data.add("density [kg/m3]", 1, &[1500.0_f32, 1600.0])?;
/// data.add_vector("velocity [m/s]", &[&[1.0, 2.0], &[0.0, 0.0]])?;
/// assert!(data.bytes().starts_with(b"<?xml"));
/// # Ok::<(), wellposed_files::vti::VtiError>(())
/// ```
pub struct ImageData {
    grid: Grid,
    count: usize,
    /// The nodes of a grid that is deformed, as they stand in the file.
    nodes: Option<Vec<u8>>,
    storage: Storage,
    time: Option<f64>,
    arrays: Vec<Array>,
}

impl ImageData {
    /// Image data on a grid, without arrays.
    pub fn new(grid: Grid, storage: Storage) -> Result<Self, VtiError> {
        let count = grid.count()?;
        Ok(Self { grid, count, nodes: None, storage, time: None, arrays: Vec::new() })
    }

    /// A structured grid: the nodes x of a plane grid are where a matrix F takes them, at Fx.
    pub fn deformed(grid: Grid, matrix: [[f64; 2]; 2], storage: Storage) -> Result<Self, VtiError> {
        let mut data = Self::new(grid, storage)?;
        let axes = data.grid.cells.len();
        if axes != 2 || !matrix.as_flattened().iter().all(|entry| entry.is_finite()) {
            return Err(VtiError::Deformation { axes, found: matrix });
        }
        let along = |axis: usize, index: usize| {
            data.grid.origin[axis] + index as f64 * data.grid.spacing[axis]
        };
        let [columns, rows] = [0, 1].map(|axis| data.grid.cells[axis] + 1);
        let node = |x: f64, y: f64| {
            let [a, b] = matrix.map(|row| row[0] * x + row[1] * y);
            [a, b, 0.0]
        };
        let nodes: Vec<f64> = (0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .flat_map(|(i, j)| node(along(0, i), along(1, j)))
            .collect();
        data.nodes = Some(data.packed(&nodes));
        Ok(data)
    }

    /// Says at what time, in seconds as a rule, the arrays hold.
    pub fn set_time(&mut self, time: f64) -> Result<(), VtiError> {
        self.time = Some(finite(time)?);
        Ok(())
    }

    /// Adds an array with a number of components per cell: the components of a cell stand next to
    /// each other, and the cells follow with the first axis fastest.
    pub fn add<T: Number>(
        &mut self,
        name: &str,
        components: usize,
        values: &[T],
    ) -> Result<(), VtiError> {
        self.admit(name)?;
        if components == 0 {
            return Err(VtiError::Components { name: name.to_owned(), found: components });
        }
        check_length(name, values.len(), self.count.saturating_mul(components))?;
        let bytes = self.packed(values);
        self.arrays.push(Array { name: name.to_owned(), kind: T::KIND, components, bytes });
        Ok(())
    }

    /// Values as they stand in the file.
    fn packed<T: Number>(&self, values: &[T]) -> Vec<u8> {
        match self.storage {
            Storage::Plain => plain(values),
            Storage::Compressed => compressed(values),
        }
    }

    /// Adds a vector from one to three fields, one for each axis and each with the first axis
    /// fastest. The vector has three components in any case, because viewers ask for that; those
    /// that are not given are zero.
    pub fn add_vector<T: Number>(&mut self, name: &str, axes: &[&[T]]) -> Result<(), VtiError> {
        if !(1..=3).contains(&axes.len()) {
            return Err(VtiError::Components { name: name.to_owned(), found: axes.len() });
        }
        for values in axes {
            check_length(name, values.len(), self.count)?;
        }
        let component = |cell: usize, axis: usize| match axes.get(axis) {
            Some(values) => values[cell],
            None => T::default(),
        };
        let vectors = (0..self.count).map(|cell| [0, 1, 2].map(|axis| component(cell, axis)));
        let values: Vec<T> = vectors.flatten().collect();
        self.add(name, 3, &values)
    }

    /// The file's bytes.
    pub fn bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_to(&mut bytes).expect(IN_MEMORY);
        bytes
    }

    /// Writes the file whole or not at all, without a second copy of the arrays.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        write_atomically_with(path, |file| self.write_to(file))
    }

    /// Writes the file's bytes, in few large pieces.
    pub fn write_to(&self, writer: &mut impl Write) -> io::Result<()> {
        writer.write_all(self.head().as_bytes())?;
        let arrays = self.arrays.iter().map(|array| &array.bytes);
        for bytes in arrays.chain(&self.nodes) {
            writer.write_all(bytes)?;
        }
        writer.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    }

    /// Checks that an array may have a name.
    fn admit(&self, name: &str) -> Result<(), VtiError> {
        attribute(name)?;
        if self.arrays.iter().any(|array| array.name == name) {
            return Err(VtiError::Taken(name.to_owned()));
        }
        Ok(())
    }

    /// Everything in front of the appended values, up to the underscore where their offsets start.
    fn head(&self) -> String {
        let compressor = match self.storage {
            Storage::Plain => "",
            Storage::Compressed => " compressor=\"vtkZLibDataCompressor\"",
        };
        let extent = self.grid.extent();
        let origin = triple(&self.grid.origin, 0.0);
        let spacing = triple(&self.grid.spacing, 1.0);
        let (time, arrays) = (self.time_element(), self.array_elements());
        let (kind, place, nodes) = match self.nodes {
            None => {
                ("ImageData", format!(" Origin=\"{origin}\" Spacing=\"{spacing}\""), String::new())
            }
            Some(_) => ("StructuredGrid", String::new(), self.node_element()),
        };
        format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\"{compressor}>\n  \
               <{kind} WholeExtent=\"{extent}\"{place}>\n\
             {time}    \
                 <Piece Extent=\"{extent}\">\n      \
                   <PointData>\n      </PointData>\n      \
                   <CellData>\n{arrays}      </CellData>\n{nodes}    \
                 </Piece>\n  \
               </{kind}>\n  \
               <AppendedData encoding=\"raw\">\n   _"
        )
    }

    /// Where the nodes of a deformed grid start: behind all arrays.
    fn node_element(&self) -> String {
        let offset: usize = self.arrays.iter().map(|array| array.bytes.len()).sum();
        format!(
            "      <Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" \
             format=\"appended\" offset=\"{offset}\"/>\n      </Points>\n"
        )
    }

    /// The time, under the name by which VTK's readers know it.
    fn time_element(&self) -> String {
        self.time.map_or_else(String::new, |time| {
            let time = shortest(time);
            format!(
                "    <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" \
                 NumberOfTuples=\"1\" format=\"ascii\">{time}</DataArray>\n    </FieldData>\n"
            )
        })
    }

    /// What the arrays are and where they start.
    fn array_elements(&self) -> String {
        let mut elements = String::new();
        let mut offset = 0;
        for Array { name, kind, components, bytes } in &self.arrays {
            let name = escaped(name);
            elements.push_str(&format!(
                "        <DataArray type=\"{kind}\" Name=\"{name}\" \
                 NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n"
            ));
            offset += bytes.len();
        }
        elements
    }
}

/// The values of an array of doubles in a file that was written by [`ImageData`] with
/// [`Storage::Plain`]; `None` if it is another file, damaged, or has no such array.
pub fn plain_values(bytes: &[u8], name: &str) -> Option<Vec<f64>> {
    const END: &[u8] = b"<AppendedData encoding=\"raw\">\n   _";
    let end = bytes.windows(END.len()).position(|window| window == END)?;
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    if head.contains(" compressor=") {
        return None;
    }
    let named = format!(" type=\"Float64\" Name=\"{}\" ", escaped(name));
    let element = head.lines().find(|line| line.contains(&named) && line.contains(" offset="))?;
    let offset = element.split(" offset=\"").nth(1)?.split('"').next()?.parse::<usize>().ok()?;
    let values = bytes.get(end + END.len()..)?.get(offset..)?;
    let (length, values) = values.split_first_chunk()?;
    let length = usize::try_from(u64::from_le_bytes(*length)).ok()?;
    let (numbers, []) = values.get(..length)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// The time of a file that was written by [`ImageData`]; `None` if it is another file or has none.
pub fn plain_time(bytes: &[u8]) -> Option<f64> {
    const NAME: &[u8] = b" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">";
    let start = bytes.windows(NAME.len()).position(|window| window == NAME)? + NAME.len();
    let text = bytes.get(start..)?.split(|byte| *byte == b'<').next()?;
    std::str::from_utf8(text).ok()?.parse().ok()
}

/// A collection (`.pvd`) of files, each with its time, in seconds as a rule, and its path relative
/// to the collection.
pub fn collection(entries: &[(f64, impl AsRef<str>)]) -> Result<Vec<u8>, VtiError> {
    let mut text = String::from(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  \
           <Collection>\n",
    );
    for (time, file) in entries {
        let (time, file) = (shortest(finite(*time)?), attribute(file.as_ref())?);
        text.push_str(&format!(
            "    <DataSet timestep=\"{time}\" group=\"\" part=\"0\" file=\"{file}\"/>\n"
        ));
    }
    text.push_str("  </Collection>\n</VTKFile>\n");
    Ok(text.into_bytes())
}

/// The paths in a collection that was written by [`collection`].
pub fn collected(text: &str) -> Vec<String> {
    let paths = text.lines().filter_map(|line| line.split_once(" file=\"")?.1.split('"').next());
    let unescaped = |path: &str| {
        let path = path.replace("&quot;", "\"").replace("&lt;", "<").replace("&gt;", ">");
        path.replace("&amp;", "&")
    };
    paths.map(unescaped).collect()
}

fn finite(time: f64) -> Result<f64, VtiError> {
    if time.is_finite() { Ok(time) } else { Err(VtiError::Time(time)) }
}

fn check_length(name: &str, found: usize, expected: usize) -> Result<(), VtiError> {
    if found == expected {
        return Ok(());
    }
    Err(VtiError::Length { name: name.to_owned(), found, expected })
}

/// A name as the value of an attribute.
fn attribute(name: &str) -> Result<String, VtiError> {
    let foreign = |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    if name.is_empty() || name.contains(foreign) {
        return Err(VtiError::Name(name.to_owned()));
    }
    Ok(escaped(name))
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;")
}

const IN_MEMORY: &str = "writing into memory";

/// Values behind their length in bytes.
fn plain<T: Number>(values: &[T]) -> Vec<u8> {
    let length = size_of_val(values);
    let mut bytes = Vec::with_capacity(8 + length);
    bytes.extend((length as u64).to_le_bytes());
    values.iter().for_each(|value| value.put(&mut bytes));
    bytes
}

/// Length of a block before compression, in bytes: several of the compressor's windows of 32 KiB.
const BLOCK: usize = 1 << 18;

/// Values in compressed blocks, behind the number of blocks, the length of a block, the length of
/// the last block if that is shorter (zero if it is not) and the compressed length of each.
fn compressed<T: Number>(values: &[T]) -> Vec<u8> {
    let mut lengths = Vec::new();
    let mut blocks = Vec::new();
    let mut bytes = Vec::with_capacity(BLOCK);
    for block in values.chunks(BLOCK / size_of::<T>()) {
        bytes.clear();
        block.iter().for_each(|value| value.put(&mut bytes));
        let start = blocks.len();
        let mut encoder = ZlibEncoder::new(blocks, Compression::default());
        encoder.write_all(&bytes).expect(IN_MEMORY);
        blocks = encoder.finish().expect(IN_MEMORY);
        lengths.push(blocks.len() - start);
    }
    let head = [lengths.len(), BLOCK, size_of_val(values) % BLOCK];
    let numbers = head.into_iter().chain(lengths);
    let mut all: Vec<u8> = numbers.flat_map(|number| (number as u64).to_le_bytes()).collect();
    all.extend(blocks);
    all
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

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

    /// The text in front of the values, and the values.
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
            // What is cut off is not made up.
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
        // 4 × 3 nodes of three coordinates; the second is a cell along the first axis from the first.
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
}
