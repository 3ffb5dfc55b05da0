//! Writer of VTK image data and structured grids.

use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

use super::arrays::{
    ArrayDeclaration, CellArrays, FILE_END, ROUNDING_ERROR_NAME, check_length,
    format_number_elements,
};
use super::attributes::check_time;
use super::encoding::{MEMORY_WRITE_MESSAGE, Storage};
use super::error::VtiError;
use super::grid::{ImageGrid, format_cell_extent, format_triple};
use super::number::VtkNumber;
use crate::{FileError, write_atomically_with};

/// Image data under construction. The same arrays added in the same order give the same bytes.
///
/// ```
/// use wellposed_files::vti::{ImageData, ImageGrid, Storage};
///
/// let grid = ImageGrid { cells: vec![2, 1], origin: vec![0.0; 2], spacing: vec![0.5; 2] };
/// let mut data = ImageData::new(grid, Storage::Plain)?;
/// data.set_time(0.25)?;
/// data.add_array("density [kg/m3]", 1, &[1500.0_f32, 1600.0])?;
/// data.add_vector("velocity [m/s]", &[&[1.0, 2.0], &[0.0, 0.0]])?;
/// assert!(data.to_bytes().starts_with(b"<?xml"));
/// # Ok::<(), wellposed_files::vti::VtiError>(())
/// ```
pub struct ImageData {
    pub(super) grid: ImageGrid,
    /// Cells of this piece along each axis; all cells of the grid unless it is one of several pieces.
    pub(super) cells: Vec<Range<usize>>,
    pub(super) cell_count: usize,
    /// Encoded node coordinates of a deformed grid.
    pub(super) nodes: Option<Vec<u8>>,
    pub(super) time: Option<f64>,
    rounding_error: Option<f64>,
    pub(super) arrays: CellArrays,
}

impl ImageData {
    /// Creates image data on a grid, without arrays.
    pub fn new(grid: ImageGrid, storage: Storage) -> Result<Self, VtiError> {
        let cells: Vec<Range<usize>> = grid.cells.iter().map(|count| 0..*count).collect();
        Self::new_piece(grid, &cells, storage)
    }

    /// Creates one of several pieces of image data, with the cells `cells` along each axis of the grid.
    pub fn new_piece(
        grid: ImageGrid,
        cells: &[Range<usize>],
        storage: Storage,
    ) -> Result<Self, VtiError> {
        grid.checked_cell_count()?;
        let is_inside = |(own, count): (&Range<usize>, &usize)| own.end <= *count;
        if cells.len() != grid.cells.len() || !cells.iter().zip(&grid.cells).all(is_inside) {
            return Err(VtiError::Size { cells: cells.iter().map(|own| own.end).collect() });
        }
        Ok(Self {
            grid,
            cell_count: cells.iter().map(ExactSizeIterator::len).product(),
            cells: cells.to_vec(),
            nodes: None,
            time: None,
            rounding_error: None,
            arrays: CellArrays::new(storage),
        })
    }

    /// Creates a structured grid: the nodes x of a plane grid are mapped to Fx by the deformation gradient F =
    /// `deformation_gradient`.
    pub fn with_deformation(
        grid: ImageGrid,
        deformation_gradient: [[f64; 2]; 2],
        storage: Storage,
    ) -> Result<Self, VtiError> {
        let axes = grid.cells.len();
        if axes != 2 || !deformation_gradient.as_flattened().iter().all(|entry| entry.is_finite()) {
            return Err(VtiError::Deformation { axes, found: deformation_gradient });
        }
        let map = |[x, y]: [f64; 2]| deformation_gradient.map(|row| row[0] * x + row[1] * y);
        Self::with_nodes(grid, map, storage)
    }

    /// Creates a structured grid: the nodes of a plane grid are mapped to positions by the function `map`, which must be
    /// finite.
    ///
    /// # Panics
    /// The grid does not have two axes.
    pub fn with_nodes(
        grid: ImageGrid,
        map: impl Fn([f64; 2]) -> [f64; 2],
        storage: Storage,
    ) -> Result<Self, VtiError> {
        let mut data = Self::new(grid, storage)?;
        data.map_nodes(map);
        Ok(data)
    }

    /// Makes the image data a structured grid with the nodes of [`with_nodes`](Self::with_nodes).
    ///
    /// # Panics
    /// The grid does not have two axes.
    pub fn map_nodes(&mut self, map: impl Fn([f64; 2]) -> [f64; 2]) {
        let along = |axis: usize, index: usize| {
            self.grid.origin[axis] + index as f64 * self.grid.spacing[axis]
        };
        let [columns, rows] =
            [0, 1].map(|axis: usize| self.cells[axis].start..self.cells[axis].end + 1);
        let node = |x: f64, y: f64| {
            let [a, b] = map([x, y]);
            [a, b, 0.0]
        };
        let nodes: Vec<f64> = rows
            .flat_map(|j| columns.clone().map(move |i| (i, j)))
            .flat_map(|(i, j)| node(along(0, i), along(1, j)))
            .collect();
        self.nodes = Some(self.arrays.encode(&nodes));
    }

    /// Sets the time of all arrays, usually in s.
    pub fn set_time(&mut self, time: f64) -> Result<(), VtiError> {
        self.time = Some(check_time(time)?);
        Ok(())
    }

    /// States the largest relative rounding error of the numbers of all arrays.
    pub fn set_rounding_error(&mut self, error: f64) {
        self.rounding_error = Some(error);
    }

    /// Adds a cell array with interleaved components, cells along the first axis fastest.
    pub fn add_array<T: VtkNumber>(
        &mut self,
        name: &str,
        components: usize,
        values: &[T],
    ) -> Result<(), VtiError> {
        self.arrays.add(name, self.cell_count, components, values)
    }

    /// Adds a cell array with the bytes of its values in little-endian order, with interleaved components.
    ///
    /// # Errors
    /// The bytes are not those of all cells.
    pub fn add_encoded_array(
        &mut self,
        array: &ArrayDeclaration,
        values: &[u8],
    ) -> Result<(), VtiError> {
        check_length(&array.name, values.len(), self.cell_count * array.cell_size())?;
        self.arrays.add_bytes(array, values);
        Ok(())
    }

    /// Adds a vector from one to three component fields, cells along the first axis fastest. The vector always has
    /// three components, as required by viewers; missing components are zero.
    pub fn add_vector<T: VtkNumber>(&mut self, name: &str, axes: &[&[T]]) -> Result<(), VtiError> {
        if !(1..=3).contains(&axes.len()) {
            return Err(VtiError::Components { name: name.to_owned(), found: axes.len() });
        }
        for values in axes {
            check_length(name, values.len(), self.cell_count)?;
        }
        let component = |cell: usize, axis: usize| match axes.get(axis) {
            Some(values) => values[cell],
            None => T::default(),
        };
        let vectors = (0..self.cell_count).map(|cell| [0, 1, 2].map(|axis| component(cell, axis)));
        let values: Vec<T> = vectors.flatten().collect();
        self.add_array(name, 3, &values)
    }

    /// Formats the file as bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.write_to(&mut bytes).expect(MEMORY_WRITE_MESSAGE);
        bytes
    }

    /// Writes the file atomically, without a second copy of the arrays.
    pub fn write_file(&self, path: &Path) -> Result<(), FileError> {
        write_atomically_with(path, |file| self.write_to(file))
    }

    /// Writes the bytes of the file, in a few large blocks.
    pub fn write_to(&self, writer: &mut impl Write) -> io::Result<()> {
        writer.write_all(self.format_header().as_bytes())?;
        self.arrays.write_values(writer)?;
        if let Some(nodes) = &self.nodes {
            writer.write_all(nodes)?;
        }
        writer.write_all(FILE_END)
    }

    /// File content before the appended values, up to the underscore from which their offsets are counted.
    pub(super) fn format_header(&self) -> String {
        let whole = self.grid.format_extent();
        let extent = format_cell_extent(&self.cells);
        let origin = format_triple(&self.grid.origin, 0.0);
        let spacing = format_triple(&self.grid.spacing, 1.0);
        let numbers = [("TimeValue", self.time), (ROUNDING_ERROR_NAME, self.rounding_error)];
        let (time, arrays) = (format_number_elements(&numbers), self.arrays.format_elements());
        let (kind, geometry, nodes) = match self.nodes {
            None => {
                ("ImageData", format!(" Origin=\"{origin}\" Spacing=\"{spacing}\""), String::new())
            }
            Some(_) => ("StructuredGrid", String::new(), self.format_node_element()),
        };
        let start = self.arrays.format_start(kind);
        format!(
            "{start}  <{kind} WholeExtent=\"{whole}\"{geometry}>\n\
             {time}    \
                 <Piece Extent=\"{extent}\">\n      \
                   <PointData>\n      </PointData>\n      \
                   <CellData>\n{arrays}      </CellData>\n{nodes}    \
                 </Piece>\n  \
               </{kind}>\n  \
               <AppendedData encoding=\"raw\">\n   _"
        )
    }

    /// XML element of the nodes of a deformed grid, whose values follow those of all arrays.
    fn format_node_element(&self) -> String {
        let offset = self.arrays.byte_count();
        format!(
            "      <Points>\n        <DataArray type=\"Float64\" NumberOfComponents=\"3\" \
             format=\"appended\" offset=\"{offset}\"/>\n      </Points>\n"
        )
    }
}
