//! Helpers shared by tests of several crates: constants of the flow models by name, reproducible random numbers,
//! complex arithmetic, test values at the ends of ranges. A development dependency only; depends on [`models`] and no
//! higher crate.
#![deny(missing_docs)]

pub mod complex;
pub mod flows;
pub mod random;
pub mod ranges;
