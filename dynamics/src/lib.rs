//! Time-domain solvers: elastoplastic solids by dimensionally split Godunov-type sweeps along coordinate lines,
//! granular flow by Fourier series; both with energy ledgers.
//!
//! This crate knows neither case files nor the analysis: records, snapshots and checkpoints are passed to an observer.
//!
//! | module | contents |
//! |---|---|
//! | [`solid`] | problems, sweeps; fused solver [`domain`], reference solver with full ledger [`mod@reference`] |
//! | [`decomposition`] | domain decomposition: subdomains on threads, halo exchange |
//! | [`simulation`] | time loop of solids and flows: end of a run, observers, output times |
//! | [`flow`] | granular flow in a box that deforms with the mean flow, by Fourier series |
//! | [`simd`] | numbers in SIMD lanes, instruction sets, dispatch |
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod decomposition;
mod exact_sum;
pub mod flow;
pub mod simd;
pub mod simulation;
pub mod solid;

pub use solid::domain::SolverReal;
pub use solid::{
    boundary, contact_law, domain, initial, ledger, line, medium, point_kernel, probe, problem,
    reference,
};
