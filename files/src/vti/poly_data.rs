//! Writer of VTK poly data whose cells are straight lines.

use std::io::{self, Write};
use std::path::Path;

use super::arrays::{CellArrays, FILE_END, format_array, format_time_element};
use super::attributes::check_time;
use super::encoding::{MEMORY_WRITE_MESSAGE, Storage};
use super::error::VtiError;
use super::number::VtkNumber;
use crate::{FileError, write_atomically_with};

/// Name of the array of points, by which [`read_plain_values`](super::read_plain_values) finds it.
pub const POINTS_ARRAY: &str = "Points";

/// Straight lines between two points each, as poly data (`.vtp`) under construction. Every line is a cell with two
/// points that it shares with no other line. The same arrays added in the same order give the same bytes.
///
/// ```
/// use wellposed_files::vti::{PolyData, Storage};
///
/// let mut data = PolyData::new(&[[[0.0, 0.0], [0.0, 0.5]], [[0.0, 0.5], [1.0, 0.5]]], Storage::Plain)?;
/// data.set_time(0.25)?;
/// data.add_array("slip [m]", &[0.0, 1e-6])?;
/// assert!(data.to_bytes().starts_with(b"<?xml"));
/// # Ok::<(), wellposed_files::vti::VtiError>(())
/// ```
pub struct PolyData {
    line_count: usize,
    /// Encoded coordinates of the points: start and end of each line.
    points: Vec<u8>,
    /// Encoded indices of the points of each line.
    connectivity: Vec<u8>,
    /// Encoded indices of the end of each line in `connectivity`.
    offsets: Vec<u8>,
    time: Option<f64>,
    arrays: CellArrays,
}

impl PolyData {
    /// Creates lines in the plane x₃ = 0 from the coordinates of their ends, in any unit of length, without arrays.
    ///
    /// # Errors
    /// A coordinate is not finite.
    pub fn new(lines: &[[[f64; 2]; 2]], storage: Storage) -> Result<Self, VtiError> {
        let coordinates = lines.as_flattened().as_flattened();
        if let Some(&found) = coordinates.iter().find(|coordinate| !coordinate.is_finite()) {
            return Err(VtiError::Point(found));
        }
        let arrays = CellArrays::new(storage);
        let points: Vec<f64> =
            lines.as_flattened().iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
        let count = lines.len() as i64;
        let connectivity: Vec<i64> = (0..2 * count).collect();
        let ends: Vec<i64> = (1..=count).map(|line| 2 * line).collect();
        Ok(Self {
            line_count: lines.len(),
            points: arrays.encode(&points),
            connectivity: arrays.encode(&connectivity),
            offsets: arrays.encode(&ends),
            time: None,
            arrays,
        })
    }

    /// Sets the time of all arrays, usually in s.
    ///
    /// # Errors
    /// The time is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), VtiError> {
        self.time = Some(check_time(time)?);
        Ok(())
    }

    /// Adds an array with one value per line.
    ///
    /// # Errors
    /// The name is invalid or used by another array, or the number of values is not that of the lines.
    pub fn add_array<T: VtkNumber>(&mut self, name: &str, values: &[T]) -> Result<(), VtiError> {
        if name == POINTS_ARRAY {
            return Err(VtiError::DuplicateName(name.to_owned()));
        }
        self.arrays.add(name, self.line_count, 1, values)
    }

    /// Formats the file as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_to(&mut bytes).expect(MEMORY_WRITE_MESSAGE);
        bytes
    }

    /// Writes the file atomically, without a second copy of the arrays.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_file(&self, path: &Path) -> Result<(), FileError> {
        write_atomically_with(path, |file| self.write_to(file))
    }

    /// Writes the bytes of the file, in a few large blocks.
    ///
    /// # Errors
    /// The writer fails.
    pub fn write_to(&self, writer: &mut impl Write) -> io::Result<()> {
        writer.write_all(self.format_header().as_bytes())?;
        self.arrays.write_values(writer)?;
        for bytes in [&self.points, &self.connectivity, &self.offsets] {
            writer.write_all(bytes)?;
        }
        writer.write_all(FILE_END)
    }

    /// File content before the appended values, up to the underscore from which their offsets are counted.
    fn format_header(&self) -> String {
        let (start, count) = (self.arrays.format_start("PolyData"), self.line_count);
        let (time, arrays) = (format_time_element(self.time), self.arrays.format_elements());
        let mut offset = self.arrays.byte_count();
        let points = format_array("Float64", POINTS_ARRAY, 3, offset);
        offset += self.points.len();
        let connectivity = format_array("Int64", "connectivity", 1, offset);
        offset += self.connectivity.len();
        let ends = format_array("Int64", "offsets", 1, offset);
        format!(
            "{start}  <PolyData>\n\
             {time}    \
                 <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"{count}\" \
                 NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n      \
                   <PointData>\n      </PointData>\n      \
                   <CellData>\n{arrays}      </CellData>\n      \
                   <Points>\n{points}      </Points>\n      \
                   <Lines>\n{connectivity}{ends}      </Lines>\n    \
                 </Piece>\n  \
               </PolyData>\n  \
               <AppendedData encoding=\"raw\">\n   _",
            2 * count
        )
    }
}
