//! Named arrays in NumPy's NPZ format.
//!
//! An NPZ file is a ZIP archive with one `.npy` entry per array. NumPy's function `numpy.load` reads it without the
//! option `allow_pickle`, since numbers and Unicode strings are plain data.

use std::io::{self, Cursor, Read, Seek, Write};

use crate::regular_file::try_read_to_end;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

/// Error of writing or reading an NPZ archive.
#[derive(Debug, thiserror::Error)]
pub enum NpzError {
    /// The number of values is not the product of the shape.
    #[error("array \"{name}\" has {found} values, which do not fill the shape {shape:?}")]
    Shape {
        /// Name of the array.
        name: String,
        /// Length along each dimension, slowest first.
        shape: Vec<usize>,
        /// Number of values given.
        found: usize,
    },
    /// Error of the ZIP container: a duplicate name or a damaged archive.
    #[error("array archive: {0}")]
    Container(#[from] zip::result::ZipError),
    /// Compressing or decompressing failed.
    #[error("array archive: {0}")]
    Stream(#[from] io::Error),
    /// An entry is not an array of a supported type in row-major order, is damaged, or is larger than allowed.
    #[error("entry \"{name}\" of the array archive {problem}")]
    Entry {
        /// Name of the array.
        name: String,
        /// Problem of the entry, as a phrase that follows the name.
        problem: &'static str,
    },
}

/// Length of the blocks in which the bytes of an array are compressed.
const BLOCK_LENGTH: usize = 1 << 16;

/// NPZ archive under construction. Arrays are compressed as they are added and written to the writer in blocks; the same
/// arrays added in the same order give the same bytes. The writer seeks back to the header of each entry to fill in its
/// length.
pub struct NpzWriter<W: Write + Seek> {
    archive: ZipWriter<W>,
}

impl<W: Write + Seek> NpzWriter<W> {
    /// Starts an archive at the beginning of a writer.
    pub fn new(writer: W) -> Self {
        Self { archive: ZipWriter::new(writer) }
    }

    /// Adds an array of double-precision numbers (`<f8`) in row-major order; an empty shape denotes a single number.
    pub fn add_f64(&mut self, name: &str, shape: &[usize], data: &[f64]) -> Result<(), NpzError> {
        self.add_entry(name, "<f8", 8, shape, data, |value, bytes| {
            bytes.extend(value.to_le_bytes())
        })
    }

    /// Adds an array of 8-bit integers (`|i1`) in row-major order.
    pub fn add_i8(&mut self, name: &str, shape: &[usize], data: &[i8]) -> Result<(), NpzError> {
        self.add_entry(name, "|i1", 1, shape, data, |value, bytes| {
            bytes.extend(value.to_le_bytes())
        })
    }

    /// Adds an array of 32-bit integers (`<i4`) in row-major order.
    pub fn add_i32(&mut self, name: &str, shape: &[usize], data: &[i32]) -> Result<(), NpzError> {
        self.add_entry(name, "<i4", 4, shape, data, |value, bytes| {
            bytes.extend(value.to_le_bytes())
        })
    }

    /// Adds an array of Unicode strings (`<U…`) in row-major order. The format pads strings with zero characters;
    /// trailing zero characters of a string are lost.
    pub fn add_text(
        &mut self,
        name: &str,
        shape: &[usize],
        data: &[impl AsRef<str>],
    ) -> Result<(), NpzError> {
        let longest = data.iter().map(|text| text.as_ref().chars().count()).max();
        let width = longest.unwrap_or(0).max(1);
        self.add_entry(name, &format!("<U{width}"), 4 * width, shape, data, |text, bytes| {
            let end = bytes.len() + 4 * width;
            bytes.extend(text.as_ref().chars().flat_map(|c| u32::from(c).to_le_bytes()));
            bytes.resize(end, 0);
        })
    }

    /// Finishes the archive and returns its writer.
    pub fn finish(self) -> Result<W, NpzError> {
        Ok(self.archive.finish()?)
    }

    /// Adds an entry; `append_bytes` appends `width` bytes for each value.
    fn add_entry<T>(
        &mut self,
        name: &str,
        type_code: &str,
        width: usize,
        shape: &[usize],
        data: &[T],
        append_bytes: impl Fn(&T, &mut Vec<u8>),
    ) -> Result<(), NpzError> {
        if value_count(shape) != Some(data.len()) {
            let (name, shape) = (name.to_owned(), shape.to_vec());
            return Err(NpzError::Shape { name, shape, found: data.len() });
        }
        let mut block = format_header(type_code, shape);
        let length = block.len() + width * data.len();
        // The fixed date makes the bytes reproducible. Entries of 4 GiB or more need the ZIP64 format.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .large_file(length >= u32::MAX as usize);
        self.archive.start_file(format!("{name}.npy"), options)?;
        for values in data.chunks((BLOCK_LENGTH / width).max(1)) {
            values.iter().for_each(|value| append_bytes(value, &mut block));
            self.archive.write_all(&block)?;
            block.clear();
        }
        self.archive.write_all(&block)?;
        Ok(())
    }
}

/// Number of values of a shape; `None` on integer overflow.
fn value_count(shape: &[usize]) -> Option<usize> {
    shape.iter().try_fold(1_usize, |product, &length| product.checked_mul(length))
}

/// Magic string of `.npy` files, and format version 1.0.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// Header of a `.npy` file, format version 1.0, padded so that the data start at a multiple of 64 bytes.
fn format_header(type_code: &str, shape: &[usize]) -> Vec<u8> {
    // A Python tuple of one item needs a trailing comma; longer tuples may have one.
    let lengths: String = shape.iter().map(|length| format!("{length}, ")).collect();
    let mut text =
        format!("{{'descr': '{type_code}', 'fortran_order': False, 'shape': ({lengths}), }}");
    let unpadded = MAGIC.len() + 2 + text.len() + 1;
    text.push_str(&" ".repeat(unpadded.next_multiple_of(64) - unpadded));
    text.push('\n');
    let mut bytes = MAGIC.to_vec();
    bytes.extend((text.len() as u16).to_le_bytes());
    bytes.extend(text.as_bytes());
    bytes
}

/// Values of an array in row-major order.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayValues {
    /// Double-precision numbers, `<f8`.
    F64(Vec<f64>),
    /// 8-bit integers, `|i1`.
    I8(Vec<i8>),
    /// 32-bit integers, `<i4`.
    I32(Vec<i32>),
    /// Unicode strings, `<U…`.
    Text(Vec<String>),
}

/// Array read from an archive.
#[derive(Debug, Clone, PartialEq)]
pub struct NpzArray {
    /// Name of the array in the archive.
    pub name: String,
    /// Length along each dimension, slowest first.
    pub shape: Vec<usize>,
    /// Values in row-major order.
    pub values: ArrayValues,
}

/// Reads all arrays of an archive, in order. Archives of other programs are accepted if all arrays are of the supported
/// types in row-major order.
pub fn read_arrays(bytes: &[u8]) -> Result<Vec<NpzArray>, NpzError> {
    read_selected_arrays(bytes, |_| true, usize::MAX)
}

/// Reads the arrays with wanted names from an untrusted archive, each limited to the size of `max_values` doubles;
/// other arrays are not decompressed.
///
/// # Errors
/// The archive is damaged, or a wanted array is of an unsupported type, is larger, or does not fit into memory.
pub fn read_selected_arrays(
    bytes: &[u8],
    is_wanted: impl Fn(&str) -> bool,
    max_values: usize,
) -> Result<Vec<NpzArray>, NpzError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let mut arrays = Vec::new();
    for index in 0..archive.len() {
        let entry = archive.by_index(index)?;
        let name = entry.name()?;
        let name = name.strip_suffix(".npy").unwrap_or(&name).to_owned();
        if !is_wanted(&name) {
            continue;
        }
        let entry_error = |problem| NpzError::Entry { name: name.clone(), problem };
        // The width of strings is stated by the array; the limit applies to bytes, in units of 8-byte numbers.
        let max_length =
            (MAX_HEADER_LENGTH as u64).saturating_add((max_values as u64).saturating_mul(8));
        let mut bytes = Vec::new();
        let expected = entry.size().min(max_length);
        try_read_to_end(entry.take(max_length.saturating_add(1)), expected, &mut bytes)?;
        if bytes.len() as u64 > max_length {
            return Err(entry_error("is larger than it can be"));
        }
        let (shape, values) = parse_array(&bytes).map_err(entry_error)?;
        arrays.push(NpzArray { name, shape, values });
    }
    Ok(arrays)
}

/// Maximum length of a header of format version 1.0, bytes.
const MAX_HEADER_LENGTH: usize = 10 + u16::MAX as usize;

/// Text between `open` and the next `close`.
fn find_delimited<'a>(text: &'a str, open: &str, close: char) -> Option<&'a str> {
    let rest = &text[text.find(open)? + open.len()..];
    Some(&rest[..rest.find(close)?])
}

fn parse_array(bytes: &[u8]) -> Result<(Vec<usize>, ArrayValues), &'static str> {
    const HEADER_PROBLEM: &str = "has no readable header of format version 1.0";
    let rest = bytes.strip_prefix(MAGIC).ok_or(HEADER_PROBLEM)?;
    let (length, rest) = rest.split_first_chunk::<2>().ok_or(HEADER_PROBLEM)?;
    let length = usize::from(u16::from_le_bytes(*length));
    let (header, data) = rest.split_at_checked(length).ok_or(HEADER_PROBLEM)?;
    let header = str::from_utf8(header).map_err(|_| HEADER_PROBLEM)?;
    if !header.contains("'fortran_order': False") {
        return Err("is not in row-major order");
    }
    let type_code = find_delimited(header, "'descr': '", '\'').ok_or(HEADER_PROBLEM)?;
    let shape = find_delimited(header, "'shape': (", ')').ok_or(HEADER_PROBLEM)?;
    let shape = shape.split(',').map(str::trim).filter(|length| !length.is_empty());
    let shape =
        shape.map(str::parse).collect::<Result<Vec<usize>, _>>().map_err(|_| HEADER_PROBLEM)?;

    const UNSUPPORTED_TYPE_PROBLEM: &str = "holds values of a kind that is not read here";
    let width = match type_code {
        "<f8" => 8,
        "|i1" => 1,
        "<i4" => 4,
        _ => {
            let characters = type_code.strip_prefix("<U").and_then(|width| width.parse().ok());
            let width = characters
                .and_then(|width: usize| width.checked_mul(4))
                .ok_or(UNSUPPORTED_TYPE_PROBLEM)?;
            if width == 0 {
                return Err(UNSUPPORTED_TYPE_PROBLEM);
            }
            width
        }
    };
    if value_count(&shape).and_then(|count| count.checked_mul(width)) != Some(data.len()) {
        return Err("has another length than its shape says");
    }
    let items = data.chunks_exact(width);
    let values = match type_code {
        "<f8" => {
            ArrayValues::F64(data.as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect())
        }
        "|i1" => ArrayValues::I8(data.iter().map(|&b| i8::from_le_bytes([b])).collect()),
        "<i4" => {
            ArrayValues::I32(data.as_chunks().0.iter().map(|&b| i32::from_le_bytes(b)).collect())
        }
        _ => ArrayValues::Text(
            items.map(decode_string).collect::<Option<_>>().ok_or("holds a broken string")?,
        ),
    };
    Ok((shape, values))
}

/// String from its zero-padded UTF-32 code points.
fn decode_string(item: &[u8]) -> Option<String> {
    let points = item.as_chunks().0.iter().map(|&b| char::from_u32(u32::from_le_bytes(b)));
    let padded: String = points.collect::<Option<_>>()?;
    Some(padded.trim_end_matches('\0').to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample_archive() -> Vec<u8> {
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
        let grid = [1.0, -0.0, f64::INFINITY, f64::NAN, 5e-324, 1.0 / 3.0];
        npz.add_f64("rate", &[2, 3], &grid).unwrap();
        npz.add_f64("single", &[], &[2.5]).unwrap();
        npz.add_f64("nothing", &[0, 4], &[]).unwrap();
        npz.add_i8("verdict", &[3], &[-1, 0, 127]).unwrap();
        npz.add_i32("count", &[1, 1, 2], &[i32::MIN, 7]).unwrap();
        npz.add_text("axis Δ", &[2], &["Δ (°)", ""]).unwrap();
        npz.finish().unwrap().into_inner()
    }

    #[test]
    fn arrays_are_read_back_unchanged() {
        let arrays = read_arrays(&sample_archive()).unwrap();
        let names: Vec<&str> = arrays.iter().map(|array| array.name.as_str()).collect();
        assert_eq!(names, ["rate", "single", "nothing", "verdict", "count", "axis Δ"]);
        let shapes: Vec<&[usize]> = arrays.iter().map(|array| &array.shape[..]).collect();
        assert_eq!(shapes, [&[2, 3][..], &[], &[0, 4], &[3], &[1, 1, 2], &[2]]);
        let ArrayValues::F64(rate) = &arrays[0].values else { panic!("numbers expected") };
        let expected = [1.0, -0.0, f64::INFINITY, f64::NAN, 5e-324, 1.0 / 3.0];
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(rate), bits(&expected));
        assert_eq!(arrays[1].values, ArrayValues::F64(vec![2.5]));
        assert_eq!(arrays[3].values, ArrayValues::I8(vec![-1, 0, 127]));
        assert_eq!(arrays[4].values, ArrayValues::I32(vec![i32::MIN, 7]));
        assert_eq!(arrays[5].values, ArrayValues::Text(vec!["Δ (°)".to_owned(), String::new()]));
    }

    #[test]
    fn headers_follow_the_format() {
        let header = format_header("<f8", &[2, 3]);
        assert_eq!(&header[..8], b"\x93NUMPY\x01\x00");
        assert_eq!(header.len() % 64, 0);
        assert_eq!(usize::from(u16::from_le_bytes([header[8], header[9]])) + 10, header.len());
        let text = str::from_utf8(&header[10..]).unwrap();
        let dictionary = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3, ), }";
        assert_eq!(text.trim_end(), dictionary);
        assert!(text.ends_with('\n'));
    }

    #[test]
    fn equal_content_gives_equal_bytes() {
        let bytes = sample_archive();
        assert_eq!(bytes, sample_archive());
        // No entry contains its time of writing.
        let mut archive = ZipArchive::new(Cursor::new(&bytes[..])).unwrap();
        for index in 0..archive.len() {
            let date = archive.by_index(index).unwrap().last_modified();
            assert_eq!(date, Some(DateTime::default()));
        }
    }

    #[test]
    fn wrong_shape_or_duplicate_name_is_refused() {
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
        let refused = npz.add_f64("a", &[2, 2], &[1.0; 3]).unwrap_err();
        assert!(matches!(refused, NpzError::Shape { found: 3, .. }), "{refused}");
        assert!(npz.add_i8("huge", &[usize::MAX, 2], &[1]).is_err());
        npz.add_i8("a", &[1], &[1]).unwrap();
        assert!(matches!(npz.add_i8("a", &[1], &[1]), Err(NpzError::Container(_))));
    }

    #[test]
    fn damaged_archives_are_refused() {
        let whole = sample_archive();
        assert!(read_arrays(&whole[..whole.len() / 2]).is_err());
        let mut flipped = 0;
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x10;
            flipped += usize::from(read_arrays(&bytes).is_err());
        }
        assert!(flipped > whole.len() / 2, "only {flipped} of {} noticed", whole.len());
        assert!(parse_array(b"\x93NUMPY\x01\x00\xff\xff{}").is_err());
        assert!(parse_array(&format_header("<U0", &[3])).is_err());
        assert!(parse_array(&format_header("|O", &[0])).is_err());
        assert!(parse_array(&format_header("<f8", &[usize::MAX, usize::MAX])).is_err());
    }

    #[test]
    fn unwanted_arrays_are_not_decompressed_and_sizes_are_limited() {
        let mut npz = NpzWriter::new(Cursor::new(Vec::new()));
        npz.add_f64("v1", &[3], &[1.0, 2.0, 3.0]).unwrap();
        npz.add_f64("large", &[100_000], &vec![0.0; 100_000]).unwrap();
        let mut bytes = npz.finish().unwrap().into_inner();
        let wanted = |name: &str| name == "v1";
        assert_eq!(read_selected_arrays(&bytes, wanted, 3).unwrap().len(), 1);
        let refused = read_selected_arrays(&bytes, |_| true, 3).unwrap_err().to_string();
        assert_eq!(refused, "entry \"large\" of the array archive is larger than it can be");
        // Damage to an entry is detected only when that entry is read.
        let place = bytes.windows(9).position(|window| window == b"large.npy").unwrap() + 9;
        bytes[place..place + 40].fill(0xff);
        assert_eq!(
            read_selected_arrays(&bytes, wanted, 3).unwrap()[0].values,
            ArrayValues::F64(vec![1.0, 2.0, 3.0])
        );
        assert!(read_arrays(&bytes).is_err());
    }
}
