//! Elastic solids against the equations of Sadovskii & Sadovskaya (2019), written out by hand, and against the elastic
//! energy density and rotational invariance.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod energy;
mod parameters;
mod plane_equations;
mod random_solids;
mod strain_rates;
mod tensors;
mod waves;
