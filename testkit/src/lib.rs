//! What tests of several crates share: constants of the flow models by name, and random numbers that are the same
//! in every run. A development dependency alone; it knows [`models`] and nothing above.
#![deny(missing_docs)]

pub mod flows;
pub mod random;
pub mod ranges;
