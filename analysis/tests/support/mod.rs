//! Helpers shared by the integration tests: 256-bit arithmetic, exact dispersion polynomials and their
//! roots, random states. None of it uses the crate's own algebra.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod brute;
pub mod exact;
pub mod planted;
pub mod slipping;
pub mod states;
pub mod verdicts;
pub mod wide;
