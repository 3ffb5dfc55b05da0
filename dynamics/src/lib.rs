//! Solids in time: sweeps along coordinate lines, and what stands between them.
//!
//! - [`medium`]: what a solid is to the sweeps;
//! - [`domain`]: fields on a rectangular grid and a step of theirs, plain and one sweep after the other;
//! - [`split`]: the same in parts, each in a thread of its own, and the halo between them;
//! - [`mod@line`]: one pair of fields along a line of cells and joints, with its energy account;
//! - [`real`]: the two kinds of floating-point numbers.
#![deny(missing_docs)]

pub mod domain;
pub mod line;
pub mod medium;
pub mod real;
pub mod split;
