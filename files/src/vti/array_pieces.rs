//! Image data whose arrays are appended in pieces, so that none of them is in memory as a whole.

use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::Path;

use tempfile::{SpooledTempFile, spooled_tempfile_in};

use super::arrays::{ArrayDeclaration, FILE_END, check_length};
use super::encoding::{BLOCK_LENGTH, compress, format_block_head};
use super::image_data::ImageData;
use crate::SeekableWriter;

/// Length up to which the compressed blocks of an array are kept in memory, bytes.
const COMPRESSED_IN_MEMORY: usize = 1 << 20;

/// Arrays of image data, to each of which values are appended in pieces.
pub struct ArrayPieces<'a> {
    arrays: Vec<UnfinishedArray>,
    storage: PieceStorage<'a>,
}

/// Array of which a part of the values has been appended.
struct UnfinishedArray {
    name: String,
    /// Number of bytes of all values.
    length: usize,
    /// Number of bytes that have been appended.
    appended: usize,
}

/// Place of the values.
enum PieceStorage<'a> {
    /// Plain values are written to their final places, which are known: the first byte of each array.
    Plain { writer: &'a mut dyn SeekableWriter, starts: Vec<u64> },
    /// Compressed values are collected, since their places follow from the compressed lengths of all arrays.
    Compressed(&'a mut [CompressedArray]),
}

/// Compressed blocks of an array.
struct CompressedArray {
    /// Values of the next block.
    pending: Vec<u8>,
    blocks: SpooledTempFile,
    block_lengths: Vec<usize>,
}

impl CompressedArray {
    fn append(&mut self, mut values: &[u8]) -> io::Result<()> {
        while !values.is_empty() {
            let (now, rest) = values.split_at(values.len().min(BLOCK_LENGTH - self.pending.len()));
            self.pending.extend_from_slice(now);
            values = rest;
            if self.pending.len() == BLOCK_LENGTH {
                self.end_block()?;
            }
        }
        Ok(())
    }

    fn end_block(&mut self) -> io::Result<()> {
        let block = compress(&self.pending);
        self.pending.clear();
        self.block_lengths.push(block.len());
        self.blocks.write_all(&block)
    }
}

impl ArrayPieces<'_> {
    /// Appends the bytes of values to the array at an index, in little-endian order, with interleaved components.
    ///
    /// # Errors
    /// A file cannot be written, or there are more values than cells.
    pub fn append(&mut self, index: usize, values: &[u8]) -> io::Result<()> {
        let array = &mut self.arrays[index];
        let start = array.appended;
        array.appended += values.len();
        if array.appended > array.length {
            return array.check();
        }
        match &mut self.storage {
            PieceStorage::Plain { writer, starts } => {
                writer.seek(SeekFrom::Start(starts[index] + start as u64))?;
                writer.write_all(values)
            }
            PieceStorage::Compressed(arrays) => arrays[index].append(values),
        }
    }
}

/// Calls `fill` and checks that it has appended all values.
fn fill_arrays(
    arrays: Vec<UnfinishedArray>,
    storage: PieceStorage,
    fill: impl FnOnce(&mut ArrayPieces) -> io::Result<()>,
) -> io::Result<()> {
    let mut pieces = ArrayPieces { arrays, storage };
    fill(&mut pieces)?;
    pieces.arrays.iter().try_for_each(UnfinishedArray::check)
}

impl UnfinishedArray {
    fn check(&self) -> io::Result<()> {
        check_length(&self.name, self.appended, self.length).map_err(io::Error::other)
    }
}

impl ImageData {
    /// Writes image data that has no arrays yet with arrays whose values `fill` appends in pieces: the same bytes as if the
    /// arrays had been added. Compressed values of large arrays are kept in files without names in the folder `scratch_folder`
    /// until all are known.
    ///
    /// # Errors
    /// A file cannot be written, `fill` fails, or an array lacks values.
    pub fn write_in_pieces(
        mut self,
        arrays: &[ArrayDeclaration],
        writer: &mut dyn SeekableWriter,
        scratch_folder: &Path,
        fill: impl FnOnce(&mut ArrayPieces) -> io::Result<()>,
    ) -> io::Result<()> {
        let unfinished = arrays.iter().map(|array| UnfinishedArray {
            name: array.name.clone(),
            length: self.cell_count * array.cell_size(),
            appended: 0,
        });
        let unfinished: Vec<UnfinishedArray> = unfinished.collect();
        if self.arrays.is_plain() {
            self.declare_arrays(arrays);
            writer.write_all(self.format_header().as_bytes())?;
            let mut starts = Vec::new();
            for array in &unfinished {
                writer.write_all(&(array.length as u64).to_le_bytes())?;
                starts.push(writer.stream_position()?);
                writer.seek(SeekFrom::Current(array.length as i64))?;
            }
            let end = writer.stream_position()?;
            fill_arrays(unfinished, PieceStorage::Plain { writer: &mut *writer, starts }, fill)?;
            writer.seek(SeekFrom::Start(end))?;
        } else {
            let compressed = arrays.iter().map(|_| CompressedArray {
                pending: Vec::new(),
                blocks: spooled_tempfile_in(COMPRESSED_IN_MEMORY, scratch_folder),
                block_lengths: Vec::new(),
            });
            let mut compressed: Vec<CompressedArray> = compressed.collect();
            let lengths: Vec<usize> = unfinished.iter().map(|array| array.length).collect();
            fill_arrays(unfinished, PieceStorage::Compressed(&mut compressed), fill)?;
            let mut heads = Vec::new();
            for ((array, length), own) in arrays.iter().zip(lengths).zip(&mut compressed) {
                if !own.pending.is_empty() {
                    own.end_block()?;
                }
                let head = format_block_head(&own.block_lengths, length);
                let length = head.len() + own.block_lengths.iter().sum::<usize>();
                self.arrays.declare_encoded(array, length);
                heads.push(head);
            }
            writer.write_all(self.format_header().as_bytes())?;
            for (head, own) in heads.iter().zip(&mut compressed) {
                writer.write_all(head)?;
                own.blocks.rewind()?;
                io::copy(&mut own.blocks, writer)?;
            }
        }
        if let Some(nodes) = &self.nodes {
            writer.write_all(nodes)?;
        }
        writer.write_all(FILE_END)
    }

    /// Adds arrays without values, for an [index](Self::format_index).
    pub fn declare_arrays(&mut self, arrays: &[ArrayDeclaration]) {
        arrays.iter().for_each(|array| self.arrays.declare(array, self.cell_count));
    }
}
