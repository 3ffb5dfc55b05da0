//! Projections onto yield sets against the optimality conditions, written with the support function of each set and
//! evaluated in double-double precision, and against a conic solver.
//!
//! s = P(s̄) if and only if s ∈ F and the work of the plastic strain e = D⁻¹(s̄ − s) over F is largest at s:
//! e·s = sup over w ∈ F of e·w. The supremum is finite only for e in a cone.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod conic;
mod interlayer;
mod mises;
mod random_solids;
mod residuals;
#[path = "../support/mod.rs"]
mod support;
