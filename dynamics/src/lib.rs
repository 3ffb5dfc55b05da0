//! Time-domain solvers: elastoplastic solids by sweeps along coordinate lines (Godunov-type, dimensionally split), granular
//! flow by Fourier series, both with energy ledgers.
//!
//! This crate knows no case file and nothing of the analysis: records, snapshots and checkpoints go to an observer.
//!
//! | module | holds |
//! |---|---|
//! | [`solid`] | media, problems, boundary conditions; one-dimensional sweeps; the fused solver, [`domain`]; a plain one with the full energy account, [`mod@reference`] |
//! | [`decomposition`] | domain decomposition: subdomains in threads, and the halo between them |
//! | [`simulation`] | the time loop of solids and flows: stop rules, observers, snapshots |
//! | [`flow`] | granular flow in a box that deforms with it, by Fourier series |
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
    boundary, domain, initial, ledger, line, medium, point_kernel, probe, problem, reference,
};
