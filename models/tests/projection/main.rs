//! Projections onto yield sets against the optimality conditions, written with the support function of each set and
//! evaluated in double-double precision, and against a conic solver.
//!
//! A stress s is the projection P(s̄) of the trial stress s̄ onto the yield set F if and only if s ∈ F and the work of
//! the plastic strain e = D⁻¹(s̄ − s), with the stiffness D, is largest at s among the stresses w of F:
//! e·s = sup e·w over w ∈ F. This supremum, the support function of F, is finite only for e in a cone.
#![allow(clippy::needless_range_loop, reason = "indices are those of tensors")]

mod conic;
mod interlayer;
mod mises;
mod random_solids;
mod residuals;
