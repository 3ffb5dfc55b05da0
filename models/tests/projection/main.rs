//! Projections onto yield sets: the conditions of optimality, written with the support function of
//! each set and evaluated in twice the precision, and a conic solver's answer.
//!
//! s = P(s̄) exactly if s ∈ F and the plastic strain e = D⁻¹(s̄ − s) does its greatest work over F
//! at s: e·s = sup over w ∈ F of e·w. The supremum is finite on a cone of e only, which e must be in.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod conic;
mod interlayer;
mod mises;
mod random_solids;
mod residuals;
#[path = "../support/mod.rs"]
mod support;
