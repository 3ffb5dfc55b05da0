//! Helpers shared by the integration tests: 256-bit arithmetic, exact dispersion polynomials and their roots, random
//! states. The references do not use the algebra of the crate.
#![allow(dead_code, reason = "each test file uses its own part")]

pub mod brute_force;
pub mod exact;
pub mod maximise;
pub mod real256;
pub mod slipping_layer;
pub mod states;
pub mod system_entries;
pub mod typed_flows;
pub mod verdicts;
