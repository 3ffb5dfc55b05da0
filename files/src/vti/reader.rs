//! Reader of files written by this crate.

use super::arrays::ArrayDeclaration;
use super::attributes::{escape_xml, unescape_xml};
use super::number::VtkNumber;
use flate2::read::ZlibDecoder;
use std::io::Read;

/// Values of an array of doubles in a file written by [`ImageData`](super::image_data::ImageData) with
/// [`Storage::Plain`](super::encoding::Storage::Plain); `None` if the file has another format or is damaged, or the
/// array is absent.
pub fn read_plain_values(bytes: &[u8], name: &str) -> Option<Vec<f64>> {
    let (numbers, []) = find_array(bytes, "Float64", name)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// Values of an array of 32-bit integers in a file, as [`read_plain_values`].
pub fn read_plain_integers(bytes: &[u8], name: &str) -> Option<Vec<i32>> {
    let (numbers, []) = find_array(bytes, "Int32", name)?.as_chunks() else { return None };
    Some(numbers.iter().map(|number| i32::from_le_bytes(*number)).collect())
}

/// Values of an array of doubles or of single-precision numbers, compressed or not; `None` if the file has another format
/// or is damaged, or the array is absent.
pub fn read_values(bytes: &[u8], name: &str) -> Option<Vec<f64>> {
    let array = list_arrays(bytes)?.into_iter().find(|own| own.name == name)?;
    let values = read_array_bytes(bytes, &array)?;
    match (array.vtk_type, array.cell_size() / array.components.max(1)) {
        (f64::VTK_TYPE, 8) => {
            let (numbers, []) = values.as_chunks() else { return None };
            Some(numbers.iter().map(|number| f64::from_le_bytes(*number)).collect())
        }
        (f32::VTK_TYPE, 4) => {
            let (numbers, []) = values.as_chunks() else { return None };
            Some(numbers.iter().map(|number| f64::from(f32::from_le_bytes(*number))).collect())
        }
        _ => None,
    }
}

/// Values of an array of 32-bit integers, as [`read_values`].
pub fn read_integers(bytes: &[u8], name: &str) -> Option<Vec<i32>> {
    let arrays = list_arrays(bytes)?.into_iter();
    let array = arrays.filter(|own| own.vtk_type == i32::VTK_TYPE).find(|own| own.name == name)?;
    let values = read_array_bytes(bytes, &array)?;
    let (numbers, []) = values.as_chunks() else { return None };
    Some(numbers.iter().map(|number| i32::from_le_bytes(*number)).collect())
}

/// Returns the bytes of the numbers of an array.
fn find_array<'a>(bytes: &'a [u8], kind: &str, name: &str) -> Option<&'a [u8]> {
    let (head, values) = split_header(bytes)?;
    if head.contains(COMPRESSOR) {
        return None;
    }
    find_plain_array(head, values, &array_attributes(kind, name))
}

/// Attribute of the start tag of a compressed file.
const COMPRESSOR: &str = " compressor=";

/// Returns the XML before the appended values, and the appended values.
fn split_header(bytes: &[u8]) -> Option<(&str, &[u8])> {
    const HEADER_END: &[u8] = b"<AppendedData encoding=\"raw\">\n   _";
    let end = bytes.windows(HEADER_END.len()).position(|window| window == HEADER_END)?;
    Some((std::str::from_utf8(&bytes[..end]).ok()?, &bytes[end + HEADER_END.len()..]))
}

/// Returns type and name of an array as they are in its XML element.
fn array_attributes(kind: &str, name: &str) -> String {
    format!(" type=\"{kind}\" Name=\"{}\" ", escape_xml(name))
}

/// Returns the encoded values of an array and of those after it.
fn find_encoded<'a>(head: &str, values: &'a [u8], attributes: &str) -> Option<&'a [u8]> {
    let element =
        head.lines().find(|line| line.contains(attributes) && line.contains(" offset="))?;
    values.get(attribute(element, "offset")?.parse::<usize>().ok()?..)
}

/// Returns the values of an array that is not compressed.
fn find_plain_array<'a>(head: &str, values: &'a [u8], attributes: &str) -> Option<&'a [u8]> {
    let (length, values) = find_encoded(head, values, attributes)?.split_first_chunk()?;
    values.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)
}

/// Returns the value of an attribute of an XML element.
fn attribute<'a>(element: &'a str, name: &str) -> Option<&'a str> {
    element.split(&format!(" {name}=\"")).nth(1)?.split('"').next()
}

/// Lists the cell arrays of a file; `None` if the file has another format.
pub fn list_arrays(bytes: &[u8]) -> Option<Vec<ArrayDeclaration>> {
    const TYPES: [&str; 4] = [f64::VTK_TYPE, f32::VTK_TYPE, i32::VTK_TYPE, i64::VTK_TYPE];
    let (head, _) = split_header(bytes)?;
    let cell_data = head.split("<CellData>").nth(1)?.split("</CellData>").next()?;
    let declaration = |line: &str| {
        let kind = attribute(line, "type")?;
        Some(ArrayDeclaration {
            name: unescape_xml(attribute(line, "Name")?),
            vtk_type: TYPES.into_iter().find(|own| *own == kind)?,
            components: attribute(line, "NumberOfComponents")?.parse().ok()?,
        })
    };
    cell_data.lines().filter(|line| line.contains("<DataArray ")).map(declaration).collect()
}

/// Returns the values of an array as little-endian bytes, decompressed if need be; `None` if the file is damaged or the
/// array is absent.
pub fn read_array_bytes(bytes: &[u8], array: &ArrayDeclaration) -> Option<Vec<u8>> {
    let (head, values) = split_header(bytes)?;
    let attributes = array_attributes(array.vtk_type, &array.name);
    if !head.contains(COMPRESSOR) {
        return find_plain_array(head, values, &attributes).map(<[u8]>::to_vec);
    }
    let encoded = find_encoded(head, values, &attributes)?;
    let number = |index: usize| {
        let bytes = encoded.get(8 * index..)?.first_chunk()?;
        usize::try_from(u64::from_le_bytes(*bytes)).ok()
    };
    let blocks = number(0)?;
    let mut start = blocks.checked_add(3)?.checked_mul(8)?;
    let mut decoded = Vec::new();
    for block in 0..blocks {
        let end = start.checked_add(number(3 + block)?)?;
        ZlibDecoder::new(encoded.get(start..end)?).read_to_end(&mut decoded).ok()?;
        start = end;
    }
    Some(decoded)
}

/// Time of a file written by [`ImageData`](super::image_data::ImageData); `None` if the file has another format or no
/// time.
pub fn read_plain_time(bytes: &[u8]) -> Option<f64> {
    const TIME_ATTRIBUTES: &[u8] = b" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">";
    let start =
        bytes.windows(TIME_ATTRIBUTES.len()).position(|window| window == TIME_ATTRIBUTES)?
            + TIME_ATTRIBUTES.len();
    let text = bytes.get(start..)?.split(|byte| *byte == b'<').next()?;
    std::str::from_utf8(text).ok()?.parse().ok()
}
