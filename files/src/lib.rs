//! File formats and safe file writing: atomic writes, and reproducible bytes for equal content.
//!
//! The crate contains no physics. It encodes columns and arrays as CSV ([`csv`]), NumPy archives ([`npz`]) and VTK
//! files ([`vti`]), and writes files so that a reader never finds a partial file ([`write_atomically`]). For restarts
//! there are checkpoint files with checksums ([`sealed`]) and tables extended row by row ([`append`]); for folders
//! shared by processes there are locks ([`lock`]) and lists of checksums ([`checksums`]). To add a file format, add a
//! module here, its use in `report` and the file names in `cli::folder::names` and `cli::run::planned` of the program.

#![deny(missing_docs)]

pub mod append;
mod atomic;
pub mod checksums;
pub mod csv;
pub mod lock;
pub mod npz;
mod open;
pub mod sealed;
pub mod vti;

/// CRC-32 checksum as in zlib; detects accidental but not intentional damage.
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

pub use atomic::{
    FileError, Staged, remove_abandoned, remove_own_temporaries, stage_with, write_atomically,
    write_atomically_with,
};
pub use open::{Written, open_regular, open_to_append, read_regular, read_regular_within};
