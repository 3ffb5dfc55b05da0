//! Encoding of array values as appended bytes, plain or compressed.

use std::io::Write;

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::number::VtkNumber;

/// Storage of array values in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// Uncompressed little-endian values.
    Plain,
    /// Lossless compression (zlib) in blocks.
    Compressed,
}

pub(super) const MEMORY_WRITE_MESSAGE: &str = "writing into memory";

/// Encodes values without compression, preceded by their length in bytes.
pub(super) fn encode_plain<T: VtkNumber>(values: &[T]) -> Vec<u8> {
    let length = size_of_val(values);
    let mut bytes = Vec::with_capacity(8 + length);
    bytes.extend((length as u64).to_le_bytes());
    values.iter().for_each(|value| value.append_bytes(&mut bytes));
    bytes
}

/// Length of a block before compression, bytes: several of the compressor's windows of 32 KiB.
pub(super) const BLOCK_LENGTH: usize = 1 << 18;

/// Encodes values in compressed blocks, preceded by the number of blocks, the length of a block, the length of the
/// last block if shorter (otherwise zero), and the compressed length of each block.
pub(super) fn encode_compressed<T: VtkNumber>(values: &[T]) -> Vec<u8> {
    let mut lengths = Vec::new();
    let mut blocks = Vec::new();
    let mut bytes = Vec::with_capacity(BLOCK_LENGTH);
    for block in values.chunks(BLOCK_LENGTH / size_of::<T>()) {
        bytes.clear();
        block.iter().for_each(|value| value.append_bytes(&mut bytes));
        let start = blocks.len();
        let mut encoder = ZlibEncoder::new(blocks, Compression::default());
        encoder.write_all(&bytes).expect(MEMORY_WRITE_MESSAGE);
        blocks = encoder.finish().expect(MEMORY_WRITE_MESSAGE);
        lengths.push(blocks.len() - start);
    }
    let head = [lengths.len(), BLOCK_LENGTH, size_of_val(values) % BLOCK_LENGTH];
    let numbers = head.into_iter().chain(lengths);
    let mut encoded: Vec<u8> = numbers.flat_map(|number| (number as u64).to_le_bytes()).collect();
    encoded.extend(blocks);
    encoded
}
