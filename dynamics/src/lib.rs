//! Solids in time by sweeps along coordinate lines, granular flow in time by Fourier series, and their energy ledgers.
//!
//! It knows no case and no file, and nothing of the analysis: records, snapshots and checkpoints go to an observer.
//!
//! - [`medium`]: what a solid is to the sweeps;
//! - [`problem`]: what is to be solved;
//! - [`domain`]: fields on a rectangular grid, and a step of theirs;
//! - [`boundary`]: what lies beyond its sides, and what acts there and inside;
//! - [`point_kernel`]: the shares of cells in what acts at a point;
//! - [`initial`]: weight in equilibrium, and waves that a solid begins with;
//! - [`ledger`]: the energy there is, and what steps did to it;
//! - [`split`]: the same in parts, each in a thread of its own, and the halo between them;
//! - [`mod@line`]: one pair of fields along a line of cells and joints, with its energy account;
//! - [`kernel`]: the same on many lines at once, in the instructions that the processor has;
//! - [`simulation`]: the loop in time, for solids and flows;
//! - [`probe`]: points at which fields are recorded;
//! - [`real`]: floating-point numbers, and groups of them;
//! - [`flow`]: granular flow in a box that moves with it, by Fourier series.
#![deny(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

pub mod decomposition;
pub mod flow;
pub mod simd;
pub mod simulation;
pub mod solid;

pub use decomposition as split;
pub use simd as real;
pub use solid::domain::SolverReal;
pub use solid::{boundary, domain, initial, ledger, line, medium, point_kernel, probe, problem};
