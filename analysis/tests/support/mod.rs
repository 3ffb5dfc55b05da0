//! Helpers shared by the integration tests: 256-bit arithmetic, exact dispersion polynomials and their roots, random
//! states. The references do not use the algebra of the crate.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod brute;
pub mod exact;
pub mod planted;
pub mod slipping;
pub mod states;
pub mod verdicts;
pub mod wide;
