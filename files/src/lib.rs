//! Files that other programs read: whole or not at all, and the same bytes for the same content.
//!
//! This crate knows no physics. It turns columns and arrays into bytes ([`csv`], [`npz`], [`vti`])
//! and puts bytes on disk so that a reader never meets a half-written file
//! ([`write_atomically`]). For work that goes on after an interruption there are files that notice
//! their own damage ([`sealed`]) and tables that grow row by row ([`append`]); for folders that several
//! processes write to there are locks ([`lock`]) and lists of checksums ([`checksums`]).

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

/// CRC-32 as in zlib: it guards against accidents, not against intent.
pub fn checksum(bytes: &[u8]) -> u32 {
    crc32fast::hash(bytes)
}

pub use atomic::{
    FileError, Staged, remove_abandoned, remove_own_temporaries, stage_with, write_atomically,
    write_atomically_with,
};
pub use open::{Written, open_regular, open_to_append, read_regular, read_regular_within};
