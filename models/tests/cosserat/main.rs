//! Elastic solids against the published equations, written out by hand, and against the energy balance and rotational
//! invariance.
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
