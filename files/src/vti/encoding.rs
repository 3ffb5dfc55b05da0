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

/// Encodes the bytes of values as [`encode_plain`] does.
pub(super) fn encode_plain_bytes(values: &[u8]) -> Vec<u8> {
    [&(values.len() as u64).to_le_bytes(), values].concat()
}

/// Length of a block before compression, bytes: several of the compressor's windows of 32 KiB.
pub(super) const BLOCK_LENGTH: usize = 1 << 18;

/// Encodes values in compressed blocks, preceded by the number of blocks, the length of a block, the length of the
/// last block if shorter (otherwise zero), and the compressed length of each block.
pub(super) fn encode_compressed<T: VtkNumber>(values: &[T]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BLOCK_LENGTH);
    let block = |values: &[T]| {
        bytes.clear();
        values.iter().for_each(|value| value.append_bytes(&mut bytes));
        compress(&bytes)
    };
    let blocks = values.chunks(BLOCK_LENGTH / size_of::<T>()).map(block);
    join_blocks(blocks, size_of_val(values))
}

/// Encodes the bytes of values as [`encode_compressed`] does.
pub(super) fn encode_compressed_bytes(values: &[u8]) -> Vec<u8> {
    join_blocks(values.chunks(BLOCK_LENGTH).map(compress), values.len())
}

/// Compresses bytes by zlib.
pub(crate) fn compress(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).expect(MEMORY_WRITE_MESSAGE);
    encoder.finish().expect(MEMORY_WRITE_MESSAGE)
}

/// Joins compressed blocks of `length` bytes before compression.
fn join_blocks(blocks: impl Iterator<Item = Vec<u8>>, length: usize) -> Vec<u8> {
    let blocks: Vec<Vec<u8>> = blocks.collect();
    let lengths: Vec<usize> = blocks.iter().map(Vec::len).collect();
    let mut encoded = format_block_head(&lengths, length);
    encoded.extend(blocks.into_iter().flatten());
    encoded
}

/// Formats what precedes compressed blocks of given lengths, which have `length` bytes before compression.
pub(super) fn format_block_head(block_lengths: &[usize], length: usize) -> Vec<u8> {
    let head = [block_lengths.len(), BLOCK_LENGTH, length % BLOCK_LENGTH];
    let numbers = head.iter().chain(block_lengths);
    numbers.flat_map(|number| (*number as u64).to_le_bytes()).collect()
}
