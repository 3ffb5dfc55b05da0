//! Elastic solids against the equations as published, typed out by hand, and against what energy and
//! rotations demand of them.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod energy;
mod parameters;
mod plane_equations;
mod random_solids;
mod strain_rates;
#[path = "../support/mod.rs"]
mod support;
mod tensors;
mod waves;
