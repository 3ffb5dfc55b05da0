//! What tests of several crates share.
#![deny(missing_docs)]

pub mod flows;
pub mod random;
pub mod ranges;
