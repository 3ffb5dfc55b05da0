//! Arrays in chunks in the format Zarr, version 3, in a ZIP archive: xarray and zarr-python read any part of an array
//! without the rest.
//!
//! Chunks are compressed by zlib after byte shuffling in the container of Blosc, version 1: the first bytes of all numbers,
//! then their second bytes, and so on, since neighbouring numbers have equal signs and exponents.

use crate::vti::compress;
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::ops::Range;
use zip::write::{SimpleFileOptions, StreamWriter};
use zip::{CompressionMethod, DateTime, ZipWriter};

/// Type of the numbers of an array.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZarrNumber {
    /// Double precision.
    F64,
    /// Single precision.
    F32,
    /// 32-bit integer.
    I32,
}

impl ZarrNumber {
    fn name(self) -> &'static str {
        match self {
            Self::F64 => "float64",
            Self::F32 => "float32",
            Self::I32 => "int32",
        }
    }

    /// Returns the number of bytes of a number.
    pub fn size(self) -> usize {
        if self == Self::F64 { 8 } else { 4 }
    }
}

/// Description of an array.
#[derive(Debug, Clone, PartialEq)]
pub struct ZarrArray {
    /// Name, unique in the store.
    pub name: String,
    /// Type of the numbers.
    pub number: ZarrNumber,
    /// Name and length of each dimension, the slowest first; a dimension with the name of an array has its values as
    /// coordinates.
    pub dimensions: Vec<(String, usize)>,
    /// Length of a chunk along each dimension.
    pub chunk_shape: Vec<usize>,
    /// Attributes, such as `units`.
    pub attributes: Map<String, Value>,
}

impl ZarrArray {
    fn metadata(&self) -> Value {
        let (names, shape): (Vec<&str>, Vec<usize>) =
            self.dimensions.iter().map(|(name, length)| (name.as_str(), *length)).unzip();
        // The fill value stands for missing chunks. JSON has no literal for not-a-number.
        let fill = if self.number == ZarrNumber::I32 { json!(0) } else { json!("NaN") };
        json!({
            "zarr_format": 3,
            "node_type": "array",
            "shape": shape,
            "data_type": self.number.name(),
            "chunk_grid": { "name": "regular", "configuration": { "chunk_shape": self.chunk_shape } },
            "chunk_key_encoding": { "name": "default", "configuration": { "separator": "/" } },
            "fill_value": fill,
            "codecs": [
                { "name": "bytes", "configuration": { "endian": "little" } },
                { "name": "blosc", "configuration": {
                    "cname": "zlib", "clevel": 6, "shuffle": "shuffle", "typesize": self.number.size(), "blocksize": 0,
                } },
            ],
            "attributes": self.attributes,
            "dimension_names": names,
        })
    }
}

/// Store under construction. The same calls give the same bytes.
pub struct ZarrWriter<W: Write> {
    archive: ZipWriter<StreamWriter<W>>,
    arrays: Map<String, Value>,
}

impl<W: Write> ZarrWriter<W> {
    /// Starts a store in an archive that `writer` receives.
    pub fn new(writer: W) -> Self {
        Self { archive: ZipWriter::new_stream(writer), arrays: Map::new() }
    }

    /// Writes all chunks of a part of an array; may be called for several parts, such as the times of a run.
    ///
    /// `leading` is the index along the first dimensions, in each of which a chunk has the length 1; `bytes` has the
    /// little-endian numbers along the others, the last of which varies fastest.
    ///
    /// # Errors
    /// The lengths do not agree, or the archive cannot be written.
    pub fn write_part(
        &mut self,
        array: &ZarrArray,
        leading: &[usize],
        bytes: &[u8],
    ) -> io::Result<()> {
        let lengths: Vec<usize> =
            array.dimensions.iter().skip(leading.len()).map(|(_, length)| *length).collect();
        let size = array.number.size();
        if bytes.len() != size * lengths.iter().product::<usize>() {
            let text = format!("{} bytes do not fill the array {}", bytes.len(), array.name);
            return Err(io::Error::new(io::ErrorKind::InvalidInput, text));
        }
        self.arrays.insert(array.name.clone(), array.metadata());
        let chunk = &array.chunk_shape[leading.len()..];
        let counts: Vec<usize> =
            lengths.iter().zip(chunk).map(|(length, chunk)| length.div_ceil(*chunk)).collect();
        for index in 0..counts.iter().product() {
            let position = unravel(index, &counts);
            let content = cut_chunk(bytes, size, (&lengths, chunk), &position);
            let mut key = format!("{}/c", array.name);
            for own in leading.iter().chain(&position) {
                key += &format!("/{own}");
            }
            self.write_entry(&key, &encode_blosc(&content, size))?;
        }
        Ok(())
    }

    /// Writes the descriptions and ends the archive.
    ///
    /// # Errors
    /// The archive cannot be written.
    pub fn finish(mut self, attributes: Map<String, Value>) -> io::Result<()> {
        let arrays = std::mem::take(&mut self.arrays);
        for (name, metadata) in &arrays {
            self.write_entry(&format!("{name}/zarr.json"), metadata.to_string().as_bytes())?;
        }
        // With the descriptions of all arrays in that of the group a reader needs one access.
        let group = json!({
            "zarr_format": 3,
            "node_type": "group",
            "attributes": attributes,
            "consolidated_metadata": { "kind": "inline", "must_understand": false, "metadata": arrays },
        });
        self.write_entry("zarr.json", group.to_string().as_bytes())?;
        self.archive.finish()?;
        Ok(())
    }

    fn write_entry(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        // The fixed date makes the bytes reproducible; chunks are compressed already.
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .last_modified_time(DateTime::default())
            .large_file(bytes.len() >= u32::MAX as usize);
        self.archive.start_file(name, options)?;
        self.archive.write_all(bytes)
    }
}

/// Returns the index along each dimension of an element of a box, the last dimension fastest.
fn unravel(mut index: usize, counts: &[usize]) -> Vec<usize> {
    let mut position = vec![0; counts.len()];
    for (own, count) in position.iter_mut().zip(counts).rev() {
        (*own, index) = (index % count, index / count);
    }
    position
}

/// Copies a chunk out of an array; beyond the array, a chunk is filled with zeros.
fn cut_chunk(
    bytes: &[u8],
    size: usize,
    (lengths, chunk): (&[usize], &[usize]),
    position: &[usize],
) -> Vec<u8> {
    let own: Vec<Range<usize>> = (0..chunk.len())
        .map(|axis| {
            let start = position[axis] * chunk[axis];
            start..(start + chunk[axis]).min(lengths[axis])
        })
        .collect();
    let mut content = vec![0; size * chunk.iter().product::<usize>()];
    let rows: Vec<usize> = own.iter().map(Range::len).collect();
    let [outer @ .., row_length] = &rows[..] else { return bytes.to_vec() };
    let offset = |position: &[usize], lengths: &[usize]| {
        position.iter().zip(lengths).fold(0, |sum, (own, length)| sum * length + own)
    };
    for row in 0..outer.iter().product() {
        let mut within = unravel(row, outer);
        within.push(0);
        let global: Vec<usize> =
            within.iter().zip(&own).map(|(own, range)| own + range.start).collect();
        let (from, to) = (size * offset(&global, lengths), size * offset(&within, chunk));
        content[to..to + size * row_length].copy_from_slice(&bytes[from..from + size * row_length]);
    }
    content
}

/// Encodes a chunk as Blosc, version 1, does: one block, shuffled, compressed by zlib (`README_CHUNK_FORMAT.rst` of
/// c-blosc).
fn encode_blosc(bytes: &[u8], size: usize) -> Vec<u8> {
    const VERSIONS: [u8; 2] = [2, 1]; // of the container, and of its use of zlib
    const SHUFFLED: u8 = 0x01;
    const STORED: u8 = 0x02;
    const NOT_SPLIT: u8 = 0x10;
    const ZLIB: u8 = 3 << 5;
    const HEADER_LENGTH: usize = 16;
    let count = bytes.len() / size;
    let mut shuffled = Vec::with_capacity(bytes.len());
    for byte in 0..size {
        shuffled.extend((0..count).map(|index| bytes[size * index + byte]));
    }
    let compressed = compress(&shuffled);
    // After the header: the start of the block, its length, the block.
    let is_stored = compressed.len() + 8 >= bytes.len();
    let flags = if is_stored { STORED | ZLIB } else { SHUFFLED | NOT_SPLIT | ZLIB };
    let content = if is_stored { bytes.len() } else { compressed.len() + 8 };
    let number = |value: usize| (value as u32).to_le_bytes(); // a chunk has less than 2 GiB
    let mut encoded = Vec::with_capacity(HEADER_LENGTH + content);
    encoded.extend([VERSIONS[0], VERSIONS[1], flags, size as u8]);
    for value in [bytes.len(), bytes.len(), HEADER_LENGTH + content] {
        encoded.extend(number(value));
    }
    if is_stored {
        encoded.extend(bytes);
    } else {
        encoded.extend(number(HEADER_LENGTH + 4));
        encoded.extend(number(compressed.len()));
        encoded.extend(compressed);
    }
    encoded
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::read::ZlibDecoder;
    use std::io::{Cursor, Read};
    use zip::ZipArchive;

    /// Decodes a chunk by the description of the format, without the functions above.
    fn decode_blosc(encoded: &[u8]) -> Vec<u8> {
        let number =
            |at: usize| u32::from_le_bytes(encoded[at..at + 4].try_into().unwrap()) as usize;
        let (flags, size, length) = (encoded[2], usize::from(encoded[3]), number(4));
        assert_eq!(number(12), encoded.len());
        if flags & 2 != 0 {
            return encoded[16..].to_vec();
        }
        let start = number(16);
        let mut shuffled = Vec::new();
        ZlibDecoder::new(&encoded[start + 4..start + 4 + number(start)])
            .read_to_end(&mut shuffled)
            .unwrap();
        assert_eq!(shuffled.len(), length);
        let count = length / size;
        (0..length).map(|place| shuffled[place % size * count + place / size]).collect()
    }

    fn read_entry(archive: &mut ZipArchive<Cursor<Vec<u8>>>, name: &str) -> Vec<u8> {
        let mut bytes = Vec::new();
        archive.by_name(name).unwrap().read_to_end(&mut bytes).unwrap();
        bytes
    }

    /// Every number of an array of 7 × 5 numbers at two times is in its chunk of 3 × 4; the rest of a chunk is zero.
    #[test]
    fn numbers_are_in_their_chunks() {
        let array = ZarrArray {
            name: "v1".to_owned(),
            number: ZarrNumber::F64,
            dimensions: [("time", 2), ("x2", 7), ("x1", 5)]
                .map(|(n, l)| (n.to_owned(), l))
                .to_vec(),
            chunk_shape: vec![1, 3, 4],
            attributes: Map::from_iter([("units".to_owned(), json!("m/s"))]),
        };
        let value =
            |time: usize, row: usize, column: usize| (100 * time + 10 * row + column) as f64;
        let mut bytes = Vec::new();
        let mut writer = ZarrWriter::new(&mut bytes);
        for time in 0..2 {
            let numbers = (0..7).flat_map(|row| (0..5).map(move |column| value(time, row, column)));
            let part: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
            writer.write_part(&array, &[time], &part).unwrap();
            assert!(writer.write_part(&array, &[time], &part[1..]).is_err());
        }
        writer.finish(Map::new()).unwrap();
        let mut archive = ZipArchive::new(Cursor::new(bytes)).unwrap();
        for time in 0..2 {
            for (i, j) in (0..3).flat_map(|i| (0..2).map(move |j| (i, j))) {
                let chunk =
                    decode_blosc(&read_entry(&mut archive, &format!("v1/c/{time}/{i}/{j}")));
                let (numbers, []) = chunk.as_chunks::<8>() else { panic!("{}", chunk.len()) };
                for (place, number) in numbers.iter().enumerate() {
                    let (row, column) = (3 * i + place / 4, 4 * j + place % 4);
                    let expected =
                        if row < 7 && column < 5 { value(time, row, column) } else { 0.0 };
                    assert_eq!(f64::from_le_bytes(*number), expected, "{row} {column}");
                }
            }
        }
        let group: Value = serde_json::from_slice(&read_entry(&mut archive, "zarr.json")).unwrap();
        let own: Value = serde_json::from_slice(&read_entry(&mut archive, "v1/zarr.json")).unwrap();
        assert_eq!(group["consolidated_metadata"]["metadata"]["v1"], own);
        assert_eq!(own["shape"], json!([2, 7, 5]));
        assert_eq!(own["attributes"]["units"], "m/s");
    }

    /// Smooth numbers shrink by more than a factor of two, random ones are stored with a header of 16 bytes.
    #[test]
    fn chunks_are_compressed_or_stored() {
        let smooth: Vec<u8> =
            (0..4096).flat_map(|i| (1.0 + 1e-4 * f64::from(i)).to_le_bytes()).collect();
        let encoded = encode_blosc(&smooth, 8);
        assert!(encoded.len() < smooth.len() / 2, "{}", encoded.len());
        assert_eq!(decode_blosc(&encoded), smooth);
        let mut state = 1_u64;
        let random: Vec<u8> = (0..4096)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 56) as u8
            })
            .collect();
        let encoded = encode_blosc(&random, 4);
        assert_eq!(encoded.len(), random.len() + 16);
        assert_eq!(decode_blosc(&encoded), random);
    }
}
