//! Solids in time: sweeps along coordinate lines, and what stands between them.
//!
//! - [`line`]: one pair of fields along a line of cells and joints, with its energy account;
//! - [`real`]: the two kinds of floating-point numbers.
#![deny(missing_docs)]

pub mod line;
pub mod real;
