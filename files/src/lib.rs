//! File formats and safe file writing: atomic writes, and reproducible bytes for equal content.
//!
//! The crate contains no physics. It encodes columns and arrays as CSV ([`csv`]), NumPy archives ([`npz`]), VTK
//! files ([`vti`]) and Zarr stores ([`zarr`]), and writes files so that a reader never finds a partial file ([`write_atomically`]). For restarts
//! there are checkpoint files with checksums ([`section_file`]) and tables extended row by row ([`table_appender`]);
//! for folders shared by processes there are locks ([`lock`]) and lists of checksums ([`checksums`]). To add a file
//! format, add a module here, its use in `report` and the file names in `cli::folder::names` and `cli::run::planned` of
//! the program.

#![deny(missing_docs)]

mod atomic_write;
pub mod checksums;
pub mod csv;
pub mod lock;
pub mod npz;
mod regular_file;
pub mod section_file;
pub mod table_appender;
pub mod vti;
pub mod zarr;

/// Writer that can seek, such as a file: earlier bytes can be overwritten.
pub trait SeekableWriter: std::io::Write + std::io::Seek {}

impl<W: std::io::Write + std::io::Seek> SeekableWriter for W {}

/// Returns the bytes of numbers in little-endian order.
pub fn encode_numbers(numbers: &[f64]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(size_of_val(numbers));
    numbers.iter().for_each(|number| bytes.extend_from_slice(&number.to_le_bytes()));
    bytes
}

/// CRC-32 checksum as in zlib; detects accidental but not intentional damage.
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

pub use atomic_write::{
    FileError, StagedFile, remove_abandoned_file, remove_temporary_files, stage_file_with,
    write_atomically, write_atomically_with,
};
pub use regular_file::{
    DigestWriter, FileDigest, open_regular_file, open_to_append, read_regular_file,
    read_regular_file_up_to,
};
