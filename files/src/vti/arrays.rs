//! Cell arrays of a VTK file, and the XML elements common to all kinds of files.

use std::io::{self, Write};

use super::attributes::{escape_xml, format_attribute};
use super::encoding::{
    Storage, encode_compressed, encode_compressed_bytes, encode_plain, encode_plain_bytes,
};
use super::error::VtiError;
use super::number::VtkNumber;
use crate::csv::format_shortest;

/// Array with its encoded values.
struct CellArray {
    name: String,
    vtk_type: &'static str,
    components: usize,
    /// Encoded values, preceded by their length or block lengths; empty if they are only declared.
    bytes: Vec<u8>,
    /// Length of the encoded values, bytes.
    length: usize,
}

/// Name, number type and number of components of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ArrayDeclaration {
    /// Name of the array.
    pub name: String,
    /// Name of the number type in VTK XML.
    pub vtk_type: &'static str,
    /// Number of components per cell.
    pub components: usize,
}

impl ArrayDeclaration {
    /// Returns the size of the values of a cell, bytes.
    pub fn cell_size(&self) -> usize {
        self.components * if self.vtk_type.ends_with("64") { 8 } else { 4 }
    }
}

/// Cell arrays, whose values are appended in order.
pub(super) struct CellArrays {
    storage: Storage,
    arrays: Vec<CellArray>,
}

impl CellArrays {
    pub(super) fn new(storage: Storage) -> Self {
        Self { storage, arrays: Vec::new() }
    }

    /// Adds an array of `cells` cells with interleaved components.
    pub(super) fn add<T: VtkNumber>(
        &mut self,
        name: &str,
        cells: usize,
        components: usize,
        values: &[T],
    ) -> Result<(), VtiError> {
        format_attribute(name)?;
        if self.arrays.iter().any(|array| array.name == name) {
            return Err(VtiError::DuplicateName(name.to_owned()));
        }
        if components == 0 {
            return Err(VtiError::Components { name: name.to_owned(), found: components });
        }
        check_length(name, values.len(), cells.saturating_mul(components))?;
        let bytes = self.encode(values);
        self.arrays.push(CellArray {
            name: name.to_owned(),
            vtk_type: T::VTK_TYPE,
            components,
            length: bytes.len(),
            bytes,
        });
        Ok(())
    }

    /// Adds an array of `cells` cells whose uncompressed values are written later.
    pub(super) fn declare(&mut self, array: &ArrayDeclaration, cells: usize) {
        self.declare_encoded(array, size_of::<u64>() + cells * array.cell_size());
    }

    /// Adds an array whose encoded values, of `length` bytes, are written later.
    pub(super) fn declare_encoded(&mut self, array: &ArrayDeclaration, length: usize) {
        self.arrays.push(CellArray {
            name: array.name.clone(),
            vtk_type: array.vtk_type,
            components: array.components,
            bytes: Vec::new(),
            length,
        });
    }

    /// Adds an array with the bytes of its values.
    pub(super) fn add_bytes(&mut self, array: &ArrayDeclaration, values: &[u8]) {
        let bytes = match self.storage {
            Storage::Plain => encode_plain_bytes(values),
            Storage::Compressed => encode_compressed_bytes(values),
        };
        self.arrays.push(CellArray {
            name: array.name.clone(),
            vtk_type: array.vtk_type,
            components: array.components,
            length: bytes.len(),
            bytes,
        });
    }

    /// Whether values are stored without compression.
    pub(super) fn is_plain(&self) -> bool {
        self.storage == Storage::Plain
    }

    /// Returns the arrays without their values.
    pub(super) fn declarations(&self) -> impl Iterator<Item = ArrayDeclaration> {
        self.arrays.iter().map(|own| ArrayDeclaration {
            name: own.name.clone(),
            vtk_type: own.vtk_type,
            components: own.components,
        })
    }

    /// Encodes values according to the storage of the file.
    pub(super) fn encode<T: VtkNumber>(&self, values: &[T]) -> Vec<u8> {
        match self.storage {
            Storage::Plain => encode_plain(values),
            Storage::Compressed => encode_compressed(values),
        }
    }

    /// Length of the appended values of all arrays, bytes.
    pub(super) fn byte_count(&self) -> usize {
        self.arrays.iter().map(|array| array.length).sum()
    }

    /// Writes the appended values.
    pub(super) fn write_values(&self, writer: &mut impl Write) -> io::Result<()> {
        self.arrays.iter().try_for_each(|array| writer.write_all(&array.bytes))
    }

    /// XML elements of the arrays with their offsets.
    pub(super) fn format_elements(&self) -> String {
        let mut elements = String::new();
        let mut offset = 0;
        for CellArray { name, vtk_type, components, length, .. } in &self.arrays {
            let element = format_array(vtk_type, &escape_xml(name), *components, offset);
            elements.push_str(&element);
            offset += length;
        }
        elements
    }

    /// XML declaration and start tag of a file of a kind.
    pub(super) fn format_start(&self, kind: &str) -> String {
        let compressor = match self.storage {
            Storage::Plain => "",
            Storage::Compressed => " compressor=\"vtkZLibDataCompressor\"",
        };
        format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"LittleEndian\" \
             header_type=\"UInt64\"{compressor}>\n"
        )
    }
}

/// End of a file, after the appended values.
pub(super) const FILE_END: &[u8] = b"\n  </AppendedData>\n</VTKFile>\n";

/// XML element of an appended array.
pub(super) fn format_array(
    vtk_type: &str,
    escaped_name: &str,
    components: usize,
    offset: usize,
) -> String {
    format!(
        "        <DataArray type=\"{vtk_type}\" Name=\"{escaped_name}\" \
         NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n"
    )
}

/// Name of the number that states the rounding error of values.
pub(super) const ROUNDING_ERROR_NAME: &str = "RelativeRoundingError";

/// XML element of the time, with the name expected by VTK readers.
pub(super) fn format_time_element(time: Option<f64>) -> String {
    format_number_elements(&[("TimeValue", time)])
}

/// XML element of the numbers of a file that are present.
pub(super) fn format_number_elements(numbers: &[(&str, Option<f64>)]) -> String {
    let element = |(name, number): &(&str, Option<f64>)| {
        let number = format_shortest((*number)?);
        Some(format!(
            "      <DataArray type=\"Float64\" Name=\"{name}\" \
             NumberOfTuples=\"1\" format=\"ascii\">{number}</DataArray>\n"
        ))
    };
    let elements: String = numbers.iter().filter_map(element).collect();
    match elements.is_empty() {
        true => elements,
        false => format!("    <FieldData>\n{elements}    </FieldData>\n"),
    }
}

pub(super) fn check_length(name: &str, found: usize, expected: usize) -> Result<(), VtiError> {
    if found == expected {
        return Ok(());
    }
    Err(VtiError::Length { name: name.to_owned(), found, expected })
}
