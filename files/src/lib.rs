//! Files that other programs read: whole or not at all, and the same bytes for the same content.
//!
//! This crate knows no physics. It turns columns and arrays into bytes ([`csv`], [`npz`]) and puts
//! bytes on disk so that a reader never meets a half-written file ([`write_atomically`]).

#![deny(missing_docs)]

mod atomic;
pub mod csv;
pub mod npz;

pub use atomic::{FileError, write_atomically};
